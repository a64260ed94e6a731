"""Plain, slow references for the kernels, written from the formulae and not from the kernels."""

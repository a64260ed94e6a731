"""Plain, slow twins of the kernels, written from the formulae and not from the kernels."""

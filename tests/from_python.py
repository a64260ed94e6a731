"""Call from Python what only kernels call."""

import functools

import numba as nb


@functools.cache
def from_python(function):
    """Return a function that is inlined into kernels, in one that Python can call."""

    @nb.njit(error_model="numpy", fastmath={"contract"})
    def call(*arguments):
        return function(*arguments)

    return call

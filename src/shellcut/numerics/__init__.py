"""Numerical tools that know nothing of shells: compiled kernels, three-vectors, lanes, threads.

May import :mod:`shellcut.arrays` only. ``jit`` is the one place that calls ``numba.njit``;
``lanes`` computes on eight doubles or sixteen singles at once; ``threads`` runs kernels side by
side.
"""

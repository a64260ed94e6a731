"""Numerical tools independent of shells: compiled kernels, three-vectors, lanes, threads.

May import ``arrays``, ``arguments`` and ``files``. Only ``jit`` asks Numba to compile; ``lanes``
computes on eight doubles at once; ``threads`` runs kernels in parallel.
"""

"""The only place that says ``numba.njit``: option sets, each with its reason.

``error_model="numpy"``
    A division by zero gives inf or nan, as NumPy does, instead of a branch and an exception in
    every kernel; lengths that may vanish are guarded by a documented branch.
``fastmath={"contract"}``
    Lets a multiplication and an addition become one fused instruction. Nothing is reassociated
    and nan stays nan, so results do not depend on how a loop was vectorised and the divergence
    guard keeps working.
``cache=True``
    Compile once a machine. A cached caller does not see an edit in a kernel it imports, hence
    the tests key ``NUMBA_CACHE_DIR`` by a hash of the sources.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ParamSpec, TypeAlias, TypeVar

import numba as nb
import numpy as np
import numpy.typing as npt

P = ParamSpec("P")
R = TypeVar("R")

Floats: TypeAlias = npt.NDArray[np.float64]
Numbers: TypeAlias = npt.NDArray[Any]
"""Real, or complex where the element is differentiated by a complex step."""
Ints: TypeAlias = npt.NDArray[np.int64]
SmallInts: TypeAlias = npt.NDArray[np.int8]
Bools: TypeAlias = npt.NDArray[np.bool_]
Vec3: TypeAlias = tuple[float, float, float]

_OPTIONS: dict[str, Any] = {"cache": True, "error_model": "numpy", "fastmath": {"contract"}}


def kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a loop over entities; called from Python, arrays and numbers only."""
    compiled: Callable[P, R] = nb.njit(**_OPTIONS)(function)
    return compiled


def inline(function: Callable[P, R]) -> Callable[P, R]:
    """Compile scalar arithmetic that only kernels call; LLVM inlines it into them.

    Not cached by itself: it is part of the kernels that are.
    """
    compiled: Callable[P, R] = nb.njit(**{**_OPTIONS, "cache": False})(function)
    return compiled

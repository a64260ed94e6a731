"""Type aliases of arrays for annotations; imports only NumPy."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

Floats: TypeAlias = npt.NDArray[np.float64]
Numbers: TypeAlias = npt.NDArray[Any]
"""Array of any numeric type."""
Ints: TypeAlias = npt.NDArray[np.integer[Any]]
SmallInts: TypeAlias = npt.NDArray[np.int8]
Bools: TypeAlias = npt.NDArray[np.bool_]
SmallIds: TypeAlias = npt.NDArray[np.int32]
Number: TypeAlias = Any
"""Number type of the mechanics: a float, or several at once (:mod:`shellcut.numerics.lanes`)."""
Vec3: TypeAlias = tuple[float, float, float]
Vector: TypeAlias = tuple[Number, Number, Number]
"""A three-vector of numbers."""

Held: TypeAlias = tuple[Ints, Floats]
"""Nodes that something holds, a node may come more than once, and its stiffness on each [N/mm]."""

HeldBy: TypeAlias = Mapping[str, Held]
"""The same of several, by their names."""

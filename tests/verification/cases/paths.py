"""Load-deflection paths beside published tables: worst point, distance to the curve, plots."""

from collections.abc import Callable

import numpy as np
from scipy.interpolate import CubicSpline

from harness import Check

ONE_PERCENT = "1 % of the column's largest deflection, at every point of the table"


def rows_of(text: str) -> np.ndarray:
    """Return the table of a text, whose rows are separated by semicolons."""
    return np.array([row.split() for row in text.split(";")], float)


def table_checks(
    names: tuple[str, ...],
    ours: np.ndarray,
    table: np.ndarray,
    *,
    gate: bool = True,
    reason: str = ONE_PERCENT,
    band: float = 0.01,
) -> list[Check]:
    """Return one row a column of the table: the point that lies off most.

    ``table`` has rows (load factor, deflections...); ``ours`` the deflections only. ``band`` is
    relative to the column's largest deflection.
    """
    rows = []
    for name, mine, theirs in zip(names, ours.T, table[:, 1:].T, strict=True):
        k = int(np.argmax(np.abs(mine - theirs)))
        rows.append(
            Check(
                f"{name}, worst of {len(table)}: at {table[k, 0]:g}",
                float(theirs[k]),
                float(mine[k]),
                band * float(np.abs(theirs).max()),
                reason,
                gate=gate,
                absolute=True,
            )
        )
    return rows


def path_checks(
    curves: dict[str, dict[str, list[float]]],
    names: tuple[str, ...],
    table: np.ndarray,
    deflections: Callable[[int], np.ndarray],
    meshes: dict[int, tuple[bool, str]],
    label: str = "{0} x {0}",
) -> list[Check]:
    """Return the rows of a table on meshes, each a gate or not and why; fill the curves of a plot.

    ``deflections(n)`` are those at the table's load factors.
    """
    rows = []
    for n, (gate, reason) in meshes.items():
        ours = deflections(n)
        said = tuple(f"{name}, {label.format(n)}" for name in names)
        rows += table_checks(said, ours, table, gate=gate, reason=reason)
        for k, name in enumerate(said):
            curves[name] = curve(ours[:, k], table[:, 0], table[:, k + 1], table[:, 0])
    return rows


def spline(path: np.ndarray, n: int = 4000) -> np.ndarray:
    """Return points along a cubic through the points of a path, by the length of its chords."""
    chord = np.linalg.norm(np.diff(path / np.abs(path).max(axis=0), axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(chord)])
    return CubicSpline(along, path)(np.linspace(0.0, along[-1], n))


def at_factors(path: np.ndarray, factors: np.ndarray) -> np.ndarray:
    """Return the deflections at load factors of a path (factor, deflections...) that rises."""
    fine = spline(path)
    return np.stack([np.interp(factors, fine[:, 0], column) for column in fine[:, 1:].T], axis=1)


def distance_to_curve(path: np.ndarray, table: np.ndarray) -> float:
    """Return the largest distance of the table's points to the path, axes scaled by its columns.

    One is the largest value of a column of the table.
    """
    scale = np.abs(table).max(axis=0)
    fine, points = spline(path) / scale, table / scale
    return max(float(np.linalg.norm(fine - point, axis=1).min()) for point in points)


def order_curve(sizes, error) -> dict[str, list[float]]:
    """Return errors over sizes beside those of order two, from the first size to the last."""
    ends, first = np.array([sizes[0], sizes[-1]]), abs(error[0])
    return curve(sizes, np.abs(error), ends, first * (ends / ends[0]) ** 2)


def curve(x, y, x_ref, y_ref) -> dict[str, list[float]]:
    """Return a curve for the plots, with the reference's points."""
    columns = {"x": x, "y": y, "x_ref": x_ref, "y_ref": y_ref}
    return {name: [float(v) for v in values] for name, values in columns.items()}

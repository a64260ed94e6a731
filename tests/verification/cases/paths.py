"""Load-deflection paths beside published tables: worst point, distance to the curve, plots."""

import numpy as np
from scipy.interpolate import CubicSpline

from harness import Check

ONE_PERCENT = "1 % of the column's largest deflection, at every point of the table"


def rows_of(text):
    """Return the table of a text, whose rows are separated by semicolons."""
    return np.array([row.split() for row in text.split(";")], float)


def table_checks(names, ours, table, beside=""):
    """Yield one row a column of a table: the point that lies off most.

    ``table`` has rows (load factor, deflections...); ``ours`` the deflections only. ``beside`` :
    why the rows have no verdict, if they have none.
    """
    for name, mine, theirs in zip(names, ours.T, table[:, 1:].T, strict=True):
        k = int(np.argmax(np.abs(mine - theirs)))
        yield Check(
            f"{name}, worst of {len(table)}: at {table[k, 0]:g}",
            float(theirs[k]),
            float(mine[k]),
            0.01 * float(np.abs(theirs).max()),
            beside or ONE_PERCENT,
            gate=not beside,
            absolute=True,
        )


def path_checks(curves, names, table, deflections, meshes):
    """Yield the rows of a table on meshes; fill the curves of a plot.

    ``deflections(n)`` are those at the table's load factors. ``meshes`` : by label n, and why the
    rows of this mesh have no verdict, if they have none.
    """
    for label, (n, beside) in meshes.items():
        ours = deflections(n)
        said = [f"{name}, {label}" for name in names]
        yield from table_checks(said, ours, table, beside)
        for k, name in enumerate(said):
            curves[name] = curve(ours[:, k], table[:, 0], table[:, k + 1], table[:, 0])


def spline(path, n=4000):
    """Return points along a cubic through the points of a path, by the length of its chords."""
    chord = np.linalg.norm(np.diff(path / np.abs(path).max(axis=0), axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(chord)])
    return CubicSpline(along, path)(np.linspace(0.0, along[-1], n))


def at_factors(path, factors):
    """Return the deflections at load factors of a path (factor, deflections...) that rises."""
    fine = spline(path)
    return np.stack([np.interp(factors, fine[:, 0], column) for column in fine[:, 1:].T], axis=1)


def distance_to_curve(path, table):
    """Return the largest distance of a table's points to a path, in its columns' largest values."""
    scale = np.abs(table).max(axis=0)
    fine, points = spline(path) / scale, table / scale
    return max(float(np.linalg.norm(fine - point, axis=1).min()) for point in points)


def order_curve(sizes, error):
    """Return errors over sizes beside those of order two, from the first size to the last."""
    ends, first = np.array([sizes[0], sizes[-1]]), abs(error[0])
    return curve(sizes, np.abs(error), ends, first * (ends / ends[0]) ** 2)


def curve(x, y, x_ref, y_ref):
    """Return a curve for the plots, with the reference's points."""
    columns = {"x": x, "y": y, "x_ref": x_ref, "y_ref": y_ref}
    return {name: [float(v) for v in values] for name, values in columns.items()}

"""What comes of reading a damaged file: refused, the same, said, or other without a word."""

import logging

import numpy as np

from shellcut import read_film, read_tool


class Said(logging.Handler):
    """Keeps what the library logs."""

    def __init__(self):
        super().__init__(logging.WARNING)
        self.lines = []

    def emit(self, record):
        self.lines.append(record.getMessage())


def read_quietly(read, path):
    """Return what a reader returns and what it said."""
    logger, handler = logging.getLogger("shellcut"), Said()
    logger.addHandler(handler)
    logger.propagate = False
    try:
        with np.errstate(all="ignore"):
            return read(path), handler.lines
    finally:
        logger.removeHandler(handler)
        logger.propagate = True


def film_of(path):
    return read_film(path, unit="mm")


def tool_of(path):
    return read_tool(path, unit="mm", sharp_angle_deg=90.0)


def outcome(kind, path, sound):
    """Return one of "refused", "same", "said", or what differs without a word.

    Parameters
    ----------
    kind : {"film", "tool"}
    sound : tuple
        What :func:`read_quietly` gave of the sound file.
    """
    read = film_of if kind == "film" else tool_of
    try:
        found, said = read_quietly(read, path)
    except ValueError:
        return "refused"
    differs = (_film_differs if kind == "film" else _tool_differs)(sound[0], found)
    if not differs:
        return "same"
    return "said" if set(_without_path(said)) - set(_without_path(sound[1])) else differs


def _without_path(lines):
    return [line.split(": ", 1)[-1] for line in lines]


def _film_differs(a, b):
    if _cells(a, a.quads) != _cells(b, b.quads):
        # the same but for places, if the corners have the same numbers
        return "coordinates" if np.array_equal(a.quads, b.quads) else "elements"
    if _sets(a) != _sets(b):
        one, two = (sorted(_sets(mesh).values(), key=repr) for mesh in (a, b))
        return "sets" if one != two else "names"
    return ""


def _tool_differs(a, b):
    if _cells(a, a.triangles) == _cells(b, b.triangles):
        return ""
    return "coordinates" if np.array_equal(a.triangles, b.triangles) else "elements"


def _points(thing):
    places = thing.nodes if hasattr(thing, "nodes") else thing.vertices
    return [tuple(row) for row in places.tolist()]


def _cells(thing, cells):
    """Return the cells by their corners' places, whatever the numbers and the first corner."""
    points = _points(thing)
    return sorted(_turned([points[n] for n in cell]) for cell in cells.tolist())


def _turned(corners):
    first = corners.index(min(corners))
    return corners[first:] + corners[:first]


def _sets(mesh):
    points, cells = _points(mesh), mesh.quads.tolist()
    named = {f"node {n}": sorted(points[i] for i in ids) for n, ids in mesh.node_sets.items()}
    return named | {
        f"quad {n}": sorted(sorted(points[i] for i in cells[e]) for e in ids.tolist())
        for n, ids in mesh.quad_sets.items()
    }

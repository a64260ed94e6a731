"""A frame in a window of PyVista: actors that stay and get the surfaces of the next frame."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.frame import Frame, is_corner

from ._panel import (
    CABLE_COLORS,
    EDGE_COLOR,
    FLANK_COLOR,
    MESH_COLOR,
    TOOL_COLOR,
    edge_length,
    tool_creases,
)

_TOOL_OPACITY = 0.4  # so that film and edges behind it are visible
_CREASE_COLOR = (0.3, 0.3, 0.33)

Part = tuple[str, Any, dict[str, Any]]
"""Name, PyVista mesh, and options of ``Plotter.add_mesh``."""


class Actors:
    """The parts of a frame in a plotter.

    Parameters
    ----------
    plotter : pyvista.Plotter
        Where they appear; what else it shows stays.
    scale : ScalarMappable
        From the values of the film to colour.
    """

    def __init__(self, plotter: Any, scale: Any) -> None:
        self._plotter, self._scale = plotter, scale
        self._shown: dict[str, Any] = {}

    @property
    def film(self) -> Any:
        """The actor of the film, whose cells are the quads."""
        return self._shown["film"]

    def show(self, frame: Frame, values: Floats, of: str = "quad") -> None:
        """Show a frame, its film coloured by values of the quads, or of the nodes (``"node"``)."""
        # Of lines without length, as of cables before they open, nothing is left to draw.
        parts = [part for part in _parts(frame, values, of) if part[1].n_points]
        if [name for name, _, _ in parts] == list(self._shown):
            for name, mesh, _ in parts:
                self._shown[name].mapper.SetInputData(mesh)
        else:  # parts appeared or vanished: add all again, so that the order stays the same
            self.clear()
            self._shown = {name: self._added(mesh, look) for name, mesh, look in parts}

    def clear(self) -> None:
        """Remove all parts; the next frame is shown by new actors."""
        for actor in self._shown.values():
            self._plotter.remove_actor(actor, reset_camera=False, render=False)
        self._shown = {}

    def rescale(self, scale: Any) -> None:
        """Colour the frames shown from now on by another scale."""
        self.clear()
        self._scale = scale

    def _added(self, mesh: Any, look: dict[str, Any]) -> Any:
        if "scalars" in look:
            look = look | {"cmap": self._scale.cmap, "clim": self._scale.get_clim()}
        actor = self._plotter.add_mesh(mesh, render=False, reset_camera=False, **look)
        if "Normals" in mesh.point_data:
            actor.prop.interpolation = "Phong"
        return actor


def _parts(frame: Frame, values: Floats, of: str) -> Iterator[Part]:
    yield (
        "film",
        _film(frame, values, of),
        {
            "scalars": "values",
            "show_scalar_bar": False,
            "ambient": 0.35,
            "diffuse": 0.65,
            "specular": 0.0,
            "show_edges": True,
            "edge_color": MESH_COLOR,
            "edge_opacity": 0.35,
        },
    )
    # Tubes, with a radius relative to the quads: lines of pixel width vanish in the film.
    thick = 0.03 * edge_length(frame)
    if len(frame.crack_edges):
        flanks = _segments(frame.points, frame.crack_edges.reshape(-1, 2))
        yield "flanks", flanks.tube(radius=thick), {"color": FLANK_COLOR}
    for state, color in CABLE_COLORS.items():
        chosen = frame.cable_segments[frame.cable_state == state]
        if len(chosen):
            yield f"cables {state}", _tubes(chosen, 1.3 * thick), {"color": color, **_BRIGHT}
    if len(frame.edge_points):
        yield "edges", _tubes(frame.edge_points, 1.6 * thick), {"color": EDGE_COLOR, **_BRIGHT}
    if len(frame.tool_triangles):
        tool = _surface(frame.tool_points, frame.tool_triangles)
        yield "tool", tool, {"color": TOOL_COLOR, "opacity": _TOOL_OPACITY, "ambient": 0.45}
        creases = tool_creases(frame)
        if len(creases):
            lines = _segments(frame.tool_points, creases)
            yield "creases", lines, {"color": _CREASE_COLOR, "line_width": 1}


_BRIGHT = {"lighting": False}


def _film(frame: Frame, values: Floats, of: str) -> Any:
    # With point normals: otherwise the two triangles of a warped quad are shaded differently.
    film = _surface(frame.points, frame.quads).compute_normals(
        cell_normals=False, split_vertices=False
    )
    (film.cell_data if of == "quad" else film.point_data)["values"] = values
    return film


def _surface(points: Floats, faces: Ints) -> Any:
    import pyvista

    own = np.pad(is_corner(faces), ((0, 0), (1, 0)), constant_values=True)
    count = own[:, 1:].sum(axis=1, keepdims=True)
    return pyvista.PolyData(np.asarray(points), np.hstack((count, faces))[own])


def _segments(points: Floats, ids: Ints) -> Any:
    import pyvista

    cells = np.column_stack((np.full(len(ids), 2), ids))
    return pyvista.PolyData(np.asarray(points), lines=cells)


def _tubes(segments: Floats, radius: float) -> Any:
    ids = np.arange(2 * len(segments)).reshape(-1, 2)
    return _segments(segments.reshape(-1, 3), ids).tube(radius=radius)

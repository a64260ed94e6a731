"""Single parts of a model, to draw a model that cannot be built."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numpy as np

from shellcut.arrays import Ints
from shellcut.loads.supports import choose_nodes
from shellcut.mesh.mesh import Mesh
from shellcut.models.guillotine import blade_before
from shellcut.models.oscillating import duration_of as oscillating_time
from shellcut.models.oscillating import way_of
from shellcut.models.preview import ModelParts
from shellcut.models.trouser import duration_of
from shellcut.tool.motion import Motion, ScrewMotion
from shellcut.tool.tool import Tool

from .build import as_long_as
from .model import Model

_BY_ITSELF = {"opening": ("rim",), "strip": ("bottom", "top")}
_PULLED = ("tail", "up", "down")
"""Node sets at which films of the package are clamped, by kind."""

# Refusals are ignored here: the error of the model reports them.
_REFUSALS = (ValueError, KeyError, ImportError, OSError)


def parts(model: Model) -> ModelParts:
    """Return those of film, held nodes, tool and motion that can be built."""
    return _Parts(model).made()


class _Parts:
    def __init__(self, model: Model) -> None:
        self._model = model
        self._of = model.sections

    def made(self) -> ModelParts:
        mesh: Mesh | None = self._try(self._film)
        if self._model.head.model == "trouser":
            return ModelParts(mesh=mesh, held=self._held_of(mesh), duration=self._try(self._pull))
        tool: Tool | None = self._try(lambda: self._tool(mesh))
        moved = self._try(lambda: self._motion(mesh, tool))
        motion, duration = (None, None) if moved is None else moved[1:]
        return ModelParts(
            mesh=mesh,
            held=self._held_of(mesh),
            tool=tool if moved is None else moved[0],
            motion=motion,
            duration=duration,
        )

    def _try(self, make: Callable[[], Any]) -> Any:
        """Return the part, None if it is refused or needs a missing part."""
        found = None
        with suppress(*_REFUSALS):
            found = make()
        return found

    def _tool(self, mesh: Mesh | None) -> Tool:
        section = self._of["tool"]
        if self._model.head.model == "guillotine" and mesh is not None:
            section = as_long_as(section, float(np.ptp(mesh.nodes[:, 0])))
        tool: Tool = section.made()
        return tool

    def _motion(self, mesh: Mesh | None, tool: Tool | None) -> tuple[Tool | None, Motion, float]:
        section = self._of["motion"]
        if self._model.head.model == "opening":
            motion = ScrewMotion.over(
                angle_deg=section.angle_deg, duration=section.duration, pitch=section.pitch
            )
            return tool, motion, section.duration
        if self._model.head.model == "guillotine":
            if mesh is None or tool is None:
                raise ValueError("the way of the blade begins where the strip does")
            law = self._of["cohesive"].made()
            return blade_before(
                mesh,
                tool,
                travel=section.travel,
                speed=section.speed,
                slice_ratio=section.slice_ratio,
                law=law,
            )
        if self._model.head.model == "oscillating":
            if mesh is None:
                raise ValueError("the way of the bar ends where the strip does")
            bar, extent = self._of["tool"], float(np.ptp(mesh.nodes[:, 0]))
            way, speed = section.travel, section.speed
            duration = oscillating_time(bar.diameter, extent, travel=way, speed=speed)
            return tool, way_of(speed), duration
        given = section.made()
        duration = section.duration
        return tool, given, float(given.times[-1]) if duration is None else duration

    def _film(self) -> Mesh:
        film = self._of["membrane"]
        if self._model.head.model == "oscillating":
            strip: Mesh = film.before(self._of["tool"].diameter)
            return strip
        mesh: Mesh = film.made()
        return mesh

    def _pull(self) -> float:
        film, way = self._of["membrane"], self._of["motion"]
        return duration_of(
            film.length, film.width, travel=way.travel, speed=way.speed, ramp=way.ramp
        )

    def _held_of(self, mesh: Mesh | None) -> Ints:
        return np.zeros(0, np.int64) if mesh is None else self._held(mesh)

    def _held(self, mesh: Mesh) -> Ints:
        film = self._of["membrane"]
        names = _BY_ITSELF.get(film.kind, ())
        if self._model.head.model == "trouser":
            names = _PULLED
        if self._model.head.model == "free" or not names:
            names = getattr(film, "clamp", ())
        found: list[Ints] = []
        for name in names:
            with suppress(*_REFUSALS):
                found.append(mesh.node_set(name))
        for support in self._model.lists.get("supports", ()):
            with suppress(*_REFUSALS):
                found.append(choose_nodes(mesh, support.nodes))
        return np.unique(np.concatenate([np.zeros(0, np.int64), *found]))

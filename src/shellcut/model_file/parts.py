"""Single parts of a model, to draw a model that cannot be built."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import suppress
from typing import Any

import numpy as np

from shellcut.arrays import Ints
from shellcut.loads.supports import choose_nodes
from shellcut.mesh.mesh import Mesh
from shellcut.models.guillotine import blade_before
from shellcut.models.oscillating import duration_of as oscillating_time
from shellcut.models.preview import ModelParts
from shellcut.models.trouser import duration_of as trouser_time
from shellcut.tool.motion import Motion
from shellcut.tool.tool import Tool

from .build import duration_of, film_of, tool_before
from .model import Model

_BY_ITSELF = {
    ("opening", "opening"): ("rim",),
    ("guillotine", "strip"): ("bottom", "top"),
    ("oscillating", "strip"): ("bottom", "top"),
    ("trouser", "strip"): ("tail", "up", "down"),
}
"""Node sets at which the models hold their own films, by model and kind."""

# Refusals are ignored here: the error of the model reports them.
_REFUSALS = (ValueError, KeyError, ImportError, OSError)


def parts(model: Model) -> ModelParts:
    """Return those of film, held nodes, tool and motion that can be built."""
    mesh: Mesh | None = _try(lambda: film_of(model))
    if model.head.model == "trouser":
        pull = _try(lambda: trouser_time(**_values(model, "length width", "travel speed ramp")))
        return ModelParts(mesh=mesh, held=_held(model, mesh), duration=pull)
    tool: Tool | None = _try(lambda: tool_before(model, mesh).made())
    moved = _try(lambda: _moved(model, mesh, tool))
    tool, motion, duration = (tool, None, None) if moved is None else moved
    held = _held(model, mesh)
    return ModelParts(mesh=mesh, held=held, tool=tool, motion=motion, duration=duration)


def _try(make: Callable[[], Any]) -> Any:
    """Return a part, None if it is refused or needs a missing part."""
    with suppress(*_REFUSALS):
        return make()
    return None


def _values(model: Model, film: str, motion: str) -> dict[str, Any]:
    given = (("membrane", film), ("motion", motion))
    return {
        name: model.sections[title].values[name] for title, names in given for name in names.split()
    }


def _moved(model: Model, mesh: Mesh | None, tool: Tool | None) -> tuple[Tool | None, Motion, float]:
    """Return the tool where it starts, its motion and the duration [s]."""
    section = model.sections["motion"]
    if model.head.model == "guillotine":
        if mesh is None or tool is None:
            raise ValueError("the way of the blade begins where the strip does")
        way = _values(model, "", "travel speed slice_ratio")
        return blade_before(mesh, tool, law=model.sections["cohesive"].made(), **way)
    motion: Motion = section.made()
    if model.head.model != "oscillating":
        return tool, motion, duration_of(section, motion)
    if mesh is None:
        raise ValueError("the way of the bar ends where the strip does")
    extent, way = float(np.ptp(mesh.nodes[:, 0])), _values(model, "", "travel speed")
    return tool, motion, oscillating_time(model.sections["tool"].diameter, extent, **way)


def _held(model: Model, mesh: Mesh | None) -> Ints:
    """Return the nodes that are held, shape (n,), as far as there are such."""
    found: list[Ints] = [np.zeros(0, np.int64)]
    if mesh is not None:
        film = model.sections["membrane"]
        own = _BY_ITSELF.get((model.head.model, film.kind), film.values.get("clamp", ()))
        choices: Iterable[Any] = (*own, *(one.nodes for one in model.lists.get("supports", ())))
        for chosen in choices:
            with suppress(*_REFUSALS):
                found.append(choose_nodes(mesh, chosen))
    return np.unique(np.concatenate(found))

"""Build a case from a model, with the builders of :mod:`shellcut.models`.

A value arrives like this: ``reader`` reads the text of ``[contact] penalty`` by the form of its
key; the section makes its object, ``Contact`` (:meth:`.key.Section.made`); :func:`build` gives it
to the model's builder, which hands it to ``Simulation(contact=...)``. There ``PenaltyLaw.of`` and
``PenaltyLaw.of_nodes`` make the stiffness of each node, a column of the table that the kernel
``press_kernel.add_press_forces`` reads. Keys of a section that is ``spread`` are arguments of the
builder or of the simulation themselves.

Of a model that cannot be built, single parts, to draw it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from typing import Any, get_args

import numpy as np

from shellcut.arrays import Ints
from shellcut.loads.supports import choose_nodes
from shellcut.mesh.mesh import Mesh
from shellcut.mesh.outline import mesh_from_outline
from shellcut.mesh.placed import placed
from shellcut.mesh.structured import OpeningName
from shellcut.models import Case, free_cut, guillotine, opening_test, oscillating, trouser
from shellcut.models.case import PAPER_DAMPING, damped_by
from shellcut.models.guillotine import blade_before
from shellcut.models.oscillating import duration_of as oscillating_time
from shellcut.models.oscillating import film_before
from shellcut.models.path_film import film_along_path
from shellcut.models.preview import ModelParts
from shellcut.models.trouser import duration_of as trouser_time
from shellcut.simulation.simulation import Simulation
from shellcut.tool.motion import Motion
from shellcut.tool.tool import Tool

from .key import Section
from .model import Model
from .section_table import STRIP_BLADE, along_path, by_gmsh
from .source import KeyPath, ModelFileError, Problem, is_refusal, titled_path

BUILDERS: dict[str, Callable[..., Case]] = {
    "opening": opening_test,
    "guillotine": guillotine,
    "free": free_cut,
    "trouser": trouser,
    "oscillating": oscillating,
}
_DISCS = get_args(OpeningName)
_OWNERS = (*BUILDERS.values(), Simulation)

_ARGUMENTS = {
    "membrane": "mesh",
    "material": "material",
    "cohesive": "law",
    "tool": "tool",
    "motion": "motion",
    "contact": "contact",
    "fracture": "fracture",
    "time": "stepping",
    "adhesion": "terms",
}
"""Argument of a builder for what is made of a section."""

_BY_ITSELF = {
    ("opening", "opening"): ("rim",),
    ("guillotine", "strip"): ("bottom", "top"),
    ("oscillating", "strip"): ("bottom", "top"),
    ("trouser", "strip"): ("tail", "up", "down"),
}
"""Node sets at which the models hold their own films, by model and kind."""

# Refusals are ignored here: the error of the model reports them.
_REFUSALS = (ValueError, KeyError, ImportError, OSError)


def build(model: Model) -> Case:
    """Build the case; ModelFileError names the section that cannot be built, or does not fit."""
    with _blame(model, ()):
        case = BUILDERS[model.head.model](**_arguments(model))
    return replace(case, name=model.name)


class _Made:
    """What is made of single sections, each once.

    A film may need the tool, and makes it; a blade without a length is as long as the strip, which
    is made before.
    """

    def __init__(self, model: Model) -> None:
        self._model = model
        self._of: dict[str, Any] = {}

    def __getitem__(self, title: str) -> Any:
        if title not in self._of:
            section = self._model.sections[title]
            if section.of is STRIP_BLADE and section.length is None and "membrane" in self._of:
                section = section.with_values(length=float(np.ptp(self["membrane"].nodes[:, 0])))
            with _blame(self._model, (title,)):
                self._of[title] = self._film() if title == "membrane" else section.made()
        return self._of[title]

    def _film(self) -> Mesh:
        model, section = self._model, self._model.sections["membrane"]
        if model.head.model == "oscillating":
            shape = {name: section.values[name] for name in ("size", "length", "width", "band")}
            return film_before(model.sections["tool"].diameter, **shape)
        if section.of.outline is None or not by_gmsh(section):
            film: Mesh = section.made()
            return film
        of = section.of.outline(section)
        shift = np.asarray(section.values.get("shift", (0.0, 0.0, 0.0)), float)
        if not along_path(section):
            return placed(
                mesh_from_outline(of.outline, holes=of.holes, size=section.size),
                shift=shift.tolist(),
            )
        # The path is where the tool passes, so the film must be in its place before it is meshed.
        aside, rise = shift[:2], float(shift[2])
        film = film_along_path(
            np.asarray(of.outline) + aside,
            holes=[np.asarray(hole) + aside for hole in of.holes],
            tool=[tool.translated((0.0, 0.0, -rise)) for tool in self._tools(section)],
            motion=self["motion"],
            duration=duration_of(model.sections["motion"], self["motion"]),
            size_at_path=section.size_at_path,
            size=section.values.get("size"),
            material=self["material"],
            law=self["cohesive"],
        )
        return placed(film, shift=(0.0, 0.0, rise))

    def _tools(self, film: Section) -> list[Tool]:
        """Return all tools under whose paths the quads of a film are small."""
        tool = self._model.sections["tool"]
        if film.values.get("tools") and tool.kind != "file":
            raise ValueError("tools are files read as [tool] file is, which is not given")
        others = [tool.with_values(file=file) for file in film.values.get("tools", ())]
        return [self["tool"], *(one.made() for one in others if one.file != tool.file)]


def _arguments(model: Model) -> dict[str, Any]:
    """Return the arguments of the model's builder: single values, and what sections make."""
    made = _Made(model)
    film = made["membrane"]
    given: dict[str, Any] = {}
    for title, section in (("", model.head), *model.sections.items()):
        given |= {
            key.parameter: value
            for name, key in section.of.keys.items()
            if key.owner in _OWNERS and (value := section.values[name]) is not None
        }
        if title in _ARGUMENTS and not section.of.spread:
            given[_ARGUMENTS[title]] = made[title]
    with _blame(model, ("membrane",), "clamp"):
        for name in given.get("clamp", ()):
            film.node_set(name)
    if model.head.model == "opening" and model.sections["membrane"].values.get("mesh") in _DISCS:
        given = damped_by(PAPER_DAMPING, given)  # as the builder does that is given the name
    if model.head.model == "free":
        given.setdefault("duration", duration_of(model.sections["motion"], given["motion"]))
    for title, several in model.lists.items():
        made_of = given[_ARGUMENTS.get(title, title)] = list[Any]()
        for n, entry in enumerate(several):
            with _blame(model, (title, n)):
                if entry.values.get("nodes") is not None:
                    choose_nodes(film, entry.nodes)
                if isinstance(entry.values.get("quads"), str):
                    film.quad_set(entry.quads)
                made_of.append(entry.made())
    return given


def duration_of(section: Section, motion: Any) -> float:
    """Return the duration of a motion [s]; by default that of its table."""
    return float(motion.times[-1] if section.duration is None else section.duration)


@contextmanager
def _blame(model: Model, path: KeyPath, *key: str) -> Iterator[None]:
    """Turn an error from a part, or a key of it, into one that names its place in the file."""
    try:
        yield
    except ModelFileError:
        raise
    except (ValueError, KeyError, ImportError, OSError) as problem:
        if not isinstance(problem, OSError) and not is_refusal(problem):
            raise
        said = problem.args[0] if isinstance(problem, KeyError) else problem
        text = f"{titled_path(path)}: {said}" if path else str(said)
        raise ModelFileError([Problem(model.source.place((*path, *key)), text)]) from problem


# --- single parts ---------------------------------------------------------------------------------


def parts(model: Model) -> ModelParts:
    """Return those of film, supported nodes, tool and motion that can be built."""
    made = _Made(model)
    mesh: Mesh | None = _try(lambda: made["membrane"])
    if model.head.model == "trouser":
        pull = _try(lambda: trouser_time(**_values(model, "length width", "travel speed ramp")))
        return ModelParts(mesh=mesh, supported=_supported(model, mesh), duration=pull)
    tool: Tool | None = _try(lambda: made["tool"])
    moved = _try(lambda: _moved(model, mesh, tool))
    tool, motion, duration = (tool, None, None) if moved is None else moved
    supported = _supported(model, mesh)
    return ModelParts(mesh=mesh, supported=supported, tool=tool, motion=motion, duration=duration)


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
            raise ValueError("the path of the blade begins where the strip does")
        travel = _values(model, "", "travel speed slice_ratio")
        return blade_before(mesh, tool, law=model.sections["cohesive"].made(), **travel)
    motion: Motion = section.made()
    if model.head.model != "oscillating":
        return tool, motion, duration_of(section, motion)
    if mesh is None:
        raise ValueError("the path of the bar ends where the strip does")
    extent, travel = float(np.ptp(mesh.nodes[:, 0])), _values(model, "", "travel speed")
    return tool, motion, oscillating_time(model.sections["tool"].diameter, extent, **travel)


def _supported(model: Model, mesh: Mesh | None) -> Ints:
    """Return the supported nodes, shape (n,); none if they cannot be found."""
    found: list[Ints] = [np.zeros(0, np.int64)]
    if mesh is not None:
        film = model.sections["membrane"]
        own = _BY_ITSELF.get((model.head.model, film.kind), film.values.get("clamp", ()))
        choices: Iterable[Any] = (*own, *(each.nodes for each in model.lists.get("supports", ())))
        for chosen in choices:
            with suppress(*_REFUSALS):
                found.append(choose_nodes(mesh, chosen))
    return np.unique(np.concatenate(found))

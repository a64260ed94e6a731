"""Build a case from a model, with the builders of :mod:`shellcut.models`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np

from shellcut.loads.supports import Support, choose_nodes
from shellcut.mesh.mesh import Mesh
from shellcut.models import Case, free_cut, guillotine, opening_test, oscillating, trouser

from .errors import ModelFileError, Problem, is_refusal
from .key import Section
from .model import Model
from .source import KeyPath


def build(model: Model) -> Case:
    """Build the case.

    Raises
    ------
    ModelFileError
        Names the section that cannot be built, or that does not fit the others.
    """
    case = _Build(model).case()
    return replace(case, name=model.name)


class _Build:
    def __init__(self, model: Model) -> None:
        self._model = model
        self._of = model.sections

    def case(self) -> Case:
        builder: Callable[[], Case] = {
            "opening": self._opening,
            "guillotine": self._guillotine,
            "free": self._free,
            "trouser": self._trouser,
            "oscillating": self._oscillating,
        }[self._model.head.model]
        with self._blame(()):
            return builder()

    def _opening(self) -> Case:
        film, motion = self._of["membrane"], self._of["motion"]
        mesh = self._made("membrane")
        if film.kind != "opening":
            with self._blame(("membrane", "clamp")):
                mesh = _with_set(mesh, "rim", film.clamp)
        return opening_test(
            mesh,
            tool=self._made("tool"),
            pitch=motion.pitch,
            angle_deg=motion.angle_deg,
            duration=motion.duration,
            **self._options(mesh),
        )

    def _guillotine(self) -> Case:
        film, motion = self._of["membrane"], self._of["motion"]
        shape: dict[str, Any]
        if film.kind == "strip":
            shape = {"size": film.size, "length": film.length, "width": film.width}
            mesh = self._made("membrane")
            extent = film.length
        else:
            mesh = self._made("membrane")
            with self._blame(("membrane", "clamp")):
                mesh = _with_set(mesh, "bottom", film.clamp[:1])
                mesh = _with_set(mesh, "top", film.clamp[-1:])
            shape = {"mesh": mesh}
            extent = float(np.ptp(mesh.nodes[:, 0]))
        blade = as_long_as(self._of["tool"], extent)
        return guillotine(
            **shape,
            notch=film.notch,
            travel=motion.travel,
            speed=motion.speed,
            slice_ratio=motion.slice_ratio,
            tool=self._made("tool", blade),
            **self._options(mesh),
        )

    def _free(self) -> Case:
        film, motion = self._of["membrane"], self._made("motion")
        mesh = self._made("membrane")
        duration = self._of["motion"].duration
        if duration is None:
            duration = float(motion.times[-1])
        supports = []
        with self._blame(("membrane", "clamp")):
            for name in film.clamp:
                mesh.node_set(name)
                supports.append(Support.clamped(name))
        for n, one in enumerate(self._model.lists["supports"]):
            with self._blame(("supports", n)):
                choose_nodes(mesh, one.nodes)
                supports.append(one.made())
        return free_cut(
            mesh,
            tool=self._made("tool"),
            motion=motion,
            duration=duration,
            notch=film.notch,
            supports=supports,
            **self._options(mesh),
        )

    def _trouser(self) -> Case:
        film, motion = self._of["membrane"], self._of["motion"]
        return trouser(
            film.size,
            length=film.length,
            width=film.width,
            notch=film.notch,
            travel=motion.travel,
            speed=motion.speed,
            ramp=motion.ramp,
            **self._options(self._made("membrane")),
        )

    def _oscillating(self) -> Case:
        film, motion, bar = self._of["membrane"], self._of["motion"], self._of["tool"]
        return oscillating(
            film.size,
            length=film.length,
            width=film.width,
            band=film.band,
            notch=film.notch,
            offset=film.offset,
            diameter=bar.diameter,
            tilt_deg=bar.tilt_deg,
            travel=motion.travel,
            speed=motion.speed,
            **self._options(film.before(bar.diameter)),
        )

    def _options(self, mesh: Mesh) -> dict[str, Any]:
        head, damping = self._model.head, self._of["damping"]
        loads = []
        for n, one in enumerate(self._model.lists["loads"]):
            with self._blame(("loads", n)):
                if getattr(one, "nodes", None) is not None:
                    choose_nodes(mesh, one.nodes)
                if getattr(one, "quads", None) is not None:
                    mesh.quad_set(one.quads)
                loads.append(one.made())
        return {
            "material": self._made("material"),
            "law": self._made("cohesive"),
            "fracture": self._made("fracture"),
            "stepping": self._made("time"),
            "damping_alpha": damping.alpha,
            "damping_beta": damping.beta,
            "directional": head.directional,
            "imperfection": head.imperfection,
            "threads": head.threads,
            "loads": loads,
            **({"contact": self._made("contact")} if "contact" in self._of else {}),
        }

    def _made(self, title: str, section: Section | None = None) -> Any:
        with self._blame((title,)):
            return (section or self._of[title]).made()

    @contextmanager
    def _blame(self, path: KeyPath) -> Iterator[None]:
        """Turn an error from a part into one that names its place in the file."""
        try:
            yield
        except ModelFileError:
            raise
        except (ValueError, KeyError, ImportError, OSError) as problem:
            if not isinstance(problem, OSError) and not is_refusal(problem):
                raise
            said = problem.args[0] if isinstance(problem, KeyError) else problem
            text = f"[{path[0]}]: {said}" if path else str(said)
            raise ModelFileError([Problem(self._model.source.place(path), text)]) from problem


def as_long_as(blade: Any, extent: float) -> Any:
    """Return the section of a blade, with the strip's length [mm] where it has none of its own."""
    if blade.kind == "blade" and blade.length is None:
        return replace(blade, length=extent)
    return blade


def _with_set(mesh: Mesh, name: str, sets: tuple[str, ...]) -> Mesh:
    """Return the mesh with a node set; a set of the same name is replaced."""
    nodes = np.unique(np.concatenate([mesh.node_set(one) for one in sets]))
    return replace(mesh, node_sets={**mesh.node_sets, name: nodes})

"""Sections that may occur several times: ``[[supports]]`` and ``[[loads]]``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from shellcut.loads.loads import EdgeTraction, Gravity, NodalForce, NodalMoment, Pressure, steady
from shellcut.loads.supports import Support

from .forms import FORMS
from .key import Constructor, Kind, Section, keys_of, own_key


@dataclass(frozen=True)
class Constant:
    """A constant rate."""

    value: float

    def __call__(self, _time: float) -> float:
        """Return the rate."""
        return self.value


@dataclass(frozen=True)
class Rising:
    """A factor that rises linearly from 0 to 1 over a time [s]."""

    ramp: float

    def __call__(self, time: float) -> float:
        """Return the factor at a time [s]."""
        return min(max(time / self.ramp, 0.0), 1.0)


def _support(section: Section) -> Support:
    given = section.arguments()
    moved = {
        name: {axis: Constant(rate) for axis, rate in given.get(name, ())}
        for name in ("velocity", "spin")
    }
    return Support(**given | moved)


def _load(doc: str, constructor: Constructor, name: str, sign: str) -> Kind:
    ramp = own_key(FORMS["number"], "time over which it rises from zero", 0.0, unit="s", least=0)
    keys = keys_of(constructor) | {"ramp": ramp}

    def make(section: Section) -> Any:
        return section.called(factor=Rising(section.ramp) if section.ramp else steady)

    return Kind(doc, keys, constructor, name=name, sign=sign, make=make)


SUPPORT = Kind(
    "Hold or move nodes, any number of [[supports]].",
    keys_of(Support, defaults={"velocity": None, "spin": None}),
    Support,
    make=_support,
)
LOADS = (
    _load("A body force.", Gravity, "gravity", "acceleration"),
    _load("A pressure along the directors.", Pressure, "pressure", "value"),
    _load("A force on every node of a set.", NodalForce, "force", "force"),
    _load("A moment on the director of every node of a set.", NodalMoment, "moment", "moment"),
    _load(
        "A force per length on the boundary edges between nodes of a set.",
        EdgeTraction,
        "traction",
        "traction",
    ),
)

"""Sections of the trouser test: they have its own defaults, and no tool."""

from __future__ import annotations

from typing import Any

from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.fracture.options import Fracture
from shellcut.material.shell_material import ShellMaterial
from shellcut.models import trouser
from shellcut.models.trouser import CHECK_EVERY, LAW, MASS_DAMPING, THICKNESS, trouser_strip

from .key import Key, Section, default_of, key, number, section, whole
from .material_sections import Homogeneous
from .run_sections import Cohesive, Damping


def again(of: type[Section], name: str, default: Any) -> Any:
    """Return a key of a section with another default."""
    known: Key = of.keys()[name]
    return key(known.kind, known.doc, default=default)


@section("membrane", kind="strip", sign="length", of=trouser_strip)
class TrouserStrip(Section):
    """A strip from x = 0, where it is notched and pulled; its other end is clamped."""

    length: float = key(number("mm"), "along the tear", default=default_of(trouser, "length"))
    width: float = key(number("mm"), "of both legs together", default=default_of(trouser, "width"))
    notch: float = key(
        number("mm"), "length of the cut between the legs", default=default_of(trouser, "notch")
    )
    size: float = key(number("mm"), "edge length of the quads", default=default_of(trouser, "size"))


@section("material", of=ShellMaterial.homogeneous)
class TornFilm(Homogeneous):
    """A single layer."""

    thickness: float = again(Homogeneous, "thickness", THICKNESS)


@section("cohesive", of=CohesiveLaw)
class TornLaw(Cohesive):
    """Cable stress as a function of cable length."""

    strength: float = again(Cohesive, "strength", LAW.strength)
    plateau: float = again(Cohesive, "plateau", LAW.plateau)
    opening_a: float = again(Cohesive, "opening_a", LAW.opening_a)
    opening_p: float = again(Cohesive, "opening_p", LAW.opening_p)
    opening_u: float = again(Cohesive, "opening_u", LAW.opening_u)
    onset: float = again(Cohesive, "onset", LAW.onset)


@section("motion", kind="straight")
class LegWay(Section):
    """Ends of the legs, one up and one down."""

    speed: float = key(
        number("mm/s", above=0.0), "of each end", default=default_of(trouser, "speed")
    )
    ramp: float = key(
        number("s", least=0.0), "time over which it rises", default=default_of(trouser, "ramp")
    )
    travel: float | None = key(
        number("mm", above=0.0),
        "way of each end",
        default=default_of(trouser, "travel"),
        unset="length less 2/3 of the width",
    )


@section("fracture")
class TornFracture(Section):
    """The crack goes through the quads; nothing steers it."""

    check_every: int = key(whole, "steps between two checks", default=CHECK_EVERY)

    largest_speed: float | None = key(
        number("mm/s"),
        "of the crack",
        default=None,
        unset="one quad in check_every steps",
    )

    def made(self) -> Fracture:
        """Return the modes."""
        return Fracture(path="free", check_every=self.check_every, largest_speed=self.largest_speed)


@section("damping")
class TornDamping(Damping):
    """Rayleigh damping."""

    alpha: float = again(Damping, "alpha", MASS_DAMPING)

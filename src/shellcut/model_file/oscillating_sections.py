"""Sections of the oscillating cut: they have its own defaults."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, get_args

from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.contact.settings import Contact
from shellcut.fracture.options import CablePlaces, Fracture
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh
from shellcut.models import oscillating
from shellcut.models.oscillating import (
    CABLE_PLACES,
    CHECK_EVERY,
    DENSITY,
    LAW,
    PENALTY,
    POISSON,
    STIFFNESS_DAMPING,
    THICKNESS,
    YOUNG,
    bar_before,
    film_before,
)

from .key import Section, choice, default_of, key, number, section, whole
from .material_sections import Homogeneous
from .run_sections import Cohesive, ContactSection, Damping
from .trouser_sections import TornFracture, again

_NOTCH = "length of the cut in which the bar starts"
_OFFSET = "distance of that cut from the bar's line"


@section("membrane", kind="strip", sign="size")
class BandedStrip(Section):
    """A strip from x = 0 with its long sides clamped, fine about its middle line."""

    size: float = key(
        number("mm"), "edge length of the fine quads", default=default_of(oscillating, "size")
    )
    length: float | None = key(
        number("mm"), "along the cut", default=None, unset="125/6 diameters of the bar"
    )
    width: float | None = key(
        number("mm"), "between the clamped sides", default=None, unset="6 diameters"
    )
    band: float | None = key(
        number("mm"), "half the breadth of the fine quads", default=None, unset="1.2 diameters"
    )
    notch: float | None = key(number("mm"), _NOTCH, default=None, unset="1.5 diameters")
    offset: float | None = key(number("mm"), _OFFSET, default=None, unset="0.35 diameters")

    def before(self, diameter: float) -> Mesh:
        """Return the film for a bar of some diameter [mm]."""
        return film_before(
            diameter, size=self.size, length=self.length, width=self.width, band=self.band
        )


@section("material", of=ShellMaterial.homogeneous)
class BrittleFilm(Homogeneous):
    """A single layer."""

    young: float = again(Homogeneous, "young", YOUNG)
    poisson: float = again(Homogeneous, "poisson", POISSON)
    density: float = again(Homogeneous, "density", DENSITY)
    thickness: float = again(Homogeneous, "thickness", THICKNESS)


@section("cohesive", of=CohesiveLaw)
class BrittleLaw(Cohesive):
    """Cable stress as a function of cable length."""

    strength: float = again(Cohesive, "strength", LAW.strength)
    plateau: float = again(Cohesive, "plateau", LAW.plateau)
    opening_a: float = again(Cohesive, "opening_a", LAW.opening_a)
    opening_p: float = again(Cohesive, "opening_p", LAW.opening_p)
    opening_u: float = again(Cohesive, "opening_u", LAW.opening_u)
    onset: float = again(Cohesive, "onset", LAW.onset)


@section("tool", kind="bar", sign="diameter")
class Bar(Section):
    """A round bar without cutting edges, as long as 8 of its diameters."""

    diameter: float = key(
        number("mm", above=0.0), "of the bar", default=default_of(oscillating, "diameter")
    )
    tilt_deg: float = key(
        number("deg"),
        "of its axis from the vertical; its top leans forward",
        default=default_of(oscillating, "tilt_deg"),
    )

    def made(self) -> Any:
        """Return the bar, just before the film."""
        return bar_before(self.diameter, self.tilt_deg)


@section("motion", kind="straight")
class BarWay(Section):
    """Along the strip, with a ramp over the first ms."""

    speed: float = key(
        number("mm/s", above=0.0), "after the ramp", default=default_of(oscillating, "speed")
    )
    travel: float | None = key(
        number("mm", above=0.0),
        "travel of the bar",
        default=default_of(oscillating, "travel"),
        unset="up to 2 diameters before the end of the strip",
    )


@section("contact", of=Contact)
class SoftContact(ContactSection):
    """Penalty contact with the tool, and of the film with itself."""

    penalty: float = again(ContactSection, "penalty", PENALTY)


@section("fracture")
class FreeFracture(TornFracture):
    """The crack goes through the quads; nothing steers it."""

    check_every: int = key(whole, "steps between two checks", default=CHECK_EVERY)
    cable_places: CablePlaces = key(
        choice(*get_args(CablePlaces)),
        "cables across a segment of the crack, at its ends or its Gauss points",
        default=CABLE_PLACES,
    )

    def made(self) -> Fracture:
        """Return the modes."""
        return replace(super().made(), cable_places=self.cable_places)


@section("damping")
class LittleDamping(Damping):
    """Rayleigh damping."""

    beta: float = again(Damping, "beta", STIFFNESS_DAMPING)

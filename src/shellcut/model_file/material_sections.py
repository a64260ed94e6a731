"""Sections of the film's material: ``[material]`` and ``[[material.layers]]``."""

from __future__ import annotations

from typing import Any

from shellcut.material.elastic import Elastic
from shellcut.material.shell_material import Layer, ShellMaterial

from .key import Section, choice, file, key, number, numbers, section, tables, whole
from .material_of_keys import made_with, material_of
from .presets import preset_names

_PRESET = "published numbers by name, for keys that are not given; docs/materials.md"


@section("material.layers", of=Elastic)
class Ply(Section):
    """One layer, listed from the bottom to the top."""

    preset: str | None = key(
        choice(*preset_names(layers=False)), _PRESET, default=None, unset="none"
    )
    young: float = key(number("MPa"), "Young's modulus")
    poisson: float = key(number(), "Poisson's ratio")
    density: float = key(number("t/mm^3"), "reference density; 1 g/cm^3 is 1e-9 t/mm^3")
    thickness: float = key(number("mm"), "of the layer")
    law: str | None = key(
        choice("elastic", "hencky", "plastic"),
        "elastic: St.Venant-Kirchhoff; hencky: elastic by logarithmic strain; plastic: it yields",
        default=None,
        unset="elastic; plastic with a yield stress",
    )
    young_across: float | None = key(
        number("MPa"),
        "modulus across the film's direction; young, poisson are then along it",
        default=None,
        unset="isotropic",
    )
    shear: float | None = key(
        number("MPa"), "shear modulus in the plane", default=None, unset="isotropic"
    )
    shear_through: float | None = key(
        number("MPa"), "G_13, transverse shear along young", default=None, unset="shear"
    )
    shear_through_across: float | None = key(
        number("MPa"), "G_23, along young_across", default=None, unset="shear_through"
    )
    yield_stress: float | None = key(
        number("MPa"), "at which it yields, true", default=None, unset="from another hardening"
    )
    hardening_modulus: float | None = key(
        number("MPa"), "rise of the yield stress over plastic strain", default=None, unset="0"
    )
    saturation_gain: float | None = key(
        number("MPa"), "Voce: further rise, which saturates", default=None, unset="none"
    )
    saturation_strain: float | None = key(
        number(), "Voce: strain at 63 % of the gain", default=None, unset="no gain"
    )
    swift_strength: float | None = key(
        number("MPa"),
        "K of the yield stress K (start + p)^exponent",
        default=None,
        unset="no Swift",
    )
    swift_start: float | None = key(number(), "of Swift's law", default=None, unset="no Swift")
    swift_exponent: float | None = key(
        number(), "of Swift's law, 0 to 1", default=None, unset="no Swift"
    )
    hardening_strain: tuple[float, ...] | None = key(
        numbers(), "plastic strains, true, from 0", default=None, unset="no table"
    )
    hardening_stress: tuple[float, ...] | None = key(
        numbers("MPa"), "true yield stresses at these", default=None, unset="no table"
    )
    hardening_file: str | None = key(
        file,
        "table of plastic strain and true stress, as shellcut tensile writes it",
        default=None,
        unset="no table",
    )
    r_values: tuple[float, ...] | None = key(
        numbers(count=3), "Hill's r at 0, 45 and 90 deg", default=None, unset="von Mises"
    )
    kinematic_modulus: float | None = key(
        number("MPa"), "linear kinematic hardening", default=None, unset="0"
    )
    cowper_symonds_rate: float | None = key(
        number("1/s"), "rate that doubles the yield stress", default=None, unset="no effect"
    )
    cowper_symonds_exponent: float | None = key(
        number(), "q, 1 or more", default=None, unset="no effect"
    )
    johnson_cook_rate: float | None = key(
        number("1/s"), "rate of the tests", default=None, unset="no effect"
    )
    johnson_cook_factor: float | None = key(
        number(), "C of 1 + C ln(rate / rate of the tests)", default=None, unset="no effect"
    )
    angle_deg: float = key(
        number("deg"), "of the layer's axes against the film's direction", default=0.0
    )

    def made(self) -> Any:
        """Return the layer."""
        return Layer(material_of(self), self.thickness)


@section("material", of=ShellMaterial)
class Film(Section):
    """What films of one layer and of several have."""

    machine_direction: tuple[float, ...] = key(
        numbers(count=3),
        "the film's direction, in the plane",
        default=(1.0, 0.0, 0.0),
        parameter="direction",
    )
    shear_factor: float | None = key(
        number(),
        "on the transverse shear moduli of every layer",
        unset="what follows from the layers, 5/6 of one",
    )
    points_per_layer: int | None = key(
        whole,
        "points through the thickness of each layer, 1 to 9",
        unset="once before the run; 5 for a law that is not linear",
    )

    def film(self, layers: list[Layer]) -> ShellMaterial:
        """Return the layers as a film."""
        film: ShellMaterial = made_with(
            ShellMaterial,
            {"direction": "machine_direction"},
            layers=layers,
            shear_factor=self.shear_factor,
            points_per_layer=self.points_per_layer,
            direction=self.machine_direction,
        )
        return film


@section("material", of=ShellMaterial.homogeneous)
class Homogeneous(Film, Ply):
    """A single layer."""

    preset: str | None = key(choice(*preset_names()), _PRESET, default=None, unset="none")
    young: float = key(Ply.keys()["young"].kind, Ply.keys()["young"].doc)
    poisson: float = key(number(), Ply.keys()["poisson"].doc)
    density: float = key(Ply.keys()["density"].kind, Ply.keys()["density"].doc)
    thickness: float = key(number("mm"), "of the film")
    angle_deg: float = key(
        number("deg"), "of the material's axes against machine_direction", default=0.0
    )

    def made(self) -> ShellMaterial:
        """Return the layer as a film."""
        return self.film([super().made()])


@section("material", sign="layers", of=ShellMaterial)
class Laminate(Film):
    """Layers through the thickness."""

    preset: str | None = key(
        choice(*preset_names(layers=True)), _PRESET, default=None, unset="none"
    )
    layers: tuple[Ply, ...] = key(tables(Ply), "from the bottom to the top")

    def made(self) -> ShellMaterial:
        """Return the layers as a film."""
        return self.film([ply.made() for ply in self.layers])

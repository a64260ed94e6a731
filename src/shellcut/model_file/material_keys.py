"""``[material]`` and ``[[material.layers]]``: the keys of a layer, and the material that they make.

Hardening and rate factor are tables in them, ``[material.hardening]`` and ``[material.rate]``.

``preset = "pet"`` gives every key that the section does not give itself, also of a hardening of the
same kind; one of another kind takes its place. ``material = "pet"`` before the first section, and
``--set material=pet``, stand for a section with this key alone.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from importlib.resources import files
from inspect import signature
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from shellcut.arguments import ArgumentError, Option, checked, declared
from shellcut.arrays import Floats
from shellcut.formats.errors import naming
from shellcut.formats.number_table import NumberTable, read_number_table
from shellcut.material.elastic import Elastic
from shellcut.material.hardening import Linear, Swift, Table, Voce, fewer_points
from shellcut.material.hencky import Hencky
from shellcut.material.material import Material
from shellcut.material.orthotropic import Orthotropic
from shellcut.material.plastic import Plastic
from shellcut.material.rate_factor import CowperSymonds, JohnsonCook
from shellcut.material.shell_material import Layer, ShellMaterial
from shellcut.unit import conversion

from .key import (
    FORMS,
    Constructor,
    Key,
    Kind,
    Section,
    choice,
    keys_of,
    kind_of,
    optional,
    own_key,
    table_key,
)
from .source import Source, loaded


@functools.cache
def presets() -> dict[str, dict[str, Any]]:
    """Return the tables of ``presets.toml``: of each film its ``material``, the keys, and sources.

    Examples
    --------
    >>> sorted(presets())
    ['aluminium_foil', 'aluminium_sheet', 'foil_ldpe', 'frangi2010', 'ldpe', 'mild_steel', 'pet']
    """
    text = (files("shellcut.model_file") / "presets.toml").read_text(encoding="utf-8")
    return loaded(text)


def preset_names(*, layers: bool | None = None) -> tuple[str, ...]:
    """Return the names; of laminates, or of single layers, only if asked for."""
    every = presets().items()
    return tuple(name for name, preset in every if layers in (None, "layers" in preset["material"]))


@checked
def read_hardening(
    file: Annotated[str | Path, Option("", "table of plastic strain and true stress", form="path")],
) -> Table:
    """Return the hardening in a text file.

    ::

        plastic strain [-],true stress [MPa]
        0,20.1
        0.01,22.4

    Columns are known by the words strain and stress in their headings; without headings the first
    two are taken. Of more than 24 points those are left that keep the shape. FileError if columns
    or units are not known, or the values are no hardening curve.
    """
    table = read_number_table(file)
    columns = [(0, 1.0), (1, 1.0)]
    if table.headings:
        with naming(file):
            columns = [_column(table, "strain", "-"), _column(table, "stress", "MPa")]
    (strain_at, of_strain), (stress_at, of_stress) = columns
    rows = table.numbers([strain_at, stress_at])
    strain: Floats = rows[:, 0] * of_strain
    stress: Floats = rows[:, 1] * of_stress
    if len(rows) > 2 and not (np.diff(strain) <= 0.0).any():
        strain, stress = fewer_points(strain, stress)
    with naming(file):
        return Table(strain, stress)


def _column(table: NumberTable, word: str, usual: str) -> tuple[int, float]:
    """Return the column whose heading has a word, and the factor of its unit."""
    found = [k for k, heading in enumerate(table.headings) if word in heading.name.lower()]
    if len(found) != 1:
        raise ValueError(
            f"one heading must name the {word}, as 'plastic strain [-]' and 'true stress [MPa]', "
            f"got {', '.join(repr(heading.text) for heading in table.headings)}"
        )
    heading = table.headings[found[0]]
    if _OTHER.search(heading.name):
        raise ValueError(
            "a hardening table must have plastic strains and true stresses, got "
            f"{heading.text!r}; shellcut tensile makes a section from a nominal curve"
        )
    try:
        return found[0], conversion(heading.unit or usual, usual)
    except ValueError as problem:
        raise ValueError(f"{word} {problem}") from None


_OTHER = re.compile(r"nominal|\beng|total|technisch", re.I)


# --- the keys of a layer --------------------------------------------------------------------------


def _preset(*, layers: bool | None = None) -> dict[str, Key]:
    text = "published numbers by name, for keys that are not given; docs/materials.md"
    return {"preset": own_key(choice(*preset_names(layers=layers)), text, None, unset="none")}


def _made_by(owner: Constructor, name: str, sign: str, doc: str, *only: str) -> Kind:
    return Kind(doc, keys_of(owner, *only), owner, name, sign, filled=True)


HARDENINGS = (
    _made_by(Voce, "voce", "gain", "The yield stress saturates; a linear rise can be added."),
    _made_by(Linear, "linear", "yield_stress", "The yield stress rises linearly, or is constant."),
    _made_by(Swift, "swift", "exponent", "A power of the plastic strain."),
    _made_by(
        Table, "table", "plastic_strain", "Linear between points.", "plastic_strain", "stress"
    ),
    _made_by(read_hardening, "file", "file", "Linear between the points of a file."),
)
"""Kinds of ``[material.hardening]``; a key is recognised as of the first that it identifies."""
RATES = (
    _made_by(CowperSymonds, "cowper_symonds", "exponent", "A power of the strain rate."),
    _made_by(JohnsonCook, "johnson_cook", "factor", "The logarithm of the strain rate."),
)
"""Kinds of ``[material.rate]``."""
_NO_AXES = "isotropic"
_LAYER = {
    **keys_of(Elastic, "young"),
    **keys_of(Orthotropic, "poisson"),
    **keys_of(Elastic, "density"),
    **keys_of(Layer),
    "law": own_key(
        choice("elastic", "hencky", "plastic"),
        "elastic: St.Venant-Kirchhoff; hencky: elastic by logarithmic strain; plastic: it yields",
        None,
        unset="elastic; plastic with a hardening",
    ),
    "young_across": optional(keys_of(Orthotropic)["young_across"], _NO_AXES),
    "shear": optional(keys_of(Orthotropic)["shear"], _NO_AXES),
    **keys_of(Orthotropic, "shear_through", "shear_through_across"),
    "hardening": table_key("yield stress over plastic strain", HARDENINGS, "no yielding"),
    "rate": table_key("factor on the yield stress over strain rate", RATES, "no effect"),
    **keys_of(Plastic, "r_values"),
    **keys_of(Orthotropic, "angle_deg"),
}
"""Keys of a layer. Of those of an orthotropic one, ``young`` is its ``young_along``."""
_OF_YIELDING = "hardening", "rate", "r_values"
_FILM = {
    "machine_direction": own_key(
        FORMS["3 numbers"], "the film's direction, in the plane", (1.0, 0.0, 0.0)
    ),
    **keys_of(ShellMaterial),
}


def _layer(keys: Section) -> Layer:
    """Return a layer; ArgumentError if its keys cannot go together."""
    law = keys.law or ("elastic" if keys.hardening is None else "plastic")
    problems = list(_contradictions(keys, law))
    moduli: Elastic | Orthotropic
    try:
        if keys.young_across is None or keys.shear is None:
            moduli = Elastic(keys.young, keys.poisson, keys.density)
        else:
            shared = [name for name in declared(Orthotropic) if name in keys.values]
            moduli = Orthotropic(keys.young, **{name: getattr(keys, name) for name in shared})
    except ValueError as problem:
        problems.append(str(problem).replace("young_along", "young"))  # one key for both classes
    if problems:
        raise ArgumentError(problems)
    film: Material = moduli
    if law == "hencky":
        film = Hencky(moduli)
    elif law == "plastic":
        film = Plastic(
            moduli,
            keys.hardening.made(),
            r_values=keys.r_values,
            rate=keys.rate and keys.rate.made(),
            angle_deg=keys.angle_deg,
        )
    return Layer(film, keys.thickness)


def _film(keys: Section) -> ShellMaterial:
    layers = [ply.made() for ply in keys.layers] if "layers" in keys.values else [_layer(keys)]
    if not any(keys.machine_direction):  # ShellMaterial would speak of functions, too
        raise ValueError("machine_direction must be a vector that is not zero")
    rest = {name: getattr(keys, name) for name in declared(ShellMaterial)}
    return ShellMaterial(layers, direction=keys.machine_direction, **rest)


PLY = Kind(
    "One layer, listed from the bottom to the top.",
    {**_preset(layers=False), **_LAYER},
    Elastic,
    make=_layer,
)
_PAPER = signature(ShellMaterial.homogeneous).parameters
HOMOGENEOUS = Kind(
    "A single layer.", {**_preset(), **_LAYER, **_FILM}, ShellMaterial.homogeneous, make=_film
).with_keys(**{name: parameter.default for name, parameter in _PAPER.items() if name in _LAYER})
LAMINATE = Kind(
    "Layers through the thickness.",
    {
        **_FILM,
        **_preset(layers=True),
        "layers": replace(own_key(FORMS["tables"], "from the bottom to the top"), kinds=(PLY,)),
    },
    ShellMaterial,
    sign="layers",
    make=_film,
)


def _contradictions(keys: Section, law: str) -> Iterator[str]:
    if law != "plastic":
        for name in _OF_YIELDING:
            if getattr(keys, name) is not None:
                why = f'got law = "{law}"' if keys.law else "got no hardening: give one"
                yield f'{name} belongs to law = "plastic", {why}'
    elif keys.hardening is None:
        kinds = ", ".join(f'"{kind.name}"' for kind in HARDENINGS)
        yield f'law = "plastic" needs a hardening: a table [material.hardening] with kind = {kinds}'
    if (keys.young_across is None) != (keys.shear is None):
        there, missing = "shear", "young_across"
        if keys.shear is None:
            there, missing = missing, there
        yield f"{there} needs {missing} too: both make the layer orthotropic"
    for name in ("shear_through", "shear_through_across"):
        if keys.young_across is None and getattr(keys, name) is not None:
            yield f"{name} needs young_across and shear too: an isotropic layer has one modulus"
    if keys.angle_deg and keys.young_across is None and keys.r_values is None:
        yield (
            "angle_deg turns the axes of young_across and r_values, got neither: leave it out, or "
            "give them"
        )


# --- films by name fill in keys -------------------------------------------------------------------


def named_material(source: Source) -> Source:
    """Return the source with a section ``[material]`` for a name in its place."""
    name = source.values.get("material")
    if not isinstance(name, str):
        return source
    lines = dict(source.lines)
    if ("material",) in lines:
        lines["material", "preset"] = lines["material",]
    return replace(source, values={**source.values, "material": {"preset": name}}, lines=lines)


def with_presets(source: Source) -> Source:
    """Return the source with the keys of its presets filled in."""
    table = source.values.get("material")
    if not isinstance(table, dict):
        return source
    return replace(source, values={**source.values, "material": filled_in(table)})


def filled_in(table: dict[str, Any]) -> dict[str, Any]:
    """Return the keys of a material, or of a layer, with those of its preset."""
    preset = presets().get(str(table.get("preset", "")), {}).get("material")
    keys = table
    if preset is not None and not ("layers" in table and "layers" not in preset):
        keys = _of_both(preset, table)
    layers = keys.get("layers")
    if isinstance(layers, list):
        filled = [filled_in(layer) if isinstance(layer, dict) else layer for layer in layers]
        keys = {**keys, "layers": filled}
    return keys


def _of_both(preset: Mapping[str, Any], given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the given keys, and those of a preset that can go with them."""
    both = {**preset, **given}
    for name, kinds in (("hardening", HARDENINGS), ("rate", RATES)):
        of_preset, own = preset.get(name, {}), given.get(name)
        if isinstance(own, dict) and kind_of(kinds, own) is kind_of(kinds, of_preset):
            both[name] = {**of_preset, **own}
        if own is None and given.get("law") in ("elastic", "hencky"):
            both.pop(name, None)
    return both


MOVED = {
    "yield_stress": ("hardening", "linear or voce", "yield_stress"),
    "hardening_modulus": ("hardening", "linear or voce", "modulus"),
    "saturation_gain": ("hardening", "voce", "gain"),
    "saturation_strain": ("hardening", "voce", "strain"),
    "swift_strength": ("hardening", "swift", "strength"),
    "swift_start": ("hardening", "swift", "start"),
    "swift_exponent": ("hardening", "swift", "exponent"),
    "hardening_strain": ("hardening", "table", "plastic_strain"),
    "hardening_stress": ("hardening", "table", "stress"),
    "hardening_file": ("hardening", "file", "file"),
    "cowper_symonds_rate": ("rate", "cowper_symonds", "rate"),
    "cowper_symonds_exponent": ("rate", "cowper_symonds", "exponent"),
    "johnson_cook_rate": ("rate", "johnson_cook", "rate"),
    "johnson_cook_factor": ("rate", "johnson_cook", "factor"),
}
"""Keys of version 0.2.0, each with the table, the kind and the key to write instead."""

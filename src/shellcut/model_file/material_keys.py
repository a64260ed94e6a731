"""``[material]`` and ``[[material.layers]]``: one flat list of keys for several constructors.

A layer's moduli, hardening and rate factor are classes of their own; in a file their arguments
stand side by side. Refusals name keys, not arguments.

``preset = "pet"`` gives every key that the section does not give itself. Keys that cannot go with a
given one, as those of another hardening, are left out. ``material = "pet"`` before the first
section, and ``--set material=pet``, stand for a section with this key alone.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from importlib.resources import files
from inspect import signature
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from shellcut.arguments import Option, checked, declared
from shellcut.arrays import Floats
from shellcut.formats.errors import FileError, naming
from shellcut.formats.number_table import NumberTable, read_number_table
from shellcut.material.elastic import Elastic
from shellcut.material.hardening import Linear, Swift, Table, Voce
from shellcut.material.hardening_points import fewer_points
from shellcut.material.hencky import Hencky
from shellcut.material.material import Material
from shellcut.material.orthotropic import Orthotropic
from shellcut.material.plastic import Plastic
from shellcut.material.rate_factor import CowperSymonds, JohnsonCook, RateFactor
from shellcut.material.shell_material import Layer, ShellMaterial
from shellcut.unit import conversion

from .errors import is_refusal
from .forms import FORMS, choice
from .key import REQUIRED, Constructor, Key, Kind, Section, keys_of, optional, own_key
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
    return tuple(name for name, one in every if layers in (None, "layers" in one["material"]))


@checked
def read_hardening(
    path: Annotated[
        str | Path,
        Option(
            "",
            "table of plastic strain and true stress",
            form="path",
        ),
    ],
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
    table = read_number_table(path)
    (strain_at, strain_unit), (stress_at, stress_unit) = _columns(table, Path(path))
    rows = table.numbers([strain_at, stress_at])
    strain: Floats = rows[:, 0] * strain_unit
    stress: Floats = rows[:, 1] * stress_unit
    if len(rows) > 2 and not (np.diff(strain) <= 0.0).any():
        strain, stress = fewer_points(strain, stress)
    with naming(path):
        return Table(strain, stress)


def _columns(table: NumberTable, path: Path) -> tuple[tuple[int, float], tuple[int, float]]:
    if not table.headings:
        return (0, 1.0), (1, 1.0)
    found = {}
    for word in ("strain", "stress"):
        places = [k for k, one in enumerate(table.headings) if word in one.name.lower()]
        if len(places) != 1:
            raise FileError(
                path,
                f"one heading must name the {word}, as 'plastic strain [-]' and 'true stress "
                f"[MPa]', got {', '.join(repr(one.text) for one in table.headings)}",
            )
        found[word] = places[0]
    if wrong := [h.text for h in table.headings if _OTHER.search(h.name)]:
        raise FileError(
            path,
            f"a hardening table must have plastic strains and true stresses, got {wrong[0]!r}; "
            "shellcut tensile makes a section of a nominal curve",
        )
    factors, problems = [], []
    for word, usual in (("strain", "-"), ("stress", "MPa")):
        try:
            factors.append(conversion(table.headings[found[word]].unit or usual, usual))
        except ValueError as problem:
            problems.append(f"{word} {problem}")
    if problems:
        raise FileError(path, "; ".join(problems))
    return (found["strain"], factors[0]), (found["stress"], factors[1])


def _optional(owner: Constructor, unset: str, **names: str) -> dict[str, Key]:
    """Return keys, by name and parameter, that may be left out together."""
    found = keys_of(owner)
    return {name: optional(found[parameter], unset) for name, parameter in names.items()}


def _preset(*, layers: bool | None = None) -> dict[str, Key]:
    text = "published numbers by name, for keys that are not given; docs/materials.md"
    return {"preset": own_key(choice(*preset_names(layers=layers)), text, None, unset="none")}


_OTHER = re.compile(r"nominal|\beng|total|technisch", re.I)
_LAW = own_key(
    choice("elastic", "hencky", "plastic"),
    "elastic: St.Venant-Kirchhoff; hencky: elastic by logarithmic strain; plastic: it yields",
    None,
    unset="elastic; plastic with a yield stress",
)
_THROUGH = keys_of(Orthotropic, "shear_through", "shear_through_across")
_COWPER_SYMONDS = "rate", "exponent"
_LAYER = {
    **keys_of(Elastic, "young"),
    **keys_of(Orthotropic, "poisson"),
    **keys_of(Elastic, "density"),
    **keys_of(Layer),
    "law": _LAW,
    **_optional(Orthotropic, "isotropic", young_across="young_across", shear="shear"),
    **_THROUGH,
    **_optional(Voce, "from another hardening", yield_stress="yield_stress"),
    **_optional(Voce, "0", hardening_modulus="modulus"),
    **_optional(Voce, "none", saturation_gain="gain"),
    **_optional(Voce, "no gain", saturation_strain="strain"),
    **_optional(Swift, "no Swift", **{f"swift_{name}": name for name in declared(Swift)}),
    **_optional(Table, "no table", hardening_strain="plastic_strain", hardening_stress="stress"),
    **_optional(read_hardening, "no table", hardening_file="path"),
    **keys_of(Plastic, "r_values"),
    **_optional(CowperSymonds, "no effect", **{f"cowper_symonds_{n}": n for n in _COWPER_SYMONDS}),
    **_optional(JohnsonCook, "no effect", johnson_cook_rate="rate", johnson_cook_factor="factor"),
    **keys_of(Orthotropic, "angle_deg"),
}


def _owned(*owners: Constructor) -> tuple[str, ...]:
    return tuple(name for name, key in _LAYER.items() if key.owner in owners)


HARDENINGS = tuple(_owned(law) for law in (Voce, Swift, Table, read_hardening))
"""Keys that go together, one group a material."""
PLASTIC = (*sum(HARDENINGS, ()), *_owned(Plastic, CowperSymonds, JohnsonCook))
"""Keys of a material that yields."""
_FILM = {
    "machine_direction": own_key(
        FORMS["3 numbers"], "the film's direction, in the plane", (1.0, 0.0, 0.0)
    ),
    **keys_of(ShellMaterial),
}


class KeyProblems(ValueError):
    """What is wrong with some keys, a sentence each."""

    def __init__(self, problems: list[str]) -> None:
        self.problems = problems
        super().__init__("; ".join(problems))


def _layer(keys: Section) -> Layer:
    return Layer(material_of(keys), keys.thickness)


def _film(keys: Section) -> ShellMaterial:
    layers = [ply.made() for ply in keys.layers] if "layers" in keys.values else [_layer(keys)]
    film: ShellMaterial = _made_with(
        ShellMaterial,
        {"direction": "machine_direction"},
        layers=layers,
        direction=keys.machine_direction,
        **{name: getattr(keys, name) for name in declared(ShellMaterial)},
    )
    return film


PLY = Kind(
    "One layer, listed from the bottom to the top.",
    {**_preset(layers=False), **_LAYER},
    Elastic,
    make=_layer,
)
_PAPER = signature(ShellMaterial.homogeneous).parameters
HOMOGENEOUS = Kind(
    "A single layer.", {**_preset(), **_LAYER, **_FILM}, ShellMaterial.homogeneous, make=_film
).with_keys(**{name: one.default for name, one in _PAPER.items() if name in _LAYER})
LAMINATE = Kind(
    "Layers through the thickness.",
    {
        **_FILM,
        **_preset(layers=True),
        "layers": replace(own_key(FORMS["tables"], "from the bottom to the top"), tables=PLY),
    },
    ShellMaterial,
    sign="layers",
    make=_film,
)


def material_of(keys: Section) -> Material:
    """Return the material that a layer's keys describe; KeyProblems if they cannot go together."""
    given = {name for name in PLASTIC if getattr(keys, name) is not None}
    hardened = [group for group in HARDENINGS if given & set(group)]
    law = keys.law or ("plastic" if hardened else "elastic")
    problems = list(_contradictions(keys, law, given, hardened))
    across = keys.young_across is not None and keys.shear is not None
    moduli = _tried(problems, lambda: _moduli(keys, Orthotropic if across else Elastic))
    if law != "plastic":
        if problems:
            raise KeyProblems(problems)
        return Hencky(moduli) if law == "hencky" else moduli
    hardening = None
    if len(hardened) == 1:
        hardening = _tried(problems, lambda: _hardening(keys, hardened[0]))
    rate = _tried(problems, lambda: _rate(keys))
    made = _tried(
        problems,
        lambda: Plastic(
            moduli or Elastic(1.0, 0.3, 1e-9),  # already refused, see the other keys
            hardening or Linear(1.0),
            r_values=keys.r_values,
            rate=rate,
            angle_deg=keys.angle_deg,
        ),
    )
    if problems:
        raise KeyProblems(problems)
    assert isinstance(made, Plastic)
    return made


def _contradictions(
    keys: Section, law: str, given: set[str], hardened: list[tuple[str, ...]]
) -> Iterator[str]:
    if law != "plastic":
        for name in PLASTIC:
            if name in given:
                yield f'{name} belongs to law = "plastic", got law = "{law}"'
    elif not hardened:
        yield (
            'law = "plastic" needs a hardening: yield_stress, or swift_strength, swift_start and '
            "swift_exponent, or hardening_strain and hardening_stress, or hardening_file"
        )
    elif len(hardened) > 1:
        several = [", ".join(n for n in group if n in given) for group in hardened]
        yield f"{several[0]} must be the only hardening, got {' and '.join(several[1:])} too"
    if (keys.young_across is None) != (keys.shear is None):
        there, missing = "shear", "young_across"
        if keys.shear is None:
            there, missing = missing, there
        yield f"{there} needs {missing} too: both make the layer orthotropic"
    for name in _THROUGH:
        if keys.young_across is None and getattr(keys, name) is not None:
            yield f"{name} needs young_across and shear too: an isotropic layer has one modulus"
    if keys.angle_deg and keys.young_across is None and keys.r_values is None:
        yield (
            "angle_deg turns the axes of young_across and r_values, got neither: leave it out, or "
            "give them"
        )


def _moduli(keys: Section, law: Constructor) -> Elastic | Orthotropic:
    names = {"young_along" if law is Orthotropic else "young": "young"}
    shared = [name for name in declared(law) if name in keys.values and name not in names]
    values = {name: getattr(keys, name) for name in shared}
    values |= dict.fromkeys(names, keys.young)
    made: Elastic | Orthotropic = _made_with(law, names, **values)
    return made


def _hardening(keys: Section, group: tuple[str, ...]) -> Table:
    law = keys.of.keys[group[0]].owner
    if law is Voce and keys.saturation_gain is None and keys.saturation_strain is None:
        law, group = Linear, group[:2]
    made: Table = _made_of(keys, law, group)
    return made


def _rate(keys: Section) -> RateFactor | None:
    groups = [_owned(law) for law in (CowperSymonds, JohnsonCook)]
    given = [group for group in groups if any(getattr(keys, name) is not None for name in group)]
    if len(given) > 1:
        raise ValueError("cowper_symonds_rate and johnson_cook_rate must not both be given")
    made: RateFactor | None = None
    if given:
        made = _made_of(keys, _LAYER[given[0][0]].owner, given[0])
    return made


def _made_of(keys: Section, law: Constructor | None, group: tuple[str, ...]) -> Any:
    """Call a constructor with the values of its keys, all of which it may need."""
    assert law is not None
    parameters = {keys.of.keys[name].parameter: name for name in group}
    needed = [n for p, n in parameters.items() if declared(law)[p].default is REQUIRED]
    missing = [name for name in needed if getattr(keys, name) is None]
    there = [name for name in needed if name not in missing]
    if missing:
        beside = f", with {there[0]}" if there else ""
        raise ValueError(f"{', '.join(missing)} must be given too{beside}")
    values = {p: getattr(keys, name) for p, name in parameters.items()}
    try:
        return _made_with(law, parameters, **{p: v for p, v in values.items() if v is not None})
    except FileError as problem:
        raise ValueError(f"{group[0]}: {problem}") from None


def _made_with(constructor: Callable[..., Any], names: Mapping[str, str], **values: Any) -> Any:
    """Call a constructor; a refusal names the keys instead of the parameters."""
    try:
        return constructor(**values)
    except FileError:
        raise
    except ValueError as problem:
        if not is_refusal(problem):
            raise
        said = []
        for sentence in str(problem).split("; "):
            words = "|".join(re.escape(name) for name in names)
            said.append(re.sub(rf"\b({words})\b", lambda found: names[found[1]], sentence, count=1))
        raise KeyProblems(said) from None


def _tried(problems: list[str], make: Callable[[], Any]) -> Any:
    try:
        return make()
    except KeyProblems as problem:
        problems += problem.problems
    except ValueError as problem:
        if not is_refusal(problem):
            raise
        problems.append(str(problem))
    return None


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
        keys = {**_fitting(preset, table), **table}
    layers = keys.get("layers")
    if isinstance(layers, list):
        filled = [filled_in(one) if isinstance(one, dict) else one for one in layers]
        keys = {**keys, "layers": filled}
    return keys


def _fitting(preset: Mapping[str, Any], given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keys of a preset that can go with the given ones."""
    gone: set[str] = set()
    if given.get("law") in ("elastic", "hencky"):
        gone |= set(PLASTIC)
    for group in HARDENINGS:
        if any(name in given for name in group):
            gone |= {name for other in HARDENINGS if other is not group for name in other}
    return {name: value for name, value in preset.items() if name not in gone}

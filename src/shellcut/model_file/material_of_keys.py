"""The material of a layer from its keys; refusals name keys, not arguments of constructors."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from shellcut.formats.errors import FileError
from shellcut.material.elastic import Elastic
from shellcut.material.hardening import Hardening, Linear, Swift, Table, Voce
from shellcut.material.hencky import Hencky
from shellcut.material.material import Material
from shellcut.material.orthotropic import Orthotropic
from shellcut.material.plastic import Plastic
from shellcut.material.rate_factor import CowperSymonds, JohnsonCook, RateFactor

from .errors import is_refusal
from .hardening_file import read_hardening

VOCE = ("yield_stress", "hardening_modulus", "saturation_gain", "saturation_strain")
SWIFT = ("swift_strength", "swift_start", "swift_exponent")
TABLE = ("hardening_strain", "hardening_stress")
FILE = ("hardening_file",)
HARDENINGS: tuple[tuple[str, ...], ...] = (VOCE, SWIFT, TABLE, FILE)
"""Keys that go together, one group a material."""
PLASTIC = (
    *(name for group in HARDENINGS for name in group),
    "r_values",
    "kinematic_modulus",
    "cowper_symonds_rate",
    "cowper_symonds_exponent",
    "johnson_cook_rate",
    "johnson_cook_factor",
)
"""Keys of a material that yields."""


class KeyProblems(ValueError):
    """What is wrong with some keys, a sentence each."""

    def __init__(self, problems: list[str]) -> None:
        self.problems = problems
        super().__init__("; ".join(problems))


def material_of(keys: Any) -> Material:
    """Return the material that a layer's keys describe.

    Raises
    ------
    KeyProblems
        If keys contradict each other or have impossible values.
    """
    given = {name for name in PLASTIC if getattr(keys, name) is not None}
    hardened = [group for group in HARDENINGS if given & set(group)]
    law = keys.law or ("plastic" if hardened else "elastic")
    problems = list(_contradictions(keys, law, given, hardened))
    moduli = _tried(problems, lambda: _moduli(keys, law))
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
        lambda: made_with(
            Plastic,
            {"kinematic": "kinematic_modulus", "r_values": "r_values", "angle_deg": "angle_deg"},
            elastic=moduli or Elastic(1.0, 0.3, 1e-9),  # already refused, see the other keys
            hardening=hardening or Linear(1.0),
            r_values=keys.r_values,
            kinematic=keys.kinematic_modulus or 0.0,
            rate=rate,
            angle_deg=keys.angle_deg,
        ),
    )
    if problems:
        raise KeyProblems(problems)
    assert isinstance(made, Plastic)
    return made


def _contradictions(
    keys: Any, law: str, given: set[str], hardened: list[tuple[str, ...]]
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
        there, missing = ("shear", "young_across")[:: 1 if keys.shear is not None else -1]
        yield f"{there} needs {missing} too: both make the layer orthotropic"
    for name in ("shear_through", "shear_through_across"):
        if keys.young_across is None and getattr(keys, name) is not None:
            yield f"{name} needs young_across and shear too: an isotropic layer has one modulus"
    oriented = keys.young_across is not None or keys.r_values is not None
    if keys.angle_deg and not oriented:
        yield (
            "angle_deg turns the axes of young_across and r_values, got neither: leave it out, or "
            "give them"
        )


def _moduli(keys: Any, law: str) -> Elastic | Orthotropic:
    if keys.young_across is None or keys.shear is None:
        return Elastic(keys.young, keys.poisson, keys.density)
    found: Orthotropic = made_with(
        Orthotropic,
        {"young_along": "young"},
        young_along=keys.young,
        young_across=keys.young_across,
        poisson=keys.poisson,
        shear=keys.shear,
        density=keys.density,
        angle_deg=keys.angle_deg,
        shear_through=keys.shear_through,
        shear_through_across=keys.shear_through_across,
    )
    return found


def _hardening(keys: Any, group: tuple[str, ...]) -> Hardening:
    made: Hardening
    if group == FILE:
        try:
            return read_hardening(keys.hardening_file)
        except FileError as problem:
            raise ValueError(f"hardening_file: {problem}") from None
    if group == TABLE:
        _all_of(keys, TABLE)
        names = {"plastic_strain": "hardening_strain", "stress": "hardening_stress"}
        made = made_with(
            Table, names, plastic_strain=keys.hardening_strain, stress=keys.hardening_stress
        )
        return made
    if group == SWIFT:
        _all_of(keys, SWIFT)
        names = {name.removeprefix("swift_"): name for name in SWIFT}
        values = {word: getattr(keys, name) for word, name in names.items()}
        made = made_with(Swift, names, **values)
        return made
    _all_of(keys, ("yield_stress",))
    names = {"yield_stress": "yield_stress", "modulus": "hardening_modulus"}
    first = {"yield_stress": keys.yield_stress, "modulus": keys.hardening_modulus or 0.0}
    if keys.saturation_gain is None and keys.saturation_strain is None:
        made = made_with(Linear, names, **first)
        return made
    _all_of(keys, ("saturation_gain", "saturation_strain"))
    made = made_with(
        Voce,
        names | {"gain": "saturation_gain", "strain": "saturation_strain"},
        **first,
        gain=keys.saturation_gain,
        strain=keys.saturation_strain,
    )
    return made


def _rate(keys: Any) -> RateFactor | None:
    cowper = ("cowper_symonds_rate", "cowper_symonds_exponent")
    johnson = ("johnson_cook_rate", "johnson_cook_factor")
    there = [g for g in (cowper, johnson) if any(getattr(keys, name) is not None for name in g)]
    if len(there) > 1:
        raise ValueError("cowper_symonds_rate and johnson_cook_rate must not both be given")
    if not there:
        return None
    _all_of(keys, there[0])
    names = {name.rpartition("_")[2]: name for name in there[0]}
    values = {word: getattr(keys, name) for word, name in names.items()}
    found: RateFactor = made_with(
        CowperSymonds if there[0] is cowper else JohnsonCook, names, **values
    )
    return found


def _all_of(keys: Any, names: tuple[str, ...]) -> None:
    missing = [name for name in names if getattr(keys, name) is None]
    there = [name for name in names if name not in missing]
    if missing:
        beside = f", with {there[0]}" if there else ""
        raise ValueError(f"{', '.join(missing)} must be given too{beside}")


def made_with(constructor: Callable[..., Any], names: Mapping[str, str], **values: Any) -> Any:
    """Call a constructor; a refusal names the keys instead of the parameters."""
    try:
        return constructor(**values)
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

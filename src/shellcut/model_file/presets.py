"""Films by name, from ``presets.toml``: their keys, and how these fill those of a model file.

``[material] preset = "pet"`` gives every key that the section does not give itself; the same holds
in ``[[material.layers]]``. Keys that cannot go with a given one, as those of another hardening,
are left out. ``material = "pet"`` before the first section, and ``--set material=pet``, stand for a
section with this key alone.
"""

from __future__ import annotations

import functools
import sys
from collections.abc import Mapping
from dataclasses import dataclass, replace
from importlib.resources import files
from typing import Any

from .source import Source

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

HARDENINGS: tuple[tuple[str, ...], ...] = (
    ("yield_stress", "hardening_modulus", "saturation_gain", "saturation_strain"),
    ("swift_strength", "swift_start", "swift_exponent"),
    ("hardening_strain", "hardening_stress"),
    ("hardening_file",),
)
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


@dataclass(frozen=True)
class Preset:
    """A film with published numbers.

    Attributes
    ----------
    name, title : str
    fit : str
        Which numbers are fits of ours, and to what.
    sources : tuple of str
        Who measured what, on which film.
    published : mapping
        Figures that the curve of the keys must have, see ``presets.toml``.
    keys : mapping
        Keys of ``[material]``.
    """

    name: str
    title: str
    fit: str
    sources: tuple[str, ...]
    published: Mapping[str, Any]
    keys: Mapping[str, Any]


@functools.cache
def presets() -> dict[str, Preset]:
    """Return all presets by name.

    Examples
    --------
    >>> sorted(presets())
    ['aluminium_foil', 'foil_ldpe', 'frangi2010', 'ldpe', 'pet']
    """
    text = (files("shellcut.model_file") / "presets.toml").read_text(encoding="utf-8")
    return {
        name: Preset(
            name, one["title"], one["fit"], tuple(one["sources"]), one["published"], one["material"]
        )
        for name, one in tomllib.loads(text).items()
    }


def preset_names(*, layers: bool | None = None) -> tuple[str, ...]:
    """Return the names; of laminates, or of single layers, only if asked for."""
    return tuple(n for n, one in presets().items() if layers in (None, "layers" in one.keys))


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
    filled = filled_in(table)
    return replace(source, values={**source.values, "material": filled})


def filled_in(table: dict[str, Any]) -> dict[str, Any]:
    """Return the keys of a material, or of a layer, with those of its preset."""
    preset = presets().get(str(table.get("preset", "")))
    keys = table
    if preset is not None and not ("layers" in table and "layers" not in preset.keys):
        keys = {**_fitting(preset.keys, table), **table}
    layers = keys.get("layers")
    if isinstance(layers, list):
        keys = {
            **keys,
            "layers": [filled_in(one) if isinstance(one, dict) else one for one in layers],
        }
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

"""Keys of a film by name fill in those of a model file.

``[material] preset = "pet"`` gives every key that the section does not give itself; the same holds
in ``[[material.layers]]``. Keys that cannot go with a given one, as those of another hardening,
are left out. ``material = "pet"`` before the first section, and ``--set material=pet``, stand for a
section with this key alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from .material_keys import HARDENINGS, PLASTIC
from .presets import presets
from .source import Source


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

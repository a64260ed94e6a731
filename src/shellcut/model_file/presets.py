"""Films by name, from ``presets.toml``."""

from __future__ import annotations

import functools
import sys
from importlib.resources import files
from typing import Any

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib


@functools.cache
def presets() -> dict[str, dict[str, Any]]:
    """Return the tables of ``presets.toml``: of each film its ``material``, the keys, and sources.

    Examples
    --------
    >>> sorted(presets())
    ['aluminium_foil', 'aluminium_sheet', 'foil_ldpe', 'frangi2010', 'ldpe', 'mild_steel', 'pet']
    """
    text = (files("shellcut.model_file") / "presets.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)


def preset_names(*, layers: bool | None = None) -> tuple[str, ...]:
    """Return the names; of laminates, or of single layers, only if asked for."""
    every = presets().items()
    return tuple(name for name, one in every if layers in (None, "layers" in one["material"]))

"""Films by name, from ``presets.toml``."""

from __future__ import annotations

import functools
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files
from typing import Any

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib


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

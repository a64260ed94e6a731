"""A JSON Schema of model files, for editors and validators."""

from __future__ import annotations

from typing import Any

from .key import REQUIRED, Key, Kind
from .presets import preset_names
from .section_table import HEAD, LISTS, SECTIONS, Kinds

_BOUNDS = {
    "above": "exclusiveMinimum",
    "least": "minimum",
    "below": "exclusiveMaximum",
    "most": "maximum",
}


def schema() -> dict[str, Any]:
    """Return the schema of draft 7.

    Whether values fit together only :func:`.read_model` knows, and whether files are there.

    Examples
    --------
    >>> opening = schema()["allOf"][0]["then"]["properties"]
    >>> opening["tool"]["anyOf"][0]["properties"]["radius"]["description"]
    '[mm] of the cutting circle'
    """
    return {
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "Model file of shellcut",
        "type": "object",
        "required": ["model"],
        "properties": {"model": _key(HEAD.keys["model"])},
        "allOf": [
            {"if": {"properties": {"model": {"const": model}}}, "then": _model(model)}
            for model in SECTIONS
        ],
    }


def _model(model: str) -> dict[str, Any]:
    found = _section((HEAD,))
    sections = {title: _section(kinds) for title, kinds in SECTIONS[model].items()}
    sections["material"]["anyOf"].append({"enum": list(preset_names())})
    several = {
        title: {"type": "array", "items": _section(kinds)} for title, kinds in LISTS[model].items()
    }
    found["properties"] |= {**sections, **several, "files": {"type": "object"}}
    return found


def _section(kinds: Kinds) -> dict[str, Any]:
    return _kind(kinds[0]) if len(kinds) == 1 else {"anyOf": [_kind(kind) for kind in kinds]}


def _kind(kind: Kind) -> dict[str, Any]:
    keys: dict[str, Any] = {"kind": {"const": kind.name}} if kind.name else {}
    for name, key in kind.keys.items():
        keys |= {one: _key(key) for one in (name, key.also) if one}
    # What a preset fills in, or a second name gives, need not be there.
    free = "preset" in kind.keys
    must = [n for n, k in kind.keys.items() if k.default is REQUIRED and not (free or k.also)]
    return {
        "type": "object",
        "description": kind.doc,
        "properties": keys,
        "required": must,
        "additionalProperties": False,
    }


def _key(key: Key) -> dict[str, Any]:
    option, found = key.option, dict(key.form.schema)
    if found.get("type") == "number":
        found["type"] = ["number", "string"]  # a text with a unit
    if key.tables is not None:
        found["items"] = _kind(key.tables)
    bounds = {word: getattr(option, name) for name, word in _BOUNDS.items()}
    unit = f"[{option.unit}] " if option.unit else ""
    default = {} if key.default in (REQUIRED, None) else {"default": key.default}
    told = {"description": f"{unit}{option.text}", **default}
    return found | {word: value for word, value in bounds.items() if value is not None} | told

"""A JSON Schema of model files, for editors and validators."""

from __future__ import annotations

from typing import Any

from .key import NUMBER, REQUIRED, Key, Kind
from .key_index import tables
from .material_keys import preset_names
from .quantity import pattern
from .section_table import ENTRY, HEAD, LISTS, SECTIONS, Kinds

DRAFT = "http://json-schema.org/draft-07/schema#"

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
    >>> opening["tool"]["then"]["properties"]["radius"]["description"]
    '[mm] radius of the cutting circle'
    """
    return {
        "$schema": DRAFT,
        "title": "Model file of shellcut",
        "type": "object",
        "required": ["model"],
        "properties": {"model": _key(HEAD.keys["model"])},
        "allOf": [
            {"if": {"properties": {"model": {"const": model}}}, "then": _model(model)}
            for model in SECTIONS
        ],
        "definitions": quantities(),
    }


def quantities() -> dict[str, Any]:
    """Return the definitions to which the schemas of keys refer: numbers, or texts with a unit."""
    units = {key.option.unit for table in tables() for key in table.keys.values()}
    return {
        _name(unit): {"type": ["number", "string"], "pattern": pattern(unit)}
        for unit in sorted(units)
    }


def settings() -> dict[str, Any]:
    """Return the schema of each key that a study may set, by section and key and by key alone.

    The place in an array of tables is :data:`.section_table.ENTRY`.
    """
    found: dict[str, list[Any]] = {"material": [{"enum": list(preset_names())}]}
    meanings: dict[str, str] = {}
    for table in tables():
        is_alone = ENTRY not in table.path.split(".")
        kind = {"kind": {"const": table.kind.name}} if table.kind.name else {}
        for name, of in (kind | _properties(table.kind)).items():
            # Kinds and models may give a key other defaults and meanings.
            bare = {word: v for word, v in of.items() if word not in ("default", "description")}
            for key in {name if is_alone else "", f"{table.path}.{name}".lstrip(".")} - {""}:
                meanings.setdefault(key, of.get("description", ""))
                if bare not in found.setdefault(key, []):
                    found[key].append(bare)
    return {
        key: {"description": meanings.get(key, ""), **(of[0] if len(of) == 1 else {"anyOf": of})}
        for key, of in sorted(found.items())
    }


def _model(model: str) -> dict[str, Any]:
    found = _section((HEAD,))
    sections = {title: _section(kinds) for title, kinds in SECTIONS[model].items()}
    film = sections["material"]
    named = {"enum": list(preset_names())}
    sections["material"] = {"if": {"type": "string"}, "then": named, "else": film}
    several = {
        title: {"type": "array", "items": _section(kinds)} for title, kinds in LISTS[model].items()
    }
    found["properties"] |= {**sections, **several, "files": {"type": "object"}}
    return found


def _section(kinds: Kinds) -> dict[str, Any]:
    """Return the schema of a section: that of its kind, chosen as the reader does it."""
    found = schema_of(kinds[0])
    for kind in reversed(kinds if len(kinds) > 1 else ()):
        named = {"properties": {"kind": {"const": kind.name}}, "required": ["kind"]}
        signs = [sign for sign in (kind.sign, kind.also_sign) if sign]
        signed = {"anyOf": [{"required": [sign]} for sign in signs]} if signs else False
        chosen = {"if": {"required": ["kind"]}, "then": named, "else": signed}
        found = {"if": chosen, "then": schema_of(kind), "else": found}
    names = [kind.name for kind in kinds if kind.name]
    return found | {"properties": {"kind": {"enum": names}}} if "if" in found else found


def schema_of(kind: Kind) -> dict[str, Any]:
    """Return the schema of a section, or of one kind of it."""
    # What a preset fills in, or a second name gives, need not be there.
    free = kind.filled or "preset" in kind.keys
    must = [n for n, k in kind.keys.items() if k.default is REQUIRED and not (free or k.also)]
    return {
        "type": "object",
        "description": kind.doc,
        "properties": ({"kind": {"const": kind.name}} if kind.name else {}) | _properties(kind),
        "required": must,
        "additionalProperties": False,
    }


def _properties(kind: Kind) -> dict[str, Any]:
    each = kind.keys.items()
    return {spelling: _key(key) for name, key in each for spelling in (name, key.also) if spelling}


def _key(key: Key) -> dict[str, Any]:
    option, found = key.option, key.form.schema()
    quantity = {"$ref": f"#/definitions/{_name(option.unit)}"}
    if found == NUMBER:
        found = {"allOf": [quantity]}  # beside a reference a validator reads nothing
    elif found.get("items") == NUMBER:
        found["items"] = quantity
    if key.is_several:
        found["items"] = _section(key.kinds)
    elif key.kinds:
        found |= _section(key.kinds)
    bounds = {word: getattr(option, name) for name, word in _BOUNDS.items()}
    unit = f"[{option.unit}] " if option.unit else ""
    default = {} if key.default in (REQUIRED, None) else {"default": key.default}
    meaning = {"description": f"{unit}{option.text}", **default}
    return found | {word: value for word, value in bounds.items() if value is not None} | meaning


def _name(unit: str) -> str:
    return f"number in {unit}".replace("/", " per ").replace("^", "") if unit else "number"

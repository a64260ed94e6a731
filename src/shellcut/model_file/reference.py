"""The table of all keys, for the documentation."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import MISSING
from typing import Any

from .key import Key, Section
from .layout import LISTS, SECTIONS
from .run_settings import Head
from .writer import written


def reference() -> str:
    """Return all keys of all sections as tables in Markdown."""
    lines = ["### Before the first section", "", *_table(Head)]
    for title, models in _owners().items():
        brackets = f"[[{title}]]" if title in LISTS["free"] else f"[{title}]"
        lines += ["", f"### {brackets}"]
        for kind, of in models.items():
            lines += ["", _heading(kind, of), "", *_table(kind)]
            for name, key in kind.keys().items():
                if key.kind.tables is not None:
                    ply = key.kind.tables
                    lines += ["", f"`[[{title}.{name}]]`: {_first_line(ply)}", "", *_table(ply)]
    return "\n".join(lines) + "\n"


def _owners() -> dict[str, dict[type[Section], list[str]]]:
    """Return by section its kinds, each with the models that have it."""
    found: dict[str, dict[type[Section], list[str]]] = {}
    for layout in (SECTIONS, LISTS):
        for model, sections in layout.items():
            for title, kinds in sections.items():
                for kind in kinds:
                    found.setdefault(title, {}).setdefault(kind, []).append(model)
    return found


def _heading(kind: type[Section], models: list[str]) -> str:
    named = f'`kind = "{kind.kind}"`, ' if kind.kind else ""
    where = "every model" if len(models) == len(SECTIONS) else "model " + ", ".join(models)
    told = f" Told by `{kind.sign}`." if kind.sign else ""
    return f"{named}{where}: {_first_line(kind)}{told}"


def _first_line(kind: type[Section]) -> str:
    return (kind.__doc__ or "").split("\n")[0]


def _table(kind: type[Section]) -> Iterator[str]:
    yield "| key | value | unit | default | meaning |"
    yield "|---|---|---|---|---|"
    for name, key in kind.keys().items():
        default = kind.__dataclass_fields__[name].default  # type: ignore[attr-defined]
        also = f", `{key.also}`" if key.also else ""
        unit = f"`{key.kind.unit}`" if key.kind.unit else ""
        cells = f"`{name}`{also}", key.kind.wants, unit, _default(default, key), key.doc
        yield f"| {' | '.join(cells)} |"


def _default(default: Any, key: Key) -> str:
    if default is MISSING:
        return "to be given"
    return key.unset if default is None else f"`{written(default)}`"

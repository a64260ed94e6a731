"""What a shell offers after an option, or in the place of a model."""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from typing import Any

from shellcut.model_file import shipped_models
from shellcut.model_file.key_index import tables
from shellcut.results.cut_quality import UNITS
from shellcut.results.summary_figures import LABELS
from shellcut.view.fields import FIELDS

_COLORMAPS = ("viridis", "cividis", "inferno", "turbo", "coolwarm")


def complete(parser: argparse.ArgumentParser) -> None:
    """Answer the shell and end; ImportError without argcomplete."""
    import argcomplete

    files = argcomplete.completers.FilesCompleter()
    sections = [one for one in tables() if not one.title.startswith("[[")]
    keys = [f"{one.title.strip('[]')}.{n}".lstrip(".") for one in sections for n in one.keys]
    offered: dict[str, Iterable[str]] = {
        **dict.fromkeys(("model", "models"), shipped_models()),
        **dict.fromkeys(("settings", "vary", "confirm"), tuple(f"{key}=" for key in keys)),
        **dict.fromkeys(("minimise", "maximise", "subject_to", "figures"), (*LABELS, *UNITS)),
        "free": keys,
        "Look.field": FIELDS,
        "Look.colormap": _COLORMAPS,
    }

    def of(action: Any) -> Any:
        names, also = offered[action.dest], files if action.dest == "model" else lambda *_, **__: ()
        return lambda prefix, **more: [*names, *also(prefix, **more)]

    (commands,) = (one.choices for one in parser._actions if one.dest == "command")
    for command in dict(commands or {}).values():
        for action in command._actions:
            if action.dest in offered:
                vars(action)["completer"] = of(action)
    argcomplete.autocomplete(parser)

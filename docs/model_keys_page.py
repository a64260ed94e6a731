"""Write ``model-keys.md``, the page of all keys of model files, from the keys themselves.

``python docs/model_keys_page.py`` writes it; a test compares page and keys.
"""

from itertools import groupby
from pathlib import Path

from shellcut.model_file.key_index import tables

PAGE = Path(__file__).parent / "model-keys.md"
TOP = """# Model keys

All keys of a [model file](howto/model-file.md) with values, units, defaults and meanings. Where a
unit is given, a value may also be a text with a unit. `shellcut keys WORD` searches the keys on
the command line; `--set SECTION.KEY=VALUE` sets one for a run, `--set SECTION.0.KEY=VALUE` that of
the first of several tables: `material.layers.0.thickness`, `loads.0.value`.
`python docs/model_keys_page.py` makes this page.

"""
HEAD = "| key | value | unit | default | meaning |\n|---|---|---|---|---|"
FIRST = "Before the first section"


def page():
    """Return the page in Markdown."""
    sections = [
        (title, list(of)) for title, of in groupby(tables(), lambda table: _section(table.title))
    ]
    parts = [TOP + "## A to Z\n", _index(sections)]
    for title, of in sections:
        parts += [f"\n## {title}\n", *map(_table, of)]
    return "\n".join(parts)


def _section(title):
    # [[material.layers]] goes with [material]
    return f"[{title.strip('[]').split('.')[0]}]" if "." in title else title or FIRST


def _index(sections):
    places = {}
    for title, of in sections:
        for table in of:
            for key_name, key in table.keys.items():
                for name in filter(None, (key_name, key.also)):
                    places.setdefault(name, {})[title] = True
    lines = ["| key | section |", "|---|---|"]
    for name in sorted(places):
        links = [f"[{title.strip('[]')}](#{_anchor(title)})" for title in places[name]]
        lines.append(f"| `{name}` | {', '.join(links)} |")
    return "\n".join(lines)


def _anchor(title):
    return title.strip("[]").lower().replace(" ", "-")


def _table(table):
    lines = []
    if table.title:
        kind = f'`kind = "{table.kind.name}"`, ' if table.kind.name else ""
        own = f"`{table.title}`, " if "." in table.title else ""
        sign = f" Recognised by `{table.kind.sign}`." if table.kind.sign else ""
        lines += [f"{own}{kind}{table.where}: {table.kind.doc}{sign}", ""]
    return "\n".join([*lines, HEAD, *(_row(*item) for item in table.keys.items()), ""])


def _row(name, key):
    also = f", `{key.also}`" if key.also else ""
    unit = f"`{key.option.unit}`" if key.option.unit else ""
    default = f"`{key.default_text}`" if key.has_default else key.default_text
    return f"| `{name}`{also} | {key.wants} | {unit} | {default} | {key.option.text} |"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")

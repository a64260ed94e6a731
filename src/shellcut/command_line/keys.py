"""``keys``: search the keys of model files.

Print the pages that answer a question with the words, then the keys of model files that have all
words in name, section, unit or meaning; without words, print all keys.

example: shellcut keys notch
"""

from __future__ import annotations

import json
from collections.abc import Iterator

from shellcut.model_file.key_index import Table, found, questions
from shellcut.model_file.schema import schema
from shellcut.study.plan import study_schema

from .shared import Arguments, Parser


def add_to(parser: Parser) -> None:
    """Add its arguments to the parser."""
    parser.add_argument("words", metavar="WORD", nargs="*", help="a word, or a part of it")
    parser.add_argument(
        "--schema",
        nargs="?",
        const="model",
        choices=("model", "study"),
        help="print a JSON Schema of model files or study files, for editors [model]",
    )


def run(arguments: Arguments) -> None:
    """Print the sections and keys found, or the schema."""
    if arguments.schema:
        whole = schema() if arguments.schema == "model" else study_schema()
        print(json.dumps(whole, indent=1, ensure_ascii=False))
        return
    pages = questions(arguments.words)
    for page, question in pages.items():
        print(f"{question}  {page}")
    try:
        chosen = found(arguments.words)
    except ValueError:
        if pages:
            return
        raise
    print("\n\n".join("\n".join(_lines(table)) for table in chosen))


def _lines(table: Table) -> Iterator[str]:
    kind = f' kind = "{table.kind.name}"' if table.kind.name else ""
    yield f"{table.title or 'before the first section'}{kind}  ({table.where}: {table.kind.doc})"
    rows = [
        (
            f"{name} or {key.also}" if key.also else name,
            f"{key.wants} [{key.option.unit}]" if key.option.unit else key.wants,
            f"= {key.default_text}" if key.has_default else f"({key.default_text})",
            key.option.text,
        )
        for name, key in table.keys.items()
    ]
    width = [max(len(row[k]) for row in rows) for k in range(3)]
    for *cells, doc in rows:
        columns = (cell.ljust(w) for cell, w in zip(cells, width, strict=True))
        yield f"  {'  '.join(columns)}  {doc}"

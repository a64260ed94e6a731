"""Write the exit codes and the reference of ``command-line.md`` from the code itself.

``python docs/command_line_page.py`` writes them into the page; a test compares page and code.
"""

import argparse
from pathlib import Path

from shellcut.command_line.main import parser_of_all
from shellcut.command_line.shared import MEANINGS

PAGE = Path(__file__).parent / "command-line.md"
BEGIN = "## All commands\n\n"
CODES = "| exit code | means |\n|---|---|\n"


def codes():
    """Return the rows of the table of exit codes."""
    return "".join(f"| {code} | {meaning} |\n" for code, meaning in MEANINGS.items())


def reference():
    """Return all subcommands with their arguments as tables in Markdown."""
    (commands,) = (a for a in parser_of_all()._actions if isinstance(a, argparse._SubParsersAction))
    return "\n".join(_section(name, parser) for name, parser in commands.choices.items())


def _section(name, parser):
    lines = [f"### shellcut {name}", "", parser.description, ""]
    actions = [a for a in parser._actions if not isinstance(a, argparse._HelpAction)]
    actions = [a for a in actions if a.help != argparse.SUPPRESS]
    if actions:
        lines += ["| argument | meaning |", "|---|---|"]
        lines += [f"| {_spelling(a)} | {_meaning(a)} |" for a in actions]
        lines += [""]
    if parser.epilog:
        lines += ["```sh", parser.epilog.removeprefix("example: "), "```", ""]
    return "\n".join(lines)


def _spelling(action):
    # nargs is 0 for flags; an argument without an option is positional.
    if not action.option_strings:
        name = str(action.metavar or action.dest)
        return f"`[{name}]`" if action.nargs == "?" else f"`{name}`"
    names = action.metavar or action.dest.upper()
    words = [names] if isinstance(names, str) else names
    value = "" if action.nargs == 0 else " " + " ".join(words)
    return ", ".join(f"`{option}{value}`" for option in action.option_strings)


def _meaning(action):
    text = (action.help or "").replace("|", r"\|")
    given = action.default not in (None, "", [], False) and not text.endswith("]")
    return f"{text}; `{action.default}` by default" if given else text


if __name__ == "__main__":
    before = PAGE.read_text(encoding="utf-8").partition(BEGIN)[0]
    top, _, rest = before.partition(CODES)
    middle = rest[rest.index("\n\n") + 1 :]
    PAGE.write_text(top + CODES + codes() + middle + BEGIN + reference(), encoding="utf-8")

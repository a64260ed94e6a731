"""Tables of the pages, for the tests that compare their figures with what they compute."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def tables(text):
    """Return the first line, counted from 0, and the rows of each table, as written."""
    found, lines = [], text.splitlines()
    for k, line in enumerate(lines):
        if not line.startswith("|"):
            continue
        if k == 0 or not lines[k - 1].startswith("|"):
            found.append((k, []))
        found[-1][1].append(line)
    return found


def cells(row):
    """Return the cells of a row; a bar within code does not end one."""
    return [cell.strip() for cell in re.split(r"\|(?=(?:[^`]*`[^`]*`)*[^`]*$)", row)[1:-1]]


def table(page, begins):
    """Return the head and the rows of the one table of a page whose head begins so.

    Each row is the list of its cells. ``page`` is a path from the root of the repository.
    """
    text = (ROOT / page).read_text(encoding="utf-8")
    (rows,) = [rows for _, rows in tables(text) if rows[0].startswith(f"| {begins}")]
    head, _, *body = map(cells, rows)
    return head, body


def numbers_of(cell):
    """Return the numbers of a cell as texts: bold or not, with a typographic minus or a comma."""
    plain = cell.replace("−", "-").replace("*", "")
    plain = re.sub(r"(?<=\d),(?=\d{3}\b)", "", plain)
    return re.findall(r"(?<![\w.])[+-]?\d+(?:\.\d+)?(?:e[+-]?\d+)?", plain)


def shown(value, number):
    """Return a value as text with the digits that a number of a page has."""
    if "e" in number:
        mantissa = number.partition("e")[0]
        digits = len(mantissa.partition(".")[2])
        return f"{value:.{digits}e}".replace("e-0", "e-").replace("e+0", "e")
    sign = "+" if number.startswith("+") else ""
    text = f"{value:{sign}.{len(number.partition('.')[2])}f}"
    return text.replace("-", "") if float(text) == 0.0 else text


def shown_as(page_cell, *values):
    """Whether the numbers of a cell are these values, with the digits that it shows."""
    given = numbers_of(page_cell)
    assert len(given) == len(values), page_cell
    return [shown(v, n) for v, n in zip(values, given, strict=True)] == given


def row(page, begins):
    """Return the cells of the one row of a page's tables whose first cell begins so."""
    text = (ROOT / page).read_text(encoding="utf-8")
    (found,) = [one for _, rows in tables(text) for one in rows if one.startswith(f"| {begins}")]
    return cells(found)


def in_range(words, *values):
    """Whether values, with the digits shown, lie from the least to the largest number of a text."""
    given = numbers_of(words)
    least, largest = min(map(float, given)), max(map(float, given))
    return all(least <= float(shown(value, given[0])) <= largest for value in values)

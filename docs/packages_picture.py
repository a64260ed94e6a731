"""The picture of the packages in ``architecture.md``, made from the import contract.

``python docs/packages_picture.py`` writes ``img/packages.svg``; a test compares the two.
"""

import re
from pathlib import Path

DOCS = Path(__file__).parent
PICTURE = DOCS / "img" / "packages.svg"
CARD = ("mitc4", "cables", "contact", "loads", "central_difference")
"""The row of the method itself, drawn in colour."""

NOTES = {
    "command_line": "the shellcut command",
    "study": "many runs: sweeps, fits, what follows from them",
    "model_file": "models as files, pages of results",
    "models": "opening test, guillotine, tears, free cut",
    "simulation": "the step, equilibrium; files and page of a run",
    "fracture": "cracks; checks before a run; runs read back",
    "mitc4": "the forces, and the integrator that follows them",
    "state": "fields in time; film, tool and motion; pictures",
    "numerics": "kernels, file formats, a picture of a run, cards",
    "arguments": "leaves: kinds of arguments, arrays, units, whole files",
}
"""Subject of each row, by its first package."""

WIDTH, ROW, GAP, LEFT = 860, 40, 12, 16
NOTE = 365
"""Width [px] of the column of notes."""


def rows():
    """Return the rows of the contract, from the top, each a list of packages."""
    text = (DOCS.parent / "pyproject.toml").read_text(encoding="utf-8")
    layers = re.search(r"\nlayers = \[\n(.*?)\n\]", text, re.S)[1]
    return [re.findall(r"\w+", row) for row in re.findall(r'"(.+?)"', layers)]


def table():
    """Return the same rows as a table in Markdown."""
    lines = [" ".join(f"`{package}`" for package in row).replace("` `", "`, `") for row in rows()]
    return "| row |\n|---|\n" + "".join(f"| {line} |\n" for line in lines)


def picture():
    """Return the picture as SVG: a row of boxes a row of the contract, imports go downward."""
    found = rows()
    height = len(found) * (ROW + GAP) + GAP
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" '
        'font-family="Helvetica, Arial, sans-serif" font-size="13">',
        f'<rect width="{WIDTH}" height="{height}" fill="#ffffff"/>',
    ]
    for k, row in enumerate(found):
        parts += _row(row, GAP + k * (ROW + GAP))
    return "\n".join([*parts, "</svg>", ""])


def _row(row, y):
    card = row[0] == CARD[0]
    fill, line = ("#fde9d3", "#c65d00") if card else ("#e8eef5", "#3d5a80")
    weights = [len(package) + 4 for package in row]
    boxes_width = WIDTH - NOTE - 2 * LEFT - 8 * (len(row) - 1)
    x, middle = float(LEFT), y + ROW / 2 + 4.5
    for package, weight in zip(row, weights, strict=True):
        width = boxes_width * weight / sum(weights)
        yield (
            f'<rect x="{x:.1f}" y="{y}" width="{width:.1f}" height="{ROW}" rx="5" '
            f'fill="{fill}" stroke="{line}"/>'
        )
        size = ' font-size="11.5"' if len(row) > 4 else ""
        yield (
            f'<text x="{x + width / 2:.1f}" y="{middle:.1f}" text-anchor="middle" '
            f'fill="#1b1b1b"{size}>{package}</text>'
        )
        x += width + 8
    yield f'<text x="{WIDTH - NOTE}" y="{middle:.1f}" fill="#555555">{NOTES[row[0]]}</text>'


if __name__ == "__main__":
    PICTURE.write_text(picture(), encoding="utf-8")

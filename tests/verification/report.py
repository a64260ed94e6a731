"""Write docs/verification.md, its chapters and their plots from the results of run.py.

    python tests/verification/run.py --json results.json
    python tests/verification/report.py results.json

The hand-written head of docs/verification.md (between the file's start and the marker line) is
kept. Below it is the table of all cases; each chapter of cases is a page in docs/verification/.
"""

import json
import re
import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parents[2] / "docs"
MARKER = "<!-- made by tests/verification/report.py: do not edit below -->"
CHAPTERS = {
    "A": ("linear-statics.md", "Linear statics of shells"),
    "B": ("large-displacements.md", "Large displacements"),
    "C": ("frequencies-and-sudden-loads.md", "Frequencies and sudden loads"),
    "D": ("discs-under-pressure.md", "Discs under pressure"),
    "F": ("cutting.md", "Cohesive law and cuts"),
    "G": ("contact-and-friction.md", "Contact and friction"),
    "P": ("yielding.md", "Films that yield"),
    "X": ("convergence-and-locking.md", "Convergence and locking"),
    "Y": ("time-integration.md", "Time integration"),
}
"""Page and title of a chapter, by the letter with which the ids of its cases begin."""


def anchor(heading):
    """Return the anchor that GitHub and the site give a heading."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def overview(cases):
    """Return the tables of all cases: id and title, rows that pass, of how many, seconds."""
    lines = []
    for letter, (page, title) in CHAPTERS.items():
        rows = []
        for name, passed, gates, seconds in cases:
            if name.startswith(letter):
                verdict = f"{passed} of {gates}" if gates else "–"
                link = f"[{name}](verification/{page}#{anchor(name)})"
                rows.append(f"| {link} | {verdict} | {seconds} |")
        if rows:
            lines += [f"### [{title}](verification/{page})", ""]
            lines += ["| case | rows that pass | time, s |", "|---|---:|---:|", *rows, ""]
    return lines


def chapter(letter, cases):
    """Return the page of a chapter."""
    lines = [
        f"# {CHAPTERS[letter][1]}",
        "",
        MARKER,
        "",
        "The page of [verification](../verification.md#published-cases) lists all cases and "
        "explains the tables.",
        "",
        *cases,
    ]
    return "\n".join(lines).rstrip() + "\n"


def table(results):
    lines = []
    for result in results:
        verdict = "passes" if result["passed"] else "FAILS"
        lines += [
            f"## {result['id']} {result['title']}",
            "",
            f"{verdict}, {result['seconds']:.1f} s",
            "",
            "| quantity | reference | ours | error | tolerance | verdict | why this tolerance |",
            "|---|---:|---:|---:|---:|---|---|",
        ]
        for c in result["checks"]:
            scale, unit = (1.0, "") if c["absolute"] else (100.0, " %")
            word = ("pass" if c["passed"] else "FAIL") if c["gate"] else "info"
            lines.append(
                f"| {c['quantity']} | {c['reference']:.6g} | {c['ours']:.6g} | "
                f"{scale * c['error']:+.3g}{unit} | {scale * c['band']:.3g}{unit} | {word} | "
                f"{c['reason']} |"
            )
        lines.append("")
        if result["curves"]:
            lines += [f"![{result['title']}](../img/verification_{result['id']}.png)", ""]
    return lines


def draw(result):
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 4.5), dpi=70)
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.12, 0.14, 0.85, 0.77))
    for k, (name, curve) in enumerate(result["curves"].items()):
        color = f"C{k}"
        axes.plot(curve["x"], curve["y"], color=color, lw=1.5, label=name)
        if curve.get("x_ref"):
            axes.plot(curve["x_ref"], curve["y_ref"], "o", color=color, ms=4, mfc="none")
    axes.set_title(f"{result['id']} {result['title']}: lines ours, circles published", fontsize=10)
    along, up = result["axes"]
    axes.set(xlabel=along, ylabel=up)
    if up.startswith("relative error"):
        axes.set_xscale("log")
        axes.set_yscale("log")
    axes.grid(color="0.9")
    axes.legend(fontsize=8, frameon=False)
    (DOCS / "img").mkdir(parents=True, exist_ok=True)
    path = DOCS / "img" / f"verification_{result['id']}.png"
    figure.savefig(path, facecolor="white", bbox_inches="tight")


def main(path):
    results = json.loads(Path(path).read_text())
    gates = sum(c["gate"] for r in results for c in r["checks"])
    passed = sum(c["gate"] and c["passed"] for r in results for c in r["checks"])
    page = DOCS / "verification.md"
    head = page.read_text().split(MARKER)[0].rstrip() if page.exists() else "# Verification"
    cases = []
    for r in results:
        verdicts = [c["passed"] for c in r["checks"] if c["gate"]]
        name = f"{r['id']} {r['title']}"
        cases.append((name, sum(verdicts), len(verdicts), f"{r['seconds']:.1f}"))
    lines = [
        head,
        "",
        MARKER,
        "",
        "## Published cases",
        "",
        f"{len(results)} cases; {passed} of {gates} rows with a verdict pass; "
        f"{sum(r['seconds'] for r in results):.0f} s on one core. The error of a row is relative, "
        "in %, or else a difference. The tolerance is the largest error that passes. Rows marked "
        "*info* have no verdict: their reference is of low confidence, or they show a known limit.",
        "",
        *overview(cases),
    ]
    page.write_text("\n".join(lines).rstrip() + "\n")
    (DOCS / "verification").mkdir(exist_ok=True)
    for letter, (name, _) in CHAPTERS.items():
        shown = table([r for r in results if r["id"].startswith(letter)])
        (DOCS / "verification" / name).unlink(missing_ok=True)
        if shown:
            (DOCS / "verification" / name).write_text(chapter(letter, shown))
    for result in results:
        if result["curves"]:
            draw(result)


if __name__ == "__main__":
    main(sys.argv[1])

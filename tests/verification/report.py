"""Write docs/verification.md and its plots from the results of run.py.

    python tests/verification/run.py --json results.json
    python tests/verification/report.py results.json

The hand-written head of the page (between the file's start and the marker line) is kept.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

DOCS = Path(__file__).resolve().parents[2] / "docs"
MARKER = "<!-- made by tests/verification/report.py: do not edit below -->"


def table(results: list[dict[str, Any]]) -> list[str]:
    lines = []
    for result in results:
        verdict = "passes" if result["passed"] else "FAILS"
        lines += [
            f"### {result['id']} {result['title']}",
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
            lines += [f"![{result['title']}](img/verification_{result['id']}.png)", ""]
    return lines


def draw(result: dict[str, Any]) -> None:
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


def main(path: str) -> None:
    results = json.loads(Path(path).read_text())
    gates = sum(c["gate"] for r in results for c in r["checks"])
    passed = sum(c["gate"] and c["passed"] for r in results for c in r["checks"])
    page = DOCS / "verification.md"
    head = page.read_text().split(MARKER)[0].rstrip() if page.exists() else "# Verification"
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
        *table(results),
    ]
    page.write_text("\n".join(lines).rstrip() + "\n")
    for result in results:
        if result["curves"]:
            draw(result)


if __name__ == "__main__":
    main(sys.argv[1])

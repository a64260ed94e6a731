"""The two pictures of a benchmark."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from benchmarks.cut import OF_THE_FILM
from benchmarks.results import Results

_COLOURS = {
    "linear": "C0",
    "points": "C1",
    "laminate": "C2",
}
_LABELS = {
    "linear": "linear material",
    "points": "two thickness points",
    "laminate": "unsymmetric laminate",
}


def _axes(height: float) -> tuple[Figure, Any]:
    figure = Figure(figsize=(7.0, height), dpi=90)
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    axes.grid(color="0.9")
    axes.set_axisbelow(True)
    return figure, axes


def draw_scaling(results: Results, file: Path) -> None:
    """Draw cost a quad and step over the number of quads, with the floors of one core."""
    figure, axes = _axes(4.5)
    groups = dict.fromkeys((c.material, c.threads) for c in results.steps)
    for material, threads in groups:
        costs = [c for c in results.steps if (c.material, c.threads) == (material, threads)]
        quads = [c.n_quad for c in costs]
        style = {"color": _COLOURS[material], "ls": "-" if threads == 1 else "--"}
        plural = "" if threads == 1 else "s"
        name = f"{_LABELS[material]}, {threads} thread{plural}"
        axes.plot(quads, [c.step for c in costs], marker="o", ms=4, label=f"step, {name}", **style)
        if threads == 1:
            kernels = [c.kernel for c in costs]
            axes.plot(quads, kernels, marker="x", ms=4, lw=0.8, label=f"elements, {name}", **style)
    peak, triad = results.limit("peak_gflops"), results.limit("triad_gbytes")
    linear = [c for c in results.steps if (c.material, c.threads) == ("linear", 1)]
    if peak and triad and linear:
        quads = [c.n_quad for c in linear]
        arithmetic = [c.arithmetic_floor(peak) for c in linear]
        axes.plot(quads, arithmetic, color="0.4", ls=":", label="arithmetic at the peak, linear")
        # Small meshes lie in the cache, where the floor says nothing.
        large = [
            (c.n_quad, floor)
            for c in linear
            if c.n_quad > 90_000 and (floor := c.memory_floor(triad)) is not None
        ]
        if large:
            axes.plot(
                *zip(*large, strict=True),
                color="0.4",
                ls="-.",
                marker="s",
                ms=3,
                label="memory, linear",
            )
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("quads")
    axes.set_ylabel("ns a quad and step")
    axes.legend(fontsize=7, frameon=False, ncols=2, loc="upper center", bbox_to_anchor=(0.5, -0.14))
    figure.savefig(file, facecolor="white", bbox_inches="tight")


def draw_profile(results: Results, file: Path) -> None:
    """Draw the parts of a step of the opening tests as stacked bars."""
    figure, axes = _axes(2.6)
    parts = list(dict.fromkeys(p for c in results.cuts for p in c.parts))
    parts.sort(key=lambda part: part not in OF_THE_FILM)
    left = [0.0] * len(results.cuts)
    names = [c.mesh for c in results.cuts]
    for k, part in enumerate(parts):
        widths = [c.parts.get(part, 0.0) for c in results.cuts]
        axes.barh(names, widths, left=left, label=part, color=f"C{k % 10}", hatch="//" * (k // 10))
        left = [a + b for a, b in zip(left, widths, strict=True)]
    axes.invert_yaxis()
    axes.set_xlabel("ns a quad and step")
    axes.legend(fontsize=7, frameon=False, ncols=4, loc="upper center", bbox_to_anchor=(0.5, -0.28))
    figure.savefig(file, facecolor="white", bbox_inches="tight")

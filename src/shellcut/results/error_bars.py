"""Error bars of a model's values, from companion runs: other meshes, slower, run-to-run scatter.

docs/howto/converge.md says how a band is made, docs/error-bars.md how often it covers the fine
answer [Roache1994]. Without a finer mesh a coarser one takes its place, of the ratio q > 1: the
value is that of f, mesh = abs(f_q - f) / (q - 1). A crack advances by whole sides of quads, so its
length is known to a side of the finest mesh at best.

The order with which a value converges is that of f + a h^p through three meshes.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from shellcut.files.regular_file import read_regular
from shellcut.files.whole_file import write_text
from shellcut.unit import in_unit, shown
from shellcut.view.curves import Curve, Diagram

from .summary_figures import label_of, unit_of

ERROR_BARS, PICTURE = "error_bars.json", "error_bars.png"
CONVERGED = "converge"
"""Folder of the companion runs in that of a run."""

GIVEN, MESH, SPEED, CHANCE = "", "mesh", "speed", "chance"
PARTS = (MESH, SPEED, CHANCE)
WORDS = {GIVEN: "as given", MESH: "mesh", SPEED: "speed", CHANCE: "scatter"}
"""Of each part, as shown; the file has the names."""
SIZE = "element side / element side of the model"

COLOURS = {MESH: 0, SPEED: 4, CHANCE: 2, GIVEN: 6}
"""Of the points of each part, in the palette."""
_CAP = 0.03

_LEVEL = 0.95
_FEWEST = 3  # meshes that show an order
_HALVED = {
    MESH: "sides half as long",
    SPEED: "half the speed",
    CHANCE: "the mean of four times as many runs",
}
"""What halves a part."""
_IN_EDGES = "crack_length_mm"
_ORDERS = (0.3, 6.0)
"""Outside which three meshes show no order: differences that hardly shrink, or that vanish."""


@dataclass(frozen=True)
class ErrorBar:
    """A value with its error bar.

    Examples
    --------
    >>> runs = Run("as given", "", 1.0), Run("finer mesh", "mesh", 0.5)
    >>> bar = error_bar("force_peak_N", runs, [3.2, 3.1])
    >>> round(bar.value, 2), round(bar.half_width, 2)
    (3.1, 0.1)
    """

    figure: str
    """Its name in ``summary.json``, with the unit."""
    value: float
    """The best estimate of the fine answer."""
    half_width: float
    """95 % of fine answers lie within it."""
    parts: Mapping[str, float]
    """Half-widths of mesh, speed and scatter, as far as there are runs for them."""
    order: float | None
    """With which it converges over three meshes."""
    values: tuple[float | None, ...]
    """Of all runs, in their order, that as given first."""
    own: float | None = None
    """Half-width that the run as given has of its mean by itself; None for what is no mean."""

    @property
    def name(self) -> str:
        """Label of the value."""
        return label_of(self.figure)

    @property
    def unit(self) -> str:
        """Unit of all numbers."""
        return unit_of(self.figure)

    @property
    def shown(self) -> tuple[str, float]:
        """Unit in which they are shown, and the factor to it."""
        return shown(self.unit)


@dataclass(frozen=True)
class Run:
    """A companion run: name, part of the error bar, sides of quads over the model's."""

    name: str
    part: str
    size: float


@dataclass(frozen=True)
class ErrorBars:
    """The values of a model with their error bars.

    Examples
    --------
    >>> runs = Run("as given", "", 1.0), Run("finer mesh", "mesh", 0.5)
    >>> bar = error_bar("force_peak_N", runs, [3.2, 3.1])
    >>> print(ErrorBars("1f3c", runs, (bar,), {}))
    result                                              value        ±      mesh     speed   scatter
    force, peak [N]                                      3.10     0.10       0.1         -         -
    force, peak: the order needs three meshes; most of ± is mesh: sides half as long would leave \
± 0.05 N
    speed: no run has it for force, peak
    scatter: no run has it for force, peak
    """

    key: str
    """Name of the folder of the run as given."""
    runs: tuple[Run, ...]
    bars: tuple[ErrorBar, ...]
    missing: Mapping[str, list[str]]
    """Why a part is missing or weak."""

    def __str__(self) -> str:
        """Return the table and what is said about it."""
        lines = [f"{'result':<46}{'value':>11}{'±':>9}" + "".join(f"{WORDS[p]:>10}" for p in PARTS)]
        for bar in self.bars:
            value, width, *parts = self.cells(bar)
            head = f"{in_unit(bar.name, bar.shown[0]):<46}{value:>11}{width:>9}"
            lines.append(head + "".join(f"{part:>10}" for part in parts))
        return "\n".join([*lines, *self.said()])

    def cells(self, bar: ErrorBar) -> list[str]:
        """Return value, half-width and parts as texts, "-" for a part without runs."""
        factor = bar.shown[1]
        value, half = factor * bar.value, factor * bar.half_width
        digits = 1 - math.floor(math.log10(half)) if half > 0.0 else 4
        parts = (bar.parts.get(part) for part in PARTS)
        texts = ("-" if width is None else f"{factor * width:.2g}" for width in parts)
        return [*(f"{v:.{max(0, digits)}f}" for v in (value, half)), *texts]

    def said(self) -> list[str]:
        """Return how each value converges and how its bar shrinks, and why a part is missing."""
        silent = {
            part: [f"no run has it for {', '.join(names)}"]
            for part in PARTS
            if (names := [bar.name for bar in self.bars if bar.parts and part not in bar.parts])
        }
        reasons = {**silent, **self.missing}.items()
        why = (f"{WORDS.get(part, part)}: {'; '.join(several)}" for part, several in reasons)
        return [*(self._said_of(bar) for bar in self.bars), *why]

    def _said_of(self, bar: ErrorBar) -> str:
        if not bar.parts:
            return f"{bar.name}: no companion run has it"
        sizes = {run.size for run, v in zip(self.runs, bar.values, strict=True) if v is not None}
        order = "does not converge with an order over the meshes"
        if bar.order is not None:
            order = f"converges with order {bar.order:.1f} over the meshes"
        elif len(sizes) < _FEWEST:
            order = "the order needs three meshes"
        most = max(bar.parts, key=lambda part: bar.parts[part])
        less = {**bar.parts, most: 0.5 * bar.parts[most]}
        unit, factor = bar.shown
        left = f"{factor * math.hypot(*less.values()):.2g} {unit}".rstrip()
        said = (
            f"{bar.name}: {order}; most of ± is {WORDS[most]}: {_HALVED[most]} would leave ± {left}"
        )
        if bar.own is None:
            return said
        own = f"{factor * bar.own:.2g} {unit}".rstrip()
        return f"{said}; by itself the run as given has ± {own}, which a longer cut would lessen"

    def write(self, path: Path) -> None:
        """Write them as JSON."""
        write_text(path, json.dumps(asdict(self), indent=1) + "\n")

    def diagram(self, bar: ErrorBar) -> Diagram:
        """Return a value over the size of the mesh, and its error bar at none."""
        # A line up with a cap at both ends and in the middle.
        x = np.tile([0.0, -_CAP, _CAP, 0.0], 3)
        at = np.repeat([bar.value + k * bar.half_width for k in (-1.0, 0.0, 1.0)], 4)
        curves = [Curve("95 % of fine answers", at, "mean", x=x)]
        for part, colour in COLOURS.items():
            each = zip(self.runs, bar.values, strict=True)
            if points := [(r.size, v) for r, v in each if r.part == part and v is not None]:
                sizes, values = zip(*points, strict=True)
                curves.append(Curve(WORDS[part], values, f"p{colour}", x=sizes))
        short = bar.name.partition(",")[0]
        return Diagram([0.0], curves, SIZE, "", short, bar.unit, bar.name, zero=False)


def read_error_bars(path: Path) -> ErrorBars:
    """Read what :meth:`ErrorBars.write` has written; ValueError if it is another file."""
    try:
        kept: dict[str, Any] = json.loads(read_regular(path))
        runs = tuple(Run(**one) for one in kept["runs"])
        bars = tuple(ErrorBar(**{**one, "values": tuple(one["values"])}) for one in kept["bars"])
        return ErrorBars(kept["key"], runs, bars, kept["missing"])
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError(f"{path} must be a file of shellcut converge, but: {error!r}") from None


def error_bar(
    figure: str,
    runs: Sequence[Run],
    values: Sequence[float | None],
    edge: float = 0.0,
    own: float | None = None,
) -> ErrorBar:
    """Return a value with its error bar from the companion runs, the model as given first.

    The first of its values must be there, others may be None; ``edge`` is the side of the quads
    of the model as given [mm], ``own`` the half-width that its mean has by itself. Runs that differ
    by scatter only contain it: it takes their place where there are none, and is never added.
    """
    (_, f), *others = [(r, v) for r, v in zip(runs, values, strict=True) if v is not None]
    meshes = sorted((r.size, v) for r, v in others if r.part == MESH)
    coarser, finer = ([m for m in meshes if m[0] > 1.0], [m for m in meshes if m[0] < 1.0])
    value, parts = f, dict[str, float]()
    if finer:
        q, value = finer[-1]
        parts[MESH] = q / (1.0 - q) * abs(value - f)
    elif coarser:
        q, far = coarser[0]
        parts[MESH] = abs(far - f) / (q - 1.0)
    if figure == _IN_EDGES and edge:
        parts[MESH] = max(parts.get(MESH, 0.0), edge * min([1.0, *(size for size, _ in meshes)]))
    for slower in (v for r, v in others if r.part == SPEED):
        value += slower - f
        parts[SPEED] = abs(slower - f)
    alike = [f, *(v for r, v in others if r.part == CHANCE)]
    if (n := len(alike)) > 1:
        t = float(scipy.special.stdtrit(n - 1, 0.5 + 0.5 * _LEVEL))
        parts[CHANCE] = t * float(np.std(alike, ddof=1))
    elif own is not None:
        parts[CHANCE] = own
    three = sorted([(1.0, f), *coarser[:1], *finer[-1:]])
    three = three if len(three) == _FEWEST else sorted([(1.0, f), *meshes])[:_FEWEST]
    width = math.hypot(*parts.values())
    return ErrorBar(figure, value, width, parts, _order(three), tuple(values), own)


def _order(meshes: Sequence[tuple[float, float]]) -> float | None:
    """Return p of f + a h^p through three meshes (h, f), None if there is none."""
    if len(meshes) < _FEWEST:
        return None
    (c, f_c), (b, f_b), (a, f_a) = meshes

    def excess(p: float) -> float:
        return float((f_a - f_b) * (b**p - c**p) - (f_b - f_c) * (a**p - b**p))

    if (f_a - f_b) * (f_b - f_c) <= 0.0 or excess(_ORDERS[0]) * excess(_ORDERS[1]) > 0.0:
        return None
    return float(scipy.optimize.brentq(excess, *_ORDERS))

"""The response surface of each figure: its error at unseen runs, and maps of two factors."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from html import escape

import numpy as np

from shellcut.report.chart import Axis, panel
from shellcut.report.markup import missing, sentences, table
from shellcut.unit import after

from .analysis import Analysed
from .effects import said_of
from .studied import Study

_N_SIDE = 50  # places of a map along each factor
_N_BAND = 8  # colours of a map, about
_N_OTHER = 32  # points of the other factors over which a map is averaged
_MOST_MAPS = 6  # of one figure

_HOW = (
    "A surface estimates a figure between the runs, by a Gaussian process. Its error is measured: "
    "runs are left out, one by one or a tenth at a time, and predicted from the others."
)

_GOOD, _POOR = 0.9, 0.5
"""Shares of the variance of unseen runs, for the words of the table."""


def surfaces(study: Study, analyses: Sequence[Analysed]) -> str:
    """Return error, prediction of runs left out, and maps, for each figure."""
    if not analyses:
        return ""
    parts = [_errors(analyses)]
    parts += [missing(f"{one.figure.name}: no surface, {one.why}.") for one in analyses if one.why]
    for one in analyses:
        if one.surface is None:
            continue
        pictures = [_left_out(study, one)]
        if one.predicts:
            pictures += _maps(study, one)
        parts.append(
            f'<h3>{escape(one.figure.name)}</h3><div class="panels">{"".join(pictures)}</div>'
        )
    if any(one.predicts and len(one.factors) > 1 for one in analyses):
        parts.append(
            '<p class="caption">Maps: the mean of the surface over all other factors; the points '
            "are the runs, each in the colour of its own figure; a cross is a run without it.</p>"
        )
    return "".join(parts)


def _errors(analyses: Sequence[Analysed]) -> str:
    rows = []
    for one in analyses:
        surface = one.surface
        if surface is None:
            continue
        how = "one by one" if surface.n_fold == surface.n_run else f"{surface.n_fold} parts"
        rows.append(
            (
                one.figure.name,
                str(surface.n_run),
                how,
                f"{surface.error:.3g}{after(one.figure.unit)}",
                f"{surface.mean_error:.3g}{after(one.figure.unit)}",
                f"{100.0 * max(surface.explained, 0.0):.0f} %",
            )
        )
    if not rows:
        return ""
    head = ("figure", "runs", "left out", "error, rms", "error of the mean", "explained")
    return f"<p>{_HOW}</p>" + table(rows, head) + sentences(_judged(analyses))


def _judged(analyses: Sequence[Analysed]) -> list[tuple[str, str, str]]:
    """Return kind, word and sentence about each surface."""
    lines, guessed = [], dict[str, None]()
    for one in analyses:
        surface = one.surface
        if surface is None:
            continue
        name, unit = one.figure.name, after(one.figure.unit)
        error, of_mean = f"{surface.error:.3g}{unit}", f"{surface.mean_error:.3g}{unit}"
        share = 100.0 * surface.explained
        if not one.predicts:
            text = (
                f"the surface is of no use: it misses unseen runs by {error}, their mean by "
                f"{of_mean}. So there is no map, main effect or sensitivity. More runs may help, "
                "or the figure is noise here."
            )
            lines.append(("doubt", "nothing", f"{name}: {text}"))
            continue
        if surface.explained < _POOR:
            text = f"it explains {share:.0f} % of the variance of unseen runs."
            lines.append(("doubt", "poor", f"{name}: take the surface as a tendency, {text}"))
        elif surface.explained > _GOOD:
            text = f"misses unseen runs by {error} (rms), their mean by {of_mean}."
            lines.append(("good", "holds", f"{name}: the surface {text}"))
        for factor, low, high in one.unseen:
            guessed[f"{factor.name} from {low:.4g} to {high:.4g}{after(factor.unit)}"] = None
    if guessed:
        text = (
            f"There is no run with {', or '.join(guessed)}: there surfaces, main effects and "
            "sensitivities are a guess."
        )
        lines.append(("doubt", "unseen", text))
    return lines


def _left_out(study: Study, one: Analysed) -> str:
    """Return what each run gave over what the others predict for it."""
    assert one.surface is not None
    surface = one.surface
    figure = one.figure.values[one.rows][surface.rows]
    texts = said_of(study, one.rows)
    said = [texts[k] for k in surface.rows.tolist()]
    ends = np.array(
        [min(figure.min(), surface.left_out.min()), max(figure.max(), surface.left_out.max())]
    )
    return panel(
        Axis("predicted from the other runs", one.figure.unit, surface.left_out),
        Axis("the run", one.figure.unit, figure),
        said,
        lines=[(ends, ends, "same")],
        hollow=study.doubted[one.rows][surface.rows],
    )


def _maps(study: Study, one: Analysed) -> list[str]:
    assert one.surface is not None
    numbers = [k for k, factor in enumerate(one.factors) if not factor.names]
    chosen = list(itertools.combinations(_by_weight(one, numbers), 2))[:_MOST_MAPS]
    figure = one.figure.values[one.rows]
    step = _round_step(float(np.ptp(figure)) / _N_BAND)
    contours = {
        "start": float(np.floor(figure.min() / step) * step),
        "end": float(np.ceil(figure.max() / step) * step),
        "size": step,
    }
    lost = ~one.rows & (study.done | study.failed)
    pictures = []
    for i, j in chosen:
        a, b = one.factors[i], one.factors[j]
        across, up = np.linspace(*a.ends, _N_SIDE), np.linspace(*b.ends, _N_SIDE)
        n_other = _N_OTHER if len(one.factors) > 2 else 1
        mean = one.surface.mean_over_others({i: across, j: up}, n_other)
        ground = {
            "type": "contour",
            "x": across.tolist(),
            "y": up.tolist(),
            "z": [[float(f"{value:.4g}") for value in row] for row in mean.T.tolist()],
            "contours": contours,
            "autocontour": False,
            "colorscale": "Viridis",
            "line": {"width": 0},
            "colorbar": {"thickness": 12},
            "hoverinfo": "skip",
        }
        pictures.append(
            panel(
                Axis(a.name, a.unit, a.values[one.rows], ends=a.ends),
                Axis(b.name, b.unit, b.values[one.rows], ends=b.ends),
                said_of(study, one.rows),
                colors=figure,
                ground=ground,
                crosses=(a.values[lost], b.values[lost]),
                hollow=study.doubted[one.rows],
            )
        )
    return pictures


def _by_weight(one: Analysed, numbers: list[int]) -> list[int]:
    """Return factors, those of the largest total index first."""
    if one.indices is None:
        return numbers
    total = one.indices.total
    return sorted(numbers, key=lambda k: -total[k])


def _round_step(about: float) -> float:
    """Return 1, 2 or 5 times a power of ten, at least ``about``."""
    unit = 10.0 ** np.floor(np.log10(about))
    return float(next(m * unit for m in (1.0, 2.0, 5.0, 10.0) if m * unit >= about))

"""The sections of the report: each from what was gathered to a piece of HTML."""

from __future__ import annotations

import base64
import hashlib
import importlib.metadata
import os
import platform
import tempfile
import urllib.parse
from collections.abc import Callable, Sequence
from html import escape
from pathlib import Path

import numpy as np

from shellcut.cut_quality import UNITS as CUT_UNITS
from shellcut.cut_quality import cut_quality
from shellcut.frame import Bools, Frame
from shellcut.view import draw_crack_map, draw_film_strip, edge_length

from .chart import Curve, chart
from .figures import key_figures
from .gathered import Gathered
from .verdict import verdict

_N_MAP = 100  # frames that the crack map takes its times from
_N_STRIP = 6  # frames in the film strip
_AS_GOOD_AS_ZERO = 5e-4  # of lengths, areas and angles of a cut: mm, mm², degrees
_N_QUALITY = 5  # frames whose cut is described
_DIGEST_LIMIT = 200_000_000  # bytes of a file whose digest is worth the wait
_TRUSTED_FROM_DEG = 10.0  # before that next to no work has been done to compare with

_QUALITY = {
    "crack_length": "crack length",
    "cut_share": "share of the line that is cut",
    "n_bridge": "uncut bridges",
    "bridge_width": "bridges, all together",
    "bridge_width_least": "narrowest bridge",
    "slit_width_mean": "slit, mean width",
    "n_flap": "flaps",
    "flap_angle_largest": "opening of a flap, largest",
    "cutout_angle": "tipping of the cut-out",
    "n_loose": "loose pieces",
    "loose_area": "loose area",
}
_KINDS = {"good": "holds", "doubt": "distrust", "note": "note"}


def section(title: str, body: str) -> str:
    """Return a titled section; nothing if it is empty."""
    return f"<section><h2>{escape(title)}</h2>\n{body}\n</section>\n" if body else ""


def table(rows: Sequence[Sequence[str]], head: Sequence[str] = ()) -> str:
    """Return a table of escaped texts, the first column its row heads."""
    parts = []
    if head:
        cells = "".join(f'<th scope="col">{escape(cell)}</th>' for cell in head)
        parts.append(f"<thead><tr>{cells}</tr></thead>")
    parts.append("<tbody>")
    for first, *others in rows:
        cells = "".join(f'<td class="n">{escape(cell)}</td>' for cell in others)
        parts.append(f'<tr><th scope="row">{escape(first)}</th>{cells}</tr>')
    return f'<div class="wide"><table>{"".join(parts)}</tbody></table></div>'


def missing(text: str) -> str:
    """Return a sentence on what is not there."""
    return f'<p class="missing">{escape(text)}</p>'


# ---------------------------------------------------------------------- words and figures


def what_was_run(run: Gathered) -> str:
    """Return the model file, or that there is none."""
    if not run.model:
        return missing("No used.toml: the model was built in Python, or the file was removed.")
    return (
        "<p>The model with all defaults filled in, as it ran (<code>used.toml</code>):</p>"
        f"<details><summary>used.toml, {len(run.model.splitlines())} lines</summary>"
        f"<pre>{escape(run.model)}</pre></details>"
    )


def judgement(run: Gathered, last: Frame | None) -> str:
    """Return the verdict, doubts first, with all that is missing."""
    figures = dict(run.summary) or _figures_so_far(run)
    lines = verdict(figures, edge_length(last) if last is not None else None)
    order = {"doubt": 0, "good": 1, "note": 2}
    said = [("doubt", "missing", problem) for problem in run.problems]
    said += [(line.kind, _KINDS[line.kind], line.text) for line in lines]
    said.sort(key=lambda item: order[item[0]])
    items = "".join(
        f'<li class="{kind}"><b>{word}</b>{escape(text)}</li>' for kind, word, text in said
    )
    return f'<ul class="verdict">{items}</ul>'


def _figures_so_far(run: Gathered) -> dict[str, float]:
    # What the recorder would have put into the summary had the run ended here.
    h = run.history
    if "tool_work" not in h:
        return {}
    trusted = _trusted(run)
    work = np.abs(h["tool_work"][trusted]).clip(np.finfo(float).tiny)
    kinetic = h["kinetic_translation"] + h["kinetic_rotation"]
    return {
        "tool_work_Nmm": float(h["tool_work"][-1]),
        "imbalance_rel": float((np.abs(h["imbalance"][trusted]) / work).max(initial=0.0)),
        "kinetic_rel": float((np.abs(kinetic[trusted]) / work).max(initial=0.0)),
        "contact_Nmm": float(h["contact_work"][-1]),
        "damping_Nmm": float((h["damping_stiffness"] + h["damping_mass"])[-1]),
        "crack_length_mm": float(h["crack_length"][-1]),
    }


def _trusted(run: Gathered) -> Bools:
    # Rows in which the tool has done enough work to compare with, as the recorder takes them.
    name, unit = run.coordinate
    x = run.history[name]
    return np.asarray(x >= (_TRUSTED_FROM_DEG if unit == "deg" else 0.1 * x[-1]))


def figures(run: Gathered) -> str:
    """Return the summary as a table."""
    rows = key_figures(run.summary or _figures_so_far(run))
    half = -(-len(rows) // 2)
    tables = "".join(table(part) for part in (rows[:half], rows[half:]) if part)
    return f'<div class="beside">{tables}</div>' if tables else ""


def splits(run: Gathered) -> str:
    """Return how many nodes were split by what, when, and how large the jumps of force were."""
    if not run.splits:
        return missing("No splits.csv: it is written when a run ends.")
    kinds = run.splits["kind"]
    if not len(kinds):
        return "<p>No node was split.</p>"
    rows = []
    for kind in dict.fromkeys(kinds.tolist()):
        chosen = kinds == kind
        times = 1e3 * run.splits["time"][chosen]
        jump = np.abs(run.splits["force_jump"][chosen]).max()
        rows.append(
            (
                f"by {kind}",
                f"{chosen.sum():,}",
                f"{times.min():.4g} ms",
                f"{times.max():.4g} ms",
                f"{jump:.3g} N",
            )
        )
    return table(rows, ("split", "nodes", "first at", "last at", "largest jump of force"))


def tool(run: Gathered, last: Frame | None) -> str:
    """Return the tool's size, edges and last place."""
    if last is None or not len(last.tool_triangles):
        return ""
    edges = np.linalg.norm(last.edge_points[:, 1] - last.edge_points[:, 0], axis=1)
    extent = " × ".join(f"{length:.4g}" for length in np.ptp(last.tool_points, axis=0))
    first = run.resistance[0] if run.history else ""
    n_tooth = sum(name.startswith(f"{first}_tooth_") for name in run.history)
    rows = [
        ("teeth", str(n_tooth) if n_tooth else "-"),
        ("cutting edges", f"{edges.sum():.4g} mm in {len(edges)} segments"),
        ("extent in x, y, z at the last frame", f"{extent} mm"),
        ("surface", f"{len(last.tool_triangles):,} triangles"),
    ]
    return table(rows)


def versions() -> str:
    """Return what the report was written by."""
    rows = [("Python", platform.python_version()), ("machine", platform.platform(terse=True))]
    for package in ("shellcut", "numpy", "scipy", "numba", "h5py", "matplotlib"):
        try:
            rows.append((package, importlib.metadata.version(package)))
        except importlib.metadata.PackageNotFoundError:
            rows.append((package, "not installed"))
    return table(rows) + '<p class="caption">Of the installation that wrote this report.</p>'


def files(run: Gathered, report: Path) -> str:
    """Return links to all that is in the folder, with sizes and digests."""
    rows = []
    for path in sorted(run.folder.iterdir()):
        if not path.is_file() or path.resolve() == report.resolve():
            continue
        size = path.stat().st_size
        digest = "-"
        if size <= _DIGEST_LIMIT:
            digest = hashlib.sha256(path.read_bytes()).hexdigest()[:16]
        rows.append(
            f'<tr><th scope="row"><a href="{escape(_link(path, report))}">{escape(path.name)}</a>'
            f'</th><td class="n">{_bytes(size)}</td><td class="n"><code>{digest}</code></td></tr>'
        )
    head = "".join(
        f'<th scope="col">{cell}</th>' for cell in ("file", "size", "SHA-256, first 16 digits")
    )
    return (
        f'<div class="wide"><table><thead><tr>{head}</tr></thead>'
        f"<tbody>{''.join(rows)}</tbody></table></div>"
    )


def _link(path: Path, report: Path) -> str:
    try:
        relative = os.path.relpath(path.resolve(), report.resolve().parent)
    except ValueError:  # on another drive
        return path.resolve().as_uri()
    return urllib.parse.quote(Path(relative).as_posix())


def _bytes(size: int) -> str:
    return f"{size / 1e6:.1f} MB" if size >= 100_000 else f"{size / 1e3:.1f} kB"


# ---------------------------------------------------------------------- curves


def resistance_curve(run: Gathered) -> str:
    """Return torque (or force) over the tool's way."""
    if not run.history:
        return missing("No curve: the history is missing.")
    first, unit = run.resistance
    teeth = [name for name in run.history if name.startswith(f"{first}_tooth_")]
    curves = []
    if len(teeth) > 1:
        label = f"each of {len(teeth)} teeth"
        curves += [Curve(label, run.history[name], "tooth") for name in teeth]
    curves += [
        Curve("from contact", run.history[f"{first}_contact"], "contact"),
        Curve("from cables at the edge", run.history[f"{first}_joints"], "joints"),
        Curve("total", run.history[first], "total"),
    ]
    return _chart(run, curves, first, _pretty(unit), f"{first} over {run.coordinate[0]}")


def energy_curve(run: Gathered) -> str:
    """Return the ledger: the work put in and where it went, and what it misses."""
    h = run.history
    if "tool_work" not in h:
        return missing("No ledger: the history is missing.")
    shares = {
        "cables": h["cohesive_work"] + h["cohesive_start_work"],
        "damping": h["damping_stiffness"] + h["damping_mass"],
        "strain": h["strain"],
        "kinetic": h["kinetic_translation"] + h["kinetic_rotation"],
        "contact": h["contact_work"],
    }
    largest = max(float(np.abs(share).max()) for share in shares.values())
    stacked = all(share.min() >= -0.01 * largest for share in shares.values())
    curves = [
        Curve(name, share, f"a{k}", area=stacked) for k, (name, share) in enumerate(shares.items())
    ]
    work = h["tool_work"] + h["load_work"] + h["support_work"]
    curves.append(Curve("work put in", work, "work"))
    ledger = _chart(run, curves, "energy", "N·mm", "energies and the work put in")
    trusted = _trusted(run)
    if trusted.sum() < 2:
        return ledger
    missed = [Curve("imbalance", 100.0 * h["imbalance_rel"][trusted], "total")]
    name, unit = run.coordinate
    start = _figure_of(h[name][trusted][0], unit)
    return ledger + _chart(
        run,
        missed,
        f"imbalance of the ledger from {start} on",
        "%",
        "what the ledger misses",
        height=170.0,
        rows=trusted,
    )


def step_curve(run: Gathered) -> str:
    """Return the time step, in numbers and over the tool's way."""
    if "dt" not in run.history:
        return ""
    steps = 1e9 * run.history["dt"][1:]  # the first row stands before the first step
    rows = [("smallest", f"{steps.min():.4g} ns"), ("largest", f"{steps.max():.4g} ns")]
    if "n_step" in run.summary:
        rows.append(("steps", f"{run.summary['n_step']:,}"))
        rows.append(("mean", f"{1e9 * run.summary['dt_s']:.4g} ns"))
    step = np.concatenate((steps[:1], steps))
    return table(rows) + _chart(
        run, [Curve("step", step, "contact")], "time step", "ns", "the time step", height=190.0
    )


def quality(run: Gathered) -> str:
    """Return the quality of the cut at a few frames."""
    frames = run.frames(_N_QUALITY)
    if not frames:
        return missing("No figures of the cut: there are no frames.")
    rows = [cut_quality(frame).figures() for frame in frames]
    coordinate, unit = frames[0].coordinate_name, frames[0].coordinate_unit
    head = [f"at {coordinate}", *(_figure_of(frame.coordinate, unit) for frame in frames)]
    lines = [
        [label, *(_figure_of(row[name], CUT_UNITS[name]) for row in rows)]
        for name, label in _QUALITY.items()
    ]
    return table(lines, head) + (
        '<p class="caption">Counted in the frames; cables are not film. A bridge is film between '
        "two crack ends that face each other; the cut-out is the piece that the cut is to free.</p>"
    )


def _figure_of(value: float, unit: str) -> str:
    number = f"{value:.3g}" if abs(value) >= _AS_GOOD_AS_ZERO else "0"
    return number if unit == "-" else f"{number}{_gap(unit)}{_pretty(unit)}"


def _chart(
    run: Gathered,
    curves: Sequence[Curve],
    name: str,
    unit: str,
    of: str,
    height: float = 300.0,
    rows: Bools | slice = slice(None),
) -> str:
    coordinate, coordinate_unit = run.coordinate
    x = run.history[coordinate][rows]
    # A motion may rest or go back; a curve read by its coordinate must not.
    ahead = np.concatenate(([True], x[1:] > np.maximum.accumulate(x)[:-1]))
    if ahead.sum() < 2:
        return missing(f"No curve of {name}: the tool has not moved.")
    last = ", ".join(f"{curve.name} {curve.values[-1]:.4g} {unit}" for curve in curves[-3:])
    shown = [
        Curve(c.name, np.nan_to_num(c.values[ahead], posinf=0.0, neginf=0.0), c.style, c.area)
        for c in curves
    ]
    return chart(
        x[ahead],
        shown,
        x_name=coordinate,
        x_unit=_pretty(coordinate_unit),
        name=name,
        unit=unit,
        described=f"Curve: {of}; at the end {last}.",
        height=height,
    )


def _pretty(unit: str) -> str:
    return unit.replace("*", "·").replace("deg", "°").replace("^2", "²")


def _gap(unit: str) -> str:
    return "" if unit == "deg" else " "


# ---------------------------------------------------------------------- pictures


def crack_map(run: Gathered) -> str:
    """Return the crack on the uncut film."""
    frames = run.frames(_N_MAP)
    if not frames:
        return missing("No crack map: there are no frames.")
    places = {}
    if run.splits:
        where = np.stack([run.splits[axis] for axis in "XYZ"], axis=1)
        kinds = run.splits["kind"]
        places = {str(kind): where[kinds == kind] for kind in np.unique(kinds)}
    picture = _picture(lambda path: draw_crack_map(path, frames, splits=places, width=8.0))
    name = frames[-1].coordinate_name
    return _figure(
        picture,
        f"Plan of the film with the crack edges coloured by the {name} they opened at",
        f"The crack on the uncut film. An edge is dated by the first frame that has it open; of "
        f"{run.results.n_frame if run.results else 0} frames {len(frames)} were looked at.",
    )


def film_strip(run: Gathered) -> str:
    """Return a few frames beside each other."""
    frames = run.frames(_N_STRIP)
    if not frames:
        return missing("No film strip: there are no frames.")
    picture = _picture(lambda path: draw_film_strip(path, frames))
    way = f"{frames[0].coordinate_name} {frames[0].coordinate:.3g} to {frames[-1].coordinate:.3g}"
    return _figure(
        picture,
        f"{len(frames)} views of the film being cut, {way} {_pretty(frames[0].coordinate_unit)}",
        "All by one camera and on one stress scale.",
    )


def snapshots(run: Gathered) -> str:
    """Return the run's own snapshots, behind a slider where there is JavaScript."""
    pictures = sorted(run.folder.glob("snapshot_*.png"))
    images = [
        _image(path.read_bytes(), f"Snapshot {k + 1} of {len(pictures)}: whole film and one tooth")
        for k, path in enumerate(pictures)
    ]
    if not images:
        return ""
    slider = (
        f'<p class="turn"><label for="slide">Picture</label><input id="slide" type="range" min="0" '
        f'max="{len(images) - 1}" value="{len(images) // 2}"><output for="slide"></output></p>'
    )
    return f'<figure class="slides">{slider}<div class="wide">{"".join(images)}</div></figure>'


def _picture(draw: Callable[[Path], None]) -> bytes | None:
    # Bytes of a PNG; None where Matplotlib is missing.
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "picture.png"
        try:
            draw(path)
        except ImportError:
            return None
        return path.read_bytes()


def _figure(picture: bytes | None, alt: str, caption: str) -> str:
    if picture is None:
        return missing("Not drawn: pictures need Matplotlib (pip install shellcut[plot]).")
    words = f'<figcaption class="caption">{escape(caption)}</figcaption>'
    return f'<figure><div class="wide">{_image(picture, alt)}</div>{words}</figure>'


def _image(png: bytes, alt: str) -> str:
    data = base64.b64encode(png).decode("ascii")
    return f'<img alt="{escape(alt)}" src="data:image/png;base64,{data}">'

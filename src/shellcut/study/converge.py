"""Error bars of a model: its companion runs as a study, and what follows from them.

Companions are the model on other meshes, slower, and from other small shapes of its film;
docs/howto/converge.md lists them. Each sets a few keys of the model file otherwise, so all of them
are a study with one factor.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

from shellcut.files.file_list import claim, folder_named
from shellcut.model_file import Model, read_model
from shellcut.model_file.section_table import along_path
from shellcut.models.path_film import path_size
from shellcut.results.error_bars import (
    CHANCE,
    ERROR_BARS,
    GIVEN,
    MESH,
    PICTURE,
    SPEED,
    ErrorBars,
    Run,
    error_bar,
)
from shellcut.results.steady_window import half_width_of
from shellcut.results.summary_figures import known_figure
from shellcut.view import can_draw, draw_curves

from .engines import AnyExecutor, Say, engine_of
from .one_run import Outcome
from .plan import FEW_FILES, Definition
from .report.studied import of_interest
from .study import run_study
from .table import NOT_COMMON

_RATIO, _SLOWER = 1.5, 2.0

_AROUND = {"quick": 72, "M1": 152, "M2": 276}
"""Nodes on the path, of the discs of the opening test."""

_ANOTHER = 0.95
"""Size of another mesh about as fine over that of the model, where a mesher makes it."""

_TURN = 1.8
"""By which teeth are turned where the nodes under them are not known [deg]."""

Settings = Mapping[str, object]


class NoFinerFilm(ValueError):
    """A model has no other mesh; the message says why."""


def converge(
    model: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    figures: Sequence[str] = (),
    settings: Mapping[str, object] | None = None,
    executor: AnyExecutor = None,
    say: Say = None,
) -> ErrorBars:
    """Run a model with its companions, and return its values with error bars.

    The companions have a coarser and a finer mesh, nodes elsewhere under the path, half the speed,
    and two other small shapes of the film: together they take ten times the time of the model. They
    are a study in ``out``: what is done is found again, what was interrupted continues.

    Parameters
    ----------
    out : str or path
        Folder for the runs, ``error_bars.json`` and, with Matplotlib, ``error_bars.png``.
    ``figures`` : sequence of str, optional
        Names in ``summary.json``; by default means and peaks of torque or force, crack length and
        work.
    model, settings, executor, say
        As of :func:`shellcut.sweep`.

    Returns
    -------
    ErrorBars

    Raises
    ------
    ModelFileError, FolderInUse, FileExistsError, ConnectionError, KeyboardInterrupt
        As of :func:`shellcut.sweep`.
    RuntimeError
        If the run as given fails.
    ValueError
        If it has not the values.

    Examples
    --------
    >>> found = converge("guillotine", "bars")  # doctest: +SKIP
    >>> print(found)  # doctest: +SKIP
    """
    figures = [known_figure(name) for name in figures]
    folder = folder_named(out)
    given = {**FEW_FILES, **(settings or {})}
    companions, missing = companions_of(read_model(model, given))
    runs, rows = tuple(companions), [list(keys.values()) for keys in companions.values()]
    names = ", ".join(companions[runs[0]])
    linked = {names: rows if len(rows[0]) > 1 else [value for (value,) in rows]}
    plan = Definition(str(model), linked, given, figures=tuple(figures)).plan()
    claim(folder, [ERROR_BARS, PICTURE])
    outcomes = run_study(plan, folder, engine_of(executor), say).outcomes
    each = [outcomes.get(run.number, Outcome("stopped")) for run in plan.runs]
    if each[0].status != "done":
        raise RuntimeError(f"the run as given must be done: {each[0].reason or each[0].status}")
    for run, one in zip(runs, each, strict=True):
        reasons = [f"{run.name} is distrusted: {doubt}" for doubt in one.doubts]
        if one.status != "done":
            reasons = [f"{run.name} is not done: {one.reason or one.status}"]
        if why := one.figures.get("no_window"):
            reasons.append(f"{run.name} has no mean: {why}")
        if reasons:
            missing.setdefault(run.part or "doubts", []).extend(reasons)
    if windows := {one.figures[NOT_COMMON] for one in each if NOT_COMMON in one.figures}:
        missing.setdefault("doubts", []).extend(sorted(windows))
    there = {name: v for name, v in each[0].figures.items() if isinstance(v, int | float)}
    chosen, lacking = of_interest(figures, there)
    if lacking or not chosen:
        raise ValueError(f"the run has no {', '.join(lacking)}, but {', '.join(there)}")
    edge = float(there.get("edge_length_mm", 0.0))
    bars = tuple(
        error_bar(n, runs, [one.figures.get(n) for one in each], edge, there.get(half_width_of(n)))
        for n in chosen
    )
    found = ErrorBars(plan.runs[0].key, runs, bars, missing)
    found.write(folder / ERROR_BARS)
    if can_draw():
        size = 7.0, 0.6 + 2.6 * len(bars)
        draw_curves(folder / PICTURE, [found.diagram(bar) for bar in bars], size=size)
    return found


def companions_of(
    model: Model, finer: float = _RATIO, slower: float = _SLOWER
) -> tuple[dict[Run, Settings], dict[str, list[str]]]:
    """Return the runs, the model as given first, with what each sets: all the same keys.

    And by the part of the error bar, why it is missing or weak. ``finer`` and ``slower`` are the
    ratios of the finer mesh and of the slower motion.
    """
    runs: dict[Run, Settings] = {Run("as given", GIVEN, 1.0): {}}
    missing: dict[str, list[str]] = {}
    try:
        runs |= _meshes(model, finer)
    except NoFinerFilm as why:
        missing[MESH] = [f"left out, because {why}"]
    if moved := _moved(model):
        runs[Run("nodes moved", CHANCE, 1.0)] = moved
    else:
        missing[CHANCE] = ["there is no mesh as fine with its nodes elsewhere under the path"]
    try:
        runs[Run("slower", SPEED, 1.0)] = _slower(model, slower)
    except ValueError as reason:
        missing[SPEED] = [str(reason)]
    shape = model.head.imperfection
    if shape is None:
        shape = int("tool" in model.sections and model.sections["tool"].kind != "bar")
    others = (shape + 1, shape + 2)
    runs |= {Run(f"shape {k}", CHANCE, 1.0): {"imperfection": k} for k in others}
    places = {key: key.rpartition(".") for keys in runs.values() for key in keys}
    given: dict[str, object] = {
        key: (model.sections[title] if title else model.head).values[name]
        for key, (title, _, name) in places.items()
    }
    given |= {"imperfection": shape, **{key: v for key, v in _sizes(model).items() if key in given}}
    return {run: {**given, **keys} for run, keys in runs.items()}, missing


def _meshes(model: Model, finer: float) -> dict[Run, Settings]:
    """Return a coarser mesh, if there is one, and a finer one; NoFinerFilm says why neither."""
    film, sizes = model.sections["membrane"], _sizes(model)
    if film.kind == "file":
        return {Run("finer mesh", MESH, 0.5): {"membrane.refine": film.refine + 1}}
    if film.kind == "opening" and film.mesh in _AROUND:
        n = _AROUND[film.mesh]
        near = sorted(_AROUND, key=lambda name: abs(_AROUND[name] - n))[1:]
        names = near if film.mesh != "quick" else near[:1]
        return {Run(f"mesh {m}", MESH, n / _AROUND[m]): {"membrane.mesh": m} for m in names}
    counted = _rows(model) is not None or film.values.get("n_side") is not None
    if not sizes and not counted and film.values.get("size") is None:
        raise NoFinerFilm("the mesher chose the size; give membrane.size")
    found = {"coarser mesh": _mesh(model, 1.0 / _RATIO), "finer mesh": _mesh(model, finer)}
    return {Run(name, MESH, h): keys for name, (h, keys) in found.items() if h != 1.0}


def finer_film(model: Model) -> Settings:
    """Return the keys of a model on a finer film; :class:`NoFinerFilm` says why there is none."""
    finer = [keys for run, keys in _meshes(model, _RATIO).items() if run.size < 1.0]
    if not finer:
        raise NoFinerFilm("there is no finer mesh of its kind")
    return finer[0]


def _mesh(model: Model, factor: float) -> tuple[float, Settings]:
    """Return the same for a mesh of about so many times as many rows."""
    film = model.sections["membrane"]
    if sizes := _sizes(model):
        return 1.0 / factor, {key: size / factor for key, size in sizes.items()}
    if film.kind == "disc" and film.n_side:
        n, m = film.n_side, _scaled(film.n_side, factor)
        layers = {"membrane.n_layer": max(1, round(film.n_layer * m / n))} if film.n_layer else {}
        return n / m, {"membrane.n_side": m, **layers}
    if (rows := _rows(model)) is not None:
        n_x, n_y = rows
        m_y = _scaled(n_y, factor)
        # As many times as many along: h is the ratio of the sides in both directions.
        return n_y / m_y, _of_rows(model, _scaled(n_x, m_y / n_y), m_y)
    return 1.0 / factor, {"membrane.size": film.size / factor}


def _moved(model: Model) -> Settings:
    """Return the keys of a mesh as fine with other nodes under the path; none if there is none."""
    film, tool = model.sections["membrane"], model.sections.get("tool")
    if sizes := _sizes(model):  # the film turns with the teeth
        return {key: _ANOTHER * size for key, size in sizes.items()}
    if tool is not None and tool.kind == "teeth":
        around = _AROUND.get(film.values.get("mesh", ""), 4 * (film.values.get("n_side") or 0))
        turn = 180.0 / around if around else _TURN
        return {"tool.phase_deg": tool.phase_deg + turn}
    if (rows := _rows(model)) is not None:
        keys = _of_rows(model, rows[0] + 1, rows[1], along=True)
        return keys if _rows(model, keys.get("membrane.size"))[1] == rows[1] else {}
    return {"membrane.size": _ANOTHER * film.size} if film.values.get("size") else {}


def _sizes(model: Model) -> dict[str, float]:
    """Return the keys of a film that is meshed along the path, with their sizes; none of others."""
    film = model.sections["membrane"]
    if not along_path(film):
        return {}
    near = film.size_at_path
    if near is None:
        near = path_size(model.sections["material"].made(), model.sections["cohesive"].made())
    found = {"membrane.size_at_path": near}
    size = film.values.get("size")
    return found if size is None else {**found, "membrane.size": size}


def _rows(model: Model, size: Any = None) -> Any:
    """Return the quads along and across a sheet, of another size if given; None for other films."""
    film = model.sections["membrane"]
    if film.kind not in ("strip", "rectangle") or "band" in film.values:
        return None
    if (size := size or film.size) is None:
        return film.n_x, film.n_y
    return round(film.length / size), round(film.width / size)


def _of_rows(model: Model, n_x: int, n_y: int, *, along: bool = False) -> Settings:
    """Return the keys of so many rows; of a size those across decide, or those along."""
    film = model.sections["membrane"]
    if film.size is None:
        return {"membrane.n_x": n_x, "membrane.n_y": n_y}
    return {"membrane.size": film.length / n_x if along else film.width / n_y}


def _scaled(n: int, factor: float) -> int:
    """Return another number of rows, about so many times as large, even or odd like it.

    It is the next one if those are too few to come nearer, and n if that would be below 1.
    """
    scaled = n + 2 * (round(0.5 * n * (factor - 1.0)) or (1 if factor > 1.0 else -1))
    return scaled if scaled > 0 else n


def _slower(model: Model, times: float) -> Settings:
    """Return the keys of a slower motion. Raises ValueError with the reason if there is none."""
    limit, v = model.head.quasi_static, model.sections["motion"].values
    # A limit of the energy goes with the square of the speed, whatever moves.
    paced = {} if limit is None else {"quasi_static": limit / times**2}
    changing = [one for several in model.lists.values() for one in several]
    why = ""
    if model.sections["motion"].kind == "table":
        why = "the motion is a table of times"
    elif any(one.values.get(name) for one in changing for name in ("ramp", "velocity", "spin")):
        why = "loads or supports change in time"
    elif any(one.values.get("rate") for one in model.titled().values()):
        why = "the film's law depends on the rate"
    if why and not paced:
        raise ValueError(f"{why}, so no run is slower")
    if why:
        return paced
    longer = {f"motion.{name}": v[name] * times for name in ("duration", "ramp") if v.get(name)}
    return paced | longer | ({"motion.speed": v["speed"] / times} if "speed" in v else {})

"""What the project asks of its speed, against what was measured."""

from __future__ import annotations

from collections.abc import Iterator

from benchmarks.cut import ANGLE
from benchmarks.harness import Gate
from benchmarks.peers import CALCULIX, OPENSEES, OURS, PeerRun
from benchmarks.results import Results
from benchmarks.steps import NO_THREADS

NORMALISED = {"linear": 1600.0, "points": 2400.0}
"""ns a quad and step times the peak in GFlop/s."""

_OF_FLOOR, _FLAT, _SPEED_UP = 2.5, 1.6, 1.6
_CUT_SECONDS = {"M1": 12.0, "M2": 50.0}
_ALL_BUT_SHELLS = 20.0  # ns a quad and step
_BYTES, _GROWTH = 1000.0, 1.0  # a quad; the growth is what pages round to
_PEER_RATIO = 100.0
_PEAK_OFF = {"OpenSees ASDShellQ4 corotational": 0.01, CALCULIX: 0.03}
_IMPORT = 1.0  # s

NOT_RUN = "not run"


def gates(results: Results) -> list[Gate]:
    """Return every gate; one without a figure says why."""
    return [
        *_of_one_core(results),
        *_of_two_threads(results),
        *_of_cuts(results),
        *_of_memory(results),
        *_of_peers(results),
        *_of_start(results),
    ]


def _of_one_core(r: Results) -> Iterator[Gate]:
    peak, triad = r.limit("peak_gflops"), r.limit("triad_gbytes")
    for material, target in NORMALISED.items():
        for name in ("M1", "M2"):
            cost = r.cost(name, material)
            figure = cost.step * peak if cost and peak else None
            what = f"normalised cost of a step, {material}, {name}, ns x GFlop/s"
            yield Gate(what, target, figure, why_not=NOT_RUN)
    large, figure, why = r.cost("1e6"), None, NOT_RUN
    if large and peak and triad:
        floor = large.memory_floor(triad)
        why = r.errors.get("steps", NOT_RUN)
        if floor is not None:
            figure = large.step / max(floor, large.arithmetic_floor(peak))
    yield Gate("step at 1e6 quads over the larger floor", _OF_FLOOR, figure, why_not=why)
    costs = [c.step for n in ("M1", "M2", "3e4", "1e5", "3e5", "1e6") if (c := r.cost(n))]
    flat = max(costs) / min(costs) if r.cost("M1") and large else None
    what = "dearest over cheapest quad and step, M1 to 1e6 quads"
    yield Gate(what, _FLAT, flat, why_not=NOT_RUN)


def _of_two_threads(r: Results) -> Iterator[Gate]:
    has_two = any(c.threads == 2 for c in r.steps)
    why = NOT_RUN if has_two or not r.steps else NO_THREADS
    for name in ("1e5", "3e5", "1e6"):
        one, two = r.cost(name), r.cost(name, threads=2)
        figure = one.step / two.step if one and two else None
        what = f"two threads over one, {name} quads"
        yield Gate(what, _SPEED_UP, figure, at_least=True, why_not=why)
    same = None if r.same_bits is None else float(r.same_bits)
    what = "same bits from one and two threads, 50 steps (1 = yes)"
    yield Gate(what, 1.0, same, at_least=True, why_not=why)


def _of_cuts(r: Results) -> Iterator[Gate]:
    for mesh, target in _CUT_SECONDS.items():
        cut = next((c for c in r.cuts if c.mesh == mesh), None)
        whole = cut is not None and cut.angle > 0.999 * ANGLE
        wall = cut.wall_seconds if cut and whole else None
        why = "only a part of the cut was run" if cut else NOT_RUN
        yield Gate(f"opening test {mesh} to {ANGLE:g} degrees, s", target, wall, why_not=why)
        # Closing, a fixed cost, would weigh too much in a part of the cut.
        others = cut.all_but_shells if cut and whole else None
        what = f"opening test {mesh}, all but the shells, ns a quad and step"
        yield Gate(what, _ALL_BUT_SHELLS, others, why_not=why)


def _of_memory(r: Results) -> Iterator[Gate]:
    m = r.memory
    span = f"{m.small.n_quad} to {m.large.n_quad} quads" if m else "1e5 to 1e6 quads"
    what = f"memory after set-up, bytes a quad, {span}"
    yield Gate(what, _BYTES, m.set_up_slope if m else None, why_not=NOT_RUN)
    growth = m.growth if m else None
    yield Gate("growth of memory over a run, bytes a quad", _GROWTH, growth, why_not=NOT_RUN)


def _of_peers(r: Results) -> Iterator[Gate]:
    runs = {run.program: run for run in r.peers}
    ours = runs.get(OURS)
    for program, off in _PEAK_OFF.items():
        assert program in {CALCULIX, *OPENSEES}
        peer = runs.get(program)
        why = r.missing_peers.get(program, NOT_RUN)
        both: tuple[PeerRun, PeerRun] | None = (ours, peer) if ours and peer else None
        ratio = both[1].cpu_ns / both[0].cpu_ns if both else None
        what = f"CPU a quad and step of {program} over ours"
        yield Gate(what, _PEER_RATIO, ratio, at_least=True, why_not=why)
        apart = abs(both[0].peak / both[1].peak - 1.0) if both else None
        yield Gate(f"peak deflection against {program}, relative", off, apart, why_not=why)


def _of_start(r: Results) -> Iterator[Gate]:
    c = r.compilation
    yield Gate("import, s", _IMPORT, c.import_seconds if c else None, why_not=NOT_RUN)
    again = float(c.recompiled) if c else None
    yield Gate("kernels compiled by a second start", 0.0, again, why_not=NOT_RUN)

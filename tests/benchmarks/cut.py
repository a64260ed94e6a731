"""The opening test end to end, and where its time goes.

First a bare run, timed as a whole: set-up, run with a Recorder that writes history and result file,
closing (summary and curves). Then a shorter run of the same cut with a timer around each part; what
the timers themselves cost is measured and subtracted, and the parts are scaled so that together
they are the bare run. Times are of their own: what a part calls belongs to the part called.
"""

from __future__ import annotations

import math
import statistics
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from benchmarks.memory import resident
from shellcut import Recorder, Simulation, opening_test, warmup
from shellcut.models import Case

ANGLE = 95.0  # degrees
FRAMES = 200
PROFILED = 1.0 / 3.0  # of the angle

METHODS = {
    "shell": ("shell.add_forces",),
    "loads and supports": ("loads.begin_forces", "supports.prescribe"),
    "integrator": ("integrator.drift", "integrator.kick"),
    "stable step": ("time_step.next",),
    "contact": ("contact.add_forces",),
    "cables": ("cables.add_forces",),
    "fracture": ("cracks.cut_due",),
    "tool and ledger": ("_place_tool", "terms.add_forces"),
}
"""What is timed, by part. The rest of a step is the driver's."""

OF_THE_FILM = ("shell", "loads and supports", "integrator", "stable step")
"""Parts that a film without a tool has too; the others are what the cut adds."""


class Profile:
    """Own times of parts, timers' cost subtracted."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = defaultdict(float)
        self._calls: dict[str, int] = defaultdict(int)
        self._inner_calls: dict[str, int] = defaultdict(int)
        self._open: list[list[Any]] = [["driver", 0.0]]

    def timed(self, part: str, work: Callable[..., Any]) -> Callable[..., Any]:
        """Return ``work`` with a timer around it."""

        def wrapped(*arguments: Any, **options: Any) -> Any:
            began = time.perf_counter()
            self._open.append([part, 0.0])
            try:
                return work(*arguments, **options)
            finally:
                own = self._open.pop()
                caller = self._open[-1]
                self._calls[part] += 1
                self._inner_calls[caller[0]] += 1
                took = time.perf_counter() - began
                self.seconds[part] += took - own[1]
                caller[1] += took

        return wrapped

    def own_seconds(self, total: float) -> dict[str, float]:
        """Return seconds by part; ``total`` is that of everything, timers included."""
        inside, outside = _timer_cost()
        seconds = dict(self.seconds) | {"driver": total - self._open[0][1]}
        return {
            part: max(0.0, s - inside * self._calls[part] - outside * self._inner_calls[part])
            for part, s in seconds.items()
        }


def _timer_cost(calls: int = 20_000) -> tuple[float, float]:
    """Return what a timer adds to the part it times, and what to the caller [s]."""

    def nothing() -> None:
        pass

    profile = Profile()
    timed = profile.timed("nothing", nothing)
    plain, whole = (_duration(work, calls) / calls for work in (nothing, timed))
    recorded = profile.seconds["nothing"] / calls
    return recorded - plain, whole - recorded


def _duration(work: Callable[[], object], calls: int) -> float:
    began = time.perf_counter()
    for _ in range(calls):
        work()
    return time.perf_counter() - began


@dataclass(frozen=True)
class Cut:
    """What one opening test took."""

    mesh: str
    n_quad: int
    angle: float
    """Reached [degrees]."""
    n_step: int
    set_up_seconds: float
    run_seconds: float
    closing_seconds: float
    cpu_seconds: float
    """User and system time of run and closing."""
    n_split: int
    n_broken: int
    imbalance: float
    """Of the energy at the end, relative."""
    memory_growth: float
    """Of the resident set over the run, before closing [bytes]."""
    parts: dict[str, float]
    """Profile [ns a quad and step]; together the run with its closing, but for medians of each."""
    profile_scale: float
    """By which the profiled run's parts were multiplied."""
    not_found: list[str]
    """Methods that could not be timed; theirs is in the part that calls them."""

    @property
    def wall_seconds(self) -> float:
        """Everything from the call of opening_test to the closed files."""
        return self.set_up_seconds + self.run_seconds + self.closing_seconds

    @property
    def all_but_shells(self) -> float:
        """Parts that the film alone does not have [ns a quad and step]."""
        return sum(ns for part, ns in self.parts.items() if part not in OF_THE_FILM)


class _TimedRecorder:
    """A Recorder whose calls and closing are timed."""

    def __init__(self, recorder: Recorder, profile: Profile | None) -> None:
        self.due, self._call = recorder.due, recorder.__call__
        if profile is not None:
            self.due = profile.timed("history and result file", self.due)
            self._call = profile.timed("history and result file", self._call)
        self._close = recorder.close
        self.closing_seconds = self.measuring_seconds = 0.0
        self.memory = 0.0
        """Resident when the run ended, before closing [bytes]."""

    def __call__(self, sim: Simulation) -> None:
        self._call(sim)

    def close(self) -> None:
        began = time.perf_counter()
        self.memory = resident()
        measured = time.perf_counter()
        self._close()
        self.measuring_seconds += measured - began
        self.closing_seconds += time.perf_counter() - measured


def time_of_angle(case: Case, angle: float) -> float:
    """Return when the tool has turned by an angle in degrees [s]."""
    motion, goal = case.simulation.motion, math.radians(angle)
    assert motion is not None
    low, high = 0.0, case.duration
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if motion.coordinate(middle) < goal else (low, middle)
    return high


@dataclass(frozen=True)
class _Run:
    run_seconds: float
    closing_seconds: float
    cpu_seconds: float
    memory_growth: float


def _run(case: Case, until: float, profile: Profile | None) -> _Run:
    """Run to a time with a Recorder that writes to a folder of its own."""
    sim = case.simulation
    with tempfile.TemporaryDirectory() as folder:
        # Rows and frames as dense in time as those of the whole cut.
        share = until / case.duration
        recorder = Recorder(
            sim,
            Path(folder),
            until=until,
            name=case.name,
            n_row=max(1, round(1900 * share)),
            n_frame=max(1, round(FRAMES * share)),
            n_snapshot=0,
            progress=False,
        )
        hook, before = _TimedRecorder(recorder, profile), resident()
        began, cpu = time.perf_counter(), time.process_time()
        sim.run(until, [hook])
        wall, cpu = time.perf_counter() - began, time.process_time() - cpu
    closing = hook.closing_seconds
    return _Run(wall - closing - hook.measuring_seconds, closing, cpu, hook.memory - before)


def profile_parts(mesh: str, angle: float) -> tuple[dict[str, float], list[str]]:
    """Return own times by part [ns a quad and step] of a run to an angle, closing left out."""
    case = opening_test(mesh)  # type: ignore[arg-type]
    sim, profile = case.simulation, Profile()
    not_found = []
    for part, names in METHODS.items():
        for name in names:
            *path, method = name.split(".")
            owner: Any = sim
            for attribute in path:
                owner = getattr(owner, attribute, None)
            try:
                setattr(owner, method, profile.timed(part, getattr(owner, method)))
            except AttributeError:
                not_found.append(name)
    seconds = _run(case, time_of_angle(case, angle), profile).run_seconds
    ns = 1e9 / (sim.state.step * sim.mesh.n_quad)
    return {part: ns * s for part, s in profile.own_seconds(seconds).items()}, not_found


def compile_all(mesh: str = "quick") -> None:
    """Compile what a run with a Recorder needs, pictures' import included."""
    warmup()
    case = opening_test("quick")
    _run(case, time_of_angle(case, 1.0), None)


def measure(mesh: str, angle: float = ANGLE, profiled: float = PROFILED, *, times: int = 1) -> Cut:
    """Time an opening test to an angle and profile a part of it, so many times in all.

    Returns the run of median length, with the medians of all parts.
    """
    compile_all(mesh)
    cuts = [_measured(mesh, angle, profiled) for _ in range(times)]
    middle = sorted(cuts, key=lambda cut: cut.wall_seconds)[times // 2]
    parts = {part: statistics.median(c.parts[part] for c in cuts) for part in middle.parts}
    return replace(middle, parts=parts)


def _measured(mesh: str, angle: float, profiled: float) -> Cut:
    began = time.perf_counter()
    case = opening_test(mesh)  # type: ignore[arg-type]
    set_up = time.perf_counter() - began
    sim = case.simulation
    run = _run(case, time_of_angle(case, angle), None)
    ns = 1e9 / (sim.state.step * sim.mesh.n_quad)
    profile, not_found = profile_parts(mesh, profiled * angle)
    scale = ns * run.run_seconds / sum(profile.values())
    parts = {part: scale * own for part, own in profile.items()}
    ledger = sim.close_ledger()
    assert sim.motion is not None
    return Cut(
        mesh=mesh,
        n_quad=sim.mesh.n_quad,
        angle=math.degrees(sim.motion.coordinate(sim.state.time)),
        n_step=sim.state.step,
        set_up_seconds=set_up,
        run_seconds=run.run_seconds,
        closing_seconds=run.closing_seconds,
        cpu_seconds=run.cpu_seconds,
        n_split=len(sim.state.split_log),
        n_broken=sim.cables.n_broken,
        imbalance=ledger.relative(ledger.imbalance),
        memory_growth=run.memory_growth,
        parts=parts | {"closing": ns * run.closing_seconds},
        profile_scale=scale,
        not_found=not_found,
    )

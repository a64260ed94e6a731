"""What a step costs: nanoseconds a quad and step over the size of the mesh.

Measured are the forces of the elements alone and the whole step (damping on, default values, no
tool) of a clamped disc under pressure. A figure is the median over windows of some steps; kernel
and step take turns, so that both see the same machine. The evaluation of the stable step, which the
default does for some quads every so many steps and for all quads every tenth time, is timed by
itself and spread over the steps between; the whole step counts it.
"""

from __future__ import annotations

import hashlib
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from benchmarks.discs import SIZES, accepts_threads, build_mesh, pressurised_disc
from benchmarks.harness import child
from benchmarks.traffic import bytes_per_step
from shellcut import Mesh, Simulation, Stepping

# Arithmetic of the shortest exact path, counted by hand.
FLOPS_A_QUAD, FLOPS_A_NODE = 565, 66

_WINDOW = 0.02  # s, long against the clock's resolution
_MOST_STEPS = 400  # in all windows together: the disc has not swung far by then
_FOLLOWED_TENTH = 10  # evaluations until all quads have been evaluated once
_LARGEST_EVALUATED = 110_000  # quads; beyond, the share of this size is taken

NO_THREADS = "Simulation has no option threads"


@dataclass(frozen=True)
class StepCost:
    """Costs of one mesh, material and number of threads [ns a quad and step]."""

    name: str
    n_quad: int
    n_node: int
    material: str
    threads: int
    kernel: float
    kernel_best: float
    plain_step: float
    """Whole step without evaluations of the stable step."""
    plain_step_best: float
    evaluation: float
    """Evaluations of the stable step, spread over the steps."""
    bytes_a_quad: float | None
    """What a step reads and writes at the least; None if it could not be found out."""
    set_up_seconds: float
    cores: float
    """CPU over wall time of the windows: below the number of threads where others ran."""

    @property
    def step(self) -> float:
        """Whole step."""
        return self.plain_step + self.evaluation

    def arithmetic_floor(self, gflops: float) -> float:
        """Return the time of the arithmetic alone at the double peak [ns a quad and step]."""
        return (FLOPS_A_QUAD + FLOPS_A_NODE * self.n_node / self.n_quad) / gflops

    def memory_floor(self, gbytes: float) -> float | None:
        """Return the time of the memory traffic alone [ns a quad and step]."""
        return None if self.bytes_a_quad is None else self.bytes_a_quad / gbytes


def _windows(sim: Simulation, repeats: int) -> tuple[list[float], list[float]]:
    """Return seconds a call of the element forces and of the step, by window."""

    def forces() -> None:
        sim.shell.add_forces(sim.state)

    kernels, steps = [], []
    n_kernel, n_step = _calls(forces, repeats), _calls(sim.step, repeats)
    for _ in range(repeats):
        kernels.append(_seconds_a_call(forces, n_kernel))
        steps.append(_seconds_a_call(sim.step, n_step))
    return kernels, steps


def _calls(work: Callable[[], None], repeats: int) -> int:
    work()
    one = _seconds_a_call(work, 1)
    return max(1, min(int(_WINDOW / one), _MOST_STEPS // repeats))


def _seconds_a_call(work: Callable[[], None], calls: int) -> float:
    began = time.perf_counter()
    for _ in range(calls):
        work()
    return (time.perf_counter() - began) / calls


def evaluation_cost(mesh: Mesh, material: str, threads: int) -> float:
    """Return the evaluations of the stable step over the steps they serve [s a step]."""
    sim = pressurised_disc(mesh, material, threads=threads, evaluate_every=2)
    plain: list[float] = []
    evaluated: list[float] = []
    for k in range(2 * _FOLLOWED_TENTH + 1):
        (evaluated if k % 2 else plain).append(_seconds_a_call(sim.step, 1))
    extra = sum(evaluated) - len(evaluated) * statistics.median(plain)
    return max(0.0, extra) / (_FOLLOWED_TENTH * Stepping().evaluate_every)


def measure_one(
    name: str,
    material: str,
    threads: int,
    *,
    repeats: int,
    accesses: dict[str, int] | None,
    evaluation: float | None,
) -> StepCost:
    """Measure one mesh; ``evaluation`` [ns a quad and step] is measured too unless given."""
    mesh = build_mesh(SIZES[name])
    began = time.perf_counter()
    sim = pressurised_disc(mesh, material, threads=threads)
    set_up = time.perf_counter() - began
    wall, cpu = time.perf_counter(), time.process_time()
    kernels, steps = _windows(sim, repeats)
    cores = (time.process_time() - cpu) / (time.perf_counter() - wall)
    ns = 1e9 / mesh.n_quad
    if evaluation is None:
        evaluation = ns * evaluation_cost(mesh, material, threads)
    return StepCost(
        name=name,
        n_quad=mesh.n_quad,
        n_node=mesh.n_node,
        material=material,
        threads=threads,
        kernel=ns * statistics.median(kernels),
        kernel_best=ns * min(kernels),
        plain_step=ns * statistics.median(steps),
        plain_step_best=ns * min(steps),
        evaluation=evaluation,
        bytes_a_quad=bytes_per_step(sim, accesses) / mesh.n_quad if accesses else None,
        set_up_seconds=set_up,
        cores=cores,
    )


def measure(
    names: Sequence[str] = tuple(SIZES),
    *,
    materials: Sequence[str] = ("linear", "points", "laminate"),
    threads: Sequence[int] = (1, 2),
    repeats: int = 7,
    say: Callable[[str], None] = print,
) -> list[StepCost]:
    """Measure all meshes, the sections with their own figure and the threads there are.

    The laminate on one thread only, and on the meshes of the opening test. Two threads are left out
    where the library cannot choose them.
    """
    costs = []
    say(HEAD)
    for material in materials:
        try:
            accesses = child("traffic", material)
        except RuntimeError as error:
            accesses = None
            say(f"memory floor of {material} left out: {error}")
        for n_thread in threads:
            if n_thread != 1 and not accepts_threads():
                say(f"{n_thread} threads, {material}: skipped, {NO_THREADS}")
                continue
            evaluation: float | None = None
            for name in names:
                if material == "laminate" and name not in ("M1", "M2"):
                    continue
                if n_thread != 1 and material == "laminate":
                    continue
                too_large = _quads(name) > _LARGEST_EVALUATED
                cost = measure_one(
                    name,
                    material,
                    n_thread,
                    repeats=repeats,
                    accesses=accesses,
                    evaluation=evaluation if too_large else None,
                )
                evaluation = cost.evaluation
                costs.append(cost)
                say(row(cost))
    return costs


def _quads(name: str) -> float:
    return {"M1": 2660.0, "M2": 8625.0}.get(name) or float(name)


def same_bits(name: str = "1e5", steps: int = 50) -> bool | None:
    """Whether one and two threads give the same positions, bit for bit; None if not choosable."""
    if not accepts_threads():
        return None
    digests = set()
    for threads in (1, 2):
        mesh = build_mesh(SIZES[name])
        sim = pressurised_disc(mesh, "linear", threads=threads)
        for _ in range(steps):
            sim.step()
        digests.add(hashlib.sha256(sim.state.node.x[: mesh.n_node].tobytes()).hexdigest())
    return len(digests) == 1


HEAD = (
    f"{'mesh':>5} {'quads':>8} {'material':>13} {'thr':>3} {'kernel':>8} {'best':>8} "
    f"{'step':>8} {'best':>8} {'dt eval':>8} {'whole':>8} {'cores':>5}  (ns a quad and step)"
)


def row(c: StepCost) -> str:
    """Return the figures of a mesh as a line of text."""
    return (
        f"{c.name:>5} {c.n_quad:>8} {c.material:>13} {c.threads:>3} {c.kernel:>8.1f} "
        f"{c.kernel_best:>8.1f} {c.plain_step:>8.1f} {c.plain_step_best:>8.1f} "
        f"{c.evaluation:>8.2f} {c.step:>8.1f} {c.cores:>5.2f}"
    )

"""The pressurised disc in other programs, in the same run: CPU a quad and step, and the answer.

A flat disc, clamped at its rim, meets a dead pressure as a step at t = 0, without damping; read are
the first peak of the middle and its time. All programs get the same mesh and dead load; OpenSees
also our nodal masses and nine tenths of our step, CalculiX takes its own. Counted is the user and
system time of one thread over the steps alone, without set-up.

The programs run if they are there: OpenSees (``pip install openseespy``), CalculiX
(``apt-get install calculix-ccx``).
"""

from __future__ import annotations

import importlib.util
import shutil
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.calculix_disc import run_calculix
from benchmarks.discs import RADIUS, accepts_threads
from benchmarks.harness import child
from shellcut import Mesh, Pressure, ShellMaterial, Simulation, Support
from shellcut.mesh.structured import disc

Array = np.ndarray[Any, Any]

YOUNG, POISSON, DENSITY, THICKNESS = 1678.0, 0.3, 1.0e-9, 0.074
PRESSURE = 0.05  # MPa
END = 9.0e-5  # s, after the first peak

MESHES = {"full": (34, 11), "quick": (16, 5)}
"""2,652 and 576 quads; n_side and n_layer of :func:`disc`."""

OURS, CALCULIX = "shellcut", "CalculiX S4R"
OPENSEES = {
    "OpenSees ASDShellQ4 corotational": ("ASDShellQ4", "-corotational"),
    "OpenSees ShellMITC4 updateBasis": ("ShellMITC4", "-updateBasis"),
}


@dataclass(frozen=True)
class Disc:
    """The model as every program takes it."""

    mesh: Mesh
    mass: Array
    """Lumped by row sums [t], shape (n_node,)."""
    inertia: Array
    """Rotary, scaled as ours: mass max(h²/12, A/8) [t·mm²], shape (n_node,)."""
    load: Array
    """Dead force along z, lumped as the mass [N], shape (n_node,)."""
    middle: int
    """Node in the middle."""


@dataclass(frozen=True)
class PeerRun:
    """One program on the disc."""

    program: str
    n_quad: int
    n_step: int
    step: float
    """Its time step [s]."""
    cpu_ns: float
    """CPU a quad and step [ns]."""
    peak: float
    """[mm]"""
    peak_time: float
    """[s]"""

    @property
    def cpu_seconds(self) -> float:
        """CPU of all steps."""
        return self.cpu_ns * self.n_quad * self.n_step * 1e-9


def build(n_side: int, n_layer: int) -> Disc:
    """Mesh the disc and lump mass, inertia and load by 2 x 2 Gauss points."""
    mesh = disc(RADIUS, n_side=n_side, n_layer=n_layer)
    corners = mesh.nodes[mesh.quads]
    share = np.zeros(mesh.quads.shape)
    g = 1.0 / np.sqrt(3.0)
    signs = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    for xi, eta in g * signs:
        a, b = 1.0 + signs[:, 0] * xi, 1.0 + signs[:, 1] * eta
        tangents = [
            np.einsum("a,eai->ei", 0.25 * slope, corners)
            for slope in (signs[:, 0] * b, signs[:, 1] * a)
        ]
        share += 0.25 * a * b * np.linalg.norm(np.cross(*tangents), axis=1)[:, None]
    rotary = np.maximum(THICKNESS**2 / 12.0, share.sum(axis=1) / 8.0)[:, None]
    area, inertia = np.zeros(mesh.n_node), np.zeros(mesh.n_node)
    np.add.at(area, mesh.quads, share)
    np.add.at(inertia, mesh.quads, DENSITY * THICKNESS * share * rotary)
    return Disc(
        mesh=mesh,
        mass=DENSITY * THICKNESS * area,
        inertia=inertia,
        load=PRESSURE * area,
        middle=int(mesh.node_set("centre")[0]),
    )


def first_peak(times: Array, heights: Array) -> tuple[float, float]:
    """Return time and height of the highest point, by a parabola through seven samples."""
    k = int(np.argmax(heights))
    near = slice(max(0, k - 3), k + 4)
    c2, c1, c0 = np.polyfit(times[near] - times[k], heights[near], 2)
    return float(times[k] - 0.5 * c1 / c2), float(c0 - 0.25 * c1 * c1 / c2)


def run_ours(model: Disc) -> PeerRun:
    """Run the disc on one thread, after a few steps to warm up."""
    options: dict[str, Any] = {"threads": 1} if accepts_threads() else {}

    def start() -> Simulation:
        return Simulation(
            model.mesh,
            ShellMaterial.homogeneous(
                young=YOUNG, poisson=POISSON, density=DENSITY, thickness=THICKNESS
            ),
            supports=[Support.clamped("rim")],
            loads=[Pressure(PRESSURE)],
            damping_alpha=0.0,
            damping_beta=0.0,
            **options,
        )

    start().run(0.02 * END)
    sim, cpu = start(), 0.0
    times, heights = [], []
    while sim.state.time < END:
        began = time.process_time()
        sim.step()
        cpu += time.process_time() - began
        times.append(sim.state.time)
        heights.append(sim.state.node.x[model.middle, 2])
    when, height = first_peak(np.array(times), np.array(heights))
    steps, quads = len(times), model.mesh.n_quad
    return PeerRun(OURS, quads, steps, times[-1] / steps, 1e9 * cpu / steps / quads, height, when)


def run_opensees(program: str, model: Disc, step: float, folder: Path) -> PeerRun:
    """Run the disc in OpenSees, in a process of its own, by central differences."""
    mesh = model.mesh
    file = folder / "disc.npz"
    np.savez(
        file,
        nodes=mesh.nodes,
        quads=mesh.quads,
        rim=mesh.node_set("rim"),
        mass=model.mass,
        inertia=model.inertia,
        load=model.load,
        middle=model.middle,
        section=[YOUNG, POISSON, THICKNESS],
    )
    element, option = OPENSEES[program]
    steps = int(END / step)
    said = child("opensees_disc", str(file), element, option, str(step), str(steps))
    heights = np.array(said["heights"])
    when, height = first_peak(step * np.arange(1, steps + 1), heights)
    cpu = 1e9 * said["cpu"] / steps / mesh.n_quad
    return PeerRun(program, mesh.n_quad, steps, step, cpu, height, when)


def measure(mesh: str | tuple[int, int] = "full") -> tuple[list[PeerRun], dict[str, str]]:
    """Run the disc in every program there is; return the runs, and why others did not run."""
    model = build(*(MESHES[mesh] if isinstance(mesh, str) else mesh))
    ours = run_ours(model)
    runs, missing = [ours], {}
    with tempfile.TemporaryDirectory() as folder:
        jobs: dict[str, Callable[[], PeerRun]] = {}
        for program in OPENSEES:
            if importlib.util.find_spec("openseespy") is None:
                missing[program] = "not installed: pip install openseespy"
            else:
                # A tenth shorter than ours: these elements are stiffer by their drilling.
                jobs[program] = lambda program=program: run_opensees(  # type: ignore[misc]
                    program, model, 0.9 * ours.step, Path(folder)
                )
        if shutil.which("ccx") is None:
            missing[CALCULIX] = "not installed: apt-get install calculix-ccx"
        else:
            jobs[CALCULIX] = lambda: _run_calculix(model, Path(folder))
        for program, job in jobs.items():
            try:
                runs.append(job())
            except RuntimeError as error:
                missing[program] = f"could not run: {error}"
    return runs, missing


def _run_calculix(model: Disc, folder: Path) -> PeerRun:
    section = (YOUNG, POISSON, DENSITY, THICKNESS)
    run = run_calculix(model.mesh, PRESSURE, model.middle, section, END, folder)
    when, height = first_peak(run.times, run.heights)
    quads = model.mesh.n_quad
    return PeerRun(CALCULIX, quads, run.n_step, run.step, run.cpu_ns / quads, height, when)

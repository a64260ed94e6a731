"""Lines of a run: its model at the start, energies and cracks during the run."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from shellcut.checks import Sweep, edge_line
from shellcut.formats.errors import counted
from shellcut.mesh.mesh import Mesh
from shellcut.tool.tool import Tool
from shellcut.unit import pretty, shown, with_unit
from shellcut.view.progress import duration, percent

if TYPE_CHECKING:
    from shellcut.simulation.simulation import Simulation

    from .resistance import AnyResistance

# Time of a step and of each quad of it [s], from the opening test on M1 and M2 in
# docs/performance.md; how many times that if all of the film yields.
_STEP_COST, _QUAD_COST, _YIELDING = 45e-6, 37e-9, 5.0

# Smallest energy that is said, over the largest.
_SAID = 1e-4


def start_lines(
    sim: Simulation, resistance: AnyResistance, until: float, sweep: Sweep | None = None
) -> Iterator[str]:
    """Yield lines on film, tool, cuts, motion and estimated run time up to ``until`` [s]."""
    n_supported = int(sim.state.node.supported[: sim.mesh.n_node].sum())
    film, *others = part_lines(sim.mesh, n_supported, sim.tool, sweep)
    yield f"{film}, {with_unit(sim.material.thickness, 'mm')} thick"
    yield from (*others, crack_line(sim))
    r = resistance
    yield (
        f"motion to {r.coordinate_name} {with_unit(r.coordinate(until), r.coordinate_unit)} in "
        f"{1e3 * until:.4g} ms; output: {r.meaning}"
    )
    yield (
        f"time   {how_long(sim, until)}: about {round(until / sim.dt, -2):,.0f} steps, the first "
        f"of {sim.dt:.4g} s"
    )


def part_lines(
    mesh: Mesh | None, n_supported: int, tool: Tool | None, sweep: Sweep | None
) -> Iterator[str]:
    """Yield a line each on what there is of a film with supported nodes, its tool and the cuts."""
    if mesh is not None:
        sides, (unit, per) = mesh.edge_lengths(), shown("mm")
        yield (
            f"film   {mesh.n_node:,} nodes, {mesh.n_quad:,} quads with sides of "
            f"{per * sides.min():.3g} to {per * sides.max():.3g} {unit}, "
            f"{with_unit(mesh.quad_areas().sum(), 'mm^2')}, {n_supported:,} nodes supported"
        )
    if tool is not None:
        length = sum(chain.length for chain in tool.chains())
        yield (
            f"tool   {counted(tool.n_body, 'body', 'bodies')}, {tool.n_triangle:,} triangles, "
            f"{counted(tool.n_chain, 'cutting edge')}, {with_unit(length, 'mm')}"
        )
    if sweep is not None:
        yield edge_line(sweep)


def status_line(sim: Simulation, resistance: AnyResistance, share: float) -> str:
    """Return a status line: coordinate, resistance, energies, imbalance, crack and cables.

    ``share`` is the completed part of the run, 0 to 1.
    """
    r, s = resistance, sim.state
    (figure, unit), (of_energy, per) = r.columns[0], shown("N*mm")
    entries = sim.ledger.entries()
    least = _SAID * max(map(abs, entries.values()))
    energies = ", ".join(
        f"{name} {per * energy:.4g}" for name, energy in entries.items() if abs(energy) > least
    )
    felt, missed = r.felt(sim)[0], sim.imbalance
    imbalance = "" if missed is None else f"imbalance {with_unit(100.0 * missed, '%')} | "
    return (
        f"{percent(share)} %: {r.coordinate_name} "
        f"{with_unit(r.coordinate(s.time), r.coordinate_unit)}, {figure} {with_unit(felt, unit)} | "
        f"E: {energies} {pretty(of_energy)} | "
        f"{imbalance}crack {with_unit(s.crack_length, 'mm')}, {counted(s.n_cable, 'cable')}, "
        f"{sim.cables.n_joint_made:,} met by the blade, {sim.cables.n_broken:,} broken"
    )


def crack_line(sim: Simulation) -> str:
    """Say where cracks can run, and which options restrict them to sides of quads."""
    if sim.cracks is None:
        return "cracks none: the model has no cohesive law"
    if sim.fracture.path == "free":
        return (
            "cracks through the quads of the mesh, where blade or load drives them "
            '(fracture.path = "free")'
        )
    asked = ", ".join(
        f"{name} = {getattr(sim.fracture, name)!r}" for name in sim.fracture.only_along_edges
    )
    which = f", because of {asked}" if asked else ""
    return f'cracks along sides of quads only (fracture.path = "edges"){which}'


def how_long(sim: Simulation, until: float) -> str:
    """Say about how long a run up to ``until`` [s] takes."""
    seconds = until / sim.dt * (_STEP_COST + _QUAD_COST * sim.mesh.n_quad)
    longer = "" if sim.material.is_linear else f", {_YIELDING:g} times that if all of it yields"
    return f"about {duration(np.ceil(seconds))} on a free core{longer}"

"""Status lines of a run: its model at the start, energies and cracks as it proceeds."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from shellcut.checks import Sweep, edge_line
from shellcut.formats.errors import counted
from shellcut.view.progress import percent

if TYPE_CHECKING:
    from shellcut.simulation.simulation import Simulation

    from .resistance import AnyResistance

# Time of a step [s] from the opening test in docs/performance.md, M1 and M2 on one free core: a
# constant part and a part per quad.
_STEP_COST, _QUAD_COST = 50e-6, 48e-9

# Smallest energy that is said, over the largest.
_SAID = 1e-4


def start_lines(
    sim: Simulation, resistance: AnyResistance, until: float, sweep: Sweep | None = None
) -> Iterator[str]:
    """Yield lines on film, tool, time step and estimated run time.

    Parameters
    ----------
    sim : Simulation
        Before its first step.
    resistance : Resistance or SupportPull
        To the motion of its tool or supports.
    until : float
        End of the run [s].
    sweep : Sweep, optional
        Path of the cutting edges, to report the cuts.
    """
    mesh, tool = sim.mesh, sim.tool
    edges = mesh.edge_lengths()
    held = int(sim.state.node.supported[: mesh.n_node].sum())
    yield (
        f"film   {mesh.n_quad:,} quads, {mesh.n_node:,} nodes, {held:,} of them held, edges "
        f"{edges.min():.3g} to {edges.max():.3g} mm, {sim.material.thickness:.3g} mm thick"
    )
    if tool is not None:
        length = sum(chain.length for chain in tool.chains())
        yield (
            f"tool   {counted(tool.n_body, 'body', 'bodies')}, {tool.n_triangle:,} triangles, "
            f"{counted(tool.n_chain, 'cutting edge')}, {length:.4g} mm"
        )
    if sweep is not None:
        yield edge_line(sweep)
    if sim.cracks is not None:
        yield f"cracks {_way_of_cracks(sim)}"
    r = resistance
    yield f"shown  {r.meaning}, over the {r.coordinate_name}"
    n_step = until / sim.dt
    cost = n_step * (_STEP_COST + _QUAD_COST * mesh.n_quad)
    yield (
        f"step   {sim.dt:.4g} s at first, so about {round(n_step, -2):,.0f} steps to "
        f"{r.coordinate_name} {r.coordinate(until):.4g} {r.coordinate_unit}, {1e3 * until:.4g} ms; "
        f"about {_rough(cost)} on a free core"
    )


def status_line(sim: Simulation, resistance: AnyResistance, share: float) -> str:
    """Return a status line: coordinate, resistance, energies, balance, crack and cables.

    Parameters
    ----------
    sim : Simulation
        After a complete step.
    resistance : Resistance or SupportPull
        To the motion of its tool or supports.
    share : float
        Completed part of the run, 0 to 1.
    """
    r, s, ledger = resistance, sim.state, sim.ledger
    figure, unit = r.columns[0]
    entries = ledger.entries()
    least = _SAID * max(map(abs, entries.values()))
    energies = ", ".join(
        f"{name} {energy:.4g}" for name, energy in entries.items() if abs(energy) > least
    )
    felt = r.felt(sim)[0]
    return (
        f"{percent(share)} %: {r.coordinate_name} {r.coordinate(s.time):.4g} "
        f"{r.coordinate_unit}, {figure} {felt:.4g} {unit} | "
        f"E: {energies} N*mm | balance {100.0 * ledger.relative(ledger.imbalance):+.2f} % | "
        f"crack {s.crack_length:.4g} mm, cables {s.n_cable} made "
        f"{sim.cables.n_joint_made} jointed {sim.cables.n_broken} broken"
    )


def _way_of_cracks(sim: Simulation) -> str:
    """Return where cracks go, and which options let them go along edges only."""
    if sim.fracture.path == "free":
        return "through the quads of the mesh"
    asked = ", ".join(
        f"{name} = {getattr(sim.fracture, name)!r}" for name in sim.fracture.only_along_edges
    )
    return "along edges of the mesh" + (f", which {asked} asks for" if asked else "")


def _rough(seconds: float) -> str:
    """Return a time rounded as an estimate deserves."""
    for size, unit in ((3600.0, "h"), (60.0, "min")):
        if seconds >= 2.0 * size:
            return f"{seconds / size:.0f} {unit}"
    return f"{np.ceil(seconds):.0f} s"

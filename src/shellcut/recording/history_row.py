"""One row of ``history.csv``: its values and units at one moment."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from shellcut.results.steady_window import CUT_LENGTH, PROCESS_ZONE, TO_SPARE, UNCUT_AHEAD

from .cut_front import CutFront
from .resistance import AnyResistance

if TYPE_CHECKING:
    from shellcut.simulation.simulation import Simulation


def history_row(
    sim: Simulation, resistance: AnyResistance, front: CutFront, *, unfelt: float
) -> Iterator[tuple[str, str, float]]:
    """Yield name, unit and value of every column: time, coordinate and plotted figure first.

    ``unfelt`` is the penetration between nodes, which nodal contact misses, when last measured
    [mm].
    """
    s, r = sim.state, resistance
    yield "time", "s", s.time
    yield r.coordinate_name, r.coordinate_unit, r.coordinate(s.time)
    yield from r.row(sim)
    ledger = sim.close_ledger()
    for name, energy in vars(ledger).items():
        yield name, "N*mm", energy
    yield "imbalance", "N*mm", ledger.imbalance
    yield "imbalance_rel", "-", ledger.relative(ledger.imbalance)
    yield "dt", "s", s.dt
    if sim.pace.share is not None:
        yield "pace", "-", sim.pace.now
    yield "cables_created", "-", s.n_cable
    yield "cables_jointed", "-", sim.cables.n_joint_made
    yield "cables_broken", "-", sim.cables.n_broken
    yield "crack_length", "mm", s.crack_length
    for edge, (length, zone, ahead, spare) in enumerate(front.rows(sim).tolist(), start=1):
        yield f"{CUT_LENGTH}{edge}", "mm", length
        yield f"{PROCESS_ZONE}{edge}", "mm", zone
        yield f"{UNCUT_AHEAD}{edge}", "mm", ahead
        yield f"{TO_SPARE}{edge}", "mm", spare
    if sim.contact is not None:
        yield "deepest_penetration", "mm", sim.contact.forces.deepest
        yield "unfelt_penetration", "mm", unfelt

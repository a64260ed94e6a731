"""All checks of a model."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from shellcut.arguments import checked
from shellcut.arrays import Bools

from .finding import DOUBT, NOTE, REFUSE, Finding, RefusedModel
from .hold import check_held_film, check_hold, check_one_motion
from .path import check_path, check_sides
from .place import check_touch, meeting_remedy
from .plausible import check_motion, check_numbers, check_steps
from .row import Rows
from .strength import check_glue, check_piercing, check_strength
from .sweep import Sweep

if TYPE_CHECKING:
    from shellcut.simulation.simulation import Simulation

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class ModelCheck:
    """Findings of the checks of a model."""

    findings: tuple[Finding, ...]
    """Refusals first, then doubts, then notes."""
    sweep: Sweep | None
    """Path of the cutting edges; None without a tool."""

    def of(self, severity: str) -> tuple[Finding, ...]:
        """Return the findings of one severity."""
        return tuple(finding for finding in self.findings if finding.severity == severity)

    def enforce(self, *, force: bool = False) -> None:
        """Raise the refusals.

        Parameters
        ----------
        force : bool
            Ignore refusals that can be overridden.

        Raises
        ------
        RefusedModel
            Lists every refusal.
        """
        if refused := [f for f in self.of(REFUSE) if not (force and f.forcible)]:
            raise RefusedModel(refused)

    @property
    def doubts(self) -> tuple[Finding, ...]:
        """Doubts, and refusals that were overridden."""
        return (*self.of(REFUSE), *self.of(DOUBT))

    def say(self) -> None:
        """Log doubts and notes as warnings of the library."""
        for finding in self.doubts:
            _log.warning("distrust: %s", finding)
        for finding in self.of(NOTE):
            _log.warning("note: %s", finding)


def support_of(sim: Simulation) -> Bools:
    """Return the fixed components of each node of the mesh, by supports and glue, (n_node, 6)."""
    support = sim.state.node.support[: sim.mesh.n_node].copy()
    fixed = sim.terms.fixed_nodes(sim.state)
    support[fixed[fixed < sim.mesh.n_node], :3] = True  # cuts have added others
    return support


@checked
def check_model(simulation: Simulation, until: float) -> ModelCheck:
    """Check a model before its run; nothing in it is changed.

    Parameters
    ----------
    simulation : Simulation
        Before its first step. :class:`Recorder`, :meth:`Case.run` and ``shellcut run`` call this
        themselves; call it yourself before your own loop over :meth:`Simulation.run`.
    until : float
        End of the run [s].

    Examples
    --------
    >>> from shellcut import CohesiveLaw, guillotine
    >>> case = guillotine(1.0, length=6.0, width=4.0, notch=1.0, travel=1.5)
    >>> check_model(case.simulation, case.duration).findings
    ()
    >>> case = guillotine(1.0, length=6.0, notch=1.0, travel=1.5, law=CohesiveLaw(strength=18e6))
    >>> print(check_model(case.simulation, case.duration).findings[0].came)
    strength 1.8e+07 MPa is 1.073e+04 times the film's modulus, 1678 MPa: this film would never tear
    """
    sim = simulation
    sweep = None
    motion = sim.motion_in_film
    if sim.tool is not None and sim.tool.n_edge and motion is not None:
        sweep = Sweep.of(sim.mesh, sim.tool, motion, until)
    order = {REFUSE: 0, DOUBT: 1, NOTE: 2}
    found = sorted(_findings(sim, sweep, until), key=lambda finding: order[finding.severity])
    return ModelCheck(tuple(found), sweep)


def _findings(sim: Simulation, sweep: Sweep | None, until: float) -> Iterator[Finding]:
    mesh, law = sim.mesh, sim.law
    support = support_of(sim)
    yield from check_numbers(mesh, sim.material, law, sim.tool)
    yield from check_strength(sim.material, law)
    led = sim.tool is not None and sim.tool.n_edge > 0
    yield from check_glue(sim.material, sim.terms, law is not None and not led)
    if sim.tool is None:
        return
    if sim.motion is not None:
        yield from check_motion(sim.motion, until)
    yield from check_hold(mesh, support)
    never_in = sweep is None or not len(sweep.place)
    remedy = meeting_remedy(sim, until) if never_in and sweep is not None else ""
    untouched = list(check_touch(sim, until, remedy)) if never_in else []
    yield from untouched
    if sweep is None:
        return  # a blunt tool has no edges whose way could be checked
    yield from check_held_film(sweep, support)
    if sim.film_motion is not None and len(sweep.place):
        yield from check_one_motion(sim.film_motion.misfit(until)[0], sweep.top_speed)
    along_edges = sim.fracture.path == "edges"
    if law is not None and not untouched:
        yield from check_path(mesh, support, sim.cables.at_edge, sweep, sim.fracture, remedy)
        touching = sim.contact is not None and sim.contact.film_edges is not None
        if sim.cracks is not None and touching and len(sweep.place):
            yield from check_sides(sweep, sim.cracks.bending_length, law)
        if sim.fracture.blade_cut and sim.fracture.puncture_force is None:
            yield from check_piercing(sim, law, sweep)
    edge = float(np.median(mesh.edge_lengths()))
    if len(sweep.place) and along_edges:
        edge = Rows(sweep).spacing
    fixed = sim.time_step.stepping.fixed
    yield from check_steps(
        dt=sim.dt,
        fixed=fixed,
        bound=np.inf if fixed is None else sim.time_step.largest_safe(sim.state),
        check_every=sim.fracture.check_every,
        duration=until,
        speed=sweep.top_speed,
        wave=max(layer.material.wave_speed for layer in sim.material.layers),
        edge_length=edge,
    )

"""A cut through any film by any tool on any motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats, Ints, product, unit
from shellcut.cables.cohesive_law import CohesiveLaw, CohesiveTable
from shellcut.checks.row import lies_under, row_of
from shellcut.checks.sweep import Sweep
from shellcut.fracture.notch_line import row_at
from shellcut.fracture.options import Fracture
from shellcut.loads.film_motion import FilmMotion, in_film
from shellcut.loads.supports import Support, SupportSet
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh
from shellcut.mitc4.initial_state import initial_state
from shellcut.simulation.simulation import Simulation
from shellcut.tool.motion import Motion, ScrewMotion, StraightMotion
from shellcut.tool.table_motion import TableMotion
from shellcut.tool.tool import Tool

from .case import Case, Clamp, CutOptions, Notch

if TYPE_CHECKING:
    from typing_extensions import Unpack

_ROUND_OFF = 1e-9

# Steps of a run, by which the motion of its film is followed: as many as a short run takes.
_STEPS = 2e4


@checked
def free_cut(
    mesh: Mesh,
    *,
    tool: Tool,
    motion: Motion,
    duration: Annotated[float, Option("s", "duration of the run", above=0)],
    notch: Notch = 0.0,
    clamp: Clamp = (),
    material: ShellMaterial | None = None,
    law: CohesiveTable | None = None,
    **options: Unpack[CutOptions],
) -> Case:
    """Build a cut from its parts.

    The notch lies along the path of the cutting edge that meets the film first, from there on.
    Along quad sides it ends at the last node of the path within its length, through quads at the
    first side of the mesh at or beyond it.

    Parameters
    ----------
    mesh : Mesh
        The film, flat or curved.
    tool, motion : Tool, Motion
        The cutter and how it moves.
    material, law : ShellMaterial, CohesiveTable, optional
        The paper's film by default.
    **options
        Options of :class:`Simulation`: ``supports`` besides ``clamp``, ``loads``, ``contact``, ...
        Without a ``fracture.path`` cracks follow quad sides if a line of them lies under the whole
        path, also where the tool would move after the run, and else run through quads.

    Returns
    -------
    Case
    """
    supports = [*map(Support.clamped, clamp), *options.get("supports", ())]
    seen = _seen_from_film(mesh, supports, motion, duration)
    fracture = with_path(mesh, tool, seen, duration, options.get("fracture"))
    options |= {"fracture": fracture, "supports": supports}
    through_quads, film = fracture.path == "free", mesh
    sweep = whole_sweep(mesh, tool, seen, duration) if notch and tool.n_edge else None
    if sweep and not through_quads:
        film = mesh.cut(_notch_nodes(sweep, notch))
    simulation = Simulation(
        film,
        material or ShellMaterial.homogeneous(),
        tool=tool,
        motion=motion,
        law=law or CohesiveLaw(),
        **options,
    )
    if sweep and through_quads:
        points, before = _notch_points(sweep, notch)
        outside = row_at(simulation.state, before) is None
        simulation.notch(*([before] if outside else []), *points)
    return Case("free", simulation, duration)


def _seen_from_film(
    mesh: Mesh, supports: Sequence[Support], motion: Motion, duration: float
) -> Motion:
    """Return the motion of a tool as seen from a film that its supports may move."""
    state, held = initial_state(mesh), SupportSet(mesh, supports)
    held.initialise(state)
    film = FilmMotion.of(held, state)
    if film is not None:
        film.begin(state, duration / _STEPS)
    return in_film(film, motion)


def with_path(
    mesh: Mesh, tool: Tool, motion: Motion, duration: float, fracture: Fracture | None
) -> Fracture:
    """Return the options of the cracks of a ready model with their path, ``"free"`` or ``"edges"``.

    It is along quad sides if another option needs it, or if a row of sides lies under the whole
    path of the cutting edges; else through the quads. A shorter run of the same motion has the same
    path.
    """
    cracks = fracture or Fracture()
    free = cracks.needed_path is None and tool.n_edge > 0
    if free and lies_under(whole_sweep(mesh, tool, motion, duration)):
        return replace(cracks, path="edges")
    return cracks.decided()


def whole_sweep(mesh: Mesh, tool: Tool, motion: Motion, duration: float) -> Sweep:
    """Return the path of the cutting edges however long the run is.

    A screw makes one turn or more, a straight motion takes the tool past the film, a table ends at
    its last row; other motions are known up to ``duration`` [s] only.
    """
    # Not isinstance: a derived class may move differently.
    if type(motion) is ScrewMotion:
        duration = max(duration, motion.ramp, 2.0 * np.pi / motion.angular_speed + motion.ramp / 2)
    elif type(motion) is StraightMotion:
        at_start = motion.pose(0.0).to_space(tool.vertices)
        along = unit(np.array(motion.direction, float))
        distance = product(mesh.nodes, along).max() - product(at_start, along).min()
        duration = max(duration, motion.ramp, distance / motion.speed + motion.ramp / 2)
    elif type(motion) is TableMotion:
        duration = max(duration, float(np.asarray(motion.times)[-1]))
    return Sweep.of(mesh, tool, motion, duration)


def _notch_nodes(sweep: Sweep, notch: float) -> Ints:
    """Return the nodes of a notch along the row of sides under the first edge, shape (n,)."""
    if not lies_under(sweep):
        raise ValueError(
            "a notch along quad sides needs a row of them under the whole path, got none: take "
            "path = 'free', or notch=0"
        )
    chain = row_of(sweep, _first_to_meet(sweep))
    distance = np.cumsum(np.linalg.norm(np.diff(sweep.mesh.nodes[chain], axis=0), axis=1))
    first = chain[: 1 + np.searchsorted(distance, notch * (1.0 + _ROUND_OFF), side="right")]
    if len(first) < 2:
        raise ValueError(
            f"the notch of {notch} mm must be at least one quad side of the path long, "
            f"{distance[0]:.4g} mm: lengthen it, or pass 0"
        )
    return np.asarray(first)


def _first_to_meet(sweep: Sweep) -> int:
    """Return the number of the cutting edge that meets the film first, -1 if none does."""
    begins = [(fate.first, fate.chain) for fate in sweep.fates if fate.first is not None]
    return min(begins, default=(0.0, -1))[1]


def _notch_points(sweep: Sweep, notch: float) -> tuple[Floats, Floats]:
    """Return the path of the first cutting edge in the film, of a given length, shape (n, 3) [mm].

    And the point a quad side before it, shape (3,): if outside the film, the notch begins at the
    border.
    """
    mine = sweep.along_edge & (sweep.chain == _first_to_meet(sweep))
    _, first = np.unique(sweep.time[mine], return_index=True)
    places = sweep.place[mine][first]
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    if not (steps > 0.0).any():
        raise ValueError(
            "a notch follows the path of a cutting edge, got none that moves through the film: "
            "pass notch=0, or check place and motion of the tool"
        )
    places, steps = places[np.append(True, steps > 0.0)], steps[steps > 0.0]
    distance = np.append(0.0, np.cumsum(steps))
    notch = min(notch, float(distance[-1]))
    n = int(np.searchsorted(distance, notch))
    end = [np.interp(notch, distance, axis) for axis in places.T]
    back = places[0] - sweep.edge_length[mine][0] / steps[0] * (places[1] - places[0])
    return np.array([*places[:n], end]), back

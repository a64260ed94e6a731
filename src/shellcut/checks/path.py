"""Check the path of the cutting edges through the film.

docs/howto/trust.md lists what is asked of it with the reasons, docs/limits.md by how much the force
is off where it is not kept.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

import numpy as np
import scipy

from shellcut.arrays import Bools, Floats
from shellcut.cables.cohesive_law import CohesiveTable
from shellcut.formats.errors import counted, named, point_text
from shellcut.mesh.mesh import Mesh

from .finding import Finding, doubt, note
from .row import Rows
from .sweep import Fate, Sweep

if TYPE_CHECKING:
    from shellcut.fracture.options import Fracture

ATTACK = np.radians(60.0)
"""Largest angle between the motion of a cutting edge and the direction in which it points."""
OFF_ROW = 0.1
"""Largest distance of a row of mesh edges, in edge lengths: the chords of a path that turns by a
right angle within six edges deviate by as much."""
NEAR_HELD = 0.5
"""Supported nodes closer than this to the path, in edge lengths, stop the blade."""
ONE_LINE = 0.2
"""Paths that are closer than this in a quad, in edge lengths, are the same cut."""
_LEFT = 2.0
"""Sides of a quad that an edge has moved on between two places in it, if it has left it between."""
SHARE = 0.05
"""Share of the crossed quads, or of the path, above which a finding is reported."""
RUNGS = 2.0
"""Smallest opening_u in edge lengths."""
BENDS = 5.0
"""Longest sides under the path in bending lengths of the film, for the torque."""
OPENINGS = 0.1
"""Longest sides under the path over opening_u, for the torque."""
_SCATTER = 1.2
"""Of the sides of quads by Gmsh about the size that was asked for."""


def check_path(
    mesh: Mesh,
    support: Bools,
    law: CohesiveTable,
    sweep: Sweep,
    fracture: Fracture,
    remedy: str = "",
) -> Iterator[Finding]:
    """Yield findings on the path of the cutting edges over the tool's whole motion.

    ``support`` has the fixed components of each node, the law is of cables that the edges have
    met, ``remedy`` what makes them meet a film that they miss.
    """
    along_edges = fracture.path == "edges"
    yield from _fates(sweep, remedy)
    if not len(sweep.place):
        return
    yield from _attack(sweep)
    rows = Rows(sweep)
    if rows.open.all():
        yield doubt(
            "there must be film to cut on the path of the cutting edges",
            "a path that lies in existing cuts, or between doubled nodes, from end to end",
            "take a shorter notch, move the tool, or merge nodes (merge=1e-6 of read_film)",
        )
    if along_edges:
        yield from _off_row(rows, sweep, bound=bool(fracture.only_along_edges))
    yield from _held(mesh, support, sweep)
    if not along_edges:
        yield from _in_one_quad(sweep)
    h = rows.spacing if along_edges else float(np.median(sweep.edge_length))
    if law.opening_u < RUNGS * h:
        yield doubt(
            f"opening_u must be at least {RUNGS:g} times the side of the quads along the path, or "
            "the force is too high (at half of that by 10 % in the opening test on quick, by 2 % "
            "in the guillotine)",
            f"opening_u {law.opening_u:.4g} mm and sides of {h:.3g} mm on the path, "
            f"{law.opening_u / h:.2g} of them",
            "use a finer film along the path; openings are in mm",
        )


def side_needed(bent: float, law: CohesiveTable) -> float:
    """Return how long sides under the path may be for the torque not to depend on them [mm].

    bent : bending length of the film [mm].
    """
    return min(BENDS * bent, OPENINGS * law.opening_u)


def check_sides(sweep: Sweep, bent: float, law: CohesiveTable) -> Iterator[Finding]:
    """Yield a finding if the film cannot fold beside the tool; its edges touch the tool's."""
    h = float(np.median(sweep.edge_length))
    if h > _SCATTER * BENDS * bent:
        size = side_needed(bent, law)
        yield doubt(
            f"sides of the quads under the path must be {BENDS:g} bending lengths of the film at "
            "most, or the film cannot fold beside the tool: at ten bending lengths the torque was "
            "wrong by up to a half, and the better of two teeth seemed the worse",
            f"sides of {h:.3g} mm, {h / bent:.2g} bending lengths of {bent:.3g} mm",
            f"set membrane.size_at_path = {size:.2g}, or bring a film as fine as that along the "
            "path",
        )


def edge_line(sweep: Sweep) -> str:
    """Return in one line how many cutting edges meet the film and stay in it."""
    fates, n = sweep.fates, len(sweep.fates)
    n_staying = sum(fate.stays for fate in fates)
    which = "the cutting edge meets" if n == 1 else f"all {n} cutting edges meet"
    if n_staying == n:
        return f"cut    {which} the film and {'stays' if n == 1 else 'stay'} in it to the end"
    never = [fate.chain for fate in fates if not fate.meets]
    if len(never) == n:
        return f"cut    none: no cutting edge of {n} meets the film"
    met = f"{n - len(never)} of {n} cutting edges meet the film, {n_staying} are in it at the end"
    parts = [met, f"never: {_numbers(never)}"] if never else [met]
    left = {fate.chain: fate.last for fate in fates if fate.last is not None and not fate.stays}
    if left:
        first = min(left.values())
        parts.append(f"they leave it from {1e3 * first:.4g} ms on: {_numbers(left)}")
    return "cut    " + "; ".join(parts)


def _fates(sweep: Sweep, remedy: str) -> Iterator[Finding]:
    fates = sweep.fates
    never = [fate.chain for fate in fates if not fate.meets]
    if len(never) == len(fates):
        yield doubt(
            "a cutting edge must pass through the film during the motion",
            f"none of {len(fates)} that does so up to {1e3 * sweep.duration:.4g} ms",
            remedy
            or "check place and unit of the tool, the motion and its duration (shellcut preview "
            "draws them)",
        )
        return
    if never:
        yield note(
            f"{len(never)} of {len(fates)} cutting edges never meet the film: {_chains(never)}",
            f"fine if that is intended; [tool] not_cutting = {never} leaves them out",
        )
    if out := [fate for fate in fates if fate.passed_out]:
        yield doubt(
            "a cutting edge must stay in the film as long as the tool moves along it, or the tool "
            "behind the edge tears the film or leaves it uncut",
            f"{len(out)} of {len(fates)} whose end leaves the film, the first at "
            f"{_first_exit(out, sweep)}: {_chains([fate.chain for fate in out])}",
            "make the edges longer, or the advance across the film smaller (pitch)",
        )
    if left := [fate for fate in fates if fate.meets and not fate.stays and not fate.passed_out]:
        yield note(
            f"{len(left)} of {len(fates)} cutting edges leave the film before the motion ends, the "
            f"first at {_first_exit(left, sweep)}: "
            f"{_chains([fate.chain for fate in left])}",
            "fine if that is intended; a shorter duration saves time",
        )


def _first_exit(fates: list[Fate], sweep: Sweep) -> str:
    first = min(fate.last for fate in fates if fate.last is not None)
    return f"{1e3 * first:.4g} ms of {1e3 * sweep.duration:.4g} ms"


def _numbers(chains: Iterable[int]) -> str:
    """Name cutting edges by numbers from 1; not_cutting counts them from 0."""
    return named(chain + 1 for chain in chains)


def _chains(chains: list[int]) -> str:
    return f"cutting edge{'s' if len(chains) > 1 else ''} {_numbers(chains)}"


def _attack(sweep: Sweep) -> Iterator[Finding]:
    edge = np.cross(sweep.normal, sweep.back)
    across = sweep.velocity - (sweep.velocity * edge).sum(axis=1)[:, None] * edge
    speed = np.linalg.norm(across, axis=1)
    # An edge that moves along itself slices and has no direction; one at rest does nothing.
    whole = np.linalg.norm(sweep.velocity, axis=1)
    moving = (speed > 0.05 * whole) & (speed > 1e-3 * sweep.top_speed)
    forward = -(across * sweep.back).sum(axis=1)
    astray = moving & (forward < np.cos(ATTACK) * speed)
    astray &= ~_seen_before(sweep, moving & ~astray)
    weight = speed * moving
    share = float((weight * astray).sum() / max(weight.sum(), 1e-300))
    if share <= SHARE:
        return
    worst = int(np.argmin(np.where(astray, forward / np.maximum(speed, 1e-300), np.inf)))
    angle = float(np.degrees(np.arccos(np.clip(forward[worst] / speed[worst], -1.0, 1.0))))
    yield doubt(
        f"a cutting edge must move where it points, within {np.degrees(ATTACK):.0f}°, or a "
        "blunt back or flank presses on the film",
        f"another direction on {100.0 * share:.0f} % of the path; cutting edge "
        f"{_numbers([int(sweep.chain[worst])])} moves {angle:.0f}° away from where it points at "
        f"{point_text(sweep.place[worst], 4)} mm, t = {1e3 * sweep.time[worst]:.4g} ms",
        "turn the tool, reverse the motion (axis of a screw, direction of a straight one), or "
        f"leave the edge out ([tool] not_cutting = [{sweep.chain[worst]}])",
    )


def _seen_before(sweep: Sweep, ahead: Bools) -> Bools:
    """Return whether an edge was at a place before while moving ahead: the way back is free."""
    back = np.zeros(len(ahead), np.bool_)
    if not ahead.any():
        return back
    tree = scipy.spatial.cKDTree(sweep.place[ahead])
    time = sweep.time[ahead]
    rest = np.flatnonzero(~ahead)
    near = tree.query_ball_point(sweep.place[rest], sweep.edge_length[rest])
    for i, at in zip(rest.tolist(), near, strict=True):
        back[i] = any(time[j] < sweep.time[i] for j in at)
    return back


def _off_row(rows: Rows, sweep: Sweep, *, bound: bool) -> Iterator[Finding]:
    asked = ~rows.open
    quads = np.unique(sweep.quad[asked])
    if not len(quads):
        return
    far = np.zeros(len(sweep.mesh.quads), np.bool_)
    far[sweep.quad[asked & (rows.off > OFF_ROW)]] = True
    share = float(far[quads].mean())
    if share <= SHARE:
        return
    worst = int(np.argmax(np.where(asked & np.isfinite(rows.off), rows.off, -1.0)))
    none = bool(np.isinf(rows.off[asked]).any())
    came = f"no such row in {100.0 * share:.0f} % of the {len(quads):,} quads under the path"
    if rows.off[worst] > OFF_ROW:
        h = float(sweep.edge_length[worst])
        where = point_text(sweep.place[worst], 4)
        came += f", the next one {rows.off[worst] * h:.3g} mm away at {where} mm"
    yield doubt(
        "a row of sides of quads must lie under the path of the cutting edges, within "
        f"{OFF_ROW:g} of their length, since cracks follow it: without it the force is too large, "
        "or nothing is cut",
        came + ("; some run across it" if none else ""),
        ('let cracks run through the quads, fracture.path = "free", or ' if not bound else "")
        + "mesh along it",
    )


def _held(mesh: Mesh, support: Bools, sweep: Sweep) -> Iterator[Finding]:
    nodes = mesh.quads[sweep.quad]
    off = np.linalg.norm(mesh.nodes[nodes] - sweep.place[:, None], axis=2)
    near = off <= NEAR_HELD * sweep.edge_length[:, None]
    supported = np.asarray(support.any(axis=1))
    held = np.unique(nodes[near & supported[nodes]])
    if len(held):
        yield doubt(
            "no supported node may lie on the path of the cutting edges: such nodes never split, "
            "so the blade runs against them",
            f"{counted(len(held), 'supported node')} on it, the first at "
            f"{point_text(mesh.nodes[held[0]], 4)} mm",
            "support other nodes, or move the tool",
        )


def _travelled(sweep: Sweep) -> Floats:
    """Return how far the middle of its edge has come in the film at each place, (n,) [mm]."""
    way = np.zeros(len(sweep.time))
    for chain in np.unique(sweep.chain).tolist():
        mine = sweep.chain == chain
        times, at = np.unique(sweep.time[mine], return_inverse=True)
        middle = np.zeros((len(times), 3))
        np.add.at(middle, at, sweep.place[mine])
        middle /= np.bincount(at)[:, None]
        steps = np.linalg.norm(np.diff(middle, axis=0), axis=1)
        way[mine] = np.append(0.0, np.cumsum(steps))[at]
    return way


def _in_one_quad(sweep: Sweep) -> Iterator[Finding]:
    order = np.lexsort((sweep.time, sweep.chain, sweep.quad))
    of = np.stack([sweep.quad, sweep.chain])[:, order]
    begins = np.diff(of, axis=1, prepend=-1).any(axis=0)
    # An edge that has left a quad may come back to it.
    begins |= np.diff(_travelled(sweep)[order], prepend=0.0) > _LEFT * sweep.edge_length[order]
    starts = np.flatnonzero(begins)
    places = np.split(sweep.place[order], starts[1:])
    quad, chain = of[:, starts]
    side = sweep.edge_length[order][starts]
    worst = 1.0
    for k in np.flatnonzero(quad[1:] == quad[:-1]).tolist():
        gap = float(scipy.spatial.distance.cdist(places[k], places[k + 1]).min())
        if ONE_LINE * side[k] < gap < worst * side[k]:
            worst, apart, at = gap / side[k], gap, k
    if worst < 1.0:
        one, other = chain[at : at + 2].tolist()
        who = f"{_chains([one])} twice," if one == other else _chains([one, other])
        yield doubt(
            "no quad may be cut twice, because the second edge then passes through it without "
            "a force",
            f"{who} {apart:.3g} mm apart in a quad with sides of {side[at]:.3g} mm near "
            f"{point_text(places[at][0], 4)} mm",
            f"use quads with sides of at most {0.5 * apart:.2g} mm there",
        )

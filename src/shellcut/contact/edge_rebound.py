"""The contact of an edge of the film returns no more energy than it has got, for kernels.

An edge that lies on a flat end of a tooth presses at one or the other edge of that, wherever it has
more energy. So its energy has a corner, at which the force jumps from one of its ends to the other.
There no step is short enough: a stiff film that is pressed on such a face swings between both edges
from step to step, and each crossing changes the energy of the film by up to the jump times the way
of the step, while that of the contact is what it was. The opening of a film of 1 mm heated itself
so with a tenth of the tool's work.

So each edge keeps the work W that its contact has got. With f the forces on its ends and d the ways
of these against the tool over the last step, in space, sums over both ends,

    W' = W - ½ Σ (f + f') · d.

Where the energy is smooth, W is that energy but for errors of the third order in d, and all of f'
acts. Else f' is scaled down so far that W is not below zero a step later, if the tool goes on as it
does and the ends feel f' and the forces known by now (:func:`.settings.largest_rebound`, along the
direction of f' in the space of both ends). That stops whatever presses the ends, so an edge that
rests on the tool is held. W begins with zero when the edge comes to press.
"""

from __future__ import annotations

from math import sqrt

from shellcut.arrays import Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import inline
from shellcut.numerics.vec3 import combine, dot, load, scale, sub
from shellcut.tool.pose import Pose, to_body, turn

from .edge_tables import EdgeTables
from .settings import largest_rebound


@inline
def way_back(i: int, end: int, dt: float, pose: Pose, before: Pose, held: EdgeTables) -> Vec3:
    """Return minus the way of an end of the i-th edge against the tool over the last step [mm]."""
    tables = borrowed(held)
    nodes, n = tables.nodes, tables.pairs.node[i, end]
    x = load(nodes.x, n)
    was = to_body(combine(1.0, x, -dt, load(nodes.velocity_half, n)), before)
    return turn(sub(was, to_body(x, pose)), pose)


@inline
def put_in_by_last(i: int, back_a: Vec3, back_b: Vec3, held: EdgeTables) -> None:
    """Add half the work of the last forces over the last step to what the i-th edge has got.

    back_a, back_b : of :func:`way_back` [mm].
    """
    memory = borrowed(held).memory
    of_a, of_b = load(memory.force[i], 0), load(memory.force[i], 1)
    memory.put_in[i] += 0.5 * (dot(of_a, back_a) + dot(of_b, back_b))


@inline
def returned(
    i: int, f_a: Vec3, f_b: Vec3, back_a: Vec3, back_b: Vec3, dt: float, held: EdgeTables
) -> float:
    """Return the part of the forces on an edge's ends that may act, and add half its work.

    f_a, f_b : forces on the ends [N].  back_a, back_b : of :func:`way_back` [mm].
    """
    tables = borrowed(held)
    memory, nodes = tables.memory, tables.nodes
    a, b = tables.pairs.node[i, 0], tables.pairs.node[i, 1]
    force, part = sqrt(dot(f_a, f_a) + dot(f_b, f_b)), 1.0
    if force == 0.0:
        return part
    out_a, out_b = scale(1.0 / force, f_a), scale(1.0 / force, f_b)
    way = dot(out_a, back_a) + dot(out_b, back_b)
    light_a = 0.0 if nodes.supported[a] else 1.0 / nodes.contact_mass[a]
    light_b = 0.0 if nodes.supported[b] else 1.0 / nodes.contact_mass[b]
    lightness = light_a * dot(out_a, out_a) + light_b * dot(out_b, out_b)
    if dt > 0.0 and lightness > 0.0:
        of_a, of_b = dot(out_a, load(nodes.force, a)), dot(out_b, load(nodes.force, b))
        pushed = -(light_a * of_a + light_b * of_b) / lightness
        most = largest_rebound(memory.put_in[i], way, pushed, 1.0 / lightness, dt)
        part = min(1.0, most / force)
    memory.put_in[i] += 0.5 * part * force * way
    return part

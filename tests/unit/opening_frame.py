"""A made-up but plausible picture of an opening, for the tests of writers and views.

A disc of radius 10.2 mm, four teeth that have each cut an arc along r = 9.4 mm, flanks apart,
straight cables ahead of each edge, cables bent around it behind, the wedges as one tool.
"""

from __future__ import annotations

import numpy as np

from shellcut.frame import JOINTED, STRAIGHT, Frame

RADIUS = 9.4  # of the cut [mm]
HEIGHT = 2.5  # of a tooth [mm]
LENGTH = 1.5  # of a tooth along the cut [mm]
HALF_THICKNESS = 0.35  # [mm]
HALF_ANGLE = np.radians(12.0)  # of the wedge
ETA = np.radians(60.0)  # of the edge to the sheet
EDGE_COLOR = (0.9, 0.0, 0.1)  # of cutting edges on every picture


def disc(n_side, rings):
    """Return points and quads: an n_side x n_side square mapped on a disc, then rings around it."""
    s = np.linspace(-1.0, 1.0, n_side + 1)
    a, b = np.meshgrid(s, s, indexing="ij")
    wide = np.abs(a) >= np.abs(b)
    with np.errstate(divide="ignore", invalid="ignore"):
        phi = np.where(wide, np.pi / 4 * b / a, np.pi / 2 - np.pi / 4 * a / b)
        r = np.where(wide, a, b) * rings[0]
    phi[~np.isfinite(phi)] = 0.0
    # Concentric squares to circles, blended with the plain square inside, where corners fold.
    blend = np.maximum(np.abs(a), np.abs(b))
    x = blend * r * np.cos(phi) + (1 - blend) * a * rings[0] * 0.85
    y = blend * r * np.sin(phi) + (1 - blend) * b * rings[0] * 0.85
    points = np.stack((x.ravel(), y.ravel()), axis=1)
    ids = np.arange((n_side + 1) ** 2).reshape(n_side + 1, n_side + 1)
    quads = np.stack((ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]), -1).reshape(-1, 4)
    rim = np.concatenate((ids[:-1, 0], ids[-1, :-1], ids[:0:-1, -1], ids[0, :0:-1]))
    angle = np.arctan2(points[rim, 1], points[rim, 0])
    for radius in rings[1:]:
        first = len(points)
        points = np.vstack((points, radius * np.stack((np.cos(angle), np.sin(angle)), 1)))
        new = first + np.arange(len(rim))
        quads = np.vstack((quads, np.stack((rim, new, np.roll(new, -1), np.roll(rim, -1)), 1)))
        rim = new
    return points, quads


def tooth(angle, dive):
    """Return points, triangles, edge segments of one wedge whose tip is at ``angle`` [rad].

    In its own axes the edge runs through the origin at the sheet, rising forward; ``dive`` is the
    depth of the tip under the sheet [mm].
    """
    slope = 1.0 / np.tan(ETA)
    depth = np.array([-dive, HEIGHT - dive])
    front = np.stack((depth * slope, np.zeros(2), depth), 1)
    back = front - [LENGTH, 0.0, 0.0]
    back[0] = [front[0, 0] - LENGTH, 0.0, -dive + LENGTH * np.tan(np.radians(30.0))]
    run = min(HALF_THICKNESS / np.tan(HALF_ANGLE), 0.6 * LENGTH)
    shoulder = front - [run, 0.0, 0.0]
    shoulder[0, 2] = -dive + run * np.tan(np.radians(30.0))
    side = np.array([0.0, HALF_THICKNESS, 0.0])
    p = np.vstack((front, shoulder + side, shoulder - side, back + side, back - side))
    quads = [(0, 1, 3, 2), (0, 4, 5, 1), (2, 3, 7, 6), (4, 8, 9, 5), (6, 7, 9, 8)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    triangles += [(0, 2, 4), (2, 6, 8), (2, 8, 4), (1, 5, 3), (3, 5, 9), (3, 9, 7)]
    steps = np.linspace(0.0, 1.0, 13)[:, None]
    edge = _bend(front[0] + steps * (front[1] - front[0]), angle)
    return _bend(p, angle), np.array(triangles), np.stack((edge[:-1], edge[1:]), 1)


def _bend(p, angle):
    theta = angle + p[:, 0] / RADIUS
    r = RADIUS + p[:, 1]
    return np.stack((r * np.cos(theta), r * np.sin(theta), p[:, 2]), 1)


def opening_frame(angle=45.0, *, n_side=38, n_tooth=4, time=None):
    """Return the frame at ``angle`` [deg]; n_side 38 gives 2,204 quads."""
    h = 2.0 * np.pi * RADIUS / (4 * n_side)
    rings = [RADIUS + h * k for k in (-3, -2, -1, 0)] + [9.8, 10.2]
    flat, quads = disc(n_side, rings)
    r, theta = np.hypot(*flat.T), np.arctan2(flat[:, 1], flat[:, 0])
    dive = 0.4 + 12.0 * np.radians(angle) / (2.0 * np.pi)
    cut = np.radians(angle)
    starts = np.arange(n_tooth) * 2.0 * np.pi / n_tooth + np.pi / 4 - 0.3

    # where the cut stands: u runs 0..1 from the start of each arc to its tip
    ahead = 0.25 / RADIUS
    since = (theta[:, None] - starts + np.pi) % (2.0 * np.pi) - np.pi
    u = (since / (cut + ahead)).clip(-0.5, 1.5)
    inside = (u > 1e-9) & (u < 1.0 - 1e-9)
    on_cut = inside.any(1) & (np.abs(r - RADIUS) < 1e-9) & (angle > 0.0)

    # twins of the nodes on the cut: the originals go with the inner quads
    originals = np.flatnonzero(on_cut)
    twin = np.arange(len(flat))
    twin[originals] = len(flat) + np.arange(len(originals))
    parent = np.concatenate((np.arange(len(flat)), originals))
    centre_r = np.hypot(*flat[quads].mean(1).T)
    quads = np.where((centre_r > RADIUS)[:, None], twin[quads], quads)
    outer = np.zeros(len(parent), bool)
    outer[len(flat) :] = True
    r, theta, u = r[parent], theta[parent], u[parent]
    reference = np.stack((r * np.cos(theta), r * np.sin(theta), 0.0 * r), 1)

    # the inner side is pressed down and in along each cut, the outer side a little
    v = np.sqrt(np.where((u > 0) & (u < 1), np.abs(4 * u * (1 - u)), 0.0)).max(1)
    reach = np.exp(-np.abs(RADIUS - r) / 1.2)
    inner = (r <= RADIUS + 1e-9) & ~outer
    down = np.where(inner, -0.9, -0.12) * v * reach * min(1.0, angle / 20.0)
    down -= 0.25 * np.exp(-(((1.0 - u) * cut * RADIUS / 1.2) ** 2)).max(1) * reach * (r < 10.19)
    shift = np.where(inner, -0.42, 0.38 * (10.2 - r) / 0.8) * v * reach
    rr = r + shift
    points = np.stack((rr * np.cos(theta), rr * np.sin(theta), down), 1)

    on = np.flatnonzero(np.abs(flat[:, 0] ** 2 + flat[:, 1] ** 2 - RADIUS**2) < 1e-6)
    on = on[np.argsort(np.arctan2(flat[on, 1], flat[on, 0]))]
    sides = np.stack((on, np.roll(on, -1)), axis=1)
    opened = sides[(twin[sides] != sides).any(axis=1)]
    crack = np.stack((opened, twin[opened]), axis=1)

    tools, triangles, edges, segments, state = [], [], [], [], []
    teeth, edge_teeth = [], []
    for number, start in enumerate(starts, start=1):
        p, t, e = tooth(start + cut, dive)
        triangles.append(t + sum(map(len, tools)))
        tools.append(p)
        edges.append(e)
        teeth += [number] * len(t)
        edge_teeth += [number] * len(e)
        for i in originals:
            behind = (start + cut - theta[i] + np.pi) % (2.0 * np.pi) - np.pi
            here, there = points[i], points[twin[i]]
            if -ahead < behind < 0.0:
                segments.append((here, there))
                state.append(STRAIGHT)
            elif 0.0 <= behind * RADIUS < 1.6:
                height = 0.5 * (here[2] + there[2]) + 0.25 * behind * RADIUS
                joint = _bend(np.array([[height / np.tan(ETA), 0.0, height]]), start + cut)[0]
                segments += [(here, joint), (joint, there)]
                state += [JOINTED, JOINTED]
    near = np.exp(-((((1.0 - u) * cut * RADIUS) / 1.5) ** 2)).max(1) * reach
    nodal = 3.0 + 15.0 * near
    principal = nodal[quads].mean(1)
    stress = np.stack((principal, 0.3 * principal, 0.1 * principal), 1)
    c, s = np.cos(cut), np.sin(cut)
    return Frame(
        time=6.3e-5 * angle if time is None else time,
        coordinate=angle,
        coordinate_name="angle",
        coordinate_unit="deg",
        points=points,
        reference=reference,
        director=np.tile([0.0, 0.0, 1.0], (len(points), 1)),
        velocity=(points - reference) / 3.0e-3,
        quads=quads,
        quad_stress=stress,
        quad_principal=np.stack((principal, 0.25 * principal), 1),
        quad_stress_top=1.5 * stress,
        quad_principal_top=np.stack((1.5 * principal, 0.375 * principal), 1),
        quad_stress_bottom=0.5 * stress,
        quad_principal_bottom=np.stack((0.5 * principal, -0.125 * principal), 1),
        quad_thickness=0.074 - 1e-5 * principal,
        held=r > 10.19,
        crack_edges=crack,
        cable_segments=np.array(segments).reshape(-1, 2, 3),
        cable_state=np.array(state, dtype=np.int8),
        cable_traction=np.linspace(18.0, 12.0, len(segments)),
        cable_opening=np.linspace(0.0, 4.0, len(segments)),
        tool_points=np.vstack(tools),
        tool_triangles=np.vstack(triangles),
        tool_tooth=np.array(teeth),
        tool_rotation=np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]),
        tool_translation=np.array([0.0, 0.0, -dive]),
        edge_points=np.vstack(edges),
        edge_tooth=np.array(edge_teeth),
        scalars={"torque": 143.6 * min(1.0, angle / 15.0), "crack length": 4 * RADIUS * cut},
        scalar_units={"torque": "N*mm", "crack length": "mm"},
    )

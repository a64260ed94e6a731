"""Kick and drift of the central difference, node by node, by [Frangi2010] 5.2."""

import numpy as np


def spin_of_cone(free, supported, rate, t):
    """Spin of a director whose spin about one axis h is prescribed: freely about h x t.

    supported, rate : (3,).  None if prescribed about none, several, or the axis along which t lies.
    """
    h = supported.astype(float)
    axis = np.cross(h, t)
    if supported.sum() != 1 or np.linalg.norm(axis) < 1e-9:
        return None
    axis /= np.linalg.norm(axis)
    return (h @ rate) * h + (free @ axis) * axis


def kicked(m, before, load, supported, rate, reaction, alpha, dt_last, dt_next, t=None):
    """Velocity of one node after a kick, its reaction, and its part of the energies.

    before, load, supported, rate, reaction : (3,), that at t_{n-1}.  t : the director, where the
    velocity is a spin.  The energies are kinetic, dissipated by alpha, and work of the support.
    """
    dt = 0.5 * (dt_last + dt_next)
    free = ((1.0 - 0.5 * alpha * dt) * before + dt * load / m) / (1.0 + 0.5 * alpha * dt)
    after = np.where(supported, rate, free)
    cone = None if t is None else spin_of_cone(free, supported, rate, t)
    if cone is not None:
        after, supported = cone, np.ones(3, bool)
    now = m * ((after - before) / dt + 0.5 * alpha * (after + before)) - load
    work = 0.5 * dt_last * np.where(supported, (reaction + now) * before, 0.0).sum()
    # t_0 lies in the middle of the first kick: the velocities on both sides have v_0 as their mean.
    earlier = before if dt_last > 0.0 else 2.0 * before - after
    kinetic = 0.5 * m * earlier @ after
    damping = alpha * dt * m * np.sum((0.5 * (before + after)) ** 2)
    return after, np.where(supported, now, reaction), np.array([kinetic, damping, work])


def turned(t, angle):
    """A director after a Cayley rotation: t' - t = angle x ½ (t' + t)."""
    x, y, z = 0.5 * angle
    half = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.linalg.solve(np.eye(3) - half, (np.eye(3) + half) @ t)

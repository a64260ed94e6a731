"""The force on a tip that counts against F_p: a mean, long against impacts of the film's nodes.

Where a tip meets the film, its mesh takes up the speed node by node. A node of the mass m that the
tip meets at the speed v gets the impulse m v, or 2 m v if it rebounds, within the time that the
penalty's spring needs, so the contact force peaks at v sqrt(k m). That says nothing about what the
film carries: a sheet that bends answers with 8 sqrt(D rho h) v from the first moment, which is 0.61
of (v/c) E/sigma_F of F_p, 2 % at 0.5 m/s in the film of the opening test. A node has more mass the
larger its quads are, and the peak over F_p grows with v and with the edge length over the
thickness.

An impulse is no force until it is spread over a time. The mean force F on a tip follows

    dF/dt = (force - F) / T,      T = 2 m v / (``IMPACT`` F_p),

with the fastest v at which film and tip have met so far, so that one impact adds ``IMPACT`` of F_p
at most, and what the film carries for longer than T counts in full. Slow tips and fine quads have a
short T, down to less than a step. What the sheet itself answers at once is no matter of the mesh:
T is shorter by its share of F_p, and where that alone pierces, the force needs no mean. It is late
by T. This *delay* over the time for which the
tip has pressed grows with m v²; the verdict judges it (``DELAY_LIMIT``).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, product
from shellcut.contact.sheet_contact import PointContact
from shellcut.numerics.kept import Kept
from shellcut.state import State
from shellcut.tool.motion import Motion
from shellcut.tool.pose import Pose

from .cut_film import CutFilm

IMPACT = 0.1
"""Share of F_p that the impact of a node may count as."""

# Growth of the time for which a tip has pressed after which the tension around it is measured anew.
_GROWTH = math.log(1.02)

# Of a tip: mean force [N], largest T [s], and time for which it has pressed [s].
_FORCE, _DELAY, _PRESSED = range(3)

# Share of F_p below which a tip that has left the film is forgotten.
_FORGOTTEN = 1e-3


class Load(NamedTuple):
    """What presses on a tip, or the lowest place of an arc."""

    row: int
    """Which it presses."""
    force: float
    """All that presses its film there [N]."""


class PressingTips(Kept):
    """Mean forces on the tips and arcs of the cutting edges, on each film that they press.

    A mean belongs to a point of the tool and the film around the row that it presses
    (:mod:`.film_around`): on the next layer, or farther on the same, it begins at zero.

    Parameters
    ----------
    points : PointContact
        By which the tool presses on the film.
    motion : Motion
        Of the tool.
    film : CutFilm
        How it is cut.
    limits : ndarray, shape (n_of_tool,)
        F_p under each of its points [N].
    impedance : float
        Of the sheet under a point [N·s/mm].
    """

    kept_names = "_tip", "_row", "_mean", "_largest", "_step", "_passed"

    def __init__(
        self,
        points: PointContact,
        motion: Motion,
        film: CutFilm,
        limits: Floats,
        impedance: float,
    ) -> None:
        self._points, self._motion, self._film, self._limits = points, motion, film, limits
        self._impedance = impedance
        self._tip, self._row = np.zeros((2, 0), np.int64)
        self._mean = np.zeros((0, 3))
        self._of_contact: dict[int, int] = {}
        self._largest = np.zeros(len(limits))
        self._step = 0
        self._passed = 0.0

    def follow(self, state: State, pose: Pose, loads: Mapping[int, Load]) -> None:
        """Take what presses on tips at the last evaluation, with the tool at the given pose.

        Costs nothing where no tip presses or has just pressed.

        loads : by their rows among the contact points.
        """
        steps, self._step = state.step - self._step, state.step
        if not loads and not len(self._tip):
            return
        contacts = np.array(list(loads), int)
        tips = self._points.point_of_sheet()[contacts].tolist()
        at = [self._find(state, *to) for to in zip(tips, loads.values(), strict=True)]
        force, of = np.zeros(len(self._tip)), self._mean
        np.maximum.at(force, at, [load.force for load in loads.values()])
        np.maximum.at(of[:, _DELAY], at, self._delay(state, pose, contacts))
        self._passed = dt = steps * state.dt
        of[:, _FORCE] += dt / (of[:, _DELAY] + dt) * (force - of[:, _FORCE])
        of[:, _PRESSED] += dt
        np.maximum.at(self._largest, self._tip, of[:, _FORCE])
        stays = (force > 0.0) | (of[:, _FORCE] >= _FORGOTTEN * self._limits[self._tip])
        self._tip, self._row, self._mean = self._tip[stays], self._row[stays], of[stays]
        of_all = np.cumsum(stays) - 1
        self._of_contact = dict(zip(loads, of_all[at].tolist(), strict=True))

    def mean(self, contact: int) -> float:
        """Return the mean force at a contact point [N]."""
        return float(self._mean[self._of_contact[contact], _FORCE])

    def largest(self) -> Floats:
        """Return the largest mean force on each point of the tool so far, over its F_p."""
        return np.asarray(self._largest / self._limits)

    def is_due(self, contact: int) -> bool:
        """Return whether the tension around a tip is to be measured, which takes long.

        It is at every check first, and once in 2 % of the time for which the tip has pressed later.
        """
        pressed = float(self._mean[self._of_contact[contact], _PRESSED])
        before = pressed - self._passed
        if before <= 0.0:
            return True
        return math.log(pressed) // _GROWTH > math.log(before) // _GROWTH

    def delay(self, contact: int) -> float:
        """Return T over the time for which the tip at a contact point has pressed."""
        _, delay, pressed = self._mean[self._of_contact[contact]].tolist()
        return float(delay / pressed) if pressed else 0.0

    def _find(self, state: State, tip: int, load: Load) -> int:
        """Return which mean is that of a tip on the film that it presses, a new one if none is."""
        near = np.isin(self._row, self._film.around(state, load.row, 0.0))
        found = np.flatnonzero((self._tip == tip) & near)
        if not found.size:
            self._tip, self._row = np.append(self._tip, tip), np.append(self._row, load.row)
            self._mean = np.append(self._mean, np.zeros((1, 3)), axis=0)
            return len(self._tip) - 1
        self._row[found[0]] = load.row
        return int(found[0])

    def _delay(self, state: State, pose: Pose, rows: Ints) -> Floats:
        """Return T at the present speed of some tips that press [s]."""
        contact_points, n = self._points.carriers, state.node
        node, weight = contact_points.node[rows], contact_points.weight[rows]
        place = self._points.points.place[self._points.point_of_sheet()[rows]]
        spin, velocity = self._motion.twist(state.time)
        velocity = velocity + np.cross(spin, product(place, pose.rotation.T))
        film = product(weight[:, None], n.velocity_half[node])[:, 0]
        gap = state.pace * velocity - film
        speed = np.abs((gap * product(contact_points.normal[rows], pose.rotation.T)).sum(axis=1))
        # What moves at the place is no more than the nodes that carry it; supported nodes do not
        # move.
        free = (weight > 0.0) & (n.push[node, 0] > 0.0)
        most = np.where(free, n.mass[node], 0.0).sum(axis=1)
        gives = (weight * weight * n.push[node, 0]).sum(axis=1)
        impulse = 2.0 * np.minimum(1.0 / np.maximum(gives, 1e-300), most) * speed
        limit = self._limits[self._points.point_of_sheet()[rows]]
        left = np.maximum(1.0 - self._impedance * speed / limit, 0.0)
        return np.asarray(left * impulse / (IMPACT * limit))

"""A round plate under a point load, large deflections, layers that follow deformation theory.

The energy of Föppl-von Kármán, with the slope t of a plate that hangs down and the displacement u
towards its border,

    e_r = u' + t²/2,  e_theta = u/r,  k_r = t',  k_theta = t/r,

is stationary in quadratic elements that grow with the radius. Each layer follows Hencky's
deformation theory in plane stress: with the mean and the half difference (a, b) of its two
stresses, of sums and differences (s, d) of strain,

    a = K s / (1 + K q),  b = G d / (1 + 3 G q),  q = p / Y(p),  a² + 3 b² = Y(p)²,
    K = E / 2(1 - nu),    G = E / 2(1 + nu).
"""

import numpy as np
import scipy.sparse
import scipy.sparse.linalg


class Layer:
    """One layer: moduli [MPa], thickness [mm], and yield stresses [MPa] at plastic strains."""

    def __init__(self, young, poisson, thickness, flow=None):
        self.mean = young / 2.0 / (1.0 - poisson)
        self.shear = young / 2.0 / (1.0 + poisson)
        self.thickness, self.flow = thickness, flow
        self.young, self.poisson = young, poisson

    def stresses(self, radial, around):
        """Return both stresses [MPa] of both strains."""
        a, b = self.mean * (radial + around), self.shear * (radial - around)
        if self.flow is not None:
            q = self._flow(a, b)
            a, b = a / (1.0 + self.mean * q), b / (1.0 + 3.0 * self.shear * q)
        return a + b, a - b

    def _flow(self, a, b):
        """Return p / Y of trial stresses: bisection, p grows with the trial."""
        strain, stress = self.flow
        equivalent = np.sqrt(a * a + 3.0 * b * b)
        low = np.zeros_like(a)
        high = np.where(equivalent > stress[0], equivalent / self.shear, 0.0)
        for _ in range(45):
            p = 0.5 * (low + high)
            y = np.interp(p, strain, stress)
            q = p / y
            left = (a / (1.0 + self.mean * q)) ** 2 + 3.0 * (b / (1.0 + 3.0 * self.shear * q)) ** 2
            above = left > y * y
            low, high = np.where(above, p, low), np.where(above, high, p)
        p = 0.5 * (low + high)
        return p / np.interp(p, strain, stress)


class Section:
    """Layers, the first one at the face that the load presses out."""

    def __init__(self, layers):
        self.thickness = sum(layer.thickness for layer in layers)
        place, weight = np.polynomial.legendre.leggauss(4)
        self.points, outer = [], 0.5 * self.thickness
        for layer in layers:
            z = outer - 0.5 * layer.thickness * (1.0 + place)
            self.points += [
                (at, 0.5 * layer.thickness * w, layer) for at, w in zip(z, weight, strict=True)
            ]
            outer -= layer.thickness

    def forces(self, strain):
        """Return (N_r, N_theta, M_r, M_theta) of (e_r, e_theta, k_r, k_theta), shape (n, 4)."""
        out = np.zeros_like(strain)
        for z, weight, layer in self.points:
            both = layer.stresses(strain[:, 0] + z * strain[:, 2], strain[:, 1] + z * strain[:, 3])
            for k, stress in enumerate(both):
                out[:, k] += weight * stress
                out[:, 2 + k] += weight * z * stress
        return out

    def bending(self):
        """Return the bending stiffness about the neutral plane before any layer yields [N·mm]."""
        rest = np.zeros((1, 4))
        C = self.tangent(rest, self.forces(rest))[0]
        return (C[2:, 2:] - C[2:, :2] @ np.linalg.inv(C[:2, :2]) @ C[:2, 2:])[0, 0]

    def tangent(self, strain, forces):
        """Return the slopes of the forces, by differences, shape (n, 4, 4)."""
        out = np.zeros((len(strain), 4, 4))
        for k in range(4):
            step = 1e-7 if k < 2 else 1e-7 / self.thickness
            moved = strain.copy()
            moved[:, k] += step
            out[:, :, k] = (self.forces(moved) - forces) / step
        return 0.5 * (out + out.transpose(0, 2, 1))


class Plate:
    """The plate, clamped at ``out`` times a length [mm] from the load."""

    def __init__(self, section, length, n_element=80, near=0.01, out=60.0):
        self.section = section
        ends = np.append(0.0, np.geomspace(near * length, out * length, n_element))
        self.n = 2 * n_element + 1
        size, first = np.diff(ends), 2 * np.arange(n_element)
        place, weight = np.polynomial.legendre.leggauss(3)
        self.shape = np.stack(
            [0.5 * place * (place - 1.0), 1.0 - place**2, 0.5 * place * (place + 1.0)], axis=1
        )
        slope = np.stack([place - 0.5, -2.0 * place, place + 0.5], axis=1)
        self.slope = slope * 2.0 / size[:, None, None]
        self.nodes = np.stack([first, first + 1, first + 2], axis=1)
        self.r = ends[:-1, None] + size[:, None] * 0.5 * (1.0 + place)
        self.weight = 0.5 * size[:, None] * weight
        self.unknown = np.zeros(2 * self.n)
        fixed = [0, self.n - 1, self.n, 2 * self.n - 1]
        self.free = np.setdiff1d(np.arange(2 * self.n), fixed)
        self.per_force = np.zeros(2 * self.n)
        each = (self.weight[:, :, None] * self.shape).sum(axis=1) / (2.0 * np.pi)
        np.add.at(self.per_force, self.n + self.nodes, each)

    def _evaluate(self, unknown, load, with_tangent):
        u, t = unknown[: self.n][self.nodes], unknown[self.n :][self.nodes]
        at = np.einsum("gk,ek->eg", self.shape, t)
        strain = np.stack(
            [
                np.einsum("egk,ek->eg", self.slope, u) + 0.5 * at * at,
                np.einsum("gk,ek->eg", self.shape, u) / self.r,
                np.einsum("egk,ek->eg", self.slope, t),
                at / self.r,
            ],
            axis=-1,
        ).reshape(-1, 4)
        forces = self.section.forces(strain)
        both = forces.reshape(*at.shape, 4)
        B = np.zeros((*at.shape, 4, 6))
        B[:, :, 0, :3] = B[:, :, 2, 3:] = self.slope
        B[:, :, 0, 3:] = at[..., None] * self.shape
        B[:, :, 1, :3] = B[:, :, 3, 3:] = self.shape / self.r[..., None]
        weight = self.weight * self.r
        rows = np.concatenate([self.nodes, self.n + self.nodes], axis=1)
        rest = -load * self.per_force
        np.add.at(rest, rows, np.einsum("eg,egij,egi->ej", weight, B, both))
        if not with_tangent:
            return rest, None, both
        C = self.section.tangent(strain, forces).reshape(*at.shape, 4, 4)
        k = np.einsum("eg,egij,egik,egkl->ejl", weight, B, C, B)
        k[:, 3:, 3:] += np.einsum("eg,eg,gi,gj->eij", weight, both[:, :, 0], self.shape, self.shape)
        i, j = np.repeat(rows, 6, axis=1).ravel(), np.tile(rows, (1, 6)).ravel()
        whole = scipy.sparse.csr_matrix((k.ravel(), (i, j)), shape=(2 * self.n, 2 * self.n))
        return rest, whole, both

    def press(self, load):
        """Go to a load [N]; return whether it is in balance, and N_r at ``r`` [N/mm]."""
        free, unknown = self.free, self.unknown.copy()
        scale = np.linalg.norm(load * self.per_force[free])
        for _ in range(40):
            rest, tangent, both = self._evaluate(unknown, load, with_tangent=True)
            size = np.linalg.norm(rest[free])
            if size < 1e-7 * scale:
                self.unknown = unknown
                return True, both[:, :, 0]
            change = -scipy.sparse.linalg.spsolve(tangent[free][:, free].tocsc(), rest[free])
            part = 1.0
            while part > 1e-3:
                trial = unknown.copy()
                trial[free] += part * change
                left = np.linalg.norm(self._evaluate(trial, load, with_tangent=False)[0][free])
                if left < (1.0 - 0.1 * part) * size:
                    break
                part *= 0.5
            unknown = trial
        return False, None

    def force_at(self, tension, distance, first):
        """Return the force [N] at which N_r reaches a tension [N/mm] at a distance [mm].

        first : a small force to begin with [N].
        """
        load, growth, before = first, 1.5, (0.0, 0.0)
        while growth > 1.005:
            done, radial = self.press(load)
            if not done:
                growth = growth**0.5
                load = before[0] * growth if before[0] else 0.25 * load
                continue
            reached = float(np.interp(distance, self.r.ravel(), radial.ravel())) / tension
            if reached >= 1.0:
                share = (1.0 - before[1]) / (reached - before[1])
                return before[0] + share * (load - before[0])
            before = load, reached
            load *= growth if reached < 0.6 else min(growth, 1.1)
        raise AssertionError(f"no balance beyond {before[0]} N, {before[1]} of the tension")

"""The stable step of a plane mesh: 2 / omega of its worst quad in plane stress.

omega² is the largest eigenvalue of the quad's own membrane stiffness on its share of the mass (row
sums), a bound for the assembly because stiffness and mass are sums over quads. Bending does not
limit the step of a film, because the rotary inertia is scaled; contact, cables and damping reduce
the step of a run further. So use this figure to compare meshes;
:mod:`shellcut.simulation.stable_step` gives the step of a run.
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.material.material import Material

_CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])


def membrane_steps(x: Floats, quads: Ints, material: Material) -> Floats:
    """Return 2 / omega of every quad [s], shape (n_quad,).

    Parameters
    ----------
    x : ndarray, shape (n_node, 2)
        Positions in the plane [mm].
    quads : ndarray, shape (n_quad, 4)
        Counter-clockwise, every corner angle below 180 degrees.
    material : Material
        Provides the plane-stress matrix and density; the thickness cancels.
    """
    X = x[quads]
    C = material.plane_stress()
    stiffness = np.zeros((len(quads), 8, 8))
    mass = np.zeros((len(quads), 4))
    for xi, eta in _CORNERS / np.sqrt(3.0):
        shape = 0.25 * (1.0 + xi * _CORNERS[:, 0]) * (1.0 + eta * _CORNERS[:, 1])
        slope = 0.25 * np.stack(
            [
                _CORNERS[:, 0] * (1.0 + eta * _CORNERS[:, 1]),
                _CORNERS[:, 1] * (1.0 + xi * _CORNERS[:, 0]),
            ]
        )
        J = np.einsum("ka,eai->eki", slope, X)
        area = J[:, 0, 0] * J[:, 1, 1] - J[:, 0, 1] * J[:, 1, 0]
        gradient = np.einsum("eik,ka->eia", np.linalg.inv(J), slope)
        B = np.zeros((len(quads), 3, 8))
        B[:, 0, 0::2], B[:, 1, 1::2] = gradient[:, 0], gradient[:, 1]
        B[:, 2, 0::2], B[:, 2, 1::2] = gradient[:, 1], gradient[:, 0]
        stiffness += area[:, None, None] * (B.transpose(0, 2, 1) @ C @ B)
        mass += material.density * area[:, None] * shape
    root = np.repeat(1.0 / np.sqrt(mass), 2, axis=1)
    largest = np.linalg.eigvalsh(stiffness * root[:, :, None] * root[:, None, :])[:, -1]
    return np.asarray(2.0 / np.sqrt(largest))

"""Deflection of a simply supported layered strip under a sine load, by elasticity.

Exact solution of three-dimensional elasticity in cylindrical bending [Pagano1969], for layers whose
moduli have a plane of symmetry, the sheet's. With p = π/span all of u_1, u_2, sigma_13, sigma_23 go
with cos px, u_3 and sigma_33 with sin px, so that the six are functions of the height alone that
fulfil y' = M y in each layer and pass from layer to layer.
"""

import numpy as np
from scipy.linalg import expm

from shellcut.material import Elastic

PLANE, THROUGH = np.array([0, 1, 5]), np.array([4, 3])


def moduli(material):
    """Stiffness for (e_11, e_22, e_33, 2e_23, 2e_13, 2e_12) in the film's axes, (6, 6) [MPa].

    What plane stress leaves open: E_3 is that across, shear that in the sheet.
    """
    if isinstance(material, Elastic):
        e1 = e2 = material.young
        nu = through = material.poisson
        shear = [0.5 * e1 / (1 + nu)] * 3
        angle = 0.0
    else:
        e1, e2 = material.young_along, material.young_across
        nu = through = material.poisson
        shear = material.shear_through_across, material.shear_through, material.shear
        shear = [modulus or material.shear for modulus in shear]
        angle = np.radians(material.angle_deg)
    compliance = np.diag([1 / e1, 1 / e2, 1 / e2, *(1 / np.array(shear))])
    for i, j, ratio in ((0, 1, nu / e1), (0, 2, through / e1), (1, 2, through / e2)):
        compliance[i, j] = compliance[j, i] = -ratio
    c, s = np.cos(angle), np.sin(angle)
    turn = np.eye(6)
    turn[PLANE[:, None], PLANE] = [
        [c * c, s * s, c * s],
        [s * s, c * c, -c * s],
        [-2 * c * s, 2 * c * s, c * c - s * s],
    ]
    turn[THROUGH[:, None], THROUGH] = [[c, s], [-s, c]]
    return turn.T @ np.linalg.inv(compliance) @ turn


def elasticity(film, span):
    """Deflection of the mid-surface [mm] under the load 1 MPa · sin(πx/span) on the top face."""
    p, half = np.pi / span, 0.5 * film.thickness
    below, through, middle = 0.0, np.eye(6), None
    for layer in film.layers:
        C = moduli(layer.material)
        plane = C[np.ix_(PLANE, PLANE)] - np.outer(C[PLANE, 2], C[2, PLANE]) / C[2, 2]
        on_plane, aside = plane[np.ix_([0, 2], [0, 2])], C[[0, 5], 2] / C[2, 2]
        M = np.zeros((6, 6))  # of (u_1, u_2, u_3, sigma_13, sigma_23, sigma_33)
        M[:2, 3:5], M[0, 2] = np.linalg.inv(C[np.ix_(THROUGH, THROUGH)]), -p
        M[2, :2], M[2, 5] = p * aside, 1 / C[2, 2]
        M[3:5, :2], M[3:5, 5] = p * p * on_plane, -p * aside
        M[5, 3] = p
        if middle is None and below + layer.thickness >= half * (1 - 1e-12):
            middle = expm(M * (half - below)) @ through
        through, below = expm(M * layer.thickness) @ through, below + layer.thickness
    bottom = np.linalg.solve(through[3:, :3], [0.0, 0.0, 1.0])
    return (middle[:, :3] @ bottom)[2]

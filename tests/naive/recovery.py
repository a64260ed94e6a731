"""Patch recovery of the stress at one node by least squares."""

import numpy as np


def principal(centres, stresses, place, director):
    """Largest principal stress and its direction at ``place`` from samples in the quads' centres.

    centres : (k, 3).  stresses : (k, 3, 3).  Fitted by 1, x, y in the plane normal to the director.
    """
    first = np.linalg.svd(director[None, :])[2][1]
    frame = np.array([first, np.cross(director, first)])
    local = np.einsum("ai,kij,bj->kab", frame, stresses, frame)
    plane = (centres - place) @ frame.T
    basis = np.column_stack([np.ones(len(plane)), plane])
    fit = np.linalg.lstsq(basis, local.reshape(len(plane), 4), rcond=None)[0][0].reshape(2, 2)
    values, vectors = np.linalg.eigh(fit)
    return values[-1], vectors[:, -1] @ frame

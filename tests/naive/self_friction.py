"""Friction of a point on a sheet by virtual work: differences of the place that it slides on."""

import numpy as np

from naive.self_contact import shape


def place_on_sheet(corners, xi, eta, over):
    """The place over a quad's foot, at a distance along its normal, carried by its corners."""
    eps = 1e-6
    c = shape(xi, eta) @ corners
    along_xi = (shape(xi + eps, eta) - shape(xi - eps, eta)) @ corners
    along_eta = (shape(xi, eta + eps) - shape(xi, eta - eps)) @ corners
    n = np.cross(along_xi, along_eta)
    return c + over * n / np.linalg.norm(n)


def slip_speed(v_point, corners, v_corners, xi, eta, over):
    """Of the point against the sheet's film where it is."""
    eps = 1e-6 / np.abs(v_corners).max()
    ahead, behind = (
        place_on_sheet(corners + s * eps * v_corners, xi, eta, over) for s in (1.0, -1.0)
    )
    return v_point - (ahead - behind) / (2.0 * eps)


def forces_on_sheet(f, corners, xi, eta, over):
    """Minus what a force on the point does to the corners, (4, 3): that of virtual work."""
    found, eps = np.zeros((4, 3)), 1e-6
    for a in range(4):
        for c in range(3):
            moved = np.zeros((4, 3))
            moved[a, c] = eps
            ahead, behind = (
                place_on_sheet(corners + s * moved, xi, eta, over) for s in (1.0, -1.0)
            )
            found[a, c] = -f @ (ahead - behind) / (2.0 * eps)
    return found


def returned(pulled, pressed, mu, stiffness):
    """The return mapping: the elongation after the step."""
    pressure = np.linalg.norm(pressed)
    across = pulled - pulled @ pressed / pressure**2 * pressed
    most = mu * pressure / stiffness
    return across * min(1.0, most / max(np.linalg.norm(across), 1e-300))

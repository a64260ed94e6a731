"""What a Statics solves, as dense matrices."""

from shellcut.statics.freedoms import Freedoms


def dense(film, *, true_inertia=True):
    """Return stiffness and diagonal mass of the free freedoms of a film as it is."""
    freedoms, node, n = Freedoms(film.state), film.state.node, film.mesh.n_node
    inertia = node.inertia[:n]
    if true_inertia:
        inertia = node.mass[:n] * film.shell.material.thickness**2 / 12.0
    mass = freedoms.diagonal(node.mass[:n], inertia)[freedoms.free]
    return freedoms.restrict(freedoms.stiffness(film.shell)).toarray(), mass

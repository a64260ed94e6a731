"""The cantilever strip of B01 to B03."""

from collections.abc import Sequence

from shellcut import ShellMaterial, Statics, Support
from shellcut.loads.loads import Load
from shellcut.mesh.structured import rectangle


def cantilever(length: float, n: int, loads: Sequence[Load]) -> Statics:
    """Return a strip of n x 1 quads, 1 wide, 0.1 thick, E = 1.2e6, nu = 0, clamped at x = 0."""
    material = ShellMaterial.homogeneous(young=1.2e6, poisson=0.0, density=1e-9, thickness=0.1)
    mesh = rectangle(length, 1.0, n_x=n, n_y=1)
    return Statics(mesh, material, supports=[Support.clamped("left")], loads=loads)

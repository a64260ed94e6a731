"""The trouser test: two legs of a notched strip are pulled apart, out of its plane, and tear it.

docs/howto/tear.md says what it measures. The legs must be stiff beside the force, G h / 2 on each,
the pull slow beside it (rho h b V² of a leg of breadth b), and the process zone short against the
strip; the defaults are so chosen.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from shellcut.arguments import Option, checked
from shellcut.cables.cohesive_law import CohesiveLaw, CohesiveTable
from shellcut.fracture.options import Fracture
from shellcut.loads.supports import Ramped, Support
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh
from shellcut.mesh.outline import QuadSize
from shellcut.mesh.structured import rectangle
from shellcut.simulation.simulation import Simulation

from .case import PAPER_DAMPING, Case, ModelOptions, damped_by, time_of_travel

if TYPE_CHECKING:
    from typing_extensions import Unpack

TEAR_LAW = CohesiveLaw(
    strength=7.0, plateau=5.6, opening_a=0.4, opening_p=1.6, opening_u=2.4, onset=0.02
)
"""Default law: 11.5 N/mm, torn over 2.4 mm, several sides of the default quads."""

THICKNESS = 0.2
"""Default thickness [mm]: the legs are stiff in bending beside their width."""

TEAR_FRACTURE = Fracture(path="free", check_every=20)
"""Default; a crack advances by one quad between two checks at most."""

MASS_DAMPING = 50.0
"""Default mass damping [1/s]: legs swing, and little else damps them."""

# Strip left before its clamped end when the run ends, over its width: less would be stiffer.
_LEFT = 2.0 / 3.0


def trouser_strip(length: float, width: float, size: float) -> Mesh:
    """Return a strip from x = 0 [mm] with the node sets ``up``, ``down`` and ``tail``.

    ``up`` and ``down`` are the ends of the legs, y > 0 and y < 0 at x = 0; ``tail`` is the other
    end.
    """
    mesh = rectangle(length, width, size=size)
    start, y = mesh.node_set("left"), mesh.nodes[:, 1]
    off = 1e-9 * width
    sets = {
        "up": start[y[start] > off],
        "down": start[y[start] < -off],
        "tail": mesh.node_set("right"),
    }
    return mesh.with_sets(node_sets=sets)


def duration_of(
    length: float, width: float, *, travel: float | None, speed: float, ramp: float
) -> float:
    """Return the duration of a test [s], with the parameters of :func:`trouser`."""
    distance = length - _LEFT * width if travel is None else travel
    return time_of_travel(distance, speed, ramp)


@checked
def trouser(
    size: QuadSize = 0.5,
    *,
    length: Annotated[float, Option("mm", "length along the tear", above=0)] = 19.0,
    width: Annotated[float, Option("mm", "width of both legs together", above=0)] = 6.0,
    notch: Annotated[float, Option("mm", "length of the cut between the legs", above=0)] = 6.0,
    travel: Annotated[
        float | None,
        Option("mm", "distance that each end moves", above=0, unset="length less 2/3 of the width"),
    ] = None,
    speed: Annotated[float, Option("mm/s", "speed of the ends, up and down", above=0)] = 2500.0,
    ramp: Annotated[float, Option("s", "time over which the speed rises", least=0)] = 3e-4,
    material: ShellMaterial | None = None,
    law: CohesiveTable | None = None,
    **options: Unpack[ModelOptions],
) -> Case:
    """Build the trouser test.

    Parameters
    ----------
    material, law : ShellMaterial, CohesiveTable, optional
        By default the elastic constants of the paper's film, 0.2 mm thick, and 11.5 N/mm torn over
        2.4 mm.
    **options
        Options of :class:`Simulation`. ``fracture`` has ``path="free"`` by default, and a check
        every 20 steps; ``damping_alpha`` is 50 /s.

    Returns
    -------
    Case

    Examples
    --------
    >>> case = trouser(1.0, length=10.0, notch=3.0)
    >>> case.simulation.mesh.n_quad, round(1e3 * case.duration, 2)
    (60, 2.55)
    """
    if not notch < length:
        raise ValueError(f"notch must lie within the length of {length} mm, got {notch}")
    duration = duration_of(length, width, travel=travel, speed=speed, ramp=ramp)
    mesh = trouser_strip(length, width, size)
    legs = [
        Support(leg, translation="yz", rotation="", velocity={"z": Ramped(rate, ramp)})
        for leg, rate in (("up", speed), ("down", -speed))
    ]
    chosen: ModelOptions = {"fracture": TEAR_FRACTURE, "damping_alpha": MASS_DAMPING}
    chosen |= damped_by(PAPER_DAMPING, options)
    simulation = Simulation(
        mesh,
        material or ShellMaterial.homogeneous(thickness=THICKNESS),
        supports=[Support.clamped("tail"), *legs],
        law=law or TEAR_LAW,
        **chosen,
    )
    if simulation.fracture.path != "free":
        raise ValueError("the trouser test needs fracture.path = 'free': nothing steers its crack")
    simulation.notch((-length, 0.0, 0.0), (notch, 0.0, 0.0))
    return Case("trouser", simulation, duration)

"""What cannot be right is refused before the run: what is wrong, where, and what to do.

Nothing here steps: the errors come from the constructors.
"""

import dataclasses

import numpy as np
import pytest

from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.checks import check_model
from shellcut.fracture.options import Fracture
from shellcut.loads.loads import EdgeTraction, Gravity, NodalForce, Pressure
from shellcut.loads.supports import Support
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.structured import rectangle
from shellcut.models import guillotine
from shellcut.simulation.simulation import Simulation
from shellcut.tool.motion import StraightMotion
from shellcut.tool.shapes import straight_blade
from shellcut.tool.table_motion import TableMotion
from shellcut.tool.tool import Tool

SHEET = rectangle(4.0, 4.0, size=1.0)  # 25 nodes, node 12 in the middle
BLADE = straight_blade()
MOTION = StraightMotion((1.0, 0.0, 0.0), speed=6000.0)
NAN = float("nan")
MASKED = np.ma.array([1, 2], mask=[False, True])
TIMES = np.ma.array([0.0, 1e-4, 2e-4], mask=[False, True, False])
HALF = np.ma.masked_invalid(np.full((25, 3), NAN))


def _blade_at(x, y):
    return dataclasses.replace(BLADE, vertices=BLADE.vertices + np.array([x, y, 0.0]))


def _simulate(mesh=SHEET, **options):
    return Simulation(mesh, ShellMaterial.homogeneous(), **options)


def _supported(*supports):
    return _simulate(supports=supports)


def _slow(_time):
    return 1.0


def _free():
    return _simulate(law=CohesiveLaw(), fracture=Fracture(path="free"))


def _moved(name, function=_slow):
    return Support(name, velocity={"y": function})


# What is done, and the words of the message, in parts.
VALUES = [
    (
        lambda: _supported(Support.clamped("tops")),
        "(top, bottom, left, right) … got 'tops' … did you mean 'top'",
    ),
    (
        lambda: _simulate(loads=[NodalForce("middle", (0.0, 0.0, 1.0))]),
        "(left, right, bottom, top) … got 'middle'",
    ),
    (
        lambda: _simulate(loads=[Pressure(1.0, quads="half")]),
        "quad set must be one of those present (none) … got 'half' … "
        "with_sets(quad_sets=...) in Python, or as a group of quads in the file of a film",
    ),
    (lambda: _supported(Support.clamped([0, 99])), "node ids must lie in 0..24 … got [99]"),
    (lambda: _supported(Support.clamped([-1])), "node ids must lie in 0..24 … got [-1]"),
    (lambda: _supported(Support.clamped([])), "name of a node set or a list of node ids … got []"),
    (
        lambda: Support("top", translation="xw"),
        "translation must be made of the letters x, y, z … 'xw'",
    ),
    (
        lambda: Support("top", translation="x", velocity={"y": _slow}),
        "['y'] … translation 'x' does not support … add these axes",
    ),
    (
        lambda: _supported(_moved("top"), _moved("left", abs)),
        "two supports prescribe the velocity along y … nodes [20] … keep one of them",
    ),
    (
        lambda: _supported(_moved("top"), Support.clamped("left")),
        "along y … nodes [20]",
    ),
    (lambda: _supported(_moved("top", 3.0)), "velocity … function"),
    (
        lambda: _simulate(loads=[EdgeTraction([6, 7, 8], (1.0, 0.0, 0.0))]),
        "needs quad sides on the border … [6, 7, 8]",
    ),
    (
        lambda: _simulate(loads=[Gravity((0.0, 9810.0))]),
        "acceleration must be three finite numbers … (0.0, 9810.0)",
    ),
    (lambda: _simulate(tool=_blade_at(-0.1, 0.0)), "tool and motion go together … both or none"),
    (lambda: _simulate(motion=MOTION), "tool and motion go together … both or none"),
    (
        lambda: ShellMaterial.homogeneous(density=0.92),
        "density must be in t/mm³ … got 0.92 … 1 g/cm³, is 1e-9 t/mm³",
    ),
    (lambda: ShellMaterial([]), "at least one layer"),
    (lambda: _simulate(damping_alpha=-0.1), "damping_alpha … got -0.1"),
    (lambda: _simulate(damping_beta=NAN), "damping_beta … got nan"),
    (lambda: _simulate().run(until=-1.0), "until must not lie before now … got -1.0"),
    (lambda: _simulate(velocity=np.zeros((3, 3))), "velocity must have shape (25, 3) … got (3, 3)"),
    (lambda: _simulate(velocity=np.full((25, 3), NAN)), "velocity … finite"),
    (
        lambda: guillotine(1.0, length=6.0, width=4.0, tool=_blade_at(0.0, 3.0)),
        "must pass through the strip, between y = -2 and 2 mm, got y = 3 mm",
    ),
]

KINDS = [
    (lambda: _simulate(supports="bottom"), "supports must be … Support … 'bottom'"),
    (lambda: _simulate(loads=[3]), "loads must be a sequence of Gravity … [3]"),
    (lambda: _simulate(tool=SHEET, motion=MOTION), "tool must be a Tool, got a Mesh"),
    (lambda: _simulate(motion=_slow), "motion must be a Motion, which has … pose"),
    (
        lambda: _simulate(tool="blade", contact={}),
        "tool must be a Tool, got 'blade';  … contact must be a Contact, got {}",
    ),
    (
        lambda: _simulate().run(1e-3, [print]),
        "hooks must be a sequence of Hook, which has due, __call__, close",
    ),
    (lambda: NodalForce("top", (1j, 0.0, 0.0)), "force must be … numbers"),
    (lambda: TableMotion(TIMES, np.zeros((3, 3))), "times must … compressed()"),
    (lambda: TableMotion([0, 1], [[0, 0, 0], [1j, 0, 0]]), "translations must"),
    (lambda: Support.clamped(MASKED), "nodes must be … masked array"),
    (lambda: _simulate(velocity=HALF), "velocity must be an array of real numbers … masked array"),
    (
        lambda: _free().notch((-1j, 0, 0), (1, 0, 0)),
        "points must be a sequence of arrays of real numbers",
    ),
    (lambda: SHEET.with_sets(node_sets={"grip": MASKED}), "node_sets must be a mapping to"),
    (
        lambda: Tool.from_triangles(BLADE.vertices * 1j, BLADE.triangles),
        "vertices must be an array of real numbers, got an array of complex128",
    ),
]


@pytest.mark.parametrize(
    ("kind", "build", "words"),
    [*((ValueError, *one) for one in VALUES), *((TypeError, *one) for one in KINDS)],
)
def test_it_is_refused(kind, build, words):
    with pytest.raises(kind) as error:
        build()
    for part in words.split(" … "):
        assert part in str(error.value)


# What takes a number of this name without declaring it; tests/unit/test_options.py has others.
NUMBERS = {
    "damping_alpha": _simulate,
    "threads": _simulate,
    "until": lambda until: _simulate().run(until),
}


@pytest.mark.parametrize("name", NUMBERS)
def test_no_number(name):
    for given in (NAN, True, "1678", 1.0 + 0.0j, [1.0], np.ones(2), np.ma.masked, None):
        if given is None and name == "threads":
            continue
        with pytest.raises(ValueError, match=rf"\b{name}\b"):
            NUMBERS[name](**{name: given})


class _Lost(StraightMotion):
    """A motion whose pose is none from some time on."""

    def pose(self, time):
        rotation, translation = super().pose(time)
        return rotation, translation * (NAN if time > 1e-5 else 1.0)


def test_a_pose_that_is_none_ends_the_run_by_name():
    lost = _Lost((1.0, 0.0, 0.0), speed=6000.0)
    sim = _simulate(tool=_blade_at(-0.1, 0.0), motion=lost, law=CohesiveLaw())
    for run in (lambda: sim.run(1e-3), lambda: check_model(sim, 1e-3)):
        with pytest.raises(ValueError, match=r"the pose of _Lost at \S+ s must be a rotation"):
            run()


def test_supports_that_agree_are_accepted():
    # The corner belongs to both sets: held twice, or moved twice by the same function, is no clash.
    _supported(Support.clamped("top"), Support.clamped("left"))
    _supported(_moved("top"), _moved("left"))

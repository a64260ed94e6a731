"""Of each mechanism a run that goes on from a checkpoint amid it, on other threads, bit for bit."""

from dataclasses import replace

import pytest

import shellcut as sc
from gone_on import check_goes_on
from notched_strip import cutting
from shellcut.models import opening_test
from shellcut.tool.shapes import straight_blade
from test_force_terms import tethered
from test_point_contact import pricked
from test_self_friction import lying
from two_pieces import thrown

SHORT = {"opening_a": 0.05, "opening_p": 0.2, "opening_u": 0.3}
SLIP = sc.CohesiveLaw(**SHORT, joint="slip", joint_friction=0.2)


def slicing(**options):
    """A slicing cut with all that rubs."""
    motion = sc.StraightMotion((1.0, 0.0, 1.0), 3e4, ramp=5e-6)
    inputs = cutting(motion=motion).inputs | {"law": SLIP, "contact": sc.Contact(friction=0.2)}
    return sc.Simulation(**inputs, **options)


def blunt(**options):
    blade = straight_blade(half_thickness=0.1, length=2.0, height=2.0, edge_radius=0.05)
    inputs = cutting().inputs | {"tool": blade.translated((-0.02, 0.0, 0.0))}
    law = replace(SLIP, joint_friction=0.3)
    return sc.Simulation(**inputs | {"law": law}, **options)


def rims(friction):
    """Teeth that enter a film and cut it; its edges press, and rub, for some steps."""
    contact = sc.Contact(film_edges=True, friction=friction)
    return lambda **options: opening_test("quick", contact=contact, **options).simulation


def term(sim, name):
    return next(one for one in sim.terms if one.name == name)


def stores(name, n_step=20):
    """Whether a term has held energy at so many steps: it is within a touch."""
    held = []

    def reached(sim):
        if term(sim, name).forces.stored > 0.0:
            held.append(sim.state.step)
        return len(held) >= n_step

    return reached


def slips(sim):
    ledger = sim.ledger
    return sim.cables.n_joint_made >= 2 and min(ledger.joint_friction, ledger.friction_work) > 0.0


def drags(sim):
    return sim.ledger.joint_friction > 0.0 and sim.state.cable.arc_grip.any()


RUNS = {
    "joints that slip": (slicing, slips, 200),
    "a blunt edge": (blunt, drags, 300),
    "friction on faces": (
        lambda **options: cutting(contact=sc.Contact(friction=0.2), **options),
        lambda sim: sim.state.step == 431 and sim.state.node.friction_spring.any(),
        269,
    ),
    "points of the tool that rub": (
        lambda **options: pricked(friction=0.2, **options),
        lambda sim: sim.motion.coordinate(sim.state.time) > 0.057,
        300,
    ),
    "edges of the film": (rims(0.0), stores("edges"), 150),
    "edges that rub": (rims(0.2), stores("edge_friction"), 150),
    "the film on itself": (  # while a point touches, between two searches
        lambda **options: thrown((0.13, 0.07, 0.2), (0.0, 0.0, 3000.0), **options),
        stores("self_contact", 4),
        150,
    ),
    "the film rubs on itself": (
        lambda **options: lying(1e7, **options)[0],
        lambda sim: sim.state.step == 150 and sim.close_ledger().friction_stored > 0.0,
        150,
    ),
    "a term of one's own": (tethered, lambda sim: sim.state.step == 150, 250),
}


@pytest.mark.parametrize("name", RUNS)
def test_a_run_goes_on_amid_it(name, tmp_path):
    build, reached, n_step = RUNS[name]
    check_goes_on(build, reached, tmp_path / "c.h5", n_step)

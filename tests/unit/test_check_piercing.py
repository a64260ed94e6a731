"""What is told before a run of a film that its tool comes down on."""

import numpy as np
import pytest

import shellcut
from shellcut import CohesiveLaw, Elastic, Fracture, Layer, ShellMaterial, opening_test
from shellcut.fracture.puncture import bending_length


def doubts(**options):
    case = opening_test("quick", **options)
    findings = shellcut.check_model(case.simulation, case.duration).findings
    return [str(one) for one in findings if "pierce" in str(one)]


def brittle(length):
    """A law whose modulus times energy over strength² is a multiple of the bending length."""
    law = CohesiveLaw()
    bent = bending_length(ShellMaterial.homogeneous(), law)
    scale = length * bent * 18.0**2 / (1678.0 * law.fracture_energy)
    openings = {f"opening_{k}": scale * getattr(law, f"opening_{k}") for k in "apu"}
    return CohesiveLaw(**openings, onset=0.01 * scale)


def test_a_film_that_tears_on_by_itself_is_doubted():
    assert doubts() == doubts(law=brittle(1.05)) == []
    (said,) = doubts(law=brittle(0.95))
    assert "0.205 mm and 0.216 mm" in said
    assert "fracture.puncture_force" in said
    assert doubts(law=brittle(0.95), fracture=Fracture(puncture_force=0.4)) == []


def test_a_film_soft_in_shear_is_doubted():
    film = ShellMaterial(
        [Layer(Elastic(e, 0.3, 1e-9), h) for e, h in ((7e4, 0.009), (200.0, 0.056), (7e4, 0.009))]
    )
    (said,) = doubts(material=film, law=CohesiveLaw(strength=40.0))
    assert "got 0.5 of it" in said


@pytest.mark.parametrize(("first", "told"), [(17.0, True), (19.0, False)])
def test_a_film_that_yields_below_its_strength_is_doubted(first, told):
    film = shellcut.preset_film("pet", yield_stress=first)
    assert any("where it yields " in said for said in doubts(material=film)) == told


@pytest.mark.parametrize(("share", "told"), [(0.25, False), (0.5, True)])
def test_a_film_that_is_tight_is_doubted(share, told):
    case = opening_test("quick")
    sim = case.simulation
    strain = share * 18.0 * 0.7 / 1678.0  # of both directions at nu = 0.3
    sim.relax(strain * sim.mesh.nodes * [1.0, 1.0, 0.0])
    said = [str(one) for one in shellcut.check_model(sim, case.duration).findings]
    assert bool(said) == told
    if told:
        assert f"a tip takes {np.sqrt(1.0 - share**2):.2g} of the usual force" in said[0]


def test_edges_that_come_in_over_the_rim_pierce_nothing():
    case = shellcut.guillotine(0.8, law=brittle(0.95))
    said = [str(one) for one in shellcut.check_model(case.simulation, case.duration).findings]
    assert not any("pierces" in one for one in said)

"""The warm-up goes through every mechanism, so that nothing is compiled inside a timed run."""

from shellcut import Fracture
from shellcut.models.guillotine import guillotine


def test_the_tiny_film_is_split_and_its_cables_meet_the_edge():
    case = guillotine(1.0, length=6.0, width=4.0, notch=1.0, travel=1.5, fracture=Fracture())
    case.simulation.run(case.duration)
    assert case.simulation.state.n_cable >= 1
    assert case.simulation.cables.n_joint_made >= 1
    assert case.simulation.contact.forces.n_touching + case.simulation.ledger.contact_work != 0

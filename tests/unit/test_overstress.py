"""Film that carries more than its strength where no crack can begin is doubted after a run."""

import json

import pytest

import shellcut as sc
from shellcut.mesh.structured import rectangle

LENGTH, UNTIL = 16.0, 1e-3
FILM = sc.ShellMaterial.homogeneous()
LAW = sc.CohesiveLaw()


def pulled(share, folder, notch=()):
    """Stretch a strip up to a share of its strength; return the summary and the doubts."""
    strain = share * LAW.strength / FILM.layers[0].material.young
    sim = sc.Simulation(
        rectangle(LENGTH, 6.0, size=0.5),
        FILM,
        supports=[
            sc.Support("left"),
            sc.Support("right", velocity={"x": lambda _: strain * LENGTH / UNTIL}),
        ],
        law=LAW,
    )
    if notch:
        sim.notch(*notch)
    output = sc.Recorder(sim, folder, until=UNTIL, name="strip", progress=False, n_snapshot=0)
    sim.run(UNTIL, [output])
    doubts = [line.text for line in output.verdict if line.kind == "doubt"]
    return json.loads((folder / "summary.json").read_text()), doubts


@pytest.mark.parametrize(("share", "doubted"), [(0.9, False), (1.5, True)])
def test_a_strip_without_a_notch_is_doubted_from_its_strength_on(tmp_path, share, doubted):
    summary, doubts = pulled(share, tmp_path / "out")
    # Ends that cannot contract, and waves of the start, change the stress by some per cent.
    assert summary["overstress_rel"] == pytest.approx(share, rel=0.08)
    assert any("torn where it has no notch" in text for text in doubts) == doubted


def test_a_notch_that_tears_relieves_the_film(tmp_path):
    notch = [(0.5 * LENGTH, -3.5, 0.0), (0.5 * LENGTH + 0.03, 1.0, 0.0)]
    summary, doubts = pulled(1.5, tmp_path / "out", notch)
    assert summary["crack_length_mm"] > 1.0
    assert summary["overstress_rel"] < 1.0
    assert not any("torn where it has no notch" in text for text in doubts)

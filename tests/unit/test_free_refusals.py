"""What cracks through quads cannot do yet is refused in words, all at once."""

import numpy as np
import pytest

import shellcut as sc
from free_strip import cut_strip
from notched_strip import cutting


def test_fracture_names_every_option_that_does_not_go():
    with pytest.raises(ValueError, match=r"criterion = 'force' only, got 'stress'.*turn_limit_deg"):
        sc.Fracture(path="free", criterion="stress", turn_limit_deg=80.0)
    with pytest.raises(ValueError, match="path must be 'free' or 'edges', got 'quads'"):
        sc.Fracture(path="quads")


def test_simulation_refuses_anisotropy_under_a_tool():
    sim = cutting()
    film = sc.Anisotropy(direction=(1.0, 0.0, 0.0), along=0.5)
    with pytest.raises(ValueError, match=r"cracks that no blade drives, got a tool"):
        sc.Simulation(
            sim.mesh,
            sim.material,
            tool=sim.tool,
            motion=sim.motion,
            law=sc.CohesiveLaw(),
            fracture=sc.Fracture(path="free", anisotropy=film),
        )


def test_a_notch_that_cannot_be_cut_is_refused():
    sim = cutting()
    with pytest.raises(ValueError, match=r"through quads.*Mesh\.cut"):
        sim.notch((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    sim = cut_strip()
    for ends in (
        ((0.0, 0.0), (1.0, 0.0, 0.0)),
        ((0.0, 0.0, np.nan), (1.0, 0.0, 0.0)),
        ([1.0] * 3,) * 2,
    ):
        with pytest.raises(ValueError, match="two different points in mm"):
            sim.notch(*ends)
    with pytest.raises(ValueError, match="must begin on the film or at its rim"):
        sim.notch((0.0, 0.0, 50.0), (1.0, 0.0, 50.0))
    sim.state.node.x[3] += 1e-3
    with pytest.raises(ValueError, match="before it is stretched"):
        sim.notch((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))

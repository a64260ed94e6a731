"""What cracks through quads cannot do yet is refused in words, all at once."""

import pytest

import shellcut as sc
from notched_strip import cutting


def test_fracture_names_every_option_that_does_not_go():
    with pytest.raises(ValueError, match=r"criterion = 'force' only, got 'stress'.*candidates"):
        sc.Fracture(path="free", criterion="stress", candidates="all")
    with pytest.raises(ValueError, match=r"path must be one of \('edges', 'free'\), got 'quads'"):
        sc.Fracture(path="quads")


def test_simulation_names_supports_and_loads():
    sim = cutting()
    moving = sc.Support("top", translation="xyz", rotation="", velocity={"y": lambda time: 1.0})
    film = sc.Anisotropy(direction=(1.0, 0.0, 0.0), along=0.5)
    with pytest.raises(ValueError, match=r"supports that rest.*no blade drives.*a pressure"):
        sc.Simulation(
            sim.mesh,
            sim.material,
            supports=[moving],
            loads=[sc.Pressure(0.1)],
            tool=sim.tool,
            motion=sim.motion,
            law=sc.CohesiveLaw(),
            fracture=sc.Fracture(path="free", anisotropy=film),
        )

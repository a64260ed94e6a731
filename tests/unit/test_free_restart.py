"""A run with cracks through quads goes on from a checkpoint as the uninterrupted run."""

import numpy as np
import pytest

import shellcut as sc
from free_strip import cut_strip
from shellcut.material.shell_material import Elastic, Layer, ShellMaterial
from shellcut.recording.checkpoint import CheckpointError, load_checkpoint, save_checkpoint
from test_checkpoint import differing, numbers_of

LAYERED = ShellMaterial(
    [Layer(Elastic(2000.0, 0.3, 1.1e-9), 0.03), Layer(Elastic(900.0, 0.4, 0.9e-9), 0.05)],
    points_per_layer=2,
)
RUNS = {
    "plain": {},
    "layers": {"material": LAYERED},
    "single": {"precision": "single"},
    "threads": {"threads": 2},
}


@pytest.mark.parametrize("options", RUNS.values(), ids=RUNS)
def test_it_goes_on_with_the_same_bits(options, tmp_path):
    sim = cut_strip(**options)
    assert sim.state.n_quad > sim.mesh.n_quad  # the notch
    n_notch = sim.state.n_quad
    while sim.cables.n_joint_made < 6 or sim.state.step % 5 != 3:
        sim.step()
    assert sim.state.n_quad > n_notch
    save_checkpoint(sim, tmp_path / "c.h5")
    again = cut_strip(**options)
    load_checkpoint(again, tmp_path / "c.h5")
    assert differing(sim, again) == []
    n_quad = sim.state.n_quad
    for _ in range(500):
        sim.step()
        again.step()
    assert sim.state.n_quad > n_quad
    assert sim.cables.n_broken > 0
    assert again.state.split_log == sim.state.split_log
    assert differing(sim, again) == []
    mine, other = numbers_of(sim), numbers_of(again)
    rows = {
        "node": sim.state.n_node,
        "cable": sim.state.n_cable,
        "quad": sim.state.n_quad,
        "flank": sim.state.flank.count,
    }

    def used(path, array):
        table = path.removeprefix("sim.state.").partition(".")[0]
        return (
            array[: rows[table]]
            if path.startswith("sim.state.") and table in rows and array.ndim
            else array
        )

    assert mine.keys() == other.keys()
    assert [
        path for path in mine if not np.array_equal(used(path, mine[path]), used(path, other[path]))
    ] == []


def test_a_film_with_more_cuts_from_the_start_is_refused(tmp_path):
    bare = sc.Simulation(cut_strip().mesh, ShellMaterial.homogeneous())
    save_checkpoint(bare, tmp_path / "bare.h5")
    with pytest.raises(CheckpointError):
        load_checkpoint(cut_strip(), tmp_path / "bare.h5")

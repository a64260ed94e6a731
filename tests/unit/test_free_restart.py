"""A run with cracks through quads goes on from a checkpoint as the uninterrupted run."""

import numpy as np
import pytest

import shellcut as sc
from free_strip import NOTCH, cut_strip, slanted_strip
from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.fracture.options import Fracture
from shellcut.material.shell_material import Elastic, Layer, ShellMaterial
from shellcut.models import guillotine
from shellcut.recording.checkpoint import CheckpointError, load_checkpoint, save_checkpoint
from shellcut.recording.recorder import Recorder
from shellcut.simulation.hooks import StopWhen
from test_checkpoint import differing, numbers_of

LAYERED = ShellMaterial(
    [Layer(Elastic(2000.0, 0.3, 1.1e-9), 0.03), Layer(Elastic(900.0, 0.4, 0.9e-9), 0.05)],
    points_per_layer=2,
)
LOADS = [
    sc.Pressure(0.002, following=True, factor=lambda time: min(time / 1e-4, 1.0)),
    sc.Pressure(0.001),
    sc.EdgeTraction("right", (0.01, 0.0, 0.0)),
    sc.Gravity((0.0, 0.0, -9810.0)),
]
PULLED = [
    sc.Support("bottom"),
    sc.Support("top", velocity={"y": lambda time: 30.0 * min(time / 1e-4, 1.0)}),
]
RUNS = {
    "plain": {},
    "layers": {"material": LAYERED},
    "threads": {"threads": 2},
    "loaded and pulled, cables at Gauss points": {
        "loads": LOADS,
        "supports": PULLED,
        "fracture": Fracture(path="free", check_every=5, cable_places="gauss"),
    },
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
    for numbers in (mine, other):  # of searches since the run began, or since the checkpoint
        del numbers["sim.cracks._pierce._near.n_search"]
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


def short_guillotine(**options):
    """A guillotine on a mesh of the user's own that ignores the path."""
    options.setdefault("fracture", Fracture(path="free"))
    return guillotine(
        mesh=slanted_strip(),
        notch=NOTCH,
        travel=3.0,
        speed=2e4,
        law=CohesiveLaw(strength=18.0, opening_a=0.05, opening_p=0.2, opening_u=0.3),
        **options,
    )


def test_a_guillotine_through_quads_keeps_its_mesh_and_has_its_notch():
    case = short_guillotine()
    free = case.simulation.cracks
    np.testing.assert_array_equal(case.simulation.mesh.nodes, slanted_strip().nodes)
    np.testing.assert_allclose(free.at_tips(case.simulation.mesh.nodes), [[1.2, 0, 0]], atol=1e-9)
    assert case.simulation.state.crack_length == 0.0
    whole = guillotine(mesh=slanted_strip(), notch=0.0, fracture=Fracture(path="free")).simulation
    assert whole.state.n_quad == whole.mesh.n_quad


def test_an_interrupted_run_leaves_the_files_of_the_uninterrupted_one(tmp_path):
    case = short_guillotine()
    options = {"n_snapshot": 0, "n_frame": 5, "progress": False}
    case.run(tmp_path / "whole", **options)
    first = short_guillotine()
    sim, stop = first.simulation, 0.6 * first.duration
    recorder = Recorder(
        sim,
        tmp_path / "parts",
        until=first.duration,
        name="guillotine",
        check=first.check,
        **options,
    )
    sim.run(first.duration, [recorder, StopWhen(lambda: sim.state.time > stop)])
    assert sim.state.n_quad > sim.mesh.n_quad + 4
    assert sim.cables.n_joint_made > 0
    again = short_guillotine()
    again.run(tmp_path / "parts", resume=True, **options)
    assert differing(case.simulation, again.simulation) == []
    for name in ("history.csv", "splits.csv"):
        assert (tmp_path / "parts" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()
    one, other = (sc.read(tmp_path / name) for name in ("whole", "parts"))
    np.testing.assert_array_equal(one.frame(-1).points, other.frame(-1).points)
    np.testing.assert_array_equal(one.frame(-1).quads, other.frame(-1).quads)

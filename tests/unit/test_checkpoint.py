"""A run that goes on from a checkpoint is the uninterrupted run, bit for bit."""

import errno
import json
import os
import re
import signal
import sys

import h5py
import numpy as np
import pytest

import shellcut as sc
import shellcut.recording.checkpoint
import shellcut.recording.recorder
import shellcut.recording.unfelt_penetration
from free_strip import cut_strip
from gone_on import differing, flat, numbers_of
from notched_strip import cutting
from open_files import is_open
from same_run import assert_same_run
from shellcut.mesh.structured import rectangle
from shellcut.models import Case
from shellcut.recording.checkpoint import CheckpointError
from shellcut.recording.cut_front import CutFront
from shellcut.recording.recorder import RunEnded
from shellcut.recording.run_files import RunFiles
from shellcut.results.history import read_history
from shellcut.simulation.hooks import StopWhen
from shellcut.simulation.instability import UnstableStep
from shellcut.state import BROKEN

try:
    import matplotlib
except ImportError:
    matplotlib = None

END = 8e-5

pytestmark = pytest.mark.usefixtures("no_pictures")

STIFF, SOFT = sc.Elastic(2000.0, 0.3, 1.1e-9), sc.Elastic(900.0, 0.4, 0.9e-9)
LAYERED = sc.ShellMaterial([sc.Layer(STIFF, 0.03), sc.Layer(SOFT, 0.05)], points_per_layer=2)


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
ASIDE = {
    "material": LAYERED,
    "loads": LOADS,
    "supports": PULLED,
    "fracture": sc.Fracture(path="free", check_every=5),
}
RUNS = {"force": (cutting, END, {}), "through quads": (cut_strip, 1.5e-4, ASIDE)}


def built(name):
    build, _, options = RUNS[name]
    return build(**options)


@pytest.fixture(scope="module", params=RUNS)
def whole(request, tmp_path_factory):
    """An uninterrupted run, checkpoints of it at some steps, and the steps it took."""
    folder = tmp_path_factory.mktemp(request.param)
    sim, end = built(request.param), RUNS[request.param][1]
    steps, dts = {}, []
    moments = {
        "start": lambda: True,
        "before contact": lambda: sim.state.step == 5,
        "contact": lambda: sim.contact.forces.n_touching > 0,
        "split": lambda: sim.state.n_cable > 0,
        "joint": lambda: sim.cables.n_joint_made > 0,
        "amid": lambda: len(sim.state.splits) >= 2,
        "break": lambda: sim.cables.n_broken > 0,
        "late": lambda: sim.state.time > 0.93 * end,
    }
    while sim.state.time < end:
        for moment, has_come in moments.items():
            if moment not in steps and has_come():
                sc.save_checkpoint(sim, folder / f"{moment}.h5")
                steps[moment] = sim.state.step
        sim.step()
        dts.append(sim.state.dt)
    assert steps.keys() == moments.keys()
    cable = sim.state.cable
    assert (cable.status[: cable.count] == BROKEN).any()
    assert len(np.unique(sim.state.node.contact_side[: sim.state.n_node])) > 1
    return request.param, sim, folder, steps, dts


def test_from_any_moment_on_it_is_the_same_run(whole):
    # To the next moment but one, in the very state that was saved there; from the first joint to
    # the end.
    name, sim, folder, steps, dts = whole
    moments = sorted(steps, key=steps.get)
    for moment, later in zip(moments, [*moments[2:], "", ""], strict=True):
        step, wanted, end = steps[moment], sim, len(dts)
        if later and moment != "joint":
            wanted, end = built(name), steps[later]
            sc.load_checkpoint(wanted, folder / f"{later}.h5")
        again = built(name)
        assert sc.load_checkpoint(again, folder / f"{moment}.h5") == {}
        assert again.state.step == step
        assert isinstance(again.state.step, int)
        assert all(isinstance(split.place, tuple) for split in again.state.split_log)
        for dt in dts[step:end]:
            again.step()
            assert again.state.dt == dt, moment
        assert again.state.split_log == wanted.state.split_log, moment
        assert differing(wanted, again) == [], moment
        if moment == "joint":
            check_that_nothing_else_has_a_history(sim, again)


# Numbers of searches since the run began, or since the checkpoint. Tables of the film's motion
# follow from its start; how far they go depends on who asked.
FOLLOWS = re.compile(r"_pierce\._near\.n_search$|\._(poses|twists|travel|solved)\b")


def check_that_nothing_else_has_a_history(sim, again):
    """Compare all numbers of two simulations, saved or not."""
    # The tables of the state have rows in reserve, which nobody reads.
    rows = {"node": sim.state.n_node, "cable": sim.state.n_cable}
    rows |= {"quad": sim.state.n_quad, "flank": sim.state.flank.count}

    def used(path, array):
        table = re.match(r"sim\.state\.(\w+)", path)
        return array[: rows.get(table[1])] if table and array.ndim else array

    mine, other = (
        {path: used(path, array) for path, array in numbers.items() if not FOLLOWS.search(path)}
        for numbers in (numbers_of(sim), numbers_of(again))
    )
    assert len(mine) > 300
    assert mine.keys() == other.keys()
    assert [path for path in mine if not np.array_equal(mine[path], other[path])] == []


def test_a_relaxed_film_goes_on(tmp_path):
    # Finer at one side: at the start only the quads there are evaluated one by one, then all.
    def stretched():
        mesh = rectangle(2.0, 2.0, n_x=8, n_y=8)
        nodes = mesh.nodes * (1.0, 1.0, 0.0)
        nodes[mesh.node_set("right"), 0] = 1.9
        sides = [*mesh.node_set("left"), *mesh.node_set("right")]
        return sc.Simulation(
            sc.Mesh.from_arrays(nodes, mesh.quads),
            sc.ShellMaterial.homogeneous(),
            supports=[sc.Support.pinned(sides)],
            loads=[sc.Pressure(1e-2)],
        )

    sim = stretched()
    sim.relax(sim.mesh.nodes * (0.01, 0.0, 0.0), tolerance=1e-2)
    sc.save_checkpoint(sim, tmp_path / "c.h5")
    again = stretched()
    assert {"frequencies.row", "time_step.known"} <= set(differing(sim, again))
    sc.load_checkpoint(again, tmp_path / "c.h5")
    assert differing(sim, again) == []
    for one in (sim, again):
        one.run(5e-6)
    assert differing(sim, again) == []


# --- refusals


def still(**options):
    """Return the strip with sides at rest: where nothing depends on the film's own motion."""
    return cutting(pulled=False, **options)


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    path = tmp_path_factory.mktemp("saved") / "checkpoint.h5"
    sim = cutting()
    sim.run(2e-5)
    sc.save_checkpoint(sim, path)
    return path


homogeneous = sc.ShellMaterial.homogeneous
A_TABLE = sc.TableMotion([0.0, 1.0], [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])


@pytest.mark.parametrize(
    ("options", "named"),
    [
        ({"size": 0.5}, "mesh.nodes: 46 x 3 numbers"),
        ({"material": homogeneous(young=1700.0)}, "layers[0].material.young: 1678.0"),
        ({"material": LAYERED}, "material.layers: 1 entries in"),
        ({"material": homogeneous(points_per_layer=2)}, "points_per_layer: None in"),
        ({"blade": 0.12}, "tool.vertices: "),
        ({"motion": sc.StraightMotion((1, 0, 0), 2.1e4, ramp=5e-6)}, "motion.speed: 20000.0 in"),
        ({"motion": sc.ScrewMotion(100.0, axis=(1, 0, 0))}, "motion: StraightMotion in the check"),
        ({"motion": A_TABLE}, "motion.times: nothing in the checkpoint, [0.0, 1.0] in"),
        ({"strength": 17.0}, "law.strength: 18.0 in the checkpoint, 17.0 in this simulation"),
        ({"fracture": sc.Fracture(criterion="stress")}, "fracture.criterion: 'force' in"),
        ({"pressure": 2e-3}, "loads[0].value: 0.001 in"),
        ({"set_name": "bottom"}, "supports: 2 entries in the checkpoint, 1 entries in"),
        ({"damping_beta": 1e-8}, "1e-08 in this simulation"),
        ({"directional": False}, "directional: 1.0 in"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_another_model_is_refused_and_left_as_it_is(saved, options, named):
    sim = cutting(**options)
    before = {name: rows.copy() for name, rows in flat(sim.saved()).items()}
    with pytest.raises(CheckpointError, match="belongs to another model") as refusal:
        sc.load_checkpoint(sim, saved)
    assert named in str(refusal.value)
    after = flat(sim.saved())
    assert all(np.array_equal(before[name], after[name]) for name in before)


class Sliding:
    """A motion of a user's own, which no list of fields describes."""

    coordinate_unit = "mm"

    def __init__(self, speed):
        self._motion = sc.StraightMotion((1.0, 0.0, 0.0), speed)
        self.pose, self.twist = self._motion.pose, self._motion.twist
        self.coordinate = self._motion.coordinate


def test_a_simulation_that_has_run_or_a_motion_of_another_pose_is_refused(saved, tmp_path):
    sim = cutting()
    sim.step()
    with pytest.raises(ValueError, match="not run yet, but this one is at step 1: build it again"):
        sc.load_checkpoint(sim, saved)
    sim = cutting(motion=Sliding(2e4))
    sim.run(1e-6)
    sc.save_checkpoint(sim, tmp_path / "c.h5")
    sc.load_checkpoint(cutting(motion=Sliding(2e4)), tmp_path / "c.h5")
    with pytest.raises(CheckpointError, match="motion: the translation at 1"):
        sc.load_checkpoint(cutting(motion=Sliding(2.1e4)), tmp_path / "c.h5")


def test_what_is_no_checkpoint_is_refused(saved, tmp_path):
    newer = re.sub(rb"format \d+", b"format 99", saved.read_bytes(), count=1)
    (tmp_path / "newer.h5").write_bytes(newer)
    with h5py.File(tmp_path / "foreign.h5", "w") as file:
        file["x"] = 1.0
    (tmp_path / "folder.h5").mkdir()
    (tmp_path / "empty.h5").write_bytes(b"")
    for name, said in (
        ("foreign", "is damaged, or not a checkpoint of shellcut"),
        ("newer", "has format 99; this version of shellcut reads"),
        ("none", r"there is no checkpoint .*none\.h5"),
        ("folder", "not a regular file"),
        ("empty", "is damaged, or not a checkpoint"),
    ):
        with pytest.raises((CheckpointError, FileNotFoundError), match=said):
            sc.load_checkpoint(still(), tmp_path / f"{name}.h5")


def test_a_full_disk_is_said_once_and_leaves_the_last_good_one(tmp_path, monkeypatch, caplog):
    short, path = Case("cut", still(), 5e-6), tmp_path / "c.h5"
    sc.save_checkpoint(short.simulation, path)
    good = path.read_bytes()

    def full(_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(shellcut.recording.checkpoint.os, "fsync", full)
    with pytest.raises(OSError, match="No space left"):
        sc.save_checkpoint(still(), path)
    assert path.read_bytes() == good
    assert [p.name for p in tmp_path.iterdir()] == ["c.h5"]
    short.run(tmp_path / "run", checkpoint_every=0.0, **RECORDS)
    assert short.simulation.state.time >= 5e-6
    assert caplog.text.count("no checkpoint could be written") == 1
    assert not (tmp_path / "run" / "checkpoint.h5").exists()


# --- runs in a folder


HALF = 0.5 * END
RECORDS = {"n_row": 60, "n_frame": 12, "n_snapshot": 3, "progress": False}


def case(**options):
    return Case("cut", cutting(**options), HALF)


def summary_of(folder):
    return json.loads((folder / "summary.json").read_text())


@pytest.fixture(scope="module")
def uninterrupted(no_pictures, tmp_path_factory):
    folder = tmp_path_factory.mktemp("uninterrupted")
    case().run(folder, checkpoint_every=None, **RECORDS)
    return folder


def resumed(folder, sim, end=HALF):
    """Go on with the run in a folder up to a time; return the simulation."""
    Case("cut", sim, end).run(folder, resume=True, progress=False)
    return sim


def interrupted_at(step, patch):
    """Make checkpoints raise SIGINT at a step."""
    real, raised = sc.save_checkpoint, []

    def save(sim, path, *, extra):
        real(sim, path, extra=extra)
        if sim.state.step == step and not raised:
            raised.append(step)
            signal.raise_signal(signal.SIGINT)

    patch.setattr(shellcut.recording.recorder, "save_checkpoint", save)


def test_what_a_caller_adds_comes_back(tmp_path):
    for extra in ({}, {"a": 1, "b": {"c": 2.5}}):
        sc.save_checkpoint(cutting(), tmp_path / "c.h5", extra=extra)
        assert sc.load_checkpoint(cutting(), tmp_path / "c.h5") == extra


@pytest.fixture
def heard_interrupts():
    # A shell starts programs in the background with Ctrl-C ignored, and a run respects that.
    former = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, former)


@pytest.mark.usefixtures("heard_interrupts")
def test_after_ctrl_c_a_run_goes_on(uninterrupted, tmp_path, monkeypatch, caplog):
    first = case()
    with monkeypatch.context() as patch:
        interrupted_at(200, patch)
        with pytest.raises(KeyboardInterrupt):
            first.run(tmp_path, checkpoint_every=0.0, **RECORDS)
    # Between steps, at once, everything saved and said; 200 checkpoints have changed nothing.
    assert first.simulation.between_steps
    assert first.simulation.state.step == 200
    assert "cut stopped at path" in caplog.text
    assert f"resume from the checkpoint in {tmp_path}" in caplog.text
    assert sc.read(tmp_path).times[-1] == first.simulation.state.time < HALF
    # As if there had been a long time before.
    saved, path = cutting(), tmp_path / "checkpoint.h5"
    extra = sc.load_checkpoint(saved, path)
    assert "wall" in extra
    sc.save_checkpoint(saved, path, extra=extra | {"wall": 1000.0})
    resumed(tmp_path, cutting())
    assert_same_run(tmp_path, uninterrupted)
    assert 1000.0 < summary_of(tmp_path)["wall_s"] < 1100.0


def test_where_a_cut_stands_is_kept_to_the_last_digit():
    # On a circle, where the way ahead is found with other round-off at every step.
    turning = sc.ScrewMotion(500.0, axis=(0.0, 0.0, 1.0), axis_point=(0.0, 40.0, 0.0))
    sim = cutting(motion=turning)
    front, again = CutFront(sim, END), CutFront(sim, END)
    while not front.rows(sim)[:, 2].any():
        sim.step()
    again.restore(front.saved())
    sim.step()
    np.testing.assert_array_equal(again.rows(sim), front.rows(sim))
    assert (CutFront(sim, END).rows(sim) != front.rows(sim)).any()


def test_a_run_interrupted_again_and_again_goes_on(uninterrupted, tmp_path):
    # By a hook that stops after any number of steps, not only where rows are written.
    for k, n_step in enumerate([1, 7, 133, 10, 104, 10_000]):
        sim, records = cutting(), RECORDS if k == 0 else {"progress": False, "resume": True}
        recorder = sc.Recorder(sim, tmp_path, until=HALF, name="cut", **records)
        last = sim.state.step + n_step
        sim.run(HALF, [recorder, StopWhen(lambda sim=sim, last=last: sim.state.step >= last)])
        # The row of the end, which a run that goes on does not keep.
        assert read_history(tmp_path / "history.csv")[0]["time"][-1] == sim.state.time
    assert_same_run(tmp_path, uninterrupted)


PICTURES = {"n_row": 10, "n_frame": 2, "n_snapshot": 2, "progress": False}


@pytest.fixture(scope="module")
def pictured(no_pictures, tmp_path_factory):
    """An uninterrupted run with pictures."""
    if not matplotlib:
        pytest.skip("needs shellcut-fem[plot]")
    folder = tmp_path_factory.mktemp("pictured")
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, "matplotlib", matplotlib)
        Case("cut", still(), 8e-6).run(folder, **PICTURES)
    return folder


def assert_same_pictures(part, whole):
    pictures = sorted(path.name for path in whole.glob("*.png"))
    assert sorted(path.name for path in part.glob("*.png")) == pictures
    for name in pictures:
        assert (part / name).read_bytes() == (whole / name).read_bytes()


def test_a_picture_that_could_not_be_written_is_drawn_later(pictured, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", matplotlib)
    with monkeypatch.context() as patch:
        at = RunFiles.new_picture

        def nowhere(files, number):
            path = at(files, number)
            return path.parent / "missing" / path.name if number == 1 else path

        # The error of the other process ends the run.
        patch.setattr(RunFiles, "new_picture", nowhere)
        with pytest.raises(FileNotFoundError, match="missing"):
            Case("cut", still(), 8e-6).run(tmp_path, **PICTURES)
    assert not (tmp_path / "summary.json").exists()
    resumed(tmp_path, still(), 8e-6)
    assert_same_pictures(tmp_path, pictured)
    assert (tmp_path / "history.csv").read_bytes() == (pictured / "history.csv").read_bytes()


def test_pictures_and_counts_go_on_where_they_were(pictured, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", matplotlib)
    # Deepest at the first frame: the summary of both parts shall know.
    unfelt = shellcut.recording.unfelt_penetration

    def depth(_, state, *__):
        return 1.0 / (1 + state.step)

    monkeypatch.setattr(unfelt, "missed_penetration", lambda *given: (1, depth(*given)))
    monkeypatch.setattr(unfelt.FlankPenetration, "largest", lambda *given: 2.0 * depth(*given))
    first = still()
    recorder = sc.Recorder(first, tmp_path, until=8e-6, name="cut", **PICTURES)
    first.run(8e-6, [recorder, StopWhen(lambda: first.state.step >= 37)])
    # The last one shows where it stopped, and is drawn again in its turn.
    drawn = ["energy", "force", "snapshot_00", "snapshot_01"]
    assert sorted(p.stem for p in tmp_path.glob("*.png")) == drawn
    resumed(tmp_path, still(), 8e-6)
    assert_same_pictures(tmp_path, pictured)
    summary = summary_of(tmp_path)
    assert (summary["unfelt_penetration_mm"], summary["unfelt_film_edge_mm"]) == (1.0, 2.0)
    # As if killed at its end, between two pictures: it is summed up, and the other is drawn.
    for lost in ("summary.json", "energy.png"):
        (tmp_path / lost).unlink()
    resumed(tmp_path, still(), 8e-6)
    assert_same_pictures(tmp_path, pictured)
    assert summary_of(tmp_path)["n_step"] == summary_of(pictured)["n_step"]


def test_a_run_that_has_ended_is_left_as_it_is_and_goes_on_to_a_later_end(tmp_path, caplog):
    def there():
        return {p.name: (p.read_bytes(), p.stat().st_mtime_ns) for p in tmp_path.iterdir()}

    Case("cut", still(), 2e-6).run(tmp_path, **RECORDS)
    before = there()
    resumed(tmp_path, still(), 2e-6)
    assert "has already ended, at path" in caplog.text
    with pytest.raises(RunEnded):
        sc.Recorder(still(), tmp_path, until=2e-6, name="cut", resume=True, progress=False)
    assert before == there()
    assert resumed(tmp_path, still(), 4e-6).state.time >= 4e-6
    times = read_history(tmp_path / "history.csv")[0]["time"]
    assert times[0] == 0.0
    assert times[-1] > 3.5e-6
    assert (np.diff(times) > 0).all()


def test_a_run_that_blows_up_keeps_the_last_good_checkpoint(tmp_path):
    blown = Case("cut", cutting(stepping=sc.Stepping(fixed=3e-7), damping_beta=5e-8), END)
    sim = blown.simulation
    with pytest.raises(UnstableStep), np.errstate(all="ignore"):
        blown.run(tmp_path, checkpoint_every=0.0, force=True, **RECORDS)
    assert not sim.between_steps
    with pytest.raises(RuntimeError, match=r"step \d+ was not completed"):
        sc.save_checkpoint(sim, tmp_path / "half.h5")
    assert not (tmp_path / "half.h5").exists()
    # The stepping may change, to save such a run.
    again = cutting(stepping=sc.Stepping(safety=0.5), damping_beta=5e-8)
    sc.load_checkpoint(again, tmp_path / "checkpoint.h5")
    assert sim.state.step - 10 <= again.state.step < sim.state.step
    before = again.dt
    again.run(again.state.time + 2e-6)
    assert again.dt < 0.6 * before
    assert all(np.isfinite(frame.points).all() for frame in sc.read(tmp_path).frames())
    assert not is_open(tmp_path / "cut.vtkhdf")
    # No number that is none, which JSON does not know.
    text = (tmp_path / "summary.json").read_text()
    assert json.loads(text, parse_constant=pytest.fail)["n_step"] == sim.state.step


def test_what_cannot_be_gone_on_with_is_named(tmp_path):
    for interval in (-1.0, float("nan")):
        with pytest.raises(ValueError, match="checkpoint_every must be 0 or more"):
            Case("cut", still(), END).run(tmp_path, checkpoint_every=interval, progress=False)
    with pytest.raises(FileNotFoundError, match=r"has no checkpoint\.h5 to resume from"):
        resumed(tmp_path / "none", still())
    assert not (tmp_path / "none").exists()
    Case("cut", still(), 2e-6).run(tmp_path, **RECORDS)
    checkpoint, history = tmp_path / "checkpoint.h5", tmp_path / "history.csv"
    good, rows = checkpoint.read_bytes(), history.read_bytes().splitlines(keepends=True)
    sc.save_checkpoint(still(), checkpoint)
    with pytest.raises(CheckpointError, match=r"checkpoint\.h5 was saved by hand"):
        resumed(tmp_path, still(), 4e-6)
    checkpoint.write_bytes(good)
    there = sorted(path.name for path in tmp_path.iterdir())
    assert "summary.json" in there
    for left, said in (
        (rows[:1], "must reach to the checkpoint"),  # what a power cut may leave
        (rows[:-1], "must reach to the checkpoint"),
    ):
        history.write_bytes(b"".join(left))
        with pytest.raises(ValueError, match=rf"history\.csv {said}"):
            resumed(tmp_path, still(), 4e-6)
        assert history.read_bytes() == b"".join(left)
        assert sorted(path.name for path in tmp_path.iterdir()) == there  # nothing is removed
    history.write_bytes(b"".join(rows))
    (tmp_path / "cut.vtkhdf").unlink()
    with pytest.raises(FileNotFoundError, match=r"cannot append to .*cut\.vtkhdf"):
        resumed(tmp_path, still(), 4e-6)
    # A new run removes the checkpoint of the old one.
    recorder = sc.Recorder(still(), tmp_path, until=END, name="cut", **RECORDS)
    is_there = checkpoint.exists()
    recorder.close()
    assert not is_there

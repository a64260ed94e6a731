"""What a run leaves in its folder, whatever happens to it."""

import itertools
import json
import time

import numpy as np
import pytest

import shellcut.recording.recorder
import shellcut.recording.unfelt_penetration
import shellcut.view.progress
from notched_strip import cutting
from open_files import is_open
from shellcut import (
    Recorder,
    ShellMaterial,
    Simulation,
    StraightMotion,
    Support,
    TableMotion,
    compare,
    read,
)
from shellcut.checks import RefusedModel
from shellcut.files.run_folder import snapshot, snapshots
from shellcut.mesh.structured import rectangle
from shellcut.models import Case
from shellcut.recording.resistance import resistance_of
from shellcut.recording.run_summary import run_summary
from shellcut.recording.unfelt_penetration import Unfelt, UnfeltPenetration
from shellcut.results.history import read_history
from shellcut.results.measured_curve import MeasuredCurve
from shellcut.results.verdict import Line
from shellcut.results.vtkhdf import VtkHdfWriter
from shellcut.simulation.hooks import StopWhen
from shellcut.simulation.instability import UnstableStep
from shellcut.tool.coordinate import Coordinate
from steady_cut import edge, edge_columns

RECORDS = {"n_row": 40, "n_frame": 4, "n_snapshot": 0, "progress": False}
END = 4e-6


pytestmark = pytest.mark.usefixtures("no_pictures")


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.fixture(scope="module")
def whole(no_pictures, tmp_path_factory):
    """Return a run with straight, jointed and broken cables, and its folder."""
    folder = tmp_path_factory.mktemp("whole")
    case = Case("cut", cutting(), 8e-5)
    case.run(folder, **RECORDS)
    return case, read(folder)


def still(**options):
    """Return the strip with sides at rest: where nothing depends on the film's own motion."""
    return cutting(pulled=False, **options)


def test_the_summary_and_the_last_frame_say_what_the_history_shows(whole):
    case, results = whole
    sim, h, summary = case.simulation, results.history, results.summary
    assert summary["n_step"] == sim.state.step
    assert summary["dt_s"] == pytest.approx(sim.state.time / sim.state.step, rel=1e-15)
    # Blade and film are shifted only: the path of the edge is that of any place of the blade.
    path = Coordinate.path(sim.motion_in_film, END).at(sim.state.time)
    assert summary["path_end_mm"] == pytest.approx(path, rel=1e-5)
    peak = np.abs(h["force"]).argmax()
    assert summary["force_peak_N"] == h["force"][peak] != 0.0
    assert summary["force_peak_at_mm"] == h["path"][peak]
    # Its supports move the film across the blade's path, so nothing keeps a direction in the film.
    assert summary["resistance"].startswith(
        "generalised force: work of the tool per mm of the path"
    )
    # Its cables break before the next is met: there is no process zone, and nothing is steady.
    assert "to go to the next cut or the film's edge" in summary["no_window"]
    assert not {"force_plateau_N", "dW_ds_N", "window_from_mm"} & summary.keys()
    assert summary["n_cable_created"] == sim.state.n_cable == h["cables_created"][-1]
    assert results.times[-1] == h["time"][-1] == sim.state.time
    assert h["path"][-1] == summary["path_end_mm"]
    assert h["tool_work"][-1] == summary["tool_work_Nmm"]
    assert (np.diff(h["time"]) > 0.0).all()
    # the checkpoint does not know of it: a run that goes on writes its own frames there
    assert results.n_frame >= RECORDS["n_frame"] + 1
    assert np.array_equal(h["force"], h["force_contact"] + h["force_joints"])
    assert min(np.abs(h["force_contact"]).max(), np.abs(h["force_joints"]).max()) > 0
    # One tooth: the same numbers in another order of adding, round-off of the force's size.
    assert h["force_tooth_1"] == pytest.approx(h["force"], abs=1e-12 * np.abs(h["force"]).max())


def test_splits_are_told_with_place_and_reference(whole):
    case, results = whole
    log, columns = case.simulation.state.split_log, results.splits
    assert len(log) == len(columns["node"]) >= 3
    for k, split in enumerate(log):
        assert split.place != split.reference
        assert tuple(columns[name][k] for name in "xyz") == split.place
        assert tuple(columns[name][k] for name in "XYZ") == split.reference
        for name in ("time", "node", "twin", "kind", "measure", "force_jump"):
            assert columns[name][k] == getattr(split, name)
        # The blade has cut from a notch on: each cut has its edge, and none is a puncture.
        assert columns["edge"][k] == 1
        assert split.kind in ("blade", "criterion")
    path = results.history["path"]
    measured = MeasuredCurve(path, results.history["force"], "mm", "N")
    assert np.isnan(compare(results, measured, y="force").pierced_at)
    assert results.split_units["force_jump"] == "N"
    assert columns["node"].dtype.kind == "i"


def test_a_case_is_run_once(tmp_path):
    case = Case("cut", still(), END)
    case.run(tmp_path, **RECORDS)
    before = contents(tmp_path)
    for resume in (False, True):
        with pytest.raises(ValueError, match=r"a case can run once, .* build it again"):
            case.run(tmp_path, resume=resume, **RECORDS)
    assert contents(tmp_path) == before


def test_what_says_that_a_run_has_ended_goes_with_a_new_one_or_one_gone_on_with(tmp_path):
    Case("cut", still(), END).run(tmp_path, **RECORDS)
    assert read(tmp_path).summary
    for options in ({"until": END}, {"until": 2 * END, "resume": True}):
        recorder = Recorder(still(), tmp_path, name="cut", **options, **RECORDS)
        summary, splits = read(tmp_path).summary, (tmp_path / "splits.csv").exists()
        recorder.close()
        assert summary == {}
        assert not splits or "resume" in options


def test_a_frame_that_cannot_be_made_does_not_hide_why_the_run_died(tmp_path, caplog):
    def spoil(sim):
        if sim.state.step == 30:
            sim.state.node.velocity_half[0] = np.nan
        return False

    sim, records = still(), RECORDS | {"n_frame": 1000}
    recorder = Recorder(sim, tmp_path, until=2e-5, name="cut", **records)
    with pytest.raises(UnstableStep, match="blew up"):
        sim.run(2e-5, [StopWhen(lambda: spoil(sim)), recorder])
    assert "could not be made: velocity must be finite" in caplog.text
    assert (tmp_path / "summary.json").exists()


def test_a_run_that_hardly_began_has_closed_no_balance(tmp_path):
    sim = still()
    recorder = Recorder(sim, tmp_path, until=END, name="cut", **RECORDS)
    sim.run(END, [recorder, StopWhen(lambda: sim.state.step >= 3)])
    summary = read(tmp_path).summary
    assert summary["n_step"] == 3
    assert not {"imbalance_rel", "kinetic_rel"} & summary.keys()
    # What is not finite is left out: to a reader of JSON it is no number.
    history, _ = read_history(tmp_path / "history.csv")
    end = {name: column[-1] for name, column in history.items()}
    end |= {"tool_work": np.inf, "damping_mass": np.nan}
    values = run_summary(sim, recorder.resistance, history, end, wall=1.0, unfelt=Unfelt())
    assert not {"tool_work_Nmm", "damping_Nmm"} & values.keys()
    assert values["n_step"] == 3


def test_doubts_are_logged_before_and_after_and_kept_in_the_summary(tmp_path, caplog):
    sim = still()
    recorder = Recorder(sim, tmp_path, until=END, name="cut", **RECORDS)
    before = [r.getMessage() for r in caplog.records if r.name.startswith("shellcut.checks")]
    assert any("opening_u must be at least" in text for text in before)
    assert recorder.verdict == ()
    sim.run(END, [recorder])
    lines = json.loads((tmp_path / "summary.json").read_text())["verdict"]
    assert [Line(**line) for line in lines] == list(recorder.verdict)
    after = [r.getMessage() for r in caplog.records if r.name == "shellcut.verdict"]
    assert after[: len(before)] == [
        f"distrust: Before the run: {text.removeprefix('distrust: ')}"
        for text in before
        if text.startswith("distrust: ")
    ]
    with pytest.raises(ValueError, match=r"records one run, and that in .* has ended"):
        sim.run(2.0 * END, [recorder])


def test_what_is_refused_leaves_nothing(tmp_path):
    sim = still(material=ShellMaterial.homogeneous(thickness=74.0))
    with pytest.raises(RefusedModel, match="a shell should be thin"):
        Recorder(sim, tmp_path / "none", until=END, name="cut", **RECORDS)
    assert not (tmp_path / "none").exists()
    film = rectangle(4.0, 2.0, size=1.0)
    sim = Simulation(film, ShellMaterial.homogeneous(), supports=[Support.clamped("left")])
    with pytest.raises(ValueError, match="needs a simulation with a tool"):
        Recorder(sim, tmp_path / "none", until=END, name="cut")
    assert not (tmp_path / "none").exists()


def test_a_table_that_turns_has_the_plateau_and_peak_of_its_torque():
    motion = TableMotion(
        [0.0, 1.0], [[0.0, 0.0, 0.0]] * 2, rotation_vectors=[[0.0, 0.0, 0.0], [0.0, 0.0, 1.5]]
    )
    sim = still(motion=motion)
    r = resistance_of(sim, 1.0)
    assert r.coordinate_unit == "deg"
    angle = np.linspace(0.0, 80.0, 1601)
    columns = (
        *("tool_work", "cohesive_work", "imbalance", "kinetic_translation", "kinetic_rotation"),
        *("crack_length", "time", "angle"),
        *("torque", "axial_force", "torque_integral", "axial_force_integral"),
    )
    history = dict.fromkeys(columns, angle) | edge_columns([edge(angle)] * 4)

    def summed():
        return run_summary(sim, r, history, wall=1.0, unfelt=Unfelt())

    summary = summed()
    # The growth of the identity a radian.
    assert 25.0 < summary["window_from_deg"] < summary["window_to_deg"] < 75.0
    for name in ("torque_plateau_Nmm", "axial_force_plateau_N", "dW_dtheta_Nmm"):
        assert summary[name] == pytest.approx(np.degrees(1.0), rel=1e-9)
    assert (summary["torque_peak_Nmm"], summary["torque_peak_at_deg"]) == (80.0, 80.0)
    history["torque"] = 0.96 - 5.0 * np.sin(np.radians(angle))
    assert summed()["torque_peak_Nmm"] == history["torque"][-1] < -3.9


def test_what_goes_wrong_while_a_frame_is_written_reaches_the_run(tmp_path, monkeypatch):
    # In a thread of its own: the next frame, or the end, must tell.
    def fail(*_):
        raise OSError("no space left")

    monkeypatch.setattr(VtkHdfWriter, "append", fail)
    sim = still()
    with pytest.raises(OSError, match="no space left"):
        Case("cut", sim, END).run(tmp_path, **RECORDS)
    assert sim.state.time < END
    assert not is_open(tmp_path / "cut.vtkhdf")


def test_how_deep_the_tool_goes_unfelt_does_not_depend_on_the_frames(tmp_path, monkeypatch):
    looked = []

    def depth(_, state, *__):
        looked.append(state.step)
        return 1, 1e-3 * state.step

    monkeypatch.setattr(shellcut.recording.unfelt_penetration, "missed_penetration", depth)
    histories = set()
    for n_frame in (1, 200):
        looked.clear()
        folder = tmp_path / str(n_frame)
        Case("cut", still(), 2e-5).run(folder, **RECORDS | {"n_frame": n_frame})
        histories.add((folder / "history.csv").read_bytes())
        # A hundred times in a run, or every ten steps of a short one.
        assert len(looked) >= 100 or len(looked) == 1 + looked[-1] // 10
    assert len(histories) == 1


def test_a_cutting_edge_ahead_of_a_tip_is_not_unfelt(monkeypatch):
    left_out = []

    def missed(_wires, _state, _pose, felt, _rows):
        return left_out.append(felt.tolist()), 0.0

    monkeypatch.setattr(shellcut.recording.unfelt_penetration, "missed_penetration", missed)
    sim = still()
    UnfeltPenetration(sim).now()
    assert left_out == [sim.cracks.tip_nodes(sim.state).tolist()] != [[]]  # no point presses yet


def test_a_log_that_fails_costs_neither_checkpoint_nor_files(tmp_path):
    def fail(_):
        raise RuntimeError("no log")

    sim = still()
    with pytest.raises(RuntimeError, match="no log"):
        Case("cut", sim, END).run(tmp_path, log=fail, **RECORDS | {"progress": True})
    assert (tmp_path / "checkpoint.h5").exists()
    assert not is_open(tmp_path / "cut.vtkhdf")


def test_pictures_are_in_the_order_of_their_numbers(tmp_path):
    for number in (100, 11, 2):
        snapshot(tmp_path, number).touch()
    (tmp_path / "snapshot_mine.png").touch()
    found = [path.stem for path in snapshots(tmp_path, first=3)]
    assert found == ["snapshot_11", "snapshot_100"]


def test_bar_lines_and_account_say_one_percentage(tmp_path, monkeypatch, capsys):
    # The blade starts slowly: a third of the time is a tenth of the path.
    monkeypatch.setattr(shellcut.view.progress, "LINE_INTERVAL", 0.0)
    sim = still(motion=StraightMotion((1, 0, 0), 2e4, ramp=10 * END))
    said = []
    Case("cut", sim, 10 * END).run(tmp_path, log=said.append, **RECORDS | {"progress": True})
    shares = [int(text.split(" %: ")[0]) for text in said]
    assert shares == sorted(shares)
    assert shares[-2:] == [100, 100]
    assert shares.count(100) == 2  # one account, one line
    # The next plain line is at most one line of energies away.
    of_energies = ["| E:" in text for text in said]
    pairs = [k for k, kinds in enumerate(itertools.pairwise(of_energies)) if kinds == (True, False)]
    assert pairs
    assert all(shares[k + 1] - shares[k] <= 5 for k in pairs)
    assert capsys.readouterr().err.count("100 %") == 1  # the energies are in run.log only


def test_another_present_folder_changes_neither_a_run_nor_its_results(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    sim = still()
    recorder = Recorder(sim, "out", until=END, name="cut", checkpoint_every=0.0, **RECORDS)
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    sim.run(END, [recorder])
    monkeypatch.chdir(tmp_path)
    results = read("out")
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert results.frame(-1).time == sim.state.time
    assert not list((tmp_path / "elsewhere").iterdir())


def test_frames_are_in_the_file_before_their_checkpoint(tmp_path, monkeypatch):
    written, lacking = [], []

    def slow(output, frame, write=VtkHdfWriter.append):
        time.sleep(0.02)  # longer than the steps to the next checkpoint
        write(output, frame)
        written.append(frame.time)

    def save(sim, path, *, extra):
        if extra["frame_time"] not in (-np.inf, *written):
            lacking.append(sim.state.step)

    monkeypatch.setattr(VtkHdfWriter, "append", slow)
    monkeypatch.setattr(shellcut.recording.recorder, "save_checkpoint", save)
    Case("cut", still(), END).run(tmp_path, checkpoint_every=0.0, **RECORDS)
    assert len(written) > RECORDS["n_frame"]
    assert not lacking

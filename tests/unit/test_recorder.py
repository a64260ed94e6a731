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
from shellcut.checks import RefusedModel
from shellcut.files.run_folder import snapshot, snapshots
from shellcut.loads.supports import Support
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.structured import rectangle
from shellcut.models import Case
from shellcut.recording.recorder import Recorder
from shellcut.recording.resistance import Resistance
from shellcut.recording.run_summary import run_summary
from shellcut.recording.unfelt_penetration import Unfelt, UnfeltPenetration
from shellcut.results.history import read_history
from shellcut.results.run_results import read
from shellcut.results.verdict import Line
from shellcut.results.vtkhdf import VtkHdfWriter
from shellcut.simulation.hooks import StopWhen
from shellcut.simulation.instability import UnstableStep
from shellcut.simulation.simulation import Simulation
from shellcut.simulation.stable_step import Stepping
from shellcut.tool.motion import StraightMotion
from shellcut.tool.table_motion import TableMotion
from steady_cut import edge, edge_columns

RECORDS = {"n_row": 40, "n_frame": 4, "n_snapshot": 0, "progress": False}
END = 4e-6


pytestmark = pytest.mark.usefixtures("no_pictures")


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def strict_json(path):
    """Return what any reader of JSON would, to which nan and infinity are no numbers."""

    def refuse(word):
        raise AssertionError(f"{word} is not JSON")

    return json.loads(path.read_text(), parse_constant=refuse)


@pytest.fixture(scope="module")
def whole(no_pictures, tmp_path_factory):
    """Return a run with straight, jointed and broken cables, and its folder."""
    folder = tmp_path_factory.mktemp("whole")
    case = Case("cut", cutting(), 8e-5)
    case.run(folder, **RECORDS)
    return case, read(folder)


def test_the_resistance_is_that_of_contact_and_joints_and_of_all_teeth(whole):
    _, results = whole
    h = results.history
    assert np.abs(h["force_contact"]).max() > 0
    assert np.abs(h["force_joints"]).max() > 0
    assert np.array_equal(h["force"], h["force_contact"] + h["force_joints"])
    # One tooth: the same numbers in another order of adding, round-off of the force's size.
    tolerance = 1e-12 * np.abs(h["force"]).max()
    assert h["force_tooth_1"] == pytest.approx(h["force"], abs=tolerance)


def test_the_summary_and_the_last_frame_say_what_the_history_shows(whole):
    case, results = whole
    sim, h, summary = case.simulation, results.history, results.summary
    assert summary["n_step"] == sim.state.step
    assert summary["dt_s"] == pytest.approx(sim.state.time / sim.state.step, rel=1e-15)
    assert summary["path_end_mm"] == sim.motion_in_film(END).coordinate(sim.state.time)
    assert summary["force_peak_N"] == h["force"][np.abs(h["force"]).argmax()]
    assert summary["force_peak_at_mm"] == h["path"][np.abs(h["force"]).argmax()]
    # Its supports move the film across the blade's way, so nothing keeps a direction in the film.
    assert summary["resistance"].startswith("generalised force: work of the tool per mm")
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


def test_a_stopped_run_ends_with_a_row_that_one_going_on_does_not_keep(tmp_path):
    for name, stop in (("whole", None), ("stopped", 33)):
        sim = cutting()
        recorder = Recorder(sim, tmp_path / name, until=END, name="cut", **RECORDS)
        hooks = (
            [recorder] if stop is None else [recorder, StopWhen(lambda s=sim: s.state.step >= 33)]
        )
        sim.run(END, hooks)
        assert read(tmp_path / name).history["time"][-1] == sim.state.time
    assert sim.state.step == 33  # rows are written every ten steps at most
    sim = cutting()
    again = Recorder(sim, tmp_path / "stopped", until=END, name="cut", resume=True, **RECORDS)
    sim.run(END, [again])
    whole, resumed = (tmp_path / name / "history.csv" for name in ("whole", "stopped"))
    assert whole.read_bytes() == resumed.read_bytes()


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
    assert results.split_units["force_jump"] == "N"
    assert columns["node"].dtype.kind == "i"


def test_a_case_is_run_once(tmp_path):
    case = Case("cut", cutting(), END)
    case.run(tmp_path, **RECORDS)
    before = contents(tmp_path)
    for resume in (False, True):
        with pytest.raises(ValueError, match=r"a case can run once, .* build it again"):
            case.run(tmp_path, resume=resume, **RECORDS)
    assert contents(tmp_path) == before


def test_what_says_that_a_run_has_ended_goes_with_a_new_one_or_one_gone_on_with(tmp_path):
    Case("cut", cutting(), END).run(tmp_path, **RECORDS)
    assert read(tmp_path).summary
    recorder = Recorder(cutting(), tmp_path, until=END, name="cut", **RECORDS)
    try:
        assert read(tmp_path).summary == {}
        assert not (tmp_path / "splits.csv").exists()
    finally:
        recorder.close()
    recorder = Recorder(cutting(), tmp_path, until=2 * END, name="cut", resume=True, **RECORDS)
    try:
        assert read(tmp_path).summary == {}
    finally:
        recorder.close()


def test_a_frame_that_cannot_be_made_does_not_hide_why_the_run_died(tmp_path, caplog):
    sim = cutting()

    class Spoiled(Recorder):
        def __call__(self, sim):
            if sim.state.step == 30:
                sim.state.node.velocity_half[0] = np.nan
            super().__call__(sim)

    recorder = Spoiled(
        sim, tmp_path, until=2e-5, name="cut", n_frame=1000, n_snapshot=0, progress=False
    )
    with pytest.raises(UnstableStep, match="blew up"):
        sim.run(2e-5, [recorder])
    assert "could not be made: velocity must be finite" in caplog.text
    assert (tmp_path / "summary.json").exists()


def test_the_summary_of_a_blow_up_is_json(tmp_path):
    blown = Case("cut", cutting(stepping=Stepping(fixed=3e-7)), 8e-5)
    with pytest.raises(UnstableStep), np.errstate(all="ignore"):
        blown.run(tmp_path, **RECORDS, force=True)
    assert strict_json(tmp_path / "summary.json")["n_step"] == blown.simulation.state.step


def test_a_run_that_hardly_began_has_closed_no_balance(tmp_path):
    sim = cutting()
    recorder = Recorder(sim, tmp_path, until=1e-3, name="cut", **RECORDS)
    sim.run(1e-3, [recorder, StopWhen(lambda: sim.state.step >= 3)])
    summary = strict_json(tmp_path / "summary.json")
    assert summary["n_step"] == 3
    assert not {"imbalance_rel", "kinetic_rel"} & summary.keys()


def test_doubts_are_logged_before_and_after_and_kept_in_the_summary(tmp_path, caplog):
    sim = cutting()
    recorder = Recorder(sim, tmp_path, until=END, name="cut", **RECORDS)
    before = [r.getMessage() for r in caplog.records if r.name.startswith("shellcut.checks")]
    assert any("opening_u must be at least" in text for text in before)
    assert recorder.verdict == ()
    sim.run(END, [recorder])
    lines = strict_json(tmp_path / "summary.json")["verdict"]
    assert [Line(**line) for line in lines] == list(recorder.verdict)
    after = [r.getMessage() for r in caplog.records if r.name == "shellcut.verdict"]
    assert after[: len(before)] == [
        f"distrust: Before the run: {text.removeprefix('distrust: ')}"
        for text in before
        if text.startswith("distrust: ")
    ]


def test_what_is_refused_leaves_nothing(tmp_path):
    sim = cutting(material=ShellMaterial.homogeneous(thickness=74.0))
    with pytest.raises(RefusedModel, match="a shell should be thin"):
        Recorder(sim, tmp_path / "none", until=END, name="cut", **RECORDS)
    assert not (tmp_path / "none").exists()
    film = rectangle(4.0, 2.0, size=1.0)
    sim = Simulation(film, ShellMaterial.homogeneous(), supports=[Support.clamped("left")])
    with pytest.raises(ValueError, match="needs a simulation with a tool"):
        Recorder(sim, tmp_path / "none", until=END, name="cut")
    assert not (tmp_path / "none").exists()


def test_figures_that_are_not_finite_are_left_out(tmp_path):
    sim = cutting()
    recorder = Recorder(sim, tmp_path, until=END, name="cut", **RECORDS)
    sim.run(END, [recorder, StopWhen(lambda: sim.state.step >= 3)])
    history, _ = read_history(tmp_path / "history.csv")
    end = {name: column[-1] for name, column in history.items()}
    end |= {"tool_work": np.inf, "damping_mass": np.nan}
    figures = run_summary(
        sim, recorder.resistance, history, end, stepping=1.0, drawing=0.0, unfelt=Unfelt()
    )
    assert not {"tool_work_Nmm", "damping_Nmm"} & figures.keys()
    assert figures["n_step"] == 3


def test_a_table_that_turns_has_the_plateau_and_peak_of_its_torque():
    motion = TableMotion(
        [0.0, 1.0], [[0.0, 0.0, 0.0]] * 2, rotation_vectors=[[0.0, 0.0, 0.0], [0.0, 0.0, 1.5]]
    )
    sim = cutting(motion=motion)
    r = Resistance(motion, 1.0)
    assert r.coordinate_unit == "deg"
    angle = np.linspace(0.0, 80.0, 1601)
    energies = ("tool_work", "cohesive_work", "imbalance", "kinetic_translation")
    figures = ("torque", "axial_force", "torque_integral", "axial_force_integral")
    columns = (*energies, "kinetic_rotation", "crack_length", "time", "angle", *figures)
    history = dict.fromkeys(columns, angle) | edge_columns([edge(angle)] * 4)
    figures = run_summary(sim, r, history, stepping=1.0, drawing=0.0, unfelt=Unfelt())
    # The growth of the identity a radian.
    low, high = figures["window_from_deg"], figures["window_to_deg"]
    assert 25.0 < low < high < 75.0
    for name in ("torque_plateau_Nmm", "axial_force_plateau_N", "dW_dtheta_Nmm"):
        assert figures[name] == pytest.approx(np.degrees(1.0), rel=1e-9)
    assert (figures["torque_peak_Nmm"], figures["torque_peak_at_deg"]) == (80.0, 80.0)
    history["torque"] = 0.96 - 5.0 * np.sin(np.radians(angle))
    figures = run_summary(sim, r, history, stepping=1.0, drawing=0.0, unfelt=Unfelt())
    assert figures["torque_peak_Nmm"] == history["torque"][-1] < -3.9


def test_what_goes_wrong_while_a_frame_is_written_reaches_the_run(tmp_path, monkeypatch):
    # In a thread of its own: the next frame, or the end, must tell.
    def fail(*_):
        raise OSError("no space left")

    monkeypatch.setattr(VtkHdfWriter, "append", fail)
    sim = cutting()
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
    histories = []
    for n_frame in (1, 7, 400):
        looked.clear()
        folder = tmp_path / str(n_frame)
        Case("cut", cutting(), 4e-5).run(
            folder, n_row=30, n_frame=n_frame, n_snapshot=0, progress=False
        )
        histories.append((folder / "history.csv").read_bytes())
        # A hundred times in a run, or every ten steps of a short one.
        assert len(looked) >= 100 or len(looked) == 1 + looked[-1] // 10
    assert histories[0] == histories[1] == histories[2]


def test_a_cutting_edge_ahead_of_a_tip_is_not_unfelt(monkeypatch):
    left_out = []
    monkeypatch.setattr(
        shellcut.recording.unfelt_penetration,
        "missed_penetration",
        lambda _wires, _state, _pose, felt, _rows: (left_out.append(felt.tolist()), 0.0),
    )
    sim = cutting()
    UnfeltPenetration(sim).now()
    assert left_out == [sim.cracks.tip_nodes(sim.state).tolist()] != [[]]  # no point presses yet


def test_a_log_that_fails_costs_neither_checkpoint_nor_files(tmp_path):
    def fail(_):
        raise RuntimeError("no log")

    sim = cutting()
    with pytest.raises(RuntimeError, match="no log"):
        Case("cut", sim, END).run(tmp_path, log=fail, **RECORDS | {"progress": True})
    assert (tmp_path / "checkpoint.h5").exists()
    assert not is_open(tmp_path / "cut.vtkhdf")


def test_pictures_are_in_the_order_of_their_numbers(tmp_path):
    for number in (100, 11, 2):
        snapshot(tmp_path, number).touch()
    (tmp_path / "snapshot_mine.png").touch()
    assert [path.name for path in snapshots(tmp_path, first=3)] == [
        "snapshot_11.png",
        "snapshot_100.png",
    ]


def test_bar_lines_and_account_say_one_percentage(tmp_path, monkeypatch, capsys):
    # The blade starts slowly: a third of the time is a tenth of the way.
    monkeypatch.setattr(shellcut.view.progress, "LINE_INTERVAL", 0.0)
    sim = cutting(motion=StraightMotion((1, 0, 0), 2e4, ramp=10 * END))
    said = []
    Case("cut", sim, 10 * END).run(tmp_path, log=said.append, **RECORDS | {"progress": True})
    pairs = [
        [int(text.split(" %: ")[0]) for text in (account, line)]
        for account, line in itertools.pairwise(said)
        if "| E:" in account and "| E:" not in line
    ]
    # The next plain line is at most one line of energies away; the time is a third when the path is
    # a tenth.
    assert pairs
    assert all(abs(account - line) <= 5 for account, line in pairs)
    shares = [int(text.split(" %: ")[0]) for text in said]
    assert shares == sorted(shares)
    assert shares[-2:] == [100, 100]
    assert shares.count(100) == 2  # one account, one line
    assert capsys.readouterr().err.count("100 %") == 1  # the energies are in run.log only


def test_frames_are_in_the_file_before_their_checkpoint(tmp_path, monkeypatch):
    written, lacking = [], []

    def slow(output, frame, write=VtkHdfWriter.append):
        time.sleep(0.02)  # longer than the steps to the next checkpoint
        write(output, frame)
        written.append(frame.time)

    def save(sim, path, *, extra):
        if extra["frame_time"] not in written:
            lacking.append(sim.state.step)

    monkeypatch.setattr(VtkHdfWriter, "append", slow)
    monkeypatch.setattr(shellcut.recording.recorder, "save_checkpoint", save)
    Case("cut", cutting(), END).run(tmp_path, checkpoint_every=0.0, **RECORDS)
    assert len(written) > RECORDS["n_frame"]
    assert not lacking

"""Means of several runs are compared over the steady window that they have in common."""

import re

import numpy as np
import pytest

from run_folder import write_run
from shellcut.results.run_results import read
from shellcut.results.steady_window import steady_figures
from shellcut.study.one_run import Outcome
from shellcut.study.optimise import Optimum, Trial
from shellcut.study.table import NOT_COMMON, CommonWindow
from steady_cut import edge, edge_columns

X = np.linspace(0.0, 150.0, 3001)
TORQUE = ("torque", "N*mm")


def cut(folder, torque, **options):
    """Write a run of one edge with this torque at an angle; return folder and outcome."""
    work = np.append(0.0, np.cumsum(torque(0.5 * (X[1:] + X[:-1])) * np.radians(np.diff(X))))
    columns = edge_columns([edge(X, **options)])
    write_run(folder, folder.name, X, torque(X), tool_work=work, strain=0.0 * X, **columns)
    history = read(folder).history
    found = steady_figures(history, ("angle", "deg"), TORQUE)
    return folder, Outcome("done", figures={**found, "torque_peak_Nmm": 200.0})


def common(runs):
    return CommonWindow(lambda number: runs[number][0])({k: one for k, (_, one) in enumerate(runs)})


def flat(x):
    return 100.0 + 0.0 * x


def test_means_are_over_the_part_that_all_windows_share(tmp_path):
    # A torque that rises by 2 % over the window of one: over the same part it is the same in both.
    def rising(x):
        return 100.0 + 0.03 * x

    runs = [
        cut(tmp_path / "early", rising, arc=20.0),
        cut(tmp_path / "late", rising, begins=30.0, arc=20.0),
    ]
    own = [one.figures for _, one in runs]
    assert own[1]["torque_plateau_Nmm"] > own[0]["torque_plateau_Nmm"] + 0.5
    found = [one.figures for one in common(runs).values()]
    low, high = own[1]["window_from_deg"], own[0]["window_to_deg"]
    for figures in found:
        assert figures["window_from_deg"] == pytest.approx(low, abs=0.051)
        assert figures["window_to_deg"] == pytest.approx(high, abs=0.051)
        mean = rising(0.5 * (low + high))
        assert figures["torque_plateau_Nmm"] == pytest.approx(mean, rel=1e-4)
        assert figures["torque_plateau_half_width_Nmm"] > 0.0
        assert figures["torque_peak_Nmm"] == 200.0


def test_runs_without_a_window_in_common_keep_their_means_and_say_why(tmp_path):
    runs = [
        cut(tmp_path / "early", flat, arc=13.0),
        cut(tmp_path / "late", flat, begins=60.0, arc=15.0),
        cut(tmp_path / "jump", lambda x: np.where(x < 60.0, 100.0, 120.0), arc=20.0),
    ]
    found = common(runs)
    for k in (0, 1):
        why = found[k].figures[NOT_COMMON]
        assert found[k].figures == runs[k][1].figures | {NOT_COMMON: why}
        assert why == "each run has its mean over its own window: the runs have none in common"
    # One that has no window anyway says why, and takes none from the others.
    assert found[2].figures["no_window"].startswith("the torque jumps at 60°")
    assert common([runs[0], runs[2]])[0].figures == runs[0][1].figures
    # A part that is too short for one.
    runs[1] = cut(tmp_path / "overlap", flat, begins=20.0, arc=20.0)
    said = r"in that of all runs, 46.7 to \S+ deg, run 0 has none, it would only last"
    assert re.search(said, common(runs)[1].figures[NOT_COMMON])


def test_the_best_is_better_by_more_than_the_half_widths():
    def means(spread):
        given = Trial({}, "a", 3.2, half_width=spread)
        other = Trial({"k": 1}, "b", 3.1, half_width=spread)
        return Optimum("force_plateau_N", 1, (), (given, other))

    assert means(0.06).best.folder == "b"  # 0.1 against 0.085
    assert "3.2 ± 0.06 N as given, 3.1 ± 0.06 N at best (-3.1 %)" in str(means(0.06))
    assert means(0.08).best.folder == "a"  # 0.113
    assert str(means(0.08)).startswith("the model as given is the best")
    # A figure that is no mean has no ±.
    assert means(None).best.folder == "b"

"""Studies on real processes: the same table however they run, and nothing lost when they die."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from functools import partial

import pytest

import shellcut as sc
from shellcut.study import engines
from shellcut.study.one_run import STOP
from small_disk import REFUSAL, files_of_at_most
from tiny_study import ANGLES, SETTINGS, done_at, in_words


def study(out, executor=1, say=str):
    return sc.sweep("guillotine", ANGLES, out, settings=SETTINGS, executor=executor, say=say)


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """Return a study that is done, one run after the other."""
    return study(tmp_path_factory.mktemp("study") / "in_turn")


@pytest.fixture
def part(done, tmp_path):
    """Return a function that copies the study without some of its runs, and gives the folder."""

    def without(*numbers):
        out = tmp_path / "part"
        shutil.copytree(done.folder, out)
        for number in numbers:
            shutil.rmtree(done.plan.runs[number].folder(out))
        return out

    return without


def test_a_study_gives_a_row_a_run(done):
    assert [row["wedge_half_angle_deg"] for row in done.rows] == [10, 14, 18, 22]
    forces = [row["force_peak_N"] for row in done.rows]
    assert all(force > 0.0 for force in forces)
    assert len(set(forces)) == 4
    table = done.table.read_text(encoding="utf-8-sig").splitlines()
    assert table[0].startswith("run,wedge_half_angle_deg,status,doubts,force_peak_N")
    for line, run in zip(table[1:], done.plan.runs, strict=True):
        told = sc.read(run.folder(done.folder)).summary["verdict"]
        (doubt,) = (one["text"] for one in told if one["kind"] == "doubt")
        assert line.split(",")[3] == "1"
        assert f"distrust: {doubt.partition('. ')[0]}" in line
    assert "wall_s" not in table[0]
    assert len(table) == 5


def test_a_second_call_runs_nothing_and_more_values_run_only_themselves(done, part):
    out = part()
    before, lines = done_at(out), []
    again = study(out, say=lines.append)
    assert done_at(out) == before
    assert lines[0].startswith("4 runs, 4 of them done before")
    assert again.table.read_bytes() == done.table.read_bytes()
    more = {"wedge_half_angle_deg": [10, 12]}
    sc.sweep("guillotine", more, out, settings=SETTINGS, executor=1, say=lines.append)
    assert len(done_at(out)) == 5
    assert any(line.startswith("2 runs, 1 of them done before") for line in lines)


def test_processes_give_the_same_table_though_one_is_killed(done, part, monkeypatch):
    children, killed = [], []

    class Noted(engines.Child):
        def begin(self, *call):
            children.append(self)
            super().begin(*call)

    monkeypatch.setattr(engines, "Child", Noted)

    def say(line):
        if line.startswith("[2/"):
            killed.append(children[-1])
            children[-1]._process.kill()

    out = part(0, 1, 2)
    found = study(out, 2, say)
    assert killed[0]._process.returncode < 0
    assert found.table.read_bytes() == done.table.read_bytes()


def test_an_executor_of_the_caller_gives_the_same_table(done, part):
    with ThreadPoolExecutor(1) as executor:
        found = study(part(1), executor)
    assert found.table.read_bytes() == done.table.read_bytes()


def test_a_study_that_is_interrupted_goes_on(done, tmp_path):
    """On two processes; `tests/reliability/kills.py` has other signals."""
    settings = in_words(SETTINGS | ANGLES)
    command = [sys.executable, "-m", "shellcut", "sweep", "guillotine", *settings]
    command += ["--jobs=2", f"-o={tmp_path}"]
    # In the background of a shell the process would ignore Ctrl-C.
    begin = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, preexec_fn=begin) as process:
        for line in process.stderr:
            if line.startswith("[1/"):
                os.kill(process.pid, signal.SIGINT)
                break
        rest = process.stderr.read()  # until the last process has ended
    assert "the present runs keep their checkpoints" in rest
    assert process.returncode == 130
    before = done_at(tmp_path)
    assert before
    found = study(tmp_path)
    assert found.table.read_bytes() == done.table.read_bytes()
    assert {path: done_at(tmp_path)[path] for path in before} == before


def test_a_full_disk_ends_its_run_and_not_the_study(done, part):
    out, lines = part(1, 2), []
    first = done.plan.runs[1].folder(out)
    with ExitStack() as full:
        full.enter_context(files_of_at_most(230_000))

        def say(line):
            lines.append(line)
            if line.startswith("[3/"):  # the first of the two has ended
                full.close()

        found = study(out, say=say)
    assert [found.outcomes[k].status for k in range(4)] == ["done", "failed", "done", "done"]
    assert re.search(REFUSAL, found.outcomes[1].reason)
    row = found.table.read_text(encoding="utf-8-sig").splitlines()[2]
    assert row.startswith("1,14,failed")
    assert re.search(REFUSAL, row)
    assert any(line.startswith("[3/4]") and "failed" in line for line in lines)
    assert first.joinpath("history.csv").exists()  # it had begun
    before = done_at(out)
    assert study(out).table.read_bytes() == done.table.read_bytes()
    assert done_at(out).keys() - before.keys() == {first / "summary.json"}
    assert {path: done_at(out)[path] for path in before} == before


def test_an_interrupted_run_goes_on_from_its_checkpoint(done, tmp_path):
    def values(executor):
        one = {"wedge_half_angle_deg": [10]}
        return sc.sweep("guillotine", one, tmp_path, settings=SETTINGS, executor=executor, say=str)

    run = values(1).plan.runs[0].folder(tmp_path)
    figures = json.loads(run.joinpath("summary.json").read_text())
    # As a killed process leaves it: a checkpoint, but no summary.
    run.joinpath("summary.json").unlink()
    # Another number of processes gives a run another number of threads; it is the same run.
    assert values(2).rows[0]["force_peak_N"] == done.rows[0]["force_peak_N"]
    again = json.loads(run.joinpath("summary.json").read_text())
    assert [again[name] for name in ("digest", "n_step")] == [figures["digest"], figures["n_step"]]


def test_a_stop_that_was_left_behind_stops_nothing(part):
    # By a study that was killed while its runs were stopping.
    out = part(3)
    (out / STOP).touch()
    assert study(out).count("done") == 4
    assert not (out / STOP).exists()


def test_a_combination_that_cannot_be_fails_in_its_run_and_the_others_go_on(tmp_path):
    settings = SETTINGS | {"cohesive.plateau": 12}
    strength = {"cohesive.strength": [18, 10]}  # below the plateau: no law
    found = sc.sweep("guillotine", strength, tmp_path, settings=settings, executor=1, say=str)
    assert [found.outcomes[k].status for k in range(2)] == ["done", "failed"]
    row = found.table.read_text(encoding="utf-8-sig").splitlines()[2]
    assert row.startswith("1,10,failed")
    assert "[cohesive]: the law must decrease" in row
    with pytest.raises(sc.ModelFileError, match="the law must decrease"):
        sc.sweep("guillotine", {"cohesive.strength": [9, 10]}, tmp_path / "no", settings=settings)
    with pytest.raises(sc.ModelFileError, match="must be positive"):
        sc.sweep("guillotine", {"cohesive.strength": [18, -10]}, tmp_path / "no", settings=settings)
    assert not (tmp_path / "no").exists()

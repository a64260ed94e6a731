"""Runs in a child of a worker: nothing is lost when either of the two dies."""

import threading
import time

import pytest

from shellcut import child_process
from shellcut.child_process import Child, ChildDied
from shellcut.files.folder_lock import FolderInUse, FolderLock
from shellcut.files.run_folder import CHECKPOINT
from shellcut.study import engines
from shellcut.study.engines import run_in_child
from shellcut.study.one_run import outcome_in, run_one
from shellcut.study.plan import Definition
from shellcut.study.study import _tasks
from tiny_study import SETTINGS

WAIT = 120.0  # s: of another process, on a machine with much else to do


@pytest.fixture(autouse=True)
def no_child_left():
    yield
    vars(engines._of_thread).clear()


def task_in(folder, **settings):
    """Return the task of a run, and its folder."""
    planned = Definition("guillotine", {"wedge_half_angle_deg": [10]}, SETTINGS | settings).plan()
    task = next(_tasks(planned, list(planned.runs), folder, jobs=2))
    return task, planned.runs[0].folder(folder)


def until(true):
    """Wait for something that another process does."""
    end = time.monotonic() + WAIT
    while not true():
        assert time.monotonic() < end
        time.sleep(0.01)


def is_held(folder):
    """Return whether a run is under way in a folder."""
    if not folder.exists():
        return False
    try:
        FolderLock(folder).close()
    except FolderInUse:
        return True
    return False


def figures_of(outcome):
    of_the_machine = {"wall_s", "ns_per_quad_step"}
    return {name: v for name, v in outcome.figures.items() if name not in of_the_machine}


def test_a_child_that_dies_is_replaced_and_one_that_lives_is_kept(tmp_path, monkeypatch):
    made = []

    class Noted(Child):
        def __init__(self):
            super().__init__()
            made.append(self)

    monkeypatch.setattr(engines, "Child", Noted)
    # What an environment prints at the start of Python does not come between the results.
    monkeypatch.setattr(child_process, "_BEGIN", f"print('I am here'); {child_process._BEGIN}")
    task, _ = task_in(tmp_path / "child")

    def kill():
        until(lambda: made)
        made[0]._process.kill()

    killer = threading.Thread(target=kill)
    killer.start()
    with pytest.raises(ChildDied, match="killed, or out of memory"):
        run_in_child(task)
    killer.join()
    here = run_one(task_in(tmp_path / "here")[0])
    there = run_in_child(task)
    assert there.status == "done"
    assert figures_of(there) == figures_of(here)
    assert run_in_child(task).figures == there.figures
    assert len(made) == 2
    made[1]._process.kill()
    made[1]._process.wait()
    assert run_in_child(task).figures == there.figures  # that of a thread is replaced before a run
    assert len(made) == 3
    # It ends with its thread, and here with what the thread has.
    process = made[2]._process
    made.clear()
    vars(engines._of_thread).clear()
    until(lambda: process.poll() is not None)
    assert process.returncode == 0


def test_a_child_whose_worker_is_killed_stops_with_a_checkpoint(tmp_path):
    # A run of many seconds: within one of them a run sees that it must stop.
    task, folder = task_in(tmp_path, **{"membrane.size": 0.2})
    child = Child()
    child.begin(run_one, task)
    until(lambda: is_held(folder))
    child._process.stdin.close()  # as the system does when the worker is killed
    until(lambda: not is_held(folder))
    assert (folder / CHECKPOINT).exists()
    assert outcome_in(folder) is None
    child.end()
    assert child._process.returncode == 0

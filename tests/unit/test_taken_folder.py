"""A folder has one run at a time; what makes room for another is what a run has written."""

import errno
import json
import os
import socket
import subprocess
import sys
import threading
import time

import pytest

import shellcut.files.file_lock
from shellcut.files.file_list import FILES, OTHERS, FileList, claim, target
from shellcut.files.folder_lock import LOCK, FolderInUse, FolderLock, TakenFolder, refuse_if_in_use


@pytest.fixture
def out(tmp_path):
    return tmp_path / "out"


@pytest.fixture
def taken(out):
    folder = TakenFolder(out)
    yield folder
    folder.lock.close()


HISTORY, FRAME = "history.csv", "a_frames/frame_0000.vtu"


def fill(folder, *names):
    for name in names:
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(name)


def left(folder):
    return sorted(p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.is_file())


def begin(folder, names, others=(), *, replace=True):
    """Take a folder for a run, and give it back."""
    taken = TakenFolder(folder)
    try:
        taken.begin(names, others, replace=replace)
    finally:
        taken.lock.close()


def run_before(folder, *names):
    """Leave what a run does, and give the folder back."""
    begin(folder, names)
    fill(folder, *names)


def test_what_a_run_wrote_goes_and_all_else_stays(out):
    run_before(out, HISTORY, "energy.png", FRAME, "b_frames/frame_0000.vtu", "checkpoint.h5")
    # Of one killed while it wrote its checkpoint.
    fill(out, f"checkpoint.part-{'0a' * 8}.h5")
    mine = ["force_measured.png", "mine.vtkhdf", "snapshot_of_my_part.png", "snapshot_07.png"]
    mine += ["b_frames/mine.vtu", "notes/history.csv", "checkpoint.part.h5"]
    fill(out, *mine)
    before = left(out)
    with pytest.raises(FileExistsError, match=r"already holds a run, with history\.csv"):
        begin(out, [HISTORY], replace=False)
    assert left(out) == before
    begin(out, [HISTORY])
    assert left(out) == sorted([*mine, FILES])
    assert not (out / "a_frames").exists()
    assert FileList(out).names == [HISTORY]


@pytest.mark.parametrize("replace", [False, True])
def test_what_no_run_wrote_is_not_replaced_either(out, replace):
    out.mkdir()
    fill(out, HISTORY, "snapshot_01.png", "notes.txt")
    wanted = r"has history\.csv, snapshot_01\.png, which this run would replace although no run wro"
    with pytest.raises(FileExistsError, match=wanted):
        begin(out, [HISTORY], ["snapshot_00.png", "snapshot_01.png"], replace=replace)
    assert left(out) == [HISTORY, "notes.txt", "snapshot_01.png"]


def test_a_list_of_another_origin_is_no_list(out, tmp_path):
    out.mkdir()
    fill(out, "precious.txt")
    (out / FILES).write_text("precious.txt\n")
    run_before(tmp_path / "other", HISTORY)
    linked = tmp_path / "linked"
    linked.mkdir()
    fill(linked, HISTORY)
    (linked / FILES).symlink_to(tmp_path / "other" / FILES)
    for folder in (out, linked):
        before = left(folder)
        assert FileList(folder).names == []
        with pytest.raises(FileExistsError, match=FILES):
            begin(folder, [HISTORY])
        assert left(folder) == before
    assert FileList(tmp_path / "other").names == [HISTORY]


def test_a_list_leads_to_nothing_outside(out, tmp_path):
    fill(tmp_path, "precious.txt")
    run_before(out, HISTORY)
    heading = (out / FILES).read_text().split("\n")[0]
    wrong = ["../precious.txt", str(tmp_path / "precious.txt"), "a/../../precious.txt", "", "."]
    wrong += ["C:\\precious.txt", "\\\\host\\precious.txt"]
    (out / FILES).write_text("\n".join([heading, *wrong, HISTORY, "precious.t"]))
    # The last line was not finished: what it names is not known.
    assert FileList(out).names == [HISTORY]
    begin(out, [])
    assert (tmp_path / "precious.txt").exists()


def test_names_are_listed_before_their_files_are_there(taken):
    taken.begin([HISTORY], replace=True)
    assert FileList(taken.path).names == [HISTORY]
    for name in (FRAME, HISTORY):
        taken.files.add(name)
    assert FileList(taken.path).names == [HISTORY, FRAME]
    assert FileList(taken.path).there() == []
    fill(taken.path, HISTORY)
    assert FileList(taken.path).there() == [HISTORY]
    taken.clear()
    assert left(taken.path) == ["run.lock"]


def test_a_run_gone_on_with_keeps_its_list(out):
    run_before(out, HISTORY, "snapshot_00.png")
    taken = TakenFolder(out)
    taken.resume([HISTORY, "summary.json"])
    assert taken.files.names == [HISTORY, "snapshot_00.png", "summary.json"]
    fill(out, "summary.json", "mine.png")
    taken.files.remove(["summary.json", "mine.png"])
    taken.lock.close()
    assert left(out) == sorted([HISTORY, FILES, "snapshot_00.png", "mine.png"])
    assert FileList(out).there() == [HISTORY, "snapshot_00.png"]


def test_links_in_a_folder_lead_to_nothing_that_a_run_may_touch(out, tmp_path):
    mine = tmp_path / "mine"
    mine.mkdir()
    fill(mine, "frame_0000.vtu", HISTORY)
    run_before(out, HISTORY, FRAME)
    for name, to in ((HISTORY, mine / HISTORY), (FRAME.split("/")[0], mine)):
        (out / name).rename(tmp_path / f"old {name}")
        (out / name).symlink_to(to)
    with pytest.raises(FileExistsError, match=r"has a_frames/frame_0000\.vtu"):
        begin(out, [HISTORY], [FRAME])
    taken = TakenFolder(out)
    taken.begin([HISTORY], replace=True)  # removes the link, not what it leads to
    assert not (out / HISTORY).is_symlink()
    with pytest.raises(FileExistsError):
        taken.files.add(FRAME)
    taken.lock.close()
    assert left(mine) == ["frame_0000.vtu", HISTORY]


def test_a_command_replaces_what_commands_wrote_and_no_input(tmp_path):
    run_before(tmp_path, "history.csv")
    claim(tmp_path, ["a.csv", "b.csv"])
    fill(tmp_path, "a.csv", "mine.csv")
    claim(tmp_path, ["b.csv", "a.csv"])
    assert FileList(tmp_path, OTHERS).names == ["a.csv", "b.csv"]
    for name in ("mine.csv", "history.csv", "run.lock", FILES):
        with pytest.raises(FileExistsError, match=name):
            claim(tmp_path, ["c.csv", name])
    with pytest.raises(FileExistsError, match=r"a\.csv is read here"):
        claim(tmp_path, ["a.csv"], [tmp_path / "nothing", tmp_path / "." / "a.csv"])
    assert FileList(tmp_path, OTHERS).names == ["a.csv", "b.csv"]
    # What a user names is replaced, but no input and nothing of a run.
    assert target(tmp_path / "mine.csv", tmp_path / "c.csv") == tmp_path / "mine.csv"
    for name in ("a.csv", "history.csv", "run.lock", FILES, OTHERS):
        with pytest.raises(FileExistsError, match=name):
            target(tmp_path / name, tmp_path / "c.csv", [tmp_path / "a.csv"])
    with pytest.raises(ValueError, match="must have a name"):
        claim("", ["a.csv"])
    with pytest.raises(ValueError, match="must have a name"):
        TakenFolder("")


HOLDER = """
import sys
from pathlib import Path
# The room alone: the whole package takes seconds.
sys.path.insert(0, str(Path(sys.argv[2]).parents[1]))
from files.folder_lock import FolderLock
lock = FolderLock(Path(sys.argv[1]))
print("held", flush=True)
sys.stdin.readline()
"""


@pytest.fixture
def holder(tmp_path):
    """A process that holds the folder."""
    command = [sys.executable, "-c", HOLDER, str(tmp_path), shellcut.files.folder_lock.__file__]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdout.readline() == b"held\n"
        yield process
        process.kill()


@pytest.mark.parametrize("killed", [True, False])
def test_who_holds_it_is_told_and_a_process_killed_or_ended_holds_nothing(holder, tmp_path, killed):
    for attempt in (FolderLock, refuse_if_in_use):
        with pytest.raises(FolderInUse) as refusal:
            attempt(tmp_path)
        said = str(refusal.value)
        assert f"process {holder.pid} on {socket.gethostname()} since 20" in said
        assert f"{tmp_path} is being written" in said
    assert json.loads((tmp_path / LOCK).read_text())["process"] == holder.pid
    if killed:
        holder.kill()
    else:
        holder.stdin.write(b"\n")
        holder.stdin.close()
    assert (holder.wait() == 0) != killed
    assert (tmp_path / LOCK).exists()
    FolderLock(tmp_path).close()
    assert list(tmp_path.iterdir()) == []


def test_twice_in_one_process_is_refused_in_any_thread(tmp_path):
    lock = FolderLock(tmp_path)
    told = []

    def attempt():
        with pytest.raises(FolderInUse, match=f"this very process, {os.getpid()}"):
            FolderLock(tmp_path)
        told.append(True)

    attempt()
    thread = threading.Thread(target=attempt)
    thread.start()
    thread.join()
    assert len(told) == 2
    lock.close()
    lock.close()
    FolderLock(tmp_path).close()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_a_fork_neither_holds_nor_frees_it(tmp_path):
    lock = FolderLock(tmp_path)
    ready, go = os.pipe(), os.pipe()
    child = os.fork()
    if child == 0:
        lock.close()  # as by an end of the interpreter
        os.write(ready[1], b"x")
        os.read(go[0], 1)
        os._exit(0)
    os.read(ready[0], 1)
    with pytest.raises(FolderInUse):
        FolderLock(tmp_path)
    # The parent gives it back while its child lives on.
    lock.close()
    FolderLock(tmp_path).close()
    os.write(go[1], b"x")
    os.waitpid(child, 0)
    for one in (*ready, *go):
        os.close(one)


def test_a_lock_whose_file_was_removed_is_taken_again(tmp_path):
    lock = FolderLock(tmp_path)
    (tmp_path / LOCK).unlink()
    lock.hold()
    with pytest.raises(FolderInUse):
        FolderLock(tmp_path)
    (tmp_path / LOCK).unlink()
    other = FolderLock(tmp_path)
    with pytest.raises(FolderInUse):
        lock.hold()
    lock.close()
    assert (tmp_path / LOCK).exists()
    other.close()
    assert not (tmp_path / LOCK).exists()


def test_of_many_that_want_it_at_once_one_gets_it(tmp_path):
    # Each holds it for a moment, ten times: nobody may come in between, also while files come and
    # go, and everybody gets it in the end, on however slow a machine.
    inside, most = [], []

    def take():
        for _ in range(10):
            while True:
                try:
                    lock = FolderLock(tmp_path)
                    break
                except FolderInUse:
                    time.sleep(1e-4)
            inside.append(1)
            most.append(len(inside))
            inside.pop()
            lock.close()

    threads = [threading.Thread(target=take) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert most == [1] * 80


@pytest.mark.skipif(sys.platform == "win32", reason="flock is of POSIX")
def test_a_file_system_without_locks_is_told_of(tmp_path, monkeypatch, caplog):
    # There is none here: the system's answer is put in its place.
    def without(*_):
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr(shellcut.files.file_lock.fcntl, "flock", without)
    FolderLock(tmp_path).close()
    assert "without locks" in caplog.text
    assert "no second run" in caplog.text
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_cannot_be_written_is_no_folder_in_use(tmp_path):
    (tmp_path / LOCK).mkdir()
    with pytest.raises(IsADirectoryError):
        FolderLock(tmp_path)


@pytest.mark.parametrize("there", ["my notes", '["process"]'])
@pytest.mark.parametrize("linked", [False, True])
def test_a_file_of_the_lock_s_name_that_is_none_stays(tmp_path, there, linked):
    mine = tmp_path / ("mine" if linked else LOCK)
    mine.write_text(there)
    if linked:
        (tmp_path / LOCK).symlink_to(mine)
    for attempt in (FolderLock, refuse_if_in_use):
        with pytest.raises(OSError, match=LOCK):
            attempt(tmp_path)
    assert mine.read_text() == there
    assert (tmp_path / LOCK).is_symlink() == linked

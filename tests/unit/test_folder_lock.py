"""One run at a time in a folder: real processes, one of them killed."""

import errno
import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time

import pytest

import shellcut.files.file_lock
from shellcut.files.folder_lock import LOCK, FolderInUse, FolderLock, refuse_if_in_use

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


def test_who_holds_it_is_told(holder, tmp_path):
    with pytest.raises(FolderInUse) as refusal:
        FolderLock(tmp_path)
    said = str(refusal.value)
    assert f"process {holder.pid} on {socket.gethostname()} since 20" in said
    assert f"{tmp_path} is being written" in said
    with pytest.raises(FolderInUse):
        refuse_if_in_use(tmp_path)
    assert json.loads((tmp_path / LOCK).read_text())["process"] == holder.pid


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs kill -9")
def test_a_process_killed_or_ended_holds_nothing(holder, tmp_path):
    holder.kill()
    holder.wait()
    assert (tmp_path / LOCK).exists()
    FolderLock(tmp_path).close()
    assert list(tmp_path.iterdir()) == []


def test_a_process_that_ends_holds_nothing(holder, tmp_path):
    holder.stdin.write(b"\n")
    holder.stdin.close()
    assert holder.wait() == 0
    FolderLock(tmp_path).close()


def test_twice_in_one_process_is_refused_in_any_thread(tmp_path):
    lock = FolderLock(tmp_path)
    with pytest.raises(FolderInUse, match=f"this very process, {os.getpid()}"):
        FolderLock(tmp_path)
    told = []

    def attempt():
        try:
            FolderLock(tmp_path)
        except FolderInUse as refusal:
            told.append(refusal)

    thread = threading.Thread(target=attempt)
    thread.start()
    thread.join()
    assert len(told) == 1
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
        got = 0
        while got < 10:
            try:
                lock = FolderLock(tmp_path)
            except FolderInUse:
                time.sleep(1e-4)
                continue
            got += 1
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

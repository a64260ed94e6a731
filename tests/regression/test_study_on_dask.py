"""A study on a real Dask scheduler with real workers, which die."""

import socket
import subprocess
import sys
from contextlib import ExitStack

import pytest

import shellcut as sc
from tiny_study import ANGLES, SETTINGS


@pytest.fixture
def begin():
    """Begin processes of Dask, which are killed in the end."""
    with ExitStack() as close:

        def begun(module, *arguments):
            command = [sys.executable, "-m", f"distributed.cli.{module}", *arguments]
            process = close.enter_context(subprocess.Popen(command, stderr=subprocess.DEVNULL))
            close.callback(process.kill)
            return process

        yield begun


@pytest.mark.slow
def test_a_study_outlives_a_worker_and_goes_on_after_its_scheduler(begin, tmp_path):
    # Imported here: two seconds that the collection of all tests would take.
    distributed = pytest.importorskip("distributed")
    with socket.socket() as here:
        here.bind(("127.0.0.1", 0))
        port = here.getsockname()[1]
    address = f"tcp://127.0.0.1:{port}"

    def study(out, executor, say=str):
        return sc.sweep(
            "guillotine", ANGLES, tmp_path / out, settings=SETTINGS, executor=executor, say=say
        )

    def scheduler():
        return begin("dask_scheduler", "--host=127.0.0.1", f"--port={port}", "--no-dashboard")

    def worker():
        # Without a nanny, which would begin a killed worker again.
        return begin("dask_worker", address, "--nthreads=1", "--no-dashboard", "--no-nanny")

    by_turn, lines = study("turn", 1), []
    first, workers = scheduler(), [worker(), worker()]

    def say(line):
        lines.append(line)
        if line.startswith("[1/"):
            workers[0].kill()
        if line.startswith("[2/"):
            first.kill()

    with distributed.Client(address, timeout=60) as client:
        client.wait_for_workers(2, timeout=60)
        with pytest.raises(ConnectionError, match="call the study again, what is done is kept"):
            study("dask", client, say)
        scheduler()
        worker()
        with distributed.Client(address, timeout=60) as again:
            again.wait_for_workers(1, timeout=60)
            found = study("dask", again)
    assert lines[0] == "4 runs, 0 of them done before; 2 at a time"
    assert found.table.read_bytes() == by_turn.table.read_bytes()

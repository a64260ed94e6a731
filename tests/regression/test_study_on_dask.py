"""A study on a real Dask scheduler with real workers, which die."""

import socket
import subprocess
import sys
from contextlib import ExitStack

import pytest

import shellcut as sc
from tiny_study import ANGLES, SETTINGS


def free_port():
    with socket.socket() as here:
        here.bind(("127.0.0.1", 0))
        return here.getsockname()[1]


class Cluster:
    """A scheduler and workers, each a process of its own."""

    def __init__(self):
        self.port = free_port()
        self.address = f"tcp://127.0.0.1:{self.port}"
        self.processes = []

    def begin(self, module, *arguments):
        command = [sys.executable, "-m", f"distributed.cli.{module}", *arguments]
        process = subprocess.Popen(command, stderr=subprocess.DEVNULL)
        self.processes.append(process)
        return process

    def scheduler(self):
        port = str(self.port)
        return self.begin("dask_scheduler", "--host=127.0.0.1", f"--port={port}", "--no-dashboard")

    def worker(self):
        # Without a nanny, which would begin a killed worker again.
        return self.begin(
            "dask_worker", self.address, "--nthreads=1", "--no-dashboard", "--no-nanny"
        )

    def end(self):
        for process in self.processes:
            process.kill()
            process.wait()


@pytest.mark.slow
def test_a_study_outlives_a_worker_and_goes_on_after_its_scheduler(tmp_path):
    # Imported here: two seconds that the collection of all tests would take.
    distributed = pytest.importorskip("distributed")
    by_turn = sc.sweep(
        "guillotine", ANGLES, tmp_path / "turn", settings=SETTINGS, executor=1, say=str
    )
    lines = []
    with ExitStack() as close:
        cluster = Cluster()
        close.callback(cluster.end)
        scheduler, workers = cluster.scheduler(), [cluster.worker(), cluster.worker()]
        client = close.enter_context(distributed.Client(cluster.address, timeout=60))
        client.wait_for_workers(2, timeout=60)

        def say(line):
            lines.append(line)
            if line.startswith("[1/"):
                workers[0].kill()
            if line.startswith("[2/"):
                scheduler.kill()

        def study(executor):
            out = tmp_path / "dask"
            return sc.sweep(
                "guillotine", ANGLES, out, settings=SETTINGS, executor=executor, say=say
            )

        with pytest.raises(ConnectionError, match="call the study again, what is done is kept"):
            study(client)
        cluster.scheduler()
        cluster.worker()
        again = close.enter_context(distributed.Client(cluster.address, timeout=60))
        again.wait_for_workers(1, timeout=60)
        found = study(again)
    assert lines[0] == "4 runs, 0 of them done before; 2 at a time"
    assert found.table.read_bytes() == by_turn.table.read_bytes()

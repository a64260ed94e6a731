"""What the study itself costs where its runs cost nothing: ten thousand of them."""

import json
import subprocess
import sys

import pytest

SCRIPT = """
import json, resource, sys, time
from pathlib import Path

import shellcut
from shellcut.study import study
from shellcut.study.factors import Design
from shellcut.study.one_run import Outcome

FIGURES = {f"figure_{k}": 0.1 * k for k in range(40)} | {"share_done": 1.0}  # as many as a run has


class Dry:
    jobs = 1

    def outcomes(self, tasks):
        for task in tasks:
            folder = Path(task.folder)
            folder.mkdir(parents=True)
            (folder / "summary.json").write_text(json.dumps(FIGURES))
            yield task, Outcome("done", figures=FIGURES, seconds=1.0)


study.engine_of = lambda executor: Dry()
factors = {
    "tool.edge_inclination_deg": "40:80",
    "motion.pitch": "8:24",
    "tool.wedge_half_angle_deg, tool.teeth": [[6, 4], [8, 4], [10, 6]],
}
spent = {}
for call in ("first", "second"):
    began = time.perf_counter(), time.process_time()
    found = shellcut.sweep(
        "opening", factors, sys.argv[1], design=Design("sobol", 10_000), say=lambda line: None
    )
    assert found.count("done") == 10_000
    spent[call] = time.perf_counter() - began[0], time.process_time() - began[1]
# What getrusage says begins with the memory of the process that has started this one.
status = Path("/proc/self/status")
if status.exists():
    kilobytes = next(line for line in status.read_text().splitlines() if line.startswith("VmHWM"))
    spent["megabytes"] = int(kilobytes.split()[1]) / 1024
else:
    spent["megabytes"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
print(json.dumps(spent))
"""


@pytest.mark.slow
def test_ten_thousand_runs_take_under_a_minute_and_a_gigabyte(tmp_path):
    command = [sys.executable, "-c", SCRIPT, str(tmp_path / "study")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=True)
    spent = json.loads(done.stdout)
    print(spent)
    assert spent["megabytes"] < 1000.0
    for call in ("first", "second"):
        _, of_the_processor = spent[call]
        assert of_the_processor < 60.0
    table = (tmp_path / "study" / "table.csv").read_text(encoding="utf-8-sig").splitlines()
    assert len(table) == 10_001

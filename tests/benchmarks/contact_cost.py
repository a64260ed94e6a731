"""What contact costs: the opening test with its parts switched on, run by run in turns.

    python tests/benchmarks/contact_cost.py --mesh M1 [--before CHECKOUT]

Each configuration runs in a process of its own; all take turns of ``ROUND`` steps on one core, so
that a machine whose speed drifts slows all alike. With ``--before`` the default contact of another
checkout of the library is one of them, and the one that the others are compared with. The default
of the opening test is *and film edges*.
Prints for each the median of the ratios of its rounds to those of the first, the ratio of the sums,
and how many steps it took. Sums leave out rounds in which a process took ``PAUSE`` times as long as
usual: it compiled a kernel, or something else had the core.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import IO, Any

import numpy as np

ROUND = 50
"""Steps of a turn: short beside the time in which the speed of a machine changes."""

PAUSE = 20.0

ANGLE = 95.0  # degrees

OFF = {"tool_points": False}
ALL: dict[str, Any] = {"friction": 0.2, "self_contact": True, "self_friction": 0.2}
CONFIGURATIONS: dict[str, dict[str, Any]] = {
    "faces": OFF,
    "faces, points": {},
    "and film edges": {"film_edges": True},
    "all but film edges": ALL | {"film_edges": False},
    "all": ALL | {"film_edges": True},
}
BEFORE = "before"


class Runner:
    """A configuration in a process of its own."""

    def __init__(self, mesh: str, settings: dict[str, Any], checkout: Path | None, core: int):
        environment = dict(os.environ)
        if checkout is not None:
            environment["PYTHONPATH"] = str(checkout / "src")
        self._process = subprocess.Popen(
            [sys.executable, __file__, "--child", json.dumps([mesh, settings, core])],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=environment,
        )
        self.ask("ready")

    def ask(self, what: str) -> Any:
        """Send a line, return the answer."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(what + "\n")
        self._process.stdin.flush()
        return json.loads(self._process.stdout.readline())

    def advance(self, n_step: int) -> tuple[float, float, int]:
        """Run so many steps; return CPU and wall time [s] and the number of steps done."""
        cpu, wall, done = self.ask(str(n_step))
        return float(cpu), float(wall), int(done)

    def close(self) -> None:
        """End the process."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._process.wait()


def serve(mesh: str, settings: dict[str, Any], core: int, asked: IO[str]) -> None:
    """Run a case as the parent asks for it, a line an order."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {core})
    import shellcut

    contact = shellcut.Contact(**settings)
    case = shellcut.opening_test(mesh, angle_deg=ANGLE, contact=contact)
    sim, until = case.simulation, case.duration
    for line in asked:
        n_step = int(line) if line.strip().isdigit() else 0
        cpu, wall, done = time.process_time(), time.perf_counter(), 0
        while done < n_step and sim.state.time < until:
            sim.step()
            done += 1
        answer = time.process_time() - cpu, time.perf_counter() - wall, done
        print(json.dumps(answer), flush=True)


def measure(
    mesh: str, begin: int, n_round: int, before: Path | None, names: list[str]
) -> dict[str, list[tuple[float, float, int]]]:
    """Return CPU time, wall time and steps of each round of each configuration."""
    core = min(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 0
    runners = {name: Runner(mesh, CONFIGURATIONS[name], None, core) for name in names}
    if before is not None:
        runners = {BEFORE: Runner(mesh, {}, before, core)} | runners
    for runner in runners.values():
        runner.advance(begin)
    rounds: dict[str, list[tuple[float, float, int]]] = {name: [] for name in runners}
    going = True
    while going and (n_round == 0 or len(rounds[names[0]]) < n_round):
        turn = {name: runner.advance(ROUND) for name, runner in runners.items()}
        going = any(done for _, _, done in turn.values())
        for name, found in turn.items():
            rounds[name].append(found)
    for runner in runners.values():
        runner.close()
    return rounds


def table(rounds: dict[str, list[tuple[float, float, int]]]) -> str:
    """Return the ratios over the first configuration as text."""
    cpu = np.array([[found[0] for found in of_one] for of_one in rounds.values()])
    wall = np.array([[found[1] for found in of_one] for of_one in rounds.values()])
    done = np.array([[found[2] for found in of_one] for of_one in rounds.values()])
    whole = (done == ROUND).all(axis=0)
    ratio = np.median(cpu[:, whole] / cpu[0, whole], axis=1)
    of_wall = np.median(wall[:, whole] / wall[0, whole], axis=1)
    usual = whole & (cpu <= PAUSE * np.median(cpu[:, whole], axis=1, keepdims=True)).all(axis=0)
    total = cpu[:, usual].sum(axis=1)
    step = 1e6 * total / (ROUND * np.count_nonzero(usual))
    lines = [
        f"{'':20} {'CPU, median':>12} {'CPU, sum':>9} {'wall':>6} {'us a step':>10} {'steps':>7}"
    ]
    for k, name in enumerate(rounds):
        lines.append(
            f"{name:20} {ratio[k]:12.3f} {total[k] / total[0]:9.3f} {of_wall[k]:6.3f} "
            f"{step[k]:10.1f} {done[k].sum():7d}"
        )
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--mesh", default="M1")
    parser.add_argument("--before", type=Path, help="another checkout, its default as the base")
    parser.add_argument("--begin", type=int, default=0, help="steps before the first round")
    parser.add_argument("--rounds", type=int, default=0, help="rounds; 0: to the end of the cut")
    parser.add_argument("--only", nargs="+", choices=list(CONFIGURATIONS), default=None)
    parser.add_argument("--child", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.child:
        serve(*json.loads(given.child), sys.stdin)
        return
    names = given.only or list(CONFIGURATIONS)
    print(table(measure(given.mesh, given.begin, given.rounds, given.before, names)))


if __name__ == "__main__":
    main()

"""What contact costs: the opening test with its parts switched on, run by run in turns.

    python tests/benchmarks/contact_cost.py --mesh M1 [--before CHECKOUT] [--sets 5]

Each configuration runs in a process of its own; all take turns of ``ROUND`` steps on one core, so
that a machine whose speed drifts slows all alike. With ``--before`` the default contact of another
checkout of the library is one of them, and the one that the others are compared with. The default
of the opening test is *and film edges*.
Prints for each the median of the ratios of its rounds to those of the first, the ratio of the sums,
that of the whole cuts (in which numbers of steps differ, too), and how many steps it took. Sums
leave out rounds in which a process took ``PAUSE`` times as long as usual: it compiled a kernel, or
something else had the core. From process to process the same work may take 2 % more or less all
along, by where its arrays lie: several sets of processes are run, and medians over them printed.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import IO, Any, NamedTuple

import numpy as np

ROUND = 50
"""Steps of a turn: short beside the time in which the speed of a machine changes."""

PAUSE = 20.0

ANGLE = 95.0  # degrees

OFF = {"tool_points": False, "film_edges": False}
ALL: dict[str, Any] = {"friction": 0.2, "self_contact": True, "self_friction": 0.2}
CONFIGURATIONS: dict[str, dict[str, Any]] = {
    "faces": OFF,
    "faces, points": {"film_edges": False},
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


class Costs(NamedTuple):
    """What the configurations cost in one set of processes, (n_configuration,) each."""

    median: np.ndarray
    """Of the ratios of CPU time, round by round, to the first configuration."""
    total: np.ndarray
    """Ratio of the sums of CPU time over rounds of equally many steps."""
    whole: np.ndarray
    """Ratio of CPU time to the end."""
    wall: np.ndarray
    """As ``median``, of wall time."""
    step: np.ndarray
    """CPU time [us]."""
    done: np.ndarray
    """Steps."""


def costs(rounds: dict[str, list[tuple[float, float, int]]]) -> Costs:
    """Return the costs over the first configuration."""
    cpu, wall, done = np.moveaxis(np.array(list(rounds.values())), 2, 0)
    usual = cpu <= PAUSE * np.median(cpu[:, :-1], axis=1, keepdims=True)
    whole = (done == ROUND).all(axis=0)
    total = cpu[:, whole & usual.all(axis=0)].sum(axis=1)
    to_end = np.where(usual, cpu, 0.0).sum(axis=1)
    return Costs(
        median=np.median(cpu[:, whole] / cpu[0, whole], axis=1),
        total=total / total[0],
        whole=to_end / to_end[0],
        wall=np.median(wall[:, whole] / wall[0, whole], axis=1),
        step=1e6 * total / (ROUND * np.count_nonzero(whole & usual.all(axis=0))),
        done=done.sum(axis=1),
    )


def table(names: list[str], sets: list[Costs]) -> str:
    """Return the medians over the sets as text."""
    lines = [f"{'':20} CPU: median     sum   whole    wall  us a step    steps"]
    for k, name in enumerate(names):
        values = (np.median([getattr(one, field)[k] for one in sets]) for field in Costs._fields)
        formats = "11.3f", "7.3f", "7.3f", "7.3f", "10.1f", "8.0f"
        columns = (format(v, f) for v, f in zip(values, formats, strict=True))
        lines.append(f"{name:20} {' '.join(columns)}")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--mesh", default="M1")
    parser.add_argument("--before", type=Path, help="another checkout, its default as the base")
    parser.add_argument("--begin", type=int, default=0, help="steps before the first round")
    parser.add_argument("--rounds", type=int, default=0, help="rounds; 0: to the end of the cut")
    parser.add_argument("--sets", type=int, default=1, help="sets of processes, one after another")
    parser.add_argument("--only", nargs="+", choices=list(CONFIGURATIONS), default=None)
    parser.add_argument("--child", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.child:
        serve(*json.loads(given.child), sys.stdin)
        return
    names = given.only or list(CONFIGURATIONS)
    sets: list[Costs] = []
    for _ in range(given.sets):
        rounds = measure(given.mesh, given.begin, given.rounds, given.before, names)
        sets.append(costs(rounds))
        print(table(list(rounds), sets), f"(of {len(sets)} sets)", sep="\n", flush=True)


if __name__ == "__main__":
    main()

"""Run the benchmarks: python tests/benchmarks/run.py [--json FILE] [--quick] [--only PART ...].

Prints what every part measures, then each target of the project with the figure and whether it is
met. Exits with 1 only if something could not run: a benchmark informs, it does not judge a busy
machine.
"""

from __future__ import annotations

import argparse
import importlib.metadata
import platform
import sys
import traceback
from collections.abc import Callable
from dataclasses import asdict
from datetime import datetime, timezone
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import shellcut
from benchmarks import compile, cut, gates, instructions, machine, memory, peers, report, steps
from benchmarks.discs import SIZES
from benchmarks.harness import Neighbours
from benchmarks.results import Results

QUICK_SIZES = ("1e3", "M1", "M2", "3e4", "1e5")
QUICK_ANGLE = 10.0  # degrees


def print_now(text: str) -> None:
    print(text, flush=True)


def run_machine(results: Results) -> None:
    results.machine = machine.measure()


def run_steps(results: Results) -> None:
    names = QUICK_SIZES if results.quick else tuple(SIZES)
    repeats = 3 if results.quick else 7
    results.steps = steps.measure(names, repeats=repeats, say=print_now)
    results.same_bits = steps.same_bits()
    print_now(f"one and two threads give the same bits: {results.same_bits}")


def run_instructions(results: Results) -> None:
    results.block = instructions.measure()
    if results.block is None:
        print_now("the machine code is not that of an x86 with AVX: not counted")
    else:
        print_now(instructions.told(results.block, results.machine))


def run_memory(results: Results) -> None:
    sizes = ("3e4", "1e5") if results.quick else ("1e5", "1e6")
    results.memory = memory.measure(*sizes)


def run_cut(results: Results) -> None:
    angle = QUICK_ANGLE if results.quick else cut.ANGLE
    for mesh in ("M1", "M2"):
        # The short ones vary most.
        results.cuts.append(cut.measure(mesh, angle, times=3 if mesh == "M1" else 1))


def run_compile(results: Results) -> None:
    results.compilation = compile.measure(1 if results.quick else 3)


def run_peers(results: Results) -> None:
    mesh = "quick" if results.quick else "full"
    results.peers, results.missing_peers = peers.measure(mesh)
    failed = {p: why for p, why in results.missing_peers.items() if why.startswith("could not run")}
    if failed:
        raise RuntimeError("; ".join(f"{program}: {why}" for program, why in failed.items()))


def run_machine_again(results: Results) -> None:
    results.machine_after = machine.measure()


PARTS: dict[str, tuple[Callable[[Results], None], Callable[[Results], list[str]] | None]] = {
    "machine": (run_machine, report.circumstances),
    "steps": (run_steps, None),
    "instructions": (run_instructions, None),
    "memory": (run_memory, report.memory),
    "cut": (run_cut, report.cuts),
    "compile": (run_compile, report.start),
    "peers": (run_peers, report.peers),
    "machine again": (run_machine_again, report.circumstances),
}
"""What measures each part, and the section of the report that tells it, if the part does not."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", type=Path, help="write everything to this file")
    parser.add_argument("--quick", action="store_true", help="small meshes, 10 degrees of the cut")
    parser.add_argument("--only", nargs="+", choices=list(PARTS), help="run these parts only")
    options = parser.parse_args()
    results = Results(
        when=datetime.now(timezone.utc).strftime("%Y-%m-%d %H:%M UTC"),
        versions={"python": platform.python_version(), "system": platform.system()}
        | {"shellcut": shellcut.__version__}
        | {name: importlib.metadata.version(name) for name in ("numpy", "numba")},
        quick=options.quick,
    )
    for name, (part, section) in PARTS.items():
        if options.only and name not in options.only:
            continue
        print_now(f"\n--- {name}")
        neighbours = Neighbours()
        try:
            part(results)
            if section is not None:
                print_now("\n".join(section(results)))
        except Exception as failure:  # the other parts are still worth having
            traceback.print_exc()
            results.errors[name] = f"{type(failure).__name__}: {failure}"
        results.neighbours[name] = met = neighbours.report()
        print_now(f"({met['seconds']:.0f} s, load average {met['load_average']:.2f} before)")
        if (others := met["cores_used_by_others"]) is not None and others > 0.1:
            print_now(f"others used {others:.2f} cores meanwhile: the figures are disturbed")
    print_now("\n".join(report.targets(results)))
    for name, error in results.errors.items():
        print_now(f"could not run: {name}: {error}")
    if options.json is not None:
        results.save(
            options.json,
            gates=[asdict(g) | {"met": g.met, "verdict": g.verdict} for g in gates.gates(results)],
        )
    return 1 if results.errors else 0


if __name__ == "__main__":
    sys.exit(main())

"""All that a run of the benchmarks found, and its JSON."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

from benchmarks.compile import Compilation, Start
from benchmarks.cut import Cut
from benchmarks.instructions import Block
from benchmarks.machine import Machine
from benchmarks.memory import Footprint, Memory
from benchmarks.peers import PeerRun
from benchmarks.steps import StepCost


@dataclass
class Results:
    """What was measured; a part that was not run is empty or None."""

    when: str = ""
    versions: dict[str, str] = field(default_factory=dict)
    quick: bool = False
    neighbours: dict[str, dict[str, float | None]] = field(default_factory=dict)
    """By part: seconds, load average, cores used by others."""
    machine: Machine | None = None
    machine_after: Machine | None = None
    steps: list[StepCost] = field(default_factory=list)
    block: Block | None = None
    """Instructions of the linear element."""
    same_bits: bool | None = None
    memory: Memory | None = None
    cuts: list[Cut] = field(default_factory=list)
    compilation: Compilation | None = None
    peers: list[PeerRun] = field(default_factory=list)
    missing_peers: dict[str, str] = field(default_factory=dict)
    errors: dict[str, str] = field(default_factory=dict)
    """What could not run, by part."""

    def limit(self, name: str) -> float | None:
        """Return a figure of the machine, the better of before and after the run."""
        values = [
            getattr(m, name)
            for m in (self.machine, self.machine_after)
            if m is not None and getattr(m, name) is not None
        ]
        return max(values, default=None)

    def cost(self, name: str, material: str = "linear", threads: int = 1) -> StepCost | None:
        """Return the costs of one mesh."""
        for cost in self.steps:
            if (cost.name, cost.material, cost.threads) == (name, material, threads):
                return cost
        return None

    def save(self, file: Path, **more: Any) -> None:
        """Write everything, and ``more``, as JSON."""
        file.write_text(json.dumps(asdict(self) | more, indent=1) + "\n")


def load(file: Path) -> Results:
    """Read what :meth:`Results.save` wrote."""
    table = json.loads(file.read_text())
    makers: dict[str, Callable[[Any], Any]] = {
        "machine": lambda m: Machine(**m),
        "machine_after": lambda m: Machine(**m),
        "steps": lambda rows: [StepCost(**row) for row in rows],
        "block": lambda b: Block(**b),
        "memory": lambda m: Memory(Footprint(**m["small"]), Footprint(**m["large"])),
        "cuts": lambda rows: [Cut(**row) for row in rows],
        "compilation": lambda c: Compilation(
            Start(**c["cold"]), Start(**c["warm"]), c["import_seconds"]
        ),
        "peers": lambda rows: [PeerRun(**row) for row in rows],
    }
    return Results(
        **{
            f.name: makers[f.name](table[f.name])
            if f.name in makers and table[f.name] is not None
            else table[f.name]
            for f in fields(Results)
        }
    )

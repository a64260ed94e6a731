"""What the linear element asks of the processor: the instructions of one block of eight quads.

Vector arithmetic and shuffles go through the ports that do the multiply-adds; a block cannot take
fewer cycles than it has such instructions over the number of these ports. The ports are those that
the measured peak shows at work: flops a cycle over the flops of one multiply-add. Gathers, loads,
stores and address arithmetic come on top, on other ports and partly on these: the bound leaves them
out.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass

import numba

from benchmarks.discs import build_mesh, pressurised_disc
from benchmarks.machine import Machine
from shellcut.mitc4.forces import add_flat_quads
from shellcut.numerics.jit import _OPTIONS
from shellcut.numerics.lane_instructions import WIDTH

_KINDS = {
    "arithmetic": r"v(fn?m(add|sub)\w*|add|sub|mul|div)p[ds]",
    "shuffle": r"v(perm|unpck|shuf|insert|extract|broadcast|blend|movddup)\w*",
    "gather": r"vgather\w*",
    "move": r"v?mov[au]p[ds]",
}


@dataclass(frozen=True)
class Block:
    """Instructions on whole vectors in the code for one block of quads."""

    arithmetic: int
    shuffle: int
    gather: int
    move: int
    """Loads and stores of vectors, those of the stack included."""

    def least_ns(self, machine: Machine) -> float:
        """Return the least time a quad on this machine [ns]."""
        ports = machine.flops_a_cycle / (2.0 * machine.lanes)
        return (self.arithmetic + self.shuffle) / ports / WIDTH / machine.clock_ghz


def measure() -> Block | None:
    """Count in the machine code of the kernel; None where it is not that of an x86 with AVX."""
    pressurised_disc(build_mesh("quick"), "linear").step()
    kinds = add_flat_quads.signatures[0]
    # A kernel from the cache has no text: compile it again, by itself.
    again = numba.njit(nogil=True, **_OPTIONS)(add_flat_quads.py_func)
    again.compile(kinds)
    found = count(again.inspect_asm(kinds))
    return None if found is None else Block(**found)


def count(code: str) -> dict[str, int] | None:
    """Return the instructions by kind of a block that is gathered, None if nothing gathers.

    The longest stretch without a label is the arithmetic of the damped kernel; the one with most
    gathers goes before it, unless it is the same.
    """
    counts = []
    for stretch in re.split(r"^\.\w+:", code, flags=re.MULTILINE):
        found: Counter[str] = Counter()
        for line in stretch.splitlines():
            words = line.split(maxsplit=1)
            if len(words) == 2 and re.search(r"%[yz]mm", words[1]):
                for kind, pattern in _KINDS.items():
                    found[kind] += bool(re.fullmatch(pattern, words[0]))
        counts.append(found)
    longest = max(counts, key=lambda found: found["arithmetic"])
    gathering = max(counts, key=lambda found: found["gather"])
    if not gathering["gather"]:
        return None
    both = longest if longest is gathering else longest + gathering
    return {kind: both[kind] for kind in _KINDS}


def told(block: Block, machine: Machine | None) -> str:
    """Return the counts as a line of text."""
    text = (
        f"{block.arithmetic} additions, multiplications and both in one, {block.shuffle} shuffles, "
        f"{block.gather} gathers, {block.move} loads and stores of vectors a block of eight quads"
    )
    if machine is None:
        return text
    least = block.least_ns(machine)
    return (
        f"{text}: at least {least:.1f} ns a quad for arithmetic and shuffles alone, "
        f"{least * machine.peak_gflops:,.0f} normalised"
    )

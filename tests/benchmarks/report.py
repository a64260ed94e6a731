"""Write all tables and pictures of the results of run.py into a folder of their name.

    python tests/benchmarks/run.py --json results.json
    python tests/benchmarks/report.py results.json      # results/performance.md and two pictures

docs/performance.md has the figures that matter to a user, and the first of the pictures.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from benchmarks.cut import OF_THE_FILM
from benchmarks.gates import gates
from benchmarks.instructions import told
from benchmarks.peers import OURS
from benchmarks.results import Results, load


def table(head: str, rows: list[list[str]], *, text_columns: int = 1) -> list[str]:
    """Return a Markdown table; figures stand right, the first columns left."""
    n = head.count("|") + 1
    rule = "|" + "---|" * text_columns + "---:|" * (n - text_columns)
    return [f"| {head} |", rule, *(f"| {' | '.join(row)} |" for row in rows), ""]


def shown(value: float | None, form: str = ".1f") -> str:
    """Return a figure, or a dash for none."""
    return "–" if value is None else format(value, form)


def targets(r: Results) -> list[str]:
    rows = [
        [
            gate.what,
            gate.verdict,
            f"{'≥' if gate.at_least else '≤'} {gate.target:g}",
            shown(gate.figure, ".4g"),
        ]
        for gate in gates(r)
    ]
    return ["## Targets", "", *table("what | verdict | target | figure", rows, text_columns=2)]


def circumstances(r: Results) -> list[str]:
    lines = ["## The machine and the run", ""]
    names = ", ".join(f"{name} {version}" for name, version in r.versions.items())
    kind = "A quick run (small meshes, a part of the cut)" if r.quick else "A full run"
    lines += [f"{kind} of {r.when}; {names}.", ""]
    others = [
        (name, part["cores_used_by_others"])
        for name, part in r.neighbours.items()
        if (part["cores_used_by_others"] or 0.0) > 0.1
    ]
    busy = ", ".join(f"{name} {cores:.2f}" for name, cores in others)
    lines += [
        f"Other processes used the cores meanwhile, so figures are disturbed (cores): {busy}."
        if busy
        else "No other process used more than a tenth of a core meanwhile.",
        "",
    ]
    measured = [m for m in (r.machine, r.machine_after) if m is not None]
    if not measured:
        return lines
    m = measured[0]
    lines += [
        f"{m.cpu}, {m.n_core} cores, {m.lanes} doubles a vector, last-level cache of "
        f"{m.cache_mbytes:.0f} MB. Limits, before and after the other parts:",
        "",
    ]
    rows = [
        ["clock, GHz", *(shown(m.clock_ghz, ".2f") for m in measured)],
        ["multiply-add, one thread, GFlop/s", *(shown(m.peak_gflops) for m in measured)],
        ["the same, flops a cycle", *(shown(m.flops_a_cycle) for m in measured)],
        ["multiply-add, two threads, GFlop/s", *(shown(m.peak_gflops_2) for m in measured)],
        ["triad, one thread, GB/s", *(shown(m.triad_gbytes) for m in measured)],
        ["triad, two threads, GB/s", *(shown(m.triad_gbytes_2) for m in measured)],
    ]
    return [
        *lines,
        *table("limit" + " | " + " | ".join(["before", "after"][: len(measured)]), rows),
    ]


def steps(r: Results) -> list[str]:
    peak, triad = r.limit("peak_gflops"), r.limit("triad_gbytes")
    if not r.steps or peak is None or triad is None:
        return []
    rows = []
    for c in r.steps:
        arithmetic, memory = c.arithmetic_floor(peak), c.memory_floor(triad)
        rows.append(
            [
                c.material,
                str(c.threads),
                f"{c.n_quad:,}",
                shown(c.kernel),
                shown(c.plain_step),
                shown(c.evaluation),
                shown(c.step),
                f"{c.step * peak:,.0f}",
                shown(c.step / arithmetic),
                shown(None if memory is None else c.step / memory),
                shown(c.cores, ".2f"),
            ]
        )
    return [
        "## A step",
        "",
        "Nanoseconds a quad and step, medians; a clamped disc under pressure, damping on."
        " *Normalised* is the whole step times the peak of one core in GFlop/s. The floors are"
        " those of one core: 565 flops a quad and 66 a node at the peak (the count of the shortest"
        " exact path for the linear material); each array of shell and state that a step reads,"
        " once, and each that it changes, twice, at the triad's bandwidth, which small meshes beat"
        " from the cache. *Cores* is CPU over wall time: below the number of threads where others"
        " ran.",
        "",
        *table(
            "section | threads | quads | elements | step | safe step's evaluation | whole step"
            " | normalised | over arithmetic | over memory | cores",
            rows,
        ),
        "![Cost over the size of the mesh](performance_scaling.png)",
        "",
        *_instructions(r),
        f"One and two threads give the same bits (1e5 quads, 50 steps): "
        f"{ {None: 'not measured', True: 'yes', False: 'no'}[r.same_bits] }.",
        "",
    ]


def _instructions(r: Results) -> list[str]:
    machine = r.machine or r.machine_after
    if r.block is None or machine is None:
        return []
    return [
        "The linear element's machine code has " + told(r.block, machine) + ". Gathers, loads and"
        " stores come on top.",
        "",
    ]


def memory(r: Results) -> list[str]:
    if r.memory is None:
        return []
    m = r.memory
    rows = [
        [f"{f.n_quad:,}", *(f"{v / 2**20:,.0f}" for v in (f.set_up, f.after_run, f.peak))]
        for f in (m.small, m.large)
    ]
    return [
        "## Memory",
        "",
        *table("quads | after set-up, MB | after a run, MB | peak, MB", rows, text_columns=0),
        f"{m.set_up_slope:,.0f} bytes a quad by the slope between the two; the peak, which the "
        f"set-up makes, {m.peak_slope:,.0f}; growth over a run {m.growth:.1f}.",
        "",
    ]


def cuts(r: Results) -> list[str]:
    if not r.cuts:
        return []
    lines = ["## The opening test, end to end", ""]
    for c in r.cuts:
        lines += [
            f"{c.mesh}, {c.n_quad:,} quads to {c.angle:.0f}°: {c.n_step:,} steps in "
            f"{c.wall_seconds:.1f} s (set-up {c.set_up_seconds:.1f}, run {c.run_seconds:.1f}, "
            f"closing {c.closing_seconds:.1f}; CPU {c.cpu_seconds:.1f}), {c.n_split} splits, "
            f"{c.n_broken} cables broken, imbalance {100.0 * c.imbalance:.3f} %, memory "
            f"{c.memory_growth / 2**20:+.0f} MB over the run.",
            "",
        ]
    parts = sorted({p for c in r.cuts for p in c.parts}, key=lambda p: (p not in OF_THE_FILM, p))
    rows = [[part, *(shown(c.parts.get(part)) for c in r.cuts)] for part in parts]
    rows.append(["**all but the shells**", *(shown(c.all_but_shells) for c in r.cuts)])
    meshes = " | ".join(c.mesh for c in r.cuts)
    lines += [
        "By part, nanoseconds a quad and step; from an instrumented run of a third of the angle,"
        " the timers' cost subtracted, medians of three for M1, scaled to the bare run (by "
        + ", ".join(f"{c.profile_scale:.3f}" for c in r.cuts)
        + f"). All but {', '.join(OF_THE_FILM[:-1])} and {OF_THE_FILM[-1]} counts as *all but the"
        " shells*.",
        "",
        *table(f"part | {meshes}", rows),
        "![Parts of a step of the opening test](performance_profile.png)",
        "",
    ]
    absent = sorted({name for c in r.cuts for name in c.not_found})
    if absent:
        lines += [f"Not timed by themselves: {', '.join(f'`{name}`' for name in absent)}.", ""]
    return lines


def peers(r: Results) -> list[str]:
    ours = next((run for run in r.peers if run.program == OURS), None)
    if ours is None:
        return []
    rows = [
        [
            run.program,
            f"{run.n_step:,}",
            f"{run.step:.2e}",
            f"{run.cpu_ns:,.0f}",
            shown(run.cpu_ns / ours.cpu_ns),
            shown(run.cpu_seconds, ".2f"),
            shown(run.peak, ".4f"),
            shown(1e6 * run.peak_time),
        ]
        for run in r.peers
    ]
    missing = [f"- {program}: {why}" for program, why in r.missing_peers.items()]
    return [
        "## Other programs on the same disc",
        "",
        f"{ours.n_quad:,} quads, R = 10.2 mm, h = 0.074 mm, clamped, dead pressure 0.05 MPa as a"
        " step, no damping; CPU of one thread a quad and step, set-up left out; first peak of the"
        " middle. CalculiX expands its shells to solids and steps by their thickness.",
        "",
        *table(
            "program | steps | step, s | CPU, ns | ratio | CPU in all, s | peak, mm | at, µs", rows
        ),
        *missing,
        *([""] if missing else []),
    ]


def start(r: Results) -> list[str]:
    c = r.compilation
    if c is None:
        return []
    rows = [
        [name, shown(s.warmup_seconds), str(s.cache_misses), str(s.cache_hits)]
        for name, s in (("first, empty cache", c.cold), ("later", c.warm))
    ]
    return [
        "## Start",
        "",
        f"Import {c.import_seconds:.2f} s, of it Numba and NumPy {c.warm.numba_seconds:.2f} s.",
        "",
        *table("start | warm-up, s | kernels compiled | from the cache", rows),
    ]


def write(results: Results, folder: Path) -> None:
    """Write page and plots into a folder."""
    from benchmarks.plots import draw_profile, draw_scaling

    folder.mkdir(parents=True, exist_ok=True)
    parts = [targets, circumstances, steps, memory, cuts, peers, start]
    lines = ["# Performance", "", *(line for part in parts for line in part(results))]
    (folder / "performance.md").write_text("\n".join(lines).rstrip() + "\n")
    if results.steps:
        draw_scaling(results, folder / "performance_scaling.png")
    if results.cuts:
        draw_profile(results, folder / "performance_profile.png")


if __name__ == "__main__":
    file = Path(sys.argv[1])
    write(load(file), file.with_suffix(""))

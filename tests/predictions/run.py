"""The page of predictions: ``python tests/predictions/run.py``.

Runs what is not kept yet, and writes ``docs/predictions.md`` and a picture of each case. Figures of
runs are kept in a file, so that a run that was ended goes on; a run whose declaration changed runs
again.
"""

import argparse
import importlib
import json
import sys
import time
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

from prediction import Figure, Found, found

DOCS = Path(__file__).resolve().parents[2] / "docs"
CASES = (
    "converging_tears",
    "passing_cracks",
    "hyperbola",
    "wedge_in_steel",
    "blunt_bar",
)


def case_of(name):
    """Return the declaration of a case."""
    return importlib.import_module(name).PREDICTION


def one_run(name, run):
    """Run one; return what it gives, and its time [s]."""
    began = time.process_time()
    given = case_of(name).run(**case_of(name).runs[run].keys)
    return given, round(time.process_time() - began, 1)


def key_of(name, run):
    """Return the name under which a run is kept: it holds its keys."""
    return f"{name} {run} {json.dumps(case_of(name).runs[run].keys, sort_keys=True)}"


def gather(names, path, jobs):
    """Return what all runs gave, and their time [s], from the file as far as it goes."""
    kept = {}
    if path.exists():
        for line in path.read_text().splitlines():
            one = json.loads(line)
            kept[one["key"]] = one
    due = [(n, r) for n in names for r in case_of(n).runs if key_of(n, r) not in kept]
    with ProcessPoolExecutor(jobs) as pool, path.open("a") as file:
        futures = {pool.submit(one_run, *one): one for one in due}
        for future in as_completed(futures):
            name, run = futures[future]
            try:
                given, seconds = future.result()
            except Exception:
                pool.shutdown(wait=False, cancel_futures=True)
                raise
            one = {"key": key_of(name, run), "given": given, "seconds": seconds}
            kept[one["key"]] = one
            file.write(json.dumps(one) + "\n")
            file.flush()
            numbers = {k: round(v, 4) for k, v in given.items() if isinstance(v, float)}
            print(name, run, numbers, seconds, "s", file=sys.stderr, flush=True)
    results = {n: {r: kept[key_of(n, r)]["given"] for r in case_of(n).runs} for n in names}
    return results, sum(kept[key_of(n, r)]["seconds"] for n in names for r in case_of(n).runs)


def text(one: Found):
    """Return value and half-width, to two digits of that."""
    if not one.n:
        return "no result"
    if not one.half_width:
        return f"{one.value:.3g}, one run"
    n = max(0, 1 - int(f"{one.half_width:e}".partition("e")[2]))
    return f"{one.value:.{n}f} ± {one.half_width:.{n}f}"


def band(one: Figure):
    """Return the published band, if there is one."""
    return f"{one.low:.4g} to {one.high:.4g}" if one.low == one.low else "–"


def row(one: Found):
    """Return the row of a figure."""
    parts = ", ".join(f"{part} {size:.2g}" for part, size in one.parts.items())
    scatter = f"{one.scatter:.2g}" if one.scatter == one.scatter else "–"
    cells = (one.figure.name, one.figure.published, band(one.figure), text(one), parts)
    return f"| {' | '.join(cells)} | {scatter} | {one.n} | {one.verdict} |"


def section(name, results):
    """Return the section of a case."""
    case = case_of(name)
    rows = [row(found(case, figure, results)) for figure in case.figures]
    return SECTION.format(
        case=case, rows="\n".join(rows), name=name, caption=case.caption or case.title
    )


def page(results, seconds):
    """Return the text of the page."""
    every = [
        (name, found(case_of(name), figure, one))
        for name, one in results.items()
        for figure in case_of(name).figures
    ]
    short = []
    for name, one in every:
        title = case_of(name).title
        link = f"[{title}](#{title.lower().replace(' ', '-').replace(',', '')})"
        short.append(
            f"| {link} | {one.figure.name} | {band(one.figure)} | {text(one)} | {one.verdict} |"
        )
    return TEXT.format(
        n=sum(one.figure.low == one.figure.low for _, one in every),
        n_hit=sum(one.hits for _, one in every),
        short="\n".join(short),
        sections="\n".join(section(name, one) for name, one in results.items()),
        minutes=seconds / 60.0,
        runs=sum(len(one) for one in results.values()),
    )


def main():
    """Run what is not kept yet, and write page and pictures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cases", nargs="*", metavar="case", help="run these only; no page")
    parser.add_argument("--kept", type=Path, default=Path("predictions.jsonl"), help="runs so far")
    parser.add_argument("--jobs", type=int, default=2, help="runs at once")
    options = parser.parse_args()
    results, seconds = gather(options.cases or CASES, options.kept, options.jobs)
    for name, one in results.items():
        case_of(name).picture(one, DOCS / "img" / f"predicted_{name}.png")
        print(section(name, one))
    if not options.cases:
        (DOCS / "predictions.md").write_text(page(results, seconds), encoding="utf-8")


SECTION = """## {case.title}

**Published.** {case.source} How sure: {case.sure}

**Known beforehand.** {case.known}

**Our model.** {case.model}

| figure | published | band | ours | of which | single runs scatter by | runs | |
|---|---|---|---:|---|---:|---:|---|
{rows}

![{caption}](img/predicted_{name}.png)

{case.said}
"""

TEXT = """# Predictions of what others measured

This page sets what others have published beside what the library gives for it, with error bars,
hit or miss. No number of a model is taken from the result. `python tests/predictions/run.py` makes
the page. Each case is a file in `tests/predictions` and says which results were known before its
band was written down; `pytest -m slow tests/predictions` runs a short form of each.

**{n_hit} of {n} figures lie in the published band.**

| case | figure | published band | ours | |
|---|---|---|---:|---|
{short}

A value is the mean of the runs on the finest mesh. ± is 95 %. It holds three parts: the error of
the mesh, estimated from the next coarser one; what a slower run changes; and Student's interval
of the mean of runs that differ by chance only (one number of the model changed by a millionth).
Parts without runs are left out. *Hit* says that the value lies in the published band. What all
runs share, the law of the cables, friction and the shell theory, is in no error bar ([how bars
are made](howto/converge.md)).

{sections}
## Not here

- **Trouser tears of LDPE and PET** (Int. J. Fracture 2019,
  [10.1007/s10704-019-00389-3](https://doi.org/10.1007/s10704-019-00389-3)): left out, because no
  number of the paper was at hand, only its abstract and introduction: uneven bending of the legs
  dissipates a part that matters.
  Derived: a leg of breadth b that is bent evenly by F = G h/2 has at most B κ²/2 = F, B being its
  stiffness, so a strain of √(3 G/(E b)) at its surface, whatever its thickness; it yields only
  where b is below 3 E G/σ_y². That is 63 mm for `ldpe` of the [materials](materials.md) at 10 N/mm
  ([GentWang1996]), 10 mm for `pet` at 6 N/mm ([Millar2016]): legs of 25 mm may yield in LDPE, in
  PET only where they bend unevenly. That the library sets the legs' work apart is
  [verified](verification.md) (case P08), not predicted.
- **Wedges with shoulders** (Zheng and Wierzbicki 1996), half-angles of 40° and more (with the edge
  tilted by 10° the library refuses them), blunt wedges that push: no formula at hand, or not run.
- **Piercing and sharpness**: [how hard is it to pierce](howto/pierce.md).

All {runs} runs took {minutes:.0f} minutes of CPU time.
"""


if __name__ == "__main__":
    main()

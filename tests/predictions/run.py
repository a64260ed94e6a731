"""The page of predictions: ``python tests/predictions/run.py``.

Runs what is not kept yet, and writes ``docs/predictions.md`` and a picture of each case. Values of
runs are kept in a file, so that it continues after it was stopped; a run whose declaration changed
runs again.
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


def digits(one: Found):
    """Return how many digits after the point show two of the half-width."""
    return max(0, 1 - int(f"{one.half_width:e}".partition("e")[2]))


def text(one: Found):
    """Return value and half-width, to two digits of that."""
    if not one.n:
        return "no result"
    if not one.half_width:
        return f"{one.value:.3g}, one run"
    n = digits(one)
    return f"{one.value:.{n}f} ± {one.half_width:.{n}f}"


def difference(one: Found):
    """Return the difference from what is published, as precise as the value."""
    if not one.n or one.difference != one.difference:
        return "–"
    return f"{one.difference:+.{digits(one)}f}".replace("-", "−")


def band(one: Figure):
    """Return the band, if there is one."""
    return f"{one.low:.4g} to {one.high:.4g}" if one.low < one.high else "–"


def row(one: Found):
    """Return the row of a value in the table of the page."""
    cells = (one.figure.name, one.figure.published, band(one.figure), text(one), difference(one))
    return f"| {' | '.join(cells)} | {one.verdict} |"


def parts(one: Found):
    """Return the row of a value in the table of error bars of its case."""
    sizes = [f"{one.parts[part]:.2g}" if part in one.parts else "–" for part in PARTS]
    scatter = f"{one.scatter:.2g}" if one.scatter == one.scatter else "–"
    return f"| {one.figure.name} | {' | '.join(sizes)} | {scatter} | {one.n} |"


def section(name, values):
    """Return the section of a case."""
    case = case_of(name)
    rows = "\n".join(parts(one) for one in values if one.n)
    return SECTION.format(case=case, rows=rows, name=name, caption=case.caption or case.title)


def page(values, minutes, runs):
    """Return the text of the page from the values of each case by its name."""
    rows = []
    for name, some in values.items():
        title = case_of(name).title
        anchor = title.lower().replace(" ", "-").replace(",", "")
        rows += [f"| [**{title}**](#{anchor}) | | | | | |", *map(row, some)]
    every = [one for some in values.values() for one in some]
    return TEXT.format(
        n=sum(one.figure.low == one.figure.low for one in every),
        n_hit=sum(one.hits for one in every),
        rows="\n".join(rows),
        sections="\n".join(section(name, some) for name, some in values.items()),
        minutes=minutes,
        runs=runs,
    )


def main():
    """Run what is not kept yet, and write page and pictures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cases", nargs="*", metavar="case", help="run these only; no page")
    parser.add_argument("--kept", type=Path, default=Path("predictions.jsonl"), help="runs so far")
    parser.add_argument("--jobs", type=int, default=2, help="runs at once")
    options = parser.parse_args()
    results, seconds = gather(options.cases or CASES, options.kept, options.jobs)
    values = {
        name: [found(case_of(name), figure, one) for figure in case_of(name).figures]
        for name, one in results.items()
    }
    for name, one in results.items():
        case_of(name).picture(one, DOCS / "img" / f"predicted_{name}.png")
        print("\n".join(map(row, values[name])), section(name, values[name]), sep="\n\n")
    if not options.cases:
        text_of_page = page(values, seconds / 60.0, sum(map(len, results.values())))
        (DOCS / "predictions.md").write_text(text_of_page, encoding="utf-8")


PARTS = ("mesh", "speed", "scatter")

SECTION = """## {case.title}

**Published.** {case.source} {case.sure}

**Our model.** {case.model}

| parts of the error bar | mesh | speed | scatter | standard deviation of one run | runs |
|---|---:|---:|---:|---:|---:|
{rows}

![{caption}](img/predicted_{name}.png)

{case.said}
"""

TEXT = """# Predictions of published measurements

This page compares published measurements and theories with what the library predicts for them. No
number of a model is fitted to the result. In every case we knew the published value, and had seen
earlier runs of a similar model, before the band was fixed; so the predictions are not blind.

**{n_hit} of {n} values lie in the published band.**

| value | published | band | ours | difference | result |
|---|---|---|---:|---:|---|
{rows}

- *Band*: values that count as a hit. A single published value without a band must be met exactly.
- *Ours*: the mean of the runs on the finest mesh, with a 95 % error bar. The bar has three parts:
  the error of the mesh, estimated from the next coarser one; the change in a slower run; and
  Student's interval of the mean of repeated runs, which differ by a tiny change of the model
  (*scatter*). Parts without runs are left out ([how bars are made](howto/converge.md)). The law of
  the cables, friction and the shell theory are the same in all runs and in no error bar.
- *Difference*: ours less the published value, or less the middle of the band where several values
  are published.

`python tests/predictions/run.py` makes this page. Each case is a file in `tests/predictions`;
`pytest -m slow tests/predictions` runs a short form of each.

{sections}
## Not predicted here

- **Trouser tears of LDPE and PET** (Int. J. Fracture 2019,
  [10.1007/s10704-019-00389-3](https://doi.org/10.1007/s10704-019-00389-3)). We know only the
  abstract and the introduction, which give no number. Uneven bending of the legs dissipates a part
  that matters there. A leg of width b and bending stiffness B that F = G h/2 bends evenly has a
  curvature κ with B κ²/2 ≤ F. The strain at its surface is then at most √(3 G/(E b)), whatever the
  thickness. So it yields only where b is below 3 E G/σ_y². That is 63 mm for `ldpe` of the
  [materials](materials.md) at 10 N/mm ([GentWang1996]) and 10 mm for `pet` at 6 N/mm
  ([Millar2016]). Legs of 25 mm may yield in LDPE, in PET only where they bend unevenly. The library
  separates the work of the legs, which is [verified](verification.md) (case P08).
- **Wedges with shoulders** (Zheng and Wierzbicki 1996): we know no formula. Half-angles of 40° and
  more, and blunt wedges that push, have not been run. (With a cutting edge tilted by 10° the
  library refuses such angles.)
- **Piercing and sharpness**: [how hard is it to pierce](howto/pierce.md).

All {runs} runs took {minutes:.0f} minutes of CPU time.
"""


if __name__ == "__main__":
    main()

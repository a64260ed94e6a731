"""The page of predictions: ``python tests/predictions/run.py``.

Runs what is not kept yet, and writes ``docs/predictions.md`` and a picture of each case. Values of
runs are kept in a file, so that it continues after it was stopped; a run whose declaration changed
runs again. With names of cases, only these run, and the other cases keep their rows of the page.
"""

import argparse
import importlib
import json
import re
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
    "torn_flap",
    "blunt_bar",
    "wedge_in_steel",
    "data_sheet",
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
    """Return value and half-width, to two digits of that, or what is said in words."""
    if one.words:
        return one.words
    if not one.n:
        return "no result"
    if not one.half_width:
        return f"{one.value:.3g}, one run"
    n = digits(one)
    return f"{one.value:.{n}f} ± {one.half_width:.{n}f}"


def published(one: Figure):
    """Return what is published, with the band that counts as a hit, if there is one."""
    band = f" ({one.low:.4g} to {one.high:.4g})" if one.low < one.high else ""
    return one.published + band


def row(one: Found):
    """Return the row of a value in the table of the page."""
    return f"| {one.figure.name} | {published(one.figure)} | {text(one)} | {one.verdict} |"


def parts(one: Found):
    """Return the row of a value in the table of error bars."""
    sizes = [f"{one.parts[part]:.2g}" if part in one.parts else "–" for part in PARTS]
    scatter = f"{one.scatter:.2g}" if one.scatter == one.scatter else "–"
    return f"| {one.figure.name} | {' | '.join(sizes)} | {scatter} | {one.n} |"


def anchor(case):
    """Return the anchor of the section of a case."""
    return case.title.lower().replace(" ", "-").replace(",", "")


def kept_rows(page, case):
    """Return the rows of a case in both tables of the page, as they are."""
    lines, found = page.splitlines(), []
    for begins in (f"| [**{case.title}**]", f"| **{case.title}** |"):
        first = next((k + 1 for k, one in enumerate(lines) if one.startswith(begins)), None)
        if first is None:
            raise SystemExit(f"the page has no values of {case.title!r}: run this case, too")
        last = next(k for k in range(first, len(lines)) if not re.match(r"\| [^*\[]", lines[k]))
        found.append(lines[first:last])
    return found


def page(rows):
    """Return the text of the page from the rows of each case in both tables, by its name."""
    cases = {name: case_of(name) for name in rows}
    table, bars = [], []
    for name, (some, of_bars) in rows.items():
        table += [f"| [**{cases[name].title}**](#{anchor(cases[name])}) | | | |", *some]
        bars += [f"| **{cases[name].title}** | | | | | | |", *of_bars] if of_bars else []
    verdicts = [one.split(" | ")[-1] for one in table]
    text = TEXT.format(
        n=sum("hit" in one or "miss" in one for one in verdicts),
        n_hit=sum("hit" in one for one in verdicts),
        n_blind=sum(one.startswith("*blind") for one in verdicts),
        rows="\n".join(table),
        bars="\n".join(bars),
        sections="\n".join(
            SECTION.format(case=case, name=name, caption=case.caption or case.title)
            for name, case in cases.items()
        ),
        runs=sum(len(case.runs) for case in cases.values()),
    )
    return linked(text)


def linked(text):
    """Return a text whose citations are links to the references."""
    return re.sub(
        r"\[([A-Z]\w+(?:19|20)\d\d)\](?!\()",
        lambda key: f"[{key[1]}](references.md#{key[1].lower()})",
        text,
    )


def main():
    """Run what is not kept yet, and write page and pictures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cases", nargs="*", metavar="case", help="run these only")
    parser.add_argument("--kept", type=Path, default=Path("predictions.jsonl"), help="runs so far")
    parser.add_argument("--jobs", type=int, default=2, help="runs at once")
    options = parser.parse_args()
    results, seconds = gather(options.cases or CASES, options.kept, options.jobs)
    path, rows = DOCS / "predictions.md", {}
    before = path.read_text(encoding="utf-8")
    for name in CASES:
        case = case_of(name)
        if name not in results:
            rows[name] = kept_rows(before, case)
            continue
        values = [found(case, figure, results[name]) for figure in case.figures]
        rows[name] = list(map(row, values)), [parts(one) for one in values if one.parts]
        case.picture(results[name], DOCS / "img" / f"predicted_{name}.png")
        print("\n".join(rows[name][0]))
    path.write_text(page(rows), encoding="utf-8")
    print(f"{seconds / 60.0:.0f} minutes of CPU time", file=sys.stderr)


PARTS = ("mesh", "speed", "scatter", "guessed")

SECTION = """## {case.title}

**Published.** {case.source} {case.sure}

**Our model.** {case.model}

![{caption}](img/predicted_{name}.png)

{case.said}
"""

TEXT = """# Predictions of published measurements

This page compares published measurements and theories with what the library predicts for them. No
number of a model is fitted to the result.

**{n_hit} of {n} values are hits. {n_blind} values are blind and wait for the comparison.**

| value | published | ours | result |
|---|---|---:|---|
{rows}

- *Published*: in brackets, the values that count as a hit. A single value without brackets must be
  met exactly.
- *Ours*: the mean of the runs on the finest mesh, with its [error bar](#error-bars).
- *Hit* or *miss*: we knew the published value, and had seen runs of a similar model, before the
  band was fixed. *Blind*: the published value exists, and nobody who made the prediction has seen
  it. There the ± is a 90 % band.

`python tests/predictions/run.py` makes this page; with the names of cases, it runs these only. Each
case is a file in `tests/predictions`. `pytest -m slow tests/predictions` runs a short form of each.

{sections}
## Error bars

An error bar contains the true value of the model in 95 % of all cases. It has three parts: the
error of the mesh, estimated from the next coarser one; the change in a slower run; and the scatter
of repeated runs, which differ by a tiny change of the model. This is Student's interval of their
mean, or of the limit of a fitted line. Parts without runs are left out ([how bars are
made](howto/converge.md)). The law of the cables, friction and the shell theory are the same in all
runs and in no error bar. Only the bands of blind values contain what had to be *guessed*.

| value | mesh | speed | scatter | guessed | standard deviation of one run | runs |
|---|---:|---:|---:|---:|---:|---:|
{bars}

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

The page needs {runs} runs, one to two hours of CPU time.
"""


if __name__ == "__main__":
    main()

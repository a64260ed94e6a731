"""``fit``: fit keys of a model to measured curves.

Fit the keys of a model that have a range (8:16) to measured curves by least squares. Writes
OUT/fit.json, with 95 % confidence intervals, and with Matplotlib OUT/fit.png. Runs are kept: the
same command again repeats none, and continues an interrupted fit.

example: shellcut fit opening slow.csv fast.csv --for fast.csv motion.duration=3e-3 --set
plateau=6:24 --set opening_u=3.2:8 -o OUT
"""

from __future__ import annotations

from collections.abc import Sequence

from shellcut.study.curve_misfit import FitCurve
from shellcut.study.fit import Search, fit
from shellcut.view import can_draw

from .compare import parted
from .shared import (
    Arguments,
    Parser,
    add_engine_to,
    add_options,
    add_settings_to,
    keys_with_values,
    made_of,
    named,
    print_found,
)


def add_to(parser: Parser) -> None:
    """Add its arguments to the parser."""
    parser.add_argument("model", metavar="MODEL", help="a model file, or a name")
    parser.add_argument("measured", metavar="FILE", nargs="+", help="tables with measured curves")
    parser.add_argument("-o", "--out", metavar="OUT", type=named, required=True, help="folder")
    add_settings_to(parser, ", or give a key to fit a range LOW:HIGH")
    flags = {name: f"--{name.replace('_', '-')}" for name in ("keep_energy", "max_runs", "method")}
    add_options(parser, Search, **flags)
    parser.add_argument(
        "--x", metavar="NAME[=COLUMN]", default="", help="the coordinate, as for compare"
    )
    parser.add_argument(
        "--y",
        metavar="NAME[=COLUMN]",
        action="append",
        default=[],
        help="the quantity, as for compare; once for each file, or several times for one file",
    )
    parser.add_argument(
        "--for",
        nargs=2,
        metavar=("CURVE", "KEY=VALUE"),
        action="append",
        default=[],
        dest="of_curves",
        help="a key with another value in one experiment: CURVE is its file, or its number from 1 "
        "on; any number of times. Curves with the same keys share a run",
    )
    parser.add_argument("--units", help='units of the files\' columns, as "deg, N*cm"')
    add_engine_to(parser)


def run(arguments: Arguments) -> int:
    """Fit, print the result."""
    return print_found(
        arguments,
        lambda executor: fit(
            arguments.model,
            _curves(arguments),
            arguments.out,
            settings=keys_with_values(
                "--set", arguments.settings, str
            ),  # texts: ranges are read later
            search=made_of(arguments, Search),
            executor=executor,
        ),
        f"in {arguments.out}: fit.json" + (", fit.png" if can_draw() else ""),
    )


def _curves(arguments: Arguments) -> list[FitCurve]:
    """Return the curves: a file with several quantities, or files with one each."""
    files, names = arguments.measured, arguments.y or [""]
    if len(files) == 1:
        files = files * len(names)
    elif len(names) == 1:
        names = names * len(files)
    if len(files) != len(names):
        raise ValueError(
            f"--y must be given once, once for each file, or several times for one file, but there "
            f"are {len(names)} for {len(files)} files"
        )
    x, x_column = parted(arguments.x)
    settings = _settings_of_curves(files, arguments.of_curves)
    curves = []
    for file, name, own in zip(files, names, settings, strict=True):
        y, y_column = parted(name)
        curves.append(FitCurve(file, x, y, (x_column, y_column), arguments.units, own))
    return curves


def _settings_of_curves(
    files: Sequence[str], given: Sequence[Sequence[str]]
) -> list[dict[str, object]]:
    """Return the settings of each curve."""
    found: list[dict[str, object]] = [{} for _ in files]
    problems = []
    for curve, text in given:
        of = [k for k, file in enumerate(files) if curve in (file, str(k + 1))]
        if not of:
            known = ", ".join(dict.fromkeys(files))
            numbers = "1" if len(files) == 1 else f"1 to {len(files)}"
            problems.append(f"--for {curve}: must be one of the files {known}, or {numbers}")
        try:
            own = keys_with_values(f"--for {curve}", [text])
            for k in of:
                found[k] |= own
        except ValueError as problem:
            problems.append(str(problem))
    if problems:
        raise ValueError("\n".join(problems))
    return found

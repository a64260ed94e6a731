"""``report``: write an HTML report of a run, a study, a fit or a search.

Write one self-contained HTML file about a run: verdict, values, curves, pictures. An interrupted
run is reported up to its last record. The report of a study (the folder of shellcut sweep) has
table, curves, values over factors; that of shellcut fit and optimise has values, curves, runs.
"""

from __future__ import annotations

from pathlib import Path

from shellcut.report import report_run
from shellcut.study.fit_result import FIT
from shellcut.study.optimise import OPTIMUM
from shellcut.study.plan import RUNS, STUDY
from shellcut.study.report import report_found, report_study

from .compare import add_columns_to, compared
from .shared import Arguments, Parser, named


def add_to(parser: Parser) -> None:
    """Add its arguments to the parser."""
    parser.add_argument(
        "folder", metavar="OUT", type=named, help="result folder of the run, study, fit or search"
    )
    parser.add_argument(
        "-o", "--output", metavar="FILE", type=named, help="file to write [OUT/report.html]"
    )
    parser.add_argument(
        "--measured",
        metavar="FILE",
        help="text table with a measured curve, to show and compare with a run; the following "
        "options are those of shellcut compare",
    )
    add_columns_to(parser)


def run(arguments: Arguments) -> None:
    """Write the report and print its path."""
    path = _written(arguments)
    print(f"{path} ({path.stat().st_size / 1e6:.1f} MB)")


def _written(arguments: Arguments) -> Path:
    folder: Path = arguments.folder
    there = [name for name in (STUDY, FIT, OPTIMUM) if (folder / name).is_file()]
    if arguments.measured and there:
        raise ValueError(
            "a measured curve is compared with one run: give the folder of a run, "
            f"{folder / RUNS}/..."
        )
    if STUDY in there:
        return report_study(folder, arguments.output)
    if there:
        return report_found(folder / there[0], arguments.output)
    if (folder / RUNS).is_dir():
        raise FileNotFoundError(
            f"{folder} holds runs, but none of {STUDY}, {FIT}, {OPTIMUM}: the command that makes "
            "them has not ended; call it again to continue, or report one run: shellcut report "
            f"{folder / RUNS}/..."
        )
    found = compared(arguments, folder) if arguments.measured else None
    return report_run(folder, arguments.output, measured=found)

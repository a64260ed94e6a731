"""``report``: write an HTML report of a run or a study.

Write one self-contained HTML file about a run: verdict, figures, curves, pictures. An interrupted
run is reported up to its last record. Of a study (the folder of shellcut sweep): table, curves,
figures over factors.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from shellcut.report import report_run

from .compare import add_columns_to, compared
from .exit_code import DONE
from .shared_arguments import named


def add_to(parser: argparse.ArgumentParser) -> None:
    """Add its arguments to the parser."""
    parser.add_argument(
        "folder", metavar="OUT", type=named, help="result folder of the run or the study"
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


def run(arguments: argparse.Namespace) -> int:
    """Write the report and print its path."""
    path = _written(arguments)
    print(f"{path} ({path.stat().st_size / 1e6:.1f} MB)")
    return DONE


def _written(arguments: argparse.Namespace) -> Path:
    from shellcut.study.study_file import STUDY

    if (arguments.folder / STUDY).is_file():
        from shellcut.study.report import report_study

        if arguments.measured:
            raise ValueError(
                "a measured curve is compared with one run: give the folder of a run, "
                f"{arguments.folder / 'runs'}/..."
            )
        return report_study(arguments.folder, arguments.output)
    found = compared(arguments, arguments.folder) if arguments.measured else None
    return report_run(arguments.folder, arguments.output, measured=found)

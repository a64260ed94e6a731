"""``sweep``: run a model with many values: a study.

Run a model with many values of some keys, or the runs of a study file. A key with several values
(40,60,80), with files (caps/*.stl), or with a range (12:20, for --design sobol or lhs) is a factor.
tool.edge_inclination_deg,motion.pitch=40:12,60:20 is a factor of two keys whose values belong
together. Runs that are done are not repeated, interrupted runs continue. OUT/table.csv has a row
for each run.
"""

from __future__ import annotations

from shellcut.formats.errors import counted
from shellcut.model_file.key_index import with_values
from shellcut.study.engines import engine_of
from shellcut.study.factors import Design, factors_of
from shellcut.study.plan import FEW_FILES, Definition, Plan, is_study, read_study
from shellcut.study.study import done_before, run_study

from .shared import (
    DONE,
    FAILED,
    Arguments,
    Parser,
    add_engine_to,
    add_options,
    add_settings_to,
    engine_given,
    keys_with_values,
    made_of,
    named,
    refuse,
)

_DRY_SHOWN = 20  # runs of a plan that are printed


def add_to(parser: Parser) -> None:
    """Add its arguments to the parser."""
    parser.add_argument("model", metavar="MODEL", help="a model file, a name, or a study file")
    parser.add_argument("-o", "--out", metavar="OUT", type=named, help="folder of the study")
    add_settings_to(parser, ", or make it a factor by several values or a range")
    add_options(parser, Design, kind="--design", n="--n", seed="--seed")
    add_engine_to(parser)
    parser.add_argument("--dry-run", action="store_true", help="list the runs; run nothing")


def run(arguments: Arguments) -> int:
    """Plan, run, and say where the table is."""
    if arguments.out is None and not arguments.dry_run:
        return refuse("give a folder for the study: -o OUT")
    planned = _planned(arguments)
    if arguments.dry_run:
        done = done_before(planned, arguments.out) if arguments.out else {}
        print(f"{counted(len(planned.runs), 'run')}, {len(done)} of them done before")
        for entry in planned.runs[:_DRY_SHOWN]:
            print(f"{entry.number:>5}  {entry.key}  {with_values(entry.values)}")
        if len(planned.runs) > _DRY_SHOWN:
            print(f"... and {len(planned.runs) - _DRY_SHOWN} more")
        return DONE
    with engine_given(arguments) as executor:
        found = run_study(planned, arguments.out, engine_of(executor))
    print(f"in {arguments.out}: {found.table.name}; shellcut report {arguments.out} shows it")
    return DONE if found.count("done") == len(planned.runs) else FAILED


def _planned(arguments: Arguments) -> Plan:
    """Return the plan of a model with its factors, or of a study file."""
    given = keys_with_values(
        "--set", arguments.settings, str
    )  # texts: a study also reads several values, and ranges
    if is_study(arguments.model):
        study = read_study(arguments.model)
        several, _ = factors_of(given)
        if several or made_of(arguments, Design) != Design():
            raise ValueError(
                f"{arguments.model} is a study: its factors and its design are in the file; --set "
                "takes one value per key here"
            )
        return study.plan({**FEW_FILES, **factors_of(given)[1]})
    return Definition(arguments.model, given, FEW_FILES, made_of(arguments, Design)).plan()

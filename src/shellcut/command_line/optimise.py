"""``optimise``: seek the values of keys that make a result least, or largest.

Seek the values of some keys that make a result least, or largest, within limits on other results. A
key has a range (0.2:0.5), several values (3,4,5) or files (caps/*.stl). The first run is the model
as given, Optuna proposes the others. A run that its verdict distrusts is not the best. Writes
OUT/optimum.json, and with Matplotlib OUT/optimum.png. Runs are kept: the same command again repeats
none, and continues an interrupted search.

example: shellcut optimise opening --set mesh=quick --set tool.half_thickness=0.2:0.5 --minimise
torque_peak --subject-to 'n_loose == 1' -o OUT
"""

from __future__ import annotations

from shellcut.study.optimise import OPTIMUM, optimise

from .shared import (
    Arguments,
    Parser,
    add_engine_to,
    add_settings_to,
    keys_with_values,
    named,
    print_found,
)


def add_to(parser: Parser) -> None:
    """Add its arguments to the parser."""
    parser.add_argument("model", metavar="MODEL", help="a model file, or a name")
    parser.add_argument("-o", "--out", metavar="OUT", type=named, required=True, help="folder")
    add_settings_to(parser, ", or give a key to seek a range LOW:HIGH, or several values")
    aim = parser.add_mutually_exclusive_group(required=True)
    for word in ("minimise", "maximise"):
        aim.add_argument(f"--{word}", metavar="VALUE", default="", help="name in summary.json")
    parser.add_argument(
        "--subject-to",
        metavar="LIMIT",
        action="append",
        default=[],
        help="VALUE <= NUMBER, or with >= or ==; any number of times",
    )
    parser.add_argument(
        "--confirm",
        metavar="KEY=VALUE",
        action="append",
        help="repeat the model as given, the best run and the second best with this key, as "
        "mesh=M1, instead of on a finer film; none: no repeat",
    )
    parser.add_argument(
        "--max-runs", metavar="N", type=int, default=60, help="largest number of runs [60]"
    )
    parser.add_argument(
        "--allow-doubts",
        action="store_true",
        help="accept as the best a run that its verdict distrusts",
    )
    add_engine_to(parser)


def run(arguments: Arguments) -> int:
    """Search, print the best values."""
    confirm, given = None, arguments.confirm  # by a finer film
    if given is not None:
        confirm = {} if given == ["none"] else keys_with_values("--confirm", given)
    return print_found(
        arguments,
        lambda executor: optimise(
            arguments.model,
            arguments.out,
            minimise=arguments.minimise,
            maximise=arguments.maximise,
            subject_to=arguments.subject_to,
            settings=keys_with_values(
                "--set", arguments.settings, str
            ),  # texts: lists and ranges are read later
            confirm=confirm,
            max_runs=arguments.max_runs,
            allow_doubts=arguments.allow_doubts,
            executor=executor,
        ),
        f"in {arguments.out}: {OPTIMUM}",
        lambda found: found.best is not None,
    )

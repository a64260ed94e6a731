"""``tensile``: modulus, yield, strength, hardening and a cohesive law from tensile tests.

Evaluate tensile tests: modulus, yield, strength, strain at break, hardening curve, scatter, and a
proposed cohesive law. With -o write OUT/tensile.json, for each direction hardening_MD.csv,
material_MD.toml and law_MD.toml (hardening.csv, ... where none is named), and with Matplotlib
tensile.png.

example: shellcut tensile MD=md_1.csv MD=md_2.csv CD=cd_1.csv --gauge-length 50 -o film
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from shellcut.model_file.key import keys_of
from shellcut.tensile import evaluate_tensile
from shellcut.tensile.evaluation import PICTURE
from shellcut.tensile.specimen import SpecimenSize

from .exit_code import DONE, refuse
from .shared_arguments import named

_LENGTHS = keys_of(SpecimenSize)


def add_to(parser: argparse.ArgumentParser) -> None:
    """Add its arguments to the parser."""
    parser.add_argument(
        "files",
        metavar="[DIRECTION=]FILE",
        nargs="+",
        help="text tables of strain and stress, or extension and force",
    )
    parser.add_argument(
        "--columns",
        metavar="X,Y,...",
        help="columns of strain and stress in all files, by heading or number from 1, as "
        "'Strain, Stress' or '2,4'; where a heading has a comma, separated by semicolons; by "
        "default those whose names and units agree",
    )
    parser.add_argument(
        "--units",
        help="units of these columns, or of strain and stress, as 'mm, N'; by default those of "
        "the headings",
    )
    for name, key in _LENGTHS.items():
        flag = f"--{name.replace('_', '-')}"
        parser.add_argument(
            flag, metavar="MM", help=f"of the specimens, as 50 or '50 mm': {key.option.text}"
        )
    parser.add_argument(
        "--offset", metavar="%", default="0.2", help="plastic strain at yield, in per cent"
    )
    parser.add_argument("-o", "--out", metavar="OUT", type=named, help="folder for the results")


def run(arguments: argparse.Namespace) -> int:
    """Evaluate, print a table, write the files."""
    lengths, problems = {}, []
    for name, key in _LENGTHS.items():
        given = getattr(arguments, name)
        try:
            lengths[name] = None if given is None else key.read(given)
        except ValueError as problem:
            problems.append(f"--{name.replace('_', '-')} {problem}")
    try:
        offset = 0.01 * float(arguments.offset.removesuffix("%"))
    except ValueError:
        problems.append(f"--offset must be a number of per cent, got {arguments.offset!r}")
    if problems:
        return refuse("\n".join(problems))
    found = evaluate_tensile(
        _by_direction(arguments.files),
        offset=offset,
        columns=arguments.columns,
        units=arguments.units,
        **lengths,
    )
    print(found)
    if arguments.out is None:
        return DONE
    written = found.write(arguments.out)
    try:
        written.append(found.plot(arguments.out / PICTURE))
    except ImportError as missing:
        print(f"no picture: {missing}", file=sys.stderr)
    print("written: " + ", ".join(map(str, written)))
    return DONE


def _by_direction(files: list[str]) -> dict[str, list[str]]:
    # a file may have "=" in its name: the part before it is a direction only if no such file is
    groups: dict[str, list[str]] = {}
    for text in files:
        direction, sign, path = text.partition("=")
        if not sign or Path(text).exists() or "/" in direction:
            direction, path = "", text
        groups.setdefault(direction, []).append(path)
    return groups

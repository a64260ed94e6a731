"""``tensile``: modulus, yield stress, strength and hardening table of a tensile test.

Evaluate one specimen of a tensile test. With -o write OUT/material.toml, a section for a model
file, and with Matplotlib OUT/tensile.png.

example: shellcut tensile md.csv --columns 2 3 --units % MPa -o film
"""

from __future__ import annotations

import sys
from pathlib import Path

from shellcut.files.file_list import claim
from shellcut.files.whole_file import write_text
from shellcut.formats.errors import naming
from shellcut.formats.number_table import read_number_table
from shellcut.tensile import evaluate_tensile
from shellcut.unit import conversion

from .shared import Arguments, Parser, named


def add_to(parser: Parser) -> None:
    """Add its arguments to the parser."""
    parser.add_argument("file", metavar="FILE", help="text table of one specimen")
    for name, what in (("--columns", "heading, or number from 1,"), ("--units", "unit")):
        text = f"{what} of strain (or extension) and of stress (or force)"
        parser.add_argument(name, metavar=("X", "Y"), nargs=2, required=True, help=text)
    for name, what, unit in (
        ("--gauge-length", "length over which the extension was measured", "MM"),
        ("--section", "width times thickness of the specimen, if Y is a force", "MM2"),
    ):
        parser.add_argument(name, metavar=unit, type=float, help=what)
    parser.add_argument(
        "--offset", metavar="%", type=float, default=0.2, help="plastic strain at yield [0.2]"
    )
    parser.add_argument("-o", "--out", metavar="OUT", type=named, help="folder for the results")


def run(arguments: Arguments) -> None:
    """Evaluate, print the values, write the files."""
    table = read_number_table(arguments.file)
    kinds = "mm" if arguments.gauge_length else "-", "N" if arguments.section else "MPa"
    factors = [conversion(unit, kind) for unit, kind in zip(arguments.units, kinds, strict=True)]
    with naming(arguments.file):
        x, y = table.numbers([table.column(column) for column in arguments.columns]).T
        test = evaluate_tensile(
            x * factors[0],
            y * factors[1],
            gauge_length=arguments.gauge_length,
            section=arguments.section,
            offset=0.01 * arguments.offset,
        )
    print(test)
    if arguments.out is None:
        return
    material, picture = (Path(arguments.out) / name for name in ("material.toml", "tensile.png"))
    claim(arguments.out, [material.name, picture.name], [arguments.file])
    write_text(material, test.section())
    try:
        print(f"written: {material}, {test.plot(picture)}")
    except ImportError as missing:
        print(f"written: {material}; no picture: {missing}", file=sys.stderr)

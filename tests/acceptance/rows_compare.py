"""Rows of the comparison with a measured curve; sweep and fit are to come."""

from __future__ import annotations

import json

from row import Rows, expect
from user import User

ROWS = Rows()


@ROWS.add(
    "12-13",
    "shellcut compare out measured.csv: semicolons, decimal commas, N*cm",
    seconds=20,
    limit="figures of a known curve in the JSON within 1e-5, a picture",
    needs=("out",),
)
def compare(user: User) -> str:
    known = user.inside("write_measured.py", str(user.out), str(user.folder / "measured.csv"))
    columns = ["--x", "angle=Winkel", "--y", "torque=Drehmoment", "--units", "deg, N*cm"]
    done = user.shellcut("compare", "out", "measured.csv", *columns)
    expect(done.code == 0, f"exit code {done.code}:\n{done.said}")
    figures = json.loads((user.out / "comparison.json").read_text(encoding="utf-8"))["figures"]
    for name, value in known.items():
        got = figures[name]["value"]
        # The file holds six digits.
        expect(abs(got - value) <= 1e-5 * abs(value), f"{name} must be {value}, got {got}")
    expect((user.out / "comparison.png").stat().st_size > 10_000, "no picture")
    rms = figures["rms"]
    return (
        f"RMS {rms['value']:.2f} {rms['unit']}, peak error {figures['peak_error']['value']:+.1%}, "
        f"work error {figures['work_error']['value']:+.1%}: as known"
    )


@ROWS.add("13-14", "shellcut sweep", seconds=0)
def sweep(user: User) -> str:
    raise NotImplementedError


@ROWS.add("14-15", "shellcut fit", seconds=0)
def fit(user: User) -> str:
    raise NotImplementedError

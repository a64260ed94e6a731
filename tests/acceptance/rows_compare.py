"""Rows of the comparison with measured curves, of many runs, and of a fit."""

from __future__ import annotations

import csv
import json

from row import Rows, expect, expect_words
from user import User

ROWS = Rows()

STUDIED = (
    "opening",
    *("--set", "mesh=quick", "--set", "motion.angle_deg=30", "--set", "duration=2e-3"),
)
"""An opening that ends at 30 deg, some seconds of one core."""


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


@ROWS.add(
    "13-14",
    "shellcut sweep: two plateaus of the law; the same call again; shellcut report",
    seconds=120,
    limit="exit code 0; a row each, the stronger law takes more work; the same bytes, nothing run",
    needs=("out",),
)
def sweep(user: User) -> str:
    asked = ("sweep", *STUDIED, "--set", "cohesive.plateau=14,18", "-o", "study")
    done = user.shellcut(*asked)
    expect(done.code == 0, f"exit code {done.code}:\n{done.said}")
    table = user.folder / "study" / "table.csv"
    with table.open(encoding="utf-8-sig", newline="") as lines:
        rows = list(csv.DictReader(lines))
    expect([row["status"] for row in rows] == ["done", "done"], f"rows {rows}")
    weak, strong = (float(row["tool_work_Nmm"]) for row in rows)
    # Nearly all of the work is the cables', which grows with the plateau.
    expect(1.1 < strong / weak < 18 / 14 + 0.05, f"works {weak}, {strong} N*mm")
    before = table.read_bytes()
    again = user.shellcut(*asked)
    expect(again.code == 0, f"exit code {again.code}:\n{again.said}")
    expect_words(again.said, "2 of them done before")
    expect(table.read_bytes() == before, "the second call changed table.csv")
    told = user.shellcut("report", "study")
    expect(told.code == 0, f"exit code {told.code}:\n{told.said}")
    expect((user.folder / "study" / "report.html").stat().st_size > 10_000, "no report")
    return f"{weak:.1f} and {strong:.1f} N*mm; again in {again.seconds:.1f} s"


@ROWS.add(
    "14-15",
    "shellcut fit: the plateau of a known curve",
    seconds=120,
    limit="exit code 0; 14 MPa within 1 %, a picture",
    needs=("out",),
)
def fit(user: User) -> str:
    curve = user.folder / "known.csv"
    known = ("--set", "cohesive.plateau=14", "--no-pictures", "-o", "known")
    measured = user.shellcut("run", *STUDIED, *known)
    expect(measured.code == 0, f"exit code {measured.code}:\n{measured.said}")
    user.inside("write_curve.py", "known", str(curve))
    done = user.shellcut("fit", *STUDIED, str(curve), "--free", "cohesive.plateau", "-o", "fitted")
    expect(done.code == 0, f"exit code {done.code}:\n{done.said}")
    fitted = json.loads((user.folder / "fitted" / "fit.json").read_text(encoding="utf-8"))
    (plateau,) = fitted["values"]
    expect(abs(plateau["value"] / 14 - 1) < 0.01, f"must be 14 MPa: {plateau}")
    expect((user.folder / "fitted" / "fit.png").stat().st_size > 10_000, "no picture")
    return f"{plateau['value']:.3f} MPa from {plateau['start']:g} MPa in {fitted['n_run']} runs"

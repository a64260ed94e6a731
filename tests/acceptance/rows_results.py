"""Rows of the results: read by shellcut and by VTK, pictures, report."""

from __future__ import annotations

import re

from row import Rows, expect, expect_words
from rows_install import hide_rendering
from user import User

ROWS = Rows()


@ROWS.add(
    "7-8",
    "shellcut.read in Python: history, frame, plot_torque",
    seconds=20,
    limit="works without pandas, which to_pandas asks for",
    needs=("out",),
)
def read_results(user: User) -> str:
    found = user.inside("read_results.py", str(user.out))
    expect("pip install pandas" in found["without_pandas"], found["without_pandas"])
    return (
        f"peak {found['peak']:.1f} {found['unit']}, {found['n_frame']} frames, "
        f"crack {found['crack']:.1f} mm"
    )


@ROWS.add(
    "7", "shellcut report out", seconds=30, limit="one file, nothing from the net", needs=("out",)
)
def report(user: User) -> str:
    done = user.shellcut("report", "out")
    expect(done.code == 0, f"exit code {done.code}:\n{done.said}")
    (page,) = user.out.glob("*.html")
    text = page.read_text(encoding="utf-8")
    # Links to the files beside it are no part of the page.
    fetched = re.findall(r"src=\"(?!data:)[^\"]*\"|(?:https?:)?//[\w.]+/[\w./]*\.(?:js|css)", text)
    fetched += re.findall(r"<link[^>]*href=\"(?!data:)[^\"]*\"|@import|url\((?!data:|#)", text)
    expect(not fetched, f"fetched from elsewhere: {fetched[:3]}")
    return f"{page.name}, {len(text) / 1e6:.1f} MB"


@ROWS.add(
    "7-8",
    "the same with pandas; VTK, PyVista and pandas installed",
    seconds=240,
    limit="the same numbers as columns",
    needs=("out",),
)
def with_pandas(user: User) -> str:
    installed = user.viewer.seconds
    found = user.inside("read_results.py", str(user.out))
    expect(found["rows"] == found["rows_pandas"], f"{found}")
    return f"{found['rows']} rows, {installed:.0f} s of it pip"


@ROWS.add(
    "6-7",
    "VTK reads opening.vtkhdf frame by frame",
    seconds=60,
    limit="points, cells and parts as simulated, no nan, VTK >= 9.3",
    needs=("out", "viewer"),
)
def frames_by_vtk(user: User) -> str:
    found = user.inside("frames_by_vtk.py", str(user.out))
    return (
        f"VTK {found['vtk']}: {found['n_frame']} frames and {found['n_back']} jumps back, "
        f"{found['n_array']} arrays, points within {found['points']:.0e} mm, "
        f"crack opens by {found['opened']:.2f} mm"
    )


@ROWS.add(
    "2",
    "shellcut doctor, drawing made impossible to VTK",
    seconds=60,
    limit="exit code 0, says that Matplotlib draws",
    needs=("viewer",),
)
def doctor_without_drawing(user: User) -> str:
    done = user.shellcut("doctor", **hide_rendering(user))
    expect(done.code == 0, f"exit code {done.code}:\n{done.said}")
    expect_words(done.said, "by Matplotlib")
    (line,) = (line for line in done.said.splitlines() if "rendering" in line)
    return " ".join(line.split())

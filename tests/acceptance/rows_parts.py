"""Rows of the user's own model: another tooth, mistakes in the file, own cap and own disc."""

from __future__ import annotations

import hashlib
import json
import re

from row import Rows, expect, expect_words
from user import User

ROWS = Rows()

_OWN = """\
model = "opening"

[membrane]
file = "disc.msh"
clamp = "clamped"

[tool]
stl = "cap.stl"
axis = "z"

[motion]
angle_deg = 10
duration = "0.7 ms"
"""


@ROWS.add(
    "9-10",
    "another tooth: teeth = 6, then shellcut preview",
    seconds=30,
    limit="a picture of film, tool and edges; nothing is run",
    needs=("environment",),
)
def another_tooth(user: User) -> str:
    model, picture = user.folder / "tooth.toml", user.folder / "tooth.png"
    done = user.shellcut("run", "opening", "--write-model", model.name)
    expect(done.code == 0, done.said)
    text = model.read_text(encoding="utf-8")
    # As a user edits: other numbers in the lines that are there, and one line more.
    for old, new in (
        ("teeth = 4", "teeth = 6\nheight = 5"),
        ("wedge_half_angle_deg = 12", "wedge_half_angle_deg = 15"),
        ('mesh = "M1"', 'mesh = "quick"'),
    ):
        expect(old in text, f"{old!r} is not in the model that is written to be edited")
        text = text.replace(old, new)
    model.write_text(text, encoding="utf-8")
    before = set(user.folder.iterdir())
    done = user.shellcut("preview", model.name, "-o", picture.name)
    expect(done.code == 0, f"exit code {done.code}:\n{done.said}")
    expect_words(done.said, "612 quads", "6 cutting edges", "72 nodes held")
    expect(picture.stat().st_size > 20_000, "the picture is empty")
    more = {path.name for path in set(user.folder.iterdir()) - before}
    expect(more == {picture.name}, f"only the picture was to be written, got {more}")
    return f"6 cutting edges, picture of {picture.stat().st_size / 1e3:.0f} kB"


@ROWS.add(
    "9-10",
    "mistakes in the model file",
    seconds=10,
    limit="exit code 2; all at once, with line and nearest name",
    needs=("environment",),
)
def mistakes(user: User) -> str:
    model = user.folder / "wrong.toml"
    model.write_text(
        'model = "opening"\n'
        "[tool]\n"
        "teehs = 6\n"
        'radius = "3 MPa"\n'
        "[cohesive]\n"
        "strength = 18\n"
        "plateau = 30\n"
        "[motoin]\n"
        "angle_deg = 95\n",
        encoding="utf-8",
    )
    done = user.shellcut("run", model.name, "-o", "wrong")
    expect(done.code == 2, f"exit code {done.code}:\n{done.said}")
    for line, words in (
        (3, "unknown key [tool].teehs; did you mean teeth?"),
        (4, "[tool].radius must be a number in mm"),
        (7, "[cohesive]: the law must decrease"),
        (8, "did you mean"),
    ):
        lines = [said for said in done.said.splitlines() if f"{model.name}:{line}: " in said]
        told = any(words in said for said in lines)
        expect(told, f"line {line} and {words!r} expected:\n{done.said}")
    expect("Traceback" not in done.said, done.said)
    expect(not (user.folder / "wrong").exists(), "nothing may be written")
    return "4 mistakes told in one go"


@ROWS.add(
    "10-12",
    "own cap.stl, inside out, and own disc as .msh, .inp and .k: shellcut preview",
    seconds=60,
    limit="says units, turned normals, 4 edges with length, worst quads and what they cost",
    needs=("parts",),
)
def own_parts(user: User) -> str:
    (user.parts / "own.toml").write_text(_OWN, encoding="utf-8")
    reports = []
    for name in ("disc.msh", "disc.inp", "disc.k"):
        path = f"membrane.file={user.parts / name}"
        picture = f"{name}.png"
        done = user.shellcut("preview", "parts/own.toml", "--set", path, "-o", picture)
        expect(done.code == 0, f"{name}: exit code {done.code}:\n{done.said}")
        expect_words(
            done.said,
            f"{name}: no unit given: taken as mm, the film is 20.4 mm across",
            "cap.stl: no unit given: taken as mm",
            "4 of 4 bodies were inside out and are turned",
            "4 cutting edges found by angle, 23.09 mm in all",
        )
        edges = re.findall(r"chain \d of body \d: .* 5\.773 mm", done.said)
        expect(len(edges) == 4, f"4 edges of 5.773 mm each, got:\n{done.said}")
        steps = re.search(
            r"(\S+) s is stable for the median quad alone,\n"
            r" +(\S+) s for the worst quad alone",
            done.said,
        )
        expect(steps, f"what the worst quads cost was not said:\n{done.said}")
        cost = f"{float(steps[2]) / float(steps[1]):.2f}"
        worst = re.findall(r"quad +\d+ at \(.*\) mm: step \S+ s, [\d.]+ of the median", done.said)
        expect(len(worst) == 10, f"the ten worst quads with their place, got:\n{done.said}")
        reports.append((re.search(r"film .* held", done.said)[0], cost))
    n_quad = re.search(r"(\d+) quads", reports[0][0])[1]
    expect(len(set(reports)) == 1, f"the three formats must give one film, got {reports}")
    return f"{n_quad} quads from each; the worst leaves {reports[0][1]} of the step"


@ROWS.add(
    "10-12",
    "own parts: the run",
    seconds=60,
    limit="exit code 0, path put into the mesh, |balance| <= 1 %",
    needs=("parts",),
)
def own_run(user: User) -> str:
    (user.parts / "own.toml").write_text(_OWN, encoding="utf-8")
    done = user.shellcut("run", "parts/own.toml", "-o", "own", "--no-pictures")
    expect(done.code == 0, f"exit code {done.code}:\n{done.said}")
    expect_words(done.said, "4 of 4 bodies were inside out", "path of")
    balances = re.findall(r"balance ([+-][\d.]+) %", done.said)
    expect(len(balances) >= 20, f"a line every 5 % must tell the balance, got {len(balances)}")
    summary = json.loads((user.folder / "own/summary.json").read_text(encoding="utf-8"))
    balance = summary["imbalance_rel"]
    expect(balance <= 0.01, f"the balance must close within 1 % of the work, got {balance:.2%}")
    used = (user.folder / "own/used.toml").read_text(encoding="utf-8")
    for name in ("cap.stl", "disc.msh"):
        digest = hashlib.sha256((user.parts / name).read_bytes()).hexdigest()
        expect(digest in used, f"used.toml must hold the digest of {name}")
    return f"balance {balance:.3%}, digests of both files in used.toml"


@ROWS.add(
    "10-12",
    "own parts: what cannot be right",
    seconds=30,
    limit="exit code 2; the names that are there; asks for the unit where it may be several",
    needs=("parts",),
)
def refused_parts(user: User) -> str:
    (user.parts / "own.toml").write_text(_OWN, encoding="utf-8")
    small = f"membrane.file={user.parts / 'decimetres.inp'}"
    for settings, words in (
        (["clamp=rim"], ["one of those present (clamped)", "got 'rim'"]),
        ([small], ["the unit must be given", "0.204 units across", "um, mm, cm, m, inch, mil"]),
        ([f"tool.stl={user.folder / 'cup.stl'}"], ["cup.stl"]),
    ):
        set_them = [word for setting in settings for word in ("--set", setting)]
        done = user.shellcut("run", "parts/own.toml", *set_them, "-o", "refused")
        expect(done.code == 2, f"{settings}: exit code {done.code}:\n{done.said}")
        expect_words(done.said, *words)
        expect("Traceback" not in done.said, done.said)
    expect(not (user.folder / "refused").exists(), "nothing may be written")
    done = user.shellcut(
        "preview", "parts/own.toml", "--set", small, "--set", "membrane.unit=100.0", "-o", "dm.png"
    )
    expect(done.code == 0, f"with the unit given: exit code {done.code}:\n{done.said}")
    return "wrong group, unit that may be several, missing file"

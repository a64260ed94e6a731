"""Slips of a first model of one's own: each message says what, where, and how to mend it.

A doubt never refuses a model that may be right; what it proposes has been tried, and is tried here
again.
"""

import re
from pathlib import Path

import numpy as np
import pytest

from shellcut import ModelFileError, read_model
from shellcut.command_line import main
from shellcut.formats.length_unit import unit_in_mm
from shellcut.mesh.structured import opening_disc
from shellcut.study.factors import factor

LAMINATE = """model = "opening"
[[material.layers]]
preset = "ldpe"
thickness = "30 um"
[[material.layers]]
preset = "aluminium_foil"
[[loads]]
value = 0.001
"""


def written(folder, text):
    path = folder / "mine.toml"
    path.write_text(text)
    return str(path)


def disc_in(folder, *, scale=1.0, at=(0.0, 0.0, 0.0), axes=(0, 1, 2)):
    """Write the quick disc at a place, its coordinates in another order and unit."""
    mesh = opening_disc("quick")
    nodes = scale * (mesh.nodes[:, list(axes)] + np.array(at))
    lines = ["*NODE", *(f"{k + 1}, {x}, {y}, {z}" for k, (x, y, z) in enumerate(nodes.tolist()))]
    lines += ["*ELEMENT, TYPE=S4R"]
    lines += [f"{k + 1}, {', '.join(str(n + 1) for n in q)}" for k, q in enumerate(mesh.quads)]
    lines += ["*NSET, NSET=rim", *(f"{n + 1}," for n in mesh.node_set("rim"))]
    path = folder / "disc.inp"
    path.write_text("\n".join(lines) + "\n")
    return {"membrane.file": str(path), "membrane.unit": "mm"}


POINT = "the decimal sign is a point"
OPENING = {
    "comma in --set": ({"thickness": "0,074"}, "[material].thickness", POINT),
    "comma and unit": ({"young": "1,7 GPa"}, "[material].young", POINT),
    "thousands": ({"young": "1,678 MPa"}, "[material].young", "thousands have none"),
    "comma in a vector": ({"tool.shift": [0, 5, 0, 0]}, "must be an array of 3 numbers", POINT),
    "no layers": ({"layers.0.thickness": 1}, "has no table 0", "write it in the file"),
    "place in a vector": ({"tool.shift[2]": -1}, "tool.shift is set as a whole", "=..."),
    "edges of teeth": ({"tool.edges": "blunt"}, "[tool].edges must be one of", '"none"'),
    "no length": ({"membrane.shift": [0, 0, "3 s"]}, "must be a number in mm", "which is in s"),
}
OF_LAYERS = {
    "no such layer": ({"layers[2].thickness": 0.02}, "material.layers.2", "has 2, from 0 on"),
    "no place": ({"layers.thickness": 1}, "several tables", "material.layers.0.thickness"),
    "from the end": ({"layers[-1].thickness": 1}, "from 0 on", "layers.0"),
    "no such load": ({"loads[1].value": 2}, "loads.1.value", "the file has 1,"),
    "unit": ({"layers[0].thickness": "3 kg"}, "[material.layers.0].thickness must", "N s^2/mm"),
    "key": ({"layers.1.thicknes": 1}, "[material.layers.1]", "thickness?"),
}
MATERIAL = "model = 'opening'\n[material]\n"
IN_FILES = {
    "comma in a file": ("thickness = 0,074\n", "thickness in line 3; write 0.074"),
    "no quotes": ("thickness = 30 um  # PE\n", 'thickness in line 3; write "30 um"'),
}
READ = {
    **{name: ("opening", *row) for name, row in OPENING.items()},
    **{name: (LAMINATE, *row) for name, row in OF_LAYERS.items()},
    **{k: (MATERIAL + text, {}, "mine.toml:3: ", mend) for k, (text, mend) in IN_FILES.items()},
}


@pytest.mark.parametrize(("model", "keys", "where", "mend"), READ.values(), ids=READ)
def test_what_cannot_be_read_is_told_with_how_to_write_it(tmp_path, model, keys, where, mend):
    source = written(tmp_path, model) if "\n" in model else model
    with pytest.raises(ModelFileError) as refused:
        read_model(source, keys)
    assert where in str(refused.value)
    assert mend in str(refused.value)


@pytest.mark.parametrize("given", ["0,05:0,08", "1,5 mm : 2,5 mm", "0,05"])
def test_a_decimal_comma_is_no_list_of_values(given):
    with pytest.raises(ValueError, match=f"thickness: the decimal sign is a point.* got {given}"):
        factor("thickness", given)


@pytest.mark.parametrize("given", ["3,4", "0.05,0.08", "caps/a1,02.stl", "M1,quick", "01,02"])
def test_a_list_with_commas_stays_a_list(given):
    assert len(factor("key", given).values) == 2


def doubts(model, keys):
    check = read_model(model, keys).build().check
    check.enforce()  # none of them refuses
    return "\n".join(map(str, check.findings))


AWAY = """model = "free"
[membrane]
mesh = "quick"
clamp = "rim"
[tool]
teeth = 4
[motion]
direction = [0, 0, 1]
speed = 2000
duration = 1e-3
"""


def test_a_motion_away_from_the_film_is_told(tmp_path):
    said = doubts("opening", {"mesh": "quick", "motion.pitch": -12})
    assert "turn the sign of the pitch (motion.pitch = 12 mm): then 4 of 4" in said
    said = doubts(written(tmp_path, AWAY), {})
    assert "reverse the motion (motion.direction = [0, 0, -1]): then 4 of 4" in said


@pytest.mark.parametrize(
    ("at", "wanted", "by_the_tool"),
    [
        ((30.0, 0.0, 0.0), [-30.0, 0.0, 0.0], False),
        ((0.0, 0.0, -20.0), [0.0, 0.0, 20.01], True),
        ((0.0, 0.0, 20.0), [0.0, 0.0, -19.99], True),
        ((60.0, 5.0, -20.0), [-60.0, -5.0, 20.01], False),
    ],
    ids=["beside", "below", "above", "below and beside"],
)
def test_a_film_that_the_edges_miss_is_told_with_the_shift_that_mends_it(
    tmp_path, at, wanted, by_the_tool
):
    keys = disc_in(tmp_path, at=at)
    said = doubts("opening", keys)
    assert ("to tool.shift" in said) == by_the_tool
    shift = [float(x) for x in re.search(r"add \[(.*?)\] mm to membrane.shift", said)[1].split(",")]
    np.testing.assert_allclose(shift, wanted, atol=0.011)
    mended = doubts("opening", {**keys, "membrane.shift": shift})
    assert "membrane.shift" not in mended
    assert "never" not in mended


def test_a_blade_above_or_beside_its_strip_is_told_with_the_shift():
    said = doubts("guillotine", {"tool.shift": [0, 0, 5]})
    assert "add [0, 0, -5] mm to tool.shift: then 1 of 1" in said
    with pytest.raises(ModelFileError, match=r"move the tool by -9 mm in y \(\[tool\] shift\)"):
        read_model("guillotine", {"tool.shift": [0, 9, 0]}).build()


def test_a_film_in_inches_is_told(tmp_path):
    keys = disc_in(tmp_path, scale=1.0 / 25.4)
    inches = 'in inches? It would be 20.4 mm across, not 0.803 mm (membrane.unit = "in")'
    assert inches in doubts("opening", keys)
    assert "inches" not in doubts("opening", {**keys, "membrane.unit": "in"})


def test_a_tool_in_inches_is_told(tmp_path):
    made = read_model("opening", {"tool.half_thickness": 0.3}).sections["tool"].made()
    path = tmp_path / "cap.stl"
    made.write(path)
    keys = {"mesh": "quick", "tool.file": str(path)}
    small = doubts("opening", {**keys, "tool.unit": 1.0 / 25.4})
    assert "is it in inches? It would be" in small
    large = doubts("opening", {**keys, "tool.unit": "in"})
    assert "is the tool in mm? It would be" in large
    assert "(tool.unit)" in large


def test_the_guess_of_a_unit_says_what_inches_would_make():
    assert 'unit="in" would make it 101.6 mm' in unit_in_mm(None, 4.0, "the film")[1]
    assert "inches" not in unit_in_mm(None, 20.4, "the film")[1]


def test_a_film_that_stands_upright_is_told(tmp_path):
    keys = disc_in(tmp_path, axes=(0, 2, 1))
    with pytest.raises(ModelFileError, match=r"or the film's plane \(\[membrane\] axis\)"):
        read_model("opening", keys).build()
    assert doubts("opening", {**keys, "membrane.axis": "normal"}) == ""


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["run", "opening", "--set", "mesh", "quick"], "write --set mesh=quick"),
        (["run", "opening", "--set", "pitch", "-12"], "write --set pitch=-12"),
        (["run", "opening", "--set", "mesh", "=", "quick"], "write --set mesh=quick"),
        (["report", "out", "--set", "mesh=quick"], "only commands that run or draw a model"),
    ],
)
def test_a_setting_in_two_words_is_told(capsys, words, said):
    with pytest.raises(SystemExit) as ended:
        main(words)
    assert ended.value.code == 2
    assert said in capsys.readouterr().err


def test_resume_says_why_it_sets_no_key(tmp_path, capsys):
    Path(tmp_path / "used.toml").write_text("")
    assert main(["resume", str(tmp_path), "--set", "mesh=M1"]) == 2
    said = capsys.readouterr().err
    assert "resume continues with the model of the run's start" in said
    assert "used.toml --set mesh=M1 -o OTHER" in said

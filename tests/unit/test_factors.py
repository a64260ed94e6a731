"""Factors, designs and the plan of a study: what is combined with what, before anything runs."""

import pytest

from shellcut.command_line import main
from shellcut.model_file.errors import ModelFileError
from shellcut.study.design import Design
from shellcut.study.factors import factor, factors_of
from shellcut.study.plan import Definition
from shellcut.study.study_file import read_study, write_study
from shellcut.study.table import write_table

WEDGE, ANGLE, SPEED = "tool.wedge_half_angle_deg", "tool.edge_angle_deg", "motion.speed"
LINKED = f"{WEDGE}, {SPEED}"
GIVEN = {LINKED: "10:500, 14:800", ANGLE: [50, 70]}


@pytest.mark.parametrize(
    ("name", "given", "values"),
    [
        ("a", "40,60, 80", (40, 60, 80)),
        ("a", "M1,quick", ("M1", "quick")),
        ("a", "[1, 2], [3, 4]", ([1, 2], [3, 4])),
        ("a", "'x,y', z", ("x,y", "z")),
        ("a", [1.5, "2 mm"], (1.5, "2 mm")),
        ("a", 7, (7,)),
        ("a,b", "40:12,60:20", ((40, 12), (60, 20))),
        (" a ,b", "40 deg : 12 mm, 60 deg : 20 mm", (("40 deg", "12 mm"), ("60 deg", "20 mm"))),
        ("a, b", "[1, 2]:'c:/x, y.stl'", (([1, 2], "c:/x, y.stl"),)),
        ("a, b, c", [[1, 2, "M1"], (3, 4, "M2")], ((1, 2, "M1"), (3, 4, "M2"))),
    ],
)
def test_values(name, given, values):
    found = factor(name, given)
    assert found.values == values
    assert found.ends is None
    assert found.keys == tuple(name.replace(" ", "").split(","))


def test_ranges():
    found = factor("a", "1 mm : 2 mm")
    assert (found.ends, found.unit, found.values) == ((1.0, 2.0), "mm", ())
    assert found.at(0.25) == "1.25 mm"
    assert found.probes() == ("1.0 mm", "2.0 mm")
    assert factor("a", "-1:1e3").ends == (-1.0, 1000.0)


@pytest.mark.parametrize(
    ("name", "given", "said"),
    [
        ("a", "", "at least one value"),
        ("a", "20:10", "must go up"),
        ("a", "1,2,1", "each value once, got 1 twice"),
        ("a", "caps/no*.stl", "there is no file"),
        ("a,", "1:2", "keys that go together must be names"),
        ("a,a", "1:2", "each once"),
        ("a,b", "40:12,60", "a,b must have 2 values together, as 1:2, got (60,)"),
        ("a,b", "40:12:7", "got (40, 12, 7)"),
        ("a,b", "40,60", "got (40,)"),
        ("a,b", ["40", "60"], "got '40'"),
        ("a,b", 3, "got 3"),
        ("a,b", "1:2,1:2", "each value once, got (1, 2) twice"),
    ],
)
def test_values_that_cannot_be_are_refused(name, given, said):
    with pytest.raises(ValueError, match=r".") as refused:
        factor(name, given)
    assert said in str(refused.value)


def test_all_problems_are_told_together_and_a_key_is_in_one_factor():
    with pytest.raises(ValueError, match="a must be in one factor only") as refused:
        factors_of({"a,b": "1:2,3:4", "a": [1, 2], "c": "2:1"})
    assert "c: a range must go up" in str(refused.value)


def test_one_value_is_a_setting():
    several, settings = factors_of({"a, b": "1:M1", "c": [5], "d": "1,2"})
    assert settings == {"a": 1, "b": "M1", "c": 5}
    assert [one.keys for one in several] == [("d",)]


def test_a_grid_combines_what_goes_together_with_every_other_value():
    several, _ = factors_of({"a,b": "1:2,3:4", "c": "5,6"})
    assert Design().runs(several) == [
        {"a": 1, "b": 2, "c": 5},
        {"a": 1, "b": 2, "c": 6},
        {"a": 3, "b": 4, "c": 5},
        {"a": 3, "b": 4, "c": 6},
    ]


@pytest.mark.parametrize("kind", ["sobol", "lhs"])
def test_points_take_linked_values_as_one_factor(kind):
    several, _ = factors_of({"a,b": "1:2,3:4,5:6,7:8", "c": "0:1"})
    runs = Design(kind, 16).runs(several)
    pairs = [(run["a"], run["b"]) for run in runs]
    assert sorted(set(pairs)) == [(1, 2), (3, 4), (5, 6), (7, 8)]
    assert all(pairs.count(pair) == 4 for pair in set(pairs))  # of sixteen even points
    assert len({run["c"] for run in runs}) == 16


def test_a_plan_goes_into_its_study_file_and_comes_back(tmp_path):
    planned = Definition("guillotine", GIVEN, {"notch": 1}).plan()
    assert [(run.values[WEDGE], run.values[SPEED]) for run in planned.runs[::2]] == [
        (10, 500),
        (14, 800),
    ]
    write_study(tmp_path / "study.toml", planned)
    again = read_study(tmp_path / "study.toml").plan()
    assert [run.key for run in again.runs] == [run.key for run in planned.runs]
    assert len({run.key for run in planned.runs}) == 4
    head = write_table(tmp_path, planned, {}).read_text(encoding="utf-8-sig").splitlines()[0]
    assert head == f"run,{WEDGE},{SPEED},{ANGLE},status,folder,reason"


def test_cores_are_shared_by_runs_that_go_together(monkeypatch):
    monkeypatch.setattr("shellcut.study.plan.available_cores", lambda: 6)
    planned = Definition("guillotine", GIVEN).plan()
    threads = [planned.model_of(planned.runs[0], jobs).head.threads for jobs in (1, 2, 6, 8)]
    assert threads == [None, 3, 1, 1]  # one alone takes what its film can use
    given = Definition("guillotine", GIVEN, {"threads": 4}).plan()
    assert given.model_of(given.runs[0], 6).head.threads == 4


def test_every_value_of_linked_keys_is_tried_before_any_run():
    study = Definition("guillotine", {LINKED: "10:500, 14:-800, 200:800"})
    with pytest.raises(ModelFileError) as refused:
        study.plan()
    assert "-800" in str(refused.value)
    assert "200" in str(refused.value)


def test_the_command_lists_the_runs(capsys):
    setting = f"--set={WEDGE},{SPEED}=10:500,14:800"
    assert main(["sweep", "guillotine", setting, "--set=notch=1", "--dry-run"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "2 runs, 0 of them done before"
    assert lines[2].endswith(f"{WEDGE}=14, {SPEED}=800")
    assert main(["sweep", "guillotine", f"--set={WEDGE},{SPEED}=10:500,14", "--dry-run"]) == 2
    assert "must have 2 values together" in capsys.readouterr().err

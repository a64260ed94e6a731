"""The search for the best values: limits on figures, their names, and a search of real runs."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import shellcut as sc
from shellcut.command_line import main
from shellcut.results.cut_quality import UNITS
from shellcut.results.summary_figures import known_figure
from shellcut.study.converge import NoFinerFilm, finer_film
from shellcut.study.factors import factors_of
from shellcut.study.optimise import OPTIMUM, Optimum, Trial
from tiny_study import SETTINGS, in_words

optuna = pytest.importorskip("optuna")
PLATEAU, ANGLE = "cohesive.plateau", "wedge_half_angle_deg"
LEAST = {"minimise": "force_peak"}


@pytest.fixture(scope="module")
def shared(tmp_path_factory):
    """A folder of searches that have runs in common: none is run twice."""
    return tmp_path_factory.mktemp("shared")


def search(folder, *more, keys=f"{PLATEAU}=6:11", n=2):
    """Search by the command; return its exit code."""
    asked = ["optimise", "guillotine", "-o", str(folder), "--jobs=1", f"--max-runs={n}"]
    goal = [] if "--maximise=force_peak" in more else ["--minimise=force_peak"]
    return main([*asked, *in_words(SETTINGS), f"--set={keys}", *goal, *more])


def kept(folder, name):
    return json.loads((folder / OPTIMUM).read_text())[name]


def test_a_search_keeps_to_its_limit_and_is_not_run_again(tmp_path):
    # The force is the plateau times h: the least within the limit is at the limit.
    lines = []

    def found():
        return sc.optimise(
            "guillotine",
            tmp_path,
            subject_to=["cohesive_work >= 0.75", "n_loose == 0"],
            settings={**SETTINGS, PLATEAU: "6:12", ANGLE: [10, 14]},
            max_runs=6,
            allow_doubts=True,  # the runs are too fast
            executor=1,
            say=lines.append,
            **LEAST,
        )

    optimum = found()
    best, given = optimum.best, optimum.trials[0]
    assert (len(optimum.trials), given.values) == (6, {})
    for one in optimum.trials:
        work = sc.read(one.folder).summary["cohesive_work_Nmm"]
        assert one.missed == pytest.approx(max(0.75 - work, 0.0))
    assert {one.missed > 0.0 for one in optimum.trials} == {True, False}
    within = [one.figure for one in optimum.trials if one.missed == 0.0]
    assert best.figure == min(within) < given.figure
    assert f"{best.figure:.4g} N at best" in str(optimum)
    assert [one["figure"] for one in kept(tmp_path, "trials")] == [
        one.figure for one in optimum.trials
    ]
    assert (tmp_path / "optimum.png").exists()
    lines.clear()
    assert str(found()) == str(optimum)
    assert not [line for line in lines if line.startswith("[")]


@pytest.mark.parametrize(
    ("more", "where", "quads"),
    [
        # The model as given, which is the second best, and the best.
        (["--confirm", "size=1"], "with size = 1: ", [24, 24]),
        ([], "on a finer film: ", [18 * 12] * 2),  # 1.5 times as many rows of 12 x 8
        (["--confirm", "none"], "", []),
    ],
)
def test_a_search_ends_with_the_best_on_another_mesh(shared, capsys, more, where, quads):
    assert search(shared, "--allow-doubts", *more) == 0
    said = capsys.readouterr().out
    for part in ("force, peak: ", "distrust at best: The motion is too fast"):
        assert f"{where}{part}" in said
    runs = kept(shared, "confirmed") if quads else []
    assert [sc.read(one["folder"]).frame(0).quads.shape[0] for one in runs] == quads
    assert ("on a finer film" in said) == (not more)


@pytest.mark.parametrize(
    ("figures", "half_width", "told"),
    [
        ((4.0, 3.0, 3.5), None, True),
        ((4.0, 3.0, 2.9), None, False),  # the finer film ranks them otherwise
        ((4.0, 3.0, 3.3), 0.1, True),
        ((4.0, 3.0, 3.1), 0.1, False),  # less than the ± of both
    ],
)
def test_the_best_is_better_only_if_a_finer_film_says_so(figures, half_width, told):
    trials = [Trial({"k": n} if n else {}, str(n), 4.0 - 0.5 * n) for n in (0, 2, 1)]
    again = [
        Trial({"size": 1, **one.values}, f"finer {one.folder}", figure, half_width=half_width)
        for one, figure in zip(trials, figures, strict=True)
    ]
    found = Optimum(
        "force_peak_N", 1, (), tuple(trials), confirmed=tuple(again), where="on a finer film"
    )
    assert (found.best.values, found.second.values) == ({"k": 2}, {"k": 1})
    said = str(found)
    assert f"{figures[2]:.3g}" in said.splitlines()[-2 if told else -3]
    assert ("its difference from the one second best is within the scatter" in said) is not told
    assert "its difference from the one as given is within the scatter" not in said


@pytest.mark.parametrize(
    ("settings", "best", "told"),
    [
        ({"k": "2:12"}, {"k": 2.0}, ["k = 2.0 lies at a bound of 2.0:12.0"]),
        ({"k": "2:12"}, {"k": 11.7}, ["k = 11.7 lies at a bound of 2.0:12.0"]),
        ({"k": "2:12"}, {"k": 3.1}, []),
        ({"k": "-12:-2"}, {"k": -11.9}, ["k = -11.9 lies at a bound of -12.0:-2.0"]),
        (
            {"k": "0.2 mm : 0.5 mm"},
            {"k": "0.21 mm"},
            ["k = 0.21 mm lies at a bound of 0.2 mm:0.5 mm"],
        ),
        ({"k": "2:12", "n": "3,4,5"}, {"k": 7.0, "n": 5}, ["n = 5 lies at a bound of 3, 4, 5"]),
        ({"n": [5, 3, 4]}, {"n": 3}, ["n = 3 lies at a bound of 5, 3, 4"]),
        ({"n": [5, 3, 4]}, {"n": 4}, []),
        ({"n": "900 um, 1 mm, 1.2 mm"}, {"n": "1 mm"}, []),
        ({"n": "3, 5"}, {"n": 3}, []),  # nothing lies between two
        ({"mesh": "M1,M2,quick"}, {"mesh": "M1"}, []),
        ({"file": ["3.stl", "4.stl", "5.stl"]}, {"file": "3.stl"}, []),
        ({"flag": [True, False, 2]}, {"flag": True}, []),
        (
            {"a, b": "40:12, 60:30, 80:20"},
            {"a": 80, "b": 20},
            ["a = 80 lies at a bound of 40, 60, 80"],
        ),
        ({"k": "2:12"}, {}, []),  # as given
    ],
)
def test_a_best_value_at_a_bound_is_told(tmp_path, settings, best, told):
    factors, _ = factors_of(settings)
    trials = (Trial({}, "a", 3.0), Trial(best, "b", 2.0), Trial({"k": 1.0}, "c", 2.5))
    found = Optimum("force_peak_N", 1, (), trials, factors=tuple(factors))
    said = [line for line in str(found).splitlines() if "lies at" in line]
    assert said == [f"{one}: if values beyond are possible, widen it" for one in told]
    found.write(tmp_path)
    assert json.loads((tmp_path / OPTIMUM).read_text())["factors"][0]["keys"]


@pytest.mark.parametrize(
    ("given", "best", "half_width", "change"),
    [
        (200.0, 150.0, None, " (-25.0 %)"),
        (-2.0, -3.0, None, " (-50.0 %)"),
        (-2.0, -1.0, None, " (+50.0 %)"),
        (2.0, 0.0, None, " (-100.0 %)"),
        (0.1, -3.0, None, ""),
        (-0.1, 3.0, None, ""),
        (0.0, 3.0, None, ""),
        (-2.0, -2.1, 0.1, " (-5.0 %, less than the ± of both)"),
        (0.1, -0.1, 0.3, " (less than the ± of both)"),
    ],
)
def test_the_change_has_the_sign_of_the_difference(given, best, half_width, change):
    first, other = (Trial({"k": v}, str(v), v, half_width=half_width) for v in (given, best))
    found = Optimum("axial_force_plateau_N", 1 if best < given else -1, (), (first, other))
    found = replace(found, confirmed=(first, other), where="again")
    assert f" at best{change}\n" in f"{found}\n".partition("again: ")[2]


def test_of_runs_that_fail_or_miss_the_limits_none_is_best():
    trials = (Trial({}, "a", 3.0, 0.5), Trial({"k": 1}, "b", reason="refused"))
    optimum = Optimum("force_peak_N", 1, ("n_loose == 1",), trials)
    assert optimum.best is None
    assert str(optimum).startswith("no run is the best: 2 runs, 1 failed, 1 beyond the limits")
    within = Optimum("force_peak_N", -1, (), (*trials, Trial({"k": 2}, "c", 2.0)))
    assert within.best.folder == "c"
    curves = {one.name: np.asarray(one.values, float) for one in within.diagram().curves}
    assert list(curves) == ["runs beyond the limits", "runs", "best so far"]
    beyond, inside, best = curves.values()
    np.testing.assert_array_equal(np.isnan(beyond), [False, True, True])
    np.testing.assert_array_equal(np.isnan(inside), [True, True, False])
    assert best[2] == 2.0


def test_what_a_verdict_distrusts_is_not_the_best_unless_that_is_allowed(tmp_path, capsys):
    asked = {"keys": "motion.speed=2500:3500", "n": 5}
    assert search(tmp_path, "--maximise=force_peak", **asked) == 0
    said = capsys.readouterr().out
    trials = kept(tmp_path, "trials")
    assert {bool(one["doubts"]) for one in trials} == {True, False}
    for one in trials:
        summary = sc.read(one["folder"]).summary
        assert len(one["doubts"]) == sum(line["kind"] == "doubt" for line in summary["verdict"])
    trusted = [one["figure"] for one in trials if not one["doubts"]]
    assert f"{max(trusted):.4g} N at best" in said
    assert f"5 runs, {5 - len(trusted)} distrusted" in said
    assert search(tmp_path, "--maximise=force_peak", "--allow-doubts", **asked) == 0
    largest = max(trials, key=lambda one: one["figure"])
    said = capsys.readouterr().out
    assert f"{largest['figure']:.4g} N at best" in said
    assert f"distrust at best: {largest['doubts'][0]}" in said


def test_where_no_run_keeps_to_the_limits_the_nearest_is_told_with_four(shared, capsys):
    assert search(shared, "--subject-to", "crack length >= 500", "--subject-to=flaps==0") == 4
    said = capsys.readouterr().out
    assert "no run is the best: 2 runs, 2 beyond the limits" in said
    assert "the nearest to crack length >= 500, flaps==0 is run 1 with crack length 1.5 mm" in said
    assert search(shared) == 4
    said = capsys.readouterr().out
    for part in ("2 runs, 2 distrusted", "distrust: The motion is too fast", "--allow-doubts"):
        assert part in said


def test_every_number_of_a_summary_is_a_name_that_a_search_knows(tmp_path):
    study = sc.sweep("guillotine", {PLATEAU: [6]}, tmp_path, settings=SETTINGS, executor=1, say=str)
    names = [name for name in study.rows[0] if name != PLATEAU]
    assert {"doubts", "force_peak_N"} <= set(names)
    assert [known_figure(one, UNITS) for one in names] == names
    words = {"piercing_force_12": "piercing_force_12_N", "flaps": "n_flap", "bridges": "n_bridge"}
    for word, name in (words | {"loose pieces": "n_loose"}).items():
        assert known_figure(word, UNITS) == name


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"minimise": "a", "maximise": "b"}, "either minimise or maximise"),
        ({}, "either minimise or maximise"),
        (LEAST | {"max_runs": 1}, "max_runs must be 2 or more, got 1"),
        (LEAST | {"subject_to": ["n_loose = 1"]}, "a limit must be NAME <= NUMBER"),
        ({"minimise": "crack_length", "subject_to": ["flasp==0"]}, "did you mean n_flap"),
        ({"minimise": "force_paek"}, "no value force_paek; did you mean force_peak_N"),
        (LEAST | {"keys": {PLATEAU: 10.0}}, "at least one key a range"),
        (LEAST | {"confirm": {"siez": 1}}, "did you mean size"),
    ],
)
def test_what_cannot_be_sought_is_refused_before_any_run(given, said, tmp_path):
    keys = given.get("keys", {PLATEAU: "6:12"})
    given = {name: value for name, value in given.items() if name != "keys"}
    with pytest.raises(ValueError, match=said):
        sc.optimise("guillotine", tmp_path / "none", settings={**SETTINGS, **keys}, **given)
    assert not Path(tmp_path / "none").exists()


def test_a_figure_that_is_not_there_is_told_with_those_that_are(shared):
    settings, goal = {**SETTINGS, PLATEAU: "6:11"}, {"minimise": "torque_peak"}
    with pytest.raises(RuntimeError, match=r"no value torque_peak_Nmm; .*force_peak_N"):
        sc.optimise("guillotine", shared, settings=settings, executor=1, say=str, **goal)


def test_the_report_of_a_search_has_what_was_found_and_the_runs(tmp_path, capsys):
    trials = (
        Trial({}, "runs/a", 3.0),
        Trial({"tool.teeth": 3}, "runs/b", 2.0, half_width=0.1),
        Trial({"tool.teeth": 9}, "runs/c", reason="teeth <overlap>"),
    )
    report = ["report", str(tmp_path)]
    Optimum("force_peak_N", 1, (), trials).write(tmp_path)
    assert main(report) == 0
    assert "report.html" in capsys.readouterr().out
    page = (tmp_path / "report.html").read_text()
    for said in ("tool.teeth = 3", "2 ± 0.1 N", "teeth &lt;overlap&gt;", "at best", "runs/"):
        assert said in page, said
    (tmp_path / OPTIMUM).write_text("{}")
    assert main(report) == 2
    assert "is not as shellcut writes it" in capsys.readouterr().err
    # Runs without a result: how to go on.
    (tmp_path / OPTIMUM).unlink()
    (tmp_path / "runs").mkdir()
    assert main(report) == 2
    said = capsys.readouterr().err
    assert "none of study.toml, fit.json, optimum.json" in said
    assert "call it again to continue" in said


def test_a_model_without_a_finer_film_says_so():
    with pytest.raises(NoFinerFilm, match="no finer mesh of its kind"):
        finer_film(sc.read_model("opening", {"mesh": "M2"}))
    assert finer_film(sc.read_model("opening", {"mesh": "M1"})) == {"membrane.mesh": "M2"}
    few = {"membrane.radius": 10.2, "n_side": 1}
    assert finer_film(sc.read_model("opening", few)) == {"membrane.n_side": 3}

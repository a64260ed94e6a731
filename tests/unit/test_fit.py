"""The parts of a fit: energy that is kept, misfit of curves, intervals; and a fit of real runs."""

import shutil
from dataclasses import replace

import numpy as np
import pytest
import scipy

import shellcut as sc
from shellcut import compare, read
from shellcut.command_line import main
from shellcut.model_file.reader import ModelVariants
from shellcut.study.curve_misfit import compared, correlations, residuals
from shellcut.study.fit_result import covariance_of
from shellcut.study.free_parameters import FreeParameters
from tiny_study import SETTINGS

PLATEAU, OPENING = "cohesive.plateau", "cohesive.opening_u"


def test_the_last_key_keeps_the_energy():
    variants = ModelVariants("opening")
    free = FreeParameters(variants, [PLATEAU, OPENING], {}, keep_energy=True)
    energy = variants.read({}).sections["cohesive"].made().fracture_energy
    assert [one.key for one in free.varied] == [PLATEAU]
    for log in (-0.1, 0.0, 0.15):
        values = free.values([log])
        assert values[PLATEAU] == pytest.approx(12.0 * np.exp(log), rel=1e-6)  # seven digits
        law = variants.read(values).sections["cohesive"].made()
        assert law.fracture_energy == pytest.approx(energy, rel=1e-6)
    with pytest.raises(ValueError, match="keeps the energy"):
        free.values([-1.0])


@pytest.mark.parametrize(
    ("keys", "bounds", "keep", "said"),
    [
        (["cohesive.plateau", "motion.axis"], {}, False, "no such key"),
        (["plateau"], {}, False, "written SECTION.KEY"),
        (["cohesive.joint"], {}, False, "cohesive.joint is no number, but"),
        ([PLATEAU], {PLATEAU: (13.0, 20.0)}, False, "around its start, 12"),
        ([PLATEAU], {OPENING: (1.0, 5.0)}, False, "not among the free keys"),
        ([PLATEAU], {}, True, "two or more keys"),
        ([PLATEAU, "motion.pitch"], {}, True, "must be of"),
        ([PLATEAU, PLATEAU], {}, False, "given once"),
        ([], {}, False, "at least one"),
    ],
)
def test_free_keys_that_cannot_be_are_refused(keys, bounds, keep, said):
    with pytest.raises(ValueError, match=said):
        FreeParameters(ModelVariants("opening"), keys, bounds, keep_energy=keep)


def test_intervals_are_those_of_linear_regression():
    # y = a + b x with noise: the textbook covariance.
    rng = np.random.default_rng(1)
    x = np.linspace(0.0, 1.0, 50)
    slopes = np.column_stack([np.ones(50), x])
    noise = rng.standard_normal(50)
    noise -= slopes @ np.linalg.lstsq(slopes, noise, rcond=None)[0]
    found, nu = covariance_of(slopes, noise, [np.eye(50)[0]])
    expected = noise @ noise / 48.0 * np.linalg.inv(slopes.T @ slopes)
    np.testing.assert_allclose(found, expected, rtol=1e-9)  # of the small ridge
    assert nu == pytest.approx(48.0)
    # Two curves with correlations of their own, with whole matrices.
    alike = [np.maximum(1.0 - np.arange(n) / m, 0.0) for n, m in ((20, 4.0), (30, 7.0))]
    found, nu = covariance_of(slopes, noise, alike)
    S = scipy.linalg.block_diag(*map(scipy.linalg.toeplitz, alike))
    P = np.linalg.inv(slopes.T @ slopes)
    M_S = S - slopes @ P @ slopes.T @ S
    expected = noise @ noise / np.trace(M_S) * P @ slopes.T @ S @ slopes @ P
    np.testing.assert_allclose(found, expected, rtol=1e-9)
    assert nu == pytest.approx(np.trace(M_S) ** 2 / np.trace(M_S @ M_S))
    nothing, _ = covariance_of(0.0 * slopes, noise, [np.eye(50)[0]])
    assert np.isinf(nothing.diagonal()).all()


@pytest.fixture(scope="module")
def known(tmp_path_factory):
    """Return the folder of a run whose parameters are known."""
    out = tmp_path_factory.mktemp("known")
    values = {PLATEAU: [12.0]}
    study = sc.sweep("guillotine", values, out, settings=SETTINGS, executor=1, say=str)
    return study.plan.runs[0].folder(study.folder)


def test_the_misfit_is_the_mean_square_over_the_peak(known):
    history = read(known).history
    x = np.linspace(0.2, 1.8, 41)
    y = np.interp(x, history["path"], history["force"])
    off = compare(known, sc.MeasuredCurve(x, y + 0.1, "mm", "N"))
    missed = residuals([off])
    assert np.sqrt(missed @ missed) == pytest.approx(off.rms / (y + 0.1).max(), rel=1e-9)


@pytest.mark.parametrize("window", [1, 20, 60])
def test_95_of_100_intervals_hold_the_truth(known, window):
    x, rng = np.linspace(0.0, 1.0, 120), np.random.default_rng(0)
    slopes = np.column_stack([1.0 - np.exp(-6.0 * x), x])
    history = read(known).history
    curve = sc.MeasuredCurve(history["path"], history["force"], "mm", "N")
    one, mean = compare(known, curve), np.ones(window) / window
    held = 0
    for _ in range(400):
        noise = np.convolve(rng.standard_normal(119 + window), mean, "valid")
        off = np.linalg.lstsq(slopes, noise, rcond=None)[0]
        missed = noise - slopes @ off
        width = window * x[1] if window > 1 else None
        one = replace(one, x=x, measured=0.0 * x, simulated=missed, window=width)
        C, nu = covariance_of(slopes, missed, [correlations(one)])
        held += abs(off[0]) < scipy.stats.t.ppf(0.975, nu) * np.sqrt(C[0, 0])
    assert 0.93 * 400 < held < 0.985 * 400  # standard deviation 1.1 %


def test_a_miss_that_is_no_noise_is_alike_over_its_length(known):
    x, history = np.linspace(0.0, 1.0, 120), read(known).history
    one = compare(known, sc.MeasuredCurve(history["path"], history["force"], "mm", "N"))
    one = replace(one, x=x, measured=0.0 * x, simulated=np.sin(9.0 * x), window=None)
    assert correlations(one)[10] > 0.5


def test_a_run_is_compared_at_the_points_of_the_first(known, tmp_path):
    history = read(known).history
    curve = sc.FitCurve(sc.MeasuredCurve(history["path"], history["force"], "mm", "N"))
    points = compared(known, curve, 0.3).x
    other = tmp_path / "other"
    shutil.copytree(known, other)
    rows = (known / "history.csv").read_text().splitlines(keepends=True)
    # A run of another step ends a row earlier or later.
    (other / "history.csv").write_text("".join(rows[:-1]))
    np.testing.assert_array_equal(compared(other, curve, 0.3, points).x, points)
    (other / "history.csv").write_text("".join(rows[: len(rows) // 2]))
    with pytest.raises(ValueError, match="the run must reach from"):
        compared(other, curve, 0.3, points)


def test_a_fit_finds_the_plateau_and_is_not_run_again(known, tmp_path):
    history = read(known).history
    curve = sc.FitCurve(sc.MeasuredCurve(history["path"], history["force"], "mm", "N"))
    lines = []

    def fitted():
        return sc.fit(
            "guillotine",
            [curve],
            [PLATEAU],
            tmp_path,
            settings={**SETTINGS, PLATEAU: 10.0},
            search=sc.Search(max_runs=12),
            executor=1,
            say=lines.append,
        )

    found = fitted()
    (plateau,) = found.values
    assert plateau.value == pytest.approx(12.0, rel=0.01)  # of smoothed curves with a sawtooth
    assert plateau.low <= plateau.value <= plateau.high < 1.2 * plateau.value
    assert found.rms < 0.2 * found.rms_at_start
    assert found.n_run <= 12
    assert "the parameters no longer change" in found.notes[0]
    (doubt,) = (note for note in found.notes if note.startswith("distrust, at the fitted values: "))
    assert "The motion is too fast" in doubt
    assert any(note.startswith("the verdict distrusts ") for note in found.notes)
    assert (tmp_path / "fit.json").exists()
    assert (tmp_path / "fit.png").exists()
    lines.clear()
    assert str(fitted()) == str(found)
    assert not [line for line in lines if line.startswith("[")]


@pytest.mark.parametrize("wrong", [{"method": "best"}, {"max_runs": 0}, {"max_runs": 2.5}])
def test_a_search_that_cannot_be_is_refused(wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        sc.Search(**wrong)


def test_too_few_runs_are_refused_before_any(tmp_path):
    search = sc.Search(max_runs=2)
    with pytest.raises(ValueError, match="must be 3 or more"):
        sc.fit("guillotine", [], [PLATEAU], tmp_path / "none", search=search)
    assert not (tmp_path / "none").exists()


@pytest.fixture
def asked(monkeypatch):
    """Return a function that gives the curves a command would fit; nothing runs."""
    seen = {}

    def not_run(model, curves, free, out, **options):
        seen["curves"] = curves
        raise ValueError("not run")

    monkeypatch.setattr("shellcut.study.fit.fit", not_run)

    def curves_of(*arguments):
        assert main(["fit", "guillotine", *arguments, "--free", PLATEAU, "-o", "x"]) == 2
        return seen.pop("curves", None)

    return curves_of


def test_the_command_gives_each_curve_its_keys(asked):
    slow, fast, third = asked(
        *("slow.csv", "fast.csv", "third.csv"),
        *("--for", "fast.csv", "motion.speed=8000", "--for", "fast.csv", "tool.edge_angle_deg=50"),
        *("--for", "3", "motion.speed=8 m/s"),
    )
    assert slow.settings == {}
    assert fast.settings == {"motion.speed": 8000, "tool.edge_angle_deg": 50}
    assert (third.measured, third.settings) == ("third.csv", {"motion.speed": "8 m/s"})
    # Two columns of a table, of two experiments.
    first, second = asked(
        "both.csv", "--y", "force=A", "--y", "force=B", "--for", "2", "motion.speed=3000"
    )
    assert (first.columns[1], first.settings) == ("A", {})
    assert (second.columns[1], second.settings) == ("B", {"motion.speed": 3000})


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (("b.csv", "motion.speed=1"), "must be one of the files a.csv, or 1"),
        (("2", "motion.speed=1"), "--for 2: must be one of"),
        (("a.csv", "motion.speed"), "must be KEY=VALUE"),
    ],
)
def test_keys_of_no_curve_are_refused(asked, capsys, given, said):
    assert asked("a.csv", "--for", *given) is None
    assert said in capsys.readouterr().err


@pytest.mark.parametrize("key", [PLATEAU, "plateau"])
def test_a_curve_cannot_set_what_is_fitted(tmp_path, key):
    curves = [sc.FitCurve("a.csv"), sc.FitCurve("b.csv", settings={key: 9.0})]
    with pytest.raises(ValueError, match=f"is fitted, so a curve must not set it, got {key}"):
        sc.fit("guillotine", curves, [PLATEAU], tmp_path / "none")
    assert not (tmp_path / "none").exists()


@pytest.mark.slow
def test_keys_that_do_the_same_to_the_curve_are_told(tmp_path):
    # Force is G h: a plateau and a thickness that are 12 MPa and 0.074 mm, from 10 and 0.08.
    both = [PLATEAU, "material.thickness"]
    settings = {**SETTINGS, "membrane.length": 8, "travel": 4.0}
    known = sc.sweep("guillotine", {}, tmp_path / "known", settings=settings, executor=1, say=str)
    history = read(known.plan.runs[0].folder(known.folder)).history
    x, force = history["path"], history["force"]
    noise = np.random.default_rng(0).standard_normal(x.size)
    measured = sc.MeasuredCurve(x, force + 0.03 * force.max() * noise, "mm", "N")
    found = sc.fit(
        "guillotine",
        [sc.FitCurve(measured)],
        both,
        tmp_path / "fit",
        settings={**settings, PLATEAU: 10.0, both[1]: 0.08},
        executor=1,
        say=str,
    )
    assert found.correlation[0, 1] < -0.95
    told = [note for note in found.notes if note.startswith("the data cannot tell")]
    assert len(told) == 1
    assert f"{PLATEAU} and material.thickness apart" in told[0]
    # Only the product is determined: to the noise of 3 % at a point.
    product = found.values[0].value * found.values[1].value
    assert product == pytest.approx(12.0 * 0.074, rel=0.03)


@pytest.mark.slow
def test_a_search_of_the_box_fits_several_curves_at_once(tmp_path):
    wedges = {"wedge_half_angle_deg": [10, 20]}
    settings = {**SETTINGS, PLATEAU: 12.0}
    known = sc.sweep("guillotine", wedges, tmp_path / "known", settings=settings, executor=1)
    curves = []
    for run in known.plan.runs:
        history = read(run.folder(known.folder)).history
        measured = sc.MeasuredCurve(history["path"], history["force"], "mm", "N")
        curves.append(sc.FitCurve(measured, settings=run.values))
    # Half a curve of the first experiment: it takes no run of its own, and keeps its place.
    whole = curves[0].measured
    half = sc.MeasuredCurve(whole.x[whole.x < 1.0], whole.y[whole.x < 1.0], "mm", "N")
    curves.append(replace(curves[0], measured=half))
    found = sc.fit(
        "guillotine",
        curves,
        [PLATEAU],
        tmp_path / "fit",
        settings={**SETTINGS, PLATEAU: 18.0},
        search=sc.Search(method="global", max_runs=30),
        executor=1,
    )
    assert found.values[0].value == pytest.approx(12.0, rel=0.01)
    assert [settings["wedge_half_angle_deg"] for settings in found.settings] == [10, 20, 10]
    assert [one.x[-1] < 1.0 for one in found.comparisons] == [False, False, True]
    assert found.n_run % 2 == 0
    assert found.rms < 0.02

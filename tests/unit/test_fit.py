"""The parts of a fit: energy that is kept, misfit of curves, intervals; and a fit of real runs."""

import json
import shutil
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import scipy

import shellcut as sc
from shellcut import compare, read
from shellcut.command_line import main
from shellcut.model_file.reader import ModelVariants
from shellcut.numerics.broken_line import BrokenLine
from shellcut.results.comparison import shares
from shellcut.study.curve_misfit import compared, correlations, residuals
from shellcut.study.fit_result import covariance_of
from shellcut.study.fit_runs import FreeParameters
from shellcut.study.one_run import Outcome
from shellcut.study.plan import sought
from shellcut.study.report import report_found
from tiny_study import SETTINGS

PLATEAU, OPENING = "cohesive.plateau", "cohesive.opening_u"


def free(given, *, model="opening", keep=False):
    """Return the free parameters of the settings of a fit."""
    factors, variants = sought(model, given)
    return FreeParameters(variants, factors, keep_energy=keep)


OWN = """model = 'opening'
[membrane]
mesh = 'quick'
[cohesive]
kind = 'bilinear'
strength = 18
knee_opening = 0.5
knee_traction = 6
opening_u = 4
"""


@pytest.mark.parametrize(
    ("text", "key", "given", "start"),
    [(None, PLATEAU, "4:36", 12.0), (OWN, "cohesive.knee_traction", "4:10", 6.0)],
)
def test_the_last_key_keeps_the_energy(tmp_path, text, key, given, start):
    model = "opening"
    if text:
        model = tmp_path / "own.toml"
        model.write_text(text)
    variants = ModelVariants(model)
    parameters = free({key: given, OPENING: "1:20"}, model=model, keep=True)
    energy = variants.read({}).sections["cohesive"].made().fracture_energy
    if text:
        by_hand = 0.5 * (18.0 + 6.0) * 0.5 + 0.5 * 6.0 * 3.5
        assert energy == pytest.approx(by_hand, rel=1e-12)
    assert [one.key for one in parameters.varied] == [key]
    for log in (-0.1, 0.0, 0.15):
        values = parameters.values([log])
        assert values[key] == pytest.approx(start * np.exp(log), rel=1e-6)  # seven digits
        law = variants.read(values).sections["cohesive"].made()
        assert law.fracture_energy == pytest.approx(energy, rel=1e-6)
    if not text:
        with pytest.raises(ValueError, match="keeps the energy"):
            parameters.values([-1.5])


@pytest.mark.parametrize(
    ("given", "unit", "start", "low", "high"),
    [
        ({"plateau": "6:24"}, "MPa", 12.0, 6.0, 24.0),
        ({PLATEAU: "20:45"}, "MPa", 30.0, 20.0, 45.0),  # the model's lies below
        ({PLATEAU: "20 kPa : 45 kPa"}, "MPa", 0.03, 0.02, 0.045),
        ({"material.thickness": "50 um : 80 um"}, "mm", 0.074, 0.05, 0.08),
        ({"cohesive.cutting_energy": "1:16"}, "N/mm", 4.0, 1.0, 16.0),  # the model has none
        # A key of one kind only takes the place of the model's kind.
        ({"cohesive.fracture_energy": "20:80"}, "N/mm", 40.0, 20.0, 80.0),
        ({"quasi_static": "0.001:0.004"}, "", 0.002, 0.001, 0.004),  # before all sections
        # Of a table in a table.
        ({"material": "pet", "yield_stress": "80:120"}, "MPa", 93.33, 80.0, 120.0),
    ],
)
def test_a_fit_starts_at_the_model_or_in_the_middle_of_the_range(given, unit, start, low, high):
    (one,) = free(given).all
    assert (one.start, one.low, one.high) == pytest.approx((start, low, high), rel=1e-9)
    assert one.unit.strip("-") == unit


@pytest.mark.parametrize(
    ("given", "keep", "said"),
    [
        ({"cohesive.plateu": "6:24"}, False, "did you mean plateau"),
        ({"cohesive.joint": "1:2"}, False, "must be .*, got 1.0"),
        ({"tool.teeth": "3:6"}, False, "must be a whole number"),
        ({PLATEAU: "6 mm:24 mm"}, False, "must be a number in MPa"),
        ({PLATEAU: "-6:24"}, False, "must be|above 0"),
        ({"tool.phase_deg": "-6:24"}, False, "a range to fit must be above 0, got -6:24"),
        ({PLATEAU: "24:6"}, False, "a range must go up"),
        ({PLATEAU: "6 kPa : 24 MPa"}, False, f"{PLATEAU}: both ends of a range must have one unit"),
        ({PLATEAU: "8,12", OPENING: "3:5"}, False, "a range low:high .*, got 2 values"),
        ({"plateau": "6:24", PLATEAU: "8:16"}, False, f"{PLATEAU} must have one range"),
        ({PLATEAU: 12.0}, False, "at least one key a range"),
        (None, False, "at least one key a range"),
        ({PLATEAU: "6:24"}, True, "two or more keys"),
        ({PLATEAU: "6:24", "motion.pitch": "6:24"}, True, "must be of"),
    ],
)
def test_ranges_that_cannot_be_fitted_are_refused(given, keep, said):
    with pytest.raises(ValueError, match=said):
        free(given, keep=keep)


@pytest.mark.parametrize(
    ("command", "said"),
    [
        ("fit opening a.csv -o x --bounds plateau=6:24", "by --set plateau=6:24"),
        ("optimise opening -o x --minimise a --vary k=6:24", "by --set k=6:24"),
        ("optimise opening -o x --minimise a --vary=k=6:24", "unrecognized arguments: --vary=k"),
    ],
)
def test_a_key_after_an_unknown_option_is_told_with_set(command, said, capsys):
    with pytest.raises(SystemExit):
        main(command.split())
    told = capsys.readouterr().err
    assert said in told
    assert "--set --" not in told


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
    np.testing.assert_allclose(nu, 48.0)
    # Two curves with errors and correlations of their own, with whole matrices.
    alike = [np.maximum(1.0 - np.arange(n) / m, 0.0) for n, m in ((20, 4.0), (30, 7.0))]
    found, nu = covariance_of(slopes, noise, alike)
    P = np.linalg.inv(slopes.T @ slopes)
    parts, shared = [], 0.0
    for c, of in zip(alike, (slice(20), slice(20, 50)), strict=True):
        J, S = slopes[of], scipy.linalg.toeplitz(c)
        M_S = S - J @ P @ J.T @ S
        variance = noise[of] @ noise[of] / np.trace(M_S)
        parts.append(variance * P @ J.T @ S @ J @ P)
        shared += np.diag(parts[-1]) ** 2 * np.trace(M_S @ M_S) / np.trace(M_S) ** 2
    np.testing.assert_allclose(found, sum(parts), rtol=1e-9)
    np.testing.assert_allclose(nu, np.diag(sum(parts)) ** 2 / shared, rtol=1e-9)


@pytest.mark.parametrize(
    ("slopes", "unknown"),
    [
        (np.zeros((25, 2)), [True, True]),
        (np.outer(np.ones(25), [1.0, 0.0]), [False, True]),  # no curve depends on the second
        (np.eye(25, 5) + np.eye(25, 5, -5), [False] * 5),
        (np.eye(25, 6), [True] * 6),  # five parameters of the five points of the first curve
        (np.eye(25, 26), [True] * 26),
    ],
)
def test_the_interval_of_what_the_data_do_not_tell_is_wide(slopes, unknown):
    noise, alike = np.random.default_rng(1).standard_normal(25), [np.eye(5)[0], np.eye(20)[0]]
    C, _ = covariance_of(slopes, noise, alike)
    np.testing.assert_array_equal(np.diag(C) > 1e6, unknown)


@pytest.fixture(scope="module")
def known(tmp_path_factory):
    """Return the folder of a run whose parameters are known, and its curve."""
    out = tmp_path_factory.mktemp("known")
    values = {PLATEAU: [10.0]}
    study = sc.sweep("guillotine", values, out, settings=SETTINGS, executor=1, say=str)
    folder = study.plan.runs[0].folder(study.folder)
    return folder, curve_of(folder)


def curve_of(folder):
    history = read(folder).history
    return sc.MeasuredCurve(history["path"], history["force"], "mm", "N")


def test_the_misfit_is_the_mean_square_over_the_peak(known):
    folder, curve = known
    x = np.linspace(0.2, 1.8, 41)
    y = np.interp(x, curve.x, curve.y)
    off = compare(folder, sc.MeasuredCurve(x, y + 0.1, "mm", "N"))
    missed = residuals([off])
    assert np.sqrt(missed @ missed) == pytest.approx(off.rms / (y + 0.1).max(), rel=1e-9)


@pytest.mark.parametrize("window", [1, 20, 60])
def test_95_of_100_intervals_hold_the_truth(known, window):
    x, rng = np.linspace(0.0, 1.0, 120), np.random.default_rng(0)
    slopes = np.column_stack([1.0 - np.exp(-6.0 * x), x])
    one, mean = compare(*known), np.ones(window) / window
    width = window * x[1] if window > 1 else None
    one, held = replace(one, x=x, measured=0.0 * x, window=width), 0
    for _ in range(400):
        noise = np.convolve(rng.standard_normal(119 + window), mean, "valid")
        off = np.linalg.lstsq(slopes, noise, rcond=None)[0]
        missed = noise - slopes @ off
        C, nu = covariance_of(slopes, missed, [correlations(replace(one, simulated=missed))])
        held += abs(off[0]) < scipy.stats.t.ppf(0.975, nu[0]) * np.sqrt(C[0, 0])
    assert 0.93 * 400 < held < 0.985 * 400  # standard deviation 1.1 %


def apart(c, x):
    """Derivatives of a curve: each parameter acts on one."""
    return np.eye(2)[c] * (1.0 - np.exp(-5.0 * x[:, None]))


def together(c, x):
    """The same of cuts by blades of two radii, with the energy G_0 + 2 r H."""
    parts = np.array([4.0, (2.0, 4.0)[c]])
    return parts / parts.sum() * (1.0 - np.exp(-5.0 * x[:, None]))


@pytest.mark.parametrize("derivatives", [apart, together])
@pytest.mark.parametrize(
    ("n", "sigma", "width"),
    [
        ((50, 2000), (0.03, 0.03), 0.05),
        ((2000, 50), (0.03, 0.03), None),
        ((150, 150), (0.1, 0.01), 0.05),
        ((60, 400), (0.1, 0.01), 0.1),
        ((400, 60), (0.1, 0.01), 0.05),
    ],
)
def test_95_of_100_intervals_hold_the_truth_for_each_curve(known, derivatives, n, sigma, width):
    rng, one, n_set = np.random.default_rng(0), compare(*known), 250
    lines = [np.linspace(0.0, 1.0, k) for k in n]
    weights = [np.sqrt(shares(x)) for x in lines]
    slopes = np.vstack(
        [
            w[:, None] * derivatives(c, x)
            for c, (w, x) in enumerate(zip(weights, lines, strict=True))
        ]
    )
    each, held = [replace(one, x=x, measured=0.0 * x, window=width) for x in lines], 0
    for _ in range(n_set):
        noise = [s * rng.standard_normal(k) for s, k in zip(sigma, n, strict=True)]
        if width:
            noise = [BrokenLine(x, e).mean_at(x, width) for x, e in zip(lines, noise, strict=True)]
        noise = np.concatenate([w * e for w, e in zip(weights, noise, strict=True)])
        off = np.linalg.lstsq(slopes, noise, rcond=None)[0]
        missed = noise - slopes @ off
        several = np.split(missed / np.concatenate(weights), n[:1])
        alike = [correlations(replace(c, simulated=e)) for c, e in zip(each, several, strict=True)]
        C, nu = covariance_of(slopes, missed, alike)
        held = held + (abs(off) < scipy.special.stdtrit(nu, 0.975) * np.sqrt(np.diag(C)))
    assert (0.91 * n_set < held).all()  # standard deviation 1.4 %
    assert (held < 0.99 * n_set).all()


def test_a_miss_that_is_no_noise_is_alike_over_its_length(known):
    x, one = np.linspace(0.0, 1.0, 120), compare(*known)
    one = replace(one, x=x, measured=0.0 * x, simulated=np.sin(9.0 * x), window=None)
    assert correlations(one)[10] > 0.5


def test_a_run_is_compared_at_the_points_of_the_first(known, tmp_path):
    folder, curve = known[0], sc.FitCurve(known[1])
    points = compared(folder, curve, 0.3).x
    other = tmp_path / "other"
    shutil.copytree(folder, other)
    rows = (folder / "history.csv").read_text().splitlines(keepends=True)
    # A run of another step ends a row earlier or later.
    (other / "history.csv").write_text("".join(rows[:-1]))
    np.testing.assert_array_equal(compared(other, curve, 0.3, points).x, points)
    (other / "history.csv").write_text("".join(rows[: len(rows) // 2]))
    with pytest.raises(ValueError, match="the run must reach from"):
        compared(other, curve, 0.3, points)


@pytest.fixture
def by_formula(known, monkeypatch):
    """Return a function that fits plateau and last opening of a formula in place of a run."""
    x, rng = np.linspace(0.0, 10.0, 200), np.random.default_rng(3)
    noise, one = 0.03 * rng.standard_normal(x.size), replace(compare(*known), x=x, window=None)

    def force(values, effect):
        opening = values[OPENING] / 4.0 - 1.0
        return values[PLATEAU] * (1.0 - np.exp(-x)) * (1.0 + effect * opening * np.exp(-x / 3.0))

    def fitted(out, truth, effect, fails, **search):
        measured = force(truth, effect) + noise * truth[PLATEAU]

        def run_values(variants, several, *_):
            done = [SimpleNamespace(folder=lambda _, v=values: v) for values in several]
            status = ["failed" if fails(v[PLATEAU], v[OPENING]) else "done" for v in several]
            return list(zip(done, map(Outcome, status), strict=True))

        def compared(values, *_):
            return replace(one, measured=measured, simulated=force(values, effect))

        monkeypatch.setattr("shellcut.study.fit.run_values", run_values)
        monkeypatch.setattr("shellcut.study.fit_runs.compared", compared)
        monkeypatch.setattr("shellcut.study.fit_runs.window_of", lambda *_: 0.0)
        ranges = {PLATEAU: "2:48", OPENING: "1:16"}
        curves = [sc.FitCurve(known[1])]
        return sc.fit("guillotine", curves, out, settings=ranges, search=sc.Search(**search))

    return fitted


@pytest.mark.parametrize(
    ("effect", "fails"),
    [
        (1.0, lambda plateau, opening: plateau > 12.3),
        (0.05, lambda plateau, opening: opening > 4.1),
        (0.05, lambda plateau, opening: opening > 4.2 and plateau > 11.0),
        (1.0, lambda plateau, opening: plateau > 12.0 or opening > 4.2),
        (1.0, lambda plateau, opening: abs(np.log(opening / 4.0)) > 0.06),  # half a step runs
    ],
)
def test_a_run_that_fails_does_not_narrow_an_interval(by_formula, tmp_path, effect, fails):
    truth = {PLATEAU: 11.8, OPENING: 4.0}
    all_run, some_fail = (
        by_formula(tmp_path / name, truth, effect, one)
        for name, one in (("all", lambda *_: False), ("some", fails))
    )
    for one, other in zip(some_fail.values, all_run.values, strict=True):
        assert np.log(one.high / one.low) > 0.8 * np.log(other.high / other.low), one.key
    hardly = "the data hardly determine cohesive.opening_u" in str(all_run)
    assert hardly == (effect < 0.1)
    assert ("the data hardly determine cohesive.opening_u" in str(some_fail)) == hardly
    assert "could not be run" in str(some_fail)


def test_an_interval_is_unknown_without_any_run_beside_the_value(by_formula, tmp_path):
    truth = {PLATEAU: 11.0, OPENING: 4.5}
    found = by_formula(tmp_path, truth, 1.0, lambda plateau, opening: opening != 4.0)
    plateau, opening = found.values
    assert plateau.low < plateau.value < plateau.high < 1.2 * plateau.value
    assert opening.value == opening.start == 4.0
    assert np.isnan([opening.low, opening.high]).all()
    _, _, row, *said = str(found).splitlines()
    assert row.endswith("unknown mm")
    assert any(f"the interval of {OPENING} is unknown" in line for line in said)
    assert "hardly" not in str(found)
    assert json.loads((tmp_path / "fit.json").read_text())["values"][1]["low"] is None


@pytest.mark.parametrize(
    ("plateau", "opening", "at_bound"),
    [
        (12.0, 4.0, []),
        (2.2, 14.5, []),
        (1.5, 4.0, [PLATEAU]),
        (70.0, 4.0, [PLATEAU]),
        (12.0, 0.5, [OPENING]),
        (60.0, 20.0, [PLATEAU, OPENING]),
    ],
)
def test_a_value_kept_from_beyond_its_range_is_told(
    by_formula, tmp_path, plateau, opening, at_bound
):
    truth = {PLATEAU: plateau, OPENING: opening}
    found = by_formula(tmp_path, truth, 1.0, lambda *_: False)
    told = [note.partition(" lies at a bound")[0] for note in found.notes if "widen it" in note]
    assert told == at_bound


@pytest.mark.parametrize("method", ["local", "global"])
@pytest.mark.parametrize("truth", [3.0, 3.4])
def test_values_that_cannot_be_run_are_not_the_best(by_formula, tmp_path, truth, method):
    # The start is so far off that no force at all misses the curve by less.
    values = {PLATEAU: truth, OPENING: 4.0}
    found = by_formula(tmp_path, values, 1.0, lambda plateau, _: 4.0 < plateau < 7.0, method=method)
    assert found.rms_at_start > 2.0
    assert any("could not be run" in note for note in found.notes)
    value = found.values[0].value
    assert value > 7.0 if method == "local" else value == pytest.approx(truth, rel=0.05)


def test_a_fit_finds_the_plateau_and_is_not_run_again(known, tmp_path):
    lines, options = [], {"settings": {**SETTINGS, "plateau": "4:36"}, "executor": 1}

    def fitted():
        search = sc.Search(max_runs=12)
        curves = [sc.FitCurve(known[1])]
        return sc.fit("guillotine", curves, tmp_path, search=search, say=lines.append, **options)

    found = fitted()
    (plateau,) = found.values
    assert (plateau.key, plateau.start) == (PLATEAU, 12.0)
    assert plateau.value == pytest.approx(10.0, rel=0.01)  # of smoothed curves with a sawtooth
    assert plateau.low <= plateau.value <= plateau.high < 1.2 * plateau.value
    assert found.rms < 0.2 * found.rms_at_start
    assert found.n_run <= 12
    assert "the parameters no longer change" in found.notes[0]
    (doubt,) = (note for note in found.notes if note.startswith("distrust, at the fitted values: "))
    assert "The motion is too fast" in doubt
    assert any(note.startswith("the verdict distrusts ") for note in found.notes)
    assert (tmp_path / "fit.png").exists()
    page = report_found(tmp_path / "fit.json").read_text()
    value = f"{plateau.value:.5g}"
    for said in (PLATEAU, value, "95 % interval", "The motion is too fast", "<img"):
        assert said in page, said
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
        sc.fit("guillotine", [], tmp_path / "none", settings={PLATEAU: "6:24"}, search=search)
    assert not (tmp_path / "none").exists()


@pytest.fixture
def asked(monkeypatch):
    """Return a function that gives the curves a command would fit; nothing runs."""
    seen = {}

    def not_run(model, curves, out, **options):
        seen["curves"] = curves
        raise ValueError("not run")

    monkeypatch.setattr("shellcut.command_line.fit.fit", not_run)

    def curves_of(*arguments):
        assert main(["fit", "guillotine", *arguments, "--set=plateau=6:24", "-o", "x"]) == 2
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
        sc.fit("guillotine", curves, tmp_path / "none", settings={"plateau": "6:24"})
    assert not (tmp_path / "none").exists()


@pytest.mark.slow
def test_keys_that_do_the_same_to_the_curve_are_told(tmp_path):
    # Force is G h: a plateau and a thickness that are 12 MPa and 0.074 mm, from 10 and 0.08.
    start = {PLATEAU: 10.0, "material.thickness": 0.08}
    sc.read_model("guillotine", start).write(tmp_path / "start.toml")
    settings = {**SETTINGS, "membrane.length": 8, "travel": 4.0}
    known = sc.sweep("guillotine", {}, tmp_path / "known", settings=settings, executor=1, say=str)
    curve = curve_of(known.plan.runs[0].folder(known.folder))
    noise = np.random.default_rng(0).standard_normal(curve.x.size)
    force = curve.y + 0.03 * curve.y.max() * noise
    settings |= {key: f"{one / 3}:{one * 3}" for key, one in start.items()}
    found = sc.fit(
        tmp_path / "start.toml",
        [sc.FitCurve(sc.MeasuredCurve(curve.x, force, "mm", "N"))],
        tmp_path / "fit",
        settings=settings,
        executor=1,
        say=str,
    )
    assert found.correlation[0, 1] < -0.95
    (told,) = [note for note in found.notes if note.startswith("the data cannot tell")]
    assert f"{PLATEAU} and material.thickness apart" in told
    # Only the product is determined: to the noise of 3 % at a point.
    product = found.values[0].value * found.values[1].value
    assert product == pytest.approx(12.0 * 0.074, rel=0.03)


@pytest.mark.slow
def test_a_search_of_the_box_fits_several_curves_at_once(tmp_path):
    wedges = {"wedge_half_angle_deg": [10, 20]}
    settings = {**SETTINGS, PLATEAU: 12.0}
    known = sc.sweep("guillotine", wedges, tmp_path / "known", settings=settings, executor=1)
    curves = [
        sc.FitCurve(curve_of(run.folder(known.folder)), settings=run.values)
        for run in known.plan.runs
    ]
    # Half a curve of the first experiment: it takes no run of its own, and keeps its place.
    whole = curves[0].measured
    half = sc.MeasuredCurve(whole.x[whole.x < 1.0], whole.y[whole.x < 1.0], "mm", "N")
    curves.append(replace(curves[0], measured=half))
    sc.read_model("guillotine", {PLATEAU: 18.0}).write(tmp_path / "start.toml")
    found = sc.fit(
        tmp_path / "start.toml",
        curves,
        tmp_path / "fit",
        settings={**SETTINGS, PLATEAU: "6:54"},
        search=sc.Search(method="global", max_runs=30),
        executor=1,
    )
    assert found.values[0].value == pytest.approx(12.0, rel=0.01)
    assert [settings["wedge_half_angle_deg"] for settings in found.settings] == [10, 20, 10]
    assert [one.x[-1] < 1.0 for one in found.comparisons] == [False, False, True]
    assert found.n_run % 2 == 0
    assert found.rms < 0.02

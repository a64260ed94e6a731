"""Values of tensile tests against curves in closed form, refusals, and what the command writes."""

from math import log

import numpy as np
import pytest

from shellcut import ShellMaterial, evaluate_tensile, read_model
from shellcut.command_line import main
from shellcut.material.nominal_stress import largest_nominal_stress

# A bilinear film: modulus and hardening [MPa], yield 16 MPa at 0.8 %, strength at 40 %.
YOUNG, HARDENING, FIRST, END = 2000.0, 20.0, 0.008, 0.4
STRENGTH = YOUNG * FIRST + HARDENING * (END - FIRST)


def bilinear(*, noise=0.0, seed=0, slack=0.0):
    """Strain [-] and stress [MPa] of a specimen that breaks at its strength."""
    elastic, plastic = np.linspace(0, FIRST, 40)[:-1], np.linspace(FIRST, END, 200)
    strain = np.concatenate([elastic, plastic])
    stress = np.minimum(YOUNG * strain, YOUNG * FIRST + HARDENING * (strain - FIRST))
    if slack:
        strain, stress = np.append(0.0, strain + slack), np.append(0.0, stress)
    return strain, stress + noise * np.random.default_rng(seed).standard_normal(len(stress))


STRAIN, STRESS = bilinear()


def write(path, strain, stress, headings="time [s];strain [%];stress [MPa]"):
    """Write a table of one specimen as a test machine does."""
    rows = [
        f"{k};{100 * x:.6f};{y:.6f}" for k, (x, y) in enumerate(zip(strain, stress, strict=True))
    ]
    path.write_text("\n".join([headings, *rows]) + "\n")
    return path


def swift(young, strength, start, exponent):
    """Strain and stress [MPa] of a film that hardens by Swift's law, up to its largest force."""
    plastic = np.append(0.0, np.geomspace(1e-5, exponent, 400))
    true = strength * (start + plastic) ** exponent
    elastic = np.linspace(0.0, true[0] / young, 60)[:-1]
    logarithmic = np.append(elastic, plastic + true / young)
    nominal = np.append(young * elastic, true) * np.exp(-logarithmic)
    top = int(np.argmax(nominal)) + 1
    return np.expm1(logarithmic[:top]), nominal[:top]


@pytest.mark.parametrize(
    ("young", "strength", "start", "exponent"),
    [(2000.0, 60.0, 0.01, 0.25), (5000.0, 150.0, 0.002, 0.2), (300.0, 30.0, 0.05, 0.4)],
)
def test_a_law_known_beforehand_is_recovered(tmp_path, young, strength, start, exponent):
    strain, stress = swift(young, strength, start, exponent)
    section = evaluate_tensile(strain, stress).section()
    (tmp_path / "cut.toml").write_text('model = "opening"\n' + section)
    (layer,) = read_model(tmp_path / "cut.toml").sections["material"].made().layers
    film = layer.material
    assert film.elastic.young == pytest.approx(young, rel=0.01)
    # The offset, 0.2 %, is what a test can tell from elastic strain; the table ends at the largest
    # force, at a plastic strain of the exponent less the elastic strain and the start.
    plastic = np.linspace(0.002, exponent - start - strength / young, 300)
    wanted = strength * (start + plastic) ** exponent
    assert film.hardening.stress(plastic) == pytest.approx(wanted, rel=0.02)
    most = largest_nominal_stress(ShellMaterial([layer]), "uniaxial")
    assert most.stress == pytest.approx(stress.max(), rel=0.01)


def test_closed_form_of_a_bilinear_film():
    # 16 MPa + H (e - 0.8 %) = E (e - 0.2 %)
    at_yield = (YOUNG * 0.002 + (YOUNG - HARDENING) * FIRST) / (YOUNG - HARDENING)
    for slack in (0.0, 0.013):
        test = evaluate_tensile(*bilinear(slack=slack))
        assert test.young == pytest.approx(YOUNG, rel=1e-9)
        assert test.slack == pytest.approx(slack, abs=1e-9)
        wanted = YOUNG * FIRST + HARDENING * (at_yield - FIRST)
        assert test.yield_stress == pytest.approx(wanted, rel=1e-9)
        assert test.strength == pytest.approx(STRENGTH, rel=1e-12)
        assert test.strain_at_strength == pytest.approx(END, rel=1e-9)
    strain = np.linspace(FIRST, END, 10_000)
    nominal = YOUNG * FIRST + HARDENING * (strain - FIRST)
    true = nominal * (1 + strain)
    wanted = np.interp(test.plastic_strain, np.log1p(strain) - true / YOUNG, true)
    assert test.plastic_strain[0] == 0.0
    last = log(1 + END) - STRENGTH * (1 + END) / YOUNG
    assert test.plastic_strain[-1] == pytest.approx(last, rel=0.02)
    np.testing.assert_allclose(test.true_stress, wanted, rtol=0.01)  # rows are means of some points
    assert (np.diff(test.true_stress) >= 0.0).all()


@pytest.mark.parametrize("drop", [0.0, 2.0])
def test_a_curve_that_does_not_rise_beyond_yield(drop):
    strain = np.linspace(0.0, 0.3, 3001)
    test = evaluate_tensile(strain, np.minimum(1500.0 * strain, 20.0 - drop * (strain > 0.02)))
    assert test.yield_stress == test.strength == pytest.approx(20.0)
    np.testing.assert_allclose(test.true_stress, 20.0 * (1.0 + test.strain_at_strength))
    assert "falls from the yield point on" in str(test)
    assert "stress = [20." in test.section()


def test_noise():
    tests = [evaluate_tensile(*bilinear(noise=0.05, seed=k)) for k in range(20)]
    young = np.array([test.young for test in tests])
    # The slope of ten points over 0.2 % has a standard error of 0.05 MPa / (sqrt(10) 0.06 %).
    assert abs(young.mean() - YOUNG) < 3.0 * 26.0 / np.sqrt(20)
    assert np.mean([test.yield_stress for test in tests]) == pytest.approx(16.04, abs=0.05)
    for test in tests:
        assert (np.diff(test.true_stress) >= 0.0).all()
        assert not test.notes


@pytest.mark.parametrize("late", [0.0, 200.0])
def test_the_modulus_is_that_of_the_lines_own_zero(late):
    # A strength far above what the film bears at 0.25 % says nothing of where the line begins.
    strain = np.linspace(0.0, 0.4, 4001)
    stress = 10.0 * np.tanh(20.0 * strain) + late * strain**2
    zero = 0.0
    for _ in range(50):
        inside = (strain >= zero + 0.0005 - 1e-12) & (strain <= zero + 0.0025 + 1e-12)
        slope, level = np.polyfit(strain[inside], stress[inside], 1)
        zero = -level / slope
    test = evaluate_tensile(strain, stress)
    assert test.young == pytest.approx(slope, rel=1e-6)
    assert test.slack == pytest.approx(zero, abs=1e-7)


def test_preload_few_points_and_what_bends():
    strain = np.linspace(0.0, 0.4, 401)  # three points in the range
    test = evaluate_tensile(strain, np.minimum(2000.0 * strain + 6.0, 16.0 + 20.0 * strain))
    assert test.young == pytest.approx(2000.0, rel=1e-9)
    assert test.slack == pytest.approx(-0.003, rel=1e-6)
    assert "3 points in the elastic range, 5 make a line" in str(test)
    foil = np.linspace(0.0, 0.01, 400)  # yields at 0.1 %
    test = evaluate_tensile(foil, np.minimum(70e3 * foil, 70.0 + 500.0 * (foil - 1e-3)))
    assert "bends in the elastic range: 7e+04 MPa in its lower half, 500 MPa" in str(test)
    strain = np.linspace(0.0, 0.0035, 50)
    test = evaluate_tensile(strain, 6e4 * strain)
    assert "tears before a plastic strain of 0.2 %: no yield" in str(test)
    assert "hardening" not in test.section()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"strain": [0.0, 1.0]}, "equally long, got .2,. and .239,."),
        ({"gauge_length": -1.0, "offset": 0.0}, "gauge_length must be above 0, .*; offset must"),
        ({"stress": -STRESS}, "must rise above 0"),
        ({"strain": STRAIN[::-1]}, "strains must not fall, .* in row 2"),
        ({"stress": np.append(np.nan, STRESS[1:])}, "must be numbers, got nan in row 1"),
        ({"strain": STRAIN / 1e3}, "must span strains from 0.05 to 0.25 %"),
        ({"stress": np.append(np.full(238, 5.0), 5.1)}, "must rise with the strain|must span"),
    ],
)
def test_refusals(change, words):
    with pytest.raises(ValueError, match=words):
        evaluate_tensile(**{"strain": STRAIN, "stress": STRESS, **change})


def test_the_command_writes_a_section_and_a_picture(tmp_path, capsys):
    pytest.importorskip("matplotlib", reason="needs shellcut-fem[plot]")
    path, out = write(tmp_path / "md.csv", STRAIN, STRESS), tmp_path / "out"
    columns = ["--columns", "strain", "3", "--units", "%", "MPa"]
    arguments = ["tensile", str(path), *columns, "-o", str(out)]
    assert main(arguments) == 0
    assert "Young's modulus     2000 MPa" in capsys.readouterr().out
    files = {"material.toml", "shellcut.files", "tensile.png"}
    assert {one.name for one in out.iterdir()} == files
    assert main(arguments) == 0  # twice the same, but never over somebody else's
    (tmp_path / "material.toml").write_text("mine")
    assert main([*arguments[:-1], str(tmp_path)]) == 2
    assert (tmp_path / "material.toml").read_text() == "mine"
    assert main(["tensile", str(path), *columns[:-2], "furlong", "MPa"]) == 2
    assert "furlong" in capsys.readouterr().err
    # Extension and force are those of the specimen.
    extension = write(tmp_path / "raw.csv", 0.5 * STRAIN, 1.11 * STRESS)
    more = ["--units", "mm", "N", "--gauge-length", "50", "--section", "1.11"]
    assert main(["tensile", str(extension), "--columns", "2", "3", *more]) == 0
    said = capsys.readouterr().out
    assert "Young's modulus     2000 MPa" in said
    assert f"{STRENGTH:.4g} MPa" in said

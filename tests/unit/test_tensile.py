"""Figures of tensile tests against curves in closed form, refusals by line, files written."""

import json
from math import log

import numpy as np
import pytest

from shellcut import CohesiveLaw, ShellMaterial, evaluate_tensile, read_measured_curve, read_model
from shellcut.command_line import main
from shellcut.formats.errors import FileError
from shellcut.material.nominal_stress import largest_nominal_stress
from shellcut.tensile.direction import proposed_law

# A bilinear film: modulus and hardening [MPa], yield 16 MPa at 0.8 %, strength at 40 %, then
# an opening over 50 mm by the law.
YOUNG, HARDENING, FIRST, END = 2000.0, 20.0, 0.008, 0.4
GAUGE = 50.0
STRENGTH = YOUNG * FIRST + HARDENING * (END - FIRST)
LAW = CohesiveLaw(strength=STRENGTH, plateau=14.0, opening_a=0.6, opening_p=3.0, opening_u=4.5)


def bilinear(*, noise=0.0, seed=0, slack=0.0, scale=1.0, points=(40, 200, 200), fall=True):
    """Strain [-] and stress [MPa] of a specimen."""
    rng = np.random.default_rng(seed)
    n_elastic, n_plastic, n_fall = points
    strain = np.concatenate(
        [np.linspace(0, FIRST, n_elastic)[:-1], np.linspace(FIRST, END, n_plastic)]
    )
    stress = np.minimum(YOUNG * strain, YOUNG * FIRST + HARDENING * (strain - FIRST))
    if fall:
        opening = np.linspace(0, LAW.opening_u, n_fall)[1:]
        falling = np.array([LAW.traction(x) for x in opening])
        # the rest of the specimen gives back its elastic strain
        back = END + opening / GAUGE - (STRENGTH - falling) / YOUNG
        strain, stress = np.append(strain, back), np.append(stress, falling)
    if slack:
        strain, stress = np.append(0.0, strain + slack), np.append(0.0, stress)
    return strain, scale * stress + noise * rng.standard_normal(len(stress))


def write(path, *curves, headings="strain {k} [%];stress {k} [MPa]", factor=100.0, bare=""):
    """Write a table of specimens side by side, as a spreadsheet does."""
    lines = [";".join(headings.format(k=k + 1) for k in range(len(curves)))]
    for row in range(max(len(x) for x, _ in curves)):
        cells = [f"{factor * x[row]:.6f};{y[row]:.6f}" if row < len(x) else ";" for x, y in curves]
        lines.append(";".join(cells))
    path.write_text(bare + "\n".join(lines) + "\n")
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


class TestMaterial:
    @pytest.mark.parametrize(
        ("young", "strength", "start", "exponent"),
        [(2000.0, 60.0, 0.01, 0.25), (5000.0, 150.0, 0.002, 0.2), (300.0, 30.0, 0.05, 0.4)],
    )
    def test_a_law_known_beforehand_is_recovered(self, tmp_path, young, strength, start, exponent):
        curve = swift(young, strength, start, exponent)
        test = evaluate_tensile(write(tmp_path / "film.csv", curve))
        test.write(tmp_path / "out")
        text = (tmp_path / "out" / "material.toml").read_text()
        (tmp_path / "cut.toml").write_text('model = "opening"\n' + text)
        (layer,) = read_model(tmp_path / "cut.toml").sections["material"].made().layers
        film = layer.material
        assert film.elastic.young == pytest.approx(young, rel=0.01)
        # the offset, 0.2 %, is what a test can tell from elastic strain; the table ends at the
        # largest force, at a plastic strain of the exponent less the elastic one and the start
        plastic = np.linspace(0.002, exponent - start - strength / young, 300)
        wanted = strength * (start + plastic) ** exponent
        assert film.hardening.stress(plastic) == pytest.approx(wanted, rel=0.02)
        # and with it the largest nominal stress, at which the record ends
        most = largest_nominal_stress(ShellMaterial([layer]), "uniaxial")
        assert most.stress == pytest.approx(curve[1].max(), rel=0.01)

    def test_noise_and_scatter_do_not_make_a_table_that_falls(self, tmp_path):
        curves = [bilinear(noise=0.2, seed=k, scale=1.0 + 0.03 * k) for k in range(5)]
        test = evaluate_tensile(write(tmp_path / "film.csv", *curves), gauge_length=GAUGE)
        test.write(tmp_path / "out")
        text = (tmp_path / "out" / "material.toml").read_text()
        (tmp_path / "cut.toml").write_text('model = "opening"\n' + text)
        (layer,) = read_model(tmp_path / "cut.toml").sections["material"].made().layers
        assert layer.material.hardening.first_yield == pytest.approx(16.0 * 1.06, rel=0.03)

    def test_a_film_that_does_not_yield_has_none(self, tmp_path):
        strain = np.linspace(0.0, 0.008, 50)
        test = evaluate_tensile(write(tmp_path / "film.csv", (strain, YOUNG * strain)))
        assert test.directions[""].material() is None
        test.write(tmp_path / "out")
        assert not (tmp_path / "out" / "material.toml").exists()


class TestClosedForm:
    def test_of_one_curve_without_noise(self, tmp_path):
        found = evaluate_tensile(write(tmp_path / "film.csv", bilinear()), gauge_length=GAUGE)
        film = found.directions[""]
        (one,) = film.figures
        assert one.young == pytest.approx(YOUNG, rel=1e-5)  # six digits in the file
        # 16 MPa + H (e - 0.8 %) = E (e - 0.2 %)
        at_yield = (YOUNG * 0.002 + (YOUNG - HARDENING) * FIRST) / (YOUNG - HARDENING)
        wanted = YOUNG * FIRST + HARDENING * (at_yield - FIRST)
        assert one.yield_stress == pytest.approx(wanted, rel=1e-5)
        assert one.strength == pytest.approx(STRENGTH, rel=1e-6)
        assert one.strain_at_strength == pytest.approx(END, rel=1e-5)
        assert film.fracture_energy.mean == pytest.approx(LAW.fracture_energy, rel=1e-3)
        found = evaluate_tensile(
            write(tmp_path / "film.csv", bilinear(slack=0.013)), gauge_length=GAUGE
        )
        (one,) = found.directions[""].figures
        assert one.slack == pytest.approx(0.013, rel=1e-3)
        assert one.young == pytest.approx(YOUNG, rel=1e-3)
        assert one.strain_at_strength == pytest.approx(END, rel=1e-4)
        strain, stress = bilinear()
        force = stress * 15.0 * 0.074 / 4.4482216152605
        path = tmp_path / "film.csv"
        extension = strain * GAUGE / 25.4
        write(path, (extension, force), headings="travel [in];load [lbf]", factor=1.0)
        found = evaluate_tensile(path, gauge_length=GAUGE, width=15.0, thickness=0.074)
        (one,) = found.directions[""].figures
        assert one.young == pytest.approx(YOUNG, rel=1e-3)  # six decimals of an inch
        assert one.strength == pytest.approx(STRENGTH, rel=1e-5)

    def test_the_hardening_curve_is_that_of_the_line(self, tmp_path):
        film = evaluate_tensile(write(tmp_path / "film.csv", bilinear())).directions[""]
        plastic, true, scatter, n = film.hardening()
        strain = np.linspace(FIRST, END, 10_000)
        nominal = YOUNG * FIRST + HARDENING * (strain - FIRST)
        wanted = np.interp(
            plastic, np.log1p(strain) - nominal * (1 + strain) / YOUNG, nominal * (1 + strain)
        )
        assert (plastic[0], n) == (0.0, 1)
        assert plastic[-1] == pytest.approx(log(1 + END) - STRENGTH * (1 + END) / YOUNG, rel=0.02)
        np.testing.assert_allclose(true, wanted, rtol=0.01)  # rows are means of some points
        assert (np.diff(true) >= 0.0).all()
        assert np.isnan(scatter).all()

    def test_with_noise_within_the_stated_scatter(self, tmp_path):
        curves = [bilinear(noise=0.05, seed=k) for k in range(6)]
        film = evaluate_tensile(
            write(tmp_path / "film.csv", *curves), gauge_length=GAUGE
        ).directions[""]
        young = film.spread("young")
        assert young.n == 6
        # the mean of six lies within three of its standard errors, and the scatter is that of
        # the slope itself: 0.05 MPa on ten points over 0.2 %
        assert abs(young.mean - YOUNG) < 3.0 * young.deviation / np.sqrt(6)
        stated = np.mean([one.young_error for one in film.figures])
        assert 0.4 * stated < young.deviation < 2.5 * stated
        assert film.spread("yield_stress").mean == pytest.approx(16.04, abs=0.05)
        assert film.spread("strength").mean == pytest.approx(STRENGTH, abs=0.15)
        energy = film.fracture_energy
        assert energy.mean == pytest.approx(LAW.fracture_energy, rel=0.03)
        law = film.law()
        assert law.fracture_energy == pytest.approx(energy.mean, rel=1e-9)
        for name, band in (("plateau", 0.4), ("opening_a", 0.15), ("opening_p", 0.25)):
            assert getattr(law, name) == pytest.approx(getattr(LAW, name), abs=band), name
        assert law.opening_u == pytest.approx(LAW.opening_u, abs=0.25)

    def test_a_law_gives_back_itself(self):
        opening = np.linspace(0.0, 4.0, 101)
        law = CohesiveLaw()
        stress = np.array([law.traction(x) for x in opening])
        found = proposed_law(opening, stress, law.fracture_energy)
        assert found.fracture_energy == pytest.approx(law.fracture_energy, rel=1e-12)
        assert found.plateau == pytest.approx(law.plateau, rel=0.01)
        for name in ("opening_a", "opening_p", "opening_u"):
            assert getattr(found, name) == pytest.approx(getattr(law, name), abs=0.05), name
        assert found.onset == pytest.approx(law.onset, rel=0.02)


class TestDirections:
    def test_by_name_and_by_heading(self, tmp_path):
        write(tmp_path / "md.csv", bilinear(), bilinear(scale=1.1))
        both = "strain [%];stress CD {k} [MPa]"
        write(tmp_path / "cd.csv", bilinear(scale=0.6), bilinear(scale=0.7), headings=both)
        found = evaluate_tensile(
            {"MD": tmp_path / "md.csv", "": [tmp_path / "cd.csv"]}, gauge_length=GAUGE
        )
        assert list(found.directions) == ["MD", "CD"]
        assert found.directions["MD"].spread("young").mean == pytest.approx(1.05 * YOUNG, rel=1e-4)
        spread = found.directions["CD"].spread("young")
        assert spread.mean == pytest.approx(0.65 * YOUNG, rel=1e-4)
        assert spread.deviation == pytest.approx(0.1 * YOUNG / np.sqrt(2.0), rel=1e-3)
        said = "\n".join(found.sentences())
        assert "take the law of the specimens cut across the blade's way" in said
        assert "MD: 2 specimens: the scatter is rough, ISO 527 asks for 5" in said

    def test_one_strain_for_all_and_specimens_of_other_lengths(self, tmp_path):
        strain, stress = bilinear()
        path = tmp_path / "film.csv"
        lines = ["strain [%];45° 1 [MPa];45° 2 [MPa];time [s]"]
        for k, (x, y) in enumerate(zip(strain, stress, strict=True)):
            second = f"{1.2 * y:.5f}" if k < 235 else "0"
            lines.append(f"{100 * x:.5f};{y:.5f};{second};{k}")
        path.write_text("\n".join(lines))
        found = evaluate_tensile(path)
        assert list(found.directions) == ["45°"]
        assert [one.specimen.broken for one in found.directions["45°"].figures] == [True, True]
        shorter = write(tmp_path / "two.csv", bilinear(), bilinear(points=(30, 80, 50)))
        assert len(evaluate_tensile(shorter).directions[""].figures) == 2


# Headings of test machines, what separates columns and decimals, and what the record holds: strain
# [-], nominal stress [MPa], extension over 50 mm, force on 15 x 0.074 mm, true values, or noise.
HEADINGS = [
    ("Prüfzeit;Standardweg;Standardkraft\ns;mm;N", ";", ",", ("?", "mm", "N"), "cp1252"),
    ("Dehnung in %\tSpannung in N/mm²", "\t", ",", ("%", "MPa"), "utf-16"),
    ("No;Extension;Load\n-;in;lbF", ";", ".", ("?", "in", "lbf"), "ascii"),
    ("Strain % (DIC)\tLoad [N] (cell 1)", "\t", ".", ("%", "N"), "ascii"),
    ("%;MPa", ";", ".", ("%", "MPa"), "ascii"),
    ("Humidity [%];Strain [-];Stress [kPa]", ";", ".", ("?", "-", "kPa"), "utf-8-sig"),
    ("Drive output[%],Extension[mm],Force[N]", ",", ".", ("?", "mm", "N"), "ascii"),
    ("Time (s),Tensile strain (Extension) (%),Load (N)", ",", ".", ("?", "%", "N"), "ascii"),
    ("Time,Extension,Load\n(s),(in),(lbF)", ",", ".", ("?", "in", "lbf"), "ascii"),
    ("Temperature\tStroke Strain\tStress\n°C\t%\tkgf/mm²", "\t", ".", ("?", "%", "kgf"), "utf-8"),
    ("# film 3\n# strain, %, stress, N/m²", ",", ".", ("%", "Pa"), "utf-8"),
    ("# strain [%], stress [MPa]", " ", ".", ("%", "MPa"), "ascii"),
    ("# % Strain / Stress [MPa]\n# Strain [%] Stress [MPa]", "\t", ".", ("%", "MPa"), "ascii"),
    ("strain;stress\n%;MPa", ";", ",", ("%", "MPa"), "ascii"),
    ("Strain in/in\tStress MPa", "\t", ".", ("-", "MPa"), "ascii"),
    ("true strain [%];true stress [MPa]", ";", ".", ("ln %", "true"), "ascii"),
    ("wahre Dehnung [-];Spannung [MPa]", ";", ",", ("ln", "MPa"), "ascii"),
    ("true stress [MPa];stress [MPa];strain [%]", ";", ".", ("true", "MPa", "%"), "ascii"),
    (
        "Table 1\n,Max. (N),L\n1,9.3,7\nTime (s),Extension (mm),Load (N)",
        ",",
        ".",
        ("?", "mm", "N"),
        "ascii",
    ),
    ("Crosshead absolute;Standard travel;Kraft\nmm;mm;N", ";", ".", ("?", "mm", "N"), "ascii"),
]


def machine(path, headings, separator, decimal, columns, encoding):
    """Write a record of the bilinear film as a test machine does."""
    strain, stress = bilinear()
    values = {
        "?": np.linspace(30.0, 50.0, len(strain)),
        "-": strain,
        "%": 100.0 * strain,
        "ln": np.log1p(strain),
        "ln %": 100.0 * np.log1p(strain),
        "mm": GAUGE * strain,
        "in": GAUGE * strain / 25.4,
        "MPa": stress,
        "true": stress * (1.0 + strain),
        "kPa": 1e3 * stress,
        "Pa": 1e6 * stress,
        "kgf": stress / 9.80665,
        "N": 15.0 * 0.074 * stress,
        "lbf": 15.0 * 0.074 * stress / 4.4482216152605,
    }
    rows = zip(*(values[column] for column in columns), strict=True)
    lines = [separator.join(f"{x:.9g}".replace(".", decimal) for x in row) for row in rows]
    path.write_bytes("\n".join([headings, *lines]).encode(encoding))
    return path


class TestColumns:
    def evaluated(self, path, **options):
        options = {"gauge_length": GAUGE, "width": 15.0, "thickness": 0.074, **options}
        return evaluate_tensile(path, **options)

    def check(self, found):
        (one,) = found.directions[""].figures
        assert one.young == pytest.approx(YOUNG, rel=1e-5)
        assert one.strength == pytest.approx(STRENGTH, rel=1e-6)
        assert one.strain_at_strength == pytest.approx(END, rel=1e-5)

    @pytest.mark.parametrize("case", HEADINGS[:-1], ids=lambda case: case[0])
    def test_headings_of_machines_give_the_same_film(self, tmp_path, case):
        self.check(self.evaluated(machine(tmp_path / "film.csv", *case)))

    def test_the_columns_used_are_said(self, tmp_path):
        found = self.evaluated(machine(tmp_path / "film.csv", *HEADINGS[0]))
        said = "film 1: strain from 'Standardweg' in mm over 50 mm and stress from 'Standardkraft'"
        assert f"{said} in N over 15 mm x 0.074 mm" in str(found)
        assert "where they are those of the cross-head" in str(found)
        assert f"{said} in N over 15 mm x 0.074 mm" in found.figures()["sentences"]

    def test_columns_that_compete_are_asked_for(self, tmp_path, capsys):
        path = machine(tmp_path / "film.csv", *HEADINGS[-1])
        options = ["--gauge-length", "50", "--width", "15", "--thickness", "74 um"]
        assert main(["tensile", str(path), *options]) == 2
        told = capsys.readouterr().err
        assert "extension may be column 1: 'Crosshead absolute' or 2: 'Standard travel'" in told
        assert '--columns "1, 3"' in told
        assert main(["tensile", str(path), *options, "--columns", "standard travel, 3"]) == 0
        assert "strain from 'Standard travel' in mm over 50 mm" in capsys.readouterr().out
        self.check(self.evaluated(path, columns=("Standard travel", "Kraft")))

    @pytest.mark.parametrize(
        ("headings", "given"),
        [
            ("Time,Strain,Stress", "%, N"),
            ("Time,Strain,Stress", "s, %, N"),
            ("Time,foo,bar", None),
            (None, "s; %; N"),
        ],
    )
    def test_units_by_hand(self, tmp_path, headings, given):
        case = (headings or "1,2,3", ",", ".", ("?", "%", "MPa"), "ascii")
        path = machine(tmp_path / "film.csv", *case)
        if headings is None:
            path.write_text(path.read_text().split("\n", 1)[1])
        with pytest.raises(ValueError, match=r"needs a column .*columns=.* units=|columns="):
            self.evaluated(path)
        if given:
            self.check(self.evaluated(path, units=given.replace("N", "MPa")))
        self.check(self.evaluated(path, columns=[2, 3], units="%, MPa"))

    @pytest.mark.parametrize(
        ("headings", "options", "words"),
        [
            ("Humidity [%];Stress [MPa]", {}, "needs a column of strain .* 1: 'Humidity .%.'"),
            ("plastic strain [-];true stress [MPa]", {}, "needs a column of strain"),
            ("Strain 1 [%];Strain 2 [%];Stress [MPa]", {}, "may be column 1: .* or 2:"),
            ("way [mm];Load cell A [N];Load cell B [N]", {}, "force may be column 2: .* or 3:"),
            ("way [mm];Force [N];Travel [mm];Load [N]", {}, "extension may .*; the force may be"),
            ("Strain;Force (kg)", {}, "2: 'Force .kg.'; choose .* and give units="),
            ("Strain [%];Stress [MPa]", {"columns": "Strian, 3"}, "mean 'Strain'.*; column must"),
            ("Strain [%];Stress [MPa]", {"columns": "1"}, "needs one of stress"),
            ("a;b;c", {"units": "%, MPa, N, s"}, "units must be 3, .* or two, .* got 4"),
            ("a;b", {"units": "%, furlong"}, "units must be known, .* got 'furlong'"),
            ("a [s];b [MPa]", {"columns": "1,2"}, "'a' must have a unit of strain .* got 's'"),
        ],
    )
    def test_what_is_not_sure_is_asked(self, tmp_path, headings, options, words):
        rows = [";".join(f"{0.1 * k * (j + 1):.3f}" for j in range(4)) for k in range(9)]
        n = len(headings.split(";"))
        lines = [";".join(row.split(";")[:n]) for row in rows]
        (tmp_path / "film.csv").write_text("\n".join([headings, *lines]))
        with pytest.raises(ValueError, match=words):
            self.evaluated(tmp_path / "film.csv", **options)

    def test_specimens_side_by_side_find_their_stress_by_name(self, tmp_path):
        (x, y), (_, other) = bilinear(), bilinear(scale=0.5)
        path = tmp_path / "film.csv"
        for heading, row in (
            ("PE strain [%];PET strain [%];PET stress [MPa];PE stress [MPa]", (x, x, other, y)),
            ("stress 1 [MPa];strain 1 [%];strain 2 [%];stress 2 [MPa]", (y, x, x, other)),
        ):
            lines = [
                ";".join(
                    f"{100 * v if c is x else v:.6f}" for v, c in zip(values, row, strict=True)
                )
                for values in zip(*row, strict=True)
            ]
            path.write_text("\n".join([heading, *lines]))
            found = evaluate_tensile(path).directions[""].figures
            assert [one.young for one in found] == pytest.approx([YOUNG, 0.5 * YOUNG], rel=1e-5)


class TestModulus:
    """Of ISO 527-1: the line's slope between 0.05 and 0.25 %, from its own zero."""

    def young(self, path, strain, stress):
        (one,) = evaluate_tensile(write(path, (strain, stress))).directions[""].figures
        return one

    @pytest.mark.parametrize("late", [0.0, 200.0])
    def test_of_a_curve_that_bends_is_that_of_its_own_zero(self, tmp_path, late):
        # a strength far above what the film bears at 0.25 % says nothing of where the line begins
        strain = np.linspace(0.0, 0.4, 4001)
        stress = 10.0 * np.tanh(20.0 * strain) + late * strain**2
        zero = 0.0
        for _ in range(50):
            inside = (strain >= zero + 0.0005 - 1e-12) & (strain <= zero + 0.0025 + 1e-12)
            slope, level = np.polyfit(strain[inside], stress[inside], 1)
            zero = -level / slope
        one = self.young(tmp_path / "film.csv", strain, stress)
        assert one.young == pytest.approx(slope, rel=1e-4)  # of digits in the file
        assert one.slack == pytest.approx(zero, abs=1e-7)

    def test_a_foot_lies_before_the_line(self, tmp_path):
        # quadratic up to 1 %, then straight with 2000 MPa; its zero lies at half of that
        strain = np.linspace(0.0, 0.2, 4001)
        stress = np.where(strain < 0.01, 1e5 * strain**2, 2000.0 * (strain - 0.005))
        one = self.young(tmp_path / "film.csv", strain, np.minimum(stress, 30.0))
        assert one.young == pytest.approx(2000.0, rel=0.005)
        assert one.slack == pytest.approx(0.005, rel=0.01)
        assert "the curve gets steeper up to a strain of 0.9" in "\n".join(one.sentences)

    def test_preload_few_points_and_brittle_films(self, tmp_path):
        strain = np.linspace(0.0, 0.4, 401)  # two points in the range
        stress = np.minimum(2000.0 * strain + 6.0, 16.0 + 20.0 * strain)
        one = self.young(tmp_path / "film.csv", strain, stress)
        assert one.young == pytest.approx(2000.0, rel=1e-5)
        assert one.slack == pytest.approx(-0.003, rel=1e-4)
        assert "secant of interpolated stresses" in "\n".join(one.sentences)
        strain = np.linspace(0.0, 0.002, 50)
        one = self.young(tmp_path / "film.csv", strain, 6e4 * strain)
        assert one.young == pytest.approx(6e4, rel=1e-4)
        assert "the curve ends between strains of 0.05 and 0.25 %" in "\n".join(one.sentences)


class TestHonestSentences:
    def said(self, path, **options):
        return "\n".join(evaluate_tensile(path, **options).sentences())

    def test_energy_and_its_reservation(self, tmp_path):
        path = write(tmp_path / "film.csv", bilinear())
        said = self.said(path, gauge_length=GAUGE)
        assert "fracture energy 55.44 kJ/m² = gauge length 50 mm x 1.109 N/mm² below" in said
        assert "openings and energy are upper bounds" in said
        assert "one specimen: the scatter is unknown" in said
        assert "spreads along the gauge length" not in said
        assert "no law: give the gauge_length" in self.said(path)

    def test_a_curve_that_bends_early(self, tmp_path):
        # a foil that yields at 0.1 %: the modulus comes from below
        strain = np.append(np.linspace(0.0, 0.01, 400), [0.0101, 0.0102])
        stress = np.append(np.minimum(70e3 * strain, 70.0 + 500.0 * (strain - 1e-3))[:400], [5, 0])
        path = write(tmp_path / "foil.csv", (strain, stress))
        found = evaluate_tensile(path).directions[""].figures[0]
        assert found.young == pytest.approx(70e3, rel=0.05)
        assert "the film yields between strains of 0.05 and 0.25 %" in "\n".join(found.sentences)

    def test_breaks_are_told(self, tmp_path):
        path = write(tmp_path / "film.csv", bilinear(fall=False))
        said = self.said(path, gauge_length=GAUGE)
        assert "no fall after the strength is recorded" in said
        assert "the record ends at 23.8 MPa, 100% of the strength, before the break" in said
        assert "no law: no specimen shows a fall" in said
        assert "0 specimens" not in str(evaluate_tensile(path))
        strain, stress = bilinear(fall=False)
        path = write(tmp_path / "film.csv", (np.append(strain, 0.4001), np.append(stress, 0.1)))
        # 23.84² / 2 E
        assert "at most 0.142 N/mm² times the gauge length" in self.said(path)
        more = np.linspace(END + 0.01, 3.0, 100)
        curve = np.append(strain, [*more, 3.001]), np.append(stress, [*(0 * more + 22.0), 0.0])
        said = self.said(write(tmp_path / "pe.csv", curve), gauge_length=GAUGE)
        assert "1 of 1 specimens hold over 80 % of the strength half-way" in said
        assert "it broke at once from 92% of the strength" in said
        strain = np.linspace(0.0, 0.01, 200)
        stress = np.append(2000.0 * strain[:-1], 0.0)
        said = self.said(write(tmp_path / "film.csv", (strain, stress)))
        assert "parts before a plastic strain of 0.2 %: no yield stress" in said


class TestRefusals:
    @pytest.mark.parametrize(
        ("text", "words"),
        [
            ("0;0\n1;2\n2;3\n", "2 columns without headings; choose .* give units="),
            ("strain;stress\n0;0\n1;2\n", "1: 'strain', 2: 'stress'; choose .* units="),
            ("time [s];stress [MPa]\n0;0\n1;2\n", "needs a column of strain"),
            (
                "1 [%];2 [%];1 [MPa];2 [MPa];3 [MPa]\n0;0;0;0;0\n1;1;1;1;1\n",
                "strain may be column 1: '1 .%.' or 2: '2 .%.'; the stress may be column 3: ",
            ),
            ("way [mm];force [N]\n0;0\n1;1\n", "gauge_length; forces need width and thickness"),
            (
                "e [%];s [MPa]\n0;0\n1;-2\n2;-3\n",
                "'s .MPa.' must rise above 0; is tension negative",
            ),
            ("e [%];s [MPa]\n0;0\n1;2\n2;3\n", "must have 5 points up to the break, got 3"),
            ("e [%];s [MPa]\n0;0\n1;2\n2;x\n3;4;5\n", "line 4: must be a number, got 'x'; line 5"),
            ("e [%];s [MPa]\n0;0\n1;1\n2;2\n0.5;2\n3;3\n4;4\n", "reverses at 0.5: .* in line 5"),
            (
                "e [-];s [MPa]\n0;0\n1;1\n2;2\n3;3\n40;4\n",
                "strain must stay below 20.* from line 6 on; is it in %",
            ),
            ("e [%];s [MPa]\n0;5\n1;4\n2;5\n3;4\n4;5\n5;5.1", "must rise with the strain"),
        ],
    )
    def test_rough_input(self, tmp_path, text, words):
        path = tmp_path / "film.csv"
        path.write_text(text)
        with pytest.raises(ValueError, match=words) as caught:
            evaluate_tensile(path)
        assert str(path) in str(caught.value)

    def test_files_and_dimensions(self, tmp_path):
        with pytest.raises(ValueError, match=r"(?s)a\.csv: cannot be read.*b\.csv: cannot be read"):
            evaluate_tensile([tmp_path / "a.csv", tmp_path / "b.csv"])
        assert issubclass(FileError, ValueError)
        with pytest.raises(ValueError, match=r"gauge_length must be .* got -1 mm; width must be"):
            evaluate_tensile(tmp_path / "a.csv", gauge_length=-1, width=float("nan"))
        with pytest.raises(ValueError, match="offset must be a strain between 0 and 1, got 0"):
            evaluate_tensile(tmp_path / "a.csv", offset=0)
        with pytest.raises(ValueError, match="at least one file"):
            evaluate_tensile([])


class TestCommand:
    def test_figures_files_and_picture(self, tmp_path, capsys):
        pytest.importorskip("matplotlib", reason="needs shellcut[plot]")
        md = write(tmp_path / "md.csv", *(bilinear(noise=0.05, seed=k) for k in range(3)))
        cd = write(tmp_path / "cd.csv", bilinear(scale=0.8))
        out = tmp_path / "out"
        arguments = ["tensile", f"MD={md}", f"CD={cd}", "--gauge-length", "5 cm", "-o", str(out)]
        assert main(arguments) == 0
        told = capsys.readouterr().out
        assert "Young's modulus" in told
        assert "law: opening_u" in told
        names = ["hardening_CD.csv", "hardening_MD.csv", "law_CD.toml", "law_MD.toml"]
        names += ["material_CD.toml", "material_MD.toml"]
        assert sorted(path.name for path in out.iterdir()) == [
            *names,
            "shellcut.files",
            "tensile.json",
            "tensile.png",
        ]
        # Twice the same, but never over what is read, or what somebody else has put there.
        assert main(arguments) == 0
        hardening = write(out / "hardening_MD.csv", bilinear())
        assert main([arguments[0], f"MD={hardening}", *arguments[3:]]) == 2
        assert "hardening_MD.csv is read here and would be replaced" in capsys.readouterr().err
        assert main(arguments) == 0
        (tmp_path / "material_MD.toml").write_text("mine")
        before = sorted(tmp_path.iterdir())
        assert main([*arguments[:-1], str(tmp_path)]) == 2
        assert "has material_MD.toml" in capsys.readouterr().err
        assert sorted(tmp_path.iterdir()) == before
        assert (tmp_path / "material_MD.toml").read_text() == "mine"
        kept = json.loads((out / "tensile.json").read_text())["directions"]
        assert kept["CD"]["young"]["mean"] == pytest.approx(0.8 * YOUNG, rel=1e-3)
        assert kept["CD"]["young"]["deviation"] is None
        # what was written is read back: a section of a model file, a table
        (tmp_path / "cut.toml").write_text(
            'model = "opening"\n' + (out / "law_MD.toml").read_text()
        )
        law = read_model(tmp_path / "cut.toml").sections["cohesive"].made()
        assert law.fracture_energy == pytest.approx(kept["MD"]["fracture_energy"]["mean"], rel=1e-4)
        curve = read_measured_curve(out / "hardening_MD.csv", x=1, y=2)
        assert (curve.x[0], curve.y_unit) == (0.0, "MPa")

    def test_bad_arguments_and_a_name_with_a_sign(self, tmp_path, capsys, monkeypatch):
        arguments = ["--gauge-length", "5 kg", "--width", "wide", "--offset", "x"]
        assert main(["tensile", str(tmp_path / "no.csv"), *arguments]) == 2
        told = capsys.readouterr().err
        assert "--gauge-length must be a number in mm" in told
        assert "--width must be a number in mm" in told
        assert "--offset must be a number of per cent" in told
        monkeypatch.chdir(tmp_path)
        write(tmp_path / "T=23.csv", bilinear())
        assert main(["tensile", "T=23.csv"]) == 0
        assert "no law: give the gauge_length" in capsys.readouterr().out

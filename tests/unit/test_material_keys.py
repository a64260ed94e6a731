"""The keys of a film that yields: what they build, what they refuse, presets by name."""

import math

import numpy as np
import pytest

from shellcut import read_model
from shellcut.material import (
    CowperSymonds,
    Elastic,
    Hencky,
    JohnsonCook,
    Linear,
    Orthotropic,
    Plastic,
    ShellMaterial,
    Swift,
    Table,
    Voce,
)
from shellcut.material.nominal_stress import largest_nominal_stress, nominal_curve
from shellcut.model_file import ModelFileError, preset_film
from shellcut.model_file.material_keys import presets

MODULI = Elastic(1678.0, 0.3, 1e-9)
YIELDS = {"hardening.yield_stress": 20}
AXES = {"young_across": 900.0, "shear": "400 MPa"}


def material(**keys):
    """The material of the packaged opening test with further keys."""
    model = read_model("opening", {f"material.{name}": value for name, value in keys.items()})
    (layer,) = model.sections["material"].made().layers
    return layer.material


@pytest.mark.parametrize(
    ("keys", "wanted"),
    [
        ({}, MODULI),
        ({"law": "elastic"}, MODULI),
        ({"law": "hencky"}, Hencky(MODULI)),
        (AXES, Orthotropic(1678.0, 900.0, 0.3, 400.0, 1e-9)),
        (
            {**AXES, "law": "hencky", "angle_deg": 30.0},
            Hencky(Orthotropic(1678.0, 900.0, 0.3, 400.0, 1e-9, angle_deg=30.0)),
        ),
        (
            {**AXES, "shear_through": 300, "shear_through_across": 200},
            Orthotropic(1678.0, 900.0, 0.3, 400.0, 1e-9, 300.0, shear_through_across=200.0),
        ),
        ({**YIELDS, "law": "plastic"}, Plastic(MODULI, Linear(20.0))),
        ({**YIELDS, "hardening.modulus": "5 MPa"}, Plastic(MODULI, Linear(20.0, 5.0))),
        (
            {"hardening": {"kind": "voce", "yield_stress": 20, "gain": 8, "strain": 0.1}},
            Plastic(MODULI, Voce(20.0, 8.0, 0.1)),
        ),
        (
            {"hardening": {"strength": 40, "start": 0.01, "exponent": 0.2}},
            Plastic(MODULI, Swift(40.0, 0.01, 0.2)),
        ),
        (
            {"hardening": {"plastic_strain": [0, 0.5, 1], "stress": [10, "20 MPa", 50]}},
            Plastic(MODULI, Table((0.0, 0.5, 1.0), (10.0, 20.0, 50.0))),
        ),
        (
            {**YIELDS, "r_values": [0.8, 1.2, 1.6], "angle_deg": 45.0},
            Plastic(MODULI, Linear(20.0), (0.8, 1.2, 1.6), angle_deg=45.0),
        ),
        (
            {**YIELDS, "rate": {"kind": "cowper_symonds", "rate": "40 1/s", "exponent": 5}},
            Plastic(MODULI, Linear(20.0), rate=CowperSymonds(40.0, 5.0)),
        ),
        (
            {**YIELDS, "rate.rate": 1.0, "rate.factor": 0.02},
            Plastic(MODULI, Linear(20.0), rate=JohnsonCook(factor=0.02, rate=1.0)),
        ),
    ],
    ids=lambda one: "-".join(one) if isinstance(one, dict) else "",
)
def test_what_keys_build(keys, wanted):
    assert material(**keys) == wanted


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"hardening.yield_stress": -1}, "[material.hardening].yield_stress must be positive"),
        ({"r_values": [1, 1, 1]}, 'belongs to law = "plastic", got no hardening: give one'),
        ({"law": "hencky", **YIELDS}, 'hardening belongs to law = "plastic", got law = "hencky"'),
        ({"law": "plastic"}, 'law = "plastic" needs a hardening: a table [material.hardening]'),
        ({"law": "elastc"}, 'must be one of "elastic", "hencky", "plastic"'),
        ({"hardening.yield_stres": 3}, "[material.hardening].kind must be given: one of voce, lin"),
        ({**YIELDS, "hardening.modulos": 3}, "[material.hardening].modulos; did you mean modulus?"),
        ({"hardening": "voce"}, "[material].hardening must be a table, got 'voce'"),
        ({"hardening.kind": "vocee"}, "[material.hardening].kind 'vocee' is unknown; did you mean"),
        ({**YIELDS, "kinematic_modulus": 9}, "unknown key [material].kinematic_modulus"),
        ({"hardening.exponent": 0.3}, "[material.hardening].start must be given: start of Swift's"),
        ({**YIELDS, "hardening.strength": 3}, 'strength belongs to kind = "swift", not to kind ='),
        ({"hardening.plastic_strain": [0, 1]}, "[material.hardening].stress must be given: true"),
        ({**YIELDS, "r_values": [1, 1, -1]}, "r_values must be three positive numbers"),
        ({**YIELDS, "rate": {"exponent": 4, "factor": 1}}, "[material.rate].exponent exclude each"),
        ({"rate": {"exponent": 4, "rate": 4}}, 'rate belongs to law = "plastic", got no hardening'),
        ({"yield_stress": 3}, "in [material.hardening], where kind is linear or voce"),
        ({"swift_start": 3}, "write start in [material.hardening], where kind is swift"),
        ({"johnson_cook_rate": 3}, "write rate in [material.rate], where kind is johnson_cook"),
        ({"young_across": 900.0}, "young_across needs shear too"),
        ({"shear_through_across": 9.0}, "shear_through_across needs young_across and shear too"),
        ({"young_across": 90.0, "shear": 3, "poisson": 9}, "young over young_across"),
        ({"angle_deg": 30.0}, "angle_deg turns the axes of young_across and r_values, got neither"),
        ({"hardening.file": "nowhere.csv"}, "[material.hardening].file: there is no file"),
    ],
    ids=lambda one: "-".join(one) if isinstance(one, dict) else "",
)
def test_what_is_refused_with_the_name_of_the_key(keys, said):
    with pytest.raises(ModelFileError) as refused:
        material(**keys)
    assert said in str(refused.value)


def test_all_problems_are_told_together():
    with pytest.raises(ModelFileError) as refused:
        material(hardening={"yield_stress": -1, "modulus": -2}, young=-4)
    for key in ("[material.hardening].yield_stress", "[material.hardening].modulus"):
        assert f"{key} must" in str(refused.value)
    assert "[material].young must" in str(refused.value)


HARDENING = "# by hand\nplastic strain [%];true stress [kPa]\n0;10000\n5;20000\n80;50000\n"


def test_a_table_from_a_file(tmp_path):
    (tmp_path / "film.csv").write_text(HARDENING)
    (tmp_path / "a.toml").write_text(
        'model = "opening"\n[material]\nyoung = 200\n[material.hardening]\nfile = "film.csv"\n'
    )
    model = read_model(tmp_path / "a.toml")
    (layer,) = model.sections["material"].made().layers
    assert layer.material.hardening == Table((0.0, 0.05, 0.8), (10.0, 20.0, 50.0))
    assert model.files() == [str(tmp_path / "film.csv")]
    # a run knows when it has changed since
    model.write(tmp_path / "used.toml")
    used = read_model(tmp_path / "used.toml")
    assert used == model
    assert used.changed_files() == []
    (tmp_path / "film.csv").write_text(HARDENING.replace("50000", "60000"))
    assert used.changed_files() == [str(tmp_path / "film.csv")]


def test_the_file_of_a_layer_is_recorded_too(tmp_path):
    (tmp_path / "film.csv").write_text(HARDENING)
    (tmp_path / "a.toml").write_text(
        'model = "opening"\n[[material.layers]]\npreset = "pet"\nhardening = {file = "film.csv"}\n'
        '[[material.layers]]\npreset = "ldpe"\nthickness = "60 um"\n'
    )
    model = read_model(tmp_path / "a.toml")
    assert model.files() == [str(tmp_path / "film.csv")]
    film = model.sections["material"].made()
    # the file stands in place of the preset's hardening
    assert film.layers[0].material.hardening.stress_at == (10.0, 20.0, 50.0)
    assert film.layers[0].material.elastic.young == presets()["pet"]["material"]["young"]
    assert film.thickness == pytest.approx(0.083)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a [-],b [MPa]\n0,1\n1,2\n", "one heading must name the strain"),
        ("total strain [-],eng. stress [MPa]\n0,1\n1,2\n", "true stresses, got 'total strain [-]'"),
        ("strain [s],stress [MPa]\n0,1\n1,2\n", "strain must be a unit of ratio (-, %, um/m)"),
        ("strain [-],stress [MPa]\n0.1,1\n1,2\n", "plastic_strain must start at 0"),
        ("strain [-],stress [MPa]\n0,3\n1,2\n", "stress must not decrease"),
    ],
)
def test_a_table_that_is_none(tmp_path, text, said):
    (tmp_path / "film.csv").write_text(text)
    with pytest.raises(ModelFileError) as refused:
        material(hardening={"file": str(tmp_path / "film.csv")})
    assert "[material.hardening]: " in str(refused.value)
    assert said in str(refused.value)


def test_tables_of_layers_have_the_lines_of_their_layer(tmp_path):
    ply = "[[material.layers]]\npreset = 'ldpe'\n[material.layers.hardening]\n"
    path = tmp_path / "a.toml"
    path.write_text(f'model = "opening"\n{ply}yield_stress = 9\n{ply}yield_stress = -9\n')
    with pytest.raises(ModelFileError) as refused:
        read_model(path)
    said = "a.toml:9: [material.layers.1.hardening].yield_stress must be positive, got -9.0 MPa"
    assert said in str(refused.value)
    path.write_text(f'model = "opening"\n{ply}yield_stress = 9\n{ply}yield_stress = 8\n')
    model = read_model(path)
    film = model.sections["material"].made()
    assert [one.material.hardening.first_yield for one in film.layers] == [9.0, 8.0]
    model.write(tmp_path / "used.toml")
    assert read_model(tmp_path / "used.toml") == model


def test_a_setting_of_a_key_that_two_kinds_have_keeps_the_kind(tmp_path):
    path = tmp_path / "a.toml"
    voce = "kind = 'voce'\nyield_stress = 9\ngain = 3\nstrain = 0.1\n"
    path.write_text(f"model = 'opening'\n[material.hardening]\n{voce}")
    (layer,) = read_model(path, {"yield_stress": 8}).sections["material"].made().layers
    assert layer.material.hardening == Voce(8.0, 3.0, 0.1)
    swift = {"material.hardening.exponent": 0.3, "material.hardening.start": 0.1}
    model = read_model(path, swift | {"material.hardening.strength": 20})
    (layer,) = model.sections["material"].made().layers
    assert layer.material.hardening == Swift(20.0, 0.1, 0.3)


def test_a_key_of_a_preset_s_hardening_leaves_the_others():
    (layer,) = preset_film("pet", hardening={"yield_stress": 80.0}).layers
    assert layer.material.hardening == Linear(80.0, 493.8)
    (layer,) = preset_film("ldpe", hardening={"yield_stress": 8.0}).layers
    assert layer.material.hardening == Linear(8.0)
    (layer,) = preset_film("pet", law="hencky").layers
    assert layer.material == Hencky(Elastic(4850.0, 0.38, 1.39e-9))


def test_a_long_table_is_thinned(tmp_path):
    p = np.linspace(0.0, 1.0, 400)
    sigma = 150.0 * (0.002 + p) ** 0.2
    rows = "\n".join(f"{a},{b}" for a, b in zip(p, sigma, strict=True))
    (tmp_path / "film.csv").write_text(f"strain [-],stress [MPa]\n{rows}\n")
    found = material(hardening={"file": str(tmp_path / "film.csv")}).hardening
    assert len(found.stress_at) == 24
    assert found.stress(p) == pytest.approx(sigma, rel=5e-3)  # measured 2e-3, of 24 lines


class TestPresets:
    @pytest.mark.parametrize("name", presets())
    def test_it_names_its_source(self, name):
        one = presets()[name]
        assert one["title"]
        assert one["fit"]
        assert len(one["sources"]) >= 1
        for source in one["sources"]:
            # who, and what was measured or given
            assert len(source) > 60

    @pytest.mark.parametrize("name", presets())
    def test_its_curve_has_the_published_figures(self, name):
        published = presets()[name]["published"]
        film = preset_film(name)
        strain, stress = nominal_curve(film)
        if "young" in published:
            modulus = film.stretching_stiffness / film.thickness
            assert modulus == pytest.approx(published["young"], rel=1e-12)
            # and the curve starts with it
            assert np.interp(1e-4, strain, stress) == pytest.approx(1e-4 * modulus, rel=2e-3)
        for at, wanted in published["points"]:
            # fits go through their points but for the digits of their parameters
            assert np.interp(at, strain, stress) == pytest.approx(wanted, rel=2e-3)
        if "yield_nominal" in published:
            first = film.layers[0].material.hardening.first_yield
            at_yield = first * math.exp(-first / published["young"])
            assert at_yield == pytest.approx(published["yield_nominal"], rel=2e-3)
        if "proof" in published:
            # 0.2 % of plastic strain: the curve meets the line of the modulus moved by it
            over = stress - published["young"] * (strain - 0.002)
            meets = np.flatnonzero((over <= 0.0) & (strain > 0.002))[0]
            assert stress[meets] == pytest.approx(published["proof"], rel=5e-3)
        if "strength" in published:
            most = largest_nominal_stress(film, "uniaxial")
            assert most.stress == pytest.approx(published["strength"], rel=2e-3)

    def test_presets_are_the_default_of_others_and_of_every_way(self):
        assert preset_film("frangi2010") == ShellMaterial.homogeneous()
        film = preset_film("foil_ldpe")
        (ldpe,), (foil,) = preset_film("ldpe").layers, preset_film("aluminium_foil").layers
        assert [one.material for one in film.layers] == [ldpe.material, foil.material]
        assert film.thickness == pytest.approx(0.074)

    @pytest.mark.parametrize("model", ["opening", "guillotine", "trouser", "oscillating", "free"])
    def test_every_model_takes_one(self, model):
        film = {"material": "pet", "material.thickness": "12 um"}
        made = read_model(model, film).sections["material"].made()
        assert made.thickness == 0.012
        assert made.layers[0].material == preset_film("pet").layers[0].material

    def test_a_preset_stands_in_a_file_and_is_written_back(self, tmp_path):
        model = read_model("opening", {"material": "ldpe"})
        assert model.sections["material"].thickness == 0.05  # of the preset, not 74 um of the file
        model.write(tmp_path / "used.toml")
        assert read_model(tmp_path / "used.toml") == model
        assert 'preset = "ldpe"' in (tmp_path / "used.toml").read_text()
        assert read_model("opening", {"material.preset": "ldpe"}) == model
        (tmp_path / "a.toml").write_text('model = "opening"\nmaterial = "pet"\n')
        (tmp_path / "b.toml").write_text('model = "opening"\n[material]\npreset = "pet"\n')
        a, b = read_model(tmp_path / "a.toml"), read_model(tmp_path / "b.toml")
        assert a.sections["material"].made() == b.sections["material"].made() == preset_film("pet")
        (tmp_path / "a.toml").write_text('model = "opening"\nmaterial = "pett"\n')
        with pytest.raises(ModelFileError, match=r'a.toml:2: .*must be one of "frangi2010", "ld'):
            read_model(tmp_path / "a.toml")
        with pytest.raises(ValueError, match=r"no film 'pett'; did you mean pet\?"):
            preset_film("pett")

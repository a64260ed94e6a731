"""Numbers typed in another unit are told, those of the film are not."""

import pytest

import shellcut as sc
from shellcut.checks.plausible import check_numbers
from shellcut.checks.steps import check_steps
from shellcut.mesh.structured import rectangle
from shellcut.tool.shapes import straight_blade

MESH = rectangle(20.0, 8.0, size=0.4)
FILM = sc.ShellMaterial.homogeneous()
BLADE = straight_blade()


def found(film=FILM, law=None, tool=BLADE, **numbers):
    if numbers:
        film = sc.ShellMaterial.homogeneous(**numbers)
    law = sc.CohesiveLaw(**(law or {}))
    return [(f.severity, str(f)) for f in check_numbers(MESH, film, law, tool)]


PASCAL = {"strength": 18e6, "plateau": 12e6}
IN_METRES = {"opening_a": 500, "opening_p": 3e3, "opening_u": 4e3}


@pytest.mark.parametrize(
    ("numbers", "severity", "said"),
    [
        ({"thickness": 74.0}, "refuse", "its theory does not hold, got thickness 74 mm"),
        ({"thickness": 2.0}, "doubt", "thinner than 0.1 of its size"),
        ({"thickness": 0.5}, "doubt", "thickness 0.5 mm and edges of 0.4 mm"),
        ({"thickness": 7.4e-5}, "doubt", "thicker than 0.0001 mm"),  # in m
        ({"young": 1.678}, "refuse", "a strain of 10.7"),  # in GPa
        ({"young": 1.678e9}, "doubt", "young 1.678e+09 MPa"),  # in Pa
        ({"density": 1e-12}, "doubt", "density 1e-12 t/mm³"),  # in t/mm³ by a slip of g/m³
        ({"density": 5e-8}, "doubt", "osmium"),
        ({"law": PASCAL}, "refuse", "a strain of 1.07e+04"),
        ({"law": {"strength": 0.018, "plateau": 0.012}}, "doubt", "a strain of 1.07e-05"),  # in GPa
        ({"law": {"strength": 400.0}}, "doubt", "a strain of 0.238"),
        ({"law": IN_METRES}, "doubt", "opening_u 4000 mm"),
        ({"law": PASCAL, "young": 1678e6}, "doubt", "1.295e+06 m/s"),  # by the speed of waves
    ],
)
def test_a_film_or_law_in_another_unit(numbers, severity, said):
    findings = found(**numbers)
    assert any(level == severity and said in text for level, text in findings), findings


@pytest.mark.parametrize(
    ("first", "r_values", "severity", "said"),
    [
        (10000.0, None, "refuse", "a first yield stress of 1e+04 MPa at a modulus of 1000 MPa"),
        (400.0, None, "doubt", "a strain of 0.4"),
        (40.0, (1000.0, 1000.0, 1000.0), "doubt", "got r_values 1000, 1000, 1000"),
        (40.0, (1.0, 0.01, 1.0), "doubt", "got r_values 1, 0.01, 1"),
    ],
)
def test_a_film_that_cannot_yield_so(first, r_values, severity, said):
    material = sc.Plastic(sc.Elastic(1000.0, 0.3, 1e-9), sc.Linear(first, 1.0), r_values)
    ((level, text),) = found(sc.ShellMaterial((sc.Layer(material, 0.05),)))
    assert level == severity
    assert said in text


def test_what_is_wrong_in_one_layer_of_several_is_told_once():
    polymer, foil = sc.Elastic(800.0, 0.4, 0.92e-9), sc.Elastic(69e9, 0.33, 2.7e-9)
    film = sc.ShellMaterial([sc.Layer(foil, 0.005), sc.Layer(polymer, 0.06), sc.Layer(foil, 0.005)])
    said = [text for _, text in found(film, tool=None)]
    assert sum("a modulus should lie" in text for text in said) == 1


@pytest.mark.parametrize(
    ("unit", "said"),
    [
        ("um", "between them nothing resists the tooth"),
        ("m", "of similar size, got a tool of 67"),
    ],
)
def test_a_tool_of_another_scale(tmp_path, unit, said):
    BLADE.write(tmp_path / "blade.stl")
    ((level, text),) = found(tool=sc.read_tool(tmp_path / "blade.stl", unit=unit))
    assert level == "doubt"
    assert said in text


# --- the steps -----------------------------------------------------------------------------------

STEPS = {
    "dt": 1.5e-7,
    "fixed": None,
    "bound": 1.6e-7,
    "check_every": 10,
    "duration": 6e-3,
    "speed": 2700.0,
    "wave": 1.3e6,
    "edge_length": 0.4,
}


def steps(**changed):
    return [(f.severity, str(f)) for f in check_steps(**{**STEPS, **changed})]


def test_what_follows_its_teeth_is_not_blamed():
    assert steps() == []
    assert steps(speed=8.1e4, check_every=5) == []  # looking more often follows a faster blade
    assert found() == []


@pytest.mark.parametrize(
    ("changed", "severity", "said"),
    [
        ({"speed": 1e9}, "refuse", "got 150 mm a step"),
        ({"dt": 1e-3, "fixed": 1e-3}, "refuse", "leave time.fixed out"),
        # 0.3 edges of 0.4 mm in ten steps of 1.5e-7 s are 8e4 mm/s
        ({"speed": 8.1e4}, "doubt", "two looks at the cracks"),
        ({"speed": 7.9e4, "wave": 5e5}, "doubt", "slower than 0.1 of the film's waves"),
        ({"dt": 2e-7, "fixed": 2e-7}, "doubt", "must not exceed the safe one, 1.6e-07 s"),
        ({"duration": 6.0}, "note", "about 4e+07 steps"),
    ],
)
def test_a_step_that_does_not_follow(changed, severity, said):
    assert [level for level, text in steps(**changed) if said in text] == [severity]

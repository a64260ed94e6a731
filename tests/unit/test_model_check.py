"""What is on the way of the cutting edges; and what ships is told to be in order."""

import importlib.util
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import shellcut
import shellcut as sc
from shellcut import CohesiveLaw, Elastic, Fracture, Layer, ShellMaterial, opening_test
from shellcut.checks import RefusedModel
from shellcut.checks.plausible import check_numbers, check_steps
from shellcut.fracture.puncture import bending_length
from shellcut.mesh.structured import opening_disc, rectangle
from shellcut.models import Case, free_cut
from shellcut.tool.shapes import round_bar, straight_blade, tooth_ring
from test_preview import two_rings

SIDES = (shellcut.Support.clamped("bottom"), shellcut.Support.clamped("top"))
EXAMPLES = Path(__file__).parents[2] / "examples"


def blade_at(y):
    return straight_blade(length=12.0, height=3.0).translated((-0.05, y, 0.0))


def zone(sides):
    """A law whose last opening is a number of sides of the strip's quads."""
    length = 0.8 * sides
    return CohesiveLaw(opening_a=0.125 * length, opening_p=0.75 * length, opening_u=length)


def strip_cut(mesh=None, *, tool=None, motion=None, supports=SIDES, path=None, **options):
    """A blade that comes in over the end of a strip of 12 by 8 mm, on y = 0, by 10 mm."""
    return free_cut(
        mesh or rectangle(12.0, 8.0, size=0.8),
        tool=tool or blade_at(0.0),
        motion=motion or shellcut.StraightMotion((1.0, 0.0, 0.0), 6000.0, ramp=1e-4),
        duration=10.0 / 6000.0,
        supports=supports,
        fracture=shellcut.Fracture(path=path),
        **options,
    )


def found(case):
    return shellcut.check_model(case.simulation, case.duration).findings


# --- no false alarms -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    "build",
    [
        lambda: shellcut.opening_test("M2"),
        lambda: shellcut.read_model("opening").build(),
        lambda: shellcut.read_model("guillotine").build(),
        lambda: shellcut.guillotine(0.4),
        strip_cut,
        lambda: strip_cut(path="edges"),
        lambda: strip_cut(tool=blade_at(0.07), path="edges"),  # 0.09 sides of a quad away
        lambda: strip_cut(tool=blade_at(0.2)),  # through the quads
        lambda: strip_cut(notch=4.0),
        lambda: strip_cut(law=zone(2.06)),
    ],
)
def test_what_is_in_order_is_not_blamed(build):
    assert found(build()) == ()


NO_RUN_OF_THEIR_OWN = "Statics(", "sweep(", "optimise("
CUTTING = [
    path.stem
    for path in sorted(EXAMPLES.glob("*.py"))
    if not any(call in path.read_text() for call in NO_RUN_OF_THEIR_OWN)
]
ENDED_BY_ITS_HOOK = {"reading_hook": 1.2e-3}


@pytest.mark.parametrize("name", CUTTING)
def test_the_examples_are_in_order(name, tmp_path, monkeypatch):
    # Every run of the script is stopped before its first step, its models are kept.
    models = []

    class Stopped(Exception):
        pass

    def keep(simulation, until):
        models.append((simulation, ENDED_BY_ITS_HOOK.get(name, until)))
        if name != "own_tooth":
            raise Stopped

    monkeypatch.setattr(Case, "run", lambda case, *_, **__: keep(case.simulation, case.duration))

    run = shellcut.Simulation.run

    def not_run(simulation, until, hooks=()):
        if not hooks:  # the warm-up
            return run(simulation, until)
        for hook in hooks:
            getattr(hook, "give_up", hook.close)()
        keep(simulation, until)

    monkeypatch.setattr(shellcut.Simulation, "run", not_run)
    monkeypatch.setattr("sys.argv", [name, "--out", str(tmp_path)])
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    script = importlib.util.module_from_spec(spec)

    def whole():
        spec.loader.exec_module(script)
        script.main()

    with pytest.raises((Stopped, FileNotFoundError)):
        whole()
    assert models
    for simulation, until in models:
        findings = shellcut.check_model(simulation, until).findings
        # What a glue needs where it peels is said of every glue.
        assert [one for one in findings if not one.came.startswith("seal: strength")] == []


# --- the path of the edges -----------------------------------------------------------------------

LEFT, RIGHT = (shellcut.Support.clamped(side) for side in ("left", "right"))
WHOLE = rectangle(12.0, 8.0, size=0.8)
PARTED = WHOLE.cut(WHOLE.nodes_where(lambda x, y, z: abs(y) < 1e-9))  # along the whole path


def straight(x, y, speed):
    return shellcut.StraightMotion((x, y, 0.0), speed)


def sideways():
    blade = straight_blade(length=1.0, height=3.0).translated((6.0, -4.5, 0.0))
    return strip_cut(motion=straight(0.0, 1.0, 2000.0), tool=blade, supports=(LEFT, RIGHT))


def backwards():
    """A ring of teeth that turns and advances against its edges."""
    down = {"axis": (0, 0, -1), "advance": (0, 0, -1)}
    motion = shellcut.ScrewMotion.over(angle_deg=60.0, duration=4e-3, pitch=12.0, **down)
    rim = [shellcut.Support.clamped("rim")]
    film = opening_disc("quick")
    return free_cut(film, tool=tooth_ring(), motion=motion, duration=4e-3, supports=rim)


def away(**keys):
    short = {"mesh": "quick", "motion.angle_deg": 12.0, "motion.duration": 0.8e-3}
    return shellcut.read_model("opening", short | keys).build()


NEVER = "the tool never touches the film: at its nearest, at "
TOLD = {
    "beside the rows": (
        lambda: strip_cut(tool=blade_at(0.2), path="edges"),
        ["no such row in 100 % of the 13 quads", "the next one 0.2 mm away", 'path = "free"'],
    ),
    "across the rows": (
        lambda: strip_cut(motion=straight(np.sqrt(0.75), 0.5, 6000.0), path="edges"),
        ["no such row"],
    ),
    "supported nodes": (
        lambda: strip_cut(supports=[*SIDES, LEFT]),
        ["1 supported node on it, the first at (0, 0, 0) mm"],
    ),
    "cut before": (lambda: strip_cut(PARTED), ["or between doubled nodes, from end to end"]),
    "sideways": (sideways, ["moves 90° away from where it points"]),
    "backwards": (backwards, ["another direction on 100 % of the path", "reverse the motion"]),
    "out of the film": (
        lambda: shellcut.opening_test("quick", pitch=40.0),
        ["4 of 4 whose end leaves the film"],
    ),
    "beyond the end": (
        lambda: strip_cut(motion=straight(1.0, 0.0, 12000.0)),
        ["1 of 1 cutting edges leave the film before the motion ends"],
    ),
    "one edge never": (
        lambda: shellcut.opening_test("quick", tool=two_rings(height=5.0)),
        ["1 of 2 cutting edges never meet the film: cutting edge 2", "[tool] not_cutting = [1]"],
    ),
    "above the film": (
        lambda: away(tip_clearance=5.0),
        [NEVER, "4.6 mm lie between them; add [0, 0, 4.99] mm to membrane.shift or add [0, 0, -4"],
    ),
    "around the film": (
        lambda: away(**{"tool.radius": 12.0}),
        [NEVER, "1.5 mm lie between them; move it by (0, 1.45, "],
    ),
    "short process zone": (lambda: strip_cut(law=zone(1.9)), ["1.9 of them"]),
}
NOTED = ("beyond the end", "one edge never")
WITH_OTHERS = ("across the rows", "sideways", "backwards")


@pytest.mark.parametrize("name", TOLD)
def test_what_is_wrong_on_the_path_is_told(name):
    build, words = TOLD[name]
    findings = found(build())
    (finding,) = [one for one in findings if all(word in str(one) for word in words)]
    assert finding.severity == ("note" if name in NOTED else "doubt")
    assert len(findings) == 1 or name in WITH_OTHERS


def test_a_saw_may_go_back_where_it_has_cut():
    t = np.linspace(0.0, 2e-3, 81)
    x = 4.0 * t / 2e-3 + 1.5 * np.sin(2.0 * np.pi * t / 1e-3)
    motion = shellcut.TableMotion(t, np.column_stack([x, 0.0 * x, 0.0 * x]))
    assert motion.twist(5e-4)[1][0] < 0.0  # it does go back
    said = [str(f) for f in found(strip_cut(motion=motion)) if f.severity != "note"]
    assert said == []


MOVED = shellcut.Support("bottom", translation="z", velocity={"z": lambda _: 1.0}), SIDES[1]


@pytest.mark.parametrize(
    ("down", "supports", "told"), [(0.5, SIDES, True), (1.5, SIDES, False), (0.5, MOVED, False)]
)
def test_a_blunt_tool_is_told_if_it_does_not_come_down_to_the_film(down, supports, told):
    bar = round_bar(diameter=1.0, height=4.0, tilt_deg=0.0).translated((6.0, 0.0, 3.0))
    motion = shellcut.StraightMotion((0.0, 0.0, -1.0), 1000.0)
    film = ShellMaterial.homogeneous()
    sim = shellcut.Simulation(WHOLE, film, supports=supports, tool=bar, motion=motion)
    said = [str(f) for f in shellcut.check_model(sim, 1e-3 * down).findings]
    assert any("never touches" in text for text in said) == told


# --- steps, refusals -----------------------------------------------------------------------------


def test_a_tool_that_passes_nodes_within_a_step_is_refused_even_if_forced():
    case = shellcut.opening_test("quick", duration=1e-8)
    (finding,) = found(case)
    assert finding.severity == "refuse"
    assert "a step" in str(finding)
    with pytest.raises(RefusedModel, match="passes nodes before contact acts on them"):
        shellcut.check_model(case.simulation, case.duration).enforce(force=True)


def test_a_path_whose_distances_are_infinite_is_refused():
    with np.errstate(over="ignore"), pytest.raises(ValueError, match="a run must take"):
        shellcut.guillotine(0.8, travel=1e300)


def test_checking_changes_nothing_and_a_film_without_a_tool_is_asked_for_numbers():
    one, two = (
        shellcut.opening_test("quick", stepping=shellcut.Stepping(fixed=1e-7)) for _ in range(2)
    )
    shellcut.check_model(one.simulation, one.duration)
    for case in (one, two):
        case.simulation.run(2e-5)
    assert np.array_equal(one.simulation.state.node.x, two.simulation.state.node.x)
    thick = ShellMaterial.homogeneous(thickness=74.0)
    check = shellcut.check_model(shellcut.Simulation(WHOLE, thick), 1e-3)
    assert check.sweep is None
    assert [f.severity for f in check.findings] == ["refuse"]


# --- what is told before a run of a film that its tool comes down on


def doubts(**options):
    case = opening_test("quick", **options)
    findings = shellcut.check_model(case.simulation, case.duration).findings
    return [str(one) for one in findings if "pierce" in str(one)]


def brittle(length):
    """A law whose modulus times energy over strength² is a multiple of the bending length."""
    law = CohesiveLaw()
    bent = bending_length(ShellMaterial.homogeneous(), law)
    scale = length * bent * 18.0**2 / (1678.0 * law.fracture_energy)
    openings = {f"opening_{k}": scale * getattr(law, f"opening_{k}") for k in "apu"}
    return CohesiveLaw(**openings, onset=0.01 * scale)


def test_a_film_that_tears_on_by_itself_is_doubted():
    assert doubts() == doubts(law=brittle(1.05)) == []
    over_the_border = found(shellcut.guillotine(0.8, law=brittle(0.95)))
    assert not any("pierces" in str(one) for one in over_the_border)
    (said,) = doubts(law=brittle(0.95))
    assert "0.205 mm and 0.216 mm" in said
    assert "fracture.puncture_force" in said
    assert doubts(law=brittle(0.95), fracture=Fracture(puncture_force=0.4)) == []


def test_a_pressure_under_which_no_film_is_flat_is_doubted():
    """0.03 N_F theta / L for the sharp tip; loads count together, where an edge passes."""
    case = opening_test("quick")

    def said(*loads, **own):
        inputs = {**case.simulation.inputs, "loads": loads, **own}
        findings = shellcut.check_model(shellcut.Simulation(**inputs), case.duration).findings
        return [str(one) for one in findings if "bulges this film" in str(one)]

    film, law = ShellMaterial.homogeneous(), CohesiveLaw()
    tension = law.strength * film.thickness
    theta = (tension / film.stretching_stiffness) ** 0.5
    flat = 0.03 * tension * theta / bending_length(film, law)
    assert said(shellcut.Pressure(0.9 * flat)) == []
    assert said(shellcut.Pressure(-1.6 * flat), shellcut.Pressure(1.5 * flat)) == []
    (one,) = said(shellcut.Pressure(-0.6 * flat), shellcut.Pressure(-0.5 * flat, following=True))
    assert f"10 % above {flat:.2g} MPa" in one
    late = shellcut.Pressure(1.1 * flat, factor=lambda time: float(time > 0.9 * case.duration))
    assert len(said(late)) == 1
    mesh = case.simulation.mesh
    middle = np.flatnonzero(np.hypot(*mesh.nodes[mesh.quads].mean(axis=1)[:, :2].T) < 5.0)
    sets = {**mesh.quad_sets, "middle": middle}
    own_set = replace(mesh, quad_sets=sets)
    assert said(shellcut.Pressure(2.0 * flat, quads="middle"), mesh=own_set) == []
    assert said(shellcut.Pressure(1.0), fracture=Fracture(puncture_force=0.4)) == []


def test_a_film_soft_in_shear_is_doubted():
    film = ShellMaterial(
        [Layer(Elastic(e, 0.3, 1e-9), h) for e, h in ((7e4, 0.009), (200.0, 0.056), (7e4, 0.009))]
    )
    (said,) = doubts(material=film, law=CohesiveLaw(strength=40.0))
    assert "probably smaller than computed" in said
    assert "strength times thickness is 0.5 of its shear stiffness" in said


def test_a_film_that_yields_before_its_strength_is_doubted(caplog):
    for first, told in ((17.0, True), (19.0, False)):
        film = shellcut.preset_film("pet", hardening={"yield_stress": first})
        assert any("yields before its strength" in said for said in doubts(material=film)) == told
    guess, soft = doubts(material=shellcut.preset_film("ldpe"))
    assert "is a guess" in guess
    assert "holds up to 10 %" in guess
    assert "soft in shear through its thickness" in soft
    weak = shellcut.preset_film("ldpe", hardening={"yield_stress": 8.0, "modulus": 20.0})
    case = shellcut.guillotine(0.8, material=weak)
    check = shellcut.check_model(case.simulation, case.duration)
    assert [one.severity for one in check.findings] == ["doubt", "note"]
    assert "a crack needs 18 MPa" in check.findings[0].came
    check.say()
    assert "distrust: a film must be able to carry the strength" in caplog.text


# --- numbers typed in another unit are told, those of the film are not


MESH = rectangle(20.0, 8.0, size=0.4)
FILM = sc.ShellMaterial.homogeneous()
BLADE = straight_blade()


def of_numbers(film=FILM, law=None, tool=BLADE, **numbers):
    if numbers:
        film = sc.ShellMaterial.homogeneous(**numbers)
    law = sc.CohesiveLaw(**(law or {}))
    found = check_numbers(MESH, film, law, tool)
    return [(f.severity, str(f)) for f in found if f.severity != "note"]


def test_another_film_with_the_law_of_the_paper_is_noted():
    pet, own = sc.preset_film("pet"), sc.CohesiveLaw(strength=90.0, plateau=60.0)
    (note,) = [f for f in check_numbers(MESH, pet, sc.CohesiveLaw(), BLADE) if f.severity == "note"]
    assert "18 MPa and 43.5 N/mm, and the film is another; take strength" in str(note)
    paper = sc.ShellMaterial.homogeneous(thickness=0.05)
    for film, law in ((pet, own), (paper, sc.CohesiveLaw())):
        assert all(f.severity != "note" for f in check_numbers(MESH, film, law, BLADE))


PASCAL = {"strength": 18e6, "plateau": 12e6}
IN_METRES = {"opening_a": 500, "opening_p": 3e3, "opening_u": 4e3}


@pytest.mark.parametrize(
    ("numbers", "severity", "said"),
    [
        ({"thickness": 74.0}, "refuse", "its theory is not valid, got thickness 74 mm"),
        ({"thickness": 2.0}, "doubt", "thinner than 0.1 of its size"),
        ({"thickness": 0.5}, "doubt", "thickness 0.5 mm and sides of quads of 0.4 mm"),
        ({"thickness": 7.4e-5}, "doubt", "thicker than 0.0001 mm"),  # in m
        ({"young": 1.678}, "refuse", "strength 18 MPa is 10.73 times the film's modulus"),  # in GPa
        ({"young": 1.678e9}, "doubt", "young 1.678e+09 MPa"),  # in Pa
        ({"density": 1e-12}, "doubt", "density 1e-12 t/mm³"),  # in t/mm³ by a slip of g/m³
        ({"density": 5e-8}, "doubt", "osmium"),
        ({"law": PASCAL}, "refuse", "this film would never tear; both are in MPa"),
        ({"law": {"strength": 0.018, "plateau": 0.012}}, "doubt", "a strain of 1.07e-05"),  # in GPa
        ({"law": {"strength": 400.0}}, "doubt", "a strain of 0.238"),
        ({"law": IN_METRES}, "doubt", "opening_u 4000 mm"),
        ({"law": PASCAL, "young": 1678e6}, "doubt", "1.295e+06 m/s"),  # by the speed of waves
    ],
)
def test_a_film_or_law_in_another_unit(numbers, severity, said):
    findings = of_numbers(**numbers)
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
    ((level, text),) = of_numbers(sc.ShellMaterial((sc.Layer(material, 0.05),)))
    assert level == severity
    assert said in text


def test_what_is_wrong_in_several_layers_is_told_once():
    foil = sc.Layer(sc.Elastic(69e9, 0.33, 2.7e-9), 0.005)  # young in Pa
    film = sc.ShellMaterial([foil, sc.Layer(sc.Elastic(800.0, 0.4, 0.92e-9), 0.06), foil])
    assert sum("a modulus should lie" in text for _, text in of_numbers(film, tool=None)) == 1


@pytest.mark.parametrize(
    ("unit", "said"),
    [("um", "between them nothing resists the tooth"), ("m", "of similar size, got a tool of 67")],
)
def test_a_tool_of_another_scale(tmp_path, unit, said):
    BLADE.write(tmp_path / "blade.stl")
    ((level, text),) = of_numbers(tool=sc.read_tool(tmp_path / "blade.stl", unit=unit))
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
    assert of_numbers() == []


@pytest.mark.parametrize(
    ("changed", "severity", "said"),
    [
        ({"speed": 1e9}, "refuse", "got 150 mm a step"),
        ({"dt": 1e-3, "fixed": 1e-3}, "refuse", "leave time.fixed out"),
        # 0.3 edges of 0.4 mm in ten steps of 1.5e-7 s are 8e4 mm/s
        ({"speed": 8.1e4}, "doubt", "two looks at the cracks"),
        ({"speed": 7.9e4, "wave": 5e5}, "doubt", "slower than 0.1 of the film's waves"),
        ({"dt": 2e-7, "fixed": 2e-7}, "doubt", "must not exceed the safe one, 1.6e-07 s"),
        ({"dt": 1e-5, "fixed": 1e-5}, "refuse", "got time.fixed 1e-05 s: leave it out"),
        ({"duration": 6.0}, "note", "about 4e+07 steps"),
    ],
)
def test_a_step_that_does_not_follow(changed, severity, said):
    assert [level for level, text in steps(**changed) if said in text] == [severity]


def test_angles_of_a_sensor_that_jumps_are_doubted_until_they_are_unwrapped():
    def said(angles, **options):
        t, vectors = np.linspace(0.0, 2e-3, len(angles)), np.radians(angles)[:, None] * [0, 0, 1.0]
        motion = shellcut.TableMotion(t, np.zeros((len(angles), 3)), vectors, **options)
        return [str(f) for f in found(strip_cut(motion=motion)) if "sensor jumps" in str(f)]

    (text,) = said([357.0, 359.0, 1.0, 3.0])
    assert "a turn of 358° from entry 1 to 2 of the table" in text
    assert "set unwrap = true" in text
    assert not said([357.0, 359.0, 1.0, 3.0], unwrap=True)
    assert not said([0.0, 270.0, 720.0])


@pytest.mark.parametrize("wrong", ["", "spin", "velocity"])
@pytest.mark.parametrize("about", [(0.0, 0.0, 0.0), (3.0, -40.0, 2.0)])
def test_a_motion_whose_twist_is_not_the_rate_of_its_pose_is_doubted(wrong, about):
    screw = shellcut.ScrewMotion(150.0, ramp=1e-4, axis=(0.0, 0.3, -1.0), axis_point=about)

    class Own:
        coordinate_unit, pose, coordinate = "rad", screw.pose, screw.coordinate

        def twist(self, time):
            spin, velocity = screw.twist(time)
            moved = np.array([0.0, 1e3, 0.0]) if wrong == "velocity" else 0.0
            return 1.1 * spin if wrong == "spin" else spin, velocity + moved

    said = [str(f) for f in found(strip_cut(motion=Own())) if "the rate of its pose" in str(f)]
    assert len(said) == bool(wrong)
    assert all(f"got a {wrong} of (" in one and "method twist of Own" in one for one in said)


@pytest.mark.parametrize(
    ("unit", "factor", "words"),
    [
        ("mm", 1.0, ""),
        ("mm", 0.7, ""),  # a component of it
        ("mm", 2.0, "which must grow no faster than the tool moves"),
        ("mm", -1.0, "which must grow, or they have the wrong sign"),
        ("rad", 1.0, ""),
        ("rad", 57.3, "which must grow no faster than the tool moves"),
        ("rad", -1.0, "which must grow, or they have the wrong sign"),
    ],
)
def test_a_coordinate_that_falls_or_outruns_the_tool_is_doubted(unit, factor, words):
    screw = shellcut.ScrewMotion(150.0, ramp=1e-4, axis_point=(3.0, -40.0, 2.0))
    line = shellcut.StraightMotion((0.6, 0.0, -0.8), 3e3, ramp=1e-4)
    known = screw if unit == "rad" else line

    class Own:
        coordinate_unit, pose, twist = unit, known.pose, known.twist

        def coordinate(self, time):
            return 5.0 + factor * known.coordinate(time)

    said = [str(f) for f in found(strip_cut(motion=Own())) if "coordinate of a motion" in str(f)]
    assert len(said) == bool(words)
    assert all(words in one and "let coordinate of Own be" in one for one in said)


@pytest.mark.parametrize("gap", [0.16, 0.3, 0.5, 0.8, 1.1])
def test_an_edge_is_seen_to_pass_through_each_of_two_sheets(gap):
    """Also where these are nearer to each other than their quads are long."""
    sheet = rectangle(12.0, 8.0, size=0.8)
    above = np.array([0.0, 0.0, gap])
    nodes = np.concatenate([sheet.nodes, sheet.nodes + above])
    sets = {
        name: np.concatenate([ids, ids + sheet.n_node]) for name, ids in sheet.node_sets.items()
    }
    quads = np.concatenate([sheet.quads, sheet.quads + sheet.n_node])
    mesh = shellcut.Mesh.from_arrays(nodes, quads, node_sets=sets)
    case = strip_cut(mesh, tool=straight_blade(length=14.0, height=6.0).translated((-0.05, 0, 0)))
    place = shellcut.check_model(case.simulation, case.duration).sweep.place
    lower, upper = (place[np.abs(place[:, 2] - z) < 0.05 * gap, 0] for z in (0.0, gap))
    for along in (lower, upper):
        assert along.min() < 0.5
        assert along.max() > 8.0


@pytest.mark.parametrize(
    ("apart", "share", "doubted"),
    [
        *((12.0, 0.5, True), (12.0, -1.0, True), (12.0, 0.05, False)),
        *((None, 0.5, True), (None, 0.05, False)),
    ],
)
def test_supports_that_move_parts_of_a_film_apart_are_doubted(apart, share, doubted):
    """Another sheet, or the other side of the one that is cut, at a share of the blade's speed."""
    mesh, speed = rectangle(10.0, 6.0, size=1.0), 1000.0
    still, moved = mesh.node_set("bottom"), mesh.node_set("top")
    if apart is not None:
        n, rim = mesh.n_node, mesh.boundary_nodes()
        nodes = np.concatenate([mesh.nodes, mesh.nodes + np.array([0.0, apart, 0.0])])
        mesh = sc.Mesh.from_arrays(nodes, np.concatenate([mesh.quads, mesh.quads + n]))
        still, moved = rim, rim + n
    sim = sc.Simulation(
        mesh,
        sc.ShellMaterial.homogeneous(),
        supports=[
            sc.Support(still, rotation=""),
            sc.Support(moved, rotation="", velocity={"x": lambda _: share * speed}),
        ],
        tool=straight_blade(length=3.0, height=3.0).translated((-6.0, 0.1, 0.0)),
        motion=sc.StraightMotion((1.0, 0.0, 0.0), speed=speed),
        law=sc.CohesiveLaw(),
    )
    found = [str(one) for one in sc.check_model(sim, 8e-3).doubts]
    assert any("as one body" in text for text in found) == doubted

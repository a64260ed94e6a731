"""Error bars from made-up figures, against closed forms; which companions a model gets."""

import math
from pathlib import Path

import pytest
import scipy

from shellcut import ErrorBars, read_model
from shellcut.report.pictures import error_bars
from shellcut.results.error_bars import Run, error_bar, read_error_bars
from shellcut.study.converge import companions_of

GIVEN = Run("as given", "", 1.0)
COARSE, FINE = Run("coarser mesh", "mesh", 1.5), Run("finer mesh", "mesh", 2.0 / 3.0)
MOVED, SLOW = Run("nodes moved", "chance", 1.0), Run("slower", "speed", 1.0)
SHAPES = Run("shape 2", "chance", 1.0), Run("shape 3", "chance", 1.0)
MESHES = GIVEN, COARSE, FINE


def at(order, runs=MESHES):
    """Return the figure 3 + 0.2 h^p of each mesh."""
    return [3.0 + 0.2 * run.size**order for run in runs]


class TestBand:
    @pytest.mark.parametrize("order", [0.5, 1.0, 1.5, 2.0, 4.0])
    def test_an_exact_order_is_found_on_any_ratios_and_the_band_holds_the_limit(self, order):
        bar = error_bar("force_peak_N", MESHES, at(order))
        assert bar.order == pytest.approx(order)
        uneven = GIVEN, Run("M1", "mesh", 1.8), Run("quick", "mesh", 3.8)
        assert error_bar("force_peak_N", uneven, at(order, uneven)).order == pytest.approx(order)
        if order == 1.0:
            assert bar.value - bar.half_width == pytest.approx(3.0)
            assert bar.value == at(1.0)[2]
            assert bar.parts == {"mesh": bar.half_width}
        elif 1.0 < order < 4.0:
            assert 0.0 < bar.value - 3.0 < bar.half_width

    @pytest.mark.parametrize(
        ("runs", "values", "value", "parts"),
        [
            # Without a finer mesh the coarser one gives the limit of first order.
            ((GIVEN, COARSE), at(1.0)[:2], 3.2, {"mesh": 0.2}),
            # An error that goes with the speed is left at its end.
            ((GIVEN, SLOW), [3.4, 3.2], 3.2, {"speed": 0.2}),
        ],
    )
    def test_of_two_runs_the_half_width_is_that_to_the_limit(self, runs, values, value, parts):
        bar = error_bar("force_peak_N", runs, values)
        assert (bar.value, bar.order) == (pytest.approx(value), None)
        assert bar.parts == pytest.approx(parts)

    def test_chance_is_the_quantile_of_student_over_runs_that_are_alike(self):
        runs = GIVEN, MOVED, SLOW, *SHAPES, FINE
        bar = error_bar("force_peak_N", runs, [3.0, 3.1, 9.0, 2.9, 3.2, None])
        spread = math.sqrt(sum((v - 3.05) ** 2 for v in (3.0, 3.1, 2.9, 3.2)) / 3.0)
        assert bar.parts["chance"] == pytest.approx(scipy.stats.t.ppf(0.975, 3) * spread)
        assert "mesh" not in bar.parts
        assert bar.half_width == pytest.approx(math.hypot(*bar.parts.values()))

    @pytest.mark.parametrize("values", [[3.0, 3.1, 3.1], [3.0, 3.1, 2.5], [3.0, 3.0, 3.0]])
    def test_meshes_without_an_order_are_told(self, values):
        bar = error_bar("force_peak_N", MESHES, values)
        assert bar.order is None
        said, *_ = ErrorBars("", MESHES, (bar,), {}).said()
        assert "does not converge with an order" in said

    def test_a_crack_is_known_to_an_edge(self):
        alone = GIVEN, SHAPES[0]
        assert error_bar("crack_length_mm", alone, [5.0, 5.0], edge=0.8).half_width >= 0.8
        bar = error_bar("crack_length_mm", MESHES, [5.0, 5.0, 5.0], edge=0.3)
        assert bar.parts == {"mesh": pytest.approx(0.2)}


@pytest.fixture
def found():
    runs = GIVEN, FINE, SLOW, *SHAPES
    bars = [
        error_bar("force_peak_N", runs, [3.0, 2.9, 2.95, 3.01, 3.02]),
        error_bar("crack_length_mm", runs, [12.0, 12.0, None, None, None], 0.4),
    ]
    return ErrorBars("1f3c", runs, tuple(bars), {"speed": ["slower <b> is not done"]})


def test_they_are_read_as_written(found, tmp_path):
    found.write(tmp_path / "bars.json")
    assert read_error_bars(tmp_path / "bars.json") == found
    for text in ('{"runs": 1}', '{"key": ', '{"runs": [], "bars": [{"value": 1}]}'):
        (tmp_path / "bars.json").write_text(text)
        with pytest.raises(ValueError, match="must be a file of shellcut converge"):
            read_error_bars(tmp_path / "bars.json")


def test_the_table_has_two_digits_of_the_half_width(found):
    head, peak, crack, *said = str(found).splitlines()
    assert head.split() == ["result", "value", "±", "mesh", "speed", "scatter"]
    assert peak.split()[-5:] == ["2.85", "0.21", "0.2", "0.05", "0.043"]
    assert crack.split()[-5:] == ["12.00", "0.27", "0.27", "-", "-"]
    assert said[0].endswith("most of ± is mesh: sides half as long would leave ± 0.12 N")
    assert said[-2:] == ["speed: slower <b> is not done", "scatter: no run has it for crack length"]


@pytest.mark.parametrize(
    ("values", "silent"),
    [
        # As given, finer, slower, moved, of two values each.
        ([(3.0, 2.9, 2.9, 3.1), (9.0, 8.0, 9.0, 9.1)], []),
        ([(3.0, None, 2.9, 3.1), (9.0, 8.0, 9.0, 9.1)], [("mesh", "force, peak")]),
        ([(3.0, 2.9, None, 3.1), (9.0, 8.0, None, 9.1)], [("speed", "force, peak, torque, peak")]),
        (
            [(3.0, 2.9, 2.9, None), (9.0, None, 9.0, 9.1)],
            [("mesh", "torque, peak"), ("scatter", "force, peak")],
        ),
        ([(3.0, 2.9, 2.9, 3.1), (9.0, None, None, None)], []),  # said of the value
    ],
)
@pytest.mark.parametrize("reasons", [{}, {"mesh": ["left out"]}])
def test_every_part_that_is_not_there_has_a_line(values, silent, reasons):
    runs, names = (GIVEN, FINE, SLOW, MOVED), ("force_peak_N", "torque_peak_Nmm")
    bars = tuple(error_bar(name, runs, v) for name, v in zip(names, values, strict=True))
    said = ErrorBars("", runs, bars, reasons).said()[2:]
    expected = {part: f"no run has it for {of}" for part, of in silent}
    expected |= {part: "; ".join(why) for part, why in reasons.items()}
    assert said == [f"{part}: {why}" for part, why in expected.items()]


def test_the_section_of_a_report_shows_every_run_and_escapes_what_is_said(found):
    page = error_bars(found)
    assert "slower &lt;b&gt; is not done" in page
    assert (page.count("finer mesh: "), page.count("slower: ")) == (2, 1)
    assert error_bars(None) == ""


def companions(name, settings=None):
    runs, missing = companions_of(read_model(name, settings))
    assert len({tuple(keys) for keys in runs.values()}) == 1  # values of one factor
    return {run.name: keys for run, keys in runs.items()}, missing


def changed(found, name):
    given = found["as given"]
    return {k: v for k, v in found[name].items() if v != given[k]}


FREE = """model = "free"
[membrane]
kind = "disc"
radius = 4
n_side = 12
[tool]
teeth = 4
[motion]
kind = "screw"
angle_deg = 90
duration = 1e-3
"""
SHEET = {"kind": "rectangle", "length": 10, "width": 4, "n_x": 20, "n_y": 9}
NEAR = {"radius": 15, "size_at_path": 0.2, "size": 3}
AWAY = {"tool.phase_deg": 1.8}


def of_film(**keys):
    return {f"membrane.{key}": value for key, value in keys.items()}


@pytest.mark.parametrize(
    ("model", "settings", "name", "keys"),
    [
        # Rows across a strip stay even, and nodes move along it only.
        ("guillotine", {}, "coarser mesh", of_film(size=8.0 / 14)),
        ("guillotine", {}, "finer mesh", of_film(size=8.0 / 30)),
        ("guillotine", {}, "nodes moved", of_film(size=30.0 / 76)),
        ("guillotine", {}, "slower", {"motion.speed": 3000.0}),
        ("guillotine", {}, "shape 3", {"imperfection": 3}),
        # A quasi-static run gets a quarter of its energy.
        (
            "guillotine",
            {"quasi_static": 0.004},
            "slower",
            {"quasi_static": 0.001, "motion.speed": 3000.0},
        ),
        # A tear has no shape and gets two.
        ("trouser", {"motion.ramp": 1e-4}, "slower", {"motion.ramp": 2e-4, "motion.speed": 1250.0}),
        ("trouser", {}, "shape 1", {"imperfection": 1}),
        # The opening turns its teeth by half a quad.
        ("opening", {"mesh": "quick"}, "nodes moved", {"tool.phase_deg": 180.0 / 72}),
        ("opening", {"mesh": "M1"}, "nodes moved", {"tool.phase_deg": 180.0 / 152}),
        ("opening", {"mesh": "M2"}, "nodes moved", {"tool.phase_deg": 180.0 / 276}),
        ("opening", {"mesh": "quick"}, "slower", {"motion.duration": 0.012}),
        # Discs and sheets of rows.
        ("free", of_film(n_side=13, n_layer=6), "finer mesh", of_film(n_side=19, n_layer=9)),
        ("free", of_film(**SHEET), "coarser mesh", of_film(n_x=12, n_y=5)),
        ("free", of_film(**SHEET), "nodes moved", AWAY),
        ("free", of_film(**SHEET), "slower", {"motion.duration": 0.002}),
        # A film along the path is meshed anew.
        ("opening", of_film(mesh="path"), "coarser mesh", of_film(size_at_path=0.6)),
        ("opening", of_film(mesh="path"), "nodes moved", of_film(size_at_path=0.38)),
        ("opening", of_film(**NEAR), "coarser mesh", of_film(size_at_path=0.3, size=4.5)),
        ("opening", of_film(**NEAR), "nodes moved", of_film(size_at_path=0.19, size=2.85)),
        ("opening", of_film(radius=15, size=0.6), "coarser mesh", of_film(size=0.9)),
        ("opening", of_film(radius=15, size=0.6), "nodes moved", AWAY),
    ],
)
def test_a_companion_changes_one_thing(tmp_path, model, settings, name, keys):
    if model == "free":
        model = tmp_path / "free.toml"
        model.write_text(FREE)
    found, missing = companions(model, settings)
    assert missing == {}
    assert changed(found, name) == pytest.approx(keys)


@pytest.mark.parametrize(
    ("model", "film", "rows"),
    [
        # Rows across as given: on the coarser mesh, on the finer one.
        *(("guillotine", {"size": 8.0 / n}, n) for n in (1, 2, 3, 4, 5, 6, 11)),
        *(("trouser", {"size": 6.0 / n, "width": 6.0}, n) for n in (2, 4)),
        *(("free", {**SHEET, "n_y": n}, n) for n in (1, 2, 3, 7)),
        *(("free", {"n_side": n}, n) for n in (1, 2, 3)),
    ],
)
def test_few_rows_have_another_mesh_of_as_many_by_two(tmp_path, model, film, rows):
    if model == "free":
        model = tmp_path / "free.toml"
        model.write_text(FREE)
    runs, missing = companions_of(read_model(model, of_film(**film)))
    sizes = {run.name: run.size for run in runs if run.part == "mesh"}
    assert "mesh" not in missing
    assert sizes["finer mesh"] < 1.0 < sizes.get("coarser mesh", 2.0)
    assert ("coarser mesh" in sizes) == (rows > 2)
    for size in sizes.values():
        n = rows / size
        assert (round(n) - rows) % 2 == 0
        assert n == pytest.approx(round(n))
        assert abs(n - rows) >= 2.0 - 1e-9


def test_which_companions_a_model_gets(tmp_path):
    found, _ = companions("guillotine")
    around = ["coarser mesh", "finer mesh", "nodes moved", "slower"]
    assert list(found) == ["as given", *around, "shape 2", "shape 3"]
    assert companions("trouser")[0]["as given"]["imperfection"] == 0
    for mesh, others in (("quick", ["M1"]), ("M1", ["quick", "M2"]), ("M2", ["M1", "quick"])):
        found, _ = companions("opening", {"mesh": mesh})
        assert [name for name in found if name.startswith("mesh")] == [f"mesh {m}" for m in others]
    film = Path(__file__).parent / "data" / "gmsh_4.1.msh"
    strip = {"membrane.file": str(film), "material.rate": {"rate": 40.0, "exponent": 5.0}}
    found, missing = companions("guillotine", strip | {"material.hardening.yield_stress": 20.0})
    assert list(found) == ["as given", "finer mesh", "shape 2", "shape 3"]
    assert changed(found, "finer mesh") == {"membrane.refine": 1}
    assert "depends on the rate" in missing["speed"][0]
    loaded = tmp_path / "loaded.toml"
    loaded.write_text(f'{FREE}[[loads]]\nkind = "pressure"\nvalue = 0.1\nramp = "1 ms"\n')
    assert "change in time" in companions(loaded)[1]["speed"][0]

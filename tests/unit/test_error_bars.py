"""Error bars from made-up figures, against closed forms; which companions a model gets."""

import math
from pathlib import Path

import pytest
import scipy

from shellcut import ErrorBars, read_model
from shellcut.report.error_bars import error_bars
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
    def test_an_exact_order_is_found_on_any_ratios(self, order):
        assert error_bar("force_peak_N", MESHES, at(order)).order == pytest.approx(order)
        uneven = GIVEN, Run("M1", "mesh", 1.8), Run("quick", "mesh", 3.8)
        assert error_bar("force_peak_N", uneven, at(order, uneven)).order == pytest.approx(order)

    def test_the_band_ends_at_the_limit_of_first_order_and_holds_that_of_higher_ones(self):
        bar = error_bar("force_peak_N", MESHES, at(1.0))
        assert bar.value - bar.half_width == pytest.approx(3.0)
        assert bar.value == at(1.0)[2]
        assert bar.parts == {"mesh": bar.half_width}
        for order in (1.5, 2.0, 3.0):
            bar = error_bar("force_peak_N", MESHES, at(order))
            assert 0.0 < bar.value - 3.0 < bar.half_width

    def test_without_a_finer_mesh_the_coarser_one_gives_the_same_limit(self):
        bar = error_bar("force_peak_N", (GIVEN, COARSE), at(1.0)[:2])
        assert (bar.value, bar.order) == (pytest.approx(3.2), None)
        assert bar.value - bar.half_width == pytest.approx(3.0)

    def test_an_error_that_goes_with_the_speed_is_left_at_its_end(self):
        bar = error_bar("force_peak_N", (GIVEN, SLOW), [3.4, 3.2])
        assert (bar.value, bar.parts) == (pytest.approx(3.2), {"speed": pytest.approx(0.2)})

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
        (said,) = ErrorBars("", MESHES, (bar,), {}).said()
        assert "does not converge with an order" in said

    def test_a_crack_is_known_to_an_edge(self):
        alone = (Run("as given", "", 1.0), Run("shape 2", "chance", 1.0))
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
    assert said[-1] == "speed: slower <b> is not done"


def test_the_section_of_a_report_shows_every_run_and_escapes_what_is_said(found):
    page = error_bars(found)
    assert "slower &lt;b&gt; is not done" in page
    assert page.count("finer mesh: ") == 2
    assert page.count("slower: ") == 1
    assert error_bars(None) == ""


def companions(name, settings=None):
    runs, missing = companions_of(read_model(name, settings))
    assert len({tuple(keys) for keys in runs.values()}) == 1  # values of one factor
    return {run.name: keys for run, keys in runs.items()}, missing


def changed(found, name):
    given = found["as given"]
    return {k: v for k, v in found[name].items() if v != given[k]}


class TestCompanions:
    def test_rows_across_a_strip_stay_even_and_nodes_move_along_it_only(self):
        found, missing = companions("guillotine")
        assert missing == {}
        assert list(found) == [
            *("as given", "coarser mesh", "finer mesh", "nodes moved", "slower"),
            *("shape 2", "shape 3"),
        ]
        assert found["coarser mesh"]["membrane.size"] == 8.0 / 14
        assert found["finer mesh"]["membrane.size"] == 8.0 / 30
        assert changed(found, "nodes moved") == {"membrane.size": 30.0 / 76}
        assert changed(found, "slower") == {"motion.speed": 3000.0}
        assert changed(found, "shape 3") == {"imperfection": 3}

    @pytest.mark.parametrize(
        ("mesh", "others"),
        [("quick", ["M1"]), ("M1", ["quick", "M2"]), ("M2", ["M1", "quick"])],
    )
    def test_the_opening_takes_its_other_meshes_and_turns_the_teeth(self, mesh, others):
        found, _ = companions("opening", {"mesh": mesh})
        assert [name for name in found if name.startswith("mesh")] == [f"mesh {m}" for m in others]
        around = {"quick": 72, "M1": 152, "M2": 276}[mesh]
        assert changed(found, "nodes moved") == {"tool.phase_deg": 180.0 / around}
        assert changed(found, "slower") == {"motion.duration": 0.012}

    def test_discs_and_sheets_of_rows(self, tmp_path):
        disc = {"membrane.kind": "disc", "membrane.radius": 4, "membrane.n_side": 13}
        path = tmp_path / "free.toml"
        path.write_text(FREE)
        found, _ = companions(path, disc | {"membrane.n_layer": 6})
        assert changed(found, "finer mesh") == {"membrane.n_side": 19, "membrane.n_layer": 9}
        sheet = {"membrane.length": 10, "membrane.width": 4, "membrane.n_x": 20, "membrane.n_y": 9}
        found, _ = companions(path, sheet | {"membrane.kind": "rectangle"})
        assert changed(found, "coarser mesh") == {"membrane.n_x": 14, "membrane.n_y": 5}
        assert changed(found, "nodes moved") == {"tool.phase_deg": 1.8}
        assert changed(found, "slower") == {"motion.duration": 0.002}

    @pytest.mark.parametrize(
        ("film", "coarser", "moved"),
        [
            ({"mesh": "path"}, {"size_at_path": 0.6}, {"size_at_path": 0.38}),
            (
                {"radius": 15, "size_at_path": 0.2, "size": 3},
                {"size_at_path": 0.3, "size": 4.5},
                {"size_at_path": 0.19, "size": 2.85},
            ),
            ({"radius": 15, "size": 0.6}, {"size": 0.9}, None),
        ],
    )
    def test_a_film_along_the_path_is_meshed_anew(self, film, coarser, moved):
        found, missing = companions("opening", {f"membrane.{k}": v for k, v in film.items()})
        assert missing == {}
        sizes = {f"membrane.{k}": pytest.approx(v) for k, v in coarser.items()}
        assert changed(found, "coarser mesh") == sizes
        away = {"tool.phase_deg": 1.8}
        if moved is not None:
            away = {f"membrane.{k}": pytest.approx(v) for k, v in moved.items()}
        assert changed(found, "nodes moved") == away

    def test_what_is_missing_is_told(self, tmp_path):
        data = Path(__file__).parent / "data"
        film = next(path for path in sorted(data.iterdir()) if path.suffix == ".msh")
        strip = {"membrane.file": str(film), "material.rate": {"rate": 40.0, "exponent": 5.0}}
        strip |= {"material.hardening.yield_stress": 20.0}
        found, missing = companions("guillotine", strip)
        assert list(found) == ["as given", "finer mesh", "shape 2", "shape 3"]
        assert changed(found, "finer mesh") == {"membrane.refine": 1}
        assert "depends on the rate" in missing["speed"][0]
        loaded = tmp_path / "loaded.toml"
        loaded.write_text(f'{FREE}[[loads]]\nkind = "pressure"\nvalue = 0.1\nramp = "1 ms"\n')
        assert "change in time" in companions(loaded)[1]["speed"][0]

    def test_a_quasi_static_run_gets_a_quarter_of_its_energy(self):
        found, _ = companions("guillotine", {"quasi_static": 0.004})
        assert changed(found, "slower") == {"quasi_static": 0.001, "motion.speed": 3000.0}

    def test_a_tear_has_no_shape_and_gets_two(self):
        found, _ = companions("trouser", {"motion.ramp": 1e-4})
        assert found["as given"]["imperfection"] == 0
        assert changed(found, "slower") == {"motion.ramp": 2e-4, "motion.speed": 1250.0}
        assert changed(found, "shape 1") == {"imperfection": 1}


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

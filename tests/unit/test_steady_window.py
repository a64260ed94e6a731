"""The steady window is where the history says that every edge cuts steadily, or nowhere."""

import re

import numpy as np
import pytest

from notched_strip import cutting
from shellcut.models import Case
from shellcut.results.run_results import read
from shellcut.results.steady_window import (
    half_width_of,
    no_mean_of,
    steady_figures,
    steady_window,
    without_means,
)
from steady_cut import ARC, SPACING, edge, edge_columns

ANGLE, PATH = ("angle", "deg"), ("path", "mm")


def history(x, edges, coordinate=ANGLE, **columns):
    named = {"time": np.linspace(0.0, 1e-3, len(x)), coordinate[0]: x, "tool_work": 140.0 * x}
    return named | edge_columns(edges) | columns


def sum_of(x, force):
    """Return the integral of a force at the middles of the rows."""
    return np.append(0.0, np.cumsum(force(0.5 * (x[1:] + x[:-1])) * np.diff(x)))


X = np.linspace(0.0, 95.0, 1901)


def test_from_the_renewed_zone_to_the_neighbourhood_of_the_next_cut():
    window = steady_window(history(X, [edge(X)] * 4), ANGLE)
    assert window
    # The cut is 2.4 mm long when the first cable has broken (a spacing behind 2 mm): from 4.8 mm on
    # until 2.4 mm are left ahead of the edge, in steps of the spacing.
    assert window.low == pytest.approx(4.8 / 0.18, abs=0.06)
    assert window.high == pytest.approx((ARC - 2.4) / 0.18, abs=0.06)
    assert window.text("deg") == f"{window.low:.3g} to {window.high:.3g} deg"
    assert (X[[window.first, window.last]] == (window.low, window.high)).all()


def test_the_mean_is_of_whole_periods_and_of_every_step():
    # Of a sawtooth, and of its integral: the rows of the torque itself do not count.
    place = 0.18 * X / SPACING
    sawtooth = 140.0 + 20.0 * np.mod(place, 1.0)
    period = np.radians(SPACING / 0.18)
    done = period * (140.0 * place + 20.0 * (np.floor(place) + np.mod(place, 1.0) ** 2) / 2.0)
    work = np.radians(X) * 135.2
    h = history(X, [edge(X)] * 4, torque=sawtooth, cohesive_work=work, tool_work=2.0 * work)
    h |= {"axial_force": sawtooth, "torque_integral": done, "axial_force_integral": 0.1 * done}
    figures = steady_figures(h, ANGLE, ("torque", "N*mm"))
    # Rows 0.05 degrees apart of teeth 2.2 degrees long: 2 % of the tooth at each end.
    assert figures["torque_plateau_Nmm"] == pytest.approx(150.0, rel=1e-3)
    assert figures["axial_force_plateau_N"] == pytest.approx(15.0, rel=1e-3)
    assert figures["dWcoh_dtheta_Nmm"] == pytest.approx(135.2, rel=1e-12)
    assert figures["dW_dtheta_Nmm"] == pytest.approx(270.4, rel=1e-12)
    window = steady_window(h, ANGLE)
    assert (figures["window_from_deg"], figures["window_to_deg"]) == (window.low, window.high)


@pytest.mark.parametrize(
    ("edges", "end", "low", "high"),
    [
        # Teeth that enter late are waited for.
        ([edge(X, arc=17.0), edge(X, begins=10.0)], "low", 34.3, 39.0),
        # It ends where the tool has left the film, or a cable is met at the end of an edge.
        ([edge(X, leaves=60.0)], "high", 60.0 - 0.4 / 0.18, 60.0),
        ([(*edge(X)[:3], np.where(X < 60.0, 1.0, 0.0))], "high", 60.0 - 0.8 / 0.18, 59.99),
        # An edge that meets a cable by the way is not waited for.
        ([edge(X), edge(X, arc=0.8)], "low", 4.8 / 0.18 - 0.06, 4.8 / 0.18 + 0.06),
    ],
    ids=["late", "left", "at the end", "by the way"],
)
def test_the_window_begins_and_ends_with_what_cuts(edges, end, low, high):
    assert low <= getattr(steady_window(history(X, edges), ANGLE), end) <= high


def test_cables_at_irregular_distances_part_no_window():
    # As quads by Gmsh have them: every tenth lies within a twentieth of the next. The edge waits
    # for it as long as for any other.
    met, zone, _, spare = edge(X)
    places = np.cumsum(np.tile([*[SPACING] * 9, 0.05 * SPACING], 10))
    irregular = np.append(0.0, places)[np.round(met / SPACING).astype(int)]
    ahead = np.maximum(ARC - irregular, 0.0)
    window = steady_window(history(X, [(irregular, zone, ahead, spare)]), ANGLE)
    assert window.high - window.low > 40.0


def test_it_begins_when_the_motion_is_up_to_speed():
    # Over half of the way the speed rises, as fast as time; then it stays.
    time = np.linspace(0.0, 2.0, 1901)
    x = np.where(time < 1.0, 0.5 * time**2, time - 0.5) * 60.0
    h = history(x, [edge(x, rate=0.3, arc=40.0)]) | {"time": time}
    assert steady_window(h, ANGLE).low >= 0.5 * 0.95**2 * 60.0


def test_a_crossing_of_an_earlier_cut_parts_the_window():
    met, zone, ahead, spare = edge(X, arc=40.0)
    # Another cut lies across the way at 5.6 mm.
    ahead = np.where(met < 5.2, 5.6 - met - SPACING, ahead)
    window = steady_window(history(X, [(met, zone, np.maximum(ahead, 0.0), spare)]), ANGLE)
    assert window.low >= 5.2 / 0.18


@pytest.mark.parametrize("n_row", [1150, 1300, 1500])
def test_a_run_cut_short_says_the_same_of_what_it_has(n_row):
    whole = steady_window(history(X, [edge(X)] * 4), ANGLE)
    x = X[:n_row]
    part = steady_window(history(x, [edge(x)] * 4), ANGLE)
    assert part.low == whole.low
    assert part.high == whole.high or part.high > x[-1] - SPACING / 0.18 - 0.06


@pytest.mark.parametrize(
    ("last", "edges", "said"),
    [
        (
            95.0,
            [],
            "the history has no cut length, as of a tool without cutting edges",
        ),
        (95.0, [{"rate": 0.0}], "no cable was bent around a cutting edge"),
        (-1.0, [{"rate": 0.0}], "no cable was bent around a cutting edge"),
        (9.9, [{}], "cutting edge 1 has cut 1.6 mm, and none of its cables has broken"),
        (19.9, [{}], "1 has cut 3.2 mm; its process zone is renewed only after 4.8 mm"),
        (95.0, [{"arc": 4.9}] * 12, "had been renewed, at 26.7 deg, cutting edge 1 had 0.1 mm to"),
        (29.9, [{}], "only last from 26.7 to 28.9 deg, in which cutting edge 1 cuts 0.4 mm; a "),
        # One leaves the film before the other's zone is renewed.
        (95.0, [{"leaves": 30.0}, {"begins": 20.0}], "left the film, or stopped, before 46.7 deg"),
    ],
)
def test_where_there_is_none_the_reason_is_said(last, edges, said):
    x = X[last >= X]
    window = steady_window(history(x, [edge(x, **options) for options in edges]), ANGLE)
    assert not window
    assert np.isnan([window.low, window.high]).all()
    assert window.text("deg") == f"none: {window.reason}"
    assert said in window.reason


LONG = np.linspace(0.0, 60.0, 3001)
STRAIGHT = [edge(LONG, rate=1.0, arc=58.0)]  # steady from 4.8 to 55.6 mm


def steady_straight(force, between=None):
    h = history(LONG, STRAIGHT, PATH, cohesive_work=3.1 * LONG, tool_work=sum_of(LONG, force))
    return steady_figures(h | {"strain": 0.0 * LONG}, PATH, ("force", "N"), between)


def test_a_force_that_jumps_has_no_mean_and_both_its_levels_are_said():
    found = steady_straight(lambda x: np.where(x < 18.0, 4.25, 5.15))
    assert set(found) == {"no_window"}
    words = r"jumps at (\S+) mm: its mean is (\S+) N from 4.8 mm on, then (\S+) N to 55.6 mm"
    at, before, after = map(float, re.search(words, found["no_window"]).groups())
    assert at == pytest.approx(18.0, abs=0.03)  # a row
    assert (before, after) == pytest.approx((4.25, 5.15), rel=1e-3)


def test_a_force_that_drifts_has_none_either():
    found = steady_straight(lambda x: 3.0 + 0.01 * x)
    assert found == {"no_window": "the force drifts from 3.048 N at 4.8 mm to 3.556 N at 55.6 mm"}
    # By 1 % over the window it is steady, and the mean's ± has most of it.
    found = steady_straight(lambda x: 3.0 + 0.0006 * x)
    assert found["force_plateau_N"] == pytest.approx(3.0 + 0.0006 * 30.2, abs=1e-4)
    assert 0.2 < found["force_plateau_half_width_N"] / (0.0006 * 50.8) < 0.5


@pytest.mark.parametrize(
    ("axial", "work", "left_out", "words"),
    [
        (lambda x: -1.8 + 0.07 * x, lambda x: 3.1 + 0.0 * x, "axial_force_plateau_N", "drifts"),
        (
            lambda x: np.where(x < 30.0, 1.0, 1.6),
            lambda x: 3.1 + 0.0 * x,
            "axial_force_plateau_N",
            "the axial force jumps at 30",
        ),
        (lambda x: 2.0 + 0.0 * x, lambda x: 2.0 + 0.03 * x, "dWcoh_ds_N", "cables' work per mm"),
        (lambda x: 2.0 + 0.0 * x, lambda x: 3.1 + 0.0 * x, None, ""),
    ],
)
def test_each_mean_is_of_what_is_steady(axial, work, left_out, words):
    force = sum_of(LONG, lambda x: 3.2 + 0.0 * x)
    columns = {"axial_force": axial(LONG), "axial_force_integral": sum_of(LONG, axial)}
    columns |= {"force_integral": force, "tool_work": force, "cohesive_work": sum_of(LONG, work)}
    h = history(LONG, STRAIGHT, PATH, strain=0.0 * LONG, **columns)
    found = steady_figures(h, PATH, ("force", "N"))
    for name, value in (("force_plateau_N", 3.2), ("axial_force_plateau_N", 2.0)):
        if name != left_out:
            assert found[name] == pytest.approx(value, rel=1e-9)
    means = {"force_plateau_N", "axial_force_plateau_N", "dWcoh_ds_N", "dW_ds_N"} - {left_out}
    assert {name for name in found if half_width_of(name) in found} == means
    reasons = {name: said for name, said in found.items() if isinstance(said, str)}
    assert list(reasons) == ([no_mean_of(left_out)] if left_out else [])
    assert all(words in said for said in reasons.values())
    # In the table of a study the means of its common window replace all of these.
    assert not {name for name in without_means(found) if name in means or name in reasons}


def test_the_end_of_the_start_is_left_out():
    found = steady_straight(lambda x: np.where(x < 6.8, 2.0, 3.2))
    # The first process zone, 2.4 mm.
    assert found["window_from_mm"] == pytest.approx(7.2, abs=0.03)
    assert found["force_plateau_N"] == pytest.approx(3.2, rel=1e-9)
    assert found["dWcoh_ds_N"] == pytest.approx(3.1, rel=1e-12)
    # What lasts longer is no start.
    found = steady_straight(lambda x: np.where(x < 15.0, 2.0, 3.2))
    assert "jumps at" in found["no_window"]


def test_a_swing_has_a_mean_with_a_wide_half_width():
    # Of 6 and of 30 mm, 0.8 to 1.4 N: the short one averages out.
    wide, narrow = (
        steady_straight(lambda x, length=length: 1.1 + 0.3 * np.sin(2.0 * np.pi * x / length))
        for length in (15.0, 2.0)
    )
    assert wide["force_plateau_half_width_N"] > 0.05
    assert narrow["force_plateau_half_width_N"] < 0.01
    for found in (wide, narrow):
        assert abs(found["force_plateau_N"] - 1.1) < found["force_plateau_half_width_N"]


def test_a_window_in_common_is_tested_on_its_own():
    def force(x):
        return np.where(x < 30.0, 3.0, 4.0)

    assert "no_window" in steady_straight(force)
    found = steady_straight(force, (31.0, 50.0))
    assert found["force_plateau_N"] == pytest.approx(4.0, rel=1e-12)
    assert (found["window_from_mm"], found["window_to_mm"]) == pytest.approx((31.0, 50.0), abs=0.02)
    assert "a mean with its ± takes" in steady_straight(force, (31.0, 33.0))["no_window"]
    assert "no_window" in steady_straight(force, (70.0, 80.0))


def test_a_small_run_says_what_it_cut(tmp_path):
    """The front as the history has it, against the cables and the mesh at the end."""
    sim = cutting(pulled=False)
    Case("cut", sim, 1.6e-4).run(
        tmp_path, n_row=200, n_frame=2, n_snapshot=0, curves=False, progress=False
    )
    h = read(tmp_path).history
    cable, n = sim.state.cable, sim.state.n_cable
    met = cable.overshoot[:n] > 0.0
    assert h["cut_length_edge_1"][-1] == pytest.approx(cable.length[:n][met].sum(), rel=1e-15)
    holds = cable.status[:n] == 1
    zone = cable.length[:n][holds].sum()
    assert h["process_zone_edge_1"][-1] == pytest.approx(zone, rel=1e-15)
    assert (np.diff(h["cut_length_edge_1"]) >= 0.0).all()
    # One crack along y = 0 up to 3.2 mm, the film's end, node by node of 0.4 mm, six cables a node.
    # The edge meets the first half a spacing beyond 0.4 mm, wherever the tip is, and has none to go
    # when the tip is at the end.
    ahead, spacing = h["uncut_ahead_edge_1"], 0.4 / 6.0
    left = ahead[ahead > 0.0]
    assert left[0] == pytest.approx(2.8 - 0.5 * spacing, abs=1e-12)
    assert (np.diff(left) <= 0.0).all()
    assert left / spacing - 0.5 == pytest.approx(np.round(left / spacing - 0.5), abs=1e-9)
    assert ahead[-1] == 0.0

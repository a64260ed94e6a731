"""What a run answers: each question with its ±, or why there is no answer."""

import re
from collections import defaultdict

import numpy as np
import pytest

import shellcut as sc
from shellcut.models.case import Case
from shellcut.results.answers import answers
from shellcut.results.summary_figures import run_figures
from shellcut.simulation.simulation import Simulation

TORQUE = {"torque_plateau_Nmm": 140.7, "torque_plateau_half_width_Nmm": 1.4}
PEAK = {"torque_peak_Nmm": 166.8, "torque_peak_at_deg": 36.07}
STEADY = {"window_from_deg": 27.3, "window_to_deg": 68.9}
PRESS = STEADY | {"axial_force_plateau_N": -0.27, "axial_force_peak_N": 4.48}
PRESS |= {"bending_length_mm": 0.216, "options": {"film_edges": True}}
PIERCING = {
    f"piercing_{what}_{k}_{unit}": value + 0.01 * k
    for k in (1, 2, 10)
    for what, unit, value in (("force", "N", 0.39), ("depth", "mm", 0.09), ("work", "Nmm", 0.07))
}
SHARP = {"edge_radius_mm": 0.002, "blunt_radius_mm": 0.1, "severing_energy_N_per_mm": 2.5}


@pytest.mark.parametrize(
    ("summary", "asked", "said"),
    [
        (
            STEADY | TORQUE | PEAK,
            "torque to cut",
            "140.7 ± 1.4 N·mm (mean over 27.3-68.9°); at most 166.8 N·mm, at 36.07°",
        ),
        (
            PEAK | {"no_window": "the torque jumps at 40°"},
            "torque to cut",
            "at most 166.8 N·mm, at 36.07°; no mean: the torque jumps at 40°",
        ),
        (PRESS | {"path_edge_mm": 0.8}, "force to press", "doubtful"),
        (PRESS | {"path_edge_mm": 0.2}, "force to press", "°); at most 4.48 N"),
        (
            PIERCING,
            "piercing",
            "3 cutting edges pierced whole film with 0.4 N to 0.49 N each, 0.1 mm to 0.19 mm "
            "deep, after 0.08 N·mm to 0.17 N·mm of work",
        ),
        (
            {"off_path_mm": 0.018, "n_tear": 3, "tear_off_path_mm": 0.4},
            "flanks",
            "cuts lie within 0.018 mm of the path of the cutting edges; 3 cuts are tears, up to "
            "0.4 mm beside it",
        ),
        (SHARP, "sharpness", "severs cables at 2.5 N/mm; from 0.1 mm on"),
    ],
)
def test_a_question_has_its_answer_and_no_other_question_is_answered(summary, asked, said):
    ((question, answer),) = answers(summary)
    assert question == asked
    assert said in answer
    assert ("doubtful" in answer) == (said == "doubtful")


@pytest.mark.parametrize(
    ("force", "said"),
    [
        (lambda u: 2.3 * np.sin(4.0 * u) - 0.1, "between -2.4 N at 67.5° and 2.2 N at 22.5°"),
        (lambda u: np.where(u < 1.0, -4.0 * u, u), "between -3.98 N at 57° and 1.57 N at 90°"),
        (lambda u: 3.0 * np.sin(2.0 * u) - 0.1, "at most 2.9 N, at 45°"),  # starts at -0.1
        (lambda u: 0.1 - 3.0 * np.sin(2.0 * u), "down to -2.9 N, at 45°"),
        (lambda u: np.where(u < 1.2, 1.0 + u, np.nan), "at most 2.2 N, at 68.7°"),
        (lambda u: 0.0 * u, "at most 0 N, at 0°"),
    ],
)
@pytest.mark.parametrize(("name", "asked"), [("axial_force", "to press"), ("force", "to cut")])
def test_a_force_of_both_signs_has_both_extremes_with_their_places(name, asked, force, said):
    angle = np.linspace(0.0, 90.0, 301)
    history = defaultdict(lambda: 0.0 * angle, time=angle, angle=angle, crack_length=angle)
    history[name] = force(np.radians(angle))
    found = run_figures(history, ("angle", "deg"), ("force", "N"))
    low, high, peak = (found[f"{name}_{which}_N"] for which in ("min", "max", "peak"))
    assert (low, high) == (np.nanmin(history[name]), np.nanmax(history[name]))
    assert abs(peak) == max(-low, high)
    for which, value in (("min", low), ("max", high), ("peak", peak)):
        row = np.flatnonzero(angle == found[f"{name}_{which}_at_deg"])
        assert history[name][row] == value
    told = answers({one: value for one, value in found.items() if one.startswith(f"{name}_")})
    assert [(question, rounded(answer)) for question, answer in told] == [(f"force {asked}", said)]


def rounded(text):
    return re.sub(r"-?\d+\.\d+", lambda found: f"{float(found[0]):.3g}", text)


def test_a_loose_piece_is_told_with_its_area_and_place(tmp_path):
    mesh = sc.Mesh.from_arrays(
        [[x, y, 0.0] for y in (0.0, 1.0) for x in (0.0, 1.0, 2.0, 5.0, 8.0, 11.0)],
        [[0, 1, 7, 6], [1, 2, 8, 7], [3, 4, 10, 9], [4, 5, 11, 10]],
        node_sets={"end": [0, 6]},
    )
    film, law = sc.ShellMaterial.homogeneous(), sc.CohesiveLaw()
    moved = sc.Support("end", velocity={"z": lambda time: 1.0})
    sim = Simulation(mesh, film, law=law, supports=[moved])
    Case("pieces", sim, 2.0 * sim.dt).run(tmp_path / "out", progress=False)
    summary = sc.read(tmp_path / "out").summary
    assert summary["n_loose"] == 1
    assert summary["loose_area_mm2"] == pytest.approx(6.0, rel=1e-12)
    centre = [summary[f"loose_{axis}_mm"] for axis in "xyz"]
    np.testing.assert_allclose(centre, [8.0, 0.5, 0.0], atol=1e-9)
    assert dict(answers(summary))["loose pieces"] == "1 piece of 6 mm² about (8, 0.5, 0) mm"

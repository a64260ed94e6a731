"""The verdict: figures against their bands."""

import logging
import re

import pytest

from shellcut.results.answers import conclusion, ending
from shellcut.results.summary_figures import key_figures
from shellcut.results.verdict import LOGGER, Line, say, verdict


def line_with(said, figures):
    """Return the line of a verdict that says something, or None."""
    found = [line for line in verdict(figures) if said in line.text]
    assert len(found) <= 1
    return found[0] if found else None


PUT_IN = {"tool_work_Nmm": 100.0, "cut_work_Nmm": 100.0}
FLAT = {"options": {"film_edges": False}, "film_half_thickness_mm": 0.037}
FELT = FLAT | {"options": {"film_edges": True}}
DEEP = {"deepest_penetration_mm": 0.04, "tool_half_thickness_mm": 0.2}
DEEPER = DEEP | {"tool_half_thickness_mm": 0.1}
KEPT = PUT_IN | {"contact_Nmm": 5.03, "contact_stored_Nmm": 5.0, "contact_lost_Nmm": 0.03}
LOST = KEPT | {"contact_stored_Nmm": 0.03, "contact_lost_Nmm": 5.0}
GREW = PUT_IN | {"stored_growth_rel": 0.0, "cables_growth_rel": 0.6, "friction_growth_rel": 0.31}
ELSE = GREW | {"friction_growth_rel": 0.0, "contact_growth_rel": 0.1, "damping_growth_rel": 0.3}
GAVE = PUT_IN | {"stored_growth_rel": -0.2, "cables_growth_rel": 1.2}
FREED = PUT_IN | {"stored_growth_rel": -9.2, "cables_growth_rel": 10.0, "damping_growth_rel": 0.2}
FREE = {"tool_work_Nmm": 1.0, "kinetic_rel": 0.856, "options": {"unheld": True}}
UNTOUCHED = {"deepest_penetration_mm": 0.0, "unfelt_penetration_mm": 0.0, "edge_length_mm": 0.8}
UNTOUCHED |= {"tool_half_thickness_mm": 0.2, "n_cable_created": 0, "initial_Nmm": 6e-7}


@pytest.mark.parametrize(
    ("figures", "kind", "said"),
    [
        # At the limit and beyond it.
        ({"imbalance_rel": 0.01}, "good", "the error is at most 1 %"),
        (PUT_IN | {"imbalance_rel": 0.02}, "doubt", "the error is at most 2 %"),
        ({"kinetic_rel": 0.05}, "good", "reaches 5 %"),
        (PUT_IN | {"kinetic_rel": 0.08}, "doubt", "reaches 8 %"),
        (
            PUT_IN | {"kinetic_rel": 0.8, "load_work_Nmm": 101.0},
            "doubt",
            "or the loads change too fast",
        ),
        (PUT_IN | {"kinetic_rel": 0.8, "load_work_Nmm": 99.0}, "doubt", "The motion is too fast"),
        (FREE, "doubt", "The film, or a piece of it, is not supported, so that its inertia"),
        (PUT_IN | {"damping_Nmm": 12.0}, "doubt", "springs open: 12 %"),
        (PUT_IN | {"contact_Nmm": -6.0}, "doubt", "gave the film 6 %"),
        (PUT_IN | {"contact_Nmm": -1.1}, "doubt", "Contact creates energy"),
        (PUT_IN | {"contact_Nmm": -0.9}, "good", "it gave the film 0.9 %"),
        (PUT_IN | {"contact_Nmm": 5.1}, "doubt", "(limit 5 %)"),
        (PUT_IN | {"contact_Nmm": 4.9}, "good", "it took 4.9 %"),
        # Only what applies is named as the cause.
        (KEPT, "doubt", "in its springs, because film presses hard on the tool: it took 5.03 % of"),
        (LOST, "doubt", "loses too much energy where film hits the tool"),
        ({"unfelt_penetration_mm": 0.35, "edge_length_mm": 0.7}, "good", "0.35 mm"),
        ({"unfelt_penetration_mm": 0.4, "edge_length_mm": 0.7}, "doubt", "0.4 mm"),
        (DEEP, "good", "up to 0.04 mm deep in the tool (limit 0.05 mm"),
        (
            DEEPER,
            "doubt",
            "(limit 0.025 mm, a quarter of 0.1 mm, the tool's volume over its",
        ),
        (FLAT | {"unfelt_film_edge_mm": 0.037}, None, "Borders or flanks"),
        (
            FLAT | {"unfelt_film_edge_mm": 0.098},
            "note",
            "film_edges = true or a finer film",
        ),
        (FELT | {"unfelt_film_edge_mm": 0.098}, "note", "Use a finer film"),
        ({"overstress_rel": 1.5}, "doubt", "would have torn where it has no notch"),
        ({"overstress_rel": 1.1}, None, "would have torn"),
        ({"idle_edge": 2, "idle_edge_load_rel": 2.8}, "doubt", "Cutting edge 2 has cut nothing"),
        ({"idle_edge": 2, "idle_edge_load_rel": 1.1}, None, "has cut nothing"),
        # Of what the steady window became.
        (PUT_IN | {"stored_growth_rel": 0.45, "n_imperfection": 0}, "doubt", "stored 45 %"),
        (GREW | {"damping_growth_rel": 0.09}, "good", "all else took 9 %"),
        (ELSE, "doubt", "all else took 40 % of the work in that window (limit"),
        (FREED, "good", "all else took 2 % of the work in that"),
        (GAVE, "note", "The film released energy that it had stored"),
        # Of the cut.
        ({"n_split": 1, "n_split_off_path": 0, "off_path_mm": 0.01}, "good", "1 of 1 splits are"),
        ({"n_split": 72, "n_split_off_path": 12, "off_path_mm": 1.74}, "doubt", "12 of 72 splits"),
        ({"n_split": 67, "n_tear": 9}, "note", "9 of 76 cuts are tears"),
        ({"n_tear": 2}, "note", "2 of 2 cuts"),
        ({"no_window": "no cable has broken"}, "note", "no mean is given: no cable has broken."),
        ({"overshoot_rel": 0.019}, "good", "meets them after 1.9 %"),
        ({"overshoot_rel": 0.6}, "doubt", "does not move where it points"),
        (UNTOUCHED, "doubt", "Nothing was cut: the tool never touched the film."),
        ({"share_done": 0.34}, "note", "stopped at 34 % of its time"),
        ({"share_done": 0.34, "broke_off": 1}, "doubt", "failed within a step, at 34 %"),
    ],
)
def test_a_figure_is_judged_by_its_limit(figures, kind, said):
    line = line_with(said, figures)
    assert (line and line.kind) == kind


def test_what_is_unknown_or_never_took_place_is_not_judged():
    assert verdict({}) == []
    assert [line.kind for line in verdict(UNTOUCHED)] == ["doubt", "note"]
    assert not any("slower" in line.text for line in verdict(FREE))


def test_the_axial_force_of_flanks_that_cannot_fold_is_distrusted_alone():
    def of(edge, *, press=True, axial="axial_force_plateau_N"):
        figures = {"path_edge_mm": edge, "bending_length_mm": 0.216, axial: -0.27}
        return figures | {"torque_plateau_Nmm": 140.0, "options": {"film_edges": press}}

    for figures in (of(0.208), of(0.398, press=False), of(0.398, axial="force_plateau_N")):
        assert line_with("axial force", figures) is None
        assert not any("distrust" in label for label, _ in key_figures(figures))
        assert "doubtful" not in conclusion(figures, 0)
    line = line_with("axial force", of(0.398))
    assert line.kind == "note"
    assert "sides of 0.398 mm (limit 0.216 mm)" in line.text
    marked = [label for label, _ in key_figures(of(0.398)) if "(distrust)" in label]
    assert marked == ["axial force, mean over  (distrust)"]
    said = conclusion(of(0.398) | PEAK, 0)
    assert said.endswith("; one value is doubtful: the axial force.")


PEAK = {"torque_peak_Nmm": 166.6, "torque_peak_at_deg": 36.1, "tool_work_Nmm": 9.0}
STEADY = {"window_from_deg": 27.3, "window_to_deg": 68.9, "torque_plateau_Nmm": 140.6}


@pytest.mark.parametrize(
    ("figures", "n_doubt", "said"),
    [
        (
            PEAK | STEADY | {"torque_plateau_half_width_Nmm": 1.4, "crack_length_mm": 59.0},
            0,
            "The cut took a torque of 140.6 ± 1.4 N·mm (mean over 27.3-68.9°); no check failed.",
        ),
        (
            PEAK | {"crack_length_mm": 3.0, "no_window": "no cable has broken", "share_done": 0.34},
            2,
            "Up to 34 % of its time, where the run was stopped, the cut took a torque of at most "
            "166.6 N·mm, at 36.1°, but no steady value exists: no cable has broken; there are 2 "
            "doubts.",
        ),
        (
            PEAK | {"share_done": 0.5, "broke_off": 1},
            1,
            "Up to 50 % of its time, where the run failed, moving the tool took a torque of at "
            "most 166.6 N·mm, at 36.1°; there is 1 doubt.",
        ),
        (
            {"force_peak_N": 3.2, "crack_length_mm": 2.0},
            0,
            "Pulling the film apart took a force of at most 3.2 N; no check failed.",
        ),
        ({"crack_length_mm": 3.0, "tool_work_Nmm": 9.0}, 0, ""),
    ],
)
def test_one_sentence_says_what_a_run_found(figures, n_doubt, said):
    assert conclusion(figures, n_doubt) == said


def test_the_end_of_a_run_folds_the_checks_that_passed():
    summary = {"imbalance_rel": 0.001, "kinetic_rel": 0.5, "tool_work_Nmm": 9.0, "cables_Nmm": 9.0}
    summary |= PEAK | {"cut_work_Nmm": 9.0, "n_cable_broken": 1, "n_step": 12}
    summary["verdict"] = [vars(line) for line in verdict(summary)]
    short, whole = (list(ending(summary, verbose=all_of_it)) for all_of_it in (False, True))
    assert short[0].startswith("Moving the tool took a torque of at most 166.6 N·mm")
    assert short[1].startswith("distrust: The motion is too fast")
    assert len([line for line in whole if line.startswith("ok: ")]) == 4
    assert "4 checks passed:" in whole
    assert not any(line.startswith("ok: ") or "were put in" in line for line in short)
    (folded,) = set(short) - {*whole}
    assert folded.startswith("4 checks passed (--verbose")
    entries = [line.split("  ")[0] for line in short if " N·mm " in line]
    assert entries == ["work of the tool", "cables"]


@pytest.mark.parametrize("stored", [0.0993, 0.1001, 0.5])
def test_what_a_film_stores_is_told_and_doubted_only_where_it_might_be_wrong(stored):
    took = PUT_IN | {"stored_growth_rel": stored, "cables_growth_rel": 0.98 - stored}
    thick = took | {"path_edge_mm": 0.6, "bending_length_mm": 1.46, "n_imperfection": 1}
    thick["damping_growth_rel"] = 0.02
    thin = thick | {"bending_length_mm": 0.2}
    flat = thick | {"n_imperfection": 0, "options": {"n_imperfection": 0}}

    def doubts(figures):
        return [line.text for line in verdict(figures) if line.kind == "doubt"]

    assert doubts(thick) == []
    note = line_with("In the steady window the work", thick).text
    assert f"cables {100 * (0.98 - stored):.1f} %, damping 2.0 %, stored" in note
    assert "The stored part is no work of cutting" in note
    assert "that of cables, film and friction" in line_with("all else took 2 %", thick).text
    if stored <= 0.1:
        assert doubts(thin) == doubts(flat) == []
        return
    (text,) = doubts(thin)
    assert "sides of 0.6 mm, and it folds only on sides shorter than 0.2 mm" in text
    assert text.endswith("Compare it with a run on a finer film near the tool.")
    (text,) = doubts(flat)
    assert "stays flat" in text
    assert text.endswith("Use imperfection = 1.")


@pytest.mark.parametrize(
    ("went", "said", "kind"),
    [
        ({"cables": 86.0, "damping": 9.0}, "cables took 90.5 % of the dissipated work (", "good"),
        ({"cables": 70.0, "damping": 25.0}, "cables took 73.7 % of the dissipated", "doubt"),
        # What film and friction take was asked for: the cables' share alone says nothing.
        (
            {"cables": 22.0, "material_dissipated": 60.0, "damping": 4.0},
            "cables took 25.6 % of the dissipated work, yielding or damage of the material 69.8 %, "
            "together 95.3 %",
            "good",
        ),
        ({"cables": 57.0, "friction": 35.0}, "friction 38 %, together 100 %", "good"),
        (
            {"cables": 40.0, "friction": 30.0, "contact": 20.0, "contact_lost": 20.0},
            "together 77.8 % (limit at least 85 %)",
            "doubt",
        ),
    ],
)
def test_what_was_dissipated_is_judged_with_all_that_takes_it(went, said, kind):
    rest = 100.0 - sum(energy for part, energy in went.items() if part != "contact_lost")
    figures = {f"{part}_Nmm": energy for part, energy in went.items()}
    figures |= PUT_IN | {"strain_Nmm": rest, "n_cable_broken": 1}
    assert line_with(said, figures).kind == kind
    text = line_with("100 N·mm were put in", figures).text
    shares = [float(share) for share in re.findall(r"(-?[\d.]+) %", text)]
    assert sum(shares) == pytest.approx(100.0, abs=0.05 * len(shares))
    assert f"cables {went['cables']:.1f} %" in text


DOUBTED = PUT_IN | {"imbalance_rel": 0.02, "kinetic_rel": 0.08, "overshoot_rel": 0.6}
DOUBTED |= {"damping_Nmm": 20.0, "cables_Nmm": 50.0, "n_cable_broken": 1, "n_cable_created": 0}
DOUBTED |= {"contact_Nmm": 6.0, "self_contact_Nmm": 3.0, "self_contact_lost_Nmm": 3.0}
DOUBTED |= {"stored_growth_rel": 0.5, "n_split": 9, "n_split_off_path": 3, "off_path_mm": 1.0}
DOUBTED |= {"deepest_penetration_mm": 0.2, "tool_half_thickness_mm": 0.2, "edge_length_mm": 0.4}
DOUBTED |= {"unfelt_film_edge_mm": 0.2, "film_half_thickness_mm": 0.04}
DOUBTED |= {"unfelt_penetration_mm": 0.4}


def test_no_remedy_names_what_a_run_has():
    # Named where it is left to do, not where it is on, not where it is unknown.
    has = {
        "film_edges": (True, False, "film_edges"),
        "path": ("free", "edges", 'path = "free"'),
        "check_every": (1, 10, "check_every"),
        "fixed_step": (True, False, "time.safety"),
        "opening_u_mm": (4.0, 0.5, "half of opening_u"),
        "n_imperfection": (1, 0, "imperfection = 1"),
    }
    on, left = (
        {name: option[k] for name, option in has.items()} | {"only_along_edges": False}
        for k in (0, 1)
    )

    def said(**options):
        return " ".join(line.text for line in verdict({**DOUBTED, **options}))

    for *_, remedy in has.values():
        assert remedy in said(options=left)
        assert remedy not in said(options=on)
        assert remedy not in said()
    assert "time.fixed" in said(options=on)
    # Of what exists along edges only, cracks through quads would be refused.
    assert 'path = "free"' not in said(options=left | {"only_along_edges": True})


def test_vibration_at_first_touch_is_not_held_against_a_run_that_was_stopped_there():
    shaken = {"cut_work_Nmm": 1.0, "kinetic_rel": 0.3, "damping_Nmm": 0.3, "n_cable_broken": 0}
    stopped = shaken | {"share_done": 0.1}
    for figures, n_doubt in ((shaken, 2), (stopped, 0), (stopped | {"n_cable_broken": 1}, 2)):
        assert sum(line.kind == "doubt" for line in verdict(figures)) == n_doubt
    assert line_with("are not judged", stopped)


def test_doubts_of_the_model_come_first_and_doubts_are_said_as_warnings(caplog):
    lines = verdict({"imbalance_rel": 0.001, "kinetic_rel": 0.5}, ["the film is thick"])
    assert [line.kind for line in lines] == ["doubt", "doubt", "good", "note"]
    assert str(lines[0]) == "distrust: Before the run: the film is thick"
    with caplog.at_level(logging.INFO, LOGGER.name):
        say([Line("doubt", "a"), Line("good", "b")])
    assert [(record.levelname, record.getMessage()) for record in caplog.records] == [
        ("WARNING", "distrust: a"),
        ("INFO", "ok: b"),
    ]

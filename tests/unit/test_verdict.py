"""The verdict: figures against their bands."""

import logging
import re

import pytest

from shellcut.results.answers import conclusion, ending
from shellcut.results.summary_figures import key_figures
from shellcut.results.verdict import LOGGER, Line, say, verdict


def test_figures_out_of_their_bands_are_doubted():
    summary = {
        "tool_work_Nmm": 100.0,
        "imbalance_rel": 0.02,
        "kinetic_rel": 0.08,
        "damping_Nmm": 12.0,
        "contact_Nmm": -6.0,
        "stored_growth_rel": 0.45,
        "cables_growth_rel": 0.4,
        "damping_growth_rel": 0.15,
        "n_imperfection": 0,
        "unfelt_penetration_mm": 0.4,
        "n_cable_created": 0,
        "edge_length_mm": 0.7,
    }
    lines = [line.text for line in verdict(summary) if line.kind == "doubt"]
    assert len(lines) == 8
    for said in (
        "the error is at most 2 %",
        "reaches 8 %",
        "springs open: 12 %",
        "gave the film 6 %",
        "stored 45 %",
        "all else took",
        "0.4 mm",
        "Nothing",
    ):
        assert sum(said in line for line in lines) == 1, said


def test_figures_at_their_limits_hold():
    summary = {"imbalance_rel": 0.01, "kinetic_rel": 0.05}
    summary |= {"unfelt_penetration_mm": 0.35, "edge_length_mm": 0.7}
    assert [line.kind for line in verdict(summary)] == ["good"] * 3 + ["note"]


def test_flanks_in_the_tool_unfelt_are_noted_and_what_to_do():
    def noted(depth, *, are_felt=False):
        options = {"film_edges": are_felt}
        figures = {"unfelt_film_edge_mm": depth, "film_half_thickness_mm": 0.037}
        lines = verdict({**figures, "options": options})
        return [line.text for line in lines if "Borders or flanks" in line.text]

    assert noted(0.037) == []
    (text,) = noted(0.098)
    assert "0.098 mm" in text
    assert "0.037 mm" in text
    assert "Use contact.film_edges = true or a finer film" in text
    (text,) = noted(0.098, are_felt=True)
    assert "Use a finer film" in text


def test_the_axial_force_of_flanks_that_cannot_fold_is_distrusted_alone():
    def of(edge, *, press=True, axial="axial_force_plateau_N"):
        figures = {"path_edge_mm": edge, "bending_length_mm": 0.216, axial: -0.27}
        return figures | {"torque_plateau_Nmm": 140.0, "options": {"film_edges": press}}

    for figures in (of(0.208), of(0.398, press=False), of(0.398, axial="force_plateau_N")):
        assert not any("axial force" in line.text for line in verdict(figures))
        assert not any("distrust" in label for label, _ in key_figures(figures))
        assert "doubtful" not in conclusion(figures, 0)
    for edge in (0.398, 0.82):
        (line,) = [one for one in verdict(of(edge)) if "axial force" in one.text]
        assert line.kind == "note"
        assert f"sides of {edge:.3g} mm (limit 0.216 mm)" in line.text
        assert "in the opening test on quick and M1" in line.text
        marked = [label for label, _ in key_figures(of(edge)) if "(distrust)" in label]
        assert marked == ["axial force, mean over  (distrust)"]
        assert conclusion(of(edge) | PEAK, 0).endswith("; one value is doubtful: the axial force.")


PEAK = {"torque_peak_Nmm": 166.6, "torque_peak_at_deg": 36.1}
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
        ({"crack_length_mm": 3.0}, 0, ""),
    ],
)
def test_one_sentence_says_what_a_run_found(figures, n_doubt, said):
    assert conclusion({"tool_work_Nmm": 9.0, **figures}, n_doubt) == said


def test_a_film_without_a_tool_is_pulled_apart():
    pulled = {"force_peak_N": 3.2, "force_peak_at_mm": 4.0, "crack_length_mm": 2.0}
    assert conclusion(pulled, 0).startswith("Pulling the film apart took a force of at most 3.2 N")


def test_the_end_of_a_run_folds_the_checks_that_passed():
    summary = {"imbalance_rel": 0.001, "kinetic_rel": 0.5, "tool_work_Nmm": 9.0, "cables_Nmm": 9.0}
    summary |= PEAK | {"n_cable_broken": 1, "n_step": 12}
    summary["verdict"] = [vars(line) for line in verdict(summary)]
    short, whole = (list(ending(summary, verbose=all_of_it)) for all_of_it in (False, True))
    assert short[0].startswith("Moving the tool took a torque of at most 166.6 N·mm")
    assert short[1].startswith("distrust: The motion is too fast")
    passed = [line for line in whole if line.startswith("ok: ")]
    assert len(passed) == 4
    assert "4 checks passed:" in whole
    assert any(line.startswith("4 checks passed (--verbose") for line in short)
    assert not any(line.startswith("ok: ") for line in short)
    assert not any("were put in" in line for line in short)
    assert set(short) - {*whole, *[line for line in short if "passed" in line]} == set()
    assert [line.split("  ")[0] for line in short if " N·mm " in line] == [
        "work of the tool",
        "cables",
    ]


CUT = {"tool_work_Nmm": 100.0, "cables_growth_rel": 0.78, "damping_growth_rel": 0.02}


@pytest.mark.parametrize("stored", [0.0993, 0.1001, 0.2, 0.5])
def test_what_a_film_stores_is_told_and_doubted_only_where_it_might_be_wrong(
    stored,
):
    took = CUT | {"stored_growth_rel": stored, "cables_growth_rel": 0.98 - stored}

    def doubts(**figures):
        return [one.text for one in verdict({**took, **figures}) if one.kind == "doubt"]

    thick = {"path_edge_mm": 0.6, "bending_length_mm": 1.46, "n_imperfection": 1}
    thin = thick | {"bending_length_mm": 0.2}
    flat = thick | {"n_imperfection": 0, "options": {"n_imperfection": 0}}
    assert doubts(**thick) == []
    lines = verdict({**took, **thick})
    (note,) = [one.text for one in lines if one.text.startswith("In the steady window the work")]
    assert f"cables {100 * (0.98 - stored):.1f} %, damping 2.0 %, stored" in note
    assert "The stored part is no work of cutting" in note
    (good,) = [one.text for one in lines if "all else took 2 %" in one.text]
    assert "that of cables, film and friction" in good
    if stored <= 0.1:
        assert doubts(**thin) == doubts(**flat) == []
        return
    (text,) = doubts(**thin)
    assert "sides of 0.6 mm, and it folds only on sides shorter than 0.2 mm" in text
    assert text.endswith("Compare it with a run on a finer film near the tool.")
    (text,) = doubts(**flat)
    assert "stays flat" in text
    assert text.endswith("Use imperfection = 1.")


def test_what_no_law_asked_for_in_the_steady_window_is_judged():
    def judged(**shares):
        lines = verdict({"tool_work_Nmm": 100.0, "stored_growth_rel": 0.0, **shares})
        return [(one.kind, one.text) for one in lines if "all else took" in one.text]

    ((kind, _),) = judged(cables_growth_rel=0.6, friction_growth_rel=0.31, damping_growth_rel=0.09)
    assert kind == "good"
    ((kind, text),) = judged(cables_growth_rel=0.7, damping_growth_rel=0.2, contact_growth_rel=0.1)
    assert kind == "doubt"
    assert "all else took 30 % of the tool's work (limit 10 %)" in text
    gave = verdict({"tool_work_Nmm": 1.0, "stored_growth_rel": -0.2, "cables_growth_rel": 1.2})
    assert any("The film released energy that it had stored" in one.text for one in gave)


def test_what_contact_gives_and_what_it_holds_are_judged_apart():
    def judged(**contact):
        lines = verdict({"tool_work_Nmm": 100.0, **contact})
        return [line.text.split()[0] for line in lines if line.kind == "doubt"]

    assert judged(contact_Nmm=4.9) == judged(contact_Nmm=-0.9) == []
    assert judged(contact_Nmm=5.1) == judged(contact_Nmm=-1.1) == ["Contact"]
    # A figure out of its limit does not look like it, and only what applies is named as the cause.
    energies = {"tool_work_Nmm": 100.0, "contact_Nmm": 5.03}
    (held,) = verdict({**energies, "contact_stored_Nmm": 5.0, "contact_lost_Nmm": 0.03})[:1]
    assert "in its springs, because film presses hard on the tool: it took 5.03 % of" in held.text
    (lost,) = verdict({**energies, "contact_stored_Nmm": 0.03, "contact_lost_Nmm": 5.0})[:1]
    assert "loses too much energy where film hits the tool" in lost.text
    assert "(limit 5 %)" in lost.text


def test_nodes_deep_in_the_tool_are_doubted():
    figures = {"deepest_penetration_mm": 0.04, "tool_half_thickness_mm": 0.2}
    line = verdict(figures)[0]
    assert line.kind == "good"
    assert "up to 0.04 mm deep in the tool (limit 0.05 mm" in line.text
    line = verdict(figures | {"tool_half_thickness_mm": 0.1})[0]
    assert line.kind == "doubt"
    assert "less than its thickness: nodes of the film are up to 0.04 mm deep" in line.text
    assert "(limit 0.025 mm, a quarter of 0.1 mm, the tool's volume over its surface)" in line.text


def test_contact_that_never_took_place_is_not_said_to_hold():
    figures = {"deepest_penetration_mm": 0.0, "unfelt_penetration_mm": 0.0, "edge_length_mm": 0.8}
    figures |= {"tool_half_thickness_mm": 0.2, "n_cable_created": 0, "initial_Nmm": 6e-7}
    lines = verdict(figures)
    assert [line.kind for line in lines] == ["doubt", "note"]
    assert "Nothing was cut: the tool never touched the film." in lines[0].text


def test_a_film_that_flies_off_is_not_said_to_be_cut_too_fast():
    figures = {"tool_work_Nmm": 1.0, "kinetic_rel": 0.856, "options": {"unheld": True}}
    (text,) = [line.text for line in verdict(figures) if line.kind == "doubt"]
    assert "The film, or a piece of it, is not supported, so that its inertia carries" in text
    assert "slower" not in text


def test_nothing_known_is_nothing_said():
    assert verdict({}) == []


@pytest.mark.parametrize(
    ("figures", "kind", "said"),
    [
        (
            {"n_split": 67, "n_split_off_path": 0, "off_path_mm": 0.01},
            "good",
            "67 of 67 splits are at most 0.01 mm away from it",
        ),
        (
            {"n_split": 1, "n_split_off_path": 0, "off_path_mm": 0.01},
            "good",
            "1 of 1 splits are at most",
        ),
        ({"n_split": 72, "n_split_off_path": 12, "off_path_mm": 1.74}, "doubt", "12 of 72 splits"),
        ({"n_split": 67, "n_tear": 9}, "note", "9 of 76 cuts are tears"),
        ({"n_tear": 2}, "note", "2 of 2 cuts"),
        ({"no_window": "no cable has broken"}, "note", "no mean is given: no cable has broken."),
        ({"overshoot_rel": 0.019}, "good", "meets them after 1.9 %"),
        ({"overshoot_rel": 0.6}, "doubt", "does not move where it points"),
        ({"n_cable_created": 0}, "doubt", "Nothing was cut"),
        ({"share_done": 0.34}, "note", "stopped at 34 % of its time"),
        ({"share_done": 0.34, "broke_off": 1}, "doubt", "failed within a step, at 34 %"),
    ],
)
def test_what_a_run_shows_of_its_cut(figures, kind, said):
    lines = [line for line in verdict(figures) if said in line.text]
    assert [line.kind for line in lines] == [kind]


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
    figures |= {"tool_work_Nmm": 100.0, "strain_Nmm": rest, "n_cable_broken": 1}
    lines = verdict(figures)
    assert [line.kind for line in lines if said in line.text] == [kind]
    (text,) = [line.text for line in lines if line.text.startswith("100 N·mm were put in")]
    shares = [float(share) for share in re.findall(r"(-?[\d.]+) %", text)]
    assert sum(shares) == pytest.approx(100.0, abs=0.05 * len(shares))
    assert f"cables {went['cables']:.1f} %" in text


def test_no_remedy_names_what_a_run_has():
    doubted = {"tool_work_Nmm": 100.0, "imbalance_rel": 0.02, "kinetic_rel": 0.08}
    doubted |= {"damping_Nmm": 20.0, "cables_Nmm": 50.0, "n_cable_broken": 1, "n_cable_created": 0}
    doubted |= {"contact_Nmm": 6.0, "self_contact_Nmm": 3.0}
    doubted |= {"self_contact_lost_Nmm": 3.0, "overshoot_rel": 0.6, "stored_growth_rel": 0.5}
    doubted |= {"n_split": 9, "n_split_off_path": 3, "off_path_mm": 1.0, "edge_length_mm": 0.4}
    doubted |= {"deepest_penetration_mm": 0.2, "tool_half_thickness_mm": 0.2}
    doubted |= {"unfelt_film_edge_mm": 0.2, "film_half_thickness_mm": 0.04}
    doubted["unfelt_penetration_mm"] = 0.4
    # named where it is left to do, not where it is on, not where it is unknown
    has = {
        "film_edges": (True, False, "film_edges"),
        "path": ("free", "edges", 'path = "free"'),
        "check_every": (1, 10, "check_every"),
        "fixed_step": (True, False, "time.safety"),
        "opening_u_mm": (4.0, 0.5, "half of opening_u"),
        "n_imperfection": (1, 0, "imperfection = 1"),
    }
    on = {name: option[0] for name, option in has.items()} | {"only_along_edges": False}
    left = {name: option[1] for name, option in has.items()} | {"only_along_edges": False}

    def said(**options):
        return " ".join(line.text for line in verdict({**doubted, **options}))

    for *_, remedy in has.values():
        assert remedy in said(options=left)
        assert remedy not in said(options=on)
        assert remedy not in said()
    assert "time.fixed" in said(options=on)
    # of what exists along edges only, cracks through quads would be refused
    assert 'path = "free"' not in said(options=left | {"only_along_edges": True})


def test_vibration_at_first_touch_is_not_held_against_a_run_that_was_stopped_there():
    shaken = {"tool_work_Nmm": 1.0, "kinetic_rel": 0.3, "damping_Nmm": 0.3, "n_cable_broken": 0}
    assert sum(line.kind == "doubt" for line in verdict(shaken)) == 2
    stopped = verdict(shaken | {"share_done": 0.1})
    assert not any(line.kind == "doubt" for line in stopped)
    assert any("are not judged" in line.text for line in stopped)
    broken = verdict(shaken | {"share_done": 0.1, "n_cable_broken": 1})
    assert sum(line.kind == "doubt" for line in broken) == 2


def test_doubts_of_the_model_come_first():
    lines = verdict({"imbalance_rel": 0.001, "kinetic_rel": 0.5}, ["the film is thick"])
    assert [line.kind for line in lines] == ["doubt", "doubt", "good", "note"]
    assert str(lines[0]) == "distrust: Before the run: the film is thick"


def test_doubts_are_said_as_warnings(caplog):
    with caplog.at_level(logging.INFO, LOGGER.name):
        say([Line("doubt", "a"), Line("good", "b")])
    assert [(record.levelname, record.getMessage()) for record in caplog.records] == [
        ("WARNING", "distrust: a"),
        ("INFO", "ok: b"),
    ]

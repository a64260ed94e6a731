"""The verdict: figures against their bands."""

import logging

import pytest

from shellcut.results.verdict import LOGGER, Line, say, verdict


def test_figures_out_of_their_bands_are_doubted():
    summary = {
        "tool_work_Nmm": 100.0,
        "imbalance_rel": 0.02,
        "kinetic_rel": 0.08,
        "damping_Nmm": 12.0,
        "contact_Nmm": -6.0,
        "unfelt_penetration_mm": 0.4,
        "n_cable_created": 0,
        "edge_length_mm": 0.7,
    }
    lines = [line.text for line in verdict(summary) if line.kind == "doubt"]
    assert len(lines) == 6
    for said in (
        "reaches 2 %",
        "reaches 8 %",
        "Damping dissipates 12 %",
        "the film 6 %",
        "0.4 mm",
        "Nothing",
    ):
        assert sum(said in line for line in lines) == 1, said


def test_figures_at_their_limits_hold():
    summary = {"imbalance_rel": 0.01, "kinetic_rel": 0.05}
    summary |= {"unfelt_penetration_mm": 0.35, "edge_length_mm": 0.7}
    assert [line.kind for line in verdict(summary)] == ["good"] * 3 + ["note"]


def test_flanks_in_the_tool_unfelt_are_noted_and_what_to_do():
    def noted(depth):
        lines = verdict({"unfelt_film_edge_mm": depth, "film_half_thickness_mm": 0.037})
        return [line.text for line in lines if "film_edges = True" in line.text]

    assert noted(0.037) == []
    (text,) = noted(0.098)
    assert "0.098 mm" in text
    assert "0.037 mm" in text


def test_what_contact_gives_and_what_it_holds_are_judged_apart():
    def judged(**contact):
        lines = verdict({"tool_work_Nmm": 100.0, **contact})
        return [line.kind for line in lines if line.kind != "note"]

    assert judged(contact_Nmm=4.9) == judged(contact_Nmm=-0.9) == ["good"]
    assert judged(contact_Nmm=5.1) == judged(contact_Nmm=-1.1) == ["doubt"]
    # Energy from nowhere counts like energy that the ledger misses, whichever its sign.
    assert judged(contact_absorbed_Nmm=-0.9) == judged(contact_absorbed_Nmm=0.9) == ["good"]
    assert judged(contact_absorbed_Nmm=-1.1) == judged(contact_absorbed_Nmm=1.1) == ["doubt"]


def test_nodes_deep_in_the_tool_are_doubted():
    figures = {"deepest_penetration_mm": 0.04, "tool_half_thickness_mm": 0.2}
    line = verdict(figures)[0]
    assert line.kind == "good"
    assert "by at most 0.04 mm (limit 0.05 mm" in line.text
    line = verdict(figures | {"tool_half_thickness_mm": 0.1})[0]
    assert line.kind == "doubt"
    assert "by 0.04 mm" in line.text
    assert "(0.025 mm)" in line.text


def test_nothing_known_is_nothing_said():
    assert verdict({}) == []


@pytest.mark.parametrize(
    ("figures", "kind", "said"),
    [
        ({"n_split": 67, "n_split_off_path": 0, "off_path_mm": 0.01}, "good", "at most 0.01 mm"),
        ({"n_split": 72, "n_split_off_path": 12, "off_path_mm": 1.74}, "doubt", "12 of 72 splits"),
        ({"overshoot_rel": 0.019}, "good", "misses 1.9 %"),
        ({"overshoot_rel": 0.6}, "doubt", "reverse the motion"),
        ({"cables_rel": 0.86}, "good", "took 86 % of the dissipated work"),
        ({"cables_rel": 0.737}, "doubt", "took 73.7 % of the dissipated work"),
        ({"n_cable_created": 0}, "doubt", "Nothing was cut"),
        ({"share_done": 0.34}, "note", "stopped at 34 % of its time"),
        ({"share_done": 0.34, "broke_off": 1}, "doubt", "broke off within a step, at 34 %"),
    ],
)
def test_what_a_run_shows_of_its_cut(figures, kind, said):
    lines = [line for line in verdict(figures) if said in line.text]
    assert [line.kind for line in lines] == [kind]


def test_vibration_at_first_touch_is_not_held_against_a_run_that_was_stopped_there():
    shaken = {"tool_work_Nmm": 1.0, "kinetic_rel": 0.3, "damping_Nmm": 0.3, "n_cable_broken": 0}
    assert sum(line.kind == "doubt" for line in verdict(shaken)) == 2
    stopped = verdict(shaken | {"share_done": 0.1})
    assert [line.kind for line in stopped] == ["note"] * 3
    assert "not judged yet" in stopped[1].text
    broken = verdict(shaken | {"share_done": 0.1, "n_cable_broken": 1})
    assert sum(line.kind == "doubt" for line in broken) == 2


def test_doubts_of_the_model_come_first():
    lines = verdict({"imbalance_rel": 0.001, "cables_rel": 0.5}, ["the film is thick"])
    assert [line.kind for line in lines] == ["doubt", "doubt", "good", "note"]
    assert str(lines[0]) == "distrust: Before the run: the film is thick"


def test_doubts_are_said_as_warnings(caplog):
    with caplog.at_level(logging.INFO, LOGGER.name):
        say([Line("doubt", "a"), Line("good", "b")])
    assert [(record.levelname, record.getMessage()) for record in caplog.records] == [
        ("WARNING", "distrust: a"),
        ("INFO", "holds: b"),
    ]

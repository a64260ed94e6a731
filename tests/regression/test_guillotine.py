"""Whole guillotine runs: the steady force is G h = 43.5 x 0.074 = 3.219 N."""

import numpy as np
import pytest

from page_tables import row, shown_as
from runs import broken_ratio, mean_force, run
from shellcut import guillotine

GH = 43.5 * 0.074
START = 10.0  # the plateau is reached after about 8 mm of cut


def check_cut(size, tmp_path):
    """Run and check; return the mean force by the tool's work and by the cables'."""
    case = guillotine(size)
    summary, history = run(case, tmp_path)
    # Whole node periods over at least 12 mm.
    length = np.floor((history["path"][-1] - START) / size) * size
    assert length >= 12.0
    force = mean_force(history, "tool_work", START, length)
    # Discretisation: 3.25-3.26 N on all meshes; the excess of 1 % is the damping's work.
    assert force == pytest.approx(GH, rel=0.02)
    # Cables alone: 3.220 N.
    of_cables = mean_force(history, "cohesive_work", START, length)
    assert of_cables == pytest.approx(GH, rel=5e-3)
    # Round-off of the time integration: below 0.1 % on 0.8 mm quads, 0.015 % on finer ones.
    assert summary["imbalance_rel"] < 1e-3
    plateau = history["path"] > START
    kinetic = history["kinetic_translation"] + history["kinetic_rotation"]
    assert (kinetic[plateau] / history["tool_work"][plateau]).max() < 0.02
    ratio = broken_ratio(case)
    assert ratio.size > 10
    assert abs(ratio - 1.0).max() < 0.01
    state = case.simulation.state
    assert all(abs(split.reference[1]) < 1e-9 for split in state.split_log)
    # Six cables along each side that has parted: their area is that of the crack, to round-off.
    area = state.cable.area[: state.cable.count].sum()
    assert area == pytest.approx(0.074 * state.crack_length, rel=1e-12)
    if size == 0.8:
        _, window, mean, work = row("docs/howto/read-results.md", "guillotine, quads of 0.8 mm")
        assert shown_as(window, summary["window_from_mm"], summary["window_to_mm"])
        assert shown_as(mean, summary["force_plateau_N"], summary["force_plateau_half_width_N"])
        half_width = summary["dWcoh_ds_half_width_N"] / GH
        assert shown_as(work, summary["dWcoh_ds_N"] / GH, half_width)
    overshoot = state.cable.overshoot[: state.cable.count].max()
    assert overshoot < 0.02
    return force, of_cables


@pytest.mark.slow
def test_three_meshes_agree(tmp_path):
    found = [check_cut(size, tmp_path / str(size)) for size in (0.8, 0.4, 0.25)]
    forces, of_cables = zip(*found, strict=True)
    assert max(forces) / min(forces) - 1.0 < 0.015
    page = "docs/verification.md"
    assert shown_as(row(page, "guillotine, mean force from the tool's work from 10 mm")[2], *forces)
    assert shown_as(row(page, "its cables, mean force")[2], *of_cables)


@pytest.mark.slow
def test_classical_cables_only_feel_the_blades_width(tmp_path):
    case = guillotine(0.4, directional=False)
    summary, history = run(case, tmp_path)
    # h ∫_0^w sigma dl with w = 0.6 mm, twice the blade's half thickness.
    expected = 0.074 * (0.5 * (18.0 + 12.0) * 0.5 + 12.0 * 0.1)
    force = mean_force(history, "tool_work", START, 16.0)
    assert force == pytest.approx(expected, rel=0.05)
    assert summary["n_cable_broken"] == 0
    assert summary["n_cable_jointed"] == 0

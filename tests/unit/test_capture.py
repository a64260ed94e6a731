"""Exposures: what is copied of a run for its frames."""

from dataclasses import fields

import numpy as np

from notched_strip import cutting
from shellcut.recording.frame_capture import Exposure


def differing(one, other):
    """Names of the fields of two frames that are not the same."""
    return [
        f.name
        for f in fields(one)
        if not np.array_equal(getattr(one, f.name), getattr(other, f.name))
    ]


def test_a_frame_is_that_of_its_exposure_however_far_the_run_has_gone_on():
    sim = cutting()
    while len(sim.state.split_log) < 2:
        sim.step()
    exposure = Exposure.of(sim, coordinate=0.0, coordinate_name="path", coordinate_unit="mm")
    at_once = exposure.frame()
    so_many = len(sim.state.split_log)
    for _ in range(20_000):
        if len(sim.state.split_log) > so_many + 2:
            break
        sim.step()
    assert len(sim.state.split_log) > so_many + 2
    assert differing(exposure.frame(), at_once) == []
    later = Exposure.of(sim, coordinate=0.0, coordinate_name="path", coordinate_unit="mm").frame()
    assert {"points", "director", "velocity", "quads", "quad_stress", "tool_translation"} <= set(
        differing(later, at_once)
    )

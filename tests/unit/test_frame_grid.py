"""A frame as a grid and back."""

import dataclasses

import numpy as np
import pytest

from opening_frame import opening_frame
from shellcut.results.frame_grid import (
    FLANK,
    KEPT_BITS,
    Counts,
    array_name,
    frame_of,
    grid_of,
    series_of,
)
from test_vtkhdf import assert_same


@pytest.mark.parametrize("angle", [0.0, 40.0])
def test_there_and_back(angle):
    frame = opening_frame(angle, n_side=8)
    grid = grid_of(frame)
    assert grid.counts == Counts.of(frame)
    back = frame_of(
        grid.counts,
        grid.points.astype(np.float32),
        grid.connectivity,
        grid.sizes,
        {**grid.point_arrays, **grid.cell_arrays},
        time=frame.time,
        coordinate=frame.coordinate,
        coordinate_name=frame.coordinate_name,
        coordinate_unit=frame.coordinate_unit,
        tool_rotation=frame.tool_rotation,
        tool_translation=frame.tool_translation,
        scalars=frame.scalars,
        scalar_units=frame.scalar_units,
    )
    assert_same(back, frame)
    assert grid.sizes.sum() == len(grid.connectivity)
    flanks = grid.connectivity[np.repeat(grid.cell_arrays["part"], grid.sizes) == FLANK]
    np.testing.assert_array_equal(flanks, frame.crack_edges.ravel())


def test_twelve_bits_are_kept_to_nearest():
    frame = opening_frame(0.0, n_side=2)
    stress = np.random.default_rng(1).normal(size=frame.quad_stress.shape) * 10.0
    grid = grid_of(dataclasses.replace(frame, quad_stress=stress))
    kept = grid.cell_arrays["membrane stress [MPa]"][: len(stress)]
    error = np.abs(kept / stress - 1.0).max()
    # Half of the last bit, and next to all of it where there are so many.
    assert 0.8 * 2.0 ** -(KEPT_BITS + 1) < error <= 2.0 ** -(KEPT_BITS + 1)
    assert not (kept.view(np.int32) & ((1 << (23 - KEPT_BITS)) - 1)).any()


def test_names_carry_the_units():
    assert array_name("speed", "mm/s") == "speed [mm per s]"
    frame = opening_frame(30.0, n_side=4)
    assert series_of(frame) == {
        "time [s]": frame.time,
        "angle [deg]": 30.0,
        "torque [N*mm]": frame.scalars["torque"],
        "crack length [mm]": frame.scalars["crack length"],
    }

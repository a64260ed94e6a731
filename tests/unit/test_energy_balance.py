"""Where the work went, from columns of a history made up by hand."""

import numpy as np
import pytest

from shellcut.energy_balance import energy_shares, largest_shares, trusted_rows, work_put_in

NAMES = (
    *("tool_work", "load_work", "support_work", "cohesive_work", "cohesive_start_work"),
    *("damping_stiffness", "damping_mass", "strain", "kinetic_translation", "kinetic_rotation"),
    *("contact_work", "imbalance"),
)
# Each column a power of two: every sum tells which it is made of.
HISTORY = {name: np.array([0.0, 2.0**k]) for k, name in enumerate(NAMES)}


def total(*names):
    return sum(HISTORY[name][1] for name in names)


def test_the_work_and_where_it_went():
    assert work_put_in(HISTORY)[1] == total("tool_work", "load_work", "support_work")
    shares = {name: share[1] for name, share in energy_shares(HISTORY).items()}
    assert shares == {
        "cables": total("cohesive_work", "cohesive_start_work"),
        "damping": total("damping_stiffness", "damping_mass"),
        "strain": total("strain"),
        "kinetic": total("kinetic_translation", "kinetic_rotation"),
        "contact": total("contact_work"),
    }


@pytest.mark.parametrize(
    ("unit", "end", "start"),
    [("deg", 95.0, 10.0), ("deg", 40.0, 10.0), ("mm", 30.0, 3.0)],
)
def test_rows_are_trusted_once_work_has_been_done(unit, end, start):
    x = np.array([0.0, np.nextafter(start, 0.0), start, end])
    assert trusted_rows(x, unit, end).tolist() == [False, False, True, True]


def test_the_largest_shares_are_of_trusted_rows_and_without_sign():
    columns = {
        "tool_work": [1e-9, 10.0, -20.0],
        "imbalance": [5.0, 0.1, -0.4],
        "kinetic_translation": [9.0, 0.5, 0.1],
        "kinetic_rotation": [9.0, 0.1, 0.1],
    }
    history = {name: np.array(column) for name, column in columns.items()}
    shares = largest_shares(history, np.array([False, True, True]))
    assert shares == pytest.approx({"imbalance_rel": 0.02, "kinetic_rel": 0.06}, rel=1e-15)
    assert largest_shares(history, np.zeros(3, bool)) == {}

"""Where the work went, from columns of a history made up by hand."""

import numpy as np
import pytest

from shellcut.results.energy_balance import energy_shares, largest_shares, trusted_rows, work_put_in

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
    dissipated = {"material_dissipated": np.array([0.0, 3.0])}
    assert shares_of(HISTORY | dissipated) == shares_of(HISTORY) | {"material": [0.0, 3.0]}
    rubbed = {"joint_friction": np.array([0.0, 2.0])}
    assert shares_of(HISTORY | rubbed) == shares_of(HISTORY) | {"joint friction": [0.0, 2.0]}


def shares_of(history):
    return {name: share.tolist() for name, share in energy_shares(history).items()}


@pytest.mark.parametrize("work", [200.0, 2e-6, -3.0])
def test_rows_are_trusted_once_work_has_been_done_in_runs_long_and_short(work):
    share = np.array([0.0, 0.0999, 0.1001, 1.0])
    assert trusted_rows({"tool_work": work * share}).tolist() == [False, False, True, True]


def test_no_row_is_trusted_without_work_and_none_of_a_blow_up():
    assert not trusted_rows({"tool_work": np.zeros(3)}).any()
    assert not trusted_rows({"tool_work": np.zeros(0)}).any()
    blown = np.array([0.0, 1.0, 2.0, np.inf, np.nan])
    assert trusted_rows({"tool_work": blown}).tolist() == [False, True, True, False, False]


@pytest.mark.parametrize("given", [-5.0, 5.0])
def test_absorbed_jumps_are_a_share_of_their_own_unless_negligible(given):
    cut = HISTORY | {"contact_absorbed": np.array([0.0, given])}
    shares = energy_shares(cut)
    assert shares["absorbed jumps"][1] == given
    assert shares["contact"][1] == total("contact_work") - given
    together = sum(share[1] for share in shares.values())
    assert together == sum(share[1] for share in energy_shares(HISTORY).values())
    little = HISTORY | {"contact_absorbed": np.array([0.0, 1e-3 * given])}
    assert "absorbed jumps" not in energy_shares(little)
    assert energy_shares(little)["contact"][1] == total("contact_work")


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

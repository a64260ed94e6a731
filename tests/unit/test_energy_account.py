"""Where the work went, of entries and columns made up by hand."""

import re
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from shellcut.results.energy_account import (
    PUT_IN,
    TAKEN_UP,
    account,
    dissipated,
    energy_figures,
    energy_put_in,
    energy_shares,
    relative_figures,
    trusted_rows,
)
from shellcut.simulation.ledger import Ledger

NAMES = [name for part in (*PUT_IN, *TAKEN_UP) for name in part.entries]
# Each entry a power of two: every sum tells which it is made of.
ENTRIES = {name: 2.0**k for k, name in enumerate(NAMES)}


def test_the_page_has_every_entry_in_its_part():
    page = (Path(__file__).parents[2] / "docs" / "theory" / "energy.md").read_text()
    account_of = page.partition("## Where the work went")[2]
    rows = [set(re.findall(r"`(\w+)`", row)) for row in re.findall(r"^\|.*\|$", account_of, re.M)]
    assert sorted(name for row in rows for name in row) == sorted(NAMES)
    for part in (*PUT_IN, *TAKEN_UP):
        assert any(row >= set(part.entries) for row in rows), part.name
    told = set(re.findall(r"`(\w+)`", page))
    assert {field.name for field in fields(Ledger)} - told == set()


def sum_of(*names):
    return sum(ENTRIES[name] for name in names)


def test_every_entry_of_the_balance_is_in_one_part():
    beside = ("_stored", "_dissipated")
    entries = {field.name for field in fields(Ledger) if not field.name.endswith(beside)}
    assert sorted(NAMES) == sorted(entries | {"material_dissipated"})
    ledger = Ledger(**ENTRIES)
    assert ledger.put_in == sum_of("tool_work", "support_work", "load_work", "initial")
    assert ledger.put_in + ledger.taken_up == 2.0 ** len(NAMES) - 1.0
    assert ledger.imbalance == ledger.put_in - ledger.taken_up
    assert ledger.kinetic == sum_of("kinetic_translation", "kinetic_rotation")
    assert ledger.damping == sum_of("damping_stiffness", "damping_mass", "damping_kinetic")
    history = {name: np.array([0.0, energy]) for name, energy in ENTRIES.items()}
    shares = {words: share[1] for words, share in energy_shares(history).items()}
    assert shares["cables"] == sum_of("cohesive_work", "cohesive_start_work")
    assert shares["kinetic energy"] == ledger.kinetic
    # Histories of older versions lack entries; what is zero throughout is not shown.
    history["friction_work"] *= 0.0
    del history["joint_friction"], history["self_contact_work"]
    left = {"friction", "friction of the cables on the cutting edge"}
    left |= {"contact of the film with itself"}
    assert energy_shares(history).keys() == shares.keys() - left


def test_the_figures_are_the_whole_account_or_none():
    entries = {"tool_work": 10.0, "cohesive_work": 4.0, "material_dissipated": 3.0, "strain": 1.0}
    entries |= {"contact_work": 0.5, "contact_stored": 0.2}
    figures = energy_figures(entries)
    assert figures.keys() == {
        *("tool_work_Nmm", "cables_Nmm", "material_dissipated_Nmm", "strain_Nmm", "contact_Nmm"),
        *("imbalance_Nmm", "contact_stored_Nmm", "contact_lost_Nmm"),
    }
    assert figures["contact_lost_Nmm"] == pytest.approx(0.3)
    put_in, became = account(figures)
    assert [line.share for line in put_in] == [1.0]
    shares = {line.words: line.share for line in became}
    assert shares["imbalance"] == pytest.approx(0.15)
    assert sum(shares.values()) == pytest.approx(1.0)
    # Of what was dissipated: what is stored is not in it, what contact gave from nowhere is lost.
    asked, together = dissipated(figures)
    assert {line.words: line.share for line in asked} == pytest.approx(
        {"cables": 4.0 / 7.3, "yielding or damage of the material": 3.0 / 7.3}
    )
    assert together == pytest.approx(7.0 / 7.3)
    assert energy_figures(entries | {"strain": np.nan}) == {}
    assert account({}) == ([], [])
    assert dissipated({}) == ([], 0.0)


@pytest.mark.parametrize(
    ("work", "trusted"),
    [
        *((work * np.array([0.0, 0.0999, 0.1001, 1.0]), [2, 3]) for work in (200.0, 2e-6, -3.0)),
        ([0.0, 0.0, 0.0], []),
        ([], []),
        ([0.0, 1.0, 2.0, np.inf, np.nan], [1, 2]),
    ],
)
def test_rows_are_trusted_once_a_tenth_of_the_work_has_been_done(work, trusted):
    rows = trusted_rows(energy_put_in({"time": np.arange(len(work)), "tool_work": np.array(work)}))
    assert np.flatnonzero(rows).tolist() == trusted


def test_the_largest_shares_are_of_trusted_rows_and_without_sign():
    columns = {
        "tool_work": [1e-9, 10.0, -20.0],
        "imbalance": [5.0, 0.1, -0.4],
        "kinetic_translation": [9.0, 0.5, 0.1],
        "kinetic_rotation": [9.0, 0.1, 0.1],
    }
    history = {name: np.array(column) for name, column in columns.items()}
    assert relative_figures(history) == pytest.approx(
        {"imbalance_rel": 0.02, "kinetic_rel": 0.06, "cut_work_Nmm": 20.0}, rel=1e-15
    )
    assert relative_figures(history | {"tool_work": np.zeros(3)}) == {}


def test_relative_is_to_all_that_was_put_in_or_taken_out():
    assert Ledger(tool_work=-4.0, load_work=10.0, initial=2.0).relative(1.0) == 0.0625
    assert Ledger(tool_work=50.0, support_work=-42.0).relative(1.0) == 0.125
    assert Ledger().relative(1.0) == 0.0
    assert Ledger(tool_work=2.0).relative(-1.0) == pytest.approx(-0.5)

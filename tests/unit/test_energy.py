"""The ledger's sums."""

from dataclasses import fields

import pytest

from shellcut.simulation.ledger import Ledger


def numbered():
    return Ledger(**{f.name: 2.0**k for k, f in enumerate(fields(Ledger))})


def test_sums_take_each_entry_once():
    book = numbered()
    assert book.kinetic == book.kinetic_translation + book.kinetic_rotation
    assert book.damping == book.damping_stiffness + book.damping_mass
    # Powers of two: the sum tells which entries are in it.
    names = ("tool_work", "load_work", "support_work", "initial")
    assert book.put_in == sum(getattr(book, n) for n in names)
    names = (
        *("kinetic_translation", "kinetic_rotation", "strain", "material_dissipated"),
        *("cohesive_work", "cohesive_start_work", "contact_work"),
        *("damping_stiffness", "damping_mass"),
    )
    assert book.taken_up == sum(getattr(book, n) for n in names)
    assert book.imbalance == book.put_in - book.taken_up


def test_relative_is_to_the_tool_or_else_to_all():
    assert Ledger(tool_work=-4.0, load_work=10.0).relative(1.0) == 0.25
    assert Ledger(load_work=8.0).relative(1.0) == 0.125
    assert Ledger().relative(1.0) == 0.0
    assert Ledger(tool_work=2.0).relative(-1.0) == pytest.approx(-0.5)

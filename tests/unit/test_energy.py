"""The ledger's sums."""

from dataclasses import fields

import pytest

from shellcut.simulation.ledger import Ledger


def numbered():
    return Ledger(**{f.name: 2.0**k for k, f in enumerate(fields(Ledger))})


def test_sums_take_each_entry_once():
    ledger = numbered()
    assert ledger.kinetic == ledger.kinetic_translation + ledger.kinetic_rotation
    dampings = ledger.damping_stiffness, ledger.damping_mass, ledger.damping_kinetic
    assert ledger.damping == sum(dampings)
    # Powers of two: the sum tells which entries are in it.
    names = ("tool_work", "load_work", "support_work", "initial")
    assert ledger.put_in == sum(getattr(ledger, n) for n in names)
    names = (
        *("kinetic_translation", "kinetic_rotation", "strain", "material_dissipated"),
        *("cohesive_work", "cohesive_start_work", "joint_friction", "contact_work"),
        *("self_contact_work", "friction_work"),
        *("damping_stiffness", "damping_mass", "damping_kinetic"),
    )
    assert ledger.taken_up == sum(getattr(ledger, n) for n in names)
    assert ledger.imbalance == ledger.put_in - ledger.taken_up


def test_relative_is_to_the_tool_or_else_to_all():
    assert Ledger(tool_work=-4.0, load_work=10.0).relative(1.0) == 0.25
    assert Ledger(load_work=8.0).relative(1.0) == 0.125
    assert Ledger().relative(1.0) == 0.0
    assert Ledger(tool_work=2.0).relative(-1.0) == pytest.approx(-0.5)

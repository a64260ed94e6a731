"""The ledger's sums."""

from dataclasses import fields

import numpy as np
import pytest

from shellcut.simulation.ledger import Ledger, tool_work


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


def test_work_of_the_tool_is_the_trapezoid_of_wrench_and_twist():
    rng = np.random.default_rng(2)
    contact, cables = rng.normal(size=(2, 3, 4, 6))  # three steps of four teeth
    spin, velocity = rng.normal(size=(2, 3, 3))
    last_contact, last = np.zeros(6), np.zeros(6)
    done = [
        tool_work(
            contact_wrench=contact[k],
            cable_wrench=cables[k],
            spin=spin[k],
            velocity=velocity[k],
            dt=0.1 * (k + 1),
            last_contact=last_contact,
            last=last,
        )
        for k in range(3)
    ]
    for k in range(3):
        moved = 0.1 * (k + 1) * np.concatenate([velocity[k], spin[k]])
        for part, wrench in enumerate((contact, contact + cables)):
            before = wrench[k - 1].sum(axis=0) if k else np.zeros(6)
            mean = 0.5 * (before + wrench[k].sum(axis=0))
            assert done[k][part] == pytest.approx(mean @ moved, rel=1e-13)
    np.testing.assert_allclose(last, (contact + cables)[2].sum(axis=0), rtol=1e-14)

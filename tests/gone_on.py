"""A run that goes on from a checkpoint, compared with the uninterrupted one."""

import numpy as np

from shellcut.recording.checkpoint import load_checkpoint, save_checkpoint


def check_goes_on(build, reached, path, *, n_step=200):
    """Save a run that has ``reached`` something; go on with it and with another from the file."""
    sim, other = build(), build()
    while not reached(sim):
        sim.step()
        assert sim.state.time < 1e-4
    save_checkpoint(sim, path)
    load_checkpoint(other, path)
    for one in (sim, other):
        for _ in range(n_step):
            one.step()
    for table in ("node", "cable"):
        mine, theirs = (getattr(one.state, table).saved() for one in (sim, other))
        for name in mine:
            np.testing.assert_array_equal(mine[name], theirs[name], err_msg=name)
    assert vars(sim.ledger) == vars(other.ledger)
    assert abs(sim.ledger.imbalance) < 5e-3 * sim.ledger.put_in

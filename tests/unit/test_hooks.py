"""When hooks are called, and what a sampler keeps."""

from types import SimpleNamespace

import pytest

from shellcut.simulation.hooks import Sampler, Trigger


def test_a_trigger_is_due_once_past_every_multiple():
    trigger = Trigger(0.1)
    times = [0.0, 0.04, 0.09, 0.11, 0.19, 0.21, 0.29]
    assert [trigger(t) for t in times] == [True, False, False, True, False, True, False]
    trigger = Trigger(0.1)
    assert trigger(0.35)
    assert not trigger(0.35)
    assert not trigger(0.399)
    assert trigger(0.401)


@pytest.mark.parametrize("interval", [0.0, -1.0, float("nan")])
def test_interval_must_be_positive(interval):
    with pytest.raises(ValueError, match="interval must be a positive time in s"):
        Trigger(interval)


def test_sampler_keeps_what_it_reads():
    sampler = Sampler(0.5, lambda sim: sim.state.time * 2)
    for time in (0.0, 0.3, 0.6, 0.7, 1.2):
        sim = SimpleNamespace(state=SimpleNamespace(time=time))
        if sampler.due(sim):
            sampler(sim)
    sampler.close()
    assert sampler.values == [0.0, 1.2, 2.4]

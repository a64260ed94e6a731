"""The first signal is a request, the second one goes through, and the former handlers are back."""

import signal
import subprocess
import sys
import threading
import time

import pytest

from shellcut.signals import Interruption

SIGNALS = [signal.SIGINT, signal.SIGTERM]


@pytest.fixture
def received():
    """What the program's own handlers get; the ones from before are put back."""
    got = []
    former = {one: signal.signal(one, lambda number, _: got.append(number)) for one in SIGNALS}
    yield got
    for one, handler in former.items():
        signal.signal(one, handler)


def handlers():
    return [signal.getsignal(one) for one in SIGNALS]


@pytest.mark.parametrize("number", SIGNALS)
def test_the_first_signal_is_held_back_and_delivered_after(received, number):
    before = handlers()
    with Interruption() as interruption:
        assert not interruption.requested
        signal.raise_signal(number)
        assert interruption.requested
        assert received == []
    assert handlers() == before
    interruption.deliver()
    assert received == [number]
    assert not interruption.requested
    interruption.deliver()
    assert received == [number]


@pytest.mark.parametrize("first", SIGNALS)
@pytest.mark.parametrize("second", SIGNALS)
def test_the_second_signal_goes_through(received, first, second):
    with Interruption() as interruption:
        signal.raise_signal(first)
        signal.raise_signal(second)
        assert received == [second]
        assert interruption.requested


def test_which_signal_ends_the_process():
    with Interruption() as interruption:
        assert not interruption.ends_process
        signal.raise_signal(signal.SIGTERM)
        assert interruption.ends_process  # unless the program handles it
    with Interruption() as interruption:
        signal.raise_signal(signal.SIGINT)
        assert not interruption.ends_process  # it becomes KeyboardInterrupt


def test_without_a_signal_nothing_is_delivered_and_handlers_are_back(received):
    before = handlers()
    with Interruption() as interruption:
        assert handlers() != before
    interruption.deliver()
    assert received == []
    assert handlers() == before
    with pytest.raises(ZeroDivisionError), Interruption():
        1 / 0  # noqa: B018
    assert handlers() == before
    # As of a program started by nohup, or in the background of a script.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with Interruption() as interruption:
        signal.raise_signal(signal.SIGINT)
        assert not interruption.requested
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN


def test_ctrl_c_becomes_a_keyboard_interrupt():
    former = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with Interruption() as interruption:
            signal.raise_signal(signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            interruption.deliver()
        with Interruption():
            signal.raise_signal(signal.SIGINT)
            with pytest.raises(KeyboardInterrupt):
                signal.raise_signal(signal.SIGINT)
    finally:
        signal.signal(signal.SIGINT, former)


def test_in_another_thread_nothing_is_held_back(received):
    before, seen = handlers(), []

    def work():
        with Interruption() as interruption:
            seen.append(handlers())
            interruption.deliver()

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert seen == [before]
    assert received == []


_WAITING = """
import signal
import time
from shellcut.signals import Interruption
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell may have it ignored
with Interruption() as interruption:
    print("running", flush=True)
    while not interruption.requested:
        time.sleep(0.01)
    print("saved", flush=True)
interruption.deliver()
print("went on", flush=True)
"""


@pytest.mark.parametrize("number", SIGNALS)
def test_a_process_ends_as_by_the_signal(number):
    process = subprocess.Popen(
        [sys.executable, "-c", _WAITING], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout.readline() == "running\n"
    time.sleep(0.05)
    process.send_signal(number)
    out, err = process.communicate(timeout=30)
    assert out == "saved\n"
    assert process.returncode == -number
    assert ("KeyboardInterrupt" in err) == (number == signal.SIGINT)

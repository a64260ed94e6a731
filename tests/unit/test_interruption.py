"""The first signal is a request, the second one goes through, and the former handlers are back.

No signal is lost, or meets code that cannot bear it: imports, kernels that load or compile.
"""

import ctypes
import os
import random
import signal
import subprocess
import sys
import threading
import time
from contextlib import contextmanager

import numba
import pytest
from numba.core import event

import shellcut
from shellcut.command_line import keys
from shellcut.command_line.main import main
from shellcut.numerics.jit import inline, kernel
from shellcut.signals import Interruption, RaisedAgain, SignalsDeferred, is_command

SIGNALS = [signal.SIGINT, signal.SIGTERM]


@pytest.fixture
def received():
    """What the program's own handlers get; the ones from before are put back."""
    got = []
    former = {one: signal.signal(one, lambda number, _: got.append(number)) for one in SIGNALS}
    yield got
    for one, handler in former.items():
        signal.signal(one, handler)


@contextmanager
def ctrl_c():
    """Let SIGINT raise KeyboardInterrupt, as in a program."""
    former = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, former)


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
    for deferred in (Interruption, SignalsDeferred):
        with pytest.raises(ZeroDivisionError), deferred():
            1 / 0  # noqa: B018
        assert handlers() == before


def test_what_is_ignored_or_ends_the_process_or_is_of_another_thread_is_left_as_it_is(received):
    before, seen = handlers(), []

    def work():
        with Interruption() as interruption, SignalsDeferred():
            seen.append(handlers())
            interruption.deliver()

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert (seen, received) == ([before], [])
    for handler in (signal.SIG_IGN, signal.SIG_DFL):
        signal.signal(signal.SIGTERM, handler)
        with SignalsDeferred():
            assert signal.getsignal(signal.SIGTERM) is handler
    # As of a program started by nohup, or in the background of a script.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with Interruption() as interruption:
        signal.raise_signal(signal.SIGINT)
        assert not interruption.requested
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN


def test_ctrl_c_becomes_a_keyboard_interrupt():
    with ctrl_c():
        with Interruption() as interruption:
            signal.raise_signal(signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            interruption.deliver()
        with Interruption():
            signal.raise_signal(signal.SIGINT)
            with pytest.raises(KeyboardInterrupt):
                signal.raise_signal(signal.SIGINT)


# ---------------------------------------------------------------- held back


@pytest.mark.parametrize("number", SIGNALS)
def test_signals_are_held_back_and_raised_once_after_the_block(received, number):
    before = handlers()
    with SignalsDeferred():
        with SignalsDeferred():
            signal.raise_signal(number)
            signal.raise_signal(number)
        assert received == []
    assert received == [number]
    assert handlers() == before


class _Signals(event.Listener):
    """Sends a signal when a compilation begins."""

    def __init__(self):
        self.n = 0

    def on_start(self, event):
        self.n += 1
        signal.raise_signal(signal.SIGINT)

    def on_end(self, event):
        pass


@pytest.mark.parametrize("kind", [kernel, inline])
def test_ctrl_c_while_a_kernel_is_compiled_comes_after_that(kind, monkeypatch, tmp_path):
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))  # with nothing compiled

    @kind
    def halved(x):
        return 0.5 * x

    sender = _Signals()
    with (
        ctrl_c(),
        event.install_listener("numba:compile", sender),
        pytest.raises(KeyboardInterrupt),
    ):
        halved(3.0)
    assert sender.n > 0
    assert len(halved.overloads) == 1  # whole
    assert halved(3.0) == 1.5


def test_ctrl_c_while_a_stored_kernel_is_loaded_comes_after_that(monkeypatch):
    @kernel
    def doubled(x):
        return 2.0 * x

    load, loaded = doubled._cache.load_overload, []

    def interrupted(*arguments):
        signal.raise_signal(signal.SIGINT)
        loaded.append(True)
        return load(*arguments)

    monkeypatch.setattr(doubled._cache, "load_overload", interrupted)
    with ctrl_c(), pytest.raises(KeyboardInterrupt):
        doubled(1.0)
    assert loaded
    assert doubled(1.0) == 2.0


# ---------------------------------------------------------------- raised again


class _Going:
    def __del__(self):
        signal.raise_signal(signal.SIGINT)


def _from_c():
    ctypes.CFUNCTYPE(None)(lambda: signal.raise_signal(signal.SIGINT))()


@pytest.mark.parametrize("drop", [_Going, _from_c])
def test_an_interrupt_that_python_drops_is_raised_again(drop):
    began = time.perf_counter()
    with ctrl_c(), pytest.raises(KeyboardInterrupt), RaisedAgain():  # noqa: PT012
        drop()
        time.sleep(30.0)
    assert time.perf_counter() - began < 20.0


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_other_errors_that_python_drops_are_reported_as_ever(monkeypatch):
    seen = []
    monkeypatch.setattr(sys, "unraisablehook", lambda dropped: seen.append(dropped.exc_type))
    former = sys.unraisablehook
    with RaisedAgain():
        ctypes.CFUNCTYPE(None)(lambda: 1 / 0)()
    assert seen == [ZeroDivisionError]
    assert sys.unraisablehook is former


# ---------------------------------------------------------------- the command


@pytest.mark.parametrize(
    ("argv", "of_python", "answer"),
    [
        (["-m"], ["python", "-m", "shellcut", "run"], True),
        (["-m"], ["python", "-X", "utf8", "-mshellcut"], True),
        (["-m"], ["python", "-m", "pytest"], False),
        (["/site/shellcut/__main__.py", "run"], ["python", "-m", "shellcut", "run"], True),
        (["/bin/shellcut", "run"], ["python", "/bin/shellcut", "run"], True),
        (["shellcut.exe"], ["python", "shellcut.exe"], True),
        (["my.py", "-m", "shellcut"], ["python", "my.py", "-m", "shellcut"], False),
        (["-c"], ["python", "-c", "import shellcut"], False),
        ([""], ["python"], False),
        ([], ["python"], False),
    ],
)
def test_which_process_is_the_command(monkeypatch, argv, of_python, answer):
    monkeypatch.setattr(sys, "argv", argv)
    monkeypatch.setattr(sys, "orig_argv", of_python)
    assert is_command() is answer


@pytest.mark.parametrize("error", [OSError, RuntimeError, ValueError])
def test_an_error_while_an_interrupt_is_answered_is_the_interrupt(monkeypatch, capsys, error):
    def interrupted(_):
        try:
            raise KeyboardInterrupt
        finally:
            raise error("left half open")

    monkeypatch.setattr(keys, "run", interrupted)
    assert main(["keys", "young"]) == 130
    assert capsys.readouterr().err == "interrupted\n"


# Python imports this file at its start. It sends Ctrl-C when a certain module is to be imported.
_AT_IMPORT = """
import os, signal, sys
class Finder:
    @staticmethod
    def find_spec(name, path=None, target=None):
        if name == os.environ["OF_A_TEST"]:
            os.kill(os.getpid(), signal.SIGINT)
signal.signal(signal.SIGINT, signal.default_int_handler)
sys.meta_path.insert(0, Finder)
"""
COMMAND = [sys.executable, "-m", "shellcut"]


@pytest.mark.skipif(os.name == "nt", reason="os.kill ends a process there")
@pytest.mark.parametrize("module", ["llvmlite.binding", "shellcut.study", "shellcut.command_line"])
def test_ctrl_c_during_the_import_ends_the_command_in_its_own_words(tmp_path, module):
    (tmp_path / "sitecustomize.py").write_text(_AT_IMPORT)
    site = os.pathsep.join([str(tmp_path), os.path.dirname(os.path.dirname(shellcut.__file__))])
    given = os.environ | {"PYTHONPATH": site, "OF_A_TEST": module}
    done = subprocess.run([*COMMAND, "keys", "young"], env=given, capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "interrupted\n")
    if module == "llvmlite.binding":  # that of a script is raised, as any
        script = [sys.executable, "-c", "import shellcut"]
        done = subprocess.run(script, env=given, capture_output=True, text=True)
        assert done.stderr.endswith("KeyboardInterrupt\n")


# Python imports this file at its start.
_SAYS_WHEN_IT_BEGINS = """
import os, signal
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell may have it ignored
open(os.environ["OF_A_TEST"], "w").close()
"""


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="there are no groups of processes there")
@pytest.mark.parametrize("command", [["run", "guillotine"], ["sweep", "guillotine"]])
def test_a_hundred_interrupts_at_random_moments_end_in_the_same_way(tmp_path, command):
    more = ["--set", "material.thickness=0.05,0.06", "--jobs", "2"] if command[0] == "sweep" else []
    began = time.perf_counter()
    subprocess.run([*COMMAND, "keys", "young"], check=True, capture_output=True)
    start = time.perf_counter() - began
    (tmp_path / "sitecustomize.py").write_text(_SAYS_WHEN_IT_BEGINS)
    site = os.pathsep.join([str(tmp_path), os.path.dirname(os.path.dirname(shellcut.__file__))])
    chance, ends = random.Random(1), []
    for k in range(100 if not more else 20):
        out, begun = str(tmp_path / f"out{k}"), tmp_path / f"begun{k}"
        process = subprocess.Popen(
            [*COMMAND, *command, *more, "-o", out],
            env=os.environ | {"PYTHONPATH": site, "OF_A_TEST": str(begun)},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )
        while process.poll() is None and not begun.exists():  # Python itself starts
            time.sleep(1e-3)
        time.sleep(start * chance.uniform(0.05, 2.5))
        os.killpg(process.pid, signal.SIGINT)
        _, said = process.communicate(timeout=120)
        wrong = process.returncode != 130 or "Traceback" in said or "ignored" in said
        ends += [(k, process.returncode, said)] if wrong else []
    assert ends == []

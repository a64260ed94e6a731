"""Commands that are killed, ended, interrupted or stopped, at random moments and within writes."""

import functools
import os
import random
import signal
import time
from itertools import count

from shellcut.files.run_folder import CHECKPOINT

from . import tiny
from .trial import Trial, at_each_write, begin, command, often_saved

SHARE = 10
PROMISE = "the results are those of the uninterrupted command, to the last bit"
SIGNALS = {name: getattr(signal, f"SIG{name}") for name in ("KILL", "TERM", "INT", "STOP")}
CODES = {"KILL": -signal.SIGKILL, "TERM": -signal.SIGTERM, "INT": 130, "STOP": 0}
# Most trials are of runs, which are short.
KINDS = ["run", "resume", "sweep", "run", "resume", "fit", "run", "resume", "optimise", "run"]
KINDS += ["resume", "converge"]
ROWS = {f"{kind}, killed": (PROMISE, "`tests/same_run.py`") for kind in dict.fromkeys(KINDS)}


def trials():
    return map(trial, count())


def trial(number):
    """Return a trial: a command, a signal and a moment."""
    chance = random.Random(f"kills {number}")
    kind = KINDS[number % len(KINDS)]
    models = [*tiny.SHORT]
    name = models[number // len(KINDS) % len(models)] if kind in ("run", "resume") else "guillotine"
    sign, at = chance.choice([*SIGNALS]), chance.random()
    within = sign != "STOP" and chance.random() < 0.4
    what = f"{kind} of {name}, {sign} {'within a write' if within else ''} at {at:.3f} of it"
    return Trial(f"{kind}, killed", what, functools.partial(_do, kind, name, sign, within, at))


def signal_within_write(n, number):
    """Let the n-th write of this process meet a signal; one that is killed has written half."""
    left = [n]

    def meets(file, data):
        left[0] -= 1
        if left[0] == 0:
            if number == signal.SIGKILL:
                file.write(data[: len(data) // 2])
            os.kill(os.getpid(), number)

    at_each_write(meets)


@functools.cache
def size_of(kind, name):
    """Return the time of a command [s], and its number of writes."""
    folder, began = tiny.folder() / f"size {kind} {name}", time.monotonic()
    counted = folder / "writes"

    def before():
        often_saved()
        at_each_write(lambda *_: counted.open("a").write("."))

    folder.mkdir()
    command([*tiny.words(kind, name), "-o", str(folder / "out")], folder, before).expect(0)
    return time.monotonic() - began, counted.stat().st_size


def _do(kind, name, sign, within, at, folder):
    of, out = "run" if kind == "resume" else kind, folder / "out"
    tiny.whole(of, name)
    seconds, writes = size_of(of, name)
    argv = [*tiny.words(of, name), "-o", str(out)]
    if kind == "resume":  # of a run that was killed before
        child = begin(argv, folder, often_saved)
        time.sleep(0.5 * at * seconds)
        child.send(signal.SIGKILL)
        child.wait()
        argv = next_command(out, of, name)

    def before():
        often_saved()
        if within:
            signal_within_write(1 + int(at * writes), SIGNALS[sign])

    child = begin(argv, folder, before)
    if not within:
        time.sleep(at * seconds)
        child.send(SIGNALS[sign])
        if sign == "STOP":
            time.sleep(0.1)
            child.send(signal.SIGCONT)
    child.wait().expect(0, CODES[sign])
    continued(out, of, name, folder)


def next_command(out, kind, name):
    """Return the command by which a user continues; a run without a checkpoint begins again."""
    argv = [*tiny.words(kind, name), "-o", str(out)]
    if kind != "run":
        return argv
    return ["resume", str(out)] if (out / CHECKPOINT).exists() else [*argv, "--overwrite"]


def continued(out, kind, name, folder):
    """Continue a command, and compare with the undisturbed one."""
    command(next_command(out, kind, name), folder).expect(0)
    tiny.assert_same(out, kind, name)

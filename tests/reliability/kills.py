"""Commands that are killed, ended, interrupted or stopped, at random moments and within writes."""

import functools
import os
import random
import signal
import sys
import time

from shellcut.files import whole_file
from shellcut.files.run_folder import CHECKPOINT
from shellcut.models.case import Case

from . import tiny
from .trial import Trial, begin, command

SHARE = 8
COUNT = None
PROMISE = "the results are those of the uninterrupted command, to the last bit"
TEST = "`kills.py`; `tests/same_run.py`"
SIGNALS = {
    "KILL": signal.SIGKILL,
    "TERM": signal.SIGTERM,
    "INT": signal.SIGINT,
    "STOP": signal.SIGSTOP,
}
# Most trials are of runs, which are short.
KINDS = ["run", "resume", "sweep", "run", "resume", "fit", "run", "resume", "optimise", "run"]
KINDS += ["resume", "converge"]
ROWS = dict.fromkeys(dict.fromkeys(f"{kind}, killed" for kind in KINDS), (PROMISE, TEST))
EVERY = 0.02  # s between two checkpoints
NO_CHECKPOINT = "it has no checkpoint yet: begun anew"


def trial(number):
    """Return a trial: a command, a signal and a moment."""
    chance = random.Random(f"kills {number}")
    kind = KINDS[number % len(KINDS)]
    models = [*tiny.SHORT]
    name = models[number // len(KINDS) % len(models)] if kind in ("run", "resume") else "guillotine"
    sign = chance.choice([*SIGNALS])
    within = chance.random() < 0.4 and sign != "STOP"
    at = chance.random()
    moment = f"write at {at:.3f} of all, after half of it" if within else f"{at:.3f} of its time"
    what = f"{kind} of {name}, {sign} at {moment}"
    of = functools.partial(_do, kind=kind, name=name, sign=sign, within=within, at=at)
    return Trial(f"{kind}, killed", what, of)


def often_saved():
    """Let the runs of this process save a checkpoint many times a second."""
    made = Case.recorder

    def recorder(case, folder, **options):
        return made(case, folder, **{**options, "checkpoint_every": EVERY})

    Case.recorder = recorder


def signal_within_write(n, number):
    """Let the n-th write of this process meet a signal after half of its bytes; count them."""
    plain, count = whole_file.write_all, 0

    def write_all(file, data):
        nonlocal count
        count += 1
        if count == n:
            half = memoryview(data)[: len(data) // 2]
            plain(file, half)
            os.kill(os.getpid(), number)
            data = memoryview(data)[len(half) :]
        plain(file, data)

    for module in [m for name, m in sys.modules.items() if name.startswith("shellcut.")]:
        if getattr(module, "write_all", None) is plain:
            module.write_all = write_all


@functools.cache
def size_of(kind, name):
    """Return the time of a command and its writes, a few more than it has."""
    folder = tiny.folder() / f"size {kind} {name}"
    began = time.monotonic()
    counted = folder / "writes"

    def before():
        often_saved()
        plain, n = whole_file.write_all, [0]

        def write_all(file, data):
            n[0] += 1
            counted.write_text(str(n[0]))
            plain(file, data)

        for module in [m for key, m in sys.modules.items() if key.startswith("shellcut.")]:
            if getattr(module, "write_all", None) is plain:
                module.write_all = write_all

    folder.mkdir(parents=True)
    command([*tiny.words(kind, name), "-o", str(folder / "out")], folder, before).expect(0)
    return time.monotonic() - began, int(counted.read_text())


def _do(folder, *, kind, name, sign, within, at):
    of = "run" if kind == "resume" else kind
    tiny.whole(of, name)
    seconds, writes = size_of(of, name)
    out = folder / "out"
    first = [*tiny.words(of, name), "-o", str(out)]
    if kind == "resume":  # of a run that was killed before
        child = begin(first, folder, often_saved)
        time.sleep(0.5 * at * seconds)
        child.send(signal.SIGKILL)
        child.wait()
        first = ["resume", str(out)]
    if kind == "resume" and not (out / CHECKPOINT).exists():
        first = [*tiny.words(of, name), "-o", str(out), "--overwrite"]

    def before():
        often_saved()
        if within:
            signal_within_write(1 + int(at * writes), SIGNALS[sign])

    child = begin(first, folder, before)
    if not within:
        time.sleep(at * seconds)
        child.send(SIGNALS[sign])
        if sign == "STOP":
            time.sleep(0.1)
            child.send(signal.SIGCONT)
    done = child.wait()
    ended = {"KILL": -signal.SIGKILL, "TERM": -signal.SIGTERM, "INT": 130, "STOP": 0}[sign]
    done.expect(0, ended)
    continued(out, of, name, folder)


def continued(out, kind, name, folder):
    """Continue a command as a user does, and compare with the undisturbed one."""
    again = [*tiny.words(kind, name), "-o", str(out)]
    if kind == "run":
        again = ["resume", str(out)] if (out / CHECKPOINT).exists() else [*again, "--overwrite"]
    command(again, folder).expect(0)
    tiny.assert_same(out, kind, name)

"""Every guard is tripped on purpose: the run stops, or is refused, with its exit code and words."""

import functools
import time

import shellcut as sc
from shellcut.formats.budget import LIMITS
from shellcut.simulation.instability import StabilityGuard

from . import tiny
from .trial import Child, Trial, command, of_the_suite

SHARE = 1
ROWS = {
    "guards in a run": ("a lost solution stops the run with exit code 3, or raises", "`guards.py`"),
    "guards before a run": ("a model that cannot be right is refused", "`guards.py`"),
    "guards of readers": ("a file of too many entities is refused", "`guards.py`"),
    "cost of the guards": ("the guards take 2 % of a run on M1 at most", "`guards.py`"),
}
MOST_SHARE, N_STEP = 0.02, 400


def ends(keys, code, said, folder):
    """Fail unless the strip with some keys and options ends with a code and words."""
    words = [*tiny.words("run", "guillotine"), *keys.split(), "-o", str(folder / "out")]
    done = command(words, folder).expect(code)
    assert said in done.out + done.error, done.error


def entities(folder):
    from test_drawing import plate, saved

    path = saved(folder / "plate.dxf", plate())

    def do():
        LIMITS["points of curves"] = 20
        sc.read_drawing(path)

    assert "points of curves" in Child(do, folder / "said").wait().error


def cost(folder):
    """Measure the time within the guards of a run on M1."""

    def do():
        spent = [0.0]
        for name in ("check_strain", "check_balance"):
            setattr(StabilityGuard, name, timed(getattr(StabilityGuard, name), spent))
        sim = sc.opening_test("M1", threads=1).simulation
        sim.step()
        spent[0], began = 0.0, time.perf_counter()
        for _ in range(N_STEP):
            sim.step()
        share = spent[0] / (time.perf_counter() - began)
        print(f"{100 * share:.2f} %")
        return int(share > MOST_SHARE)

    Child(do, folder / "said").wait().expect(0)


def timed(method, spent):
    """Return a method that adds its time."""

    def measured(*given):
        began = time.perf_counter()
        method(*given)
        spent[0] += time.perf_counter() - began

    return measured


RUNS = [
    ("--set=fixed=1e-6 --force", 3, "blew up"),
    ("--set=strength=18e6 --set=plateau=12e6 --force", 3, "is it in Pa?"),
    ("--set=young=10", 2, "--force"),
    ("--set=thickness=74", 2, "theory is not valid"),
    ("--set=fixed=1e-17", 2, "1e+11 steps at most"),
    ("--set=membrane.size=1e-6", 2, "membrane"),
    ("--set=thickness=nan", 2, "must be"),
    ("--set=strenght=3", 2, "did you mean"),
    ("--set=thickness=3kg", 2, "must be a number in mm"),
    ("--set=threads=100000", 2, "threads"),
    ("--set=output.rows=99999999999", 2, "rows"),
]
BY_HAND = "unit/test_instability.py::test_a_user_who_steps_by_hand_is_told_too"


def trials():
    for keys, code, said in RUNS:
        row = "guards in a run" if code == 3 else "guards before a run"
        yield Trial(row, keys, functools.partial(ends, keys, code, said))
    of_a_balance = functools.partial(of_the_suite, BY_HAND)
    yield Trial("guards in a run", "energy from nowhere", of_a_balance)
    yield Trial("guards of readers", "a drawing with too many points", entities)
    yield Trial("cost of the guards", f"share of {N_STEP} steps on M1", cost)

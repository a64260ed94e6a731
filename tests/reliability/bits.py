"""One digest whatever the threads, the output, the kernels or the process."""

import functools
import json

from digest_cases import digests_of
from test_same_bits import elsewhere, of_level_three

from . import tiny
from .trial import Trial, command

SHARE = 7
PROMISE = "the digest of state and history is the same"
ELSEWHERE = "`tests/regression/test_same_bits.py`"
ROWS = {
    "threads": (f"1, 2 or 4 threads: {PROMISE}", "`bits.py`"),
    "output": (f"few or many frames, with and without pictures: {PROMISE}", "`bits.py`"),
    "verify": ("`shellcut verify` finds the same run", "`tests/unit/test_verify.py`"),
    "other process": (f"another process, NumPy level, BLAS and sum: {PROMISE}", ELSEWHERE),
    "kernels": (f"kernels compiled now, and for x86-64-v3: {PROMISE}", ELSEWHERE),
}
VARIED = [("threads", ["--set=threads=2"]), ("threads", ["--set=threads=4"]), ("verify", [])]
VARIED += [("output", ["--set=output.frames=1"])]
VARIED += [("output", ["--set=output.frames=60", "--set=output.snapshots=3"])]
PROCESSES = {
    "other process": [of_level_three(), {"OPENBLAS_CORETYPE": "Haswell"}, {"PYTHONHASHSEED": "1"}],
    "kernels": [{}, {"NUMBA_CPU_NAME": "x86-64-v3", "NUMBA_CPU_FEATURES": ""}],
}


def same_when(row, more, name, folder):
    """Fail unless a short model with other words has the digest of the undisturbed run."""
    reference, out = tiny.whole("run", name), folder / "out"
    if row == "verify":
        command(["verify", str(reference)], folder).expect(0)
        return
    command([*tiny.words("run", name), *more, "-o", str(out)], folder).expect(0)
    digests = [json.loads((of / "summary.json").read_text())["digest"] for of in (out, reference)]
    assert digests[0] == digests[1]


def same_elsewhere(row, environment, folder):
    """Fail unless a process of another environment gives the digests of this one."""
    if row == "kernels":  # compiled anew, which takes a minute
        environment = {**environment, "NUMBA_CACHE_DIR": str(folder)}
    assert elsewhere(["through quads"], **environment) == here()


@functools.cache
def here():
    return digests_of(["through quads"])


TRIALS = [
    (row, f"{name} {' '.join(more)}", functools.partial(same_when, row, more, name))
    for name in tiny.SHORT
    for row, more in VARIED
]
TRIALS += [
    (row, str(words), functools.partial(same_elsewhere, row, words))
    for row, environments in PROCESSES.items()
    for words in environments
]
COUNT = len(TRIALS)


def trial(number):
    """Return one of the trials."""
    return Trial(*TRIALS[number])

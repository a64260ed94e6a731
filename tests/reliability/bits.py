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
VARIED = [
    ("threads", ["--set=threads=2"]),
    ("threads", ["--set=threads=4"]),
    ("output", ["--set=output.frames=1"]),
    ("output", ["--set=output.frames=60", "--set=output.snapshots=3"]),
]
PROCESSES = {
    "other process": [of_level_three(), {"OPENBLAS_CORETYPE": "Haswell"}, {"PYTHONHASHSEED": "1"}],
    "kernels": [{}, {"NUMBA_CPU_NAME": "x86-64-v3", "NUMBA_CPU_FEATURES": ""}],
}


def trials():
    for name in tiny.SHORT:
        yield Trial("verify", name, functools.partial(verified, name))
        for row, more in VARIED:
            what = f"{name} {' '.join(more)}"
            yield Trial(row, what, functools.partial(same_when, name, more))
    for row, environments in PROCESSES.items():
        for words in environments:
            yield Trial(row, str(words), functools.partial(same_elsewhere, row, words))


def verified(name, folder):
    command(["verify", str(tiny.whole("run", name))], folder).expect(0)


def same_when(name, more, folder):
    """Fail unless a short model with other words has the digest of the undisturbed run."""
    out = folder / "out"
    command([*tiny.words("run", name), *more, "-o", str(out)], folder).expect(0)
    runs = out, tiny.whole("run", name)
    digests = [json.loads((run / "summary.json").read_text())["digest"] for run in runs]
    assert digests[0] == digests[1]


def same_elsewhere(row, environment, folder):
    """Fail unless a process of another environment gives the digests of this one."""
    if row == "kernels":  # compiled anew, which takes a minute
        environment = {**environment, "NUMBA_CACHE_DIR": str(folder)}
    assert elsewhere(["through quads"], **environment) == here()


@functools.cache
def here():
    return digests_of(["through quads"])

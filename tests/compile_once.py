"""One process compiles a kernel, the others wait for it and take it from the cache.

Numba lets two processes compile the same kernel at the same time, and where both write to its cache
at once an entry may be lost. A lock on a file of each kernel lets one pass after the other; whoever
waited finds what the first has stored. Kernels call no kernels, so nobody holds two such locks.
"""

import hashlib
import os
from contextlib import contextmanager
from pathlib import Path

try:
    import fcntl
except ImportError:  # Windows: there both compile
    fcntl = None


@contextmanager
def _alone(function):
    folder = Path(os.environ["NUMBA_CACHE_DIR"]) / "locks"
    folder.mkdir(parents=True, exist_ok=True)
    code = function.__code__
    name = f"{code.co_filename}:{code.co_firstlineno}:{function.__qualname__}"
    with open(folder / hashlib.sha256(name.encode()).hexdigest()[:16], "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def compile_once():
    """Let kernels with a cache be compiled in one process at a time from now on."""
    from numba.core.caching import NullCache
    from numba.core.dispatcher import Dispatcher

    if fcntl is None:
        return
    compile_ = Dispatcher.compile

    def compile_alone(self, sig):
        if isinstance(self._cache, NullCache):
            return compile_(self, sig)
        with _alone(self.py_func):
            return compile_(self, sig)

    Dispatcher.compile = compile_alone

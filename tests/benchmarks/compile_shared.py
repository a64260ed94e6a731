"""Compile the opening's kernels in several processes: ``compile_shared.py N ...``, for each N anew.

Prints wall time and the CPU time of each process. With a free core for each process, the wall time
is the CPU time of the longest; so more processes than cores tell what more cores would give.
"""

import os
import resource
import subprocess
import sys
import tempfile
import time

ONE = "import sys; from compile_shared import timed; timed(int(sys.argv[1]))"


def timed(n):
    """Compile in this process and n - 1 others; print the times."""
    from shellcut.models import warmup

    warmup.available_cores = lambda: n
    began, cpu = time.perf_counter(), time.process_time()
    warmup.warmup(["opening"])
    wall, cpu = time.perf_counter() - began, time.process_time() - cpu
    others = resource.getrusage(resource.RUSAGE_CHILDREN)
    each = (others.ru_utime + others.ru_stime) / max(n - 1, 1)
    print(f"{n} processes: {wall:.1f} s; CPU {cpu:.1f} s, the others {each:.1f} s each", flush=True)


if __name__ == "__main__":
    for n in sys.argv[1:]:
        with tempfile.TemporaryDirectory() as cache:
            given = os.environ | {"NUMBA_CACHE_DIR": cache}
            folder = os.path.dirname(os.path.abspath(__file__))
            subprocess.run([sys.executable, "-c", ONE, n], env=given, cwd=folder, check=True)

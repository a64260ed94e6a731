"""The ``shellcut`` command; every call here is a call of the Python face."""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Sequence


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command with the given arguments, or with those of the process.

    Returns
    -------
    int
        Exit code: 0 done, 2 bad arguments (argparse leaves with it by itself).
    """
    parser = argparse.ArgumentParser(
        prog="shellcut", description="Explicit dynamics of thin shells cut by a sharp rigid blade."
    )
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser(
        "warmup",
        help="compile all kernels into the cache",
        description="Compile all kernels into the cache, so that the first run starts at once.",
    )
    parser.parse_args(argv)
    return _warmup()


def _warmup() -> int:
    print("compiling the kernels (half a minute, on the first run only) ...", flush=True)
    start = time.perf_counter()
    from .warmup import warmup  # after the line above: importing the library takes a while too

    warmup()
    cache = os.environ.get("NUMBA_CACHE_DIR", "__pycache__ of the package")
    print(f"done in {time.perf_counter() - start:.1f} s; the cache is in {cache}")
    return 0

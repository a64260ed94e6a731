"""``shellcut warmup``: compile before the first run."""

from __future__ import annotations

import argparse
import os
import time
from typing import Any

from shellcut.models.warmup import warmup


def add_to(commands: Any) -> None:
    """Add the subcommand to the parser."""
    parser = commands.add_parser(
        "warmup",
        help="compile all kernels into the cache",
        description="Compile all kernels into the cache, so that the first run starts at once.",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Compile; print how long it took and where the cache is."""
    print("compiling the kernels (half a minute, on the first run only) ...", flush=True)
    start = time.perf_counter()
    warmup()
    cache = os.environ.get("NUMBA_CACHE_DIR", "__pycache__ of the package")
    print(f"done in {time.perf_counter() - start:.1f} s; the cache is in {cache}")
    return 0

"""``warmup``: compile the kernels of the ready models into the cache.

Compile the kernels of the ready models into the cache, on all cores, so that the first run starts
at once.
"""

from __future__ import annotations

import os
import time

from shellcut.models.warmup import MODELS, warmup

from .shared import Arguments, Parser


def add_to(parser: Parser) -> None:
    """Add its arguments to the parser."""
    parser.add_argument(
        "models", nargs="*", metavar="MODEL", help=f"only for these of {', '.join(MODELS)}"
    )


def run(arguments: Arguments) -> None:
    """Compile; print how long it took and where the cache is."""
    print("compiling the kernels (on the first run only) ...", flush=True)
    start = time.perf_counter()
    warmup(arguments.models or MODELS, told=lambda n, of: print(f"{n} of {of}", flush=True))
    cache = os.environ.get("NUMBA_CACHE_DIR", "__pycache__ of the package")
    print(f"done in {time.perf_counter() - start:.1f} s; the cache is in {cache}")

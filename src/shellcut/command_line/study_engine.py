"""Arguments that say what carries out the runs of a study or fit."""

from __future__ import annotations

import argparse
import contextlib
from collections.abc import Iterator
from typing import Any


def add_engine_to(parser: argparse.ArgumentParser) -> None:
    """Add ``--jobs`` and ``--dask``."""
    engine = parser.add_mutually_exclusive_group()
    engine.add_argument("--jobs", metavar="N", type=int, help="processes, by default one a core")
    engine.add_argument(
        "--dask",
        metavar="ADDRESS",
        help="a Dask scheduler such as tcp://host:8786, whose workers see OUT; or local",
    )


@contextlib.contextmanager
def engine_given(arguments: argparse.Namespace) -> Iterator[Any]:
    """Give the number of processes, or a Dask client, with a cluster of its own if asked for.

    Raises
    ------
    ImportError, ConnectionError
        If there is no Dask, or no scheduler.
    """
    if arguments.dask is None:
        yield arguments.jobs
        return
    from shellcut.numerics.threads import available_cores

    try:
        from shellcut.study.dask_engine import cluster_at
    except ImportError:
        raise ImportError("--dask needs Dask: pip install 'shellcut[sweep]'") from None
    with cluster_at(arguments.dask, available_cores()) as client:
        yield client

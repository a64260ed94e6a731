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
    try:
        from distributed import Client, LocalCluster
    except ImportError:
        raise ImportError("--dask needs Dask: pip install 'shellcut[sweep]'") from None
    from shellcut.numerics.threads import available_cores

    with contextlib.ExitStack() as close:
        where: Any = arguments.dask
        if where == "local":
            cluster = LocalCluster(
                n_workers=available_cores(), threads_per_worker=1, dashboard_address=None
            )
            where = close.enter_context(cluster)
        try:
            client = close.enter_context(Client(where, timeout=10.0))
        except (OSError, TimeoutError, ValueError) as problem:
            said = f"{type(problem).__name__}: {problem}"
            raise ConnectionError(f"there is no Dask scheduler at {where}: {said}") from None
        yield client

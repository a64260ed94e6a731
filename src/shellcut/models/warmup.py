"""Compile the kernels of models before they are needed, on all cores.

``kernels.json`` lists the kernels that short runs of them call, the largest first: the models,
the kernel, the types of its arguments (:mod:`shellcut.numerics.signature_text`);
``tests/record_kernels.py`` writes it. This process and others beside it go through the list, and
each compiles what no other has begun; the machine code meets on disk
(:mod:`shellcut.numerics.kernel_cache`). A run of a model with options of its own may call others,
which are compiled when it does.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Iterable
from importlib import resources
from typing import Any

from shellcut.numerics.jit import compile_if_free, is_stored
from shellcut.numerics.signature_text import named, read
from shellcut.numerics.threads import available_cores

MODELS = ("opening", "guillotine", "oscillating", "trouser", "free")
"""Models whose kernels are listed, a free one with a plain film and blade."""

_MOST_PROCESSES = 8
"""Beyond, the largest kernel alone decides how long it takes."""

_Kernel = tuple[Any, tuple[Any, ...]]


def warmup(models: Iterable[str] = MODELS, told: Callable[[int, int], None] | None = None) -> None:
    """Compile the kernels of ready models into the cache, or load them.

    On a machine's first run this takes half a minute of one core, a second later. Call it before
    timing anything. ``told`` is called after each kernel with the numbers of kernels that are ready
    and of all, never if none has to be compiled.

    Parameters
    ----------
    models : iterable of str
        Names in :data:`MODELS`.

    Raises
    ------
    ValueError
        If one is no model.

    Examples
    --------
    >>> import shellcut
    >>> shellcut.warmup(["opening"])  # doctest: +SKIP
    """
    names = list(models)
    if unknown := [name for name in names if name not in MODELS]:
        raise ValueError(f"{', '.join(unknown)}: the models are {', '.join(MODELS)}")
    kernels = _listed(names)
    missing = [kernel for kernel in kernels if not is_stored(*kernel)]
    others, said = _others(names, len(missing)), 0
    try:
        for function, types in missing:
            if compile_if_free(function, types) and told is not None:
                ready = sum(is_stored(*kernel) for kernel in kernels)
                if ready > said:
                    told(ready, len(kernels))
                    said = ready
        for function, types in kernels:  # waits for those that others have begun
            function.compile(types)
        if missing and told is not None and said < len(kernels):
            told(len(kernels), len(kernels))
    finally:
        for other in others:
            other.kill()
            other.communicate()


def _listed(models: Iterable[str]) -> list[_Kernel]:
    """Return kernels and types of their arguments."""
    text = (resources.files("shellcut.models") / "kernels.json").read_text(encoding="utf-8")
    wanted = set(models)
    return [
        (named(name), tuple(map(read, kinds)))
        for models_of_it, name, *kinds in json.loads(text)
        if wanted.intersection(models_of_it)
    ]


def _others(models: list[str], n_missing: int) -> list[subprocess.Popen[bytes]]:
    """Start processes that compile with this one; they end with it, however it ends."""
    n = min(available_cores(), _MOST_PROCESSES, n_missing) - 1
    if not sys.executable:
        return []
    command = [sys.executable, "-c", f"from {__name__} import help_parent; help_parent()", *models]
    null = subprocess.DEVNULL
    return [
        subprocess.Popen(command, stdin=subprocess.PIPE, stdout=null, stderr=null) for _ in range(n)
    ]


def help_parent() -> None:
    """Compile what no other process has begun, until this is done or the parent ends."""
    threading.Thread(target=_end_with_parent, daemon=True).start()
    for function, types in _listed(sys.argv[1:]):
        compile_if_free(function, types)


def _end_with_parent() -> None:
    sys.stdin.read()  # until the parent closes it, or has ended
    os._exit(0)

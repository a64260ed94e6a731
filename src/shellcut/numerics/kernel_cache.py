"""Numba's cache of machine code on disk, made to notice every edit and to bear damaged files.

Numba stamps what it stores of a kernel with the kernel's own file. A kernel holds copies of the
functions that it calls, which stand in other files: here the stamp is the digest of all of them
(:mod:`shellcut.numerics.source_digest`). A stored file that is cut short, of other content or out
of date counts as none, and the kernel is compiled anew; where nothing can be stored, it is compiled
in every process.

Several processes may need a kernel at once, as those of a study on a new machine. One compiles it,
the others wait and take what it has stored.
"""

# Numba's classes have no types.
# mypy: disable-error-code="misc, no-untyped-call, no-untyped-def"

from __future__ import annotations

import hashlib
import pickle
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from numba.core.caching import FunctionCache, IndexDataCacheFile, NullCache
from numba.core.registry import cpu_target

from shellcut.files import file_lock

from .source_digest import in_package, source_digest

_N_DIGEST = hashlib.sha256().digest_size


def kernel_cache(function: Callable[..., Any]) -> Any:
    """Return the cache of a kernel, or one that stores nothing where no folder can be written."""
    try:
        return KernelCache(function)
    except RuntimeError:  # Numba finds no folder
        return NullCache()


class _KernelFile(IndexDataCacheFile):
    """Index and machine code of a kernel, a file for each variant, headed by its digest."""

    def __init__(self, function: Callable[..., Any], folder: str, name: str) -> None:
        super().__init__(folder, name, None)
        self._function = function

    def _load_index(self) -> dict[Any, str]:
        # Every access begins here, when all that the kernel calls is defined.
        is_ours = in_package(Path(self._function.__code__.co_filename))
        self._source_stamp = source_digest(*([] if is_ours else [self._function]))
        try:
            return dict(super()._load_index())
        except Exception:  # unpickling of anything else may raise anything
            return {}

    def _load_data(self, name: str) -> Any:
        data = Path(self._data_path(name)).read_bytes()
        digest, code = data[:_N_DIGEST], data[_N_DIGEST:]
        return pickle.loads(code) if hashlib.sha256(code).digest() == digest else None

    def _save_data(self, name: str, data: Any) -> None:
        code = self._dump(data)
        with self._open_for_write(self._data_path(name)) as file:
            file.write(hashlib.sha256(code).digest() + code)


class KernelCache(FunctionCache):
    """Numba's cache of one function, over such files."""

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        self._cache_file = _KernelFile(function, self.cache_path, self._impl.filename_base)

    def save_overload(self, signature: Any, result: Any) -> None:
        """Store machine code, unless the folder cannot be written or is full."""
        try:
            super().save_overload(signature, result)
        except OSError:
            self.disable()

    def has(self, signature: Any) -> bool:
        """Return whether machine code for these types of arguments, and this machine, is stored."""
        context = cpu_target.target_context
        return self._index_key(signature, context.codegen()) in self._cache_file._load_index()

    @contextmanager
    def alone(self, *, wait: bool = True) -> Iterator[bool]:
        """Keep other processes from compiling the kernel within the block.

        Parameters
        ----------
        wait : bool
            Whether to wait where another process compiles it. Without, the block is told whether
            it is alone.
        """
        try:
            self._impl.locator.ensure_cache_path()
            lock = (Path(self.cache_path) / f"{self._impl.filename_base}.lock").open("ab")
        except OSError:  # nothing can be stored, each compiles for itself
            yield True
            return
        with lock:
            try:
                file_lock.take(lock, wait=wait)
            except OSError as refusal:
                yield refusal.errno not in file_lock.HELD_BY_ANOTHER
                return
            yield True

"""Numba's cache of machine code on disk, made to notice every edit and to bear damaged files.

Numba stamps what it stores of a kernel with the kernel's own file. A kernel contains copies of the
functions that it calls, which stand in other files, and of the values that these read: here the
stamp is the digest of all of them (:mod:`shellcut.numerics.source_digest`). A stored file that is
cut short, of other content or out of date counts as none, and the kernel is compiled anew; where
nothing can be stored, it is compiled in every process.

A release brings machine code for two kinds of x86-64 processors, in the package's folder
``compiled``, which is only read: a processor uses what it understands before it searches its own
(``.ci/release.py`` makes such a wheel). It is found and judged as any other.

Several processes may need a kernel at once, as those of a study on a new machine. One compiles it,
the others wait and take what it has stored.
"""

# Numba's classes have no types.
# mypy: disable-error-code="misc, no-untyped-call, no-untyped-def"

from __future__ import annotations

import errno
import hashlib
import os
import pickle
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, ClassVar

from llvmlite import binding
from numba.core.caching import CompileResultCacheImpl, FunctionCache, IndexDataCacheFile
from numba.core.registry import cpu_target

from shellcut.files import file_lock

from .source_digest import NOT_STORED, PACKAGE, in_package, source_digest

_N_DIGEST = hashlib.sha256().digest_size

_V3 = {"avx", "avx2", "bmi", "bmi2", "cx16", "f16c", "fma", "lzcnt", "movbe", "popcnt", "sahf"}
_V4 = _V3 | {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"}
LEVELS = {"x86-64-v4": _V4, "x86-64-v3": _V3}
"""Kinds of processors that a release brings machine code for, and what these must understand."""


def _levels(name: str, features: str) -> list[str]:
    """Return the levels that a processor, as Numba names it, belongs to, the highest first."""
    understood = {flag[1:] for flag in features.split(",") if flag.startswith("+")}
    return [level for level, needed in LEVELS.items() if level == name or needed <= understood]


class _KernelFile(IndexDataCacheFile):
    """Index and machine code of a kernel, a file for each variant, headed by its digest."""

    def __init__(self, function: Callable[..., Any], folder: str, name: str) -> None:
        super().__init__(folder, name, None)
        self._function = function

    def _load_index(self) -> dict[Any, str]:
        # Every access begins here, when all that the kernel calls is defined.
        self._source_stamp = self.stamp()
        try:
            return dict(super()._load_index())
        except Exception:  # unpickling of anything else may raise anything
            return {}

    def stamp(self) -> str:
        """Return the digest of what the machine code is made of now."""
        is_ours = in_package(Path(self._function.__code__.co_filename))
        return source_digest(*([] if is_ours else [self._function]))

    def _load_data(self, name: str) -> Any:
        data = Path(self._data_path(name)).read_bytes()
        digest, code = data[:_N_DIGEST], data[_N_DIGEST:]
        with suppress(Exception):  # it may name what another version of NumPy contains
            return pickle.loads(code) if hashlib.sha256(code).digest() == digest else None

    def _save_data(self, name: str, data: Any) -> None:
        code = self._dump(data)
        with self._open_for_write(self._data_path(name)) as file:
            file.write(hashlib.sha256(code).digest() + code)


class _Nowhere:
    """The place of what cannot be stored, as Numba requires it."""

    def __init__(self, line: int) -> None:
        self._line = line

    @classmethod
    def from_function(cls, function: Callable[..., Any], _file: str) -> _Nowhere:
        """Return it for any function."""
        return cls(function.__code__.co_firstlineno)

    def get_cache_path(self) -> str:
        """Return what is no folder."""
        return os.devnull

    def ensure_cache_path(self) -> None:
        """Refuse to store."""
        raise OSError(errno.EROFS, os.strerror(errno.EROFS))

    def get_source_stamp(self) -> None:
        """Return none: nothing is kept."""

    def get_disambiguator(self) -> str:
        """Return what distinguishes functions of a name, as Numba does for those in files."""
        return str(self._line)


class _Implementation(CompileResultCacheImpl):
    _locator_classes: ClassVar[Any] = [*CompileResultCacheImpl._locator_classes, _Nowhere]

    def reduce(self, result: Any) -> tuple[Any, ...]:
        """Return what is stored: machine code, and of LLVM's code that it defines the function.

        Kernels do not call kernels, so none is linked into another. It is a third of the size then,
        and loads in half the time.
        """
        library, *described, _typing, reload, environments = super().reduce(result)
        name, kind, (code, _) = library
        called = f'define void @"{result.fndesc.llvm_cpython_wrapper_name}"() {{ ret void }}'
        defined = binding.parse_assembly(called).as_bitcode()
        return ((name, kind, (code, defined)), *described, "", reload, environments)


class KernelCache(FunctionCache):
    """Numba's cache of one function, over such files."""

    _impl_class = _Implementation
    _cache_file: _KernelFile

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        self._cache_file = _KernelFile(function, self.cache_path, self._impl.filename_base)

    @property
    def can_store(self) -> bool:
        """Whether a folder was found for what is compiled."""
        return not isinstance(self._impl.locator, _Nowhere)

    def save_overload(self, signature: Any, result: Any) -> None:
        """Store machine code, unless the folder cannot be written or is full.

        Nor is what no other process would find: what depends on a value that has no digest.
        """
        with suppress(OSError):
            if NOT_STORED not in f"{signature} {self._cache_file.stamp()}":
                super().save_overload(signature, result)

    def has(self, signature: Any) -> bool:
        """Return whether machine code for these types of arguments, and this machine, is stored."""
        places = self._places(signature, cpu_target.target_context.codegen())
        return any(key in file._load_index() for file, key in places)

    def _places(self, signature: Any, codegen: Any) -> Iterator[tuple[_KernelFile, Any]]:
        """Yield where machine code may be, and its key there; a release is first."""
        kinds, (triple, *processor), content = key = self._index_key(signature, codegen)
        source = Path(self._py_func.__code__.co_filename)
        for level in _levels(*processor) if in_package(source) else ():
            folder = PACKAGE / "compiled" / level / source.parent.relative_to(PACKAGE)
            file = _KernelFile(self._py_func, str(folder), self._impl.filename_base)
            yield file, (kinds, (triple, level, ""), content)
        yield self._cache_file, key

    def _load_overload(self, signature: Any, context: Any) -> Any:
        for file, key in self._places(signature, context.codegen()):
            if (data := file.load(key)) is not None:
                return self._impl.rebuild(context, data)
        return None

    @contextmanager
    def alone(self, *, wait: bool = True) -> Iterator[bool]:
        """Keep other processes from compiling the kernel within the block.

        Parameters
        ----------
        wait : bool
            Whether to wait where another process compiles it. Without, the block gets whether it is
            alone.
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

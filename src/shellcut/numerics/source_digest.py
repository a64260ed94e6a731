"""The digest of all that may end up in a function's machine code.

Kernels are compiled with copies of the functions that they call and of the values that these read,
so what is stored of them on disk (:mod:`shellcut.numerics.kernel_cache`) is out of date when any of
these changes. The digest covers every source of shellcut. Of a function that is defined elsewhere,
such as a law of a user's own, it covers its file, its code, its defaults and the values that it
reads: globals, cells of closures, and what it names of modules and classes; then the same of all
functions among these. So it does not matter whether a number is made by a factory, another module,
an environment variable or a file. Which of shellcut's sources a kernel reaches cannot be read off
its functions for sure: a constant does not tell where it is defined.

A value of a kind that has no digest makes the digest one of this process only: see
:data:`NOT_STORED`.
"""

from __future__ import annotations

import enum
import functools
import hashlib
import secrets
from collections.abc import Callable, Iterator
from pathlib import Path
from types import CodeType, EllipsisType, FunctionType, ModuleType, NoneType
from typing import Any

import numpy as np

PACKAGE = Path(__file__).parents[1]
"""The folder of shellcut."""

# Their versions are Numba's own business.
_FOREIGN = {"numpy", "numba", "llvmlite", "builtins", "math", "cmath", "operator"}

NOT_STORED = f"of process {secrets.token_hex(8)} only"
"""Is part of digests that cover a value without one: no other process finds what has such a digest,
and the machine code for it is not stored."""

_BY_REPR = (NoneType, bool, int, float, complex, str, bytes, EllipsisType)
"""Types whose representation says all of a value."""


def source_digest(*functions: Callable[..., Any]) -> str:
    """Return the digest of functions, and of what these call and read."""
    found = _Found(functions)
    digest = hashlib.sha256(_of_package())
    for path in found.files:
        digest.update(path.name.encode() + _content(path))
    for text in found.texts:
        digest.update(text.encode())
    return digest.hexdigest() + (f" {NOT_STORED}" if found.has_unknown else "")


class _Found:
    """Functions and all functions that they call or refer to, each once, in a fixed order."""

    def __init__(self, functions: tuple[Callable[..., Any], ...]) -> None:
        self._functions: list[Any] = []
        self._number: dict[int, int] = {}
        self.has_unknown = False
        """Whether they read a value that has no digest."""
        self.texts = [self._of_value(function) for function in functions]
        """What the digest covers of them besides the files; grows until all are listed."""
        for function in self._functions:  # which grows meanwhile
            self.texts.append(self._of_function(function))

    @property
    def files(self) -> list[Path]:
        """Their files outside of shellcut."""
        files = {Path(function.__code__.co_filename) for function in self._functions}
        elsewhere = (path for path in files if path.is_file() and not in_package(path))
        return sorted(elsewhere, key=lambda path: (path.name, _content(path)))

    def _of_function(self, function: Any) -> str:
        read: list[tuple[str, Any]] = [
            ("defaults", function.__defaults__),
            ("defaults by name", function.__kwdefaults__),
            *zip(function.__code__.co_freevars, _cells(function), strict=True),
        ]
        # The globals of shellcut's own functions follow from its sources.
        if not in_package(Path(function.__code__.co_filename)):
            read += _named_by(function)
        values = [f"{name} = {self._of_value(value)}" for name, value in read]
        return "\n".join([function.__qualname__, self._of_value(function.__code__), *values])

    def _of_value(self, value: Any) -> str:
        kind, plain = type(value), _plain(value)
        if isinstance(plain, FunctionType):
            if _is_foreign(plain.__module__):
                return f"{plain.__module__}.{plain.__qualname__}"
            if id(plain) not in self._number:
                self._number[id(plain)] = len(self._functions)
                self._functions.append(plain)
            return f"function {self._number[id(plain)]}"
        if kind in _BY_REPR:
            return f"{kind.__name__} {value!r}"
        if isinstance(value, CodeType):
            return self._of_values(_parts(value))
        if isinstance(value, ModuleType):
            return f"module {value.__name__}"
        if isinstance(value, np.ndarray | np.generic) and not value.dtype.hasobject:
            content = hashlib.sha256(value.tobytes()).hexdigest()
            return f"{value.dtype.descr} {value.shape} {content}"
        if isinstance(value, enum.Enum):
            return f"{kind.__qualname__}.{value.name} {self._of_value(value.value)}"
        if isinstance(value, tuple | list):
            return f"{kind.__qualname__} {self._of_values(value)}"
        if isinstance(value, dict | set | frozenset):
            items = value.items() if isinstance(value, dict) else value
            return f"{kind.__qualname__} {sorted(map(self._of_value, items))}"
        if isinstance(value, type):  # what is read of it is listed by name
            given = getattr(value, "_field_defaults", {})
            return f"class {value.__module__}.{value.__qualname__} {self._of_value(given)}"
        if _is_foreign(kind.__module__) and " at 0x" not in repr(value):
            return f"{kind.__module__}.{kind.__qualname__} {value!r}"
        self.has_unknown = True
        return f"{kind.__qualname__} {id(value)}"

    def _of_values(self, values: Any) -> str:
        return f"({', '.join(map(self._of_value, values))})"


def _named_by(function: Any) -> Iterator[tuple[str, Any]]:
    """Yield the globals that a function names, and what it names of modules and classes."""
    names, given = sorted(set(_names(function.__code__))), function.__globals__
    found = [(name, given[name]) for name in names if name in given]
    found += zip(function.__code__.co_freevars, _cells(function), strict=True)
    seen: set[int] = set()
    for path, value in found:  # which grows: package.module.function
        yield path, value
        if isinstance(value, ModuleType | type) and id(value) not in seen:
            seen.add(id(value))
            inner = ((name, getattr(value, name, None)) for name in names if _has(value, name))
            found += [(f"{path}.{name}", value) for name, value in inner if not _is_slot(value)]


def _has(value: Any, name: str) -> bool:
    """Return whether a module or class has a name; a module may load more when it is accessed."""
    return name in vars(value) if isinstance(value, ModuleType) else hasattr(value, name)


def _is_slot(value: Any) -> bool:
    """Return whether this says where objects of a class keep a value."""
    return hasattr(type(value), "__get__") and not isinstance(_plain(value), FunctionType)


def _cells(function: Any) -> list[Any]:
    """Return the contents of the cells of a closure; a cell may still be empty."""
    return [_in_cell(cell) for cell in function.__closure__ or ()]


def _in_cell(cell: Any) -> Any:
    try:
        return cell.cell_contents
    except ValueError:
        return "empty"


def _parts(code: CodeType) -> tuple[Any, ...]:
    """Return the contents of code, independent of where it is defined."""
    counts = code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount, code.co_flags
    names = code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars
    return code.co_name, code.co_code, counts, names, code.co_consts


def _is_foreign(module: Any) -> bool:
    return str(module).partition(".")[0] in _FOREIGN


def _names(code: CodeType) -> Iterator[str]:
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _names(constant)


def _plain(value: Any) -> Any:
    """Return the Python function of a Numba function, or the value itself."""
    for name in ("py_func", "_defn", "__func__"):  # compiled, an intrinsic, of a class
        inner = getattr(value, name, None)
        if isinstance(inner, FunctionType):
            return inner
    return value


def in_package(path: Path) -> bool:
    """Return whether a source is a source of shellcut."""
    return PACKAGE in path.parents


@functools.cache
def _of_package() -> bytes:
    """Return the digest of all sources of shellcut, 3 MB read in 10 ms."""
    digest = hashlib.sha256()
    for path in sorted(PACKAGE.rglob("*.py")):
        digest.update(path.relative_to(PACKAGE).as_posix().encode() + path.read_bytes())
    return digest.digest()


@functools.lru_cache(maxsize=64)
def _content_at(path: Path, changed: int) -> bytes:
    return path.read_bytes()


def _content(path: Path) -> bytes:
    return _content_at(path, path.stat().st_mtime_ns)

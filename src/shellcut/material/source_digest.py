"""The sources that end up in the machine code of a law, and their digest.

Numba keeps compiled kernels on disk under the types of their arguments, and a law's type holds this
digest, so no kernel runs with an old version of a law. Covered are the files of the law's functions
and of all functions that these call or hold, wherever they stand: a law of plasticity calls those
of the hardening, of the return to the yield surface and of the logarithmic strain. What stands
between them and the kernels, all files of :mod:`shellcut.numerics` and
:mod:`shellcut.material.law_dispatch`, is always covered.
"""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Callable, Iterator
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

import shellcut.numerics

# Their versions are Numba's own business.
_FOREIGN = {"numpy", "numba", "llvmlite", "builtins", "math"}


def source_digest(*functions: Callable[..., Any]) -> bytes:
    """Return the digest of the sources of functions, and of what these call."""
    digest = hashlib.sha256(_of_all_laws())
    for function in functions:
        digest.update(str(_plain(function).__qualname__).encode())
    for path in source_files(*functions):
        digest.update(path.name.encode())
        digest.update(_content(path))
    for code in sorted(_without_file(functions)):
        digest.update(code)
    return digest.digest()


def source_files(*functions: Callable[..., Any]) -> list[Path]:
    """Return the files of functions, and of all functions that they call or hold, by name."""
    files = {_file_of(one) for one in _reached(functions)}
    return sorted(
        (path for path in files if path is not None), key=lambda path: (path.name, _content(path))
    )


def _without_file(functions: tuple[Callable[..., Any], ...]) -> set[bytes]:
    """Return the code of functions that stand in no file, as those of an interactive session."""
    codes = (one.__code__ for one in _reached(functions) if _file_of(one) is None)
    return {code.co_code + repr(code.co_consts).encode() for code in codes}


def _reached(functions: tuple[Callable[..., Any], ...]) -> list[Any]:
    """Return functions and all that they call or hold, each once."""
    waiting = [_plain(one) for one in functions]
    found: dict[int, Any] = {}
    while waiting:
        function = waiting.pop()
        if id(function) not in found:
            found[id(function)] = function
            waiting += _used_by(function)
    return list(found.values())


def _used_by(function: Any) -> Iterator[Any]:
    """Yield the functions that a function names or holds."""
    names = set(_names(function.__code__))
    values = [function.__globals__[name] for name in names if name in function.__globals__]
    modules = [one for one in values if isinstance(one, ModuleType)]
    for module in modules:  # and what they hold, package.module.function
        held = [vars(module)[name] for name in names if name in vars(module)]
        modules += [one for one in held if isinstance(one, ModuleType) and one not in modules]
        values += held
    for cell in function.__closure__ or ():
        held = cell.cell_contents
        values += held if isinstance(held, tuple) else [held]
    for value in values:
        plain = _plain(value)
        if hasattr(plain, "__code__") and hasattr(plain, "__globals__") and _is_ours(plain):
            yield plain


def _is_ours(function: Any) -> bool:
    return str(function.__module__).partition(".")[0] not in _FOREIGN


def _names(code: CodeType) -> Iterator[str]:
    yield from code.co_names
    for one in code.co_consts:
        if isinstance(one, CodeType):
            yield from _names(one)


def _plain(function: Any) -> Any:
    return getattr(function, "py_func", function)


def _file_of(function: Any) -> Path | None:
    path = Path(function.__code__.co_filename)
    return path if path.is_file() else None


@functools.cache
def _of_all_laws() -> bytes:
    """Return the digest of what stands between any law and the kernels."""
    paths = sorted(Path(shellcut.numerics.__path__[0]).glob("*.py"))
    digest = hashlib.sha256()
    for path in [*paths, Path(__file__).with_name("law_dispatch.py")]:
        digest.update(path.name.encode() + _content(path))
    return digest.digest()


@functools.lru_cache(maxsize=64)
def _content_at(path: Path, changed: int) -> bytes:
    return path.read_bytes()


def _content(path: Path) -> bytes:
    return _content_at(path, path.stat().st_mtime_ns)

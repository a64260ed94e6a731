"""Arguments of public functions and classes: declared once, and checked by what is declared.

What an annotation says is asked of every argument, before the function sees it: a text is no
number, a mesh no tool, a masked array no array. An :class:`Option` in it says the unit, the meaning
and the bounds; docstrings, model files and their page have them from there. The message names all
arguments that are wrong. What several numbers must be together, the function itself knows. Imports
only NumPy.
"""

from __future__ import annotations

import difflib
import functools
import inspect
import math
import re
import sys
import types
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from numbers import Integral, Real
from typing import Annotated, Any, Literal, NamedTuple, TypeVar, Union, cast, get_args, get_origin

import numpy as np
import numpy.typing as npt

T = TypeVar("T")

_SHOWN = 60  # characters of a value
_PLAIN = {float: "a number", int: "a whole number", bool: "True or False", str: "a text"}
_ARRAY = "an array of real numbers"


class ArgumentError(TypeError, ValueError):
    """Arguments are of another kind than they must be; the message names them all."""


@dataclass(frozen=True)
class Option:
    """What is declared of an argument beside its type and its default.

    It stands in the annotation of a parameter or a field; type and default stand around it.

    Examples
    --------
    >>> @checked
    ... def run(speed: Annotated[float, Option("mm/s", "after the ramp", above=0)] = 3.0) -> float:
    ...     return speed
    >>> run(-1.0)
    Traceback (most recent call last):
        ...
    shellcut.arguments.ArgumentError: speed must be positive, got -1.0 mm/s
    >>> declared(run)["speed"].option.unit, declared(run)["speed"].default
    ('mm/s', 3.0)
    """

    unit: str
    """Empty for a pure number, and for what is no number."""
    text: str
    """Its meaning, for docstrings and the page of keys."""
    above: float | None = None
    least: float | None = None
    below: float | None = None
    most: float | None = None
    """Bounds of a number; by ``above`` and ``below`` it must not be the bound itself."""
    why: str = ""
    """Reason of the bounds, for the message."""
    unset: str = ""
    """What holds if it is None."""
    form: str = ""
    """How a model file writes it, if its type does not say so."""

    @property
    def bounds(self) -> str:
        """What a number must be, in words."""
        forms = {
            "above": "above {}",
            "below": "below {}",
            "least": "{} or more",
            "most": "{} at most",
        }
        given = {name: getattr(self, name) for name in forms}
        there = {
            k: f"{v:,}" if isinstance(v, int) else f"{v:g}"
            for k, v in given.items()
            if v is not None
        }
        if {"least", "most"} <= set(there):
            return f"from {there['least']} to {there['most']}"
        words = [forms[name].format(value) for name, value in there.items()]
        return " and ".join("positive" if word == "above 0" else word for word in words)

    def problem(self, value: Any) -> str:
        """Return why a value is out of bounds, "" if it is not."""
        if not _is_number(value, Real):
            return ""
        above, least, below, most = self.above, self.least, self.below, self.most
        within = (above is None or value > above) and (least is None or value >= least)
        within = within and (below is None or value < below) and (most is None or value <= most)
        finite = isinstance(value, Integral) or math.isfinite(value)
        if within and finite:
            return ""
        wanted = [self.bounds, *([] if finite or (self.bounds and value != value) else ["finite"])]
        why, unit = f" ({self.why})" if self.why else "", f" {self.unit}" if self.unit else ""
        return f"must be {' and '.join(filter(None, wanted))}{why}, got {_shown(value)}{unit}"


class Declared(NamedTuple):
    """An argument that has an :class:`Option`."""

    kind: Any
    """Its type."""
    option: Option
    default: Any
    """``inspect.Parameter.empty`` if it must be given."""


@functools.cache
def declared(function: Callable[..., Any]) -> Mapping[str, Declared]:
    """Return the arguments of a function, or of a class, that have an :class:`Option`, in order."""
    of = function if isinstance(function, type) else None
    kinds = dict(_kinds(inspect.unwrap(of.__init__ if of else function), of))  # type: ignore[misc]
    found = {}
    for name, parameter in inspect.signature(function).parameters.items():
        kind, option = _parted(kinds.get(name))
        if option is not None:
            found[name] = Declared(kind, option, parameter.default)
    return found


def checked(what: T) -> T:
    """Return a function that refuses arguments that are not as its annotations say.

    Of a class, such as a dataclass, it is the ``__init__``. Annotations that say nothing, like
    Any, or that cannot be looked up at run time, allow everything. Arguments with an
    :class:`Option` are added to the docstring.

    Raises
    ------
    ArgumentError
        At a call, with every argument that is of another kind, out of bounds, or nan.

    Examples
    --------
    >>> @checked
    ... def area(width: float, height: float = 1.0) -> float:
    ...     return width * height
    >>> area(2, height="3")
    Traceback (most recent call last):
        ...
    shellcut.arguments.ArgumentError: height must be a number, got '3': leave out the quotes
    """
    if isinstance(what, type):
        _document(what, vars(sys.modules[what.__module__]))
        what.__init__ = _checked_call(what.__init__, what)  # type: ignore[misc]
        return what
    _document(what, what.__globals__)  # type: ignore[attr-defined]
    return cast("T", _checked_call(what, None))


def _document(what: Any, names: dict[str, Any]) -> None:
    """Add the arguments with an :class:`Option` to a docstring."""
    lines = []
    given = inspect.get_annotations(what)
    if isinstance(what, type):
        given |= inspect.get_annotations(what.__init__)  # type: ignore[misc]
    for name, written in given.items():
        told = "Option(" in str(written)
        kind, option = _parted(eval(written, names) if told else names.get(written))
        if option:
            words = " or ".join(re.sub("^an? ", "", word) for word in _words(kind))
            lines.append(f"{name} : {words}{f' [{option.unit}]' if option.unit else ''}")
            unset = f"by default {option.unset}" if option.unset else ""
            lines.append(f"    {'; '.join(filter(None, (option.text, option.bounds, unset)))}.")
    if not lines or not what.__doc__:
        return
    text, heading = inspect.cleandoc(what.__doc__), "Parameters\n----------\n"
    entries = "\n".join(lines)
    if heading not in text:
        others = re.search(r"\n\w+\n---+\n", text)
        at = others.start() if others else len(text)
        text = f"{text[:at].rstrip()}\n\n{heading}\n{text[at:].lstrip()}"
    what.__doc__ = text.replace(heading, f"{heading}{entries}\n", 1)


def _parted(kind: Any) -> tuple[Any, Option | None]:
    """Return the type in an annotation, and the :class:`Option` beside it."""
    if get_origin(kind) is not Annotated:
        return kind, None
    return get_args(kind)[0], next((one for one in get_args(kind) if isinstance(one, Option)), None)


def _checked_call(function: Any, of: type | None) -> Any:
    signature = inspect.signature(function)

    @functools.cache
    def wanted() -> dict[str, tuple[Any, Option | None]]:
        return {name: _parted(kind) for name, kind in _kinds(function, of)}

    @functools.wraps(function)
    def call(*arguments: Any, **named: Any) -> Any:
        given: Mapping[str, Any] = {}
        try:
            given = signature.bind(*arguments, **named).arguments
        except TypeError:  # what else is wrong, Python says below
            _refuse_unknown(named, signature)
        kinds = wanted()
        wrong = {
            name: f"{name} must be {' or '.join(_words(kinds[name][0]))}, got {_shown(value)}"
            for name, value in given.items()
            if name in kinds and not _fits(value, kinds[name][0])
        }
        beyond = [
            f"{name} {said}"
            for name, value in given.items()
            if name in kinds and name not in wrong and (option := kinds[name][1])
            if (said := option.problem(value))
        ]
        if wrong and of is not None:  # a class may say better what they must be, and more
            _let_tell(wrong, beyond, lambda: function(*arguments, **named))
        if wrong or beyond:
            raise ArgumentError("; ".join([*wrong.values(), *beyond]))
        result = function(*arguments, **named)
        _refuse_nan(given)  # where the function has not said better what a number must be
        return result

    return call


def _refuse_unknown(named: Iterable[str], signature: inspect.Signature) -> None:
    """Refuse arguments that there are not."""
    kinds = signature.parameters.values()
    known = [one.name for one in kinds if one.kind in (one.KEYWORD_ONLY, one.POSITIONAL_OR_KEYWORD)]
    known = [name for name in known if name != "self"]
    if any(one.kind is one.VAR_KEYWORD for one in kinds):
        return
    unknown = [name for name in named if name not in known]
    if unknown:
        hints = (guess(name, known) or listed(known) for name in unknown)
        said = (f"there is no argument {n}{hint}" for n, hint in zip(unknown, hints, strict=True))
        raise ArgumentError("\n".join(said))


def finite_at(name: str, of_time: Callable[[float], float]) -> Callable[[float], float]:
    """Return a function of time [s] that raises ValueError, by its name, where it is not finite."""

    def value(time: float) -> float:
        found = of_time(time)
        if not math.isfinite(found):
            raise ValueError(f"{name} must be finite, got {found} at t = {time:.6g} s")
        return found

    return value


def guess(name: str, names: Iterable[str]) -> str:
    """Return "; did you mean x?" for the most similar name in any case, "" if none is similar."""
    by_letters = {one.casefold(): one for one in names}
    close = difflib.get_close_matches(name.casefold(), by_letters, n=1, cutoff=0.65)
    return f"; did you mean {by_letters[close[0]]}?" if close else ""


def listed(names: Iterable[str]) -> str:
    """Return "; there are x, y, z"."""
    return f"; there are {', '.join(names)}"


def _let_tell(wrong: Iterable[str], beyond: list[str], call: Callable[[], object]) -> None:
    """Let a ValueError through that names all that is wrong, with what else there is to say."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            call()
    except ValueError as own:
        if all(name in str(own) for name in wrong):
            if beyond:
                raise ArgumentError("; ".join([str(own), *beyond])) from None
            raise
    except Exception:  # of what it does with arguments of another kind
        return


def _refuse_nan(given: Mapping[str, Any]) -> None:
    none = [name for name, value in given.items() if isinstance(value, float) and value != value]
    if none:
        raise ArgumentError("; ".join(f"{name} must be a number, got nan" for name in none))


def _kinds(function: Any, of: type | None) -> Iterator[tuple[str, Any]]:
    """Yield the annotations that can be looked up, by the names of the arguments."""
    scopes = [  # of fields, where they were written
        (inspect.get_annotations(base), vars(sys.modules[base.__module__]))
        for base in reversed(of.__mro__ if of else ())
    ]
    known = set()
    for written, names in [*scopes, (inspect.get_annotations(function), function.__globals__)]:
        for name, kind in written.items():
            try:
                yield name, eval(kind, names) if isinstance(kind, str) else kind
            except NameError:  # imported for annotations only
                if name not in known:
                    yield name, Any
            known.add(name)


def _fits(value: Any, kind: Any) -> bool:
    """Whether a value is what an annotation says."""
    origin, parts = get_origin(kind), get_args(kind)
    if kind is Any:
        return True
    if kind is None or kind is type(None):
        return value is None
    if _is_array_kind(kind):
        return _is_array(value)
    if origin in (Union, types.UnionType):
        return any(_fits(value, part) for part in _alternatives(kind))
    if kind is float or kind is int:
        return _is_number(value, Real if kind is float else Integral)
    if kind is bool:
        return isinstance(value, bool | np.bool_)
    if origin is Literal:
        return any(isinstance(value, type(part)) and value == part for part in parts)
    if origin is tuple or (isinstance(origin, type) and issubclass(origin, Iterable) and parts):
        return _is_several(value, origin, parts)
    if isinstance(origin, type):
        return isinstance(value, origin)
    if isinstance(kind, type):
        said = getattr(kind, "_is_runtime_protocol", not getattr(kind, "_is_protocol", False))
        return isinstance(value, kind) if said else True
    return True


def _is_number(value: Any, of: type) -> bool:
    if isinstance(value, np.ndarray) and value.ndim == 0 and not np.ma.isMaskedArray(value):
        value = value[()]
    return isinstance(value, of) and not isinstance(value, bool | np.bool_)


def _is_array(value: Any) -> bool:
    """Whether NumPy can take a value for an array of real numbers, without a word."""
    if np.ma.isMaskedArray(value):
        return not np.ma.is_masked(value) and _is_array(value.data)
    try:
        array = np.asarray(value)
    except (ValueError, TypeError):  # rows of several lengths
        return False
    return array.dtype.kind in "biuf" or array.size == 0


def _is_several(value: Any, origin: Any, parts: tuple[Any, ...]) -> bool:
    if issubclass(origin, Mapping):
        return isinstance(value, Mapping) and all(_fits(one, parts[-1]) for one in value.values())
    if isinstance(value, str | bytes | Mapping) or not isinstance(value, Iterable):
        return False
    if np.ma.is_masked(value):
        return False
    if not isinstance(value, list | tuple | np.ndarray):  # it may be used up by looking at it
        return True
    if origin is tuple and parts[-1] is not Ellipsis:
        return len(value) == len(parts) and all(map(_fits, value, parts))
    return all(_fits(one, parts[0]) for one in value)


def _is_array_kind(kind: Any) -> bool:
    arrays = (np.ndarray, npt.NDArray)  # from NumPy 2.5 on, NDArray is an alias of its own
    return get_origin(kind) in arrays or kind is np.ndarray or kind == npt.ArrayLike


def _alternatives(kind: Any) -> list[Any]:
    """Return the parts of a union; before NumPy 2.5, Python merges those of ArrayLike with them."""
    parts, of_array = get_args(kind), get_args(npt.ArrayLike)
    if not of_array or not set(of_array) <= set(parts):
        return list(parts)
    return [npt.ArrayLike, *(part for part in parts if part not in of_array)]


def _words(kind: Any) -> list[str]:
    """Return what an annotation says, in words."""
    origin, parts = get_origin(kind), get_args(kind)
    if _is_array_kind(kind):
        return [_ARRAY]
    if origin in (Union, types.UnionType):
        some = [part for part in _alternatives(kind) if part is not type(None)]
        return [word for part in some for word in _words(part)]
    if kind is None or kind is type(None):
        return ["None"]
    if origin is Literal:
        return [repr(part) for part in parts]
    if origin is tuple and parts[-1] is not Ellipsis:
        return [f"{len(parts)} {_several(parts[0]) if len(set(parts)) == 1 else 'values'}"]
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return [f"a mapping to {' or '.join(_words(parts[-1]))}"]
    if isinstance(origin, type) and issubclass(origin, Iterable):
        return [f"a sequence of {_several(parts[0])}"]
    if kind in _PLAIN:
        return [_PLAIN[kind]]
    name = str(getattr(origin or kind, "__name__", kind))
    article = "an" if name[0] in "AEIOU" else "a"
    if not getattr(kind, "_is_protocol", False):
        return [f"{article} {name}"]
    methods = [method for method in vars(kind) if method[0] != "_" or method == "__call__"]
    return [f"{article} {name}, which has {', '.join(methods)}"]


def _several(kind: Any) -> str:
    words = [re.sub("^an? ", "", word) for word in _words(kind)]
    plain = {"number": "numbers", "whole number": "whole numbers", "text": "texts"}
    return " or ".join(plain.get(word, re.sub("^array", "arrays", word)) for word in words)


def _shown(value: Any) -> str:
    if np.ma.isMaskedArray(value):
        return "a masked array: take filled() or compressed()"
    if isinstance(value, np.ndarray):
        return f"an array of {value.dtype} of shape {value.shape}"
    if isinstance(value, str):
        try:
            float(value)
        except ValueError:
            return f"{value!r:.{_SHOWN}}"
        return f"{value!r:.{_SHOWN}}: leave out the quotes"
    if value is None or isinstance(value, int | float | complex | tuple | list | dict):
        return f"{value!r:.{_SHOWN}}"
    return f"a {type(value).__name__}"

"""Arguments of public functions and classes: declared once, and checked by what is declared.

What an annotation says is required of every argument, before the function sees it: a text is no
number, a mesh no tool, a masked array no array. An :class:`Option` in it says the unit, the meaning
and the bounds; docstrings, model files and their page have them from there. :func:`fits` and
:meth:`Option.problem` judge a value, of an argument as of a key in a file. The message names all
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
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from numbers import Integral, Real
from typing import Annotated, Any, Literal, NamedTuple, TypeVar, Union, cast, get_args, get_origin

import numpy as np
import numpy.typing as npt

T = TypeVar("T")

_SHOWN = 60  # characters of a value


class ArgumentError(TypeError, ValueError):
    """Arguments are not what they must be.

    Attributes
    ----------
    problems : tuple of str
        What is wrong, a sentence each; the message has them all.
    """

    def __init__(self, problems: Sequence[str]) -> None:
        self.problems = tuple(problems)
        super().__init__("; ".join(self.problems))


# --- what is declared ----------------------------------------------------------------------------


@dataclass(frozen=True)
class Option:
    """What is declared of an argument beside its type and its default.

    It is part of the annotation of a parameter or a field, besides type and default.

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
        if self.least is not None and self.most is not None:
            return f"from {_figure(self.least)} to {_figure(self.most)}"
        forms = (
            (self.above, "above {}"),
            (self.below, "below {}"),
            (self.least, "{} or more"),
            (self.most, "{} at most"),
        )
        words = [form.format(_figure(bound)) for bound, form in forms if bound is not None]
        return " and ".join("positive" if word == "above 0" else word for word in words)

    def problem(self, value: Any) -> str:
        """Return why a number is out of bounds, or not finite; "" if it is neither."""
        beyond = (
            (self.above is not None and not value > self.above)
            or (self.least is not None and not value >= self.least)
            or (self.below is not None and not value < self.below)
            or (self.most is not None and not value <= self.most)
        )
        finite = isinstance(value, Integral) or math.isfinite(value)
        if finite and not beyond:
            return ""
        wanted = [self.bounds] if self.bounds else []
        if not finite and (not wanted or not math.isnan(value)):
            wanted.append("finite")
        why = f" ({self.why})" if self.why else ""
        unit = f" {self.unit}" if self.unit else ""
        return f"must be {' and '.join(wanted)}{why}, got {_shown(value)}{unit}"


def _figure(bound: float) -> str:
    return f"{bound:,}" if isinstance(bound, int) else f"{bound:g}"


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
    kinds = _kinds_of(function)
    found = {}
    for name, parameter in inspect.signature(function).parameters.items():
        kind, option = kinds.get(name, (Any, None))
        if option is not None:
            found[name] = Declared(kind, option, parameter.default)
    return found


def _kinds_of(what: Callable[..., Any]) -> dict[str, tuple[Any, Option | None]]:
    """Return type and :class:`Option` of each annotation of a function, or of a class.

    Fields may stand in a class that it is made of, in another module. Modules keep annotations as
    text, which is evaluated here. What only type checkers import may be anything: Any.
    """
    written: list[tuple[Mapping[str, Any], dict[str, Any]]] = []
    function: Any = what
    if isinstance(what, type):
        for base in reversed(what.__mro__):
            written.append((inspect.get_annotations(base), vars(sys.modules[base.__module__])))
        function = what.__init__  # type: ignore[misc]
    function = inspect.unwrap(function)
    if hasattr(function, "__globals__"):  # unlike object.__init__
        written.append((inspect.get_annotations(function), function.__globals__))
    found: dict[str, tuple[Any, Option | None]] = {}
    for texts, names in written:
        for name, text in texts.items():
            try:
                kind = eval(text, names) if isinstance(text, str) else text
            except NameError:
                found.setdefault(name, (Any, None))
                continue
            option = None
            if get_origin(kind) is Annotated:
                kind, *more = get_args(kind)
                option = next((note for note in more if isinstance(note, Option)), None)
            found[name] = (kind, option)
    return found


# --- checked calls -------------------------------------------------------------------------------


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
    call: Any = what
    if isinstance(what, type):
        what.__init__ = _checked_call(what.__init__, what)  # type: ignore[misc]
    else:
        call = _checked_call(what, what)
    call.__doc__ = _with_parameters(call.__doc__ or "", what)
    return cast("T", call)


def _checked_call(function: Any, annotated: Any) -> Any:
    signature = inspect.signature(function)

    @functools.cache
    def kinds() -> dict[str, tuple[_Kind, Option | None]]:  # of what may be defined further below
        return {
            name: (_kind(kind), option) for name, (kind, option) in _kinds_of(annotated).items()
        }

    @functools.wraps(function)
    def call(*arguments: Any, **named: Any) -> Any:
        try:
            given = signature.bind(*arguments, **named).arguments
        except TypeError:
            _refuse_unknown(named, signature)
            return function(*arguments, **named)  # Python says what is missing or twice
        wrong, beyond, nan = [], [], []
        for name, value in given.items():
            kind, option = kinds().get(name, (_ANYTHING, None))
            if not kind.fits(value):
                wrong.append(f"{name} must be {_wanted(kind, option)}, got {_shown(value)}")
            elif option is not None and is_number(value):
                if problem := option.problem(value):
                    beyond.append(f"{name} {problem}")
            elif isinstance(value, float) and math.isnan(value):
                nan.append(f"{name} must be a number, got nan")
        if wrong or beyond:
            raise ArgumentError([*wrong, *beyond])
        result = function(*arguments, **named)
        if nan:  # and the function has not said better what they must be
            raise ArgumentError(nan)
        return result

    return call


def _refuse_unknown(named: Iterable[str], signature: inspect.Signature) -> None:
    """Refuse arguments that there are not, by name."""
    kinds = signature.parameters.values()
    known = [p.name for p in kinds if p.kind in (p.KEYWORD_ONLY, p.POSITIONAL_OR_KEYWORD)]
    known = [name for name in known if name != "self"]
    unknown = [name for name in named if name not in known]
    if unknown and not any(p.kind is p.VAR_KEYWORD for p in kinds):
        raise ArgumentError(
            [f"there is no argument {n}{guess(n, known) or listed(known)}" for n in unknown]
        )


def _with_parameters(doc: str, what: Any) -> str:
    """Return a docstring with the arguments that have an :class:`Option` under "Parameters"."""
    entries = ""
    for name, (kind, option) in _kinds_of(what).items():
        if option is not None:
            words = " or ".join(re.sub("^an? ", "", word) for word in _kind(kind).words)
            unit = f" [{option.unit}]" if option.unit else ""
            unset = f"by default {option.unset}" if option.unset else ""
            entry = "; ".join(filter(None, (option.text, option.bounds, unset)))
            entries += f"{name} : {words}{unit}\n    {entry}.\n"
    if not entries or not doc:
        return doc
    text, heading = inspect.cleandoc(doc), "Parameters\n----------\n"
    if heading not in text:
        others = re.search(r"\n\w+\n---+\n", text)
        at = others.start() if others else len(text)
        text = f"{text[:at].rstrip()}\n\n{heading}\n{text[at:].lstrip()}"
    return text.replace(heading, heading + entries, 1)


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
    by_letters = {name.casefold(): name for name in names}
    close = difflib.get_close_matches(name.casefold(), by_letters, n=1, cutoff=0.65)
    return f"; did you mean {by_letters[close[0]]}?" if close else ""


def listed(names: Iterable[str]) -> str:
    """Return "; there are x, y, z"."""
    return f"; there are {', '.join(names)}"


# --- the judge of a value ------------------------------------------------------------------------


def fits(value: Any, kind: Any) -> bool:
    """Whether a value is what an annotation says.

    Examples
    --------
    >>> fits(2, float), fits("2", float), fits((1, 2.5), tuple[float, ...]), fits(None, int | None)
    (True, False, True, True)
    """
    return _kind(kind).fits(value)


def _wanted(kind: _Kind, option: Option | None) -> str:
    """Return what an argument must be, in words."""
    if option is not None and option.form.endswith("numbers"):
        return option.form  # says how many
    return " or ".join(kind.words)


class _Kind(NamedTuple):
    """What an annotation says: in words, and of a value."""

    words: tuple[str, ...]
    fits: Callable[[Any], bool]


_ANYTHING = _Kind(("anything",), lambda value: True)
_PLAIN: dict[Any, _Kind] = {
    Any: _ANYTHING,
    **dict.fromkeys((None, types.NoneType), _Kind(("None",), lambda value: value is None)),
    float: _Kind(("a number",), lambda value: is_number(value)),
    int: _Kind(("a whole number",), lambda value: is_number(value, Integral)),
    bool: _Kind(("True or False",), lambda value: isinstance(value, bool | np.bool_)),
    str: _Kind(("a text",), lambda value: isinstance(value, str)),
}


def _kind(annotation: Any) -> _Kind:
    origin, parts = get_origin(annotation), get_args(annotation)
    if annotation in _PLAIN:
        return _PLAIN[annotation]
    # from NumPy 2.5 on, NDArray is an alias of its own
    if origin in (np.ndarray, npt.NDArray) or annotation in (np.ndarray, npt.ArrayLike):
        return _Kind(("an array of real numbers",), _is_array)
    if origin in (Union, types.UnionType):
        some = [_kind(part) for part in _alternatives(annotation)]
        words = [word for kind in some for word in kind.words if word != "None"]
        return _Kind(tuple(words), lambda value: any(kind.fits(value) for kind in some))
    if origin is Literal:
        return _Kind(
            tuple(repr(part) for part in parts),
            lambda value: any(isinstance(value, type(part)) and value == part for part in parts),
        )
    if isinstance(origin, type) and issubclass(origin, Mapping) and parts:
        return _kind_of_mapping(*parts)
    if isinstance(origin, type) and issubclass(origin, Iterable) and parts:
        return _kind_of_several(parts, is_counted=origin is tuple and parts[-1] is not Ellipsis)
    return _kind_of_class(origin or annotation)


def _kind_of_mapping(of_key: Any, of_value: Any) -> _Kind:
    """Return the kind of a mapping; what functions in it must be, whoever takes them says."""
    key, item = _kind(of_key), _kind(of_value)
    is_of_functions = get_origin(of_value) is Callable

    def fits(value: Any) -> bool:
        if not isinstance(value, Mapping) or not all(map(key.fits, value)):
            return False
        return is_of_functions or all(map(item.fits, value.values()))

    return _Kind((f"a mapping to {' or '.join(item.words)}",), fits)


def _kind_of_several(parts: tuple[Any, ...], *, is_counted: bool) -> _Kind:
    """Return the kind of a sequence, or of a tuple with a number of parts."""
    each = [_kind(part) for part in parts if part is not Ellipsis]
    words = [re.sub("^an? ", "", word) for word in each[0].words]
    plural = {"number": "numbers", "whole number": "whole numbers", "text": "texts"}
    several = " or ".join(plural.get(word, re.sub("^array", "arrays", word)) for word in words)

    def fits(value: Any) -> bool:
        single = isinstance(value, str | bytes | Mapping) or not isinstance(value, Iterable)
        if single or np.ma.is_masked(value):
            return False
        if not isinstance(value, list | tuple | np.ndarray):
            return True  # it may be used up by looking at it
        if is_counted:
            return len(value) == len(each) and all(
                kind.fits(item) for kind, item in zip(each, value, strict=True)
            )
        return all(map(each[0].fits, value))

    if not is_counted:
        return _Kind((f"a sequence of {several}",), fits)
    return _Kind((f"{len(parts)} {several if len(set(parts)) == 1 else 'values'}",), fits)


def _kind_of_class(of: Any) -> _Kind:
    """Return the kind of a class; a value shows by ``isinstance`` whether it is of most."""
    name = str(getattr(of, "__name__", of))
    words = f"{'an' if name[0] in 'AEIOU' else 'a'} {name}"
    shows = isinstance(of, type)
    if getattr(of, "_is_protocol", False):
        methods = [method for method in vars(of) if method[0] != "_" or method == "__call__"]
        words += f", which has {', '.join(methods)}"
        shows = getattr(of, "_is_runtime_protocol", False)
    return _Kind((words,), lambda value: not shows or isinstance(value, of))


def is_number(value: Any, of: type = Real) -> bool:
    """Whether a value is a number, and neither True nor False."""
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


def _alternatives(kind: Any) -> list[Any]:
    """Return the parts of a union; before NumPy 2.5, Python merges those of ArrayLike with them."""
    parts, of_array = get_args(kind), get_args(npt.ArrayLike)
    if not of_array or not set(of_array) <= set(parts):
        return list(parts)
    return [npt.ArrayLike, *(part for part in parts if part not in of_array)]


def _shown(value: Any) -> str:
    match value:
        case np.ma.MaskedArray():
            return "a masked array: take filled() or compressed()"
        case np.ndarray():
            return f"an array of {value.dtype} of shape {value.shape}"
        case str():
            try:
                float(value)
            except ValueError:
                return f"{value!r:.{_SHOWN}}"
            return f"{value!r:.{_SHOWN}}: leave out the quotes"
        case None | int() | float() | complex() | tuple() | list() | dict():
            return f"{value!r:.{_SHOWN}}"
    return f"a {type(value).__name__}"

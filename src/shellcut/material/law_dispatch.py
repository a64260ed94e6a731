"""How kernels call the laws of a film: one function for all laws, compiled for those in use.

Kernels that need laws take them as a tuple, and the Numba *type* of a law contains the law's name
and a digest of its sources and of the values that these read. A kernel is compiled once for each
combination of laws, with the laws' functions inlined, and Numba caches it under these types, also
for user-written laws. A law that is edited, or reads another number, has another type, so no kernel
runs with an old version. Kernels without laws are compiled once.
"""

# Numba's extension calls are typed for users of intrinsics, not for their authors.
# mypy: disable-error-code="arg-type, no-untyped-call"

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Annotated, Any, NamedTuple

from llvmlite import ir
from numba import types
from numba.extending import NativeValue, models, overload, register_model, typeof_impl, unbox

from shellcut.arrays import Floats, Ints, Number, Vector
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.intrinsics import in_kernels
from shellcut.numerics.jit import ALWAYS_INLINED, always_inline
from shellcut.numerics.lane_functions import any_above
from shellcut.numerics.lane_instructions import Lane
from shellcut.numerics.lanes import pick, pick_all, put_all, repeated, zero

from .point_law import LAWS, PointLaw, register


def _compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    return function if hasattr(function, "py_func") else always_inline(function)


class PointLaws(NamedTuple):
    """The laws of the points through the thickness, the same for all quads."""

    laws: tuple[PointLaw, ...]
    """Distinct laws of the layers."""
    kind: Annotated[Ints, "(n_point,)"]
    """Index of each point's law."""
    parameters: Annotated[Floats, "(n_point, n_parameter)"]
    """Parameters of each point's law, rows padded with zeros."""


class HistoryStep(NamedTuple):
    """Where the history of a block of quads is read and written, and the length of the step."""

    old: Annotated[Floats, "(n_block, n, width)"]
    """At t_{n-1}."""
    new: Annotated[Floats, "(n_new, n, width)"] | None
    """At t_n; None if ``old`` is updated in its place."""
    block: int
    """Block that is read."""
    new_block: int
    """Block that is written."""
    dt: float
    """Length of the step [s]."""


def point_stress(
    laws: PointLaws, k: int, strain: Vector, history: HistoryStep, first: int, lane: Lane
) -> tuple[Vector, Number, Number]:
    """Return stress [MPa], stored and dissipated energy density of the step [N/mm²] at point ``k``.

    Its history numbers start at ``first``.
    """
    raise NotImplementedError  # of each law, in kernels


def point_thickness(
    laws: PointLaws, k: int, strain: Vector, history: HistoryStep, first: int, lane: Lane
) -> Number:
    """Return the thickness stretch at point ``k``, with the old history."""
    raise NotImplementedError  # of each law, in kernels


# ---------------------------------------------------------------- Numba's type of a law


class LawType(types.Opaque):
    """The Numba type of a law, different for each law and each version of its source."""

    def __init__(self, law: str, digest: str) -> None:
        self.law = law
        super().__init__(name=f"PointLaw({law} {digest})")


register_model(LawType)(models.OpaqueModel)


@typeof_impl.register(PointLaw)
def _type_of_law(value: PointLaw, context: Any) -> Any:
    register(value)  # kernels find it by its name
    digest = value.digest
    if _DIGESTS.setdefault(value, digest) != digest:
        raise ValueError(
            f"the functions of the law {value.name!r} read another value than when it was used "
            "first in this process, and compiled functions keep the first one: make functions and "
            "a law of another name for it, or pass the number by parameters() of the material"
        )
    return LawType(value.name, digest)


_DIGESTS: dict[PointLaw, str] = {}
"""Digests of all laws, at their first use in this process."""


@unbox(LawType)
def _unbox_law(kind: Any, value: Any, context: Any) -> Any:
    return NativeValue(context.context.get_dummy_value())


def _laws_of(laws: Any) -> list[PointLaw]:
    return [LAWS[law.law] for law in laws.types[0].types]


def chosen_by_laws(linear: Callable[..., Any], other: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function of laws and further arguments that calls one of two with the latter.

    The first if all laws are linear, which take a few operations each.
    """

    def run(laws, *arguments):
        return linear(*arguments)

    @overload(run, jit_options=ALWAYS_INLINED)
    def _run_in_kernel(laws, *arguments):
        function = linear if all(law.linear for law in _laws_of(laws)) else other
        return lambda laws, *arguments: function(*arguments)

    return run


@always_inline
def borrowed_history(history: HistoryStep) -> HistoryStep:
    """Return a history step whose tables are :func:`~shellcut.numerics.borrowed.borrowed`."""
    return HistoryStep(
        borrowed(history.old),
        borrowed(history.new),
        history.block,
        history.new_block,
        history.dt,
    )


def _known_to_kernels(question: Callable[[PointLaws], bool]) -> Callable[[PointLaws], bool]:
    """Answer a question about laws when a kernel is compiled."""

    @in_kernels(question)
    def _in_kernel(laws: Any) -> Any:
        answer = ir.Constant(ir.IntType(1), question(_Named(_laws_of(laws))))
        return types.boolean(laws), lambda context, builder, given: answer

    return question


class _Named(NamedTuple):
    laws: list[PointLaw]


@_known_to_kernels
def dissipates(laws: PointLaws) -> bool:
    """Whether any law has a history; without a history, no dissipation is summed."""
    return any(law.history for law in laws.laws)


@_known_to_kernels
def has_axes(laws: PointLaws) -> bool:
    """Whether strains must be turned into the film's axes for any law."""
    return any(law.oriented for law in laws.laws)


def _in_kernels(of_any: Callable[..., Any], of_one: Callable[[PointLaw], Any]) -> None:
    """Compile a function of a point of any law into kernels, from that of each law."""

    @overload(of_any, jit_options=ALWAYS_INLINED)
    def _in_kernel(laws, k, strain, history, first, lane):
        function = _one_of(tuple(map(of_one, _laws_of(laws))))

        def call(laws, k, strain, history, first, lane):
            return function(laws.kind[k], laws.parameters[k], strain, history, first, lane)

        return call


@functools.cache
def _one_of(functions: tuple[Any, ...]) -> Any:
    """Return a function that calls the ``kind``-th of several functions with the same arguments."""
    if not functions:
        return _no_law
    function, others = functions[0], functions[1:]
    if not others:

        @always_inline
        def only(kind, p, strain, history, first, lane):
            return function(p, strain, history, first, lane)

        return only
    further = _one_of(others)

    @always_inline
    def one(kind, p, strain, history, first, lane):
        if kind == 0:
            return function(p, strain, history, first, lane)
        return further(kind - 1, p, strain, history, first, lane)

    return one


@always_inline
def _no_law(kind, p, strain, history, first, lane):
    none = zero(lane)
    return (none, none, none), none, none


@functools.cache
def _stress_function(law: PointLaw) -> Any:
    """Wrap a law's stress as a function that reads and writes the history of a block."""
    function, read = _compiled(law.stress), _history_reader(law)

    @always_inline
    def stress(p, strain, history, first, lane):
        before = read(history.old, history.block, first, lane)
        done = function(p, strain, before, history.dt)
        _store(history, first, lane, done)
        # A law may dissipate a plain zero; of several laws all must return lanes.
        return done[0], done[1], zero(lane) + done[2]

    return stress


def _store(history, first, lane, done):
    """Store the numbers of history that a law has returned.

    In their place only if the law says that they have changed, or does not say.
    """
    raise NotImplementedError  # in kernels


@overload(_store, jit_options=ALWAYS_INLINED)
def _store_in_kernel(history, first, lane, done):
    if not len(done[3]):
        return lambda history, first, lane, done: None
    if not isinstance(history.types[1], types.NoneType):
        return lambda history, first, lane, done: put_all(
            history.new, history.new_block, first, lane, done[3]
        )
    if len(done) < 5:
        return lambda history, first, lane, done: put_all(
            history.old, history.block, first, lane, done[3]
        )

    def where_changed(history, first, lane, done):
        if done[4]:
            put_all(history.old, history.block, first, lane, done[3])

    return where_changed


@functools.cache
def _thickness_function(law: PointLaw) -> Any:
    function, read = _compiled(law.thickness_stretch), _history_reader(law)

    @always_inline
    def thickness(p, strain, history, first, lane):
        return function(p, strain, read(history.old, history.block, first, lane))

    return thickness


@functools.cache
def _history_reader(law: PointLaw) -> Any:
    """Return a function that reads the history of a point of a block as a tuple."""
    n = len(law.history)
    if n == 0:
        return always_inline(lambda table, b, first, lane: ())

    @always_inline
    def read_all(table, b, first, lane):
        return pick_all(table, b, first, n, lane)

    if not law.first_leads:
        return read_all

    @always_inline
    def read(table, b, first, lane):
        lead = pick(table, b, first, lane)
        if any_above(lead, 0.0):
            return pick_all(table, b, first, n, lane)
        return repeated(lead, n)  # all are zero

    return read


_in_kernels(point_stress, _stress_function)
_in_kernels(point_thickness, _thickness_function)

"""Numbers on the film that can colour it, by name: stresses, thickness, displacement, history."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from shellcut.arrays import Floats, norm
from shellcut.frame import Frame, is_corner
from shellcut.unit import shown

_SHARE = 0.98  # of the quads or nodes that a colour scale encloses: tips have a stress of their own


@dataclass(frozen=True)
class Field:
    """One number for every quad or every node of the film."""

    name: str
    label: str
    """The name as a reader wants it, without its unit."""
    unit: str
    of: str
    """``"quad"`` or ``"node"``."""
    values: Callable[[Frame], Floats]
    """From a frame to the numbers, shape (n_quad,) or (n_node,), in ``unit``."""
    sign: int = 0
    """1 if a colour scale begins at zero, -1 if it ends there, 0 if it goes where the numbers
    are."""


def _von_mises(frame: Frame) -> Floats:
    a, b = frame.quad_principal[:, 0], frame.quad_principal[:, 1]
    return np.asarray(np.sqrt(a * a - a * b + b * b))


def _stress(name: str, values: Callable[[Frame], Floats], sign: int = 1) -> Field:
    which, comma, face = name.partition(",")
    return Field(name, f"{which} stress{comma}{face}", "MPa", "quad", values, sign)


_OF_ALL = (
    _stress("largest principal", lambda frame: frame.quad_principal[:, 0]),
    _stress("smallest principal", lambda frame: frame.quad_principal[:, 1], -1),
    _stress("von Mises", _von_mises),
    _stress("largest principal, top", lambda frame: frame.quad_principal_top[:, 0]),
    _stress("largest principal, bottom", lambda frame: frame.quad_principal_bottom[:, 0]),
    Field("thickness", "thickness", "mm", "quad", lambda frame: frame.quad_thickness),
    Field("displacement", "displacement", "mm", "node", lambda f: norm(f.displacement), 1),
    Field("displacement z", "displacement in z", "mm", "node", lambda f: f.displacement[:, 2]),
    Field("speed", "speed", "mm/s", "node", lambda frame: norm(frame.velocity), 1),
)
"""Those of every film; a stress is the mean over the thickness unless a face is named."""

FIELDS = tuple(field.name for field in _OF_ALL)
"""Their names."""


def fields_of(frame: Frame) -> dict[str, Field]:
    """Return the fields of a frame, those of its material too, by name, in the units shown.

    Examples
    --------
    >>> from shellcut.view.fields import _OF_ALL
    >>> [f"{field.label} [{field.unit}]" for field in _OF_ALL][:2]
    ['largest principal stress [MPa]', 'smallest principal stress [MPa]']
    """
    found = {field.name: field for field in _OF_ALL}
    for key in frame.quad_history:
        name, _, unit = key.removesuffix("]").partition(" [")
        found[name] = Field(name, name, unit, "quad", partial(_history, key))
    return {name: _shown(field) for name, field in found.items()}


def _history(key: str, frame: Frame) -> Floats:
    return frame.quad_history[key]


def _shown(field: Field) -> Field:
    unit, factor = shown(field.unit)
    return replace(field, unit=unit, values=lambda frame: factor * field.values(frame))


def at_corners(field: Field, frame: Frame, smooth: bool) -> Floats:
    """Return a field's numbers at the corners of the quads, of the shape of ``frame.quads``.

    smooth : let a node have one number, the mean of its quads; otherwise each quad has one. The
    two flanks of a crack have nodes of their own, so nothing is averaged across it.
    """
    values, own = field.values(frame), is_corner(frame.quads)
    if field.of == "quad":
        values = np.repeat(values[:, None], frame.quads.shape[1], axis=1)
        if not smooth:
            return values
        nodes, n = frame.quads[own], len(frame.points)
        share = np.bincount(nodes, minlength=n).clip(1)
        values = np.bincount(nodes, weights=values[own], minlength=n) / share
    values = values[frame.quads]
    if smooth:
        return values
    mean = (values * own).sum(axis=1) / own.sum(axis=1)
    return np.repeat(mean[:, None], values.shape[1], axis=1)


def field_limits(arrays: Sequence[Floats], sign: int = 0) -> tuple[float, float]:
    """Return round limits of a colour scale that enclose nearly all numbers of all frames.

    Few quads at a crack tip would otherwise darken the rest. ``sign`` is that of :class:`Field`:
    with 0 the scale includes zero unless the numbers lie far from it.

    Examples
    --------
    >>> import numpy as np
    >>> field_limits([np.linspace(-20.0, 38.2, 100)], 1), field_limits([np.linspace(-2.0, 0.3)])
    ((0.0, 40.0), (-2.0, 0.5))
    >>> field_limits([np.linspace(0.0712, 0.0740, 100)])
    (0.071, 0.074)
    >>> field_limits([np.zeros(3)])
    (0.0, 1.0)
    """
    values = np.concatenate(arrays)
    if not len(values):
        return 0.0, 1.0
    if sign:
        high, end = float(np.quantile(sign * values, _SHARE)), 1.0
        if high > 0.0:
            unit = 10.0 ** np.floor(np.log10(high))
            end = float(np.ceil(2.0 * high / unit) / 2.0 * unit)
        return (0.0, end) if sign > 0 else (-end, 0.0)
    low, high = np.quantile(values, (1.0 - _SHARE, _SHARE)).tolist()
    if low * high <= 0.0 or min(abs(low), abs(high)) <= high - low:
        low, high = min(low, 0.0), max(high, 0.0)
    if high - low <= 1e-9 * max(abs(low), abs(high)):
        low, high = min(low, 0.0), max(high, 0.0)
    if low == high:
        return 0.0, 1.0
    step = 10.0 ** np.floor(np.log10(high - low)) / 2.0
    # The quotients are rounded first, so that 0.3 / 0.1 stays 3.
    first, last = np.floor(round(low / step, 6)), np.ceil(round(high / step, 6))
    return float(f"{first * step:.6g}") + 0.0, float(f"{last * step:.6g}") + 0.0

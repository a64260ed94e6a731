"""How pictures, movies and the page to turn show a run: field, colours, light, camera, parts.

A *field* is what can colour the film: stresses, thickness, displacement, history numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated, Literal, get_args

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats, norm
from shellcut.files.distribution import optional
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
    >>> from shellcut.view.look import _OF_ALL
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
    nearer, farther = sorted((abs(low), abs(high)))
    if low * high <= 0.0 or nearer <= high - low or high - low <= 1e-9 * farther:
        low, high = min(low, 0.0), max(high, 0.0)
    if low == high:
        return 0.0, 1.0
    step = 10.0 ** np.floor(np.log10(high - low)) / 2.0
    # The quotients are rounded first, so that 0.3 / 0.1 stays 3.
    first, last = np.floor(round(low / step, 6)), np.ceil(round(high / step, 6))
    return float(f"{first * step:.6g}") + 0.0, float(f"{last * step:.6g}") + 0.0


_DEFAULT = "viridis"
_VIRIDIS = (
    "440154481769472a7a433d843d4e8a355e8d2e6d8e297b8e23898e"
    "1f978b21a5852eb37c46c06f65cb5e89d548b0dd2fd8e219fde725"
)  # Matplotlib's (van der Walt and Smith, CC0) at 18 even places


Part = Literal["film", "mesh", "flanks", "cables", "edges", "tool"]
"""What a look can hide."""
PARTS: tuple[Part, ...] = get_args(Part)


@checked
@dataclass(frozen=True, kw_only=True)
class Look:
    """How pictures, movies and the page to turn show a run."""

    field: Annotated[
        str,
        Option("", f"what colours the film: {', '.join(FIELDS)}, or a number of the material"),
    ] = "largest principal"
    low: Annotated[
        float | None,
        Option("", "lower end of the colour scale", unset="from the frames"),
    ] = None
    high: Annotated[float | None, Option("", "upper end", unset="from the frames")] = None
    colormap: Annotated[
        str, Option("", "colours, any map of Matplotlib: cividis, inferno, turbo, coolwarm, ...")
    ] = _DEFAULT
    flat: Annotated[bool, Option("", "one colour for each quad, not smooth from node to node")] = (
        False
    )
    hide: Annotated[Sequence[Part], Option("", f"parts not to show: {', '.join(PARTS)}")] = ()
    elevation: Annotated[
        float, Option("deg", "of the camera above the x-y plane", least=-90, most=90)
    ] = 42.0
    azimuth: Annotated[
        float, Option("deg", "of the camera from the x axis", least=-360, most=360)
    ] = -60.0
    zoom: Annotated[float, Option("", "1 shows all of film and tool", above=0, most=100)] = 1.0

    def shows(self, part: str) -> bool:
        """Return whether a part is not hidden."""
        return part not in self.hide

    def field_of(self, frame: Frame) -> Field:
        """Return what colours the film."""
        known = fields_of(frame)
        if self.field not in known:
            raise ValueError(f"field must be one of {'; '.join(known)}; got {self.field!r}")
        return known[self.field]

    def limits_for(self, values: Sequence[Floats], sign: int) -> tuple[float, float]:
        """Return the ends of the colour scale of a field, ``sign`` as in :class:`Field`."""
        low, high = field_limits(values, sign)
        low = low if self.low is None else self.low
        high = high if self.high is None else self.high
        if not low < high:
            raise ValueError(f"low must be below high, got {low:g} and {high:g}")
        return low, high

    def colors(self, n: int = 256) -> Floats:
        """Return the colours of the scale from its lower to its upper end, shape (n, 3), [-].

        Some maps take Matplotlib.
        """
        if self.colormap == _DEFAULT:
            stops = np.frombuffer(bytes.fromhex(_VIRIDIS), np.uint8).reshape(-1, 3) / 255.0
            at = np.linspace(0.0, len(stops) - 1.0, n)
            rgb = [np.interp(at, np.arange(len(stops)), column) for column in stops.T]
            return np.stack(rgb, axis=1)
        needed = f"the colour map {self.colormap!r} needs Matplotlib, which is not installed"
        instead = f"; {_DEFAULT!r} does not"
        colormaps = optional("matplotlib", needed, "plot", instead=instead).colormaps
        if self.colormap not in colormaps:
            raise ValueError(
                f"colormap must be one of Matplotlib's, such as {_DEFAULT}, cividis, inferno, "
                f"turbo or coolwarm, got {self.colormap!r}"
            )
        return np.asarray(colormaps[self.colormap](np.linspace(0.0, 1.0, n))[:, :3])

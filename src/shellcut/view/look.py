"""How pictures, movies and the page to turn show a run: field, colours, light, camera, parts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal, get_args

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats
from shellcut.files.distribution import optional
from shellcut.frame import Frame

from .fields import FIELDS, Field, field_limits, fields_of

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

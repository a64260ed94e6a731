"""How pictures, movies and the page to turn show a run: field, colours, light, camera, parts."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from shellcut.arrays import Floats
from shellcut.frame import Frame

from .fields import Field, chosen_fields, field_limits

PARTS = ("film", "mesh", "flanks", "cables", "edges", "tool")
"""What a look can hide."""

_DEFAULT = "viridis"
_VIRIDIS = (
    "440154 481769 472a7a 433d84 3d4e8a 355e8d 2e6d8e 297b8e 23898e 1f978b 21a585 2eb37c 46c06f "
    "65cb5e 89d548 b0dd2f d8e219 fde725"
)  # Matplotlib's (van der Walt and Smith, CC0) at 18 even places


@dataclass(frozen=True, kw_only=True)
class Look:
    """How a run is shown.

    Raises
    ------
    ValueError
        If a part, the scale or the camera cannot be; what cannot is told all at once.
    """

    field: str = "largest principal"
    """What colours the film, a name of :func:`shellcut.view.fields.fields_of`."""
    limits: tuple[float, float] | None = None
    """Of the colour scale, in the unit of the field; by default round numbers around nearly all."""
    colormap: str = _DEFAULT
    """Name of a colour map of Matplotlib; for others than the default it must be installed."""
    smooth: bool = True
    """Whether colours run from node to node, each the mean of its quads, or each quad has one."""
    hide: Collection[str] = ()
    """Some of :data:`PARTS`."""
    camera: tuple[float, float, float] = (42.0, -60.0, 1.0)
    """Elevation above the x-y plane and azimuth from the x axis [deg], and zoom."""

    def __post_init__(self) -> None:
        problems = []
        unknown = ", ".join(sorted(set(self.hide) - set(PARTS)))
        if unknown:
            problems.append(f"hide takes {', '.join(PARTS)}, got {unknown}")
        if self.limits is not None and not self.limits[0] < self.limits[1]:
            problems.append(f"limits must rise and be finite, got {self.limits}")
        elevation, azimuth, zoom = self.camera
        if not (abs(elevation) <= 90.0 and abs(azimuth) <= 360.0 and 0.01 <= zoom <= 100.0):
            problems.append(
                "camera must be an elevation up to 90°, an azimuth up to 360° and a zoom from "
                f"0.01 to 100, got {elevation}, {azimuth}, {zoom}"
            )
        if problems:
            raise ValueError("; ".join(problems))

    def shows(self, part: str) -> bool:
        """Return whether a part is not hidden."""
        return part not in self.hide

    def field_of(self, frame: Frame) -> Field:
        """Return what colours the film.

        Raises
        ------
        ValueError
            If the frame has no such field.
        """
        return chosen_fields(frame, [self.field])[0]

    def limits_for(self, seen: Sequence[Frame]) -> tuple[float, float]:
        """Return the ends of the colour scale of some frames."""
        field = self.field_of(seen[-1])
        return self.limits or field_limits([field.values(frame) for frame in seen], field.sign)

    def colors(self, n: int = 256) -> Floats:
        """Return the colours of the scale from its lower to its upper end, shape (n, 3), [-].

        Raises
        ------
        ValueError
            If there is no such colour map.
        ImportError
            If it takes Matplotlib, which is not installed.
        """
        if self.colormap == _DEFAULT:
            stops = np.array([list(bytes.fromhex(stop)) for stop in _VIRIDIS.split()]) / 255.0
            at = np.linspace(0.0, len(stops) - 1.0, n)
            rgb = [np.interp(at, np.arange(len(stops)), column) for column in stops.T]
            return np.stack(rgb, axis=1)
        return _of_matplotlib(self.colormap, n)


def _of_matplotlib(name: str, n: int) -> Floats:
    try:
        from matplotlib import colormaps
    except ImportError as error:
        raise ImportError(
            f"the colour map {name!r} needs Matplotlib, which is not installed: pip install "
            f"shellcut[plot]; {_DEFAULT!r} does not"
        ) from error
    if name not in colormaps:
        raise ValueError(
            f"colormap must be one of Matplotlib's, such as {_DEFAULT}, cividis, inferno, turbo "
            f"or coolwarm, got {name!r}"
        )
    return np.asarray(colormaps[name](np.linspace(0.0, 1.0, n))[:, :3])

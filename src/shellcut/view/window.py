"""A window, by PyVista, in which a person turns a run, moves through its frames, reads values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from shellcut.arrays import Floats
from shellcut.frame import Frame, is_corner

from ._panel import stress_scale, title_of, whole_camera
from ._stage import Actors
from .fields import Field, chosen_fields, field_limits
from .renderer import quiet_vtk

_N_LOOKED_AT = 12  # frames from which colour scale and camera follow
_VIEW = (42.0, -60.0)  # elevation and azimuth of the camera at the start [deg]
_MARK = (0.75, 0.0, 0.75)
_KEYS = "n: next field    left, right: frame    click: value    r: reset    q: quit"


class FrameSource(Protocol):
    """What has frames: the results of a run."""

    @property
    def n_frame(self) -> int:
        """Number of frames."""

    def frame(self, k: int) -> Frame:
        """Return frame ``k``."""


@dataclass(frozen=True)
class Reading:
    """A value read from the film."""

    quad: int
    node: int
    """The node of the quad nearest to the place."""
    place: Floats
    """Present position of the node, shape (3,), [mm]."""
    value: float
    """Of the quad or of the node, whichever the field has."""
    field: Field

    def __str__(self) -> str:
        place = ", ".join(f"{number:.5g}" for number in self.place)
        return (
            f"quad {self.quad}, node {self.node} at ({place}) mm: "
            f"{self.field.label} {self.value:.5g} {self.field.unit}"
        )


class Window:
    """The frames of a run in a window; :meth:`show` opens it and waits until it is closed.

    The slider, or the keys left and right, choose the frame; ``n`` takes the next field; a click
    reads the value at a place of the film.

    Parameters
    ----------
    source : FrameSource
        Where the frames come from, one at a time.
    field : str
        Name of the field shown first, one of :func:`shellcut.view.fields.fields_of`.
    limits : (float, float), optional
        Limits of its colour scale, in its unit; by default round numbers around nearly all.
    size : (int, int)
        Width and height at the start [pixel].
    off_screen : bool
        Whether to draw without a window, as tests do.

    Raises
    ------
    ValueError
        If there is no frame, or no such field.
    """

    def __init__(
        self,
        source: FrameSource,
        field: str = "largest principal",
        *,
        limits: tuple[float, float] | None = None,
        size: tuple[int, int] = (1280, 860),
        off_screen: bool = False,
    ) -> None:
        import pyvista

        if not source.n_frame:
            raise ValueError("a window needs at least one frame, there is none yet")
        self._source, self._limits = source, limits
        some = np.linspace(0, source.n_frame - 1, min(source.n_frame, _N_LOOKED_AT))
        self._looked_at = [source.frame(int(k)) for k in np.unique(some.round().astype(int))]
        (self.field,) = chosen_fields(self._looked_at[-1], [field])
        self._fields = chosen_fields(self._looked_at[-1], None)
        self.number = source.n_frame - 1
        self._reading: Reading | None = None
        with quiet_vtk():
            plotter: Any = pyvista.Plotter(off_screen=off_screen, window_size=list(size))
            plotter.background_color = "white"
            plotter.enable_anti_aliasing("ssaa")
            plotter.enable_depth_peeling(8)
            self._plotter, self._actors = plotter, Actors(plotter, None)
            self._rescale()
            self._slider: Any = None
            self._add_controls()
            self._look(size)
            self.show_frame(self.number)

    # ------------------------------------------------------------------ what is shown

    def show_frame(self, number: int) -> None:
        """Show a frame; a number beyond the ends shows the first or last one."""
        self.number = min(max(number, 0), self._source.n_frame - 1)
        self._frame = self._source.frame(self.number)
        self._values = self.field.values(self._frame)
        self._actors.show(self._frame, self._values, self.field.of)
        if self._slider is not None:
            self._slider.GetRepresentation().SetValue(self.number)
        if self._reading is not None:  # the quad keeps its number
            self._read(self._reading.quad, self._reading.place)
        self._say()
        self._plotter.render()

    def show_field(self, name: str) -> None:
        """Colour the film by another field.

        Raises
        ------
        ValueError
            If there is no such field.
        """
        (self.field,) = chosen_fields(self._frame, [name])
        self._limits = None
        self._rescale()
        self.show_frame(self.number)

    def pick(self, x: float, y: float) -> Reading | None:
        """Read the value at a place of the window [pixel from its lower left]; None off the film.

        The reading is shown, and follows its quad through the frames.
        """
        from vtkmodules.vtkRenderingCore import vtkCellPicker

        picker = vtkCellPicker()
        picker.SetTolerance(1e-4)
        picker.PickFromListOn()
        picker.AddPickList(self._actors.film)
        picker.Pick(x, y, 0.0, self._plotter.renderer)
        if picker.GetCellId() < 0:
            return None
        self._read(picker.GetCellId(), np.array(picker.GetPickPosition()))
        self._say()
        self._plotter.render()
        return self._reading

    def show(self) -> None:
        """Open the window and wait until it is closed."""
        with quiet_vtk():
            self._plotter.show(title=f"shellcut: {_KEYS}")

    def close(self) -> None:
        """Release the window."""
        self._plotter.close()

    # ------------------------------------------------------------------ parts

    def _rescale(self) -> None:
        limits = self._limits or field_limits(
            [self.field.values(frame) for frame in self._looked_at], self.field.sign
        )
        self._actors.rescale(_scale_of(*limits))
        for old in list(self._plotter.scalar_bars.keys()):
            self._plotter.remove_scalar_bar(old, render=False)
        first = self._looked_at[0]
        self._actors.show(first, self.field.values(first), self.field.of)
        unit = "" if self.field.unit == "-" else f" [{self.field.unit}]"
        self._plotter.add_scalar_bar(
            f"{self.field.label}{unit}",
            mapper=self._actors.film.mapper,
            color="black",
            vertical=False,
            position_x=0.04,
            position_y=0.03,
            width=0.4,
            height=0.09,
            title_font_size=18,
            label_font_size=15,
            fmt="%.4g",
            n_labels=5,
            render=False,
        )

    def _add_controls(self) -> None:
        plotter, last = self._plotter, self._source.n_frame - 1
        if last > 0:
            self._slider = plotter.add_slider_widget(
                lambda at: self.show_frame(round(at)) if round(at) != self.number else None,
                [0, last],
                value=last,
                title="frame",
                fmt="%.0f",
                color="black",
                style="modern",
                pointa=(0.55, 0.08),
                pointb=(0.96, 0.08),
                interaction_event="always",
            )
        plotter.add_key_event("Right", lambda: self.show_frame(self.number + 1))
        plotter.add_key_event("Left", lambda: self.show_frame(self.number - 1))
        plotter.add_key_event("n", self._next_field)
        plotter.iren.add_observer(
            "LeftButtonPressEvent", lambda *_: self.pick(*plotter.iren.get_event_position())
        )

    def _next_field(self) -> None:
        names = [field.name for field in self._fields]
        self.show_field(names[(names.index(self.field.name) + 1) % len(names)])

    def _look(self, size: tuple[int, int]) -> None:
        camera = whole_camera(self._looked_at, _VIEW, (size[1], size[0]))
        reach = 4.0 * max(np.ptp(frame.points, axis=0).max() for frame in self._looked_at)
        of = self._plotter.camera
        of.focal_point = camera.centre
        of.position = camera.centre + reach * camera.axes[2]
        of.up = camera.axes[1]
        of.parallel_projection = True
        of.parallel_scale = 0.6 * camera.shape[0] / camera.scale  # with room for the controls

    def _read(self, quad: int, near: Floats) -> None:
        """Read the quad at its node nearest to a place, and show it."""
        row = self._frame.quads[quad]
        polygon = row[is_corner(row[None])[0]]
        away = np.linalg.norm(self._frame.points[polygon] - near, axis=1)
        node = int(polygon[away.argmin()])
        value = float(self._values[quad if self.field.of == "quad" else node])
        self._reading = Reading(quad, node, self._frame.points[node], value, self.field)
        ends = np.stack((polygon, np.roll(polygon, -1)), axis=1)
        self._plotter.add_lines(
            self._frame.points[ends].reshape(-1, 3), color=_MARK, width=4, name="mark"
        )

    def _say(self) -> None:
        reading = "click the film to read a value" if self._reading is None else self._reading
        self._plotter.add_text(
            f"{title_of(self._frame)}\n{reading}",
            position="upper_left",
            font_size=11,
            color="black",
            name="said",
            render=False,
        )


def _scale_of(low: float, high: float) -> Any:
    """Return the map from values to colour, with a pale zero if there are numbers below it."""
    scale = stress_scale((low, high))
    if low >= 0.0:
        return scale
    from matplotlib import colormaps
    from matplotlib.colors import ListedColormap

    places = 0.5 + 0.5 * np.linspace(low, high, 256) / max(-low, high)
    scale.set_cmap(ListedColormap(colormaps["PRGn"](0.1 + 0.8 * places)))
    return scale

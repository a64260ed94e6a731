"""Sections of law, contact, fracture, time step, damping, output, supports and loads."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, get_args

from shellcut.cables.cohesive_law import CohesiveLaw, Joint, Unloading
from shellcut.contact.settings import Contact
from shellcut.fracture.options import (
    CablePlaces,
    DropLoose,
    Fracture,
    Measure,
    Path,
    instead_of,
)
from shellcut.loads.loads import (
    EdgeTraction,
    Gravity,
    Load,
    NodalForce,
    NodalMoment,
    Pressure,
    steady,
)
from shellcut.loads.supports import Support
from shellcut.recording.run_options import RunOptions
from shellcut.simulation.simulation import Simulation
from shellcut.simulation.stable_step import Stepping

from .key import (
    Section,
    axes,
    choice,
    count,
    default_of,
    flag,
    key,
    number,
    numbers,
    rates,
    section,
    set_or_ids,
    text,
    whole,
)


@section("")
class Head(Section):
    """Keys before the first section."""

    model: str = key(
        choice("opening", "guillotine", "free", "trouser", "oscillating"), "kind of model"
    )
    name: str | None = key(text, "stem of the result file", default=None, unset="the model's name")
    directional: bool = key(
        flag,
        "whether cables meet the blade; false: classical cohesive elements",
        default=default_of(Simulation, "directional"),
    )
    imperfection: int | None = key(
        count(0),
        "number of the small shape with which the film begins, so that it can buckle; 0: none",
        default=default_of(Simulation, "imperfection"),
        unset="1 with a tool that cuts, otherwise 0",
    )
    threads: int | None = key(
        count(1),
        "1 to 256; results do not depend on it",
        default=default_of(Simulation, "threads"),
        unset="one for a small film, otherwise all cores",
    )


@section("cohesive", of=CohesiveLaw)
class Cohesive(Section):
    """Cable stress as a function of cable length."""

    strength: float = key(number("MPa"), "sigma_F, at which a node splits")
    plateau: float = key(number("MPa"), "sigma_C")
    opening_a: float = key(number("mm"), "l_A, end of the drop")
    opening_p: float = key(number("mm"), "l_P, end of the plateau")
    opening_u: float = key(number("mm"), "l_U, at which the cable breaks")
    onset: float = key(number("mm"), "delta_0, over which the force turns to the opening")
    unloading: str = key(choice(*get_args(Unloading)), "how a cable unloads")
    unloading_stiffness: float = key(number("MPa/mm"), "slope of the elastic unloading")
    joint: str = key(
        choice(*get_args(Joint)),
        "what a cable does at the cutting edge: stick to its point, slip with friction, slide",
    )
    joint_friction: float = key(number(), "mu of joint = slip")


@section("contact", of=Contact)
class ContactSection(Section):
    """Penalty contact with the tool, and of the film with itself."""

    penalty: float | None = key(
        number("N/mm^3"), "lambda", unset="1e4 for 74 um of 1678 MPa, in proportion to E h"
    )
    smoothing: float = key(number(), "largest g_M as a fraction of the thickness")
    friction: float = key(number(), "Coulomb coefficient of tool and film; 0 for none")
    tool_points: bool = key(flag, "whether the tool's corners and edges push between nodes")
    film_edges: bool = key(
        flag, "whether rims and flanks touch the tool's edges between nodes", default=False
    )
    self_contact: bool = key(flag, "whether film near cracks and loose pieces touch the film")
    self_friction: float = key(number(), "Coulomb coefficient of film and film; 0 for none")


@section("contact", of=Contact)
class OpeningContact(ContactSection):
    """Penalty contact with the tool, and of the film with itself."""

    film_edges: bool = key(
        flag, "whether rims and flanks touch the tool's edges between nodes", default=True
    )


@section("fracture", of=Fracture)
class FractureSection(Section):
    """How cracks start and run."""

    criterion: str = key(choice(*get_args(Measure)), "measure of a crack that runs")
    blade_cut: bool = key(flag, "whether the blade cuts what it goes through and has passed")
    turn_limit_deg: float = key(
        number("deg"), "largest turn of a crack along edges that no blade drives"
    )
    check_every: int = key(whole, "steps between two checks")
    equilibrium_start: bool = key(flag, "start a cable with the force that the node carried")
    path: str | None = key(
        choice(*get_args(Path), instead_of=instead_of),
        "of cracks: free through quads, or along edges",
        unset="edges if they lie under the whole path or another option needs them, else free",
    )
    cable_places: str = key(
        choice(*get_args(CablePlaces)),
        "cables across a segment of a crack through quads, at its ends or its Gauss points",
    )
    largest_speed: float | None = key(
        number("mm/s"),
        "of cracks through quads that no blade drives",
        unset="one quad in check_every steps",
    )
    drop_loose: str = key(
        choice(*get_args(DropLoose)),
        "take pieces that nothing holds out of the run when they are clear of film and tool",
    )


@section("time", of=Stepping)
class Time(Section):
    """Choice of the time step."""

    safety: float = key(number(), "factor on the safe step")
    evaluate_every: int = key(whole, "steps between two evaluations of the quads")
    fixed: float | None = key(number("s"), "a fixed step", unset="the safe step")


@section("damping")
class Damping(Section):
    """Rayleigh damping."""

    alpha: float = key(
        number("1/s", least=0.0), "of the mass", default=default_of(Simulation, "damping_alpha")
    )
    beta: float = key(
        number("s", least=0.0), "of the stiffness", default=default_of(Simulation, "damping_beta")
    )


@section("output", of=RunOptions)
class Output(Section):
    """Output of a run; see also the flags of ``shellcut run``."""

    rows: int = key(count(1), "rows of history.csv", parameter="n_row")
    frames: int = key(count(1), "frames of the result file", parameter="n_frame")
    snapshots: int = key(count(0), "pictures of the film; 0 for none", parameter="n_snapshot")
    curves: bool = key(flag, "draw the curves of the run when it ends")
    checkpoint_every_s: float = key(
        number("s", least=0.0), "wall time between two checkpoints", parameter="checkpoint_every"
    )


@section("supports", of=Support)
class SupportSection(Section):
    """Hold or move nodes, any number of [[supports]]."""

    nodes: str | tuple[int, ...] = key(set_or_ids, "which nodes")
    translation: str = key(axes, "held axes of the position")
    rotation: str = key(axes, "held axes of the director's spin")
    velocity: tuple[tuple[str, float], ...] | None = key(
        rates("mm/s"), "of held axes", default=None, unset="at rest"
    )
    spin: tuple[tuple[str, float], ...] | None = key(
        rates("rad/s"), "of held axes", default=None, unset="at rest"
    )

    def made(self) -> Support:
        """Return the support."""
        return Support(
            self.nodes,
            self.translation,
            self.rotation,
            velocity={axis: Constant(rate) for axis, rate in self.velocity or ()},
            spin={axis: Constant(rate) for axis, rate in self.spin or ()},
        )


@dataclass(frozen=True)
class Constant:
    """A constant rate."""

    value: float

    def __call__(self, _time: float) -> float:
        """Return the rate."""
        return self.value


@dataclass(frozen=True)
class Rising:
    """A factor that rises linearly from 0 to 1 over a time [s]."""

    ramp: float

    def __call__(self, time: float) -> float:
        """Return the factor at a time [s]."""
        return min(max(time / self.ramp, 0.0), 1.0)


class _Load(Section):
    """A load, constant or rising."""

    ramp: float

    def made(self) -> Load:
        """Return the load."""
        assert self.constructor is not None
        factor = Rising(self.ramp) if self.ramp else steady
        load: Load = self.constructor(**self.arguments(), factor=factor)
        return load


def _ramp() -> Any:
    return key(number("s", least=0.0), "time over which it rises from zero", default=0.0)


@section("loads", kind="gravity", sign="acceleration", of=Gravity)
class GravityLoad(_Load):
    """A body force."""

    acceleration: tuple[float, ...] = key(numbers("mm/s^2", count=3), "times mass")
    ramp: float = _ramp()


@section("loads", kind="pressure", sign="value", of=Pressure)
class PressureLoad(_Load):
    """A pressure along the directors."""

    value: float = key(number("MPa"), "towards the directors' side")
    following: bool = key(flag, "turns and stretches with the surface")
    quads: str | None = key(text, "quad set", unset="all quads")
    ramp: float = _ramp()


@section("loads", kind="force", sign="force", of=NodalForce)
class ForceLoad(_Load):
    """A force on every node of a set."""

    nodes: str | tuple[int, ...] = key(set_or_ids, "which nodes")
    force: tuple[float, ...] = key(numbers("N", count=3), "on each")
    ramp: float = _ramp()


@section("loads", kind="moment", sign="moment", of=NodalMoment)
class MomentLoad(_Load):
    """A moment on the director of every node of a set."""

    nodes: str | tuple[int, ...] = key(set_or_ids, "which nodes")
    moment: tuple[float, ...] = key(numbers("N*mm", count=3), "on each")
    ramp: float = _ramp()


@section("loads", kind="traction", sign="traction", of=EdgeTraction)
class TractionLoad(_Load):
    """A force per length on the boundary edges between nodes of a set."""

    nodes: str | tuple[int, ...] = key(set_or_ids, "which nodes")
    traction: tuple[float, ...] = key(numbers("N/mm", count=3), "dead")
    ramp: float = _ramp()

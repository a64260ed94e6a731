"""Check that the time step can follow the tool, and estimate the number of steps.

An edge that enters whole film is found while it goes through a quad
(:mod:`shellcut.fracture.pierce`), and a tip that it has passed before it is far behind, by a check
every ``check_every`` steps. So between two checks the edge must move by 0.3 edge lengths at most;
and by less than half an edge in one step, or the tool passes a node before contact or cables notice
it.
"""

from __future__ import annotations

from collections.abc import Iterator

from .finding import DOUBT, REFUSE, Finding, doubt, note

FOUND_WITHIN = 0.3
"""Travel of the edge between two checks for splits, in edge lengths."""
SEEN_WITHIN = 0.5
"""Travel of the edge in one step, in edge lengths."""
OF_WAVE = 0.1
"""Speed of the edge over that of membrane waves: above this the film tears before it gives way."""
UNSAFE = 2.0
"""A fixed step over the safe one above which a film surely blows up: the bound is 12 % short of the
limit on squares, and at twice the bound what is unstable grows tenfold in a step."""
MANY_STEPS = 5e6
"""A hundred times the number of steps of the opening test on M1."""


def check_steps(
    *,
    dt: float,
    fixed: float | None,
    bound: float,
    check_every: int,
    duration: float,
    speed: float,
    wave: float,
    edge_length: float,
) -> Iterator[Finding]:
    """Yield findings on the time step and the tool's speed.

    Times in s: first step, user's fixed step, safe bound at the start, and duration of the run.
    Speeds in mm/s: the largest of the cutting edges, and that of membrane waves. The edge length
    [mm] is that along the cut, or of the whole film.
    """
    if fixed is not None and fixed > bound:
        yield Finding(
            REFUSE if fixed > UNSAFE * bound else DOUBT,
            f"a fixed step must not exceed the safe one, {bound:.4g} s at the start, or the "
            "solution blows up",
            f"time.fixed {fixed:.4g} s",
            "leave it out, or lower it",
            forcible=True,
        )
    way = speed * dt
    came = (
        f"{way:.3g} mm a step, at {1e-3 * speed:.4g} m/s and steps of {dt:.3g} s, on quads with "
        f"sides of {edge_length:.3g} mm"
    )
    slower = "take a longer duration or a lower speed"
    remedy = slower if fixed is None else f"leave time.fixed out, or {slower}"
    if way > SEEN_WITHIN * edge_length:
        yield Finding(
            REFUSE,
            f"the cutting edge must move by less than {SEEN_WITHIN:g} sides of a quad in a step, "
            "or it passes nodes before contact acts on them",
            came,
            remedy,
        )
    elif way * check_every > FOUND_WITHIN * edge_length:
        yield doubt(
            f"the cutting edge should move by less than {FOUND_WITHIN:g} sides of a quad "
            f"in the {check_every} steps between two looks at the cracks, or it cuts late",
            came,
            remedy + ("; or check more often, fracture.check_every" if check_every > 1 else ""),
        )
    elif speed > OF_WAVE * wave:
        yield doubt(
            f"the cutting edge should be slower than {OF_WAVE:g} of the film's waves, which run at "
            f"{1e-3 * wave:.4g} m/s, or inertia carries the load",
            f"{1e-3 * speed:.4g} m/s",
            f"{slower}; speeds are in mm/s: 6 m/s is 6000",
        )
    if duration / dt > MANY_STEPS:
        yield note(
            f"the run takes about {duration / dt:.2g} steps of {dt:.3g} s, with cutting edges at "
            f"{1e-3 * speed:.4g} m/s",
            "take a shorter or faster motion: any will do while the verdict finds it slow enough "
            "(kinetic energy); speeds are in mm/s, 6 m/s is 6000",
        )

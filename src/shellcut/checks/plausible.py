"""Plausible ranges of the numbers of film, law and tool; a wrong unit is the usual cause.

Each limit gives its source. A refusal needs more: no shell, no elastic film, or a motion too fast
for the time step.

An edge that enters whole film is found while it goes through a quad
(:mod:`shellcut.fracture.pierce`), and a tip that it has passed before it is far behind, by a check
every ``check_every`` steps. So between two checks the edge must move by 0.3 edge lengths at most;
and by less than half an edge in one step, or the tool passes a node before contact or cables notice
it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from shellcut.arrays import norm
from shellcut.cables.cohesive_law import CohesiveLaw, CohesiveTable
from shellcut.formats.errors import counted, point_text
from shellcut.material.plastic import Plastic
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh
from shellcut.tool.coordinate import Coordinate, HasCoordinate
from shellcut.tool.motion import Motion
from shellcut.tool.pose_of_motion import KNOWN_MOTIONS, rate_of_pose
from shellcut.tool.table_motion import TableMotion
from shellcut.tool.tool import Tool

from .finding import DOUBT, REFUSE, Finding, doubt, note
from .place import in_inches

THINNEST = 1e-4
"""[mm]; capacitor films, the thinnest on the market, have 5e-4 mm."""
SLENDER = 0.1
"""Thickness over film size up to which first-order shear theory is assumed valid."""
STIFFEST, SOFTEST = 1.3e6, 1e-3
"""[MPa]; diamond has 1.2e6, the softest gels about 1e-3."""
LIGHTEST, HEAVIEST = 1e-11, 2.3e-8
"""[t/mm³]; foams have 1e-11 and more, osmium has 2.26e-8."""
FASTEST_WAVE, SLOWEST_WAVE = 2e7, 1e4
"""[mm/s], root of modulus over density; diamond has 1.8e7, soft rubber about 2e4."""
LARGEST_STRAIN, SMALLEST_STRAIN = 0.1, 1e-4
"""Strength over modulus: above 0.1 the elastic law, St.Venant-Kirchhoff, is out of its range, and
no material is known to tear below 1e-4."""
LARGEST_YIELD_STRAIN = 0.3
"""First yield stress over modulus: thermoplastics yield at 0.02 to 0.1, soft urethanes at 0.3."""
LARGEST_R, SMALLEST_R = 10.0, 0.1
"""r-values of sheets: aluminium 0.4 to 1, deep-drawing steel up to 2.5, titanium up to 7."""
RUPTURED = 1.0
"""Strength over modulus above which the film would double its length before it tears."""
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

# Instants at which a user's motion is looked at; half the interval of its rate, relative to the
# run; tolerance of its twist.
_N_INSTANT, _INTERVAL, _SAME_TWIST = 32, 1e-6, 0.01


def check_numbers(
    mesh: Mesh, material: ShellMaterial, law: CohesiveTable | None, tool: Tool | None
) -> Iterator[Finding]:
    """Yield implausible values of film, material, law and tool size."""
    yield from _thickness(mesh, material)
    yield from _layers(material)
    if law is not None:
        yield from _law(mesh, material, law)
    if tool is not None:
        yield from _tool_size(mesh, tool)


def check_motion(motion: Motion, until: float) -> Iterator[Finding]:
    """Yield doubts about a motion: angles of a table seem to wrap, or parts do not fit together."""
    if type(motion) not in KNOWN_MOTIONS:
        yield from _twist(motion, until)
        if isinstance(motion, HasCoordinate):
            yield from _coordinate(motion, Coordinate.own(motion, until), until)
    if isinstance(motion, TableMotion) and (i := motion.leap) is not None:
        a, b = np.asarray(motion.rotation_vectors)[i : i + 2]
        yield doubt(
            "between two rows of one axis the tool turns by the difference of their angles",
            f"a turn of {math.degrees(float(norm(b - a))):.4g}° from entry {i} to {i + 1} of the "
            "table; the shorter turn is in line with the entries before or after it",
            "if the sensor jumps by a turn (359 to 1 deg), set unwrap = true ([motion], or "
            "TableMotion)",
        )


def _twist(motion: Motion, until: float) -> Iterator[Finding]:
    """Yield a doubt if most twists of a motion differ from the rates of its pose."""
    times = (np.arange(_N_INSTANT) + 0.5) / _N_INSTANT * until
    given = np.array([np.concatenate(motion.twist(t)) for t in times.tolist()])
    moved = np.array([rate_of_pose(motion, t, _INTERVAL * until) for t in times.tolist()])
    for name, unit, of in (("spin", "rad/s", slice(0, 3)), ("velocity", "mm/s", slice(3, 6))):
        off, most = norm(given[:, of] - moved[:, of]), norm(moved[:, of]).max()
        # A kink may lie at an instant, but not at most of them.
        if (off > _SAME_TWIST * max(most, norm(given[:, of]).max())).mean() > 0.5:
            worst = int(np.argmax(off))
            yield doubt(
                "the twist of a motion must be the rate of its pose, or the work of the tool is "
                "wrong",
                f"a {name} of {point_text(given[worst, of], 4)} {unit} at {times[worst]:.4g} s, "
                f"where the pose changes by {point_text(moved[worst, of], 4)}",
                f"correct the method twist of {type(motion).__name__}",
            )


def _coordinate(motion: Motion, own: Coordinate, until: float) -> Iterator[Finding]:
    """Yield a doubt if a coordinate falls, or grows faster than the motion at most instants."""
    unit = own.unit
    times = ((np.arange(_N_INSTANT) + 0.5) / _N_INSTANT * until).tolist()
    remedy = f"let coordinate of {type(motion).__name__} be the path in mm or the angle in rad"
    rule = "force and torque are work over the coordinate of a motion, "
    q = np.array([own.at(t) for t in (0.0, *times, until)])
    if q[0] - q[-1] > _SAME_TWIST * np.ptp(q):  # not by round-off where it returns
        yield doubt(
            f"{rule}which must grow, or they have the wrong sign and no mean",
            f"one that falls from {q[0]:.4g} to {q[-1]:.4g} {unit}",
            remedy,
        )
    rate = np.abs([own.rate(t) for t in times])
    spin, velocity = norm(np.array([motion.twist(t) for t in times], float)).T
    # A tool that turns may have any path: its points have different speeds.
    most = spin if unit == "rad" else np.where(spin > 0.0, np.inf, velocity)
    outrun = (rate > (1.0 + _SAME_TWIST) * most) & (most > 0.0)
    if outrun.mean() > 0.5:  # a kink may lie at an instant
        k = int(np.argmax(np.where(outrun, rate, 0.0)))
        yield doubt(
            f"{rule}which must grow no faster than the tool moves",
            f"{rate[k]:.4g} {unit}/s at {times[k]:.4g} s, where it moves at {most[k]:.4g} {unit}/s",
            remedy,
        )


def film_size(mesh: Mesh) -> float:
    """Return the side of a square with the film's area [mm]."""
    return math.sqrt(float(mesh.quad_areas().sum()))


def _thickness(mesh: Mesh, material: ShellMaterial) -> Iterator[Finding]:
    h, size = material.thickness, film_size(mesh)
    edge = float(np.median(mesh.edge_lengths()))
    remedy = 'thickness is in mm unless a unit is given: 74 µm is 0.074 or "74 um"'
    if h > SLENDER * size:
        yield Finding(
            REFUSE if h >= size else DOUBT,
            f"a shell should be thinner than {SLENDER:g} of its size, or its theory is not valid",
            f"thickness {h:.4g} mm of a film of {size:.4g} mm, the root of its area",
            remedy,
        )
    elif h > edge:
        yield doubt(
            "the film should be thinner than its quads are long: a shell has no detail below its "
            "thickness, and cables and contact act at its mid-surface",
            f"thickness {h:.4g} mm and sides of quads of {edge:.4g} mm",
            f"{remedy}; or take a coarser mesh",
        )
    if h < THINNEST:
        yield doubt(
            f"a film should be thicker than {THINNEST:g} mm; the thinnest on the market have "
            "0.0005 mm",
            f"thickness {h:.4g} mm",
            remedy,
        )


def _layers(material: ShellMaterial) -> Iterator[Finding]:
    seen = {(one.material.stretching_modulus, one.material.density) for one in material.layers}
    for young, density in sorted(seen):
        if not SOFTEST <= young <= STIFFEST:
            yield doubt(
                f"a modulus should lie between {SOFTEST:g} MPa, a gel, and {STIFFEST:g} MPa, "
                "diamond",
                f"young {young:.4g} MPa",
                'young is in MPa unless a unit is given: 1.678 GPa is 1678 or "1.678 GPa"',
            )
        if not LIGHTEST <= density <= HEAVIEST:
            yield doubt(
                f"a density should lie between {LIGHTEST:g} t/mm³, a foam, and {HEAVIEST:g} t/mm³, "
                "osmium",
                f"density {density:.4g} t/mm³",
                'density is in t/mm³ unless a unit is given: 1 g/cm³ is 1e-9 or "1 g/cm3"; if mass '
                "is added on purpose, look at the kinetic energy",
            )
        wave = math.sqrt(young / density)
        if not SLOWEST_WAVE <= wave <= FASTEST_WAVE:
            yield doubt(
                f"waves in a film should run at {1e-3 * SLOWEST_WAVE:g} to "
                f"{1e-3 * FASTEST_WAVE:g} m/s, from soft rubber to diamond",
                f"{1e-3 * wave:.4g} m/s, the root of young {young:.4g} MPa over density "
                f"{density:.4g} t/mm³",
                "one of the two is not in MPa or t/mm³",
            )
    films = [layer.material for layer in material.layers if isinstance(layer.material, Plastic)]
    for first, young in sorted({(f.hardening.first_yield, f.stretching_modulus) for f in films}):
        if (strain := first / young) > LARGEST_YIELD_STRAIN:
            yield Finding(
                REFUSE if strain > RUPTURED else DOUBT,
                f"a film should yield below a strain of {LARGEST_YIELD_STRAIN:g}, as all that do",
                f"a first yield stress of {first:.4g} MPa at a modulus of {young:.4g} MPa, a "
                f"strain of {strain:.3g}",
                'both are in MPa unless a unit is given: 40e6 Pa is 40 or "40e6 Pa"; a film that '
                "does not yield has no yield stress",
                forcible=True,
            )
    for r in sorted({f.r_values for f in films if f.r_values is not None}):
        if not (min(r) >= SMALLEST_R and max(r) <= LARGEST_R):
            yield doubt(
                f"r-values should lie between {SMALLEST_R:g} and {LARGEST_R:g}, those of all known "
                "sheets",
                f"r_values {', '.join(f'{one:.4g}' for one in r)}",
                "an r-value is the plastic strain across the width over that through the thickness",
            )


def _law(mesh: Mesh, material: ShellMaterial, law: CohesiveTable) -> Iterator[Finding]:
    # the strain at which the film as a whole carries the strength
    young = material.stretching_stiffness / material.thickness
    strain = law.strength / young
    given = f"strength {law.strength:.4g} MPa"
    remedy = 'both are in MPa unless a unit is given: 18e6 Pa is 18 or "18e6 Pa"'
    if strain > RUPTURED:
        yield Finding(
            REFUSE,
            "",
            f"{given} is {strain:,.4g} times the film's modulus, {young:.4g} MPa: this film would "
            "never tear",
            remedy,
            forcible=True,
        )
    elif not SMALLEST_STRAIN <= strain <= LARGEST_STRAIN:
        yield doubt(
            f"the strain at which the film tears should lie between {SMALLEST_STRAIN:g} and "
            f"{LARGEST_STRAIN:g}, the range of materials and of the elastic law",
            f"{given} at a modulus of {young:.4g} MPa, a strain of {strain:.3g}",
            remedy,
        )
    (paper,) = ShellMaterial.homogeneous().layers
    if law == CohesiveLaw() and any(one.material != paper.material for one in material.layers):
        yield note(
            f"the cables have the law of the opening test's film, {law.strength:g} MPa and "
            f"{law.fracture_energy:g} N/mm, and the film is another",
            "take strength and openings from its tensile tests or a measured cut "
            "(docs/materials.md)",
        )
    size = film_size(mesh)
    if law.opening_u > size:
        yield doubt(
            "a cable should break before it is as long as the film, or none ever does",
            f"opening_u {law.opening_u:.4g} mm of a film of {size:.4g} mm, the root of its area",
            "openings are in mm: 4 µm is 0.004",
        )


def _tool_size(mesh: Mesh, tool: Tool) -> Iterator[Finding]:
    edge = float(np.median(mesh.edge_lengths()))
    bodies = [
        tool.vertices[np.unique(tool.triangles[tool.triangle_body == b])]
        for b in range(tool.n_body)
    ]
    extents = [float(np.linalg.norm(np.ptp(x, axis=0))) for x in bodies]
    if small := [b for b, extent in enumerate(extents) if extent < edge]:
        yield doubt(
            "a tooth should be longer than the side of a quad: contact sees nodes only, and "
            "between them nothing resists the tooth",
            f"{counted(len(small), 'body', 'bodies')} of the tool, of which body {small[0] + 1} is "
            f"{extents[small[0]]:.3g} mm in size, and sides of {edge:.3g} mm",
            f"give the unit of the tool's file ({in_inches(extents[small[0]], 'it')}), or take a "
            "finer film",
        )
    film, whole = film_size(mesh), float(np.linalg.norm(np.ptp(tool.vertices, axis=0)))
    if whole > 100.0 * film:
        yield doubt(
            "tool and film should be of similar size",
            f"a tool of {whole:.4g} mm and a film of {film:.4g} mm",
            f"give the unit of the tool's file, or of the film's ({in_inches(film, 'the film')})",
        )


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

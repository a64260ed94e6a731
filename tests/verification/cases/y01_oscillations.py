"""Oscillations by the explicit driver: Y01 free, Y02 damped, Y03 at the critical step, Y04 long."""

from functools import partial

import numpy as np
from scipy.optimize import minimize_scalar

from cases.paths import curve
from courses import UNDAMPED, recorded
from films import shaken
from harness import Check, case, zero
from shellcut import Pressure, ShellMaterial, Simulation, Statics, Stepping, Support
from shellcut.mesh.structured import annulus, cylinder, disc, opening_disc, rectangle
from shellcut.simulation.instability import UnstableStep

MATERIAL = ShellMaterial.homogeneous(thickness=0.5)
PERIODS = 20
STRETCH = 1.01
SIDES = [Support.clamped(side) for side in ("left", "right", "top", "bottom")]
ENDS = [Support("top", "xz", "y"), Support("bottom", "xyz", "y")]
FILMS = {  # mesh, supports, the stretch in x and y
    "clamped plate": (partial(rectangle, 12.0, 10.0, n_x=12, n_y=10), SIDES, 1.0),
    "roof": (partial(cylinder, 10.0, 12.0, n_around=10, n_along=10, arc_deg=80.0), ENDS, 1.0),
    "stretched disc": (partial(disc, 10.0, n_side=8), [Support.pinned("rim")], STRETCH),
}


def best_frequency(time, value, guess):
    """Return the angular frequency of the sine nearest to the values."""

    def misfit(omega):
        waves = np.stack([np.cos(omega * time), np.sin(omega * time)], axis=1)
        return float(np.linalg.lstsq(waves, value, rcond=None)[1][0])

    width = 0.5 / PERIODS
    scan = guess * np.linspace(1.0 - width, 1.0 + width, 41)
    best = scan[np.argmin([misfit(omega) for omega in scan])]
    step = scan[1] - scan[0]
    found = minimize_scalar(
        misfit, bounds=(best - step, best + step), method="bounded", options={"xatol": 1e-9 * guess}
    )
    return float(found.x)


def frequencies(name, number):
    """Return the driver's exact angular frequency of a mode, and the measured one."""
    build, supports, stretch = FILMS[name]
    mesh = build()
    body = Statics(mesh, MATERIAL, supports=supports)
    body.state.node.x[: mesh.n_node, :2] *= stretch
    modes = body.modes(number + 1, true_inertia=False)
    omega, shape = 2.0 * np.pi * modes.frequency[number], modes.shape[number]
    dt = 0.9 * 2.0 / body.largest_frequency()
    fixed = Stepping(fixed=dt)
    sim = Simulation(mesh, MATERIAL, supports=supports, stepping=fixed, **UNDAMPED)
    if stretch != 1.0:
        sim.relax((stretch - 1.0) * mesh.nodes)
    n, node, size = mesh.n_node, sim.state.node, 1e-4 * MATERIAL.thickness
    start = node.x[:n].copy()
    node.velocity_half[:n] = size * omega * shape
    weight = node.mass[:n, None] * shape / size / (node.mass[:n, None] * shape**2).sum()

    def read(sim):
        return sim.state.time, (weight * (node.x[:n] - start)).sum()

    time, value = recorded(sim, PERIODS * 2.0 * np.pi / omega, read)
    exact = 2.0 / dt * np.arcsin(0.5 * omega * dt)
    if number == 0:
        first = time < 3.0 * 2.0 * np.pi / omega
        y01.CURVES[f"{name}, first three periods"] = curve(
            time[first], value[first], time[first], np.sin(exact * time[first])
        )
    return exact, best_frequency(time, value, exact)


@case(
    "Y01",
    "Free vibration against the modes",
    axes=("time, s", "displacement along the mode, over its amplitude"),
)
def y01():
    """Films in three states (a clamped plate, a cylindrical roof, a membrane stretched by 1 %)
    start with the velocity of a mode, of an amplitude of 1e-4 of the thickness. Read: the
    frequency, by the best sine through some twenty periods of the film's part along the mode.

    Reference: :meth:`Statics.modes` with the driver's own inertia; the central difference shortens
    the period, sin(omega_n dt / 2) = omega dt / 2, which is included. Band: kind fit, 1e-5: what is
    left of other modes, started because the spins are not, averages out over the periods.
    """
    for name in FILMS:
        for number in (0, 2):
            exact, ours = frequencies(name, number)
            yield Check(f"omega, {name}, mode {number + 1}, 1/s", exact, ours, 1e-5, "fit")


BAR = ShellMaterial.homogeneous(poisson=0.0)
N_STEP = 60


def swing(share, alpha, beta):
    """Return dt, omega, measured decay rate and measured frequency.

    ``share`` of the exact critical step; ``alpha`` over omega, ``beta`` times omega.
    """
    mesh = rectangle(4.0, 1.0, n_x=4, n_y=1)
    supports = [Support.clamped("left"), Support(np.arange(mesh.n_node), translation="yz")]
    body = Statics(mesh, BAR, supports=supports)
    modes = body.modes(1, true_inertia=False)
    omega, shape = 2.0 * np.pi * float(modes.frequency[0]), modes.shape[0]
    dt = share * 2.0 / body.largest_frequency()
    sim = Simulation(
        mesh,
        BAR,
        supports=supports,
        stepping=Stepping(fixed=dt),
        damping_alpha=alpha * omega,
        damping_beta=beta / omega,
        velocity=1e-7 * omega * shape,
    )
    end = mesh.node_set("right")
    q = [0.0]
    for _ in range(N_STEP):
        sim.step()
        q.append(float((sim.state.node.x[end, 0] - sim.state.node.X[end, 0]).mean()))
    q = np.array(q)
    A, B = np.linalg.lstsq(np.stack([q[1:-1], q[:-2]], axis=1), q[2:], rcond=None)[0]
    z = np.roots([1.0, -A, -B])[0]
    phase = omega * dt * np.arange(q.size)
    y02.CURVES[f"α = {alpha:g} ω, β = {beta:g} / ω"] = curve(
        phase, q / np.abs(q).max(), phase, np.exp(-0.5 * (alpha + beta) * phase)
    )
    return dt, omega, -np.log(abs(z)) / dt, abs(np.angle(z)) / dt


def exact(dt, omega, alpha, beta):
    """Return rate and frequency of the recurrence."""
    a, b = 0.5 * alpha * omega * dt, beta * omega * dt
    z = np.roots([1.0 + a, -(2.0 - (omega * dt) ** 2 - b), 1.0 - a - b])[0]
    return -float(np.log(abs(z))) / dt, float(abs(np.angle(z))) / dt


@case(
    "Y02", "Decay rates of alpha and beta", axes=("ω t", "displacement of the end over the largest")
)
def y02():
    """A short strip swings along itself in one of its modes, so fast (omega dt 0.2 to 1) and so
    strongly damped that what the integrator makes of the damping shows. Read: rate of decay and
    frequency, from q_{n+1} = A q_n + B q_{n-1} by least squares, which one swing fulfils exactly.

    Reference: the roots of the driver's recurrence. With a = alpha dt / 2, b = beta omega² dt and
    the damping force of beta lagging half a step,

        (1 + a) z² - (2 - omega² dt² - b) z + (1 - a - b) = 0:  |z|² = (1 - a - b) / (1 + a),

    rate -ln|z| / dt, frequency arg(z) / dt: exact, but for round-off and the amplitude (strains of
    1e-7). For information: rates of the continuous film, (alpha + beta omega²) / 2; the lag adds
    about b / 2 of the part of beta. That holds to the order of the step: two runs with dt and dt /
    2 have the ratio 2.
    """
    reason = "round-off, amplitude"
    for alpha, beta in ((0.1, 0.0), (0.0, 0.1), (0.1, 0.05)):
        dt, omega, rate, frequency = swing(0.5, alpha, beta)
        name = f"alpha {alpha:g} omega, beta {beta:g} / omega"
        wanted, turns = exact(dt, omega, alpha, beta)
        yield Check(f"rate, {name}, 1/s", wanted, rate, 1e-5, reason)
        yield Check(f"frequency, {name}, 1/s", turns, frequency, 1e-5, reason)
        plain = 0.5 * (alpha + beta) * omega
        yield Check(f"rate, {name}, continuous, 1/s", plain, rate, 0.05, "time step", gate=False)
    # The lag: what the rate of beta has above beta omega² / 2, of first order in the step.
    beta = 0.1
    excess = []
    for share in (0.2, 0.1):
        dt, omega, rate, _ = swing(share, 0.0, beta)
        excess.append(rate / (0.5 * beta * omega) - 1.0)
    expected = 0.5 * beta * omega * dt
    yield Check("excess of beta by the lag", expected, excess[1], 0.05, "order of the step")
    ratio = excess[0] / excess[1]
    yield Check("its ratio, dt to dt / 2", 2.0, ratio, 0.1, "order", absolute=True)


PLAIN = ShellMaterial.homogeneous()
UNEVEN = ("opening disc", "distorted")
KICK, CALM, GROWN = 1e-2, 10.0, 1e4
MESHES = {
    "squares": lambda: rectangle(3.0, 2.0, n_x=6, n_y=4),
    "slender": lambda: rectangle(3.0, 2.0, n_x=3, n_y=10),
    "cylinder": lambda: cylinder(3.0, 3.0, n_around=6, n_along=4, arc_deg=90.0),
    "strip": lambda: rectangle(6.0, 0.5, n_x=12, n_y=1),
    "ring": lambda: annulus(2.0, 4.0, n_around=24, n_radial=5),
    "opening disc": lambda: opening_disc("quick"),
    "distorted": lambda: shaken(rectangle(3.0, 2.0, n_x=6, n_y=4), 0.12),
}


def growth(mesh, beta, dt):
    """Return by how much a small random motion grows in 600 steps, at most GROWN and a step's."""
    kick = KICK * np.random.default_rng(0).standard_normal((mesh.n_node, 3))
    sim = Simulation(
        mesh,
        PLAIN,
        damping_alpha=0.0,
        damping_beta=beta,
        stepping=Stepping(fixed=dt),
        velocity=kick,
    )
    start = largest = float(np.abs(kick).max())
    try:
        for _ in range(600):
            sim.step()
            largest = max(largest, float(np.abs(sim.state.node.velocity_half).max()))
            if largest > GROWN * start:
                break
    except UnstableStep:
        largest = GROWN * start
    return largest / start


@case("Y03", "Exact critical step")
def y03():
    """Seven films start with random velocities of 1e-2 mm/s and run 600 steps at 0.95 and at 1.05
    of the exact step 2 / omega (sqrt(1 + xi²) - xi), xi = beta omega / 2, undamped and damped;
    omega is :meth:`Statics.largest_frequency`. Read: growth of the largest velocity, and the
    driver's safe bound over the exact step.

    Bands are bounds: growth below 10 and above 1e4; the safe bound between 0.8 and 1 of the exact
    step on the first five meshes. Where quads differ it lies lower (0.71 to 0.79), for information:
    a bound by the worst quad alone does not know what its better neighbours take over.
    """
    for name, build in MESHES.items():
        mesh = build()
        omega = Statics(mesh, PLAIN).largest_frequency()
        for beta in (0.0, 5e-8):
            xi = 0.5 * beta * omega
            exact = 2.0 / omega * (np.sqrt(1.0 + xi * xi) - xi)
            what = f"{name}, {'damped' if beta else 'undamped'}"
            below, above = growth(mesh, beta, 0.95 * exact), growth(mesh, beta, 1.05 * exact)
            sim = Simulation(mesh, PLAIN, damping_alpha=0.0, damping_beta=beta)
            share = sim.time_step.bound(sim.state) / exact
            yield Check(f"growth at 0.95, {what}", 1.0, below, CALM - 1.0, "bound")
            reached = min(above, GROWN)
            yield Check(f"growth at 1.05, {what}", GROWN, reached, 1e-6, "bound")
            safe, even = f"safe / exact step, {what}", name not in UNEVEN
            yield Check(safe, 0.9, share, 0.1 + 1e-6, "bound, 0.8 to 1", even, absolute=True)


LONG, EVERY = 1_000_000, 10
SWING = 5.0  # mm, along the arc


def strip():
    mesh = rectangle(10.0, 1.0, n_x=10, n_y=1)
    material = ShellMaterial.homogeneous(thickness=0.5)
    supports = [Support.clamped("left")]
    modes = Statics(mesh, material, supports=supports).modes(1, true_inertia=False)
    velocity = SWING * 2.0 * np.pi * modes.frequency[0] * modes.shape[0]
    sim = Simulation(mesh, material, supports=supports, velocity=velocity, **UNDAMPED)
    return sim, mesh.node_set("right")


def pressed_disc():
    mesh = disc(10.2, n_side=6)
    held, load = [Support.clamped("rim")], [Pressure(0.05)]
    sim = Simulation(mesh, ShellMaterial.homogeneous(), supports=held, loads=load, **UNDAMPED)
    return sim, mesh.node_set("centre")


def run(sim, nodes, n_step):
    """Return step, imbalance, work put in and height at every EVERY-th step."""
    rows = []
    for step in range(n_step):
        sim.step()
        if step % EVERY == 0:
            height = sim.state.node.x[nodes, 2].mean()
            rows.append((step, sim.ledger.imbalance, sim.ledger.put_in, height))
    return np.array(rows).T


def drift_rows(name, history, *, gate):
    step, imbalance, put_in, height = history
    peak = np.abs(put_in).max()
    means = imbalance.reshape(100, -1).mean(axis=1) / peak
    y04.CURVES[name] = curve(
        step.reshape(100, -1).mean(axis=1), means, [0.0, float(step[-1])], [0.0, 0.0]
    )
    drift, tenth = means - means[:10].mean(), step.size // 10
    last, largest = float(drift[-10:].mean()), float(np.abs(drift).max())
    yield zero(f"drift, last tenth / peak, {name}", last, 1e-4, "aim", gate=gate)
    yield zero(f"largest drift, hundredths / peak, {name}", largest, 1e-4, "aim", gate=gate)
    start, end = (float(np.abs(part).max()) for part in (height[:tenth], height[-tenth:]))
    what = f"largest height at the end, {name}, mm"
    yield Check(what, start, end, 0.01, "the oscillation continues", gate)


@case(
    "Y04",
    "Energy drift over 1e6 steps",
    fast=False,
    axes=("steps", "mean imbalance over the largest energy"),
)
def y04():
    """Energy over a million steps of a large oscillation.

    A strip of ten quads (10 x 1 x 0.5 mm), clamped at one end, gets the velocity of its first mode
    and swings by half its length, 600 times and more, without damping, at the driver's own step.
    Read: drift of the energies' imbalance, between the means of the first and the last tenth of the
    run and of any hundredth, over the largest energy.

    Reference: none is lost. Tolerance: 1e-4, the aim.

    For information: a clamped disc (R = 10.2, h = 0.074 mm) of 60 quads under a pressure step,
    300,000 steps. Its swing breaks up into waves as short as the mesh, whose energy has an error
    that depends on omega dt: the mean imbalance moves by some hundredths of the peak, less with the
    step: 0.03 at the driver's own, 0.004 at 0.46 and 0.0008 at 0.23 of it.
    """
    yield from drift_rows("strip, 1e6 steps", run(*strip(), LONG), gate=True)
    yield from drift_rows("disc, 3e5 steps", run(*pressed_disc(), 300_000), gate=False)

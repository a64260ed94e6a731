"""Y02 Decay under mass damping alpha and stiffness damping beta, by the explicit driver.

A short strip swings along itself in one of its modes, so fast (omega dt 0.2 to 1) and so strongly
damped that what the integrator makes of the damping shows. Read: rate of decay and frequency, from
q_{n+1} = A q_n + B q_{n-1} by least squares, which one swing fulfils exactly.

Reference: the roots of the driver's recurrence. With a = alpha dt / 2, b = beta omega² dt and the
damping force of beta lagging half a step,

    (1 + a) z² - (2 - omega² dt² - b) z + (1 - a - b) = 0:  |z|² = (1 - a - b) / (1 + a),

rate -ln|z| / dt, frequency arg(z) / dt: exact, but for round-off and the amplitude (strains of
1e-7). For information: rates of the continuous film, (alpha + beta omega²) / 2; the lag adds about
b / 2 of the part of beta. That holds to the order of the step: two runs with dt and dt / 2 have the
ratio 2.
"""

import numpy as np

from cases.paths import curve
from harness import Check
from shellcut import ShellMaterial, Simulation, Statics, Stepping, Support
from shellcut.mesh.structured import rectangle

ID, TITLE, FAST = "Y02", "Decay rates of alpha and beta", True

MATERIAL = ShellMaterial.homogeneous(poisson=0.0)
N_STEP = 60

CURVES = {}
AXES = "ω t", "displacement of the end over the largest"


def swing(share, alpha, beta):
    """Return dt, omega, measured decay rate and measured frequency.

    ``share`` of the exact critical step; ``alpha`` over omega, ``beta`` times omega.
    """
    mesh = rectangle(4.0, 1.0, n_x=4, n_y=1)
    supports = [Support.clamped("left"), Support(np.arange(mesh.n_node), translation="yz")]
    body = Statics(mesh, MATERIAL, supports=supports)
    modes = body.modes(1, true_inertia=False)
    omega, shape = 2.0 * np.pi * float(modes.frequency[0]), modes.shape[0]
    dt = share * 2.0 / body.largest_frequency()
    sim = Simulation(
        mesh,
        MATERIAL,
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
    CURVES[f"α = {alpha:g} ω, β = {beta:g} / ω"] = curve(
        phase, q / np.abs(q).max(), phase, np.exp(-0.5 * (alpha + beta) * phase)
    )
    return dt, omega, -np.log(abs(z)) / dt, abs(np.angle(z)) / dt


def exact(dt, omega, alpha, beta):
    """Return rate and frequency of the recurrence."""
    a, b = 0.5 * alpha * omega * dt, beta * omega * dt
    z = np.roots([1.0 + a, -(2.0 - (omega * dt) ** 2 - b), 1.0 - a - b])[0]
    return -float(np.log(abs(z))) / dt, float(abs(np.angle(z))) / dt


def checks():
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

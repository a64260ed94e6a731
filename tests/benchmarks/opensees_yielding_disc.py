"""The pressurised disc that yields, in OpenSees: deflection of the middle at the six pressures.

    python -m benchmarks.opensees_yielding_disc N_SIDE

The disc and pressures of yielding_disc.py, on our quads: ShellNLDKGQ with five layers of
J2PlateFibre, statics led by the deflection of the middle in steps of 0.1 mm (by load it does not
converge from the flat disc). Needs ``pip install openseespy``.
"""

from __future__ import annotations

import sys
import time

import numpy as np
import openseespy.opensees as ops

from benchmarks.yielding_disc import (
    HARDENING,
    POISSON,
    PRESSURES,
    RADIUS,
    THICKNESS,
    YIELD,
    YOUNG,
)
from shellcut import Pressure
from shellcut.loads.loads import LoadSet
from shellcut.mesh.structured import disc
from shellcut.mitc4.initial_state import initial_state

LAYERS, STEP, UNIT = 5, 0.1, 0.01
"""Layers of the section, step of the deflection [mm], and the pressure of load factor 1 [MPa]."""


def build(n_side: int) -> int:
    """Build the disc under a dead pressure of ``UNIT``; return the tag of the middle node."""
    mesh = disc(RADIUS, n_side=n_side)
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    for k, place in enumerate(mesh.nodes.tolist(), 1):
        ops.node(k, *place)
    for node in mesh.node_set("rim").tolist():
        ops.fix(node + 1, *[1] * 6)
    ops.nDMaterial("J2PlateFibre", 1, YOUNG, POISSON, YIELD, HARDENING, 0.0)
    layers = [value for _ in range(LAYERS) for value in (1, THICKNESS / LAYERS)]
    ops.section("LayeredShell", 1, LAYERS, *layers)
    for k, quad in enumerate(mesh.quads.tolist(), 1):
        ops.element("ShellNLDKGQ", k, *[node + 1 for node in quad], 1)
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    state = initial_state(mesh)
    LoadSet(mesh, [Pressure(UNIT)]).begin_forces(state)
    for node, force in enumerate(state.node.force[: mesh.n_node, 2].tolist(), 1):
        ops.load(node, 0.0, 0.0, force, 0.0, 0.0, 0.0)
    return int(mesh.node_set("centre")[0]) + 1


def main() -> None:
    """Print the pressures and deflections, and the CPU time."""
    middle = build(int(sys.argv[1]))
    ops.constraints("Plain")
    ops.numberer("RCM")
    ops.system("UmfPack")
    ops.test("NormDispIncr", 1e-6, 200)
    ops.algorithm("KrylovNewton")
    ops.integrator("DisplacementControl", middle, 3, STEP)
    ops.analysis("Static")
    began, curve = time.process_time(), [(0.0, 0.0)]
    while curve[-1][0] < PRESSURES[-1]:
        if ops.analyze(1) != 0:
            raise SystemExit(f"OpenSees failed beyond {curve[-1]}")
        curve.append((UNIT * ops.getLoadFactor(1), ops.nodeDisp(middle, 3)))
    pressure, deflection = np.array(curve).T
    at = np.interp(PRESSURES, pressure, deflection)
    print(f"{ops.getNumElements()} quads:", " ".join(f"{value:.4f}" for value in at))
    print(f"{time.process_time() - began:.1f} s of CPU, {len(curve) - 1} steps")


if __name__ == "__main__":
    main()

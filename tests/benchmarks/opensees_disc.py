"""The pressurised disc in OpenSees, run by peers.py in a process of its own.

    python -m benchmarks.opensees_disc FILE ELEMENT OPTION STEP N_STEP

FILE is the model as peers.py writes it. The elements carry no mass: translation and rotation get
the nodal masses of the file, the rotation about the normal too, so that every freedom has a mass
and the system is diagonal.
"""

from __future__ import annotations

import json
import sys
import time

import numpy as np
import openseespy.opensees as ops


def build(file: str, element: str, option: str) -> int:
    """Build the model; return the tag of the middle node."""
    model = np.load(file)
    young, poisson, thickness = model["section"].tolist()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    nodes, masses, inertias = (model[name].tolist() for name in ("nodes", "mass", "inertia"))
    for tag, (place, mass, inertia) in enumerate(zip(nodes, masses, inertias, strict=True), 1):
        ops.node(tag, *place)
        ops.mass(tag, mass, mass, mass, inertia, inertia, inertia)
    for node in model["rim"].tolist():
        ops.fix(node + 1, 1, 1, 1, 1, 1, 1)
    ops.section("ElasticMembranePlateSection", 1, young, poisson, thickness, 0.0)
    for tag, quad in enumerate(model["quads"].tolist(), start=1):
        ops.element(element, tag, *(node + 1 for node in quad), 1, option)
    ops.timeSeries("Constant", 1)
    ops.pattern("Plain", 1, 1)
    for tag, force in enumerate(model["load"].tolist(), start=1):
        ops.load(tag, 0.0, 0.0, force, 0.0, 0.0, 0.0)
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("Diagonal")
    ops.algorithm("Linear")
    ops.integrator("CentralDifference")
    ops.analysis("Transient")
    return int(model["middle"]) + 1


def run(middle: int, step: float, n_step: int) -> tuple[float, list[float]]:
    """Take the steps; return their CPU time [s] and the height of the middle after each [mm]."""
    cpu, heights = 0.0, []
    for k in range(n_step):
        began = time.process_time()
        failed = ops.analyze(1, step)
        # The first step sets the analysis up.
        cpu += (time.process_time() - began) * (n_step / (n_step - 1) if k else 0.0)
        heights.append(ops.nodeDisp(middle, 3))
        if failed or not abs(heights[-1]) < 100.0:
            raise SystemExit(f"OpenSees failed at step {k} of {step} s")
    return cpu, heights


if __name__ == "__main__":
    seconds, path = run(build(*sys.argv[1:4]), float(sys.argv[4]), int(sys.argv[5]))
    print()  # OpenSees leaves its last line open
    print(json.dumps({"cpu": seconds, "heights": path}))

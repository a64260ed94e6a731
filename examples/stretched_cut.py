"""Cutting a stretched film
========================

Stretch a strip across the path of the blade, bring it to rest, then cut it. The stretched film
gives part of the energy of the cut, so the tool does less work. ::

    python examples/stretched_cut.py --out DIR
"""

import argparse
from pathlib import Path

import matplotlib
import numpy as np

import shellcut as sc
from shellcut.meshing import rectangle
from shellcut.tool_shapes import straight_blade

matplotlib.use("Agg")
import matplotlib.pyplot as plt

LENGTH, WIDTH, SIZE = 12.0, 16.0, 0.8  # mm
STRETCH = 0.008  # of the width: 15 MPa across the path, the film tears at 18


def main() -> None:
    parser = argparse.ArgumentParser(description="cut a film as it is, and stretched")
    parser.add_argument("--out", type=Path, required=True, help="folder for the runs")
    out = parser.parse_args().out

    runs = {name: cut(out / name, by) for name, by in (("loose", 0.0), ("stretched", STRETCH))}
    figure, axes = plt.subplots(figsize=(7.0, 3.6), layout="constrained")
    for name, results in runs.items():
        path, work = results.history["path"], results.history["tool_work"]
        axes.plot(path, work, label=name)
        print(f"{name}: work of the tool {work[-1]:.2f} N*mm")
    axes.set(xlabel="way of the blade [mm]", ylabel="work of the tool [N·mm]")
    axes.legend()
    figure.savefig(out / "work.png", dpi=120)


def cut(folder: Path, stretch: float) -> sc.Results:
    mesh = rectangle(LENGTH, WIDTH, size=SIZE)
    middle = mesh.nodes_where(lambda x, y, z: (abs(y) < 1e-9) & (x < 2.0))
    sim = sc.Simulation(
        mesh.cut(middle),
        sc.ShellMaterial.homogeneous(),  # the film of the paper
        supports=[sc.Support.clamped("bottom"), sc.Support.clamped("top")],
        tool=straight_blade(length=LENGTH, height=6.0).translated((-0.05, 0.0, 0.0)),
        motion=sc.StraightMotion((1.0, 0.0, 0.0), speed=6000.0, ramp=1e-4),
        law=sc.CohesiveLaw(),
    )
    if stretch:
        # Move the clamped sides apart, and the nodes between them in proportion.
        displacement = np.zeros((sim.mesh.n_node, 3))
        displacement[:, 1] = stretch * sim.mesh.nodes[:, 1]
        steps = sim.relax(displacement)
        print(f"at rest after {steps} steps")
    until = 1.2e-3
    recorder = sc.Recorder(sim, folder, until=until, name="cut", n_snapshot=0, progress=False)
    sim.run(until, hooks=[recorder])
    return sc.read(folder)


if __name__ == "__main__":
    main()

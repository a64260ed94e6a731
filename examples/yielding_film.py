"""A film that yields
==================

Cut a polyethylene film twice, by the guillotine and in the opening test: once elastic, once with
its yield stress. Where does the work of the tool go, and how much more is it? ::

    python examples/yielding_film.py --out DIR

prints the ledger's shares and draws the plastic strain left beside the cut (edge.png).
"""

import argparse
from pathlib import Path

import matplotlib
import numpy as np

import shellcut as sc
from shellcut.models import Case
from shellcut.results.energy_account import energy_shares

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.collections import PolyCollection

YIELDING = sc.preset_film("ldpe", thickness="74 um")
ELASTIC = sc.preset_film("ldpe", thickness="74 um", law="elastic")
# What parts the drawn film: the essential work of polyethylene in [Frangi2010], 45 kJ/m².
LAW = sc.CohesiveLaw(
    strength=14.0, plateau=12.77, opening_a=0.5, opening_p=3.0, opening_u=4.0, onset=0.005
)


def main() -> None:
    parser = argparse.ArgumentParser(description="cut a film that yields, and an elastic one")
    parser.add_argument("--out", type=Path, required=True, help="folder for the runs")
    parser.add_argument("--size", type=float, default=0.4, help="quads of the guillotine [mm]")
    parser.add_argument("--length", type=float, default=20.0, help="of its strip [mm]")
    parser.add_argument("--angle", type=float, default=95.0, help="of the opening test [deg]")
    parser.add_argument("--mesh", default="quick", help="of the opening test")
    given = parser.parse_args()

    figure, axes = plt.subplots(1, 2, figsize=(9.5, 4.2), layout="constrained")
    for name, ax in zip(("guillotine", "opening"), axes, strict=True):
        runs = {}
        for kind, film in (("elastic", ELASTIC), ("yielding", YIELDING)):
            case = cut(name, film, given)
            case.run(given.out / name / kind, progress=False)
            runs[kind] = sc.read(given.out / name / kind)
        tell(name, runs)
        draw(ax, runs["yielding"])
        ax.set(title=name, xlabel="x [mm]", ylabel="y [mm]", aspect="equal")
    figure.savefig(given.out / "edge.png", dpi=120)


def cut(name: str, film: sc.ShellMaterial, given: argparse.Namespace) -> Case:
    if name == "guillotine":
        return sc.guillotine(given.size, length=given.length, material=film, law=LAW)
    duration = 6e-3 * given.angle / 95.0
    # That of the elastic film, 3.96 strength thickness²: of one that yields it must be measured.
    fracture = sc.Fracture(puncture_force=0.3)
    return sc.opening_test(
        given.mesh,
        angle_deg=given.angle,
        duration=duration,
        material=film,
        law=LAW,
        fracture=fracture,
    )


def tell(name: str, runs: dict[str, sc.Results]) -> None:
    """Print the work of the tool in each film, and where it is at the end."""
    work = {kind: float(run.history["tool_work"][-1]) for kind, run in runs.items()}
    more = work["yielding"] / work["elastic"]
    print(f"{name}: the tool's work on the yielding film is {more:.2f} times that on the elastic")
    for kind, run in runs.items():
        shares = energy_shares(run.history)
        parts = [f"{part} {100 * by[-1] / work[kind]:.1f} %" for part, by in shares.items()]
        print(f"  {kind}: {work[kind]:.3f} N*mm; {', '.join(parts)}")


def draw(ax: plt.Axes, run: sc.Results) -> None:
    """Draw the plastic strain of each quad over its place in the film as it was."""
    frame = run.frame(-1)
    strain = frame.quad_history["equivalent plastic strain [-]"]
    corners = [frame.reference[quad[quad >= 0], :2] for quad in frame.quads]
    quads = PolyCollection(corners, array=100.0 * strain, cmap="viridis")
    quads.set_clim(0.0, max(1.0, float(np.percentile(100.0 * strain, 99.5))))
    ax.add_collection(quads)
    ax.autoscale()
    ax.figure.colorbar(quads, ax=ax, label="plastic strain [%]", shrink=0.8)


if __name__ == "__main__":
    main()

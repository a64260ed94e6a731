"""A film that yields
==================

Cut a polyethylene film twice, by the guillotine and in the opening test: once elastic, once with
its yield stress. Where does the work of the tool go, and how much more is it? ::

    python examples/yielding_film.py --out DIR

prints the ledger's shares and draws the plastic strain left beside the cut (edge.png).
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

import shellcut as sc
from shellcut.results.energy_account import energy_shares

parser = argparse.ArgumentParser(description="cut a film that yields, and an elastic one")
parser.add_argument("--out", type=Path, required=True, help="folder for the runs")
parser.add_argument("--size", type=float, default=0.4, help="quads of the guillotine [mm]")
parser.add_argument("--length", type=float, default=20.0, help="of its strip [mm]")
parser.add_argument("--angle", type=float, default=95.0, help="of the opening test [deg]")
parser.add_argument("--mesh", default="quick", help="of the opening test")
given = parser.parse_args()

# %%
# Model
# -----
# What parts the drawn film is the essential work of polyethylene in [Frangi2010], 45 kJ/m². The
# force at which a tooth pierces a film that yields must be measured; here it is that of the elastic
# one, 3.96 strength thickness².

FILMS = {
    "elastic": sc.preset_film("ldpe", thickness="74 um", law="elastic"),
    "yielding": sc.preset_film("ldpe", thickness="74 um"),
}
LAW = sc.CohesiveLaw(
    strength=14.0, plateau=12.77, opening_a=0.5, opening_p=3.0, opening_u=4.0, onset=0.005
)


def model(name, film):
    if name == "guillotine":
        return sc.guillotine(given.size, length=given.length, material=film, law=LAW)
    return sc.opening_test(
        given.mesh,
        angle_deg=given.angle,
        duration=6e-3 * given.angle / 95.0,
        material=film,
        law=LAW,
        fracture=sc.Fracture(puncture_force=0.3),
    )


# %%
# Run
# ---

runs = {}
for name in ("guillotine", "opening"):
    for kind, film in FILMS.items():
        out = given.out / name / kind
        model(name, film).run(out, progress=False)
        runs[name, kind] = sc.read(out)

# %%
# Picture
# -------
# The plastic strain of each quad over its place in the film as it was, mean over the thickness.

figure, axes = plt.subplots(1, 2, figsize=(9.5, 4.2), layout="constrained", dpi=120)
for name, ax in zip(("guillotine", "opening"), axes, strict=True):
    frame = runs[name, "yielding"].frame(-1)
    strain = 100.0 * frame.quad_history["equivalent plastic strain [-]"]
    corners = [frame.reference[quad[quad >= 0], :2] for quad in frame.quads]
    quads = PolyCollection(corners, array=strain, cmap="viridis")
    quads.set_clim(0.0, max(1.0, float(np.percentile(strain, 99.5))))
    ax.add_collection(quads)
    ax.autoscale()
    figure.colorbar(quads, ax=ax, label="plastic strain [%]", shrink=0.8)
    ax.set(title=name, xlabel="x [mm]", ylabel="y [mm]", aspect="equal")
figure.savefig(given.out / "edge.png")

# %%
# Check
# -----
# Where the work of the tool is at the end. In each run the energies must balance, and in the films
# that yield a fifth of the work at least goes into yielding.

for name in ("guillotine", "opening"):
    work = {kind: float(runs[name, kind].history["tool_work"][-1]) for kind in FILMS}
    more = work["yielding"] / work["elastic"]
    print(f"{name}: the tool's work on the yielding film is {more:.2f} times that on the elastic")
    for kind in FILMS:
        run = runs[name, kind]
        shares = energy_shares(run.history)
        parts = [f"{part} {100 * by[-1] / work[kind]:.1f} %" for part, by in shares.items()]
        print(f"  {kind}: {work[kind]:.3f} N*mm; {', '.join(parts)}")
        assert run.summary["imbalance_rel"] < 5e-3
        plastic = run.history["material_dissipated"][-1] / work[kind]
        assert plastic > 0.2 if kind == "yielding" else plastic == 0.0

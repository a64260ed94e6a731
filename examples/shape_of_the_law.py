"""The shape of the cohesive law at one fracture energy
====================================================

The paper expects that the lengths l_A, l_P and l_U of the law matter little as long as its area,
the fracture energy, stays 43.5 N/mm. Here the opening test is run with laws of very different
shape and this one area: trapezoids, a straight line, and points of one's own. ::

    python examples/shape_of_the_law.py --out DIR

prints how much the torque differs, and draws laws and torques in shape_of_the_law.png.
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt

from shellcut import CohesiveLaw, CohesiveTable, opening_test, read

parser = argparse.ArgumentParser(description="laws of one energy and other shapes")
parser.add_argument("--mesh", default="quick", choices=("quick", "M1", "M2"))
parser.add_argument("--angle", type=float, default=95.0, help="of the whole turn [deg]")
parser.add_argument("--laws", type=int, default=6, help="how many of them")
parser.add_argument("--out", type=Path, required=True, help="folder for the results")
options = parser.parse_args()

# %%
# Model
# -----
# The opening test at the speed of the whole test, and laws of one area.

STRENGTH, PLATEAU, ENERGY = 18.0, 12.0, 43.5  # MPa, MPa, N/mm


def law_of(opening_a: float, opening_p: float) -> CohesiveLaw:
    """Return the law with these lengths [mm], whose last one keeps the energy."""
    # G = (sigma_F - sigma_C) l_A / 2 + sigma_C (l_P + l_U) / 2
    both = 2.0 * (ENERGY - 0.5 * (STRENGTH - PLATEAU) * opening_a) / PLATEAU
    return CohesiveLaw(
        strength=STRENGTH,
        plateau=PLATEAU,
        opening_a=opening_a,
        opening_p=opening_p,
        opening_u=both - opening_p,
    )


def law_through(openings: list[float], tractions: list[float]) -> CohesiveTable:
    """Return the law through points [MPa], whose lengths are scaled so that it has the energy."""
    area = CohesiveTable(openings=openings, tractions=tractions).fracture_energy
    scaled = [opening * ENERGY / area for opening in openings]
    return CohesiveTable(openings=scaled, tractions=tractions)


LAWS = {
    "the paper's": law_of(0.5, 3.0),
    "slow drop": law_of(1.5, 2.5),
    "long tail": law_of(0.5, 1.0),
    "sharp end": law_of(0.1, 3.5),
    "a line": CohesiveTable.linear(strength=STRENGTH, opening_u=2.0 * ENERGY / STRENGTH),
    "two steps": law_through([0.0, 1.0, 1.3, 2.5, 2.8, 4.5], [18.0, 17.0, 11.0, 10.0, 4.0, 0.0]),
}
chosen = list(LAWS)[: options.laws]

# %%
# Run
# ---

runs = {}
for name in chosen:
    out = options.out / name.replace("'", "").replace(" ", "_")
    duration = 6e-3 * options.angle / 95.0
    case = opening_test(options.mesh, angle_deg=options.angle, duration=duration, law=LAWS[name])
    case.run(out, n_snapshot=0, progress=False)
    runs[name] = read(out)

# %%
# Picture
# -------
# The laws, and the torque over the angle with each.

figure, (left, right) = plt.subplots(1, 2, figsize=(11.0, 4.0), layout="constrained", dpi=120)
for name, results in runs.items():
    law = LAWS[name]
    left.plot(law.openings, law.tractions, label=name)
    right.plot(results.history["angle"], results.history["torque"], lw=1.0, label=name)
left.set(xlabel="opening [mm]", ylabel="stress of the cable [MPa]")
right.set(xlabel="angle [deg]", ylabel="torque [N·mm]")
left.legend(frameon=False)
figure.savefig(options.out / "shape_of_the_law.png")

# %%
# Check
# -----
# Every law has the same area, and the mean torques while cutting steadily differ by less than 2 %.

means = {}
for name, results in runs.items():
    assert abs(LAWS[name].fracture_energy / ENERGY - 1.0) < 1e-12
    if "torque_plateau_Nmm" not in results.summary:
        print(f"{name:<12} no steady window: {results.summary['no_window']}")
        continue
    means[name] = results.summary["torque_plateau_Nmm"]
    print(f"{name:<12} mean torque {means[name]:6.1f} N*mm")
if means:
    first = next(iter(means.values()))
    most = max(abs(mean / first - 1.0) for mean in means.values())
    print(f"the means differ from the first by {100.0 * most:.1f} % at most")
    assert most < 0.02

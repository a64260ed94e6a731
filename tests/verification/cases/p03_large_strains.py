"""P03 Large strains: every law pulled, stretched equibiaxially and sheared to a true strain of one.

In a monotonic path the stress is the hardening curve itself: with the equivalent stress q and the
plastic strain ε - q/E' of the path, q = sigma_y(p), exactly and in one step or many.

Source: closed form; the same for all kinds of hardening. The yield stress of Swift's and Voce's law
is that of a table, itself compared with the formula.
"""

import numpy as np

from harness import Check
from shellcut.material import Elastic, Linear, MaterialPoint, Plastic, Swift, Table, Voce

ID, TITLE, FAST = "P03", "Large strains of every law", False

E, NU = 1678.0, 0.3
LAWS = {
    "linear": Linear(15.0, 40.0),
    "Swift": Swift(50.0, 0.002, 0.25),
    "Voce": Voce(15.0, 20.0, 0.1, 5.0),
    "table": Table((0.0, 0.02, 0.2, 1.5), (15.0, 20.0, 30.0, 55.0)),
}
FORMULAE = {
    "linear": lambda p: 15.0 + 40.0 * p,
    "Swift": lambda p: 50.0 * (0.002 + p) ** 0.25,
    "Voce": lambda p: 15.0 + 20.0 * (1.0 - np.exp(-p / 0.1)) + 5.0 * p,
}


def checks() -> list[Check]:
    rows = []
    p = np.append(0.0, np.geomspace(1e-8, 5.0, 5000))
    for name, formula in FORMULAE.items():
        far = float(np.abs(LAWS[name].stress(p) / formula(p) - 1.0).max())
        text = f"yield stress over the formula's, {name}, farthest from 1"
        rows.append(Check(text, 0.0, far, 1e-4, "points of the table", absolute=True))
    for name, hardening in LAWS.items():
        film = Plastic(Elastic(E, NU, 1e-9), hardening)
        for steps in (1, 50):
            pulled, both, sheared = (MaterialPoint(film) for _ in range(3))
            for k in range(1, steps + 1):
                e = k / steps
                state = pulled.pull(e)
                spread = both.strain_to([e, e, 0.0])
                slid = sheared.strain_to([0.0, 0.0, 2.0 * e])
            for kind, q, p, one in (
                ("pull", state.stress[0], 1.0 - state.stress[0] / E, state),
                (
                    "equibiaxial",
                    spread.stress[0],
                    2 * (1 - (1 - NU) * spread.stress[0] / E),
                    spread,
                ),
                (
                    "shear",
                    np.sqrt(3.0) * slid.stress[2],
                    2.0 / np.sqrt(3.0) * (1.0 - (1.0 + NU) * slid.stress[2] / E),
                    slid,
                ),
            ):
                text = f"{name}, {kind}, {steps} steps"
                wanted = float(hardening.stress(p))
                rows.append(Check(f"stress, {text}", wanted, float(q), 1e-8, "closed form"))
                got = one.history["equivalent plastic strain [-]"]
                rows.append(Check(f"plastic strain, {text}", float(p), got, 1e-8, "closed form"))
    return rows

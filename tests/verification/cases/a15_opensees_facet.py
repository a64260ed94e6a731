"""A15 trap: OpenSees' ShellMITC4 is not the MITC4 of 1984 on curved or warped meshes.

That code projects each quad to a flat facet and adds a drilling stiffness; on coarse curved meshes
it is far stiffer, on warped thin ones it locks outright. Our values on the same meshes against its
values, printed beside and never a gate. The two agree in the limit of fine meshes only; on flat
meshes they agree everywhere (A08).

Source: OpenSees 3.7.1, run for the collection.
"""

from cases import a03_scordelis_lo, a04_pinched_cylinder, a05_hemisphere, a06_twisted_beam
from harness import Check

ID, TITLE, FAST = "A15", "Trap: facets of OpenSees' ShellMITC4", False

NORMALISED = {
    "roof": (
        a03_scordelis_lo,
        {4: 0.9172611760835696, 8: 0.9639569277317044, 16: 0.986566167240037},
    ),
    "pinched cylinder": (
        a04_pinched_cylinder,
        {4: 0.34994736967678125, 8: 0.7283139548480351, 16: 0.9251191345150285},
    ),
    "hemisphere": (
        a05_hemisphere,
        {4: 0.13581982671580572, 8: 0.6758970254566824, 16: 0.9692586933519058},
    ),
}
TWISTED = {
    "in plane": {2: 0.0012021012750533786, 4: 0.002732866438622255, 8: 0.004294145666634439},
    "out of plane": {2: 0.0005515483223048288, 4: 0.0009871086438342316, 8: 0.0014316420748140967},
}


def checks() -> list[Check]:
    rows = []
    for name, (case, table) in NORMALISED.items():
        for n, value in table.items():
            quantity, ours = f"{name}, N = {n}, facets", case.deflection(case.patch(n))
            rows.append(Check(quantity, value, ours, 2e-3, "other element", gate=False))
    for load, table in TWISTED.items():
        for n, value in table.items():
            quantity, ours = f"twisted beam {load}, N = {n}, facets", a06_twisted_beam.deflection
            rows.append(Check(quantity, value, ours(load, n), 2e-3, "other element", gate=False))
    return rows

"""C09 NAFEMS FV12, free thin square plate.

10 m x 10 m, t = 0.05 m, E = 200 GPa, nu = 0.3, rho = 8000 kg/m³, all edges free. Read: the
frequencies after the six rigid modes.

Source: NAFEMS FV12 as in FinEtoolsFlexStructures.jl, FV12_vibration_examples.jl. Band as in C04,
and half a digit of the table. The tangent is singular: no support holds the rigid modes.

The table is of thin plates. At t / a = 1 / 200 shear along the free edges lowers the converged
frequencies by 0.1 % (f7: -0.13 % on 96 x 96; -0.04 % with a tenth of the thickness).
"""

import numpy as np

from cases.c04_square_plate_ssss import mesh_band, unit
from harness import Check
from shellcut import ShellMaterial, Statics
from shellcut.mesh.structured import rectangle

ID, TITLE, FAST = "C09", "NAFEMS FV12 free square plate", True

SIDE, N = 1e4, 32  # mm
MATERIAL = ShellMaterial.homogeneous(young=200e3, poisson=0.3, density=8e-9, thickness=50.0)
NAFEMS = [1.622, 2.36, 2.922, 4.19, 4.19, 7.356, 7.356, 7.668]
LAST_DIGIT = [0.0005, 0.005, 0.0005, 0.005, 0.005, 0.0005, 0.0005, 0.0005]


def checks() -> list[Check]:
    plate = Statics(rectangle(SIDE, SIDE, n_x=N, n_y=N), MATERIAL)
    frequency = plate.modes(6 + len(NAFEMS)).frequency
    rigid = float(frequency[5])
    rows = [Check("largest of the rigid modes, Hz", 0.0, rigid, 1e-2, "round-off", absolute=True)]
    for k, value in enumerate(NAFEMS):
        wave_number = np.sqrt(2.0 * np.pi * value / unit(1.0, MATERIAL))
        band = mesh_band(wave_number, SIDE / N) + LAST_DIGIT[k] / value
        ours = float(frequency[6 + k])
        rows.append(Check(f"f{k + 7}, N = {N}, Hz", value, ours, band, "mesh, (k s)²/8, digits"))
    return rows

"""D08 code_aster V6.05.115: inflated disk of Saint Venant-Kirchhoff membrane, w0 = 2448 mm.

A lead only, confidence low: radius, thickness, modulus and pressure are on a page that was not
found, so there is nothing to compute and no check. D01 is the same problem at small slopes.
"""

from harness import Check

ID, TITLE, FAST = "D08", "code_aster inflated disk: definition missing", False


def checks() -> list[Check]:
    return []

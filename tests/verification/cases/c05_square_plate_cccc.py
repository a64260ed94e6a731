"""C05 Square thin plate, clamped on all sides: natural frequencies.

Side a, nu = 0.3, a / h = 1000. Read: omega a² sqrt(rho h / D), first six.

Source: Ritz with Legendre polynomials 10 x 10, exact to about 0.02 % (Leissa 1973: 35.992, an upper
bound). Band as in C04.
"""

from cases.c04_square_plate_ssss import square_checks
from harness import Check
from shellcut import Support

ID, TITLE, FAST = "C05", "Square plate CCCC, frequencies", True

RITZ = [35.9852, 73.3939, 73.3939, 108.2165, 131.5808, 132.2049]


def checks() -> list[Check]:
    return square_checks(RITZ, [Support.clamped(side) for side in ("u0", "u1", "v0", "v1")])

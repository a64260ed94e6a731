"""C06 Square thin plate, one side clamped, the others free: natural frequencies.

Side a, nu = 0.3, a / h = 1000. Read: omega a² sqrt(rho h / D), first six.

Source: Ritz with Legendre polynomials 10 x 10, exact to about 0.02 %; Barton 1951 (code_aster
SDLS01) has upper bounds 0.2 to 0.6 % higher. Band as in C04.
"""

from cases.c04_square_plate_ssss import square_checks
from harness import Check
from shellcut import Support

ID, TITLE, FAST = "C06", "Square plate CFFF, frequencies", True

RITZ = [3.4713, 8.5077, 21.2875, 27.1992, 30.9602, 54.1935]


def checks() -> list[Check]:
    return square_checks(RITZ, [Support.clamped("u0")])

"""The keys of a film that yields, as a section of a model file: :func:`material_section`."""

from __future__ import annotations

from shellcut.arrays import Floats
from shellcut.material.hardening_points import fewer_points

_PER_LINE = 8


def material_section(young: float, plastic_strain: Floats, true_stress: Floats, n: int) -> str:
    """Return ``[material]`` with modulus and hardening table; what is not measured is a comment.

    The curve is true, in MPa, from a plastic strain of 0, increasing; n specimens are behind it.

    Examples
    --------
    >>> import numpy as np
    >>> text = material_section(2000.0, np.array([0.0, 0.1]), np.array([20.0, 30.0]), 5)
    >>> [line for line in text.splitlines() if not line.startswith("#")]
    ... # doctest: +NORMALIZE_WHITESPACE
    ['[material]', 'young = 2000', 'hardening_strain = [', '    0, 0.1,', ']',
     'hardening_stress = [', '    20, 30,', ']']
    """
    strain, stress = fewer_points(plastic_strain, true_stress)
    return "\n".join(
        [
            f"# From {n} specimens, up to the strength; the yield stress stays constant beyond.",
            "# poisson, density and thickness are not measured in a tensile test: give them.",
            "[material]",
            f"young = {young:.6g}",
            "# poisson = 0.4",
            '# density = "0.92 g/cm3"',
            '# thickness = "50 um"',
            *_array("hardening_strain", strain),
            *_array("hardening_stress", stress),
            "",
        ]
    )


def _array(name: str, values: Floats) -> list[str]:
    words = [f"{value:.6g}" for value in values]
    lines = [words[at : at + _PER_LINE] for at in range(0, len(words), _PER_LINE)]
    return [f"{name} = [", *(f"    {', '.join(line)}," for line in lines), "]"]

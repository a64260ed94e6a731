"""A film by name, in Python: :func:`preset_film`."""

from __future__ import annotations

from shellcut.material.shell_material import ShellMaterial

from .errors import guess, listed
from .presets import presets
from .reader import read_model


def preset_film(name: str, **keys: object) -> ShellMaterial:
    """Return a film with published numbers.

    Parameters
    ----------
    name : str
        As in ``[material] preset``, see docs/materials.md.
    **keys
        Other keys of ``[material]``, as ``thickness="12 um"``.

    Raises
    ------
    ValueError
        If there is no such film, or a key is wrong.

    Examples
    --------
    >>> preset_film("pet", thickness="12 um").thickness
    0.012
    """
    if name not in presets():
        raise ValueError(f"there is no film {name!r}{guess(name, presets()) or listed(presets())}")
    overrides = {f"material.{key}": value for key, value in keys.items()}
    model = read_model("opening", {"material": name, **overrides})
    film: ShellMaterial = model.sections["material"].made()
    return film

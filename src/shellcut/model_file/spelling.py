"""Messages of the library in the words of model files and commands: :func:`in_keys`.

Of an option the library speaks as of a key, ``fracture.path``. What only Python has, whoever writes
a model file or a command knows by another name.
"""

from __future__ import annotations

import re

from .source import Source

_OF_PYTHON = {
    "Mesh.cut": "membrane.notch",
    "force=True, on the command line --force": "--force",
    "units=": "--units ",
    "columns=": "--columns ",
    "triangles=": "membrane.triangles = ",
    "such as n=": "such as --n ",
}
_UNIT_OF = re.compile(r"\b(\w+) is in \S+ unless a unit is given: [^;\n]*")
_QUANTITY = re.compile(r"([-+.\deE]+)\s*([^\d\s].*)")


def in_keys(text: str, source: Source | None = None) -> str:
    """Return a message with keys and options in the place of arguments of Python.

    What is said of the unit of a key takes the quantity that the model gives, if it has a unit.

    Examples
    --------
    >>> in_keys('cut along Mesh.cut, or set contact.film_edges = True; give units="deg, N*mm"')
    'cut along membrane.notch, or set contact.film_edges = true; give --units "deg, N*mm"'
    >>> in_keys('the tool is 4 mm across; unit="..." says otherwise')
    'the tool is 4 mm across; tool.unit = "..." says otherwise'
    """
    for argument, key in _OF_PYTHON.items():
        text = text.replace(argument, key)
    title = "tool" if "the tool" in text else "membrane"
    text = re.sub(r"\bunit=(?=[\" ])", f"{title}.unit = ", text).replace("unit =  ", "unit = ")
    text = text.replace(" = True", " = true")
    return text if source is None else _UNIT_OF.sub(lambda found: _as_given(found, source), text)


def _as_given(found: re.Match[str], source: Source) -> str:
    """Return what is said of the unit of a key, with the quantity that is given."""
    tables = (table for table in source.values.values() if isinstance(table, dict))
    for given in (table[found[1]] for table in tables if found[1] in table):
        if isinstance(given, str) and (quantity := _QUANTITY.fullmatch(given)):
            smaller = f"{1e-3 * float(quantity[1]):g} {quantity[2]}"  # a slip of one SI prefix
            return f"you gave {given}; did you mean {smaller}?"
    return found[0]

"""Model files: a TOML file that says everything about a run.

:func:`read_model` reads and checks it, :meth:`Model.build` makes the case, :meth:`Model.write`
writes it with every default filled in.

May import ``models`` and rows below.
"""

from .errors import ModelFileError
from .model import Model
from .reader import read_model, shipped_models

__all__ = ["Model", "ModelFileError", "read_model", "shipped_models"]

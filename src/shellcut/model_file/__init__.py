"""Model files: a TOML file that describes a run completely.

:func:`read_model` reads and checks the file, :meth:`Model.build` builds the case,
:meth:`Model.write` writes the model with every default filled in. :mod:`.build` says how a value
gets from the file to a kernel.

May import ``models`` and the layers below.
"""

from .model import Model
from .reader import preset_film, read_model, shipped_models
from .source import ModelFileError

__all__ = ["Model", "ModelFileError", "preset_film", "read_model", "shipped_models"]

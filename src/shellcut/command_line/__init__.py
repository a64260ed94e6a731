# PYTHON_ARGCOMPLETE_OK
"""The ``shellcut`` command: one file per subcommand; each calls the public Python interface.

May import everything.
"""

from .main import main

__all__ = ["main"]

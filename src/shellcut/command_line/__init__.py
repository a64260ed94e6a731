"""The ``shellcut`` command: one file a subcommand, each of them calls of the Python face.

May import everything.
"""

from .main import main

__all__ = ["main"]

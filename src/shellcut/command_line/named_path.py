"""Paths given as arguments."""

from __future__ import annotations

import argparse
from pathlib import Path


def named(text: str) -> Path:
    """Return the path of an argument, for ``type=named``.

    Raises
    ------
    ArgumentTypeError
        If it is empty, which would stand for the present folder.
    """
    if not text:
        raise argparse.ArgumentTypeError("must have a name, got an empty one")
    return Path(text)

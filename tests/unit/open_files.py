"""Which files this process has open."""

import os
from pathlib import Path

import pytest


def is_open(path):
    """Whether this process has a file open; skips the test where the system does not tell."""
    told = Path("/proc/self/fd")
    if not told.is_dir():
        pytest.skip("needs /proc")
    links = []
    for one in told.iterdir():
        try:
            links.append(os.readlink(one))
        except FileNotFoundError:  # that of the listing itself
            continue
    return str(Path(path).resolve()) in links

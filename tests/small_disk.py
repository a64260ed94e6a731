"""Disks and files that fill up, for tests of what is left then."""

import errno
import os
import subprocess
from contextlib import contextmanager

import pytest

REFUSAL = "|".join(os.strerror(number) for number in (errno.ENOSPC, errno.EFBIG))
"""What the system says then, as a pattern."""


@contextmanager
def small_disk(folder, kilobytes=6000):
    """Make a folder a disk of its own, and yield it; skip the test where one may not."""
    folder.mkdir(exist_ok=True)
    mount = ["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "tmpfs", str(folder)]
    try:
        done = subprocess.run(mount, capture_output=True, text=True, check=False)
    except FileNotFoundError:
        pytest.skip("needs the command mount")
    if done.returncode:
        pytest.skip(f"needs the right to mount a disk: {done.stderr.strip()}")
    try:
        yield folder
    finally:
        subprocess.run(["umount", "-l", str(folder)], check=True)


@contextmanager
def files_of_at_most(n_byte):
    """Let the system refuse to write beyond a size, as it does beyond the end of a disk."""
    resource = pytest.importorskip("resource", reason="needs limits on the size of files")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (n_byte, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)

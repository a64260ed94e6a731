"""Give Numba a cache of its own for these very sources, before anything imports it.

A cached caller does not see an edit in a kernel that it imports, hence the name of the cache is a
hash of the sources. The environment's NUMBA_CACHE_DIR, if given, is left alone.
"""

import getpass
import hashlib
import importlib.util
import os
import sys
import tempfile
from pathlib import Path


def _source_folder():
    # The package that the tests will import, found without importing it.
    spec = importlib.util.find_spec("shellcut")
    if spec is None or spec.origin is None:
        return Path(__file__).parent.parent / "src" / "shellcut"
    return Path(spec.origin).parent


def _digest(folder):
    digest = hashlib.sha256()
    for path in sorted(folder.rglob("*.py")):
        digest.update(path.relative_to(folder).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


os.environ["SHELLCUT_CHECK_TYPES"] = "1"

if "NUMBA_CACHE_DIR" not in os.environ:
    assert "numba" not in sys.modules, "numba was imported before its cache could be named"
    cache = Path(tempfile.gettempdir()) / f"shellcut-numba-{getpass.getuser()}"
    os.environ["NUMBA_CACHE_DIR"] = str(cache / _digest(_source_folder()))

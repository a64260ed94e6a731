"""The distribution: its name on the package index, its version, and what installs its extras."""

from importlib import import_module
from importlib.metadata import PackageNotFoundError, distribution, version
from pathlib import Path
from typing import Any

DISTRIBUTION = "shellcut-fem"
VERSION = version(DISTRIBUTION)


def pip_install(*extras: str) -> str:
    """Return the command that installs extras, quoted for a shell.

    Examples
    --------
    >>> pip_install("mesh")
    "pip install 'shellcut-fem[mesh]'"
    """
    return f"pip install '{DISTRIBUTION}[{','.join(extras)}]'"


def optional(package: str, needed: str, *extras: str, instead: str = "") -> Any:
    """Return an optional package.

    The ImportError says for what it is ``needed``, which extras install it, and what is there
    ``instead``.
    """
    try:
        return import_module(package)
    except ImportError as error:
        raise ImportError(f"{needed}: {pip_install(*extras)}{instead}") from error


def another_project() -> str:
    """Return what to do where the index's project ``shellcut`` shares our folder, else ""."""
    try:
        other = distribution("shellcut")
    except PackageNotFoundError:
        return ""
    package = Path(__file__).resolve().parents[1]
    if Path(str(other.locate_file("shellcut"))).resolve() != package:
        return ""
    return (
        f"another project, shellcut {other.version}, is installed in the same folder, {package}, "
        f"and replaces files of {DISTRIBUTION}: run pip uninstall shellcut {DISTRIBUTION}, then "
        f"pip install {DISTRIBUTION}"
    )

"""The distribution: its name on the package index, its version, and what installs its extras."""

from importlib.metadata import PackageNotFoundError, distribution, version
from pathlib import Path

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


def refuse_another() -> None:
    """Raise ImportError where the index's other project ``shellcut`` is in the same folder."""
    try:
        other = distribution("shellcut")
    except PackageNotFoundError:
        return
    package = Path(__file__).resolve().parents[1]
    if Path(str(other.locate_file("shellcut"))).resolve() == package:
        raise ImportError(
            f"another package, shellcut {other.version}, is installed in the folder {package} and "
            f"replaces files of {DISTRIBUTION}: run pip uninstall shellcut {DISTRIBUTION}, then "
            f"pip install {DISTRIBUTION}"
        )

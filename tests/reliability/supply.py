"""What the package brings with it, and what it does with the network and other programs."""

import functools
import shutil
import subprocess
import sys
from importlib.metadata import PackageNotFoundError, distribution

import pytest
from packaging.requirements import Requirement

from shellcut.files.distribution import DISTRIBUTION

from . import tiny
from .trial import Trial, begin, command

SHARE = 1
ROWS = {
    "licences": (
        "each package of the plain install and of the extras states a licence that asks nothing of "
        "those who use it; Gmsh's, an extra, is the GPL",
        "`supply.py`",
    ),
    "network": ("a command opens no address and starts no other program", "`supply.py`"),
    "Dask": ("`--dask local` listens on the loopback only", "`supply.py`"),
    "vulnerabilities": ("no package has a known vulnerability", "`pip-audit`"),
}
# Words of licences that ask for no more than to be named, or for the source of their own files.
FREE = ("mit", "bsd", "apache", "psf", "python software", "mpl", "isc", "hpnd", "zlib")
GPL = {"gmsh"}
EVENTS = ("socket.connect", "socket.bind", "socket.getaddrinfo", "urllib.Request")
EVENTS += ("subprocess.Popen", "os.system", "os.exec", "os.posix_spawn")
COMMANDS = ("run", "resume", "verify", "report", "view", "doctor", "keys")


def installed(extra):
    """Return the licences of the packages that an install with an extra needs, by name."""
    found, waiting = {}, [(DISTRIBUTION, extra)]
    while waiting:
        name, of = waiting.pop()
        try:
            package = distribution(name)
        except PackageNotFoundError:
            pytest.skip(f"{name} is not installed")
        found[name] = licence_of(package.metadata)
        for needed in map(Requirement, package.requires or ()):
            asked = not needed.marker or needed.marker.evaluate({"extra": of})
            if asked and needed.name.lower() not in found:
                waiting.append((needed.name.lower(), ",".join(needed.extras)))
    return found


def licence_of(metadata):
    """Return what a package states as its licence: an expression, a class, the text's start."""
    classes = [c for c in metadata.get_all("Classifier") or () if c.startswith("License ::")]
    text = (metadata.get("License") or "")[:60]
    return " ".join([metadata.get("License-Expression") or "", *classes, text]).lower()


def licences(extra, folder):
    found = installed(extra)
    strict = {n: found[n] for n in found if n not in GPL and not any(w in found[n] for w in FREE)}
    assert not strict, f"{strict} of {len(found)} packages"


def alone(word, folder):
    """Do a command, and fail if it meets the network or another program."""
    seen, out = folder / "seen", folder / "out"

    def before():
        def hook(event, given):
            if event in EVENTS:
                with seen.open("a") as file:
                    file.write(f"{event} {given[:1]}\n")

        sys.addaudithook(hook)

    argv = {"run": [*tiny.words("run"), "-o", str(out)], "doctor": ["doctor"], "keys": ["keys"]}
    if word not in argv:
        shutil.copytree(tiny.whole("run"), out)
    command(argv.get(word, [word, str(out)]), folder, before).expect(0)
    assert not seen.exists(), seen.read_text()


def dask(folder):
    pytest.importorskip("distributed")
    psutil = pytest.importorskip("psutil")
    argv = [word for word in tiny.words("sweep") if word != "--jobs=1"]
    child = begin([*argv, "--dask=local", "-o", str(folder / "out")], folder)
    seen, process = set(), psutil.Process(child.pid)
    while not any((folder / "out").rglob("summary.json")) and process.status() != "zombie":
        for one in [process, *process.children(recursive=True)]:
            seen |= {c.laddr.ip for c in one.net_connections("inet") if c.status == "LISTEN"}
    child.wait(240).expect(0)
    assert seen == {"127.0.0.1"}, seen


def vulnerabilities(folder):
    pytest.importorskip("pip_audit", reason="not checked here: pip-audit is not installed")
    listed = folder / "requirements.txt"
    listed.write_text("".join(f"{n}=={distribution(n).version}\n" for n in installed("")))
    audit = [sys.executable, "-m", "pip_audit", "--no-deps", "-r", str(listed)]
    done = subprocess.run(audit, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


EXTRAS = ("", "plot", "movie", "mesh", "optimise", "sweep", "outline")


def trials():
    for extra in EXTRAS:
        yield Trial("licences", f"extra {extra!r}", functools.partial(licences, extra))
    for word in COMMANDS:
        yield Trial("network", word, functools.partial(alone, word))
    yield Trial("Dask", "listens", dask)
    yield Trial("vulnerabilities", "plain install", vulnerabilities)

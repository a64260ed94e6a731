"""The distribution is shellcut-fem: what tells to install it, what is beside it, what it is for."""

import ast
import importlib.util
import re
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import pytest

import shellcut
from shellcut.files.distribution import DISTRIBUTION, another_project, pip_install

ROOT = Path(__file__).resolve().parents[2]
PROJECT = (ROOT / "pyproject.toml").read_text(encoding="utf-8")

READ = {".md", ".rst", ".py", ".sh", ".toml", ".yml", ".yaml", ".cff", ".html", ".js", ""}
FOLDERS = ("src", "docs", "tests", "examples", ".ci", ".github")
INSTALL = re.compile(r"\bpip3? install\b(?= )")
WORD = re.compile(r" +('[^']*'|\"[^\"]*\"|[^\s`\"';|)&,\\]+)")
WITH_VALUE = ("-p", "--resolution", "--find-links")

LIBRARIES = {
    *("build", "build123d", "cadquery", "matplotlib", "numba", "openseespy", "scikit-learn"),
    *("twine", "uv", "wheel"),
}
"""What else a text may tell to install: libraries and tools."""

EXTRAS = set(re.findall(r"^(\w+) = \[.*\]$", PROJECT.split("optional-dependencies]")[1], re.M))


def written():
    """Yield the files whose texts a user or a machine follows."""
    for path in [*ROOT.glob("*.md"), *ROOT.glob("*.cff"), *ROOT.glob(".*.yaml")]:
        yield path
    for folder in FOLDERS:
        for path in sorted((ROOT / folder).rglob("*")):
            ours = not {"__pycache__", "gallery"} & set(path.parts) and path != Path(__file__)
            if ours and path.is_file() and path.suffix in READ:
                yield path


def targets(text):
    """Yield what pip is told to install by the command at the start of a text, as written.

    That is the first word that is no option, and quoted words after it; plain words after it may
    belong to the sentence. What a program puts in is left out.
    """
    at, before, first = 0, "", True
    while match := WORD.match(text, at):
        at, word = match.end(), match[1]
        if before not in WITH_VALUE and not word.startswith("-"):
            if not first and word[0] not in "'\"":
                return
            first = False
            if not {"$", "{"} & set(word):
                yield word
        before = word


def wrong(target):
    """Return why a target is not ours, this folder, or a library."""
    bare = target.strip("'\"")
    name, _, inside = bare.partition("[")
    extras = set(inside.rstrip("]").split(",")) if inside else set()
    if extras and bare == target:
        return f"{target} has no quotes: zsh takes brackets for a pattern"
    if name not in (DISTRIBUTION, ".") and re.split("[=<>]", name)[0] not in LIBRARIES:
        return f"{target} is not {DISTRIBUTION}, a folder or a library"
    return f"{target}: no such extra" if extras - EXTRAS else ""


def wrong_commands(text):
    """Yield what is wrong in the commands of a text."""
    flat = re.sub(r"\n[#>*\s]*", " ", text).replace("\\[", "[").replace("\\]", "]")
    for match in INSTALL.finditer(flat):
        yield from filter(None, map(wrong, targets(flat[match.end() :])))


def test_nothing_else_is_told_to_be_installed_nor_an_extra_of_the_other_project():
    texts = {path: path.read_text(encoding="utf-8", errors="replace") for path in written()}
    other = re.compile(rf"\bshellcut\\?\[({'|'.join(EXTRAS)})\b")
    assert [path for path, text in texts.items() if other.search(text)] == []
    found = {str(path.relative_to(ROOT)): [*wrong_commands(text)] for path, text in texts.items()}
    assert {path: what for path, what in found.items() if what} == {}
    assert sum(len(INSTALL.findall(text)) for text in texts.values()) > 25


@pytest.mark.parametrize(
    ("command", "said"),
    [
        ("pip install shellcut", "shellcut"),
        ("pip install -U 'shellcut[plot]'", "'shellcut[plot]'"),
        ("pip install shellcut-fem[plot]", "zsh"),
        ("pip install 'shellcut-fem[plots]'", "plots"),
        ("pip install 'shellcut-fem[plot,mesh]'", ""),
        ("pip install -e '.[test]' && pytest", ""),
        ("pip install matplotlib", ""),
    ],
)
def test_what_is_wrong_is_found(command, said):
    found = [*wrong_commands(f"Run {command} and go on")]
    assert [said in one for one in found] == ([True] if said else [])


def extras_named():
    """Yield the extras that the code names, where it asks for a package or says how to get it."""
    for path in (ROOT / "src").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            match node:
                case ast.Call(func=ast.Name("pip_install"), args=extras):
                    pass
                case ast.Call(func=ast.Name("optional"), args=[_, _, *extras]):
                    pass
                case _:
                    continue
            yield from (one.value for one in extras if isinstance(one, ast.Constant))


def test_name_version_and_extras_are_those_of_the_project():
    assert re.search('^name = "(.*?)"', PROJECT, re.M)[1] == DISTRIBUTION == "shellcut-fem"
    assert re.search('^version = "(.*?)"', PROJECT, re.M)[1] == version(DISTRIBUTION)
    assert shellcut.__version__ == version(DISTRIBUTION)
    named = set(extras_named())
    assert {"plot", "mesh", "outline", "sweep", "optimise", "movie"} <= named <= EXTRAS
    assert pip_install("plot", "mesh") == "pip install 'shellcut-fem[plot,mesh]'"
    assert re.findall('"Operating System :: (.*)"', PROJECT) == ["POSIX :: Linux"]


# ---------------------------------------------------------------- the other project of that name


@pytest.fixture
def beside(tmp_path):
    """Return a folder of packages with the index's ``shellcut``."""
    info = tmp_path / "shellcut-0.2.1.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: shellcut\nVersion: 0.2.1\n")
    return tmp_path


def test_a_start_with_the_other_project_in_the_same_folder_is_refused(beside):
    (beside / "shellcut").symlink_to(ROOT / "src" / "shellcut")
    start = f"import sys; sys.path.insert(0, {str(beside)!r})\n"
    start += "from shellcut.command_line import main; raise SystemExit(main(['--version']))"
    done = subprocess.run([sys.executable, "-c", start], capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stdout == ""
    (line,) = done.stderr.splitlines()
    assert line.startswith(
        "refused: another project, shellcut 0.2.1, is installed in the same folder"
    )
    assert "pip uninstall shellcut shellcut-fem, then pip install shellcut-fem" in line


def test_in_another_folder_it_does_no_harm(beside, monkeypatch):
    monkeypatch.syspath_prepend(beside)
    assert version("shellcut") == "0.2.1"
    assert another_project() == ""


# ---------------------------------------------------------------- the wheel of a release


def _release():
    spec = importlib.util.spec_from_file_location("release", ROOT / ".ci" / "release.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class _Numba:
    def __init__(self, *tags):
        self.tags = tags

    def read_text(self, _):
        return "Wheel-Version: 1.0\n" + "".join(f"Tag: cp311-cp311-{one}\n" for one in self.tags)


def _tags(tmp_path, release):
    file = tmp_path / "shellcut_fem-0.2.0.dist-info" / "WHEEL"
    file.parent.mkdir(exist_ok=True)
    file.write_text("Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n")
    release.tag_for_this_platform(tmp_path)
    text = file.read_text()
    assert "Root-Is-Purelib: false\n" in text
    return re.findall("^Tag: (.*)$", text, re.M)


def test_a_wheel_with_kernels_is_for_the_platforms_of_numba(tmp_path, monkeypatch):
    release = _release()
    with monkeypatch.context() as built_here:
        built_here.setattr(release, "distribution", lambda _: _Numba("linux_x86_64"))
        with pytest.raises(SystemExit, match=r"install Numba's wheel"):
            _tags(tmp_path, release)
    named = ("manylinux_2_27_x86_64", "manylinux_2_28_x86_64")
    monkeypatch.setattr(release, "distribution", lambda _: _Numba(*named))
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    assert _tags(tmp_path, release) == [f"{python}-{python}-{one}" for one in named]


@pytest.mark.skipif(sys.platform != "linux", reason="the tags of Linux")
def test_a_package_index_takes_the_tags(tmp_path):
    """``linux_x86_64`` it refuses: that names no version of the C library."""
    for tag in _tags(tmp_path, _release()):
        assert re.fullmatch(r"cp3\d+-cp3\d+-(many|musl)linux(20\d\d|_\d+_\d+)_\w+", tag), tag

"""What the pages tell a user to type runs, in the order of the page, and leaves what the page says.

Each page has a new folder, with the files that it takes as the user's own. All of them, in twenty
minutes:

    pytest -m "" -n 0 -s tests/unit/test_pages.py
"""

import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from films import unstructured_disc, write_gmsh
from shellcut import read_model
from shellcut.command_line import main
from shellcut.command_line.main import parser_of_all
from shellcut.command_line.shared import keys_with_values
from shellcut.model_file import shipped_models
from shellcut.study.plan import sought
from shellcut.tool.shapes import tooth_ring
from test_tensile import bilinear
from test_tensile import write as write_film

ROOT = Path(__file__).resolve().parents[2]
SHELL = {k: v for k, v in os.environ.items() if k not in {"DISPLAY", "WAYLAND_DISPLAY"}}
SHELL["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{SHELL['PATH']}"

NOT_RUN = {
    "pip install": "takes packages from an index, as tests/acceptance/run.py does",
    ".venv/bin/shellcut doctor": "of that environment; tests/acceptance/run.py runs it there",
    "from build123d": "a package of 300 MB; the caps are teeth of shellcut instead",
    "python caps.py": "the same",
    "from harness": "a file of the sources, which the command below it runs",
    "python tests/reliability": "an hour; test_reliability.py makes a few trials of each kind",
    "plate.load_steps([1.31])": "three lines on a plate, which test_statics.py has",
}
"""Parts of commands and of Python that are not run, and why."""

SHORTER = {
    "shellcut fit opening": "--set mesh=quick --set motion.angle_deg=20 --max-runs 12",
    "shellcut fit guillotine": "--set travel=3 --max-runs 12",
    "shellcut optimise": "--max-runs 5",
    "--design sobol": "--n 4",
    "benchmarks/run.py": "--quick",
    "shellcut run oscillating": "--set membrane.size=1 --set membrane.length=40",
    "oscillating_cut.py": "--size 1 --length 7",
}
"""Options that are added to commands that take longer than three minutes; their verdict is not
read, for a run may be too short for it."""


def shell(line, folder, shorter=""):
    """Run a line as a shell does; return the line, its time and what it says."""
    begin = time.perf_counter()
    command = ["bash", "-c", f"{line} {shorter}"]
    pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
    done = subprocess.run(command, cwd=folder, env=SHELL, text=True, timeout=1200, **pipes)
    assert done.returncode == 0, f"{line}: exit code {done.returncode}\n{done.stdout}"
    wrong = "Traceback|PROBLEM" if shorter else "Traceback|PROBLEM|distrust:"
    assert not re.search(wrong, done.stdout), f"{line}\n{done.stdout}"
    return f"{time.perf_counter() - begin:6.1f} s  {line}\n{done.stdout}"


# ---------------------------------------------------------------------- what a user has


def a_run(folder):
    kept = folder.parent / "a_run"  # of the first page that reads one
    if not kept.exists():
        kept.mkdir()
        short = "--set mesh=quick --set motion.angle_deg=20 --set motion.duration=1.3e-3"
        shell(f"shellcut run opening {short} --frames 20 --no-pictures -o out", kept)
    shutil.copytree(kept / "out", folder / "out")


def a_stopped_run(folder):
    command = [shutil.which("shellcut", path=SHELL["PATH"]), "run", "opening", "--set"]
    running = subprocess.Popen([*command, "mesh=quick", "-o", "out"], cwd=folder, env=SHELL)
    history = folder / "out" / "history.csv"
    while running.poll() is None and not (history.exists() and history.stat().st_size > 20_000):
        time.sleep(0.05)
    running.terminate()
    assert running.wait() == -signal.SIGTERM


def curves(*names, heading="Winkel [Grad];Drehmoment [Ncm]", end=20.0, height=14.0):
    """Return what writes measured curves that rise to a plateau."""

    def write(folder):
        x = np.linspace(0.0, end, 101)
        y = height * (1.0 - np.exp(-6.0 * x / end))
        rows = [heading, *(f"{a:.4f};{b:.4f}" for a, b in zip(x, y, strict=True))]
        for name in names:
            (folder / name).write_text("\n".join(rows))

    return write


def tensile_test(folder):
    write_film(folder / "md.csv", *bilinear(noise=0.05))


def text_of(page, name):
    """Return what writes the first text block of the page."""

    def write(folder):
        (folder / name).write_text(blocks(page, "text")[0][1])

    return write


def a_disc(folder):
    pytest.importorskip("gmsh", exc_type=ImportError)  # the page has an outline meshed, too
    write_gmsh(folder / "disc.msh", unstructured_disc(spacing=1.3), rim="rim", quads="film")


def a_cap(folder):
    tooth_ring().write(folder / "cap.stl")


def caps(folder):
    (folder / "caps").mkdir()
    for angle in (45, 60, 75):
        tooth_ring(edge_inclination_deg=angle).write(folder / "caps" / f"cap_{angle}.stl")


def a_case(folder):
    shutil.copytree(ROOT / "tests" / "verification", folder / "tests" / "verification")
    for shared in (ROOT / "tests").glob("*.py"):  # what cases share with other tests
        shutil.copy(shared, folder / "tests")
    file = folder / "tests" / "verification" / "cases" / "z01_cantilever.py"
    file.write_text(blocks("docs/howto/add-a-case.md", "python")[0][1])


def sources(folder):
    for name in ("tests", "docs", "examples"):
        (folder / name).symlink_to(ROOT / name)


# ---------------------------------------------------------------------- the pages


@dataclass
class Page:
    """What a page takes as the user's, what its code says, and the files that it leaves."""

    given: tuple = ()
    said: str = ""
    left: str = ""


QUICK = {"README", "add-a-case", "compare", "hand-built", "pierce", "read-results", "tensile"}
QUICK |= {"trust", "install", "statics"}
"""Pages that the default tests run, in some seconds each."""


PAGES = {
    "README.md": Page(said="crack .*\nlargest torque (.*\n)*crack .*\nimbalance 0", left="out"),
    "docs/command-line.md": Page(
        (curves("slow.csv", "fast.csv", "cap.csv"), tensile_test),
        said="notch",
        left="out/report.html bars OUT/fit.json OUT/optimum.json out/comparison.json cut.mp4 film",
    ),
    "docs/first-cut.md": Page(
        said=r"largest torque 1[5-8]\d N.mm\ncrack",
        left="out/torque.png out/energy.png out/history.csv out/opening.vtkhdf out/summary.json "
        "out/used.toml out/checkpoint.h5 out/run.log mine.toml model.png mine/report.html",
    ),
    "docs/howto/add-a-case.md": Page((a_case,), said="all pass"),
    "docs/howto/compare.md": Page(
        (a_run, text_of("docs/howto/compare.md", "cap.csv")),
        said="peak torque",
        left="out/comparison.json out/comparison.png",
    ),
    "docs/howto/converge.md": Page(
        said="force, mean over the steady window.* 3.23", left="bars/report.html"
    ),
    "docs/howto/data-sheet.md": Page(said=r"G 5\.6 N/mm, legs yield below 8\.82 mm"),
    "docs/howto/fit.md": Page(
        (
            curves("cap.csv", "slow.csv", "fast.csv", "steep.csv"),
            curves("sharp.csv", "blunter.csv", heading="path [mm];force [N]", end=3.0, height=0.4),
        ),
        said="95 % interval",
        left="OUT/fit.json OUT/fit.png",
    ),
    "docs/howto/hand-built.md": Page(
        # the deflection lies between that of a beam, 0.2193 mm, and of a plate, 0.1996 mm
        said=r"film 1\.[34]\d N mm\nResults of 'cut' in .*out(.*\n)*deflection 0\.2[01]",
        left="yielding/summary.json",
    ),
    "docs/howto/loose.md": Page(
        (a_run,), said=r"^[\d.]+ 0\.0 4\.0 [\d.]+$", left="teeth/optimum.json"
    ),
    "docs/howto/model-file.md": Page(said=r"Mesh\(", left="cap.toml cap.png out used.toml"),
    "docs/howto/optimise.md": Page(
        (caps,),
        said="at best",
        left="teeth/optimum.png thickness/optimum.json cap.png caps_out/optimum.json",
    ),
    "docs/howto/own-film.md": Page(
        (a_disc,),
        said=r"node_sets=\['rim'\], quad_sets=\['film'\](.*\n)*\['hole_1', 'outline', 'rim'\]",
        left="film.png out",
    ),
    "docs/howto/own-tool.md": Page(
        (a_cap, text_of("docs/howto/own-tool.md", "motion.csv")),
        said=r"(cutting edge \d \(not_cutting = \[\d\]\) of body \d: 15 segments.* open.*\n){4}",
        left="cap.png out",
    ),
    "docs/howto/pictures.md": Page(
        (a_run, curves("cap.csv")),
        left="out/view.html cut.html cut.webp film.png out/report.html crack.png scene.png",
    ),
    "docs/howto/pierce.md": Page(said=r"0\.3909\d*\n0\.2162\d*\n{'piercing_force_1_N': 0\.393"),
    "docs/howto/read-results.md": Page((a_run,), said="Results of 'opening'", left="torque.png"),
    "docs/howto/resume.md": Page((a_stopped_run,), left="out/summary.json checkpoint.h5"),
    "docs/howto/seal.md": Page(),
    "docs/howto/sharp.md": Page(
        said=r"radius 0\.02 mm severs cables at 14\.4 N/mm; from 0\.2625 mm", left="sharp"
    ),
    "docs/howto/slow.md": Page(left="out slow_0.004 slow_0.001 fast"),
    "docs/howto/studies.md": Page(left="out/report.html out/table.csv wedges/report.html openings"),
    "docs/howto/tear.md": Page(left="out thin tear.toml"),
    "docs/howto/tensile.md": Page(
        (tensile_test,), said="strength  ", left="film/material.toml film/tensile.png md.png"
    ),
    "docs/howto/trust.md": Page(said="stays=True"),
    "docs/index.md": Page(said=r"largest torque 1\d\d N.mm\ncrack", left="out/report.html"),
    "docs/install.md": Page(left=".venv"),
    "docs/materials.md": Page(left="out/summary.json"),
    "docs/performance.md": Page((sources,), left="results.json results/performance.md"),
    "docs/questions.md": Page(
        (tensile_test,),
        left="meshes/table.csv speeds/table.csv friction/table.csv film out/report.html",
    ),
    "docs/reliability.md": Page(),
    "docs/theory/oscillating.md": Page((sources,), left="out/wave.webp out/wave.png out9"),
    "docs/theory/statics.md": Page(),
}


def blocks(page, languages="sh|python"):
    """Return language and text of the blocks of a page."""
    text = (ROOT / page).read_text(encoding="utf-8")
    return re.findall(rf"```({languages})\n(.*?)```", text, re.S)


def commands(block):
    """Return the commands of a block of the shell."""
    return [line for line in block.replace("\\\n", " ").splitlines() if line.strip()]


def is_run(code):
    return not any(part in code for part in NOT_RUN)


@pytest.mark.skipif(not shutil.which("bash"), reason="the commands are those of a POSIX shell")
@pytest.mark.parametrize(
    "name",
    [pytest.param(k, marks=[] if Path(k).stem in QUICK else [pytest.mark.slow]) for k in PAGES],
)
def test_page(name, tmp_path, monkeypatch, capsys, caplog):
    page, said, names = PAGES[name], "", {}
    monkeypatch.chdir(tmp_path)
    for make in page.given:
        make(tmp_path)
    for language, block in blocks(name):
        if language == "python" and is_run(block):
            capsys.readouterr()
            exec(compile(block, name, "exec"), names)
            said += capsys.readouterr().out
        elif language == "sh":
            for line in filter(is_run, commands(block)):
                shorter = " ".join(options for part, options in SHORTER.items() if part in line)
                said += shell(line.partition(" #")[0], tmp_path, shorter)
    print(said)
    assert re.search(page.said, said, re.MULTILINE), f"nothing like {page.said!r}"
    assert [left for left in page.left.split() if not (tmp_path / left).exists()] == []
    doubts = [r.getMessage() for r in caplog.records if r.name.startswith("shellcut.checks")]
    assert [text for text in doubts if text.startswith("distrust")] == []


def test_every_page_with_code_is_run():
    pages = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    with_code = [p.relative_to(ROOT).as_posix() for p in pages if blocks(p)]
    assert with_code == list(PAGES)
    code = "\n".join(block for page in PAGES for _, block in blocks(page))
    assert [part for part in (*NOT_RUN, *SHORTER) if part not in code] == []


SHELLCUT_LINES = [
    line.strip()
    for page in PAGES
    for _, block in blocks(page, "sh")
    for line in commands(block)
    if line.startswith("shellcut ")
]


@pytest.mark.parametrize("line", SHELLCUT_LINES)
def test_commands_are_understood(line, tmp_path, monkeypatch, capsys):
    words = shlex.split(line, comments=True)[1:]
    arguments = parser_of_all().parse_args(words)
    monkeypatch.chdir(tmp_path)
    if getattr(arguments, "model", None) not in shipped_models():
        return
    if arguments.command == "sweep":
        assert main([*words, "--dry-run"]) == 0, capsys.readouterr().err
    elif arguments.command in ("fit", "optimise"):
        sought(arguments.model, keys_with_values("--set", arguments.settings, str))
    else:
        settings = keys_with_values("--set", arguments.settings)
        for file in (str(v) for v in settings.values() if re.search(r"\.(stl|msh)$", str(v))):
            Path(file).parent.mkdir(exist_ok=True)
            Path(file).touch()
        assert read_model(arguments.model, settings).head.model == arguments.model

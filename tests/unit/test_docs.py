"""The documents tell the truth: links, citations, the import table, the README's model."""

import ast
import importlib
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
KEY = re.compile(r"\[([A-Z][A-Za-z]+(?:19|20)\d\d)\]")


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_links_lead_somewhere(page):
    for target in re.findall(r"\]\(([^)#]+)\)", page.read_text()):
        if not target.startswith("http"):
            assert (page.parent / target).exists(), target


def test_every_citation_has_its_reference():
    known = set(re.findall(r"@\w+\{(\w+),", (ROOT / "docs/references.bib").read_text()))
    cited = {}
    for path in [*PAGES, *sorted((ROOT / "src").rglob("*.py"))]:
        for key in KEY.findall(path.read_text()):
            cited.setdefault(key, path.name)
    assert {key: place for key, place in cited.items() if key not in known} == {}


def test_the_reference_of_the_command_line_is_that_of_the_parser(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "docs")
    page = importlib.import_module("command_line_page")
    before, _, reference = page.PAGE.read_text(encoding="utf-8").partition(page.BEGIN)
    # else: python docs/command_line_page.py
    assert reference == page.reference()
    commands = re.findall("### shellcut (\\w+)", reference)
    assert re.findall(r"\| \[`(\w+)`\]\(#shellcut-\1\)", before) == commands


def test_every_stored_picture_is_shown():
    shown = {
        (page.parent / target).resolve()
        for page in PAGES
        for target in re.findall(r"!\[[^\]]*\]\(([^)#]+)\)", page.read_text())
    }
    assert set((ROOT / "docs" / "img").iterdir()) - shown == set()


def test_the_site_has_every_page_and_the_start_page_leads_to_it():
    text = (ROOT / "docs" / "conf.py").read_text(encoding="utf-8")
    pages = ast.literal_eval(re.search(r"\nPAGES = (\{.*?\n\})\n", text, re.S)[1])
    listed = {name for names in pages.values() for name in names}
    stored = {path.relative_to(ROOT / "docs") for path in (ROOT / "docs").rglob("*.md")}
    stored = {path.with_suffix("").as_posix() for path in stored if "gallery" not in path.parts}
    assert stored - {"index"} == listed - {"api", "gallery/index"}
    start = (ROOT / "docs" / "index.md").read_text(encoding="utf-8")
    linked = {target.removesuffix(".md") for target in re.findall(r"\]\(([\w/-]+\.md)\)", start)}
    assert linked == stored - {"index"}


def test_the_import_table_is_the_contract():
    layers = re.search(r"\nlayers = \[\n(.*?)\n\]", (ROOT / "pyproject.toml").read_text(), re.S)
    contract = [set(re.findall(r"\w+", row)) for row in re.findall(r'"(.+?)"', layers[1])]
    page = (ROOT / "docs/architecture.md").read_text().split("| row |\n|---|\n")[1]
    table = [set(re.findall(r"`(\w+)`", row)) for row in page.split("\n\n")[0].splitlines()]
    assert table == contract


def test_the_readmes_models_run(tmp_path):
    models = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.S)
    assert len(models) == 2
    assert all(len(model.splitlines()) <= 40 for model in models)
    for model in models:
        done = subprocess.run(
            [sys.executable, "-c", model],
            capture_output=True,
            text=True,
            check=False,
            cwd=tmp_path,
        )
        assert done.returncode == 0, done.stderr
        assert "crack" in done.stdout


def test_ci_takes_the_test_command_from_the_readme():
    commands = re.findall(r"python3 -m venv .*", (ROOT / "README.md").read_text())
    assert len(commands) == 2
    assert commands[0].endswith("shellcut run opening --set mesh=quick -o out")
    assert re.fullmatch(r"python3 -m venv \.venv-test.*pytest", commands[1])

"""The documents tell the truth: links, citations, tables. test_pages.py runs their code."""

import ast
import functools
import importlib.util
import json
import re
import shutil
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

import shellcut
from browser import CHROMIUM
from page_tables import tables
from shellcut.model_file.key_index import QUESTIONS
from shellcut.model_file.section_table import LISTS, SECTIONS

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
COMMANDS = ROOT / "src" / "shellcut" / "command_line"
KEY = re.compile(r"\[([A-Z][A-Za-z]+(?:19|20)\d\d)\]")


@pytest.mark.parametrize("address", ["", "https://forge.example/films/shellcut"])
def test_the_package_index_gets_links_that_lead_somewhere(tmp_path, address):
    pytest.importorskip("hatchling")
    license_of_three = "src/shellcut/scene_page/three/LICENSE"
    for path in ["README.md", "LICENSE", ".ci/index_page.py", license_of_three]:
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / path, tmp_path / path)
    before, *after = re.split('^address = ""$', (ROOT / "pyproject.toml").read_text(), flags=re.M)
    assert len(after) == 1
    (tmp_path / "pyproject.toml").write_text(f'{before}address = "{address}"{after[0]}')
    command = [sys.executable, "-m", "hatchling", "metadata"]
    ran = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
    found = json.loads(ran.stdout)
    text = found["readme"]["text"]
    links = re.findall(r"(!?)\[[^]]*\]\(([^)#]+)", text)
    links += [("", link) for name, link in found.get("urls", {}).items() if "/blob/" in link]
    if address:
        assert len(links) > 30
        files = []
        for picture, link in links:
            base = f"{address}/{'raw' if picture else 'blob'}/main/"
            assert link.startswith(base), link
            files.append(link.removeprefix(base))
    else:
        assert (links, "urls" in found) == ([], False)
        files = re.findall(r" \(`([^`]+)`\)", text)
        assert len(files) > 20
    assert [file for file in files if not (ROOT / file.partition("#")[0]).exists()] == []


def slug(heading):
    """The anchor that GitHub and the site give a heading."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).strip().lower()
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_links_lead_to_files_and_headings(page):
    for target, anchor in re.findall(r"\]\(([^)#\s]*)#?([^)\s]*)\)", page.read_text()):
        if target.startswith("http"):
            continue
        path = page.parent / target if target else page
        assert path.exists(), target
        if anchor and path.suffix == ".md":
            headings = re.findall(r"^#+ (.*)$", path.read_text(), re.M)
            assert anchor in map(slug, headings), f"{target}#{anchor}"


def test_the_pages_that_answer_questions_are_there():
    for page, (question, _) in QUESTIONS.items():
        assert (ROOT / page).is_file(), question


def test_every_citation_has_its_reference():
    known = set(re.findall(r"@\w+\{(\w+),", (ROOT / "docs/references.bib").read_text()))
    cited = {}
    for path in [*PAGES, *sorted((ROOT / "src").rglob("*.py"))]:
        for key in KEY.findall(path.read_text()):
            cited.setdefault(key, path.name)
    assert {key: place for key, place in cited.items() if key not in known} == {}


@pytest.fixture
def docs(monkeypatch):
    """Return what imports a script of docs/."""
    monkeypatch.syspath_prepend(ROOT / "docs")
    return importlib.import_module


def test_the_reference_of_the_command_line_is_that_of_the_parser(docs):
    page = docs("command_line_page")
    before, _, reference = page.PAGE.read_text(encoding="utf-8").partition(page.BEGIN)
    # else: python docs/command_line_page.py
    assert reference == page.reference()
    assert page.CODES + page.codes() + "\n" in before
    commands = re.findall("### shellcut (\\w+)", reference)
    assert re.findall(r"\| \[`(\w+)`\]\(#shellcut-\1\)", before) == commands


def test_pages_of_theory_are_short_and_have_one_figure():
    formulas = re.compile(r"(?ms)^ *```math.*?^ *```$")  # do not count
    # A line is one of 120 characters; rows of tables, and single links, may be longer.
    free = re.compile(r"\|.*|\W*\[\S+\W*")
    for page in sorted((ROOT / "docs" / "theory").glob("*.md")):
        text = page.read_text(encoding="utf-8")
        lines = formulas.sub("", text).splitlines()
        assert len(lines) <= 240, page.name
        wide = [row for row in lines if len(row) > 120 and not free.fullmatch(row)]
        assert wide == [], page.name
        assert text.count("![") == 1, page.name


@pytest.mark.parametrize("script", ["materials_page", "references_page", "model_keys_page"])
def test_pages_are_those_of_their_sources(docs, script):
    module = docs(script)
    # else: python docs/SCRIPT.py
    assert module.PAGE.read_text(encoding="utf-8") == module.page()
    assert getattr(module, "PICTURE", module.PAGE).exists()


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_formulas_are_shown_by_github_and_the_site(page):
    """GitHub reads Markdown within `$`: escapes lose the backslash, `*` and `}_` are emphasis."""
    text = re.sub(r"(?ms)^ *(```|~~~).*?^ *\1|`[^`\n]+`", "", page.read_text(encoding="utf-8"))
    assert "$$" not in text, "a formula of its own is a block ```math"
    found = re.findall(r"\$([^$\n]+)\$", text)
    odd = re.compile(r"\\[,;:!{}\\|#%&_]|[*~<>|]|[})\]]_|^\s|\s$")
    assert [formula for formula in found if odd.search(formula)] == []
    beside = re.sub(r"\$[^$\n]+\$", "\0", text)
    assert "$" not in beside, "a formula is on one line"
    assert re.findall(r"\w\0.*|.*\0[\w(]", beside) == []


def test_the_page_of_the_keys_has_every_key_of_every_model(docs):
    page = docs("model_keys_page").PAGE.read_text(encoding="utf-8")
    index, rest = page.split("## Before the first section")
    kinds = [kind for layout in (SECTIONS, LISTS) for of in layout.values() for kind in of.values()]
    for name, key in (one for of in kinds for kind in of for one in kind.keys.items()):
        assert f"| `{name}` | [" in index
        assert f"| `{name}`" in rest
        assert not key.also or f"| `{key.also}` | [" in index
    # Its links lead to its headings.
    headings = {h.strip("[]").lower().replace(" ", "-") for h in re.findall("## (.*)", page)}
    assert set(re.findall(r"\(#([\w-]+)\)", index)) == headings - {"a-to-z"}


def test_drawings_of_the_theory_are_those_of_their_script(docs):
    module = docs("theory_pictures")
    for name, draw in module.PICTURES.items():
        # else: python docs/theory_pictures.py
        assert module.path(name).read_text(encoding="utf-8") == draw(), name


def written_from(page, text):
    """Return the place in a page from which a script has written it, its length if none has.

    That script stands in a comment "made by" above it, or makes the page by the words before the
    first section; and the script names the page.
    """
    head = text.partition("\n## ")[0]
    by_comment = re.search(r"<!-- made by (\S+\.py)", text)
    by_words = re.search(r"`python (\S+\.py)`\s+makes\s+(?:it|the\s+page|this\s+page)", head)
    for found, at in ((by_words, 0), (by_comment, by_comment and by_comment.start())):
        if found and page.name in (ROOT / found[1]).read_text(encoding="utf-8"):
            return at
    return len(text)


def is_made_or_tested(section):
    """Whether a section names a command that there is, or a file of tests."""
    tests = {path.name for path in (ROOT / "tests").rglob("test_*.py")}
    scripts = re.findall(r"python ((?:tests|docs|examples)/\S+?\.py)", section)
    modules = re.findall(r"python -m ([\w.]+)", section)
    scripts += [f"tests/{name.replace('.', '/')}.py" for name in modules]
    commands = re.findall(r"(?:^|`)shellcut (\w+)", section, re.MULTILINE)
    return (
        any((ROOT / script).exists() for script in scripts)
        or any(name in tests for name in re.findall(r"\b(test_\w+\.py)", section))
        or any((COMMANDS / f"{name}.py").exists() for name in commands)
    )


def test_tables_of_figures_say_what_makes_or_reads_them():
    bare = []
    for page in sorted((ROOT / "docs").rglob("*.md")):
        text = page.read_text(encoding="utf-8")
        by_hand = text[: written_from(page, text)]
        for section in re.split(r"^(?=#+ )", by_hand, flags=re.MULTILINE):
            for _, rows in tables(section):
                figures = re.findall(r"\d\.\d", "\n".join(rows[2:]))
                if len(figures) >= 5 and not is_made_or_tested(section):
                    bare.append((page.relative_to(ROOT).as_posix(), rows[0]))
    assert bare == []


def test_every_stored_picture_is_shown():
    shown = {
        (page.parent / target).resolve()
        for page in PAGES
        for target in re.findall(r"!\[[^\]]*\]\(([^)#]+)\)", page.read_text())
    }
    assert set((ROOT / "docs" / "img").iterdir()) - shown == set()


def test_the_site_has_every_page_and_the_start_page_leads_to_it():
    docs = ROOT / "docs"
    text = (docs / "conf.py").read_text(encoding="utf-8")
    pages = ast.literal_eval(re.search(r"\nPAGES = (\{.*?\n\})\n", text, re.S)[1])
    listed = {name for names in pages.values() for name in names}
    stored = {path.relative_to(docs).with_suffix("") for path in docs.rglob("*.md")}
    stored = {path.as_posix() for path in stored if "gallery" not in path.parts}
    chapters = {name for name in stored if name.startswith("verification/")}
    cases = (docs / "verification.md").read_text("utf-8").partition("## Published cases")[2]
    assert chapters == set(re.findall(r"\]\((verification/[\w-]+)\.md\)", cases))
    stored -= chapters | {"index"}
    assert stored == listed - {"api/index", "gallery/index"}
    start = (docs / "index.md").read_text(encoding="utf-8")
    assert set(re.findall(r"\]\(([\w/-]+)\.md\)", start)) == stored


def test_every_public_name_is_on_one_page_of_the_api():
    pages = {path.stem: path.read_text("utf-8") for path in (ROOT / "docs/api").glob("*.rst")}
    index = pages.pop("index")
    shown = re.findall(r"^\.\. auto\w+:: (\S+)$", "\n".join(pages.values()), re.MULTILINE)
    assert {f"shellcut.{name}" for name in shellcut.__all__} - set(shown) == set()
    assert [name for name, n in Counter(shown).items() if n > 1] == []
    listed = re.findall(r"^   ([\w.]+)$", index, re.MULTILINE)
    assert set(pages) <= set(listed)
    missing = [one for one in shown if not re.search(rf"^   {one[9:]}\b", index, re.MULTILINE)]
    assert missing == []


@functools.cache
def sources():
    """Return path and tree of each file of the package."""
    paths = sorted((ROOT / "src").rglob("*.py"))
    return [(path, ast.parse(path.read_text(encoding="utf-8"))) for path in paths]


def is_kernel(node):
    return any(re.search("kernel|inline|apart", ast.unparse(d)) for d in node.decorator_list)


@pytest.mark.parametrize(
    ("page", "said"),
    [
        ("CITATION.cff", r"^version: (.*)$"),
        ("docs/questions.md", r"^  version = \{(.*)\},$"),
        ("docs/same-bits.md", r"^Versions: shellcut ([\d.]+), "),
        ("CHANGELOG.md", r"(?s)\A.*?^## \[([\d.]+)\]"),
    ],
)
def test_pages_name_this_version(page, said):
    here = re.search(r'^version = "(.*)"$', (ROOT / "pyproject.toml").read_text(), re.M)[1]
    assert re.findall(said, (ROOT / page).read_text(encoding="utf-8"), re.M) == [here]


def statements(tree):
    """Return how many statements a file has, docstrings not counted."""
    nodes = list(ast.walk(tree))
    texts = [n for n in nodes if isinstance(n, ast.Expr) and isinstance(n.value, ast.Constant)]
    strings = [n for n in texts if isinstance(n.value.value, str)]
    return sum(isinstance(n, ast.stmt) for n in nodes) - len(strings)


def test_packages_keep_to_their_budgets():
    table = (ROOT / "docs/architecture.md").read_text(encoding="utf-8").split("## Budgets")[1]
    budgets = {one: int(most) for one, most in re.findall(r"\| `(\w+)` \| (\d+) \|", table)}
    found = Counter()
    for path, tree in sources():
        package, *inside = path.relative_to(ROOT / "src" / "shellcut").parts
        found[package if inside else "files_beside_the_packages"] += statements(tree)
    assert set(budgets) == set(found)
    over = {one: (n, budgets[one]) for one, n in found.items() if n > budgets[one]}
    assert over == {}, "statements, and what docs/architecture.md allows"


def test_functions_are_short():
    # Kernels may be longer: each is one loop over rows, and what it calls is inlined anyway.
    long = {}
    for path, tree in sources():
        for node in ast.walk(tree):
            if not isinstance(node, ast.FunctionDef) or is_kernel(node):
                continue
            first = node.body[min(ast.get_docstring(node) is not None, len(node.body) - 1)]
            within = [n for n in node.body if isinstance(n, ast.FunctionDef) and is_kernel(n)]
            n_line = node.end_lineno - first.lineno + 1
            n_line -= sum(n.end_lineno - n.lineno + 1 for n in within)
            if n_line > 60:
                long[f"{path.name}: {node.name}"] = n_line
    assert long == {}


def test_scripts_import_what_there_is():
    missing = []
    for folder in ("tests", "docs", "examples", ".ci"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("shellcut"):
                    module = importlib.import_module(node.module)
                    names = (f"{node.module}.{name.name}" for name in node.names)
                    gone = [n for n in names if not hasattr(module, n.rpartition(".")[2])]
                    missing += [(path.name, n) for n in gone if not importlib.util.find_spec(n)]
    assert missing == []


def test_the_short_form_for_other_versions_names_tests_that_there_are():
    script = (ROOT / ".ci/versions").read_text(encoding="utf-8")
    listed = re.search(r"^short=\(\n(.*?)^\)", script, re.MULTILINE | re.DOTALL)[1]
    files = [
        before + name + after
        for before, names, after in re.findall(r"(tests\S*?)\{(.*?)\}(\S*)", listed)
        for name in names.split(",")
    ]
    assert len(files) > 20
    assert [file for file in files if not (ROOT / file).is_file()] == []


def test_package_picture_table_and_folders_are_the_contract(docs):
    pictured = docs("packages_picture")
    rows = pictured.rows()
    assert len(rows) <= 10
    assert pictured.PICTURE.read_text(encoding="utf-8") == pictured.picture()
    assert pictured.table() in (ROOT / "docs/architecture.md").read_text(encoding="utf-8")
    package = ROOT / "src" / "shellcut"
    folders = {p.parent.name for p in package.glob("*/__init__.py")}
    files = {p.stem for p in package.glob("*.py")} - {"__init__", "__main__"}
    doors = {"cut_quality", "history", "meshing", "tool_shapes"}
    assert sorted(one for row in rows for one in row) == sorted(folders | (files - doors))
    for folder in folders:
        doc = ast.get_docstring(ast.parse((package / folder / "__init__.py").read_text("utf-8")))
        assert "import" in doc.lower(), f"{folder} must say what it may import"
    for door in doors:
        body = ast.parse((package / f"{door}.py").read_text("utf-8")).body
        assert {type(node) for node in body} == {ast.Expr, ast.ImportFrom, ast.Assign}
    inside = {p.parent.name for p in package.rglob("*.py") if "numba.core" in p.read_text("utf-8")}
    assert inside == {"numerics"}, "Numba's own parts are the business of numerics/"


SITE_PAGE = """<!doctype html><body><article><section id="model-keys"><h1>Model keys</h1>
<section id="a-to-z"><h2>A to Z</h2><table><tbody><tr><td>pitch</td><td>motion</td></tr>
<tr><td>young</td><td>material</td></tr></tbody></table></section>
<section id="motion"><h2>[motion]</h2><p>kind = "screw"</p><table><tbody>
<tr><td>pitch</td><td>mm</td><td>advance a turn</td></tr>
<tr><td>duration</td><td>s</td><td>of the run</td></tr></tbody></table>
<p>kind = "straight"</p><table><tbody><tr><td>speed</td><td>mm/s</td><td>after the ramp</td></tr>
</tbody></table></section><section id="material"><h2>[material]</h2><table><tbody>
<tr><td>young</td><td>MPa</td><td>Young's modulus</td></tr></tbody></table></section>
</section></article></body><script>SCRIPT</script><script>
const shown = () => [...document.querySelectorAll("tbody tr")].filter((row) => row.offsetHeight)
  .map((row) => row.cells[0].textContent);
const found = {};
addEventListener("DOMContentLoaded", () => {
  const field = document.querySelector("input");
  for (const words of ["", "MPa", "screw", "motion MM", "nothing"]) {
    field.value = words;
    field.dispatchEvent(new Event("input"));
    const titles = [...document.querySelectorAll("h2, p")].filter((one) => one.offsetHeight);
    found[words] = [shown(), titles.map((one) => one.textContent),
      document.querySelector("output").textContent.trim()];
  }
  document.body.textContent = "FOUND" + JSON.stringify(found) + "END";
});
</script>"""


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here (apt-get install chromium)")
def test_the_page_of_the_keys_is_searched_in_the_site(tmp_path):
    script = (ROOT / "docs" / "_static" / "keys.js").read_text(encoding="utf-8")
    (tmp_path / "keys.html").write_text(SITE_PAGE.replace("SCRIPT", script), encoding="utf-8")
    command = [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--dump-dom"]
    command += [f"--user-data-dir={tmp_path / 'profile'}", (tmp_path / "keys.html").as_uri()]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True)
    found = json.loads(re.search("FOUND(.*)END", done.stdout)[1])
    assert found[""][0] == ["pitch", "young", "pitch", "duration", "speed", "young"]
    assert found["MPa"] == [["young"], ["[material]"], "1 found"]
    assert found["screw"] == [["pitch", "duration"], ["[motion]", 'kind = "screw"'], "2 found"]
    assert found["motion MM"][0] == ["pitch", "speed"]
    assert found["nothing"] == [[], [], "0 found"]


def packed_lines(tree):
    """Yield the lines of an optional text made by a product, of a step chosen in a slice, of a
    tuple that has a name only to be unpacked once."""
    for node in ast.walk(tree):
        match node:
            case ast.BinOp(left=ast.JoinedStr() | ast.Constant(str()), op=ast.Mult(), right=by):
                counts = isinstance(by, ast.Constant) or ast.unparse(by).startswith("int(")
                if not counts:
                    yield node.lineno
            case ast.Slice(step=ast.IfExp()):
                yield node.lineno
            case ast.FunctionDef():
                named = {}
                for one in ast.walk(node):
                    match one:
                        case ast.Assign(targets=[ast.Name(name)], value=ast.Tuple()):
                            named[name] = one.lineno
                        case ast.Assign(targets=[ast.Tuple(names)], value=ast.Tuple(values)):
                            pairs = zip(names, values, strict=False)
                            tuples = [a for a, b in pairs if isinstance(b, ast.Tuple)]
                            named |= {a.id: one.lineno for a in tuples if isinstance(a, ast.Name)}
                read = Counter(n.id for n in ast.walk(node) if isinstance(n, ast.Name))
                stars = Counter(
                    n.value.id
                    for n in ast.walk(node)
                    if isinstance(n, ast.Starred) and isinstance(n.value, ast.Name)
                )
                yield from (at for name, at in named.items() if (read[name], stars[name]) == (2, 1))


def test_code_is_not_packed():
    found = [f"{path.name}:{line}" for path, tree in sources() for line in packed_lines(tree)]
    assert found == []

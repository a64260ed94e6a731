"""Words that stop a reader whose second language is English, and sentences that are too long.

Each forbidden word has the field's word beside it. Read are all pages, what the program says (its
strings of at least four words) and the docstrings of public names; code in backticks, links'
addresses and formulas are left out.
"""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

FORBIDDEN = {
    r"held": "supported, fixed",
    r"chances?": "run-to-run scatter",
    r"ways?": "path, distance, direction, method, mode",
    r"ledgers?|accounts?|booked|bookkeeping|shed": "energy balance, entry of the energy balance",
    r"figures?(?! \d)": "value; picture",
    r"mend(s|ed|ing)?": "fix, correct",
    r"rims?": "border",
    r"rooms?": "package",
    r"twins?": "duplicate node; plain reference",
    r"kin": "similar",
    r"goes|comes|stands": "continues, is placed, is, moves",
    r"slow tests": "quasi-static runs",
    r"same bits": "bitwise identical, reproducible",
    r"edges? of (a|the) (quad|element|film)s?|(quad|element)s?'? edges?": "side, border",
    r"rows? of edges": "row of sides",
    r"told": "given, stated",
    r"hangs on": "depends on",
}
"""Pattern of a whole word -> what to say in its place."""

PAGES = sorted(
    str(p.relative_to(ROOT))
    for p in [*ROOT.glob("docs/**/*.md"), ROOT / "README.md", ROOT / "CHANGELOG.md"]
    if "gallery" not in p.parts
)
PLAIN = [p for p in PAGES if p.startswith("docs/howto/")]
PLAIN += ["docs/first-cut.md", "docs/install.md", "docs/questions.md", "docs/limits.md"]
"""Pages whose sentences have a greatest length: tutorial, how-to, limits."""

LONGEST, MEAN = 40, 22
"""Words of the longest sentence, and of the mean one."""

PACKAGES = sorted({p.parent for p in (ROOT / "src/shellcut").rglob("*.py")})


def prose(text):
    """Return the words of a Markdown page: without code, formulas, addresses and comments."""
    text = re.sub(r"(?ms)^ *(```|~~~|\$\$).*?^ *\1", "\n\n", text)
    text = re.sub(r"(?s)<!--.*?-->|<[^>\n]+>", " ", text)
    text = re.sub(r"``[^`]+``|`[^`]*`|\$[^$\n]+\$", "CODE", text)
    text = re.sub(r"\]\([^)]*\)", "]", text)
    return re.sub(r"\{[\w:]+\}", " ", text)


def sentences(text):
    """Return the sentences of a page: of its paragraphs, list items and table cells."""
    found = []
    for block in re.split(r"\n\s*\n|\n(?=\s*[-*+#>|]|\s*\d+\. )|(?<=\S)\s*\|", prose(text)):
        for sentence in re.split(r"(?<=[.:;?!])\s+", block):
            words = re.findall(r"[A-Za-zÀ-ÿ'’\-]{1,}|CODE|\d[\d.,]*", sentence)
            if len(words) > 3:
                found.append((len(words), " ".join(sentence.split())))
    return found


def forbidden(text):
    """Return each forbidden word of a text with some words around it and what to say instead."""
    found = []
    for pattern, instead in FORBIDDEN.items():
        for match in re.finditer(rf"(?i)(?<![\w`./-])(?:{pattern})(?![\w`/-]|\.\w)", text):
            around = text[max(match.start() - 40, 0) : match.end() + 30].replace("\n", " ")
            found.append(f"...{around}... -> {instead}")
    return found


def strings(tree):
    """Return what a module says: strings of four words and more that are no docstrings."""
    alone = [node.value for node in ast.walk(tree) if isinstance(node, ast.Expr)]
    docs = set(map(id, alone))
    said = []
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr):
            parts = [v.value if isinstance(v, ast.Constant) else "CODE" for v in node.values]
            said.append("".join(parts))
        elif isinstance(node, ast.Constant) and id(node) not in docs:
            said.append(str(node.value))
    return [text for text in said if len(text.split()) >= 4]


def public_docstrings(body):
    """Return the docstrings of the public classes, methods and functions among statements."""
    found = []
    for node in body:
        if isinstance(node, ast.ClassDef | ast.FunctionDef) and not node.name.startswith("_"):
            found.append(ast.get_docstring(node) or "")
            if isinstance(node, ast.ClassDef):
                found += public_docstrings(node.body)
    return found


@pytest.mark.parametrize("page", PAGES)
def test_a_page_has_no_forbidden_word_and_short_sentences(page):
    text = (ROOT / page).read_text()
    found = forbidden(prose(text))
    if page in PLAIN:
        lengths = sentences(text)
        found += [f"{n} words: {text}" for n, text in lengths if n > LONGEST]
        assert sum(n for n, _ in lengths) / len(lengths) <= MEAN
    assert not found, f"{len(found)} in {page}:\n" + "\n".join(found)


@pytest.mark.parametrize("package", PACKAGES, ids=lambda p: p.name)
def test_what_the_program_says_and_docstrings_of_public_names_are_plain(package):
    found = []
    for path in sorted(package.glob("*.py")):
        tree = ast.parse(path.read_text())
        said = [prose(text) for text in strings(tree)]
        docs = [prose(text) for text in public_docstrings(tree.body)]
        found += [f"{path.name}: {one}" for text in said + docs for one in forbidden(text)]
        lengths = [one for text in said for one in sentences(text)]
        found += [f"{path.name}: {n} words: {text}" for n, text in lengths if n > LONGEST]
    assert not found, f"{len(found)}:\n" + "\n".join(found)


def test_a_forbidden_word_and_a_long_sentence_are_found():
    assert len(forbidden(prose("The held node goes its way. See `held` and [a](way.md)."))) == 3
    assert sentences("One two three four. " + "word " * 41 + ".")[-1][0] > LONGEST

"""How the site is built: ``python -m sphinx -W --keep-going docs build/site``.

The pages are written for GitHub; what only a site needs is added here: the order of the pages, the
reference made of the docstrings, and the gallery, whose examples are run at every build.
"""

import re
import sys
from pathlib import Path

from sphinx.addnodes import pending_xref

import shellcut

sys.path.insert(0, str(Path(__file__).parent))

from gallery_run import QuickSettings
from references_page import entries

project = "shellcut"
highlight_language = "none"  # the pages name their languages
author = "The shellcut developers"
copyright = author
version = release = shellcut.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.mathjax",
    "sphinx.ext.napoleon",
    "sphinx_gallery.gen_gallery",
    "sphinx.ext.autosummary",
]
exclude_patterns = ["gallery/*.ipynb", "gallery/*.py", "gallery/*.md5", "sg_execution_times.rst"]
html_theme = "furo"
html_title = f"shellcut {release}"
html_show_sourcelink = False
html_copy_source = False
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_js_files = ["keys.js"]
html_theme_options = {"top_of_page_buttons": []}

myst_heading_anchors = 3
myst_enable_extensions = ["dollarmath"]
myst_fence_as_directive = ["math"]  # GitHub shows ```math as a formula, too

autosummary_generate = False  # the pages of api/ are written by hand
autodoc_default_options = {"members": True}
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
python_maximum_signature_line_length = 88  # a longer one has a line for each argument
autodoc_typehints = "none"  # the docstrings tell kinds, shapes and units
napoleon_google_docstring = False
napoleon_use_ivar = True
napoleon_use_rtype = False

PAGES = {
    "First steps": ["install", "first-cut", "questions", "gallery/index"],
    "How to": [
        "howto/model-file",
        "howto/own-tool",
        "howto/own-film",
        "howto/tear",
        "howto/pierce",
        "howto/loose",
        "howto/seal",
        "howto/sharp",
        "howto/slow",
        "howto/hand-built",
        "howto/resume",
        "howto/read-results",
        "howto/pictures",
        "howto/compare",
        "howto/tensile",
        "howto/data-sheet",
        "howto/studies",
        "howto/converge",
        "howto/optimise",
        "howto/fit",
        "howto/trust",
    ],
    "Theory": [
        "theory/opening",
        "theory/shell",
        "theory/yielding",
        "theory/time",
        "theory/cables",
        "theory/contact",
        "theory/film-contact",
        "theory/adhesion",
        "theory/scales",
        "theory/fracture",
        "theory/free-cracks",
        "theory/tears",
        "theory/curved-films",
        "theory/oscillating",
        "theory/energy",
        "theory/statics",
    ],
    "What to trust": [
        "limits",
        "error-bars",
        "predictions",
        "verification",
        "theory/yielding-cut",
        "theory/yielding-disc",
        "same-bits",
        "reliability",
        "performance",
    ],
    "Reference": [
        "model-keys",
        "materials",
        "command-line",
        "api/index",
        "versions",
        "glossary",
        "references",
        "architecture",
        "howto/add-a-case",
    ],
}
"""The side bar. A page that is missing here is a warning of Sphinx, hence an error."""


try:  # without Gmsh and Optuna the example that needs them is shown and not run
    import gmsh  # noqa: F401
    import optuna  # noqa: F401
except (ImportError, OSError):
    NOT_RUN = "which_tooth"
else:
    NOT_RUN = " "

sphinx_gallery_conf = {
    "examples_dirs": "../examples",
    "gallery_dirs": "gallery",
    "filename_pattern": rf"^((?!{NOT_RUN}).)*\.py$",
    "within_subsection_order": "gallery_run.InOrder",
    "reset_argv": QuickSettings(),
    "image_scrapers": ("gallery_run.draw_thumbnail", "matplotlib"),
    "capture_repr": ("_repr_html_",),
    "reset_modules": (),
    "abort_on_example_error": True,
    "remove_config_comments": True,
    "download_all_examples": False,
    "show_signature": False,
    "min_reported_time": 1e9,
}


OUTSIDE = re.compile(r"\]\(((?:\.\./)+[A-Z]+\.md)\)")
"""A link of a page to a Markdown file of the project that is no page of the site."""


CITED = re.compile(rf"(?<!`)\[({'|'.join(entries())})\](?![(`])")
"""A citation by its key, as in comments of the code and in pages that a script makes."""


def adapt(app, docname, source):
    """Make of a page for GitHub one for the site.

    The start page gets the tables of contents, that of verification its chapters; files outside the
    site become downloads; citations by a key become links.
    """
    source[0] = OUTSIDE.sub(r"](path:\1)", source[0])
    if app.env.doc2path(docname).suffix == ".md":
        to = "../" * docname.count("/") + "references.md"
        source[0] = CITED.sub(lambda key: f"{key[0]}({to}#{key[1].lower()})", source[0])
    if docname == "verification":
        cases = source[0].partition("## Published cases")[2]
        chapters = dict.fromkeys(re.findall(r"\((verification/[\w-]+)\.md\)", cases))
        source[0] += "\n```{toctree}\n:hidden:\n\n" + "\n".join(chapters) + "\n```\n"
    if docname == "index":
        for caption, pages in PAGES.items():
            entries = "\n".join(pages)
            source[0] += f"\n```{{toctree}}\n:hidden:\n:caption: {caption}\n\n{entries}\n```\n"


def link_citations(app, what, name, obj, options, lines):
    """Make links of the citations in a docstring."""
    to = "../" * app.env.docname.count("/") + "references.html"
    lines[:] = [CITED.sub(lambda key: f"`{key[1]} <{to}#{key[1].lower()}>`__", x) for x in lines]


def adapt_links(app, doctree):
    """Link names of the API wherever they are named; leave other words of a kind without links.

    Sphinx takes each word of a kind, as *shape* in "ndarray, shape (3,)", for the name of a class
    and, where there is none, for that of a field. Our classes begin with capitals.
    """
    for link in list(doctree.findall(pending_xref)):
        name = link.get("reftarget", "").rpartition(".")[2]
        if link.get("reftype") == "class" and not name[:1].isupper():
            link.replace_self(link.children)
        elif link.get("reftype") in ("class", "exc", "func"):
            link["refspecific"] = True  # "Recorder" is found from any module


def setup(app):
    """Let pages and docstrings be adapted as they are read."""
    app.connect("source-read", adapt)
    app.connect("autodoc-process-docstring", link_citations)
    app.connect("doctree-read", adapt_links)

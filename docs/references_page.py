"""Write ``references.md``, a heading for each entry of ``references.bib``, to which pages link.

``python docs/references_page.py`` writes it; a test compares the two. A page of our own, because
GitHub shows no ``bibliography`` directive, and links need a heading of a fixed name in both places.
"""

import re
from pathlib import Path

BIB = Path(__file__).parent / "references.bib"
PAGE = BIB.with_suffix(".md")
TOP = """# References

The publications that the pages and the comments of the code cite. A comment gives the key, such as
`[Frangi2010]`, which is the heading here. The entries for BibTeX are in
[references.bib](references.bib), from which `python docs/references_page.py` makes this page.
"""
FIELD = re.compile(r"(\w+)\s*=\s*\{((?:[^{}]|\{[^{}]*\})*)\}", re.DOTALL)


def entries():
    """Return the fields of each entry by its key."""
    found = {}
    for key, body in re.findall(r"@\w+\{(\w+),(.*?)\n\}", BIB.read_text(encoding="utf-8"), re.S):
        plain = {
            name: " ".join(re.sub(r"\\(?=&)|[{}]", "", value).split()).replace("--", "–")
            for name, value in FIELD.findall(body)
        }
        found[key] = plain
    return found


def line(entry):
    """Return the reference that an entry gives, in Markdown."""
    title = entry.get("title", "")
    within = f"*{title}*" if "publisher" in entry and title else title
    number = f" ({entry['number']})" if "number" in entry else ""
    where = [
        f"*{entry['journal']}*" if "journal" in entry else "",
        f"In: *{entry['booktitle']}*" if "booktitle" in entry else "",
        f"Edition {entry['edition'].rstrip('nd')}" if "edition" in entry else "",
        entry.get("publisher", ""),
        f"Thesis, {entry['school']}" if "school" in entry else "",
        f"{entry['institution']}{number}" if "institution" in entry else "",
        f"{entry['volume']}{number}" if "volume" in entry else "",
        entry.get("pages", ""),
        entry.get("howpublished", ""),
    ]
    authors = entry["author"].replace(" and ", "; ")
    parts = [f"{authors} ({entry['year']})", within, ", ".join(filter(None, where))]
    if "doi" in entry:
        parts.append(f"[doi:{entry['doi']}](https://doi.org/{entry['doi']})")
    return ". ".join(filter(None, parts)) + "."


def page():
    """Return the page: the references by key."""
    found = sorted(entries().items())
    return "\n".join([TOP, *(f"## {key}\n\n{line(entry)}\n" for key, entry in found)])


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")

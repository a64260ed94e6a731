"""A model: the content of a model file, checked and with all defaults filled in, and its text."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from shellcut.files.distribution import VERSION
from shellcut.files.regular_file import read_regular
from shellcut.files.whole_file import write_text
from shellcut.models import Case
from shellcut.models.preview import ModelParts

from .key import Key, Section, written
from .source import Source
from .spelling import in_keys

FILES = "files"
"""Section of a ``used.toml`` with the digests of the files that the model reads."""

_HEAD = "#:schema ./shellcut.schema.json\n# sha256 of all below: "
_COLUMN = 34
"""Column of the comments, if the value is short enough."""


@dataclass(frozen=True)
class Model:
    """Content of a model file; created by :func:`read_model`.

    Examples
    --------
    >>> from shellcut import read_model
    >>> model = read_model("opening", {"membrane.mesh": "quick", "cohesive.strength": "20 MPa"})
    >>> model.sections["cohesive"].strength
    20.0
    """

    head: Section
    """The keys before the first section."""
    sections: Mapping[str, Section]
    """Sections that occur once, by title; all of them."""
    lists: Mapping[str, tuple[Section, ...]]
    """``supports`` and ``loads``."""
    recorded: Mapping[str, str] = field(default_factory=dict, compare=False, repr=False)
    """SHA-256 of files that the model reads, as stored in a ``used.toml``."""
    source: Source = field(default_factory=Source.empty, compare=False, repr=False)
    """Places of the values in the file, for messages."""

    @property
    def name(self) -> str:
        """Stem of the result file."""
        return str(self.head.name or self.head.model)

    def build(self) -> Case:
        """Build the case, ready to run.

        Raises
        ------
        ModelFileError
            If the parts do not fit together, or a file they need cannot be used.
        """
        from .build import build

        return build(self)

    def parts(self) -> ModelParts:
        """Return those of film, supported nodes, tool and motion that can be built.

        Used to draw a refused model; :meth:`build` reports the problems of the other parts.
        """
        from .build import parts

        return parts(self)

    def with_threads(self, threads: int) -> Model:
        """Return the same model with another number of threads."""
        return replace(self, head=self.head.with_values(threads=threads))

    def run_options(self) -> dict[str, Any]:
        """Return the arguments of :meth:`Case.run` given in ``[output]``."""
        return self.sections["output"].arguments()

    def write(self, path: str | Path) -> None:
        """Write the model with every default filled in; reading it back gives the same model."""
        write_text(Path(path), model_text(self))

    def words(self, text: str) -> str:
        """Return a message of the library in the words of model files and commands."""
        return in_keys(text, self.source)

    def files(self) -> list[str]:
        """Return the absolute paths of the files the model reads, each of them once."""
        given = [
            section.values[name]
            for section in self.titled().values()
            for name, key in section.of.keys.items()
            if key.is_file and section.values[name] is not None
        ]
        each = ([value] if isinstance(value, str) else value for value in given)
        return list(dict.fromkeys(str(path) for paths in each for path in paths))

    def changed_files(self) -> list[str]:
        """Return the files that are gone or have changed since the model was written."""
        return [path for path, digest in self.recorded.items() if digest_of(path) != digest]

    def titled(self) -> dict[str, Section]:
        """Return every section, those of arrays and the tables in a section, by title.

        The keys before the first section have the title "". What is one of several has its place,
        from 0 on, in the title: ``loads.0``.
        """
        found = {"": self.head}
        for title, place, section in self.each():
            found |= section.titled(f"{title}{place}")
        return found

    def each(self) -> Iterator[tuple[str, str, Section]]:
        """Yield title and section, and the place of what is one of several: ".0", else ""."""
        yield from ((title, "", section) for title, section in self.sections.items())
        for title, several in self.lists.items():
            yield from ((title, f".{n}", section) for n, section in enumerate(several))


def digest_of(path: str | Path) -> str:
    """Return the SHA-256 of a file, "" if it cannot be read."""
    try:
        return hashlib.sha256(read_regular(path)).hexdigest()
    except OSError:
        return "none"


# --- the text, unit and meaning beside each key ---------------------------------------------------


def model_text(model: Model) -> str:
    """Return a model as TOML text; its second line is the digest of the rest."""
    lines = [
        f"# shellcut {VERSION}, model {model.head.model}: every default filled in.",
        "# A key that is commented out is not given. Units: mm, N, s, tonne, MPa.",
        *_keys(model.head),
    ]
    for title, place, section in model.each():
        lines += ["", _heading(title, place), *_section(section, title)]
    if files := model.files():
        lines += ["", f"[{FILES}]", "# SHA-256 of each file that is read"]
        lines += [f"{written(path)} = {written(digest_of(path))}" for path in files]
    body = "\n".join(lines) + "\n"
    return _signed(body)


def is_as_written(text: str) -> bool:
    """Whether a text from :func:`model_text` is unchanged."""
    return text == _signed(text.split("\n", 2)[-1])


def _signed(body: str) -> str:
    return f"{_HEAD}{hashlib.sha256(body.encode()).hexdigest()}\n{body}"


def _section(section: Section, title: str) -> Iterator[str]:
    if section.kind:
        yield _commented(f'kind = "{section.kind}"', section.of.doc)
    yield from _keys(section)
    for name, place, inner in section.tables():
        within = f"{title}.{name}"
        yield ""
        yield _heading(within, place)
        yield from _section(inner, within)


def _heading(title: str, place: str) -> str:
    if not place:
        return f"[{title}]"
    return _commented(f"[[{title}]]", f"called {title}{place} in --set and messages")


def _keys(section: Section) -> Iterator[str]:
    for name, key in section.of.keys.items():
        value = section.values[name]
        if value is None:
            yield _commented(f"# {name} =", f"{_meaning(key)} (not given: {key.option.unset})")
        elif not key.kinds:
            yield _commented(f"{name} = {written(value)}", _meaning(key))


def _meaning(key: Key) -> str:
    return f"[{key.option.unit}] {key.option.text}" if key.option.unit else key.option.text


def _commented(text: str, comment: str) -> str:
    return f"{text.ljust(_COLUMN)}  # {comment}"

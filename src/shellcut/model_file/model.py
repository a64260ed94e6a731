"""A model: the content of a model file, checked and with all defaults filled in."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from shellcut.files.regular_file import read_regular
from shellcut.files.whole_file import write_text

from .key import Section
from .source import Source

if TYPE_CHECKING:
    from shellcut.models import Case
    from shellcut.models.preview import ModelParts


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
        options: dict[str, Any] = self.sections["output"].arguments()
        return options

    def write(self, path: str | Path) -> None:
        """Write the model with every default filled in; reading it back gives the same model."""
        from .writer import model_text

        write_text(Path(path), model_text(self))

    def words(self, text: str) -> str:
        """Return a message of the library in the words of model files and commands."""
        from .spelling import in_keys

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

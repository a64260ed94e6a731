"""Write a model with every default filled in, unit and meaning beside each key."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator

from shellcut.files.distribution import VERSION

from .forms import written
from .key import Key, Section
from .model import Model, digest_of
from .reader import FILES

_HEAD = "#:schema ./shellcut.schema.json\n# sha256 of all below: "
_COLUMN = 34
"""Column of the comments, if the value is short enough."""


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

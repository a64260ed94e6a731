"""Text of files as other programs write it, in one form.

Editors and spreadsheets of Windows write a byte order mark before the text, or UTF-16; old systems
end lines with a carriage return alone, and a file with Ctrl-Z or zeros.
"""

from __future__ import annotations

import codecs
import re

_MARKS = {
    codecs.BOM_UTF8: "utf-8",
    codecs.BOM_UTF16_LE: "utf-16-le",
    codecs.BOM_UTF16_BE: "utf-16-be",
}
_BARE = {
    "utf-16-le": re.compile(rb"(?:[^\0]\0){2}"),
    "utf-16-be": re.compile(rb"(?:\0[^\0]){2}"),
}
_AFTER_THE_END = b"\x1a\0"
_XML_ENCODING = re.compile(rb"^(<\?xml[^>]*?)\s+encoding\s*=\s*[\"'][^\"']*[\"']")


def in_one_form(content: bytes) -> bytes:
    r"""Return text without a byte order mark, lines ended by line feeds; other content as it is.

    UTF-16 becomes UTF-8, with a mark or without. Content with zero bytes is no text. Other
    encodings, which a file does not state, stay: :func:`decoded` reads them.

    Examples
    --------
    >>> in_one_form("v 0 0 0".encode("utf-16")), in_one_form(b"v 0 0 0\x1a")
    (b'v 0 0 0', b'v 0 0 0')
    """
    text = _recoded(content).rstrip(_AFTER_THE_END)
    if b"\0" in text:
        return content
    if b"\r" in text and b"\n" not in text:
        text = text.replace(b"\r", b"\n")
    return text


def _recoded(content: bytes) -> bytes:
    mark, encoding = next(
        ((mark, encoding) for mark, encoding in _MARKS.items() if content.startswith(mark)),
        (b"", next((name for name, begin in _BARE.items() if begin.match(content)), "utf-8")),
    )
    if encoding == "utf-8":
        return content[len(mark) :]
    # half a character at the end is a line end that was cut, or a Ctrl-Z
    whole = content[len(mark) : len(content) - (len(content) - len(mark)) % 2]
    try:
        text = whole.decode(encoding).encode()
    except UnicodeDecodeError:
        return content
    return _XML_ENCODING.sub(rb"\1", text, count=1)


def decoded(content: bytes) -> str:
    """Return a text in UTF-8, or else in the Western code page of Windows, which is no UTF-8.

    Examples
    --------
    >>> decoded("Déplacement".encode()) == decoded("Déplacement".encode("cp1252"))
    True
    """
    try:
        return content.decode()
    except UnicodeDecodeError:
        return content.decode("cp1252", errors="replace")

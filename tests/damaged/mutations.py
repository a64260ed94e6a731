"""Damage to a file, as disks, editors, mail programs and hands make it; seeded."""

_BYTES = b"0123456789 -.,eE\n*$#a\"'="

# (content, first byte, end of a stretch, another byte) -> content
_OF_BYTES = {
    "bit flipped": lambda c, at, end, new: c[:at] + bytes([c[at] ^ 1 << new % 8]) + c[at + 1 :],
    "byte changed": lambda c, at, end, new: c[:at] + bytes([new]) + c[at + 1 :],
    "byte lost": lambda c, at, end, new: c[:at] + c[at + 1 :],
    "stretch lost": lambda c, at, end, new: c[:at] + c[end:],
    "stretch doubled": lambda c, at, end, new: c[:end] + c[at:],
    "stretch zeroed": lambda c, at, end, new: c[:at] + bytes(end - at) + c[end:],
    "cut off": lambda c, at, end, new: c[:at],
}
_OF_TEXT = {
    "byte doubled": lambda c, at, end, new: c[: at + 1] + c[at:],
    "byte put in": lambda c, at, end, new: c[:at] + bytes([new]) + c[at:],
}
# (lines, number of one) -> lines
_OF_LINES = {
    "line lost": lambda lines, k: lines[:k] + lines[k + 1 :],
    "line doubled": lambda lines, k: lines[: k + 1] + lines[k:],
    "lines swapped": lambda lines, k: lines[:k] + lines[k : k + 2][::-1] + lines[k + 2 :],
}


def mutated(rng, content, *, text):
    """Return the content with one damage, and the damage's name; the content really differs."""
    of_bytes = _OF_BYTES | _OF_TEXT if text else _OF_BYTES
    ways = [*of_bytes, *_OF_LINES] if text else [*of_bytes]
    while True:
        way = ways[int(rng.integers(len(ways)))]
        if way in _OF_LINES:
            lines = content.splitlines(keepends=True)
            damaged = b"".join(_OF_LINES[way](lines, int(rng.integers(len(lines)))))
        else:
            at = int(rng.integers(len(content)))
            new = _BYTES[int(rng.integers(len(_BYTES)))]
            damaged = of_bytes[way](content, at, at + int(rng.integers(1, 40)), new)
            damaged = damaged if way != "stretch zeroed" else damaged[: len(content)]
        if damaged != content:
            return damaged, way

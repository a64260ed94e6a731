"""One damage to a file, as disks, editors, mail programs and hands make them; seeded.

Text: a line lost, doubled or swapped with the next, a digit changed, a character put in or doubled.
Any file: a bit flipped, a byte changed or lost, a stretch lost, doubled or zeroed, the end cut off.
"""

_PUT_IN = b"0123456789 -.,eE\n*$#a\"'="


def _line_lost(rng, content):
    lines = content.splitlines(keepends=True)
    del lines[int(rng.integers(len(lines)))]
    return b"".join(lines)


def _line_doubled(rng, content):
    lines = content.splitlines(keepends=True)
    k = int(rng.integers(len(lines)))
    return b"".join([*lines[: k + 1], *lines[k:]])


def _lines_swapped(rng, content):
    lines = content.splitlines(keepends=True)
    k = int(rng.integers(len(lines) - 1))
    lines[k], lines[k + 1] = lines[k + 1], lines[k]
    return b"".join(lines)


def _digit_changed(rng, content):
    places = [k for k, byte in enumerate(content) if 48 <= byte < 58]
    if not places:
        return content
    at = places[int(rng.integers(len(places)))]
    digit = 48 + (content[at] - 48 + int(rng.integers(1, 10))) % 10
    return content[:at] + bytes([digit]) + content[at + 1 :]


def _character_lost(rng, content):
    at = int(rng.integers(len(content)))
    return content[:at] + content[at + 1 :]


def _character_doubled(rng, content):
    at = int(rng.integers(len(content)))
    return content[: at + 1] + content[at:]


def _character_put_in(rng, content):
    at = int(rng.integers(len(content) + 1))
    new = _PUT_IN[int(rng.integers(len(_PUT_IN)))]
    return content[:at] + bytes([new]) + content[at:]


def _byte_changed(rng, content):
    at = int(rng.integers(len(content)))
    new = _PUT_IN[int(rng.integers(len(_PUT_IN)))]
    return content[:at] + bytes([new]) + content[at + 1 :]


def _bit_flipped(rng, content):
    at = int(rng.integers(len(content)))
    return content[:at] + bytes([content[at] ^ (1 << int(rng.integers(8)))]) + content[at + 1 :]


def _stretch(rng, content):
    at = int(rng.integers(len(content)))
    return at, min(len(content), at + int(rng.integers(1, 40)))


def _stretch_lost(rng, content):
    at, end = _stretch(rng, content)
    return content[:at] + content[end:]


def _stretch_doubled(rng, content):
    at, end = _stretch(rng, content)
    return content[:end] + content[at:]


def _stretch_zeroed(rng, content):
    at, end = _stretch(rng, content)
    return content[:at] + bytes(end - at) + content[end:]


def _cut_off(rng, content):
    return content[: int(rng.integers(len(content)))]


ANY = (
    _bit_flipped,
    _byte_changed,
    _character_lost,
    _stretch_lost,
    _stretch_doubled,
    _stretch_zeroed,
    _cut_off,
)
TEXT = (
    _line_lost,
    _line_doubled,
    _lines_swapped,
    _digit_changed,
    _character_doubled,
    _character_put_in,
    *ANY,
)


def mutated(rng, content, *, text):
    """Return the content with one damage, and the damage's name; the content really differs."""
    ways = TEXT if text else ANY
    while True:
        way = ways[int(rng.integers(len(ways)))]
        damaged = way(rng, content)
        if damaged != content:
            return damaged, way.__name__.strip("_").replace("_", " ")

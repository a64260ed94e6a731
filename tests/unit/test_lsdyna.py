"""LS-DYNA keyword files, by the syntax of the manual: layouts of cards, sets, parts, includes."""

import numpy as np
import pytest

from damaged import samples
from known_film import (
    LEFT,
    NODE_ID,
    NODES,
    QUAD_ID,
    QUADS,
    RIGHT_PART,
    check_film,
    film_of_text,
    refusal_of_text,
    rows_in,
)

WIDTHS = {  # id of a node, coordinate, entry of a shell, entry of other cards
    "": (8, 16, 8, 10),
    "I10=Y": (10, 16, 10, 10),
    "LONG=Y": (20, 20, 20, 20),
}


def card(values, width):
    if width is None:
        return ", ".join(map(str, values)) + "\n"
    return "".join(f"{v:>{width}}" for v in values) + "\n"


def deck(options="", free=False, mark=""):
    n, x, s, w = (None,) * 4 if free else WIDTHS[options]
    parts = np.where(np.isin(np.arange(10), RIGHT_PART), 2, 1)
    text = f"*KEYWORD {options}\n$ a comment\n*TITLE\na film\n*NODE{mark}\n"
    for i, xyz in zip(NODE_ID, NODES, strict=True):
        row = card([i], n) + card([f"{c:.8g}" for c in xyz], x)
        text += row.replace("\n", ", " if free else "", 1)
    text += "*PART\nleft part\n" + card([1, 1, 1], w) + "right part\n" + card([2, 1, 1], w)
    text += f"*ELEMENT_SHELL{mark}\n"
    for e in range(10):
        text += card([QUAD_ID[e], parts[e], *NODE_ID[QUADS[e]]], s)
    text += "*SET_NODE_LIST_TITLE\nleft\n" + card([7], w) + card(NODE_ID[LEFT], w)
    text += "*SET_SHELL_LIST\n" + card([4], w) + card([*QUAD_ID[:8]], w) + card([*QUAD_ID[8:]], w)
    return text + "*MAT_ELASTIC\n" + card([1, 1e-9, 1678.0], w) + "*END\nbeyond the end\n"


def film(tmp_path, text, **options):
    return film_of_text(tmp_path / "film.k", text, **options)


def refusal(tmp_path, text):
    return refusal_of_text(tmp_path / "film.k", text)


@pytest.mark.parametrize("options", list(WIDTHS))
def test_fixed_columns(tmp_path, options):
    mesh = film(tmp_path, deck(options))
    check_film(mesh)
    assert sorted(mesh.quad_sets) == ["left part", "right part", "shell_set_4"]
    assert len(mesh.quad_set("shell_set_4")) == 10
    assert list(mesh.node_sets) == ["left"]


def with_marks():
    text = deck("I10=Y").replace("*KEYWORD I10=Y", "*KEYWORD")
    return text.replace("*NODE\n", "*NODE %\n").replace("*ELEMENT_SHELL\n", "*ELEMENT_SHELL %\n")


def with_thickness():
    head, rest = deck().split("*ELEMENT_SHELL\n")
    cards, tail = rest.split("*SET_NODE", 1)
    both = "".join(line + "\n" + card([0.074] * 4, 16) for line in cards.splitlines())
    return f"{head}*ELEMENT_SHELL_THICKNESS\n{both}*SET_NODE{tail}"


LOWER = deck().replace("*NODE", "*node").replace("*ELEMENT_SHELL", "*Element_Shell")


@pytest.mark.parametrize(
    "text",
    [deck(free=True), with_marks(), LOWER.replace(f"{0:>16}", " " * 16), with_thickness()],
    ids=["commas", "marks behind keywords", "lower case, blank fields", "cards of thickness"],
)
def test_the_same_film_in_other_writings(tmp_path, text):
    check_film(film(tmp_path, text))


def test_another_layout_none_or_no_end(tmp_path, caplog):
    told = refusal(tmp_path, deck("LONG=Y").replace("LONG=Y", ""))
    assert "is it in another layout" in told
    assert "a keyword must come first" in refusal(tmp_path, "hello\n")
    check_film(film(tmp_path, deck().split("*END")[0]))
    assert "no *END: the file may be cut short" in caplog.text


def more(*lines):
    return deck().replace("*END\n", "".join(lines) + "*END\n")


def test_sets_of_every_kind(tmp_path, caplog):
    a, b = sorted(NODE_ID)[:2]
    mesh = film(
        tmp_path,
        more(
            "*SET_NODE_LIST_GENERATE\n" + card([20], 10) + card([a, b, 0, 0], 10),
            "*SET_NODE_COLUMN\n" + card([21], 10) + card([a], 10) + card([b], 10),
            "*SET_PART_LIST\n" + card([9], 10) + card([1, 2], 10),
            "*SET_NODE_GENERAL\n" + card([8], 10) + "BOX".ljust(10) + card([1], 10),
        ),
    )
    ab = set(rows_in(mesh, NODES[[list(NODE_ID).index(a), list(NODE_ID).index(b)]]))
    assert set(mesh.node_set("node_set_20")) == ab
    assert set(mesh.node_set("node_set_21")) == ab
    assert len(mesh.quad_set("part_set_9")) == 10
    assert "node set 'node_set_8' is left out: *SET_NODE_GENERAL is not read" in caplog.text
    again = "*SET_NODE_LIST_TITLE\nleft\n" + card([8], 10) + card([NODE_ID[0]], 10)
    assert sorted(film(tmp_path, more(again)).node_sets) == ["left (7)", "left (8)"]


def test_triangles_repeat_their_last_node(tmp_path):
    n = NODE_ID
    extra = more(
        "*NODE\n" + card([9000], 8)[:-1] + card(["6.0", "0.5", "0.0"], 16),
        "*ELEMENT_SHELL\n" + card([9, 2, n[5], 9000, n[11], n[11]], 8),
    )
    told = refusal(tmp_path, extra)
    assert "got 1 triangles beside 10 quads (ids 9)" in told
    mesh = film(tmp_path, extra, triangles="split")
    assert mesh.n_quad == 4 * 10 + 3
    assert len(mesh.quad_set("right part")) == 4 * len(RIGHT_PART) + 3
    zero = extra.replace(card([n[11], n[11]], 8), card([n[11], 0], 8))
    assert film(tmp_path, zero, triangles="split").n_quad == 43


def test_quadratic_shells_are_read_by_their_corners_by_choice(tmp_path):
    text, order = deck(), sorted(QUAD_ID, key=lambda e: e % 3)
    for e in order[::2]:  # the middle nodes need no place: only the corners are taken
        (line,) = (t for t in text.splitlines() if t.startswith(f"{e:>8}") and len(t) == 48)
        text = text.replace(line, line + card([line[16:24].strip()] * 4, 8)[:-1])
    check_film(film(tmp_path, text, quadratic="corners"))


def test_a_node_written_again_at_its_place_is_one(tmp_path, caplog):
    def again(x):
        place = [f"{c:g}" for c in (x, *NODES[3][1:])]
        return more("*NODE\n" + card([NODE_ID[3]], 8)[:-1] + card(place, 16))

    check_film(film(tmp_path, again(NODES[3][0])))
    assert f"1 nodes belong to no quad and are left out (ids {NODE_ID[3]})" in caplog.text
    told = refusal(tmp_path, again(7.0))
    assert f"must occur once, or twice at one place, got {NODE_ID[3]}" in told


def test_ranges_and_includes_without_end(tmp_path):
    wide = "*SET_NODE_LIST_GENERATE\n" + card([8], None) + f"1, {2**63 - 1}\n"
    assert len(film(tmp_path, more(wide)).node_set("node_set_8")) == 18
    for k in range(1, 30):
        (tmp_path / f"i{k}.k").write_text(f"*INCLUDE\ni{k + 1}.k\ni{k + 1}.k\n")
    (tmp_path / "i30.k").write_text("*KEYWORD\n")
    told = refusal(tmp_path, more("*INCLUDE\ni1.k\n"))
    assert "1,000 files with those included at most, got 1,001" in told


def test_includes(tmp_path):
    text = deck()
    at, end = text.index("*NODE"), text.index("*PART")
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "nodes of it.k").write_text("*KEYWORD\n" + text[at:end] + "*END\n")
    (tmp_path / "parts" / "nodes.k").write_text(text[at:end])
    for name in ("nodes of it.k", "nod +\nes.k"):
        path = f"*INCLUDE_PATH\nparts\n*INCLUDE\n{name}\n"
        check_film(film(tmp_path, text[:at] + path + text[end:]))


@pytest.mark.parametrize(
    ("add", "words"),
    [
        ("*NODE_TRANSFORM\n", "*NODE_TRANSFORM: generates or moves nodes"),
        ("*INCLUDE_TRANSFORM\nx.k\n", "*INCLUDE_TRANSFORM: is not read"),
        ("*INCLUDE\nnone.k\n", "'none.k' must lie beside"),
        ("*INCLUDE\nfilm.k\n", "must not include itself"),
        ("*ELEMENT_SOLID\n" + card([5, 1], 8), "1 cells of kind 'ELEMENT_SOLID' (ids 5)"),
        ("*ELEMENT_SHELL\n" + card([5, 1, *NODE_ID[:8]], 8), "'ELEMENT_SHELL of 5 to 8 nodes'"),
        ("*ELEMENT_SHELL_COMPOSITE\n", "options must be among THICKNESS"),
        ("*ELEMENT_SHELL\n" + card([5, 1, 10, 17, 0, 0], 8), "must have 3 or 4 nodes"),
        ("*ELEMENT_SHELL\n" + card([5, 1, 10, 17, 24, 3], 8), "shells must name nodes"),
        ("*ELEMENT_SHELL\n" + card([QUAD_ID[0], 1, 10, 17, 24, 31], 8), "must occur once"),
        ("*NODE\n" + card([0], 8), "the node id must be 1 or more"),
        ("*NOD\n", "did you mean *NODE?"),
        ("*SET_NOD_LIST_TITLE\nrim\n", "mean *SET_NODE"),
        ("*SET_NODE_LIST\n", "a set must have an id"),
        ("*SET_NODE_LIST\n" + card([30], 10) + card([11], 10), "got 11; is the file cut short?"),
        ("*PART\nalone\n", "each part must have a title and a card"),
    ],
)
def test_refusals(tmp_path, add, words):
    assert words in refusal(tmp_path, more(add))


COMMAS = samples.lsdyna(commas=True)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("\n", "\n", "not used, a film takes nodes, quads and sets only: 1 *MAT_ELASTIC"),
        ("0.0\n2,", "0.0, 7, 0\n2,", "1 constraints TC, RC on cards of"),
        ("*MAT_EL", "*PARAMETER\nrx, 3\n*MAT_EL", "1 *MAT_ELASTIC, 1 *PARAMETER"),
        ("*MAT_EL", "*SET_BEAM\n1\n*MAT_EL", "1 *SET_BEAM"),
        ("\n60, 1, 40", "\n60, 7, 40", "shells are of parts 7, which no *PART"),
        ("*SET_SHELL_LIST_T", "*SET_BLOB_T", "1 *SET_BLOB_TITLE"),
    ],
)
def test_what_is_not_used_is_said(tmp_path, caplog, old, new, told):
    assert old == new or COMMAS.count(old) == 1, "the sample has changed"
    film(tmp_path, COMMAS.replace(old, new))
    assert told in caplog.text

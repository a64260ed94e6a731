"""Abaqus input files, by the syntax of the manual: decks, parts and instances, sets, includes."""

import logging

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
from shellcut.formats.budget import LIMITS

NODE_LINES = [
    f"{i}, {x:.9g}, {y:.9g}, {z:.9g}\n" for i, (x, y, z) in zip(NODE_ID, NODES, strict=True)
]
ALL_NODES = "".join(NODE_LINES)


def ids(values):
    return f"{', '.join(map(str, values))}\n"


def quads(members=range(10)):
    return "".join(f"{QUAD_ID[e]}, {', '.join(map(str, NODE_ID[QUADS[e]]))}\n" for e in members)


LEFT_IDS, RIGHT_IDS = NODE_ID[LEFT], QUAD_ID[RIGHT_PART]
FLAT = f"""*HEADING
A film
** a comment, with, commas
*NODE
{ALL_NODES}*ELEMENT, TYPE=S4R, ELSET=film
{quads()}*NSET, NSET=left
{ids(LEFT_IDS)}*ELSET, ELSET="right part"
{ids(RIGHT_IDS)}*MATERIAL, NAME=PE
*ELASTIC
1678., 0.3
*STEP
*END STEP
"""


def film(tmp_path, text, **options):
    return film_of_text(tmp_path / "film.inp", text, **options)


def refusal(tmp_path, text):
    return refusal_of_text(tmp_path / "film.inp", text)


class TestFlatDeck:
    def test_keywords_sets_elements_and_numbers_in_any_form(self, tmp_path):
        mesh = film(tmp_path, FLAT)
        check_film(mesh)
        assert len(mesh.quad_set("film")) == 10
        text = FLAT.replace("*ELEMENT, TYPE=S4R, ELSET=film", " *Element , type = s4r,\nElSet=film")
        check_film(film(tmp_path, text.replace("*NODE\n", "*node\n")))
        text = FLAT.replace(f"{NODE_ID[5]}, 5, 0, 0", f"{NODE_ID[5]}, 0.5D+01, 0.e0")
        assert text != FLAT
        check_film(film(tmp_path, text))
        whole = quads([0])
        assert whole in FLAT
        in_two_lines = ",\n".join(whole.rsplit(", ", 2)[:2]) + f", {whole.rsplit(', ', 1)[1]}"
        check_film(film(tmp_path, FLAT.replace(whole, in_two_lines)))

    def test_sets_named_on_node_and_element(self, tmp_path):
        right = [e for e in range(10) if e in RIGHT_PART]
        other = [e for e in range(10) if e not in RIGHT_PART]
        left = "".join(NODE_LINES[k] for k in LEFT)
        rest = "".join(line for k, line in enumerate(NODE_LINES) if k not in LEFT)
        text = f"*NODE, NSET=left\n{left}*NODE\n{rest}*ELEMENT, TYPE=S4, ELSET=right part\n"
        check_film(film(tmp_path, f"{text}{quads(right)}*ELEMENT, TYPE=S4R\n{quads(other)}"))

    def test_sets_of_sets_sets_in_parts_and_nodes_of_elements(self, tmp_path):
        text = FLAT + (
            "*ELSET, ELSET=both\nRIGHT PART, more\n*ELSET, ELSET=more\n"
            f"{QUAD_ID[0]}\n*NSET, NSET=rim\nLeft, {NODE_ID[17]}\n*NSET, NSET=rim\n{NODE_ID[16]}\n"
            "*NSET, NSET=beside, ELSET=right part\n"
            f"*ELSET, ELSET=span, GENERATE\n{min(RIGHT_IDS)}, {max(RIGHT_IDS)}, 3\n"
            f"*ELSET, ELSET=all, GENERATE\n{QUAD_ID.min() - 1}, {QUAD_ID.max()}\n"
        )
        mesh = film(tmp_path, text)
        inside = (min(RIGHT_IDS) <= QUAD_ID) & (max(RIGHT_IDS) >= QUAD_ID)
        assert len(mesh.quad_set("span")) == inside.sum()
        assert len(mesh.quad_set("all")) == 10  # over gaps in the ids
        assert len(mesh.quad_set("both")) == len(RIGHT_PART) + 1  # defined before "more" is
        rim = rows_in(mesh, NODES[[*LEFT, 17, 16]])
        assert set(mesh.node_set("rim")) == set(rim)
        beside = rows_in(mesh, NODES[np.unique(QUADS[RIGHT_PART])])
        assert set(mesh.node_set("beside")) == set(beside)

    def test_includes_and_data_from_files(self, tmp_path):
        (tmp_path / "sub").mkdir()
        (tmp_path / "sub" / "mesh.inp").write_text(
            f"*NODE, INPUT=nodes.txt\n*ELEMENT, TYPE=S4\n{quads()}"
        )
        (tmp_path / "sub" / "nodes.txt").write_text("** only data\n" + ALL_NODES)
        sets = FLAT[FLAT.index("*NSET") : FLAT.index("*MATERIAL")]
        check_film(film(tmp_path, f"*INCLUDE, INPUT=sub/mesh.inp\n{sets}"))


class TestPartsAndInstances:
    PART = f"*PART, NAME=Sheet\n*NODE\n{ALL_NODES}*ELEMENT, TYPE=S4R\n{quads()}*NSET, NSET=left\n"
    PART += f"{ids(LEFT_IDS)}*ELSET, ELSET=right part\n{ids(RIGHT_IDS)}*END PART\n"

    def test_a_part_alone_and_one_instance_where_the_part_is(self, tmp_path):
        check_film(film(tmp_path, self.PART))
        text = self.PART + "*ASSEMBLY, NAME=a\n*INSTANCE, NAME=s-1, PART=SHEET\n*END INSTANCE\n"
        text += f"*NSET, NSET=corner, INSTANCE=S-1\n{NODE_ID[0]}\n"
        text += f"*NSET, NSET=far\ns-1.{NODE_ID[17]}\n*NSET, NSET=again\ns-1.left\n*END ASSEMBLY\n"
        mesh = film(tmp_path, text)
        row = check_film(mesh)
        assert mesh.node_set("corner").tolist() == [row[0]]
        assert mesh.node_set("far").tolist() == [row[17]]
        assert set(mesh.node_set("again")) == set(row[LEFT])

    def test_an_instance_is_moved_then_turned(self, tmp_path):
        # a quarter turn about the line through (10, 0, 0) along z, after a shift of (1, 2, 3)
        text = self.PART + "*ASSEMBLY, NAME=a\n*INSTANCE, NAME=s, PART=Sheet\n1., 2., 3.\n"
        text += "10., 0., 0., 10., 0., 1., 90.\n*END INSTANCE\n*END ASSEMBLY\n"
        mesh = film(tmp_path, text)
        x, y, z = (NODES + np.array([1.0, 2.0, 3.0])).T
        turned = np.stack([10.0 - y, x - 10.0, z], axis=1)
        np.testing.assert_allclose(mesh.nodes, turned, rtol=0, atol=1e-14)  # round-off

    def test_two_instances_keep_their_sets_apart_and_merge_by_choice(self, tmp_path, caplog):
        text = self.PART + "*ASSEMBLY, NAME=a\n*INSTANCE, NAME=one, PART=Sheet\n*END INSTANCE\n"
        text += "*INSTANCE, NAME=two, PART=Sheet\n5., 0., 0.\n*END INSTANCE\n*NSET, NSET=ends\n"
        text += "one.left, two.left\n*END ASSEMBLY\n"
        mesh = film(tmp_path, text)
        assert (mesh.n_node, mesh.n_quad) == (36, 20)
        assert {"one.left", "two.left", "ends"} <= set(mesh.node_sets)
        assert "3 pairs of nodes are at one place" in caplog.text
        joined = film(tmp_path, text, merge=1e-6)
        assert joined.n_node == 33
        assert "3 nodes are merged" in caplog.text
        assert (joined.edges().n_quad == 1).sum() == 2 * (10 + 2)
        x = joined.nodes[joined.node_set("ends")][:, 0]
        assert sorted(x) == [0.0, 0.0, 0.0, 5.0, 5.0, 5.0]


def test_lines_become_node_sets_and_doubled_sets_are_read_once(tmp_path):
    line = f"*ELEMENT, TYPE=T3D2, ELSET=rim\n9001, {NODE_ID[0]}, {NODE_ID[6]}\n"
    mesh = film(tmp_path, FLAT + line)
    assert set(mesh.node_set("rim")) == set(rows_in(mesh, NODES[[0, 6]]))
    double = "".join(f"*NSET, NSET=s{k + 1}\ns{k}, s{k}\n" for k in range(40))
    mesh = film(tmp_path, FLAT + f"*NSET, NSET=s0\n{NODE_ID[0]}\n{double}")
    assert mesh.node_set("s40").tolist() == mesh.node_set("s0").tolist()
    check_film(film(tmp_path, FLAT + "*NODE, NSET=again\n" + NODE_LINES[3]))


def test_nodes_of_no_quad_are_said(tmp_path, caplog):
    with caplog.at_level(logging.WARNING):
        mesh = film(tmp_path, FLAT + "*NODE\n99999, 50., 50.\n*NSET, NSET=left\n99999\n")
    check_film(mesh)
    assert "1 nodes belong to no quad and are left out (ids 99999)" in caplog.text
    assert "1 of 4 of node set 'left'" in caplog.text


@pytest.mark.parametrize(
    ("add", "words"),
    [
        ("*NGEN\n1, 9, 1\n", "*NGEN: generates or moves nodes and elements"),
        ("*ELEMEN, TYPE=S4\n1, 1, 2, 3, 4\n", "did you mean *ELEMENT?"),
        ("*ELEMENT\n", "parameter TYPE must be given"),
        ("*ELEMENT, TYPE=S4\n1, 10, 17\n", "must have 4 nodes, got 2; is the file cut short?"),
        ("*ELEMENT, TYPE=S4\n1, 10, 17, 24, 31, 38\n", "must have 4 nodes, got 5"),
        ("*ELEMENT, TYPE=S4\n1, 10, 17, 24, 3\n", "must have nodes that are defined, got 3"),
        (f"*ELEMENT, TYPE=S4\n{quads([0])}", f"element id must occur once, got {QUAD_ID[0]}"),
        ("*NODE\n10, 0., 1.\n", "node 10 must have one place, got (0.0, 1.0, 0.0) and (0.0, 0.0"),
        ("*NODE\n1_0, 0., 0.\n", "entry 1 must be a whole number, got '1_0'"),
        ("*NODE, SYSTEM=C\n1000, 1., 0.\n", "must be Cartesian"),
        ("*NSET, NSET=x\n11\n", "node 11 must be defined"),
        ("*NSET, NSET=x\nnone\n", "there must be node set 'none'"),
        ("*NSET, NSET=x\nx\n", "must not contain itself"),
        ("*NSET, NSET=x, GENERATE\n1, 10, 2\n", "a step that divides their difference"),
        ("*NSET, NSET=x, GENERATE\n1, 1000000000000, 1\n", "50,000,000 ids in its sets at most"),
        ("".join(f"*NSET, NSET=s{k}\ns{k + 1}\n" for k in range(60)), "sets must nest to 50"),
        ("*NSET, NSET=x, INSTANCE=i\n10\n", "there must be an instance 'i'"),
        ("*PART, NAME=p\n", "*PART: must be ended by *END PART: cut short?"),
        ("*END PART\n", "but none is open"),
        ("*ELEMENT, TYPE=S8R\n1, 10, 17, 24, 31, 38, 45, 52,\n59\n", 'choose quadratic="corn'),
        ("*ELEMENT, TYPE=C3D8R\n1, 1, 2, 3, 4, 5, 6, 7, 8\n", "1 cells of kind 'C3D8R' (ids 1)"),
        ("*NODE,\n", "ends in a comma must continue"),
        ("*ELSET, ELSSET=x\n1\n", "'ELSSET'; did you mean ELSET"),
        ("*NSET NSET=x\n1\n", "a comma must stand between"),
    ],
)
def test_refusals(tmp_path, add, words):
    assert words in refusal(tmp_path, FLAT + add)


SAMPLE = samples.abaqus()


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("*Elastic", "*Boundary", "1 *BOUNDARY, 1 *MATERIAL, 1 *SHELL SECT"),
        ("0.00000\n2,", "0.00000, 0, 0, 1\n2,", "1 normals of nodes"),
        ("type=S4R", "type=M3D4", "elements of type M3D4, which do not bend"),
        ("type=S4R", "FILE=x, type=S4R", "parameter 'FILE' of *ELEMENT is not"),
        ("*Material", "*PARAMETER\nx = 3\n*Material", "1 *PARAMETER"),
        ("generate\n1, 9, 2\n", "generate\n", "node set 'first' in line"),
        ("generate\n1, 9, 2\n", "generate\n60, 90\n", "17 of the 31 nodes from"),
    ],
)
def test_what_is_not_used_is_said(tmp_path, caplog, old, new, told):
    film(tmp_path, SAMPLE)
    (said,) = caplog.messages
    assert "not used, a film takes nodes, quads and sets only: " in said
    assert SAMPLE.count(old) == 1, "the sample has changed"
    film(tmp_path, SAMPLE.replace(old, new))
    assert told in caplog.text


def test_what_instances_make_is_counted(tmp_path, monkeypatch):
    monkeypatch.setitem(LIMITS, "nodes and elements with those of all instances", 100)
    instances = "".join(f"*INSTANCE, NAME=s{k}, PART=Sheet\n*END INSTANCE\n" for k in range(4))
    text = f"{TestPartsAndInstances.PART}*ASSEMBLY, NAME=a\n{instances}*END ASSEMBLY\n"
    assert "100 nodes and elements with those of all instances" in refusal(tmp_path, text)


def test_lines_are_named_and_a_file_without_keywords_is_refused(tmp_path):
    told = refusal(tmp_path, FLAT + "*NODE\n1000, a, 0.\n")
    assert f"film.inp, line {FLAT.count(chr(10)) + 2}: " in told
    assert "entry 2 must be a number, got 'a'" in told
    assert "must hold *KEYWORD lines" in refusal(tmp_path, "hello\n")
    assert "there must be quads" in refusal(tmp_path, "*NODE\n1, 0., 0.\n")


def test_quadratic_shells_are_read_by_their_corners_by_choice(tmp_path, caplog):
    text = (
        "*NODE\n1, 0., 0.\n2, 4., 0.\n3, 4., 2.\n4, 0., 2.\n5, 2., -0.2\n6, 4., 1.\n7, 2., 2.\n"
        "8, 0., 1.\n*ELEMENT, TYPE=S8R, ELSET=film\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*NSET, NSET=left\n"
        "1, 8, 4\n"
    )
    mesh = film(tmp_path, text, quadratic="corners")
    assert mesh.nodes[mesh.quads].tolist() == [[[0, 0, 0], [4, 0, 0], [4, 2, 0], [0, 2, 0]]]
    assert mesh.quad_set("film").tolist() == [0]
    assert len(mesh.node_set("left")) == 2
    assert "'S8R' are read by their corners: their sides bow by 5 % of their leng" in caplog.text
    assert "1 of 3 of node set 'left'" in caplog.text
    with pytest.raises(ValueError, match="quadratic must be 'refuse' or 'corners'"):
        film(tmp_path, text, quadratic="yes")

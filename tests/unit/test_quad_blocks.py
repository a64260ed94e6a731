"""Blocks, strips and threads: every quad has one place, and every part is handed out once."""

import numpy as np
import pytest

from naive import cases
from shellcut.mesh.structured import cylinder, rectangle
from shellcut.mitc4.blocks import build_blocks
from shellcut.numerics.jit import BoundOnce
from shellcut.numerics.threads import Workers, in_order


def some_flat(mesh, seed=1):
    return np.random.default_rng(seed).random(mesh.n_quad) < 0.6


@pytest.mark.parametrize("case", cases.ALL)
def test_every_quad_has_one_place_with_its_nodes(case):
    mesh = cases.ALL[case](7, 5)
    flat = some_flat(mesh)
    blocks = build_blocks(mesh.nodes, mesh.quads, flat)
    places = blocks.quad.ravel()[blocks.filled.ravel()]
    assert sorted(places.tolist()) == list(range(mesh.n_quad))
    block, lane = np.divmod(blocks.slot, 8)
    np.testing.assert_array_equal(blocks.quad[block, lane], np.arange(mesh.n_quad))
    np.testing.assert_array_equal(blocks.corner[block, :, lane], mesh.quads)
    # Flat quads stand first, and each kind in blocks of its own.
    assert ((block < blocks.n_flat) == flat).all()
    # Where there is none the nodes are still those of some quad.
    np.testing.assert_array_equal(blocks.corner.transpose(0, 2, 1), mesh.quads[blocks.quad])


def test_quads_whose_nodes_follow_each_other_share_blocks():
    mesh = rectangle(20.0, 3.0, n_x=20, n_y=3)
    flat = np.ones(mesh.n_quad, np.bool_)
    flat[25] = False  # amid the second row, which then has one chain of eight instead of two
    blocks = build_blocks(mesh.nodes, mesh.quads, flat)
    follows = (np.diff(blocks.corner, axis=2) == 1).all(axis=(1, 2))
    np.testing.assert_array_equal(blocks.chain, follows)
    assert follows.sum() == 5
    # Numbered at random there are none, and every quad still has its place.
    names = np.random.default_rng(3).permutation(mesh.n_node)
    nodes = np.empty_like(mesh.nodes)
    nodes[names] = mesh.nodes
    blocks = build_blocks(nodes, names[mesh.quads], flat)
    assert not blocks.chain.any()
    assert sorted(blocks.quad[blocks.filled].tolist()) == list(range(60))


@pytest.mark.parametrize(
    "mesh",
    [
        rectangle(300.0, 100.0, n_x=300, n_y=100),
        cylinder(20.0, 90.0, n_around=150, n_along=200),
    ],
    ids=["sheet", "tube"],
)
def test_only_neighbouring_strips_share_nodes(mesh):
    flat = np.zeros(mesh.n_quad, np.bool_)
    blocks = build_blocks(mesh.nodes, mesh.quads, flat)
    assert blocks.n_strip >= 4
    assert blocks.n_strip % 2 == 0
    touched = [set() for _ in range(mesh.n_node)]
    for k in range(blocks.n_strip):
        corner = blocks.corner[blocks.full_start[k] : blocks.full_start[k + 1]]
        for node in np.unique(corner):
            touched[node].add(k)
    assert all(max(strips) - min(strips) <= 1 for strips in touched)
    # Even shares, or the second thread would wait.
    size = np.diff(blocks.full_start)
    assert size.max() <= size.min() + 1


def test_quads_that_more_strips_do_not_part_stay_in_two():
    # All quads span the length, so their order along it says nothing; numbered at random, every
    # strip would share nodes with every other, and two strips are neighbours whatever they share.
    mesh = rectangle(1.0, 50.0, n_x=1, n_y=25_000)
    turned = mesh.nodes[:, [1, 0, 2]] * [0.001, 1000.0, 1.0]
    quads = np.random.default_rng(4).permutation(mesh.quads)
    assert build_blocks(turned, quads, np.ones(len(quads), np.bool_)).n_strip == 2
    # In order, the same quads part well: it is not their shape that forbids it.
    assert build_blocks(turned, mesh.quads, np.ones(len(quads), np.bool_)).n_strip == 4


@pytest.mark.parametrize("threads", [1, 3])
def test_every_part_is_done_once(threads):
    workers = Workers(10, threads)
    done = np.zeros(workers.count, int)

    def part(k, count, by):
        assert count == threads
        done[k] += by

    workers.run(BoundOnce(part), 2)
    assert done.tolist() == [2] * threads


def test_an_error_of_any_part_reaches_the_caller():
    def part(k, _count):
        if k == 1:
            raise RuntimeError("part 1")

    with pytest.raises(RuntimeError, match="part 1"):
        Workers(10, 2).run(BoundOnce(part))


def test_totals_are_over_all_parts_in_their_order():
    assert in_order(np.array([[1.0, 2.0]])) == [1.0, 2.0]
    # 1e16 + 1 + 1 from the left keeps 1e16, from the right it would not.
    assert in_order(np.array([[1e16, 1.0], [1.0, 2.0], [1.0, 4.0]])) == [1e16, 7.0]


def test_a_small_film_has_one_thread_and_nonsense_is_refused():
    assert Workers(49_999).count == 1
    for nonsense in (0, 100_000, 2.0):
        with pytest.raises(ValueError, match=f"threads must be .*, got {nonsense}"):
            Workers(10, nonsense)


def test_more_threads_than_cores_are_said(monkeypatch, caplog):
    monkeypatch.setattr("shellcut.numerics.threads.available_cores", lambda: 2)
    Workers(10, 2)
    assert not caplog.messages
    assert Workers(10, 3).count == 3
    assert caplog.messages == [
        "3 threads share 2 cores: the run is slower than with one thread per core"
    ]

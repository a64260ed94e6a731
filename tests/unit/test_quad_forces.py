"""Lanes against plain floats, threads against one, other processors, no compiler."""

import os
import platform
import subprocess
import sys

import numpy as np
import pytest

from naive import cases
from shellcut import Elastic, Layer, Pressure, ShellMaterial, Simulation, Support
from shellcut.mesh.structured import cylinder, disc, rectangle
from shellcut.mitc4.blocks import build_blocks
from shellcut.mitc4.initial_state import initial_state
from shellcut.mitc4.shell import MITC4Shell
from shellcut.numerics.jit import BoundOnce, kernel
from shellcut.numerics.processor import flush_subnormals, set_rounding
from shellcut.numerics.threads import Workers, in_order

LAYERED = [Layer(Elastic(800.0, 0.35, 1e-9), 0.05), Layer(Elastic(30e3, 0.33, 2.7e-9), 0.02)]
MATERIALS = {
    "film": cases.FILM,
    "film by points": ShellMaterial.homogeneous(points_per_layer=2),
    "layers": ShellMaterial(LAYERED),
    "layers by points": ShellMaterial(LAYERED, points_per_layer=3),
}


def moved_twice(mesh, material):
    """Forces and work after two damped steps from rest to a far state."""
    shell = MITC4Shell(mesh, material, damping_beta=2e-7)
    state = initial_state(mesh)
    shell.initialise(state)
    n = mesh.n_node
    far = cases.deform(initial_state(mesh)).node
    result = []
    for part, dt in ((0.0, 0.0), (0.4, 1e-7), (1.0, 3e-7)):
        state.dt = dt
        state.node.x[:n] = (1 - part) * mesh.nodes + part * far.x[:n]
        t = (1 - part) * mesh.directors + part * far.t[:n]
        state.node.t[:n] = t / np.linalg.norm(t, axis=1)[:, None]
        state.node.force_rows[:] = 0.0
        result.append((shell.add_forces(state), state.node.force_rows[:n, :6].copy()))
    return result


@pytest.mark.parametrize("case", cases.ALL)
def test_at_rest_there_is_no_force_not_even_one_of_round_off(case):
    shell, state = cases.set_up(cases.ALL[case](11, 3), damping_beta=2e-7)
    assert shell.add_forces(state).strain_energy == 0.0
    assert not state.node.force_rows[: state.n_node].any()


@pytest.mark.parametrize("case", cases.ALL)
@pytest.mark.parametrize("layers", ["film", "layers"])
def test_points_and_the_integrated_section_agree(case, layers):
    # Two ways to the same integral; on a curved quad the section takes more points than two.
    mesh = cases.ALL[case](5, 3)
    section = moved_twice(mesh, MATERIALS[layers])
    points = moved_twice(mesh, MATERIALS[f"{layers} by points"])
    limit = 1e-12 if case == "flat" else 1e-3
    for (work, force), (wanted_work, wanted) in zip(points, section, strict=True):
        np.testing.assert_allclose(force, wanted, rtol=0, atol=limit * np.abs(wanted).max() + 1e-18)
        scale = max(abs(wanted_work.strain_energy), abs(wanted_work.damping))
        np.testing.assert_allclose(work, wanted_work, rtol=0, atol=limit * scale + 1e-24)


def run_sheet(threads):
    mesh = rectangle(60.0, 35.0, n_x=204, n_y=100)
    sim = Simulation(
        mesh,
        cases.FILM,
        supports=[Support.clamped("left")],
        loads=[Pressure(0.05), Pressure(0.02, following=True)],
        threads=threads,
    )
    for _ in range(4):
        sim.step()
    n = sim.state.node
    rows = (n.x, n.t, n.velocity_half, n.spin_half, n.reaction)
    return [r[: mesh.n_node].copy() for r in rows], vars(sim.close_ledger())


def test_results_do_not_depend_on_the_number_of_threads():
    rows, entries = run_sheet(1)
    for threads in (2, 3):
        other_rows, other_entries = run_sheet(threads)
        assert all((a == b).all() for a, b in zip(rows, other_rows, strict=True))
        assert entries == other_entries


of_x86 = pytest.mark.skipif(
    platform.machine().lower() not in ("x86_64", "amd64"), reason="x86 only has the setting"
)


@kernel
def _setting():
    before = flush_subnormals()
    set_rounding(before)
    return before


@of_x86
@pytest.mark.parametrize("material", ["film", "film by points"])
def test_a_step_leaves_the_processor_as_it_was(material):
    before = _setting() & 0x8040
    sim = Simulation(disc(2.0, n_side=4, n_layer=1), MATERIALS[material], threads=2)
    sim.step()
    there = sim.shell._workers._pool.submit(_setting).result()
    # The flags of exceptions that have been stay; what is flushed or not is as before.
    assert [_setting() & 0x8040, there & 0x8040] == [before, before]


@kernel
def _halved(values, out):
    before = flush_subnormals()
    out[0] = 0.5 * values[0]
    set_rounding(before)
    out[1] = 0.5 * values[1]


@of_x86
def test_subnormals_are_flushed_where_asked_and_nowhere_else():
    out = np.ones(2)
    least = np.full(2, 2.0**-1022)  # of the doubles with all their digits
    _halved(least, out)
    assert out.tolist() == [0.0, 2.0**-1023]
    assert (0.5 * least == 2.0**-1023).all()  # and not in what follows


_ELSEWHERE = """
import sys
import numpy as np
from test_quad_forces import forces_here
np.save(sys.argv[1], forces_here())
"""


def forces_in_another_process(tmp_path, **environment):
    """Forces of flat and curved quads, by sections and by points, with other settings of Numba."""
    here, out = os.path.dirname(__file__), tmp_path / "forces.npy"
    path = os.pathsep.join(p for p in (here, os.path.dirname(here), *sys.path) if p)
    environment |= {"PYTHONPATH": path, "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    command = [sys.executable, "-c", _ELSEWHERE, str(out)]
    subprocess.run(command, check=True, env=os.environ | environment)
    return np.load(out)


def forces_here():
    out = []
    for case in ("flat", "curved"):
        for material in ("film", "layers by points"):
            for work, force in moved_twice(cases.ALL[case](11, 3), MATERIALS[material]):
                out += [np.array(work), force.ravel()]
    return np.concatenate(out)


@pytest.mark.slow  # compiled again for either
@pytest.mark.parametrize("processor", ["haswell", "generic"], ids=["AVX2", "SSE2"])
def test_the_same_forces_on_other_processors(tmp_path, processor):
    environment = {"NUMBA_CPU_NAME": processor, "NUMBA_CPU_FEATURES": ""}
    there, here = forces_in_another_process(tmp_path, **environment), forces_here()
    # Without fused instructions every product is rounded: round-off of the largest force.
    np.testing.assert_allclose(there, here, rtol=0, atol=1e-13 * np.abs(here).max())


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
    first, last = np.full(mesh.n_node, blocks.n_strip), np.full(mesh.n_node, -1)
    for k in range(blocks.n_strip):
        corner = blocks.corner[blocks.full_start[k] : blocks.full_start[k + 1]].ravel()
        first[corner] = np.minimum(first[corner], k)
        last[corner] = k
    assert (last - first <= 1).all()
    # Even shares, or the second thread would wait.
    size = np.diff(blocks.full_start)
    assert size.max() <= size.min() + 1
    small = build_blocks(mesh.nodes, mesh.quads[:19_999], flat[:19_999])
    assert small.n_strip == 1  # at least 5000 quads each


def test_quads_that_more_strips_do_not_part_stay_in_two():
    # All quads span the length, so their order along it says nothing; numbered at random, every
    # strip would share nodes with every other, and two strips are neighbours whatever they share.
    mesh = rectangle(1.0, 50.0, n_x=1, n_y=25_000)
    turned = mesh.nodes[:, [1, 0, 2]] * [0.001, 1000.0, 1.0]
    quads = np.random.default_rng(4).permutation(mesh.quads)
    assert build_blocks(turned, quads, np.ones(len(quads), np.bool_)).n_strip == 2
    # In order, the same quads part well: it is not their shape that forbids it.
    assert build_blocks(turned, mesh.quads, np.ones(len(quads), np.bool_)).n_strip == 4


class InPython(BoundOnce):
    """A part of a loop that is no kernel."""

    def __init__(self, function):
        self.code = function


def test_an_error_of_any_part_reaches_the_caller():
    def part(k, _count):
        if k == 1:
            raise RuntimeError("part 1")

    with pytest.raises(RuntimeError, match="part 1"):
        Workers(10, 2).run(InPython(part))


def test_totals_are_over_all_parts_in_their_order():
    assert in_order(np.array([[1.0, 2.0]])) == [1.0, 2.0]
    # 1e16 + 1 + 1 from the left keeps 1e16, from the right it would not.
    assert in_order(np.array([[1e16, 1.0], [1.0, 2.0], [1.0, 4.0]])) == [1e16, 7.0]


def test_a_small_film_has_one_thread_and_more_than_cores_are_said(monkeypatch, caplog):
    assert Workers(49_999).count == 1
    with pytest.raises(ValueError, match=r"threads must be .*, got 0"):
        Workers(10, 0)
    monkeypatch.setattr("shellcut.numerics.threads.available_cores", lambda: 2)
    assert (Workers(50_000).count, Workers(10, 2).count) == (2, 2)
    assert not caplog.messages
    assert Workers(10, 3).count == 3
    assert "3 threads share 2 cores: the run is slower" in caplog.text

"""The benchmarks run on tiny sizes and give sane figures; nothing here asserts a speed."""

import math
from dataclasses import replace

import numpy as np
import pytest

import shellcut.recording.recorder
from benchmarks import (
    calculix_disc,
    cut,
    gates,
    instructions,
    machine,
    memory,
    peers,
    report,
    steps,
    traffic,
)
from benchmarks.discs import build_mesh, pressurised_disc
from benchmarks.harness import Gate, Neighbours
from benchmarks.results import Results, load


def linear_disc(side):
    return pressurised_disc(build_mesh(side), "linear")


@pytest.fixture(scope="module")
def accesses():
    """How often a step goes over each array: a disc for each of them."""
    return traffic.accesses(linear_disc)


@pytest.fixture(scope="module")
def results(accesses) -> Results:
    """All parts at tiny sizes; the child processes and the other programs left out."""
    limits = machine.measure(array_bytes=2**16, rounds=1000)
    costs = [
        steps.measure_one("1e3", m, 1, repeats=2, accesses=accesses, evaluation=None)
        for m in ("linear", "points")
    ]
    small = memory.footprint("1e3", 1)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cut, "compile_all", lambda mesh: None)  # nothing here is a time that counts
        patch.setattr(shellcut.recording.recorder, "can_draw", lambda: False)
        cuts = [cut.measure("quick", 1.0, 0.5)]
    return Results(
        when="now",
        quick=True,
        machine=limits,
        machine_after=limits,
        steps=costs,
        block=instructions.Block(600, 80, 24, 300),
        memory=memory.Memory(small, replace(small, n_quad=small.n_quad + 1)),
        cuts=cuts,
        peers=[peers.run_ours(peers.build(4, 2))],
        missing_peers={peers.CALCULIX: "not installed"},
        neighbours={"machine": Neighbours().report()},
    )


BLOCK = """
        vfmadd231pd %zmm1, %zmm2, %zmm3
.LBB0_1:
        vgatherdpd (%rax,%ymm1,8), %zmm2 {%k1}
        vaddpd 64(%rsp), %zmm2, %zmm3
        vfnmadd213pd %zmm1, %zmm2, %zmm3
        vunpcklpd %zmm1, %zmm2, %zmm3
        vaddsd %xmm1, %xmm2, %xmm3
        vmovupd %zmm3, (%rax)
        jne .LBB0_1
"""


def test_instructions_are_counted_where_a_block_gathers():
    found = instructions.count(BLOCK)
    assert found == {"arithmetic": 2, "shuffle": 1, "gather": 1, "move": 1}
    # Where the arithmetic stands apart from what gathers, both count.
    apart = BLOCK.replace(
        "        vfn", ".LBB0_2:\n        vmulpd %zmm1, %zmm2, %zmm3\n        vfn"
    )
    assert instructions.count(apart) == {**found, "arithmetic": 3}
    # Three instructions on two ports at 4 GHz, for eight quads.
    two_ports = machine.Machine("", 8, 4.0, 128.0, None, 15.0, None, 1.0, 1.0, 1)
    assert instructions.Block(**found).least_ns(two_ports) == 3 / 2 / 4 / 8
    assert instructions.count("        vaddpd %zmm1, %zmm2, %zmm3") is None


def test_the_machine_has_limits_and_steps_have_costs_and_floors(results):
    m = results.machine
    assert m.lanes in (2, 4, 8)
    figures = [m.clock_ghz, m.peak_gflops, m.triad_gbytes, m.flops_a_cycle]
    for cost in results.steps:
        figures += [cost.arithmetic_floor(m.peak_gflops), cost.memory_floor(m.triad_gbytes)]
        figures += [cost.kernel, cost.kernel_best, cost.step, cost.plain_step_best]
        assert 0.0 <= cost.evaluation < math.inf
        assert cost.n_quad == 1008
    assert all(0.0 < figure < math.inf for figure in figures)


def test_traffic_finds_what_a_step_reads_and_writes(accesses):
    sim = linear_disc(8)
    assert set(accesses.values()) == {1, 2}
    # Positions are written; the reference they started from only stands in the state.
    assert any(n == 2 for path, n in accesses.items() if path.startswith("state"))
    assert traffic.bytes_per_step(sim, accesses) >= 2 * sim.state.node.x[: sim.mesh.n_node].nbytes
    # Connectivity, read only.
    arrays = traffic.arrays_of(sim)
    assert any(arrays[path].dtype.kind in "iu" for path, n in accesses.items() if n == 1)


def test_the_profile_adds_up_to_the_run(results):
    c = results.cuts[0]
    assert c.angle == pytest.approx(1.0, abs=0.01)  # a step passes the end
    assert c.not_found == []
    assert all(0.0 <= own < math.inf for own in c.parts.values())
    # Round-off: the parts are scaled to the run.
    whole = (c.run_seconds + c.closing_seconds) * 1e9 / (c.n_step * c.n_quad)
    assert sum(c.parts.values()) == pytest.approx(whole, rel=1e-9)


def test_a_part_keeps_only_its_own_time(monkeypatch):
    clock = iter(range(100))
    monkeypatch.setattr(cut.time, "perf_counter", lambda: float(next(clock)))
    profile = cut.Profile()
    inner = profile.timed("inner", lambda: None)
    profile.timed("outer", lambda: (inner(), inner()))()
    monkeypatch.setattr(cut, "_timer_cost", lambda: (0.0, 0.0))
    # The clock ticks once a reading: 1 s an inner call, 5 s the outer with both.
    assert profile.own_seconds(7.0) == {"inner": 2.0, "outer": 3.0, "driver": 2.0}
    monkeypatch.setattr(cut, "_timer_cost", lambda: (0.5, 0.25))
    assert profile.own_seconds(7.0) == {"inner": 1.0, "outer": 2.0, "driver": 1.75}


def test_the_disc_of_the_peers_is_the_librarys():
    model = peers.build(4, 2)
    sim = pressurised_disc(model.mesh, "linear")
    n = model.mesh.n_node
    # Round-off of sums over four quads.
    assert np.allclose(model.mass, sim.state.node.mass[:n], rtol=1e-12)
    assert np.allclose(model.load, peers.PRESSURE / (1e-9 * 0.074) * model.mass, rtol=1e-12)


def test_a_peak_is_found_between_samples():
    t = np.linspace(0.0, 1.0, 30)
    # Round-off: the parabola is met exactly.
    when = peers.first_peak(t, 2.0 - (t - 0.613) ** 2)
    assert when == pytest.approx((0.613, 2.0), rel=1e-9)


def test_calculix_is_told_and_read():
    mesh = build_mesh(4)
    text = calculix_disc.deck(mesh, 0.05, 0, (1678.0, 0.3, 1e-9, 0.074), 9e-5)
    lines = text.splitlines()
    first = lines.index("*ELEMENT, TYPE=S4R, ELSET=FILM") + 1
    quads = [[int(n) - 1 for n in line.split(",")[1:]] for line in lines[first:][: mesh.n_quad]]
    assert quads == mesh.quads.tolist()
    said = (
        " displacements (vx,vy,vz) for set MIDDLE and time  0.{}000000E-05\n\n"
        "        13 -5.7E-16  4.6E-16  {}E-03\n\n"
    )
    times, heights = calculix_disc.read_middle(said.format(1, 1.2) + said.format(2, 4.8))
    assert times.tolist() == [1e-6, 2e-6]
    assert heights.tolist() == [1.2e-3, 4.8e-3]


def test_gates_say_met_not_met_or_why_not(results):
    assert Gate("a", 2.0, 1.0).verdict == "met"
    assert Gate("a", 2.0, 1.0, at_least=True).verdict == "not met"
    assert Gate("a", 2.0, math.nan).met is False
    assert all(gate.met is None and gate.why_not for gate in gates.gates(Results()))
    whys = [gate.verdict for gate in gates.gates(results) if peers.CALCULIX in gate.what]
    assert whys == ["not measured: not installed"] * 2


def test_results_make_a_page_and_come_back(results, tmp_path):
    results.save(tmp_path / "r.json")
    again = load(tmp_path / "r.json")
    assert again == results
    report.write(again, tmp_path / "r")
    page = (tmp_path / "r" / "performance.md").read_text()
    assert "| linear | 1 | 1,008 |" in page
    pictures = {"performance_scaling.png", "performance_profile.png"}
    assert {p.name for p in (tmp_path / "r").iterdir()} == {"performance.md", *pictures}
    assert all(f"]({picture})" in page for picture in pictures)

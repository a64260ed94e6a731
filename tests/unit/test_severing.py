"""Edges that sever cables: what a run shows of it, and what it leaves alone."""

from dataclasses import replace

import numpy as np
import pytest

import shellcut as sc
from gone_on import check_goes_on
from notched_strip import cutting
from shellcut import CohesiveLaw, guillotine, read, trouser
from shellcut.checks.finding import DOUBT
from shellcut.models.trouser import TEAR_LAW
from shellcut.results.summary_figures import key_figures
from shellcut.tool.shapes import straight_blade

SHORT = CohesiveLaw(opening_a=0.05, opening_p=0.2, opening_u=0.3)


def sharp_cut(law=None, radius=0.01, threads=None):
    inputs = dict(cutting().inputs) | {"threads": threads}
    inputs["tool"] = straight_blade(
        half_thickness=0.1, length=2.0, height=2.0, edge_radius=radius
    ).translated((-0.02, 0.0, 0.0))
    inputs["law"] = law or replace(SHORT, cutting_energy=1.0, severing_pressure=20.0)
    return type(cutting())(**inputs)


def test_a_cut_that_severs_goes_on_from_a_checkpoint(tmp_path):
    check_goes_on(sharp_cut, lambda sim: sim.cables.n_broken > 0, tmp_path / "half.h5", n_step=300)


def torn(law):
    return trouser(1.0, length=10.0, notch=3.0, travel=1.5, law=law).simulation


NO_BLADE = replace(TEAR_LAW, onset=0.01)
LEFT_ALONE = {
    "beyond its blunt radius": (sharp_cut, SHORT, 200.0, 600),
    "a tear without a blade": (torn, NO_BLADE, 100.0, 1500),
}


@pytest.mark.parametrize(
    ("build", "law", "pressure", "n_step"), LEFT_ALONE.values(), ids=LEFT_ALONE
)
def test_what_no_edge_severs_keeps_every_bit(build, law, pressure, n_step):
    severing = replace(law, cutting_energy=1.0, severing_pressure=pressure)
    assert build is torn or severing.blunt_radius < 0.01
    runs = [build(one) for one in (law, severing)]
    for sim in runs:
        for _ in range(n_step):
            sim.step()
    whole, cut = (sim.state for sim in runs)
    assert whole.cable.count > 0
    np.testing.assert_array_equal(whole.node.x[: whole.n_node], cut.node.x[: cut.n_node])
    assert runs[0].ledger == runs[1].ledger


def sharp_guillotine(size, radius):
    blade = straight_blade(length=6.0, height=3.0, edge_radius=radius)
    law = CohesiveLaw(cutting_energy=1.0, severing_pressure=450.0)
    return guillotine(size, length=6.0, width=4.0, notch=1.0, travel=1.5, tool=blade, law=law)


def test_a_run_says_at_what_its_edge_severs(tmp_path):
    case = sharp_guillotine(1.0, 0.02)
    case.run(tmp_path, n_frame=2, n_snapshot=0, curves=False, progress=False)
    figures = read(tmp_path).summary
    assert figures["edge_radius_mm"] == 0.02
    assert figures["severing_energy_N_per_mm"] == pytest.approx(19.0, rel=1e-12)
    assert figures["severing_opening_mm"] == case.simulation.law.at_edge(0.02).opening_u
    assert figures["blunt_radius_mm"] == pytest.approx(42.5 / 900.0, rel=1e-12)
    assert ("energy at which the edge severs cables", "19 N/mm") in key_figures(figures)


@pytest.mark.parametrize(("radius", "doubted"), [(0.005, True), (0.04, False)])
def test_the_process_zone_of_a_sharp_edge_is_checked(radius, doubted):
    # l_U = 0.393 and 3.38 mm on quads of 0.5 mm.
    findings = sharp_guillotine(0.5, radius).check.findings
    said = [found.came for found in findings if found.severity == DOUBT]
    assert len(said) == doubted
    if doubted:
        assert "opening_u 0.3934 mm and sides of 0.5 mm on the path" in said[0]


def test_a_razor_has_no_radius():
    with pytest.raises(ValueError, match="edge with a radius needs severing_pressure"):
        sharp_cut(replace(SHORT, cutting_energy=1.0))
    assert sharp_cut(replace(SHORT, cutting_energy=1.0), 0.0).cables.at_edge.opening_u < 0.1


G_0, H = "cohesive.cutting_energy", "cohesive.severing_pressure"
SHORT_CUTS = {
    "membrane.length": 6,
    "membrane.width": 4,
    "membrane.size": 0.25,
    "notch": 1,
    "travel": 4.0,
    "fracture.path": "edges",
    "output.frames": 2,
    "output.rows": 300,
    "output.curves": False,
    "cohesive.opening_a": 0.1,
    "cohesive.opening_p": 0.6,
    "cohesive.opening_u": 0.8,
    G_0: 3.0,
    H: 100.0,
}


@pytest.mark.slow
def test_two_radii_tell_razor_and_pressure_apart_and_one_does_not(tmp_path):
    radii = {"tool.edge_radius": [0.01, 0.02]}
    known = sc.sweep("guillotine", radii, tmp_path / "known", settings=SHORT_CUTS, executor=1)
    curves, rng = [], np.random.default_rng(0)
    for run in known.plan.runs:
        history = read(run.folder(known.folder)).history
        force = history["force"]
        force = force + 0.03 * force.max() * rng.standard_normal(force.size)
        measured = sc.MeasuredCurve(history["path"], force, "mm", "N")
        curves.append(sc.FitCurve(measured, settings=run.values))

    def fitted(curves, folder):
        # A third to three times of 4 N/mm and 70 MPa, from which the fit starts.
        settings = {**SHORT_CUTS, G_0: "1.333:12", H: "23.33:210"}
        out, search = tmp_path / folder, sc.Search(max_runs=50)
        return sc.fit("guillotine", curves, out, settings=settings, search=search)

    both, one = fitted(curves, "both"), fitted(curves[1:], "one")
    # 2.94 and 102 were found; the noise leaves 5 % of each, and they make up for one another.
    assert [value.value for value in both.values] == pytest.approx([3.0, 100.0], rel=0.06)
    assert not any("apart" in note for note in both.notes)
    assert any(f"cannot tell {G_0} and {H} apart" in note for note in one.notes)
    sums = one.values[0].value + 2.0 * 0.02 * one.values[1].value
    assert sums == pytest.approx(7.0, rel=0.03)

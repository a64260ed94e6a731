"""The look before the run: a picture with both poses, and nothing in the model changes."""

import importlib
import re

import numpy as np
import pytest

import shellcut as sc
from naive import cases
from shellcut.models import preview
from shellcut.models.preview import ModelParts, edge_groups, preview_parts
from shellcut.tool.shapes import tooth_ring


def test_a_picture_of_both_poses_and_a_report(tmp_path):
    case = sc.opening_test("quick")
    sim, picture = case.simulation, tmp_path / "model.png"
    before = sim.state.node.x.copy()
    report = sc.preview(sim, picture, time=case.duration)
    assert picture.stat().st_size > 20_000
    quads = 'along sides of quads only (fracture.path = "edges")'
    for said in ("612 quads", "4 bodies", f"{sim.dt:.4g} s", quads):
        assert said in report
    steps = int(re.search(r"at least ([\d,]+) steps to 6 ms", report)[1].replace(",", ""))
    assert steps == pytest.approx(case.duration / sim.dt, rel=0.05)
    np.testing.assert_array_equal(sim.state.node.x, before)
    # The quad of the shortest step.
    (worst,) = re.findall(r"quad (\d+) at \(\S+, \S+, 0\) mm: [\d.]+ of the median", report)
    squared = sim.shell.frequencies.squared
    assert squared[int(worst)] == squared.max()
    for time in (-1.0, float("nan"), float("inf")):
        with pytest.raises(ValueError, match="time must be finite and not negative"):
            sc.preview(sim, tmp_path / "never.png", time=time)
    assert not (tmp_path / "never.png").exists()


def test_sets_are_counted_with_their_pieces(tmp_path):
    case = sc.guillotine(1.0, length=6.0, width=4.0, notch=1.0)
    report = sc.preview(case.simulation, tmp_path / "model.png")
    assert "sets   of nodes: left 6 in 2 pieces, right 5, bottom 7, top 7" in report


@pytest.fixture
def figures(monkeypatch):
    """The figures that are saved."""
    kept = []
    monkeypatch.setattr(preview, "save", lambda figure, _: kept.append(figure))
    return kept


def check_nothing_is_hidden_by(part, figure):
    """Check that a legend or text covers neither axes nor other texts, and return its box."""
    figure.draw_without_rendering()
    box = part.get_window_extent()
    assert not any(box.overlaps(axes.get_tightbbox()) for axes in figure.axes)
    others = [text for text in figure.texts if text is not part]
    assert not any(box.overlaps(text.get_window_extent()) for text in others)
    return box


@pytest.mark.parametrize("pitch", [12.0, 40.0])
def test_the_legend_hides_nothing(figures, pitch):
    case = sc.opening_test("quick", pitch=pitch)  # with 40 mm the line on the edges is longer
    sc.preview(case.simulation, "model.png", time=case.duration)
    (figure,) = figures
    assert not any(axes.get_legend() for axes in figure.axes)
    (legend,) = figure.legends
    box = check_nothing_is_hidden_by(legend, figure)
    assert 0.0 < box.x0 < box.x1 < figure.bbox.x1
    # The cutting edges lie above their path, as seen from above.
    drawn = {artist.get_label(): artist.get_zorder() for artist in figure.axes[0].get_children()}
    edges, path = (
        next(drawn[name] for name in drawn if part in name) for part in ("cutting", "path")
    )
    assert edges > path


@pytest.mark.parametrize("fixed", [None, 1e-8])
def test_every_step_says_what_it_is_of(tmp_path, fixed):
    stepping = sc.Stepping(safety=0.8, fixed=fixed)
    sim = sc.opening_test("quick", stepping=stepping).simulation
    report = sc.preview(sim, tmp_path / "model.svg")
    said = re.search(
        r"step   (\S+) s(.*)\n +stable: (\S+) s with contact and cables, (\S+) s for the "
        r"worst quad alone, (\S+) s for the median quad\n",
        report,
    )
    run, film, worst, median = (float(said[k]) for k in (1, 3, 4, 5))
    quality = sc.mesh_quality(sim.mesh, sim.material, damping_beta=sim.shell.damping_beta)
    assert (median, worst) == pytest.approx((np.median(quality.step), quality.step.min()), rel=1e-3)
    # The teeth stand just above the film: contact halves what its quads would allow.
    assert film < 0.7 * worst
    assert film == pytest.approx(sim.time_step.bound(sim.state), rel=1e-3)
    assert run == pytest.approx(sim.dt, rel=1e-3)
    if fixed is None:
        assert run == pytest.approx(0.8 * film, rel=2e-3)  # four figures of each
        assert said[2] == " at first, 0.8 (time.safety) of the stable"
    else:
        assert run == fixed
        assert "because time.fixed is given: " in said[2]
        assert said[2].endswith(f"without it {0.8 * sim.time_step.bound(sim.state):.4g} s")


def test_a_film_without_a_tool_is_drawn_once(tmp_path):
    mesh = cases.curved(4, 3)
    sim = sc.Simulation(mesh, cases.FILM, supports=[sc.Support.clamped([0, 1])])
    report = sc.preview(sim, tmp_path / "film.svg", time=1.0)
    assert "2 nodes supported" in report
    assert "tool" not in report
    assert (tmp_path / "film.svg").read_text().count("t = ") <= 1


@pytest.fixture
def drawn(monkeypatch):
    """What is given to the picture."""
    views = []
    # The package has a function of the name.
    module = importlib.import_module("shellcut.models.preview")

    def draw(parts, _, sweep, *__, **___):
        views.append((parts, sweep))

    monkeypatch.setattr(module, "draw_model", draw)
    return views


def two_rings(height=2.0):
    """Teeth that cut, and others that are beside the film."""
    ring = tooth_ring(n_teeth=1, height=height)
    return sc.Tool.from_triangles(
        np.concatenate([ring.vertices, ring.vertices * [2.0, 2.0, 1.0]]),
        np.concatenate([ring.triangles, ring.triangles + ring.n_vertex]),
        edges=np.concatenate([ring.edges, ring.edges + ring.n_vertex]),
        flank_angle_deg=ring.flank_angle_deg,
    )


@pytest.mark.parametrize(("angle", "label"), [(30.0, "in the film to the end"), (80.0, "leave")])
def test_cutting_edges_are_drawn_by_what_becomes_of_them(drawn, angle, label):
    # Teeth 2 mm high are through the film after 60.6 degrees of a pitch of 12 mm.
    case = sc.opening_test("quick", tool=two_rings(), angle_deg=angle)
    report = sc.preview(case.simulation, "never.png", time=case.duration)
    ((parts, sweep),) = drawn
    tool = parts.tool
    labels, colors, edges = zip(*edge_groups(tool, sweep), strict=True)
    assert label in labels[0]
    assert labels[1] == "1 cutting edge never meets the film"
    for k, mine in enumerate(edges):
        assert mine.tolist() == tool.edges[tool.edge_chain == k].tolist()
    assert len(set(colors)) == 2
    radius = np.linalg.norm(sweep.place, axis=1)
    assert np.abs(radius - 9.4).max() < 1e-3  # chords of the edge
    assert "never: 2" in report
    assert "note: 1 of 2 cutting edges never meet the film: cutting edge 2" in report


def test_of_a_model_that_is_refused_what_there_is_is_drawn(tmp_path):
    ring, mesh = tooth_ring(), sc.opening_test("quick").simulation.mesh
    film, tool = tmp_path / "film.png", tmp_path / "tool.png"
    assert preview_parts(ModelParts(tool=ring), tool).splitlines() == [
        "tool   4 bodies, 4,112 triangles, 4 cutting edges, 23.09 mm"
    ]
    assert preview_parts(ModelParts(mesh=mesh), film).startswith("film   649 nodes")
    assert all(picture.stat().st_size > 20_000 for picture in (film, tool))
    with pytest.raises(ValueError, match="neither film nor tool"):
        preview_parts(ModelParts(), "never.png")


def test_notch_and_supports_that_move_are_drawn(drawn):
    case = sc.trouser(1.0, length=10.0, notch=3.0)
    sc.preview(case.simulation, "never.png", time=case.duration)
    ((view, _),) = drawn
    assert np.abs(view.notch[:, :, 1:]).max() < 1e-12
    assert (view.notch[..., 0].min(), view.notch[..., 0].max()) == pytest.approx((0.0, 3.0))
    for (place, way), side in zip(view.pulls, (1.0, -1.0), strict=True):
        assert place[1] * side > 0.0
        assert not place[[0, 2]].any()
        assert way.tolist() == [0.0, 0.0, 2500.0 * side]


def test_the_picture_of_a_pull_tells_its_cost_below(figures):
    case = sc.trouser(1.0, length=10.0, notch=3.0)
    report = sc.preview(case.simulation, "model.png", time=case.duration)
    (figure,) = figures
    caption = next(text for text in figure.texts if "film  " in text.get_text())
    told = caption.get_text().splitlines()
    assert [line.split()[0] for line in told] == ["film", "run", "cracks"]
    assert set(told) <= set(report.splitlines())
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert {"notch", "2 supports that move"} <= set(labels)
    check_nothing_is_hidden_by(caption, figure)

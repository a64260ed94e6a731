"""Films that are turned and moved by keys, tools made blunt, and keys of one table of several."""

import numpy as np
import pytest

from shellcut import preset_film, read_model
from shellcut.mesh.mesh import Mesh, MeshError
from shellcut.mesh.placed import placed
from shellcut.mesh.structured import cylinder, rectangle
from shellcut.model_file.key_index import unit_of_key
from shellcut.model_file.overrides import spelled
from shellcut.model_file.reader import ModelVariants
from shellcut.study.factors import factors_of
from shellcut.study.fit_runs import FreeParameters
from shellcut.study.plan import Definition
from test_slips import LAMINATE, disc_in, written

SHEET = rectangle(4.0, 2.0, size=1.0)


@pytest.mark.parametrize("axis", ["x", "-x", "y", "-y", "-z", (1.0, 2.0, -0.5), "normal"])
def test_a_film_in_any_plane_comes_to_lie_level(axis):
    normal = np.array((1.0, 2.0, -0.5)) / np.sqrt(5.25)
    if axis in ("x", "-x", "y", "-y", "-z"):
        normal = np.eye(3)["xyz".index(axis[-1])]
    along = np.roll(normal, 1) - normal * (normal @ np.roll(normal, 1))
    along /= np.linalg.norm(along)
    sheet = SHEET.nodes @ np.stack([along, np.cross(normal, along), normal])
    film = placed(Mesh.from_arrays(sheet, SHEET.quads), axis=axis, shift=(0.0, 0.0, 3.0))
    np.testing.assert_allclose(film.nodes[:, 2], 3.0, atol=1e-14)
    np.testing.assert_allclose(np.abs(film.directors[:, 2]), 1.0, rtol=1e-14)
    np.testing.assert_allclose(film.edge_lengths(), SHEET.edge_lengths(), rtol=1e-13)
    assert axis != "normal" or (film.directors[:, 2] > 0.0).all()


def test_a_turn_about_the_axis_and_the_shift_come_in_this_order():
    film = placed(SHEET, turn_deg=90.0, shift=(1.0, 0.0, 0.0))
    X = SHEET.nodes
    turned = np.stack([1.0 - X[:, 1], X[:, 0], X[:, 2]], axis=1)
    np.testing.assert_allclose(film.nodes, turned, atol=1e-15)
    assert placed(SHEET) is SHEET


def test_a_shift_that_swallows_the_shape_of_the_film_is_refused():
    film = rectangle(4.0, 2.0, n_x=4, n_y=2)
    np.testing.assert_allclose(np.ptp(placed(film, shift=(4e6, 0, 0)).nodes, axis=0), [4, 2, 0])
    with pytest.raises(ValueError, match=r"shift must be at most 4e\+06 mm, .* got \[1e\+17"):
        placed(film, shift=(1e17, 0, 0))


def test_a_curved_film_has_no_normal():
    with pytest.raises(MeshError, match="give the direction in its file that becomes z"):
        placed(cylinder(3.0, 4.0, n_around=12, n_along=3), axis="normal")


def test_a_film_is_in_its_place_before_anything_is_chosen_on_it(tmp_path):
    keys = disc_in(tmp_path, at=(0.0, 0.0, 7.0), axes=(0, 1, 2))
    flat = read_model("opening", {"mesh": "quick"}).build().simulation
    sim = read_model("opening", {**keys, "membrane.shift": [0, 0, "-7 mm"]}).build().simulation
    np.testing.assert_allclose(sim.mesh.nodes, flat.mesh.nodes, atol=1e-12)
    assert (sim.state.node.supported == flat.state.node.supported).all()


@pytest.mark.parametrize(("model", "keys"), [("opening", {"mesh": "quick"}), ("guillotine", {})])
def test_a_tool_that_is_made_has_no_edges_if_told_so(model, keys):
    tool = read_model(model, {**keys, "tool.edges": "none"}).build().simulation.tool
    sharp = read_model(model, keys).build().simulation.tool
    assert (tool.n_edge, tool.n_triangle) == (0, sharp.n_triangle)
    assert sharp.n_edge > 0


def test_a_key_of_one_table_of_several_has_one_spelling(tmp_path):
    path, used = written(tmp_path, LAMINATE), tmp_path / "used.toml"
    first, second = (
        read_model(path, keys)
        for keys in ({"layers[0].thickness": "20 um"}, {"material.layers.0.thickness": 0.02})
    )
    assert first == second
    assert layers(first)[0].thickness == 0.02
    first.write(used)
    assert "# called material.layers.0 in --set" in used.read_text()
    assert read_model(used) == first
    assert spelled("layers[0].hardening.gain") == "material.layers.0.hardening.gain"
    assert unit_of_key("material.layers.0.thickness") == "mm"
    assert "material.layers.1.hardening" in first.titled()


def layers(model):
    return model.sections["material"].made().layers


def test_layers_of_a_preset_have_places_too():
    made = read_model("opening", {"material": "foil_ldpe", "layers[0].thickness": 0.01})
    others = [one.thickness for one in preset_film("foil_ldpe").layers[1:]]
    assert [one.thickness for one in layers(made)] == [0.01, *others]


def test_another_preset_of_a_layer_or_kind_of_load_leaves_no_key_of_the_first(tmp_path):
    path = written(tmp_path, LAMINATE)
    model = read_model(path, {"layers.0.preset": "pet", "layers.0.thickness": "12 um"})
    assert layers(model)[0] == preset_film("pet", thickness="12 um").layers[0]
    model = read_model(path, {"loads[0].acceleration": [0, 0, 1]})
    assert [one.kind for one in model.lists["loads"]] == ["gravity"]
    assert read_model(path, {"loads.0": {"value": 3.0}}).lists["loads"][0].value == 3.0


def test_studies_and_fits_take_them_in_both_spellings(tmp_path):
    path = written(tmp_path, LAMINATE)
    plan = Definition(path, {"layers[0].thickness": "0.02,0.03"}, {"loads[0].value": 0.002}).plan()
    assert plan.factors[0].keys == ("material.layers.0.thickness",)
    assert plan.definition.settings == {"loads.0.value": 0.002}
    assert plan.runs[0].key != plan.runs[1].key
    factors, _ = factors_of({"layers[1].thickness": "5 um : 20 um"})
    (free,) = FreeParameters(ModelVariants(path), factors).all
    assert (free.key, free.unit, free.low) == ("material.layers.1.thickness", "mm", 0.005)
    assert free.low <= free.start <= free.high

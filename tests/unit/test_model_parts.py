"""The parts of a model by themselves: those of the case that is built, and those there are."""

import numpy as np
import pytest

from free_model import FREE
from shellcut import ModelFileError, read_model

TWICE_HELD = FREE.replace('"bottom", "top"', '"bottom"') + '[[supports]]\nnodes = "top"\n'


@pytest.mark.parametrize("name", ["opening", "guillotine", "free", "trouser", "oscillating"])
def test_they_are_those_of_the_case(name, tmp_path):
    small = {
        "opening": {"mesh": "quick"},
        "guillotine": {"size": 0.5},
        "oscillating": {"size": 1.5},
    }
    (tmp_path / "free.toml").write_text(TWICE_HELD)
    model = read_model(tmp_path / "free.toml" if name == "free" else name, small.get(name))
    case, parts = model.build(), model.parts()
    sim = case.simulation
    # A notch is cut last, along a path that was in the mesh: it appends nodes.
    assert np.array_equal(parts.mesh.nodes, sim.mesh.nodes[: parts.mesh.n_node])
    held = np.flatnonzero(sim.state.node.supported[: sim.mesh.n_node])
    assert parts.supported.tolist() == held.tolist()
    if name == "trouser":
        assert (parts.tool, parts.motion, parts.duration) == (None, None, case.duration)
        return
    assert np.array_equal(parts.tool.vertices, sim.tool.vertices)
    assert parts.duration == case.duration
    for at in (0.0, 0.4 * case.duration, case.duration):
        for ours, theirs in zip(parts.motion.pose(at), sim.motion.pose(at), strict=True):
            assert np.array_equal(ours, theirs)


@pytest.mark.parametrize(
    "wrong", ["[cohesive]\nstrength = -1", "[material]\ndensity = 1", "[output]\nframes = 0", "[a]"]
)
def test_what_is_wrong_elsewhere_takes_nothing_away(tmp_path, wrong):
    path = tmp_path / "opening.toml"
    path.write_text(f'model = "opening"\n[membrane]\nmesh = "quick"\n{wrong}\n')
    with pytest.raises(ModelFileError) as refusal:
        read_model(path)
    parts = refusal.value.partial.parts()
    assert None not in (parts.mesh, parts.tool, parts.motion, parts.duration)


@pytest.mark.parametrize(
    ("old", "new", "there"),
    [
        ("length = 6.0\nwidth", "width", {"tool", "motion"}),
        ("height = 3.0", "height = -3.0", {"mesh", "motion"}),
        ("[1, 0, 0]", "[0, 0, 0]", {"mesh", "tool"}),
        ('clamp = ["bottom"]', 'clamp = ["botom"]', {"mesh", "tool", "motion"}),
        ('nodes = "top"', 'nodes = "tip"', {"mesh", "tool", "motion"}),
    ],
)
def test_what_is_wrong_is_left_out(tmp_path, old, new, there):
    assert TWICE_HELD.count(old) == 1
    (tmp_path / "free.toml").write_text(TWICE_HELD.replace(old, new))
    try:
        model = read_model(tmp_path / "free.toml")
        with pytest.raises(ModelFileError):
            model.build()
    except ModelFileError as problem:
        model = problem.partial
    parts = model.parts()
    made = {name for name in ("mesh", "tool", "motion") if getattr(parts, name) is not None}
    assert made == there
    if "botom" in new:  # the other set is held still
        assert parts.supported.tolist() == sorted(parts.mesh.node_set("top").tolist())


def test_a_file_without_a_model_has_no_parts(tmp_path):
    path = tmp_path / "x.toml"
    path.write_text('model = "closing"\n')
    with pytest.raises(ModelFileError) as refusal:
        read_model(path)
    assert refusal.value.partial is None

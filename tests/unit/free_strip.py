"""A blade that cuts a small strip through its quads, for the tests of what comes after a cut."""

from films import pieces
from shellcut import CohesiveLaw, Fracture, Mesh, ShellMaterial, Simulation, StraightMotion, Support
from shellcut.fracture.crack_path import CrackPath
from shellcut.fracture.cut_film import CutFilm
from shellcut.mesh.structured import rectangle
from shellcut.tool.shapes import straight_blade

NOTCH = 0.9


def slanted_strip(slope=0.15):
    """A strip whose inner rows of quads slant, so that a cut along y = 0 crosses them."""
    mesh = rectangle(6.0, 3.2, n_x=15, n_y=8)
    X = mesh.nodes.copy()
    X[:, 1] += slope * (X[:, 0] - 2.6) * (1.0 - (X[:, 1] / 1.6) ** 2)
    return Mesh.from_arrays(X, mesh.quads, node_sets=mesh.node_sets)


def cut_strip(*, material=None, mesh=None, notched=True, **options):
    """Return the strip with a notch through its quads and a blade before it."""
    options.setdefault("fracture", Fracture(path="free", check_every=5))
    options.setdefault("supports", [Support.clamped("bottom"), Support.clamped("top")])
    simulation = Simulation(
        mesh or slanted_strip(),
        material or ShellMaterial.homogeneous(),
        tool=straight_blade(half_thickness=0.1, length=6.0, height=2.0).translated((-0.1, 0, 0)),
        motion=StraightMotion((1, 0, 0), 2e4, ramp=5e-6),
        law=CohesiveLaw(strength=18.0, opening_a=0.05, opening_p=0.2, opening_u=0.3),
        **options,
    )
    if notched:
        simulation.notch((-1.0, 0.0, 0.0), (NOTCH, 0.0, 0.0))
    return simulation


def pieces_of(sim):
    """How many pieces the film has."""
    return pieces(sim.state.quads).max() + 1


def path_in(sim):
    """What finds the paths of cracks through the film of a simulation."""
    return CrackPath(CutFilm(sim.cracks.cuts.topology, sim.shell))


def notched_sheet(rise, material=None, **fracture):
    """A sheet of quads of 0.5 mm, 5 by 4 mm, with a notch of 2.2 mm above its middle line.

    rise : how far above, in quads; at 0 the notch lies along sides.
    """
    film, path = material or ShellMaterial.homogeneous(), Fracture(path="free", **fracture)
    mesh = rectangle(5.0, 4.0, size=0.5)
    sim = Simulation(mesh, film, law=CohesiveLaw(), fracture=path)
    rim, y = mesh.nodes[:, 0].min(), 0.5 * rise
    sim.notch((rim - 1.0, y, 0.0), (rim + 2.2, y, 0.0))
    return sim


def segment_ahead(sim):
    """The only tip of a simulation and the segment straight ahead of it."""
    (tip,) = sim.cracks.tips
    return tip, path_in(sim).segment_from(sim.state, tip, tip.heading)

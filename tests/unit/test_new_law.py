"""A law with history in a file of its own, tests/unit/damaging_film.py, and nothing else.

Forces, output, criterion, ledger, checkpoint and frames ask it; a reference and closed forms say
what must come out.
"""

import itertools
from contextlib import closing

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from damaging_film import Damaging
from gone_on import check_goes_on
from naive import cases
from naive import shell as naive
from notched_strip import cutting
from shellcut import Elastic, Layer, Mesh, Orthotropic, ShellMaterial, Simulation, Support, read
from shellcut.material import LAWS, Material, PointLaw, register
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.initial_state import initial_state
from shellcut.mitc4.shell import MITC4Shell
from shellcut.models import Case
from shellcut.recording.frame_capture import frame_of
from shellcut.results.vtkhdf import VtkHdfWriter
from shellcut.results.vtkhdf_reader import VtkHdfReader

TOY = Damaging()
FILM = ShellMaterial([Layer(TOY, 0.074)])
TURNED = Rotation.from_rotvec([1.1, -1.5, 1.3]).as_matrix()  # of cases.deform
# The same in all directions, by the law with axes: test_yielding_film.py has films of these two
# laws, too, whose kernels are compiled once for both files.
EVEN = Orthotropic(800.0, 800.0, 0.4, 800.0 / 2.8, 1e-9)
LAMINATE = ShellMaterial([Layer(EVEN, 0.05), Layer(TOY, 0.03)])
FILMS = {"film": FILM, "laminate": LAMINATE}


def damaged(psi, kappa):
    """Return kappa, damage and dissipated density of the toy law, from its formulae."""
    before = max(kappa, TOY.onset)
    kappa = max(before, np.sqrt(2 * psi / TOY.young))
    lost = 0.5 * TOY.young * TOY.largest * TOY.onset * (kappa - before)
    return kappa, TOY.largest * (1 - TOY.onset / kappa), lost


def green(X, T, x, t, z, xi, eta):
    """Green-Lagrange strain at a point as a tensor, its normal and volume; x, t may be complex."""
    value, *by = naive.shape(xi, eta)
    A, dT, T0 = [d @ X for d in by], [d @ T for d in by], value @ T
    a, dt = [d @ x for d in by], [d @ t for d in by]
    now, then = naive.tied_shear(x, t, xi, eta), naive.tied_shear(X, T, xi, eta)
    covariant = [A[0] + z * dT[0], A[1] + z * dT[1], T0]
    contra = np.linalg.inv(np.array(covariant).T)
    E = np.zeros((3, 3), np.result_type(x, t))
    for i, j in itertools.product(range(2), repeat=2):
        stretch = 0.5 * (a[i] @ a[j] - A[i] @ A[j])
        bend = a[i] @ dt[j] + a[j] @ dt[i] - A[i] @ dT[j] - A[j] @ dT[i]
        E += (stretch + 0.5 * z * bend) * np.outer(contra[i], contra[j])
    for i in range(2):
        half = 0.5 * (now[i] - then[i])
        E += half * (np.outer(contra[i], contra[2]) + np.outer(contra[2], contra[i]))
    volume = np.cross(covariant[0], covariant[1]) @ covariant[2]
    return E, T0 / np.linalg.norm(T0), volume


def naive_step(mesh, x, t, film, history):
    """Return dW/dx, dW/dt, stored and dissipated energy, and take the history on."""
    by = np.zeros((2, *x.shape))
    stored = dissipated = 0.0
    points = list(enumerate(naive.thickness_rule(film, film.integration_points)))
    factor = naive.shear_factor(film)
    for (e, q), (g, gauss), (j, (z, w, one)) in itertools.product(
        enumerate(mesh.quads), enumerate(naive.GAUSS), points
    ):
        X, T, now = mesh.nodes[q], mesh.directors[q], np.stack([x[q], t[q]])
        E, normal, volume = green(X, T, *now, z, *gauss)
        plane = np.eye(3) - np.outer(normal, normal)
        elastic = Elastic(800.0, 0.4, 1e-9) if one is EVEN else one
        whole = naive.stress_of(E, normal, elastic, factor)
        inside = plane @ whole @ plane
        psi = 0.5 * np.sum(inside * E)
        loss = lost = 0.0
        if one is TOY:
            history[e, g, j], loss, lost = damaged(psi, history.get((e, g, j), 0.0))
        stored += w * volume * (0.5 * np.sum(whole * E) - loss * psi)
        dissipated += w * volume * lost
        for which, a, c in itertools.product(range(2), range(4), range(3)):
            moved = now.astype(complex)
            moved[which, a, c] += 1e-30j
            dE = green(X, T, *moved, z, *gauss)[0].imag / 1e-30
            by[which, q[a], c] += w * volume * np.sum((whole - loss * inside) * dE)
    return by[0], by[1], stored, dissipated


@pytest.mark.parametrize(
    ("case", "film"), [*((case, "film") for case in cases.ALL), ("curved", "laminate")]
)
def test_forces_and_energies_are_those_of_the_reference_there_and_back(case, film):
    mesh = cases.ALL[case](2, 1)
    shell, state = cases.set_up(mesh, FILMS[film])
    n, history = mesh.n_node, {}
    far = cases.deform(initial_state(mesh), stretch=0.01, tilt=0.03).node
    for part in (1.0, 0.4):  # loads, then unloads
        x = (1 - part) * mesh.nodes @ TURNED.T + part * far.x[:n]
        state.node.x[:n], state.node.t[:n] = x, far.t[:n]
        wanted = naive_step(mesh, x, far.t[:n].copy(), FILMS[film], history)
        state.node.force_rows[:] = 0.0
        work = shell.add_forces(state)
        # Round-off of a metric of order one, in forces of E h.
        for got, force in zip((state.node.force, state.node.director_force), wanted, strict=False):
            np.testing.assert_allclose(-got[:n], force, rtol=0, atol=1e-11 * abs(force).max())
        assert work.strain_energy == pytest.approx(wanted[2], rel=1e-11)
        assert work.dissipated == pytest.approx(wanted[3], rel=1e-9, abs=1e-15)
        if part == 1.0:
            assert work.dissipated > 1e-3 * work.strain_energy
            assert shell.history_means(state)["damage [-]"].max() > 0.1


def pulled(strains, film=FILM):
    """One quad pulled along x to Green strains in turn with free sides: S_22 = 0."""
    mesh = Mesh.from_arrays([[0, 0], [2, 0], [2, 1], [0, 1]], [[0, 1, 2, 3]])
    shell, state = cases.set_up(mesh, film)
    dissipated = 0.0
    for e in strains:
        state.node.x[:4, 0] = mesh.nodes[:, 0] * np.sqrt(1 + 2 * e)
        state.node.x[:4, 1] = mesh.nodes[:, 1] * np.sqrt(1 - 2 * TOY.poisson * e)
        work = shell.add_forces(state)
        dissipated += work.dissipated
    return shell, state, work.strain_energy, dissipated


def test_stresses_energies_and_thickness_are_the_closed_form_of_the_law():
    peak, e, which = 0.01, 0.004, np.array([0])
    shell, state, stored, dissipated = pulled([0.5 * peak, peak, e])
    damage = TOY.largest * (1 - TOY.onset / peak)
    S = (1 - damage) * TOY.young * e
    longer, narrower = np.sqrt(1 + 2 * e), np.sqrt(1 - 2 * TOY.poisson * e)
    sigma = S * longer / narrower**2  # the thickness narrows as the width does
    for place, stress in (("mid", sigma), ("top", sigma), ("bottom", sigma), ("nominal", S)):
        tensor = shell.stress(state, which, place=place)[0]
        np.testing.assert_allclose(tensor, np.diag([stress, 0, 0]), atol=1e-12 * TOY.young)
    faces = shell.face_stresses(state)
    np.testing.assert_allclose(faces.stress[0, :, 0], sigma, rtol=1e-11)
    np.testing.assert_allclose(faces.principal[0, :, 0], sigma, rtol=1e-11)
    # E_33 = - nu/(1 - nu) (1 - nu) E_11
    assert faces.thickness[0] == pytest.approx(FILM.thickness * narrower, rel=1e-12)
    volume = 2.0 * FILM.thickness
    assert stored == pytest.approx(0.5 * S * e * volume, rel=1e-11)
    lost = 0.5 * TOY.young * TOY.largest * TOY.onset * (peak - TOY.onset)
    assert dissipated == pytest.approx(lost * volume, rel=1e-11)
    means = shell.history_means(state)
    assert means["largest strain [-]"][0] == pytest.approx(peak, rel=1e-11)
    assert means["damage [-]"][0] == pytest.approx(damage, rel=1e-11)
    with pytest.raises(ValueError, match="place must be one of"):
        shell.stress(state, which, place="side")


def test_output_and_trial_forces_leave_the_history_alone():
    shell, state, _, _ = pulled([0.006])
    before = state.history.copy()
    state.node.x[:4] *= 1.01
    force = sum(shell.corner_forces(state, np.zeros(1, int), np.array([a])) for a in (1, 2))
    shell.stress(state, np.array([0]))
    shell.face_stresses(state)
    shell.tangents(state, np.array([0]))
    np.testing.assert_array_equal(state.history, before)
    state.node.force_rows[:] = 0.0
    shell.add_forces(state)
    np.testing.assert_allclose(force[0], state.node.force[[1, 2]].sum(axis=0), rtol=1e-12)
    assert (state.history != before).any()


def test_bending_shows_at_the_outermost_points_and_only_they_are_damaged():
    mesh = Mesh.from_arrays([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1, 2, 3]])
    shell, state = cases.set_up(mesh, FILM)
    slope = 0.15
    lean = np.array([-1, 1, 1, -1]) * np.sin(slope)
    state.node.t[:4] = np.stack([lean, 0 * lean, np.sqrt(1 - lean**2)], axis=1)
    shell.add_forces(state)
    places, weights = np.polynomial.legendre.leggauss(5)
    strains = FILM.thickness * places * np.sin(slope)
    stiff = TOY.young / (1 - TOY.poisson**2)
    damage = [damaged(0.5 * stiff * e * e, 0.0)[1] for e in strains]
    assert damage[-1] > 0.3
    outermost = shell.face_stresses(state).stress[0, :, 0]
    # The dropped square of the height in the surface that carries the stress: (h curvature)².
    wanted = (1 - damage[-1]) * stiff * strains[-1]
    np.testing.assert_allclose(outermost[1:], [wanted, -wanted], rtol=0.05)
    assert abs(outermost[0]) < 0.02 * outermost[1]
    mean = shell.history_means(state)["damage [-]"][0]
    assert mean == pytest.approx(0.5 * weights @ damage, rel=0.05)


END = 8e-5


def pulled_strip(film=FILM, **options):
    """A strip pulled beyond the onset of damage and let go again."""
    mesh = rectangle(4.0, 2.0, n_x=10, n_y=5)
    there_and_back = {"x": lambda t: 1600.0 * np.sin(2 * np.pi * t / END)}
    supports = [Support.clamped("left"), Support("right", velocity=there_and_back)]
    return Simulation(mesh, film, supports=supports, **options)


def test_the_ledger_closes_with_what_the_law_has_dissipated():
    sim = pulled_strip(damping_beta=0.0)
    sim.run(END)
    ledger = sim.close_ledger()
    assert ledger.material_dissipated > 0.2 * ledger.support_work > 0.0
    # The step, measured 2e-4; without the new entry it would be what was dissipated.
    assert abs(ledger.imbalance) < 1e-3 * ledger.support_work
    # By increments, and by the state alone.
    rule = sim.shell.points.rule
    n_block, _, width = sim.state.history.shape
    kappa = sim.state.history.reshape(n_block, 4, rule.place.size, 2, width)[:, :, :, 0]
    lost = 0.5 * TOY.young * TOY.largest * TOY.onset * np.maximum(kappa - TOY.onset, 0.0)
    volume = sim.shell.points.flat_frame.reshape(n_block, 4, 4, width)[:, :, 3]
    total = np.einsum("j,bqjl,bql->", rule.weight, lost, volume)
    assert ledger.material_dissipated == pytest.approx(total, rel=1e-9 * 1e5 ** (width == 16))


def test_a_resumed_run_is_the_same_bit_for_bit(tmp_path):
    def flowing(sim):
        return sim.state.time > 0.4 * END and sim.ledger.material_dissipated > 0.0

    check_goes_on(pulled_strip, flowing, tmp_path / "c.h5", 150)


def test_a_cut_writes_dissipation_and_damage(tmp_path):
    weak = ShellMaterial([Layer(Damaging(onset=5e-4), 0.074)])
    case = Case("cut", cutting(material=weak), 2e-5)
    case.run(tmp_path, n_row=20, n_frame=4, n_snapshot=0, curves=False, progress=False)
    results, sim = read(tmp_path), case.simulation
    column = results.history["material_dissipated"]
    assert (np.diff(column) >= 0.0).all()
    assert sim.ledger.material_dissipated >= column[-1] > 0.0
    assert results.units["material_dissipated"] == "N*mm"
    assert results.summary["material_dissipated_Nmm"] == sim.ledger.material_dissipated
    first, last = results.frame(0).quad_history, results.frame(-1).quad_history
    assert set(first) == set(last) == {"largest strain [-]", "damage [-]"}
    assert last["damage [-]"].max() > 0.05
    frame = frame_of(sim, coordinate=0.0, coordinate_name="path", coordinate_unit="mm")
    with closing(VtkHdfWriter(tmp_path / "own.vtkhdf")) as writer:
        writer.append(frame)
    again = VtkHdfReader(tmp_path / "own.vtkhdf").frame(0)
    for name, wanted in sim.shell.history_means(sim.state).items():
        np.testing.assert_array_equal(frame.quad_history[name], wanted)
        np.testing.assert_allclose(again.quad_history[name], wanted, rtol=2.0**-12, atol=1e-30)


def test_a_law_with_history_is_never_run_as_linear():
    assert (FILM.points_per_layer, FILM.integration_points) == (None, 5)
    assert not FILM.is_linear
    shell = MITC4Shell(rectangle(1.0, 1.0, n_x=1, n_y=1), FILM, damping_beta=0.0)
    assert shell.points.rule.place.size == 5
    assert shell.has_points
    assert ShellMaterial([Layer(TOY, 0.074)], points_per_layer=1).integration_points == 1
    assert ShellMaterial.homogeneous().integration_points is None


def other(p, strain, history, dt):
    return strain, 0.0, 0.0, history


def test_laws_are_known_by_name():
    assert {"St.Venant-Kirchhoff", "damaging"} <= set(LAWS)
    assert register(TOY.law) is TOY.law is LAWS["damaging"]
    for function in (other, TOY.law.stress):  # the latter without its history
        with pytest.raises(ValueError, match="a law 'damaging' is already registered"):
            register(PointLaw("damaging", function, TOY.law.thickness_stretch))
    assert LAWS["damaging"] is TOY.law
    assert PointLaw("mine", other, other, tuple("abcd"), turning=(1,)).turning == (1,)
    elastic = PointLaw("mine", other, other, elastic=True)
    assert elastic.frozen is elastic
    with pytest.raises(ValueError, match="material must be a Material, got 3"):
        Layer(3, 0.1)


@pytest.mark.parametrize(
    ("history", "options", "said"),
    [
        ((), {"name": " "}, "a law needs a name"),
        (("damage [-]",), {"linear": True}, "a linear law has no history"),
        (("a", "a"), {}, "history names must differ"),
        (("N/mm",), {}, "without a slash"),
        *(
            (tuple("abcd"), {"turning": turning}, "turning must name where strains of three numb")
            for turning in ((2,), (-1,), (0, 1), ("a",))
        ),
        (("a",), {"first_leads": True}, "a history must have numbers for the first to lead"),
        (("a",), {"elastic": True}, "an elastic law has no history, 'mine' names"),
    ],
)
def test_a_law_that_cannot_be_is_refused_with_a_sentence(history, options, said):
    name = options.pop("name", "mine")
    with pytest.raises(ValueError, match=said):
        PointLaw(name, other, other, history, **options)


def test_what_else_asks_for_stiffness_gets_it_from_the_material():
    class Twofold(Damaging):
        def plane_stress(self):
            return np.array([[400.0, 0.0, 0.0], [0.0, 100.0, 0.0], [0.0, 0.0, 50.0]])

    two = Twofold(density=1e-9)
    assert isinstance(two, Material)
    assert two.stretching_modulus == pytest.approx(400.0)
    assert two.wave_speed == pytest.approx(np.sqrt(4e11))
    film = ShellMaterial([Layer(two, 0.02), Layer(Elastic(1000.0, 0.3, 1e-9), 0.01)])
    assert film.stretching_stiffness == pytest.approx(18.0)
    # One number says the ratio, but the shortened form of flat quads wants isotropy besides.
    assert ShellMaterial([Layer(two, 0.02)]).bending_ratio is None
    assert ShellMaterial([Layer(TOY, 0.02)]).bending_ratio == pytest.approx(0.02**2 / 12)

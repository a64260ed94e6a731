"""Linear answers of very thin films: through the strains, with figures, and at no greater cost."""

from contextlib import suppress

import numpy as np
import pytest

from dense_statics import dense
from page_tables import table
from patches import mapped_patch, pinched_hemisphere, sphere
from shellcut import ShellMaterial, Statics
from shellcut.mesh.structured import rectangle
from shellcut.statics.freedoms import Freedoms
from shellcut.statics.tangent_solver import NoConvergence, TangentSolver


def hemisphere(slenderness, n=16):
    """A pinched quarter of a hemisphere with a hole, its force in proportion to its bending."""
    force = (250.0 / slenderness) ** 3
    model, on_x, _ = pinched_hemisphere(mapped_patch(n, n, sphere), 10.0 / slenderness, force)
    return model, on_x


def test_very_thin_films_are_solved_through_their_strains():
    # Bending without stretching: displacements do not change with the thickness at this force, but
    # for the part of the membrane, some (h/R) of it. The assembled stiffness is off by 1e-3 at 1e6
    # and of no use at 1e8.
    found = []
    for slenderness in (1e5, 1e6, 1e8):
        model, on_x = hemisphere(slenderness)
        answer = model.linear()
        found.append(answer.displacement[on_x, 0])
        assert answer.error < 1e-4
        assert answer.condition > 1e10
    assert found[1] == pytest.approx(found[0], rel=1e-4)
    assert found[2] == pytest.approx(found[1], rel=1e-6)


def test_what_is_still_missing_is_solved_for_again():
    # Where factors are no guide GMRES takes for solved what is not: on 64 x 64 quads the first
    # answer of R/h = 1e7 misses too much to be let through, 1e-8 at an 1e18 of condition.
    (_, *slenderness), ((_, *deflections),) = table("docs/theory/statics.md", "$R/h$ | 1e4")
    assert "1e7" in slenderness
    for ratio, of_the_page in zip(map(float, slenderness), deflections, strict=True):
        model, on_x = hemisphere(ratio, n=64)
        answer = model.linear()
        assert answer.error < 1e-4
        assert answer.residual < 0.1 or ratio > 1e7
        assert answer.displacement[on_x, 0] / 0.093 == pytest.approx(float(of_the_page), abs=2e-6)


def test_so_are_their_frequencies_and_small_load_steps():
    thick, thin = (hemisphere(slenderness)[0].modes(3).frequency for slenderness in (1e5, 1e6))
    np.testing.assert_allclose(10.0 * thin, thick, rtol=1e-3)
    model, on_x = hemisphere(1e6)
    expected = 1e-4 * model.linear().displacement[on_x, 0]
    (rest,) = model.load_steps([1e-4])
    # The residual is one of last digits; the corrections say that the film is at rest.
    assert rest.residual > 1e-6
    assert rest.displacement[on_x, 0] == pytest.approx(expected, rel=1e-4)


def test_what_no_double_can_tell_is_refused_with_figures():
    model, _ = hemisphere(1e11)
    with pytest.raises(NoConvergence, match=r"off by .* %: the condition of the stiffness is \d"):
        model.linear()


def test_pivots_stay_on_the_diagonal():
    # Turns and displacements differ in their stiffness by h² over the size of a quad, squared:
    # unscaled, small diagonals were passed over and the factors of thin films filled up.
    thick, thin = (hemisphere(slenderness)[0] for slenderness in (250.0, 1e7))
    fill = [TangentSolver(m.state, Freedoms(m.state), m.shell)._factor.L.nnz for m in (thick, thin)]
    assert fill[0] == fill[1]


def test_pivots_count_negative_eigenvalues():
    model, _ = hemisphere(250.0, n=4)
    film = model.state, Freedoms(model.state), model.shell
    K, mass = dense(model)
    omega2 = np.linalg.eigvalsh(K / np.sqrt(np.outer(mass, mass)))
    for n in (0, 1, 2, 7, 30, mass.size - 1):
        below = 0.5 * (omega2[n - 1] + omega2[n]) if n else 0.0
        assert TangentSolver(*film, shift=-below * mass).n_negative == n
        # Pivots off the diagonal count nothing, nor do factors that say nothing of the stiffness.
        spread = TangentSolver(*film, shift=-below * mass)
        spread._factorise(1.0)
        assert spread.n_negative == n
    # No rigid motion is one, whatever its round-off, nor what round-off makes of a very thin film.
    free = Statics(rectangle(4.0, 3.0, n_x=5, n_y=4), ShellMaterial.homogeneous())
    with suppress(NoConvergence):  # right too, where a pivot has no round-off, as with SciPy 1.15
        assert TangentSolver(free.state, Freedoms(free.state), free.shell).n_negative == 0
    thin, _ = hemisphere(1e8)
    assert TangentSolver(thin.state, Freedoms(thin.state), thin.shell).n_negative == 0

"""The largest eigenvalue of a matrix, and singular values of matrices over frequency."""

from dataclasses import dataclass
from math import inf, pi, sqrt

import numpy as np
import pytest
from flint import acb, acb_mat, arb

from symflex.analysis.norms.axis import MatrixOnAxis, TaylorForm
from symflex.analysis.norms.largest import (
    NODES,
    _limit,
    _NormSearch,
    _on,
    eigenvalue_bound,
    eigenvalue_met,
    largest_gain,
    singular_bound,
    squared,
)
from symflex.balls import precision
from tests.unit.analysis.norms.test_axis import of_terms


def test_eigenvalues_lie_between_their_bounds():
    random = np.random.default_rng(3)
    for n in (1, 2, 5):
        root = random.normal(size=(n, n)) + 1j * random.normal(size=(n, n))
        matrix = root @ root.conj().T
        largest = np.linalg.eigvalsh(matrix)[-1]
        with precision(128):
            exact = acb_mat(n, n, [acb(complex(x)) for x in matrix.ravel()])
            least, most = float(eigenvalue_met(exact)), float(eigenvalue_bound(exact))
        assert least <= largest * (1 + 1e-12) and largest <= most * (1 + 1e-12), n
        assert most - least < 1e-3 * largest


def test_a_ball_of_matrices_is_bounded_as_a_whole():
    with precision(128):
        wide = acb_mat(2, 2, [acb(arb(3, 0.5)), acb(0), acb(0), acb(1)])
        assert 3.5 <= singular_bound(wide) <= 3.51


def test_the_smaller_square_of_a_matrix_is_taken():
    form = TaylorForm((acb_mat(1, 3, [1, 2, 2]),), arb(0))
    (square,) = squared(form)
    assert square.nrows() == 1 and float(square[0, 0].real) == pytest.approx(9)


def test_the_largest_eigenvalue_of_zero_is_zero():
    assert eigenvalue_bound(acb_mat(2, 2)) == 0


def test_of_a_ball_the_farthest_end_bounds_and_the_nearest_is_met():
    for n in (1, 2):
        ball = acb_mat(n, n, [acb(arb(3, 0.5)) if i == 0 else acb(0) for i in range(n * n)])
        assert 3.5 <= float(eigenvalue_bound(ball)) < 3.5001 and 2.4999 < float(eigenvalue_met(ball)) <= 2.5


def quadratic(*coefficients):
    return [acb_mat(1, 1, [acb(c)]) for c in coefficients]


def test_between_nodes_the_bound_is_attained_in_the_middle():
    # 1 - c (t - t_0)^2 has its 1 between two nodes; a chord misses it by c/4 of their distance^2.
    for half, c in ((1, 0.5), (2, 0.1)):
        middle = half / (2 * NODES)
        top = _on(quadratic(1 - c * middle**2, 2 * c * middle, -c), arb(half))
        assert 1 - 1e-12 < float(top) < 1 + 1e-6
    # 3 t_0^2 t - t^3 with t_0 = 11/12 has 2 t_0^3 there; |6 t| is 6 at most, a 12th more than at t_0.
    top = float(_on(quadratic(0, 3 * (11 / 12) ** 2, 0, -1), arb(1)))
    assert 2 * (11 / 12) ** 3 <= top < 2 * (11 / 12) ** 3 + 6 / 36 / 8 / 8


def test_at_a_node_the_bound_of_a_straight_line_is_attained():
    assert float(_on(quadratic(1, 2, 0), arb(3))) == pytest.approx(7, rel=1e-6)
    assert float(_on(quadratic(1, -2, 0), arb(3))) == pytest.approx(7, rel=1e-6)


@dataclass
class Form:
    """A matrix with the same form everywhere, that no ball bounds."""

    form: TaylorForm
    low: float = 0.0

    def value(self, s, *, is_wide):
        return acb_mat(1, 1, [acb("inf")])

    def in_disc(self, low, high, enough):
        return self.form

    beyond_disc = in_disc


def test_what_a_form_lacks_is_added_to_the_bound_and_taken_from_what_is_met():
    search = _NormSearch(Form(TaylorForm((acb_mat(2, 2, [2, 0, 0, 1]),), arb(0.5), arb(0.25))), 1e-3)
    piece = search.piece((1.0, 3.0), in_disc=True)
    assert 2.5 <= piece.top < 2.5001 and 1.7499 < search.best <= 1.75 and search.omega == 2
    # All of it below a level that was met: its size is bound enough, what it lacks counts.
    search.best = arb(4)
    wide = TaylorForm((acb_mat(1, 1, [1]), acb_mat(1, 1, [2])), arb(0.75), arb(0))
    search.matrix = Form(wide)
    assert 3.75 <= search.piece((1.0, 3.0), in_disc=True).top < 3.7501
    search.best = arb(3.7)
    assert 3.75 <= search.piece((1.0, 3.0), in_disc=True).top < 3.76


def test_the_largest_value_of_a_band_is_at_its_end_or_inside():
    # 1/(s + 1) falls, s/(s + 1) = 1 - 1/(s + 1) rises; 2/(s^2 + 0.2 s + 1) has 2/(0.2 sqrt(0.99)) inside.
    falling, rising = of_terms((-1, 1, 1)), of_terms((-1, 1, 1), constant=((arb(-1),),))
    for matrix, band, exact, omega in (
        (falling, (1.0, 2.0), 1 / sqrt(2), 1),
        (rising, (1.0, 2.0), 2 / sqrt(5), 2),
        (falling, None, 1, 0),
        (rising, None, 1, inf),
    ):
        found = largest_gain(matrix, band, 1e-2)
        assert float(found.least) <= exact * (1 + 1e-12) and exact <= float(found.most) * (1 + 1e-12)
        assert float(found.most) < exact * 1.02 and found.reasons == ()
        assert found.omega == (omega if omega == inf else pytest.approx(omega, abs=0.2))


def test_a_limit_turned_by_one_delay_is_searched_over_a_whole_period():
    # [1, -e^(-jx/T); 1, 1] has 2 at x = T pi, 3 T pi, ...; of these only 3 T pi is in a period from 4 T on.
    zero = of_terms().functions[0][0]
    constant = ((arb(-1), arb(1)), (arb(-1), arb(-1)))
    for delay in (1.0, -0.5):
        turned = MatrixOnAxis(((zero, zero),) * 2, (), constant, ((arb(0), arb(delay)), (arb(0), arb(0))))
        most, least, omega = _limit(_NormSearch(turned, 1e-2), 4.0 / abs(delay))
        assert float(least) <= 2 <= float(most) < 2.03
        assert omega == pytest.approx(3 * pi / abs(delay), rel=0.05)


def test_a_search_ends_where_enough_is_met():
    found = largest_gain(of_terms((-1, 1, 1)), enough=0.5)
    assert found.least > 0.5 and found.most >= 1

"""The largest eigenvalue of a matrix, and singular values of matrices over frequency."""

import numpy as np
import pytest
from flint import acb, acb_mat, arb

from symflex.analysis.norms.axis import TaylorForm
from symflex.analysis.norms.largest import eigenvalue_bound, eigenvalue_met, singular_bound, squared
from symflex.balls import precision


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

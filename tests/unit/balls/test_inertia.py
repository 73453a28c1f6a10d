"""Signs of pivots against eigenvalues in numpy, with and without constraints."""

from itertools import product

import numpy as np
import pytest
from flint import arb

from symflex.balls import UndecidedError
from symflex.balls.inertia import elimination_order, pivots


def sparse(matrix, number=arb):
    """Return a matrix as rows of what is not zero."""
    return [{j: number(x) for j, x in enumerate(row) if x} for row in matrix.tolist()]


def order(matrix):
    return elimination_order(
        len(matrix), [(i, j) for i, j in zip(*np.nonzero(matrix), strict=True) if i <= j]
    )


def random_matrix(seed, size=9, constraints=0):
    """Return a symmetric matrix whose last rows are constraints, zero on their diagonals."""
    rng = np.random.default_rng(seed)
    matrix = rng.integers(-5, 6, (size, size)).astype(float)
    matrix *= rng.random((size, size)) < 0.4
    matrix = matrix + matrix.T + np.diag(rng.integers(-9, 10, size))
    if constraints:
        matrix[-constraints:, -constraints:] = 0
    return matrix


def test_as_many_pivots_are_negative_as_eigenvalues():
    for constraints, seed in product([0, 2, 4], range(12)):
        matrix = random_matrix(seed, constraints=constraints)
        values = np.linalg.eigvalsh(matrix)
        if np.min(np.abs(values)) < 1e-9:
            continue
        found = pivots(sparse(matrix), order(matrix))
        assert found.negative == np.sum(values < 0), (constraints, seed)


def test_pairs_are_eliminated_where_nothing_stands_on_the_diagonal():
    for seed in range(24):
        matrix = random_matrix(seed, size=6)
        np.fill_diagonal(matrix, 0)
        values = np.linalg.eigvalsh(matrix)
        if np.min(np.abs(values)) > 1e-9:
            assert pivots(sparse(matrix), range(6)).negative == np.sum(values < 0), seed


def test_the_pivots_product_is_the_determinant():
    for seed in range(6):
        matrix = random_matrix(seed, constraints=3)
        determinant = np.linalg.det(matrix)
        if abs(determinant) < 1e-6:
            continue
        found = pivots(sparse(matrix), order(matrix))
        assert float(found.determinant) == pytest.approx(determinant, rel=1e-9), seed


def test_a_border_is_left_with_minus_the_receptance():
    # 1/k of one spring, k = 4, read and driven by a factor of 3.
    rows = [{0: arb(4), 1: arb(3)}, {0: arb(3)}]
    assert pivots(rows, (0,), [1]).borders == (arb(-9) / 4,)


def test_a_singular_matrix_is_not_decided():
    matrix = np.array([[1.0, -1.0], [-1.0, 1.0]])
    with pytest.raises(UndecidedError):
        pivots(sparse(matrix), (0, 1))


def test_ends_go_before_the_middle_and_a_constraint_waits_for_what_it_ties():
    pairs = [(i, i) for i in range(5)] + [(i, i + 1) for i in range(4)]
    assert elimination_order(5, pairs)[:2] in ((0, 1), (0, 4))
    pairs = [(0, 0), (1, 1), (0, 2), (1, 2)]
    assert elimination_order(3, pairs)[0] != 2

"""Determinants of polynomials against sympy's."""

from random import Random

import sympy
from flint import fmpz_poly

from symflex.algebra import Ring
from symflex.algebra.polynomial_determinant import determinant, in_one_variable


def test_determinants_are_those_of_sympy():
    random, s = Random(5), sympy.Symbol("s")
    for size in (0, 1, 2, 5):
        rows = [
            {j: [random.randint(-99, 99) for _ in range(3)] for j in range(size) if random.random() < 0.8}
            for _ in range(size)
        ]
        matrix = sympy.Matrix(
            size, size, lambda i, j, rows=rows: sum(c * s**k for k, c in enumerate(rows[i].get(j, [])))
        )
        expected = sympy.Poly(matrix.det(), s).all_coeffs()[::-1]
        found = determinant([{j: fmpz_poly(c) for j, c in row.items()} for row in rows], range(size))
        assert [int(c) for c in found.coeffs()] == ([] if expected == [0] else expected), size


def test_columns_are_taken_in_their_order():
    one, x = fmpz_poly([1]), fmpz_poly([0, 1])
    assert determinant([{3: one}, {1: x}], [1, 3]) == -x
    assert determinant([{3: one}, {1: x}], [3, 1]) == x


def test_what_has_other_names_is_no_polynomial_in_s():
    ring = Ring(("s", "pi"))
    s, pi = ring.context.gens()
    assert in_one_variable(2 * s**3 - 1, ring) == fmpz_poly([-1, 0, 0, 2])
    assert in_one_variable(s + pi, ring) is None
    assert in_one_variable(s * 0, ring) == 0

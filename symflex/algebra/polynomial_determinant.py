"""Determinants of matrices of polynomials in one variable with integers.

Input: sparse rows of polynomials. Output: the determinant, from its value at one power of 2, in whose digits
its coefficients are (Kronecker 1882).

Example: of ``[s, s - 3; s + 2, s]`` the coefficients are below 32, so that the value at 64 says all. It is
64*64 - 61*66 = 70 = 1*64 + 6: the determinant is s + 6.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import prod

from flint import fmpz_mat, fmpz_mpoly, fmpz_poly

from symflex.algebra.ring import LAPLACE, Ring
from symflex.budget import spend


def determinant(rows: Sequence[Mapping[int, fmpz_poly]], columns: Sequence[int]) -> fmpz_poly:
    """Return the determinant over some columns, as many as there are rows, in their order.

    No coefficient of it is larger than the product, over the rows, of the sums of all their coefficients.

    >>> s = fmpz_poly([0, 1])
    >>> determinant([{0: s, 1: s - 3}, {0: s + 2, 1: s}], [0, 1])
    x + 6
    """
    spend()
    kept = [[row.get(j, fmpz_poly()) for j in columns] for row in rows]
    largest = prod(max(sum(abs(int(c)) for x in row for c in x.coeffs()), 1) for row in kept)
    bits = largest.bit_length() + 2
    value = int(fmpz_mat([[x(1 << bits) for x in row] for row in kept]).det()) if kept else 1
    spend()
    digits, half, whole = list[int](), 1 << (bits - 1), 1 << bits
    while value:
        digit = (value + half) % whole - half
        digits.append(digit)
        value = (value - digit) >> bits
    return fmpz_poly(digits)


def in_one_variable(polynomial: fmpz_mpoly, ring: Ring) -> fmpz_poly | None:
    """Return a polynomial in s alone as one in one variable; None where it has others.

    >>> ring = Ring(("s", "k"))
    >>> s, k = ring.context.gens()
    >>> in_one_variable(s**2 + 3, ring), in_one_variable(k * s, ring)
    (x^2 + 3, None)
    """
    s, coefficients = ring.index[LAPLACE], dict[int, int]()
    for powers, coefficient in polynomial.terms():
        if sum(powers) != powers[s]:
            return None
        coefficients[int(powers[s])] = int(coefficient)
    return fmpz_poly([coefficients.get(i, 0) for i in range(max(coefficients, default=-1) + 1)])

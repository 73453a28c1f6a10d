"""The differential equation a polynomial in kernels solves in a base length: its solutions near zero.

A sum of exponentials ``exp(Lambda x)`` solves the equation whose characteristic roots are all the Lambda.
Completed by their images under the symmetries of the wavenumbers, its coefficients are polynomials in those
of the dispersion relation; a combination of its solutions with the exact derivatives at x = 0 holds no terms
that cancel for small x.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import factorial, inf, lgamma, log
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

SERIES_ERROR = log(1e-19)
"""Logarithm of the first term left out, over the largest."""

Polynomial = tuple[int, ...]
"""Ascending integer coefficients."""

Symmetric = dict[tuple[int, int], int]
"""A polynomial in ``e = lambda_1^2 + lambda_2^2`` and ``f = lambda_1^2 lambda_2^2``."""


@dataclass(frozen=True, slots=True)
class LocalBasis:
    """Solutions of the equation with characteristic polynomial ``x^n + c_(n-1) x^(n-1) + ... + c_0``."""

    # 2 for waves, 4 for bending: every solution is ``x^k`` times a series in ``(w x)^step``, w the
    # wavenumber. 1 for a pair of wavenumbers.
    step: int
    order: int  # number of solutions; solution k has derivative k at zero equal to 1, the others below n zero
    # ``c_0, ..., c_(n-1)`` as polynomials in e and f, over powers of the wavenumber for a step of 2 or 4.
    coefficients: tuple[Mapping[tuple[int, int], int], ...]

    def series(self, solution: int, size: float) -> tuple[Fraction, ...]:
        """Return the coefficients of powers of ``(w x)^step`` in a solution over ``x^solution``.

        It is used up to an exponent of some size.
        """
        whole = [c.get((0, 0), 0) for c in self.coefficients]
        derivatives = [int(i == solution) for i in range(self.order)]
        found: list[Fraction] = []
        m = 0
        while m <= solution + self.step or taylor_term(size, m) > SERIES_ERROR:
            if m >= self.order:
                derivatives.append(-sum(c * derivatives[m - self.order + i] for i, c in enumerate(whole)))
            if m >= solution and (m - solution) % self.step == 0:
                found.append(Fraction(derivatives[m], factorial(m)))
            m += 1
        while len(found) > 1 and not found[-1]:
            found.pop()
        return tuple(found)


def taylor_term(size: float, order: int) -> float:
    """Return the logarithm of ``size^order/order!``, whose parts may each exceed a double."""
    return order * (log(size) if size else -inf) - lgamma(order + 1) if order else 0.0


def series_length(size: float) -> int:
    """Return how many derivatives a Taylor series needs up to an exponent of the given size."""
    m = 1
    while taylor_term(size, m) > SERIES_ERROR:
        m += 1
    return m + 1


def wave_basis(exponents: Iterable[Sequence[tuple[int, int]]]) -> LocalBasis:
    """Return the basis for exponents ``a*gamma``."""
    roots = sorted({sign * a for ((a, _),) in exponents for sign in (1, -1)})
    return _basis(2, [(r, 0) for r in roots])


def bending_basis(exponents: Iterable[Sequence[tuple[int, int]]]) -> LocalBasis:
    """Return the basis for exponents ``(a + j b)*mu``."""
    roots: set[tuple[int, int]] = set()
    for ((a, b),) in exponents:
        for x, y in ((a, b), (-b, a)):
            roots |= {(x, y), (-x, -y), (x, -y), (-x, y)}
    return _basis(4, sorted(roots))


def _basis(step: int, roots: Sequence[tuple[int, int]]) -> LocalBasis:
    polynomial: list[tuple[int, int]] = [(1, 0)]
    for real, imaginary in roots:
        longer = [(0, 0), *polynomial]
        for i, (x, y) in enumerate(polynomial):
            below = longer[i]
            longer[i] = (below[0] - (x * real - y * imaginary), below[1] - (x * imaginary + y * real))
        polynomial = longer
    return LocalBasis(step, len(roots), tuple({(0, 0): x} for x, _ in polynomial[:-1]))


def pair_basis(exponents: Iterable[Sequence[tuple[int, int]]]) -> LocalBasis:
    """Return the basis for exponents ``a*lambda_1 + b*lambda_2``."""
    orbits = sorted({tuple(sorted((abs(a), abs(b)), reverse=True)) for (a, _), (b, _) in exponents})
    total: list[Symmetric] = [{(0, 0): 1}]
    for a, b in orbits:
        total = _times(total, _orbit(a, b))
    return LocalBasis(1, len(total) - 1, tuple(total[:-1]))


def _orbit(a: int, b: int) -> list[Symmetric]:
    """Return the polynomial in x whose roots are all images of ``a*lambda_1 + b*lambda_2``."""
    if a == 0:
        return [{}, {(0, 0): 1}]
    if b == 0:
        # (x^2 - a^2 lambda_1^2)(x^2 - a^2 lambda_2^2)
        return [{(0, 1): a**4}, {}, {(1, 0): -(a**2)}, {}, {(0, 0): 1}]
    if a == b:
        # (x^2 - a^2 e)^2 - 4 a^4 f
        return [{(2, 0): a**4, (0, 1): -4 * a**4}, {}, {(1, 0): -2 * a**2}, {}, {(0, 0): 1}]
    q: list[Symmetric] = [
        {(2, 0): a**2 * b**2, (0, 1): a**4 + b**4 - 2 * a**2 * b**2},
        {},
        {(1, 0): -(a**2 + b**2)},
        {},
        {(0, 0): 1},
    ]
    linear: list[Symmetric] = [{(1, 0): -(a**2 + b**2)}, {}, {(0, 0): 2}]
    squares = _plus(_times(linear, linear), q, -2)
    product = _plus(_times(q, q), [_scaled(c, (0, 1), 1) for c in squares], -4 * a**2 * b**2)
    return _plus(product, [{(0, 2): 1}], 16 * a**4 * b**4)


def _scaled(value: Symmetric, by: tuple[int, int], number: int) -> Symmetric:
    return {(i + by[0], j + by[1]): x * number for (i, j), x in value.items()}


def _plus(left: Sequence[Symmetric], right: Sequence[Symmetric], number: int) -> list[Symmetric]:
    found = [dict(c) for c in left] + [{} for _ in range(len(right) - len(left))]
    for i, c in enumerate(right):
        for key, x in c.items():
            found[i][key] = found[i].get(key, 0) + number * x
    return [{k: x for k, x in c.items() if x} for c in found]


def _times(left: Sequence[Symmetric], right: Sequence[Symmetric]) -> list[Symmetric]:
    found: list[Symmetric] = [{} for _ in range(len(left) + len(right) - 1)]
    for i, a in enumerate(left):
        for j, b in enumerate(right):
            for (p, q), x in a.items():
                for (r, t), y in b.items():
                    key = (p + r, q + t)
                    found[i + j][key] = found[i + j].get(key, 0) + x * y
    return [{k: x for k, x in c.items() if x} for c in found]

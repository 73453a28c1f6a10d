"""What is expanded for small lengths: solutions of equations in one length.

A sum of exponentials ``exp(Lambda x)`` solves the equation whose characteristic roots are all the Lambda.
Completed by their images under the symmetries of the wavenumbers, its coefficients are polynomials in those
of the dispersion relation; a combination of its solutions with the exact derivatives at x = 0 has no terms
that cancel for small x.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import factorial, inf, lgamma, log, prod

from flint import fmpz_mpoly

from symflex.algebra.ring import Ring, by_powers

SERIES_ERROR = log(1e-19)  # logarithm of the first term left out, over the largest


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
        """Return the coefficients of powers of ``(w x)^step`` in a solution, for exponents up to a size."""
        constants = [c.get((0, 0), 0) for c in self.coefficients]
        derivatives = [int(i == solution) for i in range(self.order)]
        coefficients: list[Fraction] = []
        m = 0
        while m <= solution + self.step or taylor_term(size, m) > SERIES_ERROR:
            if m >= self.order:
                derivatives.append(-sum(c * derivatives[m - self.order + i] for i, c in enumerate(constants)))
            if m >= solution and (m - solution) % self.step == 0:
                coefficients.append(Fraction(derivatives[m], factorial(m)))
            m += 1
        while len(coefficients) > 1 and not coefficients[-1]:
            coefficients.pop()
        return tuple(coefficients)


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
    powers = by_powers(SYMMETRIC, prod((_orbit(a, b) for a, b in orbits), start=SYMMETRIC.constant(1)))
    order = max(powers)
    terms = ((powers[n].terms() if n in powers else ()) for n in range(order))
    exact = tuple({(int(p), int(q)): int(c) for (_, p, q), c in each} for each in terms)
    return LocalBasis(1, order, exact)


SYMMETRIC = Ring(("x", "e", "f"))  # x, ``e = lambda_1^2 + lambda_2^2``, ``f = lambda_1^2 lambda_2^2``


def _orbit(a: int, b: int) -> fmpz_mpoly:
    """Return the polynomial in x whose roots are all images of ``a*lambda_1 + b*lambda_2``."""
    x, e, f = SYMMETRIC.context.gens()
    if a == 0:
        return x
    if b == 0:
        # (x^2 - a^2 lambda_1^2)(x^2 - a^2 lambda_2^2)
        return x**4 - a**2 * e * x**2 + a**4 * f
    if a == b:
        return (x**2 - a**2 * e) ** 2 - 4 * a**4 * f
    squares = a**2 + b**2
    q = x**4 - squares * e * x**2 + a**2 * b**2 * e**2 + (a**2 - b**2) ** 2 * f
    return q**2 - 4 * a**2 * b**2 * f * ((2 * x**2 - squares * e) ** 2 - 2 * q) + 16 * a**4 * b**4 * f**2

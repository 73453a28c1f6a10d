"""What is expanded for small lengths: solutions of equations in one length, and power series in all of them.

A sum of exponentials ``exp(Lambda x)`` solves the equation whose characteristic roots are all the Lambda.
Completed by their images under the symmetries of the wavenumbers, its coefficients are polynomials in those
of the dispersion relation; a combination of its solutions with the exact derivatives at x = 0 holds no terms
that cancel for small x.

Polynomials in fundamental functions and exponentials are power series in the size of all lengths together;
their Taylor coefficients are exact polynomials in s and the parameters. What cancels for small lengths, or
divides by a power of s, does so here and not in rounded numbers.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import comb, factorial, inf, lgamma, log, prod
from typing import TYPE_CHECKING

from flint import Ordering, fmpz_mpoly_ctx

from symflex.algebra import Factored, common_denominator
from symflex.algebra.ring import Ring, by_powers
from symflex.budget import spend
from symflex.errors import BudgetError, Diagnostic

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from flint import fmpz_mpoly

    from symflex.algebra import Dispersion, Kernel, KernelTable


SERIES_ERROR = log(1e-19)
"""Logarithm of the first term left out, over the largest."""

Polynomial = tuple[int, ...]
"""Ascending integer coefficients."""


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
    whole = prod((_orbit(a, b) for a, b in orbits), start=SYMMETRIC.constant(1))
    powers = by_powers(SYMMETRIC, whole)
    order = max(powers)
    return LocalBasis(
        1,
        order,
        tuple(
            {(int(p), int(q)): int(c) for (_, p, q), c in powers[n].terms()} if n in powers else {}
            for n in range(order)
        ),
    )


SYMMETRIC = Ring(("x", "e", "f"))
"""Of polynomials in x, ``e = lambda_1^2 + lambda_2^2`` and ``f = lambda_1^2 lambda_2^2``."""


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


WORK_LIMIT = 60_000
"""Terms that one step may hold before such a series is given up."""

LEADING = 16
"""Taylor coefficients looked at, at least; where the first ones vanish, some more."""

FURTHER = 8
"""How many more at a time."""


@dataclass(frozen=True, eq=False)
class GeneralSeries:
    """Taylor series of polynomials in the kernels of a table."""

    ring: Ring  # of the polynomials
    table: KernelTable  # its kernels are fundamental functions and exponentials only

    def coefficients(self, polynomial: fmpz_mpoly, size: float) -> tuple[Factored, ...]:
        """Return the terms of the series, without leading zeros, as far as an exponent of a size needs.

        Raises BudgetError: SF503 when it has too many terms.
        """
        count = LEADING
        while taylor_term(size, count) > SERIES_ERROR:
            count += 1
        while True:
            # Only over the common denominator is it seen which ones vanish.
            total = [self._factored(c, m) for m, c in enumerate(self._total(polynomial, count))]
            first = next((m for m, c in enumerate(total) if not c.is_zero), None)
            if first is None:
                return ()
            largest = max(taylor_term(size, m) for m in range(first, count))
            if count > size and taylor_term(size, count) < SERIES_ERROR + largest:
                break
            count += FURTHER
        far = (m for m in range(first + 1, count) if m > size)
        last = next((m for m in far if taylor_term(size, m) < SERIES_ERROR + largest), count)
        return tuple(c for c in total[first:last] if not c.is_zero)

    def _total(self, polynomial: fmpz_mpoly, count: int) -> list[fmpz_mpoly]:
        positions = [self.ring.index[k.generator] for k in self.table.kernels]
        grouped: dict[tuple[int, ...], dict[tuple[int, ...], int]] = {}
        for monomial, coefficient in polynomial.terms():
            exponents = [int(e) for e in monomial]
            powers = tuple(exponents[i] for i in positions)
            for i in positions:
                exponents[i] = 0
            grouped.setdefault(powers, {})[(*exponents, 0)] = int(coefficient)
        return self._nested([(k, self._context.from_dict(v)) for k, v in grouped.items()], 0, count)

    def _nested(
        self, terms: Sequence[tuple[tuple[int, ...], fmpz_mpoly]], at: int, count: int
    ) -> list[fmpz_mpoly]:
        """Return the series of a polynomial in the kernels from a position on, by powers of the first."""
        zero = self._context.constant(0)
        if at == len(self.table.kernels):
            return [sum((c for _, c in terms), zero), *[zero] * (count - 1)]
        by_power: dict[int, list[tuple[tuple[int, ...], fmpz_mpoly]]] = {}
        for powers, c in terms:
            by_power.setdefault(powers[at], []).append((powers, c))
        if set(by_power) == {0}:
            return self._nested(terms, at + 1, count)
        kernel = self._kernel_series(self.table.kernels[at], count)
        total = [zero] * count
        for power in range(max(by_power), -1, -1):
            if any(len(c) for c in total):
                total = _product(total, kernel, zero)
                if sum(map(len, total)) > WORK_LIMIT:
                    message, hint = "the power series has too many terms", "give more parameters numbers"
                    raise BudgetError(Diagnostic("SF503", message, None, hint))
            if power in by_power:
                inner = self._nested(by_power[power], at + 1, count)
                total = [a + b for a, b in zip(total, inner, strict=True)]
        return total

    def _kernel_series(self, kernel: Kernel, count: int) -> list[fmpz_mpoly]:
        """Return the derivatives at zero of a kernel with respect to the scale of its length."""
        step = self._over(kernel.length * self._length_below)
        powers = [self._context.constant(1)]
        for _ in range(count - 1):
            powers.append(powers[-1] * step)
        if kernel.function == "exp":
            shift = -self._over(kernel.dispersion.shift)
            values = [self._context.constant(1)]
            for _ in range(count - 1):
                values.append(values[-1] * shift)
        else:
            values = self._derivatives(kernel.dispersion, count + kernel.order)[kernel.order :]
        return [a * b for a, b in zip(values, powers, strict=True)]

    def _derivatives(self, law: Dispersion, count: int) -> list[fmpz_mpoly]:
        """Return the derivatives of a fundamental function at zero."""
        n, whole = law.order, [self._over(c) for c in law.characteristic]
        found = [self._context.constant(int(i == n - 1)) for i in range(n)]
        while len(found) < count:
            spend()
            last = len(found) - n
            found.append(-sum((c * found[last + i] for i, c in enumerate(whole)), self._context.constant(0)))
        return found[:count]

    # ------------------------------------------------------------------------------------- denominators

    @cached_property
    def _context(self) -> fmpz_mpoly_ctx:
        """The ring with one more generator, the inverse of the common denominator."""
        return fmpz_mpoly_ctx.get((*self.ring.names, "over"), Ordering.lex)

    @cached_property
    def _below(self) -> Factored:
        """A common denominator of all coefficients of dispersion relations, and shifts."""
        return common_denominator(self.ring, self.table.coefficients)

    @cached_property
    def _length_below(self) -> Factored:
        """A common denominator of all lengths."""
        return common_denominator(self.ring, [k.length for k in self.table.kernels])

    def _over(self, value: Factored) -> fmpz_mpoly:
        """Return a value as a polynomial in the generators and the inverse of the common denominator."""
        if value.is_zero:
            return self._context.constant(0)
        power, whole = 0, value
        if any(e < 0 for _, e in value.factors) or value.unit.denominator != 1:
            power, whole = 1, value * self._below
        terms: Mapping[tuple[int, ...], int] = {
            (*(int(e) for e in m), power): int(c) for m, c in whole.expand().terms()
        }
        return self._context.from_dict(dict(terms))

    def _factored(self, derivative: fmpz_mpoly, order: int) -> Factored:
        """Return a derivative over the factorial of its order, over the ring."""
        if not len(derivative):
            return Factored.number(self.ring, 0)
        by_power: dict[int, dict[tuple[int, ...], int]] = {}
        for monomial, c in derivative.terms():
            *own, power = (int(e) for e in monomial)
            by_power.setdefault(power, {})[tuple(own)] = int(c)
        most = max(by_power)
        below = self._below.expand()
        whole = self.ring.constant(0)
        for power, terms in by_power.items():
            whole = whole + self.ring.context.from_dict(terms) * below ** (most - power)
        if not len(whole):
            return Factored.number(self.ring, 0)
        value = Factored.polynomial(self.ring, whole) * Fraction(1, factorial(order))
        return value / self._below**most / self._length_below**order


def _product(left: Sequence[fmpz_mpoly], right: Sequence[fmpz_mpoly], zero: fmpz_mpoly) -> list[fmpz_mpoly]:
    """Return the derivatives of a product."""
    found = []
    for m in range(len(left)):
        total = zero
        for k in range(m + 1):
            if len(left[k]) and len(right[m - k]):
                total = total + left[k] * right[m - k] * comb(m, k)
        found.append(total)
    return found

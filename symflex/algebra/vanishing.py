"""To what order polynomials in kernels vanish: where wavenumbers do, where two of them meet, and at s = 0.

Numerators and denominators of transfer functions are entire in s, but as polynomials in kernels they bear
powers of wavenumbers whose zeros kernels cancel: ``sinh(gamma l)/gamma``. The order is read off Taylor series
over a prime field at random values of everything else: only what is zero vanishes there, almost surely.

Wavenumbers are square and fourth roots of quantities of either sign, which exist in some fields and not in
others: the primes are one more than a multiple of eight, and there are several of them. With ``s = e^4``
every wavenumber is a power series in e.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from random import Random

from flint import fmpz, fmpz_mpoly, nmod_poly
from flint.utils.flint_exceptions import DomainError

from symflex.algebra.dispersion import Dispersion, KernelTable
from symflex.algebra.factored import PRIME, Factored
from symflex.algebra.ring import Ring, by_powers, degree_in, terms_of

TERMS = (8, 16, 32)  # lengths of Taylor series that are tried


@dataclass(frozen=True, eq=False)
class Vanishing:
    """Orders of zeros of polynomials over one ring."""

    ring: Ring  # with the table's generators
    table: KernelTable  # wavenumbers and kernels
    solutions: Sequence[Sequence[tuple[str, Factored]]]  # parameters by wavenumbers and others, in order

    def at_zero(self, polynomial: fmpz_mpoly, wavenumber: str) -> int | None:
        """Return the order in a wavenumber at zero, s and the parameters being independent of it."""
        return self._order(polynomial, wavenumber, None)

    def at_confluence(self, polynomial: fmpz_mpoly, dispersion: Dispersion) -> int | None:
        """Return the order in ``lambda_1^2 - lambda_2^2`` where the two wavenumbers meet."""
        first, second = dispersion.wavenumbers
        return self._order(polynomial, second, first)

    def at_zero_of_pair(self, polynomial: fmpz_mpoly, dispersion: Dispersion) -> int | None:
        """Return the order in ``lambda_1`` at zero, the parameters following the dispersion relation."""
        return self._order(polynomial, dispersion.wavenumbers[0], "")

    def _order(self, polynomial: fmpz_mpoly, moving: str, meeting: str | None) -> int | None:
        for solved in self.solutions:
            for terms in TERMS:
                field = TaylorField(terms)
                values = self._values(field, moving, meeting, solved)
                if values is None:
                    break
                order = field.order(field.polynomial(polynomial, self.ring.names, values))
                if order is not None:
                    return order
        return None

    def _values(
        self, field: TaylorField, moving: str, meeting: str | None, solved: Sequence[tuple[str, Factored]]
    ) -> dict[str, nmod_poly] | None:
        names = self.ring.names
        values = random_values(names, Random(20), field)
        values[moving] = field.power(1, int(values[meeting][0]) if meeting else 0)
        if meeting is not None:
            for name, formula in solved:
                residue = field.rational(formula, names, values)
                if residue is None:
                    return None
                values[name] = residue
        lengths: dict[Factored, int] = {}
        for kernel in self.table.kernels:
            if not kernel.wavenumber or kernel.wavenumber not in (moving, meeting):
                continue
            length = field.rational(kernel.length, names, values)
            if length is None:
                return None
            # Where two wavenumbers meet, both start from one exponential per length.
            start = lengths.setdefault(kernel.length, pow(BASE, 1001 + 2 * len(lengths), field.prime))
            argument = field.times(values[kernel.wavenumber], length)
            circular = kernel.function in ("cos", "sin")
            even, odd = field.even_odd(argument, start, circular=circular)
            values[kernel.generator] = even if kernel.function in ("cosh", "cos") else odd
        return values


def primes() -> Iterator[int]:
    """Yield the sizes of fields that are tried, the same ones every time."""
    prime = PRIME + 2 - STEP
    for _ in range(FIELDS):
        prime = _next_prime(prime)
        yield prime


@cache
def _next_prime(prime: int) -> int:
    candidate = prime + STEP
    while not fmpz(candidate).is_prime():
        candidate += STEP
    return candidate


FIELDS = 400
STEP = 8
FIRST_PRIME = next(primes())
BASE = 3  # powers of it stand for exponentials


@dataclass(frozen=True, slots=True)
class TaylorField:
    """Series to a fixed number of terms."""

    terms: int  # number of coefficients kept
    prime: int = FIRST_PRIME  # the field's size

    def constant(self, value: int) -> nmod_poly:
        """Return a number as a series."""
        return nmod_poly([value % self.prime], self.prime)

    def power(self, exponent: int, start: int = 0) -> nmod_poly:
        """Return ``start + x^exponent``."""
        return nmod_poly([start, *[0] * (exponent - 1), 1] if exponent else [start + 1], self.prime)

    def order(self, series: nmod_poly) -> int | None:
        """Return the order of the first term, ``None`` when there is none."""
        return next((i for i, c in enumerate(series.coeffs()) if int(c)), None)

    def times(self, left: nmod_poly, right: nmod_poly) -> nmod_poly:
        """Return a product."""
        return left.mul_low(right, self.terms)

    def inverse(self, series: nmod_poly) -> nmod_poly | None:
        """Return the reciprocal, ``None`` when the series starts with zero."""
        return series.inverse_series_trunc(self.terms) if int(series[0]) else None

    def root(self, series: nmod_poly) -> nmod_poly | None:
        """Return a square root, ``None`` when the valuation is odd or the leading coefficient no square."""
        first = self.order(series)
        if first is None or first % 2:
            return None
        lead = square_root(int(series[first]), self.prime)
        if lead is None:
            return None
        square, root = series.right_shift(first), self.constant(lead)
        half, terms = pow(2, -1, self.prime), 1
        while terms < self.terms - first:
            terms = min(2 * terms, self.terms - first)
            # Newton's iteration doubles the number of terms.
            root = (root + square.mul_low(root.inverse_series_trunc(terms), terms)) * half
        return root.left_shift(first // 2).truncate(self.terms)

    def even_odd(self, argument: nmod_poly, start: int, *, circular: bool) -> tuple[nmod_poly, nmod_poly]:
        """Return cosh and sinh, or cos and sin, given ``start`` for a constant angle."""
        constant = int(argument[0])
        moving = argument - self.constant(constant)
        sign = self.prime - 1 if circular else 1
        square = self.times(moving, moving) * sign
        even, odd = self.constant(1), moving
        term_even, term_odd = self.constant(1), moving
        below = _reciprocals(self.terms + 2, self.prime)
        for n in range(1, self.terms // 2 + 1):
            term_even = self.times(term_even, square) * (below[2 * n] * below[2 * n - 1] % self.prime)
            term_odd = self.times(term_odd, square) * (below[2 * n] * below[2 * n + 1] % self.prime)
            if term_even.is_zero() and term_odd.is_zero():
                break
            even, odd = even + term_even, odd + term_odd
        if not constant:
            return even, odd
        if circular:
            share = pow(1 + start * start, -1, self.prime)
            c, s = (1 - start * start) * share % self.prime, 2 * start * share % self.prime
        else:
            half, back = pow(2, -1, self.prime), pow(start, -1, self.prime)
            c, s = (start + back) * half % self.prime, (start - back) * half % self.prime
        return even * c + odd * (s * sign % self.prime), even * s + odd * c

    def polynomial(
        self, polynomial: fmpz_mpoly, names: Sequence[str], values: Mapping[str, nmod_poly]
    ) -> nmod_poly:
        """Return a polynomial with series in place of its generators."""
        total = self.constant(0)
        powers: dict[tuple[int, int], nmod_poly] = {}
        for monomial, coefficient in terms_of(polynomial):
            product = self.constant(coefficient)
            for key in monomial:
                if key not in powers:
                    powers[key] = values[names[key[0]]].pow_trunc(key[1], self.terms)
                product = self.times(product, powers[key])
            total = total + product
        return total

    def rational(
        self, value: Factored, names: Sequence[str], values: Mapping[str, nmod_poly]
    ) -> nmod_poly | None:
        """Return a rational function, ``None`` when a denominator starts with zero."""
        unit = value.unit.numerator * pow(value.unit.denominator, -1, self.prime)
        total = self.constant(unit)
        for factor, exponent in value.factors:
            series: nmod_poly | None = self.polynomial(factor, names, values)
            if exponent < 0 and series is not None:
                series = self.inverse(series)
            if series is None:
                return None
            total = self.times(total, series.pow_trunc(abs(exponent), self.terms))
        return total


@cache
def _reciprocals(count: int, prime: int) -> tuple[int, ...]:
    """Return 0 and the reciprocals of the numbers below ``count`` modulo a larger prime."""
    reciprocals = [0, 1]
    for n in range(2, count):
        reciprocals.append(-(prime // n) * reciprocals[prime % n] % prime)
    return tuple(reciprocals)


def square_root(value: int, prime: int) -> int | None:
    """Return a square root modulo a prime, ``None`` when there is none.

    >>> square_root(2, 17), square_root(3, 17)
    (6, None)
    """
    try:
        return int(fmpz(value).sqrtmod(prime))
    except DomainError:
        return None


def random_values(names: Sequence[str], random: Random, field: TaylorField) -> dict[str, nmod_poly]:
    """Return a random number per name."""
    return {name: field.constant(random.randrange(1, field.prime)) for name in names}


BRANCHES = 4  # of a wavenumber about a point where it vanishes
ORIGIN_TERMS = 80
TRIALS = 4  # values of the parameters that are tried in each field


class OriginSeries:
    """Orders at s = 0, or where ``at`` vanishes, of functions over a ring, up to ``terms`` quarters.

    They are those for almost all values of the parameters, or for the ``known`` ones.
    """

    def __init__(
        self,
        ring: Ring,
        table: KernelTable,
        at: fmpz_mpoly | None = None,
        terms: int = ORIGIN_TERMS,
        known: Mapping[str, Fraction] | None = None,
    ) -> None:
        self.ring = ring
        self._found = _find_point(ring, table, ring.context.gen(0) if at is None else at, terms, known or {})

    def order(self, value: Factored) -> int | None:
        """Return the order of the zero (negative: of the pole), ``None`` when it is not found."""
        if self._found is None:
            return None
        field, values = self._found
        total = 0
        for factor, exponent in value.factors:
            first = field.order(field.polynomial(factor, self.ring.names, values))
            if first is None:
                return None
            total += first * exponent
        return total // BRANCHES if total % BRANCHES == 0 else None


def _find_point(
    ring: Ring, table: KernelTable, at: fmpz_mpoly, terms: int, known: Mapping[str, Fraction]
) -> tuple[TaylorField, dict[str, nmod_poly]] | None:
    """Return series for all generators near where a polynomial vanishes, with some numbers given."""
    if any(d.kind in ("general", "varying") for d in table.dispersions):
        return None
    index = next((i for i in range(len(ring.names)) if degree_in(at, i) == 1), 0)
    parts = by_powers(ring, at, index)
    name, zero = ring.names[index], ring.constant(0)

    def prepare(values: dict[str, nmod_poly], field: TaylorField) -> bool:
        for given, x in known.items():
            values[given] = field.constant(x.numerator * pow(x.denominator, -1, field.prime))
        coefficients = [
            field.polynomial(parts.get(k, zero), ring.names, values) for k in range(max(parts) + 1)
        ]
        there = nmod_poly([int(coefficient[0]) for coefficient in coefficients], field.prime)
        root = next((root for root, _ in there.roots()), None)
        if root is None or not int(there.derivative()(root)):
            return False
        # The scale decides in which fields the roots of several wavenumbers exist together.
        scale = (int(values[name][0]) or 1) / there.derivative()(root)
        values[name] = field.power(BRANCHES) * scale + field.constant(int(root))
        return True

    return find_point(ring, table, terms, prepare)


def find_point(
    ring: Ring, table: KernelTable, terms: int, prepare: Callable[[dict[str, nmod_poly], TaylorField], bool]
) -> tuple[TaylorField, dict[str, nmod_poly]] | None:
    """Return values that satisfy all relations in a field, series of ``terms``; ``prepare`` may refuse."""
    random = Random(11)
    for prime in primes():
        field = TaylorField(terms, prime)
        for _ in range(TRIALS):
            values = random_values(ring.names, random, field)
            if prepare(values, field) and all(_place(d, ring, values, field) for d in table.dispersions):
                generators = _with_kernels(ring, table, values, field)
                return None if generators is None else (field, generators)
    return None


def _with_kernels(
    ring: Ring, table: KernelTable, values: dict[str, nmod_poly], field: TaylorField
) -> dict[str, nmod_poly] | None:
    starts: dict[tuple[int, int], int] = {}
    pairs: dict[tuple[Dispersion, str, Factored, bool], tuple[nmod_poly, nmod_poly]] = {}
    for kernel in table.kernels:
        if kernel.function in ("fundamental", "entry"):
            continue
        circular = kernel.function in ("cos", "sin")
        pair = (kernel.dispersion, kernel.wavenumber, kernel.length, circular)
        if pair not in pairs:
            length = field.rational(kernel.length, ring.names, values)
            shift = field.rational(kernel.dispersion.shift, ring.names, values)
            if length is None or shift is None:
                return None
            rate = values[kernel.wavenumber] if kernel.wavenumber else -shift
            # Where two wavenumbers meet, both start from one exponential per length.
            place = (int(rate[0]), int(length[0]))
            start = starts.setdefault(place, pow(BASE, 1001 + 2 * len(starts), field.prime))
            pairs[pair] = field.even_odd(field.times(rate, length), start, circular=circular)
        even, odd = pairs[pair]
        if kernel.function == "exp":
            values[kernel.generator] = even + odd
        else:
            values[kernel.generator] = even if kernel.function in ("cosh", "cos") else odd
    return values


def _place(law: Dispersion, ring: Ring, values: dict[str, nmod_poly], field: TaylorField) -> bool:
    """Put the wavenumbers' series into the values; False where a root does not exist."""
    coefficients = [field.rational(x, ring.names, values) for x in law.characteristic]
    c = [x for x in coefficients if x is not None]
    if len(c) < len(coefficients):
        return False
    roots: list[nmod_poly | None] = []
    match law.kind:
        case "wave":
            roots = [field.root(-c[0])]
        case "bending":
            square = field.root(c[0] * pow(4, -1, field.prime))
            roots = [None if square is None else field.root(square)]
        case "pair":
            middle = -c[2] * pow(2, -1, field.prime)
            root = field.root(field.times(middle, middle) - c[0])
            if root is not None:
                roots = [field.root(middle + root), field.root(middle - root)]
    if len(roots) < len(law.wavenumbers):
        return False
    for name, series in zip(law.wavenumbers, roots, strict=True):
        if series is None:
            return False
        values[name] = series
    return True

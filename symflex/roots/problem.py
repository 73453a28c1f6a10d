"""A product of polynomials in s with exact coefficients, and its coprime, square-free parts.

The parts are in s or in z = s^2, and their numeric roots are all simple, as far as the constants are
independent. A root on the imaginary axis of a real polynomial f, and a root whose negative is a root too, is
a common root of f(s) and f(-s). So gcd(f(s), f(-s)) = h(s^2) holds them all, and what remains has none on
the axis.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce

from flint import arb, arb_poly, fmpz_mpoly, fmpz_mpoly_ctx, fmpz_poly

from symflex.algebra import Factored, Ring, degree_in, square_free_factors
from symflex.balls import precision, value_at
from symflex.budget import spend
from symflex.errors import Diagnostic, ModelError, UncertifiedError
from symflex.model.model import IMAGINARY
from symflex.transfer import BoundTransferFunction, coefficients_in_s

ZERO_TEST_BITS = (64, 256, 1024, 4096)  # precisions at which a coefficient is compared with zero, in turn


@dataclass(frozen=True, slots=True)
class RealConstant:
    """A real number that exact steps treat as an independent symbol."""

    name: str  # such as ``pi`` or ``sqrt(2)``; equal names are the same constant
    evaluate: Callable[[], arb]  # returns the constant as a real ball at the current precision


@dataclass(frozen=True, slots=True)
class PolynomialInS:
    """A polynomial in s whose coefficients are integer polynomials in real constants; SF403 for zero.

    >>> from fractions import Fraction
    >>> p = PolynomialInS.from_rationals([Fraction(1, 2), 0, Fraction(1, 3)])
    >>> p.degree, p.integers()
    (2, (3, 0, 2))
    """

    coefficients: tuple[fmpz_mpoly, ...]  # in ascending powers of s, without trailing zeros
    context: fmpz_mpoly_ctx  # ring of the coefficients; generator number i stands for ``constants[i]``
    constants: tuple[RealConstant, ...] = ()  # one for each generator; none with integers alone

    def __post_init__(self) -> None:
        if len(self.constants) != self.context.nvars():
            raise ValueError(f"{self.context.nvars()} generators but {len(self.constants)} constants")
        length = max((i for i, c in enumerate(self.coefficients, 1) if not c.is_zero()), default=0)
        if length == 0:
            raise ModelError(Diagnostic("SF403", "the polynomial is zero: every s is a root of it"))
        object.__setattr__(self, "coefficients", tuple(self.coefficients[:length]))

    @classmethod
    def from_rationals(cls, coefficients: Sequence[Fraction | int]) -> PolynomialInS:
        """Return the polynomial with these ascending coefficients, scaled to integers."""
        scale = math.lcm(*(c.denominator for c in coefficients))
        return cls.from_integers([int(c * scale) for c in coefficients])

    @classmethod
    def from_integers(cls, coefficients: Sequence[int]) -> PolynomialInS:
        """Return the polynomial with these ascending integer coefficients."""
        context = fmpz_mpoly_ctx.get([], "lex")
        return cls(tuple(context.constant(c) for c in coefficients), context)

    @property
    def degree(self) -> int:
        """Degree in s."""
        return len(self.coefficients) - 1

    @property
    def is_exact(self) -> bool:
        """Whether every coefficient is an integer."""
        return not self.constants

    def integers(self) -> tuple[int, ...]:
        """Return the ascending coefficients of a polynomial without constants."""
        if self.constants:
            raise ValueError("the coefficients contain constants")
        return tuple(int(c.to_dict().get((), 0)) for c in self.coefficients)

    def enclosure(self) -> arb_poly:
        """Return the polynomial with coefficients as balls, at the current precision."""
        if self.is_exact:
            return arb_poly([arb(c) for c in self.integers()])
        values = tuple(constant.evaluate() for constant in self.constants)
        return arb_poly([value_at(c, values.__getitem__, arb) for c in self.coefficients])

    def require_leading_coefficient(self) -> None:
        """Prove that the leading coefficient is not zero; SF401 if balls of 4096 bits hold zero."""
        if self.is_exact:
            return
        for bits in ZERO_TEST_BITS:
            with precision(bits):
                values = tuple(constant.evaluate() for constant in self.constants)
                if value_at(self.coefficients[-1], values.__getitem__, arb) != 0:
                    return
        message = f"cannot tell whether the coefficient {self.coefficients[-1]} of s^{self.degree} is zero"
        hint = "its constants seem to satisfy a relation; write the coefficient without it"
        raise UncertifiedError(Diagnostic("SF401", message, hint=hint))


@dataclass(frozen=True, slots=True)
class RootProblem:
    """The roots of a product of powers of polynomials."""

    factors: tuple[tuple[PolynomialInS, int], ...]  # with positive exponents, maybe with common factors

    def __post_init__(self) -> None:
        if any(exponent < 1 for _, exponent in self.factors):
            raise ValueError("exponents of factors are positive")

    @classmethod
    def from_rationals(cls, coefficients: Sequence[Fraction | int]) -> RootProblem:
        """Return the problem of one polynomial with these ascending coefficients."""
        return cls(((PolynomialInS.from_rationals(coefficients), 1),))

    @property
    def degree(self) -> int:
        """Number of roots, counted with multiplicity."""
        return sum(polynomial.degree * exponent for polynomial, exponent in self.factors)


def polynomial_in_s(bound: BoundTransferFunction, factor: fmpz_mpoly) -> PolynomialInS:
    """Return a factor without wavenumbers and kernels as a polynomial in s."""
    constants = tuple(RealConstant(name, evaluate) for name, evaluate in bound.constants)
    ring = bound.ratio.ring
    used = tuple(c for c in constants if degree_in(factor, ring.index[c.name]))
    small = Ring(("s", *(c.name for c in used)))
    places = [ring.index[name] for name in small.names]
    terms = {tuple(int(m[i]) for i in places): int(c) for m, c in factor.terms()}
    coefficients = Ring(small.names[1:])
    polynomial = small.context.from_dict(terms)
    return PolynomialInS(coefficients_in_s(polynomial, coefficients), coefficients.context, used)


def is_complex(value: Factored) -> bool:
    """Tell whether j is in a product."""
    return IMAGINARY in value.ring.index and value.depends_on(IMAGINARY)


def problem_of(bound: BoundTransferFunction, factors: Iterable[tuple[fmpz_mpoly, int]]) -> RootProblem:
    """Return what roots powers of factors without wavenumbers and kernels have, those that depend on s."""
    if bound.radicals:
        factors = bound.radicals.split(factors)
    polynomials = [(polynomial_in_s(bound, f), e) for f, e in factors]
    return RootProblem(tuple((p, e) for p, e in polynomials if p.degree > 0))


def cancelled(bound: BoundTransferFunction) -> Factored:
    """Return the product of what cancelled between numerator and denominator."""
    hidden = tuple((h.polynomial, h.multiplicity) for h in bound.hidden)
    return Factored(bound.ratio.ring, Fraction(1), hidden)


@dataclass(frozen=True, slots=True)
class SquareFreePart:
    """A square-free polynomial without the root 0."""

    polynomial: PolynomialInS  # in s, or in z = s^2 when ``in_square``
    multiplicity: int  # of every root of the part in the whole product
    in_square: bool  # the roots s are plus and minus the square roots of the polynomial's roots


@dataclass(frozen=True, slots=True)
class Splitting:
    """A product of polynomials, taken apart exactly."""

    zeros: int  # multiplicity of the root s = 0
    parts: tuple[SquareFreePart, ...]  # pairwise coprime


def split(problem: RootProblem) -> Splitting:
    """Take a product of polynomials apart into coprime square-free parts; SF506 when the time is over.

    It is exact over Q(constants), the constants taken as algebraically independent.

    >>> splitting = split(RootProblem.from_rationals([0, 0, 4, 4, 1, 1]))  # s^2 (s + 1) (s^2 + 4)
    >>> splitting.zeros, [(part.polynomial.integers(), part.in_square) for part in splitting.parts]
    (2, [((4, 1), True), ((1, 1), False)])
    """
    simple = _split_simple(problem)
    if simple is not None:
        return simple
    ring = _Ring.of(problem)
    zeros = 0
    base: list[tuple[fmpz_mpoly, int]] = []
    for polynomial, exponent in problem.factors:
        spend()
        low = next(i for i, c in enumerate(polynomial.coefficients) if not c.is_zero())
        zeros += low * exponent
        for factor, power in square_free_factors(ring.lift(polynomial, low))[1]:
            if _degree(factor) > 0:
                base = _insert(base, factor, power * exponent)
    parts: list[SquareFreePart] = []
    for element, multiplicity in base:
        spend()
        even = element.gcd(ring.reflect(element))
        for part, step in ((even, 2), (element // even, 1)):
            if _degree(part) > 0:
                parts.append(SquareFreePart(ring.lower(part, step), multiplicity, in_square=part is even))
    return Splitting(zeros, tuple(parts))


def _split_simple(problem: RootProblem) -> Splitting | None:
    """Return the parts of one polynomial with integers, None if it has squares or there are more."""
    if len(problem.factors) != 1 or not problem.factors[0][0].is_exact:
        return None
    ((polynomial, exponent),) = problem.factors
    integers = polynomial.integers()
    low = next(i for i, c in enumerate(integers) if c)
    common = math.gcd(*integers)
    whole = fmpz_poly([c // common for c in integers[low:]])
    if whole.gcd(whole.derivative()).degree() > 0:
        return None
    even = whole.gcd(whole(fmpz_poly([0, -1])))
    parts = [(even.coeffs()[::2], True), ((whole // even).coeffs(), False)]
    found = ((PolynomialInS.from_integers([int(c) for c in part]), square) for part, square in parts)
    return Splitting(low * exponent, tuple(SquareFreePart(p, exponent, x) for p, x in found if p.degree))


def _insert(
    base: list[tuple[fmpz_mpoly, int]], element: fmpz_mpoly, multiplicity: int
) -> list[tuple[fmpz_mpoly, int]]:
    """Add a square-free element to a pairwise coprime base; what is shared sums its multiplicities."""
    result: list[tuple[fmpz_mpoly, int]] = []
    for other, other_multiplicity in base:
        common = element.gcd(other)
        rest = other // common
        if _degree(rest) > 0:
            result.append((rest, other_multiplicity))
        if _degree(common) > 0:
            element = element // common
            result.append((common, multiplicity + other_multiplicity))
    if _degree(element) > 0:
        result.append((element, multiplicity))
    return result


def _degree(element: fmpz_mpoly) -> int:
    return int(element.degrees()[0])


@dataclass(frozen=True, slots=True)
class _Ring:
    """Z[s, constants], with s the first generator."""

    context: fmpz_mpoly_ctx
    constants: tuple[RealConstant, ...]

    @classmethod
    def of(cls, problem: RootProblem) -> _Ring:
        """Return a ring that contains every factor of the problem."""
        by_name = {c.name: c for polynomial, _ in problem.factors for c in polynomial.constants}
        names = ["s", *(f"c{i}" for i in range(len(by_name)))]
        return cls(fmpz_mpoly_ctx.get(names, "lex"), tuple(by_name.values()))

    def lift(self, polynomial: PolynomialInS, low: int) -> fmpz_mpoly:
        """Return the polynomial divided by s^low and by the content of its coefficients."""
        position = {constant.name: i for i, constant in enumerate(self.constants)}
        places = [position[constant.name] for constant in polynomial.constants]
        coefficients: list[fmpz_mpoly] = []
        for coefficient in polynomial.coefficients[low:]:
            terms: dict[tuple[int, ...], int] = {}
            for exponents, integer in coefficient.to_dict().items():
                powers = dict(zip(places, map(int, exponents), strict=True))
                terms[0, *(powers.get(i, 0) for i in range(len(self.constants)))] = int(integer)
            coefficients.append(self.context.from_dict(terms))
        content = reduce(lambda a, b: a.gcd(b), coefficients)
        terms = {
            (power, *(int(e) for e in monomial[1:])): int(integer)
            for power, coefficient in enumerate(coefficients)
            for monomial, integer in (coefficient // content).to_dict().items()
        }
        return self.context.from_dict(terms)

    def lower(self, element: fmpz_mpoly, step: int) -> PolynomialInS:
        """Return the element as a polynomial in s^step."""
        context = fmpz_mpoly_ctx.get([f"c{i}" for i in range(len(self.constants))], "lex")
        rows: list[dict[tuple[int, ...], int]] = [{} for _ in range(_degree(element) // step + 1)]
        for exponents, integer in element.to_dict().items():
            power, *monomial = (int(e) for e in exponents)
            rows[power // step][tuple(monomial)] = int(integer)
        return PolynomialInS(tuple(context.from_dict(row) for row in rows), context, self.constants)

    def reflect(self, element: fmpz_mpoly) -> fmpz_mpoly:
        """Return the element with s replaced by -s."""
        terms = element.to_dict().items()
        return self.context.from_dict({e: -c if int(e[0]) % 2 else c for e, c in terms})

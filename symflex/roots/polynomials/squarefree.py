"""Exact splitting of a product of polynomials into coprime, square-free parts.

Input: a :class:`RootProblem`. Output: the multiplicity of the root 0, and parts in s or in z = s^2
whose numeric roots are all simple (as far as the constants are independent).

A root on the imaginary axis of a real polynomial f, and a root whose negative is a root too, is a common
root of f(s) and f(-s). So gcd(f(s), f(-s)) = h(s^2) holds them all, and what remains has none on the axis.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce

from flint import fmpz_mpoly, fmpz_mpoly_ctx

from symflex.algebra import square_free_factors
from symflex.budget import Budget, entered_budget
from symflex.roots.problem import PolynomialInS, RealConstant, RootProblem


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


def split(problem: RootProblem, budget: Budget | None = None) -> Splitting:
    """Take a product of polynomials apart into coprime square-free parts; SF506 when the time is over.

    It is exact over Q(constants), the constants taken as algebraically independent.

    Examples
    --------
    >>> splitting = split(RootProblem.from_rationals([0, 0, 4, 4, 1, 1]))  # s^2 (s + 1) (s^2 + 4)
    >>> splitting.zeros, [(part.polynomial.integers(), part.in_square) for part in splitting.parts]
    (2, [((4, 1), True), ((1, 1), False)])
    """
    time = budget or entered_budget()
    ring = _Ring.of(problem)
    zeros = 0
    base: list[tuple[fmpz_mpoly, int]] = []
    for polynomial, exponent in problem.factors:
        time.spend()
        low = next(i for i, c in enumerate(polynomial.coefficients) if not c.is_zero())
        zeros += low * exponent
        for factor, power in square_free_factors(ring.lift(polynomial, low))[1]:
            if _degree(factor) > 0:
                base = _insert(base, factor, power * exponent)
    parts: list[SquareFreePart] = []
    for element, multiplicity in base:
        time.spend()
        even = element.gcd(ring.reflect(element))
        odd = element // even
        if _degree(even) > 0:
            parts.append(SquareFreePart(ring.lower(even, 2), multiplicity, in_square=True))
        if _degree(odd) > 0:
            parts.append(SquareFreePart(ring.lower(odd, 1), multiplicity, in_square=False))
    return Splitting(zeros, tuple(parts))


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
        """Return a ring that holds every factor of the problem."""
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
                monomial = [0] * (len(self.constants) + 1)
                for place, exponent in zip(places, exponents, strict=True):
                    monomial[place + 1] = int(exponent)
                terms[tuple(monomial)] = int(integer)
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

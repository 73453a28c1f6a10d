"""Stability boundaries of polynomials in s and a gain, exactly.

With ``s = j omega`` and ``w = omega^2`` the characteristic polynomial is ``E(w, K) + j omega O(w, K)``. It
has a root on the imaginary axis where E and O vanish together, at s = 0 where its last coefficient does, at
infinity where its first does. What E and O have in common belongs to roots that mirror each other in the axis
for every gain; between the real roots of its discriminant their number on the axis stays the same.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import lcm
from typing import TYPE_CHECKING

from flint import arb, fmpz_mpoly

from symflex.algebra import Ring, degree_in
from symflex.balls import precision, value_at
from symflex.errors import Diagnostic, UncertifiedError
from symflex.loops.stability_map import Crossing, PoleCount
from symflex.roots import PolynomialInS, RealConstant, Root, RootProblem, find_polynomial_roots
from symflex.roots.pole_zero_map import count_right
from symflex.roots.problem import problem_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.loops.loop import GainPolynomial
    from symflex.transfer import BoundTransferFunction

W, K = 0, 1
"""Positions of omega squared and of the gain in the ring of E and O."""
SPARE_DIGITS = 10
COUNT_DIGITS = 15
"""Of squares whose sign alone matters."""


@dataclass(frozen=True)
class LumpedFactor:
    """One polynomial factor of a characteristic function."""

    bound: BoundTransferFunction  # carries the ring of the factor
    factor: GainPolynomial
    constants: tuple[RealConstant, ...]  # real numbers the coefficients hold as symbols
    ring: Ring  # w, K and the constants
    # even and odd: E and O without their common factor.
    even: fmpz_mpoly
    odd: fmpz_mpoly
    common: fmpz_mpoly  # the greatest common factor of E and O

    @classmethod
    def of(cls, bound: BoundTransferFunction, factor: GainPolynomial) -> LumpedFactor:
        """Return a factor without kernels as E and O."""
        terms = _integer_terms(factor)
        constants = tuple(RealConstant(name, evaluate) for name, evaluate in bound.constants)
        names = bound.ratio.ring.names[1 : 1 + len(constants)]
        used = [i for i, _ in enumerate(names) if any(key[2][i] for key in terms)]
        ring = Ring(("w", "K", *(names[i] for i in used)))
        zeros = min(s for s, _, _ in terms)
        parts: tuple[dict[tuple[int, ...], int], ...] = ({}, {})
        for (s, k, rest), number in terms.items():
            half, is_odd = divmod(s - zeros, 2)
            place = (half, k, *(rest[i] for i in used))
            parts[is_odd][place] = number * (-1) ** half
        even, odd = (ring.context.from_dict(part) for part in parts)
        common = even.gcd(odd) if len(odd) else even
        return cls(
            bound,
            factor,
            tuple(constants[i] for i in used),
            ring,
            even / common,
            odd / common if len(odd) else odd,
            common,
        )

    def crossings(self, digits: int) -> list[Crossing]:
        """Return the gains at which the number of poles on a side of the axis may change, real and finite."""
        crossings: list[Crossing] = []
        whole = self.even * self.common, self.odd * self.common
        if degree_in(whole[0], K) == 0 and degree_in(whole[1], K) == 0:
            return []
        if degree_in(whole[0], W) or len(whole[1]):
            at_zero = self.ring.coefficients(whole[0], W)[0]
            crossings += [Crossing(gain, (arb(0),)) for gain in self._gains(at_zero, digits)]
        leading = [self._leading(whole)]
        if degree_in(self.common, W):
            leading.append(self._leading((self.common, self.common * 0)))
        crossings += [
            Crossing(gain, (), is_infinite=True) for f in leading for gain in self._gains(f, digits)
        ]
        return crossings + self._meetings(digits) + self._on_axis(digits)

    def _meetings(self, digits: int) -> list[Crossing]:
        """Return where poles that mirror each other in the axis meet, on it or beside it."""
        w, k = (str(self.ring.context.gen(i)) for i in (W, K))
        simple = self.common / self.common.gcd(self.common.derivative(w))
        if degree_in(simple, W) < 2 or degree_in(simple, K) == 0:  # noqa: PLR2004 (two roots can meet)
            return []
        slope = simple.derivative(w)
        gains = self._real_roots(simple.discriminant(w), K, digits)
        squares = self._real_roots(simple.resultant(slope, k), W, digits + SPARE_DIGITS)
        meetings = ((gain.re, self._frequencies(gain, squares, (simple, slope))) for gain in gains)
        return [Crossing(gain, near, is_symmetric=True) for gain, near in meetings]

    def _on_axis(self, digits: int) -> list[Crossing]:
        """Return where E and O vanish together at a positive w."""
        even, odd = (self.ring.coefficients(f, K) for f in (self.even, self.odd))
        if not len(self.odd) or len(even) == len(odd) == 1:
            return []
        if max(len(even), len(odd)) <= 2:  # noqa: PLR2004 (affine)
            zero = self.ring.constant(0)
            even, odd = ([*f, zero][:2] for f in (even, odd))
            resultant = even[0] * odd[1] - even[1] * odd[0]
            roots = self._real_roots(resultant, W, digits + SPARE_DIGITS)
            return [c for root in roots if root.re > 0 and (c := self._affine(root, even, odd))]
        name = [str(self.ring.context.gen(i)) for i in (W, K)]
        squares = self._real_roots(self.even.resultant(self.odd, name[K]), W, digits + SPARE_DIGITS)
        gains = self._real_roots(self.even.resultant(self.odd, name[W]), K, digits)
        meetings = ((gain.re, self._frequencies(gain, squares, (self.even, self.odd))) for gain in gains)
        return [Crossing(gain, near) for gain, near in meetings if near]

    def _affine(self, root: Root, even: Sequence[fmpz_mpoly], odd: Sequence[fmpz_mpoly]) -> Crossing | None:
        """Return the gain at which the poles cross at a frequency; ``None`` where that is infinite."""
        with precision(2 * root.working_bits()):
            values = [[self._value(f, root.re, arb(0)) for f in pair] for pair in (even, odd)]
            usable = [(-constant / slope) for constant, slope in values if not slope.contains(0)]
            if not usable:
                return None
            gain = max(usable, key=lambda ball: ball.rel_accuracy_bits())
            return Crossing(gain, (root.re.sqrt(),))

    def _frequencies(
        self, gain: Root, squares: Sequence[Root], polynomials: Sequence[fmpz_mpoly]
    ) -> tuple[arb, ...]:
        """Return the frequencies that belong to a gain: at the others one of the polynomials is not 0."""
        positive = [square for square in squares if square.re > 0]
        near = [w for w in positive if all(self._may_vanish(f, w, gain) for f in polynomials)]
        with precision(gain.working_bits()):
            return tuple(square.re.sqrt() for square in near)

    def _may_vanish(self, polynomial: fmpz_mpoly, square: Root, gain: Root) -> bool:
        with precision(2 * max(square.working_bits(), gain.working_bits())):
            return self._value(polynomial, square.re, gain.re).contains(0)

    def _value(self, polynomial: fmpz_mpoly, square: arb, gain: arb) -> arb:
        """Return a polynomial of the ring at w and K, at the current precision."""
        values = [square, gain, *(constant.evaluate() for constant in self.constants)]
        return value_at(polynomial, values.__getitem__, arb)

    def _leading(self, parts: tuple[fmpz_mpoly, fmpz_mpoly]) -> fmpz_mpoly:
        """Return the coefficient of the highest power of s in ``E + s O``, a polynomial in K."""
        even, odd = parts
        high, higher = degree_in(even, W), degree_in(odd, W)
        chosen, power = (odd, higher) if len(odd) and 2 * higher + 1 > 2 * high else (even, high)
        return self.ring.coefficients(chosen, W)[power]

    def _gains(self, polynomial: fmpz_mpoly, digits: int) -> list[arb]:
        return [root.re for root in self._real_roots(polynomial, K, digits)]

    def _real_roots(self, polynomial: fmpz_mpoly, variable: int, digits: int) -> list[Root]:
        """Return the real roots of a polynomial in one of w and K; each once."""
        if degree_in(polynomial, variable) == 0:
            return []
        problem = RootProblem(((self._polynomial(self.ring.coefficients(polynomial, variable)), 1),))
        return [root for root in find_polynomial_roots(problem, digits) if root.is_real]

    def count(self, gain: Fraction) -> PoleCount:
        """Return how many poles lie right of the axis and on it for a gain that is not a crossing.

        SF802 when a root cannot be told from one on the axis.
        """
        factors = [(f, e) for f, e in self.factor.at(gain).factors if e > 0]
        roots = find_polynomial_roots(problem_of(self.bound, factors), COUNT_DIGITS)
        if any(root.re.contains(0) and not root.on_imaginary_axis for root in roots):
            message = "it could not be decided on which side of the imaginary axis a pole lies"
            raise UncertifiedError(Diagnostic("SF802", message))
        axis = sum(root.multiplicity for root in roots if root.on_imaginary_axis)
        times = self.factor.multiplicity
        return PoleCount(count_right(roots) * times, axis * times)

    def _polynomial(self, coefficients: Sequence[fmpz_mpoly]) -> PolynomialInS:
        small = Ring(self.ring.names[2:])
        moved = []
        for coefficient in coefficients:
            terms = {tuple(int(e) for e in m[2:]): int(n) for m, n in coefficient.terms()}
            moved.append(small.context.from_dict(terms))
        return PolynomialInS(tuple(moved), small.context, self.constants)


def _integer_terms(factor: GainPolynomial) -> dict[tuple[int, int, tuple[int, ...]], int]:
    """Return powers of s, K and constants with integer coefficients, scaled by what has no roots."""
    rational: dict[tuple[int, int, tuple[int, ...]], Fraction] = {}
    for k, coefficient in enumerate(factor.coefficients):
        if coefficient.is_zero:
            continue
        above, below = coefficient.numerator(), coefficient.denominator()
        shift = [0] * len(coefficient.ring.names)
        number = Fraction(1, below.expand().term_content().leading_coefficient().__int__())
        for f, e in below.factors:
            # Only pi stands below: every other value is rational or a generator.
            for i, power in enumerate(f.monoms()[0]):
                shift[i] += int(power) * e
        for monomial, integer in above.expand().terms():
            exponents = [int(e) - d for e, d in zip(monomial, shift, strict=True)]
            key = (exponents[0], k, tuple(exponents[1:]))
            rational[key] = rational.get(key, Fraction(0)) + int(integer) * number
    least = [min(key[2][i] for key in rational) for i in range(len(next(iter(rational))[2]))]
    scale = lcm(*(value.denominator for value in rational.values()))
    return {
        (s, k, tuple(e - m for e, m in zip(rest, least, strict=True))): int(value * scale)
        for (s, k, rest), value in rational.items()
    }

"""Stability boundaries of polynomials in s and a gain, exactly.

With ``s = j omega`` and ``w = omega^2`` the characteristic polynomial is ``E(w, K) + j omega O(w, K)``. It
has a root on the imaginary axis where E and O vanish together, at s = 0 where its last coefficient does, at
infinity where its first does. What E and O have in common belongs to roots that mirror each other in the axis
for every gain; between the real roots of its discriminant their number on the axis stays the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial, reduce
from math import inf, lcm

from flint import arb, arb_series, fmpz_mpoly

from symflex.algebra import Ring, degree_in, irreducible_factors
from symflex.balls import bits_for_digits, precision, value_at
from symflex.budget import spend
from symflex.errors import Diagnostic, SymflexError, UncertifiedError
from symflex.loops.gain_functions import GainFunctions
from symflex.loops.loop import GainPolynomial, Loop
from symflex.loops.stability_map import Crossing, PoleCount
from symflex.roots import PolynomialInS, RealConstant, Root, RootProblem, find_polynomial_roots
from symflex.roots.pole_zero_map import count_right
from symflex.roots.problem import problem_of
from symflex.transfer import BoundTransferFunction

W, K = 0, 1  # positions of omega squared and of the gain in the ring of E and O
SPARE_DIGITS = 10
COUNT_DIGITS = 15  # of squares whose sign alone matters


@dataclass(frozen=True)
class LumpedFactor:
    """One polynomial factor of a characteristic function."""

    bound: BoundTransferFunction  # carries the ring of the factor
    factor: GainPolynomial
    constants: tuple[RealConstant, ...]  # real numbers the coefficients hold as symbols
    ring: Ring  # w, K and the constants
    even: fmpz_mpoly  # even and odd: E and O without their common factor
    odd: fmpz_mpoly
    common: fmpz_mpoly  # the greatest common factor of E and O
    loop: Loop | None = None  # whose factor it is
    functions: GainFunctions | None = None  # in the ring, or powers of one root in its place
    limits: tuple[Fraction, Fraction] = (Fraction(0), Fraction(0))

    @classmethod
    def of(
        cls,
        bound: BoundTransferFunction,
        factor: GainPolynomial,
        loop: Loop | None = None,
        limits: tuple[Fraction | None, Fraction | None] = (None, None),
    ) -> LumpedFactor:
        """Return a factor without kernels as E and O; of one with functions of the gain limits are known."""
        terms = _integer_terms(factor)
        constants = [RealConstant(name, evaluate) for name, evaluate in bound.constants]
        functions = None if loop is None or not factor.exponents else loop.functions
        unknowns = [] if functions is None else [f"{name} of the gain" for name in functions.calls]
        if functions is not None and functions.root is not None:
            terms, unknowns = _in_root(terms, functions, constants), []
        used = [i for i, _ in enumerate(constants) if any(key[2][i] for key in terms)]
        ring = Ring(("w", "K", *unknowns, *(constants[i].name for i in used)))
        zeros = min(s for s, _, _ in terms)
        parts: tuple[dict[tuple[int, ...], int], ...] = ({}, {})
        for (s, k, rest), number in terms.items():
            half, is_odd = divmod(s - zeros, 2)
            exponents = (half, *k, *(rest[i] for i in used))
            parts[is_odd][exponents] = number * (-1) ** half
        even, odd = (ring.context.from_dict(part) for part in parts)
        common = even.gcd(odd) if len(odd) else even
        kept, halves = tuple(constants[i] for i in used), (even / common, odd / common if len(odd) else odd)
        ends = limits[0] or Fraction(0), limits[1] or Fraction(0)
        return cls(bound, factor, kept, ring, *halves, common, loop, functions, ends)

    def _moves(self, *polynomials: fmpz_mpoly) -> bool:
        """Tell whether one of some polynomials depends on the gain."""
        end = len(self.ring.names) - len(self.constants)
        return any(degree_in(f, i) for f in polynomials for i in range(K, end))

    @property
    def _mixed(self) -> GainFunctions | None:
        """The functions of the gain in the ring."""
        return self.functions if self.functions is not None and self.functions.root is None else None

    def crossings(self, digits: int) -> list[Crossing]:
        """Return the gains at which the number of poles on a side of the axis may change, real and finite."""
        crossings, functions = self._crossings(digits), self.functions
        if functions is None or functions.root is None:
            return crossings
        with precision(max([COUNT_DIGITS, *(2 * c.gain.bits() for c in crossings)])):
            powers = ((c, functions.sign * c.gain**functions.root) for c in crossings if not c.gain < 0)
            return [replace(crossing, gain=gain) for crossing, gain in powers]

    def _crossings(self, digits: int) -> list[Crossing]:
        crossings: list[Crossing] = []
        parts = self.even * self.common, self.odd * self.common
        if not self._moves(*parts):
            return []
        content = reduce(fmpz_mpoly.gcd, (c for f in parts for c in self.ring.coefficients(f, W)))
        crossings += [Crossing(gain, (), is_singular=True) for gain in self._gains(content, digits)]
        parts = parts[0] / content, parts[1] / content
        if degree_in(parts[0], W) or len(parts[1]):
            at_zero = self.ring.coefficients(parts[0], W)[0]
            crossings += [Crossing(gain, (arb(0),)) for gain in self._gains(at_zero, digits)]
        leading = [self._leading(parts)]
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
        if degree_in(simple, W) < 2 or not self._moves(simple):  # noqa: PLR2004 (two roots can meet)
            return []
        slope = simple.derivative(w)
        if self._mixed is not None:
            return self._with_functions(simple.discriminant(w), (simple, slope), digits, is_symmetric=True)
        gains = self._real_roots(simple.discriminant(w), K, digits)
        squares = self._real_roots(simple.resultant(slope, k), W, digits + SPARE_DIGITS)
        meetings = ((gain.re, self._frequencies(gain, squares, (simple, slope))) for gain in gains)
        return [Crossing(gain, near, is_symmetric=True) for gain, near in meetings]

    def _on_axis(self, digits: int) -> list[Crossing]:
        """Return where E and O vanish together at a positive w."""
        even, odd = (self.ring.coefficients(f, K) for f in (self.even, self.odd))
        if not len(self.odd) or not self._moves(self.even, self.odd):
            return []
        if self._mixed is not None:
            resultant = self.even.resultant(self.odd, str(self.ring.context.gen(W)))
            return self._with_functions(resultant, (self.even, self.odd), digits)
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

    def _with_functions(
        self,
        polynomial: fmpz_mpoly,
        both: tuple[fmpz_mpoly, fmpz_mpoly],
        digits: int,
        *,
        is_symmetric: bool = False,
    ) -> list[Crossing]:
        """Return the gains at which a polynomial vanishes and two others share a root, positive or not."""
        lowest = min(both, key=lambda f: degree_in(f, W) or inf)
        crossings = []
        for gain in self._gains(polynomial, 2 * digits + SPARE_DIGITS):
            with precision(max(gain.bits(), bits_for_digits(digits))):
                known = [RealConstant(str(i), partial(arb, x)) for i, x in enumerate(self._numbers(gain))]
            ring = Ring(self.ring.names[1:])
            parts = [ring.taken_over(c, self.ring.names) for c in self.ring.coefficients(lowest, W)]
            problem = RootProblem(((PolynomialInS(tuple(parts), ring.context, tuple(known)), 1),))
            try:
                squares = [r for r in find_polynomial_roots(problem, digits) if r.is_real and r.re > 0]
            except SymflexError:
                spend()
                crossings.append(Crossing(gain, (), is_symmetric=is_symmetric, is_open=True))
                continue
            is_open = gain.rel_accuracy_bits() < bits_for_digits(digits)
            near = [w for w in squares if all(self._value(f, w.re, gain).contains(0) for f in both)]
            frequencies = tuple(w.re.sqrt() for w in near)
            crossings.append(Crossing(gain, frequencies, is_symmetric=is_symmetric, is_open=is_open))
        return crossings

    def _numbers(self, gain: arb) -> list[arb]:
        """Return the gain, its functions and the constants, at the current precision."""
        gain_values = [gain] if self._mixed is None else [x[0] for x in self._mixed.at(gain)]
        return [*gain_values, *(constant.evaluate() for constant in self.constants)]

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
        near = []
        for square in (w for w in squares if w.re > 0):
            with precision(2 * max(square.working_bits(), gain.working_bits())):
                if all(self._value(f, square.re, gain.re).contains(0) for f in polynomials):
                    near.append(square)
        with precision(gain.working_bits()):
            return tuple(square.re.sqrt() for square in near)

    def _value(self, polynomial: fmpz_mpoly, square: arb, gain: arb) -> arb:
        """Return a polynomial of the ring at w and K, at the current precision."""
        values = [square, *self._numbers(gain)]
        return value_at(polynomial, values.__getitem__, arb)

    def _leading(self, parts: tuple[fmpz_mpoly, fmpz_mpoly]) -> fmpz_mpoly:
        """Return the coefficient of the highest power of s in ``E + s O``, a polynomial in K."""
        even, odd = parts
        high, higher = degree_in(even, W), degree_in(odd, W)
        chosen, power = (odd, higher) if len(odd) and 2 * higher + 1 > 2 * high else (even, high)
        return self.ring.coefficients(chosen, W)[power]

    def _gains(self, polynomial: fmpz_mpoly, digits: int) -> list[arb]:
        """Return gains at which a polynomial without w vanishes, and narrow ranges where it may."""
        functions, gains = self._mixed, list[arb]()
        if functions is None:
            return [root.re for root in self._real_roots(polynomial, K, digits)]
        for factor, _ in irreducible_factors(polynomial)[1] if self._moves(polynomial) else ():
            if self._moves(factor):

                def value(gain: arb, factor: fmpz_mpoly = factor) -> arb_series:
                    return functions.value(factor, gain, [c.evaluate() for c in self.constants])

                for zeros in functions.zeros(value, self.limits, digits):
                    gains += zeros
        return gains

    def _real_roots(self, polynomial: fmpz_mpoly, variable: int, digits: int) -> list[Root]:
        """Return the real roots of a polynomial in one of w and K; each once."""
        if degree_in(polynomial, variable) == 0:
            return []
        small, moved = Ring(self.ring.names[2:]), []
        for coefficient in self.ring.coefficients(polynomial, variable):
            terms = {tuple(int(e) for e in m[2:]): int(n) for m, n in coefficient.terms()}
            moved.append(small.context.from_dict(terms))
        problem = RootProblem(((PolynomialInS(tuple(moved), small.context, self.constants), 1),))
        return [root for root in find_polynomial_roots(problem, digits) if root.is_real]

    def count(self, gain: Fraction, within: float = inf) -> PoleCount:
        """Return how many poles within an abs(s) [rad/s] are on the right and on the axis; else SF802."""
        roots = [root for root in self.roots(gain) if not abs(root.enclosure()) > within]
        times = self.factor.multiplicity
        axis = sum(root.multiplicity for root in roots if root.on_imaginary_axis)
        return PoleCount(count_right(roots) * times, axis * times)

    def roots(self, gain: Fraction) -> list[Root]:
        """Return the poles for a gain, each in one of the open half-planes or on the axis."""
        loop = self.loop if self.factor.exponents else None
        bound = self.bound if loop is None else loop.bound_at(gain)
        factors = [(f, e) for f, e in self.factor.value_in(bound, gain, loop).factors if e > 0]
        roots = find_polynomial_roots(problem_of(bound, factors), COUNT_DIGITS)
        if any(root.re.contains(0) and not root.on_imaginary_axis for root in roots):
            message = "it could not be decided on which side of the imaginary axis a pole lies"
            raise UncertifiedError(Diagnostic("SF802", message))
        return list(roots)


Terms = dict[tuple[int, tuple[int, ...], tuple[int, ...]], int]  # by exponents of s, the gain, and others


def _in_root(terms: Terms, functions: GainFunctions, constants: list[RealConstant]) -> Terms:
    """Return terms in the root of the gain; what its powers are multiplied by is added to the constants."""
    places = []
    for _, _, constant in functions.powers:
        if constant is not None and constant.name not in [c.name for c in constants]:
            constants.append(constant)
        places.append(None if constant is None else [c.name for c in constants].index(constant.name))
    most = [max(key[1][j] for key in terms) for j in range(1, 1 + len(places))]
    moved: dict[tuple[int, int, tuple[int, ...]], int] = {}
    for (s, (power_of_gain, *others), rest), number in terms.items():
        exponents = [*rest[: len(constants)], *[0] * (len(constants) - len(rest))]
        power, value = power_of_gain * (functions.root or 1), number * functions.sign**power_of_gain
        for (each, factor, _), place, times, top in zip(functions.powers, places, others, most, strict=True):
            power += each * times
            value *= factor.numerator**times * factor.denominator ** (top - times)
            if place is not None:
                exponents[place] += times
        key = (s, power, tuple(exponents))
        moved[key] = moved.get(key, 0) + value
    least = min(power for _, power, _ in moved)
    return {(s, (power - least,), rest): value for (s, power, rest), value in moved.items() if value}


def _integer_terms(factor: GainPolynomial) -> Terms:
    """Return powers of s, K and constants with integer coefficients, scaled by what has no roots."""
    rational: dict[tuple[int, tuple[int, ...], tuple[int, ...]], Fraction] = {}
    for k, coefficient in factor.terms:
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

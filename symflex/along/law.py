"""Laws of waves whose coefficients vary along x, with numbers.

Input: a law over the ring of a bound transfer function, and what the ring's generators are.
Output: a :class:`BoundLaw`: the coefficients of ``z' = A(x, s) z`` as power series in x, in powers of u,
where u is s, its square, s less the middle of a ball, or ``s^2 + a s`` where what resists motion is ``a``
times what is moved all along x; and bounds on them.

    a clamped beam that tapers, E I (1 - x)^3 and rho A (1 - x):
    order 0 in u = s^2:   y' = theta, theta' = tau/(E I (1 - x)^3), tau' = -f
    order 1:              f' = rho A (1 - x) y
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property, partial
from math import gcd
from typing import Any

from flint import acb, acb_poly, acb_series, arb, arb_poly, arb_series

from symflex.algebra import FUNCTIONS, LAPLACE, Dispersion, Factored, by_powers, degree_in, evaluated, summed
from symflex.algebra.ring import PolynomialMemo, terms_of
from symflex.algebra.sparse import Monomial
from symflex.along.fundamental_matrix import PowerExpansion, expand
from symflex.along.growth import SingularCoefficientError, growth_along, legs_along
from symflex.along.system import Coefficients, Number, Place, RationalPart, SingularBeginning
from symflex.balls import Value, at_centre, ball, current_bits, precision, raised, series_terms
from symflex.errors import Diagnostic, ModelError
from symflex.expressions import Expression, fold
from symflex.model.along import COORDINATE
from symflex.model.linearity import integer_exponent

ELSEWHERE = acb(0.7, 1.3)  # a frequency like any other, at which coefficients have no pole in s
TINY = 2.0**-30
FEW_BITS = 30
LINEAR = 2  # powers of s less a pole's middle that are kept: the next ones give far less than its radius
LEAST = 2.0**-20  # relative radius on which an expansion is used at least, so that slopes are bounded
ROOM = 2.0  # how much wider than a ball of s it may be within the disc on which an expansion is used
Ends = tuple[arb, arb]
Along = Any  # a value along x: a real power series, or a complex ball. Their arithmetic is one


@dataclass(frozen=True, slots=True, eq=False)
class Summand:
    """A part of an entry of A: ``s^power * along / divisor``."""

    power: int
    divisor: Factored  # of s
    along: Factored  # of x


@dataclass(frozen=True, eq=False)
class PartedLaw:
    """A law whose coefficients are sums of products of a function of x and one of s."""

    law: Dispersion
    functions: Mapping[str, Expression]  # generators that are functions of x

    @cached_property
    def summands(self) -> Mapping[Place, tuple[Summand, ...]]:
        """The entries of A that are not zero, in parts; SF910 where s and x are divided by together."""
        rows = enumerate(self.law.matrix)
        return {(i, j): tuple(self._parted(x)) for i, row in rows for j, x in enumerate(row) if not x.is_zero}

    @cached_property
    def every(self) -> tuple[Summand, ...]:
        """All parts, in order."""
        return tuple(t for parts in self.summands.values() for t in parts)

    @cached_property
    def weights(self) -> tuple[int, ...] | None:
        """Powers of the divisor that scale states, so that A is a polynomial in ``u = s^step/divisor``."""
        if not self.divisors:
            return (0,) * self.law.order
        if len(self.divisors) > 1:
            return None
        # An entry of row i and column j is then times divisor^(w_j - w_i): that has to make it a power of u.
        apart = [(i, j, below - power) for i, j, power, below in self.places]
        by_state: dict[int, int] = {}
        for first in range(self.law.order):
            pending = [] if first in by_state else [(first, 0)]
            while pending:
                state, weight = pending.pop()
                if by_state.setdefault(state, weight) != weight:
                    return None
                more = [(j, weight + n) for i, j, n in apart if i == state]
                more += [(i, weight - n) for i, j, n in apart if j == state]
                pending += [(k, w) for k, w in more if by_state.get(k) != w]
        return tuple(by_state[i] for i in range(self.law.order))

    @cached_property
    def step(self) -> int:
        """How often s is a factor of u: what depends on its square alone has half the powers."""
        return gcd(*(t.power for t in self.every)) or 1

    @cached_property
    def divisors(self) -> tuple[Factored, ...]:
        """What parts are divided by, each once."""
        return tuple({str(t.divisor): t.divisor for t in self.every if not t.divisor.is_one}.values())

    @cached_property
    def places(self) -> tuple[tuple[int, ...], ...]:
        """Per part its row, its column, and its powers of ``s^step`` and of one over every divisor."""
        return tuple(
            (*place, t.power // self.step, *(int(str(t.divisor) == str(d)) for d in self.divisors))
            for place, parts in self.summands.items()
            for t in parts
        )

    def _parted(self, value: Factored) -> Iterator[Summand]:
        ring = value.ring
        moving = [ring.index[n] for n in (COORDINATE, *self.functions)]
        one = Factored.number(ring, 1)
        along, divisor, mixed = one * value.unit, one, one
        for factor, exponent in value.factors:
            piece = Factored(ring, Fraction(1), ((factor, exponent),))
            if not degree_in(factor, 0):
                along = along * piece
            elif exponent > 0:
                mixed = mixed * piece
            elif not any(degree_in(factor, i) for i in moving):
                divisor = divisor / piece
            else:
                message = "a coefficient with both s and x in a denominator is not available yet"
                hint = "use one damping time constant all along x, or divide the member where it changes"
                raise ModelError(Diagnostic("SF910", message, None, hint))
        for power, coefficient in by_powers(ring, mixed.expand()).items():
            yield Summand(power, divisor, along * Factored.polynomial(ring, coefficient))


@dataclass(frozen=True, eq=False)
class BoundLaw(PartedLaw):
    """A law at one length of a member. Values are enclosed at the current precision."""

    length: Factored
    constants: Mapping[str, Callable[[], arb]]  # generators free of s and x
    parameters: Mapping[str, Callable[[], arb]]  # what functions of x are made of
    orders: Mapping[Place, int] = field(default_factory=dict)  # powers of the way from the start in entries
    _growths: dict[int, float] = field(default_factory=dict, repr=False)  # at rest and about frequencies

    @cached_property
    def drag(self) -> Factored | None:
        """What a is in ``u = s^2 + a s``, where no other s occurs: two powers of s are then one of u."""
        ratios = []
        for parts in self.summands.values():
            moving = {t.power: t for t in parts if t.power}
            if moving and moving.keys() != {1, 2}:
                return None
            if moving:
                ratios.append(moving[1].along / moving[2].along)
        if not ratios or self.divisors or self.law.singular is not None:
            return None
        first, *others = ratios
        is_alike = all((other - first).is_zero for other in others)
        return None if not is_alike or any(map(first.depends_on, (COORDINATE, *self.functions))) else first

    @cached_property
    def degree(self) -> int:
        """The degree of u in s."""
        return self.step if self.drag is None else 2

    @cached_property
    def beginning(self) -> tuple[tuple[int, ...], BoundLaw, BoundLaw] | None:
        """About a singular start: the powers, and as laws B and the values there."""
        own = self.law.singular
        if own is None:
            return None
        plain = (replace(self.law, matrix=m, singular=None) for m in (own.matrix, own.values))
        matrix, values = (replace(self, law=law) for law in plain)
        orders = {(i, j): n for i, row in enumerate(own.orders) for j, n in enumerate(row) if n}
        return own.powers, replace(matrix, orders=orders), values

    def growth(self, largest: arb) -> float:
        """Return about by which power of e solutions grow along the member at most, for an abs(u)."""
        return growth_along(_InPowers(self, self.degree), largest)

    def growth_at(self, octave: int, parts: int) -> float:
        """Return the same for ``abs(s) = 2^(octave/parts)``."""
        if octave not in self._growths:
            size = arb(2.0 ** (octave / parts))
            near = _AboutMiddle(self, acb(0, size), 1)
            self._growths[octave] = (
                growth_along(near, arb(0))
                if self.weights is None
                else self.growth(abs(at_centre(self.rate(acb(0, size)))))
            )
        return self._growths[octave]

    def rate(self, s: Value) -> Value:
        """Return u, of which A is a polynomial once states are scaled by their weights."""
        if self.drag is not None:
            square: Value = s * (s + self.value(self.drag, {}))
            return square
        rate: Value = raised(s, self.step) * raised(self.divisor(s), -1)
        return rate

    def divisor(self, s: Value) -> Value:
        """Return what states are scaled by powers of."""
        divisor: Value = self.value(self.divisors[0], {}, s) if self.divisors else s * 0 + 1
        return divisor

    def expanded(self, largest: arb, bits: int) -> PowerExpansion:
        """Return the fundamental matrix in powers of u, for abs(u) up to the largest; else SF250."""
        try:
            with precision(bits):
                return expand(_InPowers(self, self.degree), largest, bits)
        except SingularCoefficientError as error:
            raise self._singular(error) from None

    def check(self) -> None:
        """Raise ModelError: SF250 where a coefficient is not analytic on the whole member."""
        try:
            legs_along(_InPowers(self, self.degree), arb(TINY), arb(TINY), FEW_BITS)
        except SingularCoefficientError as error:
            raise self._singular(error) from None

    def expanded_about(
        self, middle: acb, reach: arb, orders: int, within: Ends | None = None
    ) -> PowerExpansion | None:
        """Return the same in powers of s less a middle, up to a reach, maybe ``within``; None at a pole."""
        try:
            return expand(_AboutMiddle(self, middle, orders, within), reach, current_bits(), orders)
        except SingularCoefficientError as error:
            try:
                expand(_AboutMiddle(self, ELSEWHERE, 1), arb(TINY), FEW_BITS, 1)
            except SingularCoefficientError:
                raise self._singular(error) from None
            return None

    def _singular(self, error: SingularCoefficientError) -> ModelError:
        what, near = f"a coefficient of '{self.law.name}'", f"near x = {error.place:.6g} m"
        message, hint = f"{what} is not analytic {near}", "a stiffness vanishes, or a coefficient has a pole"
        hint += " or a branch point; end the member before it"
        if error.is_steep:
            message = f"{what} is too steep {near}"
            hint = "it changes many times over within a thousandth of the length: are units of rates right?"
        return ModelError(Diagnostic("SF250", message, self.law.span, hint))

    def growth_about(self, s: acb, within: Ends) -> float:
        """Return about by which power of e solutions grow between two places at ``s``."""
        return growth_along(_AboutMiddle(self, s.mid(), 1, within), arb(0))

    def matrix_at(self, s: acb, within: Ends) -> list[list[acb]]:
        """Return what takes states from one place to another, on a ball of s: of a pole, a small one."""
        middle, size = s.mid(), range(self.law.order)
        least = abs(middle).upper() * LEAST if middle != 0 else arb(LEAST)
        expansion = self.expanded_about(middle, max(least, (s.rad() * ROOM).upper()), LINEAR, within)
        if expansion is None:
            return [[acb("nan", "nan") for _ in size] for _ in size]
        return [[expansion.series((i,), (j,), s - middle)[0] for j in size] for i in size]

    def ends(self) -> Ends:
        """Return where x begins and ends."""
        (first,) = self.law.start
        start, length = (acb(self.value(x, {})).real for x in (first, self.length))
        return start, start + length

    def along(self, x: Along) -> dict[str, Along]:
        """Return the coordinate and the functions of it."""
        return {COORDINATE: x} | {name: self._function(each, x) for name, each in self.functions.items()}

    def _function(self, function: Expression, x: Along) -> Along:
        def number(value: arb) -> Along:
            return arb_series([value]) if isinstance(x, arb_series) else acb(value)

        def named(name: str) -> Along:
            if name == COORDINATE:
                return x
            return number(arb.pi() if name == "pi" else self.parameters[name]())

        def power(base: Along, exponent: Expression) -> Along:
            return raised(base, integer_exponent(exponent) or 0)

        return fold(
            function,
            number=lambda value: number(ball(value)),
            name=named,
            power=power,
            call=lambda inner, argument: _called(inner.name, argument),
        )

    def value(self, value: Factored, along: Mapping[str, Along], s: Value | None = None) -> Along:
        """Return a coefficient, given the coordinate and functions of it, and s where that occurs."""
        is_series = isinstance(along.get(COORDINATE), arb_series)
        one: Along = arb_series([1]) if is_series else acb(1)
        return evaluated(value, partial(self._number, along, s), one)

    def _number(self, along: Mapping[str, Along], s: Value | None, name: str) -> Along:
        known: Along = along.get(name, s if name == LAPLACE else None)
        return self.constants[name]() if known is None else known

    def rational_parts(
        self, x: arb, rates: Callable[[Summand], tuple[tuple[int, Number], ...]]
    ) -> list[RationalPart] | None:
        """Return the entries of A about a point, each part as a quotient of polynomials in x."""
        ring = self.law.matrix[0][0].ring
        if any(t.along.depends_on(name) for t in self.every for name in self.functions):
            return None
        place = ring.index[COORDINATE]
        degrees = [sum(degree_in(f, place) * e for f, e in t.along.factors if e > 0) for t in self.every]
        degrees += [degree_in(f, place) for t in self.every for f, e in t.along.factors if e < 0]
        with series_terms(1 + max(degrees, default=0)):
            along = self.along(arb_series([x, 1]))

            def polynomial(value: Factored) -> arb_poly:
                return arb_poly(self.value(value, along).coeffs())

            def parted(place: Place, part: Summand) -> RationalPart:
                factors = [(Factored.polynomial(ring, f), e) for f, e in part.along.factors]
                above = Factored.number(ring, part.along.unit)
                for factor, exponent in factors:
                    above = above * factor**exponent if exponent > 0 else above
                below = (polynomial(f) for f, e in factors for _ in range(-e))
                return RationalPart(place, polynomial(above), tuple(below), rates(part))

            every = [parted(place, t) for place, own in self.summands.items() for t in own]
        return [part for part in every if part.rates]

    def shifted(self, place: Place, coefficients: Sequence[arb], terms: int) -> arb_poly:
        """Return an entry's power series about the start, or anywhere where no power of the way is apart."""
        order = self.orders.get(place, 0)
        return arb_poly([*[arb(0)] * order, *coefficients][:terms])

    def far(self, place: Place, x: acb) -> arb:
        """Return a bound on the power of the way from the start by which an entry is multiplied."""
        order = self.orders.get(place, 0)
        return (x - self.ends()[0]).abs_upper() ** order if order else arb(1)

    def size(self, value: Factored, along: Mapping[str, Along], s: acb | None = None) -> arb:
        """Return a bound on a coefficient on balls: factor by factor, as powers of wide balls are wider."""
        total = abs(ball(value.unit))
        for factor, exponent in value.factors:
            number = partial(self._number, along, s)
            own: acb = summed(self._terms(factor), value.ring.names, number, acb(1))
            total *= (own.abs_upper() if exponent > 0 else own.abs_lower()) ** exponent
        return total

    @cached_property
    def _terms(self) -> PolynomialMemo[list[tuple[Monomial, int]]]:
        """The terms of the factors of coefficients, which are bounded on many balls."""
        return PolynomialMemo(terms_of)


@dataclass(frozen=True, eq=False)
class _InPowers:
    """A law in powers of u, that is s or its square, over a divisor where states are scaled by that."""

    law: BoundLaw
    step: int  # of powers of s; a part between two steps is in u by another one, see :attr:`BoundLaw.drag`

    @property
    def size(self) -> int:
        return self.law.law.order

    @property
    def beginning(self) -> SingularBeginning | None:
        if self.law.beginning is None:
            return None
        powers, *laws = self.law.beginning
        return SingularBeginning(powers, *(_InPowers(law, self.step) for law in laws))

    def ends(self) -> Ends:
        return self.law.ends()

    def series(self, x: arb, terms: int) -> list[Coefficients]:
        coefficients: list[Coefficients] = [{}]
        with series_terms(terms):
            along = self.law.along(arb_series([x, 1], terms))
            for place, parts in self.law.summands.items():
                for t in self._in_powers(parts):
                    order = t.power // self.step
                    coefficients += [{} for _ in range(order + 1 - len(coefficients))]
                    own = self.law.shifted(place, self.law.value(t.along, along).coeffs(), terms)
                    coefficients[order][place] = coefficients[order].get(place, arb_poly([])) + own
        return coefficients

    def parts(self, x: arb) -> list[RationalPart] | None:
        return self.law.rational_parts(
            x, lambda t: ((t.power // self.step, arb(1)),) if self._in_powers([t]) else ()
        )

    def bounds(self, x: acb, largest: arb) -> dict[Place, arb]:
        along = self.law.along(x)
        return {
            place: self.law.far(place, x)
            * sum(
                (
                    self.law.size(t.along, along) * largest ** (t.power // self.step)
                    for t in self._in_powers(parts)
                ),
                arb(0),
            )
            for place, parts in self.law.summands.items()
        }

    def _in_powers(self, parts: Sequence[Summand]) -> list[Summand]:
        return [t for t in parts if t.power % self.step == 0]


@dataclass(frozen=True, eq=False)
class _AboutMiddle:
    """A law in powers of u, that is s less a middle, of which so many are kept."""

    law: BoundLaw
    middle: acb
    orders: int
    within: Ends | None = None  # places other than the ends; at the start coefficients may have poles

    @property
    def size(self) -> int:
        return self.law.law.order

    @property
    def beginning(self) -> SingularBeginning | None:
        if self.law.beginning is None or self.ends()[0] != self.law.ends()[0]:
            return None
        powers, *laws = self.law.beginning
        return SingularBeginning(powers, *(_AboutMiddle(law, self.middle, self.orders) for law in laws))

    def ends(self) -> Ends:
        return self.law.ends() if self.within is None else self.within

    def series(self, x: arb, terms: int) -> list[Coefficients]:
        coefficients: list[Coefficients] = [{} for _ in range(self.orders)]
        with series_terms(terms):
            along = self.law.along(arb_series([x, 1], terms))
            parts = [
                (place, t, acb_poly(self.law.shifted(place, self.law.value(t.along, along).coeffs(), terms)))
                for place, own in self.law.summands.items()
                for t in own
            ]
        for place, t, coefficient in parts:
            for order, c in self._rates(t):
                coefficients[order][place] = coefficients[order].get(place, acb_poly([])) + coefficient * c
        return coefficients

    def parts(self, x: arb) -> list[RationalPart] | None:
        return self.law.rational_parts(x, self._rates)

    def _rates(self, part: Summand) -> tuple[tuple[int, acb], ...]:
        """Return the powers of u in what a part is multiplied by."""
        with series_terms(self.orders):
            s = acb_series([self.middle, 1], self.orders)
            rate: acb_series = raised(s, part.power) / self._divisor(part.divisor, s)
            return tuple(enumerate(rate.coeffs()))

    def bounds(self, x: acb, largest: arb) -> dict[Place, arb]:
        along, radius = self.law.along(x), arb(0, largest.abs_upper())
        s = self.middle + acb(radius, radius)
        return {
            place: self.law.far(place, x)
            * sum(
                (
                    self.law.size(t.along, along)
                    * s.abs_upper() ** t.power
                    * self.law.size(t.divisor**-1, along, s)
                    for t in parts
                ),
                arb(0),
            )
            for place, parts in self.law.summands.items()
        }

    def _divisor(self, value: Factored, s: acb_series) -> acb_series:
        total = acb_series([ball(value.unit)], self.orders)
        for factor, exponent in value.factors:
            own = acb_series([0], self.orders)
            for power, part in by_powers(value.ring, factor).items():
                own = own + raised(s, power) * self.law.value(Factored.polynomial(value.ring, part), {})
            total = total * raised(own, exponent)
        return total


def _called(name: str, x: Along) -> Along:
    """Return a function of a ball or series; not a number where it is not analytic on the ball."""
    if isinstance(x, acb):
        if name in ("sqrt", "log"):
            return x.sqrt(analytic=True) if name == "sqrt" else x.log(analytic=True)
    elif name in ("sinh", "cosh", "tanh"):
        grown, decayed = x.exp(), (-x).exp()
        odd, even = (grown - decayed) / 2, (grown + decayed) / 2
        return {"sinh": odd, "cosh": even}[name] if name != "tanh" else odd / even
    evaluate: Callable[[Along], Along] = FUNCTIONS[name].evaluate
    return evaluate(x)

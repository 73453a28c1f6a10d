"""What a gain enters by besides itself: roots, logarithms and other functions of it, on their domain.

Input: the functions of constants in a characteristic function that depend on the gain, and the values of the
other parameters. Output: enclosures of them for any gain, and all gains at which a polynomial in them
vanishes. Example: of ``(s + 1)^4 + K log(K)`` the product ``K log(K)`` is 4 at K = 3.32732 alone.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import frexp, lcm, prod

from flint import arb, arb_series, fmpz_mpoly

from symflex.algebra import terms_of
from symflex.balls import ball, precision
from symflex.errors import Diagnostic, UsageError
from symflex.expressions import Call, Expression, fold
from symflex.loops.axis import find_on_axis, pieces
from symflex.model import ExactValue
from symflex.roots import RealConstant
from symflex.transfer.enclose import constant_tangent, enclose, enclosure, first_order, later, rational_value

Limits = tuple[Fraction | None, Fraction | None]
NEAREST_ZERO = 70  # halvings of the range towards zero; what is left is looked at as one piece
EACH_RATIO = 3.7
MOST_FAILED = 8
NARROW_BITS = 20  # relative accuracy from which a part in which gains are undecided is not worth a word
MOST_INTERVALS = 4_000  # in each part of a range, so that none is short; others are undecided
ZERO = Fraction(0)
RANGE_OF_NOMINAL = 100  # times of the nominal gain examined if there may be boundaries without end
INSIDE = 16  # gains that are tried where the declared one is not in the range
SHORT = 10**6  # denominator of an end of the domain that is a short number
EDGE_BITS = 128
EDGE_STEPS = 1000  # precision of an end of the domain, and steps towards it
BEYOND = 1 + 1e-9  # how far a search goes beyond its end, which is a double


@dataclass(frozen=True, eq=False)
class GainFunctions:
    """Functions of one gain."""

    gain: str  # its name
    calls: Mapping[str, Call]  # generators, and what they stand for
    values: Mapping[str, ExactValue]  # of the other parameters
    nominal: Fraction | None

    def __bool__(self) -> bool:
        return bool(self.calls)

    @property
    def root(self) -> int | None:
        """The n for which all are powers of the n-th root of the gain, but for factors; None without one."""
        exponents = [exponent(call, self.gain) for call in self.calls.values()]
        known = [e.denominator for e in exponents if e is not None]
        return lcm(*known) if len(known) == len(exponents) else None

    @cached_property
    def powers(self) -> list[tuple[int, Fraction, RealConstant | None]]:
        """Powers of that root which the functions are: exponents, and two factors of what multiplies them."""
        powers: list[tuple[int, Fraction, RealConstant | None]] = []
        at_one = {**self.values, self.gain: ExactValue(Fraction(self.sign))}
        for generator, call in self.calls.items():
            power = int((exponent(call, self.gain) or ZERO) * (self.root or 1))
            root, square = rational_value(call, at_one), rational_value(call.argument, at_one)
            name = f"{generator} at {self.sign}" if square is None else f"{call.name}({square})"
            known = later(call, {name: enclosure(value) for name, value in at_one.items()})
            powers.append((power, root or Fraction(1), None if root else RealConstant(name, known)))
        return powers

    def at(self, gain: arb) -> list[arb_series]:
        """Return the gain and its functions to first order, at the current precision."""
        numbers = self._numbers(gain)
        return [
            numbers[self.gain],
            *(constant_tangent(c, numbers, is_real=True) for c in self.calls.values()),
        ]

    def _numbers(self, gain: arb) -> dict[str, arb_series]:
        numbers = {name: first_order(value()) for name, value in self._enclosed.items()}
        return {**numbers, self.gain: first_order(gain, 1)}

    @cached_property
    def _enclosed(self) -> Mapping[str, Callable[[], arb]]:
        return {name: enclosure(value) for name, value in self.values.items()}

    def value(self, polynomial: fmpz_mpoly, gain: arb, constants: Sequence[arb]) -> arb_series:
        """Return a polynomial in the gain, its functions and constants, whose first generator is left out."""
        places = [first_order(arb(0)), *self.at(gain), *(first_order(c) for c in constants)]
        return sum(
            (
                prod((places[i] ** e for i, e in m), start=first_order(arb(int(c))))
                for m, c in terms_of(polynomial)
            ),
            first_order(arb(0)),
        )

    def zeros(
        self, value: Callable[[arb], arb_series], limits: tuple[Fraction, Fraction], digits: int
    ) -> tuple[list[arb], list[arb]]:
        """Return the gains in a range at which a function vanishes, and narrow pieces that are undecided."""
        low, high = (float(x) for x in limits)
        reach = max(-low, high) * BEYOND
        first = 2.0 ** (frexp(reach)[1] - NEAREST_ZERO)
        zeros, undecided = [], []
        # Balls that end at 0 exactly, as what is raised to a fraction there is not real beyond it.
        for sign in (1, -1) if low < first and high > -first else ():
            about = arb(sign * first / 2, first / 2)
            with precision(EDGE_BITS):
                if (high > 0 if sign > 0 else low < 0) and not value(about)[0] != 0:
                    undecided.append(about)
        for sign, start, end in ((1, max(low, first), high), (-1, max(-high, first), -low)):

            def on(gain: arb, bits: int, sign: int = sign) -> tuple[arb_series, arb_series]:
                with precision(bits):
                    return value(sign * gain), value(sign * gain.mid())

            def equation(place: arb_series, sign: int = sign) -> tuple[arb, arb]:
                return place[0], sign * place[1]

            failed = 0
            for ends in reversed(pieces(start, end * BEYOND, EACH_RATIO)) if start < end else ():
                if failed == MOST_FAILED:  # all that is next to zero
                    undecided.append(sign * arb(start).union(arb(ends[1])))
                    break
                roots = find_on_axis(on, equation, lambda _: False, ends, digits, MOST_INTERVALS)
                zeros += [sign * root for root in roots.roots]
                undecided += [sign * piece for piece in roots.undecided]
                failed += any(piece.rel_accuracy_bits() < NARROW_BITS for piece in roots.undecided)
        return zeros, undecided

    @property
    def sign(self) -> int:
        """Sign of the nominal gain."""
        return -1 if self.nominal is not None and self.nominal < 0 else 1

    def domain(self, limits: Limits, *, is_endless: bool) -> Limits:
        """Return the part of a range about the nominal gain where functions are real; else SF804, SF228."""
        low, high = limits
        if is_endless and self.root is not None:
            if self.sign > 0:
                return max(low or ZERO, ZERO), high
            return low, min(high or ZERO, ZERO)
        if (low is None or high is None) and not self.nominal:
            message = f"a loop that depends on functions of '{self.gain}' needs a bounded range of it"
            hint = "give the parameter a value, or say --range LO HI"
            raise UsageError(Diagnostic("SF804", message, None, hint))
        reach = abs(self.nominal or ZERO) * RANGE_OF_NOMINAL
        start: Fraction = -reach if low is None else low
        end: Fraction = reach if high is None else high
        gains = [start + Fraction(n, INSIDE) * (end - start) for n in range(1, INSIDE)]
        for gain in [self.nominal] if self.nominal and start < self.nominal < end else gains:
            if self._is_real(ball(gain)):
                return self._edge(gain, start), self._edge(gain, end)
        for call in self.calls.values():
            enclose(call, {**self._enclosed, self.gain: lambda: ball(self.nominal or start)})
        message = f"no value of '{self.gain}' was found in the range for which the model has real values"
        raise UsageError(Diagnostic("SF804", message, None, "say --range LO HI"))

    def _is_real(self, gains: arb) -> bool:
        return all(x[0].is_finite() and x[1].is_finite() for x in self.at(gains))

    def _edge(self, inside: Fraction, end: Fraction) -> Fraction:
        """Return how far from a gain functions are real: to an end, a short number next to it, or another."""
        with precision(EDGE_BITS):
            step = end - inside
            for _ in range(EDGE_STEPS):
                if self._is_real(ball(inside).union(ball(inside + step))):
                    inside += step
                else:
                    step /= 2
                if inside == end or abs(step) < abs(end - inside) / 2**EDGE_BITS:
                    break
        short = inside.limit_denominator(SHORT)
        return short if abs(short - inside) <= 4 * abs(step) else inside


def exponent(expression: Expression, gain: str) -> Fraction | None:
    """Return the power of a gain that an expression is, but for a factor; ``None`` of anything else.

    >>> from symflex.expressions import Name, Product
    >>> exponent(Call("sqrt", Product((Name("m"), Name("K")))), "K")
    Fraction(1, 2)
    """

    def scaled(base: Fraction | None, power: Expression) -> Fraction | None:
        times = rational_value(power, {})
        return None if times is None or base is None else base * times

    def called(call: Call, argument: Fraction | None) -> Fraction | None:
        if call.name == "sqrt" and argument is not None:
            return argument / 2
        return argument if argument == 0 else None

    def product(factors: Sequence[Fraction | None]) -> Fraction | None:
        known = [e for e in factors if e is not None]
        return sum(known, Fraction(0)) if len(known) == len(factors) else None

    power: Fraction | None = fold(
        expression,
        number=lambda _: Fraction(0),
        name=lambda name: Fraction(int(name == gain)),
        power=scaled,
        call=called,
        negative=lambda e: e,
        total=lambda terms: terms[0] if len({*terms}) == 1 else None,
        product=product,
        quotient=lambda a, b: None if a is None or b is None else a - b,
    )
    return power

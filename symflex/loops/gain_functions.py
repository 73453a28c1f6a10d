"""What a gain enters by besides itself: roots, logarithms and other functions of it, on their domain.

Input: the functions of constants in a characteristic function that depend on the gain, and the values of the
other parameters. Output: enclosures of them for any gain, and all gains at which a polynomial in them
vanishes. Example: of ``(s + 1)^4 + K log(K)`` the product ``K log(K)`` is 4 at K = 3.32732 alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import frexp, isqrt, lcm
from typing import TYPE_CHECKING

from flint import arb, arb_series

from symflex.algebra import terms_of
from symflex.balls import ball, precision
from symflex.errors import Diagnostic, UsageError
from symflex.expressions import Call, Power, Quotient, fold, nodes
from symflex.loops.axis import find_on_axis
from symflex.model import ExactValue
from symflex.roots import RealConstant
from symflex.roots.root import exact_fraction
from symflex.transfer.enclose import constant_tangent, enclose, enclosure, first_order, later, rational_value

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from flint import fmpz_mpoly

    from symflex.expressions import Expression

Limits = tuple[Fraction | None, Fraction | None]
NEAREST_ZERO = 40
"""Halvings of the range towards zero; what is left is looked at as one piece."""
ZERO = Fraction(0)
RANGE_OF_NOMINAL = 100
"""How many times the nominal gain is examined where there may be boundaries without end."""
INSIDE = 16
"""Gains that are tried where the declared one is not in the range."""
SHORT = 10**6
"""Denominator of an end of the domain that is a short number."""
EDGE_BITS = 128
EDGE_DIGITS = 30
"""Precision of an end of the domain."""
BEYOND = 1 + 1e-9
"""How far a search goes beyond its end, which is a double."""


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
            square = rational_value(call.argument, at_one) if call.name == "sqrt" else None
            is_real = square is not None and square > 0
            whole = (
                Fraction(isqrt(square.numerator), isqrt(square.denominator)) if square and is_real else ZERO
            )
            if whole and whole**2 == square:
                powers.append((power, whole, None))
            else:
                values = {name: enclosure(value) for name, value in at_one.items()}
                name = f"{generator} at {self.sign}" if square is None else f"sqrt({square})"
                powers.append((power, Fraction(1), RealConstant(name, later(call, values))))
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
        places = [*self.at(gain), *(first_order(c) for c in constants)]
        logs = self._logs_at_zero(gain) if gain.contains(0) else {}
        total = first_order(arb(0))
        for monomial, coefficient in terms_of(polynomial):
            term, powers = first_order(arb(int(coefficient))), dict(monomial)
            rates = sum(e * logs[i] for i, e in powers.items() if i in logs)
            if rates and powers.get(1, 0) >= rates:
                # K^a log(K)^b is smallest next to zero, where it vanishes.
                last = [places[0][0].upper(), *(x[0] for x in self.at(gain.upper())[1:])]
                size = arb(1)
                for i in (1, *logs):
                    size = size * abs(last[i - 1]) ** powers.pop(i, 0)
                term = term * first_order(arb(0, size.upper()), arb("nan"))
            for i, e in powers.items():
                term = term * places[i - 1] ** e
            total = total + term
        return total

    def _logs_at_zero(self, gain: arb) -> dict[int, arb]:
        """Return ``abs(n/log)`` at a small gain of logarithms of its n-th power, by their position."""
        end = self.at(gain.upper())
        logs = {}
        for i, call in enumerate(self.calls.values(), 1):
            power = exponent(call.argument, self.gain) if call.name == "log" else None
            if power and end[i][0] * ball(power) < 0 and gain.mid() > 0:
                logs[i + 1] = abs(ball(power) / end[i][0])
        return logs

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
            if start < end:
                on, ends = _Gains(value, sign), (start, end * BEYOND)
                roots = find_on_axis(on, lambda pair: pair, lambda _: False, ends, digits)
                zeros += [sign * root for root in roots.roots]
                undecided += [sign * piece for piece in roots.undecided]
        return zeros, undecided

    @property
    def sign(self) -> int:
        """Sign of the gain's own value."""
        return -1 if self.nominal is not None and self.nominal < 0 else 1

    def domain(self, limits: Limits, *, is_endless: bool) -> Limits:
        """Return the part of a range about the gain's own value in which all functions are real.

        It goes to 100 times that value by default; of powers alone it may be endless. SF804 where there is no
        value, SF228 where it is not inside.
        """
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
        inside = self._inside(start, end)
        for condition in self._conditions():
            if exponent(condition, self.gain) is not None:
                start, end = (max(start, ZERO), end) if inside > 0 else (start, min(end, ZERO))
                continue

            def value(gain: arb, condition: Expression = condition) -> arb_series:
                return constant_tangent(condition, self._numbers(gain), is_real=True)

            zeros, undecided = self.zeros(value, (start, end), EDGE_DIGITS)
            for edge in (*zeros, *undecided):
                if ball(inside) > edge:
                    start = max(start, self._edge(condition, edge, edge.upper()))
                elif ball(inside) < edge:
                    end = min(end, self._edge(condition, edge, edge.lower()))
        return start, end

    def _inside(self, low: Fraction, high: Fraction) -> Fraction:
        """Return a gain for which all functions are real, the declared one if that is in the range."""
        shares = (Fraction(n, INSIDE) for n in range(1, INSIDE))
        for gain in ([self.nominal] if self.nominal and low < self.nominal < high else []) or [
            low + share * (high - low) for share in shares
        ]:
            if all(x[0].is_finite() for x in self.at(ball(gain))):
                return gain
        for call in self.calls.values():
            enclose(call, {**self._enclosed, self.gain: lambda: ball(self.nominal or low)})
        message = f"no value of '{self.gain}' was found in the range for which the model has real values"
        raise UsageError(Diagnostic("SF804", message, None, "say --range LO HI"))

    def _conditions(self) -> list[Expression]:
        """Return what may not vanish in the functions, inner ones first."""
        conditions: list[Expression] = []
        for call in self.calls.values():
            for node in reversed(nodes(call)):
                below: Expression | None = None
                if isinstance(node, Call) and node.name in ("sqrt", "log", "tan"):
                    below = Call("cos", node.argument) if node.name == "tan" else node.argument
                elif isinstance(node, Quotient):
                    below = node.denominator
                elif isinstance(node, Power) and (rational_value(node.exponent, {}) or 0) < 0:
                    below = node.base
                if below is not None and below not in conditions and exponent(below, self.gain) != 0:
                    conditions.append(below)
        return conditions

    def _edge(self, condition: Expression, edge: arb, within: arb) -> Fraction:
        """Return an end of the domain: exactly where that is a short number, else one just within."""
        short = exact_fraction(edge).limit_denominator(SHORT)
        try:
            is_exact = rational_value(condition, {**self.values, self.gain: ExactValue(short)}) == 0
        except KeyError:
            is_exact = False
        return short if is_exact else exact_fraction(within)


def exponent(expression: Expression, gain: str) -> Fraction | None:
    """Return the power of a gain that an expression is, but for a factor; ``None`` of anything else.

    Examples
    --------
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


@dataclass(frozen=True)
class _Gains:
    """A function of the gain, or of its negative, for a search of one dimension."""

    value: Callable[[arb], arb_series]
    sign: int

    def on(self, gain: arb, bits: int) -> tuple[tuple[arb, arb], tuple[arb, arb]]:
        """Return value and slope on a ball, and in its middle."""
        with precision(bits):
            around, centre = (self.value(self.sign * x) for x in (gain, gain.mid()))
            return (around[0], self.sign * around[1]), (centre[0], self.sign * centre[1])

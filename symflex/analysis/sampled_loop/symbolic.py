"""A pulse function as an expression: numbers where all is known, the period and the delay as letters.

Input: a bound transfer function, and the times of ``[sampled]``. Output: an expression in ``b``, one sample
back, and in names of real constants, with what encloses these.

    1/(s + a), period T    P = (1 - q) b/(a (1 - q b)), q = exp(-a T)

Over a range of the period the poles of the continuous part stay, and what they are at samples is a function
of T that has a derivative. The step response is a sum of ``c_j t^j/j! exp(p t)``, and

    sum k^j x^k = A_j(x)/(1 - x)^(j + 1) with Eulerian polynomials, x, x + x^2, x + 4 x^2 + x^3
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial
from math import ceil, factorial

from flint import acb, arb

from symflex.analysis.sampled_loop.pulse import Pulse, StepResponse, step_response
from symflex.errors import Diagnostic, ModelError, UncertifiedError, UsageError
from symflex.expressions import (
    Call,
    Expression,
    Name,
    Negative,
    Quotient,
    Sum,
    is_number,
    negative,
    number,
    power,
    product_of,
    sum_of,
)
from symflex.model import ExactValue
from symflex.transfer import BoundTransferFunction
from symflex.transfer.enclose import rational_value

BACK = "one sample back"  # the name of exp(-s*T): no name of a specification has blanks
EULERIAN = ((1,), (0, 1), (0, 1, 1), (0, 1, 4, 1), (0, 1, 11, 11, 1))
Ends = tuple[Fraction, Fraction]
Fixed = tuple[tuple[str, Callable[[], arb]], ...]
B = Name(BACK)


@dataclass(frozen=True)
class Timing:
    """The period and the delay of a controller, some of whose parameters lie in ranges."""

    period: Expression  # [s]
    delay: Expression  # [s]
    values: Mapping[str, ExactValue]
    ranges: Mapping[str, Ends]

    def at(self, expression: Expression, share: Fraction) -> Fraction:
        """Return a time where all ranges are passed by a share."""
        inside = {n: ExactValue(low + share * (high - low)) for n, (low, high) in self.ranges.items()}
        value = rational_value(expression, {**self.values, **inside})
        if value is None:
            message = "a time of [sampled] is no rational number"
            raise ModelError(Diagnostic("SF260", message, expression.span, 'write it as a time: "1 ms"'))
        return value

    def samples(self, late: Fraction) -> int:
        """Return by how many samples the output is late, counted in whole ones; SF804 if that changes."""
        shares = (Fraction(0), Fraction(1, 2), Fraction(1))
        periods, delays = ([self.at(e, x) for x in shares] for e in (self.period, self.delay))
        if not periods[0] > 0 and periods[1] > 0:  # an open end of the range
            periods[0] = periods[1] / 2**20
        counts = {ceil((d + late) / p) for p, d in zip(periods, delays, strict=True)}
        whole = [(d + late) / p for p, d in zip(periods, delays, strict=True)]
        if len(counts) > 1 and len(set(whole)) > 1:
            message = "within the range the delay passes a whole number of samples"
            hint = "ask for parts of the range, or give the delay as a share of the period: delay = '0.2*T'"
            raise UsageError(Diagnostic("SF804", message, self.delay.span, hint))
        return counts.pop()


@dataclass
class _Constants:
    """Real numbers that expressions call by names."""

    known: list[tuple[str, Callable[[], arb]]] = field(default_factory=list)

    def name(self, evaluate: Callable[[], arb]) -> Expression:
        """Return a new name of a number."""
        name = f"number {len(self.known)} of the continuous part"
        self.known.append((name, evaluate))
        return Name(name)


def pulse_of(pulse: Pulse) -> tuple[Expression, Fixed]:
    """Return a pulse function whose coefficients are numbers."""
    found, constants = pulse.at(), _Constants()

    def side(which: str, first: int) -> Expression:
        terms: list[Expression] = [number(1)] if first else []
        for j in range(first, len(getattr(found, which))):
            if which == "below" or j not in pulse.zeros:
                name = constants.name(partial(_coefficient, pulse, which, j))
                terms.append(product_of([name, power(B, number(j))]))
        return sum_of(terms)

    above, below = side("above", 0), side("below", 1)
    return Quotient(above, product_of([power_of_ahead(found.at_one), below])), tuple(constants.known)


def _coefficient(pulse: Pulse, which: str, j: int) -> arb:
    side: tuple[arb, ...] = getattr(pulse.at(), which)
    return side[j] if j < len(side) else arb(0)


def power_of_ahead(exponent: int) -> Expression:
    """Return a power of ``1 - b``."""
    return power(Sum((number(1), Negative(B))), number(exponent))


def pulse_over(bound: BoundTransferFunction, timing: Timing) -> tuple[Expression, Fixed]:
    """Return a pulse function in symbols of its times; SF804, SF810 where it has no such form."""
    constants, responses = _Constants(), step_response(bound)
    total: list[Expression] = []
    for part, late in enumerate(responses.delays):
        samples = timing.samples(late)
        ahead = sum_of([
            product_of([number(samples), timing.period]), negative(timing.delay), negative(number(late))
        ])  # fmt: skip
        for mode, (rate, count) in enumerate(responses.modes):
            total.append(
                product_of([
                    power(B, number(samples)),
                    _Mode(responses, part, mode, rate, count, constants).summed(timing.period, ahead),
                ])
            )  # fmt: skip
    return sum_of(total), tuple(constants.known)


@dataclass(frozen=True)
class _Mode:
    """What one pole of the continuous part, or a conjugate pair, adds to a pulse function."""

    responses: StepResponse
    part: int
    mode: int
    rate: acb  # about
    count: int  # of coefficients
    constants: _Constants

    def summed(self, period: Expression, ahead: Expression) -> Expression:
        """Return ``(1 - b) sum h(k T + ahead) b^k``."""
        if self.rate == 0:
            return self._real(period, ahead, None)
        if self.rate.imag == 0:
            return self._real(period, ahead, self._named(lambda rate, _: rate.real))
        if self.count > 1:
            message = "two equal pairs of complex poles cannot be followed over the period"
            raise UncertifiedError(Diagnostic("SF810", message, None, "ask at each value: --set T=VALUE"))
        return self._pair(period, ahead)

    def _named(self, of: Callable[[acb, Sequence[acb]], arb]) -> Expression:
        part, mode = self.part, self.mode
        return self.constants.name(lambda: of(*self.responses.at(part, mode)))

    def _real(self, period: Expression, ahead: Expression, rate: Expression | None) -> Expression:
        growing = number(1) if rate is None else Call("exp", product_of([rate, period]))
        begun = number(1) if rate is None or is_number(ahead, 0) else Call("exp", product_of([rate, ahead]))
        coefficients = [self._named(partial(_real_part, j)) for j in range(self.count)]
        x = product_of([growing, B])
        terms = []
        for i in range(self.count):
            shifted = sum_of([
                Quotient(product_of([coefficients[j], power(ahead, number(j - i))]), number(factorial(j - i)))
                for j in range(i, self.count)
            ])  # fmt: skip
            eulerian = sum_of(
                [product_of([number(c), power(x, number(n))]) for n, c in enumerate(EULERIAN[i]) if c]
            )
            above = product_of([begun, shifted, power(period, number(i)), eulerian])
            ahead_of = Sum((number(1), Negative(x)))
            below = power_of_ahead(i) if rate is None else power(ahead_of, number(i + 1))
            term: Expression = Quotient(above, product_of([number(factorial(i)), below]))
            terms.append(term if rate is None else product_of([power_of_ahead(1), term]))
        return sum_of(terms)

    def _pair(self, period: Expression, ahead: Expression) -> Expression:
        decay = self._named(lambda rate, _: rate.real)
        omega = self._named(lambda rate, _: rate.imag)
        x, y = (self._named(partial(_part_of, side)) for side in ("real", "imag"))

        def turned(time: Expression) -> tuple[Expression, Expression, Expression]:
            angle = product_of([omega, time])
            return Call("exp", product_of([decay, time])), Call("cos", angle), Call("sin", angle)

        # c exp(p ahead) = u + j v, and q = exp(p T): Re sum c' q^k b^k = (u - Re(c' conj q) b)/|1 - q b|^2
        begun, cos_a, sin_a = turned(ahead)
        u = product_of([begun, Sum((product_of([x, cos_a]), negative(product_of([y, sin_a]))))])
        v = product_of([begun, Sum((product_of([x, sin_a]), product_of([y, cos_a])))])
        grown, cos_t, sin_t = turned(period)
        crossed = product_of([grown, Sum((product_of([u, cos_t]), product_of([v, sin_t])))])
        above = Sum((u, negative(product_of([crossed, B]))))
        middle = product_of([number(2), grown, cos_t, B])
        below = Sum((number(1), negative(middle), product_of([power(grown, number(2)), power(B, number(2))])))
        return Quotient(product_of([power_of_ahead(1), above]), below)


def _real_part(j: int, rate: acb, coefficients: Sequence[acb]) -> arb:
    del rate
    return coefficients[j].real


def _part_of(side: str, rate: acb, coefficients: Sequence[acb]) -> arb:
    del rate
    part: arb = getattr(coefficients[0], side)
    return part

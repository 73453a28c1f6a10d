"""The pulse function of a continuous machine whose parameters lie in ranges, to first order in each.

Input: a rational transfer function in s and in such parameters, the period and the delay of the controller.
Output: a :class:`PlantPulse`, a quotient of polynomials in ``b = 1/z`` whose coefficients are enclosed for
all values in a box, with their slopes.

    x' = A x + B u, y = C x + d u; M = T (A B; 0 0)    step response at t = k T: (C d) exp(k M) (0; 1)
    denominator det(1 - b exp(A T)), numerator from as many values of the step response

The exponential of ``(M M'; 0 M)`` has that of M and its derivative as blocks (Van Loan 1978). A power of s
that divides the denominator is one of 1 - b, exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property, partial

from flint import acb, acb_series, arb, arb_mat, fmpz_mpoly

from symflex.algebra import LAPLACE
from symflex.algebra.ring import Ring
from symflex.analysis.sampled_loop.symbolic import B, power_of_ahead
from symflex.balls import current_bits
from symflex.balls.values import Arithmetic
from symflex.errors import Diagnostic, ModelError
from symflex.expressions import Expression, Name, Quotient, number, power, product_of, sum_of
from symflex.loops.boxes import Box, CharacteristicFunction, enclosed
from symflex.model import ExactValue
from symflex.transfer.enclose import constant_tangent, enclosure, first_order

Pair = tuple[arb, arb]  # a value and its slope
Matrices = tuple[arb_mat, arb_mat]


@dataclass(frozen=True, eq=False)
class PlantPulse:
    """``sum(above[j] b^j) / ((1 - b)^at_one * sum(below[j] b^j))`` for all values of parameters in a box."""

    machine: CharacteristicFunction  # of the transfer function from held outputs to samples
    period: Expression  # [s]
    delay: Expression  # from a sample to the output that follows from it [s]
    samples: int  # by how many samples the output is late, counted in whole ones
    is_whole: bool  # it is late by whole samples
    numbers: Mapping[str, ExactValue]  # the other parameters of these times

    @cached_property
    def _parts(self) -> tuple[list[fmpz_mpoly], list[fmpz_mpoly], int]:
        """Coefficients of numerator and denominator by powers of s, and how many of the lowest are 0 below.

        ModelError: SF236 where the function grows with s.
        """
        ratio = self.machine.tf.ratio
        sides = ratio.numerator().expand(), ratio.denominator().expand()
        above, below = (ratio.ring.coefficients(f, ratio.ring.index[LAPLACE]) for f in sides)
        if len(above) > len(below):
            message = "what a sampled block sees grows with the frequency of what it holds"
            hint = "let it see a position in place of an acceleration, or put a low-pass in front of it"
            raise ModelError(Diagnostic("SF236", message, self.machine.tf.output.span, hint))
        at_one = next(i for i, f in enumerate(below) if not f.is_zero())
        return above, below, at_one

    @cached_property
    def _by_name(self) -> dict[str, tuple[int, int]]:
        """Which side a coefficient is on, and beside which power of b, by its name."""
        last = (self.samples + self.order, self.order - self.at_one)
        places = [(0, j) for j in range(last[0] + 1) if j not in self.zeros]
        places += [(1, j) for j in range(1, last[1] + 1)]
        return {f"number {i} of the continuous part": place for i, place in enumerate(places)}

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the coefficients."""
        return tuple(self._by_name)

    @property
    def expression(self) -> Expression:
        """The function with names in place of its coefficients."""
        sides: tuple[list[Expression], list[Expression]] = ([], [number(1)])
        for name, (side, j) in self._by_name.items():
            sides[side].append(product_of([Name(name), power(B, number(j))]))
        above, below = map(sum_of, sides)
        return Quotient(above, product_of([power_of_ahead(self.at_one), below]))

    def named(self, box: Box, along: str = "") -> dict[str, Pair]:
        """Return the coefficients by their names, with their slopes in one parameter."""
        sides = self.at(box, along)
        return {name: sides[side][j] for name, (side, j) in self._by_name.items()}

    def fixed(self, box: Box) -> tuple[tuple[str, Callable[[], arb]], ...]:
        """Return what encloses each coefficient at the precision of the time it is called."""

        @cache
        def at(_: int) -> dict[str, Pair]:
            return self.named(box)

        def coefficient(name: str) -> arb:
            return at(current_bits())[name][0]

        return tuple((name, partial(coefficient, name)) for name in self.names)

    def _time(self, expression: Expression, box: Box, along: str) -> Pair:
        """Return a time of the controller to first order."""
        known = {n: enclosure(x) for n, x in self.numbers.items() if not x.is_imaginary}
        known |= {n: enclosed(ends) for n, ends in zip(self.machine.names, box, strict=True)}
        series = constant_tangent(
            expression, {n: first_order(x(), int(n == along)) for n, x in known.items()}
        )
        return series[0], series[1]

    @property
    def order(self) -> int:
        """How many poles the machine has."""
        return len(self._parts[1]) - 1

    @property
    def at_one(self) -> int:
        """How many of them are at s = 0."""
        return self._parts[2]

    @property
    def zeros(self) -> frozenset[int]:
        """Numbers of coefficients of the numerator that are exactly 0."""
        above, below, _ = self._parts
        return frozenset(range(self.samples + (self.is_whole and len(above) < len(below))))

    def at(self, box: Box, along: str = "") -> tuple[list[Pair], list[Pair]]:
        """Return the coefficients above and below, each with its slope in one parameter."""
        above, below, at_one = self._parts
        n, ring = self.order, self.machine.tf.ratio.ring
        values = self.machine.kernels(self.machine.tf, box, along).constants
        given = {name: _pair(value) for name, value in values.items()}
        period, delay = (self._time(each, box, along) for each in (self.period, self.delay))
        num, den = ([_value(ring, f, given) for f in side] for side in (above, below))
        lead = den[-1]
        if lead[0].contains(0):
            return _unknown(n + 1 + self.samples + 1), _unknown(n - at_one + 1)
        # In the time of one period s is s T, so that entries are near one.
        scale = [_power(period, n - i) for i in range(n + 1)]
        a = [_product(_over(d, lead), x) for d, x in zip(den, scale, strict=True)]
        b = [_product(_over(c, lead), x) for c, x in zip(num, scale, strict=False)]
        b += [_ZERO] * (n + 1 - len(b))
        through = b[n]
        c = [_minus(b[i], _product(through, a[i])) for i in range(n)]
        step = _companion(a[:n], has_input=True)
        one = _exponential(step, _ONE)
        ahead = _ZERO if self.is_whole else _minus((arb(self.samples), arb(0)), _over(delay, period))
        state = _exponential(step, ahead)
        steps = []
        for _ in range(n + 1):
            column = [(state[0][i, n], state[1][i, n]) for i in range(n)]
            steps.append(_sum([through, *map(_product, c, column)]))
            state = _times(one, state)
        if self.is_whole and len(above) < len(below):
            steps[0] = _ZERO
        alone = _exponential(_companion(a[at_one:n], has_input=False), _ONE)
        turned = _characteristic(alone)
        whole = turned
        for _ in range(at_one + 1):
            whole = [_minus(x, y) for x, y in zip([*whole, _ZERO], [_ZERO, *whole], strict=True)]
        product = [_sum([_product(whole[i], steps[j - i]) for i in range(j + 1)]) for j in range(n + 1)]
        return [_ZERO] * self.samples + product, turned


_ZERO: Pair = (arb(0), arb(0))
_ONE: Pair = (arb(1), arb(0))


def _unknown(count: int) -> list[Pair]:
    return [(arb(0, float("inf")), arb(0, float("inf")))] * count


def _pair(value: Arithmetic) -> Pair:
    """Return a real constant and its slope."""
    if isinstance(value, acb_series):
        return value[0].real, value[1].real
    return acb(value).real, arb(0)


def _value(ring: Ring, polynomial: fmpz_mpoly, given: dict[str, Pair]) -> Pair:
    """Return a polynomial in parameters to first order."""
    terms = []
    for monomial, coefficient in zip(polynomial.monoms(), polynomial.coeffs(), strict=True):
        term: Pair = (arb(coefficient), arb(0))
        for i, exponent in enumerate(monomial):
            if exponent:
                term = _product(term, _power(given[ring.names[i]], int(exponent)))
        terms.append(term)
    return _sum(terms)


def _sum(pairs: Sequence[Pair]) -> Pair:
    return sum((x for x, _ in pairs), arb(0)), sum((y for _, y in pairs), arb(0))


def _minus(one: Pair, two: Pair) -> Pair:
    return one[0] - two[0], one[1] - two[1]


def _product(one: Pair, two: Pair) -> Pair:
    return one[0] * two[0], one[0] * two[1] + one[1] * two[0]


def _scaled(one: Pair, by: arb) -> Pair:
    return one[0] * by, one[1] * by


def _power(one: Pair, exponent: int) -> Pair:
    if not exponent:
        return arb(1), arb(0)
    return one[0] ** exponent, exponent * one[0] ** (exponent - 1) * one[1]


def _over(one: Pair, two: Pair) -> Pair:
    quotient = one[0] / two[0]
    return quotient, (one[1] - quotient * two[1]) / two[0]


def _companion(a: Sequence[Pair], *, has_input: bool) -> Matrices:
    """Return the companion matrix of ``s^n + a[n-1] s^(n-1) + ...``, with the column of the input."""
    n = len(a)
    size = n + has_input
    value, slope = arb_mat(size, size), arb_mat(size, size)
    for i in range(n - 1):
        value[i, i + 1] = arb(1)
    for i in range(n):
        value[n - 1, i], slope[n - 1, i] = -a[i][0], -a[i][1]
    if has_input and n:
        value[n - 1, n] = arb(1)
    return value, slope


def _exponential(matrix: Matrices, time: Pair) -> Matrices:
    """Return the exponential of a matrix times a number, and its slope."""
    value, slope = matrix
    n = value.nrows()
    if not n:
        return value, slope
    both = arb_mat(2 * n, 2 * n)
    for i in range(n):
        for j in range(n):
            both[i, j], both[i, n + j] = _product((value[i, j], slope[i, j]), time)
            both[n + i, n + j] = both[i, j]
    grown = both.exp()
    parts = [arb_mat([[grown[i, shift + j] for j in range(n)] for i in range(n)]) for shift in (0, n)]
    return parts[0], parts[1]


def _times(one: Matrices, two: Matrices) -> Matrices:
    return one[0] * two[0], one[0] * two[1] + one[1] * two[0]


def _characteristic(matrix: Matrices) -> list[Pair]:
    """Return ``det(1 - b M)`` by powers of b (Faddeev and LeVerrier 1840)."""
    n = matrix[0].nrows()
    coefficients: list[Pair] = [_ONE]
    power: Matrices = (arb_mat(n, n), arb_mat(n, n))
    for k in range(1, n + 1):
        value, slope = power
        for i in range(n):
            value[i, i] += coefficients[-1][0]
            slope[i, i] += coefficients[-1][1]
        power = _times(matrix, (value, slope))
        trace = _sum([(power[0][i, i], power[1][i, i]) for i in range(n)])
        coefficients.append(_scaled(trace, arb(-1) / k))
    return coefficients

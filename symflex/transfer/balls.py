"""Values in balls: of expressions of constants, of sparse polynomials, and to double precision.

Polynomials are prepared for evaluation: products shared by successive terms are made once.
"""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from math import inf, isfinite, nan, prod
from typing import TYPE_CHECKING, Any, TypeVar

from flint import acb, acb_series, arb, ctx, fmpq

from symflex.algebra import FUNCTIONS, terms_of
from symflex.errors import Diagnostic, ModelError
from symflex.expressions import Call, Expression, Number, fold, format_expression, names
from symflex.quantities import IMAGINARY_UNIT

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from flint import fmpz_mpoly

    from symflex.algebra import Factored
    from symflex.algebra.sparse import Monomial
    from symflex.expressions import Call
    from symflex.model import ExactValue

    Ball = Callable[[acb], acb]


Numeral = TypeVar("Numeral", Fraction, arb)


def ball(value: Fraction) -> arb:
    """Return a rational number as a ball at the current precision."""
    return arb(fmpq(value.numerator, value.denominator))


def expansion(s: acb) -> acb_series:
    """Return ``s + x`` to first order in x."""
    return acb_series([s, acb(1)], 2)


@contextmanager
def series_terms(count: int) -> Iterator[None]:
    """Compute power series to so many terms inside the block; restore the former number on every exit."""
    former = ctx.cap
    ctx.cap = count
    try:
        yield
    finally:
        ctx.cap = former


def at_centre(value: Value) -> acb:
    """Return the first coefficient of a series; a number is its own."""
    return value[0] if isinstance(value, acb_series) else value


def value_at(
    polynomial: fmpz_mpoly, values: Callable[[int], Numeral], number: Callable[[int], Numeral]
) -> Numeral:
    """Return a polynomial's value, term by term; ``values`` gives that of the generator at a position."""
    total = number(0)
    for monomial, coefficient in polynomial.terms():
        term = number(int(coefficient))
        for i, exponent in enumerate(monomial):
            if exponent:
                term = term * values(i) ** int(exponent)
        total = total + term
    return total


def rational_value(expression: Expression, values: Mapping[str, ExactValue]) -> Fraction | None:
    """Return the exact value of an expression of rational numbers, ``None`` when it is anything else.

    Examples
    --------
    >>> from symflex.expressions import Number, Quotient
    >>> rational_value(Quotient(Number(Fraction(8)), Number(Fraction(6))), {})
    Fraction(4, 3)
    """

    def named(name: str) -> Fraction:
        if values[name].pi_power:
            raise KeyError(name)
        return values[name].rational

    def none(*_: object) -> Fraction:
        raise KeyError

    try:
        return fold(expression, number=Fraction, name=named, power=none, call=none)
    except (KeyError, ZeroDivisionError):
        return None


def enclosure(value: ExactValue) -> Callable[[], arb]:
    """Return what encloses an exact value at the precision of the time it is called."""
    if value.is_imaginary:
        unit: Arithmetic = acb(0, 1)
        return lambda: unit
    return lambda: ball(value.rational) * arb.pi() ** value.pi_power


def later(expression: Expression, values: Mapping[str, Callable[[], arb]]) -> Callable[[], arb]:
    """Return what encloses an expression at the precision of the time it is called; see :func:`enclose`."""
    return lambda: enclose(expression, values)


def enclose(expression: Expression, values: Mapping[str, Callable[[], arb]]) -> arb:
    """Return a ball that contains the value of an expression at the current precision.

    It is one of numbers, ``pi``, named constants and elementary functions. Raises ModelError: SF228 when the
    value is not a finite real number.

    Examples
    --------
    >>> from symflex.expressions import Call, Number
    >>> from fractions import Fraction
    >>> enclose(Call("sqrt", Number(Fraction(4))), {}).contains(2)
    True
    """
    result = _enclose(expression, values)
    if not result.is_finite():
        message = f"'{format_expression(expression)}' is not a finite real number for these values"
        raise ModelError(Diagnostic("SF228", message, expression.span, _imaginary_hint(expression)))
    return result


def _imaginary_hint(expression: Expression) -> str | None:
    """Name j where the root of a negative number stands for it."""
    if isinstance(expression, Call) and expression.name == "sqrt" and not names(expression.argument):
        return IMAGINARY_UNIT
    return None


def _enclose(expression: Expression, values: Mapping[str, Callable[[], arb]]) -> arb:
    return fold(
        expression,
        number=ball,
        name=lambda name: arb.pi() if name == "pi" else values[name](),
        power=lambda base, exponent: base ** _enclose(exponent, values),
        call=lambda call, argument: FUNCTIONS[call.name].evaluate(argument),
    )


def principal_values(
    expression: Expression,
    count: int,
    name: Callable[[str], list[acb]],
    call: Callable[[Call, list[acb]], list[acb]] | None = None,
    number: Callable[[Fraction], arb] = ball,
) -> list[acb]:
    """Return balls around the principal values of an expression at so many points, in one walk.

    ``name`` gives the values of a name, ``call`` those of a function that is none of the language's, and
    ``number`` that of a number, which is exact by default. A value is not finite where the expression divides
    by zero.

    Examples
    --------
    >>> from symflex.expressions import Call, Name
    >>> principal_values(Call("sqrt", Name("s")), 2, lambda _: [acb(4), acb(-4)])
    [2.00000000000000, 2.00000000000000j]
    """

    def raised(base: list[acb], exponent: Expression) -> list[acb]:
        power = exponent.value if isinstance(exponent, Number) else rational_value(exponent, {})
        if power is not None and power.denominator == 1:
            return [x ** int(power) for x in base]
        exponents = principal_values(exponent, count, name, call)
        return [x**y for x, y in zip(base, exponents, strict=True)]

    def called(node: Call, argument: list[acb]) -> list[acb]:
        if node.name in FUNCTIONS or call is None:
            function: Callable[[Arithmetic], Arithmetic] = FUNCTIONS[node.name].evaluate
            return [function(x) for x in argument]
        return call(node, argument)

    return fold(
        expression,
        number=lambda value: [acb(number(value))] * count,
        name=name,
        power=raised,
        call=called,
        negative=lambda values: [-x for x in values],
        total=lambda terms: [sum(xs, acb(0)) for xs in zip(*terms, strict=True)],
        product=lambda factors: [prod(xs, start=acb(1)) for xs in zip(*factors, strict=True)],
        quotient=lambda above, below: [x / y for x, y in zip(above, below, strict=True)],
    )


Value = acb | acb_series
"""A number, or a power series in the displacement from one."""
Arithmetic = Any
"""A ball or a power series, real or complex. Their arithmetic is one."""


def raised(base: Arithmetic, exponent: int) -> Arithmetic:
    """Return an integer power of a ball or a series, not finite where it divides by zero.

    Examples
    --------
    >>> raised(acb_series([2, 1], 2), -1), raised(acb_series([0, 1], 2), -1)[0].is_finite()
    (0.500000000000000 + (-0.250000000000000)*x + O(x^2), False)
    """
    if isinstance(base, acb | arb):
        return base**exponent
    found: Arithmetic = base**0 if exponent == 0 else base
    for _ in range(abs(exponent) - 1):
        found = found * base
    if exponent < 0:
        # Balls are not finite then by themselves; series of them raise an error.
        return found * arb("nan") if found[0].contains(0) else 1 / found
    return found


def evaluated(value: Factored, number: Callable[[str], Arithmetic], one: Arithmetic) -> Arithmetic:
    """Return a rational function with a number in place of every generator; ``one`` is 1 of their kind."""
    total, names = one * ball(value.unit), value.ring.names
    for factor, exponent in value.factors:
        total = total * raised(summed(terms_of(factor), names, number, one), exponent)
    return total


def summed(
    terms: Sequence[tuple[Monomial, int]],
    names: Sequence[str],
    number: Callable[[str], Arithmetic],
    one: Arithmetic,
) -> Arithmetic:
    """Return the same of a polynomial, by its terms."""
    total = one * 0
    for monomial, coefficient in terms:
        term = one * coefficient
        for i, exponent in monomial:
            term = term * raised(number(names[i]), exponent)
        total = total + term
    return total


def binary_exponent(value: acb) -> int | None:
    """Return about the binary logarithm of a ball's size, None for zero and what is not finite.

    Examples
    --------
    >>> binary_exponent(acb(5)), binary_exponent(acb(0))
    (3, None)
    """
    size = value.abs_upper()
    if size == 0 or not size.is_finite():
        return None
    mantissa, exponent = size.man_exp()
    return int(mantissa).bit_length() + int(exponent)


def balancing(sizes: Sequence[Mapping[int, int]], columns: int, passes: int) -> tuple[list[int], list[int]]:
    """Return exponents of two for rows and columns that bring their largest entries near one.

    ``sizes`` are the binary exponents of what is not zero, row by row and by column; units make them differ.

    Examples
    --------
    >>> balancing([{0: 10, 1: 0}, {0: 10, 1: 4}], 2, 2)
    ([-10, -10], [0, 6])
    """
    left, right = [0] * len(sizes), [0] * columns
    for _ in range(passes):
        for i, row in enumerate(sizes):
            left[i] = -max((e + right[j] for j, e in row.items()), default=0)
        largest: list[int | None] = [None] * columns
        for i, row in enumerate(sizes):
            for j, e in row.items():
                known = largest[j]
                largest[j] = e + left[i] if known is None else max(known, e + left[i])
        right = [0 if e is None else -e for e in largest]
    return left, right


Step = tuple[int, tuple[int, ...], int]
"""How many factors of the last product stay, which powers follow, and the term's integer."""


@dataclass(frozen=True, slots=True)
class EvaluationPlan:
    """How to evaluate one polynomial."""

    powers: tuple[tuple[int, int], ...]  # positions of generators, and exponents, that occur
    steps: tuple[Step, ...]  # one per term

    def value(self, powers: Sequence[Value]) -> Value:
        """Return the polynomial's value from those of the powers."""
        products: list[Value] = [acb(1)]
        total: Value = acb(0)
        for kept, following, coefficient in self.steps:
            del products[kept + 1 :]
            product = products[-1]
            for i in following:
                product = product * powers[i]
                products.append(product)
            total = total + product * coefficient
        return total


def plan(polynomial: fmpz_mpoly) -> EvaluationPlan:
    """Return how to evaluate a polynomial."""
    numbers: dict[tuple[int, int], int] = {}
    steps: list[Step] = []
    last: tuple[int, ...] = ()
    for monomial, coefficient in polynomial.terms():
        factors = ((i, int(e)) for i, e in enumerate(monomial) if e)
        powers = tuple(numbers.setdefault(power, len(numbers)) for power in factors)
        kept = 0
        while kept < min(len(last), len(powers)) and last[kept] == powers[kept]:
            kept += 1
        steps.append((kept, powers[kept:], int(coefficient)))
        last = powers
    return EvaluationPlan(tuple(numbers), tuple(steps))


FIRST_BITS = 96
LAST_BITS = 6144
DOUBLE_BITS = 54
"""One more than the significand of a double."""
NEAR = (200, 220)
"""Negative powers of two between which the behaviour at a point is read off, where there is no number."""


def double_value(
    enclosed: Callable[[int], Ball], s: complex, patience: int | None, bits: int = FIRST_BITS
) -> complex:
    """Return a function's value at one complex frequency [rad/s] to double precision.

    ``enclosed`` is the function by the precision, which begins with so many ``bits``. After ``patience``
    doublings a value that is not a number is sought as a limit; never with None, where only a pole has none.
    The value is nan where ``s`` is not finite, and ``inf + nan*1j`` at a pole.
    """
    if not (isfinite(s.real) and isfinite(s.imag)):
        return complex(nan, nan)
    point, last = acb(s.real, s.imag), None if patience is None else bits << patience
    while True:
        value = enclosed(bits)(point)
        if value.is_finite() and value.rel_accuracy_bits() >= DOUBLE_BITS:
            return complex(float(value.real.mid()), float(value.imag.mid()))
        if last is not None and not value.is_finite() and bits >= last:
            return _limit_at(enclosed, s)
        if bits >= LAST_BITS:
            return 0j if value.is_finite() else complex(inf, nan)
        bits *= 2


def _limit_at(enclosed: Callable[[int], Ball], s: complex) -> complex:
    """Return the value where parts of an expression are not numbers, by continuity."""
    order, value = order_near(enclosed, s)
    if value is None or order < 0:
        return complex(inf, nan)
    return 0j if order > 0 else complex(float(value.real.mid()), float(value.imag.mid()))


def order_near(enclosed: Callable[[int], Ball], s: complex) -> tuple[int, acb | None]:
    """Return the order of the zero (negative: of the pole) at ``s``, and a value close by if one is found."""
    near, nearer = (_beside(enclosed, s, -e) for e in NEAR)
    if near is None or nearer is None:
        return 0, None
    with ctx.workprec(LAST_BITS):
        ratio = abs(nearer / near).log() / arb(2).log() / (NEAR[0] - NEAR[1])
        return round(float(ratio.mid())), nearer


def limit_at_zero(enclosed: Callable[[int], Ball]) -> float:
    """Return the limit from two values close to zero, where it goes like an integer power of s."""
    order, value = order_near(enclosed, 0j)
    if value is None:
        return nan
    if order < 0:
        return inf if value.real > 0 else -inf
    return float(value.real.mid()) if order == 0 else 0.0


def _beside(enclosed: Callable[[int], Ball], s: complex, exponent: int) -> acb | None:
    """Return a ball around the value at ``s + 2^exponent``, ``None`` when it is not found."""
    bits = FIRST_BITS * 8
    while bits <= LAST_BITS:
        with ctx.workprec(bits):
            point = acb(s.real, s.imag) + (arb(2) ** exponent) * max(abs(s), 1.0)
            value = enclosed(bits)(point)
            if value.is_finite() and value.rel_accuracy_bits() >= DOUBLE_BITS:
                return value
        bits *= 2
    return None

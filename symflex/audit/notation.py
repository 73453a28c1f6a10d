"""From an element of the field back to an expression, in the printed formula's own symbols where possible."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations_with_replacement
from math import lcm, prod

from flint import fmpq, fmpq_mat

from symflex.algebra import LAPLACE, Factored
from symflex.audit.factors import full_angles, lowest_terms
from symflex.audit.field import HOLE, UNIT, Arithmetic
from symflex.audit.reading import FormulaReading
from symflex.expressions import (
    Call,
    Expression,
    Name,
    Negative,
    Power,
    Sum,
    negative,
    number,
    power,
    product_of,
    quotient,
    sum_of,
)

MOST_DEGREE = 4
MOST_SYMBOLS = 6
MOST_MONOMIALS = 80
MOST_SHIFTS = 40
SQUARE = 2


@dataclass(frozen=True, eq=False)
class Symbol:
    """A name or function call of the print whose value holds functions of s."""

    expression: Expression
    value: Factored


def symbols_of(reading: FormulaReading) -> tuple[Symbol, ...]:
    """Return the transcendental symbols of the printed expression, in order of appearance."""
    symbols: dict[Expression, Symbol] = {}
    pending = [reading.formula.expression]
    while pending:
        node = pending.pop()
        is_symbol = (isinstance(node, Name) and node.name in reading.lines) or isinstance(node, Call)
        if is_symbol and node not in symbols:
            value = reading.value(node)
            if reading.field.depends_on_functions(value):
                symbols[node] = Symbol(node, value)
                continue
        pending.extend(reversed(node.children))
    return tuple(symbols.values())


def in_symbols(field: Arithmetic, value: Factored, symbols: Sequence[Symbol]) -> Expression | None:
    """Return a value as a sum of least degree of products of symbols, ``None`` when it is not one."""
    if not symbols or len(symbols) > MOST_SYMBOLS:
        return None
    monomials: list[tuple[tuple[int, ...], Factored]] = []
    for degree in range(MOST_DEGREE + 1):
        for chosen in combinations_with_replacement(range(len(symbols)), degree):
            monomials.append((chosen, prod((symbols[i].value for i in chosen), start=field.number(1))))
        if len(monomials) > MOST_MONOMIALS:
            return None
        coefficients = solve_linear(field, value, [m for _, m in monomials])
        if coefficients is not None:
            terms = []
            for c, (chosen, _) in reversed(list(zip(coefficients, monomials, strict=True))):
                times = Counter(symbols[i].expression for i in chosen)
                factors = (power(f, n) if n > 1 else f for f, n in times.items())
                terms += [product_of([number(c), *factors])] if c else []
            return sum_of(terms)
    return None


def solve_linear(
    field: Arithmetic, value: Factored, parts: Sequence[Factored]
) -> tuple[Fraction, ...] | None:
    """Return rational coefficients with which the parts add up to the value, ``None`` when there are none.

    Where several will do, later parts are left out.
    """
    everything = [*parts, value]
    common = field.number(1)
    for v in everything:
        missing = (v * common).denominator()
        common = common * missing
    rows: dict[tuple[int, ...], dict[int, int]] = {}
    scale = lcm(*(v.unit.denominator for v in everything))
    for j, v in enumerate(everything):
        polynomial = field.reduce((v * common * scale).expand())
        for monomial, coefficient in polynomial.terms():
            rows.setdefault(tuple(int(e) for e in monomial), {})[j] = int(coefficient)
    count = len(everything)
    if not rows:
        return tuple(Fraction(0) for _ in parts)
    matrix = fmpq_mat(len(rows), count, [fmpq(row.get(j, 0)) for row in rows.values() for j in range(count)])
    reduced, rank = matrix.rref()
    solution = [Fraction(0)] * len(parts)
    for i in range(rank):
        pivot = next(j for j in range(count) if reduced[i, j] != 0)
        if pivot == count - 1:
            return None
        x = reduced[i, count - 1]
        solution[pivot] = Fraction(int(x.p), int(x.q))
    return tuple(solution)


def monomial_expression(field: Arithmetic, value: Factored) -> Expression | None:
    """Return a number times powers of s and the parameters; ``None`` for anything else."""
    exponents: dict[str, Fraction] = {}
    order, coefficient = field.ground.order, value.unit
    for factor, exponent in value.factors:
        if len(factor) > 1:
            return None
        name = field.ring.names[next(i for i, e in enumerate(factor.monoms()[0]) if e)]
        if name.startswith(("exp(", "cos(", "sin(", "sum(", UNIT, HOLE)):
            return None
        if name.startswith("root("):
            integer, remainder = divmod(exponent, order)
            coefficient *= Fraction(int(name[5:-1])) ** integer
            if remainder:
                exponents[name[5:-1]] = Fraction(remainder, order)
        else:
            step = order if name in field.ground.rootable else 1
            exponents[name] = Fraction(exponent, step)
    return powers_expression(coefficient, exponents)


def powers_expression(coefficient: Fraction, exponents: dict[str, Fraction]) -> Expression:
    """Return a number times powers of names; half powers stand together under one root."""
    groups: dict[tuple[bool, int], list[Expression]] = {}
    for name, exponent in sorted(exponents.items(), key=lambda item: item[0] == LAPLACE):
        base: Expression = number(int(name)) if name.isdigit() else Name(name)
        times, root = abs(exponent.numerator), exponent.denominator
        groups.setdefault((exponent > 0, root), []).append(power(base, times) if times != 1 else base)
    above: list[Expression] = [number(coefficient.numerator)]
    below: list[Expression] = [number(coefficient.denominator)]
    for root in sorted({root for _, root in groups}):
        up, down = groups.get((True, root), []), groups.get((False, root), [])
        if root == 1:
            above, below = [*above, *up], [*below, *down]
            continue
        radicand = quotient(product_of(up), product_of(down))
        plain = Power(radicand, quotient(number(1), number(root)))
        above.append(Call("sqrt", radicand) if root == SQUARE else plain)
    return quotient(product_of(above), product_of(below))


def factor_expression(reading: FormulaReading, value: Factored) -> Expression | None:
    """Return a value, up to a factor without zeros, in the printed symbols or with functions of s."""
    field = reading.field
    symbols = symbols_of(reading)
    written = _in_symbols(field, value, symbols)
    if written is None:
        return polynomial_expression(field, value)
    return _negated(written[0]) if _begins_negative(written[0]) else written[0]


def _begins_negative(expression: Expression) -> bool:
    return isinstance(expression.terms[0] if isinstance(expression, Sum) else expression, Negative)


def _negated(expression: Expression) -> Expression:
    terms = expression.terms if isinstance(expression, Sum) else (expression,)
    return sum_of(negative(term) for term in terms)


def polynomial_expression(field: Arithmetic, value: Factored) -> Expression | None:
    """Return a polynomial with its functions written out, ``None`` when it has a denominator."""
    if any(e < 0 for _, e in value.factors):
        return None
    terms = []
    for monomial, coefficient in (value / value.unit).expand().terms():
        plain = field.number(int(coefficient) * value.unit.numerator)
        functions: list[Expression] = []
        for i, (name, exponent) in enumerate(zip(field.ring.names, monomial, strict=True)):
            if not int(exponent):
                continue
            if name.startswith(("exp(", "cos(", "sin(")):
                functions.append(_function(field, name, int(exponent)))
            else:
                plain = plain * Factored.polynomial(field.ring, field.ring.context.gen(i)) ** int(exponent)
        factor = monomial_expression(field, plain)
        if factor is None:
            return None
        terms.append(product_of([factor, *functions]))
    return sum_of(terms)


def _function(field: Arithmetic, name: str, exponent: int) -> Expression:
    wave = field.ground.waves[int(name[4:-1])]
    plain = [(n, e) for n, e in wave.key if not n.startswith("sum(")]
    exponents = {n.removeprefix("root(").removesuffix(")"): e for n, e in plain}
    if name.startswith("exp("):
        return Call("exp", powers_expression(wave.unit * exponent, exponents))
    call = Call(name[:3], powers_expression(wave.unit, exponents))
    return call if exponent == 1 else power(call, exponent)


def derived_in_symbols(reading: FormulaReading) -> Expression | None:
    """Return the derived function in the symbols of the print, ``None`` if that does not work out."""
    field = reading.field
    symbols, terms = symbols_of(reading), lowest_terms(field, reading.derived)
    if terms is None or not symbols:
        return None
    parts = []
    for factors in (terms.zeros, terms.poles):
        product = prod((factor**times for factor, times in factors), start=terms.ring.constant(1))
        value = full_angles(field, terms.ring, product)
        written = None if value is None else _in_symbols(field, value, symbols)
        if written is None:
            return None
        parts.append(written)
    (above, num), (below, den) = parts
    if _begins_negative(below):
        below, den = _negated(below), -den
    ratio = field.constant_ratio(reading.derived, num / den)
    front = None if ratio is None else monomial_expression(field, ratio)
    return None if front is None else product_of([front, quotient(above, below)])


def _in_symbols(
    field: Arithmetic, value: Factored, symbols: Sequence[Symbol]
) -> tuple[Expression, Factored] | None:
    """Return a value, up to powers of exponentials, in symbols."""
    # A value may be divided by powers of the exponentials.
    highest = [0] * len(field.ground.waves)
    for factor, exponent in value.factors:
        for i in range(len(highest)):
            places = [field.ring.index[f"{f}({i})"] for f in ("exp", "cos", "sin")]
            highest[i] += exponent * sum(int(factor.degrees()[index]) for index in places)
    shifts = [field.number(1)]
    for i, degree in enumerate(highest):
        e = Factored.generator(field.ring, f"exp({i})")
        shifts = [s * e**-n for s in shifts for n in range(abs(degree) + 1)]
    for shift in shifts[:MOST_SHIFTS]:
        written = in_symbols(field, value * shift, symbols)
        if written is not None:
            return written, value * shift
    return None

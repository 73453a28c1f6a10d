"""Distributed functions as rational ones: numerator and denominator up to a power of s, in symbols.

Input: a transfer function with kernels, and a power.
Output: a rational function with exact coefficients; of a compliance at the driven point the truncated series
of its reciprocal, the dynamic stiffness.

    cantilever with a mass at its tip, up to s^2:    1/(3*E*I/l^3 + (33*rho*A*l/140 + m)*s^2)    (Rayleigh)

Kernels are Taylor series, as in :mod:`symflex.symbolic.limits`. What remains is a function of the squares or
the fourth powers of wavenumbers, which the dispersion relations make rational in s.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

from symflex.algebra import NO_KERNELS, Factored, Ring
from symflex.algebra.ring import by_powers, terms_of
from symflex.errors import Diagnostic, UsageError
from symflex.expressions import Name, power, product_of, sum_of
from symflex.print.forms import PrintedForm, print_form
from symflex.print.forms.notation import constant_symbols
from symflex.print.forms.printed import Approximation, S
from symflex.print.forms.shapes import of_powers
from symflex.print.read_back import read_back
from symflex.symbolic.distance import distance, roots_of
from symflex.symbolic.limits import LimitFinder, NotSymbolicError
from symflex.transfer import TransferFunction, bind
from symflex.transfer.lowest_terms import cancel


def truncated(tf: TransferFunction, order: int) -> tuple[TransferFunction, PrintedForm]:
    """Return a distributed function as a rational one in symbols, up to a power of s."""
    if tf.is_rational:
        exact = Approximation(("it is a rational function of s already",), {"kind": "order"}, is_whole=True)
        return tf, replace(print_form(tf), approximation=exact)
    num, den = _expanded(tf, order + 1)
    plain = Ring(tuple(n for n in num.ring.names if n not in tf.kernels.generators))
    places = [n.node if not n.component else f"{n.node}.{n.component}" for n in tf.input.nodes]
    is_flexible = tf.quantity in ("receptance", "angular compliance")
    is_driven = is_flexible and [tf.output.expression] == [Name(p) for p in places]
    is_stiffness = is_driven and _begins(num) <= _begins(den)
    sides = [num / num, den / num] if is_stiffness else [num, den]
    lowest = min(map(_begins, sides))
    series = [[c.over(plain) for c in _series(side, order + 1)] for side in sides]
    terms = [
        [
            (first + k, c)
            for k, c in enumerate(coefficients)
            if not c.is_zero and first + k <= max(order, first)
        ]
        for coefficients, first in zip(series, (_begins(side) - lowest for side in sides), strict=True)
    ]
    zero, s = Factored.number(plain, 0), Factored.generator(plain, "s")
    above, below = (sum((c * s**k for k, c in coefficients), zero) for coefficients in terms)
    ratio, _ = cancel(above, below)
    truncated = replace(tf, reduced=ratio, closed=None, hidden=(), kernels=NO_KERNELS, parts=None, solve=None)
    form = (_stiffness(truncated, terms[1]) if is_stiffness else None) or print_form(truncated)
    what = "dynamic stiffness" if is_stiffness else "numerator and denominator"
    said = [f"exact {what} up to s^{order}"]
    facts: dict[str, object] = {"kind": "order", "order": order, "stiffness": is_stiffness}
    if any(p.value is None for p in tf.parameters):
        said.append("no error is known, as a parameter has no value")
        return truncated, replace(form, approximation=Approximation(tuple(said), facts))
    before, after = bind(tf), bind(truncated)
    apart = distance(before, after, roots_of(before, after), (0.01, 0.1))
    return truncated, replace(form, approximation=Approximation((*said, *apart.said), facts | apart.facts))


def _expanded(tf: TransferFunction, count: int) -> tuple[Factored, Factored]:
    """Return numerator and denominator whose first coefficients of s, so many, are those of a function."""
    ring, finder = tf.ratio.ring, LimitFinder(tf, "0")
    sides = tf.ratio.numerator(), tf.ratio.denominator()
    try:
        # Kernels of one side together are functions of s, and one by one they need not be.
        num, den = (finder.expanded((side / side.unit).expand(), count) * side.unit for side in sides)
        for name, (square, order) in finder.laws.items():
            wave = Factored.generator(ring, name)
            above, below = (side.exponent_of(ring.generator(name)) for side in (num, den))
            num, den = num / wave**above, den / wave**below
            if (above - below) % order or num.depends_on(name) or den.depends_on(name):
                raise NotSymbolicError("it is not a function of s alone")
            num = num * square ** ((above - below) // order)
    except NotSymbolicError as error:
        message = f"{tf.name} is not expanded in s: {error.diagnostics[0].message}"
        raise UsageError(Diagnostic("SF902", message)) from None
    return num, den


def _begins(value: Factored) -> int:
    """Return the power of s that a rational function begins with."""
    return sum(min(by_powers(value.ring, f)) * e for f, e in value.factors)


def _series(value: Factored, count: int) -> list[Factored]:
    """Return the first coefficients of s of a rational function, from the power on that it begins with."""
    zero = value * 0
    total = [zero + value.unit, *[zero] * (count - 1)]
    for factor, exponent in value.factors:
        powers = by_powers(value.ring, factor)
        least, none = min(powers), value.ring.constant(0)
        coefficients = [Factored.polynomial(value.ring, powers.get(least + n, none)) for n in range(count)]
        for _ in range(abs(exponent)):
            for n in range(count) if exponent < 0 else reversed(range(count)):
                others = sum((coefficients[i] * total[n - i] for i in range(1, n + 1)), zero)
                total[n] = (
                    (total[n] - others) / coefficients[0]
                    if exponent < 0
                    else total[n] * coefficients[0] + others
                )
    return total


def _stiffness(tf: TransferFunction, series: Sequence[tuple[int, Factored]]) -> PrintedForm | None:
    """Return one over a sum of powers of s, each with a sum of quotients; None where sums are below."""
    symbols, terms = constant_symbols(tf), []
    for exponent, value in series:
        below, fractions = value.denominator(), []
        if any(len(f) > 1 for f, _ in below.factors):
            return None
        for monomial, number in terms_of(value.numerator().expand()):
            gens = tuple((value.ring.context.gen(i), e) for i, e in monomial)
            term = Factored(value.ring, Fraction(number), gens) / below
            powers = [(str(*value.ring.used_in([f])), e) for f, e in term.factors]
            bases = {symbols.get(name, Name(name)): e for name, e in powers}
            fractions.append(of_powers(term.unit, bases))
        terms.append(product_of([sum_of(fractions), power(S, exponent)]))
    form = PrintedForm("order", of_powers(Fraction(1), {}), sum_of(terms))
    read_back(tf, form)
    return form

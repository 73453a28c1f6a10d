"""Distributed functions as rational ones: numerator and denominator up to a power of s, in letters.

Input: a transfer function with kernels, and a power.
Output: a rational function with exact coefficients; of a compliance at the driven point the truncated series
of its reciprocal, the dynamic stiffness.

    cantilever with a mass at its tip, up to s^2:    1/(3*E*I/l^3 + (33*rho*A*l/140 + m)*s^2)    (Rayleigh)

Wavenumbers that vanish at s = 0 have a weight, the power of s that they begin with, and so has s. Kernels
become Taylor series up to a weight. What remains is even in every wavenumber, or a function of its fourth
power, so the dispersion relation makes it rational in s.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import factorial
from typing import TYPE_CHECKING

from symflex.algebra import NO_KERNELS, Factored, Ring
from symflex.algebra.factored import composed
from symflex.algebra.ring import by_powers, terms_of
from symflex.budget import spend
from symflex.errors import Diagnostic, UsageError
from symflex.expressions import Name, power, product_of, sum_of
from symflex.letters.distance import distance, roots_of
from symflex.print.forms import PrintedForm, print_form
from symflex.print.forms.notation import constant_symbols
from symflex.print.forms.printed import Approximation, S
from symflex.print.forms.shapes import of_powers
from symflex.print.read_back import read_back
from symflex.transfer import TransferFunction, bind
from symflex.transfer.lowest_terms import cancel

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from flint import fmpz_mpoly

    from symflex.algebra import Kernel

QUARTERS = 4
"""Weights count in quarters of a power of s: a bending wave begins with its square root."""
ORDERS = (0, 2, 4, 8, 16, 32)
"""Powers of s with which a numerator may begin, besides what it is divided by."""


def truncated(tf: TransferFunction, order: int) -> tuple[TransferFunction, PrintedForm]:
    """Return a distributed function as a rational one, in letters, up to a power of s.

    Raises UsageError: SF902 for a function whose waves do not come to rest at s = 0.

    Examples
    --------
    >>> from symflex import pipeline
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... parameters = { T = "1 s" }
    ... inputs.u = {}
    ... outputs.y = "u*exp(-T*s)"
    ... ''')
    >>> str(truncated(pipeline.derive_all(model)[0], 2)[0].ratio)
    '1/2*(s^2*T^2 - 2*s*T + 2)'
    """
    if tf.is_rational:
        whole = Approximation(("it is a rational function of s already",), {"kind": "order"}, is_whole=True)
        return tf, replace(print_form(tf), approximation=whole)
    weights = _weights(tf)
    num, den = (_expanded(tf, part, order + 1, weights) for part in (tf.num, tf.den))
    plain = Ring(tuple(n for n in num.ring.names if n not in tf.kernels.generators))
    places = [n.node if not n.component else f"{n.node}.{n.component}" for n in tf.input.nodes]
    is_driven = tf.quantity == "receptance" and [tf.output.expression] == [Name(p) for p in places]
    is_stiffness = is_driven and _begins(num) <= _begins(den)
    sides = [num / num, den / num] if is_stiffness else [num, den]
    lowest = min(map(_begins, sides))
    # Kernels come last among the generators.
    images = (*plain.context.gens(), *[plain.constant(0)] * (len(num.ring.names) - len(plain.names)))

    def moved(factor: fmpz_mpoly) -> Factored:
        return Factored.polynomial(plain, factor.compose(*images, ctx=plain.context))

    series = [[c.map_factors(plain, moved) for c in _series(side, order + 1)] for side in sides]
    terms = [
        [(first + k, c) for k, c in enumerate(own) if not c.is_zero and first + k <= max(order, first)]
        for own, first in zip(series, (_begins(side) - lowest for side in sides), strict=True)
    ]
    zero, s = Factored.number(plain, 0), Factored.generator(plain, "s")
    above, below = (sum((c * s**k for k, c in own), zero) for own in terms)
    ratio, _ = cancel(above, below)
    own = replace(tf, reduced=ratio, closed=None, hidden=(), kernels=NO_KERNELS, parts=None, solve=None)
    form = (_stiffness(own, terms[1]) if is_stiffness else None) or print_form(own)
    what = "dynamic stiffness" if is_stiffness else "numerator and denominator"
    said = [f"exact {what} up to s^{order}"]
    facts: dict[str, object] = {"kind": "order", "order": order, "stiffness": is_stiffness}
    if any(p.value is None for p in tf.parameters):
        said.append("no error is known, as a parameter has no value")
        return own, replace(form, approximation=Approximation(tuple(said), facts))
    before, after = bind(tf), bind(own)
    apart = distance(before, after, roots_of(before, after), (0.01, 0.1))
    return own, replace(form, approximation=Approximation((*said, *apart.said), facts | apart.facts))


def _refused(tf: TransferFunction, reason: str) -> UsageError:
    return UsageError(Diagnostic("SF902", f"{tf.name} is not expanded in s: {reason}"))


def _weights(tf: TransferFunction) -> dict[int, int]:
    """Return the positions of s and the wavenumbers, and the quarters of a power of s they begin with."""
    weights = {0: QUARTERS}
    for law in tf.kernels.dispersions:
        if law.kind not in ("exponential", "wave", "bending"):
            raise _refused(tf, f"the waves of '{law.name}' are of more than one kind")
        own = QUARTERS * _begins(law.characteristic[0]) // law.order if law.wavenumbers else 1
        if own <= 0:
            raise _refused(tf, f"the waves of '{law.name}' do not come to rest at s = 0")
        weights |= {tf.ratio.ring.index[name]: own for name in law.wavenumbers}
    return weights


def _expanded(tf: TransferFunction, part: Factored, count: int, weights: Mapping[int, int]) -> Factored:
    """Return a rational function whose first coefficients of s, so many, are those of a part."""
    ring, table = part.ring, tf.kernels
    laws = [(law, law.wavenumbers[0]) for law in table.dispersions if law.wavenumbers]
    # gamma^2 and mu^4
    images = {w: law.characteristic[0] * (-1 if law.kind == "wave" else Fraction(1, 4)) for law, w in laws}
    front = part.filter(lambda f: not ring.used_in([f]) & {*table.generators}) * part.unit
    inner = part / front
    for law, wave in laws:
        below = -min(inner.exponent_of(ring.generator(wave)), 0)
        times = -(-below // law.order)
        inner = inner * Factored.generator(ring, wave) ** (times * law.order)
        front = front / images[wave] ** times
    if inner.denominator().factors:
        raise _refused(tf, "it is divided by kernels")
    for start in ORDERS:
        spend()
        most, value = QUARTERS * (start + count), inner
        for kernel in (k for k in table.kernels if inner.depends_on(k.generator)):
            series = _taylor(tf, kernel, weights, most)
            value = _cut(composed(value, {kernel.generator: series}), weights, most)
        for law, wave in laws:
            total = Factored.number(ring, 0)
            for exponent, rest in by_powers(ring, value.filter(bool).expand(), ring.index[wave]).items():
                if exponent % law.order:
                    raise _refused(tf, "it is no function of s alone")
                total = total + Factored.polynomial(ring, rest) * images[wave] ** (exponent // law.order)
            value = total * value.unit
        if not value.is_zero and _begins(value) <= start:
            return front * value
    raise _refused(tf, "it begins with a higher power of s than is looked for")


def _cut(value: Factored, weights: Mapping[int, int], most: int) -> Factored:
    """Return the terms of a polynomial up to a weight."""
    polynomial, steps = value.filter(bool).expand(), weights.items()
    terms = {m: c for m, c in polynomial.to_dict().items() if sum(w * int(m[i]) for i, w in steps) <= most}
    return Factored.polynomial(value.ring, polynomial.context().from_dict(terms)) * value.unit


def _taylor(tf: TransferFunction, kernel: Kernel, weights: Mapping[int, int], most: int) -> Factored:
    """Return a kernel's Taylor series."""
    rate = Factored.generator(kernel.length.ring, kernel.wavenumber or "s")
    argument = kernel.length * (rate if kernel.wavenumber else -kernel.dispersion.shift)
    if argument.denominator().factors or (_cut(argument, weights, 0).factors):
        raise _refused(tf, "a length or a delay is a quotient, or does not come to rest at s = 0")
    is_circular, total = kernel.function in ("cos", "sin"), argument * 0
    parity = {"exp": (0, 1), "cosh": (0, 2), "cos": (0, 2), "sinh": (1, 2), "sin": (1, 2)}[kernel.function]
    for k in range(parity[0], most + 1, parity[1]):
        sign = -1 if is_circular and k % 4 > 1 else 1
        total = total + _cut(argument**k, weights, most) * Fraction(sign, factorial(k))
    return total


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
        own = [Factored.polynomial(value.ring, powers.get(least + n, none)) for n in range(count)]
        for _ in range(abs(exponent)):
            for n in range(count) if exponent < 0 else reversed(range(count)):
                others = sum((own[i] * total[n - i] for i in range(1, n + 1)), zero)
                total[n] = (total[n] - others) / own[0] if exponent < 0 else total[n] * own[0] + others
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

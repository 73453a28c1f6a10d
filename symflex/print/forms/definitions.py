"""The compact form: sub-impedances and the user's definitions stay closed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from math import gcd

from flint import fmpz_mpoly

from symflex.algebra import LAPLACE, Factored, degree_in
from symflex.equations.elimination import Closure
from symflex.expressions import Expression, Name, Product, Sum, names, nodes, power, product_of, sum_of
from symflex.model.linearity import factored_of
from symflex.print.forms.arrange import (
    Arranger,
    ProductPrinter,
    is_long_product,
    length,
    lowest_power_of_s,
    reading,
)
from symflex.print.forms.arranged import Arranged
from symflex.print.forms.kept import REWRITE_LIMIT, divisor_of, in_definitions, is_divisor
from symflex.print.forms.notation import constant_symbols
from symflex.print.forms.polynomial import in_kernels
from symflex.print.forms.printed import PrintedForm
from symflex.print.forms.shapes import S, of_powers, powers_of, rebuilt
from symflex.transfer import ClosedForm, TransferFunction

SMALL = 200  # number of terms up to which every arrangement is tried


def definitions_form(tf: TransferFunction, arranged: Arranged | None = None) -> PrintedForm:
    """Return the shortest print that keeps sums of the network and definitions closed.

    Candidates are the elimination's own closed form, and the expanded polynomial rewritten in the
    definitions.
    """
    if not tf.is_rational:
        return in_kernels(tf, "definitions", tf.ratio)
    arranged = arranged or Arranged()
    if tf.closed is not None and _is_large(tf):
        return PrintedForm("definitions", *_from_closure(tf, tf.closed, arranged))

    arranger = arranged.printer(Arranger.plain(tf.base, constant_symbols(tf))).arranger

    def tidied(part: Expression) -> Expression:
        return _collected(tidied_sum(part, tf.base.index), arranger)

    sides = (tf.ratio.numerator(), tf.ratio.denominator())
    num, den = (rebuilt(_rewritten(tf, arranger, side), tidied) for side in sides)
    if (closed := tf.closed) is not None:
        closed_num, closed_den = (rebuilt(e, tidied) for e in _from_closure(tf, closed, arranged))
        shown = (shows_origin(tf.ratio, closed_num, closed_den), shows_origin(tf.ratio, num, den))
        # A rational factor may stand differently in the two: take both parts from one of them then.
        if shown[0] != shown[1]:
            num, den = (closed_num, closed_den) if shown[0] else (num, den)
        elif tf.base == tf.ratio.ring and (closed.closure.open(closed.den) / tf.ratio.denominator()).is_one:
            num, den = min(closed_num, num, key=reading), min(closed_den, den, key=reading)
        elif reading(closed_num) + reading(closed_den) <= reading(num) + reading(den):
            num, den = closed_num, closed_den
    return PrintedForm("definitions", num, den)


def shows_origin(ratio: Factored, num: Expression, den: Expression) -> bool:
    """Tell whether zeros and poles at s = 0 are seen as powers of s: not in ``b*(s + a) - a*b``."""
    at_zero = ratio.exponent_of(ratio.ring.generator(LAPLACE))
    return lowest_power_of_s(num) - lowest_power_of_s(den) == at_zero


def tidied_sum(part: Expression, order: Mapping[str, int]) -> Expression:
    """Return a sum by powers of s, with what all its terms share in front: ``R*(C*s + 1)``."""
    part = _by_powers(part, order) if isinstance(part, Sum) else part
    if isinstance(part, Product):
        places = [n for n, f in enumerate(part.factors) if isinstance(f, Sum)] or [0]
        between = part.factors[places[0] : places[-1]]
        moved = [f for f in between if not isinstance(f, Sum)]
        sums = [f for f in between if isinstance(f, Sum)]
        return product_of([*part.factors[: places[0]], *moved, *sums, *part.factors[places[-1] :]])
    if not isinstance(part, Sum):
        return part
    terms = [powers_of(t) for t in part.terms]
    shared: dict[Expression, int] = {
        base: min(powers.get(base, 0) for _, powers in terms)
        for base in sorted(terms[0][1], key=lambda base: isinstance(base, Sum))
        if isinstance(base, Name | Sum) and all(powers.get(base, 0) > 0 for _, powers in terms)
    }
    whole = gcd(*(x.numerator for x, _ in terms)) if all(x.denominator == 1 for x, _ in terms) else 1
    if not shared and whole == 1:
        return part
    rest = (
        of_powers(x / whole, {b: n - shared.get(b, 0) for b, n in p.items() if n != shared.get(b)})
        for x, p in terms
    )
    return product_of([of_powers(Fraction(whole), shared), sum_of(rest)])


def _collected(part: Expression, arranger: Arranger) -> Expression:
    """Return a nested sum by powers of s if that reads as easily: ``a*b*s^2 + K*(a + b)*s + c``."""
    if not isinstance(part, Sum) or length(part) > SMALL or not any(_nests_s(t) for t in part.terms):
        return part
    if any(n.name not in arranger.ring.index for n in names(part)):
        return part

    value = factored_of(part, arranger.ring)
    return min(part, arranger.grouped_by_s(value.expand()), key=reading) if is_divisor(value) else part


def _nests_s(term: Expression) -> bool:
    """Tell whether a term is a product with a sum that contains another one with s."""
    sums = [f for f in term.factors if isinstance(f, Sum)] if isinstance(term, Product) else []
    return any(isinstance(n, Sum) and n not in sums and S in names(n) for f in sums for n in nodes(f))


def _by_powers(total: Sum, order: Mapping[str, int]) -> Expression:
    """Return ``M*s^2 + (b + K)*s + k`` for ``b*s + k + s*(M*s + K)``, by falling powers of s."""
    parts: dict[int, list[Expression]] = {}
    others = list[Expression]()
    for term in total.terms:
        opened = [term]
        if (
            isinstance(term, Product)
            and isinstance(term.factors[1], Sum)
            and {*names(term.factors[0])} == {S}
        ):
            opened = [product_of([term.factors[0], t, *term.factors[2:]]) for t in term.factors[1].terms]
        split = [powers_of(t) for t in opened]
        if any(S in names(base) and base != S for _, powers in split for base in powers):
            others.append(term)
            continue
        for front, powers in split:
            coefficient = of_powers(front, {b: n for b, n in powers.items() if b != S})
            parts.setdefault(powers.get(S, 0), []).append(coefficient)
    if (others or not any(parts)) and all(len(each) == 1 for n, each in parts.items() if n):
        return total
    by_powers = []
    for n in sorted(parts, reverse=True):
        if n or all(isinstance(e, Name) for e in parts[n]):
            parts[n].sort(key=lambda e: [order.get(name.name, 0) for name in names(e)])
        by_powers.append(product_of([tidied_sum(sum_of(_added(parts[n])), order), power(S, n)]))
    return sum_of([*by_powers, *others])


def _added(terms: Iterable[Expression]) -> list[Expression]:
    """Return terms, those that differ in their number alone added up."""
    fronts: dict[Expression, Fraction] = {}
    for front, powers in map(powers_of, terms):
        one = of_powers(Fraction(1), powers)
        fronts[one] = fronts.get(one, Fraction(0)) + front
    return [of_powers(front, powers_of(one)[1]) for one, front in fronts.items()]


def _is_large(tf: TransferFunction) -> bool:
    """Tell whether rewriting the expanded polynomials would cost more than it can shorten."""
    return max(tf.length, 1) > (REWRITE_LIMIT if tf.definitions else SMALL)


def _from_closure(
    tf: TransferFunction, closed: ClosedForm, arranged: Arranged
) -> tuple[Expression, Expression]:
    closure = closed.closure
    base = arranged.printer(Arranger.plain(closure.base, constant_symbols(tf))).arranger
    named = _named_sums(tf, closure)
    symbols = {**constant_symbols(tf), **{n: named.get(n, base.grouped_by_s(p)) for n, p in closure.sums}}
    own = Arranger(closure.ring, symbols, {n: degree_in(p, 0) for n, p in closure.sums})
    arranger = arranged.printer(own).arranger
    return arranger.grouped(closed.num), arranger.grouped(closed.den)


def _named_sums(tf: TransferFunction, closure: Closure) -> dict[str, Expression]:
    """Return the definitions that are exactly a closed sum."""
    named: dict[str, Expression] = {}
    for name, value in tf.definitions:
        if value.unit == 1 and len(value.factors) == 1 and value.factors[0][1] == 1:
            polynomial = value.factors[0][0]
            for closed_name, closed_sum in closure.sums:
                if polynomial == closed_sum:
                    named.setdefault(closed_name, Name(name))
    return named


def _rewritten(tf: TransferFunction, arranger: Arranger, value: Factored) -> Expression:
    """Return one side as a polynomial, divided by every definition that makes it shorter.

    Factors of a long product stay as they are.
    """
    ring, own = tf.base, value.over(tf.base)
    divisors = [divisor_of(name, value) for name, value in tf.definitions if is_divisor(value)]

    def in_defined(polynomial: fmpz_mpoly) -> fmpz_mpoly:
        is_short = len(polynomial) <= REWRITE_LIMIT
        return in_definitions(polynomial, divisors, ring) if is_short else polynomial

    if is_long_product(own):
        kept = own.map_factors(ring, lambda factor: Factored.polynomial(ring, in_defined(factor)))
        return ProductPrinter(arranger).quotient(kept)
    return arranger.grouped_by_s(in_defined(own.expand()))

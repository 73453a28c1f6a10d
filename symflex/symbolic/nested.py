"""Printed formulas without terms that change little, in sums inside products and in the lines below.

Input: a printed rational function, the values of its letters, and a bound on the change of coefficients of s.
Output: the numerator, the denominator and the lines without more and more terms, with the largest change.

    1/(M s^2 + k), M = m + m_n   with m_n = m/200 and 1 %   ->   1/(M s^2 + k), M = m

Both are polynomials of s in balls, with the lines put in; what changes least by itself goes first.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from math import inf

from flint import arb, arb_poly

from symflex import expressions as e
from symflex.algebra import LAPLACE, Factored, Ring
from symflex.balls import ball
from symflex.equations.equations import ConstantFunction
from symflex.errors import ModelError
from symflex.model.linearity import factored_of, integer_exponent
from symflex.print.forms.notation import reachable
from symflex.print.forms.printed import PrintedForm, S
from symflex.print.forms.shapes import of_powers, plain, powers_of, rebuilt
from symflex.symbolic.distance import upper
from symflex.transfer.enclose import enclose

NUM, DEN = "", "/"
Parts = dict[str, e.Expression]  # numerator, denominator and the lines below, by their names


@dataclass(frozen=True, eq=False)
class NestedForm:
    """A printed rational function whose sums lose terms."""

    form: PrintedForm
    ring: Ring
    values: Mapping[str, arb]  # of the generators but s

    @property
    def parts(self) -> Parts:
        """What is printed."""
        return {NUM: self.form.num, DEN: self.form.den, **dict(self.form.where)}

    def sides(self, parts: Parts) -> tuple[tuple[ConstantFunction, ...], Factored, Factored]:
        """Return functions that the ring lacks, as sums in them lost terms, and both sides with them."""
        num, den = sides = [_opened(parts[side], parts) for side in (NUM, DEN)]
        calls = {e.format_expression(n): n for x in sides for n in e.nodes(x) if isinstance(n, e.Call)}
        more = tuple(ConstantFunction(n, call) for n, call in calls.items() if n not in self.ring.index)
        ring = Ring((*self.ring.names, *(each.generator for each in more))) if more else self.ring
        return more, factored_of(num, ring), factored_of(den, ring)

    def without(self, most: float, other: Callable[[Parts], float]) -> list[tuple[Parts, float]]:
        """Return forms without one more term each time; nothing changes by more, nor ``other`` says more."""
        sums = dict.fromkeys(n for x in self.parts.values() for n in e.nodes(x) if isinstance(n, e.Sum))
        every = [(total, term) for total in sums for term in total.terms]
        alone = [(self.change(_less(self.parts, *each)), each) for each in every]
        order: list[tuple[e.Expression, e.Expression]]
        order = [each for change, each in sorted(alone, key=lambda pair: pair[0]) if change <= most]
        found: list[tuple[Parts, float]] = []
        while order:
            (total, term), *order = order
            parts = _less(found[-1][0] if found else self.parts, total, term)
            change = self.change(parts) if isinstance(total, e.Sum) else inf
            if max(change, other(parts) if change <= most else inf) <= most:
                found.append((parts, change))
                pairs = [_less({"total": x, "term": y}, total, term) for x, y in order]
                order = [(pair["total"], pair["term"]) for pair in pairs]
        return [({n: self._tidied(x, parts) for n, x in parts.items()}, change) for parts, change in found]

    def change(self, parts: Parts) -> float:
        """Return the largest relative change of a coefficient of s, rounded up."""
        try:
            pairs = [
                (self._polynomial(self.parts, side), self._polynomial(parts, side)) for side in (NUM, DEN)
            ]
        except (KeyError, TypeError, ArithmeticError, ModelError):  # with j, over s, or not defined there
            return inf
        if any(x.degree() != y.degree() for x, y in pairs):
            return inf
        every = [each for x, y in pairs for each in zip(x.coeffs(), y.coeffs(), strict=True)]
        return max(0.0 if x == 0 and y == 0 else upper(abs((y - x) / x)) for x, y in every)

    def _polynomial(self, parts: Parts, side: str) -> arb_poly:
        values = {name: partial(arb, value) for name, value in self.values.items()}
        found: arb_poly = e.fold(
            _opened(parts[side], parts),
            number=lambda x: arb_poly([ball(x)]),
            name=lambda name: arb_poly([0, 1] if name == LAPLACE else [self.values[name]]),
            power=lambda base, n: base ** (integer_exponent(n) or -1),
            call=lambda call, _: arb_poly([enclose(call, values)]),
            quotient=_divided,
        )
        return found

    def shown(self, parts: Parts) -> PrintedForm:
        """Return the form with other parts, in lowest terms, without lines that are a name or a number."""
        for name, line in parts.items():
            if isinstance(line, e.Name | e.Number) and name not in (NUM, DEN):
                parts = {n: plain(x, {name: parts[name]}) for n, x in parts.items()}
        quotient = self._tidied(e.quotient(parts[NUM], parts[DEN]), parts)
        num, den = quotient.children if isinstance(quotient, e.Quotient) else (quotient, e.number(1))
        return replace(self.form, num=num, den=den, where=reachable((num, den), parts.items()), source=None)

    def _tidied(self, expression: e.Expression, parts: Parts) -> e.Expression:
        """Return an expression whose products are in lowest terms, sums after letters."""

        def place(base: e.Expression) -> tuple[bool, bool, int]:
            index = self.ring.index.get(base.name, len(self.ring.index)) if isinstance(base, e.Name) else 0
            return S in e.names(base), isinstance(base, e.Sum | e.Call), index

        def tidied(part: e.Expression) -> e.Expression:
            products = map(powers_of, part.terms if isinstance(part, e.Sum) else (part,))
            return e.sum_of(of_powers(x, {b: p[b] for b in sorted(p, key=place)}) for x, p in products)

        result = tidied(rebuilt(expression, tidied))
        for call in e.nodes(expression):  # a generator of the ring keeps its name
            if isinstance(call, e.Call) and e.format_expression(_opened(call, parts)) in self.ring.index:
                result = e.replace_node(result, rebuilt(call, tidied), call)
        return result


def _opened(expression: e.Expression, parts: Parts) -> e.Expression:
    for _ in parts:
        expression = e.substitute(expression, parts)
    return expression


def _less(parts: Parts, total: e.Expression, term: e.Expression) -> Parts:
    """Return parts without a term of a sum."""
    remaining = e.sum_of([x for x in total.children if x != term])
    return {name: plain(e.replace_node(x, total, remaining), {}) for name, x in parts.items()}


def _divided(one: arb_poly, other: arb_poly) -> arb_poly:
    if other.degree() > 0:
        raise TypeError
    return one * (1 / other[0])

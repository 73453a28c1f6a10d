"""Printed formulas without terms that change little, in sums inside products and in the lines below.

Input: a printed rational function, the values of its letters, and a bound on the change of coefficients of s.
Output: the numerator, the denominator and the lines without more and more terms, with the largest change.

    1/(M s^2 + k), M = m + m_n   with m_n = m/200 and 1 %   ->   1/(M s^2 + k), M = m

Numerator and denominator are polynomials of s in balls, with the lines put in; terms go in the order of the
changes that each makes alone.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import inf

from flint import arb, arb_poly

from symflex import expressions as e
from symflex.algebra import LAPLACE, Factored, Ring
from symflex.balls import ball
from symflex.equations.equations import ConstantFunction
from symflex.errors import ModelError
from symflex.letters.distance import upper
from symflex.model.linearity import factored_of, integer_exponent
from symflex.print.forms.notation import reachable
from symflex.print.forms.printed import PrintedForm, S
from symflex.print.forms.shapes import of_powers, plain, powers_of, rebuilt
from symflex.transfer.enclose import enclose

Parts = tuple[e.Expression, ...]  # a numerator, a denominator, and lines


@dataclass(frozen=True, eq=False)
class NestedForm:
    """A printed rational function whose sums lose terms."""

    form: PrintedForm
    ring: Ring
    values: Mapping[str, arb]  # of the generators but s

    @property
    def parts(self) -> Parts:
        """What is printed."""
        return (self.form.num, self.form.den, *(line for _, line in self.form.where))

    @property
    def terms(self) -> list[Parts]:
        """Every term, after the sum that it stands in."""
        sums = dict.fromkeys(n for x in self.parts for n in e.nodes(x) if isinstance(n, e.Sum))
        return [(total, term) for total in sums for term in total.terms]

    def lines(self, parts: Parts) -> dict[str, e.Expression]:
        """Return what names stand for."""
        return dict(zip(dict(self.form.where), parts[2:], strict=True))

    def opened(self, parts: Parts, expressions: Sequence[e.Expression] = ()) -> Parts:
        """Return expressions, numerator and denominator by default, with the lines put in."""
        where, opened = self.lines(parts), tuple(expressions or parts[:2])
        for _ in where:
            opened = tuple(e.substitute(each, where) for each in opened)
        return opened

    def sides(self, parts: Parts, constants: Sequence[ConstantFunction] = ()) -> list[Factored]:
        """Return numerator and denominator over the ring and more functions."""
        ring = Ring((*self.ring.names, *(c.generator for c in constants))) if constants else self.ring
        return [factored_of(part, ring) for part in self.opened(parts)]

    def constants(self, parts: Parts) -> tuple[ConstantFunction, ...]:
        """Return the functions of constants that the ring lacks, as sums in them have lost terms."""
        every = (n for part in self.opened(parts) for n in e.nodes(part) if isinstance(n, e.Call))
        named = {e.format_expression(call): call for call in every}
        return tuple(ConstantFunction(n, call) for n, call in named.items() if n not in self.ring.index)

    def without(self, most: float, other: Callable[[Parts], float]) -> list[tuple[Parts, float]]:
        """Return forms without one more term each time; nothing changes by more, nor ``other`` says more."""
        alone = [(self.change(_less(self.parts, *each)), each) for each in self.terms]
        order = [each for change, each in sorted(alone, key=lambda pair: pair[0]) if change <= most]
        found: list[tuple[Parts, float]] = []
        while order:
            (total, term), *order = order
            parts = _less(found[-1][0] if found else self.parts, total, term)
            change = self.change(parts) if isinstance(total, e.Sum) else inf
            if max(change, other(parts) if change <= most else inf) <= most:
                found.append((parts, change))
                order = [_less(pair, total, term) for pair in order]
        return [(tuple(self._tidied(part, parts) for part in parts), change) for parts, change in found]

    def change(self, parts: Parts) -> float:
        """Return the largest relative change of a coefficient of s, rounded up."""
        try:
            pairs = [*zip(self._polynomials(self.parts), self._polynomials(parts), strict=True)]
        except (TypeError, ArithmeticError, ModelError):  # over s, or of functions that are not defined there
            return inf
        if any(x.degree() != y.degree() for x, y in pairs):
            return inf
        every = [each for x, y in pairs for each in zip(x.coeffs(), y.coeffs(), strict=True)]
        return max(0.0 if x == 0 and y == 0 else upper(abs((y - x) / x)) for x, y in every)

    def _polynomials(self, parts: Parts) -> list[arb_poly]:
        values = {name: partial(arb, value) for name, value in self.values.items()}
        s, power = arb_poly([0, 1]), lambda base, n: base ** (integer_exponent(n) or -1)
        in_balls = partial(e.fold, number=lambda x: arb_poly([ball(x)]), power=power, quotient=_divided)
        name, call = (
            (lambda n: s if n == LAPLACE else arb_poly([self.values[n]])),
            lambda c, _: arb_poly([enclose(c, values)]),
        )
        return [in_balls(part, name=name, call=call) for part in self.opened(parts)]

    def shown(self, parts: Parts) -> PrintedForm:
        """Return the form with other parts, in lowest terms, without lines that are a name or a number."""
        lines, whole = self.lines(parts), e.quotient(*parts[:2])
        for name in (*lines,):
            if isinstance(lines[name], e.Name | e.Number):
                put = {name: lines.pop(name)}
                whole, lines = plain(whole, put), {n: plain(line, put) for n, line in lines.items()}
        whole = self._tidied(whole, parts)
        num, den = whole.children if isinstance(whole, e.Quotient) else (whole, e.number(1))
        where = reachable((num, den), lines.items())
        return replace(self.form, num=num, den=den, where=where, source=None)

    def _tidied(self, expression: e.Expression, parts: Parts) -> e.Expression:
        """Return an expression whose products are in lowest terms, sums after letters."""

        def place(base: e.Expression) -> tuple[bool, bool, int]:
            index = self.ring.index.get(base.name, len(self.ring.index)) if isinstance(base, e.Name) else 0
            return S in e.names(base), isinstance(base, e.Sum | e.Call), index

        def tidied(part: e.Expression) -> e.Expression:
            products = map(powers_of, part.terms if isinstance(part, e.Sum) else (part,))
            return e.sum_of(of_powers(x, {b: p[b] for b in sorted(p, key=place)}) for x, p in products)

        result = tidied(rebuilt(expression, tidied))
        for call in e.nodes(expression):
            if isinstance(call, e.Call):  # a generator of the ring keeps its name
                is_own = e.format_expression(self.opened(parts, [call])[0]) in self.ring.index
                result = e.replace_node(result, rebuilt(call, tidied), call) if is_own else result
        return result


def _less(parts: Parts, total: e.Expression, term: e.Expression) -> Parts:
    """Return parts without a term of a sum."""
    rest = e.sum_of([x for x in total.children if x != term])
    return tuple(plain(e.replace_node(x, total, rest), {}) for x in parts)


def _divided(one: arb_poly, other: arb_poly) -> arb_poly:
    if other.degree() > 0:
        raise TypeError
    return one * (1 / other[0])

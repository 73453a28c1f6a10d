"""Values with the imaginary unit that are real together, written without it.

A table of poles has conjugate pairs, and a filter with these poles is real: exact expansion shows it.

    p_1 = "-3 + 4*j", p_2 = "-3 - 4*j", H = "1/((s - p_1)*(s - p_2))":  H = 1/(s^2 + 6*s + 25)
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import reduce
from operator import add
from typing import TYPE_CHECKING

from flint import fmpz_mpoly

from symflex.algebra import LAPLACE, Ring, by_powers, terms_of
from symflex.errors import BudgetError
from symflex.expressions import (
    Attribute,
    Call,
    Equation,
    Expression,
    Name,
    Negative,
    Product,
    Quotient,
    Sum,
    format_expression,
    names,
    negative,
    number,
    power,
    product_of,
    quotient,
    replace_node,
    substitute,
    sum_of,
)
from symflex.expressions.nodes import nodes
from symflex.library.blocks import BLOCKS
from symflex.model.linearity import EXPONENT_LIMIT, factored_of
from symflex.model.model import IMAGINARY

if TYPE_CHECKING:
    from symflex.model.network import Draft

UNIT, ONE = Name(IMAGINARY), Fraction(1)
MOST_NODES = 2000  # nodes of an expression with its definitions put in; larger ones stay as they are written


def with_real_values(draft: Draft) -> Draft:
    """Return a draft in which j stands only where a value, a block or a signal is not real."""
    ratios = {b.name: Quotient(*(e for _, e in b.values)) for b in draft.blocks if b.block is BLOCKS["tf"]}
    values = {d.name: d.expression for d in draft.definitions} | ratios
    reading = _ComplexNames({})
    while len(found := {n: e for n, e in values.items() if reading.has_unit(e)}) > len(reading.values):
        reading = _ComplexNames(found)
    settled = {n: reading.real(e) for n, e in found.items()}
    reading = _ComplexNames({n: e for n, e in found.items() if reading.has_unit(settled[n])})
    real = {n: e for n, e in settled.items() if n not in reading.values}
    definitions = [replace(d, expression=real.get(d.name, d.expression)) for d in draft.definitions]
    blocks = list(draft.blocks)
    for i, block in enumerate(blocks):
        if block.name in real:
            whole = real[block.name]
            num, den = whole.children if isinstance(whole, Quotient) else (whole, number(1))
            blocks[i] = replace(block, values=(("num", num), ("den", den)))
    signals = tuple(replace(x, expression=reading.real(x.expression)) for x in draft.signals)
    outputs = tuple(replace(x, expression=reading.real(x.expression)) for x in draft.outputs)
    needed = [x.expression for x in signals] + [x.expression for x in outputs]
    needed += [e for use in draft.elements for _, e in use.values]
    needed += [e for f in draft.fields for e in (*f.equations, *f.conditions)]
    used: set[str] = set()
    while needed:
        new = {n.name for n in names(needed.pop()) if isinstance(n, Name) and n.name in reading.values} - used
        used |= new
        needed += [reading.values[name] for name in new]
    gone = reading.values.keys() - used
    return replace(
        draft,
        definitions=tuple(d for d in definitions if d.name not in gone),
        blocks=tuple(b for b in blocks if b.name not in gone),
        signals=signals,
        outputs=outputs,
    )


@dataclass(frozen=True)
class _ComplexNames:
    """Definitions and blocks with j, by name."""

    values: Mapping[str, Expression]

    def has_unit(self, expression: Expression) -> bool:
        """Tell whether an expression contains j, or a name that does."""
        return any(n == UNIT or (isinstance(n, Name) and n.name in self.values) for n in names(expression))

    def real(self, node: Expression) -> Expression:
        """Return an expression whose real parts are written without j."""
        if not self.has_unit(node):
            return node
        found = self._parts(node)
        if found is None or self.has_unit(found):
            found = self._expanded(node) or found or node
        return replace(found, span=node.span)

    def _parts(self, node: Expression) -> Expression | None:
        match node:
            case Sum(terms) | Product(terms):
                join = sum_of if isinstance(node, Sum) else product_of
                parts = [self.real(x) for x in terms]
                rest = [x for x in parts if self.has_unit(x)]
                joint = self._expanded(join(rest)) if len(rest) > 1 else None
                return join([*(x for x in parts if not self.has_unit(x)), joint]) if joint else join(parts)
            case Negative(operand):
                return negative(self.real(operand))
            case Quotient(above, below):
                return Quotient(self.real(above), self.real(below))
            case Equation(left, right):
                return Equation(self.real(left), self.real(right))
        return None

    def _expanded(self, node: Expression) -> Expression | None:
        """Return the quotient of polynomials that an expression is, if all its coefficients are real."""
        try:
            (a, b), (c, d), leaves = self._polynomials(node)
        except (BudgetError, TypeError, ZeroDivisionError):  # what is no rational function of its names
            return None
        if not (b * c - a * d).is_zero():
            return None
        above, below = (b, d) if c.is_zero() else (a, c)
        shared = above.gcd(below)
        above, below = above / shared, below / shared
        if max(int(e) for x in (above, below) for e in x.degrees()) > EXPONENT_LIMIT:
            return None
        scale = Fraction(int(below.leading_coefficient()))
        return quotient(leaves.expression(above, scale), leaves.expression(below, scale))

    def _polynomials(self, node: Expression) -> tuple[_Parts, _Parts, _Leaves]:
        """Return real and imaginary part of numerator and denominator. TypeError where there are none."""
        opened = self._opened(node)
        kinds = (Name, Attribute, Call)
        leaves = {format_expression(n): n for n in nodes(opened) if isinstance(n, kinds)}
        ring = Ring(tuple(dict.fromkeys((LAPLACE, IMAGINARY, *leaves))))

        value = factored_of(opened, ring)
        above, below = (_parts(ring, x.expand()) for x in (value.numerator(), value.denominator()))
        return above, below, _Leaves(ring, leaves)

    def _opened(self, node: Expression) -> Expression:
        """Return an expression with its definitions put in, and ``exp(a + j*b)`` in cosine and sine."""
        for _ in self.values:
            node = substitute(node, self.values)
            if len(nodes(node)) > MOST_NODES:
                raise TypeError
        for call in [n for n in nodes(node) if isinstance(n, Call) and self.has_unit(n.argument)]:
            (a, b), (c, d), leaves = self._polynomials(call.argument)
            if call.name != "exp" or not d.is_zero():
                raise TypeError
            sign = -1 if int(b.leading_coefficient()) < 0 else 1
            below, one = leaves.expression(c, ONE), [] if a.is_zero() else [leaves.expression(a, ONE)]
            angle = quotient(leaves.expression(b * sign, ONE), below)
            turn = sum_of([Call("cos", angle), product_of([number(sign), UNIT, Call("sin", angle)])])
            grown = product_of([*(Call("exp", quotient(x, below)) for x in one), turn])
            node = replace_node(node, call, grown)
        return node


@dataclass(frozen=True)
class _Leaves:
    """What the generators of a ring stand for."""

    ring: Ring
    nodes: Mapping[str, Expression]

    def expression(self, polynomial: fmpz_mpoly, scale: Fraction) -> Expression:
        """Return a polynomial over a number, by powers of s."""
        by_power: dict[int, list[Expression]] = {}
        for monomial, coefficient in terms_of(polynomial):
            exponents = dict(monomial)
            factors = [number(coefficient / scale)]
            for i, e in exponents.items():
                node = self.nodes.get(self.ring.names[i])
                if isinstance(node, Call) and node.name in ("sqrt", "sin"):
                    cosine = power(Call("cos", node.argument), 2)
                    square = node.argument if node.name == "sqrt" else sum_of([number(1), negative(cosine)])
                    factors += [power(square, e // 2), power(node, e % 2)]
                elif i and node is not None:
                    factors.append(power(node, e))
            by_power.setdefault(exponents.get(0, 0), []).append(product_of(factors))
        s = Name(LAPLACE)
        return sum_of(product_of([sum_of(terms), power(s, n)]) for n, terms in by_power.items())


_Parts = tuple["fmpz_mpoly", "fmpz_mpoly"]


def _parts(ring: Ring, polynomial: fmpz_mpoly) -> _Parts:
    """Return real and imaginary part of a polynomial in j."""
    signed = [
        (n % 2, part * (-1 if n % 4 > 1 else 1))
        for n, part in by_powers(ring, polynomial, ring.index[IMAGINARY]).items()
    ]
    real, imaginary = (reduce(add, (p for n, p in signed if n == k), ring.constant(0)) for k in (0, 1))
    return real, imaginary

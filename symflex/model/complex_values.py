"""Values with the imaginary unit that are real together, written without it.

A table of poles has conjugate pairs, and a filter with these poles is real: exact expansion shows it.

    p_1 = "-3 + 4*j", p_2 = "-3 - 4*j", H = "1/((s - p_1)*(s - p_2))":  H = 1/(s^2 + 6*s + 25)
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING

from flint import fmpz_mpoly

from symflex.algebra import LAPLACE, Factored, Ring, real_parts, terms_of
from symflex.errors import BudgetError, ModelError
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
from symflex.library.elements import LinearForm
from symflex.model.boundary import depends_on_s, varying_constants
from symflex.model.dynamics import Dynamics, ExpressionReader
from symflex.model.linearity import EXPONENT_LIMIT
from symflex.model.model import IMAGINARY

if TYPE_CHECKING:
    from symflex.model.network import Draft

UNIT, ONE = Name(IMAGINARY), Fraction(1)
MOST_NODES = 2000  # nodes of an expression with its definitions put in; larger ones stay as they are written


def with_real_values(draft: Draft) -> Draft:
    """Return a draft in which j stands only where a value, a block or a signal is not real."""
    ratios = {b.name: Quotient(*(e for _, e in b.values)) for b in draft.blocks if b.block is BLOCKS["tf"]}
    values = {d.name: d.expression for d in draft.definitions} | ratios
    varying = varying_constants(draft.definitions, draft.blocks)
    reading = _ComplexNames({}, varying)
    while len(found := {n: e for n, e in values.items() if reading.has_unit(e)}) > len(reading.values):
        reading = _ComplexNames(found, varying)
    settled = {n: reading.real(e) for n, e in found.items()}
    reading = _ComplexNames({n: e for n, e in found.items() if reading.has_unit(settled[n])}, varying)
    real = {n: e for n, e in settled.items() if n not in reading.values}
    definitions = [replace(d, expression=real.get(d.name, d.expression)) for d in draft.definitions]
    blocks = list(draft.blocks)
    for i, block in enumerate(blocks):
        if block.name in real:
            gain = real[block.name]
            num, den = gain.children if isinstance(gain, Quotient) else (gain, number(1))
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
    varying: frozenset[str]  # definitions and blocks that depend on s

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
                imaginary = [x for x in parts if self.has_unit(x)]
                joint = self._expanded(join(imaginary)) if len(imaginary) > 1 else None
                return join([*(x for x in parts if not self.has_unit(x)), joint]) if joint else join(parts)
            case Negative(operand):
                return negative(self.real(operand))
            case Quotient(above, below):
                return Quotient(self.real(above), self.real(below))
            case Equation(left, right):
                return Equation(self.real(left), self.real(right))
        return None

    def _expanded(self, node: Expression) -> Expression | None:
        """Return the quotient of polynomials that an expression is, if all its coefficients are real.

        What cancels in it is written above and below, as it stays a mode of the model.
        """
        try:
            reading, leaves = self._read(node)
            (a, b), (c, d) = map(leaves.parts, (reading.value.numerator(), reading.value.denominator()))
            hidden, imaginary = leaves.parts(reading.hidden)
        except (BudgetError, ModelError, TypeError, ZeroDivisionError):  # no rational function of its names
            return None
        written = c.gcd(d)
        if not (b * c - a * d).is_zero() or not imaginary.is_zero() or leaves.vary(c / written, d / written):
            return None
        above, below = (b, d) if c.is_zero() else (a, c)
        shared = above.gcd(below)
        above, below = above / shared, below / shared
        remainder = leaves.in_s(Factored.polynomial(leaves.ring, shared))
        if max(int(e) for x in (above, below) for e in x.degrees()) > EXPONENT_LIMIT:
            return None
        scale = Fraction(int(below.leading_coefficient()))
        kept = [leaves.expression(x, ONE) for x in (hidden, remainder.expand()) if leaves.vary(x)]
        return quotient(*(product_of([*kept, leaves.expression(x, scale)]) for x in (above, below)))

    def _read(self, node: Expression) -> tuple[Dynamics[Factored], _Leaves]:
        """Return what an expression is read as with its definitions put in."""
        opened = self._opened(node)
        kinds = (Name, Attribute, Call)
        nodes_by_name = {format_expression(n): n for n in nodes(opened) if isinstance(n, kinds)}
        ring = Ring(tuple(dict.fromkeys((LAPLACE, IMAGINARY, *nodes_by_name))))
        varying = {name for name, n in nodes_by_name.items() if depends_on_s(n, self.varying)}
        leaves = _Leaves(ring, nodes_by_name, varying)
        return leaves.read_constant(opened), leaves

    def _opened(self, node: Expression) -> Expression:
        """Return an expression with its definitions put in, and ``exp(a + j*b)`` in cosine and sine."""
        for _ in self.values:
            node = substitute(node, self.values)
            if len(nodes(node)) > MOST_NODES:
                raise TypeError
        for call in [n for n in nodes(node) if isinstance(n, Call) and self.has_unit(n.argument)]:
            reading, leaves = self._read(call.argument)
            (a, b), (c, d) = map(leaves.parts, (reading.value.numerator(), reading.value.denominator()))
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
class _Leaves(ExpressionReader):
    """Names and calls as generators of a ring, and what they stand for."""

    ring: Ring
    nodes: Mapping[str, Expression]
    varying: Collection[str]

    def leaf(self, expression: Expression) -> Dynamics[Factored | LinearForm]:
        """Return the generator of a name or a call. TypeError for what is no value, such as an equation."""
        if not isinstance(expression, Name | Attribute | Call):
            raise TypeError
        return Dynamics(Factored.generator(self.ring, format_expression(expression)), self.one)

    def vary(self, *polynomials: fmpz_mpoly) -> bool:
        """Tell whether any of these depends on s."""
        return any(not self.in_s(Factored.polynomial(self.ring, x)).is_one for x in polynomials if x)

    def parts(self, polynomial: Factored) -> tuple[fmpz_mpoly, fmpz_mpoly]:
        """Return real and imaginary part of a polynomial in j."""
        return real_parts(self.ring, polynomial.expand(), IMAGINARY)

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

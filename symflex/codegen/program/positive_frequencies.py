"""Programs of the angular frequency, made shorter where it is positive.

Input: a :class:`Piecewise` program of the angular frequency in real arithmetic.
Output: the same without signs of what is positive; and one in tangents of half angles, which need fewer
functions. With t = tan(x/2) and h = tanh(x/2) the frequency equation of a cantilever,

    1 + cos(x) cosh(x),    becomes    2 (1 - t^2 h^2)/((1 + t^2) (1 - h^2)).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, reduce
from math import gcd, lcm
from typing import TYPE_CHECKING

from flint import Ordering, fmpq, fmpq_mpoly_ctx

from symflex.codegen.program import nodes as tree

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from flint import fmpq_mpoly


TWO = tree.RealNumber(Fraction(2))


def for_positive(program: tree.Piecewise) -> tree.Piecewise:
    """Return a program of the angular frequency as one for positive ones, with no power of j above one.

    Values stay the same to the last bit; signs and doublings go where they cost nothing.
    """
    tests = _each(program.tests, _positive)
    conditions = tuple(replace(c, quantity=_everywhere(c.quantity, _positive)) for c in program.conditions)
    turn, is_negative = (program.turn or 0) % 2, (program.turn or 0) > 1
    code = []
    for piece in program.code:
        if piece.is_complex:
            code.append(piece)
            continue
        own = _each(piece.code, _positive)
        if is_negative:
            num, den = own.values
            own = replace(own, values=_negated(num, den, {a.name for a in own.constants}))
        code.append(replace(piece, code=own))
    return replace(program, tests=tests, conditions=conditions, code=tuple(code), turn=turn)


def in_half_angles(program: tree.Piecewise) -> tree.Piecewise | None:
    """Return a program for positive frequencies in tangents of half angles, circular and hyperbolic.

    With ``t = tan(x/2)`` and ``h = tanh(x/2)`` sums of ``exp(-x)``, cosines and sines of one argument are
    polynomials, and short ones. ``None`` unless a piece of one bending wavenumber and one length gets
    shorter.
    """
    found = [None if p.circle or p.is_complex else _half_angles(p) for p in program.code]
    if not any(found):
        return None
    code = tuple(new[0] if new else old for new, old in zip(found, program.code, strict=True))
    conditions = program.conditions
    first = found[program.pieces[0]]
    if len(conditions) == 1 and conditions[0].limit and first is not None and first[1]:
        # Nothing cancels at small arguments: series serve next to zero only, where quotients are limits.
        conditions = (replace(conditions[0], limit=conditions[0].limit * NEXT_TO_ZERO),)
    return replace(program, code=code, conditions=conditions)


def _each(code: tree.Straight, change: Callable[[tree.CodeNode], tree.CodeNode]) -> tree.Straight:
    return tree.Straight(
        tuple(tree.Assignment(a.name, _everywhere(a.value, change)) for a in code.constants),
        tuple(tree.Assignment(a.name, _everywhere(a.value, change)) for a in code.assignments),
        tuple(_everywhere(v, change) for v in code.values),
    )


def _everywhere(node: tree.CodeNode, change: Callable[[tree.CodeNode], tree.CodeNode]) -> tree.CodeNode:
    """Return an expression changed from the leaves up."""
    return change(node.with_children(_everywhere(c, change) for c in node.children))


def _positive(node: tree.CodeNode) -> tree.CodeNode:
    match node:
        case tree.Apply("abs", tree.Laplace()):
            return tree.Laplace()
        case tree.Multiply((factor, tree.Assigned() as x)) if factor == TWO:
            return tree.Add((x, x))
        case tree.Apply(
            function, tree.Negate(tree.Multiply((tree.RealNumber() | tree.ParameterValue() as first, *rest)))
        ):
            return tree.Apply(function, tree.Multiply((tree.Negate(first), *rest)))
    return node


def _negated(
    num: tree.CodeNode, den: tree.CodeNode, constants: set[str]
) -> tuple[tree.CodeNode, tree.CodeNode]:
    """Return numerator and denominator of minus a quotient; the sign goes to a number if there is one."""
    if (above := _signed(num, constants)) is not None:
        return above, den
    if (below := _signed(den, constants)) is not None:
        return num, below
    return tree.Negate(num), den


def _signed(node: tree.CodeNode, constants: set[str]) -> tree.CodeNode | None:
    """Return minus a product whose first factor is a number, ``None`` if it is no such product."""
    match node:
        case tree.RealNumber() | tree.ParameterValue():
            return tree.Negate(node)
        case tree.Assigned(name) if name in constants:
            return tree.Negate(node)
        case tree.Multiply((first, *rest)) if (changed := _signed(first, constants)) is not None:
            return tree.Multiply((changed, *rest))
    return None


# ------------------------------------------------------------------------------------- half angles

NEXT_TO_ZERO = 1e-6
"""Of the square of an argument below which series are used, the part that is left to them."""

CONTEXT = fmpq_mpoly_ctx.get(("t", "other"), Ordering.lex)
"""Polynomials in ``t_half`` and ``decay``; in the end, in t and h."""

T, OTHER = CONTEXT.gens()

_Powers = dict[tree.CodeNode, int]
"""A product of powers of expressions."""

_Value = tuple[_Powers, "fmpq_mpoly"]
"""A product of powers, its sign among them, times a polynomial."""

MINUS: _Value = ({tree.Negate(tree.RealNumber(Fraction(1))): 1}, CONTEXT.constant(1))


def _half_angles(piece: tree.CodePiece) -> tuple[tree.CodePiece, bool] | None:
    """Return a piece in tangents of half angles, and whether nothing cancels where its argument is small.

    ``None`` when it is not of that kind or not shorter.
    """
    reader = _HalfAngleReader({a.name: a.value for a in (*piece.code.constants, *piece.code.assignments)})
    try:
        law, half = reader.argument()
        (front, above), (back, below) = (reader.value(v) for v in piece.code.values)
    except _OtherKindError:
        return None
    if not all(any(not d for _, d in p.monoms()) for p in (above, below)):
        # What decays with the length would be a difference of numbers near one.
        return None
    degree = max(d for p in (above, below) for _, d in p.monoms())
    unit, (above, below) = _primitive([_hyperbolic(p, degree) for p in (above, below)])
    gain = _product((front, CONTEXT.constant(unit)), (back, CONTEXT.constant(1)), -1)
    # omega and mu by x/2 = sqrt(half^2 * law * omega) = half * mu
    omega, mu = gain[0].pop(tree.Laplace(), 0), gain[0].pop(tree.Assigned("mu"), 0)
    power = mu + 2 * omega
    gain = _product(_product(gain, law, -omega), half, -power)
    names = [tree.Assigned(n) for n in ("x_half", "t_half", "h_half", "t_h")]
    x, t, h, both = names
    values = [_sum(p, t, h, both) for p in (above, below)]
    size = _product(({}, CONTEXT.constant(1)), gain, 1 if power >= 0 else -1)
    side = 0 if power >= 0 else 1
    values[side] = tree.Multiply((tree.Assigned("c_gain"), *[x] * abs(power), values[side]))
    constants = (
        tree.Assignment("c_square", _fraction(_product(_product(half, half), law))),
        tree.Assignment("c_gain", _fraction(size)),
    )
    assignments = (
        tree.Assignment(
            "x_half", tree.Apply("sqrt", tree.Multiply((tree.Assigned("c_square"), tree.Laplace())))
        ),
        tree.Assignment("t_half", tree.Apply("tan", x)),
        tree.Assignment("h_half", tree.Apply("tanh", x)),
        tree.Assignment("t_h", tree.Multiply((t, h))),
    )
    code = tree.Straight((*piece.code.constants, *constants), assignments, ()).needed(values)
    if _cost(code) >= _cost(piece.code):
        return None
    return replace(piece, code=code), _is_regular(above) and _is_regular(below)


def _is_regular(polynomial: fmpq_mpoly) -> bool:
    """Tell whether the terms of lowest degree do not cancel where t and h are equal."""
    lowest = min(map(sum, polynomial.monoms()))
    signs = {v > 0 for m, v in polynomial.terms() if sum(m) == lowest}
    return len(signs) == 1


def _cost(code: tree.Straight) -> int:
    roots = [*(a.value for a in code.assignments), *code.values]
    return sum(max(len(n.children) - 1, 0) + isinstance(n, tree.Apply) for r in roots for n in r.walk())


class _OtherKindError(Exception):
    """An expression is no product of powers and a polynomial."""


@dataclass(frozen=True)
class _HalfAngleReader:
    """Reads a piece's expressions as products of powers and polynomials of ``t_half`` and ``decay``."""

    values: Mapping[str, tree.CodeNode]

    def argument(self) -> tuple[_Value, _Value]:
        """Return mu^2/omega and half the argument over mu."""
        applied = [n for v in self.values.values() for n in v.walk() if isinstance(n, tree.Apply)]
        functions = sorted(n.function for n in applied if any(self._varies(c) for c in n.children))
        match self.values.get("mu"), self.values.get("t_half"), self.values.get("decay"):
            case tree.Apply("sqrt", square), tree.Apply("tan", angle), tree.Apply("exp", exponent):
                law, half, whole = (self.value(n) for n in (square, angle, exponent))
            case _:
                raise _OtherKindError
        powers, quotient = _product(whole, half, -1)
        is_such = (
            functions == ["exp", "sqrt", "tan"] and powers == MINUS[0] and quotient == CONTEXT.constant(2)
        )
        is_linear = half[0].pop(tree.Assigned("mu"), 0) == 1 and law[0].pop(tree.Laplace(), 0) == 1
        if not is_such or not is_linear or any(self._varies(n) for n in (*law[0], *half[0])):
            raise _OtherKindError
        return law, half

    def _varies(self, node: tree.CodeNode) -> bool:
        return any(
            isinstance(n, tree.Laplace) or (isinstance(n, tree.Assigned) and n.name in self._varying)
            for n in node.walk()
        )

    @cached_property
    def _varying(self) -> set[str]:
        """The names of values that depend on the frequency."""
        found: set[str] = set()
        for name, value in self.values.items():  # each is made of earlier ones
            for n in value.walk():
                if isinstance(n, tree.Laplace) or (isinstance(n, tree.Assigned) and n.name in found):
                    found.add(name)
                    break
        return found

    @cached_property
    def _known(self) -> dict[str, _Value]:
        """Values by name, which are asked for wherever the name occurs."""
        return {}

    def value(self, node: tree.CodeNode) -> _Value:
        """Return the value of an expression; sums and functions free of s count as symbols."""
        match node:
            case tree.RealNumber(number, 0):
                return {}, CONTEXT.constant(number.numerator) / number.denominator
            case tree.Assigned("t_half"):
                return {}, T
            case tree.Assigned("decay"):
                return {}, OTHER
            case tree.Assigned(name) if name != "mu":
                named = self.values[name]
                if name in self._varying or not isinstance(named, tree.Apply | tree.Add):
                    if name not in self._known:
                        self._known[name] = self.value(named)
                    powers, polynomial = self._known[name]
                    return dict(powers), polynomial
            case tree.Negate(operand):
                return _product(self.value(operand), MINUS)
            case tree.Divide(above, below):
                return _product(self.value(above), self.value(below), -1)
            case tree.IntegerPower(base, exponent):
                return _product(({}, CONTEXT.constant(1)), self.value(base), exponent)
            case tree.Multiply(factors):
                return reduce(_product, map(self._part, factors))
            case tree.Add(terms) if self._varies(node):
                parts = [self._part(x) for x in terms]
                if not any(powers for powers, _ in parts):
                    return {}, sum((p for _, p in parts), CONTEXT.constant(0))
        if self._varies(node) and node not in (tree.Laplace(), tree.Assigned("mu")):
            raise _OtherKindError
        return {node: 1}, CONTEXT.constant(1)

    def _part(self, node: tree.CodeNode) -> _Value:
        """Return the value of a part of an expression; minus a polynomial is a polynomial."""
        powers, polynomial = self.value(node)
        return ({}, -polynomial) if powers == MINUS[0] else (powers, polynomial)


def _product(left: _Value, right: _Value, power: int = 1) -> _Value:
    """Return ``left * right**power``."""
    if power < 0 and not right[1].is_constant():
        raise _OtherKindError
    powers = dict(left[0])
    for node, exponent in right[0].items():
        powers[node] = powers.get(node, 0) + exponent * power
    polynomial = left[1] * right[1] ** power if power >= 0 else left[1] / right[1] ** -power
    return {n: e for n, e in powers.items() if (e % 2 if n in MINUS[0] else e)}, polynomial


def _fraction(value: _Value) -> tree.CodeNode:
    """Return a product of powers and a number as an expression."""
    powers = {node: exponent for node, exponent in value[0].items() if node not in MINUS[0]}
    number = value[1].leading_coefficient()
    sides: list[list[tree.CodeNode]] = [[], []]
    for own, whole in zip(sides, (int(number.p), int(number.q)), strict=True):
        own.extend([tree.RealNumber(Fraction(whole))] if whole != 1 else [])
    for node, exponent in powers.items():
        sides[exponent < 0].append(node if abs(exponent) == 1 else tree.IntegerPower(node, abs(exponent)))
    above, below = map(_multiplied, sides)
    whole_node = tree.Divide(above, below) if sides[1] else above
    return whole_node if len(powers) == len(value[0]) else tree.Negate(whole_node)


def _multiplied(factors: Sequence[tree.CodeNode]) -> tree.CodeNode:
    """Return a product; of no factors, one."""
    if len(factors) == 1:
        return factors[0]
    return tree.Multiply(tuple(factors)) if factors else tree.RealNumber(Fraction(1))


def _hyperbolic(polynomial: fmpq_mpoly, degree: int) -> fmpq_mpoly:
    """Return ``(1 + h)**degree`` times a polynomial in t and ``d = (1 - h)/(1 + h)``, in t and h."""
    terms = (T**i * (1 - OTHER) ** j * (1 + OTHER) ** (degree - j) * c for (i, j), c in polynomial.terms())
    return sum(terms, CONTEXT.constant(0))


def _primitive(polynomials: Sequence[fmpq_mpoly]) -> tuple[fmpq, list[fmpq_mpoly]]:
    """Return the quotient of the contents, and polynomials with whole coefficients that share nothing."""
    sizes = [
        fmpq(gcd(*(int(x.p) for x in p.coeffs())), lcm(*(int(x.q) for x in p.coeffs()))) for p in polynomials
    ]
    return sizes[0] / sizes[1], [p / size for p, size in zip(polynomials, sizes, strict=True)]


def _sum(polynomial: fmpq_mpoly, t: tree.CodeNode, h: tree.CodeNode, both: tree.CodeNode) -> tree.CodeNode:
    """Return a polynomial in t and h by powers of their product."""
    groups: dict[int, list[tree.CodeNode]] = {}
    for (i, j), coefficient in sorted(polynomial.terms()):
        number, shared = Fraction(int(coefficient.p), int(coefficient.q)), min(i, j)
        factors = [*([t] * (i - shared)), *([h] * (j - shared))]
        if abs(number) != 1 or not factors:
            factors.insert(0, tree.RealNumber(abs(number)))
        term = _multiplied(factors)
        groups.setdefault(shared, []).append(term if number > 0 else tree.Negate(term))
    summands: list[tree.CodeNode] = []
    for shared, terms in sorted(groups.items()):
        inner = _total(terms)
        minus = isinstance(inner, tree.Negate)
        size = inner.operand if isinstance(inner, tree.Negate) else inner
        factors = [both] * shared
        if not (shared and size == tree.RealNumber(Fraction(1))):
            factors.append(size)
        product = _multiplied(factors)
        summands.append(tree.Negate(product) if minus else product)
    return _total(summands)


def _total(terms: Sequence[tree.CodeNode]) -> tree.CodeNode:
    """Return a sum; a term without minus sign comes first when there is one."""
    if len(terms) == 1:
        return terms[0]
    first = next((t for t in terms if not isinstance(t, tree.Negate)), None)
    if first is None:
        return tree.Negate(_total([t.operand for t in terms if isinstance(t, tree.Negate)]))
    rest = [t for t in terms if t is not first]
    return tree.Add((first, *rest))

"""Programs of the angular frequency, made shorter where it is positive.

Input: a :class:`Piecewise` program of the angular frequency in real arithmetic.
Output: the same without signs of what is positive; and one in tangents of half angles, which need fewer
functions. With t = tan(x/2) and h = tanh(x/2) the frequency equation of a cantilever,

    1 + cos(x) cosh(x),    becomes    2 (1 - t^2 h^2)/((1 + t^2) (1 - h^2)).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from math import comb, gcd, lcm
from typing import TYPE_CHECKING

from symflex.codegen.program.nodes import (
    Add,
    Apply,
    Assigned,
    Assignment,
    CodeNode,
    CodePiece,
    Divide,
    IntegerPower,
    Laplace,
    Multiply,
    Negate,
    ParameterValue,
    Piecewise,
    RealNumber,
    Straight,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence


TWO = RealNumber(Fraction(2))


def for_positive(program: Piecewise) -> Piecewise:
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


def in_half_angles(program: Piecewise) -> Piecewise | None:
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


def _each(code: Straight, change: Callable[[CodeNode], CodeNode]) -> Straight:
    return Straight(
        tuple(Assignment(a.name, _everywhere(a.value, change)) for a in code.constants),
        tuple(Assignment(a.name, _everywhere(a.value, change)) for a in code.assignments),
        tuple(_everywhere(v, change) for v in code.values),
    )


def _everywhere(node: CodeNode, change: Callable[[CodeNode], CodeNode]) -> CodeNode:
    """Return an expression changed from the leaves up."""
    return change(node.with_children(_everywhere(c, change) for c in node.children))


def _positive(node: CodeNode) -> CodeNode:
    match node:
        case Apply("abs", Laplace()):
            return Laplace()
        case Multiply((factor, Assigned() as x)) if factor == TWO:
            return Add((x, x))
        case Apply(function, Negate(Multiply((RealNumber() | ParameterValue() as first, *rest)))):
            return Apply(function, Multiply((Negate(first), *rest)))
    return node


def _negated(num: CodeNode, den: CodeNode, constants: set[str]) -> tuple[CodeNode, CodeNode]:
    """Return numerator and denominator of minus a quotient; the sign goes to a number if there is one."""
    if (above := _signed(num, constants)) is not None:
        return above, den
    if (below := _signed(den, constants)) is not None:
        return num, below
    return Negate(num), den


def _signed(node: CodeNode, constants: set[str]) -> CodeNode | None:
    """Return minus a product whose first factor is a number, ``None`` if it is no such product."""
    match node:
        case RealNumber() | ParameterValue():
            return Negate(node)
        case Assigned(name) if name in constants:
            return Negate(node)
        case Multiply((first, *rest)) if (changed := _signed(first, constants)) is not None:
            return Multiply((changed, *rest))
    return None


# ------------------------------------------------------------------------------------- half angles

NEXT_TO_ZERO = 1e-6
"""Of the square of an argument below which series are used, the part that is left to them."""

_Monomial = tuple[Fraction, dict[CodeNode, int]]
_Polynomial = dict[tuple[int, int], Fraction]


def _half_angles(piece: CodePiece) -> tuple[CodePiece, bool] | None:
    """Return a piece in tangents of half angles, and whether nothing cancels where its argument is small.

    ``None`` when it is not of that kind or not shorter.
    """
    reader = _HalfAngleReader({a.name: a.value for a in (*piece.code.constants, *piece.code.assignments)})
    found = reader.found()
    if found is None:
        return None
    law, half = found
    sides = [reader.split(v) for v in piece.code.values]
    if any(s is None for s in sides):
        return None
    (front, above), (back, below) = (s for s in sides if s is not None)
    if not all(any(not d for _, d in p) for p in (above, below)):
        # What decays with the length would be a difference of numbers near one.
        return None
    degree = max(d for p in (above, below) for _, d in p)
    unit, (above, below) = _primitive([_hyperbolic(p, degree) for p in (above, below)])
    gain = _product((unit, {}), _product(front, back, -1))
    # omega and mu by x/2 = sqrt(half^2 * law * omega) = half * mu
    omega, mu = gain[1].pop(Laplace(), 0), gain[1].pop(reader.mu, 0)
    power = mu + 2 * omega
    gain = _product(gain, law, -omega)
    gain = _product(gain, half, -power)
    square = _fraction(_product(_product(half, half), law))
    names = [Assigned(n) for n in ("x_half", "t_half", "h_half", "t_h")]
    x, t, h, both = names
    constants = [Assignment("c_square", square)]
    values = [_sum(p, t, h, both) for p in (above, below)]
    size = _product((Fraction(1), {}), gain, 1 if power >= 0 else -1)
    constants.append(Assignment("c_gain", _fraction(size)))
    side = 0 if power >= 0 else 1
    values[side] = Multiply((Assigned("c_gain"), *[x] * abs(power), values[side]))
    assignments = [
        Assignment("x_half", Apply("sqrt", Multiply((Assigned("c_square"), Laplace())))),
        Assignment("t_half", Apply("tan", x)),
        Assignment("h_half", Apply("tanh", x)),
        Assignment("t_h", Multiply((t, h))),
    ]
    whole = Straight((*piece.code.constants, *constants), tuple(assignments), ())
    code = whole.needed(values)
    if _cost(code) >= _cost(piece.code):
        return None
    return replace(piece, code=code), _is_regular(above) and _is_regular(below)


def _is_regular(polynomial: _Polynomial) -> bool:
    """Tell whether the terms of lowest degree do not cancel where t and h are equal."""
    lowest = min(i + j for i, j in polynomial)
    signs = {v > 0 for (i, j), v in polynomial.items() if i + j == lowest}
    return len(signs) == 1


def _cost(code: Straight) -> int:
    roots = [*(a.value for a in code.assignments), *code.values]
    return sum(max(len(n.children) - 1, 0) + isinstance(n, Apply) for r in roots for n in r.walk())


@dataclass(frozen=True)
class _HalfAngleReader:
    """Reads a piece's expressions as products of powers and polynomials of ``t_half`` and ``decay``."""

    values: Mapping[str, CodeNode]

    @property
    def mu(self) -> CodeNode:
        return Assigned("mu")

    def found(self) -> tuple[_Monomial, _Monomial] | None:
        """Return mu^2/omega and half the argument over mu, if there is one of each."""
        applied = [n for v in self.values.values() for n in v.walk() if isinstance(n, Apply)]
        functions = [n.function for n in applied if any(self._varies(c) for c in n.children)]
        match self.values.get("mu"), self.values.get("t_half"), self.values.get("decay"):
            case Apply("sqrt", square), Apply("tan", angle), Apply("exp", exponent):
                pass
            case _:
                return None
        law, half, whole = (self.monomial(n) for n in (square, angle, exponent))
        if sorted(functions) != ["exp", "sqrt", "tan"] or law is None or half is None or whole is None:
            return None
        if _product(whole, half, -1) != (Fraction(-2), dict[CodeNode, int]()) or half[1].pop(self.mu, 0) != 1:
            return None
        if law[1].pop(Laplace(), 0) != 1 or any(self._varies(n) for n in (*law[1], *half[1])):
            return None
        return law, half

    def _varies(self, node: CodeNode) -> bool:
        return any(
            isinstance(n, Laplace) or (isinstance(n, Assigned) and self._varies(self.values[n.name]))
            for n in node.walk()
        )

    def monomial(self, node: CodeNode) -> _Monomial | None:
        """Return an expression as a product of powers; sums and functions free of s count as symbols."""
        match node:
            case RealNumber(value, 0):
                return value, {}
            case Negate(operand):
                inner = self.monomial(operand)
                return None if inner is None else (-inner[0], inner[1])
            case Multiply(factors):
                result: _Monomial | None = (Fraction(1), {})
                for factor in factors:
                    own = self.monomial(factor)
                    result = None if result is None or own is None else _product(result, own)
                return result
            case Divide(above, below):
                left, right = self.monomial(above), self.monomial(below)
                return None if left is None or right is None else _product(left, right, -1)
            case IntegerPower(base, exponent):
                inner = self.monomial(base)
                return None if inner is None else _product((Fraction(1), {}), inner, exponent)
            case Assigned(name) if name not in ("mu", "t_half", "decay"):
                named = self.values[name]
                is_symbol = isinstance(named, Apply | Add) and not self._varies(named)
                return (Fraction(1), {node: 1}) if is_symbol else self.monomial(named)
            case Assigned("mu") | ParameterValue() | RealNumber() | Laplace():
                return Fraction(1), {node: 1}
        return None if self._varies(node) else (Fraction(1), {node: 1})

    def split(self, node: CodeNode) -> tuple[_Monomial, _Polynomial] | None:
        """Return an expression as a product of powers times a polynomial with numbers for coefficients."""
        if isinstance(node, Negate):
            inner = self.split(node.operand)
            return None if inner is None else (_product((Fraction(-1), {}), inner[0]), inner[1])
        factors = node.factors if isinstance(node, Multiply) else (node,)
        front: _Monomial = (Fraction(1), {})
        rest: _Polynomial = {(0, 0): Fraction(1)}
        for factor in factors:
            polynomial = self.polynomial(factor)
            if polynomial is not None:
                rest = _convolved(rest, polynomial)
                continue
            if isinstance(factor, Multiply):
                inner = self.split(factor)
                if inner is None:
                    return None
                front, rest = _product(front, inner[0]), _convolved(rest, inner[1])
                continue
            own = self.monomial(factor)
            if own is None:
                return None
            front = _product(front, own)
        return front, rest

    def polynomial(self, node: CodeNode) -> _Polynomial | None:
        """Return a polynomial in ``t_half`` and ``decay``."""
        match node:
            case RealNumber(value, 0):
                return {(0, 0): value}
            case Assigned("t_half"):
                return {(1, 0): Fraction(1)}
            case Assigned("decay"):
                return {(0, 1): Fraction(1)}
            case Assigned("mu"):
                return None
            case Assigned(name):
                return self.polynomial(self.values[name])
            case Negate(operand):
                inner = self.polynomial(operand)
                return None if inner is None else {k: -v for k, v in inner.items()}
            case Add(parts) | Multiply(parts):
                polynomials = [p for x in parts if (p := self.polynomial(x)) is not None]
                if len(polynomials) < len(parts):
                    return None
                result = polynomials[0]
                for p in polynomials[1:]:
                    result = _convolved(result, p) if isinstance(node, Multiply) else _added(result, p)
                return result
        return None


def _product(left: _Monomial, right: _Monomial, power: int = 1) -> _Monomial:
    """Return ``left * right**power``."""
    symbols = dict(left[1])
    for node, exponent in right[1].items():
        symbols[node] = symbols.get(node, 0) + exponent * power
    return left[0] * right[0] ** power, {n: e for n, e in symbols.items() if e}


def _fraction(value: _Monomial) -> CodeNode:
    """Return a product of powers as an expression."""
    number, symbols = value
    sides: list[list[CodeNode]] = [[], []]
    for side, whole in enumerate((abs(number.numerator), number.denominator)):
        if whole != 1:
            sides[side].append(RealNumber(Fraction(whole)))
    for node, exponent in symbols.items():
        sides[exponent < 0].append(node if abs(exponent) == 1 else IntegerPower(node, abs(exponent)))
    above, below = (
        own[0] if len(own) == 1 else Multiply(tuple(own)) if own else RealNumber(Fraction(1)) for own in sides
    )
    whole_node = Divide(above, below) if sides[1] else above
    return Negate(whole_node) if number < 0 else whole_node


def _added(left: _Polynomial, right: _Polynomial) -> _Polynomial:
    keys = dict.fromkeys((*left, *right))
    zero = Fraction(0)
    return {k: v for k in keys if (v := left.get(k, zero) + right.get(k, zero))}


def _convolved(left: _Polynomial, right: _Polynomial) -> _Polynomial:
    result: _Polynomial = {}
    for (a, b), x in left.items():
        result = _added(result, {(a + c, b + d): x * y for (c, d), y in right.items()})
    return result


def _hyperbolic(polynomial: _Polynomial, degree: int) -> _Polynomial:
    """Return ``(1 + h)**degree`` times a polynomial in t and ``d = (1 - h)/(1 + h)``, in t and h."""
    result: _Polynomial = {}
    for (i, j), number in polynomial.items():
        falling = {(0, k): Fraction(comb(j, k) * (-1) ** k) for k in range(j + 1)}
        rising = {(0, k): Fraction(comb(degree - j, k)) for k in range(degree - j + 1)}
        result = _added(result, _convolved({(i, 0): number}, _convolved(falling, rising)))
    return result


def _primitive(polynomials: Sequence[_Polynomial]) -> tuple[Fraction, list[_Polynomial]]:
    """Return the quotient of the contents, and polynomials with whole coefficients that share nothing."""
    unit, found = Fraction(1), []
    for side, polynomial in enumerate(polynomials):
        numbers = list(polynomial.values())
        size = Fraction(gcd(*(x.numerator for x in numbers)), lcm(*(x.denominator for x in numbers)))
        unit *= size ** (-1 if side else 1)
        found.append({k: v / size for k, v in polynomial.items()})
    return unit, found


def _sum(polynomial: _Polynomial, t: CodeNode, h: CodeNode, both: CodeNode) -> CodeNode:
    """Return a polynomial in t and h by powers of their product."""
    groups: dict[int, list[CodeNode]] = {}
    for (i, j), number in sorted(polynomial.items()):
        shared = min(i, j)
        factors = [*([t] * (i - shared)), *([h] * (j - shared))]
        if abs(number) != 1 or not factors:
            factors.insert(0, RealNumber(abs(number)))
        term: CodeNode = factors[0] if len(factors) == 1 else Multiply(tuple(factors))
        groups.setdefault(shared, []).append(term if number > 0 else Negate(term))
    summands: list[CodeNode] = []
    for shared, terms in sorted(groups.items()):
        inner = _total(terms)
        minus = isinstance(inner, Negate)
        size = inner.operand if isinstance(inner, Negate) else inner
        factors = [both] * shared
        if not (shared and size == RealNumber(Fraction(1))):
            factors.append(size)
        product: CodeNode = factors[0] if len(factors) == 1 else Multiply(tuple(factors))
        summands.append(Negate(product) if minus else product)
    return _total(summands)


def _total(terms: Sequence[CodeNode]) -> CodeNode:
    """Return a sum; a term without minus sign comes first when there is one."""
    if len(terms) == 1:
        return terms[0]
    first = next((t for t in terms if not isinstance(t, Negate)), None)
    if first is None:
        return Negate(_total([t.operand for t in terms if isinstance(t, Negate)]))
    rest = [t for t in terms if t is not first]
    return Add((first, *rest))

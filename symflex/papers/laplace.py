r"""What a paper means in the Laplace domain: which letter is s, and which letters are signals.

Input: trees with the letters of a paper. Output: trees in s, and of equations in s the unknowns, as many as
there are equations, and the inputs.

    1/(j\omega RC + 1)              1/(R*C*s + 1)
    (ms^2 + cs + k)X(s) = F(s)      unknown X, input F

The variable is s, p, D, or a frequency beside the imaginary unit. Each term of a linear equation has one
signal in it. What s multiplies is rather an unknown, and what is called F, u or V rather an input.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from symflex.errors import Span
from symflex.expressions import (
    Call,
    Derivative,
    Expression,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
    is_number,
    names,
    negative,
    nodes,
    power,
    substitute,
)
from symflex.papers.matrices import Matrix, Value, flat_product, unsigned
from symflex.papers.source import PrintedEquation, refusal
from symflex.papers.symbols import IMAGINARY, LAPLACE, PaperNotation, PrintedSymbol


def in_laplace(expressions: Sequence[Expression], notation: PaperNotation) -> tuple[list[Expression], str]:
    """Return expressions in s, and what is s: p, D, or a frequency, if that is all that has no meaning."""
    used = {n.name for e in expressions for n in names(e) if isinstance(n, Name)}
    known = {*notation.names.values(), "pi"}
    if LAPLACE not in used and used & known and used - known in ({"p"}, {"D"}):
        (name,) = used - known
        return [substitute(e, {name: Name(LAPLACE)}) for e in expressions], name
    if LAPLACE not in used and used & known and used - known in ({"omega"}, {"Omega"}):
        (name,) = used - known
        turned = [_turned(e, "j", name) for e in expressions]  # -omega^2 is s^2
        if all(found is not None and not found[1] for found in turned):
            return [found[0] for found in turned if found is not None], name
    return list(expressions), LAPLACE


def laplace_of(statement: PrintedEquation, notation: PaperNotation) -> str:
    """Return what an equation calls the Laplace variable: p or D where it says so and has no s."""
    texts = [t.text for t in statement.tokens]
    for name in ("p", "D"):
        if PrintedSymbol(name) in notation.names or LAPLACE in texts or name not in texts:
            continue
        if any(texts[i : i + 3] == ["(", name, ")"] for i in range(1, len(texts))):
            return name
    return LAPLACE


def settled(value: Value, notation: PaperNotation, span: Span) -> Value:
    r"""Return a tree in s, whatever the paper calls it: ``j\omega`` and powers of ``\omega`` become s."""
    if isinstance(value, Matrix):
        rows = (tuple(_in_s(x, notation, span) for x in row) for row in value.rows)
        return replace(value, rows=tuple(rows))
    return _in_s(value, notation, span)


def _in_s(expression: Expression, notation: PaperNotation, span: Span) -> Expression:
    known = set(notation.names.values())
    used = {n.name for n in names(expression) if isinstance(n, Name)}
    if notation.motion:
        return expression
    units = [u for u in IMAGINARY if u in used and u not in known]
    frequency = next((w for w in ("omega", "Omega") if w in used and w not in known), None)
    if not units:
        return expression
    if frequency is not None and LAPLACE in used:
        raise refusal(
            span, f"s and {units[0]}*{frequency} stand side by side", "name one of them in [notation]"
        )
    if len(units) > 1:
        raise refusal(span, "both i and j look like the imaginary unit", "name one of them in [notation]")
    if frequency is None:
        where = next(n.span for n in nodes(expression) if isinstance(n, Name) and n.name == units[0])
        raise refusal(
            where or span, f"'{units[0]}' looks like the imaginary unit, without a frequency beside it"
        )
    turned = _turned(expression, units[0], frequency)
    if turned is None:
        where = next(n.span for n in nodes(expression) if isinstance(n, Name) and n.name == units[0])
        raise refusal(
            where or span, f"'{units[0]}' does not vanish when {units[0]}*omega is s", "write it with s"
        )
    result, power = turned
    if power:
        raise refusal(span, f"the imaginary unit remains when {units[0]}*omega is s", "write it with s")
    return result


def _turned(node: Expression, unit: str, frequency: str) -> tuple[Expression, int] | None:
    """Return an expression with ``frequency = s/unit``, and the turns of the unit in front, 0 or 1."""

    def times(factor: Expression, turns: int) -> tuple[Expression, int]:
        turns %= 4
        return (negative(factor), turns - 2) if turns > 1 else (factor, turns)

    match node:
        case Name(name):
            if name == unit:
                return Number(Fraction(1), span=node.span), 1
            return times(Name(LAPLACE, span=node.span), 3) if name == frequency else (node, 0)
        case Negative(operand):
            inner = _turned(operand, unit, frequency)
            return None if inner is None else (negative(inner[0]), inner[1])
        case Sum(terms):
            parts = [_turned(t, unit, frequency) for t in terms]
            if None in parts or len({p[1] for p in parts if p is not None}) > 1:
                return None
            whole = [p for p in parts if p is not None]
            return Sum(tuple(p[0] for p in whole), span=node.span), whole[0][1]
        case Product(factors):
            parts = [_turned(f, unit, frequency) for f in factors]
            if None in parts:
                return None
            whole = [p for p in parts if p is not None]
            turns = sum(p[1] for p in whole)
            kept = [p[0] for p in whole if not is_number(p[0], 1)] or [Number(Fraction(1))]
            signs = sum(isinstance(k, Negative) for k in kept)
            product = flat_product([unsigned(k) for k in kept], node.span)
            return times(negative(product) if signs % 2 else product, turns)
        case Quotient(above, below):
            pair = _turned(above, unit, frequency), _turned(below, unit, frequency)
            if pair[0] is None or pair[1] is None:
                return None
            return times(Quotient(pair[0][0], pair[1][0], span=node.span), pair[0][1] - pair[1][1])
        case Power(base, exponent):
            inner = _turned(base, unit, frequency)
            size = _rational(exponent)
            if inner is None or size is None:
                return inner if inner is not None and inner[0] == base and not inner[1] else None
            if size.denominator != 1 or is_number(inner[0], 0):
                return None if inner[1] else (Power(inner[0], exponent, span=node.span), 0)
            return times(power(inner[0], exponent), inner[1] * int(size))
        case Call(name, argument):
            inner = _turned(argument, unit, frequency)
            if inner is None or inner[1]:
                return None
            return Call(name, inner[0], span=node.span), 0
    return node, 0


def _rational(exponent: Expression) -> Fraction | None:
    """Return the value of an exponent such as -1/2, ``None`` if it has names or is no quotient."""
    match exponent:
        case Number(value):
            return value
        case Negative(operand):
            inner = _rational(operand)
            return None if inner is None else -inner
        case Quotient(Number(above), Number(below)):
            return above / below if below else None
    return None


# --- signals ---


@dataclass(frozen=True)
class Signals:
    """The signals of equations in s."""

    unknowns: tuple[str, ...]
    inputs: tuple[str, ...]
    doubt: str = ""  # what else could be so


def terms_of(sides: Sequence[Expression]) -> list[Expression]:
    """Return the terms of both sides that are not zero, without their signs."""
    found = [t for side in sides for t in (side.terms if isinstance(side, Sum) else (side,))]
    bare = (t.operand if isinstance(t, Negative) else t for t in found)
    return [t for t in bare if not is_number(t, 0)]


def signals_in(
    equations: Sequence[Sequence[Expression]], typed: set[str], forces: Sequence[str]
) -> Signals | None:
    """Return the signals of equations; ``None`` if these are no linear equations of signals in s."""
    parts = [terms_of(sides) for sides in equations]
    signals = _typed(parts, typed) or _likely(parts)
    if not signals or any(degree(term, signals) != 1 for terms in parts for term in terms):
        return None
    every = [term for terms in parts for term in terms]
    in_order = list(dict.fromkeys(name for term in every for name in _names(term) if name in signals))
    multiplied = {name for term in every if _has_s(term) for name in signals & _held(term)}

    def rank(name: str) -> tuple[bool, bool]:
        stem = name.split("_", maxsplit=1)[0]
        return name in multiplied, stem not in forces and stem.lower() not in forces

    def places(name: str) -> int:
        return sum(any(name in _held(t) for t in terms) for terms in parts)

    ranked = sorted(in_order, key=lambda name: (*rank(name), places(name)))
    count = len(signals) - len(equations)
    if count < 0:
        return Signals(tuple(in_order), (), f"{len(equations)} equations for {len(in_order)} signals")
    inputs = ranked[:count]
    doubt = ""
    if inputs and count < len(ranked) and rank(inputs[-1]) == rank(ranked[count]):
        doubt = (
            f"{inputs[-1]} is taken as an input, and {ranked[count]} as an unknown; it may be the other way"
        )
    kept = [name for name in in_order if name not in inputs]
    return Signals(tuple(kept), tuple(name for name in in_order if name in inputs), doubt)


def degree(node: Expression, signals: Collection[str]) -> int:
    """Return the degree of a term in signals and their derivatives; 2 stands for what is not linear."""
    match node:
        case Derivative():
            return 1
        case Name(name):
            return int(name in signals)
        case Product(factors):
            return sum(degree(factor, signals) for factor in factors)
        case Sum(terms):
            return max(degree(term, signals) for term in terms)
        case Quotient(above, below):
            return degree(above, signals) + 2 * degree(below, signals)
        case Power(base, _):
            return 2 * degree(base, signals)
        case Call():
            return 2 * max((degree(child, signals) for child in node.children), default=0)
        case Negative(operand):
            return degree(operand, signals)
    return 0


def is_ratio(sides: Sequence[Expression], typed: set[str]) -> bool:
    """Tell whether an equation gives a transfer function, and is none of motion."""
    return any(isinstance(t, Quotient) and _held(t.denominator) & typed for t in terms_of(sides))


def _has_s(node: Expression) -> bool:
    """Tell whether s multiplies a signal; below a line it does not."""
    if isinstance(node, Quotient):
        return _has_s(node.numerator)
    return (isinstance(node, Name) and node.name == LAPLACE) or any(map(_has_s, node.children))


def _names(term: Expression) -> list[str]:
    return [n.name for n in names(term) if isinstance(n, Name)]


def _held(term: Expression) -> set[str]:
    return set(_names(term))


def _typed(parts: Sequence[Sequence[Expression]], typed: set[str]) -> set[str]:
    return {name for terms in parts for term in terms for name in _held(term)} & typed


def _likely(parts: Sequence[Sequence[Expression]]) -> set[str]:
    """Return what stands alone in a term, or beside a bracket with s, and what is common to all others."""
    found: set[str] = set()
    for term in (t for terms in parts for t in terms):
        factors = term.factors if isinstance(term, Product) else (term,)
        plain = {f.name for f in factors if isinstance(f, Name)} - {LAPLACE}
        if len(factors) == len(plain) == 1 or any(
            isinstance(f, Sum) and LAPLACE in _held(f) for f in factors
        ):
            found |= plain
    left = [_held(t) - {LAPLACE} for terms in parts for t in terms if not _held(t) & found]
    common = set.intersection(*left) if left else set()
    return found | common if len(common) == bool(left) else set()

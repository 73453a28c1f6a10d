r"""Which symbols of equations in s are signals, which of these are unknown, and which act.

Input: both sides of each equation, and what the paper writes as a function of s.
Output: unknowns, as many as there are equations, and inputs.

    (ms^2 + cs + k)X(s) = F(s)      unknown X, input F

Each term of a linear equation has one signal in it. What s multiplies is rather an unknown, and what is
called F, u or V rather an input.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from symflex.expressions import (
    Call,
    Derivative,
    Expression,
    Name,
    Negative,
    Power,
    Product,
    Quotient,
    Sum,
    is_number,
    names,
)
from symflex.papers.symbols import LAPLACE


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

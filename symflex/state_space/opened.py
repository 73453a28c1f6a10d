"""A model written so that every filter's states are its own.

Input: a model. Output: the same model without definitions, and with a signal for what each filter puts out.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import chain, count
from typing import TypeGuard

from symflex.algebra import LAPLACE
from symflex.errors import BudgetError, Diagnostic
from symflex.expressions import (
    Attribute,
    Equation,
    Expression,
    Name,
    Negative,
    Product,
    Quotient,
    Sum,
    format_expression,
    names,
    names_among,
    negative,
    nodes,
    product_of,
    quotient,
    substitute,
    sum_of,
)
from symflex.library.blocks import BLOCKS
from symflex.model import Input, Model, Output, Signal
from symflex.model.model import rewritten

PARTS_LIMIT = 100_000  # parts that an expression may have once its definitions are opened


def opened(model: Model) -> Model:
    """Return a model of the same behaviour without definitions; SF501 when they are too large to be opened.

    A definition may hold a denominator in s that only shows when it is opened.
    """
    if not model.definitions:
        return model
    meanings: dict[str, Expression] = {}
    sizes: dict[str, int] = {}
    for definition in model.definitions:
        meanings[definition.name] = _opened(definition.expression, meanings, sizes)
        sizes[definition.name] = len(nodes(meanings[definition.name]))

    return rewritten(replace(model, definitions=()), lambda e: _opened(e, meanings, sizes))


def with_filters_apart(model: Model) -> Model:
    """Return a model of the same behaviour in which blocks and filters stand one after, or beside, another.

    ``y = G_1*G_2*u`` becomes a signal for ``G_2*u`` and one for ``G_1`` times that; in ``c = k*e + k_i/s*e``
    the integral becomes a signal of its own. The model has no definitions.
    """
    splitter = _Splitter(model)
    signals = tuple(replace(x, expression=splitter.apart(x.name, x.expression)) for x in model.signals)
    outputs = tuple(replace(o, expression=splitter.apart(o.name, o.expression)) for o in model.outputs)
    elements = tuple(
        replace(
            e,
            values=tuple(
                (name, splitter.apart(e.name, value) if name in driven else value) for name, value in e.values
            ),
        )
        for e in model.elements
        for driven in [{p.name for p in e.element.parameters if p.signal}]
    )
    if not splitter.added:
        return model
    return replace(model, elements=elements, signals=(*signals, *splitter.added), outputs=outputs)


def without_delays(model: Model) -> tuple[Model, dict[str, tuple[str, Expression]]]:
    """Return a model cut at its delays, whose parts are rational, and where.

    What leaves a delay is an input of the cut model; by its name, the output that enters there, and T.
    """
    apart, late = with_filters_apart(opened(model)), {}
    times = {b.name: dict(b.values)["T"] for b in apart.blocks if b.block is BLOCKS["delay"]}
    inputs, outputs, signals = list(model.inputs), list(apart.outputs), list[Signal]()
    for x in apart.signals:
        match x.expression:
            case Product(factors) if delays := [
                f for f in factors if isinstance(f, Name) and f.name in times
            ]:
                late[x.name] = (f"{x.name}_ahead", sum_of(times[f.name] for f in delays))
                inputs.append(Input(x.name, "signal"))
                outputs.append(Output(late[x.name][0], product_of(f for f in factors if f not in delays)))
            case _:
                signals.append(x)
    cut = replace(apart, inputs=tuple(inputs), outputs=tuple(outputs), signals=tuple(signals))
    used = {n.name for _, e in cut.expressions() for n in names(e)}
    blocks = tuple(b for b in cut.blocks if b.name not in times or b.name in used)
    return (replace(cut, blocks=blocks) if late else model), late


def _opened(expression: Expression, known: Mapping[str, Expression], sizes: Mapping[str, int]) -> Expression:
    used = names_among(expression, known)
    if sum(sizes[name] for name in used) > PARTS_LIMIT:
        message = f"an expression would have more than {PARTS_LIMIT} parts with its definitions inserted"
        hint = "make a signal of what is used often: signals are not inserted"
        raise BudgetError(Diagnostic("SF501", message, expression.span, hint))
    return substitute(expression, known) if used else expression


class _Splitter:
    """Puts what each block or filter makes of something into a signal of its own."""

    def __init__(self, model: Model) -> None:
        self.added: list[Signal] = []
        self._blocks = {b.name for b in model.blocks}
        groups = (model.nodes, model.signals, model.inputs)
        self._varying = {item.name for group in groups for item in group}
        fixed = (model.parameters, model.elements, model.outputs, model.blocks)
        self._taken = self._varying | {item.name for group in fixed for item in group}

    def apart(self, owner: str, expression: Expression) -> Expression:
        """Return an expression with signals, named by ``owner``, for blocks, and filters in a sum."""
        match expression:
            case Sum(terms):
                denominators = [_denominators(t) for t in terms]
                parts: list[Expression] = []
                for i, term in enumerate(terms):
                    part = self.apart(owner, term)
                    others = {d for j, own in enumerate(denominators) if j != i for d in own}
                    # Filters that share a denominator have its states together.
                    if self._varies(term) and denominators[i] and not denominators[i] & others:
                        is_negative = isinstance(part, Negative)
                        inner = part.operand if isinstance(part, Negative) else part
                        name = Name(self._signal(f"{owner}_{i + 1}", inner))
                        part = negative(name) if is_negative else name
                    parts.append(part)
                return sum_of(parts)
            case Negative(operand):
                return negative(self.apart(owner, operand))
            case Equation(left, right):
                return replace(expression, left=self.apart(owner, left), right=self.apart(owner, right))
            case Quotient(numerator, denominator):
                return quotient(self.apart(owner, numerator), denominator)
            case Product(factors) if over := [
                f for f in factors if isinstance(f, Quotient) and any(map(self._is_block, nodes(f.numerator)))
            ]:
                above = product_of([over[0].numerator, *(f for f in factors if f is not over[0])])
                return self.apart(owner, quotient(above, over[0].denominator))
            case Product(factors) if wide := [f for f in factors if self._is_sum_of_blocks(f)]:
                inner = self.apart(owner, product_of(f for f in factors if f is not wide[0]))
                name = Name(self._signal(f"{owner}_in", inner))
                return self.apart(owner, sum_of(product_of([t, name]) for t in wide[0].children))
            case Product(factors) if any(self._varies(f) for f in factors):
                applied = [f.name for f in factors if self._is_block(f)]
                value = product_of(
                    self.apart(owner, f) if self._varies(f) else f for f in factors if not self._is_block(f)
                )
                for block in reversed(applied):
                    value = Name(self._signal(f"{block}_out", product_of([Name(block), value])))
                return value
        return expression

    def _is_block(self, expression: Expression) -> TypeGuard[Name]:
        return isinstance(expression, Name) and expression.name in self._blocks

    def _is_sum_of_blocks(self, expression: Expression) -> bool:
        is_constant = isinstance(expression, Sum) and not self._varies(expression)
        return is_constant and any(map(self._is_block, nodes(expression)))

    def _varies(self, expression: Expression) -> bool:
        return any(
            isinstance(n, Attribute) or (isinstance(n, Name) and n.name in self._varying)
            for n in names(expression)
        )

    def _signal(self, wanted: str, expression: Expression) -> str:
        """Add a signal with a name that nothing has."""
        candidates = chain([wanted], (f"{wanted}_{number}" for number in count(2)))
        name = next(x for x in candidates if x not in self._taken)
        self._taken.add(name)
        self._varying.add(name)
        self.added.append(Signal(name, expression))
        return name


def _denominators(expression: Expression) -> set[str]:
    """Return the factors in s that a term of a sum is divided by, as text."""
    denominators: set[str] = set()
    pending = [expression]
    while pending:
        node = pending.pop()
        match node:
            case Negative(operand):
                pending.append(operand)
            case Product(factors):
                pending.extend(factors)
            case Quotient(numerator, denominator):
                pending.append(numerator)
                parts = denominator.factors if isinstance(denominator, Product) else (denominator,)
                denominators |= {format_expression(f) for f in parts if names_among(f, (LAPLACE,))}
    return denominators

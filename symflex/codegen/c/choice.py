"""The choice among the pieces of a program, as C text."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from symflex.codegen.c.expression import Kind, Term, product
from symflex.codegen.c.scope import POSITIVE, STEP, Body
from symflex.codegen.program import Condition, Piecewise, RealNumber

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence


def conditions_of(program: Piecewise, scope: Body, varying: Body | None = None) -> list[str]:
    """Print what conditions need, and return the conditions; limits go to the outer scope."""
    inner = varying or scope
    fixed = program.tests.needed([c.scale for c in program.conditions])
    scope.assign(fixed.constants)
    limits = [limit_text(c, scope) for c in program.conditions]
    varied = program.tests.needed([c.quantity for c in program.conditions])
    scope.assign(varied.constants)
    if varying is not None:
        inner.known = dict(scope.known)
    inner.assign(varied.assignments)
    conditions = []
    for condition, limit in zip(program.conditions, limits, strict=True):
        quantity = inner.term(condition.quantity)
        if not condition.limit:
            left = product(inner.term(condition.scale), quantity)
            text = {Kind.COMPLEX: f"{left.text}.re", Kind.REAL: left.text, Kind.IMAGINARY: "0.0"}[left.kind]
            conditions.append(f"{text} < 0.0")
            continue
        size = {
            Kind.COMPLEX: f"cx_abs({quantity.text})",
            Kind.REAL: quantity.text if quantity == POSITIVE else f"fabs({quantity.text})",
            Kind.IMAGINARY: f"fabs({quantity.text})",
        }[quantity.kind]
        conditions.append(f"{size} < {limit}")
    return conditions


def limit_text(condition: Condition, scope: Body) -> str:
    """Return the text of a limit, a variable unless it is a number."""
    if not condition.limit or condition.scale == RealNumber(Fraction(1)):
        return repr(condition.limit)
    scale = scope.term(condition.scale)
    size = f"cx_abs({scale.text})" if scale.kind is Kind.COMPLEX else f"fabs({scale.text})"
    return scope.hold("limit", Term(f"{condition.limit!r} / {size}", Kind.REAL)).text


def choose(
    program: Piecewise,
    conditions: Sequence[str],
    scope: Body,
    body: Callable[[int, Body], None],
) -> None:
    """Print the choice among pieces: test i adds ``2**i`` to the number of the piece."""
    indent = STEP * scope.depth
    if len(set(program.pieces)) == 1:
        body(program.pieces[0], scope)
        return
    if len(conditions) == 1:
        for at, opening in ((1, f"if ({conditions[0]}) {{"), (0, "} else {")):
            scope.lines.append(indent + opening)
            block = scope.within()
            body(program.pieces[at], block)
            scope.lines += block.lines
        scope.lines.append(f"{indent}}}")
        return
    names = []
    for i, test in enumerate(conditions):
        name = scope.name(f"test_{i}")
        scope.say(f"const int {name} =", test)
        names.append(f"{2**i} * {name}" if i else name)
    scope.lines.append(f"{indent}switch ({' + '.join(names)}) {{")
    default = program.pieces[0]
    for k in sorted({*program.pieces} - {default}):
        scope.lines += [f"{indent}case {n}:" for n, piece in enumerate(program.pieces) if piece == k]
        _case(k, scope, body)
    scope.lines.append(f"{indent}default:")
    _case(default, scope, body)
    scope.lines.append(f"{indent}}}")


def _case(k: int, scope: Body, body: Callable[[int, Body], None]) -> None:
    indent = STEP * scope.depth
    block = scope.within()
    body(k, block)
    returns = block.lines and block.lines[-1].lstrip().startswith("return")
    if returns and len(block.lines) == 1:
        scope.lines += block.lines
        return
    scope.lines[-1] += " {"
    scope.lines += [*block.lines, *([] if returns else [f"{indent}{STEP}break;"]), f"{indent}}}"]

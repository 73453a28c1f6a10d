"""The relations of the square roots among functions of constants."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

from symflex.algebra import Factored, Radicals, Ring
from symflex.expressions import Call, Expression, fold, format_expression
from symflex.model.along import COORDINATE, varies_along_x
from symflex.model.linearity import integer_exponent

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from symflex.equations.equations import ConstantFunction
    from symflex.model import ModelParameter


def radicals_of(
    ring: Ring,
    constants: Sequence[ConstantFunction],
    parameters: Sequence[ModelParameter],
    value: Callable[[str], Factored] | None = None,
) -> Radicals:
    """Return the relations over a ring of the roots that are among its generators.

    ``value`` is what a parameter's name stands for, by default the generator of that name.
    """
    roots = [c.expression for c in constants if c.expression.name == "sqrt"]
    if not any(p.name == COORDINATE for p in parameters):
        roots = [c for c in roots if not varies_along_x(c)]
    roots = [c for c in roots if format_expression(c) in ring.index]
    units = [ring.index[p.name] for p in parameters if p.is_imaginary and p.name in ring.index]
    known = {p.name for p in parameters if p.assume != "real"} | {"pi"}
    positive = frozenset(i for n, i in ring.index.items() if n in known or n.startswith("exp("))
    if not (roots or units) or ring.is_sparse:
        return Radicals(ring, positive=positive)

    def named(name: str) -> Factored:
        return Factored.generator(ring, name) if value is None or name == "pi" else value(name)

    def raised(base: Factored, exponent: Expression) -> Factored:
        return base ** (integer_exponent(exponent) or 0)

    def called(call: Call, _: Factored) -> Factored:
        return Factored.generator(ring, format_expression(call))

    radicands = dict.fromkeys(units, Factored.number(ring, -1))
    for c in roots:
        # What divides by zero, or holds s or a block, has no value, which is reported where one is asked for.
        with suppress(ZeroDivisionError, KeyError):
            radicands[ring.index[format_expression(c)]] = fold(
                c.argument, number=lambda n: Factored.number(ring, n), name=named, power=raised, call=called
            )
    return Radicals.of(ring, radicands, positive)

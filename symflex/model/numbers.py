"""The same model with numbers in place of its valued parameters, for what needs no symbols."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from symflex.expressions import substitute
from symflex.model.units import exact_expression

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from symflex.expressions import Expression
    from symflex.model.model import ExactValue, Model

Values = tuple[tuple[str, "Expression"], ...]


def with_numbers(
    model: Model, symbolic: Collection[str] = (), values: Mapping[str, ExactValue] | None = None
) -> Model:
    """Return a model whose valued parameters are replaced by exact numbers; the others stay symbolic.

    Its transfer functions, bound, are those of the model; deriving them costs no symbols. A distributed model
    is returned as it is.

    Parameters
    ----------
    model : Model
        Resolved.
    symbolic : collection of str
        Parameters that stay symbolic although they have a value.
    values : mapping of str to ExactValue, optional
        Taken in place of the declared ones.
    """
    if model.is_distributed:
        # Wavenumbers and kernels are named by their parameters; values are put in when they are bound.
        return model
    given = {**{p.name: p.value for p in model.parameters}, **(values or {})}
    numbers = {
        name: exact_expression(value)
        for name, value in given.items()
        if value is not None and name not in symbolic
    }

    def put_in(given: Values) -> Values:
        return tuple((name, substitute(e, numbers)) for name, e in given)

    return replace(
        model,
        parameters=tuple(p for p in model.parameters if p.name not in numbers),
        definitions=tuple(
            replace(d, expression=substitute(d.expression, numbers)) for d in model.definitions
        ),
        elements=tuple(replace(e, values=put_in(e.values)) for e in model.elements),
        signals=tuple(replace(x, expression=substitute(x.expression, numbers)) for x in model.signals),
        blocks=tuple(
            replace(
                b,
                values=put_in(b.values),
                submodel=None if b.submodel is None else with_numbers(b.submodel, symbolic, values),
            )
            for b in model.blocks
        ),
        outputs=tuple(replace(o, expression=substitute(o.expression, numbers)) for o in model.outputs),
    )

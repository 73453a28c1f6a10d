"""What varies along x in a model."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.expressions import Expression, names_among
from symflex.model.scope import COORDINATE, scope_of

if TYPE_CHECKING:
    from symflex.model.model import Model

__all__ = ["COORDINATE", "is_tapered", "varies_along_x"]


def varies_along_x(expression: Expression) -> bool:
    """Tell whether the coordinate stands in an expression that may contain it.

    >>> from symflex.expressions import Name, Product
    >>> varies_along_x(Product((Name("A_0"), Name("x")))), varies_along_x(Name("A_0"))
    (True, False)
    """
    return bool(names_among(expression, (COORDINATE,)))


def is_tapered(model: Model) -> bool:
    """Tell whether coefficients of a field, or values of an element, vary along x."""
    if not scope_of(model).is_coordinate(COORDINATE):
        return False
    values = [
        value
        for use in model.elements
        for name, value in use.values
        if any(p.name == name and p.varies for p in use.element.parameters)
    ]
    coefficients = [e for f in model.fields for e in f.equations if COORDINATE not in f.unknowns]
    return any(map(varies_along_x, (*values, *coefficients)))

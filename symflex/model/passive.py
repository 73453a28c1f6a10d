"""Whether a model is passive: nothing in it supplies energy but its inputs.

Then no pole lies in the right half plane: of ``x^H A(s) x/s`` mass, loss and stiffness are each nonnegative,
and at Re(s) > 0 their sum vanishes only where nothing moves (Anderson & Vongpanitlerd 1973, Network Analysis
and Synthesis, chapter 2).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.expressions import Name, names
from symflex.model.points import Line

if TYPE_CHECKING:
    from collections.abc import Iterable

    from symflex.model.model import ExactValue, Model, PlacedElement


def is_passive(model: Model, values: Iterable[tuple[str, ExactValue]]) -> bool:
    """Tell whether it is proved that a model supplies no energy.

    Nothing is known with signals, blocks, fields, parameters that depend on s, elements that are not of this
    program, or a value of the wrong sign.

    Examples
    --------
    >>> from symflex import pipeline
    >>> text = '''
    ... symflex = 1
    ... parameters = { k = "2 N/m", m = "1 kg" }
    ... elements.body = { type = "mass", at = "x", m = "m" }
    ... elements.spring = { type = "spring", between = ["x", "ground"], k = "SIGNk" }
    ... inputs.F = { force = "x" }
    ... outputs.X = "x"
    ... '''
    >>> for sign in ("", "-"):
    ...     model = pipeline.loads(text.replace("SIGN", sign))
    ...     print(is_passive(model, [(p.name, p.value) for p in model.parameters]))
    True
    False
    """
    if model.signals or model.blocks or model.fields:
        return False
    line = Line.of_numbers(model.definitions, values)
    inputs = {each.name for each in model.inputs}
    return all(_is_passive(use, line, inputs) for use in model.elements)


def _is_passive(use: PlacedElement, line: Line, inputs: set[str]) -> bool:
    element, given = use.element, dict(use.values)
    if element.is_source:
        # One that follows an input alone is a support or a free node where the input rests.
        known = inputs | {"pi", *line.values}
        return all(
            isinstance(each, Name) and each.name in known for value in given.values() for each in names(value)
        )
    law = element.passive
    if law is None or any(given[name] != given[law.equal[0]] for name in law.equal):
        return False
    signs = {name: line.sign(value) for name, value in given.items()}
    return all(sign is not None and (sign >= 0 or name in law.of_any_sign) for name, sign in signs.items())

"""Prose of generated code, the same in every language: formula, origin, defaults."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.emit.forms import print_form
from symflex.emit.program import inert, nearest_double, wrapped
from symflex.expressions import Number, Quotient, format_expression

if TYPE_CHECKING:
    from symflex.model import Model, Parameter
    from symflex.transfer import TransferFunction

FORMULA_LINES = 20
FORMULA_TERMS = 1000


def default(parameter: Parameter) -> str:
    """Return the double nearest to a parameter's value as text, empty without a value."""
    value = parameter.value
    return "" if value is None else repr(nearest_double(value.rational, value.pi_power))


def origin(model: Model, width: int, indent: str = "") -> list[str]:
    """Return title and source in lines of inert text, followed by an empty one; none if there are none."""
    lines: list[str] = []
    for word, text in (("Model", model.title), ("Source", model.source)):
        if text.strip():
            lines += wrapped(f"{word}: {inert(text)}", width, indent)
    return [*lines, ""] if lines else []


def formula(tf: TransferFunction, width: int) -> list[str]:
    """Return the formula in lines of inert text, shortened when it is long."""
    above, below = tf.order
    if sum(len(f) for f, _ in tf.ratio.factors) <= FORMULA_TERMS:
        form = print_form(tf)
    elif tf.closed is not None and len(tf.closed.num) + len(tf.closed.den) <= FORMULA_TERMS:
        form = print_form(tf, "definitions")
    else:
        kind = "sums of kernels" if tf.is_distributed else f"polynomials of degree {above} and {below}"
        return [f"A quotient of {kind} in s."]
    is_whole = isinstance(form.den, Number) and form.den.value == 1
    whole = format_expression(form.num if is_whole else Quotient(form.num, form.den))
    lines = wrapped(inert(f"{tf.name} = {whole}"), width, "", "    ")
    for i, (name, expression) in enumerate(form.where):
        word = "where" if i == 0 else "     "
        lines += wrapped(f"{word} {inert(f'{name} = {format_expression(expression)}')}", width, "", "    ")
    if len(lines) <= FORMULA_LINES:
        return lines
    kept = lines[: FORMULA_LINES - 1]
    return [*kept, f"    ... and {len(lines) - len(kept)} lines more."]

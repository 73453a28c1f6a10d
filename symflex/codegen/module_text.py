"""What generated code says about a model, whatever its language: formulas, origins, descriptions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.codegen.program.evaluate import nearest_double
from symflex.codegen.program.user_text import inert, wrapped
from symflex.expressions import Quotient, format_expression, is_number
from symflex.print.forms import print_form
from symflex.print.latex.table import decimal_text
from symflex.transfer import NestedTransferFunction

if TYPE_CHECKING:
    from symflex.model import Model, ModelParameter
    from symflex.print.forms import PrintedForm
    from symflex.transfer import AnyTransferFunction

FORMULA_LINES = 20
"""Lines of a formula that a docstring shows."""

FORMULA_TERMS = 1000
"""Terms up to which a formula is written out."""

NESTED_SIZE = 300
"""Operations of a nested form up to which its formula is written out."""

COST = (
    "Exponents without a formula are found numerically, which costs some hundred times a complex exponential."
)
"""What is said of functions that solve for their exponents."""

ITERATED = (
    "Exponents without a formula are found by iteration, which costs some hundred times a complex "
    "exponential; the error was measured with exponents from eigenvalues."
)
"""What is said of those that find their exponents otherwise than the code that was measured."""


def formula_lines(tf: AnyTransferFunction, width: int) -> list[str]:
    """Return the formula in lines of inert text of so many columns, shortened when it is long."""
    if isinstance(tf, NestedTransferFunction):
        return (
            _lines_of(tf.name, print_form(tf), width)
            if tf.size <= NESTED_SIZE
            else [f"A quotient of nested expressions of {tf.size} operations."]
        )
    above, below = tf.order
    if tf.length <= FORMULA_TERMS:
        form = print_form(tf)
    elif tf.closed is not None and len(tf.closed.num) + len(tf.closed.den) <= FORMULA_TERMS:
        form = print_form(tf, "definitions")
    else:
        kind = "sums of kernels" if tf.is_distributed else f"polynomials of degree {above} and {below}"
        return [f"A quotient of {kind} in s."]
    return _lines_of(tf.name, form, width)


def _lines_of(name: str, form: PrintedForm, width: int) -> list[str]:
    whole = format_expression(form.num if is_number(form.den, 1) else Quotient(form.num, form.den))
    lines = wrapped(inert(f"{name} = {whole}"), width, "", "    ")
    for i, (symbol, expression) in enumerate(form.where):
        word = "where" if i == 0 else "     "
        lines += wrapped(f"{word} {inert(f'{symbol} = {format_expression(expression)}')}", width, "", "    ")
    if len(lines) <= FORMULA_LINES:
        return lines
    kept = lines[: FORMULA_LINES - 1]
    return [*kept, f"    ... and {len(lines) - len(kept)} lines more."]


def origin_lines(model: Model, width: int) -> list[str]:
    """Return title and source of a model in lines of inert text, none for what is not given."""
    lines: list[str] = []
    for word, text in (("Model", model.title), ("Source", model.source)):
        if text.strip():
            lines += wrapped(f"{word}: {inert(text)}", width)
    return lines


def headline(tf: AnyTransferFunction, *, is_real: bool = False) -> str:
    """Return what a function, or its response in real arithmetic, computes, in one inert line."""
    unit = f" [{tf.unit}]" if tf.unit else ""
    at = " at s = j omega, in real arithmetic" if is_real else ""
    return inert(f"{tf.quantity[:1].upper()}{tf.quantity[1:]} {tf.name}{unit}{at}.")


def described(parameter: ModelParameter, name: str) -> str:
    """Return what a parameter is, with its unit, as inert text that ends with a full stop.

    ``name`` is what it is called in the generated code.
    """
    parts = [inert(parameter.doc).rstrip(".")] if parameter.doc.strip() else []
    parts += [f"'{inert(parameter.name)}' in the model"] if name != parameter.name else []
    text = f"{', '.join(parts) or 'parameter of the model'}"
    text = f"{text} [{inert(parameter.unit)}]." if parameter.unit else f"{text}."
    written = value_as_written(parameter)
    return f"{text} {inert(written)} in the model." if written else text


def value_as_written(parameter: ModelParameter) -> str:
    """Return a value in the unit it was written in, empty where that is the SI unit of the code.

    Examples
    --------
    >>> from symflex import pipeline
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... parameters = {E = "70 GPa", l = "2 m"}
    ... inputs.u = {}
    ... outputs.y = "E*l*u"
    ... ''')
    >>> [value_as_written(p) for p in model.parameters]
    ['70 GPa', '']
    """
    value, unit = parameter.as_written()
    if value is None or unit in (parameter.unit, ""):
        return ""
    return f"{decimal_text(value)} {unit}"


def default_value(parameter: ModelParameter) -> str:
    """Return the double nearest to a parameter's value as text, empty without a value.

    Raises
    ------
    ModelError
        SF233 when it does not fit in double precision.
    """
    value = parameter.value
    return "" if value is None else repr(nearest_double(value.rational, value.pi_power))

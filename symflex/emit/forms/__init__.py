"""Forms of a transfer function. A new form is one function and one line in ``FORMS``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.emit.forms.arrange import Arranger
from symflex.emit.forms.definitions import definitions_form
from symflex.emit.forms.hidden import hidden_expressions
from symflex.emit.forms.polynomial import factored_form, monic_form, polynomial_form
from symflex.emit.forms.printed import Form, PrintedForm
from symflex.emit.forms.zpk import zpk_form
from symflex.errors import Diagnostic, UsageError
from symflex.errors.diagnostic import nearest
from symflex.expressions import format_expression

if TYPE_CHECKING:
    from symflex.transfer import TransferFunction

FORMS: dict[str, Form] = {
    "polynomial": polynomial_form,
    "monic": monic_form,
    "factored": factored_form,
    "definitions": definitions_form,
    "zpk": zpk_form,
}

LARGE = 300
"""Number of expanded terms from which only the closed form is tried: no expanded print is shorter."""
CANDIDATES = ("definitions", "factored", "polynomial")
"""The symbolic forms among which the shortest print is the default; ties go to the first."""


def print_form(tf: TransferFunction, form: str | None = None, digits: int = 6) -> PrintedForm:
    """Return a transfer function in the named form, or in the one that prints shortest.

    Parameters
    ----------
    tf : TransferFunction
        Derived.
    form : str, optional
        A key of :data:`FORMS`.
    digits : int
        Significant digits of forms that print decimals.

    Raises
    ------
    UsageError
        SF902 when there is no such form.
    ModelError
        SF229 when the form needs numbers and a parameter has none.
    """
    if form is None:
        tried = CANDIDATES if sum(len(f) for f, _ in tf.ratio.factors) <= LARGE else CANDIDATES[:1]
        return min((FORMS[name](tf, digits) for name in tried), key=_length)
    if form not in FORMS:
        hint = nearest(form, FORMS) or "forms: " + ", ".join(FORMS)
        raise UsageError(Diagnostic("SF902", f"there is no form '{form[:64]}'", None, hint))
    return FORMS[form](tf, digits)


def _length(form: PrintedForm) -> int:
    parts = [form.num, form.den, *(e for _, e in form.where)]
    return sum(len(format_expression(part)) for part in parts)


__all__ = [
    "CANDIDATES",
    "FORMS",
    "Arranger",
    "Form",
    "PrintedForm",
    "hidden_expressions",
    "print_form",
]

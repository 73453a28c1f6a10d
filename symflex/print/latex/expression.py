r"""Expressions as LaTeX mathematics: the notation of :mod:`symflex.print.writer` for paper.

Factors follow each other without a sign except where two numbers would meet.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from symflex.algebra.functions import FUNCTIONS
from symflex.print.label import symbol
from symflex.print.width import CDOT_SIZES, NOTHING, THIN_SIZES, Width
from symflex.print.writer import FENCES, MOST_PRIMES, ExpressionWriter, Shape, Spelling, Style, Written

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from symflex.expressions import Expression


def latex_expression(expression: Expression, labels: Mapping[str, str], style: Style = Style.DISPLAY) -> str:
    r"""Return an expression as LaTeX for math mode.

    Names without a declared label get :func:`~symflex.print.label.label_of`. Raises TypeError for an
    equation or a quantity of an element, which no transfer function holds.

    Examples
    --------
    >>> from symflex.expressions import Name, number, power, product_of, quotient, sum_of
    >>> s, zeta, omega = Name("s"), Name("zeta_p1"), Name("omega_p1")
    >>> print(latex_expression(sum_of([power(s, 2), product_of([number(2), zeta, omega, s])]), {}))
    s^{2} + 2 \zeta_{p1} \omega_{p1} s
    >>> print(latex_expression(quotient(number(1), product_of([Name("r"), sum_of([s, zeta])])), {"r": "r_t"}))
    \frac{1}{r_t (s + \zeta_{p1})}
    """
    return Writer(labels).piece(expression, style).markup


class Writer(ExpressionWriter):
    """Writes expressions as LaTeX with one set of labels."""

    def __init__(self, labels: Mapping[str, str]) -> None:
        super().__init__(labels, LATEX)


def _fenced(content: str, nesting: int, is_tall: bool) -> str:
    left, right = FENCES[nesting % len(FENCES)]
    return rf"\left{left} {content} \right{right}" if is_tall else f"{left}{content}{right}"


def _sum(terms: Sequence[tuple[str, bool]]) -> str:
    parts = [f"- {term[1:]}" if is_negative else f"+ {term}" for term, is_negative in terms]
    return " ".join((terms[0][0], *parts[1:]))


def _between(left: Written, right: Written) -> tuple[str, Width]:
    is_number = right.markup[:1].isdigit()
    if is_number or (right.markup.startswith(r"\frac") and left.markup[-1:].isdigit()):
        return r" \cdot ", CDOT_SIZES
    if left.shape is Shape.CALL or right.shape is Shape.CALL:
        return r" \, ", THIN_SIZES
    if (left.is_wordy or right.is_wordy) and not (left.nesting or right.nesting):
        return r" \, ", THIN_SIZES
    return " ", NOTHING


LATEX: Final = Spelling(
    fraction=r"\frac{{{}}}{{{}}}",
    slash="{}/{}",
    power="{}^{{{}}}",
    applied="{}{}",
    digits="{}",
    negative="-{}",
    root=r"\sqrt{{{}}}",
    exponential=r"\mathrm{{e}}^{{{}}}",
    name=lambda name, labels: symbol(name, labels).latex,
    function=lambda name: FUNCTIONS[name].latex,
    primed=lambda name, order: name + ("'" * order if order <= MOST_PRIMES else rf"^{{({order})}}"),
    scientific=lambda mantissa, exponent: rf"{mantissa} \cdot 10^{{{exponent}}}",
    fenced=_fenced,
    sum=_sum,
    product="".join,
    between=_between,
    function_power=lambda head, call, exponent: f"{head}^{{{exponent}}}{call.removeprefix(head)}",
)

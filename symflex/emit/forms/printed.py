"""What a form is: a transfer function arranged for print, and the contract of its maker."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from symflex.expressions import Equation, Expression
    from symflex.transfer import TransferFunction


@dataclass(frozen=True, slots=True)
class PrintedForm:
    """A transfer function as an author would write it.

    Parameters
    ----------
    name : str
        The form's name, a key of ``FORMS``.
    num, den : Expression
        Numerator and denominator, terms and factors in the order of print.
    where : tuple of (str, Expression)
        The names that occur and what they stand for; a line may use the names of any other, without cycles.
    laws : tuple of (str, Equation)
        Functions of x that occur, with the differential equation each solves: at x = 0 the highest but one of
        its derivatives is one and those before it are zero. Only for field equations whose exponents have no
        formula.
    """

    name: str
    num: Expression
    den: Expression
    where: tuple[tuple[str, Expression], ...] = ()
    laws: tuple[tuple[str, Equation], ...] = ()


class Form(Protocol):
    """A function that arranges a transfer function."""

    def __call__(self, tf: TransferFunction, digits: int) -> PrintedForm:
        """Return the arranged form; ``digits`` is used by forms that print decimals."""
        ...

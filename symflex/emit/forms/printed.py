"""What a form is: a transfer function arranged for print, and the contract of its maker."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from symflex.expressions import Expression
    from symflex.transfer import TransferFunction


@dataclass(frozen=True, slots=True)
class PrintedForm:
    """A transfer function as an author would write it.

    Parameters
    ----------
    name : str
        The form's name: ``polynomial``, ``monic``, ``factored``, ``zpk``, ``definitions``.
    num, den : Expression
        Numerator and denominator, terms and factors in the order of print.
    where : tuple of (str, Expression)
        The definitions that occur, in declared order.
    """

    name: str
    num: Expression
    den: Expression
    where: tuple[tuple[str, Expression], ...] = ()


class Form(Protocol):
    """A function that arranges a transfer function."""

    def __call__(self, tf: TransferFunction, digits: int) -> PrintedForm:
        """Return the arranged form; ``digits`` is used by forms that print decimals."""
        ...

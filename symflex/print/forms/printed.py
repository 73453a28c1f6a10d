"""What a form is: a transfer function arranged for print, and the contract of its maker."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Protocol

from symflex.algebra import LAPLACE
from symflex.expressions import Expression, Name, format_expression

if TYPE_CHECKING:
    from symflex.expressions import Equation
    from symflex.roots.verdict import StabilityVerdict
    from symflex.transfer import TransferFunction


S: Final = Name(LAPLACE)


@dataclass(frozen=True, slots=True)
class PrintedForm:
    """A transfer function as an author would write it."""

    name: str  # the form's name, a key of ``FORMS``
    # num and den: numerator and denominator, terms and factors in the order of print.
    num: Expression
    den: Expression
    # The names that occur and what they stand for; a line may use the names of any other, without cycles.
    where: tuple[tuple[str, Expression], ...] = ()
    # Functions of x that occur, with the differential equation each solves: at x = 0 the highest but one of
    # its derivatives is one and those before it are zero. Only for field equations whose exponents have no
    # formula.
    laws: tuple[tuple[str, Equation], ...] = ()
    argument: Expression = S  # of the transfer function: s, or the imaginary unit times the angular frequency
    # Of a form that lists poles: whether the model is stable, which hidden modes decide too.
    stability: StabilityVerdict | None = None

    def at(self, name: str) -> str:
        """Return what a signal is called where it is a function of another argument than s.

        Examples
        --------
        >>> PrintedForm("polynomial", Name("a"), Name("b")).at("X")
        'X'
        >>> PrintedForm("frequency", Name("a"), Name("b"), argument=Name("omega")).at("X")
        'X(omega)'
        """
        return name if self.argument == S else f"{name}({format_expression(self.argument)})"


class Arrange(Protocol):
    """A function that arranges a transfer function."""

    def __call__(self, tf: TransferFunction, digits: int) -> PrintedForm:
        """Return the arranged form; ``digits`` is used by forms that print decimals."""
        ...

"""A transfer function arranged for print, with SymPy at the surface."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from symflex.expressions import Expression, Name
from symflex.print.forms import PrintedForm
from symflex.print.sympy import symbols_of, to_sympy
from symflex.print.text import form_text

if TYPE_CHECKING:
    import sympy

    from symflex import transfer as transfer_room


@dataclass(frozen=True)
class Form:
    """A transfer function arranged for print, as SymPy expressions and as text.

    Parameters
    ----------
    source : TransferFunction or NestedTransferFunction
        The transfer function.
    printed : PrintedForm
        Its arrangement.
    """

    source: transfer_room.AnyTransferFunction
    printed: PrintedForm

    @property
    def name(self) -> str:
        """The form's name."""
        return self.printed.name

    @cached_property
    def _symbols(self) -> dict[str, sympy.Symbol]:
        return symbols_of(self.source.model)

    def _sympy(self, expression: Expression) -> sympy.Expr:
        return to_sympy(expression, self._symbols)

    @property
    def num(self) -> sympy.Expr:
        """Numerator."""
        return self._sympy(self.printed.num)

    @property
    def den(self) -> sympy.Expr:
        """Denominator."""
        return self._sympy(self.printed.den)

    @property
    def expr(self) -> sympy.Expr:
        """Numerator over denominator."""
        return self.num / self.den

    @property
    def where(self) -> tuple[tuple[sympy.Symbol, sympy.Expr], ...]:
        """The closed names that occur, with what they stand for."""
        return tuple((self._sympy(Name(n)), self._sympy(e)) for n, e in self.printed.where)

    def latex(self) -> str:
        """Return the equation in LaTeX."""
        from symflex.print.latex import inline_latex

        return inline_latex(self.source, self.printed)

    def __repr__(self) -> str:
        return f"<Form {self.name} of {self.source.name}>"

    def _repr_latex_(self) -> str | None:
        """Return the equation for a notebook, in lines where one would be too long; None for a huge one."""
        from symflex.print.latex import notebook_latex

        latex = notebook_latex(self.source, self.printed)
        return None if latex is None else f"$\\displaystyle {latex}$"

    def __str__(self) -> str:
        return form_text(self.source, self.printed)

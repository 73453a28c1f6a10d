"""A transfer function in nested form, its parts as SymPy expressions."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from symflex.api.form import Form
from symflex.print.forms import print_form
from symflex.print.json_format import derive_json
from symflex.transfer import bind_nested

if TYPE_CHECKING:
    import sympy

    from symflex import transfer as transfer_room
    from symflex.api.transfer_function import Number


@dataclass(frozen=True)
class NestedTransferFunction:
    """A transfer function as a straight-line program: numerator over denominator, in named sub-impedances.

    Neither need be a polynomial, and common factors are not looked for. See
    :func:`symflex.transfer.derive_nested`.
    """

    exact: transfer_room.NestedTransferFunction

    @property
    def name(self) -> str:
        """``OUT/IN``."""
        return self.exact.name

    @property
    def quantity(self) -> str:
        """Receptance, mobility, accelerance, impedance, ..."""
        return self.exact.quantity

    @property
    def unit(self) -> str:
        """SI unit, empty when unknown."""
        return self.exact.unit

    @property
    def size(self) -> int:
        """How many operations a value takes, shared ones counted once."""
        return self.exact.size

    @cached_property
    def _form(self) -> Form:
        return Form(self.exact, print_form(self.exact))

    @property
    def num(self) -> sympy.Expr:
        """Numerator, in the names of :attr:`where`."""
        return self._form.num

    @property
    def den(self) -> sympy.Expr:
        """Denominator, in the names of :attr:`where`."""
        return self._form.den

    @property
    def where(self) -> tuple[tuple[sympy.Symbol, sympy.Expr], ...]:
        """The sub-impedances in order, each in terms of earlier ones."""
        return self._form.where

    def latex(self) -> str:
        """Return the equation in LaTeX."""
        return self._form.latex()

    def to_json_dict(self) -> dict[str, object]:
        """Return the transfer function as ``symflex derive --json`` lists it."""
        return derive_json(self.exact, print_form(self.exact))

    def bind(self, **values: Number) -> transfer_room.BoundNested:
        """Return the function with the declared values, or the given ones in their place.

        Numbers are in SI units; strings may carry a unit, ``k="95 kN/m"``. Of what it returns, ``H(2j)`` is a
        value to double precision, from balls, and ``H.at(s)`` evaluates arrays.

        Raises
        ------
        ModelError
            SF229 when a parameter has no value.
        UsageError
            SF902 for an unknown parameter.
        """
        return bind_nested(self.exact, values)

    def __repr__(self) -> str:
        return f"<NestedTransferFunction {self.name}, {self.size} operations>"

    def _repr_latex_(self) -> str | None:
        return self._form._repr_latex_()

    def __str__(self) -> str:
        return str(self._form)

"""Cramer's rule on one elimination: the determinant of a system, and bordered ones for its outputs.

Input: :class:`symflex.equations.Equations`.
Output: polynomials over the closed ring. The determinant's roots are the poles of the system. With the row of
an output and the column of an input as border its roots are the zeros: the poles of the system in which that
output is kept at zero by whatever that input takes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.equations.elimination.closing import ClosedSystem, close
from symflex.equations.elimination.minors import Minors, expansion_order
from symflex.equations.elimination.singular import explain_singular
from symflex.equations.elimination.unit_pivots import Reduced, eliminate_unit_pivots

if TYPE_CHECKING:
    from flint import fmpz_mpoly

    from symflex.algebra import Factored
    from symflex.equations import Equations


@dataclass(frozen=True, eq=False)
class Determinants:
    """The determinants of one system, each up to the sign they share.

    Parameters
    ----------
    equations : Equations
        The system.
    system : ClosedSystem
        The same over the closed ring.
    reduced : Reduced
        What remains of it without unit pivots.
    minors : Minors
        Shared by all determinants.
    den : fmpz_mpoly
        The determinant, not zero, over the closed ring.
    """

    equations: Equations
    system: ClosedSystem
    reduced: Reduced
    minors: Minors
    den: fmpz_mpoly

    @staticmethod
    def of(equations: Equations) -> Determinants:
        """Return the determinants of a system.

        Raises
        ------
        ModelError
            SF30x when the equations are singular, with the reason.
        BudgetError
            SF502 when the determinant would be too large.
        """
        system = close(equations)
        reduced = eliminate_unit_pivots(system.rows, system.outputs, len(system.unknowns))
        if len(reduced.rows) != len(reduced.columns):
            raise explain_singular(equations)
        order = expansion_order(reduced.rows, reduced.columns)
        minors = Minors(tuple(reduced.rows[i] for i in order), ring=system.closure.ring)
        den = minors.determinant(sum(1 << c for c in reduced.columns))
        if den.is_zero():
            raise explain_singular(equations)
        return Determinants(equations, system, reduced, minors, den)

    def num(self, output: str, source: str) -> fmpz_mpoly:
        """Return the determinant bordered by an output and an input, over the closed ring.

        Over :attr:`den` it is ``output/input`` times the output's divisor.
        """
        # Cramer: det [C D; A B] over det A, up to the sign of moving the border from last row to first.
        found = self.minors.bordered(self.reduced.outputs[self.position(output)], self.border(source))
        return -found if len(self.reduced.columns) & 1 else found

    def position(self, output: str) -> int:
        """Return where an output stands among the rows of outputs."""
        return [row.name for row in self.equations.outputs].index(output)

    def border(self, source: str) -> int:
        """Return the columns of the unknowns left, and that of an input, as bits."""
        column = len(self.system.unknowns) + [v.owner for v in self.system.inputs].index(source)
        return sum(1 << c for c in self.reduced.columns) | 1 << column

    def opened(self, polynomial: fmpz_mpoly) -> Factored:
        """Return a determinant over the ring of the equations."""
        return self.system.closure.open(polynomial)

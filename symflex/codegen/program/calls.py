"""What programs call at run time, besides elementary functions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.codegen.program.nodes import ModalValue, ModeValues, Roots, Solutions

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.codegen.program.nodes import Piecewise


@dataclass(frozen=True, slots=True)
class RuntimeCalls:
    """Which functions of :mod:`symflex.codegen.program.runtime` pieces call.

    Parameters
    ----------
    means : bool
        Means over circles.
    series : bool
        Solutions by power series.
    propagation : bool
        Solutions by matrix exponentials.
    roots : bool
        Characteristic roots.
    modes : bool
        Sums over characteristic roots.
    """

    means: bool
    series: bool
    propagation: bool
    roots: bool
    modes: bool

    @staticmethod
    def of(programs: Sequence[Piecewise]) -> RuntimeCalls:
        """Return what any of some programs calls."""
        pieces = [piece for p in programs for piece in p.code]
        codes = (*(p.tests for p in programs), *(piece.code for piece in pieces))
        nodes = [node for code in codes for node in code.nodes()]
        solving = {n.terms > 0 for n in nodes if isinstance(n, Solutions)}
        return RuntimeCalls(
            means=any(piece.circle for piece in pieces),
            series=True in solving,
            propagation=False in solving,
            roots=any(isinstance(n, Roots) for n in nodes),
            modes=any(isinstance(n, ModalValue | ModeValues) for n in nodes),
        )

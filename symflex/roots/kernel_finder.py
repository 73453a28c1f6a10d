"""The engines for functions with kernels, behind the contract of root finders."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.budget import Budget, entered_budget
from symflex.roots.distributed.side import ENGINES, LOSSLESS, NoEngineError, Side
from symflex.roots.problem import KernelProblem
from symflex.roots.region import Everything, Mode, Position

if TYPE_CHECKING:
    from symflex.roots.problem import Problem
    from symflex.roots.region import Region
    from symflex.roots.root import Root


@dataclass(frozen=True, slots=True)
class KernelRootFinder:
    """Encloses the roots of functions with kernels by one engine.

    Parameters
    ----------
    name : str
        As in the registry: ``lossless``, ``guess-and-prove`` or ``subdivision``.
    """

    name: str

    def __post_init__(self) -> None:
        if self.name not in ENGINES:
            message = f"no engine is called {self.name}"
            raise ValueError(message)

    def accepts(self, problem: Problem) -> bool:
        """Return whether the engine can solve the problem; one of them has to be without losses."""
        if not isinstance(problem, KernelProblem):
            return False
        try:
            self._side(problem, 15)
        except NoEngineError:
            return False
        return True

    def find(
        self, problem: Problem, region: Region, digits: int, budget: Budget | None = None
    ) -> tuple[Root, ...]:
        """Return all roots in the closed region, by natural frequency; none where they cannot be proved.

        Raises
        ------
        TypeError
            For a product of polynomials.
        ValueError
            For everything: there are infinitely many.
        BudgetError
            SF505, SF506 when the search takes too long.
        """
        if not isinstance(problem, KernelProblem):
            message = f"{self.name} is for functions with kernels"
            raise TypeError(message)
        if isinstance(region, Everything):
            message = "a transcendental function has infinitely many roots"
            raise ValueError(message)
        side = self._side(problem, digits, budget)
        if isinstance(region, Mode):
            side.numbered(region.number)
            return side.in_order() if side.engine == LOSSLESS else ()
        side.search(region)
        if not side.prove(region).is_complete:
            return ()
        ordered = side.in_order()
        positions = region.classify(ordered)
        return tuple(r for r, p in zip(ordered, positions, strict=True) if p is not Position.OUTSIDE)

    def _side(self, problem: KernelProblem, digits: int, budget: Budget | None = None) -> Side:
        return Side(problem.bound, problem.part, digits, budget or entered_budget(), engines=(self.name,))

"""What every root finder offers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from symflex.budget import Budget
    from symflex.roots.problem import Problem
    from symflex.roots.region import Region
    from symflex.roots.root import Root


class RootFinder(Protocol):
    """An engine that encloses roots with proof.

    A new engine is one file that offers an object of this shape, and one line in
    :data:`symflex.roots.ROOT_FINDERS`.
    """

    @property
    def name(self) -> str:
        """Key in the registry."""
        ...

    def accepts(self, problem: Problem) -> bool:
        """Return whether the engine can solve the problem."""
        ...

    def find(
        self, problem: Problem, region: Region, digits: int, budget: Budget | None = None
    ) -> tuple[Root, ...]:
        """Return at least all roots in the closed region, in the order of :func:`find_polynomial_roots`.

        Raises
        ------
        TypeError
            For a problem it does not accept.
        BudgetError
            When the budget is exceeded; ``found`` is a tuple of the roots proved until then, or ``None``.
        """
        ...

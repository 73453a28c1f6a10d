"""Poles and zeros of a bound transfer function."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.budget import Budget, entered_budget
from symflex.roots.distributed.distributed import locate_distributed
from symflex.roots.functions.simplified import without_lengths_of_zero
from symflex.roots.pole_zero_map import PoleZeroMap, find_pole_zero_map
from symflex.roots.problem import problem_of

if TYPE_CHECKING:
    from symflex.roots.region import Region
    from symflex.transfer import BoundTransferFunction


def locate(
    bound: BoundTransferFunction,
    region: Region | None = None,
    digits: int = 30,
    budget: Budget | None = None,
) -> PoleZeroMap:
    """Find the poles and zeros of a transfer function, with its hidden modes, proved.

    Each root has so many correct significant digits. A transfer function that is identically zero has neither
    poles nor zeros; all its modes are hidden. Those of a distributed system, of which there are infinitely
    many, are searched in :func:`default_region` when everything is asked for, and the search is limited by
    its work where no budget is given.
    """
    bound = without_lengths_of_zero(bound)
    if bound.is_distributed:
        return locate_distributed(bound, region, digits, budget or entered_budget())
    above = [(f, e) for f, e in bound.ratio.factors if e > 0]
    below = [(f, -e) for f, e in bound.ratio.factors if e < 0]
    hidden = [(f.polynomial, f.multiplicity) for f in bound.hidden]
    return find_pole_zero_map(
        bound.name,
        problem_of(bound, below),
        problem_of(bound, above),
        region,
        digits,
        [(problem_of(bound, [factor]), "cancelled") for factor in hidden],
        budget=budget,
    )

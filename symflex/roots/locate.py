"""Poles and zeros of a bound transfer function."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flint import fmpz_mpoly_ctx

from symflex.budget import Budget, entered_budget
from symflex.roots.distributed.distributed import locate_distributed
from symflex.roots.functions.vanishing import without_lengths_of_zero
from symflex.roots.pole_zero_map import PoleZeroMap, find_pole_zero_map
from symflex.roots.problem import PolynomialInS, RealConstant, RootProblem
from symflex.transfer import BoundTransferFunction, coefficients_in_s

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flint import fmpz_mpoly

    from symflex.roots.region import Region


def locate(
    bound: BoundTransferFunction,
    region: Region | None = None,
    digits: int = 30,
    budget: Budget | None = None,
) -> PoleZeroMap:
    """Find the poles and zeros of a transfer function, with its hidden modes, proved.

    Parameters
    ----------
    bound : BoundTransferFunction
        With numbers.
    region : Region, optional
        Everything by default.
    digits : int
        Correct significant digits of each root.
    budget : Budget, optional
        Limits the search; by default a distributed system's is limited by its work.

    Returns
    -------
    PoleZeroMap
        A transfer function that is identically zero has neither poles nor zeros; all its modes are hidden.
        Those of a distributed system, of which there are infinitely many, are searched in
        :func:`default_region` when everything is asked for.
    """
    bound = without_lengths_of_zero(bound)
    if bound.is_distributed:
        return locate_distributed(bound, region, digits, budget or entered_budget())
    above = [(f, e) for f, e in bound.ratio.factors if e > 0]
    below = [(f, -e) for f, e in bound.ratio.factors if e < 0]
    hidden = [(f.polynomial, f.multiplicity) for f in bound.hidden]
    return find_pole_zero_map(
        bound.name,
        _problem(bound, below),
        _problem(bound, above),
        region,
        digits,
        [(_problem(bound, [factor]), "cancelled") for factor in hidden],
        budget=budget,
    )


def _problem(bound: BoundTransferFunction, factors: Sequence[tuple[fmpz_mpoly, int]]) -> RootProblem:
    polynomials = [(_polynomial(bound, f), e) for f, e in factors]
    return RootProblem(tuple((p, e) for p, e in polynomials if p.degree > 0))


def _polynomial(bound: BoundTransferFunction, factor: fmpz_mpoly) -> PolynomialInS:
    coefficients = coefficients_in_s(factor, bound.constant_ring)
    if all(c.is_constant() for c in coefficients):
        integers = fmpz_mpoly_ctx.get([], "lex")
        numbers = (int(c.leading_coefficient()) if len(c) else 0 for c in coefficients)
        return PolynomialInS(tuple(integers.constant(n) for n in numbers), integers)
    constants = tuple(RealConstant(name, evaluate) for name, evaluate in bound.constants)
    return PolynomialInS(coefficients, bound.constant_ring.context, constants)

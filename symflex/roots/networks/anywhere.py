"""Poles and zeros of networks that lose energy, are driven by themselves, or are read elsewhere than driven.

All roots in a disc about 0 that holds what is asked for, from :mod:`symflex.roots.networks.disc_search`. What
numerator and denominator share, to twice the digits, is hidden.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import hypot, pi
from typing import TYPE_CHECKING

from flint import arb

from symflex.roots.networks.blocks import most_zeros
from symflex.roots.networks.disc_search import DiscSearch, DiscSide
from symflex.roots.polynomial_roots import in_order
from symflex.roots.region import Band, Mode, Modes, Rectangle, Region
from symflex.roots.root import Root, overlap

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.budget import Budget
    from symflex.roots.networks.cramer import CramerEquations

CRAMER = "cramer"
"""What stands in a certificate: the determinants of Cramer's rule, in discs."""
WIDER = 1.01
"""How far beyond the region the disc reaches."""
ROUNDS = 8
GROWTH = 1.4
SPARE = 1
"""Roots beyond those asked for that a disc is to hold, so that its circle passes between two."""


@dataclass(frozen=True, slots=True)
class DiscRoots:
    """Roots in a disc, all of them."""

    radius: float  # [rad/s]
    poles: tuple[Root, ...]  # but for hidden ones; those at 0 among them
    zeros: tuple[Root, ...]
    shared: tuple[Root, ...]
    has_all_zeros: bool  # there are no others

    def holds(self, wanted: int) -> bool:
        """Tell whether there are as many modes among the poles and among the zeros, or all zeros."""
        return modes(self.poles) >= wanted and (self.has_all_zeros or modes(self.zeros) >= wanted)


def roots_in_disc(
    cramer: CramerEquations,
    region: Region,
    digits: int,
    budget: Budget,
    *,
    symmetric: tuple[bool, bool],
) -> DiscRoots:
    """Return all roots in a disc that holds what the region asks for.

    UndecidedError where they are not all proved; EssentialSingularityError where roots accumulate.
    """
    search = DiscSearch(cramer, digits, budget, symmetric, most_zeros=most_zeros(cramer))
    match region:
        case Band(_, high):
            return _roots(search, 2 * pi * float(high) * WIDER, digits)
        case Rectangle():
            across = max(abs(float(x)) for x in (region.re_low, region.re_high))
            along = max(abs(float(x)) for x in (region.im_low, region.im_high))
            return _roots(search, hypot(across, along) * WIDER, digits)
    wanted = region.count if isinstance(region, Modes) else region.number if isinstance(region, Mode) else 1
    budget.progress.report(0.0, "sizing the disc")
    radius = search.radius_of(2 * wanted + SPARE)
    for _ in range(ROUNDS):
        found = _roots(search, radius, digits)
        if found.holds(wanted) or not search.may_grow(radius * GROWTH, wanted):
            break
        radius *= GROWTH
    return found


def modes(roots: Sequence[Root]) -> int:
    """Return how many modes there are among roots, those that mirror each other being one."""
    return sum(group[0].multiplicity for group in mirrored(in_order(roots)))


def mirrored(roots: Sequence[Root]) -> list[list[Root]]:
    """Return the roots other than 0 in order, those together that mirror each other in the axes."""
    found: list[list[Root]] = []
    for root in roots:
        if root.is_zero:
            continue
        if found and any(
            abs(root.re).overlaps(abs(other.re)) and abs(root.im).overlaps(abs(other.im))
            for other in found[-1]
        ):
            found[-1].append(root)
        else:
            found.append([root])
    return found


def _roots(search: DiscSearch, radius: float, digits: int) -> DiscRoots:
    search.budget.progress.report(0.3, "evaluating determinants on a circle")
    den, num = search.sides(radius)
    search.budget.progress.report(0.7, "enclosing roots")
    poles, zeros = den.all_roots(digits), num.all_roots(digits)
    shared: list[Root] = []
    closer: tuple[list[Root], list[Root]] | None = None
    kept: list[Root] = []
    for pole in poles:
        place = next((k for k, z in enumerate(zeros) if overlap(pole, z)), None)
        if place is not None and closer is None:
            closer = den.all_roots(2 * digits), num.all_roots(2 * digits)
        if place is None or closer is None or not _coincide(pole, zeros[place], *closer):
            kept.append(pole)
            continue
        zero = zeros.pop(place)
        common = min(pole.multiplicity, zero.multiplicity)
        shared.append(replace(pole, multiplicity=common))
        if zero.multiplicity > common:
            zeros.insert(place, replace(zero, multiplicity=zero.multiplicity - common))
        if pole.multiplicity > common:
            kept.append(replace(pole, multiplicity=pole.multiplicity - common))
    poles = kept
    common = min(den.at_zero, num.at_zero)
    shared += _zero(common, den, num)
    poles += _zero(den.at_zero - common, den)
    zeros += _zero(num.at_zero - common, num)
    has_all = num.count == search.most_zeros
    return DiscRoots(radius, in_order(poles), in_order(zeros), in_order(shared), has_all)


def _coincide(pole: Root, zero: Root, poles: Sequence[Root], zeros: Sequence[Root]) -> bool:
    """Tell whether a pole and a zero are among those that still overlap to twice the digits."""
    return any(overlap(a, b) for a in poles if overlap(a, pole) for b in zeros if overlap(b, zero))


def _zero(order: int, *sides: DiscSide) -> list[Root]:
    """Return a root at 0 of an order."""
    if not order:
        return []
    reach = max(side.zero_reach for side in sides)
    is_zero = not reach
    box = arb(0, reach)
    return [Root(box, box, order, on_imaginary_axis=is_zero, is_real=is_zero, certified=is_zero)]

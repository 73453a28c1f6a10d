"""Poles and zeros of networks that lose energy, are driven by themselves, or are read elsewhere than driven.

All roots in a disc about 0 with those requested, from :mod:`symflex.roots.networks.disc_search`. What
numerator and denominator share, to twice the digits, is hidden.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, partial
from math import hypot, pi

from symflex.budget import entered_budget
from symflex.model.loss_factors import has_loss_factors
from symflex.roots.networks.blocks import most_zeros
from symflex.roots.networks.cramer import CramerEquations
from symflex.roots.networks.disc_search import DiscSearch, DiscSide
from symflex.roots.pole_zero_map import search_modes, take_out_shared
from symflex.roots.polynomial_roots import in_order
from symflex.roots.region import Band, Mode, Modes, Rectangle, Region
from symflex.roots.root import LossyRoot, Root, count_modes, overlap, root_at_zero

CRAMER = "cramer"  # what stands in a certificate: the determinants of Cramer's rule, in discs
WIDER = 1.01  # how far beyond the region the disc reaches
GROWTH = 1.4
SPARE = 1  # roots beyond those asked for that a disc is to hold, so that its circle passes between two


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
        return count_modes(self.poles) >= wanted and (self.has_all_zeros or count_modes(self.zeros) >= wanted)


def roots_in_disc(
    cramer: CramerEquations, region: Region, digits: int, *, symmetric: tuple[bool, bool]
) -> DiscRoots:
    """Return all roots in a disc that contains what the region asks for; UndecidedError if not proved."""
    search = DiscSearch(cramer, symmetric, most_zeros=most_zeros(cramer))
    match region:
        case Band(_, high):
            return _roots(search, 2 * pi * float(high) * WIDER, digits)
        case Rectangle():
            across = max(abs(float(x)) for x in (region.re_low, region.re_high))
            along = max(abs(float(x)) for x in (region.im_low, region.im_high))
            return _roots(search, hypot(across, along) * WIDER, digits)
    wanted = wanted_modes(region)
    entered_budget().progress.report(0.0, "sizing the disc")
    radius = search.radius_of(2 * wanted + SPARE) / GROWTH
    in_disc: DiscRoots

    def search_wider(_modes: int) -> int:
        nonlocal in_disc, radius
        radius *= GROWTH
        in_disc = _roots(search, radius, digits)
        return int(not in_disc.holds(wanted) and search.may_grow(radius * GROWTH, wanted))

    search_modes(wanted, search_wider)
    return in_disc


def wanted_modes(region: Region) -> int:
    """Return how many of the lowest modes a region asks for; 0 where it asks by place."""
    return region.count if isinstance(region, Modes) else region.number if isinstance(region, Mode) else 0


def _roots(search: DiscSearch, radius: float, digits: int) -> DiscRoots:
    entered_budget().progress.report(0.3, "evaluating determinants on a circle")
    den, num = search.sides(radius)
    entered_budget().progress.report(0.7, "enclosing roots")
    finer = cache(lambda side: side.all_roots(2 * digits))

    def closer(side: DiscSide, root: Root) -> Root:
        return next((r for r in finer(side) if overlap(r, root)), root)

    own = (den.all_roots(digits), num.all_roots(digits))
    poles, zeros, shared = take_out_shared(*own, partial(closer, den), partial(closer, num))
    if has_loss_factors(search.equations.equations.model):  # which belong to omega > 0
        for side in (poles, zeros, shared):
            side[:] = [LossyRoot.of(root) for root in side if not root.im < 0]
    common = min(den.at_zero, num.at_zero)
    shared += root_at_zero(common, max(den.zero_reach, num.zero_reach))
    poles += root_at_zero(den.at_zero - common, den.zero_reach)
    zeros += root_at_zero(num.at_zero - common, num.zero_reach)
    has_all = num.count == search.most_zeros
    return DiscRoots(radius, in_order(poles), in_order(zeros), in_order(shared), has_all)

"""The root of a function with kernels at s = 0: how often it is one.

``s sinh(s) - s^2`` vanishes like s^4/6, so 0 is a root four times. Orders are read off series over a prime
field where every wavenumber has a formula; else circles about 0 are counted.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flint import arb

from symflex.algebra.vanishing import OriginSeries
from symflex.errors import Diagnostic, UncertifiedError
from symflex.roots.counting.winding import Cell, RootOnPathError
from symflex.roots.precision import precision
from symflex.roots.root import FLOAT_BITS, Root

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.algebra import Factored
    from symflex.roots.counting.argument_principle import CertifiedWinding

SERIES_TERMS = (20, 80)
"""Lengths of the series about 0 in which the first term is sought."""
DEPTHS = (1.0, 4.0, 16.0, 64.0)
"""How far below the lowest root, in ln, circles about 0 are counted where the order is not known exactly."""


def roots_at_zero(
    winding: CertifiedWinding, part: Factored, left: float, holes: Sequence[Cell], *, is_hidden: bool
) -> tuple[list[Root], int]:
    """Return the root at s = 0, and how often the function without powers of s winds about 0 there.

    ``winding`` is of the function without powers of s, ``part`` the product with them. ``left`` is pi, or
    pi/2 for functions whose roots mirror each other in the imaginary axis; holes are stayed away from. Of
    what is hidden only powers of s count, not what kernels vanish like. SF404 when no circle about 0 can be
    counted.
    """
    function = winding.function
    power, zero = function.power, arb(0)
    powers = part.exponent_of(part.ring.context.gen(0))
    exact = None
    for terms in SERIES_TERMS:
        exact = OriginSeries(part.ring, function.bound.kernels, terms=terms).order(function.part**power)
        if exact is not None:
            break
    if exact is not None and (is_hidden or exact % power == 0):
        total = powers if is_hidden else powers + exact // power
        root = Root(zero, zero, total, on_imaginary_axis=True, is_real=True)
        return [root for _ in range(total >= 1)], exact
    z, turns = turns_about_zero(winding, left, holes)
    # Kernels without a formula: so many roots lie this close to 0, and nothing says that they are 0.
    with precision(FLOAT_BITS):
        box = arb(0, arb(z).exp().upper())
    total = powers if is_hidden else powers + turns
    if not turns or is_hidden:
        box = zero
    is_zero = bool(box == 0)
    certified = is_zero or total == 1
    root = Root(box, box, total, on_imaginary_axis=is_zero, is_real=is_zero, certified=certified)
    return [root for _ in range(total >= 1)], turns * power


def turns_about_zero(winding: CertifiedWinding, left: float, holes: Sequence[Cell]) -> tuple[float, int]:
    """Return ln of a small radius, and how many roots are proved to lie within it."""
    lowest = winding.smallest(left, holes)
    found: tuple[float, int] | None = None
    for depth in DEPTHS:
        try:
            turns, rest = divmod(winding.count_within(lowest - depth, left), winding.function.power)
        except RootOnPathError:
            continue
        if not rest:
            found = (lowest - depth, turns)
        if not turns:
            break
    if found is None:
        message = f"the order of the root of {winding.function.bound.name} at s = 0 cannot be told"
        raise UncertifiedError(Diagnostic("SF404", message))
    return found

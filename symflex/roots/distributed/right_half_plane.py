"""Roots of a function with kernels in the right half-plane, wherever they lie.

The closed right half-plane is searched up to a radius beyond which one of the function's terms outweighs all
others; a certified count about the half disc says how many roots it holds, and only where there are some they
are searched.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import log, pi

from flint import acb

from symflex.errors import BudgetError
from symflex.roots.counting.winding import RootOnPathError
from symflex.roots.distributed.far_out import axis_tail, right_tail
from symflex.roots.distributed.side import Side
from symflex.roots.pole_zero_map import WITHOUT_END, count_right, is_right
from symflex.roots.region import Band, Rectangle, Region
from symflex.roots.root import Root

ACCUMULATING = "poles accumulate in the right half-plane"
DEGENERATE = "a root where wavenumbers meet may not be a pole"
NOT_COUNTED = "the poles in the right half-plane could not be counted"
WAVES = 10.0  # largest argument of a kernel up to which poles are counted where no end of them is known
FURTHER, LOWER = 30.0, 3000.0  # times it up to where roots on the axis are counted; it over the first
MARGIN = 1.01  # how far beyond the radius of a tail the path runs, so that its corners meet no root


@dataclass(frozen=True, slots=True)
class RightHalfPlane:
    """The roots of one function in the right half-plane."""

    roots: tuple[Root, ...]  # those found, on the imaginary axis too
    unproved: str = ""  # why there may be others; empty where there are none
    reached: float = 0.0  # up to which abs(s) there are none [rad/s], where that is known


def search_right(
    side: Side, known: Sequence[Root], reached: float, limit: float | None = None
) -> RightHalfPlane:
    """Count and find the roots on the right: all are ``known`` to ``reached``, none is beyond a ``limit``."""
    if side.is_finite:
        return RightHalfPlane(tuple(known))
    if any(hole.right < pi / 2 for hole in side.holes):
        return RightHalfPlane(tuple(known), ACCUMULATING)
    radius, unproved = last_on_the_right(side, reached) if limit is None else (limit, "")
    if radius <= reached:
        return _known_to(known, unproved, reached)
    # Roots mirror each other in the axis, and a path along it would meet them.
    is_even = side.function.is_even and (bool(unproved) or limit is not None)
    is_mirrored = bool(unproved) and is_even
    count: int | None = None
    try:
        count = None if is_even else side.count_right(log(radius * MARGIN))
    except RootOnPathError:
        pass
    except BudgetError as error:
        # Where no end is known, more was looked at than what was asked for.
        if unproved:
            return _known_to(known, unproved, reached)
        return RightHalfPlane(tuple(known), error.diagnostics[0].message)
    seen = [root for root in known if root.re.contains(0) or is_right(root)]
    if count is None or count != count_right(seen):
        end = Fraction(radius)
        region: Region = Rectangle(Fraction(0), end, -end, end)
        if is_even and not is_mirrored:
            region = Band(Fraction(0), Fraction(radius * MARGIN / (2 * pi)))
        again = side.anew()
        try:
            again.search(region)
            # Roots of undamped systems lie on the border, and beyond what was asked for it is not followed.
            proof = None if is_mirrored else again.prove(region)
        except BudgetError as error:
            if is_mirrored:
                return _known_to(known, unproved, reached)
            more = f"{count} are counted, but not all are found: " if count else ""
            return RightHalfPlane(tuple(known), more + error.diagnostics[0].message)
        seen = [root for root in again.roots if root.re.contains(0) or is_right(root)]
        if proof is None:
            return _known_to(seen, unproved, reached)
        if not proof.is_complete if count is None else count_right(seen) != count:
            if unproved:
                return _known_to(seen, unproved, reached)
            return RightHalfPlane(tuple(seen), proof.reason or NOT_COUNTED)
    return _known_to(seen, unproved, radius)


def last_on_axis(side: Side) -> float | None:
    """Return a radius [rad/s] beyond which no root lies on the axis, None without one or only far off."""
    most = side.function.frequency_of(WAVES) * FURTHER
    radius = axis_tail(side.bound, side.part, most / LOWER)
    return radius if radius < most else None


def _known_to(roots: Sequence[Root], unproved: str, reached: float) -> RightHalfPlane:
    return RightHalfPlane(tuple(roots), unproved, reached if unproved else 0.0)


def last_on_the_right(side: Side, reached: float = 0.0) -> tuple[float, str]:
    """Return how far roots are to be counted [rad/s], and why there may be others beyond."""
    start, radius = side.function.frequency_of(1.0), 0.0
    for factor, exponent in side.function.part.factors:
        if exponent > 0:
            tail = right_tail(side.function.bound, (factor,), (acb(1),), start)
            if isinstance(tail, str):
                return max(reached, side.function.frequency_of(WAVES)), tail
            radius = max(radius, tail)
    return radius, ""


def gaps_text(half_planes: Iterable[RightHalfPlane]) -> str:
    """Say why roots of several functions may be missing, each reason once and how far all are known.

    >>> gaps_text([RightHalfPlane((), "no end", 20.0), RightHalfPlane((), "no end", 10.0)])
    'known up to 1.592 Hz only: no end'
    """
    reached: dict[str, float] = {}
    for each in half_planes:
        if each.unproved:
            reached[each.unproved] = min(reached.get(each.unproved, each.reached), each.reached)
    return "; ".join(
        f"known up to {radius / (2 * pi):.4g} Hz only: {reason}"
        if radius > 0 and WITHOUT_END not in reason
        else reason
        for reason, radius in reached.items()
    )

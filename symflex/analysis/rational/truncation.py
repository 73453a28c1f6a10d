"""Which poles and zeros a rational approximation keeps.

Input: a bound transfer function, and a number of modes or a highest frequency. Output: a :class:`KeptRoots`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import takewhile
from typing import TYPE_CHECKING

from symflex.errors import Diagnostic, UsageError
from symflex.roots import Band, Everything, Modes, Position
from symflex.roots.locate import locate
from symflex.roots.verdict import is_right

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.roots import PoleZeroMap, Root
    from symflex.transfer import BoundTransferFunction

FURTHER = (1, 4)
"""Modes beyond those kept that are looked for: a double root counts as two and is not divided."""


@dataclass(frozen=True, slots=True)
class KeptRoots:
    """The poles and zeros that are kept."""

    modes: int  # modes among the poles, roots at 0 aside
    # poles and zeros: those kept.
    poles: tuple[Root, ...]
    zeros: tuple[Root, ...]
    found: PoleZeroMap  # what was known, some of those left out among them
    omitted_hz: float | None  # natural frequency of the first pole left out [Hz]
    is_exact: bool  # nothing is left out of a rational function
    # By how much the degree of the numerator exceeds that of the denominator, of a rational function of which
    # nothing is left out; else 0.
    excess: int

    @property
    def highest_hz(self) -> float | None:
        """The highest natural frequency of a pole kept [Hz], of a zero when there is none but 0."""
        for roots in (self.poles, self.zeros):
            frequencies = [root.frequency_hz() for root in roots if not root.is_zero]
            if frequencies:
                return max(frequencies)
        return None


def truncate(bound: BoundTransferFunction, modes: int, digits: int) -> KeptRoots:
    """Return the poles of a number of modes, and the zeros below the first pole left out.

    Poles in the right half plane are kept wherever they lie: without them the approximation would be stable.
    Zeros are left out from above until there are no more than poles, unless nothing is left out of a rational
    function: what grows with s is of no use to a simulation. Modes count as in :class:`symflex.roots.Modes`,
    roots at 0 aside; SF902 for a number below zero.
    """
    if modes < 0:
        raise UsageError(Diagnostic("SF902", f"the number of modes cannot be {modes}"))
    for further in FURTHER:
        region = Modes(modes + further) if bound.is_distributed else Everything()
        found = locate(bound, region, digits)
        poles, left_out = _lowest(found, modes)
        if left_out or not bound.is_distributed:
            break
    omitted = min((root.frequency_hz() for root in left_out), default=None)
    zeros, above = _zeros_below(bound, found, omitted, digits)
    is_exact = not left_out and not bound.is_distributed
    if not is_exact:
        zeros = _no_more_than(zeros, sum(root.multiplicity for root in poles))
    excess = max(_count(zeros) - _count(poles), 0) if is_exact else 0
    known = replace(found, zeros=above)
    return KeptRoots(len(_modes_of(poles)), poles, zeros, known, omitted, is_exact, excess)


def modes_up_to(bound: BoundTransferFunction, high_hz: float, digits: int) -> int:
    """Return how many modes have natural frequencies up to a limit [Hz]."""
    return len(_modes_of(locate(bound, Band(Fraction(0), Fraction(high_hz)), digits).poles))


def _count(roots: Sequence[Root]) -> int:
    return sum(root.multiplicity for root in roots)


def _modes_of(roots: Sequence[Root]) -> list[Root]:
    """Return the roots that count: one of each pair, a multiple one as often as it is one."""
    return [root for root in roots if not root.is_zero and not root.im < 0 for _ in range(root.multiplicity)]


def _lowest(found: PoleZeroMap, modes: int) -> tuple[tuple[Root, ...], tuple[Root, ...]]:
    """Return the poles of the lowest modes with those at 0 and in the right half plane, and the others."""
    positions = Modes(modes).classify(found.poles)
    is_kept = [p is not Position.OUTSIDE or is_right(r) for r, p in zip(found.poles, positions, strict=True)]
    kept = tuple(r for r, keep in zip(found.poles, is_kept, strict=True) if keep)
    left_out = tuple(r for r, keep in zip(found.poles, is_kept, strict=True) if not keep)
    return (*kept, *found.unstable), left_out


def _zeros_below(
    bound: BoundTransferFunction, found: PoleZeroMap, limit_hz: float | None, digits: int
) -> tuple[tuple[Root, ...], tuple[Root, ...]]:
    """Return the zeros with natural frequencies below a limit, and all that are known."""
    known = found.zeros
    if limit_hz is None:
        return known, known
    if bound.is_distributed and all(root.frequency_hz() < limit_hz for root in known):
        # There may be more of them below the limit than were asked for.
        known = locate(bound, Band(Fraction(0), Fraction(limit_hz)), digits).zeros
    return tuple(takewhile(lambda root: root.frequency_hz() < limit_hz, known)), known


def _no_more_than(zeros: Sequence[Root], poles: int) -> tuple[Root, ...]:
    """Leave out zeros from above, mirror images together, until there are no more of them than poles."""
    kept = list(zeros)
    while _count(kept) > poles and not kept[-1].is_zero:
        last = kept[-1].frequency_hz()
        kept = [root for root in kept if root.is_zero or root.frequency_hz() < last * (1 - 1e-12)]
    return tuple(kept)

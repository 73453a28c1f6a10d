"""How many roots the equations have about a point.

Their determinants are entire; values on a small circle give the Taylor coefficients ``c_k r^k``. If one of
these is larger than all others together, the circle holds k roots (Rouche 1862).

    f = (s - 2)^2 (s - 5) about s = 2, r = 1e-38:  -3 r^2 is larger than r^3, and the disc holds two roots
"""

from __future__ import annotations

from contextlib import suppress
from math import ceil, log
from typing import TYPE_CHECKING

from flint import acb, arb

from symflex.balls import UndecidedError, precision

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.roots.networks.cramer import CramerEquations

NARROW = 128
"""Binary digits of abs(s) within which roots count as lying at a point: 38 decimal ones."""
WIDER = 100
"""Doublings of the radius of the disc in which the determinants are bounded."""
SPARE = 8
"""Values on the circle beyond those that the bound takes: orders from about so high on are not counted."""
MOST_POINTS = 64
"""Where the bound is cruder, as where waves grow thousandfold, roots are not counted."""
BITS = 1024, 4096
"""With which the coefficients are computed; each order takes ``NARROW`` of them."""


def roots_about(cramer: CramerEquations, s: acb) -> tuple[int | None, int | None]:
    """Return how many roots denominator and numerator have within ``2^-NARROW abs(s)`` of a point: proved.

    None for one whose roots are not counted: it vanishes everywhere, or has more than are looked for.
    """
    found: tuple[int | None, int | None] = (None, None)
    for bits in BITS:
        with precision(bits), suppress(UndecidedError):
            reach = (abs(s.mid()) * arb(2) ** -NARROW).mid()
            bounds = cramer.bounds_on(_box(s, reach * arb(2) ** WIDER))
            first = cramer.at((s.mid() + reach).mid(), bits)
            beyond = (b - _log(v) for b, v in zip(bounds, (first.den, first.num), strict=True) if v != 0)
            count = SPARE + ceil(max(beyond, default=0.0) / (WIDER * log(2)))
            if count > MOST_POINTS:
                break
            turns = (acb(0, 2 * arb.pi() * k / count).exp() for k in range(1, count))
            values = [first, *(cramer.at((s.mid() + reach * turn).mid(), bits) for turn in turns)]
            sides = [v.den for v in values], [v.num for v in values]
            found = _largest(sides[0], bounds[0]), _largest(sides[1], bounds[1])
        if None not in found:
            break
    return found


def _box(s: acb, reach: arb) -> acb:
    return acb(arb(s.real.mid(), reach.upper()), arb(s.imag.mid(), reach.upper()))


def _largest(values: Sequence[acb], log_bound: float) -> int | None:
    """Return which Taylor coefficient exceeds all others together; ``None`` where none is proved to."""
    n = len(values)
    others = arb(log_bound).exp() * arb(2) ** (1 - WIDER * n)
    aliased = acb(arb(0, others.upper()), arb(0, others.upper()))
    sizes = [abs(c / n + aliased) for c in acb.dft(list(values))]
    return next((k for k in range(n) if sizes[k] > sum((*sizes[:k], *sizes[k + 1 :]), others)), None)


def _log(value: acb) -> float:
    return float(value.abs_upper().log().mid())

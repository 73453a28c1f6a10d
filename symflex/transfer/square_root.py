"""Square roots of balls and series that are analytic where they are asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flint import acb, acb_series, arb

if TYPE_CHECKING:
    from symflex.transfer.monomials import Value

NOWHERE = acb("nan", "nan")
NARROW = 2.0**-30
"""Relative radius of balls whose square root needs no special care."""


def square_root(x: Value) -> Value:
    """Return a square root that is analytic on the ball, tight where the ball is wide.

    Whether the ball crosses the cut of the principal root does not matter then.

    Examples
    --------
    >>> from flint import acb, arb
    >>> bool((square_root(acb(arb(-4, 1))) ** 2).contains(acb(-4)))
    True
    """
    base = x[0] if isinstance(x, acb_series) else x
    middle = base.mid()
    if middle == 0:
        return x.sqrt()
    reach = (base / middle - 1).abs_upper()
    if reach < NARROW:
        return (x / middle).sqrt() * middle.sqrt()
    if not reach < 1:
        # Of a ball that holds 0 no branch is analytic.
        return NOWHERE if isinstance(x, acb) else acb_series([NOWHERE] * x.prec, x.prec)
    # sqrt(m) sqrt(1 + e) with abs(e) <= d differs from sqrt(m) by at most (1 - sqrt(1 - d)) sqrt(m).
    off = (1 - (1 - reach).sqrt()).upper()
    root = middle.sqrt() * acb(arb(1, off), arb(0, off))
    if isinstance(x, acb):
        return root
    found = [root]
    for n in range(1, x.prec):
        crossed = sum((found[k] * found[n - k] for k in range(1, n)), acb(0))
        found.append((x[n] - crossed) / (2 * root))
    return acb_series(found, x.prec)

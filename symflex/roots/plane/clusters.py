"""Telling apart roots that lie close together, by the moments of a circle about them.

For the n roots inside a circle about c, the integral of ``(s - c)^k f'/f`` is ``2 pi j`` times their k-th
power sum (Delves and Lyness 1967); Newton's identities make a polynomial of degree n out of these, whose
roots are guesses that are then proved one by one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flint import acb, acb_poly, arb

from symflex.roots.plane.branch_points import prove_together
from symflex.roots.plane.simple_root import prove_simple
from symflex.roots.precision import precision
from symflex.roots.root import GUARD_BITS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.roots.functions.kernel_function import KernelFunction
    from symflex.roots.root import Root

POINTS = 64
"""On a circle: the trapezoidal rule's error falls like the roots' distance from its centre to this power."""
MOST = 12
"""Roots one cluster may have."""
NEARLY_WHOLE = 0.01
"""Difference from an integer of a number of roots that is believed."""
ACCURACY = 2.0**-120
"""Of the guesses, in radii: clusters are small in their circle."""


def resolve(
    function: KernelFunction, centre: acb, radius: arb, digits: int, bits: int, *, even: bool
) -> list[Root] | None:
    """Return all roots inside a circle with enclosures, ``None`` where they do not separate.

    The centre is exact; the circle, of ``radius`` [rad/s], passes between roots, well away from all. ``bits``
    are the precision of the moments; ``even`` roots mirror each other in the imaginary axis.
    """
    found: list[Root] = []
    with precision(bits):
        directions = [(acb(0, 2) * arb.pi() * k / POINTS).exp() for k in range(POINTS)]
        samples = [function.enclosed((centre + radius * d).mid(), bits) for d in directions]
    for i in range(len(samples[0])):
        if samples[0][i][2] <= 0:
            continue
        with precision(bits):
            weights = [d * radius * s[i][1] / s[i][0] for d, s in zip(directions, samples, strict=True)]
            guesses = _guesses(weights, directions)
        if guesses is None:
            return None
        for guess in guesses:
            with precision(bits + GUARD_BITS):
                start = (centre + radius * guess).mid()
            root = prove_simple(function, start, digits, factor=i, even=even, first_bits=bits)
            if root is None:
                root = prove_together(function, start, radius, digits, function.power, even=even)
            if root is None:
                return None
            found.append(root)
    return found if _are_apart(found) else None


def middle_of(function: KernelFunction, centre: acb, radius: arb, bits: int) -> acb | None:
    """Return about the mean of the roots inside a circle, ``None`` where it cannot be told."""
    with precision(bits):
        total, count = acb(0), acb(0)
        for k in range(POINTS):
            direction = (acb(0, 2) * arb.pi() * k / POINTS).exp()
            s = (centre + radius * direction).mid()
            for value, slope, exponent in function.enclosed(s, bits):
                weight = exponent * direction * slope / value
                count += weight
                total += weight * direction
        mean = centre + radius * total / count
        return mean.mid() if mean.is_finite() else None


def _guesses(weights: Sequence[acb], directions: Sequence[acb]) -> list[acb] | None:
    """Return the roots of one factor inside the circle, in its radius from its centre."""
    if not all(w.is_finite() for w in weights):
        return None
    moments = []
    powers = [acb(1)] * len(weights)
    count = 0
    for k in range(MOST + 1):
        moment = sum((p * w for p, w in zip(powers, weights, strict=True)), acb(0)) / POINTS
        if k == 0:
            count = round(float(moment.real.mid()))
            if abs(complex(moment.mid()) - count) > NEARLY_WHOLE or not 0 <= count <= MOST:
                return None
        moments.append(moment.mid())
        if k == count:
            break
        powers = [(p * d).mid() for p, d in zip(powers, directions, strict=True)]
    # Newton's identities: k e_k = sum of (-1)^(i-1) e_(k-i) p_i.
    elementary = [acb(1)]
    for k in range(1, count + 1):
        terms = ((-1) ** (i - 1) * elementary[k - i] * moments[i] for i in range(1, k + 1))
        elementary.append((sum(terms, acb(0)) / k).mid())
    polynomial = acb_poly([(-1) ** (count - i) * elementary[count - i] for i in range(count + 1)])
    if count == 0:
        return []
    try:
        return [root.mid() for root in polynomial.roots(tol=ACCURACY)]
    except ValueError:
        return None


def _are_apart(roots: Sequence[Root]) -> bool:
    if not roots:
        return True
    with precision(max(root.working_bits() for root in roots)):
        boxes = [root.enclosure() for root in roots]
        return not any(a.overlaps(b) for i, a in enumerate(boxes) for b in boxes[:i])

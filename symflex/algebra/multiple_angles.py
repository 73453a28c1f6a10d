"""Kernels of a length rewritten in kernels of a multiple of it, where only multiples occur.

``cos^k`` and ``sin cos^k`` are sums of ``cos(i x)`` and ``sin(i x)``; where every i is a multiple of n, the
angle ``n x`` serves. Hyperbolic functions follow the same rules.
"""

from __future__ import annotations

from fractions import Fraction
from math import comb
from typing import TYPE_CHECKING

from symflex.algebra.factored import Factored
from symflex.algebra.ring import coefficients_of

if TYPE_CHECKING:
    from flint import fmpz_mpoly

    from symflex.algebra.exponentials import KernelPair
    from symflex.algebra.ring import Ring


def lift(ring: Ring, polynomial: fmpz_mpoly, angle: KernelPair, n: int) -> Factored | None:
    """Return a polynomial in normal form with an angle's kernels standing for n times its argument.

    It is of degree one at most in the odd kernel; ``None`` when it is not a polynomial in kernels of the
    multiple.
    """
    even, odd = ring.index[angle.even.generator], ring.index[angle.odd.generator]
    parts = coefficients_of(ring, polynomial, (even, odd))
    highest = max((k + o for k, o in parts), default=0)
    zero = ring.constant(0)
    harmonics: dict[tuple[int, int], fmpz_mpoly] = {}
    for (k, o), coefficient in parts.items():
        if o > 1:
            return None
        part = coefficient * 2 ** (highest - k)
        for i, o_i, weight in _harmonics(k, o):
            if o_i and not i:
                continue
            key = (i, o_i)
            harmonics[key] = harmonics.get(key, zero) + part * weight
    c, s = ring.generator(angle.even.generator), ring.generator(angle.odd.generator)
    total = zero
    for (i, o), part in harmonics.items():
        if part.is_zero():
            continue
        if i % n:
            return None
        c_i, s_i = _multiple(ring, c, s, i // n)
        total = total + part * (s_i if o else c_i)
    return Factored.polynomial(ring, total) * Fraction(1, 2**highest)


def _harmonics(k: int, odd: int) -> list[tuple[int, int, int]]:
    """Return ``2^k cos^k`` or ``2^k sin cos^k`` as (multiple, odd or even, weight).

    ``2^k cos^k x = sum_j C(k, j) cos((k - 2j) x)``; times ``sin x``, ``sin x cos(i x)`` is half of
    ``sin((i + 1) x) - sin((i - 1) x)``.
    """
    found = []
    for j in range(k + 1):
        i = k - 2 * j
        if not odd:
            found.append((abs(i), 0, comb(k, j)))
        else:
            # Pairs of j and k - j make each half a whole: the sum over all j of sin((i + 1) x).
            multiple = i + 1
            found.append((abs(multiple), 1, comb(k, j) if multiple > 0 else -comb(k, j)))
    return found


def _multiple(ring: Ring, c: fmpz_mpoly, s: fmpz_mpoly, times: int) -> tuple[fmpz_mpoly, fmpz_mpoly]:
    """Return the even and the odd kernel of a multiple of the argument, in normal form."""
    even, over = ring.constant(1), ring.constant(0)
    for _ in range(times):
        # sinh^2 and -sin^2 are both this square less one.
        even, over = even * c + over * (c * c - 1), over * c + even
    return even, over * s

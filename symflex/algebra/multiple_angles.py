"""Kernels of a length rewritten in kernels of a multiple of it, where only multiples occur.

``cos^k`` and ``sin cos^k`` are sums of ``cos(i x)`` and ``sin(i x)``; where every i is a multiple of n, the
angle ``n x`` serves. Hyperbolic functions follow the same rules.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from symflex.algebra.exponential_sum import spread
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
        for i, weight in _harmonics(k, o):
            harmonics[i, o] = harmonics.get((i, o), zero) + part * weight
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


def _harmonics(k: int, odd: int) -> list[tuple[int, int]]:
    """Return ``2^k cos^k x``, or ``2^k sin x cos^k x``, by cosines, or sines, of multiples.

    Exponentials of opposite multiples make one cosine or sine.
    """
    return [(abs(i), weight) for i, weight in spread(k, odd).items() if i > 0 or not odd]


def _multiple(ring: Ring, c: fmpz_mpoly, s: fmpz_mpoly, times: int) -> tuple[fmpz_mpoly, fmpz_mpoly]:
    """Return the even and the odd kernel of a multiple of the argument, in normal form."""
    even, over = ring.constant(1), ring.constant(0)
    for _ in range(times):
        # sinh^2 and -sin^2 are both this square less one.
        even, over = even * c + over * (c * c - 1), over * c + even
    return even, over * s

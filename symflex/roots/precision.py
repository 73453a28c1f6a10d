"""Working precision of python-flint, set for a block and always restored; balls as mpmath numbers."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import flint

if TYPE_CHECKING:
    import mpmath
    from flint import acb, arb


BITS_PER_DIGIT = math.log2(10)


class precision:  # noqa: N801 (reads as a statement)
    """Compute with ``bits`` bits, at least 2, inside the block; restore the former precision on every exit.

    Examples
    --------
    >>> import flint
    >>> before = flint.ctx.prec
    >>> with precision(200):
    ...     flint.arb(2).sqrt().rel_accuracy_bits() > 190
    True
    >>> flint.ctx.prec == before
    True
    """

    __slots__ = ("_bits", "_former")

    def __init__(self, bits: int) -> None:
        self._bits = bits

    def __enter__(self) -> None:
        self._former = flint.ctx.prec
        flint.ctx.prec = self._bits

    def __exit__(self, *raised: object) -> None:
        flint.ctx.prec = self._former


def bits_for_digits(digits: int) -> int:
    """Return the bits that ``digits`` decimal digits need, with a few to spare.

    Examples
    --------
    >>> bits_for_digits(50)
    183
    """
    return math.ceil(digits * BITS_PER_DIGIT) + 16


def to_mpmath(ball: arb) -> mpmath.mpf:
    """Return the midpoint of a real ball, exactly.

    Examples
    --------
    >>> from flint import arb
    >>> to_mpmath(arb(0.75))
    mpf('0.75')
    """
    import mpmath  # most commands need none of it

    mantissa, exponent = ball.mid().man_exp()
    return mpmath.mp.make_mpf(mpmath.libmp.from_man_exp(int(mantissa), int(exponent)))


def to_complex_mpmath(ball: acb) -> mpmath.mpc:
    """Return the midpoint of a complex ball, exactly."""
    import mpmath  # most commands need none of it

    # mpmath.mpc(re, im) would round to the working precision.
    return mpmath.mp.make_mpc((to_mpmath(ball.real)._mpf_, to_mpmath(ball.imag)._mpf_))

"""Working precision of python-flint: set for a block, and raised until something is decided.

Input: a number of bits, or the first and the last. Output: the same computation at that precision; the former
precision is restored on every exit. Only this module reads or writes ``flint.ctx``. Example: 64 bits decide
that ``sin(22) < 0``; no precision decides the sign of ``sin(pi)``, so the caller names the last one. Theorem:
a ball contains the value at every precision (Johansson 2017, IEEE Trans. Comput. 66, 1281), so more bits
sharpen an answer and never change it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, TypeVar

import flint
from flint import acb, arb

if TYPE_CHECKING:
    import mpmath


BITS_PER_DIGIT = math.log2(10)
MOST_BITS = 20_000  # no value asked for so far needed a tenth of it

Settled = TypeVar("Settled")


class UndecidedError(Exception):
    """A sign is not decided at this precision, or at this point."""


class precision:  # noqa: N801 (reads as a statement)
    """Compute with ``bits`` bits, at least 2, inside the block; restore the former precision on every exit.

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


def current_bits() -> int:
    """Return with how many bits balls are computed."""
    return flint.ctx.prec


def precisions(first: int, last: int) -> Iterator[int]:
    """Yield ``first`` and its doubles as long as they are at most ``last``.

    >>> list(precisions(64, 300))
    [64, 128, 256]
    """
    while first <= last:
        yield first
        first *= 2


def settled(compute: Callable[[], Settled], bits: int) -> Settled:
    """Return what is computed with at least so many bits; UndecidedError where too many would be needed."""
    for enough in precisions(bits, max(bits, MOST_BITS)):
        with suppress(UndecidedError), precision(enough):
            return compute()
    raise UndecidedError


@contextmanager
def series_terms(count: int) -> Iterator[None]:
    """Compute power series to so many terms inside the block; restore the former number on every exit."""
    former = flint.ctx.cap
    flint.ctx.cap = count
    try:
        yield
    finally:
        flint.ctx.cap = former


def current_terms() -> int:
    """Return to how many terms power series are computed."""
    return flint.ctx.cap


def bits_for_digits(digits: int) -> int:
    """Return the bits that ``digits`` decimal digits need, with a few to spare.

    >>> bits_for_digits(50)
    183
    """
    return math.ceil(digits * BITS_PER_DIGIT) + 16


def to_mpmath(ball: arb) -> mpmath.mpf:
    """Return the midpoint of a real ball, exactly.

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

"""Working precision of python-flint, set for a block and always restored."""

from __future__ import annotations

import math

import flint

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

"""Working precision of python-flint, set for a block and always restored."""

from __future__ import annotations

import math
from contextlib import contextmanager
from typing import TYPE_CHECKING

import flint

if TYPE_CHECKING:
    from collections.abc import Iterator

BITS_PER_DIGIT = math.log2(10)


@contextmanager
def precision(bits: int) -> Iterator[None]:
    """Compute with ``bits`` bits inside the block; restore the former precision on every exit.

    Parameters
    ----------
    bits : int
        Precision of midpoints, at least 2.

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
    former = flint.ctx.prec
    flint.ctx.prec = bits
    try:
        yield
    finally:
        flint.ctx.prec = former


def bits_for_digits(digits: int) -> int:
    """Return the bits that ``digits`` decimal digits need, with a few to spare.

    Examples
    --------
    >>> bits_for_digits(50)
    183
    """
    return math.ceil(digits * BITS_PER_DIGIT) + 16

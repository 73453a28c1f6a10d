"""Bytes that anybody may have written, read without passing their end.

    00 00 00 02 | 3f f0 00 00 00 00 00 00 | ...
    integer("i4") = 2, and then numbers("f8", (2,)) raises ValueError: it is cut short

What a file claims is compared with what is there before anything is allocated. Readers of .npz, .mat and
netCDF files share these checks; each raises ValueError with the reason, OverflowError beyond a limit.
"""

from __future__ import annotations

from math import prod
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

CUT = "it is cut short"
SHOWN = 80
"""Characters of a message that repeats what a file says."""
LAST_CHARACTER: Final = 0x10FFFF
SURROGATES: Final = (0xD800, 0xDFFF)
"""Unicode's range of characters, and the halves of pairs in it that are none (Unicode 15, section 3.9)."""
DIMENSIONS_LIMIT = 32
"""Of numpy 1; version 2 takes 64."""


def require(is_met: bool, reason: str) -> None:
    """Raise a ValueError with the reason unless a condition is met."""
    if not is_met:
        raise ValueError(reason)


class ByteReader:
    """Bytes that are taken one after the other.

    ``order``, ``<`` or ``>``, is which end of a number comes first.

    Examples
    --------
    >>> reader = ByteReader(bytes([0, 0, 0, 2, 1]), ">")
    >>> reader.integer("i4"), reader.left
    (2, 1)
    >>> reader.take(2)
    Traceback (most recent call last):
    ValueError: it is cut short
    """

    def __init__(self, data: bytes | memoryview, order: str = "<") -> None:
        self.data = memoryview(data)
        self.order = order
        self.place = 0

    @property
    def left(self) -> int:
        """How many bytes were not taken."""
        return len(self.data) - self.place

    def take(self, count: int) -> memoryview:
        """Return the next bytes; ValueError when there are fewer."""
        require(0 <= count <= self.left, CUT)
        self.place += count
        return self.data[self.place - count : self.place]

    def align(self, size: int) -> None:
        """Go to the next multiple of a size, or to the end."""
        self.place = min(-(-self.place // size) * size, len(self.data))

    def numbers(self, kind: str, shape: Sequence[int], order: Literal["C", "F"] = "C") -> npt.NDArray[Any]:
        """Return an array of numbers of one kind, such as ``f8``, in the bytes' own order.

        ValueError when there are fewer bytes, or the shape is none; nothing is allocated for what is not
        there.
        """
        if len(shape) > DIMENSIONS_LIMIT or any(size < 0 for size in shape):
            message = f"an array has the shape {' x '.join(map(str, shape))}"[:SHOWN]
            raise ValueError(message)
        dtype = np.dtype(self.order + kind)
        count = prod(shape)
        if not count:
            # Nothing is there, and yet it would be walked through.
            require(max(shape) <= len(self.data), CUT)
            return np.empty(tuple(shape), dtype)
        taken = self.take(count * dtype.itemsize)
        if dtype.kind == "U":
            codes = np.frombuffer(taken, np.dtype(self.order + "u4"))
            wrong = (codes > LAST_CHARACTER) | ((codes >= SURROGATES[0]) & (codes <= SURROGATES[1]))
            require(not np.any(wrong), "a text holds what is not a character")
        return np.frombuffer(taken, dtype).reshape(tuple(shape), order=order)

    def integer(self, kind: str) -> int:
        """Return one integer."""
        return int(self.numbers(kind, (1,))[0])

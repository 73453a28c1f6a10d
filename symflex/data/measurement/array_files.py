"""Arrays in .npz and netCDF 3 files that anybody may have written, read without passing their end.

    00 00 00 02 | 3f f0 00 00 00 00 00 00 | ...
    integer("i4") = 2, and then numbers("f8", (2,)) raises ValueError: it is cut short

What a file claims is compared with what is there before anything is allocated; nothing is unpickled. Readers
of .npz, .mat and netCDF files share these checks; each raises ValueError with the reason, OverflowError
beyond a limit. ``numpy.load`` allocates what a header claims before it reads: 144 bytes ask for gigabytes.

The layouts are PKWARE's APPNOTE 6.3.10 for an archive and numpy's enhancement proposal 1 for what is in it;
Unidata, NetCDF Classic Format Specification (versions 1 and 2: 32 and 64-bit offsets).
"""

from __future__ import annotations

import re
import zipfile
import zlib
from io import BytesIO
from math import prod
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np
import numpy.typing as npt

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


Arrays = dict[str, npt.NDArray[Any]]

_MAGIC: Final = b"\x93NUMPY"
_ENDING: Final = ".npy"
_DESCRIPTION: Final = re.compile(r"'descr': '([<>|=]?)([biufcSU?]\d{0,6})'")
_ORDER: Final = re.compile(r"'fortran_order': (True|False)")
_SHAPE: Final = re.compile(r"'shape': \(((?:\d{1,12}, ?)*\d{0,12}),?\)")
_END, _END_SIZE, _END_64, _COMMENT = b"PK\x05\x06", 22, b"PK\x06\x07", 0xFFFF
"""The record that ends an archive: signature, size, its locator of 64 bits, the longest comment."""
_DIRECTORY_LIMIT: Final = 2**20
"""Bytes of an archive's list of members: some ten thousand of them."""
_IS_ENCRYPTED = 1
"""Bit of a member's flags."""


def read_archive(data: bytes, limit: int, members: int) -> Arrays:
    """Return the arrays of an .npz by name.

    ValueError with the reason: no archive, encrypted, cut short, arrays of objects. OverflowError when the
    arrays take more than ``limit`` bytes together, or are more than ``members``.

    Examples
    --------
    >>> read_archive(b"PK", 100, 10)
    Traceback (most recent call last):
    ValueError: it is not an archive, or is cut short
    """
    _check_directory(data)
    try:
        with zipfile.ZipFile(BytesIO(data)) as file:
            infos = file.infolist()
            if len(infos) > members or sum(info.file_size for info in infos) > limit:
                raise OverflowError
            return {info.filename.removesuffix(_ENDING): _array(_member(file, info)) for info in infos}
    except (zipfile.BadZipFile, zlib.error, OSError, EOFError, KeyError, NotImplementedError) as error:
        raise ValueError(str(error)[:100] or CUT) from None


def _check_directory(data: bytes) -> None:
    """Refuse an archive with a list of members that is large itself: each is an object in memory."""
    end = data.rfind(_END, max(len(data) - _END_SIZE - _COMMENT, 0))
    require(end >= 0 and len(data) - end >= _END_SIZE, "it is not an archive, or is cut short")
    size = int.from_bytes(data[end + 12 : end + 16], "little")
    if size > _DIRECTORY_LIMIT or _END_64 in data[max(end - 20, 0) : end]:
        raise OverflowError


def _member(file: zipfile.ZipFile, info: zipfile.ZipInfo) -> bytes:
    require(not info.flag_bits & _IS_ENCRYPTED, f"'{info.filename[:40]}' in it is encrypted")
    require(
        info.compress_type in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED),
        f"'{info.filename[:40]}' in it is compressed in an unknown way",
    )
    with file.open(info) as member:
        content = member.read(info.file_size + 1)
    require(len(content) == info.file_size, f"'{info.filename[:40]}' in it is cut short")
    return content


def _array(content: bytes) -> npt.NDArray[Any]:
    """Return the array of an .npy file."""
    reader = ByteReader(content)
    require(bytes(reader.take(len(_MAGIC))) == _MAGIC, "a member is not an array")
    major = reader.integer("u1")
    reader.take(1)
    header = bytes(reader.take(reader.integer("u2" if major == 1 else "u4"))).decode("latin-1")
    description, order, shape = (pattern.search(header) for pattern in (_DESCRIPTION, _ORDER, _SHAPE))
    if description is None or order is None or shape is None:
        message = "an array is of no plain numbers or texts"
        raise ValueError(message)
    sizes = [int(size) for size in re.findall(r"\d+", shape[1])]
    reader.order = description[1] or "="
    try:
        return reader.numbers(description[2], sizes, "F" if order[1] == "True" else "C")
    except TypeError:  # a kind of number that numpy has not
        message = f"an array is of an unknown kind '{description[2]}'"
        raise ValueError(message) from None


Attributes = dict[str, str]
Variable = tuple[tuple[str, ...], npt.NDArray[Any], Attributes]

_TYPES: Final = {1: "i1", 2: "S1", 3: "i2", 4: "i4", 5: "f4", 6: "f8"}
_DIMENSION, _VARIABLE, _ATTRIBUTE, _ABSENT, _TEXT = 10, 11, 12, 0, 2
"""Tags of lists, and the type of characters, as the specification numbers them."""
_OFFSETS: Final = {1: "i4", 2: "i8"}


def read_netcdf(data: bytes, items: int) -> tuple[Attributes, dict[str, Variable]]:
    r"""Return global attributes, and by name of every variable its dimensions, values and attributes.

    ValueError with the reason: no such file, cut short, an unlimited dimension that is not empty, or
    variables that stand in the same place. OverflowError for more than ``items`` dimensions, variables or
    attributes.

    Examples
    --------
    >>> read_netcdf(b"CDF\x05", 10)
    Traceback (most recent call last):
    ValueError: it is neither netCDF 3 nor .npz
    """
    reader = ByteReader(data, ">")
    require(data[:3] == b"CDF" and data[3:4] in (b"\x01", b"\x02"), "it is neither netCDF 3 nor .npz")
    reader.take(3)
    offset = _OFFSETS[reader.integer("u1")]
    records = reader.integer("i4")
    dimensions = [(_name(reader), reader.integer("i4")) for _ in range(_count(reader, _DIMENSION, items))]
    attributes = _attributes(reader, items)
    found: dict[str, Variable] = {}
    left = len(data)
    for _ in range(_count(reader, _VARIABLE, items)):
        name = _name(reader)
        numbers = [reader.integer("i4") for _ in range(_checked(reader.integer("i4"), items))]
        require(
            all(0 <= number < len(dimensions) for number in numbers), "a variable has an unknown dimension"
        )
        about = _attributes(reader, items)
        kind = _type(reader)
        reader.integer("i4")  # the size, which dimensions and type say as well
        begin = reader.integer(offset)
        shape = [dimensions[number][1] for number in numbers]
        require(not (0 in shape and records), f"variable '{name[:40]}' has an unlimited dimension")
        body = ByteReader(data, ">")
        body.take(begin)
        values = body.numbers(kind, shape)
        left -= values.nbytes
        require(left >= 0, "variables stand in the same place")
        found[name] = tuple(dimensions[number][0] for number in numbers), values, about
    return attributes, found


def _checked(count: int, items: int) -> int:
    if not 0 <= count <= items:
        raise OverflowError
    return count


def _count(reader: ByteReader, tag: int, items: int) -> int:
    found, count = reader.integer("i4"), reader.integer("i4")
    require(found == tag or (found, count) == (_ABSENT, 0), f"a list of kind {found}")
    return _checked(count, items)


def _name(reader: ByteReader) -> str:
    name = bytes(reader.take(reader.integer("i4"))).decode("utf-8")
    reader.align(4)
    return name


def _type(reader: ByteReader) -> str:
    number = reader.integer("i4")
    require(number in _TYPES, f"values of an unknown type {number}")
    return _TYPES[number]


def _attributes(reader: ByteReader, items: int) -> Attributes:
    """Return attributes as text."""
    found: Attributes = {}
    for _ in range(_count(reader, _ATTRIBUTE, items)):
        name, kind = _name(reader), _type(reader)
        values = reader.numbers(kind, (reader.integer("i4"),))
        reader.align(4)
        is_text = kind == _TYPES[_TEXT]
        found[name] = values.tobytes().decode("utf-8") if is_text else " ".join(map(str, values.tolist()))
    return found

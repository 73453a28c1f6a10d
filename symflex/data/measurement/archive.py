"""Numpy archives that anybody may have written: nothing is unpickled or allocated that is not there.

The layouts are PKWARE's APPNOTE 6.3.10 for the archive and numpy's enhancement proposal 1 for what is in it.
``numpy.load`` allocates what a header claims before it reads: 144 bytes ask for gigabytes.
"""

from __future__ import annotations

import re
import zipfile
import zlib
from io import BytesIO
from typing import Any, Final

import numpy.typing as npt

from symflex.data.measurement.byte_reader import CUT, ByteReader, require

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

"""MATLAB files of version 4 to 7: arrays of numbers and text, and nothing else of them.

scipy's reader ends the process on some files of a few hundred bytes, and a reader of our own, which takes no
byte that is not there, is shorter than a process to keep it in. The layout is that of The MathWorks, MAT-File
Format (R2023b): "Level 5 MAT-File Format" and "Level 4 MAT-File Format".
"""

from __future__ import annotations

import zlib
from math import prod
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symflex.data.measurement.array_files import CUT, SHOWN, SURROGATES, ByteReader, require

Arrays = dict[str, npt.NDArray[Any]]

_HEADER, _VERSION, _VERSION_5, _VERSION_7_3 = 128, 124, 1, 2
_STORED: Final = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
_TEXT: Final = {2: "utf-8", 16: "utf-8", 4: "utf-16", 17: "utf-16", 18: "utf-32"}
_MATRIX, _COMPRESSED = 14, 15
"""Data types of elements: an array, and a compressed element."""
_CELL, _CHAR, _NUMERIC = 1, 4, range(6, 16)
_COMPLEX_FLAG = 0x0800
_STORED_4: Final = ("f8", "f4", "i4", "i2", "u2", "u1")
_TEXT_4, _LAST_MOPT = 1, 4999
"""Version 4 begins with the decimal digits MOPT: machine, 0, kind of number, kind of matrix."""
_NAME_LIMIT = 63
"""Characters of a name in MATLAB."""
VARIABLES_LIMIT: Final = 10_000
"""Also of cells, and of lines of a text."""
TEXT_LIMIT = 1000
"""Characters of a line: of texts, numpy gives each the room of the longest."""
_OTHER: Final[npt.NDArray[Any]] = np.empty(0, object)
"""What stands for a structure, a sparse matrix and the like, whose content nobody asks for."""


class NewerFileError(ValueError):
    """The file is of version 7.3, which is HDF5."""


def read_variables(data: bytes, limit: int) -> Arrays:
    """Return the variables of a MATLAB file by name; compressed ones may grow to ``limit`` bytes together.

    Numbers and logical values have their shape without dimensions of size one, text is an array of lines,
    cells of text an array of their texts; of what is none of these there is an empty array of objects.
    ValueError with the reason: no such file, or cut short; OverflowError too large, or too many variables.
    """
    if 0 in data[:4]:  # in version 5 text stands there
        return _version_4(data)
    require(len(data) >= _HEADER, CUT)
    order = {b"IM": "<", b"MI": ">"}.get(data[126:128])
    if order is None:
        message = "no mark of byte order"
        raise ValueError(message)
    version = ByteReader(data[_VERSION:126], order).integer("u2") >> 8
    if version == _VERSION_7_3:
        raise NewerFileError
    require(version == _VERSION_5, f"unknown version {version}")
    reader = ByteReader(memoryview(data)[_HEADER:], order)
    found: Arrays = {}
    for _ in range(VARIABLES_LIMIT + 1):
        if not reader.left:
            return found
        kind, content = _element(reader)
        if kind == _COMPRESSED:
            stream = zlib.decompressobj()
            inflated = stream.decompress(content, limit + 1)
            limit -= len(inflated)
            if limit < 0:
                raise OverflowError
            require(stream.eof, CUT)
            kind, content = _element(ByteReader(inflated, order))
        if kind == _MATRIX:
            name, array = _matrix(ByteReader(content, order), are_cells_read=True)
            found[name] = array
    raise OverflowError


def _element(reader: ByteReader) -> tuple[int, memoryview]:
    """Return kind and content of the next data element; small ones stand in their own tag."""
    kind = reader.integer("u4")
    if kind >> 16:
        return kind & 0xFFFF, reader.take(4)[: min(kind >> 16, 4)]
    content = reader.take(reader.integer("u4"))
    if kind != _COMPRESSED:
        reader.align(8)
    return kind, content


def _matrix(reader: ByteReader, *, are_cells_read: bool) -> tuple[str, npt.NDArray[Any]]:
    """Return name and value of an array: flags, dimensions, name, then what its class asks for."""
    flags = ByteReader(_element(reader)[1], reader.order).integer("u4")
    dimensions = _numbers(*_element(reader), reader.order)
    shape = [int(size) for size in dimensions]
    name = bytes(_element(reader)[1]).decode("latin-1")[:_NAME_LIMIT]
    kind = flags & 0xFF
    if kind == _CHAR:
        return name, _lines(*_element(reader), reader.order, shape)
    if kind == _CELL and are_cells_read:
        cells = []
        while reader.left:
            inner, content = _element(reader)
            if inner == _MATRIX and content:
                cells.append(_matrix(ByteReader(content, reader.order), are_cells_read=False)[1])
                if len(cells) > VARIABLES_LIMIT:
                    raise OverflowError
        is_text = all(cell.dtype.kind == "U" and cell.size == 1 for cell in cells)
        return name, np.array([str(cell.item()) for cell in cells]) if cells and is_text else _OTHER
    if kind not in _NUMERIC:
        return name, _OTHER
    values = _shaped(_numbers(*_element(reader), reader.order), shape)
    if flags & _COMPLEX_FLAG:
        values = _complex(values, _shaped(_numbers(*_element(reader), reader.order), shape))
    return name, values


def _numbers(kind: int, content: memoryview, order: str) -> npt.NDArray[Any]:
    require(kind in _STORED, f"numbers of an unknown kind {kind}")
    stored = _STORED[kind]
    return ByteReader(content, order).numbers(stored, (len(content) // int(stored[1:]),))


def _shaped(values: npt.NDArray[Any], shape: list[int]) -> npt.NDArray[Any]:
    require(prod(shape) == values.size, f"{values.size} numbers for {' x '.join(map(str, shape))}"[:SHOWN])
    return np.squeeze(values.reshape(shape, order="F")) if values.size else values


def _complex(real: npt.NDArray[Any], imaginary: npt.NDArray[Any]) -> npt.NDArray[Any]:
    values = np.empty(real.shape, np.complex128)
    values.real, values.imag = real, imaginary  # a product with j would turn infinities into no numbers
    return values


def _lines(kind: int, content: memoryview, order: str, shape: list[int]) -> npt.NDArray[Any]:
    """Return text as an array of lines; in the file it stands by columns."""
    require(kind in _TEXT, f"text of an unknown kind {kind}")
    ending = "" if kind in (2, 16) else "-le" if order == "<" else "-be"
    text = bytes(content).decode(_TEXT[kind] + ending, "replace")
    rows = shape[0] if shape else 0
    if not text:
        return np.array("")
    if rows > VARIABLES_LIMIT:
        raise OverflowError
    require(rows >= 1 and len(text) % rows == 0, "text does not fill its lines")
    return np.squeeze(np.array([text[row : rows * TEXT_LIMIT : rows].rstrip(" \0") for row in range(rows)]))


def _version_4(data: bytes) -> Arrays:
    found: Arrays = {}
    order = "<" if int.from_bytes(data[:4], "little") <= _LAST_MOPT else ">"
    reader = ByteReader(data, order)
    for _ in range(VARIABLES_LIMIT + 1):
        if not reader.left:
            return found
        mopt, rows, columns, is_complex, length = (reader.integer("i4") for _ in range(5))
        kind, text = mopt // 10 % 10, mopt % 10
        is_header = 0 <= mopt <= _LAST_MOPT and kind < len(_STORED_4) and length >= 1
        require(is_header, "no header of a variable")
        name = bytes(reader.take(length)).decode("latin-1").split("\0")[0][:_NAME_LIMIT]
        shape = (rows, columns)
        values = reader.numbers(_STORED_4[kind], shape, "F")
        if is_complex == 1:
            values = _complex(values, reader.numbers(_STORED_4[kind], shape, "F"))
        if text == _TEXT_4:
            if rows > VARIABLES_LIMIT:
                raise OverflowError
            values = values[:, :TEXT_LIMIT]
            is_character = (values.real >= 0) & (values.real < SURROGATES[0])
            codes = np.where(is_character, values.real, ord("?")).astype(np.uint32)
            lines = ["".join(map(chr, row)).rstrip(" \0") for row in codes.tolist()]
            found[name] = np.squeeze(np.array(lines))
        else:
            found[name] = _OTHER if text else np.squeeze(values)
    raise OverflowError

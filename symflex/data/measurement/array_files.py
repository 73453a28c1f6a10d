"""Arrays in .npz, .mat and netCDF 3 files that anybody may have written, read without passing their end.

    00 00 00 02 | 3f f0 00 00 00 00 00 00 | ...
    integer("i4") = 2, and then numbers("f8", (2,)) raises ValueError: it is cut short

What a file claims is compared with what is there before anything is allocated; nothing is unpickled. Each
reader raises ValueError with the reason, OverflowError beyond a limit. ``numpy.load`` allocates what a header
claims before it reads: 144 bytes ask for gigabytes. scipy's reader of MATLAB files ends the process on some
of a few hundred bytes, and a reader of our own is shorter than a process to keep it in.

The layouts are PKWARE's APPNOTE 6.3.10 for an archive and numpy's enhancement proposal 1 for what is in it;
Unidata, NetCDF Classic Format Specification (versions 1 and 2: 32 and 64-bit offsets); The MathWorks,
MAT-File Format (R2023b): "Level 5 MAT-File Format" and "Level 4 MAT-File Format".
"""

from __future__ import annotations

import re
import zipfile
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from io import BytesIO
from math import prod
from typing import Any, Final, Literal

import numpy as np
import numpy.typing as npt

CUT = "it is cut short"
SHOWN = 80  # characters of a message that quotes a file
LAST_CHARACTER: Final = 0x10FFFF  # the end of the range of Unicode
SURROGATES: Final = (0xD800, 0xDFFF)  # halves of pairs, which are not characters (Unicode 15, section 3.9)
DIMENSIONS_LIMIT = 32  # of numpy 1; version 2 takes 64


def require(is_met: bool, reason: str) -> None:
    """Raise a ValueError with the reason unless a condition is met."""
    if not is_met:
        raise ValueError(reason)


class ByteReader:
    """Bytes that are taken one after the other.

    ``order``, ``<`` or ``>``, is which end of a number comes first.

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
        """Return an array of one kind, such as ``f8``; ValueError for fewer bytes, or what is no shape."""
        is_shape = len(shape) <= DIMENSIONS_LIMIT and all(size >= 0 for size in shape)
        require(is_shape, f"an array has the shape {' x '.join(map(str, shape))}"[:SHOWN])
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
            require(not np.any(wrong), "a text contains an invalid character")
        return np.frombuffer(taken, dtype).reshape(tuple(shape), order=order)

    def integer(self, kind: str) -> int:
        """Return one integer."""
        return int(self.numbers(kind, (1,))[0])


Arrays = dict[str, npt.NDArray[Any]]

_MAGIC: Final = b"\x93NUMPY"
_DESCRIPTION: Final = re.compile(r"'descr': '([<>|=]?)([biufcSU?]\d{0,6})'")
_FIELDS: Final = re.compile(
    r"'descr': \[((?:\('\w{1,60}', '[<>|=]?(?:[iu][1248]|f[48]|c8|c16)'\),? ?){1,99})\]"
)
_ORDER: Final = re.compile(r"'fortran_order': (True|False)")
_SHAPE: Final = re.compile(r"'shape': \(((?:\d{1,12}, ?)*\d{0,12}),?\)")
_END, _END_SIZE, _END_64, _COMMENT = b"PK\x05\x06", 22, b"PK\x06\x07", 0xFFFF
"""The record that ends an archive: signature, size, its locator of 64 bits, the longest comment."""
_DIRECTORY_LIMIT: Final = 2**20  # bytes of an archive's list of members: some ten thousand of them


def read_archive(data: bytes, limit: int, members: int) -> Arrays:
    """Return the arrays of an .npz by name; OverflowError beyond ``limit`` bytes or ``members`` arrays."""
    # Refuse an archive with a list of members that is large itself: each is an object in memory
    end = data.rfind(_END, max(len(data) - _END_SIZE - _COMMENT, 0))
    require(end >= 0 and len(data) - end >= _END_SIZE, "it is not an archive, or is cut short")
    size = int.from_bytes(data[end + 12 : end + 16], "little")
    if size > _DIRECTORY_LIMIT or _END_64 in data[max(end - 20, 0) : end]:
        raise OverflowError
    try:
        with zipfile.ZipFile(BytesIO(data)) as file:
            infos = file.infolist()
            if len(infos) > members or sum(info.file_size for info in infos) > limit:
                raise OverflowError
            named = ((info.filename.removesuffix(".npy"), _member(file, info)) for info in infos)
            return {key: array for name, member in named for key, array in read_array(name, member).items()}
    except (zipfile.BadZipFile, zlib.error, OSError, EOFError, KeyError, NotImplementedError) as error:
        raise ValueError(str(error)[:100] or CUT) from None


def _member(file: zipfile.ZipFile, info: zipfile.ZipInfo) -> bytes:
    name, is_known = (
        f"'{info.filename[:40]}'",
        info.compress_type in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED),
    )
    require(not info.flag_bits & 1, f"{name} in it is encrypted")
    require(is_known, f"{name} in it is compressed in an unknown way")
    with file.open(info) as member:
        content = member.read(info.file_size + 1)
    require(len(content) == info.file_size, f"{name} in it is cut short")
    return content


def read_array(name: str, content: bytes) -> Arrays:
    """Return the array of an .npy file under a name, or the fields of a structured one under their own."""
    reader = ByteReader(content)
    require(bytes(reader.take(len(_MAGIC))) == _MAGIC, "a member is not an array")
    major = reader.integer("u1")
    reader.take(1)
    header = bytes(reader.take(reader.integer("u2" if major == 1 else "u4"))).decode("latin-1")
    description, order, shape = (pattern.search(header) for pattern in (_DESCRIPTION, _ORDER, _SHAPE))
    if (fields := _FIELDS.search(header)) and shape:
        dtype = np.dtype(re.findall(r"'(\w+)', '([^']+)'", fields[1]))
        count = prod(int(size) for size in re.findall(r"\d+", shape[1]))
        rows = np.frombuffer(reader.take(count * dtype.itemsize), dtype)
        return {field: rows[field] for field in dtype.names or ()}
    if description is None or order is None or shape is None:
        raise ValueError("an array contains neither plain numbers nor text")
    sizes = [int(size) for size in re.findall(r"\d+", shape[1])]
    reader.order = description[1] or "="
    try:
        return {name: reader.numbers(description[2], sizes, "F" if order[1] == "True" else "C")}
    except TypeError:  # a kind of number that numpy has not
        raise ValueError(f"an array is of an unknown kind '{description[2]}'") from None


Attributes = dict[str, str]
Variable = tuple[tuple[str, ...], npt.NDArray[Any], Attributes]

_TYPES: Final = {1: "i1", 2: "S1", 3: "i2", 4: "i4", 5: "f4", 6: "f8"}
_DIMENSION, _VARIABLE, _ATTRIBUTE, _ABSENT, _TEXT = 10, 11, 12, 0, 2
"""Tags of lists, and the type of characters, as the specification numbers them."""
_OFFSETS: Final = {1: "i4", 2: "i8"}


def read_netcdf(data: bytes, items: int) -> tuple[Attributes, dict[str, Variable]]:
    """Return global attributes, and by name of every variable its dimensions, values and attributes."""
    reader = ByteReader(data, ">")
    require(data[:3] == b"CDF" and data[3:4] in (b"\x01", b"\x02"), "it is neither netCDF 3 nor .npz")
    reader.take(3)
    offset = _OFFSETS[reader.integer("u1")]
    records = reader.integer("i4")
    dimensions = [(_name(reader), reader.integer("i4")) for _ in range(_count(reader, _DIMENSION, items))]
    attributes = _attributes(reader, items)
    variables: dict[str, Variable] = {}
    remaining = len(data)
    for _ in range(_count(reader, _VARIABLE, items)):
        name = _name(reader)
        numbers = [reader.integer("i4") for _ in range(_checked(reader.integer("i4"), items))]
        are_known = all(0 <= number < len(dimensions) for number in numbers)
        require(are_known, "a variable has an unknown dimension")
        about = _attributes(reader, items)
        kind = _type(reader)
        reader.integer("i4")  # the size, which dimensions and type say as well
        begin = reader.integer(offset)
        shape = [dimensions[number][1] for number in numbers]
        require(not (0 in shape and records), f"variable '{name[:40]}' has an unlimited dimension")
        body = ByteReader(data, ">")
        body.take(begin)
        values = body.numbers(kind, shape)
        remaining -= values.nbytes
        require(remaining >= 0, "variables overlap")
        variables[name] = tuple(dimensions[number][0] for number in numbers), values, about
    return attributes, variables


def _checked(count: int, items: int) -> int:
    if not 0 <= count <= items:
        raise OverflowError
    return count


def _count(reader: ByteReader, tag: int, items: int) -> int:
    tag_read, count = reader.integer("i4"), reader.integer("i4")
    require(tag_read == tag or (tag_read, count) == (_ABSENT, 0), f"a list of kind {tag_read}")
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
    entries: Attributes = {}
    for _ in range(_count(reader, _ATTRIBUTE, items)):
        name, kind = _name(reader), _type(reader)
        values = reader.numbers(kind, (reader.integer("i4"),))
        reader.align(4)
        is_text = kind == _TYPES[_TEXT]
        entries[name] = values.tobytes().decode("utf-8") if is_text else " ".join(map(str, values.tolist()))
    return entries


_HEADER, _VERSION, _VERSION_5, _VERSION_7_3 = 128, 124, 1, 2
_STORED: Final = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
_TEXT_KINDS: Final = {2: "utf-8", 16: "utf-8", 4: "utf-16", 17: "utf-16", 18: "utf-32"}
_MATRIX, _COMPRESSED = 14, 15  # data types of elements: an array, and a compressed element
_CELL, _STRUCT, _OBJECT, _CHAR, _NUMERIC, _OPAQUE = 1, 2, 3, 4, range(6, 16), 17
_COMPLEX_FLAG = 0x0800
_STORED_4: Final = ("f8", "f4", "i4", "i2", "u2", "u1")
_TEXT_4, _LAST_MOPT = 1, 4999  # version 4 begins with digits MOPT: machine, 0, kind of number, kind of matrix
_NAME_LIMIT = 63  # characters of a name in MATLAB
VARIABLES_LIMIT: Final = 10_000  # also of cells, and of lines of a text
TEXT_LIMIT = 1000  # characters of a line: of texts, numpy gives each the room of the longest
_OTHER: Final[npt.NDArray[Any]] = np.empty(0, object)  # stands for a sparse matrix and the like
DEEPEST = 8  # levels of structures in structures, and of cells


@dataclass(frozen=True, slots=True)
class ClassName:
    """What stands for an object of MATLAB, whose content only MATLAB can read."""

    name: str


class NewerFileError(ValueError):
    """The file is of version 7.3, which is HDF5."""


def read_variables(data: bytes, limit: int) -> Arrays:
    """Return the variables of a MATLAB file by name; compressed ones may grow to ``limit`` bytes together."""
    # Numbers and logical values have their shape without dimensions of size one, text is an array of lines,
    # cells of text an array of their texts, an object one :class:`ClassName`; a field of a structure is
    # called ``data.P.frf``, of the second of several ``data(2).P.frf``, a cell ``c{3}``. Others are empty
    # arrays.
    if 0 in data[:4]:  # in version 5 text stands there
        return _version_4(data)
    require(len(data) >= _HEADER, CUT)
    require(data[126:128] in (b"IM", b"MI"), "no byte-order mark")
    order = "<" if data[126:128] == b"IM" else ">"
    version = ByteReader(data[_VERSION:126], order).integer("u2") >> 8
    if version == _VERSION_7_3:
        raise NewerFileError
    require(version == _VERSION_5, f"unknown version {version}")
    reader = ByteReader(memoryview(data)[_HEADER:], order)
    variables: Arrays = {}
    for _ in range(VARIABLES_LIMIT + 1):
        if not reader.left:
            return variables
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
            name, values = _matrix(ByteReader(content, order), DEEPEST)
            variables |= {name + key: value for key, value in values.items()}
            if len(variables) > VARIABLES_LIMIT:
                raise OverflowError
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


def _matrix(reader: ByteReader, depth: int) -> tuple[str, Arrays]:
    """Return name and value of an array: flags, dimensions, name, then what its class asks for."""
    # The value of a structure or a cell array is several, by what is to be added to the name; others have "".
    flags = ByteReader(_element(reader)[1], reader.order).integer("u4")
    kind = flags & 0xFF
    if kind == _OPAQUE:
        name, _, of = (_short_text(reader) for _ in range(3))
        return name, {"": np.array([ClassName(of)], object)}
    shape = [int(size) for size in _numbers(*_element(reader), reader.order)]
    name = _short_text(reader)
    if kind == _CHAR:
        return name, {"": _lines(*_element(reader), reader.order, shape)}
    if kind == _OBJECT:
        return name, {"": np.array([ClassName(_short_text(reader))], object)}
    if kind == _CELL and depth:
        return name, _cells(_inner(reader, depth))
    if kind == _STRUCT and depth:
        return name, _fields(reader, depth)
    if kind not in _NUMERIC:
        return name, {"": _OTHER}
    values = _shaped(_numbers(*_element(reader), reader.order), shape)
    if flags & _COMPLEX_FLAG:
        values = _complex(values, _shaped(_numbers(*_element(reader), reader.order), shape))
    return name, {"": values}


def _short_text(reader: ByteReader) -> str:
    return bytes(_element(reader)[1]).decode("latin-1")[:_NAME_LIMIT]


def _inner(reader: ByteReader, depth: int) -> list[Arrays]:
    """Return the arrays that follow, which are those of a cell array or a structure."""
    values: list[Arrays] = []
    while reader.left:
        inner, content = _element(reader)
        if inner == _MATRIX:
            empty: Arrays = {"": _OTHER}
            values.append(_matrix(ByteReader(content, reader.order), depth - 1)[1] if content else empty)
            if len(values) > VARIABLES_LIMIT:
                raise OverflowError
    return values


def _cells(values: Sequence[Arrays]) -> Arrays:
    texts = [v[""] for v in values if "" in v and v[""].dtype.kind == "U" and v[""].size == 1]
    if values and len(texts) == len(values):
        return {"": np.array([str(text.item()) for text in texts])}
    return {f"{{{i + 1}}}{key}": v for i, value in enumerate(values) for key, v in value.items()}


def _fields(reader: ByteReader, depth: int) -> Arrays:
    """Return the fields of a structure, or of an array of them: the names' common length, names, values."""
    length = ByteReader(_element(reader)[1], reader.order).integer("i4")
    text = bytes(_element(reader)[1])
    require(0 < length <= _NAME_LIMIT + 1, "names of fields of an unknown length")
    names = [text[i : i + length].split(b"\0")[0].decode("latin-1") for i in range(0, len(text), length)]
    values = _inner(reader, depth)
    many = len(values) > len(names)
    return {
        (f"({i // len(names) + 1})" if many else "") + f".{names[i % len(names)]}{key}": v
        for i, value in enumerate(values if names else ())
        for key, v in value.items()
    }


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
    require(kind in _TEXT_KINDS, f"text of an unknown kind {kind}")
    ending = "" if kind in (2, 16) else "-le" if order == "<" else "-be"
    text = bytes(content).decode(_TEXT_KINDS[kind] + ending, "replace")
    rows = shape[0] if shape else 0
    if not text:
        return np.array("")
    if rows > VARIABLES_LIMIT:
        raise OverflowError
    require(rows >= 1 and len(text) % rows == 0, "text does not fill its lines")
    return np.squeeze(np.array([text[row : rows * TEXT_LIMIT : rows].rstrip(" \0") for row in range(rows)]))


def _version_4(data: bytes) -> Arrays:
    variables: Arrays = {}
    reader = ByteReader(data, "<" if int.from_bytes(data[:4], "little") <= _LAST_MOPT else ">")
    for _ in range(VARIABLES_LIMIT + 1):
        if not reader.left:
            return variables
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
            variables[name] = np.squeeze(np.array(lines))
        else:
            variables[name] = _OTHER if text else np.squeeze(values)
    raise OverflowError

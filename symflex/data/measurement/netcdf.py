"""Arrays in netCDF 3 files that anybody may have written: nothing is allocated that is not there.

The layout is that of Unidata, NetCDF Classic Format Specification (versions 1 and 2: 32 and 64-bit offsets).
"""

from __future__ import annotations

from typing import Any, Final

import numpy.typing as npt

from symflex.data.measurement.byte_reader import ByteReader, require

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

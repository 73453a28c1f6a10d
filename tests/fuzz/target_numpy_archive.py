"""Measured responses in numpy archives; checksums are made right, so that mutation reaches the arrays."""

import io
import struct
import zipfile

from symflex.data.measurement.arrays import read_arrays
from symflex.data.measurement.files import npz_bytes
from tests.fuzz.measured import RESPONSE, answered

ROOMS = ("symflex.data.measurement", "zipfile")
AS_IT_IS = b"PK"


def seeds():
    """Return an archive, and its members one after the other."""
    archive = npz_bytes(RESPONSE)
    return [archive, unpacked(archive)]


def unpacked(archive):
    """Return the members of an archive one after the other, each after its name and length."""
    with zipfile.ZipFile(io.BytesIO(archive)) as file:
        members = [(name.encode(), file.read(name)) for name in file.namelist()]
    return b"".join(bytes([len(name)]) + name + struct.pack("<H", len(data)) + data for name, data in members)


def packed(data):
    """Return the archive of members that stand one after the other."""
    buffer = io.BytesIO()
    names = set()
    with zipfile.ZipFile(buffer, "w") as file:
        while len(data) > 2:
            size = data[0]
            name, data = data[1 : 1 + size].decode("latin-1").replace("\0", ""), data[1 + size :]
            length = int.from_bytes(data[:2], "little")
            if name and name not in names:
                file.writestr(name, data[2 : 2 + length])
                names.add(name)
            data = data[2 + length :]
    return buffer.getvalue()


def run(data):
    """Read a file."""
    answered(read_arrays, data if data.startswith(AS_IT_IS) else packed(data), "a.npz")

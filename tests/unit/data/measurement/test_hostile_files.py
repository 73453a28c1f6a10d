"""Binary data files that were damaged, cut, or made to deceive."""

from __future__ import annotations

import io
import struct
import time
import tracemalloc
import zipfile

import numpy as np
import pytest
import scipy.io

from symflex.data.measurement.array_files import read_archive, read_netcdf, read_variables
from symflex.data.measurement.arrays import read_arrays
from symflex.data.measurement.comma_separated import read_columns
from symflex.data.measurement.universal_file import read_universal_file
from symflex.errors import DataError

ARRAYS = {"f": np.arange(1.0, 5), "H": np.array([1, 1j, -1, 2 + 1j]), "tf": "X/F"}


def mat(form="5", arrays=None, *, compress=False):
    buffer = io.BytesIO()
    scipy.io.savemat(buffer, arrays or ARRAYS, format=form, do_compression=compress)
    return buffer.getvalue()


def npz():
    buffer = io.BytesIO()
    np.savez(buffer, **ARRAYS)
    return buffer.getvalue()


def npy(description, shape, data=b""):
    header = f"{{'descr': '{description}', 'fortran_order': False, 'shape': {shape}, }}\n".encode()
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as file:
        file.writestr("a.npy", b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header + data)
    return buffer.getvalue()


def netcdf(size, count=1):
    """A file with variables of doubles along one dimension, all of which begin at the variables overlap."""
    dimensions = struct.pack(">iiiii", 10, 1, 1, int.from_bytes(b"x\0\0\0", "big"), size)
    begin = 4 + 4 + len(dimensions) + 8 + 8 + count * 36
    variables = [
        struct.pack(">i", 1) + bytes([97 + i, 0, 0, 0]) + struct.pack(">iiiiiii", 1, 0, 0, 0, 6, 8, begin)
        for i in range(count)
    ]
    head = b"CDF\x01" + struct.pack(">i", 0) + dimensions + struct.pack(">iiii", 0, 0, 11, count)
    return head + b"".join(variables)


def answered(name, data):
    """Whether a reader returns, or refuses with a typed error; anything else is raised."""
    try:
        read_arrays(name, data, "a")
    except DataError:
        pass
    return True


FILES = {
    "mat 5": ("a.mat", mat()),
    "mat 4": ("a.mat", mat("4")),
    "mat 5, compressed": ("a.mat", mat(compress=True)),
    "npz": ("a.npz", npz()),
}


@pytest.mark.slow
def test_a_flipped_bit_is_answered_or_refused():
    for name, data in FILES.values():
        for place in range(0, len(data), 2):
            for bit in range(place % 3, 8, 3):
                assert answered(name, data[:place] + bytes([data[place] ^ 1 << bit]) + data[place + 1 :])


def test_a_file_cut_anywhere_is_refused_or_answered():
    for name, data in FILES.values():
        for place in range(len(data)):
            assert answered(name, data[:place])


def test_numbers_of_every_kind_are_read_as_scipy_wrote_them():
    for form in ["4", "5"]:
        kinds = ["f8", "f4", "i4", "i2", "u2", "u1"] + ["i8", "u8", "u4", "i1"] * (form == "5")
        arrays = {f"a_{kind}": np.array([[1, 2, 3], [4, 5, 6]], kind) for kind in kinds}
        arrays["z"] = np.array([[1 + 2j, 3], [4j, -5]])
        found = read_variables(mat(form, arrays), 10_000)
        assert {name: value.tolist() for name, value in found.items()} == {
            name: value.tolist() for name, value in arrays.items()
        }, form


def test_cells_of_text_are_read_as_texts():
    cells = np.array(["X/F", "longer/F"], object)
    assert read_variables(mat(arrays={"tf": cells}), 1000)["tf"].tolist() == ["X/F", "longer/F"]


def test_fields_of_structures_are_called_by_their_path():
    inner = np.array([{"b": np.arange(2)}, {"b": np.arange(4)}], object)
    found = read_variables(mat(arrays={"s": {"a": np.arange(3), "t": {"u": 1.5}}, "c": inner}), 10_000)
    assert {k: v.tolist() for k, v in found.items()} == {
        "s.a": [0, 1, 2], "s.t.u": 1.5, "c{1}.b": [0, 1], "c{2}.b": [0, 1, 2, 3],
    }  # fmt: skip


def test_what_nobody_asks_for_is_left_unread():
    sparse = scipy.sparse.csc_matrix(np.eye(3))
    found = read_variables(mat(arrays={"s": sparse, "f": np.arange(3.0)}), 10_000)
    assert found["s"].size == 0
    assert found["f"].tolist() == [0, 1, 2]


def test_big_endian_files_are_read():
    name, values = b"f\0\0\0", struct.pack(">3d", 1, 2, 3)
    body = struct.pack(">IIIIIIIII", 6, 8, 6, 0, 5, 8, 1, 3, 1 << 16 | 1) + name
    body += struct.pack(">II", 9, len(values)) + values
    data = b"MATLAB 5.0".ljust(124) + b"\x01\x00MI" + struct.pack(">II", 14, len(body)) + body
    assert read_variables(data, 1000)["f"].tolist() == [1, 2, 3]


CLAIMS = {
    "npz of 4 GB": (read_archive, npy("<f8", "(536870912,)"), (10**6, 9)),
    "npz of text": (read_archive, npy("<U99999", "(99999,)"), (10**6, 9)),
    "npz of empty texts": (read_archive, npy("<U0", "(999999999,)"), (10**6, 9)),
    "netCDF of 4 GB": (read_netcdf, netcdf(536870912), (9,)),
}


def test_what_a_small_file_claims_is_not_allocated():
    for name, (read, data, limits) in CLAIMS.items():
        tracemalloc.start()
        with pytest.raises((ValueError, OverflowError)):
            read(data, *limits)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert peak < 1_000_000, name


def test_an_archive_that_grows_beyond_the_limit_is_refused():
    buffer = io.BytesIO()
    np.savez_compressed(buffer, f=np.zeros(100_000))
    with pytest.raises(OverflowError):
        read_archive(buffer.getvalue(), 100_000, 9)


def test_a_matlab_file_that_grows_beyond_the_limit_is_refused():
    data = mat(arrays={"f": np.zeros(100_000)}, compress=True)
    with pytest.raises(OverflowError):
        read_variables(data, 100_000)


def test_objects_in_an_archive_are_refused():
    buffer = io.BytesIO()
    np.savez(buffer, f=np.array([{}], object))
    with pytest.raises(ValueError, match="neither plain numbers nor text"):
        read_archive(buffer.getvalue(), 10_000, 9)


def test_an_encrypted_member_is_refused_by_name():
    data = npz().replace(b"PK\x01\x02\x14\x03\x14\x00\x00", b"PK\x01\x02\x14\x03\x14\x00\x01")
    data = data.replace(b"PK\x01\x02-\x03-\x00\x00", b"PK\x01\x02-\x03-\x00\x01")
    with pytest.raises(ValueError, match=r"'f\.npy' in it is encrypted"):
        read_archive(data, 10_000, 9)


def test_an_archive_of_very_many_members_is_refused():
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as file:
        for i in range(30):
            file.writestr(f"{i}.npy", b"")
    with pytest.raises(OverflowError):
        read_archive(buffer.getvalue(), 10_000, 9)


def test_text_that_is_no_characters_is_refused():
    with pytest.raises(ValueError, match="invalid character"):
        read_archive(npy("<U1", "(1,)", struct.pack("<I", 0x110000)), 10_000, 9)


def test_variables_of_netcdf_in_one_place_are_refused():
    assert list(read_netcdf(netcdf(4, 1) + bytes(32), 9)[1]) == ["a"]
    with pytest.raises(ValueError, match="variables overlap"):
        read_netcdf(netcdf(100, 8) + bytes(800), 9)


def test_a_text_of_very_many_cells_is_refused_early(monkeypatch):
    monkeypatch.setattr("symflex.data.measurement.text_table.MAX_CELLS", 5000)
    rows = "".join(f"{i},{','.join('12345')}\n" for i in range(1000))
    read_columns("wide.csv", ("f,a,b,c,d,e\n" + rows[: rows.index("800,")]).encode(), "wide", "f,re,im")
    with pytest.raises(DataError, match=r"wide.csv:835:1: error\[SF607\]: .* more than 5000 numbers"):
        read_columns("wide.csv", ("f,a,b,c,d,e\n" + rows).encode(), "wide", "f,re,im")


def test_very_many_marks_of_datasets_take_no_time_and_lines_are_counted_on():
    begun = time.process_time()
    with pytest.raises(DataError, match=r"a.uff:80001:1: this dataset has no end"):
        read_universal_file("a.uff", b"    -1\n" * 80001, "a")
    assert time.process_time() - begun < 2

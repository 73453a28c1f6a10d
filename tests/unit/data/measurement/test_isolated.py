"""Files of other programs that optional libraries read, and JSON."""

from __future__ import annotations

import io
import json
import sys
import zipfile

import h5py
import nptdms
import numpy as np
import openpyxl
import pytest

from symflex.data.measurement import read_measurement
from symflex.data.measurement.arrays import arrays_in
from symflex.data.measurement.isolated import read_isolated
from symflex.errors import DataError, UsageError
from tests.unit.data.measurement.instruments import DB, DEG, IM, RE, SIZE, F, H

PAIRS = [[h.real, h.imag] for h in H]
PARTS = {"re": RE.tolist(), "im": IM.tolist()}
NOTATIONS = {
    "pairs": {"frequency": F.tolist(), "H": PAIRS, "tf": "X/F"},
    "positive": {"f": F.tolist(), "H": [[3, 4]] * F.size},
    "text": {"frequency_hz": F.tolist(), "values": [f"{h.real}{h.imag:+}j" for h in H]},
    "a table": [{"f": f, "mag": a, "phase_deg": p} for f, a, p in zip(F, SIZE, DEG, strict=True)],
    "objects": {"f": F.tolist(), "H": [{"re": h.real, "im": h.imag} for h in H]},
    "runs": {"f": F.tolist(), "runs": [{"name": "a", "H": PARTS}, {"name": "b", "H": PARTS}]},
}


def test_json_of_arrays_is_read_in_every_notation(tmp_path):
    for case, content in NOTATIONS.items():
        (tmp_path / "a.json").write_text(json.dumps(content))
        found = read_measurement(tmp_path / "a.json")
        values = 3 + 4j if case == "positive" else H
        assert all(one.values == pytest.approx(values) for one in found), case
        assert len(found) == 1 + (case == "runs"), case


def test_hostile_json_is_refused():
    for text, said in (
        ("[" * 100_000, "nested too deeply"),
        ('{"a":' * 20 + "1" + "}" * 20, "nested too deeply"),
        ("[" + "[]," * 4_000_000 + "[]]", "more than"),
        (json.dumps([{str(i): 1} for i in range(3000)]), "more than"),
        ('{"f": [1, "' + "x" * 20_000_000 + '"]}', "long texts"),
        ("{", "not JSON"),
        ('{"f": [[1], [2, 3]]}', "not JSON"),
    ):
        with pytest.raises(DataError, match=said):
            arrays_in("a.json", text.encode(), ".json")


def workbook(rows):
    book = openpyxl.Workbook()
    book.active.append(["notes", 1])
    sheet = book.create_sheet("sweep")
    for row in [["Analyser 7"], [], ["Frequency (Hz)", "Magnitude (dB)", "Phase (deg)"], *rows]:
        sheet.append(row)
    book.save(content := io.BytesIO())
    return content.getvalue()


def test_the_fullest_sheet_of_a_workbook_is_a_table(tmp_path):
    (tmp_path / "a.xlsx").write_bytes(workbook(np.column_stack([F, DB, DEG]).tolist()))
    (found,) = read_measurement(tmp_path / "a.xlsx")
    assert found.values == pytest.approx(H)
    (tmp_path / "a.xlsx").write_bytes(workbook([[1, 2, 3], [2, "x", 3], [3, 4, 5]]))
    with pytest.raises(DataError, match=r"a.xlsx:5:3: error\[SF603\]: 'x' is not a number"):
        read_measurement(tmp_path / "a.xlsx")


def hdf5(fill, head=b""):
    content = io.BytesIO()
    with h5py.File(content, "w", userblock_size=512 if head else 0) as file:
        fill(file)
    return head + content.getvalue()[len(head) :]


def test_hdf5_and_newer_matlab_files_are_read(tmp_path):
    def run(file):
        file["run/frequency"], file["run/tf"] = F, "X/F"
        file["run"].create_dataset("H", data=H, chunks=(16,), compression="gzip")

    def variables(file):
        file["f"] = F[None]
        file["H"] = H.astype(complex).view([("real", "f8"), ("imag", "f8")])[:, None]
        file["tf"] = np.array([[ord(c)] for c in "X/F"], np.uint16)
        file["tf"].attrs["MATLAB_class"] = np.bytes_("char")
        file["#refs#/a"] = file["c"] = h5py.Empty("f8")

    (tmp_path / "a.h5").write_bytes(hdf5(run))
    head = b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM"
    (tmp_path / "a.mat").write_bytes(hdf5(variables, head))
    for name in ("a.h5", "a.mat"):
        (found,) = read_measurement(tmp_path / name)
        assert found.name == "X/F"
        assert found.values == pytest.approx(H)


def test_nothing_outside_an_hdf5_file_is_read(tmp_path):
    (tmp_path / "other.h5").write_bytes(hdf5(lambda file: file.create_dataset("H", data=H)))
    H.tofile(tmp_path / "raw")

    def fill(file):
        file["f"] = F
        file["there"] = h5py.ExternalLink(str(tmp_path / "other.h5"), "/H")
        file.create_dataset("H", (F.size,), "c16", external=[(str(tmp_path / "raw"), 0, H.nbytes)])
        layout = h5py.VirtualLayout((F.size,), "c16")
        layout[:] = h5py.VirtualSource(str(tmp_path / "other.h5"), "H", (F.size,))
        file.create_virtual_dataset("G", layout)
        file["loop/again"] = file["/"]

    assert {*read_isolated("h5py", hdf5(fill), 10_000)} == {"f"}


def test_channels_of_tdms_are_a_record_or_responses(tmp_path):
    noise = np.random.default_rng(1).standard_normal(4000)
    for name, about, channels in (
        ("record", {"wf_increment": 1e-3}, {"force": noise, "acc": np.cumsum(noise)}),
        ("sweep", {"wf_increment": 0.5, "wf_start_offset": 1.0, "wf_xname": "Frequency"}, PARTS),
    ):
        with nptdms.TdmsWriter(tmp_path / f"{name}.tdms") as file:
            file.write_segment(
                [nptdms.ChannelObject("g", k, np.array(v), properties=about) for k, v in channels.items()]
            )
    (found,) = read_measurement(tmp_path / "sweep.tdms")
    assert found.values == pytest.approx(H)
    (found,) = read_measurement(tmp_path / "record.tdms")
    assert found.name == "acc/force"


def test_a_library_that_is_not_installed_is_named_with_the_extra(tmp_path, monkeypatch):
    for name, library in (("a.xlsx", "openpyxl"), ("a.hdf5", "h5py"), ("a.tdms", "nptdms")):
        monkeypatch.setitem(sys.modules, library, None)
        (tmp_path / name).write_bytes(b"x")
        with pytest.raises(UsageError, match=library) as caught:
            read_measurement(tmp_path / name)
        (said,) = caught.value.diagnostics
        assert (said.code, said.hint) == ("SF914", "pip install 'symflex[files]'")


def test_whatever_a_library_does_is_one_error(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setitem(sys.modules, "nptdms", sys)  # in the process of its own, the module below
    for does, said in (
        ("import os; os.kill(os.getpid(), 11)", "'a' is not a .tdms file: nptdms fails on it"),
        ("raise KeyError('x')", "'a' is not a .tdms file: KeyError: 'x'"),
        ("[0] * 10**10", "contains more than 50000000 bytes"),
    ):
        (tmp_path / "nptdms.py").write_text(f"class TdmsFile:\n  def read(f):\n    {does}\n")
        with pytest.raises(DataError, match=said):
            arrays_in("a", b"x", ".tdms")


def test_workbooks_that_grow_are_refused():
    content = workbook([[1, 2, 3]])
    with pytest.raises(OverflowError):
        read_isolated("openpyxl", content, 20)
    rows = b"".join(b'<row r="%d"><c r="XFD%d"><v>1</v></c></row>' % (i, i) for i in range(9, 400))
    large = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(content)) as old, zipfile.ZipFile(large, "w") as new:
        for name in old.namelist():
            new.writestr(name, old.read(name).replace(b"</sheetData>", rows + b"</sheetData>"))
    with pytest.raises(OverflowError):
        read_isolated("openpyxl", large.getvalue(), 10**8)

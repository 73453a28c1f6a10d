"""SPICE's raw files: header, precision, order, points and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from symflex.data.measurement import read_measurement
from symflex.data.measurement.record import read_record
from symflex.data.measurement.spice_raw import table_of_raw
from symflex.errors import DataError

F = np.geomspace(1.0, 1000.0, 80)
S = 2j * np.pi * F
H = 628.0**2 / (S**2 + 62.8 * S + 628.0**2)
T = np.arange(200) * 1e-3
Y = 1 - np.cos(30 * T) * np.exp(-2 * T)


def raw(columns, names, flags, kinds, *, encoding="utf-16-le", is_fast=False):
    """Return a binary raw file; numpy writes the numbers."""
    listed = "".join(f"\t{i}\t{name}\t{kind}\n" for i, (name, kind) in enumerate(names))
    head = (
        f"Title: * filter\nDate: Mon\nPlotname: x\nFlags: {flags}\nNo. Variables: {len(names)}\n"
        f"No. Points: {len(columns[0]):12d}\nVariables:\n{listed}Binary:\n"
    )
    if is_fast:
        return head.encode(encoding) + b"".join(
            np.asarray(c, k).tobytes() for c, k in zip(columns, kinds, strict=True)
        )
    rows = np.empty(len(columns[0]), [(str(i), kind) for i, kind in enumerate(kinds)])
    for i, column in enumerate(columns):
        rows[str(i)] = column
    return head.encode(encoding) + rows.tobytes()


AC = [("frequency", "frequency"), ("V(in)", "voltage"), ("V(out)", "voltage")]
TRANSIENT = [("time", "time"), *AC[1:]]


@pytest.mark.parametrize(
    ("kinds", "options"),
    [
        (("<c16", "<c16", "<c16"), {}),
        (("<c16", "<c8", "<c8"), {}),
        (("<c16", "<c16", "<c16"), {"encoding": "ascii"}),
        (("<c16", "<c16", "<c16"), {"is_fast": True}),
    ],
)
def test_voltages_of_an_ac_analysis_are_over_that_of_the_source(tmp_path, kinds, options):
    flags = "complex forward" + " fastaccess" * options.get("is_fast", False)
    path = tmp_path / "filter.raw"
    path.write_bytes(raw([F, 0 * F + 2.0, 2 * H], AC, flags, kinds, **options))
    (found,) = read_measurement(path)
    assert found.values == pytest.approx(H, rel=1e-6)
    assert found.frequency_hz == pytest.approx(F)


@pytest.mark.parametrize(
    ("kinds", "flags", "is_fast"),
    [
        (("<f8", "<f4", "<f4"), "real forward", False),
        (("<f8", "<f8", "<f8"), "real forward double", False),
        (("<f8", "<f4", "<f4"), "real forward fastaccess", True),
    ],
)
def test_a_transient_is_a_record_whose_times_may_be_marked_by_their_signs(kinds, flags, is_fast):
    times = np.where(np.arange(T.size) % 7 == 3, -T, T)
    data = raw([times, (T > 0.01) * 1.0, Y], TRANSIENT, flags, kinds, is_fast=is_fast)
    record = read_record("a.raw", table_of_raw(data), "a")
    assert record.step_s == pytest.approx(1e-3)
    assert record.input[0] == "V(in)"
    assert record.outputs[0][0] == "V(out)"
    assert record.outputs[0][1] == pytest.approx(Y, abs=1e-6)
    assert record.unit("V(out)") == "1"


def test_what_is_cut_short_or_claims_more_is_refused(tmp_path):
    data = raw([T, 0 * T, Y], TRANSIENT, "real forward", ("<f8", "<f4", "<f4"))
    claimed = data.replace(
        "No. Points:          200".encode("utf-16-le"), "No. Points:    999999999".encode("utf-16-le")
    )
    for bad in (
        data[:-5],
        data[:100],
        claimed,
        data.replace("Binary".encode("utf-16-le"), "Binari".encode("utf-16-le")),
    ):
        path = tmp_path / "bad.raw"
        path.write_bytes(bad)
        with pytest.raises(DataError) as caught:
            read_measurement(path)
        assert caught.value.diagnostics[0].code == "SF601"


def test_values_in_text_are_read_with_blanks_inside_complex_numbers(tmp_path):
    head = "Title: x\nDate: Mon\nFlags: complex\nNo. Variables: 2\nNo. Points: 80\nVariables:\n"
    head += "\t0\tfrequency\tfrequency\n\t1\tV(out)\tvoltage\nValues:\n"
    rows = [
        f"{i}\t\t{f!r},  0.0\n\t{h.real!r},{h.imag!r}\n"
        for i, (f, h) in enumerate(zip(F.tolist(), H.tolist(), strict=True))
    ]
    (tmp_path / "a.raw").write_text(head + "".join(rows))
    (found,) = read_measurement(tmp_path / "a.raw")
    assert found.values == pytest.approx(H)


def test_a_sweep_of_a_voltage_is_no_record_and_no_response(tmp_path):
    names = [("V1", "voltage"), ("V(out)", "voltage")]
    (tmp_path / "a.raw").write_bytes(raw([T, Y], names, "real forward", ("<f8", "<f4")))
    with pytest.raises(DataError, match="neither a time nor a frequency"):
        read_measurement(tmp_path / "a.raw")

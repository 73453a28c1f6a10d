from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from scipy.io import savemat

from symflex.data.measurement.input_signal import read_signal
from symflex.errors import DataError

TIMES = tuple(Fraction(k, 100) for k in range(4))
VALUES = (0.0, 1.0, 1.5, 0.0)


def rows(separator, scale=1, decimal=".", form="{:g}"):
    pairs = zip(TIMES, VALUES, strict=True)
    lines = (separator.join(form.format(float(x)) for x in (t * scale, u)) for t, u in pairs)
    return "".join(line.replace(".", decimal) + "\n" for line in lines)


FILES = {
    "plain.csv": "time_s,u\n" + rows(","),
    "named.csv": "Time (s),CH1 (V)\n" + rows(","),
    "keysight.csv": "x-axis,1\nsecond,Volt\n" + rows(",", form="{:+.5E}"),
    "siglent.csv": "Record Length,Analog:4\nModel Number,S1\nSource,CH1\nSecond,Volt\n" + rows(","),
    "pico.csv": "Time,Channel A\n(ms),(V)\n\n" + rows(",", 1000),
    "rs.csv": "in s,C1 in V\n" + rows(",", form="{:.11E}"),
    "lvm.lvm": "LabVIEW Measurement\t\nDate\t2026/11/27\n***End_of_Header***\t\n\nX0\t0,0E+0\n"
    "***End_of_Header***\t\nX_Value\tVoltage\tComment\n" + rows("\t", decimal=",", form="{:.6f}"),
    "german.csv": "Zeit in ms;Kraft in N\n" + rows(";", 1000, ","),
    "tab.txt": rows("\t"),
    "micro.csv": "t (\u00b5s);u\n" + rows(";", 10**6),
    "unit_apart.dat": "# time [ms] force\n" + rows(" ", 1000),
    "unit_apart_too.dat": "# t ms u\n" + rows(" ", 1000),
    "savetxt.txt": rows(" ", form="{:.18e}"),
    "numbered.csv": "X,CH1,Start,Increment,\nSequence,Volt,0,1e-2,\n"
    + "".join(f"{i},{u},\n" for i, u in enumerate(VALUES)),
    "beside.csv": "".join(
        f"{told},{line},\n"
        for told, line in zip(("Length,4,", "Interval,1e-2,", ",,", ",,"), rows(",").split(), strict=True)
    ),
    "pandas.csv": ",t,u\n" + "".join(f"{i},{line}\n" for i, line in enumerate(rows(",").split())),
}


@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "latin-1"])
def test_inputs_are_read_as_instruments_save_them(tmp_path, name, encoding):
    (tmp_path / name).write_bytes(FILES[name].encode(encoding))
    signal = read_signal(tmp_path / name)
    assert signal.times == TIMES
    assert tuple(map(float, signal.values)) == VALUES


def test_inputs_are_read_from_arrays(tmp_path):
    t, u = np.arange(4) * 0.01, np.array(VALUES)
    np.save(tmp_path / "rows.npy", np.array([t, u]))
    np.savez(tmp_path / "ms.npz", t_ms=1000 * t, force=u)
    savemat(tmp_path / "nested.mat", {"out": {"tout": t[:, None], "force": u[:, None]}})
    for name in ("rows.npy", "ms.npz", "nested.mat"):
        signal = read_signal(tmp_path / name)
        assert (signal.times, tuple(map(float, signal.values))) == (TIMES, VALUES), name
    head = "# Created by Octave 8.4.0\n# name: A\n# type: matrix\n# rows: 4\n# columns: 2\n"
    (tmp_path / "octave.txt").write_text(head + rows(" "), encoding="utf-8")
    assert read_signal(tmp_path / "octave.txt").times == TIMES
    savemat(tmp_path / "two.mat", {"t": t, "u": u, "y": u})
    with pytest.raises(DataError, match="one other as long"):
        read_signal(tmp_path / "two.mat")


@pytest.mark.parametrize(
    "head", ["X,CH1,Start\nSequence,Volt,0\n", "time [cycles],u\n", "sample,u\n", "f (Hz),H\n"]
)
def test_what_is_not_seen_to_be_a_time_is_refused(tmp_path, head):
    (tmp_path / "u.csv").write_text(head + rows(","), encoding="utf-8")
    with pytest.raises(DataError, match="the first column is not the time"):
        read_signal(tmp_path / "u.csv")


def test_columns_that_are_not_used_are_named(tmp_path):
    (tmp_path / "u.csv").write_text("Time,Force,Temp\n0,1,2\n1,2,3\n", encoding="utf-8")
    assert read_signal(tmp_path / "u.csv").guesses == ("not used: 'Temp'",)
    (tmp_path / "u.csv").write_text("0,1,2\n1,2,3\n", encoding="utf-8")
    assert read_signal(tmp_path / "u.csv").guesses == ("not used: column 3",)


@pytest.mark.parametrize("heading", ["t,F [mN]", "t_s,F_mN", "t (s),F in mN", "time,F\ns,mN"])
def test_values_are_in_si_where_the_file_gives_their_unit(tmp_path, heading):
    (tmp_path / "input.csv").write_text(f"{heading}\n0,0\n1,1500\n")
    found = read_signal(tmp_path / "input.csv")
    assert (found.values, found.unit) == ((0, Fraction(3, 2)), "N")
    assert found.guesses == ("'F' is in mN, and is read in N: times 0.001",)

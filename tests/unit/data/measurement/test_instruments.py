"""Files as instruments and programs save them are read by the first command, and guesses are said."""

from __future__ import annotations

import io
import re

import numpy as np
import pytest

from symflex.data.measurement import read_measurement
from symflex.errors import DataError, SymflexError, UsageError
from tests.unit.data.measurement.instruments import DB, DEG, IM, RE, SIZE, TURN, F, H, all_files, rows

FILES = all_files()


@pytest.mark.parametrize("half", [0, 1])
def test_each_is_read_as_it_was_saved(tmp_path, half):
    wrong = {}
    for saved in FILES[half::2]:
        path = tmp_path / saved.name
        path.write_bytes(saved.content)
        try:
            found = read_measurement(path, saved.columns)
        except SymflexError as error:
            wrong[saved.name] = str(error)
            continue
        if len(found) != len(saved.values):
            wrong[saved.name] = f"{found} {found[0].guesses}"
            continue
        for one, values, frequency in zip(found, saved.values, saved.frequency, strict=False):
            if one.values.shape != values.shape:
                wrong[saved.name] = f"{one} {one.guesses}"
                continue
            error = np.max(abs(one.values - values) / abs(values))
            off = np.max(abs(one.frequency_hz - frequency) / frequency)
            if error > saved.tolerance or off > 1e-6:
                wrong[saved.name] = f"values off by {error:.2g}, frequencies by {off:.2g}: {one.guesses}"
    assert not wrong, "\n".join(f"{name}: {why}" for name, why in wrong.items())
    assert len(FILES) >= 60


GUESSES = {
    "relative_no.csv": "'Channel 2 Magnitude (dB)' over 'Channel 1 Magnitude (dB)'",
    "power_itself.csv": "'Power ratio (10log10 dB)' is the response itself, which fits the phase",
    "power.csv": "is the square of the magnitude, which fits the phase",
    "shift.dat": "the frequency is 'Frequency Shift (Hz)' plus 'Center Frequency (Hz)'",
    "potentiostat.par": "'E', 'I' beside the impedance: signals, not responses, and left out",
    "many.mat": "the values are h",
    "oros.csv": "decimals are written with a comma",
    "lag.csv": "'Phase lag (deg)' is the phase times -1",
    "chinese.csv": "is read as GB18030",
    "bare.zma": "no line names the columns: Hz, Ohm, degrees",
    "scope_bode.csv": "Latin-1",
    "vibration_utf16.txt": "the text is UTF-16",
    "cell.mpt": "'-Im(Z)/Ohm' is the imaginary part times -1",
    "plot.z": "the lines go down in frequency",
    "radians.csv": "'Phase' has no unit and is read in radians",
    "lags.dat": "the phase rises where the magnitude falls",
    "bench.dat": "a column is the phase times -1",
    "designer.csv": "'Gain (V/V)', 'Phase (Rad)'",
    "degrees.csv": "'Magnitude' has no unit and is read as a ratio",
    "scope_comma.csv": "'Gain' has no unit and is read in dB",
    "scope_log.csv": "decimal logarithm of the frequency",
    "printer_x.csv": "magnitude only: minimum phase is assumed",
    "pocket.s1p": "Z11 is the response, from S-parameters with the reference 0.05 Ohm",
    "through.s2p": "S21 is the response",
    "radians.mat": "read in rad/s, in which its ends are round numbers",
    "two_channels.csv": "the magnitude is 'vout' over 'vin'",
    "in_rows.csv": "each line is taken as a column",
    "in_and_out.txt": "the response is 'V(out)' over 'V(in)'",
    "lock_in_xy.csv": "columns 'x', 'y' not used",
    "cells_with_units.csv": "'Magnitude' has no unit and is read in dB",
    "per_cent.csv": "'Coherence (%)' is read in per cent",
    "whole.csv": "numbers such as 1,000 are read in thousands",
    "whole_de.csv": "'|H| [%]' is read in per cent",
    "volts.csv": "the magnitude is 'CH2 Amplitude (V)' over 'CH1 Amplitude (V)'",
    "spectra.csv": "the response is 'Accel' over 'Force'",
    "without_x.lvm": "the frequencies are those that the header gives",
    "empty_memory.csv": "columns '|Z|(ohm)-mem', 'θz(deg)-mem' not used",
    "both.mpt": "'(Y)/Ohm-1' is the reciprocal of 'Z' and is left out",
    "wrdata.data": "'v(out)' twice is read as real and imaginary part",
    "one_longer.csv": "line 2 has 5 cells: the first 3 are read",
    "two_unnamed.csv": "column without a name not used",
    "network.csv": "line 7 names the columns, and the numbers begin in line 8",
}


def test_what_is_guessed_is_said(tmp_path):
    by_name = {saved.name: saved for saved in FILES}
    for name, said in GUESSES.items():
        path = tmp_path / name
        path.write_bytes(by_name[name].content)
        guesses = read_measurement(path, by_name[name].columns)[0].guesses
        assert any(said in guess for guess in guesses), (name, guesses)


def npz(**arrays):
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)
    return buffer.getvalue()


WORD = re.compile(r"--columns ([^ ;)]+?),?(?: |$|\))")
ODD = F * 1.0123456789
AMBIGUOUS = {
    "parts.csv": (rows(F, RE, IM).encode(), "a.csv:1:1".replace("a", "parts"), H),
    "level.txt": (rows(F, DB, DEG, sep="\t").encode(), "level.txt:1:1", H),
    "words.csv": (("Setting,A [V],B [V]\n" + rows(F, RE, IM)).encode(), "words.csv:1:1", H),
    "positive.csv": (
        ("Hz,Magnitude,Phase\n" + rows(F, DB + 74, DEG)).encode(),
        "fit dB as well",
        10**3.7 * H,
    ),
    "matrix.npz": (npz(m=np.column_stack([F, RE, IM])), "real columns without names", H),
    "odd.npz": (npz(m=np.column_stack([ODD, H])), "in Hz or in rad/s", H),
    "axis.npz": (npz(x=ODD, y=H), "in Hz or in rad/s", H),
    "two.npz": (npz(f=F, a=H, b=2 * H), "has no array values; it has f (99), a (99), b (99)", H),
    "four.txt": (rows(F, DB, SIZE, DEG, sep="\t").encode(), "four.txt:1:1", H),
    "radians.txt": (rows(F, SIZE, TURN, sep=" ").encode(), "radians.txt:1:1", H),
    "fft.lvm": (("X_Value\tAcc (FFT)\n" + rows(F, DB, sep="\t")).encode(), "none of these names", None),
    "level_alone.csv": (("Freq(Hz),SPL(dB)\n" + rows(F, DB + 80)).encode(), "of phase is missing", 1e4 * H),
    "ohms.npz": (npz(m=np.column_stack([F, SIZE, DEG])), "real columns without names", H),
    "speaker.csv": (("freq_hz,spl_db,spl_30deg_db\n" + rows(F, DB, DB - 3)).encode(), "speaker.csv:1:1", H),
    "kilo.csv": (("FREQUENCY (kHz), DB[S12]\n" + rows(F / 1e3, DB)).encode(), "of phase is missing", H),
    "record.csv": (("freq\nt,a,b\n" + rows(F, RE, IM)).encode(), "record.csv:2:1", None),
    "log.csv": (("ln f,re,im\n" + rows(np.log(F), RE, IM)).encode(), "no column is the frequency", None),
    "phase.csv": (("Frequency (Hz),Phase (deg)\n" + rows(F, DEG)).encode(), "magnitude is missing", None),
    "offset.csv": (("Frequency Shift (Hz),re,im\n" + rows(F, RE, IM)).encode(), "a distance from", None),
}
"""Files that do not say enough, what is said of them, and their values where numbers alone tell them."""


def test_hints_followed_to_the_letter_are_right_or_say_what_is_better(tmp_path):
    for name, (content, said, values) in AMBIGUOUS.items():
        path = tmp_path / name
        path.write_bytes(content)
        with pytest.raises(DataError) as caught:
            read_measurement(path)
        assert said in str(caught.value), (name, str(caught.value))
        options = WORD.findall(caught.value.diagnostics[0].hint)
        assert options or values is None, name
        for i, option in enumerate(options):
            (found, *_) = read_measurement(path, option)
            truth = H if values is None else values
            is_size = found.is_magnitude
            got, truth = (abs(found.values), abs(truth)) if is_size else (found.values, truth)
            is_band = i or 0.98 < found.frequency_hz[-1] / F[-1] < 1.02  # ODD is 1 % beside F
            is_right = found.is_record or (is_band and np.allclose(got, truth, rtol=1e-3))
            assert is_right or (i and "look more like" in str(found.guesses)), (name, option, found.guesses)


def test_few_lines_with_a_coherence_above_one_are_left_out_and_said(tmp_path):
    share = [0.9] * F.size
    share[3] = share[50] = 1.2
    path = tmp_path / "a.csv"
    path.write_text("f,re,im,coh\n" + rows(F, RE, IM, share))
    (found,) = read_measurement(path)
    assert found.values.size == F.size - 2
    assert "left out a coherence above 1: lines 5, 52" in found.guesses


@pytest.mark.parametrize(("ratio", "level"), [(1.242, 2.9), (1.3, 3.0), (1.15, 1.9)])
def test_positive_decibels_near_one_are_never_read_as_a_ratio(tmp_path, ratio, level):
    # A lag turns the phase by asin((r - 1)/(r + 1)): 6.2 degrees for 1.242, as many as a turn has radians.
    x = np.geomspace(0.01, 100, 120)
    h = 10 ** (level / 20) * (1 + 1j * x / ratio**0.5 / ratio**0.5) / (1 + 1j * x)
    rows_of = zip(x, 20 * np.log10(abs(h)), np.degrees(np.angle(h)), strict=True)
    text = "".join(f"{f:.6g},{size:.6g},{turn:.6g}\n" for f, size, turn in rows_of)
    (tmp_path / "a.csv").write_text("Frequency,Magnitude,Phase\n" + text)
    try:
        (found,) = read_measurement(tmp_path / "a.csv")
    except DataError as error:
        assert error.diagnostics[0].code == "SF602"
        assert "fit" in str(error)
    else:
        assert found.values == pytest.approx(h, rel=1e-3)


def test_a_cross_spectrum_among_arrays_is_no_response(tmp_path):
    (tmp_path / "a.npz").write_bytes(npz(f=F, Pxy=H, Pxx=abs(H)))
    with pytest.raises(DataError, match=r"has no array values; it has f \(99\), Pxy \(99\)"):
        read_measurement(tmp_path / "a.npz")


def test_responses_are_called_what_stands_in_the_brackets_of_their_columns(tmp_path):
    (tmp_path / "named.csv").write_bytes({saved.name: saved for saved in FILES}["named.csv"].content)
    assert [one.name for one in read_measurement(tmp_path / "named.csv")] == ["A_1/F", "A_2/F"]


def test_columns_that_are_not_there_are_refused(tmp_path):
    by_name = {saved.name: saved for saved in FILES}
    for name, columns in (
        ("frame.csv", "f,re,im,coh,re"), ("frame.csv", "f,quux,im"), ("through.s2p", "s31"),
        ("pocket.s1p", "s21"),
        ("many.mat", "f=freq,h=G"), ("many.mat", "q=freq"), ("many.mat", "f,re,im"), ("pair.npy", "f,h,h"),
    ):  # fmt: skip
        path = tmp_path / name
        path.write_bytes(by_name[name].content)
        with pytest.raises(UsageError) as caught:
            read_measurement(path, columns)
        assert caught.value.diagnostics[0].code == "SF902", name


HOSTILE = {
    "a word": ("f;re;im\n1,5;2,5;3\n2,5;x;3\n3,5;2;1\n", "SF603", "a.csv:3:5"),
    "a gap": ("f,re,im\n1,2,3\n2,,3\n3,4,5\n", "SF603", "a.csv:3:1"),
    "magnitude alone": ("Freq(Hz),SPL(dB)\n1,2\n2,3\n3,4\n", "SF602", "a.csv:1:1"),
    "no unit anyone knows": ("f [furlong],re,im\n1,2,3\n2,3,4\n3,4,5\n", "SF602", "a.csv:1:1"),
    "a long line": ("f,re,im\n" + "1," * 20000 + "\n", "SF601", "a.csv:2:1"),
    "commas twice": ("f,re,im\n1,5,2,5,3,5\n2,5,2,5,3,5\n3,5,2,5,3,5\n", "SF602", "a.csv:2:1"),
    "a square": ("f [Hz],|H|^2,phase [deg]\n1,5,2\n2,5,2\n3,5,2\n", "SF602", "a.csv:1:8"),
    "a natural logarithm": ("f [Hz],ln|H|,phase [deg]\n1,5,2\n2,5,2\n3,5,2\n", "SF602", "a.csv:1:8"),
    "a logarithm": ("ln(f),Gain (dB),phase [deg]\n1,5,2\n2,5,2\n3,5,2\n", "SF602", "a.csv:1:1"),
    "a ratio of frequencies": ("f/f0,Gain (dB),phase [deg]\n1,5,2\n2,5,2\n3,5,2\n", "SF602", "a.csv:1:1"),
    "nepers": ("f [Hz],Gain (Np),phase [deg]\n1,5,2\n2,5,2\n3,5,2\n", "SF602", "a.csv:1:8"),
    "a counter": (",re,im\n0,1,2\n1,2,3\n2,1,2\n", "SF602", "a.csv:1:1"),
    "cross spectrum": ("f,Re(Sxy),Im(Sxy)\n1,2,3\n2,2,3\n3,4,5\n", "SF602", "a.csv:1:3"),
    "two axes": ("f,x,y\n1,2,3\n2,2,3\n3,4,5\n", "SF602", "a.csv:1:1"),
    "three axes": ("f,x,y,z\n1,2,-3,1\n2,2,3,1\n3,4,5,1\n", "SF602", "a.csv:1:3"),
    "a row without a meaning": (
        "f,1,2,3,4,5,6,7\n\nre,1,2,3,4,5,6,7\nx,0,0,0,0,0,1,0\n",
        "SF602",
        "a.csv:4:1",
    ),
    "a row that is too large": (
        "f,1,2,3,4,5,6,7\nre,1,2,3,4,5,6,7\nim,0,0,1e200,0,0,1,0\n",
        "SF603",
        "a.csv:2:8",
    ),
    "a matrix cut short": (
        "# Created by Octave 8.4.0\n# name: A\n# type: matrix\n# rows: 2\n# columns: 2\n 1 2\n 3\n",
        "SF601",
        "A is cut short",
    ),
    "prose": ("Dear reader,\nthis is a letter.\n", "SF605", "a.csv"),
}


def test_hostile_text_is_refused_with_its_place(tmp_path):
    for case, (text, code, place) in HOSTILE.items():
        (tmp_path / "a.csv").write_text(text)
        with pytest.raises(DataError) as caught:
            read_measurement(tmp_path / "a.csv")
        assert f"[{code}]" in str(caught.value), (case, str(caught.value))
        assert place in str(caught.value), (case, str(caught.value))


def test_hostile_touchstone_files_are_refused_with_their_place(tmp_path):
    for text, code, place in (
        ("# furlong S RI R 50\n1 2 3\n", "SF601", "a.s1p:1:1"),
        ("# Hz S RI R -50\n1 2 3\n", "SF601", "a.s1p:1:1"),
        ("# Hz S RI R 50\n1 2\n", "SF601", "a.s1p:2:1"),
        ("# Hz S RI R 50\n1 2 x\n", "SF603", "a.s1p:2:1"),
        ("# Hz S RI R 50\n1 1 0\n2 1 0\n3 1 0\n", "SF603", "Z"),
        ("# Hz S RI R 50\n", "SF605", "a.s1p"),
    ):
        (tmp_path / "a.s1p").write_text(text)
        with pytest.raises(DataError) as caught:
            read_measurement(tmp_path / "a.s1p")
        assert f"[{code}]" in str(caught.value), text
        assert place in str(caught.value), text


def element(kind, content):
    return (
        kind.to_bytes(4, "little")
        + len(content).to_bytes(4, "little")
        + content
        + b"\0" * (-len(content) % 8)
    )


def test_an_object_of_matlab_is_named_with_the_commands_that_unpack_it(tmp_path):
    flags = element(6, (17).to_bytes(8, "little"))
    body = flags + element(1, b"G") + element(1, b"MCOS") + element(1, b"idfrd")
    header = b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM"
    (tmp_path / "a.mat").write_bytes(header + element(14, body))
    with pytest.raises(DataError) as caught:
        read_measurement(tmp_path / "a.mat")
    assert "G is an object of the class idfrd" in str(caught.value)
    assert "[H, w] = frdata(G); save('FILE.mat', 'H', 'w', '-v7')" in str(caught.value)


def test_what_is_no_data_file_says_what_to_do(tmp_path):
    for name, said in (
        ("a.xls", "save the sheet as .xlsx or .csv"),
        ("a.xyz", "not a text table"),
    ):
        (tmp_path / name).write_text("nothing here\n")
        with pytest.raises(DataError) as caught:
            read_measurement(tmp_path / name)
        assert "[SF606]" in str(caught.value), name
        assert said in str(caught.value), name


def test_other_parameters_of_two_ports_are_those_of_circuit_theory(tmp_path):
    # A series impedance Z between the ports: S21 = 2 R/(2 R + Z), y21 = -1/Z (Pozar, Microwave Engineering).
    s21, s11 = 100 / (100 + H), H / (100 + H)
    text = "# Hz S RI R 50\n" + rows(
        F, s11.real, s11.imag, s21.real, s21.imag, s21.real, s21.imag, s11.real, s11.imag, sep=" "
    )
    (tmp_path / "a.s2p").write_text(text)
    assert read_measurement(tmp_path / "a.s2p", "y21")[0].values == pytest.approx(-1 / H, rel=1e-3)
    assert read_measurement(tmp_path / "a.s2p", "s21")[0].values == pytest.approx(s21)


def test_universal_files_name_node_direction_and_unit(tmp_path):
    pyuff = pytest.importorskip("pyuff")
    path = tmp_path / "a.uff"
    sets = [
        pyuff.prepare_58(
            binary=0, func_type=4, rsp_node=node, rsp_dir=direction, ref_node=3, ref_dir=1,
            data=np.r_[0, H * node], x=np.r_[0.0, F], id1="x", rsp_ent_name="NONE",
            ref_ent_name="NONE", abscissa_spacing=0, abscissa_spec_data_type=18,
            ordinate_spec_data_type=kind, orddenom_spec_data_type=13,
        )
        for node, direction, kind in ((1, 3, 12), (2, -2, 8), (2, -2, 8))
    ]  # fmt: skip
    pyuff.UFF(str(path)).write_sets(sets)
    found = read_measurement(path)
    assert [one.name for one in found] == ["A_1Z/F_3X", "X_2nY/F_3X", "X_2nY/F_3X 2"]
    assert [one.unit for one in found] == ["(m/s^2)/N", "(m)/N", "(m)/N"]
    assert found[1].values == pytest.approx(2 * H)
    assert "the line at 0 Hz is left out" in found[0].guesses
    power = pyuff.prepare_58(
        binary=0, func_type=9, rsp_node=1, rsp_dir=1, ref_node=0, ref_dir=0, data=SIZE**2, x=F, id1="x",
        rsp_ent_name="NONE", ref_ent_name="NONE", abscissa_spacing=0, abscissa_spec_data_type=18,
        ordinate_spec_data_type=0, orddenom_spec_data_type=0,
    )  # fmt: skip
    pyuff.UFF(str(path)).write_sets([power], mode="overwrite")
    (found,) = read_measurement(path)
    assert abs(found.values) == pytest.approx(SIZE)
    assert found.is_magnitude
    path.write_text("    -1\n    15\n         1         0         0         0  0. 0. 0.\n    -1\n")
    with pytest.raises(DataError, match=r"it contains datasets 15 \(nodes\)"):
        read_measurement(path)


def test_a_magnitude_of_two_channels_alone_is_their_ratio(tmp_path):
    (tmp_path / "a.csv").write_text("freq,vin,vout\n" + rows(F, 0 * F + 2, 2 * abs(H)), encoding="utf-8")
    (found,) = read_measurement(tmp_path / "a.csv")
    assert abs(found.values) == pytest.approx(abs(H), rel=1e-6)
    assert found.is_magnitude


def test_sweeps_with_the_same_frequencies_are_averaged_and_up_and_down_kept_apart(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("f,re,im\n" + rows(F, 1.004 * RE, IM) + rows(F, 0.996 * RE, IM))
    (found,) = read_measurement(path)
    assert found.values == pytest.approx(H)
    assert "2 sweeps: those with the same frequencies are averaged" in found.guesses
    path.write_text("f,re,im\n" + rows(F, RE, IM) + rows(F[::-1], 3 * RE[::-1], 3 * IM[::-1]))
    found = read_measurement(path)
    assert [one.name for one in found] == ["up", "down"]
    assert found[1].values == pytest.approx(3 * H)
    path.write_text(
        "f,re,im\n" + rows(F, RE, IM) + rows(F, RE, [*map(str, IM[:50]), "x", *map(str, IM[51:])])
    )
    (found,) = read_measurement(path)  # the line without a number is left out of the mean
    assert found.values.size == F.size - 1


def test_sweeps_that_differ_by_more_than_noise_are_kept_apart(tmp_path):
    random, path = np.random.default_rng(2), tmp_path / "a.csv"
    path.write_text("f,mag_db,phase_deg\n" + "".join(rows(F, DB + 0.5 * i, DEG) for i in range(8)))
    found = read_measurement(path)
    assert len(found) == 8
    assert found[7].values == pytest.approx(H * 10 ** (3.5 / 20), rel=1e-6)
    noisy = [H * (1 + 0.03 * random.normal(size=F.size)) for _ in range(8)]
    path.write_text("f,re,im\n" + "".join(rows(F, h.real, h.imag) for h in noisy))
    assert len(read_measurement(path)) == 1
    path.write_text("level_V,f,mag_db,phase_deg\n" + "".join(rows(0 * F + i, F, DB, DEG) for i in range(8)))
    assert len(read_measurement(path)) == 8


@pytest.mark.parametrize(
    "head", ["f[HZ],|V1| [V],|V2|[V],w", "f/Hz,V_1/V,V_2/V,omega/(rad/s)", "f,U1,U2,w", "f,Ue [V],Ua [V],w"]
)
def test_amplitudes_at_both_ends_are_a_ratio_and_f_beside_w_is_in_hz(tmp_path, head):
    path = tmp_path / "a.csv"
    path.write_text(head + "\n" + rows(F, 0 * F + 2, 2 * SIZE, 2 * np.pi * F))
    (found,) = read_measurement(path)
    assert abs(found.values) == pytest.approx(SIZE, rel=1e-6)
    assert found.frequency_hz == pytest.approx(F)
    assert any("the magnitude is" in guess for guess in found.guesses)
    assert not any("has no unit" in guess for guess in found.guesses)


def test_amplitudes_in_two_units_are_a_ratio_of_one(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("f (Hz),Vin (V),Vout (mV)\n" + rows(F, 0 * F + 2, 2e3 * SIZE))
    (found,) = read_measurement(path)
    assert abs(found.values) == pytest.approx(SIZE, rel=1e-6)
    assert found.unit == "1"


def test_values_in_the_unit_of_a_file_are_read_in_si(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("# unit: mm/N\nfrequency_hz,re,im\n" + rows(F, RE, IM))
    (found,) = read_measurement(path)
    assert found.unit == "m/N"
    assert found.values == pytest.approx(H / 1e3)


def test_units_in_headings_scale_decibels_over_one_and_columns_that_are_asked(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("f (Hz),gain (dB re 1 mm/N),phase (deg)\n" + rows(F, DB, DEG))
    (found,) = read_measurement(path)
    assert found.unit == "m/N" and found.values == pytest.approx(H / 1e3, rel=1e-6)
    path.write_text("speed [rpm],amp [um/N],phase [deg]\n" + rows(60 * F, SIZE, DEG))
    (found,) = read_measurement(path, "f,mag,phase_deg")
    assert found.frequency_hz == pytest.approx(F)
    assert found.unit == "m/N" and found.values == pytest.approx(H / 1e6, rel=1e-6)
    for head, scale, unit, factor in (
        ("f (Hz),|Z| [kOhm],phase [deg]", 1, "Ohm", 1e3),
        ("f (Hz),mag_um_per_V,phase_deg", 1, "m/V", 1e-6),
        ("f (Hz),mag (mm/s^2)/N,phase [cycles]", 1 / 360, "m/(N*s^2)", 1e-3),
    ):
        path.write_text(head + "\n" + rows(F, SIZE, DEG * scale))
        (found,) = read_measurement(path)
        assert found.unit == unit and found.values == pytest.approx(factor * H, rel=1e-4)
    path.write_text("f (Hz),attenuation (dB),phase (deg)\n" + rows(F, -DB, DEG))
    (found,) = read_measurement(path)
    assert found.values == pytest.approx(H, rel=1e-6) and "times -1" in " ".join(found.guesses)
    path.write_text("f (Hz),Real (g/N),Imaginary (g/N)\n" + rows(F, RE, IM))
    (found,) = read_measurement(path)  # of an acceleration, or of a mass
    assert "the unit 'g/N' of 'Real (g/N)' is not taken: values are as written" in found.guesses


def test_sweeps_between_which_another_column_changed_are_not_averaged(tmp_path):
    (tmp_path / "a.csv").write_text(
        "R,f,S11dB,S11deg\n"
        + rows([*map(str, 0 * F)], F, DB, DEG)
        + rows([*map(str, 0 * F + 9)], F, DB - 6, DEG)
    )
    found = read_measurement(tmp_path / "a.csv")
    assert [one.name for one in found] == ["S11 sweep 1", "S11 sweep 2"]
    assert found[0].values == pytest.approx(H, rel=1e-6)


def test_matrices_of_values_beside_frequencies_or_of_their_parts_are_responses(tmp_path):
    beside = {k: np.column_stack([F, a]) for k, a in (("H1_2", H), ("G1_2", 2 * H), ("H1_3", 3 * H))}
    (tmp_path / "a.npz").write_bytes(npz(**beside))
    assert [one.values[0] / H[0] for one in read_measurement(tmp_path / "a.npz")] == pytest.approx([1, 3])
    (tmp_path / "a.npz").write_bytes(npz(H21=np.column_stack([RE, IM]), f_start=1.0, df=0.5, f_end=50))
    (found,) = read_measurement(tmp_path / "a.npz")
    assert found.values == pytest.approx(H)
    assert found.frequency_hz == pytest.approx(F)


def test_numbers_without_frequencies_ask_for_them(tmp_path):
    for name, content in (
        ("one.txt", "".join(f"{h.real:.12g}{h.imag:+.12g}j\n" for h in H).encode()),
        ("two.csv", ("re;im\n" + rows(RE, IM, sep=";", decimal=",")).encode()),
        ("sizes.csv", ("Magnitude,Phase (deg)\n" + rows(SIZE, DEG)).encode()),
        ("h.npz", npz(H=H)),
        ("any.npz", npz(x=H)),
    ):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(DataError) as caught:
            read_measurement(tmp_path / name)
        assert "--from HZ --step HZ" in caught.value.diagnostics[0].hint, (name, str(caught.value))
        (found,) = read_measurement(tmp_path / name, axis=(1.0, 0.5))
        assert found.values == pytest.approx(H, rel=1e-6), name
        assert found.frequency_hz == pytest.approx(F), name

"""Data files of every format, good and bad."""

from __future__ import annotations

import io
import os
from importlib.util import find_spec

import numpy as np
import pytest
import scipy.io

from symflex.data.measurement import READERS, MeasuredResponse, measurement_bytes, read_measurement
from symflex.errors import DataError, SymflexError, UsageError
from tests.unit.analysis.systems import words

FREQUENCY = np.arange(1.0, 11.0)
VALUES = np.exp(0.3j * FREQUENCY) * FREQUENCY
COHERENCE = np.linspace(0.5, 0.95, 10)
PLAIN = "frequency_hz,re,im\n1,2,3\n2,3,4\n3,4,5\n"


@pytest.fixture
def write(tmp_path):
    def put(name, content):
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return put


def table(header, *columns, separator=","):
    rows = [separator.join(repr(float(c[i])) for c in columns) for i in range(10)]
    return "\n".join([header, *rows]) + "\n"


PHASE = np.angle(VALUES)
RE, IM, DECIBEL = VALUES.real, VALUES.imag, 20 * np.log10(abs(VALUES))
LAYOUTS = [
    table("frequency_hz,re,im,coherence", FREQUENCY, RE, IM, COHERENCE),
    table("Frequency [Hz];Real;Imag;Coherence", FREQUENCY, RE, IM, COHERENCE, separator=";"),
    table("coh f dB phase_deg", COHERENCE, FREQUENCY, DECIBEL, np.degrees(PHASE), separator=" "),
    table("freq(kHz)\tmag(dB)\tphase(rad)\tcoh", FREQUENCY / 1000, DECIBEL, PHASE, COHERENCE, separator="\t"),
    "% said\n\n"
    + table("omega,magnitude,phase_rad,gamma2", 2 * np.pi * FREQUENCY, abs(VALUES), PHASE, COHERENCE),
    "\ufeff" + table("frequency_hz, re, im, coherence", FREQUENCY, RE, IM, COHERENCE).replace("\n", "\r\n"),
]


def test_columns_are_recognised_by_their_names(write):
    for text in LAYOUTS:
        (found,) = read_measurement(write("a.csv", text))
        assert found.name == "a", text
        assert found.frequency_hz == pytest.approx(FREQUENCY), text
        assert found.values == pytest.approx(VALUES), text
        assert found.coherence == pytest.approx(COHERENCE), text


def test_comment_lines_hold_what_columns_cannot(write):
    text = "# tf: A_tip/V_cmd\n# averages: 12\n# window: Hanning\n# unit: m/s^2\n# synthetic: yes\n" + PLAIN
    (found,) = read_measurement(write("a.csv", text))
    assert (found.name, found.averages, found.window) == ("A_tip/V_cmd", 12, "hann")
    assert (found.unit, found.is_synthetic) == ("m/s^2", True)


def test_a_line_at_zero_hertz_is_left_out(write):
    (found,) = read_measurement(write("a.csv", PLAIN.replace("1,2,3", "0,2,3\n1,2,3")))
    assert found.frequency_hz.tolist() == [1, 2, 3]


LEFT_OUT = {
    "no number": ("7,nan,4", "left out lines without a number, or with zero: line 8"),
    "overload": ("7,OVLD,OVLD", "left out lines without a number, or with zero: line 8"),
    "zero": ("7,0,0", "left out lines without a number, or with zero: line 8"),
    "empty": ("7,,", "line 8 ('7,,') is not a row of numbers and is skipped"),
    "below zero": ("-7,2,3", "left out negative frequencies: line 8"),
    "twice": ("6,6,-6", "left out what repeats the line before it: line 8"),
    "not in order": ("30,30,-30", "the lines are not in order of frequency, and are sorted"),
}


def test_lines_that_cannot_be_used_are_left_out_and_said(write):
    numbers = [i for i in range(1, 21) if i != 7]
    for case, (line, said) in LEFT_OUT.items():
        lines = [f"{i},{i},{-i}" for i in numbers]
        (found,) = read_measurement(write("a.csv", "\n".join(["f,re,im", *lines[:6], line, *lines[6:], ""])))
        expected = numbers + [30] * (case == "not in order")
        assert found.frequency_hz.tolist() == expected, case
        assert found.values.tolist() == [f - 1j * f for f in expected], case
        assert said in found.guesses, (case, found.guesses)


def test_lines_are_left_out_at_the_ends_without_limit_and_a_tenth_between(write):
    def text(bad):
        return "f,re,im\n" + "".join(f"{i},{'nan' if i in bad else i},1\n" for i in range(1, 41))

    (found,) = read_measurement(write("a.csv", text({*range(1, 11), *range(30, 41)})))
    assert found.frequency_hz.tolist() == list(range(11, 30))
    with pytest.raises(DataError, match="so in 7 more lines"):
        read_measurement(write("a.csv", text(set(range(2, 18, 2)))))


def test_columns_that_are_not_named_are_not_listed(write):
    with pytest.raises(UsageError, match=r"5 words, and there are 4 columns: f, re, im\n"):
        read_measurement(write("a.csv", ",f,re,im\n0,1,2,3\n1,2,3,4\n2,3,4,5\n"), "-,f,re,im,coh")


MISTAKES = {
    "unknown column": ("frequency_hz,re,img\n1,2,3\n", "SF602", "a.csv:1:17"),
    "no header": ("1,2,3\n2,3,4\n", "SF602", "a.csv:1:1"),
    "a margin for a phase": ("f,db,phase margin (deg)\n1,2,3\n2,3,4\n3,4,5\n", "SF602", "a.csv:1:6"),
    "no phase": ("f,db\n1,2\n", "SF602", "a.csv:1:1"),
    "phase without unit": ("f,db,phase\n1,2,3\n", "SF602", "a.csv:1:6"),
    "unknown unit": ("frequency [knots],re,im\n1,2,3\n", "SF602", "a.csv:1:1"),
    "two of a kind": ("f,freq,re,im\n1,2,2,3\n2,5,2,3\n3,4,1,1\n", "SF602", "a.csv:1:3"),
    "no frequency": ("re,im\n1,2\n", "SF602", "a.csv:1:1"),
    "short line": (PLAIN.replace("2,3,4", "2,3"), "SF603", "a.csv:3:1"),
    "word": (PLAIN.replace("2,3,4", "2,three,4"), "SF603", "a.csv:3:3"),
    "decimal comma and point": ("f;re;im\n1;2,5;3\n2;2.5;3\n3;2,5;1\n", "SF603", "a.csv:3:3"),
    "nan": (PLAIN.replace("2,3,4", "2,nan,4"), "SF603", "a.csv:3:3"),
    "infinite frequency": (PLAIN.replace("3,4,5", "inf,4,5"), "SF603", "a.csv:4:1"),
    "too fast": (PLAIN.replace("3,4,5", "1e300,4,5"), "SF603", "a.csv:4:1"),
    "too slow": (PLAIN.replace("1,2,3", "1e-300,2,3"), "SF603", "a.csv:2:1"),
    "negative frequency": (PLAIN.replace("1,2,3", "-1,2,3"), "SF603", "a.csv:2:1"),
    "zero value": (PLAIN.replace("2,3,4", "2,0,0"), "SF603", "a.csv:3:3"),
    "negative magnitude": ("f,mag (m/N),phase_deg\n1,-2,3\n2,3,4\n3,4,5\n", "SF603", "a.csv:2:3"),
    "overflow": ("f,db,phase_deg\n1,9e9,3\n2,3,4\n3,4,5\n", "SF603", "a.csv:2:3"),
    "coherence": ("f,re,im,coh\n1,2,3,1.5\n2,3,4,1\n3,4,5,1\n", "SF603", "a.csv:2:7"),
    "averages": ("# averages: many\n" + PLAIN, "SF603", "a.csv:1:13"),
    "unit of the values": ("# unit: furlong/N\n" + PLAIN, "SF602", "a.csv:1:9"),
    "too large to square": (PLAIN.replace("2,3,4", "2,1e300,4"), "SF603", "a.csv:3:3"),
    "too small to square": (PLAIN.replace("2,3,4", "2,1e-300,0"), "SF603", "a.csv:3:3"),
    "twice": (PLAIN.replace("3,4,5", "2,4,5"), "SF604", "a.csv:4:1"),
    "empty": ("", "SF605", "a.csv"),
    "comments only": ("# nothing\n", "SF605", "a.csv"),
    "header only": ("f,re,im\n", "SF605", "a.csv"),
    "one line": ("f,re,im\n1,2,3\n", "SF605", "a.csv"),
    "binary": (b"f,re,im\n\xff\xfe\x00\x01", "SF601", "a.csv"),
    "NUL": (b"f,re,im\n1,\x00,3", "SF601", "a.csv"),
    "control": (b"f,re,im\n1,\x02,3", "SF601", "a.csv"),
    "no Windows-1252": (b"f,re,im\n1,\x81,3\n2,3,4\n", "SF603", "a.csv:2:3"),
}


def test_a_mistake_is_named_with_its_place(write):
    for case, (content, code, place) in MISTAKES.items():
        found = words(read_measurement, write("a.csv", content))
        assert found.startswith("DataError") and f"[{code}]" in found and place in found, case


def test_all_mistakes_are_told_at_once_up_to_twenty(write):
    text = "f,re,im\n" + "".join(f"{i},x,1\n" for i in range(50))
    with pytest.raises(DataError) as caught:
        read_measurement(write("a.csv", text))
    assert len(caught.value.diagnostics) == 20


def npz(**arrays):
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)
    return buffer.getvalue()


def mat(**arrays):
    buffer = io.BytesIO()
    scipy.io.savemat(buffer, arrays, do_compression=True)
    return buffer.getvalue()


def test_arrays_are_recognised_by_their_names(write):
    for suffix, pack in [("npz", npz), ("mat", mat)]:
        content = pack(
            f=FREQUENCY, H=np.array([VALUES, 2 * VALUES]), coh=np.array([COHERENCE] * 2), averages=7.0
        )
        first, second = read_measurement(write(f"a.{suffix}", content))
        assert (first.name, second.name) == ("a 1", "a 2"), (suffix, pack)
        assert second.values == pytest.approx(2 * VALUES), (suffix, pack)
        assert first.coherence == pytest.approx(COHERENCE), (suffix, pack)
        assert first.averages == 7, (suffix, pack)


def test_wrong_arrays_are_refused(write):
    for suffix, pack in [("npz", npz), ("mat", mat)]:
        for arrays, code in (
            ({"f": FREQUENCY}, "SF602"),
            ({"f": FREQUENCY, "H": VALUES[:7]}, "SF602"),
            ({"f": np.minimum(FREQUENCY, FREQUENCY[-2]), "H": VALUES}, "SF604"),
            ({"f": FREQUENCY, "H": VALUES * np.nan}, "SF603"),
            ({"f": np.array(["a", "b"]), "H": VALUES}, "SF602"),
        ):
            with pytest.raises(DataError) as caught:
                read_measurement(write(f"a.{suffix}", pack(**arrays)))
            assert caught.value.diagnostics[0].code == code, (suffix, pack)


def test_nothing_is_unpickled(write):
    class Trap:
        def __reduce__(self):
            return os.mkdir, ("sprung",)

    path = write("a.npz", npz(f=np.array([Trap()], dtype=object), H=VALUES))
    with pytest.raises(DataError):
        read_measurement(path)
    assert not (path.parent / "sprung").exists()


@pytest.mark.slow
def test_an_archive_that_grows_beyond_the_limit_is_refused(write):
    buffer = io.BytesIO()
    np.savez_compressed(buffer, f=np.zeros(8_000_000), H=VALUES)
    with pytest.raises(DataError) as caught:
        read_measurement(write("a.npz", buffer.getvalue()))
    assert caught.value.diagnostics[0].code == "SF607"


def test_damaged_files_of_every_format_are_refused_without_a_traceback(write):
    files = {".npz": npz(f=FREQUENCY, H=VALUES), ".mat": mat(f=FREQUENCY, H=VALUES), ".csv": PLAIN.encode()}
    if find_spec("pyuff") is not None:
        files[".uff"] = measurement_bytes(MeasuredResponse("a/b", FREQUENCY, VALUES), "a.uff")
    assert files.keys() <= READERS.keys()
    random = np.random.default_rng(1)
    for suffix, good in files.items():
        for _ in range(80):
            content = bytearray(good)
            for place in random.integers(0, len(content), 6):
                content[place] = random.integers(0, 256)
            try:
                read_measurement(write(f"a{suffix}", bytes(content[: random.integers(1, len(content))])))
            except SymflexError as error:
                assert error.diagnostics, suffix
        assert words(read_measurement, write(f"a{suffix}", random.bytes(4000))).startswith("DataError"), (
            suffix
        )


@pytest.mark.needs_module("pyuff")
def test_universal_files_give_back_what_was_written(write):
    response = MeasuredResponse("A/V", FREQUENCY, VALUES, COHERENCE, 9.0, "hann", is_synthetic=True)
    (found,) = read_measurement(write("a.uff", measurement_bytes(response, "a.uff")))
    assert (found.name, found.averages, found.window, found.is_synthetic) == ("A/V", 9.0, "hann", True)
    assert found.values == pytest.approx(VALUES)
    assert found.coherence == pytest.approx(COHERENCE)


@pytest.mark.needs_module("pyuff")
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # pyuff leaves its file open
def test_universal_files_of_kind_58b_are_read(write, tmp_path):
    import pyuff

    path = tmp_path / "b.uff"
    entry = pyuff.prepare_58(
        binary=1, func_type=4, rsp_node=1, rsp_dir=1, ref_node=2, ref_dir=1, data=VALUES, x=FREQUENCY,
        id1="A/V", rsp_ent_name="NONE", ref_ent_name="NONE", abscissa_spacing=0, abscissa_spec_data_type=18,
        ordinate_spec_data_type=0, orddenom_spec_data_type=0,
    )  # fmt: skip
    pyuff.UFF(str(path)).write_sets([entry])
    (found,) = read_measurement(path)
    assert found.values == pytest.approx(VALUES)


@pytest.mark.needs_module("pyuff")
def test_universal_files_without_a_response_are_refused(write):
    for text, code in (
        ("nothing\n", "SF601"),
        ("    -1\n    58\nhalf\n", "SF601"),
        ("    -1\n   151\na\n    -1\n", "SF601"),
    ):
        with pytest.raises(DataError) as caught:
            read_measurement(write("a.uff", text))
        assert caught.value.diagnostics[0].code == code


def test_files_that_are_none(write, tmp_path):
    with pytest.raises(UsageError):
        read_measurement(tmp_path / "none.csv")
    with pytest.raises(UsageError):
        (tmp_path / "folder.csv").mkdir()
        read_measurement(tmp_path / "folder.csv")
    with pytest.raises(DataError) as caught:
        read_measurement(write("a.xls", PLAIN))
    assert caught.value.diagnostics[0].code == "SF606"

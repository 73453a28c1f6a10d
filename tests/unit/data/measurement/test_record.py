"""Time records: which column is what, and frequency responses estimated from them."""

from __future__ import annotations

import io
import re
from datetime import datetime, timedelta

import numpy as np
import pytest
import scipy.io
from scipy import signal

import symflex
from symflex.cli import run
from symflex.data.measurement import (
    Estimate,
    measurement_bytes,
    prepared,
    read_measurement,
    read_records,
)
from symflex.data.measurement.record import read_record
from symflex.errors import DataError, UsageError

STEP = 0.002
MODES = ((12.0, 0.03, 1.0), (31.0, 0.02, 0.5))
"""Natural frequency [Hz], damping ratio and static compliance of a system of two modes."""


def true(frequency):
    s = 2j * np.pi * np.asarray(frequency)
    w = [(2 * np.pi * f, z, a) for f, z, a in MODES]
    return sum(a * o**2 / (s**2 + 2 * z * o * s + o**2) for o, z, a in w)


def simulated(u, oversampled=4):
    """Return every fourth sample of the output, by exact exponentials between finer ones."""
    t = np.arange(u.size) * STEP / oversampled
    parts = []
    for f, z, a in MODES:
        w = 2 * np.pi * f
        system = signal.TransferFunction([a * w**2], [1, 2 * z * w, w**2])
        parts.append(signal.lsim(system, u, t, interp=np.unique(u).size > 2)[1])
    return u[::oversampled], sum(parts)[::oversampled]


def inputs(kind, n=4096, over=4):
    t = np.arange(n * over) * STEP / over
    noise = np.random.default_rng(5)
    if kind == "step":
        return (np.arange(n * over) >= 100 * over).astype(float)
    if kind == "impact":
        return np.where((t > 0.02) & (t < 0.032), np.sin(np.pi * (t - 0.02) / 0.012) ** 2, 0.0)
    if kind == "chirp":
        return signal.chirp(t, 2, t[-1] * 0.8, 80) * (t < 0.75 * t[-1])
    if kind == "periodic":
        spectrum = np.zeros(n * over // 16 + 1, complex)
        k = np.arange(1, 80)
        spectrum[k] = np.exp(2j * np.pi * noise.random(k.size))
        return np.tile(np.fft.irfft(spectrum), 8) * 1000
    return signal.lfilter(*signal.butter(6, 0.3 / over), noise.normal(size=n * over))


def written(folder, u, y, head="time,u,y", name="record.csv", times=None, sep=","):
    t = np.arange(len(y)) * STEP if times is None else times
    columns = [t, y] if u is None else [t, u, y]
    rows = (sep.join(f"{x:.9g}" for x in row) for row in zip(*columns, strict=True))
    (folder / name).write_text(head + "\n" + "\n".join(rows) + "\n", encoding="utf-8")
    return folder / name


KINDS = {
    "step": ("a step", 0.002),
    "impact": ("an impact", 0.002),
    "chirp": ("begins and ends at rest", 0.01),
    "periodic": ("a periodic input: the mean over", 0.002),
}


@pytest.mark.parametrize("kind", KINDS)
def test_a_response_is_the_true_one_where_the_record_is_without_noise(tmp_path, kind):
    said, error = KINDS[kind]
    (response,) = read_measurement(written(tmp_path, *simulated(inputs(kind))))
    assert response.name == "y/u"
    assert any(said in guess for guess in response.guesses)
    low = response.between(4.0, 40.0)
    assert low.values.size > 30
    away = np.abs(low.frequency_hz - 12.0) > 1.5
    assert np.max(np.abs(low.values / true(low.omega_seen / (2 * np.pi)) - 1)[away]) < 5 * error
    if kind == "step":  # it ends where only noise is left
        u, y = (np.append(x, np.full(60_000, x[-1])) for x in simulated(inputs(kind)))
        (again,) = read_measurement(
            written(tmp_path, u, y + np.random.default_rng(1).normal(0, 1e-4, y.size))
        )
        assert 0.5 < again.values.size / response.values.size < 2


def test_noise_is_averaged_by_welch_with_a_coherence_that_explains_the_error(tmp_path):
    u, y = simulated(inputs("noise", 16384))
    y = y + 0.05 * np.std(y) * np.random.default_rng(1).normal(size=y.size)
    path = written(tmp_path, u, y)
    (whole,) = read_measurement(path, estimate=Estimate(segments=16))
    response = whole.between(3, 9)  # no peak is smeared there
    assert "31 segments" in response.guesses[-1] and response.window == "hann"
    error = (
        np.abs(response.values / true(response.frequency_hz) - 1) / response.relative_deviation() / np.sqrt(2)
    )
    assert 0.5 < np.sqrt(np.mean(error**2)) < 1.5


def test_an_impact_that_does_not_die_away_is_seen_through_an_exponential_window(tmp_path):
    u, y = simulated(inputs("impact", 512, 16), 16)
    path = written(tmp_path, u, y)
    (plain,) = read_measurement(path, estimate=Estimate(window="none"))
    assert "of it is left at the end, which changes gains" in plain.guesses[0] and not plain.window
    for window in ("hann", "exponential", "exponential:0.3"):
        (response,) = read_measurement(path, estimate=Estimate(window=window))
        assert "a fit subtracts its decay rate" in response.guesses[0] and response.decay_rate > 3, window
        low = response.between(4.0, 40.0)
        error = np.abs(low.values / true(low.omega_seen / (2 * np.pi)) - 1)
        assert np.max(error) < (0.03 if window == "exponential:0.3" else 0.01), window
    with pytest.raises(UsageError, match="neither hann nor none nor exponential:SECONDS"):
        Estimate(window="exponential:0")


def test_the_damping_of_an_exponential_window_is_taken_out_of_a_fit(tmp_path):
    f = np.arange(2.0, 60.0, 0.25)
    h = true(f - 1j / (2 * np.pi * 0.4))
    rows = "\n".join(f"{a:.9g},{b.real:.9g},{b.imag:.9g}" for a, b in zip(f, h, strict=True))
    path, made = tmp_path / "frf.csv", tmp_path / "again.uff"
    for head, window in (("# window: exponential 0.4 s\n", None), ("", "exponential:0.4")):
        path.write_text(f"{head}frequency_hz,re,im\n{rows}\n", encoding="utf-8")
        fit = symflex.fit(path, window=window)
        assert np.allclose(fit.frequencies_hz, [12.0, 31.0], rtol=1e-6)
        assert np.allclose(fit.found.resonances.zeta_p, [0.03, 0.02], rtol=1e-5)
        assert "2.5 1/s that it adds are subtracted" in str(fit)
    (response,) = prepared(read_measurement(path), window="exponential:0.4")
    made.write_bytes(measurement_bytes(response, made))
    assert read_measurement(made)[0].window == "exponential:0.4"
    with pytest.raises(UsageError, match="is not a time record"):
        prepared(read_measurement(path), window="exponential")


@pytest.mark.slow
@pytest.mark.parametrize("kind", [*KINDS, "noise", "decay", "output alone"])
def test_poles_are_within_their_standard_errors(tmp_path, kind):
    is_alone = kind in ("decay", "output alone")
    if kind == "output alone":  # driven by noise
        u, y = simulated(inputs("noise", 100_000))
    else:
        u, y = simulated(inputs("impact" if is_alone else kind, 3072))
    y = y + 0.01 * np.std(y) * np.random.default_rng(2).normal(size=y.size)
    fit = symflex.fit(
        written(tmp_path, None if is_alone else u, y, "t,y" if is_alone else "t,u,y"),
        band=(3, 60),
    )
    errors = fit.standard_errors
    for f, z, _ in MODES:
        i = int(np.argmin(np.abs(fit.resonances.omega_p - 2 * np.pi * f)))
        assert (
            abs(fit.resonances.omega_p[i] / (2 * np.pi) - f) < 4 * errors.omega_p[i] / (2 * np.pi) + 1e-4 * f
        )
        assert abs(fit.resonances.zeta_p[i] - z) < 4 * errors.zeta_p[i] + 0.005 * z
        assert errors.zeta_p[i] < 0.2 * z


@pytest.mark.parametrize(
    ("head", "source", "outputs"),
    [
        ("time,u,y", "u", ["y"]),
        ("t;Kraft [N];Beschl. [m/s^2]", "Kraft", ["Beschl."]),
        ("TIME\tCH1\tCH2", "CH1", ["CH2"]),
        ("Zeit [ms];Weg;Force", "Force", ["Weg"]),
        ("#time,accel_x,accel_y", None, ["accel_x", "accel_y"]),
        ("Time (s),Hammer (N),Accel (g)", "Hammer", ["Accel"]),
        ("Time Stamp, Velocidad (rad/s), PWM", "PWM", ["Velocidad"]),
        ("Time,ADC,DAC", "DAC", ["ADC"]),
        ("Time (s),Torque (N·m),ESC signal (µs)", "ESC signal", ["Torque"]),
        ("x-axis,1,2\nsecond,Volt,Volt", "1", ["2"]),
        ("time,Voltage (out),Voltage (in)", "Voltage (in)", ["Voltage (out)"]),
        ("t_now,velocity_fed,velocity_cmd", "velocity_cmd", ["velocity_fed"]),
        ("Time,twist.angular.x,twist.angular.z", None, ["twist.angular.x", "twist.angular.z"]),
    ],
)
def test_headers_say_which_column_is_what(head, source, outputs):
    sep = ";" if ";" in head else "\t" if "\t" in head else ","
    rng = np.random.default_rng(1)
    rows = [sep.join(f"{x:.6g}" for x in (i * 1.0, *rng.normal(size=2))) for i in range(64)]
    record = read_record("a.csv", f"{head}\n{chr(10).join(rows)}\n".encode(), "a")
    assert (record.input and record.input[0]) == source
    assert [name for name, _ in record.outputs] == outputs
    assert record.step_s == pytest.approx(1e-3 if "ms" in head else 1.0)


def test_times_stand_anywhere_and_counters_and_magnitudes_are_left_out():
    random = np.random.default_rng(1)
    x, times = random.normal(size=(3, 64)), np.arange(64) * 0.01 + random.uniform(0, 0.001, 64)
    every = np.vstack([x, times, np.linalg.norm(x, axis=0), np.arange(64)])
    for head, columns, outputs in (
        ("volt,tempo_corrigido", (0, 3), ["volt"]),
        ("sample,time,sensor_value", (5, 3, 0), ["sensor_value"]),
        ("t,a_x,a_y,a_z,a", (3, 0, 1, 2, 4), ["a_x", "a_y", "a_z"]),
    ):
        rows = "\n".join(",".join(f"{v:.9g}" for v in row) for row in every[list(columns)].T)
        record = read_record("a.csv", f"{head}\n{rows}\n".encode(), "a")
        assert record.input is None and [name for name, _ in record.outputs] == outputs, head


def test_a_time_is_not_suggested_for_a_frequency_and_may_have_another_unit(tmp_path):
    y = np.random.default_rng(1).normal(size=(64, 2))
    np.savez(tmp_path / "a.npz", t=np.arange(64) * 0.01, acc=y)
    assert [one.name for one in read_measurement(tmp_path / "a.npz")] == ["acc 1", "acc 2"]
    (found,) = read_measurement(tmp_path / "a.npz", "t=t,u=acc 1,y=acc 2")
    assert found.name == "acc 2/acc 1"
    path = written(tmp_path, *y.T, head="22380416,1,2", times=22380416 + 2044 * np.arange(1, 65))
    assert any("t_us" in guess for guess in read_measurement(path, "t,u,y")[0].guesses)


CHIRP = signal.chirp(np.arange(2000) * STEP, 1, 4.0, 60)
PUSHED = signal.lfilter([1e-4], [1, -1.9, 0.96], CHIRP)


@pytest.mark.parametrize(
    ("head", "unit", "factors"),
    [
        ("t [s],F [N],x [mm]", "m/N", (1, 1e3)),
        ("t;F;x\ns;kN;um", "m/N", (1e-3, 1e6)),
        ("t_s,F_N,x_mm", "m/N", (1, 1e3)),
        ("t/s,F/N,x/mm", "m/N", (1, 1e3)),
        ("# units: s, N, mm\nt,F,x", "m/N", (1, 1e3)),
        ("# unit: mm/N\nt,F,x", "m/N", (1, 1e3)),
        ("# unit of x: mm\n# unit of F: N\nt,F,x", "m/N", (1, 1e3)),
        ("time in s,force in N,position in mm", "m/N", (1, 1e3)),
        ("Time,Channel A,Channel B\n(s),(V),(mV)\n", "1", (1, 1e3)),
        ("X,CH1,CH2\nSecond,Volt,Volt", "1", (1, 1)),
        ("time_s,u [V],omega [rpm]", "rad/(V*s)", (1, 30 / np.pi)),
        ("time_s,u,omega", "", (1, 1)),
        ("t,hammer [N],acc [g]", "m/(N*s^2)", (1, 1 / 9.80665)),
        ("t,u [counts],y [V]", "", (1, 1)),
    ],
)
def test_units_of_columns_scale_their_values(tmp_path, head, unit, factors):
    u, y = (x * factor for x, factor in zip((CHIRP, PUSHED), factors, strict=True))
    (found,) = read_measurement(written(tmp_path, u, y, head=head, sep=";" if ";" in head else ","))
    (plain,) = read_measurement(written(tmp_path, CHIRP, PUSHED))
    assert found.unit == unit
    assert found.values == pytest.approx(plain.values, rel=1e-5)
    is_said = any(word in guess for guess in found.guesses for word in ("times", "'counts'"))
    assert is_said or set(factors) == {1}
    assert (b"# unit: " in measurement_bytes(found, "a.csv")) == bool(unit)


def test_files_of_labview_have_units_above_the_names_and_perhaps_no_times():
    random = np.random.default_rng(1).normal(size=(64, 2))
    head = "LabVIEW Measurement\nSeparator\tTab\nX_Columns\t{}\n***End_of_Header***\n"
    head += "Y_Unit_Label\tNewton\tmm\nX0\t0.0\t0.0\nDelta_X\t0.001\t0.001\n***End_of_Header***\n"
    for is_timed in (True, False):
        rows = "".join(f"{0.001 * i if is_timed else ''}\t{a}\t{b}\n" for i, (a, b) in enumerate(random))
        text = head.format("One" if is_timed else "No") + "X_Value\tForce\tTravel\tComment\n" + rows
        record = read_record("a.lvm", text.encode(), "a")
        assert record.step_s == pytest.approx(0.001) and record.unit("Travel") == "m/N"
        assert record.input[1] == pytest.approx(random[:, 0])
        assert record.outputs[0][1] == pytest.approx(random[:, 1] / 1e3)


def test_samples_that_are_no_numbers_are_lost_ones():
    rows = [f"{i},{a},{b}" for i, (a, b) in enumerate(np.random.default_rng(1).normal(size=(64, 2)))]
    rows[20] = "20,1,NaN"
    record = read_record("a.csv", "\n".join(["t_ms,u,y", *rows]).encode(), "a")
    assert np.flatnonzero(record.is_missing).tolist() == [20]
    assert record.outputs[0][1].size == 64


def test_a_frequency_in_prose_or_among_outputs_makes_no_response_of_a_record(tmp_path):
    head = "# swept in frequency, up to 60 Hz\ntime,u,omega"
    (found,) = read_measurement(written(tmp_path, CHIRP, PUSHED, head=head))
    assert found.name == "omega/u"


def test_a_constant_input_is_a_step_also_where_columns_are_named(tmp_path):
    y = 1 - np.cos(6 * np.arange(400) * STEP) * np.exp(-3 * np.arange(400) * STEP)
    path = written(tmp_path, np.full(400, 5.0), y, head="time_s,u,y")
    (plain,), (asked,) = read_measurement(path), read_measurement(path, "t,u,y")
    assert asked.values == pytest.approx(plain.values)


def oscilloscope(t, y, *, is_quoted=False):
    """Return a file of an oscilloscope that writes what it knows beside the samples."""
    about = ["Record Length,2.0e+03,", "Sample Interval,2.0e-03,", *[",,"] * 4, "Source,CH2,"]
    about += ["Vertical Units,mV,", "Horizontal Units,s,", "Model Number,TDS1012B,"]
    about = [
        f'"{a.partition(",")[0]}",{a.partition(",")[2]}' if is_quoted and a[0] != "," else a for a in about
    ]
    cells = [*about, *[",,"] * (len(y) - len(about))]
    return "".join(f"{a},{b:.9f},{c:.6g},\r\n" for a, b, c in zip(cells, t, y, strict=True))


@pytest.mark.parametrize("is_quoted", [False, True])
def test_samples_behind_what_is_known_of_them_are_read_with_name_and_unit(tmp_path, is_quoted):
    t = np.arange(2000) * STEP
    ringing = 1e3 * np.exp(-3 * t) * np.sin(60 * t)
    path = tmp_path / "tek.csv"
    path.write_text(oscilloscope(t - 0.1, ringing, is_quoted=is_quoted), newline="")
    record = read_record(str(path), path.read_bytes(), "tek")
    assert record.step_s == pytest.approx(STEP)
    assert dict(record.units) == {"CH2": "V"}
    assert record.outputs[0][1] == pytest.approx(ringing / 1e3, abs=1e-5)
    again = read_record(str(path), path.read_bytes(), "tek", "-,-,-,t,y")
    assert again.outputs[0][1] == pytest.approx(record.outputs[0][1])


def test_a_matrix_that_begins_at_rest_and_is_no_response_is_a_record(tmp_path):
    t = np.arange(2000) * STEP
    u = CHIRP * (t > 0)
    y = signal.lfilter([0, 1e-4], [1, -1.9, 0.96], u)
    np.savez(tmp_path / "a.npz", data=np.column_stack([t, u, y]))
    (found,) = read_measurement(tmp_path / "a.npz")
    assert found.name == "y/u"
    assert any("is taken as the time" in guess for guess in found.guesses)
    s = 2j * np.pi * np.arange(0, 50, 0.25)
    response = 1 / (s**2 + 2 * s + 3600)
    np.savez(tmp_path / "a.npz", data=np.column_stack([abs(s) / 6.2832, response.real, response.imag]))
    with pytest.raises(DataError, match="--columns f,re,im"):
        read_measurement(tmp_path / "a.npz")


def test_signals_of_a_structure_with_start_and_increment_are_in_the_unit_of_their_axis(tmp_path):
    t = np.arange(1000) * STEP
    for label, step, expected in (("s", STEP, STEP), ("ms", 1e3 * STEP, STEP)):
        x = {"start_value": 0.0, "increment": step, "quantity": {"label": label}}
        values = {"values": np.exp(-3 * t) * np.sin(60 * t), "quantity": {"label": "g"}}
        held = {"x_values": x, "y_values": values, "function_record": {"name": "Point1"}}
        io_file = io.BytesIO()
        scipy.io.savemat(io_file, {"Signal": held})
        record = read_record("a.mat", io_file.getvalue(), "a")
        assert record.step_s == pytest.approx(expected)
        assert record.outputs[0][0] == "Point1"
        assert record.units == {"Point1": "m/s^2"}


def test_a_rate_above_the_columns_is_the_sampling_time():
    rows = "\n".join(f"{np.sin(i):.5f},{np.cos(i):.5f}" for i in range(64))
    for line, step in (("Sampling rate: 2 kHz", 5e-4), ("Sample interval = 0.5 ms", 5e-4), ("dt,0.01", 0.01)):
        record = read_record("a.csv", f"Record Length,64\n{line}\nforce,y\n{rows}\n".encode(), "a")
        assert record.step_s == pytest.approx(step), line
        assert record.input[0] == "force"


def test_columns_asked_overrule_names(tmp_path):
    u, y = simulated(inputs("step"))
    path = written(tmp_path, y, u, "time,a,b")
    (response,) = read_measurement(path, "t,y,u")
    assert response.name == "a/b"
    with pytest.raises(UsageError, match="one t, at most one u"):
        read_measurement(path, "t,u,u")


def test_jitter_gaps_and_saturation_are_said(tmp_path):
    u, y = simulated(inputs("chirp", 1024))
    times = np.arange(1024) * STEP
    shaken = times + np.random.default_rng(1).uniform(-0.2, 0.2, 1024) * STEP
    kept = np.delete(np.arange(1024), np.arange(500, 520))
    clipped = np.clip(y, -0.5 * y.max(), 0.5 * y.max())
    cases = {
        "not even": (u, y, shaken),
        "samples are missing from 0.998 to 1.04 s": (u[kept], y[kept], times[kept]),
        "is it saturated?": (u, clipped, times),
    }
    for said, (a, b, t) in cases.items():
        (response,) = read_measurement(written(tmp_path, a, b, times=t))
        assert any(said in guess for guess in response.guesses), said
        assert len(response.guesses) == 2, said


def test_records_of_one_length_are_averaged_as_sure_as_they_are(tmp_path):
    u, y = simulated(inputs("impact"))
    rng = np.random.default_rng(4)
    noise = 0.02 * np.std(y)
    read = []
    for i in range(4):
        path = written(tmp_path, u, y + noise * rng.normal(size=y.size), name=f"{i}.csv")
        read += read_measurement(path)
    (mean,) = prepared(read, (5.0, 50.0))
    assert "4 records are averaged" in mean.guesses
    ratio = prepared(read[:1], (5.0, 50.0))[0].relative_deviation() / mean.relative_deviation()
    assert np.median(ratio) == pytest.approx(2.0, rel=0.2)


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("time,u,y\n0,0,1\n1,0,2\n2,1,3\n", "SF605"),
        ("time,u,y\n" + "\n".join(f"{i % 40 + i // 40 * 9},0,{i}" for i in range(80)), "SF604"),
        ("time,u,y\n" + "\n".join(f"{i},0,{i if i % 3 else 'x'}" for i in range(80)), "SF603"),
        ("time,u,y\n" + "\n".join(f"{i},0,5" for i in range(80)), "SF602"),
    ],
)
def test_what_is_no_record_is_refused_with_its_reason(tmp_path, text, code):
    path = tmp_path / "bad.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(DataError) as caught:
        read_measurement(path)
    assert caught.value.diagnostics[0].code == code


def test_the_command_line_writes_the_response_of_a_record(tmp_path, capsys):
    u, y = simulated(inputs("chirp", 2048))
    path, made = written(tmp_path, u, y, "time,F,X"), tmp_path / "frf.csv"
    assert run(["measure", str(path), "-o", str(made)]) == 0
    assert "begins and ends at rest" in capsys.readouterr().err
    (response,) = read_measurement(made)
    low = response.between(3, 40)
    away = np.abs(low.frequency_hz - 12) > 2
    assert response.name == "X/F"
    assert np.max(np.abs(low.values / true(low.frequency_hz) - 1)[away]) < 0.1
    assert run(["measure", str(path), "--tf", "Q/F", "-o", str(made)]) == 2
    assert "choose a response with --tf: X/F" in capsys.readouterr().err


def test_a_table_with_frequencies_beside_a_time_is_no_record():
    text = "Time,Frequency (Hz),Magnitude (dB),Phase (deg)\n" + "\n".join(
        f"{i},{i + 1},3,4" for i in range(60)
    )
    assert read_record("a.csv", text.encode(), "a") is None


def archive(**arrays):
    content = io.BytesIO()
    np.savez(content, **arrays)
    return content.getvalue()


def columns(*series, begin="", sep=","):
    lines = (sep.join(f"{x:.9g}" for x in row) for row in zip(*series, strict=True))
    return (begin + "\n".join(lines)).encode()


def test_hints_followed_to_the_letter_read_the_record(tmp_path):
    u, y = (x[:512] for x in simulated(inputs("chirp", 512)))
    held = np.round(4 * u) / 4
    t, zero = STEP * np.arange(1, 513), np.zeros(512)
    shaken = t + STEP / 100 * np.sin(np.arange(512))
    cases = {  # content, what stands for the words that only a person knows, the input that is meant
        "from_one_step.csv": (columns(t, held, y), {}, held),
        "behind_a_constant.txt": (columns(shaken, zero, held, y, sep=" "), {}, held),
        "alone.csv": (columns(t, y), {}, None),
        "counted.txt": (columns(np.maximum(np.arange(-1, 511), 0), u, y, sep="\t"), {"SECONDS": "2e-3"}, u),
        "named.csv": (columns(u, y, begin="u,y\n"), {"SECONDS": "0.002"}, u),
        "one_column.csv": (columns(y), {"SECONDS": "0.002"}, None),
        "matrix.npz": (archive(m=np.column_stack([t - STEP, held, y])), {}, held),
        "beside_others.npz": (archive(N=3, a=y[:90], data=np.array([t - STEP, zero, u, y])), {}, u),
        "by_name.npz": (archive(v=u, w=y), {"u=NAME": "u=v", "y=NAME": "y=w", "SECONDS": ".002"}, u),
    }
    for name, (content, known, source) in cases.items():
        path = tmp_path / name
        path.write_bytes(content)
        with pytest.raises(DataError) as caught:
            read_measurement(path)
        hint = caught.value.diagnostics[0].hint
        (option,) = re.findall(r"--columns ((?:-,)*(?:t,|u,|u=|y,)[^\s;]*\w)", hint)
        for word, meant in known.items():
            assert word in option, (name, option)
            option = option.replace(word, meant)
        record = read_record(name, content, "a", option)
        assert record.step_s == pytest.approx(STEP, rel=1e-3), name
        assert record.input is source is None or np.allclose(record.input[1], source, atol=1e-3), name
        assert len(record.outputs) == 1 and np.allclose(record.outputs[0][1], y, atol=1e-3), name
    with pytest.raises(UsageError, match="'dt=SECONDS' is not a sampling time"):
        read_record("a.csv", cases["named.csv"][0], "a", "u,y,dt=SECONDS")


def test_times_of_day_dates_and_times_since_1970_are_read():
    noise = np.random.default_rng(1).normal(size=(64, 2))
    since = [datetime(2024, 1, 5, 23, 59, 59, 700_000) + timedelta(seconds=i / 100) for i in range(64)]
    milliseconds = [1_704_499_199_700 + 10 * i for i in range(64)]
    cases = {
        "timestamp,u,y": [f"{d:%Y-%m-%dT%H:%M:%S.%f}Z" for d in since],
        "": [f"{d:%Y-%m-%d %H:%M:%S.%f}" for d in since],
        "Date,Time,u,y": [f"{d:%m/%d/%Y,%H:%M:%S.%f}" for d in since],
        "Datum/Zeit;Eingang;y": [f"{d:%d.%m.%Y %H:%M:%S,%f}" for d in since],
        "time,trigger,u,y": [f"{x},{int(x > 1_704_499_200_000)}" for x in milliseconds],
        "millis,u,y": [f"{x}" for x in range(0, 640, 10)],
        "Time,u,y\nms,N,mm": [f"{x}" for x in range(0, 640, 10)],
        "time_min,u,y": [f"{i / 6000:.9f}" for i in range(64)],
        "t [h],u,y": [f"{i / 360_000:.12f}" for i in range(64)],
        "time,u,y": [f"{45296.4 + i / 8_640_000:.11f}" for i in range(64)],
    }
    for head, times in cases.items():
        sep = ";" if ";" in head else ","
        cells = [[f"{x:.9f}".replace(".", "," if sep == ";" else ".") for x in row] for row in noise.tolist()]
        rows = (sep.join([t, *row]) for t, row in zip(times, cells, strict=True))
        record = read_record("a.csv", "\n".join([head, *rows]).encode(), "a")
        assert record is not None, head
        assert record.step_s == pytest.approx(0.01, rel=2e-3), head
        assert np.allclose(record.input[1][:9], noise[:9, 0], atol=0.2 if head == "time,u,y" else 1e-8), head
        assert len(record.outputs) == 1, head
    whole = "\n".join(f"{d:%H:%M:%S},{a},{b}" for d, (a, b) in zip(since, noise.tolist(), strict=True))
    with pytest.raises(DataError) as caught:
        read_record("a.csv", f"time,u,y\n{whole}".encode(), "a")
    assert "--columns -,u,y,dt=SECONDS" in caught.value.diagnostics[0].hint
    assert read_record("a.csv", f"time,u,y\n{whole}".encode(), "a", "-,u,y,dt=0.01").step_s == 0.01


def test_odd_columns_of_loggers_are_read():
    noise = np.random.default_rng(1).normal(size=(64, 2))
    bracketed = "\n".join(f"{i},{1e-5 * i:.9g},({x!r}+0j)" for i, (x, _) in enumerate(noise.tolist()))
    record = read_record("a.csv", f",Time,Amplitude\n{bracketed}\n".encode(), "a")
    assert np.array_equal(record.outputs[0][1], noise[:, 0]) and record.step_s == pytest.approx(1e-5)
    told = '"u","y","Ts",\n' + "\n".join(f"{a},{b},{'' if i else 4}," for i, (a, b) in enumerate(noise))
    record = read_record("a.csv", told.encode(), "a")
    assert record.step_s == 4 and [name for name, _ in record.outputs] == ["y"]
    timed = columns(np.arange(64), *noise.T, begin="Time (ms),a,b\n")
    assert read_record("a.csv", timed, "a", "t,y,u").step_s == pytest.approx(1e-3)


def test_channels_that_are_no_outputs_are_left_out_and_said():
    noise = np.random.default_rng(1).normal(size=(64, 4))
    t = np.arange(64) / 100
    a, b, c, d = noise.T
    cases = {  # names, columns, the input, the outputs, what is said
        "t,pwm,volts,speed": ((a, 3 * a + 1, c), ["speed"], "'volts' is a multiple of 'pwm'"),
        "t,uEst,uVal,yEst,yVal": ((a, b, c, d), ["yEst"], "'uVal' is another input"),
        "t,u1,u2,y1,y2": ((a, b, c, d), ["y1", "y2"], "'u2' is another input"),
        "t,u,v": ((a, 2 * a), ["v"], ""),
        "t,stamp,u,y,z": ((t + 1e9, a, b, b), ["y"], ""),
    }
    for head, (series, outputs, said) in cases.items():
        record = read_record("a.csv", columns(t, *series, begin=head + "\n"), "a")
        assert [name for name, _ in record.outputs] == outputs, head
        assert np.allclose(record.input[1], a), head
        assert said in " ".join(record.guesses), head
    rows = "\n".join(f"{x},{1 if i % 4 else ''},{y}" for i, (x, y) in enumerate(zip(t, c, strict=True)))
    with pytest.raises(DataError, match="something other than numbers"):
        read_record("a.csv", f"t,a,b\n{rows}".encode(), "a")
    assert read_record("a.csv", f"t,a,b\n{rows}".encode(), "a", "t,-,y").outputs[0][0] == "b"


def test_square_waves_that_are_held_between_samples_show_the_response_at_their_harmonics(tmp_path):
    u = np.tile(np.repeat([1.0, -1.0], 50), 40)  # no power in even harmonics
    pole = np.exp(-2 * np.pi * 20 * STEP / 10)
    y = signal.lfilter([0, 1 - pole], [1, -pole], u) + 1e-3 * np.random.default_rng(2).normal(size=u.size)
    (found,) = read_measurement(written(tmp_path, u, y, times=np.arange(u.size) * STEP / 10))
    assert "periodic" in found.guesses[-1] and "held between samples" in found.guesses[-1]
    off = np.abs(found.values * (1 + 1j * found.frequency_hz / 20) - 1)
    assert found.frequency_hz[:9] == pytest.approx(50 * np.arange(1, 18, 2))
    assert np.all(off < 5 * found.relative_deviation()) and np.all(off[:3] < 0.012)


def test_sweeps_that_are_cut_off_and_steps_at_uneven_times_are_seen(tmp_path):
    u, y = simulated(signal.chirp(np.arange(12_000) * STEP / 4, 2, 6, 60, phi=-90))
    (found,) = read_measurement(written(tmp_path, u, y))
    assert "a record from rest" in found.guesses[-1]
    near = (found.frequency_hz > 5) & (found.frequency_hz < 20)
    h = true(found.omega_seen / 2 / np.pi)
    assert near.sum() > 10 and np.all(np.abs(found.values - h)[near] < 0.03 * np.abs(h)[near])
    u, y = simulated(inputs("step"))
    t = STEP * (np.arange(u.size) + 0.05 * np.random.default_rng(1).uniform(size=u.size))
    (found,) = read_measurement(written(tmp_path, u, y, times=t))
    assert "a step" in found.guesses[-1]


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # pyuff leaves files open
def test_time_responses_of_a_universal_file_are_a_record(tmp_path):
    pyuff = pytest.importorskip("pyuff")
    for binary in (0, 1):
        path = tmp_path / f"record{binary}.uff"
        for node, kind, label, values in ((1, 13, "N", CHIRP), (2, 8, "mm", 1e3 * PUSHED)):
            words = dict.fromkeys(("id1", "id2", "id3", "id4", "id5", "rsp_ent_name", "ref_ent_name"), "NONE")
            entry = pyuff.prepare_58(
                **words, binary=binary, func_type=1, rsp_node=node, rsp_dir=3, ref_node=0, ref_dir=0,
                abscissa_spacing=1, abscissa_inc=STEP, abscissa_min=0.0, abscissa_spec_data_type=17,
                ordinate_spec_data_type=kind, orddenom_spec_data_type=0, ordinate_axis_units_lab=label,
                num_pts=values.size, data=values, x=np.arange(values.size) * STEP,
            )  # fmt: skip
            pyuff.UFF(str(path)).write_sets([entry], mode="add")
        (found,) = read_measurement(path)
        (plain,) = read_measurement(written(tmp_path, CHIRP, PUSHED))
        assert found.name == "X_2Z/F_1Z"
        assert found.unit == "m/N"
        assert found.values == pytest.approx(plain.values, rel=1e-4)


def test_channels_of_several_files_are_one_record(tmp_path):
    t = np.arange(CHIRP.size) * STEP
    for name, values in (("A.CSV", CHIRP), ("B.CSV", 1e3 * PUSHED)):
        (tmp_path / name).write_text(oscilloscope(t, values), newline="")
    (found,) = read_records(f"u={tmp_path / 'A.CSV'},y={tmp_path / 'B.CSV'}")
    (plain,) = read_measurement(written(tmp_path, CHIRP, 1e3 * PUSHED))
    assert found.name == "B/A"  # both channels have one name
    assert found.values == pytest.approx(plain.values, rel=1e-3)
    with pytest.raises(UsageError, match="at most one u"):
        read_records("u=A.CSV,u=B.CSV")
    (tmp_path / "C.CSV").write_text(oscilloscope(2 * t, PUSHED), newline="")
    with pytest.raises(DataError, match="has a sample every"):
        read_records(f"u={tmp_path / 'A.CSV'},y={tmp_path / 'C.CSV'}")


def test_nodes_of_a_circuit_keep_their_names(tmp_path):
    (found,) = read_measurement(written(tmp_path, CHIRP, PUSHED, head="time\tV(in)\tV(n001)", sep="\t"))
    assert found.name == "V(n001)/V(in)"
    assert found.unit == "1"


def test_a_reference_that_never_changes_is_no_step_of_its_own():
    rows = "\n".join(f"{i * STEP:.3f},3.2" for i in range(200))
    with pytest.raises(DataError, match="no channel of numbers that changes"):
        read_record("a.csv", f"TIME,REF1\n{rows}\n".encode(), "a")


def test_a_decay_that_is_cut_off_early_is_no_response_to_noise(tmp_path):
    t = np.arange(190) * 0.005
    random = np.random.default_rng(1)
    y = np.exp(-0.03 * 75.4 * t) * np.sin(75.4 * t) + 0.002 * random.normal(size=190)
    (found,) = read_measurement(written(tmp_path, None, y, head="time,acc", times=t))
    assert any("taken as a free decay" in guess for guess in found.guesses)
    noise = signal.lfilter([1], [1, -1.9, 0.96], random.normal(size=4000))
    (found,) = read_measurement(written(tmp_path, None, noise, head="time,acc"))
    assert any("driven by white noise" in guess for guess in found.guesses)


def test_a_response_keeps_its_unit_in_every_format(tmp_path):
    (found,) = read_measurement(written(tmp_path, CHIRP, 1e3 * PUSHED, head="t [s],F [N],x [mm]"))
    for ending in (".csv", ".npz", ".uff"):
        if ending == ".uff":
            pytest.importorskip("pyuff")
        path = tmp_path / f"frf{ending}"
        path.write_bytes(measurement_bytes(found, path))
        (again,) = read_measurement(path)
        assert again.unit == "m/N", ending
        assert again.values == pytest.approx(found.values, rel=1e-4), ending


@pytest.mark.parametrize("again", ["", "time_s,u,y\n", "\n"])
def test_records_one_below_the_other_are_several(tmp_path, again):
    source, parts = np.random.default_rng(5), []
    for size in (80, 80, 60):
        u, y = source.standard_normal((2, size))
        parts.append(
            "".join(f"{i / 100:g},{a:.6g},{b:.6g}\n" for i, (a, b) in enumerate(zip(u, y, strict=True)))
        )
    (tmp_path / "several.csv").write_text("time_s,u,y\n" + again.join(parts))
    found = read_measurement(tmp_path / "several.csv")
    assert [one.samples[0].output.size for one in found] == [80, 80, 60]
    assert "the times begin again: 3 records, one below the other" in found[0].guesses

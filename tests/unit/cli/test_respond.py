"""``symflex respond``."""

from __future__ import annotations

import csv
import io
import math
import runpy
from dataclasses import replace

import mpmath
import numpy as np
import pytest

import symflex
from symflex.analysis.time_response import response_text

OSCILLATOR = """
symflex = 1
parameters = { m = "2 kg", b = "4 N*s/m", k = "800 N/m" }
inputs  = { F = { force = "x" } }
outputs = { X = "x", A = "s^2*x" }
[elements]
load   = { type = "mass", at = "x", m = "m" }
rail   = { type = "damper", between = ["ground", "x"], b = "b" }
spring = { type = "spring", between = ["ground", "x"], k = "k" }
"""


def step_of_oscillator(t, m=2.0, b=4.0, k=800.0):
    """Return the closed form of a damped oscillator's step response."""
    decay, omega = b / (2 * m), math.sqrt(k / m - (b / (2 * m)) ** 2)
    return (1 - math.exp(-decay * t) * (math.cos(omega * t) + decay / omega * math.sin(omega * t))) / k


@pytest.fixture
def oscillator(shell, tmp_path):
    (tmp_path / "osc.toml").write_text(OSCILLATOR, encoding="utf-8")
    return shell


def test_json_has_the_schema_and_holds_the_closed_form(oscillator):
    done = oscillator("respond", "osc.toml", "--tf", "X/F", "--until", "0.5s", "--points", "11", "--json")
    document = done.json
    assert done.code == 0
    assert document["schema"] == "symflex.respond/1"
    assert (document["tf"], document["input"], document["unit"]) == ("X/F", "step", "m")
    assert document["certified"] is True
    assert document["time"] == pytest.approx([0.05 * i for i in range(11)])
    for t, value, radius in zip(document["time"], document["value"], document["radius"], strict=True):
        assert abs(float(value) - step_of_oscillator(t)) <= float(radius) + 1e-17


def test_the_table_has_the_digits_asked_for_where_they_are_known(shell, tmp_path):
    (tmp_path / "lag.toml").write_text('symflex = 1\ninputs.u = {}\noutputs.y = "u/(s + 1)"')
    for digits, value in ((30, "0.632120558828557678404476229839"), (5, "0.63212")):  # 1 - 1/e
        out = shell("respond", "lag.toml", "--until", "1", "--points", "2", "--digits", str(digits)).out
        assert out.splitlines()[-1].split()[1] == value


def test_a_step_of_a_speed_is_in_the_unit_of_its_command(oscillator, tmp_path):
    loop = '[signals]\nw = "(r - w)/(s*T)"\n[inputs]\nr = { unit = "rad/s" }\n[outputs]\nW = "w"\n'
    text = f'symflex = 1\n[parameters]\nT = "1 s"\n{loop}'
    (tmp_path / "speed.toml").write_text(text, encoding="utf-8")
    assert (
        oscillator("respond", "speed.toml", "--until", "1", "--points", "2", "--json").json["unit"] == "rad/s"
    )


def test_without_an_end_a_step_is_followed_until_it_has_died_away(oscillator):
    found = oscillator("respond", "osc.toml", "--tf", "X/F", "--json").json
    left = math.exp(-found["time"][-1])  # the poles are -1 +- 20j
    assert 0.001 < left < 0.05
    assert float(found["value"][-1]) * 800 == pytest.approx(1, abs=1.01 * left)


def test_text_says_what_is_an_impulse(oscillator):
    out = oscillator("respond", "osc.toml", "--tf", "A/F", "--to", "impulse", "--until", "1 s").out
    assert "also, at 0 s, an impulse of weight 0.5" in out
    assert max(map(len, out.splitlines())) <= 80


def test_a_table_has_a_line_a_point_and_a_figure_is_written(oscillator, tmp_path):
    oscillator("respond", "osc.toml", "--tf", "X/F", "--until", "0.5", "--points", "3", "-o", "x.csv")
    text = (tmp_path / "x.csv").read_text(encoding="utf-8")
    rows = list(csv.DictReader(io.StringIO("".join(x for x in text.splitlines(True) if x[0] != "#"))))
    assert [float(row["time_s"]) for row in rows] == [0.0, 0.25, 0.5]
    assert float(rows[2]["value"]) == pytest.approx(step_of_oscillator(0.5), rel=1e-11)
    oscillator("respond", "osc.toml", "--tf", "X/F", "--until", "0.5", "-o", "x.svg")
    assert (tmp_path / "x.svg").read_bytes().startswith(b"<?xml")


def test_what_makes_no_sense_is_refused_with_a_sentence(oscillator):
    for arguments in (
        ["--until", "-1"],
        ["--until", "0"],
        ["--until", "3 kg"],
        ["--until", "soon"],
        ["--until", "1", "--points", "1"],
        ["--until", "1", "--to", "push"],
        ["--until", "1", "--tf", "Y/F"],
        ["--until", "1", "-o", "x.docx"],
        ["--until", "1", "-o", "x.csv", "--json"],
    ):
        done = oscillator("respond", "osc.toml", *arguments)
        assert done.code == 2, arguments
        assert done.err.strip(), arguments
        assert "Traceback" not in done.err, arguments


def test_a_file_is_an_input_of_straight_lines(oscillator, tmp_path):
    (tmp_path / "u.csv").write_text("time_ms,F\n0,1\n500,1\n", encoding="utf-8")
    arguments = ["--tf", "X/F", "--to", "u.csv", "--until", "0.5", "--points", "3", "--json"]
    document = oscillator("respond", "osc.toml", *arguments).json
    assert document["input"] == "u.csv"
    assert document["time"] == [0.0, 0.25, 0.5]
    assert [float(v) for v in document["value"]] == pytest.approx(
        [step_of_oscillator(t) for t in (0, 0.25, 0.5)]
    )


def test_without_an_end_a_file_is_followed_at_its_own_times(oscillator, tmp_path):
    (tmp_path / "u.csv").write_text("0 0\n0.1 1\n0.3 1\n", encoding="utf-8")
    assert oscillator("respond", "osc.toml", "--to", "u.csv", "--json").json["time"] == [0.0, 0.1, 0.3]


def test_a_file_that_is_no_input_is_refused_at_its_place(oscillator, tmp_path):
    for text, code in (
        ("", "SF605"),
        ("time_s,u\n0,1\n", "SF605"),
        ("time_s,u\n0,1\n1,\n2,3\n", "SF603"),
        ("time_s,u\n0,1\n1,nan\n2,3\n", "SF603"),
        ("time_s,u\n0,1\n1\n2,3\n", "SF602"),
        ("time_s,u\n0,1\n1,0,5\n2,3\n", "SF602"),
        ("time_s,u\n0,1\n2,1\n1,3\n", "SF604"),
        ("frequency,u\n0,1\n1,1\n", "SF602"),
        ("time_cycles,u\n0,1\n1,1\n", "SF602"),
        ("0,1\n1,1e999\n", "SF603"),
    ):
        (tmp_path / "u.csv").write_text(text, encoding="utf-8")
        done = oscillator("respond", "osc.toml", "--to", "u.csv")
        assert done.code == 3, (text, code)
        assert f"error[{code}]" in done.err, (text, code)
    assert "error[SF901]" in oscillator("respond", "osc.toml", "--to", "none.csv").err


def test_a_shaper_is_printed_with_its_residual_and_drawn(oscillator, tmp_path):
    document = oscillator("shape", "osc.toml", "--kind", "zvd", "--json").json
    assert document["schema"] == "symflex.shape/1"
    assert len(document["impulses"]) == 3
    assert sum(float(i["amplitude"]) for i in document["impulses"]) == pytest.approx(1, abs=1e-14)
    assert float(document["modes"][0]["residual"]) <= 1e-14
    done = oscillator("shape", "osc.toml", "-o", "left.svg")
    assert "ZV shaper, 2 impulses" in done.out
    assert (tmp_path / "left.svg").exists()


def test_a_delay_of_the_specification_becomes_states(shell, tmp_path):
    text = OSCILLATOR.replace("[elements]", 'blocks.D = { type = "delay", T = "13 ms" }\n[elements]')
    (tmp_path / "late.toml").write_text(text.replace('X = "x"', 'X = "D*x"'), encoding="utf-8")
    asked = ["--to", "state-space", "--sample", "10ms", "-o", "step.py"]
    assert shell("export", "late.toml", "--tf", "X/F", *asked).code == 0
    names = runpy.run_path(str(tmp_path / "step.py"))
    assert [state["name"] for state in names["STATES"]] == ["x", "x_dot", "F_2_before", "F_1_before"]
    w = np.zeros(4)
    for _ in range(50):
        w = names["A"] @ w + names["B"] @ [1.0]
    assert float((names["C"] @ w)[0]) == pytest.approx(step_of_oscillator(0.487), rel=1e-12)
    done = shell("export", "late.toml", *asked)
    assert done.code == 3
    assert "use --tf to choose functions with the same delay" in done.err


def test_a_controller_is_exported_with_its_poles_and_what_rounding_costs(oscillator, tmp_path):
    for target in ("c", "numpy"):
        done = oscillator(
            "export", "osc.toml", "--tf", "X/F", "--to", target, "--sample", "1ms", "--method", "tustin"
        )
        assert done.code == 0, target
        assert "by the bilinear transformation" in done.out, target
        assert "Poles in z: 0.9988" in done.out, target
        assert "rounding takes the output off by at most" in " ".join(done.out.replace(" * ", " ").split()), (
            target
        )


def test_options_of_sampling_that_do_not_go_together_are_refused(oscillator):
    for asked, said in (
        (["--to", "julia", "--sample", "1ms"], "--sample is for"),
        (["--to", "c", "--method", "zoh"], "need --sample"),
        (["--to", "state-space", "--sample", "1ms", "--direct"], "--direct is for"),
        (["--to", "state-space", "--sample", "1ms", "--method", "matched"], "to one transfer function"),
        (["--to", "c", "--sample", "1ms", "--minimal"], "--minimal is for"),
        (["--to", "numpy", "--sample", "1ms", "--form", "band"], "without --sample"),
        (["--to", "c", "--sample", "1ms", "--up-to", "1 kHz"], "without --sample"),
        (["--to", "c", "--sample", "0"], "positive time"),
        (["--to", "c", "--sample", "1ms", "--method", "tustin", "--prewarp", "1kHz"], "that is 500 Hz"),
        (["--to", "c", "--sample", "1ms", "--method", "tustin", "--prewarp", "1kg"], "--prewarp takes"),
    ):
        done = oscillator("export", "osc.toml", "--tf", "X/F", *asked)
        assert done.code == 2, (asked, said)
        assert said in done.err, (asked, said)


def test_inputs_that_were_broken_by_hand_get_a_sentence(oscillator, tmp_path):
    for asked, code, said in (
        (["--until", "1e300"], 2, "error[SF103]: --until '1e300': a decimal exponent beyond 60"),
        (["--until", "1", "--modes", "2"], 2, "--modes and --joint need --shaped"),
        (["--until", "1", "--width", "a4"], 2, "--xlim, --ylim, --width and --font apply only to a figure"),
        (
            ["--until", "1", "-o", "osc.svg", "--width", "a4", "--font", "sans", "--ylim", "0", "1"],
            0,
            "wrote",
        ),
        (
            ["--until", "1", "--shaped", "zv", "--modes", "7"],
            2,
            "has only 1 oscillatory mode, and --modes 7 asks for 7",
        ),
        (["--to", "gap.csv"], 3, "gap.csv:3:1: error[SF603]: a number is missing"),
        (["--to", "odd.csv"], 2, "the times have no usable common step"),
        (["--to", "same.csv"], 3, "same.csv:4:1: error[SF604]: times do not increase"),
        (["--to", "free"], 2, "--to free needs --initial"),
        (["--hold"], 2, "--hold needs a file of samples"),
    ):
        (tmp_path / "gap.csv").write_text("time_s,u\n0,0\n1,\n2,1\n", encoding="utf-8")
        (tmp_path / "odd.csv").write_text("time_s,u\n0,0\n0.1234567890123456,1\n1,1\n", encoding="utf-8")
        (tmp_path / "same.csv").write_text("time_s,u\n0,0\n0,1\n0,2\n", encoding="utf-8")
        done = oscillator("respond", "osc.toml", "--tf", "X/F", *asked)
        assert (done.code, done.err.count(said)) == (code, 1), (asked, code, said)


def test_what_grows_beyond_doubles_is_printed_in_decimals_and_not_drawn(shell, tmp_path):
    text = 'symflex = 1\ninputs.u = {}\noutputs.y = "u/(s - 5)"\n'
    (tmp_path / "up.toml").write_text(text, encoding="utf-8")
    document = shell("respond", "up.toml", "--until", "1000", "--points", "2", "--json").json
    with mpmath.workdps(20):
        expected = (mpmath.exp(5000) - 1) / 5
        assert abs(mpmath.mpf(document["value"][1]) / expected - 1) < mpmath.mpf("1e-11")
    drawn = shell("respond", "up.toml", "--until", "1000", "--points", "3", "-o", "up.svg")
    assert drawn.code == 2
    assert "error[SF812]: the response of y/u exceeds the range of doubles from 500 s on" in drawn.err
    beyond = shell("respond", "up.toml", "--until", "1e10s")
    assert (beyond.code, "error[SF812]: the response of y/u exceeds 10^100000 from" in beyond.err) == (
        2,
        True,
    )
    sampled = shell("export", "up.toml", "--to", "c", "--sample", "1000s")
    assert sampled.code == 3
    assert "error[SF233]" in sampled.err


def test_a_bound_below_the_range_of_doubles_is_not_called_zero(oscillator):
    out = oscillator("shape", "osc.toml", "--digits", "400").out
    assert "residual vibration at most 1e-300" in out


def test_a_response_of_an_unstable_system_says_that_it_grows(oscillator, tmp_path):
    (tmp_path / "fall.toml").write_text(
        'symflex = 1\nparameters.a = "4 1/s^2"\ninputs.u = {}\noutputs.y = "a*u/(s^2 - a)"\n'
    )
    said = "the response grows without bound; the system is unstable: 1 pole in the right half-plane"
    for until in ((), ("--until", "1s")):
        assert said in " ".join(oscillator("respond", "fall.toml", *until).out.split())
    assert "grows" not in oscillator("respond", "osc.toml", "--tf", "X/F").out


def motion_of_oscillator(t, x, v, m=2.0, b=4.0, k=800.0):
    """Return the closed form of a damped oscillator's motion from a place and a speed."""
    decay, omega = b / (2 * m), math.sqrt(k / m - (b / (2 * m)) ** 2)
    return math.exp(-decay * t) * (x * math.cos(omega * t) + (v + decay * x) / omega * math.sin(omega * t))


@pytest.mark.parametrize(
    ("initial", "x", "v"),
    [
        (["x=1 mm"], 0.001, 0),
        (["x=0.001", "s*x=0.1 m/s"], 0.001, 0.1),
        (["s*x = 360 km/h"], 0, 100),
        (["s * x=-pi/2 m/s", "x = 2 cm"], 0.02, -math.pi / 2),
    ],
)
def test_a_free_motion_is_the_closed_form(initial, x, v, oscillator):
    options = [part for text in initial for part in ("--initial", text)]
    found = oscillator(
        "respond", "osc.toml", "--to", "free", *options, "--until", "0.5", "--points", "6", "--json"
    )
    truth = [motion_of_oscillator(0.1 * i, x, v) for i in range(6)]
    assert [float(y) for y in found.json["value"]] == pytest.approx(truth, rel=1e-10)
    assert found.json["certified"]


def test_a_step_from_initial_values_is_the_sum_of_both(oscillator):
    found = oscillator(
        "respond", "osc.toml", "--initial", "x=1 mm", "--until", "0.5", "--points", "6", "--json"
    )
    truth = [step_of_oscillator(0.1 * i) + motion_of_oscillator(0.1 * i, 0.001, 0) for i in range(6)]
    assert [float(y) for y in found.json["value"]] == pytest.approx(truth, rel=1e-10)
    assert found.json["initial"] == "x = 1 mm"


LEVERS = """
symflex = 1
inputs.F = { force = "x" }
outputs.X = "x"
signals.z = "x + y"
[elements]
a = { type = "mass", at = "x", m = "1 kg" }
b = { type = "mass", at = "y", m = "1 kg" }
c = { type = "spring", between = ["x", "ground"], k = "4 N/m" }
d = { type = "spring", between = ["y", "ground"], k = "9 N/m" }
"""
FREE = {
    "discharge": (
        'inputs.V = { voltage = "a" }\noutputs.U = "b"\n[elements]\n'
        'r = { type = "resistor", between = ["a", "b"], R = "1 kOhm" }\n'
        'c = { type = "capacitor", between = ["b", "ground"], C = "1 uF" }',
        "b=5 V",
        lambda t: 5 * math.exp(-t / 1e-3),
    ),
    "rotor": (
        'inputs.T = { torque = "w" }\noutputs.W = "s*w"\n[elements]\n'
        'j = { type = "inertia", at = "w", J = "0.1 kg*m^2" }\n'
        'd = { type = "rotary_damper", between = ["w", "ground"], b = "0.2 N*m*s/rad" }',
        "s*w=3000 rpm",
        lambda t: 100 * math.pi * math.exp(-2 * t),
    ),
}


@pytest.mark.parametrize("name", FREE)
def test_initial_values_of_other_domains(name, shell, tmp_path):
    text, initial, truth = FREE[name]
    (tmp_path / "model.toml").write_text(f"symflex = 1\n{text}\n", encoding="utf-8")
    options = [part for each in initial.split(", ") for part in ("--initial", each)]
    options += ["--to", "free", "--until", "2 ms", "--points", "3", "--json"]
    found = shell("respond", "model.toml", *options).json
    assert [float(y) for y in found["value"]] == pytest.approx([truth(t) for t in found["time"]], rel=1e-10)


def test_what_is_no_state_of_a_lumped_model_has_no_initial_value(oscillator, tmp_path):
    bar = (
        'symflex = 1\ninputs.F = { force = "x" }\noutputs.X = "x"\n[elements]\n'
        'bar = { type = "rod", between = ["ground", "x"], EA = "7 MN", rhoA = "0.27 kg/m", l = "1 m" }\n'
    )
    (tmp_path / "bar.toml").write_text(bar, encoding="utf-8")
    (tmp_path / "levers.toml").write_text(LEVERS, encoding="utf-8")
    refused = {
        ("bar.toml", "x=1 mm"): "SF235",
        ("osc.toml", "y=1 mm"): "'y' is not a quantity whose initial value can be given",
        ("levers.toml", "z=1 mm"): "give values of x, y, s*x, s*y",
        ("osc.toml", "x=1 N"): "'x' is in 'm', its initial value in 'N'",
        ("osc.toml", "s^2*x=1"): "give values of x, s*x",
        ("osc.toml", "x"): "--initial takes NAME=VALUE",
    }
    said = {key: oscillator("respond", key[0], "--initial", key[1]).err for key in refused}
    assert not [key for key, text in refused.items() if text not in said[key]]


STAIRS = [(0.0, 1.0), (0.1, 2.0), (0.25, 0.5)]
JUMPS = {
    "held": ("time_s,F\n0,1\n0.1,2\n0.25,0.5\n", ("--hold",)),
    "two lines at a time": ("time_s,F\n0,1\n0.1,1\n0.1,2\n0.25,2\n0.25,0.5\n", ()),
    "held in milliseconds": ("time_ms;F\n0;1\n100;2\n250;0,5\n", ("--hold",)),
}


@pytest.mark.parametrize("case", JUMPS)
def test_a_staircase_is_a_sum_of_steps(case, oscillator, tmp_path):
    text, options = JUMPS[case]
    (tmp_path / "in.csv").write_text(text, encoding="utf-8")
    found = oscillator(
        "respond", "osc.toml", "--to", "in.csv", *options, "--until", "0.4", "--points", "9", "--json"
    ).json
    before = [0.0, *(u for _, u in STAIRS)]
    truth = [
        sum(
            (u - was) * step_of_oscillator(t - at)
            for (at, u), was in zip(STAIRS, before, strict=False)
            if t > at
        )
        for t in found["time"]
    ]
    assert [float(y) for y in found["value"]] == pytest.approx(truth, rel=1e-9, abs=1e-18)


def test_an_output_that_follows_at_once_jumps_with_its_input(oscillator, tmp_path):
    (tmp_path / "in.csv").write_text(JUMPS["held"][0], encoding="utf-8")
    found = oscillator("respond", "osc.toml", "--tf", "A/F", "--to", "in.csv", "--hold", "--json").json
    jumps = [float(j[key]) for j in found["jumps"] for key in ("time", "height")]
    assert jumps == pytest.approx([0.1, 0.5, 0.25, -0.75])  # a jump of F over m


def test_a_record_drives_the_model_and_its_output_is_compared(oscillator, tmp_path):
    t = 0.01 * np.arange(200)
    measured = np.array([1.1 * step_of_oscillator(max(x - 0.2, 0.0)) * 5 for x in t])  # 10 % too large
    rows = [f"{x:.2f},{3 + 5 * (x >= 0.2)},{0.7 + y:.9g}" for x, y in zip(t.tolist(), measured, strict=True)]
    (tmp_path / "axis.csv").write_text("time,force,X\n" + "\n".join(rows) + "\n", encoding="utf-8")
    asked = ("respond", "osc.toml", "--tf", "X/F", "--record", "axis.csv", "--hold")
    rms = oscillator(*asked, "--json").json["measured"]["rms_difference"]
    assert rms == pytest.approx(np.std(measured / 11), rel=1e-3)  # less the mean, an offset
    offset = 0.7 + np.mean(measured) / 11
    said = f"measured X less the model: rms {rms:.4g} m, where X has"
    for more in ((), ("-o", "axis.svg"), ("-o", "axis.csv.csv")):  # -o leaves the table
        out = " ".join(oscillator(*asked, *more).out.split())
        assert said in out and f"an offset of {offset:.4g} is subtracted" in out
    table = np.loadtxt(tmp_path / "axis.csv.csv", delimiter=",", skiprows=5)
    assert table[:, 3] == pytest.approx(measured - np.mean(measured) / 11, abs=1e-8)
    drawn = ("osc.toml", "step", "--tf", "X/F", "--record", "axis.csv", "-o", "step.svg")
    assert oscillator("plot", *drawn).code == 0
    assert "measured" in (tmp_path / "step.svg").read_text(encoding="utf-8")
    assert oscillator("plot", "osc.toml", "bode", *drawn[2:]).code == 2
    assert oscillator(*asked, "--to", "ramp").code == 2
    assert oscillator("respond", "osc.toml", "--tf", "X/F", "--record", "osc.toml").code == 2


def test_a_record_is_in_the_units_of_its_header_and_held_where_that_is_closer(oscillator, tmp_path):
    t = 0.01 * np.arange(100)
    u = np.random.default_rng(1).normal(size=100)
    y = [sum((b - a) * step_of_oscillator(x - at) for at, a, b in zip(t, [0, *u], u, strict=False) if x > at)
         for x in t]  # fmt: skip
    rows = "\n".join(f"{x:.2f},{1e-3 * f:.12g},{1e3 * z:.12g}" for x, f, z in zip(t, u, y, strict=True))
    asked = ("respond", "osc.toml", "--tf", "X/F", "--record", "axis.csv")
    (tmp_path / "axis.csv").write_text(f"time [s],F [kN],X [mm]\n{rows}\n", encoding="utf-8")
    found = oscillator(*asked)
    assert "'X' is in mm, and is read in m: times 0.001" in found.err
    assert "held from each sample to the next, which is closer" in found.err
    assert float(found.out.partition("rms ")[2].split()[0]) < 1e-6 * np.std(y)
    (tmp_path / "axis.csv").write_text(f"time [s],F [V],X\n{rows}\n", encoding="utf-8")
    found = oscillator(*asked)
    assert "'F' is in V, and F in N: values are not converted" in found.err
    assert "'X' has no unit in the record, and is taken in m" in found.err


def test_what_is_not_certified_has_an_estimated_error_and_no_radius():
    response = symflex.loads(OSCILLATOR).transfer_function("X", "F").bind().step_response([0, 0.1])
    estimated = replace(response, certified=False, reason="so")
    heads = [text.splitlines()[2].split()[3:] for text in map(response_text, (response, estimated))]
    assert heads == [["radius"], ["est.", "error"]]


def test_a_response_that_settles_says_that_a_hidden_mode_grows(shell, tmp_path):
    text = """
        symflex = 1
        blocks = { P = "1/(s - 3)", C = "(s - 3)/(s + 2)" }
        signals = { y = "P*C*u" }
        inputs = { u = {} }
        outputs = { Y = "y" }
        """
    (tmp_path / "hidden.toml").write_text(text, encoding="utf-8")
    out = shell("respond", "hidden.toml").out
    assert "final value              0.5000000000" in out  # 1/(0 + 2)
    assert "the system is unstable: 1 pole in the right half-plane" in out
    assert "a hidden pole in the right half-plane" in out

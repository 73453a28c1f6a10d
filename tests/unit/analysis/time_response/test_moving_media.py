"""Waves in what moves along x: two speeds, kept shape, and what loses or exchanges on the way."""

import numpy as np
import pytest

from symflex import loads
from symflex.analysis.time_response import SampleTimes, time_response
from symflex.analysis.time_response.delayed_terms import read_delays

HEAD = "symflex = 1\n"
THREADLINE = """
parameters = { T = "100 N", m = "20 g/m", v = "30 m/s", L = "0.8 m", x_F = "0.3 m" }
inputs = { F = { unit = "N" } }
outputs = { Y = "w_2(x_F)" }
[fields.w_1]
domain = ["0", "x_F"]
equation = "m*(s^2*w_1 + 2*v*s*w_1' + v^2*w_1'') = T*w_1''"
conditions = ["w_1(0) = 0", "w_1(x_F) = w_2(x_F)"]
[fields.w_2]
domain = ["x_F", "L"]
equation = "m*(s^2*w_2 + 2*v*s*w_2' + v^2*w_2'') = T*w_2''"
conditions = ["w_2(L) = 0", "(T - m*v^2)*(w_1'(x_F) - w_2'(x_F)) = F"]
"""
MOVED = """
[parameters]
T = "100 N"
m = "20 g/m"
L = "0.8 m"
c = { value = "0 N*s/m^2", assume = "nonnegative" }
v = { value = "30 m/s", assume = "real" }
[inputs]
u = { unit = "m" }
[outputs]
Y = "w(L/4)"
[fields.w]
domain = ["0", "L"]
equation = "m*(s^2*w + 2*v*s*w' + v^2*w'') + c*(s*w + v*w') = T*w''"
conditions = ["w(0) = u", "w(L) = 0"]
"""
# p runs along x, n against it; p(0) = u + r n(0), n(L) = q p(L)
OPPOSED = """
parameters = { a = "50 m/s", b = "20 m/s", L = "1 m", r = "0.5", q = "0.7" }
inputs = { u = {} }
outputs = { Y = "p(L)" }
[fields.x]
domain = ["0", "L"]
unknowns = ["p", "n"]
equations = ["s*p + a*p' = 0", "s*n - b*n' = 0"]
conditions = ["p(0) = u + r*n(0)", "n(L) = q*p(L)"]
"""
EXCHANGER = """
parameters = { a = "1 m/s", b = "SPEED", L = "1 m", k = "0.4 1/s", h = "0.6 1/s" }
inputs = { u = {} }
outputs = { Y = "p(L)" }
[fields.x]
domain = ["0", "L"]
unknowns = ["p", "n"]
equations = ["s*p + a*p' = k*(n - p)", "s*n SIGN b*n' = h*(p - n)"]
conditions = ["p(0) = u", "n(END) = 0"]
"""


def of(text, output="Y", source="u"):
    return loads(HEAD + text).transfer_function(output, source).bind().bound


def test_a_force_on_a_moving_string_is_known_exactly():
    # The printed formula in delays: 1/(2 sqrt(T m) s) times a quotient of exp(-2 tau s), inverted by hand.
    found = time_response(of(THREADLINE, source="F"), "step", SampleTimes.of([0.01, 0.02]))
    assert found.certified
    assert found.method == "echoes"
    assert found.values == pytest.approx([0.00353553390593, 0.00268502974911], abs=1e-14)


def test_a_wave_takes_its_own_time_along_the_motion_and_against_it():
    c, x, length = 5000**0.5, 0.2, 0.8
    for v in (30.0, -30.0):
        text = MOVED.replace('"30 m/s"', f'"{v} m/s"')
        found = time_response(of(text), "step", SampleTimes.of([0.0, 0.04]))
        along, back = 1 / (c + v), 1 / (c - v)
        round_trip = length * (along + back)
        first, second = x * along, length * along + (length - x) * back
        expected = sorted([first, second, first + round_trip, second + round_trip])
        times = [float(jump.time) for jump in found.jumps]
        heights = [float(jump.height) for jump in found.jumps]
        assert times == pytest.approx([t for t in expected if t < 0.04], rel=1e-12), v
        assert heights == pytest.approx([1.0, -1.0, 1.0, -1.0][: len(heights)], abs=1e-12), v


def test_what_runs_in_opposite_directions_returns_after_both_ways():
    # exp(-0.02 s)/(1 - 0.35 exp(-0.07 s))
    found = time_response(of(OPPOSED), "step", SampleTimes.of([0.0, 0.05, 0.1, 0.2]))
    assert found.certified
    assert found.values == pytest.approx([0.0, 1.0, 1.35, 1.4725], abs=1e-12)


def test_streams_of_one_speed_exchange_and_keep_their_shape():
    # The difference decays by exp(-(k + h) x/a): p = (h + k exp(-1))/(k + h) after 1 s.
    text = EXCHANGER.replace("SPEED", "1 m/s").replace("SIGN", "+").replace("END", "0")
    found = time_response(of(text), "step", SampleTimes.of([0.9, 1.1, 5.0]))
    late = 0.6 + 0.4 * np.exp(-1)
    assert found.certified
    assert found.values == pytest.approx([0.0, late, late], abs=1e-12)


def test_streams_in_opposite_directions_exchange_between_the_fronts():
    # Bromwich integrals of the solved boundary value problem, 400,000 points to 2e4 rad/s: right to 3e-9.
    text = EXCHANGER.replace("SPEED", "0.5 m/s").replace("SIGN", "-").replace("END", "L")
    found = time_response(of(text), "ramp", SampleTimes.of([0.7, 1.4, 3.1]))
    assert found.certified
    assert found.values == pytest.approx([0.0, 0.275868564, 1.55085247], abs=5e-9)


def test_a_moving_string_with_friction_is_certified_by_its_fronts():
    found = time_response(
        of(MOVED.replace('"0 N*s/m^2"', '"0.3 N*s/m^2"')), "step", SampleTimes.of([0.0, 0.01])
    )
    assert (found.certified, found.method) == (True, "wave echoes")
    # The front loses exp(-c x/(2 m (c_0 + v))) on its way of x = 0.2 m.
    height = np.exp(-0.3 * 0.2 / (2 * 0.02 * (5000**0.5 + 30)))
    assert float(found.jumps[0].height) == pytest.approx(height, rel=1e-12)


def test_the_reason_is_the_true_one():
    line = """
parameters = { R = "0.2 Ohm/m", H = "0.1 H/m", G = "0.4 S/m", C = "0.2 F/m", l = "1 m" }
inputs = { u = {} }
outputs = { Y = "V(l)" }
[fields.x]
domain = ["0", "l"]
unknowns = ["V", "I"]
equations = ["V' = -(H*s + R)*I", "I' = -(C*s + G)*V"]
conditions = ["V(0) = u", "I(l) = 0"]
"""
    for text, said in (
        (line, "some waves weaken on the way"),
        (line.replace("0.2 Ohm", "0.9 Ohm"), "change shape"),
    ):
        assert said in read_delays(of(text))

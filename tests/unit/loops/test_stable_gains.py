"""What is said about loops, and what is not."""

from __future__ import annotations

import json
import math

import mpmath
import numpy as np
import pytest

import symflex
from tests.unit.refusals import refusal


def counts(found):
    return [(i.poles.right, i.poles.axis) for i in found.proved.intervals]


def test_a_hidden_unstable_mode_makes_the_loop_unstable():
    model = symflex.loads("""
symflex = 1
parameters.K = 1
signals.x = "u/(s - 1)"
signals.u = "K*(r - y)"
signals.y = "u/(s + 1)"
inputs.r = {}
outputs.Y = "y"
""")
    found = model.stability("K")
    assert found.certified
    assert found.stable == ()
    assert counts(found) == [(1, 0)]


def test_poles_on_the_axis_for_every_gain_are_no_stability(loop):
    found = loop("K/s^2").stability("K")
    assert counts(found) == [(0, 2)]
    assert found.is_stable is False


def test_undamped_masses_flutter_when_the_far_one_is_fed_back():
    # m = 1, k = 1: (s^2 + 1)^2 - 1 + K has a double root in s^2 at K = 1.
    model = symflex.Model(
        parameters={"K": {"value": "0.5 N/m"}},
        signals={"F": "K*(r - y)"},
        elements={
            "a": {"type": "mass", "at": "x", "m": "1 kg"},
            "k": {"type": "spring", "between": ["x", "y"], "k": "1 N/m"},
            "b": {"type": "mass", "at": "y", "m": "1 kg"},
            "drive": {"type": "force_source", "at": "x", "f": "F"},
        },
        inputs={"r": {}},
        outputs={"Y": "y"},
    )
    found = model.stability("K")
    (boundary,) = found.boundaries
    assert float(boundary.gain) == 1
    assert boundary.entering == 2
    assert counts(found) == [(0, 4), (2, 0)]
    assert abs(2 * math.pi * boundary.frequencies_hz[0] - 1) < 1e-12


def test_a_pole_through_infinity_and_one_through_zero(loop):
    # (s + 1) + K (s + 2): the pole is -(1 + 2 K)/(1 + K).
    found = loop("K*(s + 2)/(s + 1)", K={"value": 1, "assume": "real"}).stability("K")
    infinite, zero = found.proved.boundaries
    assert (float(infinite.gain), float(zero.gain)) == (-1, -0.5)
    assert infinite.crossings[0].is_infinite
    assert [float(w) for w in zero.frequencies] == [0]
    assert counts(found) == [(0, 0), (1, 0), (0, 0)]


def test_a_gain_may_occur_squared_in_a_polynomial(loop):
    # s^3 + 2 s^2 + 3 s + K^2 is stable for K^2 < 6.
    found = loop("K^2/(s^3 + 2*s^2 + 3*s)").stability("K")
    (boundary,) = found.boundaries
    assert abs(float(boundary.gain) - math.sqrt(6)) < 1e-12
    assert abs(2 * math.pi * boundary.frequencies_hz[0] - math.sqrt(3)) < 1e-12


def test_poles_that_touch_the_axis_at_one_gain():
    found = symflex.loads("""
symflex = 1
parameters.K = 3
signals.y = "r/(s + (K - 1)^2)"
inputs.r = {}
outputs.Y = "y"
""").stability("K")
    assert [tuple(map(float, ends)) for ends in found.stable] == [(0, 1), (1, math.inf)]


def test_a_loop_whose_order_is_lower_at_one_gain_is_stable_beside_it():
    # K^2 s^2 + s + 1 has one pole at K = 0, where the other is infinite.
    found = symflex.loads("""
symflex = 1
parameters.K = { value = 3, assume = "real" }
signals.y = "r/(K^2*s^2 + s + 1)"
inputs.r = {}
outputs.Y = "y"
""").stability("K", (-1, 1))
    assert [tuple(map(float, ends)) for ends in found.stable] == [(-1, 0), (0, 1)]


def test_all_digits_of_a_transcendental_boundary(loop):
    found = loop("K*D/s").stability("K", (0, 5), digits=50)
    printed = found.to_json_dict()["boundaries"][0]["gain"]["value"]
    assert printed == "3.1415926535897932384626433832795028841971693993751"


@pytest.mark.slow
def test_a_neutral_loop_is_certified_only_below_a_gain_of_one(loop):
    below = loop("K*D*(s + 3)/(s + 1)").stability("K", (0, 0.9))
    beyond = loop("K*D*(s + 3)/(s + 1)").stability("K", (0, 3))
    assert below.certified
    assert not beyond.certified
    assert beyond.counted_up_to_hz < math.inf
    assert float(beyond.boundaries[0].gain) == float(below.boundaries[0].gain)


@pytest.mark.slow
def test_what_crosses_above_the_highest_frequency_counted_does_not_seem_to_touch_the_axis():
    # 1 = g*s/(s + 50)*exp(-s/100): |s/(s + 50)| grows with omega, so each pole crosses once, to the right.
    found = symflex.Model(
        parameters={"g": {"value": 0.6}, "T": "10 ms"},
        blocks={"D": {"type": "delay", "T": "T"}, "H": {"type": "tf", "num": [1, 0], "den": [1, "50 1/s"]}},
        signals={"y": "r + g*H*D*y"},
        inputs={"r": {}},
        outputs={"Y": "y"},
    ).stability("g", (0, 60))
    assert not found.certified
    assert [b.entering for b in found.boundaries] == [2] * len(found.boundaries)
    assert all(b.frequencies_hz[0] < found.counted_up_to_hz for b in found.boundaries)


@pytest.mark.slow
def test_poles_cross_where_a_damper_at_the_actuator_does_nothing_and_what_is_not_proved_is_said(
    lossless_beam,
):
    # Poles cross where the damped end is at rest: at a colocated zero, 2 + cosh 2q + cos 2q = 0.
    found = lossless_beam("tip", is_damped=True).stability("K", up_to_hz=60)
    (hertz,) = found.boundaries[0].frequencies_hz
    stiffness, mass, length = 200e9 * 4000e-12, 7850 * 480e-6, 1.086
    # The clamped-free beam: x is the first root of cosh x cos x = -1, x = 2q.
    assert abs(2 * math.pi * hertz - 1.8751040687119611**2 / length**2 * math.sqrt(stiffness / mass)) < 1e-7
    assert not found.certified
    assert abs(found.counted_up_to_hz - 60) < 1e-9
    assert "NOT CERTIFIED beyond 60 Hz" in str(found)
    assert counts(found) == [(0, 0), (2, 0)]


@pytest.mark.slow
def test_of_a_spring_at_the_damped_end_all_poles_are_counted_and_margins_are_not(lossless_beam):
    found = lossless_beam("act", is_damped=True).stability("K", up_to_hz=100)
    assert not found.certified
    assert found.counted_up_to_hz == math.inf
    assert found.reasons == ("phase margins above 100 Hz are not known",)
    assert "all above" not in str(found)
    assert counts(found) == [(0, 0)]


@pytest.mark.slow
def test_where_poles_mirror_each_other_the_gain_itself_is_examined(lossless_beam):
    # At the tip poles leave the axis for larger gains, and whether some have no one knows.
    for where, word in (("act", "marginal"), ("tip", "unknown")):
        found = lossless_beam(where).stability("K", up_to_hz=100)
        assert found.proved.verdict.word == word
        assert not found.certified and counts(found) == []
        assert "mirrored poles" in str(found)


def test_a_real_pole_through_zero_beside_a_delay(loop):
    # s + 2 + 3 K e^(-s T) is 0 at s = 0 for K = -2/3; a factor in front of the delay counts.
    found = loop("3*K*D/(s + 2)", K={"value": 1, "assume": "real"}).stability("K", (-1, 1))
    boundary = found.boundaries[0]
    assert abs(float(boundary.gain) + 2 / 3) < 1e-12
    assert boundary.frequencies_hz == (0.0,)
    assert counts(found)[:2] == [(1, 0), (0, 0)]


@pytest.mark.slow
def test_a_loop_gain_of_exactly_one_at_rest_is_told_from_one_beside_it(loop):
    # It is below one at all other frequencies: 1/(s + 1) e^(-s) crosses where omega = -tan(omega).
    found = loop("3*K*D/(0.3*s + 3)", T="0.1 s").stability("K", (0, 1.5))
    assert found.certified
    assert not found.proved.phase_margins
    found = loop("K*D/(s + 1)", T="1 s").stability("K", (0, 3))
    assert found.certified
    assert float(found.boundaries[0].gain) == pytest.approx(math.hypot(1, 2.028757838110434), rel=1e-12)
    # (2 s + 1)/(s^2 + s + 1) is one in size at 0 and where 1 + 4 w^2 = (1 - w^2)^2 + w^2, w^2 = 5.
    loop_gain = "K*D*(2*a*s + 1)/(a^2*s^2 + a*s + 1)"
    found = loop(loop_gain, T="0.1 s", a={"value": "1 s"}).stability("K", (0, 2))
    assert found.certified
    (margin,) = found.proved.phase_margins
    w = math.sqrt(5)
    angle = math.pi + math.atan(2 * w) - math.atan2(w, 1 - w * w) - 0.1 * w
    assert float(margin.frequency) == pytest.approx(w, rel=1e-12)
    assert float(margin.angle) == pytest.approx(angle, rel=1e-12)


def test_values_in_place_of_declared_ones(loop):
    found = loop("K*D/s").stability("K", (0, 20), T="0.25 s")
    assert abs(float(found.boundaries[0].gain) - 2 * math.pi) < 1e-12
    # The bandwidth is where K/omega = 1, and K is half of pi/(2 T).
    assert found.bandwidth_hz == pytest.approx(0.5, rel=1e-12)
    assert max(map(len, str(found).splitlines())) <= 80


def test_errors(loop):
    model, unset = loop("K*D/s"), loop("K*D/s", K={})
    for arguments, refused in (
        (("Q",), "UsageError SF902"),
        (("T",), "ModelError SF801"),
        (("K", (2, 1)), "UsageError SF804"),
        (("K", (0, None)), "UsageError SF804"),
    ):
        assert refusal(model.stability, *arguments) == refused, arguments
    assert refusal(model.stability, "K", (0, 50), budget=1e-6) == "BudgetError SF506"
    assert loop("K^2*D/s").stability("K", (0, 3)).certified
    # Beside a delay a gain without a value needs a range.
    assert refusal(unset.stability, "K") == "UsageError SF804"
    assert unset.stability("K", (0, 5)).is_stable is None


def test_the_document_is_json(loop):
    document = json.loads(json.dumps(loop("K/(s*(s + 1)*(s + 2))").stability("K").to_json_dict()))
    assert document["schema"] == "symflex.stability/1"
    assert document["boundaries"][0]["gain"]["value"].startswith("6.0000")
    assert document["intervals"][1]["right_half_plane_poles"] == 2
    assert document["certified"] is True
    assert document["phase_margins"][0]["smallest"] is True


def test_the_bandwidth_is_where_half_of_the_limit_has_loop_gain_one(loop):
    found = loop("K/(s*(s + 1)*(s + 2))").stability("K")
    # abs(3/(s (s+1) (s+2))) = 1 with x = omega^2: x (x + 1) (x + 4) = 9.
    (x,) = [r.real for r in np.roots([1, 5, 4, -9]) if abs(r.imag) < 1e-12 and r.real > 0]
    assert found.bandwidth_hz == pytest.approx(np.sqrt(x) / (2 * np.pi), rel=1e-12)
    assert found.to_json_dict()["bandwidth"]["limited"] is True
    # Its phase is that of -1 plus the margin.
    s = 1j * np.sqrt(x)
    margin = np.degrees(np.angle(-3 / (s * (s + 1) * (s + 2))))
    assert found.to_json_dict()["bandwidth"]["phase_margin_degrees"] == pytest.approx(margin)


def test_there_may_be_no_bandwidth_or_no_limit_to_it(loop):
    assert loop("K/(s + 1)").stability("K").bandwidth_hz == float("inf")
    # Half of the limit is a loop gain of 1/2 where it is largest.
    assert np.isnan(loop("K*D/(s + 1)", T="10 s").stability("K", (0, 2)).bandwidth_hz)
    assert np.isnan(loop("K/(s - 1)").stability("K").bandwidth_hz)
    # Half of the range, 10, times 1/2 at rest and 1 far up: never below one.
    assert loop("K*(s + 1)/(s + 2)").stability("K", (0, 20)).to_json_dict()["bandwidth"] is None


@pytest.mark.slow
def test_a_servo_with_a_timoshenko_arm_is_stable_for_every_gain_below_the_frequency_asked_for():
    # Position and velocity are fed back where the torque acts: a spring and a damper there, whatever the arm.
    arm = {
        "type": "beam",
        "theory": "timoshenko",
        "between": ["hub", "tip"],
        "rho": "2700 kg/m^3",
        "l": "0.7 m",
    }
    section = {"E": "E", "G": "E/(2*(1 + nu))", "kappa": "5/6", "I": "b*h^3/12", "A": "b*h"}
    model = symflex.Model(
        parameters={
            "E": "70 GPa",
            "nu": 0.33,
            "b": "3 cm",
            "h": "5 cm",
            "k_p": "400 N*m/rad",
            "k_d": "30 N*m*s/rad",
        },
        elements={
            "hinge": {"type": "pin", "at": "hub"},
            "rotor": {"type": "inertia", "at": "hub.theta", "J": "0.05 kg*m^2"},
            "arm": {**arm, **section},
            "load": {"type": "mass", "at": "tip", "m": "1.2 kg"},
            "servo": {
                "type": "torque_source",
                "at": "hub.theta",
                "tau": "k_p*(r - hub.theta) - k_d*s*hub.theta",
            },
        },
        inputs={"r": {"unit": "rad"}},
        outputs={"Y": "tip"},
    )
    found = model.stability("k_p", (100, 1000), up_to_hz=1000)
    assert counts(found) == [(0, 0)]
    assert abs(found.counted_up_to_hz - 1000) < 1e-9


def test_a_passive_structure_says_nothing_of_delays_in_its_output():
    # theta/(1 - 2 exp(-s T)) grows at ln(2)/T, for every gain.
    text = """
symflex = 1
parameters = { K = "1 N*m", T = "0.3 s" }
blocks.D = { type = "delay", T = "T" }
inputs.r = { unit = "rad" }
outputs.y = "phi/(1 - 2*D)"
[elements]
rod = { type = "shaft", between = ["phi", "end"], GJ = 1, rhoJ = 1, l = 1 }
motor = { type = "torque_source", at = "phi", tau = "K*(r - (1 + T*s)*phi)" }
"""
    found = symflex.loads(text).stability("K", (0, 5))
    assert not any(interval.poles.is_stable for interval in found.proved.intervals)
    assert not found.is_stable


def test_a_stiffness_that_a_gain_makes_negative_is_not_passive():
    # A shaft of GJ = l = 1 holds its end as a spring of 1 N m: with k_0 - K it is stable up to K = k_0 + 1.
    text = """
symflex = 1
parameters = { K = "1 N*m", k_0 = "3 N*m" }
inputs.T = { torque = "phi" }
outputs.y = "phi"
[elements]
rod = { type = "shaft", between = ["ground", "phi"], GJ = 1, rhoJ = 1, l = 1 }
loss = { type = "rotary_damper", between = ["phi", "ground"], b = 0.5 }
spring = { type = "torsion_spring", between = ["phi", "ground"], k = "k_0 - K" }
"""
    found = symflex.loads(text).stability("K", (0, 20)).proved
    assert [i.poles.right for i in found.intervals] == [0, 1]
    assert abs(float(found.boundaries[0].gain.mid()) - 4) < 1e-9


@pytest.mark.slow
def test_two_parallel_leaves_with_losses_are_stable():
    # What two equal leaves hide is cosh^2 + cos^2 - 2, which is 0 where s is, but no pole is there.
    leaf = {"type": "beam", "between": ["ground", "x"], "l": "60 mm", "eta": "3 us"}
    leaf |= {"EI": "2 N*m^2", "rhoA": "0.2 kg/m"}
    model = symflex.Model(
        parameters={"b": "3 N*s/m"},
        elements={
            "left": leaf,
            "right": leaf,
            "guide": {"type": "slider", "at": "x"},
            "loss": {"type": "damper", "between": ["x", "ground"], "b": "b"},
        },
        inputs={"F": {"force": "x"}},
        outputs={"X": "x"},
    )
    found = model.stability("b")
    assert counts(found) == [(0, 0)]
    assert found.is_stable is True


@pytest.mark.slow
def test_a_damper_at_a_node_of_a_high_mode_is_not_called_stable():
    # sin(50 pi x/l) vanishes at l/50, where the damper is: this mode, at 2500 Hz, is undamped and seen.
    string = {"type": "string", "N": "100 N", "rhoA": "10 g/m"}
    model = symflex.Model(
        parameters={"K": "0.3 N*s/m"},
        elements={
            "short": {**string, "between": ["ground", "p"], "l": "2 cm"},
            "long": {**string, "between": ["p", "q"], "l": "98 cm"},
            "loss": {"type": "damper", "between": ["p", "ground"], "b": "K"},
        },
        inputs={"Z": {"displacement": "q"}},
        outputs={"R": "Z.f"},
    )
    found = model.stability("K")
    assert found.is_stable is None
    assert found.to_json_dict()["verdict"]["right_half_plane"] == 0


@pytest.mark.slow
def test_a_voice_coil_on_a_leaf_spring_is_searched_from_where_balls_know_its_values():
    # Far below its first mode a leaf is a spring of 12 E I/l^3, and the loop a polynomial in s.
    mass, stiff = 0.4, 12 * 110e9 * 2.5e-11 / 0.06**3
    stage = np.polymul([mass, 8**2 / 4, stiff], np.polymul([1e-3, 1], [1, 0]))
    for gain in (100, 900):
        pid = np.polyadd(np.polymul([1e-3, 1], [gain, 2000]), [12, 0, 0])
        assert max(np.roots(np.polyadd(stage, 8 / 4 * pid)).real) < 0
    found = symflex.loads("""
symflex = 1
parameters.kp = "300 V/m"
blocks.C = { type = "pid", k_p = "kp", k_i = "2000 V/m/s", k_d = "12 V*s/m", T_f = "1 ms" }
inputs.r = { unit = "m" }
outputs.X = "st"
[elements]
leaf = { type = "beam", between = ["ground", "st"], EI = 2.75, rhoA = 0.246, l = "60 mm", eta = "3 us" }
hold = { type = "slider", at = "st" }
stage = { type = "mass", at = "st", m = "400 g" }
coil = { type = "voice_coil", terminals = ["u", "ground"], mover = "st", k_f = "8 N/A", R = "4 Ohm" }
supply = { type = "voltage_source", at = "u", v = "C*(r - st)" }
""").stability("kp", (100, 900))
    assert found.certified
    assert counts(found) == [(0, 0)]


@pytest.mark.slow
def test_where_wavenumbers_meet_in_the_right_half_plane_a_tensioned_beam_has_no_pole():
    # They meet at s = N/(2 sqrt(rho A E I (1 + eta s))), 11.5 rad/s, where the formula is 0/0. The loop of
    # c/K > tau is passive at K = 50; from where Im K(j omega) = 0 on, two poles are on the right.
    model = symflex.loads("""symflex = 1
parameters = { K = 50 }
[elements.arm]
type = "beam"
between = ["ground", "tip"]
eta = 1e-4
E = 7e10
I = 1e-9
A = 1e-4
rho = 2700
l = 0.5
N = 100
[elements.drive]
type = "force_source"
at = "tip"
f = "u"
[signals]
u = "-(K + 2*s)/(0.001*s + 1)*tip"
[inputs]
F = { force = "tip" }
[outputs]
X = "tip"
""")

    def gain(omega):
        s = mpmath.mpc(0, omega)
        bending = 70 * (1 + s / 10**4)
        roots = mpmath.polyroots([bending, 0, -100, 0, 0.27 * s**2], extraprec=200)
        tip = [mpmath.exp(r / 2) for r in roots]
        ends = [[r**2 * e for r, e in zip(roots, tip, strict=True)]]  # no moment, and a unit force
        ends += [[(100 * r - bending * r**3) * e for r, e in zip(roots, tip, strict=True)]]
        shares = mpmath.lu_solve(mpmath.matrix([[1] * 4, roots, *ends]), mpmath.matrix([0, 0, 0, 1]))
        return -(1 + s / 1000) / mpmath.fdot(tip, shares) - 2 * s

    omega = mpmath.findroot(lambda w: gain(w).imag, 346)
    found = model.stability("K")
    assert counts(found) == [(0, 0), (2, 0)]
    (boundary,) = found.proved.boundaries
    assert float(boundary.gain.mid()) == pytest.approx(float(gain(omega).real), rel=1e-9)

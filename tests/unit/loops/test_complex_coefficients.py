"""Stable values of models with complex coefficients: rotors in x + jy and machines in d + jq."""

from itertools import pairwise
from math import pi, sqrt

import mpmath
import pytest

import symflex

# Jeffcott's rotor with damping from outside and from inside is stable up to the speed w (1 + c_e/c_i) with
# w^2 = k/m, where it whirls with w (Kimball 1924); in axes that turn with it, with w less the speed.
ROTOR = {"m": "10 kg", "k": "1 MN/m", "c_e": "400 N*s/m", "c_i": "150 N*s/m"}
NATURAL = sqrt(1e6 / 10)
ONSET = NATURAL * (1 + 400 / 150)
WRITTEN = (
    ("m*s^2*z + c_e*s*z + c_i*(s - j*W)*z + k*z = F", NATURAL),
    ("k*z = F + j*c_i*W*z - s*(c_i + c_e)*z - s^2*m*z", NATURAL),
    ("m*s^2*z + (c_i + c_e)*s*z + c_i*W*z/j + k*z = F", NATURAL),
    ("m*z'' + c_e*z' + c_i*(z' - j*W*z) + k*z = F", NATURAL),
    ("m*(s + j*W)^2*z + c_e*(s + W*j)*z + c_i*s*z + k*z = F", NATURAL - ONSET),
    ("m*(s^2 - 2*W*s/j - W^2)*z + c_e*s*z + c_e*j*W*z + c_i*s*z + k*z = F", NATURAL - ONSET),
)
# A current loop with a delay in axes that turn with omega.
CURRENT = """symflex = 1
parameters = { L = "2 mH", R = "0.5 Ohm", omega = "2000 rad/s", T = "150 us", K = "4 V/A", T_n = "4 ms" }
inputs = { w = { unit = "A" } }
outputs = { I = "i" }
[signals]
u = "K*(1 + 1/(T_n*s))*exp(-s*T)*(w - i)"
i = "u/(L*s + R + j*omega*L)"
"""


def rotor(equation: str, **speed: object) -> symflex.Model:
    return symflex.Model(
        parameters=ROTOR | {"W": speed or "300 rad/s"},
        equations={"unknowns": ["z"], "equations": [equation]},
        inputs={"F": {"unit": "N"}},
        outputs={"Z": "z"},
    )


def ends(found: symflex.Stability) -> list[tuple[float, list[float], int]]:
    """Return each boundary with the frequencies [rad/s] there, and how many poles enter."""
    return [(float(b.gain), [2 * pi * f for f in b.frequencies_hz], b.entering) for b in found.boundaries]


@pytest.mark.parametrize(("equation", "frequency"), WRITTEN)
def test_a_rotor_with_damping_inside_is_stable_up_to_the_onset(equation, frequency):
    found = rotor(equation).stability(over="W", limits=(0, 2000))
    ((speed, frequencies, entering),) = ends(found)
    assert found.certified
    assert found.is_stable
    assert speed == pytest.approx(ONSET, rel=1e-13)
    assert frequencies == [pytest.approx(frequency, rel=1e-12)]
    assert entering == 1
    assert ends(rotor(equation).stability("W", (0, 2000)))[0][0] == pytest.approx(ONSET, rel=1e-13)


def test_a_rotor_without_damping_has_its_own_poles_on_the_axis_and_no_images():
    # Seen from axes that turn, (s + j W)^2 = -k/m: two poles on the axis at every speed.
    found = rotor("m*(s + j*W)^2*z + k*z = F").stability(over="W", limits=(1, 300))
    assert found.certified
    assert [(i.poles.right, i.poles.axis) for i in found.proved.intervals] == [(0, 2)]


def test_a_rotor_that_turns_the_other_way_whirls_backwards():
    model = rotor(WRITTEN[0][0], value="-300 rad/s", assume="real")
    backwards, forwards = ends(model.stability(over="W", limits=(-2000, 2000)))
    assert (backwards[0], forwards[0]) == pytest.approx((-ONSET, ONSET))
    assert (*backwards[1], *forwards[1]) == pytest.approx((-NATURAL, NATURAL))
    assert (backwards[2], forwards[2]) == (-1, 1)


def current(s, K=4, T=150e-6, omega=2000):
    """Return the characteristic function, with s times it so that it is entire."""
    return s * (2e-3 * s + 0.5 + 1j * omega * 2e-3) + K * (s + 250) * mpmath.exp(-s * T)


@pytest.mark.parametrize(
    ("name", "limits", "guess"),
    [("omega", (0, 20000), (9200, -11100)), ("K", (10, 20), (17, -10500)), ("T", (0, 1e-3), (4e-4, -4000))],
)
def test_a_delayed_loop_in_turning_axes_meets_the_axis_at_negative_frequencies(name, limits, guess):
    found = symflex.loads(CURRENT).stability(over=name, limits=limits)

    def both(value, omega):
        at = current(mpmath.mpc(0, omega), **{name: value})
        return [at.real, at.imag]

    value, omega = map(float, mpmath.findroot(both, guess))
    assert found.certified
    assert ends(found) == [(pytest.approx(value, rel=1e-9), [pytest.approx(omega, rel=1e-9)], 1)]


def test_a_chart_counts_poles_of_the_model_alone():
    model = rotor(WRITTEN[0][0])
    chart = model.stability(over=("W", "c_e"), ranges={"W": (0, 3000), "c_e": (0, 1000)})
    assert chart.at(NATURAL * (1 + 200 / 150) - 50, 200) == "stable"
    assert chart.at(NATURAL * (1 + 200 / 150) + 50, 200) == "unstable by 1"


SHAFT = """symflex = 1
parameters = {{ c = 1, c_i = {c_i}, W = 3 }}
inputs = {{ M = {{}} }}
outputs = {{ Y = "w'({at})" }}
[fields.w]
domain = ["0", "1"]
equation = "{equation} + s^2*w = 0"
conditions = ["w(0) = 0", {ends}]
"""
VISCOUS = {"c_i": 2, "at": 1, "ends": '"w\'\'(0) = 0", "w(1) = 0", "w\'\'(1) = M"'}


@pytest.mark.parametrize("equation", ["w'''' + c*s*w + c_i*(s - j*W)*w", "s*c*w + c_i*(s + W/j)*w + w''''"])
def test_a_shaft_with_viscous_damping_inside_whirls_as_its_first_mode_does(equation):
    # s^2 + c s + c_i (s - j W) + pi^4 = 0 has a root j w where w = pi^2 and c w + c_i (w - W) = 0.
    model = symflex.loads(SHAFT.format(equation=equation, **VISCOUS))
    found = model.stability(over="W", limits=(14, 15), up_to_hz=2)
    assert not found.certified
    assert ends(found) == [(pytest.approx(1.5 * pi**2, rel=1e-13), [pytest.approx(pi**2, rel=1e-13)], 1)]
    assert [(i.poles.right, i.poles.axis) for i in found.proved.intervals] == [(0, 0), (1, 0)]
    turned = symflex.loads(SHAFT.format(equation=equation.replace("j", "(-j)"), **VISCOUS))
    found = turned.stability(over="W", limits=(14, 15), up_to_hz=2)
    assert ends(found) == [(pytest.approx(1.5 * pi**2, rel=1e-13), [pytest.approx(-(pi**2), rel=1e-13)], 1)]


@pytest.mark.parametrize("sign", ["", "-"])
def test_all_poles_of_a_string_with_damping_inside_are_counted(sign):
    # The same of -w'' with pi^2 in place of pi^4; all others whirl later.
    equation = f"-w'' + c*s*w + c_i*(s - {sign}j*W)*w".replace("--", "+")
    model = symflex.loads(SHAFT.format(c_i=2, at=1, ends='"w(1) = M"', equation=equation))
    found = model.stability(over="W", limits=(4.6, 4.8))
    omega = -pi if sign else pi
    assert found.certified and found.proved.is_complete
    assert ends(found) == [(pytest.approx(1.5 * pi, rel=1e-13), [pytest.approx(omega, rel=1e-13)], 1)]


@pytest.mark.slow
def test_all_poles_of_a_shaft_with_material_damping_are_counted():
    # s^2 + c s + pi^4 (1 + c_i (s - j W)) = 0 where w = pi^2 and c w + c_i pi^4 (w - W) = 0.
    ends_of = VISCOUS["ends"].replace("w''(1)", "(1 + c_i*(s - j*W))*w''(1)")
    text = SHAFT.format(c_i=0.01, at=1, ends=ends_of, equation="(1 + c_i*(s - j*W))*w'''' + c*s*w")
    found = symflex.loads(text).stability(over="W", limits=(19, 21))
    assert found.certified
    onset = pi**2 + 1 / (0.01 * pi**2)
    assert ends(found) == [(pytest.approx(onset, rel=1e-13), [pytest.approx(pi**2, rel=1e-13)], 1)]


@pytest.mark.slow
def test_poles_of_a_disc_on_a_shaft_stay_on_the_axis_at_every_speed():
    # EI = rhoA = l = 1 with m = J_d = 1, J_p = 2: F(w) is real, and changes its sign twice below 4 rad/s.
    text = SHAFT.format(
        c_i=1,
        at=1,
        equation="w''''",
        ends="\"w'(0) = 0\", \"w''(1) = -(s^2 - 2*j*W*s)*w'(1)\", \"w'''(1) = s^2*w(1) - M\"",
    )

    def disc(omega, speed):
        x = mpmath.sqrt(abs(omega))
        c, s, ch, sh = mpmath.cos(x), mpmath.sin(x), mpmath.cosh(x), mpmath.sinh(x)
        rows = [  # w = cosh - cos and sinh - sin, of k x
            [x**2 * (ch + c), x**2 * (sh + s), x * (sh + s), x * (ch - c)],
            [x**3 * (sh - s), x**3 * (ch + c), ch - c, sh - s],
        ]
        turn = omega**2 - 2 * speed * omega
        one, two = ([row[i] for i in (0, 1)] for row in rows)
        bend = [one[i] - turn * rows[0][2 + i] for i in (0, 1)]
        shear = [two[i] + omega**2 * rows[1][2 + i] for i in (0, 1)]
        return bend[0] * shear[1] - bend[1] * shear[0]

    signs = [mpmath.sign(disc(mpmath.mpf(k) / 50 + 0.003, 3)) for k in range(-200, 200)]
    changes = sum(a != b for a, b in pairwise(signs))
    found = symflex.loads(text).stability(over="W", limits=(2.99, 3.01), up_to_hz=4 / (2 * pi), digits=8)
    assert [(i.poles.right, i.poles.axis) for i in found.proved.intervals] == [(0, changes)]


@pytest.mark.slow
def test_a_column_seen_from_turning_axes_flutters_at_becks_load():
    # s + j W in place of s: pairs meet at 20.0509... at -W +- 11.0155... (Beck 1952).
    clamped = "\"w'(0) = 0\", \"w''(1) = 0\", \"w'''(1) = -M\""
    text = SHAFT.format(c_i=10, at=1, ends=clamped, equation="w'''' + c_i*w'' + 2*j*W*s*w - W^2*w")
    found = symflex.loads(text).stability(over="c_i", limits=(20, 20.1), up_to_hz=3, digits=10)
    ((load, frequencies, entering),) = ends(found)
    assert load == pytest.approx(20.0509536189737, rel=1e-10)
    assert frequencies == pytest.approx([-3 - 11.0155576409229, -3 + 11.0155576409229], rel=1e-10)
    assert entering == 2


def test_a_string_that_moves_stays_on_the_axis_in_turning_axes():
    # s = -j W + j n pi (1 - v^2), which lie at -4.86, 0.86, 3.72 and 6.58 rad/s up to 7.5.
    equation = "-(1 - c^2)*w'' + 2*c*(s + j*W)*w' + 2*j*W*s*w - W^2*w"
    text = SHAFT.format(c_i=1, at=1, ends='"w(1) = M"', equation=equation).replace("c = 1", "c = 0.3")
    found = symflex.loads(text).stability(over="W", limits=(2, 2.1), up_to_hz=1.2, digits=8)
    assert [(i.poles.right, i.poles.axis) for i in found.proved.intervals] == [(0, 4)]


def test_a_chart_of_waves_with_complex_coefficients_has_the_onset_of_its_first_mode():
    # Unstable where W > pi^2 (1 + c/c_i), by one pole.
    model = symflex.loads(SHAFT.format(equation="w'''' + c*s*w + c_i*(s - j*W)*w", **VISCOUS))
    ranges = {"W": (14, 16), "c": (0.9, 1.1)}
    chart = model.stability(over=("W", "c"), ranges=ranges, up_to_hz=2, resolve=0.6)
    assert sorted(region.verdict.right for region in chart.regions) == [0, 1]
    for part in (part for part in chart.boxes if part.region >= 0):
        right, (speeds, losses) = chart.regions[part.region].verdict.right, part.box
        corners = {float(w) > pi**2 * (1 + float(c) / 2) for w in speeds for c in losses}
        assert corners == {bool(right)}


def test_a_pole_that_passes_0_is_at_0_once():
    # With damping inside alone, seen from the shaft: m (s + j W)^2 + c_i s + k is 0 at s = 0 where W^2 = k/m.
    found = rotor("m*(s + j*W)^2*z + c_i*s*z + k*z = F").stability(over="W", limits=(0, 1000))
    assert ends(found) == [(pytest.approx(NATURAL, rel=1e-13), [0.0], 1)]


def beside(equation: str) -> symflex.Model:
    """Return a damped body beside another unknown, which no transfer function sees."""
    return symflex.Model(
        parameters=ROTOR | {"W": "300 rad/s"},
        equations={"unknowns": ["z", "y"], "equations": [equation, "c_e*s*z + k*z = F"]},
        inputs={"F": {"unit": "N"}},
        outputs={"Z": "z"},
    )


def test_a_hidden_rotor_meets_the_axis_on_its_own_side():
    found = beside("m*s^2*y + c_i*(s + j*W)*y + k*y = 0").stability(over="W", limits=(0, 1000))
    assert found.certified and found.is_stable
    assert ends(found) == [(pytest.approx(NATURAL, rel=1e-13), [pytest.approx(-NATURAL, rel=1e-13)], 1)]


def test_a_pole_that_no_gain_moves_keeps_a_model_with_complex_coefficients_unstable():
    # i has the pole -(R + K) - j omega; v adds 1, which K does not move, to what i shows.
    text = CURRENT.replace('u = "K*(1 + 1/(T_n*s))*exp(-s*T)*(w - i)"', 'u = "K*(w - i)"')
    text = text.replace('I = "i"', 'I = "i", V = "v"') + 'v = "i/(s - 1)"\n'
    found = symflex.loads(text).stability("K")
    assert found.proved.apart.verdict.word == "unstable" and not found.is_stable
    assert [(i.poles.right, i.poles.axis) for i in found.proved.intervals] == [(1, 0)]

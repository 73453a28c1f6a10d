"""Responses with delays and with waves that keep their form are exact, piecewise."""

from fractions import Fraction
from itertools import product
from math import comb, cos, exp, factorial, pi, sin, sqrt

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import lambertw

from symflex import loads
from symflex.analysis.time_response import SampleTimes, time_response
from symflex.errors import UncertifiedError
from tests.unit.analysis.time_response.references import of_quotient

DELAY = (
    'parameters = { a = "1 1/s", w = "2 1/s" }\nblocks.D = { type = "delay", T = "1 s" }\n'
    "inputs.u = {}\noutputs.y = "
)


def bound(text, output="y", input="u"):
    return loads(f"symflex = 1\n{text}").transfer_function(output, input).bind().bound


def rod(rest="", ends='["ground", "x"]', kind="rod"):
    """A rod of impedance 2 N s/m in which waves take 1/2 s from end to end."""
    material = 'E = "4 Pa", A = "1 m^2"' if kind == "rod" else 'N = "4 N", A = "1 m^2"'
    return bound(
        f'elements.bar = {{ type = "{kind}", between = {ends}, {material}, rho = "1 kg/m^3", l = "1 m" }}\n'
        f'inputs.F = {{ force = "x" }}\noutputs.X = "x"\n{rest}',
        "X",
        "F",
    )


def after(t, delay):
    return np.maximum(t - delay, 0)


TIMES = np.linspace(0, 7.3, 75)
STEPS = {
    "a delay": (lambda: bound(f'{DELAY}"D*u"'), (TIMES >= 1.0).astype(float)),
    "a lag after a delay": (lambda: bound(f'{DELAY}"D*u/(s + a)"'), 1 - np.exp(-after(TIMES, 1))),
    # 1/(s + e^-s) = sum (-1)^k e^(-sk)/s^(k+1)
    "a loop around a delay": (
        lambda: bound(f'{DELAY}"u/(s + a*D)"'),
        sum((-1) ** k * after(TIMES, k) ** (k + 1) / factorial(k + 1) for k in range(8)),
    ),
    "an unstable loop around a delay": (
        lambda: bound(f'{DELAY}"u/(s + 3*a*D)"'),
        sum((-3) ** k * after(TIMES, k) ** (k + 1) / factorial(k + 1) for k in range(8)),
    ),
    "a neutral loop": (  # 1/(1 + e^-s/2) = sum (-1/2)^k e^(-sk)
        lambda: bound(f'{DELAY}"u/(1 + D/2)"'),
        sum((-0.5) ** k * (TIMES >= k) for k in range(8)),
    ),
    "two delays that have no common measure": (
        lambda: bound(
            'blocks.D = { type = "delay", T = "1 s" }\nblocks.G = { type = "delay", T = "1.37 s" }\n'
            'inputs.u = {}\noutputs.y = "u/(1 - D/2 - G/3)"'
        ),
        sum(
            comb(i + k, i) * 0.5**i * 3.0**-k * (TIMES >= i + 1.37 * k)
            for i, k in product(range(8), range(8))
        ),
    ),
    # X/F = tanh(s/2)/(2 s): images change sign at the clamp
    "a rod that is clamped": (rod, TIMES / 2 + sum((-1) ** k * after(TIMES, k) for k in range(1, 8))),
    "a string that is clamped": (
        lambda: rod(kind="string"),
        TIMES / 2 + sum((-1) ** k * after(TIMES, k) for k in range(1, 8)),
    ),
    "a rod that is free": (
        lambda: rod(ends='["x", "end"]'),
        TIMES / 2 + sum(after(TIMES, k) for k in range(1, 8)),
    ),
    # a damper of the rod's impedance: X/F = (1 - e^-s)/(4 s), nothing comes back a second time
    "a rod with a matched damper": (
        lambda: rod('elements.d = { type = "damper", between = ["ground", "x"], b = "2 N*s/m" }'),
        (TIMES - after(TIMES, 1)) / 4,
    ),
}


def test_a_step_response_is_that_of_the_images():
    for name, (function, expected) in STEPS.items():
        found = time_response(function(), "step", SampleTimes.of(TIMES))
        largest = np.max(np.abs(expected))
        assert found.certified, name
        assert np.max(np.abs(found.values - expected)) < 1e-13 * largest, name
        assert np.max(found.radius) <= 1e-11 * largest, name


@pytest.mark.parametrize("kind", ["impulse", "step"])
def test_a_rod_with_a_mass_is_what_its_first_echoes_give(kind):
    # 1/(m s^2 + Z s coth(s/2)) with m = 1, Z = 2 is (1 - w)/((s^2 + 2 s) + w (2 s - s^2)), w = e^-s
    function = rod('elements.m = { type = "mass", at = "x", m = "1 kg" }')
    u = {"impulse": 0, "step": 1}[kind]
    times = [0.2, 0.7, 1.4, 1.9]
    found = time_response(function, kind, SampleTimes.of(times))
    first = of_quotient([1], [1, 2, 0], u, times)
    # coefficient of w: (-1 (s^2 + 2s) - (2s - s^2))/(s^2 + 2s)^2 = -4s/(s^2 + 2s)^2
    echo = of_quotient([-4, 0], [1, 4, 4, 0, 0], u, [t - 1 if t > 1 else 0.0 for t in times])
    expected = np.array([float(a + (b if t > 1 else 0)) for a, b, t in zip(first, echo, times, strict=True)])
    assert np.max(np.abs(found.values - expected)) <= 1e-15


def test_the_impulse_response_of_a_rod_has_fronts_and_two_values_there():
    found = time_response(rod(), "impulse", SampleTimes.evenly(Fraction(3), 4))
    assert [(float(j.time), float(j.height)) for j in found.jumps] == [(1.0, -1.0), (2.0, 1.0), (3.0, -1.0)]
    assert found.values.tolist() == pytest.approx([0.5, 0.0, 0.0, 0.0])
    assert found.radius.tolist() == pytest.approx([0.0, 0.5, 0.5, 0.5])  # between 1/2 and -1/2


def test_an_impulse_through_a_delay_is_an_impulse_later():
    found = time_response(bound(f'{DELAY}"D*u*(s + w)/(s + a)"'), "impulse", SampleTimes.of([0.5, 2.0]))
    assert [(float(i.time), i.order, float(i.weight)) for i in found.impulses] == [(1.0, 0, 1.0)]
    assert found.values.tolist() == pytest.approx([0.0, np.exp(-1)])


def test_what_decays_on_its_way_arrives_weaker():
    # w' + (s + k) w/v = 0: exp(-k T) of what enters arrives after T = l/v = 2 s, in a loop again and again.
    field = (
        'parameters = { v = "2 m/s", l = "4 m", k = "0.1 1/s" }\ninputs.u = {}\noutputs.y = "w(l)"\n'
        '[fields.w]\ndomain = ["0", "l"]\nequations = ["w\' + (s + k)*w/v = 0"]\n'
        'conditions = ["w(0) = ENTERING"]\n'
    )
    share, times = exp(-0.2), SampleTimes.of([1.0, 3.0, 5.0, 7.0])
    for entering, expected in (
        ("u", [0, share, share, share]),
        ("u + w(l)/2", [0, *np.cumsum([share, share**2 / 2, share**3 / 4])]),
    ):
        found = time_response(bound(field.replace("ENTERING", entering)), "step", times)
        assert found.certified
        assert np.allclose(found.values, expected, rtol=1e-12, atol=0)


@pytest.mark.slow
def test_what_decays_behind_waves_that_change_shape_arrives_weaker_too():
    field = (
        '[fields.w]\ndomain = ["0", "d"]\nequations = ["w\' + (s + k)*w/v = 0"]\nconditions = ["w(0) = x"]\n'
    )
    text = (
        'parameters = { v = "2 m/s", d = "4 m", k = "0.1 1/s" }\n'
        'elements.b = { type = "rod", between = ["ground", "x"], EA = "4 N", rhoA = "1 kg/m", l = "1 m", '
        'eta = "0.1 s" }\ninputs.F = { force = "x" }\noutputs = { X = "x", Y = "w(d)" }\n'
    )
    early = time_response(bound(text + field, "X", "F"), "step", SampleTimes.of([0.5, 1.5]), 6)
    late = time_response(bound(text + field, "Y", "F"), "step", SampleTimes.of([2.5, 3.5]), 6)
    assert np.allclose(late.values, np.exp(-0.2) * np.array(early.values), rtol=1e-6, atol=0)


def test_a_front_whose_time_is_irrational_is_between_samples():
    stiff = bound(
        'elements.bar = { type = "rod", between = ["ground", "x"], E = "2 Pa", A = "1 m^2", '
        'rho = "1 kg/m^3", l = "1 m" }\ninputs.F = { force = "x" }\noutputs.V = "s*x"',
        "V",
        "F",
    )
    found = time_response(stiff, "step", SampleTimes.of([1.414213562373095, 1.4142135623730951]))
    assert float(found.jumps[0].time) == pytest.approx(sqrt(2), rel=1e-15)
    assert found.values.tolist() == pytest.approx([1 / sqrt(2), -1 / sqrt(2)])  # sqrt(2) lies between


def test_what_comes_before_its_input_is_refused():
    with pytest.raises(UncertifiedError, match="SF810"):
        time_response(bound(f'{DELAY}"u/D"'), "step", SampleTimes.of([1.0]))


@pytest.mark.slow
def test_a_rod_with_more_echoes_than_can_be_followed_is_a_sum_of_modes():
    mass = 'elements.m = { type = "mass", at = "x", m = "1 kg" }'
    found = time_response(rod(mass), "step", SampleTimes.of([400.0, 500.5]), 6)
    assert found.certified
    # Modes of a rod of 1 kg and 4 N with 1 kg at its end: q tan q = 1, omega = 2 q.
    expected = np.zeros(2)
    for k in range(4000):
        low, high = k * pi, k * pi + pi / 2
        q = brentq(lambda q: q * sin(q) - cos(q), low, high)
        omega, share = 2 * q, (1 - sin(2 * q) / (2 * q)) / 2 + sin(q) ** 2
        expected += sin(q) ** 2 / (share * omega**2) * (1 - np.cos(omega * np.array([400.0, 500.5])))
    assert np.all(np.abs(found.values - expected) <= found.radius + 1e-12)
    assert found.radius.max() < 1e-5 * max(expected)


def test_even_and_single_times_agree():
    function = bound(f'{DELAY}"u/(s^2 + a*s/5 + w^2 + w*a*D)"')
    even = time_response(function, "step", SampleTimes.of(TIMES))
    single = time_response(function, "step", SampleTimes.of(TIMES).one_by_one())
    assert np.all(np.abs(even.values - single.values) <= even.radius + single.radius)


SPEED_LOOP = """
symflex = 1
parameters = { J = "1.2e-3 kg*m^2", b = "2e-3 N*m*s", k_p = "0.35 N*m*s", T_i = "60 ms", T_d = "0.5 ms" }
inputs.r = { unit = "rad/s" }
outputs.w = "s*phi"
[blocks]
D = { type = "delay", T = "T_d" }
C = { type = "pid", k_p = "k_p", k_i = "k_p/T_i" }
[elements]
rotor = { type = "inertia", at = "phi", J = "J" }
friction = { type = "rotary_damper", between = ["phi", "ground"], b = "b" }
drive = { type = "torque_source", at = "phi", tau = "C*D*(r - s*phi)" }
"""


@pytest.mark.slow
def test_a_neutral_loop_of_too_many_echoes_is_estimated_by_its_modes():
    text = 'symflex = 1\nparameters = { T = "1 ms", w = "1 1/s" }\ninputs.u = {}\n'
    text += 'blocks.D = { type = "delay", T = "T" }\noutputs.y = "w^2*u/(s^2 + w*s + w^2 + s^2*D/2)"\n'
    found = loads(text).transfer_function("y", "u").bind().step_response()
    # Newton's method for s^2 + s + 1 + s^2 e^(-s T)/2 = 0: all other roots lie near Re s = -693.
    s = complex(-0.33, 0.75)
    for _ in range(30):
        late = np.exp(-0.001 * s) / 2
        slope = 2 * s + 1 + (2 * s - 0.001 * s**2) * late
        s -= (s**2 + s + 1 + s**2 * late) / slope
    t = found.times[2:]
    expected = 1 + 2 * (np.exp(s * t) / (s * slope)).real
    assert not found.certified
    assert np.all(np.abs(found.values[2:] - expected) <= found.radius[2:] + 1e-12)
    assert found.radius[2:].max() < 1e-9


@pytest.mark.slow
def test_where_nobody_says_how_long_a_slow_loop_is_followed_until_it_has_settled():
    text = 'symflex = 1\nparameters.T = "1 ms"\nblocks.D = { type = "delay", T = "T" }\ninputs.r = {}\n'
    text += 'signals = { y = "u/(s*(s + 1))", u = "D*(r - y)/(1 + 0.03*s)" }\noutputs.y = "y"\n'
    found = loads(text).transfer_function("y", "r").bind().step_response()
    # Where s e^(s T) (s + 1)(1 + 0.03 s) = -1, by Newton's method: the pair of the loop, -0.47 +- 0.88j.
    s = complex(-0.5, 0.87)
    for _ in range(30):
        late = np.exp(-0.001 * s)
        slope = 0.09 * s**2 + 2.06 * s + 1 - 0.001 * late
        s -= (s * (s + 1) * (1 + 0.03 * s) + late) / slope
    assert found.times[-1] == pytest.approx(-5 / s.real, rel=0.01)
    t = found.times[-20:]
    assert found.values[-20:] == pytest.approx(1 + 2 * (late / (slope * s) * np.exp(s * t)).real, abs=1e-9)


@pytest.mark.parametrize(
    ("gain", "law", "kind"), [(1.2, "a*(u - D*x)", "step"), (1.7, "x", "ramp")], ids=["through", "unstable"]
)
@pytest.mark.slow
def test_a_loop_run_through_many_times_settles_into_its_residues(gain, law, kind):
    signals = 'signals.x = "k*(u - D*x)/s"\n'
    found = time_response(
        bound(f'parameters.k = "{gain} 1/s"\nparameters.a = "{gain}"\n'
              f'blocks.D = {{ type = "delay", T = "1 s" }}\ninputs.u = {{}}\n{signals}outputs.y = "{law}"\n'),
        kind, SampleTimes.of([0.4, 7.3, 55.0, 80.5, 300.0]),
    )  # fmt: skip
    # K/(s + K e^-s): s = W_n(-K) are its poles (Corless et al. 1996), K/(1 + s) its residues.
    s = np.array([complex(lambertw(-gain, n)) for n in range(-60, 60)])[:, None]
    order = 2 if kind == "ramp" else 0  # x goes through the integrator as well, and a ramp through another
    later = found.times[1:]  # before the first delay the loop is open
    expected = np.sum(gain / (s**order * (1 + s)) * np.exp(s * later), axis=0).real
    if kind == "ramp":
        expected = expected + later - (1 - gain) / gain
    assert found.certified
    assert found.values[0] == pytest.approx(
        gain * 0.4**2 / 2 if kind == "ramp" else gain, abs=found.radius[-1]
    )
    assert found.values[1:] == pytest.approx(expected, rel=1e-11, abs=1e-12)
    assert found.radius.max() <= 1e-12 * np.abs(found.values).max()


def test_a_speed_loop_with_delay_is_what_small_steps_give():
    # 0.28 s are 560 delays, whose echoes are too many; the pole of friction is next to one at 0.
    found = loads(SPEED_LOOP).transfer_function("w", "r").bind().step_response()
    info = loads(SPEED_LOOP).transfer_function("w", "r").bind().step_info()
    step, late = 1e-5, 50
    speed, integral, torques, speeds = 0.0, 0.0, [], []
    for k in range(int(0.03 / step)):
        error = 1 - speed
        torques.append(0.35 * error + 0.35 / 0.06 * integral)
        speed += step * ((torques[k - late] if k >= late else 0) - 2e-3 * speed) / 1.2e-3
        integral += step * error
        speeds.append(speed)
    assert found.certified
    assert float(info.peak.mid()) == pytest.approx(max(speeds), rel=1e-3)
    assert float(info.peak_time.mid()) == pytest.approx(step * np.argmax(speeds), rel=3e-3)
    assert np.interp(found.times[1:20], step * np.arange(1, 1 + len(speeds)), speeds) == pytest.approx(
        found.values[1:20], rel=3e-3
    )


@pytest.mark.slow
def test_a_loop_of_a_plant_that_rings_is_what_small_steps_give():
    text = (
        'parameters = { m = "2 kg", k = "20 kN/m", b = "60 N*s/m", T = "3 ms", K = "4 1/s", P = "0.6" }\n'
        'blocks.D = { type = "delay", T = "T" }\ninputs.r = {}\n'
        'signals = { f = "k*u/(m*s^2 + b*s + k)", u = "(P + K/s)*(r - D*f)" }\noutputs.y = "f"\n'
    )
    found = time_response(bound(text, input="r"), "step", SampleTimes.of([0.0, 0.3, 0.6]))
    # Heun's method with 3 ms as 300 steps of 10 us: force, its rate, and the integral of what it lacks.
    h, late = 1e-5, 300
    state, past = np.zeros(3), [0.0] * (late + 1)

    def slopes(z, seen):
        force = 0.6 * (1 - seen) + 4 * z[2]
        return np.array([z[1], 1e4 * (force - z[0]) - 30 * z[1], 1 - seen])

    expected = [0.0]
    for n in range(1, 60_001):
        first = slopes(state, past[-1 - late])
        state = state + h / 2 * (first + slopes(state + h * first, past[-late]))
        past.append(state[0])
        if n % 30_000 == 0:
            expected.append(state[0])
    assert found.values == pytest.approx(expected, abs=2e-6)

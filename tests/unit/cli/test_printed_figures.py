"""Figures that stand in text without a radius: every digit is right, or the radius follows.

Truths are closed forms, evaluated with mpmath.
"""

import random
import re

import mpmath as mp
import pytest
from flint import arb

from symflex.roots import figure

NUMBER = r"-?\d+(?:\.\d+)?(?:e-?\d+)?"


def claim_of(text):
    """Return a printed number and how far the truth may be off: its radius, or half of its last digit."""
    value, _, radius = text.partition(" +- ")
    if radius:
        return mp.mpf(value), mp.mpf(radius)
    mantissa, _, exponent = value.partition("e")
    return mp.mpf(value), mp.mpf(10) ** (int(exponent or 0) - len(mantissa.partition(".")[2])) / 2


def is_right(text, truth):
    value, off = claim_of(text)
    return abs(value - truth) <= off * (1 + mp.mpf(10) ** -9)


def head(inputs, outputs, parameters=""):
    return (
        f"symflex = 1\nparameters = {{ {parameters} }}\ninputs = {{ {inputs} }}\noutputs = {{ {outputs} }}\n"
    )


def bar(c_f, k_f, *, E, rho, A):
    part = f'E = "{E} Pa", A = "{A} m^2", rho = "{rho} kg/m^3", l = "1 m"'
    part += f', c_f = "{c_f} N*s/m^2", k_f = "{k_f} N/m^2"'
    text = head('F = { force = "x" }', 'X = "x", V = "s*x"')
    return f'{text}[elements]\nbar = {{ type = "rod", between = ["ground", "x"], {part} }}\n'


# Bars whose c_f and k_f are critical, (s + 2)^2: the first wave lasts until the echo at 2 s.
RELAXING = bar(4, 4, E=1, rho=1, A=1)
WET = bar(500, 0, E=70e9, rho=2700, A=1e-4)
END = mp.tanh(2) / 2
REACHED = {share: -mp.log(1 - 2 * share * END) / 2 for share in (0.1, 0.9, 0.98)}
PEAK = (1 - mp.exp(-4)) / 2
FRONT, LATE = -2 / (mp.sqrt(70e9 * 2700) * mp.mpf("1e-4")), 2 * mp.sqrt(mp.mpf(2700) / 70e9)
DAMPED = mp.exp(-mp.mpf(500) / (2 * 2700 * mp.mpf("1e-4")) * LATE)

INTEGRATOR = (
    head("r = {}", 'Y = "y"', 'K = "3 1/s", T = "0.5 s"') + 'signals = { y = "K/s*exp(-s*T)*(r - y)" }\n'
)
CANCELLED = (
    head("r = {}", 'Y = "y"', "K = 5") + 'signals = { y = "K*(s + 2)/((s + 2)*(s^2 + 0.2*s + 9))*(r - y)" }\n'
)
RINGING = mp.sqrt(14 - mp.mpf("0.01"))
LIGHT = head("u = {}", 'Y = "u/(s^2 + a*s + 16)"', 'a = "1e-13 1/s"')
CLUSTER = head("u = {}", 'Y = "u/((s + 1)*(s + 1.0000000001))"')
CUBIC = head("r = {}", 'Y = "y"', "K = 2") + 'signals = { y = "K/(s*(s + 1)*(s + 2))*(r - y)" }\n'
CROSSING = mp.sqrt(mp.findroot(lambda x: x * (x + 1) * (x + 4) - 4, 0.5))  # |L(j w)| = 1, x = w^2
PHASE = 90 - mp.degrees(mp.atan(CROSSING) + mp.atan(CROSSING / 2))
OSCILLATOR = head('F = { force = "x" }', 'X = "x"', 'm = "2 kg", b = "4 N*s/m", k = "800 N/m"') + (
    '[elements]\nload = { type = "mass", at = "x", m = "m" }\n'
    'rail = { type = "damper", between = ["ground", "x"], b = "b" }\n'
    'spring = { type = "spring", between = ["ground", "x"], k = "k" }\n'
)
HALF_PERIOD = mp.pi / mp.sqrt(399)
K = mp.exp(-HALF_PERIOD)
# y(s) = 1/(s (s + 1 + 2 e^(-2 s))): poles are -1 + W_k(-4 e^2)/2, and those that grow are far ahead at 600 s.
POLE = -1 + mp.lambertw(-4 * mp.e**2) / 2
GROWN = 2 * (mp.exp(600 * POLE) / (POLE * (1 - 4 * mp.exp(-2 * POLE)))).real
UNSTABLE = (
    head("r = {}", 'Y = "y"', 'K = 2, T = "2 s"')
    + 'signals = { y = "(s + 2)/((s + 1)*(s + 2))*(r - K*exp(-s*T)*y)" }\n'
)
LONG = ("relaxing bar", "gains of an integrator with a delay")
STEP = ("respond", "--points", "2")
CASES = {
    "relaxing bar": (
        RELAXING,
        (*STEP, "--until", "1s"),
        {
            "final value +(.*) m": END,
            "peak  +(.*) m": PEAK,
            "peak time +(.*) s": 2,
            "overshoot +(.*) %": 100 * (PEAK / END - 1),
            "rise time, 10 % to 90 % +(.*) s": REACHED[0.9] - REACHED[0.1],
            "settling time, to 2 % +(.*) s": REACHED[0.98],
        },
    ),
    "fronts": (
        WET,
        (*STEP, "--tf", "V/F", "--until", "0.5ms"),
        {"jumps by (.*) at": FRONT * DAMPED, "jumps by .* at (.*) s": LATE},
    ),
    "integrator with a delay": (
        INTEGRATOR,
        (*STEP, "--until", "1s"),
        {"peak time +(.*) s": mp.mpf(4) / 3, "rise time, 10 % to 90 % +(.*) s": mp.mpf("0.8") / 3},
    ),
    "gains of an integrator with a delay": (
        INTEGRATOR,
        ("stability", "--gain", "K"),
        {f"^ +({NUMBER}) +\\S+ +\\S+ +0.5": mp.pi, f"gain +x ({NUMBER})": mp.pi / 3},
    ),
    "hidden cancellation": (
        CANCELLED,
        (*STEP, "--until", "1s"),
        {
            "final value +(.*)": mp.mpf(5) / 14,
            "peak time +(.*) s": mp.pi / RINGING,
            "overshoot +(.*) %": 100 * mp.exp(-mp.pi / 10 / RINGING),
        },
    ),
    "light damping": (
        LIGHT,
        ("roots",),
        {f"[+]-.* (\\S+) +{NUMBER}$": 2 / mp.pi, f"[+]-.* ({NUMBER})$": mp.mpf("1e-13") / 8},
    ),
    "poles that lie together": (
        CLUSTER,
        ("roots", "--digits", "3"),
        {f"{NUMBER} +({NUMBER}) +1$": 1 / (2 * mp.pi)},
    ),
    "margins": (
        CUBIC,
        ("stability", "--gain", "K"),
        {
            "gain +x (\\S+)": 3,
            "gain .* (\\S+) dB": 20 * mp.log10(3),
            "gain .* (\\S+) Hz": mp.sqrt(2) / (2 * mp.pi),
            "phase +(\\S+) deg": PHASE,
            "phase .* (\\S+) Hz": CROSSING / (2 * mp.pi),
        },
    ),
    "sensitivity": (
        OSCILLATOR,
        ("roots", "--sensitivity", "k"),
        {"k +(\\S+) +\\S+$": mp.mpf("0.5"), "k +\\S+ +(\\S+)$": mp.mpf("-0.025")},
    ),
    "shaper": (
        OSCILLATOR,
        ("shape",),
        {
            "mode at (\\S+) Hz": 10 / mp.pi,
            f"^ +(\\S+) +{NUMBER}\\s*\\Z": HALF_PERIOD,
            "zeta (\\S+):": mp.mpf("0.05"),
        },
    ),
}


@pytest.mark.parametrize("case", [pytest.param(c, marks=[pytest.mark.slow] * (c in LONG)) for c in CASES])
def test_every_figure_holds_the_truth(case, shell, tmp_path):
    text, (command, *options), truths = CASES[case]
    (tmp_path / "model.toml").write_text(text, encoding="utf-8")
    out = shell(command, "model.toml", *options).out
    found = {pattern: re.search(pattern, out, re.MULTILINE) for pattern in truths}
    assert None not in found.values(), out
    wrong = {p: m[1] for p, m in found.items() if not is_right(m[1], truths[p])}
    assert not wrong


@pytest.mark.slow
def test_a_loop_is_followed_for_three_hundred_delays_while_it_grows(shell, tmp_path):
    (tmp_path / "model.toml").write_text(UNSTABLE, encoding="utf-8")
    found = shell("respond", "model.toml", "--until", "600s", "--points", "7", "--json").json
    assert found["certified"]
    assert abs(mp.mpf(found["value"][-1]) - GROWN) <= mp.mpf(found["radius"][-1]) + 1


def test_a_figure_claims_no_less_than_its_ball():
    source = random.Random(1)
    for _ in range(500):
        middle, radius = (mp.mpf(10) ** source.uniform(-8, 8) for _ in range(2))
        digits = source.randrange(1, 12)
        ball = arb(str(source.choice((-1, 1)) * middle), str(radius * mp.mpf(10) ** -source.randrange(12)))
        for text in (figure(ball, digits), figure(ball, digits, trimmed=True)):
            value, off = claim_of(text.replace("e+", "e"))
            within = arb(str(value), str(off * (1 + mp.mpf(10) ** -12)))
            assert within.contains(ball), (ball, text)


def test_a_figure_of_a_narrow_ball_has_all_digits():
    assert [figure(arb(x), 4) for x in (0, 1, 9.9996, 5e9)] == ["0", "1.000", "10.00", "5.000e9"]


def test_a_figure_of_a_wide_ball_has_its_radius():
    assert figure(arb(1.75, 0.6), 6) == "1.75 +- 0.61"

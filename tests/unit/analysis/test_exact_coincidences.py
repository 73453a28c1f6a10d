"""What a map takes together or to infinity: zeros at 2/h, modes with a period of whole samples, and others.

Every expected output is that of a recurrence made here: rational arithmetic for the bilinear transformation,
matrix exponentials of mpmath at 60 digits for a held input.
"""

from fractions import Fraction
from math import ceil
from random import Random

import mpmath
import pytest
from numpy.polynomial import Polynomial

from symflex import loads
from symflex.codegen.difference import difference_equation
from symflex.errors import InternalError, UsageError
from tests.unit.analysis.systems import words

H = Fraction(1, 1000)
U = [Random(5).choice((1, -1)) for _ in range(40)]
PI = mpmath.mp.clone()
PI.dps = 60
W = {f: 2 * PI.pi * f for f in (250, 500, 1000)}


def discretised(text, *how, delay="", parameters=""):
    """Return y/u for y = text * u at 1 ms."""
    late = f'blocks.D = {{ type = "delay", T = "{delay}" }}' if delay else ""
    spec = f"symflex = 1\n{parameters}\n{late}\ninputs.u = {{}}\n"
    spec += f'outputs.y = "({text})*{"D*" if delay else ""}u"'
    return loads(spec).transfer_function("y", "u").bind().discretise("1 ms", *how)


def bilinear(num, den, k=2000):
    """Return the output for U, from s = k (z - 1)/(z + 1) in rational numbers; descending powers of s."""
    n = len(den) - 1
    minus, plus = Polynomial([Fraction(-k), Fraction(k)]), Polynomial([Fraction(1), Fraction(1)])

    def moved(side):
        terms = (Fraction(c) * minus**i * plus ** (n - i) for i, c in enumerate(side[::-1]))
        total = sum(terms, Polynomial([0]))
        return [*total.coef, *([Fraction(0)] * (n + 1))][n::-1]

    above, below = (list(p) for p in (moved(num), moved(den)))
    return recurrence(above, below)


def recurrence(above, below):
    y = []
    for k in range(len(U)):
        value = sum(b * U[k - i] for i, b in enumerate(above) if k >= i)
        y.append((value - sum(a * y[k - i] for i, a in enumerate(below) if 0 < i <= k)) / below[0])
    return y


def held(num, den, late=0):
    """Return the output for U held between samples, behind a delay of so many samples."""
    n = len(den) - 1
    num, den = ([PI.mpf(0)] * (n + 1 - len(num)) + [PI.mpf(c) for c in num], [PI.mpf(c) for c in den])
    whole = ceil(late)
    ahead = PI.mpf(whole) - PI.mpf(late)

    def step(share):
        matrix = PI.zeros(n + 1)
        for i in range(n):
            matrix[i, i + 1] = 1
            matrix[n - 1, i] = -den[n - i] / den[0]
        matrix[n - 1, n] = 1
        grown = PI.expm(matrix * share / 1000)
        return grown[:n, :n], grown[:n, n]

    direct = num[0] / den[0]
    seen = [(num[n - i] - direct * den[n - i]) / den[0] for i in range(n)]
    parts = [step(1 - ahead), step(ahead)]
    state, y = PI.zeros(n, 1), []
    for k in range(len(U)):
        before, after = ([0] * whole + U + [0])[k], ([0] * whole + U + [0])[k + 1]
        y.append(direct * before + sum(c * state[i] for i, c in enumerate(seen)))
        for (grown, given), u in zip(parts, (before, after), strict=True):
            state = grown * state + given * u
    return y


def agree(found, expected, within=1e-12):
    """Tell whether code in sections, in one section, and coefficients for other programs give an output."""
    largest = max(map(abs, expected))
    num, den = found.coefficients()
    same = recurrence([0.0] * (len(den) - len(num)) + num.tolist(), den.tolist())
    runs = [same, *(difference_equation(found, is_direct=is_direct).run(U) for is_direct in (True, False))]
    pairs = (pair for run in runs for pair in zip(run, expected, strict=True))
    return all(abs(a - float(b)) <= within * largest for a, b in pairs)


def test_roots_at_two_over_h_are_taken_to_infinity_and_to_zero_by_tustin():
    for text, num, den in (
        ("(2000 - s)/(2000 + s)", [-1, 2000], [1, 2000]),  # y[k] = u[k - 1]
        ("(s - 2000)/(s + 3)", [1, -2000], [1, 3]),
        ("(s - 2000)^2/(s + 3)^2", [1, -4000, 4000000], [1, 6, 9]),
        ("(2000 - s)^3/(2000 + s)^3", [-1, 6000, -12 * 10**6, 8 * 10**9], [1, 6000, 12 * 10**6, 8 * 10**9]),
        ("(s - 2000)*(s + 7)/((s + 3)*(s^2 + s + 9))", [1, -1993, -14000], [1, 4, 12, 27]),
        ("(s - 2000)/(s^2*(s + 2000))", [1, -2000], [1, 2000, 0, 0]),
        ("(s + 2000)/(s + 3)", [1, 2000], [1, 3]),
        ("s^2/(s + 2000)^2", [1, 0, 0], [1, 4000, 4000000]),
        ("(s - 2000)/((s - 2000)*(s + 1))", [1], [1, 1]),
        ("3", [3], [1]),
        ("s/(s/1000000 + 1)", [10**6, 0], [1, 10**6]),
    ):
        assert agree(discretised(text, "tustin"), bilinear(num, den)), text
    delayed = discretised("(2000 - s)/(2000 + s)", "tustin", delay="2 ms")
    assert agree(delayed, [0, 0, 0, *U[:-3]])


def test_a_pade_filter_of_one_sample_is_one_sample_of_delay():
    pade = discretised("(1 - T*s/2)/(1 + T*s/2)", "tustin", parameters='parameters.T = "1 ms"')
    made = difference_equation(pade)
    assert made.run(U) == [0.0, *U[:-1]]
    assert made.bounds_of_output() == (0.0, 1.0)
    theirs = pade.to_control()
    assert theirs.num[0][0].tolist() == [1.0]
    assert theirs.den[0][0].tolist() == [1.0, 0.0]


def test_a_zero_that_a_prewarped_tustin_takes_to_infinity_is_found_where_pi_is_in_both():
    # With f h = 1/4 the k of s = k (z - 1)/(z + 1) is 2 pi f/tan(pi/4), the zero itself: y[k] = -u[k - 1].
    prewarped = discretised("(s - w)/(s + w)", "tustin", "250 Hz", parameters='parameters.w = "250 Hz"')
    assert difference_equation(prewarped).run(U) == pytest.approx([0, *(-u for u in U[:-1])], abs=1e-15)
    with pytest.raises(UsageError, match="takes to infinity"):
        discretised("1/(s - w)", "tustin", "250 Hz", parameters='parameters.w = "250 Hz"')


def test_modes_with_a_period_of_whole_samples_are_sampled_exactly():
    for frequency, text, num, den, late in (
        (500, "1/(s^2 + w^2)", [1], [1, 0, W[500] ** 2], 0),
        (500, "1/((s + 3)^2 + w^2)", [1], [1, 6, 9 + W[500] ** 2], 0),
        (500, "1/(s^2 + w^2)", [1], [1, 0, W[500] ** 2], 2.75),
        (500, "(s^2 + w^2)/(s + w)^2", [1, 0, W[500] ** 2], [1, 2 * W[500], W[500] ** 2], 1),
        (1000, "1/((s^2 + w^2)*(s + 5))", [1], [1, 5, W[1000] ** 2, 5 * W[1000] ** 2], 0),
        (1000, "1/((s + 3)^2 + w^2)", [1], [1, 6, 9 + W[1000] ** 2], 0.25),
        (1000, "1/(s*(s^2 + w^2))", [1], [1, 0, W[1000] ** 2, 0], 0),
        (250, "1/((s^2 + w^2)*(s^2 + 9*w^2))", [1], [1, 0, 10 * W[250] ** 2, 0, 9 * W[250] ** 4], 0),
        (250, "3", [3], [1], 1.5),
        (250, "1/((s + 1000000)*(s + 2))", [1], [1, 1000002, 2000000], 0),
    ):
        delay = f"{late} ms" if late else ""
        found = discretised(text, delay=delay, parameters=f'parameters.w = "{frequency} Hz"')
        assert agree(found, held(num, den, late)), (frequency, text, late)


def test_poles_that_are_one_at_samples_make_one_pole_in_z():
    both = discretised("1/((s + 3)^2 + w^2)", parameters='parameters.w = "500 Hz"')
    (pole,) = both.poles  # -exp(-3 h), of a pair
    assert pole.imag == 0
    assert float(pole.real.mid()) == pytest.approx(-0.997004495503373, rel=1e-15)


def test_an_oscillation_that_is_zero_at_every_sample_is_said_to_be():
    seen = discretised("1/(s^2 + w^2)", parameters='parameters.w = "2 kHz"')
    made = difference_equation(seen)
    assert made.run(U) == [0.0] * len(U)
    assert made.measured()[1] == "y/u is zero at every sample"


def test_matched_refuses_a_root_that_comes_to_one_and_takes_others_together():
    said = words(discretised, "(s^2 + w^2)/(s + w)^2", "matched", parameters='parameters.w = "1 kHz"')
    assert said.startswith("UsageError")
    assert "a zero at 0-6283.19j rad/s, which matched takes to z = 1" in said.replace("0+", "0-")
    # +-500 Hz j come to -1 both, two zeros at infinity to -1 and none; equal to 1/w^2 at s = 0.
    found = discretised("1/(s^2 + w^2)", "matched", parameters='parameters.w = "500 Hz"')
    assert agree(found, [float(y / W[500] ** 2) for y in recurrence([0, 2, 2], [1, 2, 1])])


def test_a_function_of_z_that_is_wrong_is_refused(monkeypatch):
    monkeypatch.setattr("symflex.analysis.sampling._leading", lambda _: 2)
    with pytest.raises(InternalError, match="is wrong"):
        discretised("1/(s + 1)", "tustin")
    monkeypatch.setattr("symflex.analysis.sampling._poles_at_samples", lambda *_: ())
    with pytest.raises(InternalError, match="is wrong"):
        discretised("1/(s + 1)")


def test_nothing_is_left_of_a_function_that_is_zero():
    for method in ("zoh", "tustin", "matched"):
        assert difference_equation(discretised("0", method)).run(U) == [0.0] * len(U), method

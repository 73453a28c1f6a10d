"""Test points: where they lie, which parameters they have, and the values of functions there."""

import mpmath
from flint import ctx

from symflex import pipeline
from symflex.transfer.probes import Probes, probes_of

SUSPENSION = """symflex = 1
parameters = { m = "3 kg", k = "200 N/m", b = {}, zeta = 0.2 }
definitions = { omega_d = "sqrt(k/m*(1 - zeta^2))" }
inputs.u = {}
outputs.y = "omega_d*(b*s + k)/(m*s^2 + b*s + k)*u"
"""


def only(text):
    (tf,) = pipeline.derive_all(pipeline.loads(text))
    return tf


def number(exact):
    return mpmath.mpf(int(exact.numerator)) / exact.denominator


def test_points_lie_on_axes_and_in_all_quadrants_and_parameters_on_both_sides_of_1():
    probes = Probes(only(SUSPENSION))
    points = [(re, im) for _, (re, im) in probes.points]
    signs = {((re > 0) - (re < 0), (im > 0) - (im < 0)) for re, im in points}
    assert signs >= {(-1, 0), (0, 1), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)}
    for name in ("m", "k", "b"):
        values = [s.values[name].rational for s, _ in probes.points]
        assert min(values) < 1 < max(values)
    # The constant sqrt(1 - zeta^2) is real at all of them.
    assert all(0 < s.values["zeta"].rational <= 1 for s, _ in probes.points)


def test_values_are_those_of_the_formula():
    tf = only(SUSPENSION)
    probes = probes_of(tf)
    with mpmath.workdps(40), ctx.workprec(128):
        for (setting, (re, im)), value in zip(probes.points, probes.values(128), strict=True):
            v = {
                n: mpmath.mpf(x.rational.numerator) / x.rational.denominator
                for n, x in setting.values.items()
            }
            s = mpmath.mpc(
                mpmath.mpf(re.numerator) / re.denominator, mpmath.mpf(im.numerator) / im.denominator
            )
            omega_d = mpmath.sqrt(v["k"] / v["m"] * (1 - v["zeta"] ** 2))
            right = omega_d * (v["b"] * s + v["k"]) / (v["m"] * s**2 + v["b"] * s + v["k"])
            assert abs(complex(value) - complex(right)) < 1e-13 * abs(right)


def test_declared_values_are_kept_where_they_are_asked_for():
    tf = only(SUSPENSION.replace("b = {}", 'b = "7 N*s/m"'))
    for setting, _ in probes_of(tf).declared.points:
        assert {n: v.rational for n, v in setting.values.items()}["b"] == 7
    assert Probes(only(SUSPENSION)).declared.points == ()

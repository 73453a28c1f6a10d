"""Poles, zeros and hidden modes of a whole transfer function, by what its formula says."""

import cmath
from math import pi, sqrt

import pytest

from symflex.errors import ModelError
from symflex.roots import Band, Modes
from symflex.roots.functions.simplified import without_lengths_of_zero
from symflex.roots.locate import locate
from tests.unit.roots.distributed_models import ROD, bound


def of(formula, *, signals=""):
    return bound(f'symflex = 1\ninputs.u = {{}}\n{signals}outputs.y = "{formula}"\n')


def places(roots):
    return sorted((round(float(r.re), 9), round(float(r.im), 9), r.multiplicity) for r in roots)


@pytest.mark.slow
def test_roots_over_square_roots_keep_multiplicity_and_axis():
    for formula, poles, hidden in [
        ("u/(s^2 + 2*sqrt(2)*s + 2)", [(-round(sqrt(2), 9), 0, 2)], []),
        ("u/(s^2 + 2*sqrt(6)*s + (sqrt(2)*sqrt(3))^2)", [(-round(sqrt(6), 9), 0, 2)], []),
        ("u*(s + sqrt(8))/(s^2 - 8)", [(round(sqrt(8), 9), 0, 1)], [(-round(sqrt(8), 9), 0, 1)]),
        # (s^2 + 3)(s + sqrt(3)) multiplied out
        (
            "u/(s^3 + sqrt(3)*s^2 + 3*s + sqrt(27))",
            [(-round(sqrt(3), 9), 0, 1), (0, -round(sqrt(3), 9), 1), (0, round(sqrt(3), 9), 1)],
            [],
        ),
    ]:
        found = locate(of(formula), digits=12)
        assert (found.certificate.certified, places(found.poles)) == (True, poles), formula
        assert places([h.root for h in found.hidden]) == hidden, formula
        assert all(r.on_imaginary_axis for r in found.poles if r.im != 0), formula


def test_roots_are_those_of_the_formula():
    for formula, poles, zeros in [
        ("u*(s + 3)/((s + 1)*(s + 2)^2)", [(-2, 0, 2), (-1, 0, 1)], [(-3, 0, 1)]),
        # f is 1 Hz, 2 pi rad/s
        ("u*s^2/((s + f)*(s + 2))", [(-round(2 * pi, 9), 0, 1), (-2, 0, 1)], [(0, 0, 2)]),
        ("u/(s^2 + 2)", [(0, -round(sqrt(2), 9), 1), (0, round(sqrt(2), 9), 1)], []),
        ("7*u", [], []),
    ]:
        found = locate(of(formula, signals='parameters.f = "1 Hz"\n' if "f" in formula else ""), digits=12)
        assert places(found.poles) == poles
        assert places(found.zeros) == zeros, (formula, poles)
        assert (found.tf, found.certificate.certified, found.digits) == ("y/u", True, 12), (formula, poles)


def test_what_cancels_is_hidden_with_its_multiplicity():
    found = locate(of("(s - 3)^2*x/(s + 1)", signals='signals.x = "u/(s - 3)^3"\n'))
    assert [(float(h.root.re), h.root.multiplicity, h.cause) for h in found.hidden] == [(3, 2, "cancelled")]
    assert places(found.poles) == [(-1, 0, 1), (3, 0, 1)]


def test_without_zeros_the_poles_are_those_of_the_textbook():
    # x tan x = 2, see ROD, by scipy's brentq.
    found = locate(bound(ROD), Modes(2), with_zeros=False)
    assert found.zeros == () and found.certificate.certified
    omega = sorted(float(r.im) for r in found.all_poles if r.im > 0)
    assert omega == pytest.approx([1.076873986311771, 3.6435971674254], rel=1e-8)
    assert locate(bound(ROD), Modes(2)).zeros


def test_without_zeros_a_removable_point_is_no_pole():
    # A mass between two strings on a damped foundation, s^2 + 2 gamma coth(gamma) = 0. Where gamma vanishes,
    # at s = -0.1 +- j sqrt(0.99), this is s^2 + 2 and no pole.
    half = 'type = "string", N = "N", rhoA = "mu", l = "L/2", c_f = "c", k_f = "k"'
    source = bound(f"""symflex = 1
parameters = {{ N = 1, mu = 1, L = 2, c = 0.2, k = 1 }}
elements.a = {{ {half}, between = ["ground", "x"] }}
elements.b = {{ {half}, between = ["x", "ground"] }}
elements.m = {{ type = "mass", at = "x", m = 1 }}
inputs.F = {{ force = "x" }}
outputs.X = "x"
""")
    found = locate(source, Modes(3), with_zeros=False)
    assert found.poles and found.certificate.certified
    for root in found.poles:
        s = complex(root.re, root.im)
        gamma = cmath.sqrt(s * s + s / 5 + 1)
        assert abs(s * s * cmath.sinh(gamma) + 2 * gamma * cmath.cosh(gamma)) < 1e-9
        assert abs(gamma) > 0.1


def test_a_hidden_pole_at_0_within_a_block_lets_no_signal_rest_anywhere():
    block = '{ type = "tf", num = "s", den = "s*(s + 2)" }'
    text = f'symflex = 1\nblocks.P = {block}\nsignals.y = "P*u"\ninputs.u = {{}}\noutputs.Y = "y"\n'
    found = locate(bound(text))
    assert [h.root.is_zero for h in found.hidden] == [True]
    assert (found.verdict.word, found.verdict.moving) == ("stable", ())


WITHOUT_LENGTH = """
symflex = 1
parameters.T = {{ value = "0 s", assume = "nonnegative" }}
blocks.D = {{ type = "delay", T = "T" }}
inputs.u = {{}}
outputs.y = "{formula}"
"""


def test_a_delay_of_no_time_is_none_and_a_denominator_that_vanishes_without_it_refused():
    found = locate(bound(WITHOUT_LENGTH.format(formula="u*(s + 2*D)/((s + 3*D)*(s + 5))")))
    assert places(found.poles) == [(-5, 0, 1), (-3, 0, 1)]
    assert places(found.zeros) == [(-2, 0, 1)]
    with pytest.raises(ModelError, match="SF231") as failed:
        without_lengths_of_zero(bound(WITHOUT_LENGTH.format(formula="u/(1 - D)")))
    (diagnostic,) = failed.value.diagnostics
    assert diagnostic.message == "the denominator of y/u is zero for these values"
    assert diagnostic.hint == "a part needs its length"


def test_poles_right_of_the_axis_are_not_counted_again(monkeypatch):
    # exp(-s)/(s + 1) with gain 5: one pair right of the axis, at 2.03 to 2.5 rad/s.
    loop = of("y", signals='blocks.D = { type = "delay", T = 1 }\nsignals.y = "5*D*(u - y)/(s + 1)"\n')
    band = Band(1, 2)
    fresh, lowest = locate(loop, band), locate(loop, Modes(2))
    monkeypatch.setattr("symflex.roots.locate.search_right", None)
    found = locate(loop, band, judged=lowest)
    assert found.verdict == fresh.verdict
    assert found.verdict.found == 2
    assert places(found.unstable) == places(fresh.unstable) != []
    assert places(found.poles) == places(fresh.poles)

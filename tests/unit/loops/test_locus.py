"""Root loci: ends, asymptotes, and what is refused."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from scipy.special import lambertw

import symflex
from symflex.errors import UsageError
from symflex.figures import AxisLimits, draw
from symflex.loops import loop_gain, trace_locus
from symflex.loops.of_model import characteristic_loop
from tests.unit.refusals import refusal


def characteristic(model, gain="K"):
    return characteristic_loop(model.resolved, gain)


@pytest.mark.slow
def test_curves_go_from_open_loop_poles_to_closed_loop_poles(loop):
    locus = trace_locus(characteristic(loop("K/(s*(s + 1)*(s + 2))")), (Fraction(0), Fraction(60)))
    assert locus.arrived
    for s in (s for branch in locus.branches for s in branch[::10]):  # poles for some gain
        gain = -s * (s + 1) * (s + 2)
        assert abs(gain.imag) < 1e-8 * (1 + abs(gain))
        assert -1e-9 < gain.real < 60.001
    ends = sorted((branch[-1] for branch in locus.branches), key=lambda s: (s.real, s.imag))
    wanted = sorted(np.roots([1, 3, 2, 60]), key=lambda s: (s.real, s.imag))
    assert np.allclose(ends, wanted, rtol=1e-9)
    assert sorted(branch[0].real for branch in locus.branches) == [-2, -1, 0]


@pytest.mark.slow
def test_one_curve_ends_next_to_the_zero(loop):
    locus = trace_locus(characteristic(loop("K*(s - 3)/((s + 1)*(s + 2))")), (Fraction(0), Fraction(10**6)))
    assert min(abs(branch[-1] - 3) for branch in locus.branches) < 1e-4


@pytest.mark.slow
def test_a_delay_loop_is_traced(loop):
    locus = trace_locus(characteristic(loop("K*D/(s + 1)")), (Fraction(1, 10), Fraction(4)), modes=3)
    assert locus.arrived
    assert len(locus.branches) >= 3
    for branch in locus.branches:
        s = branch[-1]
        assert abs(s + 1 + 4 * np.exp(-s / 2)) < 1e-7 * abs(4 * np.exp(-s / 2))


def test_the_loop_gain_is_minus_one_at_a_boundary(loop):
    model = loop("K/(s*(s + 1)*(s + 2))", K=6)
    assert abs(loop_gain(characteristic(model))(1j * 2**0.5) + 1) < 1e-12


def test_a_mass_alone_is_no_gain():
    cart = """
symflex = 1
parameters.m = "2 kg"
inputs.F   = { force = "x" }
outputs.X  = "x"
elements.cart = { type = "mass", at = "x", m = "m" }
"""
    assert refusal(trace_locus, characteristic(symflex.loads(cart), "m")) == "ModelError SF801"


def test_errors(loop):
    squared, unset = (characteristic(loop(*each)) for each in (("K^2/(s + 1)",), ("K/(s + 1)", {})))
    assert refusal(trace_locus, squared) == "UsageError SF806"
    assert refusal(trace_locus, unset) == "UsageError SF804"
    assert refusal(loop_gain, unset) == "UsageError SF806"


def newton(function, slope, s):
    for _ in range(50):
        s -= function(s) / slope(s)
    return s


@pytest.mark.slow
def test_poles_that_come_from_infinity_are_traced(loop):
    # s + 1 + K (s + 3) exp(-s/10): one pole at K = 0, infinitely many for any K > 0.
    locus = trace_locus(
        characteristic(loop("K*D*(s + 3)/(s + 1)", T="0.1 s")), (Fraction(0), Fraction(9, 10))
    )
    assert locus.arrived
    assert [branch[0] for branch in locus.branches] == [-1]
    assert len(locus.entering) == 8  # five modes, one of them real and from -1
    for branch in locus.entering:
        assert branch[0].real < -100
        for s in branch[::9]:
            gain = -(s + 1) / (s + 3) * np.exp(s / 10)
            assert abs(gain.imag) < 1e-9 * abs(gain)
            assert 0 < gain.real < 0.9000001
    for guess in (-2, -1 + 31j, -1 - 31j, -1 + 94j, -1 + 157j, -1 + 220j):
        root = newton(
            lambda s: s + 1 + 0.9 * (s + 3) * np.exp(-s / 10),
            lambda s: 1 + 0.9 * np.exp(-s / 10) * (1 - (s + 3) / 10),
            guess,
        )
        assert min(abs(end - root) for end in locus.ends) < 1e-9
        drawn = [branch[-1] for branch in (*locus.branches, *locus.entering)]
        assert min(abs(end - root) for end in drawn) < 1e-9


@pytest.mark.slow
def test_a_pole_from_infinity_meets_one_of_the_plant(loop):
    # (s + 1) exp(s/2) has its least value on the axis at -3: there the two meet, and leave as a pair.
    locus = trace_locus(characteristic(loop("K*D/(s + 1)")), (Fraction(0), Fraction(4)), modes=3)
    drawn = sorted((*locus.branches, *locus.entering), key=lambda branch: abs(branch[-1]))[:2]
    for branch in drawn:
        assert min(abs(s + 3) for s in branch) < 0.1
    pair = sorted((branch[-1] for branch in drawn), key=lambda s: s.imag)
    assert pair[0] == pytest.approx(pair[1].conjugate(), rel=1e-9)
    assert abs(pair[1] + 1 + 4 * np.exp(-pair[1] / 2)) < 1e-8


@pytest.mark.slow
def test_a_pole_from_infinity_of_a_loop_that_differentiates(loop):
    locus = trace_locus(characteristic(loop("K*(s + 2)^2/(s + 1)")), (Fraction(0), Fraction(10)))
    (entering,) = locus.entering
    wanted = sorted(np.roots([10, 41, 41]))
    assert entering[-1] == pytest.approx(wanted[0])
    assert entering[0].real < -5
    assert locus.branches[0][-1] == pytest.approx(wanted[1])


@pytest.mark.slow
def test_curves_turn_little_from_step_to_step(loop):
    # Poles leave each other at once where those of two modes come close.
    expression = "K/((s^2 + 0.04*s + 4)*(s^2 + 0.05*s + 5))"
    locus = trace_locus(characteristic(loop(expression)), (Fraction(0), Fraction(10**6)))
    for branch in locus.branches:
        steps = np.diff(np.array(branch))
        visible = steps[np.abs(steps) > 0.05]
        assert np.max(np.abs(np.angle(visible[1:] / visible[:-1]))) < 0.3


FORCE_LOOP = """
symflex = 1
[parameters]
E = "210 GPa"
I = "4e-10 m^4"
r = "7800 kg/m^3"
l = "0.5 m"
A = "6e-5 m^2"
eta = "2e-4 s"
k = "5 kN/m"
K = 0.5
[blocks]
D = { type = "delay", T = "3 ms" }
[elements]
motor = { type = "mass", at = "root", m = "2 kg" }
friction = { type = "damper", between = ["root", "ground"], b = "60 N*s/m" }
guide = { type = "slider", at = "root" }
beam = { type = "beam", between = ["root","tip"], E = "E", I = "I", rho = "r", A = "A", l = 0.5, eta = "eta" }
head = { type = "mass", at = "tip", m = "0.3 kg" }
contact = { type = "spring", between = ["tip", "ground"], k = "k" }
losses = { type = "damper", between = ["tip", "ground"], b = "6 N*s/m" }
drive = { type = "force_source", at = "root", f = "u" }
[signals]
u = "K*(F_cmd - D*(k*tip))"
[inputs]
F_cmd = {}
[outputs]
F_tip = "k*tip"
"""


@pytest.mark.slow
def test_poles_that_go_where_poles_accumulate_stop_there():
    # Of a Kelvin-Voigt beam poles accumulate at -1/eta = -5000; which are there, no search can tell.
    locus = trace_locus(characteristic(symflex.loads(FORCE_LOOP)))
    assert locus.arrived
    assert len(locus.entering) == 2
    (hole,) = locus.end.excluded
    assert hole.re == pytest.approx(-5000)
    for branch in (*locus.branches, *locus.entering):
        assert len(branch) == 1 or abs(branch[-1] + 5000) > hole.radius


def test_a_range_that_is_none_is_told_in_its_own_words(loop):
    done = characteristic(loop("K/(s + 1)"))
    for limits, message, hint in (
        ((5, 1), "reversed: 5 to 1", "--range 1 5"),
        ((2, 2), "empty", "different"),
        ((0, None), "finite", "two numbers"),
        ((None, 1), "finite", "two numbers"),
    ):
        with pytest.raises(UsageError, match="SF804") as caught:
            trace_locus(done, tuple(None if x is None else Fraction(x) for x in limits))
        (told,) = caught.value.diagnostics
        assert message in told.message, limits
        assert hint in told.hint, limits


@pytest.mark.slow
def test_the_frame_holds_the_poles_at_the_last_gain(loop):
    done = characteristic(loop("K*D*(s + 3)/(s + 1)", T="0.1 s"))
    figure = draw("locus", done, limits=(Fraction(0), Fraction(9, 10)))
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["poles, $K = 0$", "poles, $K = 0.9$", "zeros", "from poles not marked"]
    # The fifth mode is near (2 n + 1) pi / T for n = 3.
    assert figure.axes[0].get_ylim()[1] > 7 * np.pi / 0.1
    assert figure.axes[0].get_xlim()[0] < -3


def test_a_locus_is_shown_as_far_as_the_band_reaches(loop):
    figure = draw(
        "locus", characteristic(loop("K*(s + 30)/((s + 1)*(s + 2))")), band_hz=(0, 20 / (2 * np.pi))
    )
    (axes,) = figure.axes
    assert 20 < axes.get_ylim()[1] < 25
    assert axes.get_xlim()[0] > -25
    assert not any("zeros" in text.get_text() for text in figure.legends[0].get_texts())  # at -30


@pytest.mark.slow
def test_as_many_modes_are_traced_as_a_band_holds(loop):
    # (s + 1) exp(s/10) = -1 where s = 10 W(-exp(1/10)/10) - 1.
    known = [10 * lambertw(-np.exp(0.1) / 10, branch) - 1 for branch in range(-8, 8)]
    wanted = sorted((s for s in known if abs(s) < 150), key=lambda s: (s.imag, s.real))
    done = characteristic(loop("K*D/(s + 1)", T="0.1 s"))
    traced = trace_locus(done, (Fraction(1), Fraction(2)), band_hz=(0, 150 / (2 * np.pi)))
    found = [complex(float(r.re.mid()), float(r.im.mid())) for r in traced.start.poles]
    assert len(wanted) > 4
    assert np.allclose(sorted(found, key=lambda s: (s.imag, s.real)), wanted, rtol=1e-9)


@pytest.mark.slow
def test_a_locus_has_the_limits_asked_for_and_counts_what_is_outside(loop):
    frame = AxisLimits(x=(-3, 1), y=(0, 2))
    done = characteristic(loop("K*(s + 30)/((s + 1)*(s + 2))"))
    figure = draw("locus", done, limits=(Fraction(0), Fraction(1000)), frame=frame)
    assert (figure.axes[0].get_xlim(), figure.axes[0].get_ylim()) == ((-3, 1), (0, 2))
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["poles, $K = 0$", "poles, $K = 1$ (all outside)", "poles, $K = 1000$ (all outside)"]


def test_a_nyquist_plot_says_whether_the_closed_loop_is_stable(loop):
    # K exp(-s/2)/s is stable up to K = pi, where a pair crosses; the next one does at 5 pi.
    said = "unstable: 2 poles in the right half-plane"
    asked = AxisLimits(has_verdict=True)
    figure = draw("nyquist", characteristic(loop("K*D/s", K=4)), title="A loop", frame=asked)
    (legend,) = figure.legends
    assert legend.get_title().get_text() == (f"A loop\nclosed loop {said}")


ROD = """
symflex = 1
parameters = { EA = "1 kN", mu = "0.5 kg/m", l = "2 m", m = "1 kg", K = "GAIN N*s/m", T = "0.1 s" }
inputs.v = { unit = "m/s" }
outputs.V = "s*a"
elements.bar = { type = "rod", between = ["a", "b"], EA = "EA", rhoA = "mu", l = "l" }
elements.body = { type = "mass", at = "a", m = "m" }
elements.drive = { type = "force_source", at = "a", f = "LAW" }
"""


@pytest.mark.slow
def test_curves_of_speed_loops_leave_hidden_poles_at_0_and_part_from_there():
    """A rod with one free end resists at the other with EA k tanh(k l), k = s sqrt(mu/EA)."""
    for law, force in [
        ("K*(v - s*a)", lambda s: 20 * s),  # where the rod is does not matter
        ("K*(1 + 1/(T*s))*(v - s*a)", lambda s: 20 * (s + 10)),  # two poles part from 0
    ]:
        model = symflex.loads(ROD.replace("GAIN", "2").replace("LAW", law))
        locus = trace_locus(characteristic(model), modes=2)
        assert locus.arrived, law
        for s in (branch[-1] for branch in locus.branches):
            wave = s * (0.5 * 1000) ** 0.5 * np.tanh(s * (0.5 / 1000) ** 0.5 * 2)
            assert abs(s**2 + force(s) + wave) < 1e-6 * abs(s**2), (law, s)


def test_the_locus_of_a_negative_gain_begins_at_ten_times_its_value():
    cart = symflex.loads(
        'symflex = 1\nparameters = { K = { value = -2, assume = "real" } }\n'
        'signals.y = "K*(r - y)/(s + 1)"\ninputs.r = {}\noutputs.Y = "y"'
    )
    locus = trace_locus(characteristic(cart))
    assert locus.limits == (-20, 0)
    assert locus.branches[0][0] == pytest.approx(19)  # s + 1 + K = 0

"""Sampled state equations are those of the continuous system at samples, the input held between."""

from fractions import Fraction
from math import exp

import mpmath
import numpy as np
import pytest
import scipy.linalg
import scipy.signal
from flint import arb, arb_mat

from symflex import loads
from symflex.errors import ModelError
from symflex.state_space.sampled import Sampling, sampled
from tests.unit.refusals import refusal

CHAIN = """
symflex = 1
parameters = { m = "2 kg", b = "3 N*s/m", k = "800 N/m" }
inputs  = { F = { force = "y" } }
outputs = { X = "x", A = "s^2*y" }
[elements]
m1 = { type = "mass", at = "x", m = "m" }
m2 = { type = "mass", at = "y", m = "m/2" }
k1 = { type = "spring", between = ["ground", "x"], k = "k" }
k2 = { type = "spring", between = ["x", "y"], k = "2*k" }
b2 = { type = "damper", between = ["x", "y"], b = "b" }
"""


def balls_of(*arrays):
    """Return matrices of doubles in balls, as the function asks for them."""
    matrices = [arb_mat(*a.shape, [arb(float(x)) for x in a.ravel()]) for a in map(np.array, arrays)]
    return lambda bits: tuple(matrices)


def test_a_chain_is_sampled_as_scipy_does_it():
    system = loads(CHAIN).state_space()
    plain = system.bind()
    found = system.discretise("2 ms")
    expected = scipy.signal.cont2discrete((plain.A, plain.B, plain.C, plain.D), 0.002)
    for one, other in zip((found.A, found.B, found.C, found.D), expected, strict=False):
        assert np.max(np.abs(one - other)) <= 1e-13 * max(1, np.max(np.abs(other)))
    assert found.states == system.states


def test_another_value_is_taken():
    system = loads(CHAIN).state_space()
    a = system.bind(k="100 N/m").A
    assert np.allclose(system.discretise(0.01, k="100 N/m").A, scipy.linalg.expm(a * 0.01), rtol=1e-13)


def held(lag, gain, times, h, u, delay):
    """Return y at times of y' = -lag y + gain u(t - delay), u held, event by event in closed form."""
    moments = sorted({*times, *(k * h + delay for k in range(len(u)))})
    y, t, found = 0.0, 0.0, {}
    for moment in moments:
        # Constant on the way: rounding to the middle of the interval tells which value.
        k = int(np.floor(((t + moment) / 2 - delay) / h))
        value = u[k] if 0 <= k < len(u) else 0.0
        decay = exp(-lag * (moment - t))
        y, t = y * decay + gain / lag * (1 - decay) * value, moment
        found[moment] = y
    return [found[t] for t in times]


def test_a_delay_of_any_fraction_is_exact():
    for samples in [0.0, 0.3, 1.0, 2.7]:
        h, u = 0.1, np.random.default_rng(5).normal(size=40)
        times = [k * h for k in range(40)]
        step = sampled(
            balls_of([[-2.0]], [[3.0]], [[1.0]], [[0.0]]),
            Sampling(Fraction(1, 10)),
            Fraction(str(samples)) / 10,
            (["w"], ["u"], ["y"]),
        )
        w, found = np.zeros(len(step.states)), []
        for value in u:
            found.append(float((step.C @ w + step.D @ [value])[0]))
            w = step.A @ w + step.B @ [value]
        expected = held(2.0, 3.0, times, h, u, samples * h)
        assert np.max(np.abs(np.array(found) - expected)) < 1e-13, samples


def test_what_passes_straight_through_is_late_too():
    for samples in [0.0, 1.0, 2.0, 2.5]:
        step = sampled(
            balls_of([[-1.0]], [[0.0]], [[0.0]], [[1.0]]),
            Sampling(Fraction(1)),
            Fraction(str(samples)),
            (["w"], ["u"], ["y"]),
        )
        u = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
        w, found = np.zeros(len(step.states)), []
        for value in u:
            found.append(float((step.C @ w + step.D @ [value])[0]))
            w = step.A @ w + step.B @ [value]
        late = int(np.ceil(samples))
        assert found == [*[0.0] * late, *u[: len(u) - late]], samples


LAG = ([[-1.0]], [[1.0]], [[1.0]], [[0.0]])
NAMES = (["w"], ["u"], ["y"])


def test_every_entry_is_the_nearest_double():
    step = sampled(balls_of(*LAG), Sampling(Fraction(1, 3)), Fraction(0), NAMES)
    with mpmath.workdps(40):
        decay = mpmath.exp(-mpmath.mpf(1) / 3)
        assert (step.A[0, 0], step.B[0, 0]) == (float(decay), float(1 - decay))


def test_a_system_without_states_is_its_feedthrough():
    text = 'symflex = 1\ninputs.u = {}\noutputs.y = "3*u"'
    step = loads(text).state_space().discretise(0.1)
    assert (step.A.shape, step.D.tolist()) == ((0, 0), [[3.0]])


def test_programs_for_control_take_it():
    step = loads(CHAIN).state_space().discretise("1 ms", delay=0.0005)
    assert step.to_scipy().dt == 0.001
    assert step.to_control().dt == 0.001
    assert step.states[-1] == "F_1_before"
    assert loads(CHAIN).state_space().discretise("1 ms", delay="0 s").states == step.states[:-1]


def test_times_that_make_no_sense_are_refused():
    system = loads(CHAIN).state_space()
    for dt, delay in ((0, 0), (-1, 0), (0.1, -0.1), (1e-6, 1.0)):
        assert refusal(system.discretise, dt, delay) == "UsageError SF902", (dt, delay)


def test_growth_beyond_doubles_within_a_sample_is_refused():
    with pytest.raises(ModelError, match="SF233"):
        sampled(balls_of([[1000.0]], *LAG[1:]), Sampling(Fraction(1)), Fraction(0), NAMES)

"""Responses to inputs given by samples are exact between them."""

from fractions import Fraction

import numpy as np
import pytest
import scipy.signal

from symflex import loads
from symflex.analysis.time_response import forced_response
from symflex.errors import UncertifiedError
from tests.unit.analysis.systems import rational, words

TIMES = [Fraction(i, 4) for i in range(9)]


def second_order():
    text = 'symflex = 1\nelements.m = { type = "mass", at = "x", m = "2 kg" }\n'
    text += 'elements.b = { type = "damper", between = ["ground", "x"], b = "3 N*s/m" }\n'
    text += 'elements.k = { type = "spring", between = ["ground", "x"], k = "50 N/m" }\n'
    text += 'inputs.F = { force = "x" }\noutputs.X = "x"'
    return loads(text).transfer_function("X", "F").bind()


def test_a_random_input_gives_what_scipy_gives_with_a_first_order_hold():
    H, times = second_order(), np.linspace(0, 8, 400)
    u = np.random.default_rng(3).normal(size=400)
    system = scipy.signal.StateSpace([[0, 1], [-25, -1.5]], [[0], [0.5]], [[1, 0]], [[0]])
    _, expected, _ = scipy.signal.lsim(system, u, times)
    found = H.forced_response(times, u)
    assert np.max(np.abs(found.values - expected)) < 1e-12 * np.max(np.abs(expected))
    assert found.radius.max() < 1e-11 * np.max(np.abs(expected))


def test_uneven_samples_of_an_integrator_are_a_trapezoidal_rule():
    times, u = [0, Fraction(1, 10), Fraction(7, 10), 2], [1, 3, -1, 0]
    found = forced_response(rational("1/s"), times, u, times)
    assert found.values.tolist() == pytest.approx([0.0, 0.2, 0.8, 0.15])


def test_between_and_after_samples_the_input_is_a_line_and_then_constant():
    found = forced_response(rational("1/s"), [0, 1], [0, 2], [Fraction(1, 2), 1, 3])
    assert found.values.tolist() == [0.25, 1.0, 5.0]


def test_an_input_through_a_delay_is_the_input_later():
    text = 'symflex = 1\nblocks.D = { type = "delay", T = "0.5 s" }\ninputs.u = {}\noutputs.y = "D*u"'
    bound = loads(text).transfer_function("y", "u").bind().bound
    u = [0, 1, 4, 9, 16, 25, 36, 49, 64]
    assert forced_response(bound, TIMES, u, TIMES).values.tolist() == [0, 0, *u[:-2]]


def test_an_input_that_begins_with_a_jump_is_passed_on_with_it():
    text = 'symflex = 1\nblocks.D = { type = "delay", T = "0.3 s" }\ninputs.u = {}\noutputs.y = "D*u"'
    found = loads(text).transfer_function("y", "u").bind().forced_response([1.0, 2.0], [2.0, 2.0])
    assert [(float(j.time), float(j.height)) for j in found.jumps] == [(1.3, 2.0)]


def test_what_differentiates_its_input_is_refused():
    with pytest.raises(UncertifiedError, match="differentiates"):
        forced_response(rational("s^3/(s + 1)"), [0, 1], [0, 1], [0, 1])


def test_samples_that_make_no_sense_are_refused_with_a_sentence():
    respond = second_order().forced_response
    for times, values, said in (
        ([0.0, 1.0], [1.0], "two or more finite values"),
        ([0.0, 1.0], [1.0, np.nan], "finite values"),
        ([0.0], [1.0], "two or more"),
        ([1.0, 0.0], [1.0, 2.0], "increase"),
        ([0.0, 1.0, 2.3456789012], [1.0, 2.0, 3.0], "no usable common step"),
    ):
        found = words(respond, times, values)
        assert found.startswith("UsageError") and said in found, (times, values)

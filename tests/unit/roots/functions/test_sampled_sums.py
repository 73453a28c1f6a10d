"""Samples of sums of exponentials in doubles against closed forms, and where balls have to sample."""

from functools import cache

import mpmath
import pytest
from flint import acb
from mpmath import mp, mpc

from symflex.balls import precision
from symflex.roots.functions.exponential_values import ExponentialValues
from symflex.roots.functions.kernel_function import KernelFunction
from symflex.roots.functions.sampled_sums import SampledSums
from tests.unit.roots.distributed_models import FREE, bound
from tests.unit.roots.functions.test_kernel_function import CLOSED, function_of

BITS = 64
POINTS = (0.3 + 0.4j, 1.5 + 2j, 2.5 + 1.4j)


@cache
def sampled(text):
    function = function_of(text)
    with precision(BITS):
        sums = ExponentialValues(function.bound.kernel_values(), *function.exponentials)
        return function, SampledSums.of(sums)


@pytest.mark.parametrize("name", CLOSED)
def test_differences_of_logarithms_and_slopes_are_those_of_closed_forms_but_for_powers_of_s(name):
    text, closed = CLOSED[name]
    function, sums = sampled(text)
    first, *others = (sums.at(z) for z in POINTS)
    with mp.workdps(30):
        own = [closed(mpmath.exp(mpc(z))) for z in POINTS]
        slopes = [mpmath.diff(lambda z: mpmath.log(closed(mpmath.exp(z))), mpc(z)) for z in POINTS]
    order = (first.slope - complex(slopes[0])).real * function.power
    assert order == pytest.approx(round(order), abs=1e-9)
    order = round(order) / function.power
    for sample, value, slope, z in zip(others, own[1:], slopes[1:], POINTS[1:], strict=True):
        assert sample.slope == pytest.approx(complex(slope) + order, rel=1e-10)
        grown = sample.log - first.log - complex(mpmath.log(value / own[0])) - order * (z - POINTS[0])
        turns = grown.imag * function.power / float(2 * mp.pi)
        assert grown.real == pytest.approx(0, abs=1e-10)
        assert turns == pytest.approx(round(turns), abs=1e-9)


def test_a_function_samples_as_its_balls_do():
    for text, _ in CLOSED.values():
        function = function_of(text)
        for z in POINTS:
            own = function.at_logarithm(z)
            with precision(2 * BITS):
                exact = function.at_point(acb(z.real, z.imag).exp())
            assert own.slope == pytest.approx(exact.slope, rel=1e-10)
            turns = (own.log - exact.log).imag / float(2 * mp.pi)
            assert turns == pytest.approx(round(turns), abs=1e-9)


def test_where_digits_cancel_doubles_give_no_sample():
    _, sums = sampled(FREE)
    # cos(x) cosh(x) - 1 is -x^4/6 and less: at s = 1e-4 a relative 2e-9 of its terms.
    assert sums.at(-9.2 + 1j) is None
    assert sums.at(-140 + 0j) is None
    assert sums.at(800 + 0j) is None  # beyond the largest double
    source = bound(FREE)
    assert KernelFunction(source, source.den).order_at_zero() == pytest.approx(2, abs=1e-6)

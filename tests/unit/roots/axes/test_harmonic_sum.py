"""Functions of the root of s on both axes against products of hyperbolic and circular functions."""

from itertools import product
from math import log

import mpmath
from flint import arb
from mpmath import mp, mpc, mpf

from symflex.algebra.exponential_sum import ExponentialSum
from symflex.balls import precision
from symflex.roots.axes.axis_function import IMAGINARY, REAL
from symflex.roots.axes.harmonic_sum import LosslessFunction
from symflex.roots.functions.kernel_function import KernelFunction
from tests.unit.roots.distributed_models import bound
from tests.unit.roots.lossless_functions import CONSTANT, DEGREES, RATES, function_of


def value(sums, x):
    """Return the same sums by mpmath."""
    return sum(
        number
        * x**power
        * CONSTANT**of_constant
        * mpmath.fprod(getattr(mpmath, name)(RATES[i] * x ** DEGREES[i]) for i, name in kernels)
        for number, power, of_constant, kernels in sums
    )


# Lossless models have such functions: cosh and cos of bending come in pairs, sinh(g s) of waves with x^2.
BENT = ((1, 0, 0, ((0, "cosh"), (0, "cos"))), (-1, 0, 0, ()))
SLID = ((1, 0, 0, ((0, "cosh"), (0, "sin"))), (1, 0, 0, ((0, "sinh"), (0, "cos"))))
LOADED = (
    (1, 0, 0, ((0, "cosh"), (0, "cos"))),
    (1, 0, 0, ()),
    (2, 1, 1, ((0, "cosh"), (0, "sin"))),
    (-2, 1, 1, ((0, "sinh"), (0, "cos"))),
)
WAVE = ((1, 2, 0, ((2, "sinh"),)), (5, 0, 1, ((2, "cosh"),)))
BOTH = (
    (1, 2, 0, ((0, "cosh"), (0, "cos"), (2, "sinh"))),
    (1, 2, 0, ((2, "sinh"),)),
    (-3, 1, 2, ((0, "cosh"), (0, "sin"), (2, "cosh"))),
    (3, 1, 2, ((0, "sinh"), (0, "cos"), (2, "cosh"))),
)
POWER = ((3, 4, 1, ()), (1, 0, 2, ()))
TWO_BEAMS = (
    (1, 0, 0, ((0, "cosh"), (0, "cos"), (1, "sinh"))),
    (1, 0, 0, ((0, "cosh"), (0, "cos"), (1, "sin"))),
)
FUNCTIONS = {
    "bent": BENT, "slid": SLID, "loaded": LOADED, "wave": WAVE, "both": BOTH, "power": POWER,
    "two beams": TWO_BEAMS,
}  # fmt: skip


def test_on_an_axis_it_is_the_same_function_but_for_one_exponential_and_one_number():
    for axis, name in product([REAL, IMAGINARY], FUNCTIONS):
        sums = FUNCTIONS[name]
        source = function_of((sums, 1)).on_axis(0, axis)
        with mp.workdps(60), precision(200):
            times = [mpf(k) / 8 for k in (3, 7, 11, 17, 29)]
            unit = mpc(1, axis)
            ratios = []
            for t in times:
                found = source.values(200).value(arb(float(t)))
                ratios.append(value(sums, unit * t) / mpf(found.mid().str(50, radius=False)))
            # exp(c t + d t^2) times a number: the logarithms of three differences are the same line.
            logs = [mpmath.log(abs(ratio)) for ratio in ratios]
            (a, b, c) = mpmath.lu_solve([[1, t, t * t] for t in times[:3]], logs[:3])
            for t, each in zip(times, logs, strict=True):
                assert abs(a + b * t + c * t * t - each) < 1e-20, (axis, name)
            # That number is the same for all, and real or not: it has one direction.
            assert all(
                abs(mpmath.im(ratio / ratios[0])) < 1e-20 * abs(ratio / ratios[0]) for ratio in ratios
            ), (axis, name)
            assert all(mpmath.re(ratio / ratios[0]) > 0 for ratio in ratios), (axis, name)


def test_what_is_not_real_on_an_axis_is_none():
    for sums, axis in [
        (((1, 0, 0, ((0, "cosh"),)), (1, 0, 0, ((0, "sin"),))), IMAGINARY),
        (((1, 0, 0, ()), (1, 1, 0, ())), IMAGINARY),
        (((1, 0, 0, ()), (1, 2, 0, ())), IMAGINARY),
        (((1, 0, 0, ((2, "cosh"),)), (1, 0, 0, ((2, "sinh"),))), IMAGINARY),
        (((1j, 0, 0, ()), (1, 0, 0, ((0, "cosh"),))), REAL),
    ]:
        # cosh((1 + j) t) + sin((1 + j) t), 1 + (1 + j) t, 1 + 2 j t^2, exp(j t^2), j + cosh(t)
        assert function_of((sums, 1)).on_axis(0, axis) is None
    # exp(j x), with the smallest coefficient there is.
    alone = LosslessFunction(((ExponentialSum({((0, 0, 1),): {(): (1, 0)}}), 1),), function_of().enclosures)
    assert alone.on_axis(0, REAL) is None


def test_turns_of_factors_add_up_by_their_exponents_from_the_real_to_the_imaginary_axis():
    for radius in [3.2, 60.7]:
        alone = [function_of((each, 1)).turn(log(radius)) for each in (BENT, WAVE)]
        together = function_of((BENT, 3), (WAVE, -2)).turn(log(radius))
        assert abs(together - 3 * alone[0] + 2 * alone[1]) < 1e-12, radius
    for z in [2.1, 4.3]:
        # s^2 + 9/3: roots +-j sqrt(3), each seen from the arc; and arg(s^2 + 3) itself.
        function = function_of((POWER, 1))
        radius = mpmath.exp(z)
        turned = mpmath.arg((9 * (1j * radius) ** 2 + 9) / (9 * radius**2 + 9))
        assert abs(abs(function.turn(z)) - abs(turned)) < 1e-9


def kernel_function(text):
    source = bound(text, 0)
    return KernelFunction(source, source.den)

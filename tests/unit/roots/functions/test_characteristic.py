"""Values and slopes of a characteristic function on balls, against derivatives by hand in mpmath."""

import mpmath
import pytest
from flint import acb, acb_series

import symflex
from symflex.balls import expansion, precision
from symflex.roots.functions.characteristic import CharacteristicValues
from symflex.roots.functions.exponential_values import sums_of

# y = exp(-s T)/(s + K): with (s + K) and exp(-s T) as the two polynomials.
DELAYED = """symflex = 1
parameters = { K = "2 1/s", T = "0.5 s" }
inputs.u = {}
outputs.y = "exp(-s*T)/(s + K)*u"
"""


@pytest.fixture
def delayed():
    return symflex.loads(DELAYED).transfer_function("y", "u").bind().bound


def both(bound, bits=80):
    polynomials = [side.numerator().expand() for side in (bound.num, bound.den)]
    with precision(bits):
        kernels = bound.kernel_values()
        for sums in (sums_of(bound.ratio.ring, polynomials, bound.kernels), None):
            yield CharacteristicValues.of(kernels, polynomials, sums)


def test_quotients_of_values_and_slopes_are_those_by_hand(delayed):
    s = mpmath.mpc(0.3, 4)
    num, slope = mpmath.exp(-s / 2), -mpmath.exp(-s / 2) / 2
    for characteristic in both(delayed):
        with precision(80):
            place = characteristic.at(expansion(acb(0.3, 4)))
            less = characteristic.largest([0, 1], place)
            (a, a_slope), (b, b_slope) = (characteristic.first_order(i, place, less) for i in (0, 1))
        for found, wanted in ((a / b, num / (s + 2)), (a_slope / a, slope / num), (b_slope / b, 1 / (s + 2))):
            assert abs(complex(found.mid()) - complex(wanted)) < 1e-15 * abs(wanted)


def test_a_slope_of_zero_along_s_leaves_that_of_constants_which_do_not_move(delayed):
    for characteristic in both(delayed):
        with precision(80):
            place = characteristic.at(acb_series([acb(1), 0], 2))
            less = characteristic.largest([0], place)
            assert characteristic.first_order(0, place, less)[1] == 0

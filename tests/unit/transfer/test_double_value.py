"""Values to double precision, on functions in balls whose accuracy a test lays down."""

from itertools import product
from math import inf, isnan, nan

from flint import acb, arb, ctx

from symflex.transfer.double_value import DOUBLE_BITS, FIRST_BITS, LAST_BITS, NEAR, double_value, order_near

FAIL = acb(arb("nan"), arb("nan"))


def accurate(value, bits):
    """Return a ball about a number that is right to so many bits and no more."""
    with ctx.workprec(LAST_BITS):
        found = acb(arb(value, arb(value) * arb(2) ** (-1 - bits)))
    assert found.rel_accuracy_bits() == bits
    return found


class Levels:
    """A function that notes at which precisions beyond the first it was asked for, and answers by them."""

    def __init__(self, answer):
        self.answer, self.asked = answer, []

    def enclosed(self, bits):
        self.asked += [bits] if bits > FIRST_BITS else []
        return lambda s: self.answer(bits, s)

    def __call__(self, s, patience=None):
        return double_value(self.enclosed, s, patience)


def test_the_precision_is_doubled_up_to_a_last_one_and_then_the_value_counts_as_zero():
    function = Levels(lambda bits, s: accurate(0.75, 10))
    assert function(1j) == 0
    assert function.asked == [192, 384, 768, 1536, 3072, 6144]


def test_a_value_that_is_never_finite_is_a_pole():
    value = Levels(lambda bits, s: FAIL)(1j)
    assert (value.real, isnan(value.imag)) == (inf, True)


def test_where_no_number_is_given_no_number_is_returned():
    for s in [complex(nan, 1), complex(1, nan), complex(inf, 1), complex(1, -inf)]:
        value = Levels(lambda bits, s: acb(1))(s)
        assert isnan(value.real), s
        assert isnan(value.imag), s


PLACE = 3 + 4j


def undefined(at):
    """Return a function that is not a number at a point, and has a given form beside it."""

    def answer(bits, s):
        with ctx.workprec(bits):
            offset = s - acb(PLACE.real, PLACE.imag)
            return FAIL if offset.contains(0) else at(offset)

    return answer


def test_a_function_that_vanishes_at_such_a_point_is_zero_there():
    assert Levels(undefined(lambda offset: offset * acb(2, 5)))(PLACE, 0) == 0


def test_a_function_that_grows_towards_such_a_point_has_a_pole_there():
    for order in [-1, -2]:
        value = Levels(undefined(lambda offset, order=order: acb(1) / offset**-order))(PLACE, 0)
        assert (value.real, isnan(value.imag)) == (inf, True), order


def test_a_function_that_is_no_number_about_such_a_point_has_no_limit():
    value = Levels(lambda bits, s: FAIL)(PLACE, 0)
    assert (value.real, isnan(value.imag)) == (inf, True)


def power(order, s):
    def function(bits):
        def at(z):
            with ctx.workprec(bits):
                return (z - acb(s.real, s.imag)) ** order * acb(3, -7)

        return at

    return function


def test_orders_are_read_off_beside_a_point():
    for order, s in product([-3, -1, 0, 1, 2, 5], [0j, 0.25j, 300 - 400j]):
        found, value = order_near(power(order, s), s)
        assert found == order, (order, s)
        with ctx.workprec(LAST_BITS):
            # The nearer point stands off by 2^-220 of what is larger: the point's size, or one.
            offset = arb(2) ** -NEAR[1] * max(abs(s), 1.0)
            error = abs(value / (acb(3, -7) * acb(offset) ** order) - 1)
        assert error < arb(2) ** -DOUBLE_BITS, (order, s)


def test_values_beside_a_point_that_are_finite_and_of_few_bits_do_not_count():
    assert order_near(lambda bits: lambda s: accurate(0.75, DOUBLE_BITS - 1), 1j) == (0, None)
    assert order_near(lambda bits: lambda s: accurate(0.75, DOUBLE_BITS), 1j)[1] is not None

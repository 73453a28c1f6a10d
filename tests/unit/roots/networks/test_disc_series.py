"""Entire functions in a disc whose roots are known, from their values on the circle."""

from math import pi

import pytest
from flint import acb, arb, ctx

from symflex.roots.networks.disc_search import DiscSide
from symflex.roots.networks.disc_series import DiscSeries, RootNearCircleError, points_needed

BITS = 160


@pytest.fixture(autouse=True)
def working_precision():
    with ctx.workprec(BITS):
        yield


def series(function, log_bound, radius=10.0, ratio=4.0, count=None):
    """Return a function's series; ``log_bound`` is that within ratio times the radius."""
    count = count or points_needed(log_bound, 0.0, ratio, 80)
    values = [function(radius * acb(0, 2 * arb.pi() * k / count).exp()) for k in range(count)]
    return DiscSeries.of(values, arb(radius), log_bound, ratio, BITS)


def hyperbolic_cosine():
    return series(lambda s: s.cosh(), 40.0)


def test_the_derivative_on_a_box_holds_those_of_its_points():
    found = hyperbolic_cosine()
    box = acb(arb(0.5, 1e-3), arb(0.2, 1e-3))
    slope = found.slope_on(box)
    for x in (acb(0.4995, 0.2005), acb(0.5, 0.2)):
        assert slope.overlaps(10 * (10 * x).sinh())


def test_roots_are_counted_with_their_multiplicities():
    # cosh vanishes at j pi (k + 1/2): six times within 10.
    assert hyperbolic_cosine().count() == 6
    assert series(lambda s: s**3 * (s - 2) ** 2 * (s + 20), 20.0).count() == 5
    assert series(lambda s: s * s * s.cosh(), 48.0).order_at_zero() == 2
    with pytest.raises(RootNearCircleError):
        series(lambda s: s - 10, 5.0).count()


def test_roots_are_counted_on_circles_whose_powers_exceed_floats():
    # A double root at 3 j, which s^2 + 9 squared has, and its mirror image.
    double = series(lambda s: (s * s + 9) ** 2, 16.0)
    for size in (1e-2, 1e-6, 1e-10):
        assert double.count_about(acb(0, arb(3) / 10), size) == 2
        assert double.count_about(acb(0, arb("0.305")), size) == (2 if size == 1e-2 else 0)


def test_all_roots_are_approximated_and_proved():
    found = hyperbolic_cosine()
    guesses = found.approximate(0)
    boxes = [found.proved(x) for x in guesses]
    assert all(box is not None for box in boxes)
    assert sorted(round(float(box.imag.mid()) * 10 / pi, 9) for box in boxes) == [
        -2.5,
        -1.5,
        -0.5,
        0.5,
        1.5,
        2.5,
    ]


def test_a_real_root_is_one_root_where_its_box_reaches_beyond_the_axis():
    found = series(lambda s: s - 3, 5.0)
    box = acb(arb(0.3, 1e-9), arb(1e-16, 1e-15))
    side = DiscSide(found, lambda x, _: 10 * x - 3, 1, ((box, 1),), 0, 0.0, is_even=False)
    assert side.found == found.count() == 1
    assert [(r.is_real, bool(r.re.contains(3)), bool(r.im == 0)) for r in side.all_roots(10)] == [(True,) * 3]

"""Minors of fundamental matrices in doubles, of equations whose solutions have names of their own."""

import mpmath
import numpy as np
import pytest

from symflex.along.doubles import fundamental_minors

BEAM = ((0, 1, 0), (1, 2, 0), (2, 3, 0), (3, 0, 1))
SECOND = ((0, 1, 0), (1, 0, 1))


def minors(along, places, bases, wanted, start=0.0, length=1.0):
    given = [np.atleast_1d(b) for b in bases]
    found = fundamental_minors(along, start, length, given, places, wanted)
    scales = found[len(wanted) :]
    return [v * np.exp(scales[len(rows) - 1]) for v, (rows, _) in zip(found, wanted, strict=False)]


def of_uniform_beams(x):
    return [1.0, 1.0, 1.0, 1.0]


def test_a_uniform_clamped_free_beam_has_cosh_cos_plus_one_at_real_and_complex_frequencies():
    for k in [0.01, 3.0, 40.0, 200.0]:
        # the fourth derivative is k^4 w: what is free after clamping vanishes with (1 + cosh k cos k)/2.
        (found,) = minors(of_uniform_beams, BEAM, [k**4], [((2, 3), (2, 3))])
        size = 1 + np.cosh(k) if k < 700 else 1
        assert abs(found[0] - (1 + np.cosh(k) * np.cos(k)) / 2) < 2e-13 * size
    k = 5 + 2j
    (found,) = minors(of_uniform_beams, BEAM, [k**4], [((2, 3), (2, 3))])
    assert found[0] == pytest.approx((1 + np.cosh(k) * np.cos(k)) / 2, rel=1e-12)


def test_a_coefficient_that_grows_with_x_makes_airy_functions():
    for u in [2.0, -3000.0, 40 - 900j]:
        (value, slope) = minors(
            lambda x: [1.0, x], SECOND, [complex(u)], [((0,), (0,)), ((1,), (0,))], start=0.5, length=1.5
        )
        with mpmath.workdps(40):
            k = mpmath.mpmathify(u) ** (mpmath.mpf(1) / 3)
            ai, bi, dai, dbi = (
                lambda x, f=f, d=d, k=k: k**d * f(k * x, derivative=d)
                for d in (0, 1)
                for f in (mpmath.airyai, mpmath.airybi)
            )
            wronskian = k / mpmath.pi
            expected = (ai(2) * dbi(0.5) - bi(2) * dai(0.5)) / wronskian
            steep = (dai(2) * dbi(0.5) - dbi(2) * dai(0.5)) / wronskian
            size = abs(expected) + abs(steep) / abs(mpmath.sqrt(u))
            assert abs(value[0] - expected) < 1e-12 * size, u
            assert abs(slope[0] - steep) < 1e-12 * size * abs(mpmath.sqrt(u))


def test_parameters_may_be_arrays():
    a = np.array([0.2, 0.7, 0.9])
    u = np.array([-50.0, 3.0, -2000.0])
    wanted = [((0,), (0,)), ((0, 1), (0, 1))]
    together = minors(lambda x: [1.0, 1 - a * x], SECOND, [u], wanted)
    for i in range(3):
        alone = minors(lambda x, i=i: [1.0, 1 - a[i] * x], SECOND, [u[i]], wanted)
        assert [t[i] for t in together] == pytest.approx([v[0] for v in alone], rel=1e-13)
        assert alone[1][0] == pytest.approx(1.0, rel=1e-12)  # the Wronskian


@pytest.mark.slow
def test_what_an_element_is_does_not_depend_on_others():
    u = -np.geomspace(1e-3, 1e6, 50)
    wanted = [((0,), (1,))]
    (together,) = minors(lambda x: [1.0, 1 / (1.1 - x) ** 4], SECOND, [u], wanted)
    for i in (0, 20, 49):
        (alone,) = minors(lambda x: [1.0, 1 / (1.1 - x) ** 4], SECOND, [u[i]], wanted)
        assert alone[0] == pytest.approx(together[i], rel=1e-15)


def test_more_waves_than_anyone_follows_are_no_number():
    (found,) = minors(of_uniform_beams, BEAM, [1e30], [((0,), (0,))])
    assert np.isnan(found[0])

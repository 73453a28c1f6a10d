"""Forms on pieces of the axis contain the function, at the functions for which bounds are attained."""

from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import pairwise
from math import inf
from types import SimpleNamespace

import mpmath as mp
import numpy as np
import pytest
from flint import acb, acb_mat, arb

import symflex
from symflex.analysis.norms.axis import (
    CIRCLE,
    CIRCLE_POINTS,
    ORDER,
    REACHES,
    MatrixOnAxis,
    ModalTerm,
    TaylorForm,
    norm,
)
from symflex.analysis.norms.expanded import expanded
from symflex.balls import precision
from tests.unit.analysis.norms.models import cantilever, response


def expanded_of(expression):
    model = symflex.Model(inputs={"u": {}}, outputs={"y": expression})
    return expanded(model.transfer_function("y", "u").bind().bound, 2)


def of_terms(*terms, constant=(), delays=()):
    """Return minus fractions c/(s - p)^k, of one output and one input, turned by a delay."""
    given = tuple(ModalTerm(acb(p), k, {(0, 0): acb(c)}) for p, k, c in terms)
    return MatrixOnAxis(((expanded_of("0*u"),),), given, constant, delays)


@pytest.mark.parametrize("delay", [0.0, 0.7])
def test_coefficients_are_those_of_taylor_and_the_last_has_the_values_at_both_ends(delay):
    # mpmath's derivatives of -exp(-T s) (2/(s + 0.1 - j) + 3/(s + 0.2)^2 + 5).
    low, high = 0.9, 1.3
    delays = ((arb(delay),),) if delay else ()
    matrix = of_terms((-0.1 + 1j, 1, 2), (-0.2, 2, 3), constant=((arb(5),),), delays=delays)

    def along(omega):
        s = mp.mpc(0, omega)
        return -mp.exp(-mp.mpf(delay) * s) * (2 / (s + mp.mpc("0.1", -1)) + 3 / (s + mp.mpf("0.2")) ** 2 + 5)

    form = matrix.in_disc(low, high)
    with mp.workdps(30):
        sharp = mp.taylor(along, mp.mpf(low + high) / 2, ORDER - 2)
        ends = [mp.taylor(along, mp.mpf(end), ORDER - 1)[-1] for end in (low, high)]
    for exact, found in zip(sharp, form.powers, strict=False):
        assert complex(found[0, 0].mid()) == pytest.approx(complex(exact), rel=1e-12)
        assert found[0, 0].rad() < 1e-12
    last = form.powers[-1][0, 0]
    for end in ends:
        near = acb(arb(float(end.real), 1e-9), arb(float(end.imag), 1e-9))
        assert last.real.overlaps(near.real) and last.imag.overlaps(near.imag)
    assert form.off == form.in_middle == 0 and len(form.powers) == ORDER
    assert complex(matrix.value(acb(0, 1.1))[0, 0].mid()) == pytest.approx(complex(along(mp.mpf("1.1"))))


def test_the_last_coefficient_is_no_wider_than_its_piece():
    # 2/(5 + j w)^6 is 2.9e-5 at 4 rad/s, and changes by 6*0.1/6.4 of it within 0.1 rad/s; balls by more.
    last = of_terms((-5, 1, 2)).in_disc(3.9, 4.1).powers[-1][0, 0]
    assert last.real.rad() + last.imag.rad() < 6 * 2.9e-5 * 6 * 0.1 / 6.4 < 2.9e-5


def test_values_on_a_ball_contain_those_at_its_rim():
    matrix = of_terms((-1 + 1j, 1, 2), (-2, 2, 3))
    ball = acb(arb(0, 0.05), arb(1.2, 0.1))
    found = matrix.value(ball)[0, 0]
    for s in (0.05 + 1.1j, -0.05 + 1.1j, 0.05 + 1.3j, -0.05 + 1.3j):
        exact = -2 / (s + 1 - 1j) - 3 / (s + 2) ** 2
        assert abs(exact.real - float(found.real.mid())) < float(found.real.rad())
        assert abs(exact.imag - float(found.imag.mid())) < float(found.imag.rad())


@dataclass
class Power:
    """((s - j)/radius)^power, which is 1 on all of the rim of a disc about j, and no larger within."""

    power: int
    radius: float

    def around(self, s):
        # What it is on the disc in a box, which is less than in its corners.
        return acb((min(s.real.rad(), s.imag.rad()) / self.radius) ** self.power)

    def at(self, s):
        return ((s - acb(0, 1)) / self.radius) ** self.power


@pytest.mark.parametrize("k", [0, 1, 5, CIRCLE_POINTS - 1])
def test_what_a_circle_of_values_takes_for_another_power_is_as_large_as_cauchy_allows(k):
    # On the circle of values (c e^(jx))^(14 + k) looks like c^14 (c e^(jx))^k: the error is attained.
    half = 0.125
    radius = half * REACHES[0]
    matrix = MatrixOnAxis(((Power(CIRCLE_POINTS + k, radius),),))
    form = matrix.beyond_disc(1 - half, 1 + half)
    with precision(128):
        error = CIRCLE**CIRCLE_POINTS / radius**k
        for n, m in enumerate(form.powers):
            assert m[0, 0].contains(0), n  # what the function has of this power
        assert max(form.powers[k][0, 0].real.rad(), form.powers[k][0, 0].imag.rad()) < 2.001 * error
        assert abs(form.powers[k][0, 0].mid()) > 0.99 * error


def test_what_powers_beyond_lack_is_attained_at_the_ends_of_a_piece():
    # (t/R)^14 at t = R/8 is all that is left out, of at most 1/8^14 (1 + 1/8 + 1/64 + ...).
    half = 0.125
    form = MatrixOnAxis(((Power(CIRCLE_POINTS, half * REACHES[0]),),)).beyond_disc(1 - half, 1 + half)
    share = 1 / REACHES[0]
    assert share**CIRCLE_POINTS <= form.off <= 1.001 * share**CIRCLE_POINTS / (1 - share)
    assert form.in_middle == 0


def test_no_form_is_found_where_a_pole_may_be_near():
    matrix = of_terms((1j, 1, 1))
    assert not matrix.beyond_disc(0.9, 1.1).is_finite
    assert matrix.beyond_disc(1.5, 1.6).is_finite


def test_the_tail_of_poles_on_the_axis_is_attained():
    # At 5 rad/s 2/(s - 3j) is 2/2, and with 8/(s - 3j)^2 of another entry the norm sqrt(1 + 4).
    zero = expanded_of("0*u")
    terms = (ModalTerm(acb(0, 3), 1, {(0, 0): acb(2)}), ModalTerm(acb(0, 3), 2, {(1, 0): acb(8)}))
    matrix = MatrixOnAxis(((zero,), (zero,)), terms)
    assert float(matrix.tail(5.0)) == pytest.approx(5**0.5, rel=1e-15)
    # 1/(s^2 + 9) by its fractions: 1/6 over 2 rad/s to each pole, counted as if both were that close.
    assert float(MatrixOnAxis(((expanded_of("u/(s^2 + 9)"),),)).tail(5.0)) == pytest.approx(1 / 6)
    assert matrix.tail(3.0) is None and matrix.tail(2.9) is None
    size, power = matrix.tail_power(5.0)
    assert (float(size), power) == (pytest.approx(5 * 5**0.5, rel=1e-15), -1)
    # A constant of 7 besides, which does not fall.
    more = MatrixOnAxis(((zero,), (zero,)), terms, ((arb(7),), (arb(0),)))
    size, power = more.tail_power(5.0)
    assert (float(size), power) == (pytest.approx(7 + 5**0.5, rel=1e-15), 0)
    assert complex(more.limit()[0, 0]) == -7
    assert [float(x.real) for x in more.entry(0, 0).value(acb(0, 4)).entries()] == [-7]
    assert more.entry(1, 0).terms[0].power == 2


@pytest.mark.parametrize(("power", "tail"), [(Fraction(1, 2), None), (0, 3), (Fraction(-1, 2), 1)])
def test_a_tail_is_bounded_where_it_does_not_grow(power, tail):
    # 3 w^p at 9 rad/s and beyond.
    size = SimpleNamespace(power=Fraction(power), most=arb(3))
    far_out = SimpleNamespace(size=lambda omega: size), Fraction(0)
    matrix = MatrixOnAxis(((SimpleNamespace(used=1.0, radius=2.0, far_out=far_out),),))
    found = matrix.tail(9.0)
    assert (found is None) if tail is None else float(found) == pytest.approx(tail)


def test_a_rational_part_that_is_nearly_the_function_is_subtracted_fraction_by_fraction():
    # 1/(s + 1) + 2/(s + 3) less 0.9/(s + 1 + d) and 2/(s + 3 - d) with d = 1e-10, in 40 digits.
    function, d = expanded_of("u/(s + 1) + 2*u/(s + 3)"), arb("1e-10").mid()
    terms = tuple(ModalTerm(acb(p), 1, {(0, 0): acb(c)}) for p, c in ((-1 - d, 0.9), (-3 + d, 2)))
    matrix = MatrixOnAxis(((function,),), terms)
    with precision(192):
        s = acb(0, 2)
        exact = 1 / (s + 1) + 2 / (s + 3) - acb(0.9) / (s + 1 + d) - 2 / (s + 3 - d)
        found = sum((f.weights[0, 0] / (s - f.pole) ** f.power for f in matrix.fractions), acb(0))
        assert found.overlaps(exact) and found.rad() < 1e-9
        assert matrix.in_disc(1.9, 2.1).powers[0][0, 0].overlaps(exact)


def test_powers_of_one_pole_are_subtracted_each_from_its_own():
    function = expanded_of("u/(s + 1) + 2*u/(s + 1)^2")
    terms = of_terms((-1, 1, 1), (-1, 2, 2)).terms
    for given in (terms, terms[::-1]):
        fractions = MatrixOnAxis(((function,),), given).fractions
        left = sum((f.weights[0, 0] / (acb(0, 2) - f.pole) ** f.power for f in fractions), acb(0))
        assert abs(left).upper() < 1e-15


def test_a_pole_that_the_rational_part_lacks_stays():
    matrix = MatrixOnAxis(((expanded_of("u/(s + 1) + 2*u/(s + 3)"),),), of_terms((-1, 1, 1)).terms)
    assert sorted(float(abs(f.weights[0, 0]).mid()) for f in matrix.fractions)[-1] == pytest.approx(2)
    only = MatrixOnAxis(((expanded_of("0*u"),),), of_terms((-1, 1, 1)).terms)
    assert [complex(f.weights[0, 0]) for f in only.fractions] == [-1]


def test_pieces_in_the_disc_cover_it_from_its_lower_end_to_twice_the_largest_pole():
    matrix = of_terms((-3 + 4j, 1, 1), (-2, 1, 1))
    parts, edge, sizes = matrix.in_discs(0.0, inf)
    assert (edge, sizes, parts[0][0], parts[-1][1]) == (10, [2, 5], 0, pytest.approx(10))
    assert all(a[1] == b[0] for a, b in pairwise(parts))
    at_rest = of_terms((0, 1, 1), (-2, 1, 1)).in_discs(0.0, inf)
    assert at_rest[0][0] == (0, pytest.approx(0.02)) and at_rest[1:] == (4, [2])
    parts, edge, _ = matrix.in_discs(1.0, 7.0)
    assert (edge, parts[0][0], parts[-1][1]) == (7, 1, pytest.approx(7))


def test_delays_turn_entries_by_their_part_of_a_period():
    zero = expanded_of("0*u")
    matrix = MatrixOnAxis(((zero, zero),), delays=((arb(0), arb(-0.5)),))
    assert matrix.turns(8 * np.pi) == pytest.approx(2)


def test_forms_multiply():
    form = TaylorForm((acb_mat(1, 1, [2]), acb_mat(1, 1, [1])), arb(0.5), arb(0))
    product = form.times(form, arb(1))
    assert [float(m[0, 0].real) for m in product.powers] == [4, 4, 1]
    assert float(product.off) >= 2 * 3 * 0.5 + 0.25
    # (2 + 1/2)(3 + 1/4) - 6: what both lack is attained where all have one sign.
    one, other = (TaylorForm((acb_mat(1, 1, [x]),), arb(off)) for x, off in ((2, 0.5), (3, 0.25)))
    assert float(one.times(other, arb(1)).off) == pytest.approx(2.5 * 3.25 - 6, rel=1e-12)


def test_the_size_of_a_form_is_attained_at_the_end_of_its_piece():
    form = TaylorForm((acb_mat(1, 1, [1]), acb_mat(1, 1, [2]), acb_mat(1, 1, [4])), arb(0))
    assert float(form.size(arb(3))) == pytest.approx(1 + 2 * 3 + 4 * 9)


def test_the_norm_of_a_ball_is_that_of_its_farthest_member():
    assert float(norm(acb_mat(1, 2, [acb(arb(2.5, 0.5)), acb(0, 4)]))) == pytest.approx(5)


@cache
def of_beam():
    return MatrixOnAxis(((expanded(cantilever().transfer_function("X", "F").bind().bound, 2),),))


def test_forms_contain_the_function_in_the_disc_and_beyond():
    matrix = of_beam()
    for form_on, low, high in ((matrix.in_disc, 900.0, 905.0), (matrix.beyond_disc, 9000.0, 9100.0)):
        form, middle = form_on(low, high), (low + high) / 2
        assert form.is_finite
        for omega in np.linspace(low, high, 5):
            with precision(128):
                t = arb(omega - middle)
                total = sum((m[0, 0] * t**k for k, m in enumerate(form.powers)), acb(0))
                off = abs(total - acb(response(omega))).lower()
            assert off <= form.off + 1e-15 * abs(response(omega)), omega


def test_tails_bound_the_function():
    matrix = of_beam()
    size, power = matrix.tail_power(1e5)
    for omega in (1e5, 1e6, 1e7):
        assert abs(response(omega)) <= float(matrix.tail(1e5))
        assert abs(response(omega)) <= float(size) * omega**power
    assert matrix.tail(1.0) is None

"""Roots inside, on and outside a region."""

from fractions import Fraction

import mpmath
import pytest
from flint import arb

import symflex
from symflex.roots import (
    Band,
    Everything,
    Mode,
    Modes,
    PolynomialInS,
    Rectangle,
    Root,
    RootProblem,
    find_pole_zero_map,
)
from tests.unit.roots.root_problems import from_roots, problem, with_pi

NOTHING = problem(1)


def rectangle(*sides):
    return Rectangle(*(Fraction(side) for side in sides))


def poles_in(region, polynomial, digits=20):
    found = find_pole_zero_map("y/u", polynomial, NOTHING, region, digits)
    return [(r.decimal(4).re, r.decimal(4).im, r.on_boundary) for r in found.poles]


def axis_pairs(*frequencies):
    """Undamped pairs at these angular frequencies."""
    factors = tuple((PolynomialInS.from_integers([w * w, 0, 1]), 1) for w in frequencies)
    return RootProblem(factors)


def pair(omega, on_boundary=False):
    return [("0", f"{omega:.3f}", on_boundary), ("0", f"-{omega:.3f}", on_boundary)]


AT_11_HZ = RootProblem(((with_pi(lambda pi, one: (484 * pi**2, 0 * one, one)), 1),))
RIGID, AT_ZERO = problem(0, 0, 1), ("0", "0", False)


def test_a_region_holds_what_lies_in_it_and_says_what_lies_on_its_boundary():
    for region, polynomial, expected in [
        # 6, 7 and 63 rad/s are 0.95, 1.11 and 10.03 Hz
        (Band(Fraction(1), Fraction(10)), axis_pairs(6, 7, 63), pair(7)),
        (Band(Fraction(1), Fraction(11)), AT_11_HZ, [("0", "69.12", True), ("0", "-69.12", True)]),
        # The rigid body belongs to bands from zero on.
        (Band(Fraction(0), Fraction(1)), RIGID, [AT_ZERO]),
        (Band(Fraction(1), Fraction(2)), RIGID, []),
        # A rectangle is closed, its edge exact on either axis, and may be a line or a point.
        (rectangle(-5, 0, -10, 10), axis_pairs(2, 20), pair(2, True)),
        (rectangle(-5, 0, 0, 10), problem(*from_roots([-1, -7])), [("-1.000", "0", True)]),
        (rectangle(0, 1, 0, 1), problem(0, 1), [("0", "0", True)]),
        (rectangle(1, 2, 0, 1), problem(0, 1), []),
        (rectangle(Fraction(1, 10), 1, -1, 1), problem(-1, 10), [("0.1000", "0", True)]),
        (rectangle(0, 0, -3, 3), axis_pairs(2, 5), pair(2, True)),
        (rectangle(0, 0, 2, 2), axis_pairs(2, 5), [("0", "2.000", True)]),
        # Modes count a conjugate pair once, a real root once, and rigid bodies not at all.
        (Modes(2), axis_pairs(1, 2, 3), pair(1) + pair(2)),
        (Modes(2), problem(*from_roots([-1, -2, -3])), [("-1.000", "0", False), ("-2.000", "0", False)]),
        (Modes(1), problem(0, 0, 36, 0, 13, 0, 1), [AT_ZERO, *pair(2)]),
        (Modes(0), problem(0, 0, 4, 0, 1), [AT_ZERO]),
        # Two of one frequency lie across the limit.
        (Modes(1), problem(-4, 0, 1), [("-2.000", "0", True), ("2.000", "0", True)]),
    ]:
        assert poles_in(region, polynomial) == expected, region


def test_a_root_1e_40_from_a_bands_end_is_decided():
    for shift, count in [(1, 0), (-1, 2)]:
        # (2 pi f)^2 with f = 11 (1 +- 1e-40) Hz
        f = Fraction(11) * (1 + shift * Fraction(1, 10**40))
        polynomial = with_pi(
            lambda pi, one, f=f: (4 * f.numerator**2 * pi**2, 0 * one, one * f.denominator**2)
        )
        found = poles_in(Band(Fraction(1), Fraction(11)), RootProblem(((polynomial, 1),)), digits=15)
        assert [flag for *_, flag in found] == [False] * count, shift


def test_modes_count_multiplicity_and_apply_to_zeros_as_well():
    found = find_pole_zero_map("y/u", problem(*from_roots([-1, -1, -1, -2])), NOTHING, Modes(2))
    assert [root.multiplicity for root in found.poles] == [3]
    found = find_pole_zero_map("y/u", axis_pairs(1, 3, 5), axis_pairs(2, 4), Modes(1))
    assert [root.decimal(2).im for root in found.zeros] == ["2.0", "-2.0"]


def axis_root(frequency, times=1):
    return Root(arb(0), arb(frequency), times, on_imaginary_axis=True, is_real=frequency == 0)


def classified(region, *roots):
    return "".join(position.name[0] for position in region.classify(roots))


def test_modes_and_the_mode_of_one_number_are_inside_and_no_others():
    for number, positions in [(1, "OIIOOOO"), (2, "OOOIOOO"), (3, "OOOIOOO"), (4, "OOOOIIO"), (5, "OOOOOOI")]:
        # Twice 0, a pair, a double root, a pair, a root.
        roots = [axis_root(w) for w in (0, 1, -1)] + [axis_root(2, 2)] + [axis_root(w) for w in (3, -3, 4)]
        assert classified(Mode(number), *roots) == positions
    roots = [axis_root(w) for w in (0, 1, -1)] + [axis_root(2, 2)] + [axis_root(w) for w in (3, -3)]
    found = [classified(Modes(count), *roots) for count in range(6)]
    assert found == ["IOOOOO", "IIIOOO", "IIIIOO", "IIIIOO", "IIIIII", "IIIIII"]


def test_two_roots_of_one_frequency_across_the_limit_are_on_it_where_they_mirror_each_other():
    pair = [Root(arb(re), arb(0), 1, on_imaginary_axis=False, is_real=True) for re in (-2, 2)]
    assert classified(Modes(1), *pair) == "BB"
    assert classified(Modes(2), *pair) == "II"
    # Of the same frequency as far as is known, and not the same.
    blurred = [
        Root(arb(re, r), arb(0), 1, on_imaginary_axis=False, is_real=True) for re, r in ((-2, 0.1), (2, 0.2))
    ]
    assert classified(Modes(1), *blurred) == "UU"


def test_regions_have_these_keys_as_data():
    for region, data in [
        (Everything(), {"kind": "everything"}),
        (Band(Fraction(1, 2), Fraction(3)), {"kind": "band", "low_hz": 0.5, "high_hz": 3.0}),
        (rectangle(-1, 2, -3, 4), {"kind": "rectangle", "re": [-1.0, 2.0], "im": [-3.0, 4.0]}),
        (Modes(7), {"kind": "modes", "count": 7}),
        (Mode(9), {"kind": "mode", "number": 9}),
    ]:
        assert region.to_json_dict() == data


def test_impossible_regions_are_refused():
    for make, message in [
        (lambda: Band(Fraction(2), Fraction(1)), "band"),
        (lambda: Band(Fraction(-1), Fraction(1)), "band"),
        (lambda: rectangle(1, 0, 0, 1), "^a rectangle needs RE0 <= RE1, IM0 <= IM1$"),
        (lambda: rectangle(0, 1, 1, 0), "^a rectangle needs RE0 <= RE1, IM0 <= IM1$"),
        (lambda: Modes(-1), "^the number of modes cannot be -1$"),
        (lambda: Mode(0), "^modes are numbered from 1, not 0$"),
    ]:
        with pytest.raises(ValueError, match=message):
            make()


@pytest.mark.parametrize("T", ["1e-8", "1e-12"])
def test_the_first_root_may_lie_on_the_circle_that_a_search_begins_with(T):
    """The root of ``s + 2 exp(-s T)`` is ``W(-2 T)/T``, next to -2; searches begin at powers of 2."""
    model = symflex.loads(
        f'symflex = 1\nparameters.T = "{T} s"\ninputs.u = {{}}\noutputs.y = "u/(s + 2*exp(-s*T))"\n'
    )
    (pole,) = model.transfer_function("y", "u").bind().poles(modes=1)
    assert pole.im == 0
    with mpmath.workdps(40):
        assert abs(pole.re - mpmath.lambertw(-2 * mpmath.mpf(T)).real / mpmath.mpf(T)) < 1e-12

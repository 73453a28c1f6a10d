"""From discs of s or of s^2 to roots, and what may be said of roots that could not be separated."""

from fractions import Fraction
from itertools import permutations, product

from flint import acb, arb, fmpq

from symflex.balls import precision
from symflex.roots import PolynomialInS, Root, RootProblem
from symflex.roots.polynomial_roots import _square_roots, find_polynomial_roots, in_order
from symflex.roots.polynomials.discs import Disc
from symflex.roots.problem import SquareFreePart

CORNERS = [(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1)]


def exact(value):
    with precision(2000):
        fraction = Fraction(value)
        return arb(fmpq(fraction.numerator, fraction.denominator)).mid()


def root(re, im, wide=0, **known):
    with precision(2000):
        box = arb(0, exact(wide))
        marks = {"multiplicity": 1, "on_imaginary_axis": False, "is_real": False, **known}
        return Root(exact(re) + box, exact(im) + box, **marks)


def part(*roots, in_square=False, multiplicity=1):
    coefficients = [Fraction(1)]
    for value in roots:
        longer = [Fraction(0), *coefficients]
        coefficients = [
            x - Fraction(value) * y for x, y in zip(longer, [*coefficients, Fraction(0)], strict=True)
        ]
    return SquareFreePart(PolynomialInS.from_rationals(coefficients), multiplicity, in_square)


def encloses(roots, point):
    with precision(2000):
        return any(each.enclosure().contains(point) for each in roots)


def points_of(disc):
    """Return points of a disc and of its mirror image: the centre, and eight next to the circle."""
    with precision(400):
        found = []
        for x, y in CORNERS:
            size = arb(x * x + y * y).sqrt() if x or y else arb(1)
            point = disc.centre + acb(x, y) / size * disc.radius * arb("0.999999")
            found += [point.mid(), point.mid().conjugate()]
        return found


def disc(re, im, radius, count=1):
    return Disc(acb(exact(re), exact(im)), exact(radius), count)


def test_square_roots_of_every_point_of_a_disc_are_enclosed():
    for count, place in product(
        [1, 2], [(4, 0), (-4, 0), (0.75, 0), (0, 4), (3, 5), (-3, 5), (1e-3, 4), (-1e-3, 4)]
    ):
        z = disc(*place, 0.5, count)
        found = _square_roots(z)
        is_real = place[1] == 0
        assert sum(r.multiplicity for r in found) == (2 if is_real else 4) * count, place
        assert all(r.certified is (count == 1) for r in found), (count, place)
        exact_zero = is_real and count == 1
        assert all((r.is_real or r.on_imaginary_axis) is exact_zero for r in found), (count, place)
        assert {type(mark) for r in found for mark in (r.is_real, r.on_imaginary_axis)} == {bool}, place
        assert not encloses(found, acb(0)), (count, place)
        points = [p for p in points_of(z) if not exact_zero or p.imag == 0]
        for point in points:
            with precision(400):
                s = point.sqrt()
                assert encloses(found, s), (count, place)
                assert encloses(found, -s), (count, place)


def test_a_disc_about_s_squared_that_may_hold_0_is_one_uncertified_box():
    for count, place in product([1, 2], [(0, 0, 1), (0.5, 0, 0.5), (0.3, 0.4, 0.5), (-0.25, 0, 0.5)]):
        z = disc(*place, count)
        (found,) = _square_roots(z)
        assert (found.certified, found.is_real, found.on_imaginary_axis) == (False, False, False), place
        assert found.multiplicity == (2 if place[1] == 0 else 4) * count
        for point in points_of(z):
            with precision(400):
                assert encloses([found], point.sqrt()), (count, place)
                assert encloses([found], -point.sqrt()), (count, place)


def test_roots_stand_by_natural_frequency_then_real_part_then_positive_imaginary_part_first():
    placed = [(0, 0), (-1, 0), (0, 2), (0, -2), (-3, 4), (-3, -4), (3, 4), (3, -4), (0, 5), (0, -5), (5, 0)]
    wanted = [(0, 0), (-1, 0), (0, 2), (0, -2), (-3, 4), (-3, -4), (0, 5), (0, -5), (3, 4), (3, -4), (5, 0)]
    for start in range(len(placed)):
        shuffled = placed[start:] + placed[:start]
        found = in_order([root(*place) for place in shuffled])
        assert [(int(float(r.re.mid())), int(float(r.im.mid()))) for r in found] == wanted


def test_roots_whose_frequencies_are_not_told_apart_stand_by_their_real_parts():
    for size in [1, 10**9, Fraction(1, 10**9)]:
        # Boxes about abs(s) = 5 and 5 (1 - 2e-13), both a part in 1e12 wide.
        wide = 5 * size / Fraction(10**12)
        left = root(-3 * size, 4 * size, wide)
        axis = root(0, 5 * size * (1 - Fraction(2, 10**13)), wide)
        lower = root(0, Fraction(49, 10) * size, wide)
        for start in permutations([left, axis, lower]):
            assert in_order(start) == (lower, left, axis), size


def product_of(*factors):
    return RootProblem(tuple((part(*roots).polynomial, exponent) for roots, exponent in factors))


def test_roots_at_zero_are_one_root_with_both_marks():
    (zero, other) = find_polynomial_roots(product_of(((0, 0, 3), 2)), 10)
    assert (zero.multiplicity, zero.on_imaginary_axis, zero.is_real) == (4, True, True)
    assert zero.re == zero.im == 0
    assert (other.multiplicity, other.is_real) == (2, True)

"""Roots proved together in a disc that holds so many, of functions whose roots are known."""

from itertools import product

from flint import acb, arb

from symflex.balls import precision
from symflex.roots.plane.local_roots import is_branched, prove_together
from tests.unit.roots.known_functions import KnownFunction

DIGITS = 12
BITS = 400


def beside(*offsets):
    """Return roots that lie so far from 2 + 3j."""
    with precision(BITS):
        return tuple((arb(2) + complex(z).real, arb(3) + complex(z).imag) for z in offsets)


def together(
    roots, count, *, start=1e-9 + 2e-9j, within=1e-2, even=False, is_close=False, power=1, digits=DIGITS
):
    function = KnownFunction(((roots, 1),), is_even=even, power=power)
    with precision(BITS):
        s = acb(2 + complex(start).real, 3 + complex(start).imag)
    return prove_together(function, s, arb(within), digits, count, even=even, is_close=is_close)


def holds(found, roots):
    with precision(BITS):
        return all(found.enclosure().contains(acb(*root)) for root in roots)


def test_a_root_of_any_multiplicity_is_enclosed_to_the_digits_wanted():
    for digits, count in product([3, 12, 60], [1, 2, 3]):
        roots = beside(*[0] * count)
        found = together(roots, count, digits=digits)
        assert holds(found, roots), (digits, count)
        assert (found.multiplicity, found.certified) == (count, count == 1), digits
        with precision(BITS):
            assert found.re.rad() < 4 * arb(10) ** -digits, count
            assert found.im.rad() < 4 * arb(10) ** -digits, count


def test_close_roots_are_enclosed_together_unless_they_have_to_agree():
    roots = beside(1e-6, -1e-6j)
    found = together(roots, 2)
    assert holds(found, roots)
    assert (found.multiplicity, found.certified) == (2, False)
    # Not much more than they take.
    assert 1e-7 < found.re.rad() < 1e-3
    assert together(beside(1e-6, -1e-6j), 2, is_close=True) is None
    assert together(beside(0, 0), 2, is_close=True) is not None
    assert together(beside(0, 1e-30), 2, is_close=True) is not None


def test_a_root_next_to_the_axis_lies_on_it_where_roots_mirror_each_other():
    for even, on_axis in [(True, True), (False, False)]:
        with precision(BITS):
            roots = ((arb(0), arb(10).sqrt()), (arb(0), -arb(10).sqrt()))
            start = acb(arb(10) ** -20, arb(10).sqrt().mid())
        function = KnownFunction(((roots, 1),), is_even=even)
        found = prove_together(function, start, arb(0.01), DIGITS, 1, even=even)
        assert found.on_imaginary_axis is on_axis, even
        assert found.im.overlaps(arb(10).sqrt()), even
        assert found.re.contains(0), even


def test_a_disc_is_branched_where_a_value_in_it_is_no_number():
    for within, branched in [(0.9, False), (1.1, True)]:

        class Root(KnownFunction):
            def value_and_slope(self, i, s):
                return 1 / s, acb(1)

        assert is_branched(Root((((1,), 1),)), acb(1), arb(within)) is branched
        assert is_branched(Root((((1,), 1),)), acb(0, 1), arb(within)) is branched

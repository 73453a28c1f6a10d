"""Limits of magnitudes as the frequency grows, against values derived by hand."""

from fractions import Fraction

import pytest
from flint import arb

from symflex.loops.delayed_limit import delayed_limit

AT_ONCE, LATER, LATEST = (), ((0, -1, 0),), ((0, -2, 0),)


def terms(given):
    return {
        exponent: {Fraction(p): arb(c) for p, c in enumerate(powers) if c}
        for exponent, powers in given.items()
    }


def test_a_limit_is_given_where_one_phase_makes_all_terms_extreme():
    # |2 + E|/|4 - E| with E = exp(-j omega T) is largest at E = 1, 3/3. With s: |4 s + 3 - s E| is larger.
    above = terms({AT_ONCE: (0, 2), LATER: (0, 1)})
    found = delayed_limit(above, terms({AT_ONCE: (3, 4), LATER: (0, -1)}))
    assert found.size.contains(1) and found.below_from == 0
    # |2 + E|/|4 + E| is at most 3/5; 3/3 would need E = 1 above and E = -1 below.
    assert delayed_limit(above, terms({AT_ONCE: (3, 4), LATER: (0, 1)})) is None


def test_of_one_delay_both_signs_are_taken_and_of_several_only_that_at_rest():
    # |2 - E|/|4 + E| is largest at E = -1, 3/3. |2 - E_1 - E_2| would need both to be -1, as E and E^2 never
    # are; at rest |2 + E_1 + E_2|/|4 - E_1 - E_2| is 4/2.
    found = delayed_limit(terms({AT_ONCE: (2,), LATER: (-1,)}), terms({AT_ONCE: (4,), LATER: (1,)}))
    assert found is not None and found.size.contains(1)
    other = ((1, -1, 0),)
    above = {AT_ONCE: (2,), LATER: (-1,), other: (-1,)}
    assert delayed_limit(terms(above), terms({AT_ONCE: (4,)})) is None
    above = {AT_ONCE: (2,), LATER: (1,), other: (1,)}
    found = delayed_limit(terms(above), terms({AT_ONCE: (4,), LATER: (-1,), other: (-1,)}))
    assert found is not None and found.size.contains(2)


def test_a_term_that_falls_faster_leaves_it_open_from_where_a_magnitude_is_below_its_limit():
    above = terms({AT_ONCE: (0, 2), LATER: (0, 1), LATEST: (1,)})
    found = delayed_limit(above, terms({AT_ONCE: (3, 4), LATER: (0, -1)}))
    assert found.size.contains(1) and found.below_from is None


def test_a_magnitude_is_below_its_limit_only_from_where_it_crosses_it():
    # |s^2 + 3|^2 - |s^2 + s + 1|^2 = 8 - 5 omega^2 on the axis.
    found = delayed_limit(terms({AT_ONCE: (3, 0, 1)}), terms({AT_ONCE: (1, 1, 1)}))
    crossing = (8 / 5) ** 0.5
    assert found.size.contains(1) and crossing <= found.below_from <= 2 * crossing
    assert found.below_from == pytest.approx((2 * 8 / 5) ** 0.5)  # Fujiwara's bound in omega^2

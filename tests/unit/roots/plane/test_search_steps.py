"""Each step of a search of the plane, with everything that it calls known beforehand."""

from __future__ import annotations

from cmath import exp
from itertools import product
from math import log, pi
from types import SimpleNamespace

import pytest
from flint import arb

from symflex.roots.counting.winding import Cell, RootOnPathError
from symflex.roots.plane import search as transcendental
from symflex.roots.plane.search import NEAR, RIGHT_HALF, SHARES, RootSearch, _is_in
from symflex.roots.root import Root

DIGITS = 17
PLACE = 0.7 + 1.9j
"""ln of where the roots are."""


def root(s, times=1):
    return Root(
        arb(s.real), arb(s.imag), times, on_imaginary_axis=s.real == 0, is_real=s.imag == 0, certified=True
    )


def cell_about(z, size):
    return Cell(z.real - size / 2, z.real + size / 2, z.imag - size / 2, z.imag + size / 2)


class Counting:
    """Stands for the winding of a function with so many roots at one place."""

    def __init__(self, power=1, *, is_even=False, blocked=0):
        self.function = SimpleNamespace(is_even=is_even, is_mirrored=is_even, power=power)
        self.blocked, self.counted, self.count_at_place = blocked, [], 1

    def sample(self, z):
        if z == PLACE:
            raise RootOnPathError
        return SimpleNamespace(slope=self.count_at_place / (z - PLACE))

    def count(self, cell):
        self.counted.append(cell)
        if len(self.counted) <= self.blocked:
            raise RootOnPathError
        return self.count_at_place


def search(**options):
    return RootSearch(Counting(**options), (), DIGITS)


@pytest.fixture
def known(monkeypatch):
    """Let proofs say what a test sets, and keep what they are asked."""
    answers = SimpleNamespace(simple=None, branched=False, together=None, asked={})

    def say(name, answer):
        def called(*given, **more):
            answers.asked[name] = (given, more)
            return getattr(answers, answer)

        monkeypatch.setattr(transcendental, name, called)

    say("prove_simple", "simple")
    say("is_branched", "branched")
    say("prove_together", "together")
    return answers


def together(one, size, count):
    """Look for so many roots from beside the place where they are."""
    one._winding.count_at_place = count
    return one._together(cell_about(PLACE + size / 5, size), count)


HERE = exp(PLACE)


def is_here(s):
    return abs(complex(s) - HERE) < 1e-9


def test_one_root_is_proved_where_newtons_method_ends(known):
    for is_even in [True, False]:
        known.simple = root(HERE)
        one = search(is_even=is_even)
        assert together(one, 0.3, 1) == [known.simple], is_even
        (function, s, digits), options = known.asked["prove_simple"]
        assert function is one.function, is_even
        assert is_here(s), is_even
        assert (digits, options) == (DIGITS, {"even": is_even})


def test_a_root_has_the_multiplicity_counted_by_the_power_and_lies_in_the_cell(known):
    known.simple = root(HERE, 2)
    assert together(search(power=3), 0.3, 6) == [known.simple]
    assert together(search(power=3), 0.3, 3) is None
    known.simple = root(exp(PLACE + 1))
    assert together(search(), 0.3, 1) is None
    assert together(search(), NEAR / 2, 1) is None


def test_about_a_place_without_a_box_a_circle_is_drawn_if_the_cell_is_small(known):
    for (size, asked), power in product([(NEAR * 0.99, True), (NEAR * 1.01, False)], [1, 2]):
        one, given = search(power=power), []
        one._about = lambda s, count, given=given: given.append((is_here(s), count)) or ["found"]
        assert together(one, size, power) == (["found"] if asked else None)
        assert given == [(True, power)] * asked


def test_newtons_method_that_leaves_the_cell_finds_nothing(known):
    one = search()
    known.simple = root(HERE)
    assert one._together(cell_about(PLACE + 0.5, 0.2), 1) is None
    # No slope, no step.
    one._winding.sample = lambda z: SimpleNamespace(slope=0)
    assert one._together(cell_about(PLACE, 0.2), 1) is None
    # Nor any end of it.
    steps = []
    one._winding.sample = lambda z: steps.append(z) or SimpleNamespace(slope=(-1) ** len(steps) * 1e3)
    assert one._together(cell_about(PLACE, 0.2), 1) is None
    assert len(steps) == transcendental.SEARCH_STEPS
    assert known.asked == {}


def test_several_roots_are_together_only_next_to_a_branch(known):
    known.together = root(HERE, 2)
    one = search(is_even=True)
    assert together(one, 0.3, 2) is None
    (function, s, radius), _ = known.asked["is_branched"]
    assert function is one.function
    assert is_here(s)
    assert float(radius) == pytest.approx(abs(HERE) * 1e-4, rel=1e-6)
    known.branched = True
    assert together(one, 0.3, 2) == [known.together]
    given, options = known.asked["prove_together"]
    assert given[0] is one.function
    assert is_here(given[1])
    assert (float(given[2]), *given[3:]) == (float(radius), DIGITS, 2)
    assert options == {"even": True, "is_close": True}
    known.together = root(exp(PLACE + 1), 2)
    assert together(one, 0.3, 2) is None
    known.together = None
    assert together(one, 0.3, 2) is None


# ------------------------------------------------------------------------------------------------- cells


def test_the_first_cut_is_made_where_roots_are_rare():
    for cell, first in [
        # A half plane and more is cut to the right of lightly damped roots.
        (Cell(0.0, 1.0, -0.03, pi + 0.03), RIGHT_HALF),
        (Cell(0.0, 3.1, -0.03, pi + 0.03), RIGHT_HALF),
        # A quarter, a part that begins to the left, and a longer ring are cut off their middle.
        (Cell(0.0, 1.0, -0.03, pi / 2), -0.03 + SHARES[0] * (pi / 2 + 0.03)),
        (Cell(0.0, 1.0, 0.0, pi), SHARES[0] * pi),
        (Cell(0.0, 1.0, 0.5, pi), 0.5 + SHARES[0] * (pi - 0.5)),
        (Cell(0.0, 3.3, -0.03, pi + 0.03), None),
    ]:
        one = search()
        (lower, counted), (upper, rest) = one._split(cell, 5)
        assert (counted, rest) == (1, 4), cell
        if first is None:
            assert (lower.high, upper.low) == pytest.approx((SHARES[0] * 3.3,) * 2), cell
        else:
            assert (lower.left, upper.right) == pytest.approx((first, first)), cell


def test_a_cut_through_a_root_is_made_elsewhere():
    one = search(blocked=2)
    cell = Cell(0.0, 1.0, 0.0, 0.5)
    (lower, _), (upper, _) = one._split(cell, 3)
    assert lower.high == upper.low == pytest.approx(SHARES[2])
    assert search(blocked=len(SHARES))._split(cell, 3) is None


def test_a_ring_whose_border_meets_a_root_is_widened_until_none_does():
    one = search(blocked=3)
    one._separate = lambda cell, count: ([root(HERE)], 2)
    found = one.ring(0.0, 1.0, 0.2, 1.0)
    assert len(one._winding.counted) == 4
    for inner, outer in zip(one._winding.counted, one._winding.counted[1:], strict=False):
        assert outer.low < inner.low
        assert inner.high < outer.high
        assert outer.right < inner.right
        assert inner.left < outer.left
    assert (found.roots, found.missing, found.cell) == ((root(HERE),), 2, one._winding.counted[-1])


def test_mirror_images_and_what_is_no_root_are_left_out():
    for is_even in [True, False]:
        kept = [root(2 + 1j), root(3 + 0j)]
        others = [root(-2 + 1j), root(1 - 1j), root(1 + 2j, 0)]
        one = search(is_even=is_even)
        one._together = lambda cell, count, roots=(*kept, *others): [*roots]
        found, missing = one._separate(cell_about(PLACE, 1), 5)
        assert found == (kept if is_even else [*kept, others[0]])
        assert missing == 0, is_even


def test_a_cell_without_roots_is_not_looked_at_and_one_that_is_too_small_not_cut():
    one = search()
    one._together = one._split = one._as_one = None
    assert one._separate(cell_about(PLACE, 1), 0) == ([], 0)
    one, given = search(), []
    one._together = lambda cell, count: None
    one._split = lambda cell, count: given.append(cell)
    one._as_one = lambda cell, count: [root(HERE)]
    one._separate(cell_about(PLACE, 0.5e-11), 1)
    assert given == []
    one._separate(cell_about(PLACE, 2e-11), 1)
    assert len(given) == 1


def test_a_cell_that_cannot_be_cut_is_looked_at_closer():
    one, given = search(), []
    one._together = lambda cell, count: None
    one._split = lambda cell, count: None
    one._as_one = lambda cell, count: given.append((cell, count)) or [root(HERE, 2)]
    cell = cell_about(PLACE, 1)
    assert one._separate(cell, 2) == ([root(HERE, 2)], 0)
    assert given == [(cell, 2)]
    one._as_one = lambda cell, count: None
    assert one._separate(cell, 2) == ([], 2)


def test_on_the_axes_a_root_met_twice_in_a_row_is_one(monkeypatch):
    one, asked = search(is_even=True), []
    places = {0.0: [log(3), log(3.001), log(9)], pi / 2: [log(3) + 0.5j * pi, log(7) + 0.5j * pi]}

    def changes(winding, low, high, angle):
        assert (winding, low, high) == (one._winding, 0.5, 2.5)
        return [complex(z) for z in places[angle]]

    def prove(function, s, digits, *, even):
        asked.append((function, digits, even))
        near = complex(s)
        known = [3, 3j, 7j]
        return next((root(complex(each)) for each in known if abs(near - each) < 0.1), None)

    monkeypatch.setattr(transcendental, "sign_changes", changes)
    monkeypatch.setattr(transcendental, "prove_simple", prove)
    assert one.on_axes(0.5, 2.5) == [root(3 + 0j), root(3j), root(7j)]
    assert asked == [(one.function, DIGITS, True)] * 5


def test_a_root_is_in_a_cell_by_its_logarithm_whatever_the_turn_and_a_hair_outside():
    for s, inside in [
        (exp(1 + 3.1j), True),
        # Beyond the negative axis arguments begin anew.
        (exp(1 - 3.1j), True),
        (exp(1 - 2.9j), False),
        (exp(1 + 2.9j), False),
        (exp(1.2 + 3.1j), False),
        (exp(0.8 - 3.1j), False),
    ]:
        assert _is_in(Cell(0.9, 1.1, pi - 0.2, pi + 0.2), root(s)) is inside
        assert _is_in(Cell(0.9, 1.1, -pi - 0.2, -pi + 0.2), root(s)) is inside
    for beside, inside in ((0.5e-11, True), (1e-10, False)):
        assert _is_in(Cell(0.5, 1.0, -0.1, 0.1), root(exp(1.0 + beside + 0j))) is inside


def test_roots_of_a_small_cell_are_one_if_they_are_a_multiple_of_the_power(known):
    known.together = root(HERE, 2)
    one = search(power=2, is_even=True)
    assert one._as_one(cell_about(PLACE, 1e-11), 4) == [known.together]
    given, options = known.asked["prove_together"]
    assert (given[0], given[3:], options) == (one.function, (DIGITS, 4), {"even": True})
    assert is_here(given[1])
    assert one._as_one(cell_about(PLACE, 1e-11), 3) is None
    known.together = None
    assert one._as_one(cell_about(PLACE, 1e-11), 4) is None

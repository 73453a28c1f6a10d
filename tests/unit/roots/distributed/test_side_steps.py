"""Each step of the search of one side, with searches and counts that answer what is known."""

from __future__ import annotations

from fractions import Fraction
from math import inf, log, pi

import pytest

from symflex.errors import BudgetError
from symflex.roots import Band, Modes, Rectangle
from symflex.roots.axes.lossless import LosslessSearch
from symflex.roots.counting.argument_principle import CertifiedWinding
from symflex.roots.counting.winding import Cell, RootOnPathError, Winding
from symflex.roots.distributed import proof
from symflex.roots.distributed.proof import WIDER, Proof
from symflex.roots.distributed.side import FEW
from symflex.roots.engines import GUESS_AND_PROVE, LOSSLESS, SUBDIVISION
from symflex.roots.plane.search import HIGHEST, Found, RootSearch
from tests.unit.roots.distributed_models import DELAY_LOOP, KELVIN_VOIGT
from tests.unit.roots.stand_ins import OVER, root, side


def places(roots):
    return [(float(r.re), float(r.im)) for r in roots]


class Answers:
    """What both kinds of searches answer, and what they are asked."""

    left = pi / 2
    is_even = True

    def __init__(self, roots=(), scans=(), axes=(), ring=None, fails=None, numbered=None):
        self.roots, self.missing, self.reached = list(roots), 2, 3.5
        self.scans, self.axes, self.found, self.fails = list(scans), list(axes), ring, fails
        self.one, self.asked, self.excluded = numbered, [], set()

    def smallest(self):
        return -1.25

    def passing(self, radius):
        return radius + 0.125

    def extend(self, modes, radius=-inf):
        self.asked.append(("extend", modes, radius))
        if self.fails:
            raise self.fails

    def scan(self, modes, radius, is_complete):
        self.asked.append(("scan", modes, radius))
        if self.fails:
            raise self.fails
        answer = self.scans.pop(0)
        return is_complete() if answer is None else answer

    def on_axes(self, low, high):
        self.asked.append(("axes", low, high))
        answer = self.axes.pop(0)
        if isinstance(answer, Exception):
            raise answer
        return answer

    def ring(self, low, high, right, left):
        self.asked.append(("ring", low, high, right, left))
        return self.found

    def numbered(self, number):
        self.asked.append(("numbered", number))
        if isinstance(self.one, Exception):
            raise self.one
        return self.one


class InPlane(Answers, RootSearch):
    pass


class Lossless(Answers, LosslessSearch):
    pass


def with_searches(*searches, scans):
    """Return a side that turns from one search to the next, each with or without scans."""
    one = side()
    left = list(zip(searches, scans, strict=True))

    def following():
        one._search, one._scans = left.pop(0)

    one._next_search = following
    following()
    return one


# ------------------------------------------------ one search after another


def test_searches_come_in_the_order_of_the_engines():
    one, seen = side(), []
    for _ in range(4):
        seen.append((one.engine, type(one._search).__name__, one._scans))
        one._next_search()
    assert seen == [
        (LOSSLESS, "LosslessSearch", True),
        (GUESS_AND_PROVE, "RootSearch", True),
        (GUESS_AND_PROVE, "RootSearch", False),
        (SUBDIVISION, "RootSearch", False),
    ]
    # After the last there is none.
    assert (one.engine, one._scans) == (SUBDIVISION, False)
    assert one._search._winding is one._winding


def test_what_does_not_mirror_is_not_scanned_along_axes():
    for text in [DELAY_LOOP, KELVIN_VOIGT]:
        one = side(text)
        assert (one.engine, one._scans) == (GUESS_AND_PROVE, False), text
        assert type(one._search._winding) is Winding, text
        assert (one._search.holes, one._search.digits) == (one.holes, 20), text
        one._next_search()
        assert (one.engine, one._scans) == (SUBDIVISION, False), text
        assert type(one._search._winding) is CertifiedWinding, text


def test_a_scan_that_is_complete_ends_the_search_and_a_domain_where_doubles_do():
    first = InPlane([root(0, 2)], scans=[True])
    one = with_searches(first, scans=[True])
    one.extend(3, 1.5)
    assert first.asked == [("scan", 3, 1.5)]
    first = InPlane()
    first.reached = inf
    one = with_searches(first, scans=[False])
    one.extend(1)
    assert one._domain == Cell(-inf, HIGHEST, 0.0, pi)


def test_a_scan_that_is_not_leads_to_the_next_search():
    first, second, third = (
        Lossless(scans=[False]),
        InPlane(scans=[False]),
        InPlane([root(0, 2), root(-1, 3), root(-2, 0)]),
    )
    one = with_searches(first, second, third, scans=[True, True, False])
    one.extend(3, 1.5)
    assert first.asked == second.asked == [("scan", 3, 1.5)]
    assert third.asked == [("extend", 3, 1.5)]
    assert one._innermost == -1.25
    assert one._domain == Cell(-inf, 3.5, 0.0, pi)
    assert one.missing == 2
    # Mirror images are added.
    assert sorted(places(one.roots)) == sorted(
        [(0, 2), (0, -2), (-1, 3), (-1, -3), (1, 3), (1, -3), (2, 0), (-2, 0)]
    )


def test_whether_a_scan_is_complete_is_counted():
    first = InPlane([root(0, 2)], scans=[None, None])
    one = with_searches(first, InPlane(), scans=[True, False])
    one.counted = lambda: Proof(2, len(one.roots))
    one.extend(1)
    assert places(one.roots) == [(0, 2), (0, -2)]
    one._search = first
    one._scans = True
    one.counted = lambda: Proof(3, len(one.roots))
    one.extend(1)
    assert one._search is not first


def test_what_was_found_until_a_search_was_broken_off_is_kept():
    for scans in [True, False]:
        one = with_searches(InPlane([root(0, 2)], fails=OVER), scans=[scans])
        with pytest.raises(BudgetError):
            one.extend(1)
        assert places(one.roots) == [(0, 2), (0, -2)], scans
        assert one.missing == 2, scans


# ------------------------------------------------ regions

BAND = Band(Fraction(1, 2), Fraction(3, 2))
LOW, HIGH = log(pi) - WIDER, log(3 * pi) + WIDER


class Circle:
    """Counts so many about 0, up to any radius."""

    def __init__(self, count=0, smallest=-2.0):
        self.answer, self.lowest, self.asked = count, smallest, []

    def smallest(self, left, holes):
        self.asked.append((left, holes))
        return self.lowest

    def count_within(self, z, left):
        self.asked.append((z, left))
        if self.answer is None:
            raise RootOnPathError
        return self.answer


def many(one, count=1000, smallest=-2.0):
    one._winding, one._lossless = Circle(count, smallest), None
    return one._winding


def test_axes_are_scanned_a_little_beyond_a_band_and_from_0_on_in_a_disc():
    first = InPlane(axes=[[root(0, 5)]])
    one = with_searches(first, scans=[True])
    many(one)
    one.counted = lambda: Proof(2, 2)
    one.search(BAND)
    assert first.asked == [("axes", pytest.approx(LOW - WIDER), pytest.approx(HIGH + 0.125 + 1.1 * WIDER))]
    assert (one._domain.low, one._domain.high) == pytest.approx(first.asked[0][1:])
    assert (one._domain.right, one._domain.left) == (0.0, pi)
    assert places(one.roots) == [(0, 5), (0, -5)]
    assert one._innermost is None
    first = InPlane(axes=[[]])
    one = with_searches(first, scans=[True])
    many(one)
    one.counted = lambda: Proof(0, 0)
    one.search(Band(Fraction(0), Fraction(3, 2)))
    assert one._domain.low == -inf
    assert first.asked[0][1] == pytest.approx(-2 - WIDER)
    assert one._innermost == -2


def test_axes_with_a_root_that_is_not_told_lead_to_the_plane():
    cell = Cell(LOW, HIGH, -0.03, 1.6)
    first, second = InPlane(axes=[RootOnPathError()]), InPlane(ring=Found((root(-1, 5),), 3, cell))
    one = with_searches(first, second, scans=[True, False])
    many(one)
    one.counted = lambda: Proof(len(one.roots), 1)
    one._located = [root(0, 1)]
    one.search(BAND)
    ((_, low, high, right, left),) = second.asked
    assert (low, high, right) == (pytest.approx(LOW), pytest.approx(HIGH + 0.125), 0)
    assert left >= pi / 2
    assert sorted(places(one.roots)) == [(-1, -5), (-1, 5), (1, -5), (1, 5)]
    assert (one.missing, one._domain) == (3, cell)


def test_a_ring_about_all_of_0_is_counted_as_a_disc():
    cell = Cell(-2.001, HIGH, -0.03, pi / 2 + 0.03)
    first = InPlane(ring=Found((), 0, cell))
    one = with_searches(first, scans=[False])
    many(one)
    one.search(Band(Fraction(0), Fraction(3, 2)))
    assert one._domain == Cell(-inf, cell.high, cell.right, cell.left)


def test_a_part_that_holds_few_is_searched_as_a_disc():
    for count, is_disc in ((FEW, True), (FEW + 1, False), (None, False)):
        first = InPlane(ring=Found((), 0, None))
        one = with_searches(first, scans=[False])
        counts = many(one, count)
        one.search(BAND)
        ((_, low, _, right, left),) = first.asked
        assert (low == -2) is is_disc
        assert (one._innermost == -2) is is_disc
        assert counts.asked[-1] == (pytest.approx(HIGH + 0.125 + WIDER), pi / 2)
        if is_disc:
            assert (right, left) == (0, pi)


def test_a_rectangle_off_the_axes_is_not_scanned_along_axes():
    first = InPlane(ring=Found((), 1, None))
    first.is_even, first.left = False, pi
    one = with_searches(first, scans=[True])
    many(one)
    one.search(Rectangle(Fraction(2), Fraction(3), Fraction(1), Fraction(2)))
    ((kind, low, high, right, left),) = first.asked
    assert kind == "ring"
    assert 0 < right < left < pi / 2
    assert low <= log(5**0.5) < log(13**0.5) <= high
    assert one._scans is False


def test_a_lossless_search_leaves_the_plane_to_the_next_and_modes_are_searched_by_number():
    first, second = Lossless(), InPlane(ring=Found((), 1, None))
    one = with_searches(first, second, scans=[False, False])
    many(one)
    one.search(BAND)
    assert (first.asked, len(second.asked)) == ([], 1)
    first = InPlane()
    one = with_searches(first, scans=[False])
    one.search(Modes(7))
    assert first.asked == [("extend", 7, -inf)]


# ------------------------------------------------ numbers and proofs


def test_a_mode_by_number_of_a_lossless_search_comes_with_its_image_only():
    first = Lossless(numbered=root(0, 7))
    one = with_searches(first, scans=[True])
    one._origin = [root(0, 0, 2)]
    found = one.numbered(3)
    assert places([found]) == [(0, 7)]
    assert places(one.roots) == [(0, 7), (0, -7)]
    assert first.asked == [("numbered", 3)]


def test_without_it_all_modes_below_are_found():
    for answer in [None, RootOnPathError()]:
        known = [root(0, 2, 2), root(0, 5), root(0, 9)]
        one = with_searches(Lossless(known, scans=[True], numbered=answer), scans=[True])
        one._origin = [root(0, 0, 2)]
        one._take(one._search)
        assert places([one.numbered(3)]) == [(0, 5)], answer
        assert one._search.asked == [("numbered", 3), ("scan", 3, -inf)], answer
        assert places(one.roots) == [(0, 5), (0, -5)], answer


def test_a_double_mode_has_two_numbers():
    for number, im in [(1, 2), (2, 2), (3, 5), (4, 9), (5, None)]:
        one = with_searches(InPlane([root(0, 5), root(0, 2, 2), root(0, 9)]), scans=[False])
        found = one.numbered(number)
        assert (found and float(found.im)) == im, number
        assert places(one.roots) == ([(0, im), (0, -im)] if im else []), number


def test_a_proof_that_lacks_something_is_left_to_subdivision():
    one, asked = side(), []
    one._subdivide = asked.append
    one._subdivided = lambda: Proof(7, 7)
    one.counted = lambda: Proof(3, 3)
    assert one.prove(BAND) == Proof(3, 3)
    one.counted = lambda: Proof(3, 2)
    assert asked == []
    assert one.prove(BAND) == Proof(7, 7)
    assert asked == [BAND]
    one._engines = (LOSSLESS, GUESS_AND_PROVE)
    assert one.prove(BAND) == Proof(3, 2)
    one.engine = SUBDIVISION
    assert one.prove(BAND) == Proof(7, 7)
    assert asked == [BAND]


def test_a_subdivision_goes_as_far_as_the_search_before():
    one, asked = with_searches(InPlane(), scans=[True]), []
    one.roots = [root(0, 0), root(0, 2), root(0, -2), root(-1, 0)]
    one.extend = lambda modes, radius: asked.append((modes, radius))
    one.search = asked.append
    one._subdivide(Modes(9))
    assert asked == [(2, 3.5)]
    assert (one.engine, one._scans) == (SUBDIVISION, False)
    assert one._search._winding is one._winding
    one._subdivide(BAND)
    assert asked[1:] == [BAND]


def test_neighbourhoods_not_met_are_not_left_out():
    one = with_searches(InPlane(), scans=[False])
    holes = Cell(0, 1, 2, 3), Cell(1, 2, 2, 3)
    one.holes = holes
    one._search.excluded = {holes[1]}
    assert one.excluded() == (holes[1],)
    one._search = None
    assert one.excluded() == ()


def test_blurred_roots_are_kept_once_and_exact_ones_put_in_their_place():
    one = with_searches(InPlane(), scans=[False])
    blurred = [root(0, 3, 2, 0.1, certified=False), root(0, 3.05, 2, 0.1, certified=False)]
    one._set([*blurred, root(0, 9)])
    assert sorted({abs(im) for _, im in places(one.roots)}) == [3, 9]
    one = with_searches(InPlane(), scans=[False])
    exact = root(0, 3)
    one._exact = [exact, root(0, -3), root(0, 7, 2)]
    one._set([root(0, 3, 1, 1e-9), root(0, 7, 1, 1e-9)])
    assert exact in one.roots
    # Of another multiplicity it is another.
    assert [r.im.is_exact() for r in one.roots if float(r.im) > 5] == [False, False]


class Right(Circle):
    """Counts of the right half plane; the first is of the disc about 0."""

    def __init__(self, within, right, smallest=-2.0):
        super().__init__(within, smallest)
        self.right, self.rings = right, []

    def count(self, cell):
        return self.right

    def count_right(self, low, high, angle):
        self.rings.append((low, high))
        return self.right


def test_the_right_half_plane_is_counted_between_two_half_circles(monkeypatch):
    for within, right, power, smallest, count in (
        (0, 4, 1, -2.0, 4),
        (0, 4, 2, -2.0, 2),
        (0, 3, 2, -2.0, None),
        (1, 4, 1, -2.0, None),
        (0, 4, 1, 5.0, 4),
    ):
        one, used = side(DELAY_LOOP), Right(within, right, smallest)
        used.function = one.function
        monkeypatch.setattr(proof, "CertifiedWinding", lambda *given, tries_series, used=used: used)
        one.function.power, one._order = power, 0
        if count is None:
            with pytest.raises(RootOnPathError):
                one.count_right(3.0)
            continue
        assert one.count_right(3.0) == count
        low = min(smallest, 2.0)
        assert used.rings == [(low, 3.0)]
        assert used.asked == [(pi, one.holes), (low, pi)]


def test_a_ring_holds_what_its_outer_circle_does_but_for_its_inner_circle_and_holes(monkeypatch):
    monkeypatch.setattr(proof, "is_whole_ring", lambda *given: True)
    monkeypatch.setattr(proof.Count, "within", lambda self, z: {(5.0, 1.5): 20, (1.0, 1.5): 6}[z, self.left])
    count = proof.Count(Right(0, 3), 0, (), 1.5)
    cells = [Cell(2, 3, 0, 1), Cell(3, 4, 0, 1)]
    monkeypatch.setattr(proof, "parts", lambda *given: ([], cells))
    assert count.turns(Cell(1.0, 5.0, 0.0, pi)) == 20 - 6 - 2 * 3
    monkeypatch.setattr(proof, "parts", lambda *given: ([], []))
    assert count.turns(Cell(-inf, 5.0, 0.0, pi)) == 20
    monkeypatch.setattr(proof, "is_whole_ring", lambda *given: False)
    monkeypatch.setattr(proof, "parts", lambda *given: (cells, []))
    assert count.turns(Cell(1.0, 5.0, 0.0, pi)) == 2 * 3


def test_without_losses_roots_within_a_circle_are_counted_along_the_axis():
    class Counts:
        def count(self, z):
            return 5 if z == 1.5 else 0

    circle = Circle(9)
    assert proof.Count(circle, 2, (), pi, Counts()).within(1.5) == 7
    assert proof.Count(circle, 2, (), 0.7).within(1.5) == 9
    assert circle.asked == [(1.5, 0.7)]

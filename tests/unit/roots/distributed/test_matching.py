"""What poles and zeros share, which roots are chosen, and what is said of them, with stand-ins."""

from __future__ import annotations

from cmath import exp as cexp
from cmath import phase
from dataclasses import dataclass, field
from fractions import Fraction
from math import inf, log

import pytest

from symflex import pipeline
from symflex.errors import BudgetError
from symflex.roots import Band, Modes, Rectangle
from symflex.roots.counting.winding import Cell
from symflex.roots.locate import (
    MATCHING_ROUNDS,
    _chosen,
    _exclusion,
    _find,
    _match,
    default_region,
    degenerate_points,
)
from tests.unit.roots.distributed_models import KELVIN_VOIGT, ON_A_FOUNDATION, ROD, SLIDING_FREE, bound
from tests.unit.roots.stand_ins import places, root


@dataclass
class StandIn:
    """A side with these roots; refined, they keep to their middle."""

    roots: list
    reached: float = -inf
    modes: int = 9
    asked: list = field(default_factory=list)
    searched: list = field(default_factory=list)

    def refined(self, given):
        return root(float(given.re.mid()), float(given.im.mid()), given.multiplicity)

    def extend(self, modes, radius=-inf):
        self.asked.append((modes, radius))

    def search(self, region):
        self.searched.append(region)


def matched(poles, zeros):
    sides = StandIn(list(poles)), StandIn(list(zeros))
    shared = _match(*sides)
    return places(shared), places(sides[0].roots), places(sides[1].roots)


def test_what_poles_and_zeros_share_is_neither_and_all_else_stays():
    assert matched([root(-1, 2)], [root(-1, 3), root(-2, 2)]) == ([], [(-1, 2, 1)], [(-1, 3, 1), (-2, 2, 1)])
    poles, zeros = [root(-1, 2), root(-3, 0)], [root(-4, 0), root(-1, 2)]
    assert matched(poles, zeros) == ([(-1, 2, 1)], [(-3, 0, 1)], [(-4, 0, 1)])


def test_of_a_multiple_root_the_smaller_multiplicity_is_shared():
    for pole, zero in [(3, 1), (1, 3), (2, 2)]:
        both = min(pole, zero)
        left = [[(-1, 2, n - both)] if n > both else [] for n in (pole, zero)]
        assert matched([root(-1, 2, pole)], [root(-1, 2, zero)]) == ([(-1, 2, both)], *left)


def test_enclosures_that_overlap_and_centre_elsewhere_are_not_shared():
    # Refined, both are known to be apart.
    assert matched([root(-1, 2, size=0.1)], [root(-1.05, 2, size=0.1)])[0] == []
    assert len(matched([root(-1, 2, size=0.1)], [root(-1, 2, size=0.01)])[0]) == 1


def test_what_is_shared_is_certified_where_both_are():
    for one, other in [(True, False), (False, True), (True, True)]:
        sides = StandIn([root(-1, 2, certified=one)]), StandIn([root(-1, 2, certified=other)])
        assert [r.certified for r in _match(*sides)] == [one and other]


class Sharing(StandIn):
    """A side that finds the same root in every round."""

    def extend(self, modes, radius=-inf):
        super().extend(modes, radius)
        self.roots = [root(-1, 2)]


def test_so_many_modes_are_lacking_that_it_is_given_up():
    poles, zeros = Sharing([], modes=1), Sharing([], modes=1)
    with pytest.raises(
        BudgetError, match=r"SF505.*: too many poles and zeros coincide to identify the modes"
    ) as e:
        _find((poles, zeros), Modes(3))
    assert e.value.diagnostics[0].hint == "ask for a band, which shows those that do not"
    assert [modes for modes, _ in poles.asked if modes] == [3 + 2 * k for k in range(MATCHING_ROUNDS)]


FIVE = [root(0, 0, 2), root(0, 4), root(0, -4), root(-7, 0, 2), root(0, 9), root(0, -9)]


def test_of_a_rectangle_what_lies_outside_is_left_out_and_what_lies_on_it_marked():
    found = _chosen(FIVE, Rectangle(Fraction(-5), Fraction(5), Fraction(-4), Fraction(9, 2)))
    assert [(float(r.im), r.on_boundary) for r in found] == [(0, False), (4, False), (-4, True)]


def test_without_a_region_the_models_own_is_searched():
    for analysis, region in [
        ("", Modes(5)),
        ("[analysis]\nmodes = 3", Modes(3)),
        ('[analysis]\nband = ["1 Hz", "9 Hz"]', Band(Fraction(1), Fraction(9))),
    ]:
        model = pipeline.loads(ROD + analysis)
        assert default_region(pipeline.derive_bound(model, model.transfer_functions)[0]) == region, analysis


def test_wavenumbers_vanish_where_their_law_does():
    for text, points in (
        # gamma = s; q^4 = s^2/4; gamma^2 = s^2 + 1
        (ROD, [(0, 0, 2)]),
        (SLIDING_FREE, [(0, 0, 2)]),
        (ON_A_FOUNDATION, [(0, -1, 1), (0, 1, 1)]),
        (KELVIN_VOIGT, [(0, 0, 2)]),
    ):
        assert sorted(places(degenerate_points(bound(text)))) == points


def test_a_neighbourhood_left_out_is_said_as_a_disc_about_its_point():
    for point, re, im in [(2j, 0.0, 2.0), (-5 + 0j, -5.0, 0.0), (3 + 4j, 3.0, 4.0), (5 + 0j, 5.0, 0.0)]:
        z = complex(log(abs(point)), phase(point))
        found = _exclusion(Cell(z.real - 0.05, z.real + 0.05, z.imag - 0.05, z.imag + 0.05))
        assert (found.re, found.im) == pytest.approx((re, im), abs=1e-12)
        # What lies on an axis lies on it exactly.
        assert all(x == y for x, y in ((found.re, re), (found.im, im)) if y == 0), (point, re)
        assert found.reason == "infinitely many roots accumulate there", (point, re)
        # All of the neighbourhood is in it, its farthest corner on its edge.
        farthest = abs(point) * abs(cexp(0.05 + 0.05j) - 1)
        assert found.radius == pytest.approx(farthest), (point, re)

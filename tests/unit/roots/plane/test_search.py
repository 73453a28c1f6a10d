"""Searches of cells of the plane."""

from cmath import exp, log
from dataclasses import dataclass, field

import pytest
from flint import acb, arb

from symflex.roots.counting.winding import Cell, Winding
from symflex.roots.functions.entire import Sample
from symflex.roots.plane.search import RootSearch, _starts
from tests.unit.roots.known_functions import KnownFunction


@dataclass
class Powers:
    """A product of ``z - root`` for each root, in z = ln(s), that counts its samples."""

    roots: tuple[complex, ...]
    power: int = 1
    is_even: bool = False
    samples: list[complex] = field(default_factory=list)

    @property
    def function(self):
        return self

    def sample(self, z):
        self.samples.append(z)
        return Sample(0j, sum(1 / (z - root) for root in self.roots))


def test_steps_between_several_roots_end_where_they_fall_no_more():
    # A step 2/(1/(z - a) + 1/(z - b)) is the harmonic mean of the ways to both roots, and leads to neither.
    winding = Powers((0.3 + 1j, -0.3 + 1j))
    cell = Cell(-0.5, 0.6, 0.5, 1.55)
    assert RootSearch(winding, (), 15)._together(cell, 2) is None
    assert len(winding.samples) < 6


def test_a_row_of_roots_goes_on_where_those_met_last_point_to():
    # The third of 0, 0.1, 0.21, ... lies a tenth of a step beside 0.2; those met draw no step back to them.
    row = (1j, 0.1 + 1j, 0.21 + 1j, 0.33 + 1j, 0.46 + 1j)
    winding, cell = Powers(row), Cell(-0.02, 0.5, 0.9, 1.1)
    start, _ = _starts(cell, row[:2])
    assert start == pytest.approx(0.2 + 1j)
    following = RootSearch(winding, (), 15)._next(cell, start, row[:2])
    assert following == pytest.approx(0.21 + 1j, abs=1e-9)
    assert len(winding.samples) < 6


@dataclass(frozen=True, eq=False)
class Sampled(KnownFunction):
    """A known function that paths follow as well; its roots spend nothing."""

    work: int = 0
    cancels: bool = False
    is_negated: bool = False
    count_at_zero: int = 0

    def at_logarithm(self, z):
        s = acb(exp(z))
        parts = [(*self.value_and_slope(i, s), e * self.power) for i, (_, e) in enumerate(self.factors)]
        if any(complex(value) == 0 for value, _, _ in parts):
            return None
        total = sum(e * log(complex(value)) for value, _, e in parts)
        return Sample(total, complex(s) * sum(e * complex(d) / complex(v) for v, d, e in parts))

    def order_at_zero(self):
        return self.count_at_zero * self.power

    def reach(self, s):
        return 3 * s


def search(*factors, holes=(), digits=12, **known):
    return RootSearch(Winding(Sampled(factors, **known)), holes, digits)


def pairs(*roots):
    """Return roots with their conjugates."""
    return tuple(r for x, y in roots for r in ((x, y), (x, -y))[: 2 if y else 1])


def listed(roots):
    return sorted((round(complex(r).imag, 6), round(complex(r).real, 6), r.multiplicity) for r in roots)


def test_a_ring_has_each_root_of_the_upper_half_plane_once_with_its_multiplicity():
    # Within 0.9 and 5.5 rad/s: -1, -1 + 2j, 3j of order 2 by its factor, 4 + 3j; neither -6 nor (1 + j)/8.
    outside = pairs((-6, 0), (0.125, 0.125))
    for power in (1, 2):
        known = search((pairs((-1, 0), (-1, 2), (4, 3)) + outside, 1), (pairs((0, 3)), 2), power=power)
        found = known.ring(log(0.9).real, log(5.5).real)
        assert found.missing == 0
        assert listed(found.roots) == [(0, -1, 1), (2, -1, 1), (3, 0, 2), (3, 4, 1)]
        assert all(r.certified for r in found.roots)


def test_even_functions_have_their_roots_in_the_right_quadrant_and_on_its_axes():
    quadrants = tuple(r for x, y in ((1, 2), (-1, 2)) for r in pairs((x, y)))
    roots = (*quadrants, (3, 0), (-3, 0), (0, 4), (0, -4))
    found = search((roots, 1), is_even=True, is_mirrored=True).ring(log(0.9).real, log(5.5).real)
    assert listed(found.roots) == [(0, 3, 1), (2, 1, 1), (4, 0, 1)] and found.missing == 0
    assert [r.on_imaginary_axis for r in sorted(found.roots, key=lambda r: complex(r).imag)] == [
        False,
        False,
        True,
    ]


def test_roots_that_no_cut_parts_are_one_disc():
    close = ((-1, 2), (arb(-1) + arb(2) ** -46, arb(2)))
    mirrored = tuple((x, -arb(y)) for x, y in close)
    found = search(((*close, *mirrored), 1)).ring(log(0.9).real, log(5.5).real)
    (root,) = found.roots
    assert (root.multiplicity, root.certified, found.missing) == (2, False, 0)


def test_a_search_goes_outwards_until_it_has_enough_modes_and_not_into_holes():
    roots = pairs(*((-0.01 * k, 2.0**k) for k in range(1, 7)))
    exact = tuple((arb(x), arb(y)) for x, y in roots)
    known = search((exact, 1))
    known.extend(2)
    assert {round(complex(r).imag) for r in known.roots} >= {2, 4} and len(known.roots) < 6
    before = known.reached
    known.extend(2)
    assert known.reached == before
    known.extend(0, log(65).real)
    assert sorted(round(complex(r).imag) for r in known.roots) == [2, 4, 8, 16, 32, 64]
    assert known.reached >= log(65).real and known.missing == 0
    hole = Cell(log(7).real, log(9).real, 1.4, 1.8)
    holed = search((exact, 1), holes=(hole,))
    holed.extend(0, log(20).real)
    assert sorted(round(complex(r).imag) for r in holed.roots)[:3] == [2, 4, 16]
    assert holed.excluded == {hole} and holed.missing == 0


@pytest.mark.parametrize(("radius", "passed"), [(0.5, 0.5), (0.9, 2.03), (2.0, 2.03), (2.01, 2.01)])
def test_a_circle_passes_a_hole(radius, passed):
    # Up to the largest nudge inside of it, 0.171, a circle may come to meet it.
    known = search((pairs((0, 1)), 1), holes=(Cell(1.0, 2.0, 1.0, 2.0),))
    assert known.passing(radius) == pytest.approx(passed)


def test_a_root_on_the_first_circle_is_found_by_moving_it():
    roots = pairs((0, 1), (0, 2))
    found = search((roots, 1)).ring(1e-3, 1.0)
    assert listed(found.roots) == [(1, 0, 1), (2, 0, 1)]


def test_what_is_counted_and_not_found_is_missing():
    known = search((pairs((0, 1)), 1))
    assert known._separate(Cell(-1e-12, 1e-12, 1.0, 1.0 + 1e-12), 3)[1] == 3
    assert known._separate(Cell(-1e-12, 1e-12, 1.0, 1.0 + 1e-12), -2)[1] == 2
    doubled = search((pairs((0, 1)), 1), power=2)
    assert doubled._separate(Cell(-1e-12, 1e-12, 1.0, 1.0 + 1e-12), 1)[1] == 1
    assert doubled._separate(Cell(-1e-12, 1e-12, 1.0, 1.0 + 1e-12), 6)[1] == 3

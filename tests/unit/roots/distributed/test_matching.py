"""What poles and zeros share, which roots are chosen, and what is said of them, with stand-ins."""

from __future__ import annotations

from cmath import exp as cexp
from cmath import phase
from fractions import Fraction
from math import log

import pytest

from symflex import pipeline
from symflex.roots import Band, Modes
from symflex.roots.counting.winding import Cell
from symflex.roots.distributed.proof import holes_about
from symflex.roots.locate import _exclusion, default_region, degenerate_points
from tests.unit.roots.distributed_models import KELVIN_VOIGT, ON_A_FOUNDATION, ROD, SLIDING_FREE, bound
from tests.unit.roots.stand_ins import places


def test_without_a_region_the_models_own_is_searched():
    for analysis, region in [
        ("", Modes(5)),
        ("[analysis]\nmodes = 3", Modes(3)),
        ('[analysis]\nband = ["1 Hz", "9 Hz"]', Band(Fraction(1), Fraction(9))),
    ]:
        model = pipeline.loads(ROD + analysis)
        assert default_region(model) == region, analysis


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


def test_neighbourhoods_that_meet_are_left_out_as_one():
    # Each reaches 0.05 in ln(s).
    for points, count in [
        ([2, 2 * 1.1], 1), ([2, 2 * 1.11], 2), ([2, 2 * cexp(0.099j)], 1), ([2, 2 * cexp(0.101j)], 2),
        # the third joins two that do not meet each other
        ([2, 2 * cexp(0.15j), 2 * cexp(0.07j)], 1), ([2, 3, 4, 3.05], 3)
    ]:  # fmt: skip
        assert len(holes_about([complex(p) for p in points])) == count, points

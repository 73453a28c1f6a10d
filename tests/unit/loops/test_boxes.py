"""Where sums of intervals may vanish, by geometry."""

from math import inf

import pytest
from flint import acb, arb

from symflex.loops.boxes import share_taken


@pytest.mark.parametrize(
    ("centre", "terms", "share", "parts"),
    [
        (3, [1, 1], 2 / 3, [1 / 3, 1 / 3]),
        (3, [1, -1], 2 / 3, [1 / 3, 1 / 3]),
        (1j, [0.5j], 0.5, [0.5]),
        # A square about 1.1 + 0.5 j has an edge at 0.1; towards its middle it takes 1.6 of 1.46.
        (1.1 + 0.5j, [1, 1j], 1 / 1.1, [1 / 1.1, 0]),
        (0.5 + 1.1j, [1, 1j], 1 / 1.1, [0, 1 / 1.1]),
        (1 + 1j, [0.5 + 0.5j], 0.5, [0.5]),
        (2 + 1j, [1 + 1j], 0, [0]),  # beside 0
        (0, [1], inf, [1]),
        # Balls count with the end that is worst.
        (2, [arb(0.5, 0.25)], 0.375, [0.375]),
        (arb(2, 0.5), [0.75], 0.5, [0.5]),
    ],
)
def test_terms_take_away_the_share_that_the_best_direction_shows(centre, terms, share, parts):
    found, own = share_taken(acb(centre), [acb(x) for x in terms])
    assert found == pytest.approx(share, rel=1e-8, abs=1e-12)
    assert own == pytest.approx(parts, rel=1e-8)


def test_terms_that_just_reach_0_take_all_away():
    for centre, terms in ((2, [1, 1]), (1 + 0.5j, [1, 1j]), (1, [1, 1j])):
        assert share_taken(acb(centre), [acb(x) for x in terms])[0] >= 1
        assert share_taken(acb(centre) * (1 + 2**-20), [acb(x) for x in terms])[0] < 1

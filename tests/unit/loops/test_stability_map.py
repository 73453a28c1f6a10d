"""Words about a range of a gain."""

from fractions import Fraction
from types import SimpleNamespace

import pytest

from symflex.loops.stability_map import _examined


@pytest.mark.parametrize(
    ("limits", "words"),
    [
        ((None, None), "every K"),
        ((Fraction(1), None), "K > 1"),
        ((None, Fraction(2)), "K < 2"),
        ((Fraction(1), Fraction(2)), "1 < K < 2"),
    ],
)
def test_the_range_that_was_examined_is_told(limits, words):
    stability = SimpleNamespace(limits=limits, gain="K", intervals=(1,), is_narrowed=False, nominal=None)
    assert _examined(stability) == words

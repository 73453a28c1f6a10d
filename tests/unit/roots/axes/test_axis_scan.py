"""Guesses on the axes: on a grid in doubles, and step by step in balls where doubles do not serve."""

from itertools import pairwise
from math import exp, pi

import numpy as np
import pytest
from mpmath import cos, findroot, mp, mpf, sin, tan, tanh

from symflex.roots.axes.axis_scan import sign_changes
from symflex.roots.counting.winding import Winding
from symflex.roots.functions.kernel_function import KernelFunction
from tests.unit.roots.distributed_models import ROD, SLIDING_FREE, bound

CLOSE = 1e-6
"""Relative, of guesses on a grid."""


class InBalls(KernelFunction):
    """A function that is not sampled in doubles."""

    in_doubles = None


def searched(text, kind=KernelFunction):
    source = bound(text, 0)
    return Winding(kind(source, source.den))


def sliding_free(n):
    """Return omega_n = x^2 with tan x + tanh x = 0."""
    return float(findroot(lambda x: tan(x) + tanh(x), (n - mpf(1) / 4) * mp.pi)) ** 2


def rod(n):
    """Return omega_n with omega tan omega = 2."""
    return float(findroot(lambda x: x * sin(x) - 2 * cos(x), (n - 1) * mp.pi + 2 / (n * mp.pi)))


def test_every_natural_frequency_is_met_once():
    for kind, text, expected in (
        (KernelFunction, SLIDING_FREE, sliding_free),
        (KernelFunction, ROD, rod),
        (InBalls, ROD, rod),
    ):
        found = sign_changes(searched(text, kind), 0.5, 5.0, pi / 2)
        wanted = [omega for n in range(1, 60) if exp(0.5) < (omega := expected(n)) < exp(5.0)]
        precise = CLOSE if kind is KernelFunction else 0.03
        assert [exp(z.real) for z in found] == pytest.approx(wanted, rel=precise), text
        assert all(z.imag == pi / 2 for z in found), text


def test_a_long_ray_is_searched_in_many_grids():
    found = [exp(z.real) for z in sign_changes(searched(SLIDING_FREE), 0.0, 19.0, pi / 2)]
    # tanh is one: neighbours are pi apart in x.
    steps = [np.sqrt(high) - np.sqrt(low) for low, high in pairwise(found[3:])]
    assert len(found) == int((exp(9.5) / pi) + 0.25)
    assert steps == pytest.approx([pi] * len(steps), rel=1e-3)


def test_there_are_none_on_the_real_axis_of_a_beam():
    assert sign_changes(searched(SLIDING_FREE), -3.0, 8.0, 0.0) == []

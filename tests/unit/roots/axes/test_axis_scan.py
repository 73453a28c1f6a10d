"""Guesses on the axes: on a grid in doubles, and step by step in balls where doubles do not serve."""

from __future__ import annotations

from itertools import pairwise
from math import exp, pi

import numpy as np
import pytest
from mpmath import cos, findroot, mp, mpf, sin, sinh, sqrt, tan, tanh

from symflex.budget import Budget
from symflex.roots import Modes
from symflex.roots.axes.axis_scan import sign_changes
from symflex.roots.counting.winding import Winding
from symflex.roots.functions.kernel_function import KernelFunction
from tests.unit.roots.distributed_models import ROD, SLIDING_FREE, bound
from tests.unit.roots.stand_ins import poles_by

CLOSE = 1e-6
"""Relative, of guesses on a grid."""


class InBalls(KernelFunction):
    """A function that is not sampled in doubles."""

    in_doubles = None


def searched(text, kind=KernelFunction):
    source = bound(text, 0)
    return Winding(kind(source, source.den), Budget())


def bending_part(function):
    """Return the number of the factor with kernels."""
    (number,) = (i for i, (terms, _) in enumerate(function.exponentials) if len(terms.terms) > 1)
    return number


def sliding_free(n):
    """Return omega_n = x^2 with tan x + tanh x = 0."""
    return float(findroot(lambda x: tan(x) + tanh(x), (n - mpf(1) / 4) * mp.pi)) ** 2


def rod(n):
    """Return omega_n with omega tan omega = 2."""
    return float(findroot(lambda x: x * sin(x) - 2 * cos(x), (n - 1) * mp.pi + 2 / (n * mp.pi)))


@pytest.mark.parametrize("kind", [KernelFunction, InBalls])
@pytest.mark.parametrize(("text", "expected"), [(SLIDING_FREE, sliding_free), (ROD, rod)])
def test_every_natural_frequency_is_met_once(kind, text, expected):
    found = sign_changes(searched(text, kind), 0.5, 5.0, pi / 2)
    wanted = [omega for n in range(1, 60) if exp(0.5) < (omega := expected(n)) < exp(5.0)]
    precise = CLOSE if kind is KernelFunction else 0.03
    assert [exp(z.real) for z in found] == pytest.approx(wanted, rel=precise)
    assert all(z.imag == pi / 2 for z in found)


def test_a_long_ray_is_searched_in_many_grids():
    found = [exp(z.real) for z in sign_changes(searched(SLIDING_FREE), 0.0, 19.0, pi / 2)]
    # tanh is one: neighbours are pi apart in x.
    steps = [np.sqrt(high) - np.sqrt(low) for low, high in pairwise(found[3:])]
    assert len(found) == int((exp(9.5) / pi) + 0.25)
    assert steps == pytest.approx([pi] * len(steps), rel=1e-3)


def test_there_are_none_on_the_real_axis_of_a_beam():
    assert sign_changes(searched(SLIDING_FREE), -3.0, 8.0, 0.0) == []


@pytest.mark.parametrize("apart", ["1e-3", "1e-8"])
def test_two_roots_in_one_step_are_both_met(apart):
    # Two rods that only a soft spring joins: omega = (2 n - 1) pi/2, and a little more for the other.
    text = f"""
symflex = 1
[elements]
one = {{ type = "rod", between = ["ground", "x"], E = "1 Pa", A = "1 m^2", rho = "1 kg/m^3", l = "1 m" }}
two = {{ type = "rod", between = ["ground", "y"], E = "1 Pa", A = "1 m^2", rho = "1 kg/m^3", l = "1 m" }}
tie = {{ type = "spring", between = ["x", "y"], k = "{apart} N/m" }}
[inputs]
F = {{ force = "x" }}
[outputs]
X = "x"
"""
    source = bound(text, 0)
    found = poles_by("guess-and-prove", source, Modes(6), 20)
    upper = sorted(float(root.im.mid()) for root in found if root.im > 0)
    alone = [(n - 0.5) * pi for n in (1, 2, 3)]
    # In phase the spring does not work; against each other it does twice: omega cot omega = -2 k.
    tied = [float(findroot(lambda x: x * cos(x) + 2 * mpf(apart) * sin(x), x)) for x in alone]
    assert upper == pytest.approx(sorted([*alone, *tied]), rel=1e-14)


def test_where_doubles_lose_all_digits_balls_take_over():
    # A free beam far below its first resonance: a sum of ones that is s^4 or so in the end.
    winding = searched(SLIDING_FREE)
    function = winding.function
    (low,) = function.in_doubles.sampled(np.array([-50.0]), pi / 2, [bending_part(function)])
    assert low.share[0] < 1e-10
    assert sign_changes(winding, -50.0, 2.5, pi / 2) == sign_changes(
        searched(SLIDING_FREE, InBalls), -50.0, 2.5, pi / 2
    )


def test_sums_in_doubles_are_the_function():
    # E I rho A = 1: F is sinh 2q + sin 2q, s = 2 q^2, but for constants and powers of q.
    function = searched(SLIDING_FREE).function
    places, angle = np.array([0.3, 1.7, 4.0]), 0.4
    (found,) = function.in_doubles.sampled(places, angle, [bending_part(function)])
    wanted = []
    for place in places:
        q = sqrt(mp.expj(angle) * mp.exp(place) / 2)
        wanted.append(mp.log(sinh(2 * q) + sin(2 * q)))
    slopes = np.diff(found.size - [float(w.real) for w in wanted]) / np.diff(places) * 4
    power = round(slopes[0])
    assert slopes == pytest.approx([power, power], abs=1e-12)
    turned = (found.phase - [float(w.imag) for w in wanted]) / (2 * pi)
    assert (turned - turned[0] - np.round(turned - turned[0])) == pytest.approx([0, 0, 0], abs=1e-12)

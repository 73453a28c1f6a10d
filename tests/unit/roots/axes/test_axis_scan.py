"""Guesses on the axes: on a grid in doubles, and step by step in balls where doubles do not serve."""

from __future__ import annotations

from cmath import log as clog
from itertools import pairwise
from math import exp, log, pi
from types import SimpleNamespace

import numpy as np
import pytest
from mpmath import cos, findroot, mp, mpf, sin, sinh, sqrt, tan, tanh

from symflex.roots import Modes
from symflex.roots.axes.axis_scan import (
    LONGEST,
    _changes_sign,
    _pieces,
    _secants,
    _step_by_step,
    sign_changes,
)
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
    return Winding(kind(source, source.den))


def bending_part(function):
    """Return the number of the factor with kernels."""
    (number,) = (i for i, (terms, _) in enumerate(function.exponentials[1]) if len(terms.terms) > 1)
    return number


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


def test_two_roots_in_one_step_are_both_met():
    for apart in ["1e-3", "1e-8"]:
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
        k = mpf(apart)
        tied = [float(findroot(lambda x, k=k: x * cos(x) + 2 * k * sin(x), x)) for x in alone]
        assert upper == pytest.approx(sorted([*alone, *tied]), rel=1e-14), apart


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


# -------------------------------------------------------------- each step, of known functions of ln(s)


class Ray:
    """Stands for the winding of a real function of place = ln(abs(s)), given with its derivative."""

    def __init__(self, value, slope, fastest=0.0, power=1):
        self.value, self.slope, self.speed, self.power = value, slope, fastest, power
        self.places, self.spent, self.angles = [], 0, set()
        self.function = self
        self.in_doubles = None

    def spend(self):
        self.spent += 1

    def fastest(self, z):
        self.angles.add(z.imag)
        return self.speed(z.real) if callable(self.speed) else self.speed

    def at_logarithm(self, z, *, is_simple):
        assert is_simple
        self.places.append(z.real)
        self.angles.add(z.imag)
        value = self.value(z.real)
        if value == 0:
            return None
        return SimpleNamespace(
            log=self.power * clog(complex(value)), slope=complex(self.power * self.slope(z.real) / value)
        )

    def sample(self, place):
        return self.at_logarithm(complex(place, 0.0), is_simple=True)

    def pieces(self, start, end):
        one, other = self.sample(start), self.sample(end)
        self.places.clear()
        return [(a, b) for a, _, b, _ in _pieces(self, start, one, end, other, 0.0)]


def parabola(*roots):
    """Return the function that is zero at two places, and its derivative."""
    a, b = roots
    return Ray(lambda x: (x - a) * (x - b), lambda x: 2 * x - a - b)


def sine(rate):
    return Ray(lambda x: np.sin(rate * x), lambda x: rate * np.cos(rate * x), fastest=rate)


def test_every_change_of_sign_is_met_once_in_order():
    for rate in [1.0, 5.0, 40.0]:
        ray = sine(rate)
        found = list(_step_by_step(ray, 0.01, 4.0, 0.3))
        assert found == pytest.approx(
            [n * pi / rate for n in range(1, int(4 * rate / pi) + 1)], abs=0.2 / rate
        )
        assert found == sorted(found), rate
        assert ray.angles == {0.3}, rate


def test_two_roots_in_one_step_are_met_by_its_slopes():
    for roots, count in [
        ((0.4, 0.6), 2),
        ((0.8, 0.9), 2),
        ((0.3, 0.4), 2),
        ((0.6, 0.66), 2),
        ((0.1, 0.15), 2),
        ((0.4, 3.0), 1),
        ((-2.0, 3.0), 0),
    ]:
        ray = parabola(*roots)
        ray.speed = 0.0
        found = [
            (a, b)
            for a, first, b, last in _pieces(ray, 0.0, ray.sample(0.0), 1.0, ray.sample(1.0), 0.0)
            if _changes_sign(ray, first, last)
        ]
        assert len(found) == count, roots
        assert all(any(a < r < b for r in roots) for a, b in found), roots


def test_secants_close_in_on_a_change_of_sign():
    for value, low, high, root in (
        (lambda x: x * x - 2, 1.0, 2.0, 2**0.5),
        (lambda x: 2 - x * x, 1.0, 2.0, 2**0.5),
        (lambda x: np.exp(3 * x) - 5, 0.0, 1.0, log(5) / 3),
        (np.cos, 1.0, 2.5, pi / 2),
    ):
        asked = []

        def sampled(places, turned, numbers, value=value, asked=asked):
            asked.append((turned, numbers))
            values = value(np.asarray(places, float))
            return [SimpleNamespace(size=np.log(np.abs(values)), phase=np.angle(values + 0j) + 0.7)]

        ends = []
        for place in (low, high):
            (sample,) = sampled([place], 0.3, [4])
            ends.append((np.array([place]), sample.size, sample.phase))
        (found,) = _secants(SimpleNamespace(sampled=sampled), 4, ends, 0.3)
        assert found == pytest.approx(root, abs=3e-3 * (high - low))
        assert asked == [(0.3, [4])] * (2 + 4), root


class Grid(Ray):
    """The same, sampled in doubles too, as one of the factors of a product."""

    def __init__(self, value, slope, fastest=0.0, *, exponents=(1,), share=1.0, noise=0.0):
        super().__init__(value, slope, fastest)
        self.part = SimpleNamespace(factors=[(None, exponent) for exponent in exponents])
        self.in_doubles = SimpleNamespace(fastest=self.fastest, sampled=self.sampled)
        self.share, self.noise, self.numbers, self.grids = share, noise, set(), []

    def sampled(self, places, turned, numbers):
        self.numbers.add(tuple(numbers))
        self.angles.add(turned)
        self.grids.append(places)
        values = self.value(np.asarray(places, float))
        phase = np.angle(values + 0j) + self.noise * (np.arange(len(values)) == 1)
        share = np.where(np.arange(len(values)) == 1, self.share, 1.0)
        return [SimpleNamespace(size=np.log(np.abs(values)), phase=phase, share=share) for _ in numbers]


def on_grid(ray, low=0.1, high=3.0):
    return [z.real for z in sign_changes(ray, low, high, pi / 2)]


def test_on_grids_every_change_of_sign_is_met_once_and_closely():
    for rate in [1.0, 9.0, 70.0, 9000.0]:
        ray = Grid(lambda x, k=rate: np.sin(k * x), lambda x, k=rate: k * np.cos(k * x), fastest=rate)
        expected = [n * pi / rate for n in range(1, int(3 * rate / pi) + 1) if n * pi / rate > 0.1]
        assert on_grid(ray) == pytest.approx(expected, abs=1e-3 / rate)
        assert ray.places == [], rate
        assert ray.angles == {pi / 2 - 1e-13}, rate
        # Neighbours are as close as an exponent allows, and what is sampled at once is bounded.
        assert np.diff(ray.grids[0]).max() <= min(LONGEST, 1 / rate) * (1 + 1e-9)
        assert max(len(grid) for grid in ray.grids) <= 4096 + 3, rate


def test_where_doubles_do_not_tell_balls_are_asked():
    for share, noise, in_balls in [
        (1.0, 0.0, False),
        (0.9e-10, 0.0, True),
        (1.1e-10, 0.0, False),
        (1.0, 0.09, False),
        (1.0, 0.11, True),
    ]:
        ray = Grid(np.sin, np.cos, fastest=1.0, share=share, noise=noise)
        assert on_grid(ray, 2.0, 4.0) == pytest.approx([pi], abs=0.05), (share, noise)
        assert bool(ray.places) is in_balls, (share, noise)


def test_a_dip_between_points_of_a_grid_is_looked_at_step_by_step():
    # Two roots in less than a step.
    ray = Grid(lambda x: (x - 1.05) * (x - 1.07), lambda x: 2 * x - 2.12)
    assert on_grid(ray, 0.5, 1.5) == pytest.approx([1.05, 1.07], abs=0.02)
    assert ray.places
    assert max(ray.places) - min(ray.places) < 2.1 * LONGEST
    assert ray.angles == {pi / 2 - 1e-13}
    # One that does not reach zero.
    assert on_grid(Grid(lambda x: (x - 1.03) ** 2 + 1e-3, lambda x: 2 * x - 2.06), 0.5, 1.5) == []

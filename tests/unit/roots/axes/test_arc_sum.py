"""Turns of sums of exponentials on an arc where they are known: of one term, about roots, and bounds."""

from cmath import exp, rect
from itertools import product
from math import cos, log, pi, sin, sqrt
from random import Random

import numpy as np
import pytest
from flint import acb, arb

from symflex.balls import precision
from symflex.roots.axes.harmonic_sum import OUTWEIGHED, ArcSum, ArcTerm, _Arc, _most
from symflex.roots.counting.winding import RootOnPathError


@pytest.fixture(autouse=True)
def working_precision():
    with precision(64):
        yield


def term(p, q, powers):
    """Return a term given numbers, and the coefficients of powers of x by their exponents."""
    return ArcTerm(acb(p), acb(q), tuple((n, acb(c)) for n, c in powers.items()))


def polynomial(*roots):
    """Return the product of all x - root."""
    coefficients = [acb(1)]
    for root in roots:
        shifted = [acb(0), *coefficients]
        coefficients = [a - root * b for a, b in zip(shifted, [*coefficients, acb(0)], strict=True)]
    return ArcSum((ArcTerm(acb(0), acb(0), tuple(enumerate(coefficients))),))


def test_one_term_turns_by_its_exponent_and_its_power():
    for radius, (p, q, n) in product(
        [0.3, 7.0, 5000.0],
        [(0, 0, 0), (0, 0, 3), (2 - 1j, 0, 0), (0, 1.5j, 2), (-1 + 0.5j, 2, 1), (3, -2 - 1j, 4)],
    ):
        end = radius * rect(1, pi / 4)
        turned = (p * (end - radius) + q * (end**2 - radius**2)).imag + n * pi / 4
        found = ArcSum((term(p, q, {n: -2 + 3j}),)).turn(arb(radius))
        assert float(found) == pytest.approx(turned, rel=1e-12, abs=1e-12), (radius, p, q)
        assert found.rad() < 1e-9, (radius, p, q)


def test_passing_one_root_adds_a_whole_turn():
    for angle in [0.01, pi / 8, 0.5, pi / 4 - 0.01]:
        # exp(x - root) - 1, next to whose root no others lie.
        root = acb(3 * rect(1, angle))
        terms = (term(1, 0, {0: (-root).exp()}), term(0, 0, {0: -1}))
        below, above = (ArcSum(terms).turn(arb(3 * scale)) for scale in (1 - 1e-7, 1 + 1e-7))
        assert abs(above - below - 2 * arb.pi()) < 1e-4, angle


def test_a_root_on_the_arc_and_a_function_that_is_zero_are_refused():
    zero = ArcSum((term(1, 0, {0: 1}), term(1, 0, {0: -1})))
    for refused in (*(polynomial(2 * rect(1, where)) for where in (0.0, 0.3, pi / 4)), zero):
        with pytest.raises(RootOnPathError):
            refused.turn(arb(2))


def test_a_root_beside_the_arc_adds_no_turn():
    for angle in [-0.01, pi / 4 + 0.01]:
        # x - root turns by what it turns as seen from the root: from end to end, on one side.
        root, radius = 2 * rect(1, angle), 2.0
        start, end = radius - root, radius * rect(1, pi / 4) - root
        turned = (acb(end) / acb(start)).arg()
        assert abs(polynomial(root).turn(arb(radius)) - turned) < 1e-9, angle


SUMS = [
    # sinh(x) sin(x), cosh(2x) - cos(2x), x cosh(x) cos(x) + exp(x)
    {(1 + 1j, 0): {0: 1}, (1 - 1j, 0): {0: -1}, (-1 + 1j, 0): {0: -1}, (-1 - 1j, 0): {0: 1}},
    {(2, 0): {0: 1}, (-2, 0): {0: 1}, (2j, 0): {0: -1}, (-2j, 0): {0: -1}},
    {(1 + 1j, 0): {1: 1}, (1 - 1j, 0): {1: 1}, (1, 0): {0: 2}, (-1 + 1j, 0): {1: 1}, (-1 - 1j, 0): {1: 1}},
]


# ------------------------------------------------ compared with samples of the same sum, in numpy


def drawn(seed, *, squares=0.4):
    """Return some terms p, q, powers of x with their coefficients."""
    random = Random(seed)
    return [
        (
            complex(random.uniform(-2, 2), random.uniform(-2, 2)),
            complex(random.uniform(-squares, squares), random.uniform(-squares, squares)),
            {n: complex(random.uniform(-3, 3), random.uniform(-3, 3)) for n in random.sample(range(4), 2)},
        )
        for _ in range(random.randint(2, 4))
    ]


def sampled_turn(terms, radius):
    x = radius * np.exp(1j * pi / 4 * np.linspace(0, 1, 40_001))
    exponents = [p * x + q * x**2 for p, q, _ in terms]
    scale = np.max(np.real(exponents), axis=0)
    total = sum(
        np.exp(e - scale) * sum(c * x**n for n, c in powers.items())
        for e, (_, _, powers) in zip(exponents, terms, strict=True)
    )
    angles = np.unwrap(np.angle(total))
    return angles[-1] - angles[0]


def test_any_sum_turns_as_samples_of_it_do():
    for radius, seed in product([1.7, 8.3, 40.9], range(6)):
        terms = drawn(seed)
        found = ArcSum(tuple(term(*each) for each in terms)).turn(arb(radius))
        assert float(found) == pytest.approx(sampled_turn(terms, radius), abs=1e-6), seed
        assert found.rad() < 1e-6, (radius, seed)
    for radius, terms in product([6.1, 30.5, 411.3], SUMS):
        listed = [(p, q, powers) for (p, q), powers in terms.items()]
        found = ArcSum(tuple(term(*each) for each in listed)).turn(arb(radius))
        assert float(found) == pytest.approx(sampled_turn(listed, radius), abs=1e-6), terms


def test_the_turn_on_a_long_arc_takes_no_longer():
    # sinh(2x) + sin(2x), whose argument turns by that of exp(2x) but for a part of one turn.
    rates = {2: 0.5, -2: -0.5, 2j: -0.5j, -2j: 0.5j}
    radius = arb(10) ** 7
    turn = ArcSum(tuple(term(p, 0, {0: c}) for p, c in rates.items())).turn(radius)
    assert abs(turn - 2 * radius / arb(2).sqrt()) < arb.pi() / 2
    assert turn.rad() < 1e-6


@pytest.mark.parametrize(
    ("exponents", "end", "least"),
    [
        # exp(x) is least at the end of the eighth, exp(R/sqrt(2)); exp(x^2) halfway, exp(R^2/sqrt(2)).
        ((1, 0), 1.0, -log(OUTWEIGHED) * sqrt(2)),
        ((0, 1), 0.5, sqrt(-log(OUTWEIGHED) * sqrt(2))),
        ((1, 0), 0.0, -log(OUTWEIGHED)),
    ],
)
def test_one_term_outweighs_the_others_up_to_where_it_is_least_on_an_arc(exponents, end, least):
    whole = ArcSum((term(*exponents, {0: 1}), term(0, 0, {0: 1})))
    for share, outweighs in ((1 + 1e-6, True), (1 - 1e-6, False)):
        arc = _Arc(whole.terms, whole._sizes, arb(least * share))
        assert arc._outweighs(0.0, end, 0) is outweighs


def test_a_number_turned_by_up_to_an_angle_is_bounded():
    for angle, value in product([0.0, 0.3, 1.2], [3 + 4j, 3 - 4j, -3 + 4j, -3 - 4j, -5, 5j]):
        bound = float(_most(acb(value), (arb(angle).sin(), arb(angle).cos())))
        turned = [(value * exp(1j * angle * k / 50)).real for k in range(-50, 51)]
        assert max(turned) <= bound + 1e-12, (angle, value)
        # Where the part along the axis is negative it is the bound itself.
        largest = value.real if value.real > 0 else value.real * cos(angle)
        assert bound == pytest.approx(largest + abs(value.imag) * sin(angle), abs=1e-12)

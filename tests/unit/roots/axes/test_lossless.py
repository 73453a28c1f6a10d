"""Functions without losses: turns on an arc against dense samples, roots on an axis, and modes by number."""

from __future__ import annotations

from random import Random

import numpy as np
import pytest
from flint import acb, arb, ctx
from mpmath import exp, findroot, mp, mpf, sin

from symflex.algebra.exponential_sum import AxisWave
from symflex.roots import Mode, Modes
from symflex.roots.axes.axis_function import (
    IMAGINARY,
    REAL,
    AxisFunction,
    AxisNewton,
    Enclosures,
    bits_of,
    bracketed,
    changes_sign,
)
from symflex.roots.axes.harmonic_sum import ArcSum, ArcTerm
from symflex.roots.counting.winding import RootOnPathError
from symflex.roots.precision import precision
from tests.unit.roots.distributed_models import FREE, PINNED_IN_THE_MIDDLE, ROD, SLIDING_FREE, bound
from tests.unit.roots.stand_ins import poles_by

SAMPLES = 60_000
DIGITS = 30


@pytest.fixture(autouse=True)
def working_precision():
    before = ctx.prec
    ctx.prec = 64
    yield
    ctx.prec = before


def exponential(p, q, *powers):
    return ArcTerm(acb(*p), acb(*q), tuple((n, acb(*c)) for n, c in powers))


def turn_by_samples(terms, radius):
    """Return the change of the argument from 0 to 45 degrees, by samples so dense that none turns far."""
    x = radius * np.exp(1j * np.linspace(0, np.pi / 4, SAMPLES))
    exponents = np.array([complex(t.linear) * x + complex(t.square) * x * x for t in terms])
    highest = exponents.real.max(axis=0)
    total = sum(
        sum(complex(c) * x**n for n, c in term.powers) * np.exp(exponent - highest)
        for term, exponent in zip(terms, exponents, strict=True)
    )
    steps = np.angle(total[1:] / total[:-1])
    assert np.abs(steps).max() < 1
    return steps.sum()


def random_sum(random, squares):
    """Return a sum like those of systems without losses: any combination of a few rates, real and not."""
    rates = [random.uniform(0.3, 2.0) for _ in range(2)]
    terms = []
    for _ in range(random.randint(2, 7)):
        a, b = (random.choice((-2, -1, 0, 1, 2)) for _ in range(2))
        square = rates[1] * random.choice((-1, 0, 1)) if squares else 0.0
        powers = [
            (n, (random.uniform(-2, 2), random.uniform(-2, 2))) for n in sorted(random.sample(range(4), 2))
        ]
        terms.append(exponential((a * rates[0], b * rates[0]), (square, 0), *powers))
    return tuple(terms)


@pytest.mark.parametrize("squares", [False, True], ids=["beams", "beams and rods"])
@pytest.mark.parametrize("radius", [0.2, 3.0, 40.0, 300.0])
def test_the_turn_on_an_arc_is_that_of_dense_samples(squares, radius):
    random = Random(int(10 * radius) + squares)
    if squares:
        radius = radius**0.7
    compared = 0
    for _ in range(12):
        terms = random_sum(random, squares)
        try:
            turn = ArcSum(terms).turn(arb(radius))
        except RootOnPathError:
            continue
        compared += 1
        assert abs(turn - turn_by_samples(terms, radius)) < 1e-6
    assert compared >= 10


def test_the_turn_on_a_long_arc_takes_no_longer():
    # sinh(2x) + sin(2x), whose argument turns by that of exp(2x) but for a part of one turn.
    terms = (
        exponential((2, 0), (0, 0), (0, (0.5, 0))),
        exponential((-2, 0), (0, 0), (0, (-0.5, 0))),
        exponential((0, 2), (0, 0), (0, (0, -0.5))),
        exponential((0, -2), (0, 0), (0, (0, 0.5))),
    )
    radius = arb(10) ** 7
    turn = ArcSum(terms).turn(radius)
    assert abs(turn - 2 * radius / arb(2).sqrt()) < arb.pi() / 2
    assert turn.rad() < 1e-6


def test_a_root_on_the_arc_is_refused():
    # 1 + exp(x - 3) vanishes at 3 + j pi, whose argument is 46.3 degrees; turned by two degrees, it is met.
    root = acb(3) + acb(0, 1) * arb.pi()
    factor = (acb(0, 1) * arb.pi() * 2 / 180).exp()
    terms = (
        ArcTerm(acb(0), acb(0), ((0, acb(1)),)),
        ArcTerm(factor, acb(0), ((0, acb(-3).exp()),)),
    )
    with pytest.raises(RootOnPathError):
        ArcSum(terms).turn(abs(root).mid())


def decaying(axis, digits):
    """Return exp(-t) + sin(t) as a function of t."""
    one = Enclosures(bits_of(digits), (), (arb(1),), (1,))
    waves = (AxisWave((0,), (1,), {}, {0: {(): 1}}), AxisWave((-1,), (0,), {0: {(): 1}}, {}))
    return AxisFunction(waves, axis, one)


@pytest.mark.parametrize("digits", [10, 50, 400])
@pytest.mark.parametrize("guess", [3.2, 9.4, 628.3])
def test_a_root_on_an_axis_is_enclosed_to_any_number_of_digits(digits, guess):
    source = decaying(IMAGINARY, digits)
    assert changes_sign(source, guess - 0.5, guess + 0.5)
    t = bracketed(source, guess - 0.5, guess + 0.5)
    frequency = AxisNewton(digits).frequency(source, t)
    with mp.workdps(digits + 60), precision(bits_of(digits) + 200):
        exact = findroot(lambda t: exp(-t) + sin(t), guess)
        assert frequency.rad() < frequency * arb(10) ** -digits
        assert frequency.contains(arb(mp.nstr(2 * exact**2, digits + 50)))


def test_nothing_is_enclosed_where_no_root_is():
    source = decaying(REAL, 20)
    assert not changes_sign(source, 0.5, 2.0)
    assert AxisNewton(20).frequency(source, 1.5) is None


@pytest.mark.parametrize("text", [ROD, FREE, SLIDING_FREE, PINNED_IN_THE_MIDDLE])
def test_modes_by_number_are_those_of_the_list(text):
    source = bound(text, 0)
    listed = [root for root in poles_by("lossless", source, Modes(12), DIGITS) if root.im > 0]
    assert len(listed) == 12
    for number, root in enumerate(listed, 1):
        alone = [root for root in poles_by("lossless", source, Mode(number), DIGITS) if root.im > 0]
        assert [r.decimal(20).im for r in alone] == [root.decimal(20).im]


def test_a_very_high_mode_of_a_rod_with_a_tip_mass():
    # x tan x = 2, and omega = x.
    with mp.workdps(50):
        number = 10**9
        (root, _) = poles_by("lossless", bound(ROD, 0), Mode(number), DIGITS)
        x = findroot(lambda x: x * mp.sin(x) - 2 * mp.cos(x), (number - 1) * mp.pi + mpf(2) / number)
        assert abs(mpf(root.decimal(DIGITS).im) - x) < mpf(10) ** (12 - DIGITS)

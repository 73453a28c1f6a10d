"""Random loops with functions of a gain: every interval agrees with the poles at gains inside it.

The gain enters by roots, powers, logarithms, exponentials, quotients and definitions of definitions, in one
place or two, before polynomials, delays and beams. At each gain the model is read again with that value,
and ``roots`` certifies its poles; numpy and the winding of a function written by hand count them, too.
"""

from cmath import exp as turned
from contextlib import suppress
from fractions import Fraction
from math import inf, nan
from random import Random

import numpy as np
import pytest

from symflex import pipeline
from symflex.errors import ModelError
from symflex.loops.of_model import stability
from symflex.options import StabilityOptions
from tests.independent.nyquist import poles_right_of_axis
from tests.random_models import random_loop

CLEAR = 1e-6
"""Poles closer to the axis, relative to the largest, are not told by numpy."""
BESIDE = Fraction(1, 10**5)
"""How far beside a boundary a gain is tried, relative to the interval."""


def wrong_counts(seed, kind, *, count=3, proved=inf):
    """Return the gains whose right-half-plane poles are not those of an interval, and how many were tried."""
    text, characteristic = random_loop(seed, kind)
    limits = None if kind in ("lumped", "two places") else ("0.1", "3")
    found = stability(pipeline.loads(text), StabilityOptions("K", limits))
    random, gains, wrong, tried = Random(seed), list[Fraction](), [], 0
    for interval in found.intervals:
        low = Fraction(float(interval.low)) if interval.low is not None else Fraction(-50)
        width = Fraction(float(interval.high)) - low if interval.high is not None else 2 * abs(low) + 50
        shares = [Fraction(random.uniform(0.01, 0.99) ** 2) for _ in range(-(-count // len(found.intervals)))]
        gains += [low + share * width for share in (*shares, BESIDE, 1 - BESIDE)]
    for i, gain in enumerate(random.sample(gains, len(gains))):
        right = next((each.poles.right for each in found.intervals if each.holds(gain)), None)
        if right is None:
            continue
        plain, delayed = characteristic(float(gain)) if characteristic else (np.array([nan]), np.zeros(1))
        counted = []
        if np.isfinite([*plain, *delayed]).all() and kind != "delay":
            poles = np.roots(np.polyadd(plain, delayed))
            if all(abs(p.real) > CLEAR * max(abs(poles)) for p in poles):
                counted.append(sum(p.real > 0 for p in poles))
        if i < proved and found.is_complete:
            model = pipeline.loads(text, settings={"K": str(gain.limit_denominator(10**9))})
            (bound,) = pipeline.derive_bound(model, model.transfer_functions)
            verdict = pipeline.roots(bound).verdict
            counted += [verdict.right] if verdict.certified and verdict.right is not None else []
            if kind == "delay" and not wrong:

                def chi(s, plain=plain, delayed=delayed):
                    return np.polyval(plain, s) + turned(-0.3 * s) * np.polyval(delayed, s)

                counted.append(poles_right_of_axis(chi, 1.2 * found.radius))
        tried += len(counted)
        wrong += [(gain, right, n) for n in counted if n != right]
    return wrong, tried, found


@pytest.mark.parametrize(("kind", "seed"), [("lumped", 0), ("two places", 20), ("delay", 2)])
def test_intervals_agree_with_poles(kind, seed):
    assert not wrong_counts(seed, kind)[0]


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "seeds"), [("lumped", 12), ("two places", 8), ("delay", 8), ("beam", 2)])
def test_intervals_of_many_loops_agree_with_poles(kind, seeds):
    wrong = []
    for seed in range(100, 100 + seeds):
        with suppress(ModelError):  # SF228: the value of the gain is not one for which all is real
            wrong += wrong_counts(seed, kind, proved=2)[0]
    assert not wrong

"""Random loops with functions of a gain: every interval agrees with the poles at gains inside it.

The gain enters by roots, powers, logarithms, exponentials, quotients and definitions of definitions, in one
place or two, before polynomials, dead times and beams. At each gain the model is read again with that value,
and ``roots`` proves its poles; numpy and the winding of a function written by hand count them, too.
"""

from cmath import exp as turned
from contextlib import suppress
from fractions import Fraction
from math import cosh, exp, inf, log, nan, sin, sqrt, tanh
from random import Random

import numpy as np
import pytest

from symflex import pipeline
from symflex.errors import ModelError
from symflex.loops.of_model import stability
from symflex.options import StabilityOptions
from tests.independent.nyquist import poles_right_of_axis

FUNCTIONS = {
    "{}": lambda x: x,
    "sqrt({})": sqrt,
    "({})^2": lambda x: x**2,
    "({})^3": lambda x: x**3,
    "({})^(-2)": lambda x: x**-2,
    "1/({})": lambda x: 1 / x,
    "log(1 + {})": lambda x: log(1 + x),
    "log({})": log,
    "exp(-({})/2)": lambda x: exp(-x / 2),
    "exp({}) - 1": lambda x: exp(x) - 1,
    "({0})/(2 + {0})": lambda x: x / (2 + x),
    "(3 - ({0}))/(1 + ({0})^2)": lambda x: (3 - x) / (1 + x**2),
    "sqrt(4 - ({}))": lambda x: sqrt(4 - x),
    "sqrt(1 + ({})^2)": lambda x: sqrt(1 + x**2),
    "tanh({})": tanh,
    "sin({})": sin,
    "1/cosh({})": lambda x: 1 / cosh(x),
    "({0})*log({0})": lambda x: x * log(x),
}
CLEAR = 1e-6
"""Poles closer to the axis, relative to the largest, are not told by numpy."""
BESIDE = Fraction(1, 10**5)
"""How far beside a boundary a gain is tried, relative to the interval."""
BEAM = """[elements]
drive = {{ type = "force_source", at = "x", f = "{}" }}
guide = {{ type = "slider", at = "x" }}
damper = {{ type = "damper", between = ["x", "ground"], b = "0.3 N*s/m" }}
link = {{ type = "beam", between = ["x", "t"], EI = "2 N*m^2", rhoA = "0.5 kg/m", l = "1 m", eta = "5 ms" }}
[outputs]
Y = "x"
[inputs]
r = {{ unit = "m" }}"""
SIGNALS = '[signals]\ny = "{}"\n[inputs]\nr = {{}}\n[outputs]\nY = "y"'


def function_of_gain(random, names):
    """Return a random function of K as an expression and to be called; definitions are added to names."""
    text, steps = "K", []
    scale = Fraction(random.choice((1, 2, 3, 5, 8, 20, -1)), random.choice((1, 1, 2, 4)))
    for _ in range(random.choice((1, 1, 2, 3))):
        form, function = random.choice(list(FUNCTIONS.items()))
        steps.append(function)
        text = form.format(text)
        if random.random() < 0.5:
            names[f"d_{len(names)}"] = text
            text = list(names)[-1]

    def value(gain):
        try:
            for step in steps:
                gain = step(gain)
        except (ArithmeticError, ValueError):  # beyond doubles, or where roots of squares are not real
            return nan
        return float(scale) * gain

    return f"{scale}*({text})", value


def polynomial(random, degree, lowest=-0.2):
    """Return descending coefficients, most of whose roots lie left of the axis."""
    found = np.ones(1)
    while len(found) <= degree:
        a, b = random.uniform(lowest, 3), random.uniform(0.2, 4)
        found = np.polymul(found, [1, a] if len(found) == degree or random.random() < 0.5 else [1, a, b])
    return found.round(3)


def random_loop(seed, kind):
    """Return the text of a loop, and of a gain the polynomials without and with a dead time of 0.3 s."""
    random, names, places = Random(f"{kind} {seed}"), {}, []
    for _ in range(2 if kind == "two places" or (kind == "dead time" and seed % 3 == 0) else 1):
        degree = random.randint(*((2, 5) if kind == "lumped" else (1, 3)))
        zeros = random.randint(0, max(0, degree - random.choice((1, 2, 2, int(kind == "dead time")))))
        b = random.choice((1, 4)) * polynomial(random, zeros, -1)
        places.append((*function_of_gain(random, names), polynomial(random, degree), b))
    sign = "real" if kind == "lumped" and seed % 4 == 0 else "positive"
    value = random.choice((0.3, 0.7, 1.2, 1.9))
    head = f'symflex = 1\nparameters = {{ K = {{ value = {value}, assume = "{sign}" }}'
    head += ', k = "1 N/m", c = "0.2 N*s/m" }\n[definitions]\n' if kind == "beam" else " }\n[definitions]\n"
    head += "".join(f'{name} = "{text}"\n' for name, text in names.items())
    if kind == "beam":
        more = random.choice(("", f" - c*({places[0][0]})*s*x"))
        return head + BEAM.format(f"k*({places[0][0]})*(r - x){more}"), None
    paths = [
        f"({f})*({'+'.join(f'({c:g})*s^{len(b) - 1 - i}' for i, c in enumerate(b))})"
        f"/({'+'.join(f'({c:g})*s^{len(a) - 1 - i}' for i, c in enumerate(a))})"
        for f, _, a, b in places
    ]
    paths[0] += "*exp(-0.3*s)*(r - y)" if kind == "dead time" else "*(r - y)"
    one, other = places[0], places[-1] if len(places) > 1 else ("", lambda _: 0, np.ones(1), np.ones(1))

    def characteristic(gain):
        plain = np.polymul(one[2], np.polyadd(other[2], other[1](gain) * other[3]))
        return plain, one[1](gain) * np.polymul(one[3], other[2])

    return head + SIGNALS.format(f"{paths[0]}{''.join(f' - {p}*y' for p in paths[1:])}"), characteristic


def wrong_counts(seed, kind, *, count=3, proved=inf):
    """Return at which gains the poles right of the axis are not those of an interval, how many were tried."""
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
        if np.isfinite([*plain, *delayed]).all() and kind != "dead time":
            poles = np.roots(np.polyadd(plain, delayed))
            if all(abs(p.real) > CLEAR * max(abs(poles)) for p in poles):
                counted.append(sum(p.real > 0 for p in poles))
        if i < proved and found.is_complete:
            model = pipeline.loads(text, settings={"K": str(gain.limit_denominator(10**9))})
            (bound,) = pipeline.derive_bound(model, model.transfer_functions)
            verdict = pipeline.roots(bound).verdict
            counted += [verdict.right] if verdict.certified and verdict.right is not None else []
            if kind == "dead time" and not wrong:

                def chi(s, plain=plain, delayed=delayed):
                    return np.polyval(plain, s) + turned(-0.3 * s) * np.polyval(delayed, s)

                counted.append(poles_right_of_axis(chi, 1.2 * found.radius))
        tried += len(counted)
        wrong += [(gain, right, n) for n in counted if n != right]
    return wrong, tried, found


@pytest.mark.parametrize(("kind", "seed"), [("lumped", 0), ("two places", 20), ("dead time", 2)])
def test_intervals_agree_with_poles(kind, seed):
    assert not wrong_counts(seed, kind)[0]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "seeds"), [("lumped", 12), ("two places", 8), ("dead time", 8), ("beam", 2)]
)
def test_intervals_of_many_loops_agree_with_poles(kind, seeds):
    wrong = []
    for seed in range(100, 100 + seeds):
        with suppress(ModelError):  # SF228: the value of the gain is not one for which all is real
            wrong += wrong_counts(seed, kind, proved=2)[0]
    assert not wrong

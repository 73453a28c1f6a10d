"""Roots of chains of beams, read far from the drive or with losses, against transfer matrices in mpmath.

A state is (w, w', M, V) with M = E I w'' and V = E I w'''. A clamped start leaves M and V unknown
there. The tip is free of moment and pulled by a unit force; what is read is the deflection where the first
beam ends.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from math import pi

import pytest
from mpmath import arg, cos, cosh, exp, eye, matrix, mp, mpc, mpf, root, sin, sinh

from symflex import pipeline
from symflex.budget import Budget
from symflex.model import with_numbers
from symflex.roots.networks.poles_zeros import locate_in_network
from symflex.roots.region import Band, Modes

BENDING, MASS = 200, Fraction(78, 100)
"""E I [N m^2] and rho A [kg/m]."""
DIGITS = 80
MOST_TURN = 1.0
"""By which the response may turn between two points of a circle [rad]; else there are more of them."""


def length(i):
    return f"0.{30 + 7 * i % 13}"


def stiffness(i):
    return 1000 + 37 * (5 * i % 11)


def specification(count, read, eta):
    """Return a clamped chain of different beams, each on a spring at its end, pulled at its tip."""
    law = f'E = "200 GPa", rho = "7800 kg/m^3", A = "100 mm^2", I = "1000 mm^4", eta = "{eta} s"'
    lines = []
    for i in range(count):
        ends = f'["{f"n{i}" if i else "ground"}", "n{i + 1}"]'
        lines.append(f'b{i} = {{ type = "beam", between = {ends}, {law}, l = "{length(i)} m" }}')
        spring = f'between = ["n{i + 1}", "ground"], k = "{stiffness(i)} N/m"'
        lines.append(f's{i} = {{ type = "spring", {spring} }}')
    elements = "\n".join(lines)
    ports = f"[inputs]\nF = {{ force = 'n{count}' }}\n[outputs]\nY = 'n{read}'\n"
    return f"symflex = 1\n[elements]\n{elements}\n{ports}"


def along(span, s, eta):
    """Return what takes the state from one end of a beam to the other."""
    bending = BENDING * (1 + mpf(eta) * s)
    k = root(-mpf(MASS.numerator) / MASS.denominator * s * s / bending, 4)
    c, d = (cosh(k * span) + cos(k * span)) / 2, (cosh(k * span) - cos(k * span)) / 2
    a, b = (sinh(k * span) + sin(k * span)) / 2, (sinh(k * span) - sin(k * span)) / 2
    functions = [c, a / k, d / k**2, b / k**3]  # of which each is the derivative of the next
    states = matrix(4, 4)
    for i in range(4):
        for j in range(4):
            order = j - i
            value = functions[order] if order >= 0 else k**4 * functions[4 + order]
            scale = (bending if i > 1 else 1) / (bending if j > 1 else 1)
            states[i, j] = value * scale
    return states


def response(chain, s):
    """Return the deflection at the end of a beam per unit of force on the tip."""
    count, read, eta = chain
    whole, first = eye(4), None
    for i in range(count):
        whole = along(mpf(length(i)), s, eta) * whole
        first = whole if i + 1 == read else first
        spring = eye(4)
        spring[3, 0] = -stiffness(i)  # V behind it is V before it less k w
        whole = spring * whole
    # M = 0 and V = -F at the tip.
    m, v = whole[2, 2], whole[2, 3]
    below = m * whole[3, 3] - v * whole[3, 2]
    return (first[0, 2] * v - first[0, 3] * m) / below


def winding(chain, radius):
    """Return how many more zeros than poles the response has in a disc about 0."""

    def turned(low, high, before, after, depth=0):
        turn = float(arg(after / before))
        if depth > 1 and abs(turn) < MOST_TURN:
            return turn
        middle = (low + high) / 2
        value = response(chain, radius * exp(mpc(0, middle)))
        return turned(low, middle, before, value, depth + 1) + turned(middle, high, value, after, depth + 1)

    angles = [pi * (k - 0.3) / 24 for k in range(49)]
    values = [response(chain, radius * exp(mpc(0, angle))) for angle in angles]
    return sum(
        turned(*places, *ends) for places, ends in zip(pairwise(angles), pairwise(values), strict=True)
    ) / (2 * pi)


def located(chain, region):
    equations = pipeline.assemble_sparse(with_numbers(pipeline.loads(specification(*chain)), in_kernels=True))
    return locate_in_network(equations, "Y/F", ("Y", "F"), region, 15, Budget(), is_default=False)


def slow(*values):
    return pytest.param(*values, marks=pytest.mark.slow)


@pytest.mark.parametrize(
    ("count", "read", "eta", "modes"),
    [
        (3, 1, "0", 3),
        slow(6, 1, "0", 10),
        slow(12, 1, "0", 5),
        # Roots accumulate at -1/eta = -10000 rad/s, and the sixth mode lies below 3300 rad/s.
        slow(6, 6, "1e-4", 6),
        slow(4, 1, "2e-4", 3),
    ],
)
def test_roots_are_where_and_as_many_as_products_of_matrices_have_them(count, read, eta, modes):
    chain = (count, read, eta)
    near = located(chain, Modes(modes))
    assert near.certificate.certified
    with mp.workdps(DIGITS):
        for roots, expected in ((near.poles, 2), (near.zeros, 0.5)):
            for each in (r for r in roots if not r.im < 0):
                s = mpc(each.decimal(15).re, each.decimal(15).im)
                step = abs(s) * mpf(10) ** -9 * mpc("0.6", "0.8")
                ratio = response(chain, s + step) / response(chain, s + 2 * step)
                assert abs(ratio) == pytest.approx(expected, rel=1e-3)
        radius = float(max(abs(complex(float(z.re), float(z.im))) for z in near.zeros)) * 1.02
        found = located(chain, Band(Fraction(0), Fraction(radius) / Fraction(2 * pi)))
        assert found.certificate.certified
        assert winding(chain, radius) == pytest.approx(len(found.zeros) - len(found.poles), abs=0.01)

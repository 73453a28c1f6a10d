"""For which gains and periods sampled loops are stable."""

from fractions import Fraction

import numpy as np
import pytest

from symflex import loads
from tests.unit.analysis.sampled_loop.exact_steps import closed_poles

WALL = """symflex = 1
parameters = { m = "0.3 kg", b = "0.7 N*s/m", K = "1000 N/m", B = "0.3 N*s/m", T = "1 ms" }
inputs     = { F = { unit = "N" } }
outputs    = { X = "x" }
[blocks]
wall = "K + B*(z - 1)/(T*z)"
[sampled]
period = "T"
[signals]
x = "(F - wall*x)/(s*(m*s + b))"
"""


def edge(controller, low, high, plant=([1.0], [0.3, 0.7, 0.0]), period=1e-3, delay=0.0):
    """Return by bisection where the largest pole of matrix exponentials passes the unit circle."""
    for _ in range(60):
        middle = (low + high) / 2
        outside = max(abs(closed_poles(plant, controller(middle), period, delay))) > 1
        low, high = (low, middle) if outside else (middle, high)
    return (low + high) / 2


def test_the_largest_stiffness_of_a_wall():
    found = loads(WALL).stability(over="K", limits=(0, 3000))
    expected = edge(lambda K: ([K + 300.0, -300.0], [1.0, 0.0]), 1500.0, 2500.0)
    assert float(found.boundaries[0].gain) == pytest.approx(expected, rel=1e-10)
    assert found.certified and found.is_stable


def test_a_wall_of_round_numbers():
    # m = 0.2 kg, b = 0.5 N s/m, B = 0.2 N s/m, T = 1 ms: K below 1399.18544 N/m, by matrix exponentials
    text = (
        WALL.replace("0.3 kg", "0.2 kg").replace("0.7 N*s/m", "0.5 N*s/m").replace("0.3 N*s/m", "0.2 N*s/m")
    )
    found = loads(text).stability(over="K", limits=(0, 3000))
    expected = edge(lambda K: ([K + 200.0, -200.0], [1.0, 0.0]), 900.0, 2000.0, ([1.0], [0.2, 0.5, 0.0]))
    assert float(found.boundaries[0].gain) == pytest.approx(expected, rel=1e-10)
    assert float(found.boundaries[0].gain) == pytest.approx(1399.18544, abs=5e-6)


def test_a_delay_of_computing_costs_stiffness():
    text = WALL.replace('period = "T"', 'period = "T"\ndelay = "0.37 ms"')
    found = loads(text).stability(over="K", limits=(1, 3000))
    expected = edge(lambda K: ([K + 300.0, -300.0], [1.0, 0.0]), 500.0, 2500.0, delay=0.37e-3)
    assert float(found.boundaries[0].gain) == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("mass", [1, 100, 10_000])
def test_damping_over_half_a_period_and_a_delay_bounds_the_stiffness_of_a_wall(mass):
    # Gil, Sanchez, Hulin, Preusche, Hirzinger (2009): K < (b + B)/(T/2 + t_d) = 0.6/1.2 ms for low damping,
    # which leaves terms of b T/m.
    text = WALL.replace('period = "T"', 'period = "T"\ndelay = "0.7 ms"').replace("0.3 kg", f"{mass} kg")
    text = text.replace("0.7 N*s/m", "0.1 N*s/m").replace("0.3 N*s/m", "0.5 N*s/m")
    (boundary,) = loads(text).stability(over="K", limits=(1, 3000)).boundaries
    assert float(boundary.gain) == pytest.approx(500, rel=6e-4 / mass)


def test_a_pole_that_leaves_at_minus_one():
    # z = 1 - K T, so K = 2/T
    text = """symflex = 1
parameters = { K = 1, T = 0.25 }
blocks     = { C = "K*z/z" }
sampled    = { period = "T" }
signals    = { y = "C*(r - y)/s" }
inputs     = { r = {} }
outputs    = { Y = "y" }
"""
    found = loads(text).stability(over="K", limits=(Fraction(1, 10), 20))
    (boundary,) = found.boundaries
    assert float(boundary.gain) == pytest.approx(8, abs=1e-9)
    assert boundary.entering == 1
    assert boundary.frequencies_hz == (pytest.approx(2, rel=1e-6),)


def test_the_longest_period():
    text = """symflex = 1
parameters = { K = 4, T = "0.25 s" }
blocks     = { C = "K*z/z" }
sampled    = { period = "T" }
signals    = { y = "C*(r - y)/(s + 1)" }
inputs     = { r = {} }
outputs    = { Y = "y" }
"""
    # q - K (1 - q) = -1, q = exp(-T): T = ln((K + 1)/(K - 1))
    found = loads(text).stability(over="T", limits=(0.1, 1))
    assert float(found.boundaries[0].gain) == pytest.approx(np.log(5 / 3), rel=1e-9)


@pytest.mark.slow
def test_a_chart_of_a_wall():
    chart = loads(WALL).stability(over=("K", "B"), ranges={"K": (1, 3000), "B": (0.01, 1)}, resolve=0.05)
    for K, B in ((500, 0.2), (1200, 0.5), (2500, 0.1)):
        outside = sum(
            abs(closed_poles(([1.0], [0.3, 0.7, 0.0]), ([K + B * 1e3, -B * 1e3], [1.0, 0.0]), 1e-3)) > 1
        )
        assert chart.at(K, B) == (f"unstable by {outside}" if outside else "stable")


def test_what_is_said_is_said_of_the_circle():
    found = loads(WALL).stability(over="K", limits=(0, 3000))
    assert "all poles outside the unit circle counted" in str(found)
    assert found.to_json_dict()["sampled"] == "wall: sampled every 0.001 s, the output held"


@pytest.mark.parametrize("beta", [0.2, 2 * 2**0.5 - 2, 1.5])
def test_the_stiffest_wall_of_a_free_mass_by_jury(beta):
    # z (z - 1)^2 + alpha/2 z (z + 1) + beta/2 (z + 1)(z - 1) with alpha = K T^2/m and beta = B T/m, by the
    # criterion of Jury: alpha < 2 beta (2 - beta)/(2 + beta), at most 12 - 8 sqrt(2) = 0.686.
    text = f"""symflex = 1
parameters = {{ m = 2, K = 1, B = {beta * 200}, T = 0.01 }}
inputs     = {{ F = {{}} }}
outputs    = {{ X = "x" }}
blocks     = {{ wall = "K + B*(z - 1)/(T*z)" }}
sampled    = {{ period = "T" }}
signals    = {{ x = "(F - wall*x)/(m*s^2)" }}
"""
    found = loads(text).stability(over="K", limits=(0, 60_000))
    assert float(found.boundaries[0].gain) / 20_000 == pytest.approx(2 * beta * (2 - beta) / (2 + beta))

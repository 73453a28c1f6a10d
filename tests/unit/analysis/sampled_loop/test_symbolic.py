"""Pulse functions of delayed machines with the period as a symbol: the same values as with numbers."""

from fractions import Fraction

import pytest

from symflex import pipeline
from symflex.analysis.sampled_loop.closed import sampled_loop
from symflex.errors import UsageError
from symflex.transfer import bind

PLANTS = (
    "1/(s*(0.3*s + 0.7))",
    "1/(s^2 + 0.2*s + 40)",
    "1/(s + 2)^3",
    "(s + 3)/(s^2*(s + 1))",
    "1/(s*(s^2 + 4))",
)


def loop(plant, delay="0", ranges=None):
    text = f"""symflex = 1
parameters = {{ K = 3, T = "0.1 s" }}
blocks     = {{ G = "exp(-0.013*s)*({plant})", C = "K*(1 - 0.5/z)" }}
sampled    = {{ period = "T", delay = "{delay}", blocks = ["C"] }}
signals    = {{ y = "G*(u - C*y)" }}
inputs     = {{ u = {{}} }}
outputs    = {{ Y = "y" }}
"""
    return sampled_loop(pipeline.loads(text), ranges)


@pytest.mark.parametrize("plant", PLANTS)
@pytest.mark.parametrize("delay", ["0", "0.3*T"])
def test_the_characteristic_function_is_the_same_in_symbols(plant, delay):
    s = 0.7 + 3j
    numbers = bind(loop(plant, delay).tf)(s)
    letters = bind(loop(plant, delay, {"T": (Fraction(9, 100), Fraction(11, 100))}).tf, {"T": "0.1"})(s)
    assert letters == pytest.approx(numbers, rel=1e-9)


def test_a_range_in_which_a_delay_passes_a_sample_is_refused():
    with pytest.raises(UsageError) as caught:
        loop(PLANTS[0], "0.1 s", {"T": (Fraction(1, 20), Fraction(1, 5))})
    assert caught.value.diagnostics[0].code == "SF804"

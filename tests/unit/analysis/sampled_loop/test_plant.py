"""Continuous parts with parameters in ranges: values, slopes and boundaries, against matrix exponentials."""

from fractions import Fraction

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

from symflex import loads, pipeline
from symflex.analysis.sampled_loop.closed import sampled_loop
from symflex.errors import ModelError
from symflex.transfer import bind
from tests.unit.analysis.sampled_loop.test_symbolic import PLANTS

HANDLE = """symflex = 1
parameters = { m = "0.3 kg", b = "0.7 N*s/m", k = "1 kN/m", K = "1900 N/m", B = "0.3 N*s/m", T = "1 ms" }
inputs     = { F = { force = "x" } }
outputs    = { X = "x" }
blocks     = { wall = "K + B*(z - 1)/(T*z)" }
sampled    = { period = "T" }
[elements]
handle = { type = "mass", at = "x", m = "m" }
rail   = { type = "damper", between = ["x", "ground"], b = "b" }
tool   = { type = "spring", between = ["x", "ground"], k = "k" }
motor  = { type = "force_source", at = "x", f = "-wall*x" }
"""


def size(m=0.3, b=0.7, k=1000.0, K=1900.0, B=0.3, T=1e-3):
    """Return the largest pole in z of the handle, by the exponential of its matrix."""
    step = expm(np.array([[0, 1, 0], [-k / m, -b / m, 1 / m], [0, 0, 0]]) * T)
    turned, held = step[:2, :2], step[:2, 2:]
    seen = np.array([[1.0, 0.0]])
    whole = np.block([[turned - (K + B / T) * held @ seen, held * (B / T)], [seen, np.zeros((1, 1))]])
    return max(abs(np.linalg.eigvals(whole)))


def edge(name, low, high):
    return brentq(lambda x: size(**{name: x}) - 1, low, high, xtol=1e-13, rtol=1e-13)


@pytest.mark.parametrize("plant", PLANTS)
@pytest.mark.parametrize("delay", ["0", "0.3*T", "T", "0.02 s"])
def test_the_characteristic_function_is_that_of_numbers(plant, delay):
    text = f"""symflex = 1
parameters = {{ K = 3, T = "0.1 s" }}
blocks     = {{ G = "{plant}", C = "K*(1 - 0.5/z)" }}
sampled    = {{ period = "T", delay = "{delay}", blocks = ["C"] }}
signals    = {{ y = "G*(u - C*y)" }}
inputs     = {{ u = {{}} }}
outputs    = {{ Y = "y" }}
"""
    model, s = pipeline.loads(text), 0.7 + 3j
    loop = sampled_loop(model, {"T": (Fraction(9, 100), Fraction(11, 100))})
    found = loop.characteristic(("T",)).bound_in(loop.tf, ((Fraction(1, 10),) * 2,))
    assert found(s) == pytest.approx(bind(sampled_loop(model).tf)(s), rel=1e-9)


def test_slopes_are_those_of_differences():
    loop = sampled_loop(pipeline.loads(HANDLE), {"k": (Fraction(900), Fraction(1100))})
    values = [loop.plant.named(((Fraction(k),) * 2,), "k") for k in (999, 1000, 1001)]
    for name, (_, slope) in values[1].items():
        change = float(values[2][name][0] - values[0][name][0]) / 2
        assert float(slope) == pytest.approx(change, rel=1e-5)


@pytest.mark.parametrize(("low", "high"), [(1e5, 3e5), pytest.param(1.7e6, 1.9e6, marks=pytest.mark.slow)])
def test_a_stiffer_tool_is_worse_and_then_better(low, high):
    found = loads(HANDLE).stability(over="k", limits=(low, high))
    assert found.certified
    assert float(found.boundaries[0].gain) == pytest.approx(edge("k", low, high), rel=1e-8)


def test_the_least_friction_of_a_rail():
    found = loads(HANDLE).stability(over="b", limits=(0, 2))
    assert float(found.boundaries[0].gain) == pytest.approx(edge("b", 0.3, 1), rel=1e-8)


def test_the_longest_period_of_a_wall():
    found = loads(HANDLE).stability(over="T", limits=("0.5 ms", "5 ms"))
    assert found.certified
    assert float(found.boundaries[0].gain) == pytest.approx(edge("T", 5e-4, 5e-3), rel=1e-8)


def test_parameters_of_a_delayed_machine_are_refused():
    text = HANDLE.replace("-wall*x", "-wall*x - exp(-0.003*s)*k*x/2")
    with pytest.raises(ModelError, match="delay"):
        loads(text).stability(over="k", limits=(0, 100))

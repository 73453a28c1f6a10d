"""Laws along x, as polynomials in what holds s."""

from cmath import sqrt

import pytest
from flint import ctx

from symflex import pipeline

# A chain that hangs in what resists its motion.
CHAIN = """symflex = 1
[parameters]
m = "3 kg/m"
c = "1.5 N*s/m^2"
T = "40 N"
w = "15 N/m"
l = "2 m"
[fields.u]
domain = ["0", "l"]
equation = "((T - w*x)*u')' = {moved}"
conditions = ["u(0) = X", "u(l) = 0"]
[inputs]
X = {{ unit = "m" }}
[outputs]
y = "u(l/2)"
"""
EVEN = CHAIN.format(moved="m*s^2*u").replace('c = "1.5 N*s/m^2"\n', "")


def bound(text):
    model = pipeline.loads(text)
    (made,) = pipeline.derive_bound(model, model.transfer_functions)
    return made


def law_of(function):
    with ctx.workprec(64):
        return function.kernel_values().matrices.laws[0]


@pytest.mark.parametrize(
    "moved", ["m*s^2*u + c*s*u", "s*(m*s + c)*u", "2*m*(s^2 + c/m*s)*u - m*s*(s + c/m)*u"]
)
def test_a_resistance_in_proportion_to_mass_is_one_power_with_it(moved):
    # All s stand in s^2 + (c/m) s, so the undamped chain has the same values where its s^2 is that.
    damped, undamped = bound(CHAIN.format(moved=moved)), bound(EVEN)
    assert (law_of(damped).step, law_of(damped).degree) == (1, 2)
    for s in (0.3 + 2j, -4 + 7j, 5 + 0j):
        right = undamped(sqrt(s * s + 0.5 * s))
        assert abs(damped(s) - right) < 1e-13 * abs(right), s


@pytest.mark.parametrize("moved", ["m*s^2*u + c*(1 + x/l)*s*u", "c*s*u"])
def test_powers_of_s_that_differ_along_x_stay_apart(moved):
    law = law_of(bound(CHAIN.format(moved=moved)))
    assert law.drag is None
    assert law.degree == law.step == 1

"""Damped members whose foundation, tension or loss factor is 0: poles of their own equations.

Kelvin-Voigt damping multiplies EA or EI by 1 + eta s; both are 1, as are rhoA and l. A rod with a mass m at
its tip has poles where ``m s^2 sinh(g)/g + (1 + eta s) cosh(g)`` vanishes, g^2 = s^2/(1 + eta s). A beam with
one has ``s^2 + eta b^4 s + b^4 = 0`` for each real root b of ``1 + cos(b) cosh(b) + m b (cos(b) sinh(b) -
sin(b) cosh(b))`` (Blevins 1979, table 8-8).
"""

import pickle

import mpmath
import pytest

import symflex
from symflex import pipeline
from symflex.loops.of_model import stability
from symflex.loops.over import stability_over
from symflex.options import StabilityOptions
from symflex.roots.region import Modes

ETA, MASS = 0.002, 0.3
HEAD = 'symflex = 1\ninputs = { F = { force = "tip" } }\noutputs = { X = "tip" }\n'
TIP = 'm = { type = "mass", at = "tip", m = "0.3 kg" }\n'
FIELD = """symflex = 1
parameters = { eta = "0.002 s", N_0 = { value = "0 N", assume = "real" }, N_1 = "3 N", N_2 = "3 N" }
inputs = { F = {} }
outputs = { X = "w(1)" }
[fields.w]
domain = ["0", "1"]
equation = "(1 + eta*s)*w'''' - (@)*w'' + s^2*w = 0"
conditions = ["w(0) = 0", "w'(0) = 0", "w''(1) = 0", "(1 + eta*s)*w'''(1) - (@)*w'(1) - 0.3*s^2*w(1) = -F"]
"""


def rod(key, value="c"):
    letters = 'parameters = { c = { value = "0", assume = "real" }, eta = "0.002 s" }\n'
    letters = letters.replace('"0"', {"c_f": '"0 N*s/m^2"', "k_f": '"0 N/m^2"'}.get(key, "0"))
    keys = f'EA = "1 N", rhoA = "1 kg/m", l = "1 m", eta = "eta", {key} = "{value}"'
    return HEAD + letters + f'[elements]\nb = {{ type = "rod", between = ["ground", "tip"], {keys} }}\n' + TIP


def beam(key, unit):
    letters = (
        f'parameters = {{ c = {{ value = "0 {unit}", assume = "real" }}, eta = "0.002 s", l = "1 m" }}\n'
    )
    keys = f'EI = "1 N*m^2", rhoA = "1 kg/m", l = "l", eta = "eta", {key} = "c"'
    return (
        HEAD + letters + f'[elements]\nb = {{ type = "beam", between = ["ground", "tip"], {keys} }}\n' + TIP
    )


def pole_of_rod():
    def characteristic(s):
        wave = mpmath.sqrt(s**2 / (1 + ETA * s))
        return MASS * s**2 * mpmath.sinh(wave) / wave + (1 + ETA * s) * mpmath.cosh(wave)

    return mpmath.findroot(characteristic, -0.0015 + 1.22j)


def pole_of_beam():
    def characteristic(b):
        sway = mpmath.cos(b) * mpmath.sinh(b) - mpmath.sin(b) * mpmath.cosh(b)
        return 1 + mpmath.cos(b) * mpmath.cosh(b) + MASS * b * sway

    stiffness = mpmath.findroot(characteristic, 1.5) ** 4
    return (-ETA * stiffness + mpmath.sqrt((ETA * stiffness) ** 2 - 4 * stiffness)) / 2


def first(text):
    model = pipeline.loads(text)
    (bound,) = pipeline.derive_for_roots(model, model.transfer_functions)
    return pipeline.roots(bound, Modes(1), 15)


def assert_first(text, pole):
    located = first(text)
    assert located.certificate.certified
    assert (located.verdict.word, located.hidden) == ("stable", ())
    assert len(located.poles) == 2
    found = complex(located.poles[0])
    assert abs(complex(found.real, abs(found.imag)) - complex(pole.real, abs(pole.imag))) < 1e-12 * abs(pole)


def test_a_damped_rod_with_no_foundation_has_no_pole_at_0():
    for key in ("c_f", "k_f", "eta_s"):
        assert_first(rod(key), pole_of_rod())


def test_a_definition_that_is_0_is_no_foundation():
    text = rod("c_f", "none") + '[definitions]\nnone = "2*c"\n'
    assert_first(text, pole_of_rod())


def test_a_damped_beam_with_no_tension_or_foundation_is_the_plain_one():
    for key, unit in (("N", "N"), ("c_f", "N*s/m^2"), ("k_f", "N/m^2"), ("eta_s", "")):
        assert_first(beam(key, unit), pole_of_beam())


@pytest.mark.slow
def test_a_field_without_tension_is_the_plain_one_also_where_tensions_balance():
    for tension in ("N_0", "N_1 - N_2"):
        assert_first(FIELD.replace("@", tension), pole_of_beam())


LOOP = """symflex = 1
parameters = { k_i = { value = 0, assume = "nonnegative" } }
inputs.F = {}
outputs.Y = "y"
blocks.G = { type = "pid", k_p = 2, k_i = "k_i" }
signals.y = "G*(F - y)/(2*s^2 + s + 3)"
"""


def test_a_gain_of_0_leaves_what_the_model_without_it_says():
    """2 s^2 + s + 5 has its roots in the left half-plane; with k_i it is s (2 s^2 + s + 5) + k_i."""
    model = pipeline.loads(LOOP)
    by_gain = stability(model, StabilityOptions(gain="k_i", limits=("0", "4")))
    over = stability_over(model, StabilityOptions(over=("k_i",), limits=("0", "4")))
    assert [each.verdict.word for each in (by_gain, over)] == ["stable", "stable"]
    # Routh 1877: 1*5 > 2*k_i.
    assert [round(float(b.gain), 12) for each in (by_gain, over) for b in each.boundaries] == [2.5, 2.5]


def test_stability_of_a_loop_is_judged_with_a_loss_factor_of_0():
    text = """symflex = 1
parameters = { K = { value = "0 N/m", assume = "real" }, eta = { value = 0, assume = "nonnegative" } }
inputs.F = { force = "x" }
outputs.X = "x"
[elements]
m = { type = "mass", at = "x", m = "1 kg" }
d = { type = "damper", between = ["x", "ground"], b = "1 N*s/m" }
s = { type = "spring", between = ["x", "ground"], k = "2 N/m", eta_s = "eta" }
k = { type = "spring", between = ["x", "ground"], k = "K" }
"""
    found = stability(pipeline.loads(text), StabilityOptions(gain="K"))
    assert (found.verdict.word, [float(b.gain) for b in found.boundaries]) == ("stable", [-2.0])


def test_a_function_bound_with_a_value_of_0_still_has_the_parameter():
    """1/(s^2 + b s + k) with b = 0 has poles at +-j sqrt(k), and with 1 % of k at +-j sqrt(2 +- 0.02)."""
    letters = 'parameters = { b = { value = 3, assume = "real" }, k = 2 }'
    text = f'symflex = 1\n{letters}\ninputs.u = {{}}\noutputs.y = "u/(s^2 + b*s + k)"'
    function = symflex.loads(text).transfer_function("y", "u")
    bound = function.bind(b=0)
    (cloud,) = bound.root_clouds("1 %")
    assert cloud.count == 1
    low, high = cloud.sides[2:]
    assert low < 1.98**0.5 < 2.02**0.5 < high
    assert pickle.loads(pickle.dumps(bound))(1j) == bound(1j) == 1

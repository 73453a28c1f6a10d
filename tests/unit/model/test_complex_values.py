"""Filters and machines with complex coefficients, against numpy's roots of the polynomials they stand for."""

from math import cos, sin

import numpy as np
import pytest

from symflex import pipeline
from symflex.analysis.response import evaluate
from symflex.errors import SymflexError
from symflex.model.loss_factors import check_causal
from symflex.roots.locate import locate
from symflex.roots.loss_modes import COMPLEX

PAIR = {"p": "-3 + 4*j", "q": "-3 - 4*j"}
QUADRATIC = [1, 6, 25]
SEISMOMETER = {  # a broadband seismometer's poles, rad/s
    "p_1": "-0.037 + 0.037*j",
    "p_2": "-0.037 - 0.037*j",
    "p_3": "-15.64",
    "p_4": "-97.34 + 400.7*j",
    "p_5": "-97.34 - 400.7*j",
}
RATED = {"w_0": "5 rad/s", "zeta": "0.2"}


def model(output="H*v", definitions=(), blocks=(), parameters=(), signals=()):
    sections = [("parameters", parameters), ("definitions", definitions), ("blocks", blocks)]
    sections += [("inputs", {"v": {}}), ("signals", signals), ("outputs", {"U": output})]

    def written(value):
        if isinstance(value, dict):
            return "{ " + ", ".join(f"{k} = {written(v)}" for k, v in value.items()) + " }"
        return "[" + ", ".join(map(written, value)) + "]" if isinstance(value, list) else f'"{value}"'

    lines = ["symflex = 1"]
    for name, entries in sections:
        lines += [f"[{name}]", *(f"{k} = {written(v)}" for k, v in dict(entries).items())]
    return pipeline.loads("\n".join(lines))


def located(given):
    (bound,) = pipeline.derive_bound(given, given.transfer_functions)
    return bound, locate(bound, None, 15)


def values(roots):
    return sorted((complex(r) for r in roots for _ in range(r.multiplicity)), key=lambda z: (z.real, z.imag))


def test_conjugate_pairs_are_real_filters_however_they_are_written():
    seismic = np.poly([-0.037 + 0.037j, -0.037 - 0.037j, -15.64, -97.34 + 400.7j, -97.34 - 400.7j]).real
    across = np.poly([5 * complex(cos(2), sin(2)), 5 * complex(cos(2), -sin(2))]).real
    table = "s^2*(s + 15.15)/((s - p_1)*(s - p_2)*(s - p_3)*(s - p_4)*(s - p_5))"
    rated = {"p": "w_0*(-zeta + j*sqrt(1 - zeta^2))", "q": "w_0*(-zeta - j*sqrt(1 - zeta^2))"}
    turned = {"p": "r*(cos(2) + j*sin(2))", "q": "r*(cos(2) - j*sin(2))"}
    for given, num, den in [
        ({"definitions": SEISMOMETER, "blocks": {"H": table}}, [1, 15.15, 0, 0], seismic),
        ({"definitions": PAIR, "blocks": {"H": "25/((s - p)*(s - q))"}}, [25], QUADRATIC),
        (
            {
                "definitions": {"p_1": "-0.888 + 0.888*j", "p_2": "-0.888 - 0.888*j"},
                "blocks": {"H": "s^2/((s - p_1)*(s - p_2))"},
            },
            [1, 0, 0],
            [1, 1.776, 1.577088],
        ),
        ({"definitions": PAIR, "blocks": {"H": {"num": "25", "den": "(s - p)*(s - q)"}}}, [25], QUADRATIC),
        (
            {"definitions": PAIR, "blocks": {"H": {"num": ["25"], "den": ["1", "-(p + q)", "p*q"]}}},
            [25],
            QUADRATIC,
        ),
        ({"definitions": PAIR | {"b": "p + q", "c": "p*q"}, "output": "v/(s^2 - b*s + c)"}, [1], QUADRATIC),
        (
            {"definitions": PAIR, "blocks": {"A": "1/(s - p)", "B": "1/(s - q)"}, "output": "A*B*v"},
            [1],
            QUADRATIC,
        ),
        ({"definitions": PAIR, "output": "(1 - 2*j)*v/(s - p) + (1 + 2*j)*v/(s - q)"}, [2, 22], QUADRATIC),
        ({"blocks": {"H": "1/((s + 3 - 4*j)*(s + 3 + 4*j))"}}, [1], QUADRATIC),
        (
            {"definitions": PAIR, "blocks": {"H": "1/((s - p)^2*(s - q)^2)"}},
            [1],
            np.polymul(QUADRATIC, QUADRATIC),
        ),
        ({"definitions": rated, "parameters": RATED, "output": "v/((s - p)*(s - q))"}, [1], [1, 2, 25]),
        ({"definitions": turned, "parameters": {"r": "5"}, "output": "v/((s - p)*(s - q))"}, [1], across),
        (
            {"definitions": {"p": "5*exp(j*2)", "q": "5*exp(-j*2)"}, "output": "v/((s - p)*(s - q))"},
            [1],
            across,
        ),
        (
            {"definitions": PAIR, "signals": {"e": "v - y", "y": "25*e/((s - p)*(s - q)*s)"}, "output": "y"},
            [25],
            [1, 6, 25, 25],
        ),
    ]:
        made = model(**given)
        bound, found = located(made)
        assert made.imaginary is None, given
        check_causal(made, "a step")
        s = 1j * np.array([0.3, 2.0, 30.0])
        assert np.allclose(evaluate(bound, s.imag), np.polyval(num, s) / np.polyval(den, s)), given
        assert found.certificate.certified
        poles = sorted(np.roots(den), key=lambda z: (round(z.real, 6), z.imag))
        assert np.allclose(values(found.poles), poles, rtol=1e-5), given
        assert found.verdict.word == "stable"
        assert not found.verdict.reason


MACHINE = {"R": "0.5 Ohm", "L": "2 mH", "w": "300 rad/s"}
ROTOR = {"m": "2", "k": "800", "c": "3", "c_i": "1", "W": "50"}
WHIRL = {"k_r": "k - j*W*c_i"}


def test_complex_coefficients_have_all_their_poles_in_both_half_planes():
    controlled = {"i": "e/Z", "e": "(2 + 500/s)*(v - i)"}
    impedance = {"Z": "R + L*s + j*w*L"}
    closed = [2e-3, 0.5 + 0.6j + 2, 500]
    for given, den, word in [
        (
            {"definitions": {"p": "-3 + 4*j"}, "blocks": {"H": "1/((s - p)*(s - 2*p))"}},
            np.poly([-3 + 4j, -6 + 8j]),
            "stable",
        ),
        ({"definitions": {"p": "-3 - 4*j"}, "output": "v/(s - p)"}, [1, 3 + 4j], "stable"),
        ({"definitions": {"p": "3 - 4*j"}, "output": "v/(s - p)"}, [1, -3 + 4j], "unstable"),
        ({"blocks": {"H": "1/(s - 2*j)"}}, [1, -2j], "marginal"),
        ({"parameters": MACHINE, "definitions": impedance, "output": "v/Z"}, [2e-3, 0.5 + 0.6j], "stable"),
        (
            {"parameters": MACHINE, "definitions": impedance, "signals": controlled, "output": "i"},
            closed,
            "stable",
        ),
        (
            {"parameters": ROTOR, "definitions": WHIRL, "output": "v/(m*s^2 + (c + c_i)*s + k_r)"},
            [2, 4, 800 - 50j],
            "stable",
        ),
        (
            {
                "parameters": ROTOR | {"W": "100"},
                "definitions": WHIRL,
                "output": "v/(m*s^2 + (c + c_i)*s + k_r)",
            },
            [2, 4, 800 - 100j],
            "unstable",
        ),
    ]:
        made = model(**given)
        _, found = located(made)
        poles = sorted(np.roots(den), key=lambda z: (z.real, z.imag))
        assert np.allclose(values(found.poles), poles), given
        assert found.certificate.certified
        assert found.verdict.word == word, given
        assert found.verdict.reason.endswith(COMPLEX)
        with pytest.raises(SymflexError, match="complex coefficients"):
            check_causal(made, "a step")


def test_a_rotor_in_equations_whirls_forward_and_backward():
    text = """
symflex = 1
[equations]
unknowns = ["r"]
equations = ["0.2*s^2*r - j*15*s*r + 3*s*r + 800*r = M"]
[inputs]
M = {}
[outputs]
Y = "r"
"""
    _, found = located(pipeline.loads(text))
    expected = sorted(np.roots([0.2, 3 - 15j, 800]), key=lambda z: z.real)
    assert np.allclose(values(found.poles), expected)


# Around s = 1, conjugate pairs with the poles -2 + 3j and -2 - 3j: what cancels is a mode.
LEFT, RIGHT = "(s - 1)/(s + 2 + 3*j)", "1/((s - 1)*(s + 2 - 3*j))"
SHIFTED = {"p": "-2 + 3*j", "q": "-2 - 3*j", "a": "1/(1 - p)", "b": "1/(1 - q)"}
CANCELLED = {
    "in a signal": {"signals": {"y": f"{LEFT}*({RIGHT})*v"}, "output": "y"},
    "in an output": {"output": f"{LEFT}*({RIGHT})*v"},
    "of two definitions": {"definitions": {"C": LEFT, "P": RIGHT}, "output": "P*C*v"},
    "of two blocks": {"blocks": {"C": LEFT, "P": RIGHT}, "output": "P*C*v"},
    "in a block": {"blocks": {"H": f"{LEFT}*({RIGHT})"}},
    "in numerator and denominator": {
        "blocks": {"H": {"num": f"({LEFT})*({RIGHT})*(s - 1)", "den": "s - 1"}},
    },
    "in a factor of both": {
        "definitions": {"Q": "s - 1", "C": "Q/(s + 2 + 3*j)", "P": "1/(Q*(s + 2 - 3*j))"},
        "output": "P*C*v",
    },
    "by addition": {
        "definitions": SHIFTED,
        "output": "v*(1/((s - 1)*(s - p)) - a/(s - 1) + 1/((s - 1)*(s - q)) - b/(s - 1))",
    },
}


@pytest.mark.parametrize("where", CANCELLED)
def test_what_cancels_beside_a_conjugate_pair_is_hidden(where):
    made = model(**CANCELLED[where])
    assert made.imaginary is None
    _, found = located(made)
    assert np.allclose(values(found.poles), [-2 - 3j, -2 + 3j])
    assert {round(complex(h.root).real, 6) for h in found.hidden} == {1}
    assert found.verdict.word == "unstable"


def test_a_pair_that_cancels_is_hidden_and_half_a_pair_leaves_a_model_complex():
    pair = {"definitions": PAIR, "output": "v*(s - p)*(s - q)/((s - p)*(s - q)*(s + 3))"}
    _, found = located(model(**pair))
    assert np.allclose(
        sorted((complex(h.root) for h in found.hidden), key=lambda z: z.imag), [-3 - 4j, -3 + 4j]
    )
    assert model(definitions=PAIR, output="v*(s - p)/((s - p)*(s + 3))").imaginary is not None


def test_a_constant_that_cancels_and_what_terms_share_hide_nothing():
    shared = "v/(s^2 + 6*s + 25) + v/(s - p) + v/(s - q)"
    for given in [
        {"definitions": PAIR, "parameters": {"R": "2"}, "output": "R*v/((s - p)*(s - q)*R)"},
        {"definitions": PAIR, "output": "(1 + 2*j)*v/((s - p)*(s - q)*(1 + 2*j))"},
        {"definitions": PAIR, "output": shared},
    ]:
        _, found = located(model(**given))
        assert np.allclose(values(found.poles), [-3 - 4j, -3 + 4j]), given
        assert not found.hidden, given


def test_loss_factors_stay_loss_factors_beside_real_filters():
    spring = """
symflex = 1
inputs.F = { force = "x" }
outputs.X = "25*x/((s + 3 - 4*j)*(s + 3 + 4*j))"
[elements]
a = { type = "mass", at = "x", m = 2 }
k = { type = "spring", between = ["x", "ground"], k = 800, eta_s = 0.1 }
"""
    defined = {
        "parameters": {"eta": "0.1"},
        "definitions": {"K": "800*(1 + j*eta)"},
        "output": "v/(2*s^2 + K)",
    }
    upper = np.roots([2, 0, 800 * (1 + 0.1j)])
    (upper,) = upper[upper.imag > 0]
    for made, poles in [(pipeline.loads(spring), [-3 + 4j, upper]), (model(**defined), [upper])]:
        _, found = located(made)
        assert np.allclose(values(found.poles), sorted(poles, key=lambda z: z.real))
        assert found.verdict.word == "unknown"
        with pytest.raises(SymflexError, match="loss factors"):
            check_causal(made, "a step")


def test_definitions_in_a_circle_and_ones_that_double_at_every_step_are_left_as_they_are():
    with pytest.raises(SymflexError, match="circle"):
        model("v*a", {"a": "j*b + 1", "b": "a*a"})
    doubled = {f"d{i}": f"d{i + 1}*d{i + 1}*a{i}" for i in range(12)} | {"d12": "1 + 2*j"}
    assert model("v*d0", doubled, parameters={f"a{i}": "1" for i in range(12)}).imaginary is not None

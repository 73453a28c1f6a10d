"""Structural damping: what loss factors mean, by complex stiffnesses in numpy, and what they exclude."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

import symflex
from symflex.errors import SymflexError
from tests.unit.refusals import refusal

OMEGA = np.array([1.0, 9.9, 10.1, 40.0])
TWO_MASSES = """symflex = 1
parameters = { m_1 = "2 kg", m_2 = "1 kg", k_1 = "100 N/m", k_2 = "400 N/m", eta_1 = 0.05, eta_2 = 0.1 }
[elements]
a = { type = "mass", at = "x", m = "m_1" }
b = { type = "mass", at = "y", m = "m_2" }
s = { type = "spring", between = ["x", "ground"], k = "k_1", eta_s = "eta_1" }
t = { type = "spring", between = ["x", "y"], k = "k_2*(1 + j*eta_2)" }
[inputs]
F = { force = "x" }
[outputs]
X = "x"
Y = "y"
"""
ONE_MASS = """symflex = 1
[elements]
a = {{ type = "mass", at = "x", m = "1 kg" }}
s = {{ type = "spring", between = ["x", "ground"], k = "100 N/m"{} }}
[inputs]
F = {{ force = "x" }}
[outputs]
X = "{}"
"""
CANTILEVER = """symflex = 1
[elements]
wall = { type = "fixed", at = "a" }
arm = { type = "beam", between = ["a", "b"], EI = "56 N*m^2", rhoA = "0.162 kg/m", l = "0.5 m", eta_s = 0.02 }
[inputs]
F = { force = "b.y" }
[outputs]
Y = "b.y"
"""


def stiffness(eta_1=0.05, eta_2=0.1):
    k_1, k_2 = 100 * (1 + 1j * eta_1), 400 * (1 + 1j * eta_2)
    return np.array([[k_1 + k_2, -k_2], [-k_2, k_2]])


def receptance(omega):
    return np.linalg.inv(stiffness() - omega**2 * np.diag([2.0, 1.0]))[:, 0]


@pytest.mark.parametrize(("output", "row"), [("X", 0), ("Y", 1)])
def test_frequency_response_is_that_of_complex_stiffness(output, row):
    bound = symflex.loads(TWO_MASSES).transfer_function(output, "F").bind()
    expected = np.array([receptance(w)[row] for w in OMEGA])
    assert np.allclose(bound.frequency_response(OMEGA).values, expected, rtol=1e-13)
    assert np.allclose(bound(1j * OMEGA), expected, rtol=1e-13)


def test_modes_have_natural_frequencies_and_loss_factors():
    found = symflex.loads(TWO_MASSES).transfer_function("X", "F").bind().pole_zero_map()
    squares = sorted(np.linalg.eigvals(np.diag([0.5, 1.0]) @ stiffness()), key=abs)
    assert found.certificate.certified
    omega = [r.frequency_hz() * 2 * np.pi for r in found.poles]
    assert omega == pytest.approx([x.real**0.5 for x in squares])
    factors = [float(r.loss_factor().mid()) for r in found.poles]
    assert factors == pytest.approx([x.imag / x.real for x in squares])


def test_formula_prints_j_and_reduces_its_square():
    tf = symflex.loads(TWO_MASSES).transfer_function("X", "F")
    assert "1 + j*eta_1" in str(tf)
    assert "j^2" not in str(tf.form("polynomial"))


def test_beam_has_the_modes_and_response_of_its_complex_stiffness():
    bound = symflex.loads(CANTILEVER).transfer_function("Y", "F").bind()
    roots = (1.8751040687119611, 4.6940911329741746, 7.8547574382376126)
    frequencies = [q**2 * (56 / 0.162) ** 0.5 / 0.5**2 / (2 * np.pi) for q in roots]
    poles = bound.poles(modes=3)
    assert [p.frequency_hz for p in poles] == pytest.approx(frequencies, rel=1e-12)
    assert [p.loss_factor for p in poles] == pytest.approx([0.02] * 3, rel=1e-12)

    def deflection(omega):
        with mpmath.workdps(30):
            rigidity = 56 * (1 + 0.02j)
            q = mpmath.mpc(0.162 * omega**2 / rigidity) ** 0.25 * 0.5
            top = mpmath.cosh(q) * mpmath.sin(q) - mpmath.sinh(q) * mpmath.cos(q)
            below = 1 + mpmath.cosh(q) * mpmath.cos(q)
            return complex(0.5**3 / (rigidity * q**3) * top / below)

    assert np.allclose(bound(1j * OMEGA), [deflection(w) for w in OMEGA], rtol=1e-12)


def test_exported_numpy_is_the_response():
    module = {}
    exec(symflex.loads(TWO_MASSES).export_numpy(), module)  # noqa: S102
    values = module["TRANSFER_FUNCTIONS"]["X/F"](1j * OMEGA)
    assert np.allclose(values, [receptance(w)[0] for w in OMEGA], rtol=1e-13)


def test_what_needs_another_s_is_refused():
    model = symflex.loads(TWO_MASSES)
    tf = model.transfer_function("X", "F")
    bound = tf.bind()
    for call in (
        lambda: bound.step_response([0.0, 1.0]),
        bound.step_response,
        bound.step_info,
        bound.input_shaper,
        bound.residues,
        bound.rational,
        bound.sensitivities,
        bound.explain_zeros,
        bound.state_space,
        bound.to_scipy,
        bound.dcgain,
        lambda: bound.discretise(0.01),
        lambda: bound.mode_shape(1),
        lambda: bound.frequency_response([0.0, 1.0]),
        lambda: bound(1.0 + 1j),
        lambda: bound(-1j),
        lambda: tf.form("zpk"),
        tf.state_space,
        model.state_space,
        lambda: model.stability("k_1"),
        lambda: model.sweep({"k_1": [1.0, 2.0]}),
        model.export_c,
        model.export_matlab,
        model.export_state_space,
    ):
        assert refusal(call) == "ModelError SF251"
    assert refusal(lambda: tf.bind(j=2.0)) == "UsageError SF902"


@pytest.mark.parametrize(
    ("text", "code"),
    [
        (ONE_MASS.format("", "j*x"), "SF210"),
        (ONE_MASS.format(", eta_s = 0.1", "j*x"), "SF210"),
        (CANTILEVER.replace('"0.5 m"', '"0.5*j"'), "SF210"),
        (ONE_MASS.format(', eta_s = "2 s"', "x"), "SF203"),
        ("parameters.j = 3\n".join(ONE_MASS.format(", eta_s = 0.1", "j*x").split("\n", 1)), "SF211"),
    ],
)
def test_j_elsewhere_is_refused(text, code):
    text = text.replace("symflex = 1parameters", "symflex = 1\nparameters")
    with pytest.raises(SymflexError) as caught:
        symflex.loads(text)
    (problem,) = caught.value.diagnostics
    assert problem.code == code
    if code == "SF210":
        assert "j^2 = -1" in problem.hint


def test_a_parameter_may_still_be_called_j():
    text = ONE_MASS.format("", "j*x").replace("[elements]", "parameters.j = 3\n[elements]")
    assert "j" in str(symflex.loads(text).transfer_function("X", "F"))

"""Delays written as exp(-s*T) mean what a block of type delay means."""

import cmath

import mpmath
import pytest

from symflex import pipeline, transfer
from symflex.errors import ModelError, SpecError
from symflex.roots import Modes

TEXT = """symflex = 1
parameters = {{ K = 3, T = "0.2 s" }}
definitions = {{ C = "D/s", D = "K*exp(-s*T)", late = "s*T" }}
blocks.P = {{ type = "tf", num = "K*exp(-s*T)", den = [1, 2] }}
signals.y = "{signal}"
inputs.r = {{}}
outputs.Y = "{output}"
"""
S = complex(0.3, 1.7)
LATE = 3 * cmath.exp(-0.2 * S)


def value(signal, output="y"):
    (function,) = pipeline.derive_all(pipeline.loads(TEXT.format(signal=signal, output=output)))
    return transfer.bind(function)(S)


@pytest.mark.parametrize(
    ("signal", "expected"),
    [
        ("K*exp(-s*T)*(r - y)", LATE / (1 + LATE)),
        ("K*exp(-T*s)*(r - y)", LATE / (1 + LATE)),
        ("3*exp(-0.2*s)*(r - y)", LATE / (1 + LATE)),
        ("K*exp(s*-T)*r", LATE),
        ("K*exp(-s*T/2)*exp(-(T/2)*s)*r", LATE),
        ("K*exp(-s*(T + T))*r", LATE**2 / 3),
        ("K*exp(-s*T - 2*T*s)*r", LATE**3 / 9),
        ("K*exp(-(s + 2)*T)*r", LATE * cmath.exp(-0.4)),
        ("K*exp(-(s - 1)*T)*r", LATE * cmath.exp(0.2)),
        ("K*exp(-T*(s + 5*K))*r", LATE * cmath.exp(-3)),
        ("K*exp(2 - s*T)*r", LATE * cmath.exp(2)),
        ("K*exp(-(2*s + 4)*T/2)*r", LATE * cmath.exp(-0.4)),
        ("K*exp(-late)*r", LATE),
        ("D*(r - y)", LATE / (1 + LATE)),
        ("C*(r - y)", LATE / (S + LATE)),
        ("P*(r - y)", LATE / (S + 2 + LATE)),
        ("r - delay_1*0", None),
    ],
)
def test_a_delay_is_written_in_signals_definitions_and_tf_blocks(signal, expected):
    if expected is None:
        with pytest.raises(SpecError, match="unknown name 'delay_1'"):
            value(signal)
        return
    assert value(signal) == pytest.approx(expected, rel=1e-12)


def test_a_delay_is_written_in_an_output():
    assert value("K*r", "y*exp(-s*T)") == pytest.approx(LATE, rel=1e-12)


@pytest.mark.parametrize(
    ("signal", "said"),
    [
        ("exp(s*T)*r", r"a delay cannot look ahead; the z of a sampled controller is 1/exp\(-s\*T\)"),
        ("exp(-s^2*T)*r", "exp of an expression in s is not available yet"),
        ("exp(-s*K)*r", None),
        ("exp(-s*y)*r", "'y' is the signal 'y'"),
        ("exp(-s*U)*r", "unknown name 'U'"),
    ],
)
def test_what_is_no_delay_is_refused_at_its_place(signal, said):
    if said is None:  # K has no unit of its own: a number of seconds
        assert value(signal) == pytest.approx(cmath.exp(-3 * S), rel=1e-12)
        return
    with pytest.raises(SpecError, match=said) as caught:
        value(signal)
    assert caught.value.diagnostics[0].span.line == 5


def test_a_power_of_e_is_said_to_be_an_exponential_function():
    with pytest.raises(SpecError) as caught:
        value("e^(-s*T)*r")
    assert ("SF225", "an exponential function is exp(...), as in exp(-s*T)") in {
        (d.code, d.hint) for d in caught.value.diagnostics
    }


def test_definitions_that_would_double_without_end_are_not_written_out():
    doubled = "\n".join(f'A{i} = "A{i - 1} + A{i - 1}"' for i in range(1, 60))
    text = f'symflex = 1\nparameters.T = 1\n[definitions]\nA0 = "exp(-s*T)"\n{doubled}\n'
    with pytest.raises(SpecError, match="exp of an expression in s is not available yet"):
        pipeline.loads(text + '[signals]\ny = "A59*r"\n[inputs]\nr = {}\n[outputs]\nY = "y"\n')


RIJKE = """symflex = 1
parameters = { rho = "1.2 kg/m^3", c = "343 m/s", L = "1 m", x_f = "0.25 m", n = 0.1, tau = "1 ms" }
definitions.Q = "n*exp(-s*tau)"
inputs.p_0 = { unit = "Pa" }
outputs.p_f = "p2(x_f)"
[fields.cold]
domain = ["0", "x_f"]
unknowns = ["p1", "u1"]
equations = ["p1' = -rho*s*u1", "u1' = -s/(rho*c^2)*p1"]
conditions = ["p1(0) = p_0", "p1(x_f) = p2(x_f)"]
[fields.hot]
domain = ["x_f", "L"]
unknowns = ["p2", "u2"]
equations = ["p2' = -rho*s*u2", "u2' = -s/(rho*c^2)*p2"]
conditions = ["u2(x_f) = HEAT*u1(x_f)", "p2(L) = 0"]
"""


def test_a_delay_is_written_in_a_condition_of_a_field():
    def determinant(s):  # waves p_1 = sinh(s*x/c), p_2 = sinh(s*(L - x)/c) about the heat source
        return mpmath.sinh(s / 343) + 0.1 * mpmath.exp(-s / 1000) * mpmath.cosh(s / 1372) * mpmath.sinh(
            3 * s / 1372
        )

    growing = [mpmath.findroot(determinant, start) for start in (14 + 1086j, 2 + 3250j)]
    for heat in ("(1 + n*exp(-s*tau))", "(1 + exp(-tau*s)*n)", "(1 + Q)"):
        (bound,) = pipeline.derive_bound(pipeline.loads(RIJKE.replace("HEAT", heat)), [("p_f", "p_0")])
        found = [complex(r) for r in pipeline.roots(bound, Modes(3)).poles if r.re > 0 and r.im > 0]
        assert found == pytest.approx([complex(s) for s in growing], rel=1e-12)


def test_a_delay_in_an_equation_of_a_field_is_refused_with_its_reason():
    text = RIJKE.replace("HEAT", "1").replace("definitions.Q", "# ")
    text = text.replace("-s/(rho*c^2)*p2", "-s/(rho*c^2)*(1 + n*exp(-s*tau))*p2")
    with pytest.raises(ModelError, match="a delay inside a field's equation") as caught:
        pipeline.derive_all(pipeline.loads(text))
    assert caught.value.diagnostics[0].span.line == 14

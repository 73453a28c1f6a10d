"""Dead times written as exp(-s*T) mean what a block of type delay means."""

from __future__ import annotations

import cmath

import pytest

from symflex import pipeline, transfer
from symflex.errors import SpecError

TEXT = """symflex = 1
parameters = {{ K = 3, T = "0.2 s" }}
definitions = {{ C = "D/s", D = "K*exp(-s*T)" }}
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
        ("D*(r - y)", LATE / (1 + LATE)),
        ("C*(r - y)", LATE / (S + LATE)),
        ("P*(r - y)", LATE / (S + 2 + LATE)),
        ("r - delay_1*0", None),
    ],
)
def test_a_dead_time_is_written_in_signals_definitions_and_tf_blocks(signal, expected):
    if expected is None:
        with pytest.raises(SpecError, match="unknown name 'delay_1'"):
            value(signal)
        return
    assert value(signal) == pytest.approx(expected, rel=1e-12)


def test_a_dead_time_is_written_in_an_output():
    assert value("K*r", "y*exp(-s*T)") == pytest.approx(LATE, rel=1e-12)


@pytest.mark.parametrize(
    ("signal", "said"),
    [
        ("exp(s*T)*r", "a delay cannot look ahead"),
        ("exp(-s^2*T)*r", "exp of an expression in s is not available yet"),
        ("exp(-s*K)*r", None),
        ("exp(-s*y)*r", "'y' is the signal 'y'"),
        ("exp(-s*U)*r", "unknown name 'U'"),
    ],
)
def test_what_is_no_dead_time_is_refused_at_its_place(signal, said):
    if said is None:  # K has no unit of its own: a number of seconds
        assert value(signal) == pytest.approx(cmath.exp(-3 * S), rel=1e-12)
        return
    with pytest.raises(SpecError, match=said) as caught:
        value(signal)
    assert caught.value.diagnostics[0].span.line == 5


def test_definitions_that_would_double_without_end_are_not_written_out():
    doubled = "\n".join(f'A{i} = "A{i - 1} + A{i - 1}"' for i in range(1, 60))
    text = f'symflex = 1\nparameters.T = 1\n[definitions]\nA0 = "exp(-s*T)"\n{doubled}\n'
    with pytest.raises(SpecError, match="exp of an expression in s is not available yet"):
        pipeline.loads(text + '[signals]\ny = "A59*r"\n[inputs]\nr = {}\n[outputs]\nY = "y"\n')

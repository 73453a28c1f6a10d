"""Loops for the tests of stable gains."""

from __future__ import annotations

import pytest

import symflex

BEAM = """
symflex = 1
[parameters]
K = { value = "1 kN/m" }
E = "200 GPa"
I = "4000 mm^4"
rho = "7850 kg/m^3"
A = "480 mm^2"
l = "1.086 m"
b = "20 N*s/m"
[signals]
F = "K*(r - SENSOR)"
[elements]
drive = { type = "force_source", at = "act", f = "F" }
guide = { type = "slider", at = "act" }
DAMPER
link = { type = "beam", between = ["act", "tip"], E = "E", I = "I", rho = "rho", A = "A", l = "l" }
[inputs]
r = {}
[outputs]
X = "tip"
"""
DAMPER = 'friction = { type = "damper", between = ["act", "ground"], b = "b" }'


@pytest.fixture
def loop():
    """Return a function that closes a unity feedback loop around an expression."""

    def close(expression: str, K: object = 1, T: str = "0.5 s", **more: object) -> symflex.Model:
        return symflex.Model(
            parameters={"K": K if isinstance(K, dict) else {"value": K}, "T": {"value": T}, **more},
            blocks={"D": {"type": "delay", "T": "T"}},
            signals={"y": f"{expression}*(r - y)"},
            inputs={"r": {}},
            outputs={"Y": "y"},
        )

    return close


@pytest.fixture
def lossless_beam():
    """Return a function that closes a loop around an undamped beam."""

    def close(sensor: str, *, is_damped: bool = False) -> symflex.Model:
        text = BEAM.replace("SENSOR", sensor).replace("DAMPER", DAMPER if is_damped else "")
        return symflex.loads(text if is_damped else text.replace('b = "20 N*s/m"\n', ""))

    return close

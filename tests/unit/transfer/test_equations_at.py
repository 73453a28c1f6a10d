"""Equations with numbers, against derivatives by hand."""

import pytest
from flint import acb

from symflex import pipeline
from symflex.transfer.bind import read_values
from symflex.transfer.equations_at import EquationsAt

OSCILLATOR = """
symflex = 1
[parameters]
m = "2 kg"
k = "8 N/m"
[elements]
body = { type = "mass", at = "x", m = "m" }
spring = { type = "spring", between = ["x", "ground"], k = "k" }
damper = { type = "damper", between = ["x", "ground"], b = "sqrt(k*m)" }
[inputs]
F = { force = "x" }
[outputs]
X = "x"
"""


@pytest.mark.parametrize(("along", "slope"), [("s", 4 * 3 + 4), ("m", 9 + 3), ("k", 1 + 3 * 0.25)])
def test_functions_of_two_parameters_move_along_one(along, slope):
    # m s^2 + sqrt(k m) s + k at s = 3: d/ds 2 m s + 4, d/dm s^2 + s sqrt(k/m)/2, d/dk 1 + s sqrt(m/k)/2.
    equations = pipeline.assemble(pipeline.loads(OSCILLATOR))
    at = EquationsAt(equations, read_values(equations.model.parameters, {}))
    entry = at.on(acb(3), along)(at.entries()[0][0])
    assert (complex(entry[0]), complex(entry[1])) == pytest.approx((18 + 12 + 8, slope), rel=1e-15)
    assert complex(at.value("X", "F", acb(3))) == pytest.approx(1 / (18 + 12 + 8), rel=1e-15)

"""Spans whose numerator grows in a length in which the denominator does not: exponentials stay in range."""

import numpy as np
import pytest

from symflex import pipeline
from symflex.codegen.program.evaluate import evaluate
from tests.unit.codegen.exportable import program_of

SPANS = """
symflex = 1
parameters = {{ EI = "84 N*m^2", mu = "0.405 kg/m", c = "{loss} N*s/m^2", l = "0.8 m", x_o = "0.57 m" }}
inputs.F = {{}}
outputs.Y = "{output}"
[fields.w_1]
domain = ["0", "l/3"]
equation = "EI*w_1'''' + mu*s^2*w_1 + c*s*w_1 = 0"
conditions = ["{first}", "w_1'''(0) = 0", "{inside} = 0"]
[fields.w_2]
domain = ["l/3", "l"]
equation = "EI*w_2'''' + mu*s^2*w_2 + c*s*w_2 = 0"
conditions = [
  "w_2(l/3) = w_1(l/3)", "w_2'(l/3) = w_1'(l/3)", "w_2''(l/3) = w_1''(l/3)", "w_2'''(l/3) = w_1'''(l/3)",
  "{last} = F",
]
"""
FAR = (1e8j, -5e7 + 1e8j, 1e10j, 1e12j)


@pytest.mark.slow
@pytest.mark.parametrize(
    "model",
    [
        SPANS.format(loss=0.1, output="w_2(x_o)", first="w_1'(0) = 0", inside="w_1(l/6)", last="w_2''(l)"),
        SPANS.format(loss=0.3, output="w_1(0)", first="w_1''(0) = 0", inside="w_2(x_o)", last="w_2(l)"),
    ],
    ids=["condition inside the first span", "condition inside the second span"],
)
def test_spans_with_a_condition_inside_have_finite_values_at_any_frequency(model):
    (tf,) = pipeline.derive_all(pipeline.loads(model))
    values = {name: float(v.rational) for name, v in pipeline.bind(tf).values}
    found = evaluate(program_of(tf), np.array(FAR), values)
    # The conditions inside keep all but decaying waves from the output: nothing of them is left there.
    assert np.abs(found).max() < 1e-200

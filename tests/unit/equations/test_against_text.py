"""What is read of an expression is compared with it, and what was read wrongly is not used."""

import pytest

from symflex import pipeline
from symflex.algebra import Factored
from symflex.equations import evaluate
from symflex.equations.against_text import compare
from symflex.errors import InternalError, Text
from symflex.expressions import Name, Product, format_expression, parse

PRIME = 2**61 - 1
NUMBERS = {"x": 5, "y": 1, "k": 3}


def expression(text):
    return parse(Text.alone("", text))


def check(text, read):
    def leaf(node):
        assert isinstance(node, Name)
        return NUMBERS[node.name]

    compare(expression(text), read, leaf, PRIME)


def test_what_has_no_value_at_the_point_is_not_compared():
    check("x/(y - 1)", 7)
    check("x/z", 7)
    check("x", None)


LOOP = """
symflex = 1
parameters = { K = "2 N/m", m = "3 kg", T = "1 s" }
signals.u = "K*(r - T*s*x)"
inputs.r = { unit = "m" }
outputs.y = "x"
elements.body = { type = "mass", at = "x", m = "m" }
elements.force = { type = "force_source", at = "x", f = "u" }
"""
FIELD = """
symflex = 1
parameters = { N = "2 N", mu = "3 kg/m", l = "1 m" }
inputs.F = { unit = "N" }
outputs.y = "w(l)"
[fields]
w = { domain = ["0", "l"], equation = "N*w'' = mu*s^2*w", conditions = ["w(0) = 0", "N*w'(l) = F"] }
"""


def test_a_product_that_loses_a_factor_is_noticed(monkeypatch):
    pipeline.assemble(pipeline.loads(LOOP))
    monkeypatch.setattr(evaluate.ExactEvaluator, "_product", lambda self, left, right, expression: right)
    with pytest.raises(InternalError, match="was not read as it is written"):
        pipeline.assemble(pipeline.loads(LOOP))


def test_a_field_whose_equation_changes_a_sign_is_noticed(monkeypatch):
    pipeline.assemble(pipeline.loads(FIELD))
    read = evaluate.ExactEvaluator.linear

    def changed(self, side):
        sign = -1 if "w''" in format_expression(side) and isinstance(side, Product) else 1
        return read(self, side) * Factored.number(self.ring, sign)

    monkeypatch.setattr(evaluate.ExactEvaluator, "linear", changed)
    with pytest.raises(InternalError, match="SF991"):
        pipeline.assemble(pipeline.loads(FIELD))

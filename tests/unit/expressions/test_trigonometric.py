"""Sums for products of sines and cosines, against their values."""

import math

import pytest

from symflex.errors import Text
from symflex.expressions import fold, format_expression, parse
from symflex.expressions.trigonometric import shorter


@pytest.mark.parametrize("kind", ["sin", "cos"])
@pytest.mark.parametrize("quarters", range(-5, 6))
@pytest.mark.parametrize("rest", ["", " + x"])
def test_quarter_turns_are_carried_out(kind, quarters, rest):
    angle = f"{quarters}*pi/2{rest}" if quarters >= 0 else f"-{-quarters}*pi/2{rest}"
    short = shorter(parse(Text.alone("text", f"m*g*{kind}({angle})")))
    assert "pi" not in format_expression(short)
    value = fold(
        short,
        number=float,
        name={"m": 2, "g": 5, "x": 0.3}.__getitem__,
        power=None,
        call=lambda call, inner: getattr(math, call.name)(inner),
    )
    x = 0.3 if rest else 0
    assert value == pytest.approx(10 * getattr(math, kind)(quarters * math.pi / 2 + x), abs=1e-12)

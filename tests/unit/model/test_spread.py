"""How far parameters may be off, and the box they lie in then; what is refused is in golden/broken."""

from dataclasses import replace
from fractions import Fraction
from math import pi

import pytest

from symflex import Model
from symflex.errors import UsageError
from symflex.model import ExactValue, spread_box

PARAMETERS = {
    "share": {"value": "2 kg", "spread": "10 %"},
    "number": {"value": 4, "spread": 0.25},
    "own": {"value": "30 mm", "spread": "0.5 mm"},
    "cycles": {"value": "10 Hz", "spread": "1 Hz"},
    "angle": {"value": "10 deg", "spread": "1 deg"},
    "below": {"value": -2, "spread": "5 %", "assume": "real"},
    "zero": {"value": 0, "spread": "1 mm", "unit": "m", "assume": "real"},
    "none": 3,
}
BOX = {
    "share": (1.8, 2.2),
    "number": (3, 5),
    "own": (0.0295, 0.0305),
    "cycles": (9, 11),
    "angle": (pi / 20, 11 * pi / 180),
    "below": (-2.1, -1.9),
    "zero": (-0.001, 0.001),
}


def test_a_spread_is_a_share_or_in_the_unit_of_the_value():
    model = Model(parameters=PARAMETERS, inputs={"u": {}}, outputs={"y": "u/(s + angle*cycles)"})
    box = spread_box(model.parameters)
    assert list(box) == list(BOX)
    for name, ends in box.items():
        assert tuple(map(float, ends)) == pytest.approx(BOX[name], rel=1e-15), name
    assert box["angle"][0] < Fraction(314159265358979323846264338327950288, 20 * 10**35)
    every = spread_box(model.parameters, Fraction(1, 2))
    assert every["none"] == (Fraction(3, 2), Fraction(9, 2))
    assert "zero" not in every
    assert 'share = { value = "2 kg", spread = "10 %" }' in model.to_toml()


def test_a_box_that_no_value_may_have_is_refused():
    given = {"m": {"value": "2 kg", "spread": "1 kg"}}
    model = Model(parameters=given, inputs={"u": {}}, outputs={"y": "u/(m*s + 1)"})
    assert spread_box(model.parameters) == {"m": (1, 3)}
    light = replace(model.parameters[0], value=ExactValue(Fraction(1)))
    with pytest.raises(UsageError, match="reaches values"):
        spread_box([light])
    with pytest.raises(UsageError, match="no parameter"):
        spread_box([])

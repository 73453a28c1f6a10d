from fractions import Fraction

import pytest

from symflex.errors import BudgetError, UsageError
from symflex.model import ExactValue, ModelParameter
from symflex.sweep import Design, Range, design_of, read_design
from symflex.sweep.design import number
from tests.unit.refusals import refusal
from tests.unit.sweep.models import oscillator

PARAMETERS = oscillator().parameters


def values(text):
    return [point[0] for point in read_design(PARAMETERS, [text]).points]


def rationals(text):
    return [value.rational for value in values(text)]


def test_a_list_is_taken_exactly_and_in_its_order():
    assert rationals("k=3,1/3,0.1") == [3, Fraction(1, 3), Fraction(1, 10)]


def test_units_are_converted_exactly():
    assert rationals("k=1 kN/m, 2 N/mm") == [1000, 2000]


def test_cycles_become_radians():
    (value,) = values("f=3 Hz")
    assert value == ExactValue(Fraction(6), 1) or value == ExactValue(Fraction(3), 0)


def test_linear_values_are_equally_spaced():
    assert rationals("k=1:2:lin:5") == [1, Fraction(5, 4), Fraction(3, 2), Fraction(7, 4), 2]
    assert rationals("k=1:2:5") == rationals("k=1:2:lin:5")


def test_logarithmic_values_have_equal_ratios():
    found = rationals("k=1e4:1e6:log:5")
    assert found[0] == 10**4 and found[2] == 10**5 and found[4] == 10**6
    assert float(found[1]) == pytest.approx(10**4.5, rel=1e-14)


def test_a_range_may_fall():
    assert rationals("k=3:1:lin:3") == [3, 2, 1]


def test_values_between_are_what_a_double_holds():
    for value in rationals("k=1:3:log:40"):
        assert Fraction(repr(float(value))) == value


def test_the_last_axis_varies_fastest():
    design = read_design(PARAMETERS, ["m=1,2", "k=3,4,5"])
    assert design.shape == (2, 3)
    assert [(p[0].rational, p[1].rational) for p in design.points[:4]] == [(1, 3), (1, 4), (1, 5), (2, 3)]


def test_every_part_of_a_range_is_met_once():
    design = read_design(PARAMETERS, ["k=1:3", "m=10:1000:log"], 20)
    for column in design.shares:
        assert sorted(int(share * 20) for share in column) == list(range(20))
    stiffness = [float(point[0].rational) for point in design.points]
    assert sorted(int((k - 1) / 2 * 20) for k in stiffness) == list(range(20))


def test_a_seed_says_which_numbers_are_drawn():
    first, same, other = (read_design(PARAMETERS, ["k=1:3"], 9, seed).points for seed in (4, 4, 5))
    assert first == same
    assert first != other


def test_a_tolerance_is_about_the_declared_value():
    (limits,) = read_design(PARAMETERS, ["b=+-10%"], 5).ranges
    assert (limits.low.rational, limits.high.rational) == (Fraction(45, 100), Fraction(55, 100))


def test_draws_are_repeated_at_every_point_of_a_grid():
    design = read_design(PARAMETERS, ["m=1,2", "k=1:3"], 4)
    assert design.shape == (2, 4)
    assert [p[1] for p in design.points[:4]] == [p[1] for p in design.points[4:]]


REFUSED = {
    "SF902": (
        *(
            "",
            "k",
            "k=",
            "=3",
            "kk=1,2",
            "k=1:2",
            "k=1:2:log",
            "k=1:2:cubic:3",
            "k=1:2:log:0",
            "k=1:2:log:-3",
        ),
        *("k=1:2:log:3:4", "k=1:2:lin:٣", "b=0:2:log:3", "k=1:1:lin:3", "k=1,,2", "k=1,two", "k=+-5%"),
        *("k=__import__('os')", "k=1:2:lin:0e3", "k=1:2:lin:1e-1", "k=1:2:lin:1.5", "k=1e999999999:2:lin:3"),
    ),
    "SF203": ("k=1 kg,2",),
    "SF209": (
        *("k=-1,2", "k=0,1", "k=0 N/mm", "k=0:2:lin:3", "k=2:0:lin:3", "f=0 Hz,1 Hz"),
        # Ranges to draw from that begin at zero, or below it.
        *("k=0:2", "k=+-100%", "k=+-150%"),
    ),
    "SF507": (
        *("k=1:2:lin:99999999", "k=1:2:lin:1000000000", "k=1:2:lin:1e9", "k=1:2:1e+9"),
        *("k=1:2:lin:1" + 5000 * "0", "k=1:2:lin:1e" + 5000 * "9", "k=1" + 1_000_000 * ",1"),
    ),
}
DRAWN = ("k=0:2", "k=+-100%", "k=+-150%")


def test_what_cannot_be_swept_is_refused():
    found = {
        text[:40]: (code, refusal(read_design, PARAMETERS, [text], 10 if text in DRAWN else 0)[-5:])
        for code, texts in REFUSED.items()
        for text in texts
    }
    assert {text: codes for text, codes in found.items() if codes[0] != codes[1]} == {}


def test_values_in_python_are_refused_at_zero_as_those_of_a_specification_are():
    for zero in (0, 0.0, -0.0, "0 N/m", Fraction(0)):
        assert refusal(design_of, PARAMETERS, {"k": [1, zero]}) == "UsageError SF209", repr(zero)


def test_zero_is_a_value_of_what_may_vanish():
    assert rationals("b=0,1") == [0, 1]
    assert rationals("b=0:1:lin:3") == [0, Fraction(1, 2), 1]
    (limits,) = read_design(PARAMETERS, ["b=+-100%"], 5).ranges
    assert (limits.low.rational, limits.high.rational) == (0, 1)
    signed = [ModelParameter("c", None, assume="real")]
    assert [p[0].rational for p in read_design(signed, ["c=-1:1:lin:3"]).points] == [-1, 0, 1]


def test_a_count_may_be_written_as_a_power_of_ten():
    assert rationals("k=1:2:lin:1e1") == rationals("k=1:2:lin:10")
    assert len(rationals("k=1:2:lin:02E+1")) == 20


def test_a_parameter_is_swept_once():
    with pytest.raises(UsageError, match="twice"):
        read_design(PARAMETERS, ["k=1,2", "k=3,4"])


def test_draws_need_a_range():
    with pytest.raises(UsageError, match="no range"):
        read_design(PARAMETERS, ["k=1,2"], 10)


def test_python_takes_sequences():
    design = design_of(PARAMETERS, {"k": [1, 0.1, "2 N/mm"], "m": "1:2:lin:2"})
    assert design.shape == (3, 2)
    assert [axis.name for axis in design.axes] == ["k", "m"]
    assert design.axes[0].values[1].rational == Fraction(1, 10)


def test_points_are_limited():
    with pytest.raises(BudgetError, match="SF507"):
        Design((), (Range("k", ExactValue(Fraction(1)), ExactValue(Fraction(2))),), 1_000_001)


def test_numbers_are_in_si_units():
    assert number(ExactValue(Fraction(2), 1)) == pytest.approx(6.283185307179586)

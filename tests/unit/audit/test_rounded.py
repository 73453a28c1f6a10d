"""Printed numbers against values, to the digits that are printed."""

import pytest

from symflex.audit.rounded import is_right_to_its_digits
from symflex.errors import Text
from symflex.expressions import Expression, parse


def expression(text: str) -> Expression:
    return parse(Text.alone("formula", text))


@pytest.mark.parametrize(
    ("printed", "derived", "is_right"),
    [
        ("2.792/(s^2 + 0.717*s + 9.985)", "2.79245/(s^2 + 0.71698*s + 9.98491)", True),
        ("2.792/(s^2 + 0.717*s + 9.985)", "2.7927/(s^2 + 0.717*s + 9.985)", False),  # 2.7927 rounds to 2.793
        ("2.792/(s^2 + 0.717*s + 9.985)", "5.58490/(2*s^2 + 1.43396*s + 19.96982)", True),  # all times 2
        ("2.79/(s^2 + 0.717*s)", "2.79/(s^2 + 0.717*s + 0.001)", False),  # a term is missing
        ("3/(s + 2)", "3.01/(s + 2)", False),  # small whole numbers are exact
        ("1230/(s + 2)", "1230.4/(s + 2)", True),
        ("1.5e-3*s/(s + 2)", "1.52e-3*s/(s + 2)", True),
        ("-1.0/(s^2 - 4.0)", "-1.02/(s^2 - 4.01)", True),
        ("0.50/(s + 1)", "0.53/(s + 1)", False),  # two digits are printed
        ("1.0/((s + 1.5)*(s + 2.5))", "1/(s^2 + 4*s + 3.75)", False),  # not compared: brackets
        ("1.0/(k*s + 1)", "1/(k*s + 1)", False),  # not compared: a name
    ],
)
def test_coefficients_are_intervals_as_wide_as_their_last_digit(printed, derived, is_right):
    assert is_right_to_its_digits(expression(printed), expression(derived)) is is_right

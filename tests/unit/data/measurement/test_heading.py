"""Names and units as people type the headings of columns."""

import pytest

from symflex.data.measurement.heading import units_below, with_unit
from symflex.data.measurement.text_table import TextTable


@pytest.mark.parametrize(
    ("cell", "expected"),
    [
        ("x [mm]", ("x", "mm")),
        ("F in kN", ("F", "kN")),
        ("acc_m_s2", ("acc", "m/s2")),
        ("V(out)", ("V(out)", "V")),
        ("speed (rad/s)", ("speed", "rad/s")),
        ("run 3", ("run 3", "")),
    ],
)
def test_a_unit_stands_behind_a_name(cell, expected):
    assert with_unit(cell, "") == expected


def test_units_may_have_a_line_of_their_own():
    table = TextTable.of("a.csv", b"t,F\n(s),(mN)\n0,1\n1,2\n")
    assert units_below(table, 2, ["t", "F"]) == ["s", "mN"]
    assert units_below(table, 1, ["t", "F"]) == []

"""What every column of tables of roots promises, whatever page it stands on."""

import functools

import pytest

from symflex import pipeline
from symflex.print.html import roots_html
from symflex.print.latex import root_table
from symflex.print.roots import MODE_COLUMNS, PAGE_COLUMNS, PAPER_COLUMNS, one_of_each_pair
from symflex.quantities import unit_of

# s^2 + 6 s + 25 has the roots -3 +- 4j; the servo's integrator adds one at 0.
TEXT = """
symflex = 1
elements.body = { type = "mass", at = "x", m = 1 }
elements.wall = { type = "spring", between = ["x", "ground"], k = 25 }
elements.oil = { type = "damper", between = ["x", "ground"], b = 6 }
inputs.F = { force = "x" }
outputs.X = "x/s"
"""


@functools.cache
def found():
    return pipeline.roots(pipeline.derive_bound(pipeline.loads(TEXT), [("X", "F")])[0])


def test_columns_show_numbers_in_units_or_nothing():
    for column in dict.fromkeys((*PAGE_COLUMNS, *PAPER_COLUMNS, *MODE_COLUMNS)):
        assert not column.unit or unit_of(column.unit).scale, column.head
        for entry in one_of_each_pair(found().poles):
            (cell,) = entry.cells([column], 6)
            assert cell == "" or float(cell) > -4, column.head


def test_columns_of_pages_are_in_notebooks_and_those_of_paper_in_tables():
    page, table = roots_html(found()), root_table(found(), "poles")
    assert [c.head for c in PAGE_COLUMNS if f">{c.head}<" not in page] == []
    assert [c.head for c in PAPER_COLUMNS if not all(line in table for line in c.paper)] == []


def test_the_columns_of_a_known_pair_are_those_of_a_right_triangle():
    (pair,) = [entry for entry in one_of_each_pair(found().poles) if entry.is_pair]
    shown = dict(zip((c.head for c in PAGE_COLUMNS), pair.cells(PAGE_COLUMNS, 6), strict=True))
    assert (shown["Re s [rad/s]"], shown["Im s [rad/s]"]) == ("-3.00000", "4.00000")
    assert float(shown["damping ratio"]) == 0.6
    assert float(shown["frequency [Hz]"]) == pytest.approx(5 / 6.283185307, rel=1e-5)
    assert shown["multiplicity"] == "1"

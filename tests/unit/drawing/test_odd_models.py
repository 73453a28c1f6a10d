"""Odd models are drawn, or refused with a sentence."""

from __future__ import annotations

import pytest

from symflex import pipeline
from symflex.drawing import drawing_of
from tests.unit.drawing.geometry_checks import count, outside, overlaps, struck_texts, wrongly_counted

LONG = "a" * 64


def chain(count, closed=False):
    masses = "".join(f'm_{i} = {{ type = "mass", at = "x_{i}", m = "m" }}\n' for i in range(count))
    last = count if closed else count - 1
    springs = "".join(
        f'k_{i} = {{ type = "spring", between = ["x_{i}", "x_{(i + 1) % count}"], k = "k" }}\n'
        for i in range(last)
    )
    return f"""
parameters = {{ m = "1 kg", k = "1 N/m" }}
[elements]
{masses}{springs}
[inputs]
F = {{ force = "x_0" }}
[outputs]
X = "x_{count - 1}"
"""


ODD = {
    "no ground": chain(2),
    "a ring": chain(5, closed=True),
    "two hundred masses": chain(200),
    "nine masses": chain(9),
    "two parts": chain(2) + 'Y = "y"\n[elements.alone]\ntype = "mass"\nat = "y"\nm = "3 kg"\n',
    "parallel masses": chain(2) + '[elements.more]\ntype = "mass"\nat = "x_0"\nm = "3 kg"\n',
    "long names": f"""
[parameters]
{LONG[1:]}b = "1 kg"
[elements]
{LONG} = {{ type = "mass", at = "{LONG}", m = "{LONG[1:]}b" }}
[inputs]
{LONG[1:]}c = {{ force = "{LONG}" }}
[outputs]
{LONG} = "s*{LONG}"
""",
    "right to left": 'title = "\u05de\u05e1\u05d4"\ndoc = "\u202e"\n' + chain(1),
    "no elements": '[inputs]\nu = {}\n[outputs]\ny = "3*u"\n',
    "a long formula": f"""
parameters = {{ m = "1 kg", k = "1 N/m" }}
[elements]
m = {{ type = "mass", at = "x", m = "m" }}
k = {{ type = "spring", between = ["x", "ground"], k = "{" + ".join(["k"] * 40)}" }}
[inputs]
F = {{ force = "x" }}
[outputs]
X = "x"
""",
    "many inputs at a node": """
[elements]
m = { type = "mass", at = "x", m = "1 kg" }
[inputs]
F_1 = { force = "x" }
F_2 = { force = "x" }
F_3 = { force = "x" }
[outputs]
X = "x"
V = "s*x"
A = "s^2*x"
""",
}


@pytest.mark.parametrize("values", [False, True])
@pytest.mark.parametrize("name", ODD)
def test_odd_models_are_drawn(name, values):
    model = pipeline.loads(f"symflex = 1\n{ODD[name]}")
    drawing = drawing_of(model, values=values)
    assert (overlaps(drawing), struck_texts(drawing), outside(drawing)) == ([], [], [])
    assert wrongly_counted(model, drawing) == []


def test_of_a_long_chain_the_ends_and_the_number_are_drawn():
    drawing = drawing_of(pipeline.loads(f"symflex = 1\n{chain(200)}"))
    shown = [i.name for i in drawing.of_kind("element") if i.name.startswith("m_")]
    # The first and the last one bear marks; of those between the first two and the last two are drawn.
    assert sorted(shown) == sorted(["m_0", "m_1", "m_2", "m_197", "m_198", "m_199"])
    assert "$n = 200$" in {t.markup for i in drawing.items for t in i.texts}
    assert len(drawing.abbreviated) == 194 + 195
    assert count(drawing, "dots", "") == 1


def test_nine_masses_are_drawn_as_they_are():
    assert not drawing_of(pipeline.loads(f"symflex = 1\n{chain(9)}")).abbreviated

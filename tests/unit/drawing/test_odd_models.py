"""Odd models are drawn, or refused with a sentence."""

from __future__ import annotations

from itertools import combinations

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


MEMBER = 'E = "1 GPa", rho = "1 kg/m^3", I = "1 m^4"'
DRIVEN = '[inputs]\nF = { force = "x" }\n[outputs]\n'


def frame(name, first, last, length, angle):
    ends = f'between = ["{first}", "{last}"], l = "{length}", angle = "{angle} deg", A = "1 m^2"'
    return f'{name} = {{ type = "frame", {ends}, {MEMBER} }}\n'


def beam(area, outputs):
    ends = f'between = ["ground", "x"], l = "l", A = "{area}"'
    known = 'parameters = { A = "1 m^2", l = "1 m" }\n[elements]\n'
    return f'{known}arm = {{ type = "beam", {ends}, {MEMBER} }}\n{DRIVEN}{outputs}'


def joined_masses(pairs, count):
    masses = "".join(f'm_{i} = {{ type = "mass", at = "x_{i}", m = "1 kg" }}\n' for i in range(count))
    springs = "".join(
        f'k_{a}_{b} = {{ type = "spring", between = ["x_{a}", "x_{b}"], k = "1 N/m" }}\n' for a, b in pairs
    )
    return f'[elements]\n{masses}{springs}[inputs]\nF = {{ force = "x_0" }}\n[outputs]\nX = "x_1"\n'


ODD = {
    "a star": joined_masses([(0, i) for i in range(1, 9)], 9),
    "all joined to all": joined_masses(list(combinations(range(6), 2)), 6),
    "a sum of thirty": "[inputs]\n"
    + "".join(f"u_{i} = {{}}\n" for i in range(30))
    + f'[outputs]\ny = "{" + ".join(f"u_{i}" for i in range(30))}"\n',
    "thirty points of a beam": beam("A", "".join(f'Y_{i} = "arm.y(l*{i}/29)"\n' for i in range(30))),
    "a beam to a point": beam("A*(1 - 0.999*x/l)^2", 'Y = "arm.y(l/2)"\n'),
    "a millimetre and a kilometre": "[elements]\n"
    + frame("foot", "ground", "p", "1 mm", 0)
    + frame("mast", "p", "x", "1 km", 90)
    + '[inputs]\nF = { force = "x.x" }\n[outputs]\nX = "x.x"\n',
    "a frame there and back": "[elements]\n"
    + frame("there", "p", "x", "1 m", 0)
    + frame("back", "x", "p", "1 m", 0)
    + '[inputs]\nF = { force = "x.x" }\n[outputs]\nX = "x.x"\n',
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

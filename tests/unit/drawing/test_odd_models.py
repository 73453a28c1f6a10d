"""Odd models are drawn, or refused with a sentence."""

import re
from itertools import combinations

import pytest

from symflex import pipeline
from symflex.cli import run
from symflex.drawing import drawing_of
from symflex.errors import SpecError
from tests.unit.drawing.geometry_checks import count, faults, of_kind

LONG = "a" * 64
MEMBER = 'E = "1 GPa", rho = "1 kg/m^3", I = "1 m^4"'
BEAM = f'type = "beam", {MEMBER}, A = "1 m^2", l = "1 m"'
MASS = 'm = { type = "mass", at = "x", m = 1 }\n'
BRIDGE = ("vw", "vu", "wu", "wt", "ut")
CLAMPED = ["w(0) = 0", "w'(0) = 0", "w''(1) = 0", "w'''(1) = 0"]


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


def driven(elements, at="x", more=""):
    """A model of some elements, with a force on a node that is looked at, and more outputs or sections."""
    return f'[elements]\n{elements}[inputs]\nF = {{ force = "{at}" }}\n[outputs]\nX = "{at}"\n{more}'


def many(count, element):
    """So many elements, ``{i}`` the number of each and ``{j}`` that of the next one."""
    numbered = (element.replace("{i}", str(i)).replace("{j}", str(i + 1)) for i in range(count))
    return "".join(f"e_{i} = {{ {one} }}\n" for i, one in enumerate(numbered))


def frame(first, last, length, angle):
    ends = f'between = ["{first}", "{last}"], l = "{length}", angle = "{angle} deg", A = "1 m^2"'
    return f'{first}_{last} = {{ type = "frame", {ends}, {MEMBER} }}\n'


def beam(area, outputs):
    ends = f'between = ["ground", "x"], l = "l", A = "{area}"'
    known = 'parameters = { A = "1 m^2", l = "1 m" }\n'
    return known + driven(f'arm = {{ type = "beam", {ends}, {MEMBER} }}\n', more=outputs)


def joined_masses(pairs, count):
    springs = "".join(
        f'k_{a}_{b} = {{ type = "spring", between = ["x_{a}", "x_{b}"], k = "1 N/m" }}\n' for a, b in pairs
    )
    return driven(many(count, 'type = "mass", at = "x_{i}", m = 1') + springs, "x_0", 'Y = "x_1"\n')


def signals(text, output, inputs="u = {}"):
    return f'[signals]\n{text}\n[inputs]\n{inputs}\n[outputs]\ny = "{output}"\n'


def circuit(elements, output="v"):
    return f'[elements]\n{elements}[inputs]\nV = {{ voltage = "v" }}\n[outputs]\nY = "{output}"\n'


def field(conditions, equation="w'''' + s^2*w = 0", domain='domain = ["0", "1"]'):
    known = f'{domain}\nequation = "{equation}"\nconditions = {conditions}'
    return f'[fields.w]\n{known}\n[inputs]\nF = {{}}\n[outputs]\nY = "w(1)"\n'


def labelled(latex):
    return f"parameters = {{ m = {{ value = 1, latex = '{latex}' }} }}\n" + driven(MASS.replace("1", '"m"'))


ODD = {
    "a star": joined_masses([(0, i) for i in range(1, 9)], 9),
    "a wheel": joined_masses([(0, i) for i in range(1, 7)] + [(i, i % 6 + 1) for i in range(1, 7)], 7),
    "a ring of two": joined_masses([(0, 1), (1, 0)], 2),
    "all joined to all": joined_masses(list(combinations(range(6), 2)), 6),
    "no springs at all": joined_masses([], 5),
    "a sum of thirty": signals(
        "", " + ".join(f"u_{i}" for i in range(30)), "\n".join(f"u_{i} = {{}}" for i in range(30))
    ),
    "an algebraic loop": signals('a = "u - b"\nb = "2*a"', "b"),
    "a signal of itself": signals('a = "u - a"', "a"),
    "signals that lead nowhere": signals('a = "2*u"\nb = "3*u"', "u"),
    "twenty gains in a row": signals(
        'a_0 = "2*u"\n' + "\n".join(f'a_{i} = "{i + 2}*a_{i - 1}"' for i in range(1, 20)), "a_19"
    ),
    "every signal of every other": signals(
        "\n".join(f'a_{i} = "u + {" + ".join(f"2*a_{j}" for j in range(5) if j != i)}"' for i in range(5)),
        "a_4",
    ),
    "a long transfer function": signals("", "G*u")
    + f'[blocks]\nG = {{ type = "tf", num = {[1] * 13}, den = {[2] * 14} }}\n',
    "a force that is looked at": driven(MASS, more='C = "3*F"\n'),
    "blocks that nothing uses": driven(MASS, more='[blocks]\nG = { type = "lag", T = "1 s" }\n'),
    "thirty points of a beam": beam("A", "".join(f'Y_{i} = "arm.y(l*{i}/29)"\n' for i in range(30))),
    "a beam to a point": beam("A*(1 - 0.999*x/l)^2", 'Y = "arm.y(l/2)"\n'),
    "all that a beam has at its ends": beam(
        "A", "".join(f'Q_{i} = "{q}"\n' for i, q in enumerate(("x.theta", "arm.tau", "arm.f", "arm.tau(0)")))
    ),
    "five beams side by side": driven(many(5, f'{BEAM}, between = ["p", "x"]')),
    "a star of beams": driven(many(5, BEAM + ', between = ["x", "p_{i}"]')),
    "a ring of beams": driven(many(4, BEAM + ', between = ["p_{i}", "p_{j}"]').replace("p_4", "p_0"), "p_0"),
    "three supports at a node": driven(
        f'b = {{ {BEAM}, between = ["p", "x"] }}\n'
        + "".join(f'{kind}_1 = {{ type = "{kind}", at = "p" }}\n' for kind in ("pin", "slider", "fixed"))
    ),
    "a millimetre and a kilometre": driven(
        frame("ground", "p", "1 mm", 0) + frame("p", "x", "1 km", 90), "x.x"
    ),
    "two members clamped in one place": driven(
        frame("ground", "x", "1 m", 45)
        + frame("ground", "q", "1 m", 135)
        + frame("x", "q", "1.41421356 m", 180),
        "x.x",
    ),
    "a square of members": driven(
        "".join(frame(*ends, "1 m", 90 * i) for i, ends in enumerate(("px", "xr", "rq", "qp"))), "x.x"
    ),
    "twelve members at a node": driven(
        "".join(frame("x", f"p_{i}", "1 m", 30 * i) for i in range(12)), "x.x"
    ),
    "two hundred masses in a ring": chain(200, closed=True),
    "two parts": chain(2) + 'Y = "y"\n[elements.alone]\ntype = "mass"\nat = "y"\nm = "3 kg"\n',
    "ten masses at a node": driven(many(10, 'type = "mass", at = "x", m = "{j} kg"')),
    "twelve branches at a node": driven(
        MASS + many(12, 'type = "spring", between = ["x", "y_{i}"], k = 1').replace("y_5", "ground")
    ),
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
    "names of underscores": driven('a_ = { type = "mass", at = "x__", m = 1 }\n', "x__"),
    "names that TeX has": driven(
        'frac = { type = "mass", at = "sqrt_x", m = 1 }\nbegin = { type = "fixed", at = "int_y" }\n', "sqrt_x"
    ),
    "a title of another language": f'title = "</title><script>$x^{{$ %&#"\n{driven(MASS)}',
    "a sentence as a label": labelled(r"\text{the front part of the carriage, upper side}"),
    "no elements": '[inputs]\nu = {}\n[outputs]\ny = "3*u"\n',
    "a motion of nothing": '[inputs]\nz = { displacement = "x" }\n[outputs]\nX = "x"\n',
    "a long formula": driven(MASS.replace("1", f'"{" + ".join(["m"] * 40)}"'), more="[parameters]\nm = 1\n"),
    "forty digits": driven(MASS.replace("1", f'"1.{"234567890" * 4} kg"')),
    "many inputs at a node": driven(MASS, more='V = "s*x"\nA = "s^2*x"\n').replace(
        "[outputs]", 'G = { force = "x" }\nz = { displacement = "x" }\n[outputs]'
    ),
    "the difference of any two": driven(
        many(5, 'type = "spring", between = ["x_{i}", "x_{j}"], k = 1'),
        "x_0",
        "".join(f'D_{a}{b} = "x_{a} - x_{b}"\n' for a, b in combinations(range(5), 2)),
    ),
    "a voltage held twice": circuit("").replace("[outputs]", 'W = { voltage = "v" }\n[outputs]'),
    "eight resistors at a node": circuit(
        many(8, 'type = "resistor", between = ["v", "w_{i}"], R = 1').replace("w_3", "ground")
    ),
    "a bridge": circuit(
        "".join(f'{a}{b} = {{ type = "resistor", between = ["{a}", "{b}"], R = 1 }}\n' for a, b in BRIDGE),
        "w - u",
    ),
    "six motors on a shaft": circuit(
        many(6, 'type = "dc_motor", terminals = ["v", "w_{i}"], shaft = "r", k_t = 1'), "r"
    ),
    "a gear to the ground": circuit(
        'g = { type = "transformer", from = "r", to = "ground", ratio = 2 }\n'
        'J = { type = "inertia", at = "r", J = 1 }\n'
    ),
    "a load all along": field(CLAMPED, "w'''' + s^2*w = F"),
    "twelve conditions": field(
        [f"w{i * chr(39)}({x}) = {'F' if x > i else 0}" for x in (0, 1) for i in range(6)],
        "w'''''''''''' + s^2*w = 0",
    ),
}
VALUED = (
    "all joined to all",
    "thirty points of a beam",
    "twelve members at a node",
    "long names",
    "forty digits",
    "a bridge",
    "twelve conditions",
)
"""Those that have many values, or long ones."""
REFUSED = {
    "empty": ("SF214", ""),
    "only outputs": ("SF214", '[inputs]\n[outputs]\nX = "x"\n'),
    "only inputs": ("SF214", '[inputs]\nF = { force = "x" }\n[outputs]\n'),
    "an unknown element": ("SF216", driven(MASS.replace("mass", "wheel"))),
    "a bracket that stays open": ("SF101", driven(MASS.replace(" }", ""))),
    "a text that stays open": ("SF101", driven(MASS.replace('x"', "x"))),
    "one name twice": ("SF102", driven(MASS + MASS)),
    "a key that is unknown": ("SF207", driven(MASS.replace("m = 1", 'm = 1, colour = "red"'))),
    "a name that is unknown": ("SF210", driven(MASS.replace("1", '"M"'))),
    "a hint for no node": ("SF210", driven(MASS, more='[drawing]\norder = ["q"]\n')),
    "another unit": ("SF203", driven(MASS.replace("1", '"1 N"'))),
    "too small a number": ("SF103", driven(MASS.replace("1", '"1e-300 kg"'))),
    "too long a name": ("SF213", driven(f"{LONG}{MASS}")),
    "a name from right to left": ("SF101", driven(f"\u05de{MASS}")),
    "a label from right to left": ("SF230", labelled("\u05de")),
    "a label of a combining character": ("SF230", labelled("x\u0301")),
    "a label that reads a file": ("SF230", labelled(r"\input{/etc/passwd}")),
    "a node of two domains": ("SF220", driven(f'{MASS}J = {{ type = "inertia", at = "x", J = 1 }}\n')),
    "a spring back to its node": ("SF218", driven('k = { type = "spring", between = ["x", "x"], k = 1 }\n')),
    "a beam from ground to ground": ("SF218", driven(f'b = {{ {BEAM}, between = ["ground", "ground"] }}\n')),
    "a motor on one wire": (
        "SF218",
        circuit('M = { type = "dc_motor", terminals = ["v", "v"], shaft = "r", k_t = 1 }\n'),
    ),
    "a force on the ground": ("SF218", driven(MASS, "ground")),
    "a member without length": ("SF209", driven(frame("ground", "x", "0 m", 0), "x.x")),
    "a field without conditions": ("SF243", field([])),
    "a field without a domain": ("SF214", field(CLAMPED, domain="")),
    "a product of signals": ("SF222", signals("", "u*u")),
    "an output of nothing": ("SF221", driven(MASS, more='C = "3"\n')),
}


def wrong(text, values):
    """Say what is wrong with the drawing of a model."""
    model = pipeline.loads(f"symflex = 1\n{text}")
    return faults(model, drawing_of(model, values=values))


@pytest.mark.parametrize("half", [0, 1])
@pytest.mark.slow
def test_odd_models_are_drawn(half):
    found = {name: wrong(ODD[name], values=False) for name in [*ODD][half::2]}
    assert {name: said for name, said in found.items() if said} == {}


@pytest.mark.slow
def test_odd_models_are_drawn_with_values():
    found = {name: wrong(ODD[name], values=True) for name in VALUED}
    assert {name: said for name, said in found.items() if said} == {}


def test_broken_models_are_refused_with_a_sentence_and_its_place(tmp_path, capsys):
    for name, (code, text) in REFUSED.items():
        (tmp_path / "odd.toml").write_text(f"symflex = 1\n{text}", "utf-8")
        assert (
            run(["draw", str(tmp_path / "odd.toml"), "-o", str(tmp_path / "odd.svg")]) == SpecError.exit_code
        ), name
        assert re.match(rf".*odd\.toml:\d+:\d+: error\[{code}\]: \S", capsys.readouterr().err), name
        assert not (tmp_path / "odd.svg").exists(), name


def test_a_block_that_divides_by_zero_is_a_box_with_its_name():
    drawing = drawing_of(pipeline.loads("""
symflex = 1
blocks.G = { type = "tf", num = ["1"], den = ["0"] }
inputs.u = {}
outputs.y = "G*u"
"""))  # fmt: skip
    assert count(drawing, "block", "G") == 1


def test_of_a_long_chain_the_ends_and_the_number_are_drawn():
    drawing = drawing_of(pipeline.loads(f"symflex = 1\n{chain(200)}"))
    shown = [i.name for i in of_kind(drawing, "element") if i.name.startswith("m_")]
    assert sorted(shown) == ["m_0", "m_1", "m_198", "m_199"]
    assert "$n = 200$" in {t.markup for i in drawing.items for t in i.texts}
    assert len(drawing.abbreviated) == 196 + 197
    assert count(drawing, "dots", "") == 1


def test_nine_masses_are_drawn_as_they_are():
    assert not drawing_of(pipeline.loads(f"symflex = 1\n{chain(9)}")).abbreviated


def test_a_long_chain_is_drawn_in_a_column_where_one_in_the_middle_is_looked_at():
    drawing = drawing_of(pipeline.loads(f'symflex = 1\n{chain(60)}Y = "x_30"\n'))
    shown = {i.name for i in of_kind(drawing, "element") if i.name.startswith("m_")}
    assert shown == {f"m_{i}" for i in (0, 1, 29, 30, 31, 58, 59)}
    assert count(drawing, "dots", "") == 2
    assert drawing.width == pytest.approx(88.5 / 25.4 * 72)

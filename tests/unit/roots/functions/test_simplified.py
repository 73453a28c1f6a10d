"""Waves that are not reflected leave one exponential, which has no roots; waves in step share theirs."""

from __future__ import annotations

import pytest
from mpmath import cosh, exp, log, mpc, mpf, pi, sinh, sqrt, tanh

from symflex.roots import Modes
from symflex.roots.locate import locate
from tests.unit.roots.distributed_models import bound
from tests.unit.roots.known_roots import Case, cases, check, elements, known, on_axis

PARAMETERS = 'parameters = { E = "210 GPa", A = "3 cm^2", rho = "7850 kg/m^3", l = "0.7 m" }\n'
PARAMETERS += 'definitions.b = "A*sqrt(E*rho)"'
BAR = """bar = { type = "rod", between = ["x", "y"], E = "E", A = "A", rho = "rho", l = "l" }
end = { type = "damper", between = ["y", "ground"], b = "b" }
"""


def impedance():
    return 3 * sqrt(210 * mpf(10) ** 9 * 7850) / 10**4


def speed():
    return sqrt(210 * mpf(10) ** 9 / 7850)


def matched(part=""):
    """Return a rod that a damper ends without reflection."""
    return elements(BAR + part, more=PARAMETERS)


NEARLY = BAR.replace('"x", "y"', '"ground", "x"').replace('"y"', '"x"').replace('"b"', '"1.1*b"')
LAYER = 'layer = { type = "rod", between = ["y", "z"], E = "E_2", A = "A_2", rho = "rho", l = "l" }\n'
LAYERS = elements(
    BAR.replace('["y", "ground"]', '["z", "ground"]') + LAYER, output="s*x",
    more=PARAMETERS.replace(" }", ', E_2 = "840 GPa", A_2 = "1.5 cm^2" }'),
)  # fmt: skip
WIRE = """symflex = 1
inputs.y_0 = { displacement = "left" }
outputs.Y = "right"
elements.wire = { type = "string", between = ["left", "right"], N = 100, rhoA = 0.01, l = 1 }
elements.dash = { type = "damper", between = ["right", "ground"], b = 1 }
"""
# A closed branch of length 0.6 and section 0.4 on a duct of sound speed 2, half a second before its end.
BRANCH = 'symflex = 1\ninputs.p_0 = {}\noutputs.p_R = "b(1)"\n'
for p, length, section, ends in [
    ("a", 1, 1, '"a(0) = p_0", "va(1) = vb(0) + vc(0)"'),
    ("b", 1, 1, '"b(0) = a(1)", "b(1) = 2*vb(1)"'),
    ("c", 0.6, 0.4, '"c(0) = a(1)", "vc(0.6) = 0"'),
]:
    equations = f'["{section}*{p}\' + s*v{p} = 0", "4*v{p}\' + {section}*s*{p} = 0"]'
    BRANCH += f'fields.{p} = {{ unknowns = ["{p}", "v{p}"], domain = [0, {length}], '
    BRANCH += f"equations = {equations}, conditions = [{ends}] }}\n"
# Heaviside: sqrt((L s + R)/(C s + G)) = sqrt(L/C) where R C = L G.
LINE = """symflex = 1
parameters = { L = "0.5 H/m", C = "2 F/m", R = "0.3 Ohm/m", l = "1 m" }
definitions = { G = "R*C/L", Z = "sqrt(L/C)" }
inputs.U = { unit = "V" }
outputs = { I = "i(0)", V = "v(l)" }
[fields.line]
unknowns = ["v", "i"]
domain = ["0", "l"]
equations = ["v' = -(L*s + R)*i", "i' = -(C*s + G)*v"]
conditions = ["v(0) = U", "v(l) = Z*i(l)"]
"""
MASSLESS = """arm = { type = "beam", between = ["ground", "x"], EI = 3, rhoA = 0, l = 1.2, N = 5 }
tip = { type = "mass", at = "x", m = 2 }
dash = { type = "damper", between = ["x", "ground"], b = 1 }"""
IN_STEP = """bar = { type = "rod", between = ["x", "ground"], EA = 600, rhoA = 6, l = "l" }
wire = { type = "string", between = ["x", "ground"], N = "N", rhoA = "mu", l = "2*l" }"""
CO_FLOW = """symflex = 1
parameters = { v = "0.5 m/s", h = "0.2 1/s", g = "0.1 1/s", l = "2 m" }
inputs.T_0 = { unit = "K" }
outputs.Y = "T(l)"
[fields.pipes]
unknowns = ["T", "W"]
domain = ["0", "l"]
equations = ["v*T' + s*T + h*(T - W) = 0", "v*W' + s*W + g*(W - T) = 0"]
conditions = ["T(0) = T_0 - T(l)/2", "W(0) = 0"]
"""
CRITICAL = """r = { type = "rod", between = ["x", "y"], EA = "EA", rhoA = "mu", l = 1, k_f = "k", c_f = "c" }
dash = { type = "damper", between = ["y", "ground"], b = "sqrt(EA*mu)" }
spring = { type = "spring", between = ["y", "ground"], k = "sqrt(EA*k)" }"""


def massless():
    """Return 2 s^2 + s + k = 0, as EI w'''' = N w'': w(l)/F = (l - tanh(g l)/g)/N, g = sqrt(N/EI)."""
    g = sqrt(mpf(5) / 3)
    return [mpc(-0.25, sqrt(5 / (mpf("1.2") - tanh(mpf("1.2") * g) / g) / 2 - mpf(1) / 16))]


def mixed():
    """Return poles of two fluids: (T, W) mixes with the rate h + g for the time l/v, 4 s."""
    share = (mpf("0.1") + mpf("0.2") * exp(mpf("-1.2"))) / mpf("0.3")
    return (mpc(log(share / 2), (2 * n + 1) * pi) / 4 for n in range(9))


CASES = {
    "a matched rod": Case(matched(), at_zero=1, poles=known(), region=None),
    "a mass before it": Case(
        matched('body = { type = "mass", at = "x", m = 2 }'), lambda: [-impedance() / 2], at_zero=1,
        region=None,
    ),
    "a spring before it": Case(
        matched('spring = { type = "spring", between = ["x", "ground"], k = 1000 }'),
        lambda: [-1000 / impedance()], region=None,
    ),
    "a damper before it": Case(
        matched('other = { type = "damper", between = ["x", "ground"], b = "2*b" }'), known(), at_zero=1,
        region=None,
    ),
    # exp(2 s l/c) = (b - z)/(b + z) with z the impedance: s = c/(2 l) ln(1/21) + j n pi c/l.
    "a rod that is nearly matched": Case(
        elements(NEARLY, more=PARAMETERS),
        lambda: (mpc(-log(21) / 2, n * pi) * speed() / mpf("0.7") for n in range(9)),
    ),
    "a string that absorbs every wave": Case(WIRE, known(), region=None),
    "layers of equal impedance": Case(LAYERS, known(), region=None, hidden=lambda: [(0, 1)]),
    "a side branch before an end without reflections": Case(
        BRANCH, zeros=on_axis(lambda n: (2 * n - 1) * pi / mpf("0.6")), region=Modes(2),
        equation=lambda s: cosh(0.3 * s) * exp(s / 2) + mpf("0.4") * sinh(s / 2) * sinh(0.3 * s),
    ),
    "a line without distortion that ends in its impedance": Case(LINE, known(), region=None, output=1),
    "a beam without mass": Case(elements(MASSLESS), massless, region=None),
    # A string and a rod of one speed and impedance: sinh(q) sinh(2 q)/sinh(3 q), q = s/10.
    "waves in step by value": Case(
        elements(IN_STEP, more='parameters = { N = "600 N", mu = "6 kg/m", l = "1 m" }'),
        lambda: (mpc(0, n * 10 * pi / 3) for n in (1, 2, 4, 5, 7, 8)), region=Modes(4),
        hidden=lambda: [mpc(0, 10 * pi)],
    ),
    "fluids that flow one way": Case(CO_FLOW, mixed, word="stable"),
}  # fmt: skip


@pytest.mark.parametrize("case", cases(CASES))
def test_roots_are_those_of_what_is_reflected(case):
    check(case)


def test_what_is_not_reflected_leaves_a_function_without_waves():
    # sqrt(4 E rho) A/2 = sqrt(E rho) A
    by_symbols = LAYERS.replace('"E_2"', '"4*E"').replace('"A_2"', '"A/2"')
    # sqrt(E A (mu s^2 + 2 sqrt(k mu) s + k)) = sqrt(E A mu) s + sqrt(E A k)
    more = 'parameters = { EA = "600 N", mu = "6 kg/m", k = "50 N/m^2" }\n'
    founded = elements(CRITICAL, more=f'{more}definitions.c = "2*sqrt(k*mu)"')
    for text, value in (
        (by_symbols, 1 / float(impedance())),
        (LINE, 2),
        (founded, 1 / (60 * (3 + 4j) + 30000**0.5)),
    ):
        function = bound(text)
        assert function.source.is_rational
        assert not function.hidden or text is by_symbols
        assert function(3 + 4j) == pytest.approx(value)
    assert locate(bound(LINE)).all_poles == ()

"""Waves that are not reflected leave one exponential, which has no roots."""

from __future__ import annotations

import cmath
from math import cos, exp, log, pi, sin, sqrt, tanh

import pytest

from symflex import loads, pipeline
from symflex.analysis.time_response import SampleTimes, time_response
from symflex.roots.region import Modes

HEAD = """
symflex = 1
[parameters]
E = "210 GPa"
A = "3 cm^2"
rho = "7850 kg/m^3"
l = "0.7 m"
m = "2 kg"
k = "1 kN/m"
[definitions]
b = "A*sqrt(E*rho)"
[inputs]
F = { force = "x" }
[outputs]
X = "x"
[elements]
bar = { type = "rod", between = ["x", "y"], E = "E", A = "A", rho = "rho", l = "l" }
end = { type = "damper", between = ["y", "ground"], b = "b" }
"""
IMPEDANCE = 3e-4 * sqrt(210e9 * 7850)


def poles(text):
    model = pipeline.loads(text)
    (bound,) = pipeline.derive_for_roots(model, model.transfer_functions[:1])
    found = pipeline.roots(bound)
    assert found.certificate.certified
    return sorted((float(p.re), float(p.im)) for p in found.poles)


def test_a_rod_with_a_matched_end_is_a_damper_of_its_impedance():
    parts = {
        "": [0],
        'body = { type = "mass", at = "x", m = "m" }': [-IMPEDANCE / 2, 0],
        'spring = { type = "spring", between = ["x", "ground"], k = "k" }': [-1000 / IMPEDANCE],
        'other = { type = "damper", between = ["x", "ground"], b = "2*b" }': [0],
    }
    for part, expected in parts.items():
        found = poles(HEAD + part)
        assert [re for re, _ in found] == pytest.approx(expected, rel=1e-12), part
        assert not any(im for _, im in found), part


def test_a_rod_whose_end_is_nearly_matched_has_its_poles_far_left():
    # exp(2 s l/c) = (b - z)/(b + z) with z the impedance: s = c/(2 l) ln(1/21) + j n pi c/l
    found = poles(
        HEAD.replace('b = "b"', 'b = "1.1*b"')
        .replace('"x", "y"]', '"ground", "y"]')
        .replace('"x" }', '"y" }')
        .replace('X = "x"', 'X = "y"')
    )
    speed = sqrt(210e9 / 7850)
    assert found[0][0] == pytest.approx(speed / 1.4 * -3.044522437723423, rel=1e-9)


def test_a_string_that_absorbs_every_wave_delays_alone():
    text = """
    symflex = 1
    parameters = { N = "100 N", rho = "1000 kg/m^3", A = "10 mm^2", l = "1 m", b = "1 N*s/m" }
    inputs.y_0 = { displacement = "left" }
    outputs.Y = "right"
    elements.wire = { type = "string", between = ["left", "right"], N = "N", rho = "rho", A = "A", l = "l" }
    elements.dash = { type = "damper", between = ["right", "ground"], b = "b" }
    """
    assert not poles(text)


def test_a_side_branch_before_an_end_without_reflections_hides_nothing():
    # A closed branch of length 0.6 and section 0.4 on a duct of sound speed 2, half a second before its end.
    text = 'symflex = 1\ninputs.p_0 = {}\noutputs.p_R = "b(1)"\n'
    for p, length, section, ends in [
        ("a", 1, 1, '"a(0) = p_0", "va(1) = vb(0) + vc(0)"'),
        ("b", 1, 1, '"b(0) = a(1)", "b(1) = 2*vb(1)"'),
        ("c", 0.6, 0.4, '"c(0) = a(1)", "vc(0.6) = 0"'),
    ]:
        equations = f'["{section}*{p}\' + s*v{p} = 0", "4*v{p}\' + {section}*s*{p} = 0"]'
        text += f'fields.{p} = {{ unknowns = ["{p}", "v{p}"], domain = [0, {length}], '
        text += f"equations = {equations}, conditions = [{ends}] }}\n"
    (bound,) = pipeline.derive_bound(model := pipeline.loads(text), model.transfer_functions)
    found = pipeline.roots(bound, Modes(2))
    assert (found.certificate.certified, found.hidden, bound.source.hidden) == (True, (), ())
    assert [float(r.im) for r in found.zeros if r.im > 0] == pytest.approx([pi / 0.6, 3 * pi / 0.6])
    for s in map(complex, found.poles):
        q = 0.3 * s
        assert abs(cmath.cosh(q) * cmath.exp(s / 2) + 0.4 * cmath.sinh(s / 2) * cmath.sinh(q)) < 1e-12


LAYERS = """
symflex = 1
inputs.F = { force = "x" }
outputs.V = "s*x"
[parameters]
E = "210 GPa"
A = "3 cm^2"
rho = "7850 kg/m^3"
l = "0.7 m"
E_2 = "840 GPa"
A_2 = "1.5 cm^2"
[elements]
bar = { type = "rod", between = ["x", "y"], E = "E", A = "A", rho = "rho", l = "l" }
layer = { type = "rod", between = ["y", "z"], E = "E_2", A = "A_2", rho = "rho", l = "l" }
end = { type = "damper", between = ["z", "ground"], b = "A*sqrt(E*rho)" }
"""


def test_layers_of_equal_impedance_are_a_damper_by_symbols_and_by_values():
    # sqrt(4 E rho) A/2 = sqrt(E rho) A
    assert poles(LAYERS) == []
    by_symbols = LAYERS.replace('"E_2"', '"4*E"').replace('"A_2"', '"A/2"')
    bound = loads(by_symbols).transfer_function("V", "F").bind().bound
    assert bound.source.is_rational
    assert bound(1j) == pytest.approx(1 / IMPEDANCE)


def test_a_line_without_distortion_that_ends_in_its_impedance_is_a_resistor():
    # Heaviside: sqrt((L s + R)/(C s + G)) = sqrt(L/C) where R C = L G
    model = loads("""
    symflex = 1
    parameters = { L = "0.5 H/m", C = "2 F/m", R = "0.3 Ohm/m", l = "1 m" }
    definitions = { G = "R*C/L", Z = "sqrt(L/C)" }
    inputs.U = { unit = "V" }
    outputs = { I = "i(0)", V = "v(l)" }
    [fields.line]
    unknowns = ["v", "i"]
    domain = ["0", "l"]
    equations = ["v' = -(L*s + R)*i", "i' = -(C*s + G)*v"]
    conditions = ["v(0) = U", "v(l) = Z*i(l)"]
    """)
    current, voltage = (model.transfer_function(name, "U").bind().bound for name in "IV")
    assert current.source.is_rational
    assert current(3 + 4j) == pytest.approx(2)
    assert pipeline.roots(voltage).all_poles == ()


def test_a_beam_without_mass_is_a_spring():
    # EI w'''' = N w'': w(l)/F = (l - tanh(g l)/g)/N, g = sqrt(N/EI); so 2 s^2 + s + k has these roots.
    text = """
    symflex = 1
    parameters = { EI = "3 N*m^2", N = "5 N", l = "1.2 m", m = "2 kg", b = "1 N*s/m" }
    inputs.F = { force = "x" }
    outputs.X = "x"
    [elements]
    arm = { type = "beam", between = ["ground", "x"], EI = "EI", rhoA = "0 kg/m", l = "l", N = "N" }
    tip = { type = "mass", at = "x", m = "m" }
    dash = { type = "damper", between = ["x", "ground"], b = "b" }
    """
    g = sqrt(5 / 3)
    stiffness = 5 / (1.2 - tanh(1.2 * g) / g)
    turn = sqrt(stiffness / 2 - 1 / 16)
    assert poles(text) == [pytest.approx((-0.25, -turn)), pytest.approx((-0.25, turn))]
    bound = loads(text).transfer_function("X", "F").bind().bound
    found = time_response(bound, "step", SampleTimes.of([0.7]))
    decay = exp(-0.7 / 4) * (cos(0.7 * turn) + sin(0.7 * turn) / 4 / turn)
    assert found.certified
    assert found.values[0] == pytest.approx((1 - decay) / stiffness, rel=1e-11)


def test_a_rod_on_a_critical_foundation_that_ends_in_its_impedance_is_a_spring_and_a_damper():
    # sqrt(E A (mu s^2 + 2 sqrt(k mu) s + k)) = sqrt(E A mu) s + sqrt(E A k)
    text = """
    symflex = 1
    parameters = { EA = "600 N", mu = "6 kg/m", k = "50 N/m^2", l = "0.7 m" }
    inputs.F = { force = "x" }
    outputs.X = "x"
    definitions.c = "2*sqrt(k*mu)"
    [elements]
    bar = { type = "rod", between = ["x", "y"], EA = "EA", rhoA = "mu", l = "l", k_f = "k", c_f = "c" }
    dash = { type = "damper", between = ["y", "ground"], b = "sqrt(EA*mu)" }
    spring = { type = "spring", between = ["y", "ground"], k = "sqrt(EA*k)" }
    """
    bound = loads(text).transfer_function("X", "F").bind().bound
    assert bound.source.is_rational
    assert not bound.hidden
    assert bound(3 + 4j) == pytest.approx(1 / (60 * (3 + 4j) + sqrt(30000)))


def test_modes_that_waves_in_step_by_value_share_are_hidden():
    # A string and a rod of one speed and impedance: sinh(q) sinh(2 q)/sinh(3 q), q = s/10
    text = """
    symflex = 1
    parameters = { N = "600 N", mu = "6 kg/m", EA = "600 N", rhoA = "6 kg/m", l = "1 m" }
    inputs.F = { force = "x" }
    outputs.X = "x"
    [elements]
    bar = { type = "rod", between = ["x", "ground"], EA = "EA", rhoA = "rhoA", l = "l" }
    wire = { type = "string", between = ["x", "ground"], N = "N", rhoA = "mu", l = "2*l" }
    """
    model = pipeline.loads(text)
    (bound,) = pipeline.derive_for_roots(model, model.transfer_functions)
    found = pipeline.roots(bound)
    assert found.certificate.certified
    turns = [float(p.im) * 3 / 10 / pi for p in found.poles if p.im > 0]
    assert turns == pytest.approx([1, 2, 4, 5, 7])


def test_a_string_that_moves_along_has_the_poles_of_both_waves():
    # (T - mu v^2) u'' - 2 mu v s u' - mu s^2 u = 0 between fixed ends: waves at c + v and c - v,
    # poles j n pi (c^2 - v^2)/(c l)
    text = """
    symflex = 1
    parameters = { T = "8 N", mu = "2 kg/m", v = "1 m/s", l = "1 m" }
    inputs.q = {}
    outputs.Y = "u(l/2)"
    [fields.u]
    domain = ["0", "l"]
    equation = "(T - mu*v^2)*u'' - 2*mu*v*s*u' - mu*s^2*u = 0"
    conditions = ["u(0) = q", "u(l) = 0"]
    """
    turns = sorted(im / 1.5 / pi for _, im in poles(text) if im > 0)
    assert turns == pytest.approx([1, 3, 5, 7, 9])


CO_FLOW = """
symflex = 1
parameters = { v = "0.5 m/s", h = "0.2 1/s", g = "0.1 1/s", l = "2 m" }
inputs.T_0 = { unit = "K" }
outputs.Y = "T(l)"
[fields.pipes]
unknowns = ["T", "W"]
domain = ["0", "l"]
equations = ["v*T' + s*T + h*(T - W) = 0", "v*W' + s*W + g*(W - T) = 0"]
conditions = ["T(0) = T_0 - T(l)/2", "W(0) = 0"]
"""


def test_fluids_that_flow_one_way_come_late_and_mixed():
    # Seen from where they flow, (T, W) mixes with the rate h + g for the time l/v.
    mixed = (0.1 + 0.2 * exp(-0.3 * 4)) / 0.3
    (bound,) = pipeline.derive_bound(pipeline.loads(CO_FLOW), [("Y", "T_0")])
    found = pipeline.roots(bound, Modes(3))
    assert (found.verdict.word, found.certificate.certified) == ("stable", True)
    expected = [complex(log(mixed / 2), (2 * n + 1) * pi) / 4 for n in range(3)]
    poles = [complex(r.enclosure()) for r in found.poles if r.im > 0]
    assert poles == pytest.approx(expected, rel=1e-12)
    step = time_response(bound, "step", SampleTimes.of([3.9, 4.1, 8.1]))
    assert step.certified
    assert step.values.tolist() == pytest.approx([0, mixed, mixed - mixed**2 / 2], abs=1e-12)

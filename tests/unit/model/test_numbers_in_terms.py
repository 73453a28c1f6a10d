"""A number in a term does not switch its unit check off; as a gain, a pole or a time it may have a unit.

What each model should give follows from counting kg, m and s by hand, as beside it.
"""

import cmath
import math

import pytest

import symflex
from symflex.errors import SpecError

COMMON = 'm = "2 kg", c = "3 N*s/m", k = "5 N/m", g = "9.81 m/s^2", l = "0.3 m", omega = "4 rad/s", '
NODE = """[elements]
body = { type = "mass", at = "x", m = "m" }
wall = { type = "spring", between = ["x", "ground"], k = "k" }
"""


def motion(equations, extra="zeta = 0.05", unknowns='"x"', output="x"):
    return f"""symflex = 1
    parameters = {{ {COMMON}{extra} }}
    inputs.F = {{ unit = "N" }}
    outputs.Y = "{output}"
    [equations]
    unknowns = [{unknowns}]
    equations = ["{equations}"]
    """


def body(output, extra="zeta = 0.05", more=""):
    start = f"symflex = 1\nparameters = {{ {COMMON}{extra} }}\n"
    return f'{start}inputs.F = {{ force = "x" }}\noutputs.Y = "{output}"\n{NODE}{more}'


def pushed(force, more="", extra="k_f = '2 N/V', K = 30"):
    return body("x", extra, f'push = {{ type = "force_source", at = "x", f = "{force}" }}\n{more}')


def beam(equation, extra="n = 2", tip="EI*w''(l) = 0"):
    return f"""symflex = 1
    parameters = {{ EI = "2 N*m^2", N = "3 N", mu = "1 kg/m", l = "1 m", {extra} }}
    inputs.F = {{ unit = "N" }}
    outputs.Y = "w(l)"
    [fields.w]
    domain = ["0", "l"]
    equation = "{equation}"
    conditions = ["w(0) = 0", "w'(0) = 0", "EI*w'''(l) = -F", "{tip}"]
    """


def controlled(k_i):
    return f"""symflex = 1
    parameters = {{ K = "2 V/m", T = "0.1 s" }}
    inputs.u = {{ unit = "m" }}
    outputs.Y = "C*u"
    blocks.C = {{ type = "pid", k_p = "K", k_i = "{k_i}" }}
    """


def codes(text):
    with pytest.raises(SpecError) as caught:
        symflex.loads(text)
    return {d.code for d in caught.value.diagnostics}


RIGHT = [
    (motion("m*s^2*x + 2*zeta*omega*m*s*x + m*omega^2*x = F"), "m/N"),
    (motion("2*zeta*m*omega*s*x + s^2*m*x + 1/2*k*x = 3*F"), "m/N"),
    (motion("m*s^2*x + (c/2 + 0.1*c)*s*x + 3/4*k*x = F"), "m/N"),
    (motion("2*(m*s^2*x + 3*(c*s*x + sqrt(2)*k*x/7)) = 2*pi*F"), "m/N"),
    (motion("m*s^2*x + 2*zeta*sqrt(k*m)*s*x + k*x = F"), "m/N"),
    (motion("m*s^2*x + (alpha*m + beta*k)*s*x + k*x = F", "alpha = 0.1, beta = 1e-4"), "m/N"),
    (motion("m*s^2*x + d*s*x + k*x = F", "d = 20"), "m/N"),  # d in N*s/m, as its place asks for
    (motion("m*s^2*x + 20*s*x + k*x = F"), "m/N"),
    (motion("m*s^2*x + k*x + mu*m*g/l*x = F", "mu = 0.3"), "m/N"),
    (
        motion(
            'J*s^2*p = F*l - t", "p = n*q", "n*t = J*q*s^2', 'J = "1 kg*m^2", n = 9', '"p", "q", "t"', "q"
        ),
        "1/N",
    ),
    (motion('m*s^2*x + k*x + mu*k*y = F", "m*s^2*y + k*y - mu*k*x = 0', "mu = 0.5", '"x", "y"', "y"), "m/N"),
    (body("0.5*m*s^2*x + 2*k*x"), "1"),
    (body("mu*k*x", "mu = 0.5"), "1"),
    (body("k*x*(1 + 0.2*s)"), "1"),
    (body("c*s*x + k*x*100/(s + 100)"), "1"),
    (body("(s + 2)*x"), "m/(N*s)"),
    (pushed("-k_f*K*(x + 0.1*s*x)"), "m/N"),  # K in V/m
    (pushed("-2*k*x*100/(s + 100)"), "m/N"),
    (pushed("k_f*u", '[signals]\nu = "-100*x - 3*wall.f"\n'), "m/N"),  # a feedback of states by numbers
    (beam("EI*w'''' - 2*N*w'' + 0.5*mu*s^2*w = 0"), "m/N"),
    (beam("mu*s^2*w - n*N*w'' + EI*w'''' = 0"), "m/N"),
    (beam("(1 + n*s)*EI*w'''' + a*mu*s*w + mu*s^2*w = 0", "n = 1e-4, a = 0.2"), "m/N"),
    (controlled("K/(20*T)"), "V/m"),
    (controlled(5), "V/m"),
]
WRONG = [
    motion("m*s^2*x + 2*c*x + k*x = F"),  # no s beside c
    motion("m*s^2*x + c*s*x/2 + 2*m*x = F"),
    motion("m*s^2*x + 2*k*s*x + k*x = F"),
    motion("m*s^2*x + 2*zeta*omega*m*x + k*x = F"),  # no s beside a bare number, either
    motion("m*s^2*x + n*c*x + k*x = F", "n = 2"),
    motion("(1/2)*m*s^2*x + (c + 2*k)*s*x + k*x = F"),
    motion("2*(m*s^2*x + 3*(c*x + k*x/7)) = F"),
    motion("m*s^2*x + sqrt(2)*c*x + k*x = F"),
    motion("0.5*m*s^2*x + 0.5*c*x + 0.5*k*x = 0.5*F"),
    body("F + 2*x"),
    body("2*c*x + k*x"),
    body("wall.f - x/2"),
    body("sin(2*l)*x"),
    pushed("2*c*x"),
    pushed("v", '[signals]\nv = "-2*c*x"\n'),
    pushed("Z*x", '[definitions]\nZ = "c*s + 2*m"\n'),
    beam("EI*w'''' - 2*N*w + mu*s^2*w = 0"),  # no primes
    beam("EI*w'''' - N*w'' + 2*mu*s*w = 0"),
    beam("EI*w'''' + mu*s^2*w = 0", tip="EI*w''(l) = 2*F"),
    controlled("2*K"),
]


def test_a_number_beside_right_units_is_accepted_and_the_unit_is_found():
    wrong = []
    for text, unit in RIGHT:
        (quotient,) = symflex.loads(text).resolved.quotients or [("", None)]
        if str(quotient[1]) != unit:
            wrong.append((text, unit, str(quotient[1])))
    assert wrong == []


def test_a_number_does_not_hide_units_that_disagree():
    assert [text for text in WRONG if not codes(text) <= {"SF203", "SF205"}] == []
    # Without the number, the same is refused.
    for text in (motion("m*s^2*x + c*x + k*x = F"), body("F + x"), beam("EI*w'''' - N*w + mu*s^2*w = 0")):
        assert codes(text) == {"SF205"}


def test_a_bare_number_whose_places_ask_for_two_units_fits_any():
    text = controlled("K").replace('K = "2 V/m"', "K = 2")
    assert symflex.loads(text).transfer_function("Y", "u").bind()(2j) == pytest.approx(2 + 2 / 2j)


def test_a_number_with_pi_or_a_root_fits_a_port_as_a_decimal_does():
    delayed = 'symflex = 1\ninputs.u = {{}}\noutputs.Y = "D*u"\n{}blocks.D = {{ type = "{}", {} }}\n'
    named = 'definitions.T = "{}"\n'
    tuned = 'omega = "2*pi*50", zeta = 0.5'
    w = 100 * math.pi
    for text, expected in [
        (delayed.format("", "delay", 'T = "pi/4"'), cmath.exp(-2j * math.pi / 4)),
        (delayed.format(named.format("sqrt(2)"), "delay", 'T = "T"'), cmath.exp(-2j * math.sqrt(2))),
        (delayed.format("", "low_pass", tuned), w**2 / (w**2 - 4 + 2j * w)),
        (delayed.format(named.format("exp(1)"), "lag", 'T = "2*T"'), 1 / (1 + 4j * math.e)),
        (body("x").replace('k = "k"', 'k = "sqrt(2)*10"'), 1 / (10 * math.sqrt(2) - 8)),
        (controlled("pi/4"), 2 + math.pi / 4 / 2j),
    ]:
        (function,) = symflex.loads(text).transfer_functions()
        assert function.bind()(2j) == pytest.approx(expected), text
    assert codes(body("x").replace('k = "k"', 'k = "pi*c"')) == {"SF203"}

"""Groups without dimension as books choose them, and the functions in them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mpmath
import pytest
import sympy

import symflex

if TYPE_CHECKING:
    from symflex.symbolic.limits import SymbolicForm

MASS = '[elements]\nbody = { type = "mass", at = "x", m = "m" }\n'
SPRING = 'wall = { type = "spring", between = ["x", "ground"], k = "k" }\n'
DAMPER = 'loss = { type = "damper", between = ["x", "ground"], b = "b" }\n'
FORCE = '[inputs]\nF = { force = "x" }\n[outputs]\ny = "x"\n'
TIP = '[inputs]\nF = { force = "z" }\n[outputs]\ny = "z.y"\n'
BEAM = (
    '[elements]\narm = { type = "beam", between = ["a", "z"], '
    'E = "E", I = "I", rho = "rho", A = "A", l = "l" }\nend = { type = "fixed", at = "a" }\n'
)
OF_BEAM = {"E": "70 GPa", "I": "2e-9 m^4", "rho": "2700 kg/m^3", "A": "1e-4 m^2", "l": "0.5 m"}
OF_BODY = {"m": "2 kg", "k": "8 N/m", "b": "0.8 N*s/m"}
SIGNALS = "[inputs]\nu = {}\n[outputs]\n"
OMEGA = "l**2*sqrt(rho*A/(E*I))*s"
MOTOR = (
    '[elements]\nr = { type = "resistor", between = ["v", "w"], R = "R" }\n'
    'coil = { type = "voice_coil", terminals = ["w", "ground"], mover = "x", k_f = "k_f" }\n'
    'body = { type = "mass", at = "x", m = "m" }\n'
    'wall = { type = "spring", between = ["x", "ground"], k = "k" }\n'
    '[inputs]\nU = { voltage = "v" }\n[outputs]\ny = "x"\n'
)
RLC = (
    '[elements]\nr = { type = "resistor", between = ["p", "q"], R = "R" }\n'
    'i = { type = "inductor", between = ["q", "o"], L = "L" }\n'
    'c = { type = "capacitor", between = ["o", "ground"], C = "C" }\n'
    '[inputs]\nU = { voltage = "p" }\n[outputs]\ny = "o"\n'
)

CASES: dict[str, tuple[str, dict[str, str], dict[str, str]]] = {
    "oscillator": (
        MASS + SPRING + DAMPER + FORCE,
        OF_BODY,
        {"y/F": "1/(S**2 + 2*zeta*S + 1)", "scale": "1/k", "S": "s*sqrt(m/k)", "zeta": "b/(2*sqrt(k*m))"},
    ),
    "free body": (MASS + FORCE, OF_BODY, {"y/F": "1", "scale": "1/(m*s**2)"}),
    "two masses": (
        MASS
        + 'other = { type = "mass", at = "y", m = "M" }\n'
        + 'link = { type = "spring", between = ["x", "y"], k = "k" }\n'
        + FORCE.replace('y = "x"', 'y = "y"'),
        {**OF_BODY, "M": "3 kg"},
        {"y/F": "1/(S**2*(mu*S**2 + mu + 1))", "scale": "1/k", "S": "s*sqrt(m/k)", "mu": "M/m"},
    ),
    "circuit": (
        RLC,
        {"R": "10 Ohm", "L": "1 mH", "C": "1 uF"},
        {"y/U": "1/(S**2 + 2*zeta*S + 1)", "scale": "1", "S": "s*sqrt(L*C)", "zeta": "R*sqrt(C/L)/2"},
    ),
    "root of a sum": (
        SIGNALS + 'y = "u/(s^2 + 2*z*sqrt(k/m + g/l)*s + k/m + g/l)"',
        {**OF_BODY, "l": "0.1 m", "g": "9.81 m/s^2", "z": "0.02"},
        {
            "y/u": "1/(S**2 + 2*Pi_1*sqrt(1 + Pi)*S + 1 + Pi)",
            "scale": "m/k",
            "S": "s*sqrt(m/k)",
            "Pi": "g*m/(k*l)",
            "Pi_1": "z",
        },
    ),
    "cantilever": (BEAM + TIP, OF_BEAM, {"scale": "l**3/(E*I)", "S": OMEGA}),
    "loaded cantilever": (
        BEAM
        + 'load = { type = "mass", at = "z", m = "m" }\n'
        + 'prop = { type = "spring", between = ["z", "ground"], k = "k" }\n'
        + TIP,
        {**OF_BEAM, **OF_BODY},
        {"scale": "l**3/(E*I)", "S": OMEGA, "mu": "m/(rho*A*l)", "kappa": "k*l**3/(E*I)"},
    ),
    "rod": (
        '[elements]\nbar = { type = "rod", between = ["a", "x"], E = "E", rho = "rho", A = "A", l = "l" }\n'
        'end = { type = "fixed", at = "a" }\n' + FORCE,
        OF_BEAM,
        {"y/F": "tanh(S)/S", "scale": "l/(E*A)", "S": "l*sqrt(rho/E)*s"},
    ),
    "piston on a column": (
        '[elements]\nbar = { type = "rod", between = ["a", "x"], E = "E", rho = "rho", A = "A", l = "l" }\n'
        'end = { type = "fixed", at = "a" }\nload = { type = "mass", at = "x", m = "m" }\n' + FORCE,
        {**OF_BEAM, **OF_BODY},
        {"y/F": "sinh(S)/(S*(mu*S*sinh(S) + cosh(S)))", "scale": "l/(E*A)", "mu": "m/(rho*A*l)"},
    ),
    "string": (
        "[elements]\n"
        'one = { type = "string", between = ["a", "x"], N = "N", rho = "rho", A = "A", l = "a" }\n'
        'two = { type = "string", between = ["x", "z"], N = "N", rho = "rho", A = "A", l = "l - a" }\n'
        'left = { type = "fixed", at = "a" }\nright = { type = "fixed", at = "z" }\n' + FORCE,
        {**OF_BEAM, "N": "100 N", "a": "0.2 m"},
        {"scale": "l/N", "S": "l*sqrt(rho*A/N)*s", "lambda": "a/l"},
    ),
    "loop with a delay": (
        SIGNALS + 'y = "K*u/(tau*s + 1 + K*exp(-s*T))"',
        {"K": "2", "T": "0.1 s", "tau": "1 s"},
        {"scale": "1", "Pi": "K"},
    ),
    "angles": (
        '[elements]\nrotor = { type = "inertia", at = "x", J = "J" }\n'
        'shaft = { type = "torsion_spring", between = ["x", "ground"], k = "k_t" }\n'
        '[inputs]\nF = { torque = "x" }\n[outputs]\ny = "x"\n',
        {"J": "0.1 kg*m^2", "k_t": "40 N*m/rad"},
        {"y/F": "1/(S**2 + 1)", "scale": "1/k_t", "S": "s*sqrt(J/k_t)"},
    ),
    "coil": (
        MOTOR,
        {"R": "8 Ohm", "k_f": "5 N/A", "m": "0.01 kg", "k": "1000 N/m"},
        {"S": "s*sqrt(m/k)"},
    ),
    "root of letters": (
        '[definitions]\nb = "2*c*sqrt(k*m)"\n' + SIGNALS + 'y = "u/(m*s^2 + b*s + k)"',
        {"m": "2 kg", "k": "8 N/m", "c": "0.1"},
        {"y/u": "1/(S**2 + 2*Pi*S + 1)", "scale": "1/k", "S": "s*sqrt(m/k)", "Pi": "c"},
    ),
}


def reading_of(text: str, parameters: dict[str, str], analysis: str = "") -> SymbolicForm:
    lines = "".join(f'{name} = "{value}"\n'.replace('""', "{}") for name, value in parameters.items())
    spec = f"symflex = 1\n[parameters]\n{lines}{text}\n{analysis}"
    return symflex.loads(spec).transfer_functions()[0].dimensionless()


@pytest.mark.parametrize("name", CASES)
def test_groups_are_those_of_books(name: str) -> None:
    text, parameters, expected = CASES[name]
    reading = reading_of(text, parameters)
    assert "sqrt(1)" not in str(reading)
    for line, wanted in expected.items():
        found = reading.expr(line)
        assert found is not None, reading
        names = {x: sympy.Symbol(x, positive=True) for x in ("E", "I", "N", "S", "C", "zeta", "lambda", "s")}
        quotient = found / sympy.sympify(wanted, names)
        positive = {x: sympy.Symbol(x.name, positive=True) for x in quotient.free_symbols}
        assert sympy.simplify(quotient.subs(positive)) == 1, reading
    groups = {row.name for row in reading.rows} - {"y/F", "y/u", "y/U", "scale"}
    assert name in ("coil", "loop with a delay") or groups - {"q", "q_1", "q_2", "S"} <= set(expected), (
        reading
    )


def test_scale_times_the_function_in_groups_is_the_function() -> None:
    text, parameters, _ = CASES["loaded cantilever"]
    reading = reading_of(text, parameters)
    values = {"E": 70e9, "I": 2e-9, "rho": 2700, "A": 1e-4, "l": 0.5, "m": 2, "k": 8, "s": 20 + 300j}
    whole = reading.expr("scale") * reading.expr("y/F")
    for _ in reading.rows:
        whole = whole.subs({x: reading.expr(x.name) or x for x in whole.free_symbols})
    found = complex(
        sympy.lambdify(list(whole.free_symbols), whole, "mpmath")(
            *(values[x.name] for x in whole.free_symbols)
        )
    )
    s, q = mpmath.mpc(values["s"]), mpmath.mpf("0.5") * (mpmath.mpf("0.27") / 140) ** 0.25
    x = q * mpmath.sqrt(-1j * s)  # beta l, beta^4 = -rho A s^2/(E I)
    ch, sh, c, si = mpmath.cosh(x), mpmath.sinh(x), mpmath.cos(x), mpmath.sin(x)
    stiffness = 140 * (x / 0.5) ** 3 * (1 + ch * c) / (ch * si - sh * c)
    assert found == pytest.approx(complex(1 / (stiffness + 2 * s**2 + 8)), rel=1e-9)


@pytest.mark.parametrize(
    ("prefer", "wanted"),
    [
        ('["k/m"]', "prefer of [analysis] is not a group"),
        ('["b^2/(k*m)"]', "zeta = b/(2*sqrt(m*k))"),
        ('["m*k/b^2"]', "mu = m*k/b^2"),
    ],
)
def test_a_model_may_prefer_groups(prefer: str, wanted: str) -> None:
    text, parameters, _ = CASES["oscillator"]
    assert wanted in str(reading_of(text, parameters, f"[analysis]\nprefer = {prefer}"))


@pytest.mark.parametrize(
    ("text", "parameters", "reason"),
    [
        (SIGNALS + 'y = "u/(s^2 + a*s + c)"', {"a": "", "c": ""}, "nothing says which unit 'a' has"),
        (SIGNALS + 'y = "u/(s + 1)"', {}, "s would be one, and is in 1/s"),
        (SIGNALS + 'y = "u/(sqrt(s) + 1)"', {}, "has roots of s"),
    ],
)
def test_what_has_no_groups_is_told_why(text: str, parameters: dict[str, str], reason: str) -> None:
    assert reason in str(reading_of(text, parameters))


def test_a_fourth_root_is_shown_by_its_fourth_power_in_text_and_latex() -> None:
    # q^4 = rho A omega^2 l^4/(E I) = -S^2 (Rao 2007, chapter 11)
    reading = reading_of(BEAM + TIP, OF_BEAM)
    assert "  q^4 = -S^2" in reading.text().splitlines()
    assert "q^{4} &= -S^{2}" in reading.latex()

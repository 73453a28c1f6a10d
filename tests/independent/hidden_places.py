"""Places of a specification that take an expression of s, each with the equations around it.

``@`` in a text stands for the expression, or where a place says ``of`` what, for its product with that. The
equations, written by hand, are linear in E, the expression's value: each place where E stands is a subsystem
with states of its own. Models have parameters K, a gain, and c, a damping or a resistance. Numbers are such
that they are stable with E = 1/(s + 2), its square, 1/(s + 3) and 1 + 1/(s + 2).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import mpmath
import sympy as sp

s, q, E = sp.symbols("s q E")  # q: the delay exp(-0.3 s) of a place that has one of its own
half, third, fifth = (sp.Rational(1, n) for n in (2, 3, 5))
Rows = list[list[sp.Expr | int]]
Law = Callable[[mpmath.mpc, mpmath.mpc], mpmath.mpc]


@dataclass(frozen=True)
class Place:
    """Where an expression of s stands, and what is true of the model around it."""

    name: str
    text: str
    rows: Rows | None = None
    """Coefficients of the unknowns, of which the first is the output, and of the input on the right."""
    of: str = ""  # what the expression multiplies
    law: Law | None = None
    """With waves, a function of s and E in place of rows; its roots are the poles."""


# ---------------------------------------------------------------------------------------- what stands around

MECHANICAL = """
parameters = { K = "2 N/m", c = "3 N*s/m", k = "1 N/m", b = "1 N*s/m", m = "1 kg" }
elements.m = { type = "mass", at = "x", m = "m" }
elements.d = { type = "damper", between = ["x", "ground"], b = "c" }
elements.g = { type = "force_source", at = "x", f = "-K*x" }
inputs.F = { force = "x" }
outputs.X = "x"
"""
ROTATIONAL = """
parameters = { K = "2 N*m", c = "3 N*m*s", k = "1 N*m", b = "1 N*m*s", m = "1 kg*m^2" }
elements.m = { type = "inertia", at = "x", J = "m" }
elements.d = { type = "rotary_damper", between = ["x", "ground"], b = "c" }
elements.g = { type = "torque_source", at = "x", tau = "-K*x" }
inputs.F = { torque = "x" }
outputs.X = "x"
"""
PLANAR = MECHANICAL.replace('"x"', '"x.y"').replace("K*x", "K*x.y")
ELECTRICAL = """
parameters = { K = "2 A/V", c = "3 Ohm", R = "1 Ohm", L = "1 H", C_1 = "1 F", S = "1 A/V" }
elements.c = { type = "capacitor", between = ["v_1", "ground"], C = "C_1" }
elements.r = { type = "resistor", between = ["v_1", "ground"], R = "c" }
elements.g = { type = "current_source", at = "v_1", i = "-K*v_1" }
inputs.F = { current = "v_1" }
outputs.X = "v_1"
"""
DRIVEN = ELECTRICAL.replace('inputs.F = { current = "v_1" }', 'inputs.F = { voltage = "p" }')
SENSED = ELECTRICAL.replace('["v_1", "ground"], R = "c"', '["v_1", "n"], R = "c"')
ACOUSTIC = """
[parameters]
K = "2 m^3/(s*Pa)"
c = "3 Pa*s/m^3"
R = "1 Pa*s/m^3"
L = "1 kg/m^4"
C_1 = "1 m^3/Pa"
S = "1 m^3/(s*Pa)"
[elements]
c = { type = "acoustic_compliance", at = "p_1", C = "C_1" }
r = { type = "acoustic_resistance", between = ["p_1", "ground"], R = "c" }
g = { type = "flow_source", at = "p_1", q = "-K*p_1" }
[inputs]
F = { flow = "p_1" }
[outputs]
X = "p_1"
[elements.e]
"""
THERMAL = """
parameters = { K = "2 W/K", c = "3 K/W", R = "1 K/W", C_1 = "1 J/K", S = "1 W/K" }
elements.c = { type = "thermal_capacity", at = "T_1", C = "C_1" }
elements.r = { type = "thermal_resistance", between = ["T_1", "ground"], R = "c" }
elements.g = { type = "heat_source", at = "T_1", phi = "-K*T_1" }
inputs.F = { heat = "T_1" }
outputs.X = "T_1"
"""
D = s**2 + 3 * s + 2  # of the mechanical models: m, c and K
Y = s + 2 + third  # of the electrical, acoustic and thermal ones: C_1, K and c
MOTOR = """
parameters = { K = "2 N*m", c = "3 N*m*s", R = "1 Ohm", L = "0.5 H", k_1 = "1 N*m/A", k_2 = "1 V*s/rad" }
elements.m = { type = "inertia", at = "x", J = "1 kg*m^2" }
elements.d = { type = "rotary_damper", between = ["x", "ground"], b = "c" }
elements.g = { type = "torque_source", at = "x", tau = "-K*x" }
elements.e = { type = "dc_motor", terminals = ["a", "ground"], shaft = "x", %s }
inputs.F = { voltage = "a" }
outputs.X = "e.i"
"""
COIL = """
parameters = { K = "2 N/m", c = "3 N*s/m", R = "1 Ohm", L = "0.5 H", k_1 = "1 N/A", k_2 = "1 V*s/m" }
elements.m = { type = "mass", at = "x", m = "1 kg" }
elements.d = { type = "damper", between = ["x", "ground"], b = "c" }
elements.g = { type = "force_source", at = "x", f = "-K*x" }
elements.e = { type = "voice_coil", terminals = ["a", "ground"], mover = "x", %s }
inputs.F = { voltage = "a" }
outputs.X = "e.i"
"""
PIEZO = """
parameters = { K = "2 N/m", c = "3 N*s/m", R = "1 Ohm", alpha = "1 N/V", C_1 = "1 F", k = "1 N/m" }
elements.m = { type = "mass", at = "x", m = "1 kg" }
elements.d = { type = "damper", between = ["x", "ground"], b = "c" }
elements.g = { type = "force_source", at = "x", f = "-K*x" }
elements.r = { type = "resistor", between = ["v_1", "ground"], R = "R" }
elements.e = { type = "piezo", terminals = ["v_1", "ground"], between = ["ground", "x"], %s }
inputs.F = { force = "x" }
outputs.X = "x"
"""
LOOP = """
parameters = { K = 2, c = 3, k = 1, tau = "1 s", w_0 = "1 rad/s" }
inputs.r = {}
outputs.X = "y"
"""
EQUATIONS = """
parameters = { K = "2 N/m", c = "3 N*s/m", k = "1 N/m", m = "1 kg" }
inputs.F = { unit = "N" }
outputs.X = "x"
"""
ENERGY = f"""{EQUATIONS}
energy.coordinates = ["x"]
energy.kinetic = "m*x'^2/2"
energy.dissipation = "c*x'^2/2"
"""
FIELD = """
[parameters]
K = "1 N/m"
c = "0.5 N*s/m"
k = "1 N/m"
s_f = "1 N/m^2"
S = "1 N"
mu = "1 kg/m"
l = "1 m"
eta = "0.4 s"
[inputs]
F = { unit = "N" }
d = { unit = "N" }
[outputs]
X = "w(l)"
[fields.w]
domain = ["0", "l"]
"""
FIELD_EQUATION = "S*(1 + eta*s)*w'' = mu*s^2*w"
FIELD_CONDITION = "S*(1 + eta*s)*w'(l) + c*s*w(l) + K*w(l) = F"
WAVES = {
    "rod": ('EA = "S", rhoA = "mu", eta = "h"', "N", "kg/m", "N*s/m^2", "N/m^2"),
    "shaft": ('GJ = "S", rhoJ = "mu", eta = "h"', "N*m^2", "kg*m", "N*s", "N"),
    "string": ('N = "S", rhoA = "mu", c_f = "d_f"', "N", "kg/m", "N*s/m^2", "N/m^2"),
    "beam": ('EI = "S", rhoA = "mu", eta = "h"', "N*m^2", "kg/m", "N*s/m^2", "N/m^2"),
}


def _mechanical(name: str, text: str, branch: sp.Expr, of: str = "") -> tuple[Place, Place]:
    """Return a place in a model in translation, and the same in rotation."""
    turned = {"spring k": "torsion_spring k", "damper b": "rotary_damper b", "mass m": "inertia J"}
    other = turned.get(name, "torque_source tau")
    (kind, key), (kind_2, key_2) = name.split(), other.split()
    line = f'elements.e = {{ type = "{kind}", {text} }}\n'
    turned_line = f'elements.e = {{ type = "{kind_2}", {text.replace(f"{key} =", f"{key_2} =")} }}\n'
    rows: Rows = [[D + branch, 1]]
    return Place(name, MECHANICAL + line, rows, of), Place(other, ROTATIONAL + turned_line, rows, of)


def _block(name: str, block: str, row: list[sp.Expr | int], *more: list[sp.Expr | int]) -> Place:
    """Return a place in the block G of the loop y = K/(s + c) G (r - y); unknowns y, e, w = G e, and more."""
    size = 3 + len(more)
    given = [[s + 3, 0, -2], [1, 1, 0], row, *more]
    rows = [[*each, *[0] * (size - len(each)), int(i == 1)] for i, each in enumerate(given)]
    return Place(name, f'{LOOP}blocks.G = {{ {block} }}\nsignals.y = "K/(s + c)*G*(r - y)"\n', rows)


def _field(
    name: str, law: Law, *, equation: str = FIELD_EQUATION, end: str = FIELD_CONDITION, of: str = ""
) -> Place:
    """Return a place in a rod written as a field, fixed at 0, with a spring and a dashpot at its end."""
    text = f'{FIELD}equation = "{equation}"\nconditions = ["w(0) = 0", "{end}"]\n'
    return Place(name, text, None, of, law)


def _wave(name: str, value: str, law: Law) -> Place:
    """Return a place in a distributed element fixed at 0, with m, c and K at its end."""
    kind, key = name.split()
    own, *units = WAVES[kind]
    own = ", ".join(each for each in own.split(", ") if not each.startswith(f"{key} "))
    names = ", ".join(f'{n} = "1 {unit}"' for n, unit in zip(("S", "mu", "d_f", "s_f"), units, strict=True))
    start = {"shaft": ROTATIONAL, "beam": PLANAR}.get(kind, MECHANICAL)
    start = start.replace(" }", f', {names}, h = "0.4 s" }}', 1)
    line = f'type = "{kind}", between = ["ground", "x"], l = "1 m", {own}, {key} = "{value}"'
    return Place(name, f"{start}elements.e = {{ {line} }}\n", law=law)


def _rod(stiffness: mpmath.mpc, inertia: mpmath.mpc, end: mpmath.mpc) -> mpmath.mpc:
    """A rod fixed at 0, with an impedance at 1: w = sinh(g x), where g^2 = inertia/stiffness."""
    g = mpmath.sqrt(inertia / stiffness)
    if not g:
        return 1 + end / stiffness
    return mpmath.cosh(g) + end * mpmath.sinh(g) / (stiffness * g)


def _cantilever(stiffness: mpmath.mpc, inertia: mpmath.mpc, end: mpmath.mpc) -> mpmath.mpc:
    """A beam clamped at 0, with an impedance at 1 where it may turn.

    w = cosh b x - cos b x - r (sinh b x - sin b x), with w'' = 0 at 1 and stiffness w^(3) = end w. Source:
    Timoshenko, Young and Weaver 1974, Vibration Problems in Engineering, chapter 5.
    """
    b = mpmath.sqrt(mpmath.sqrt(-inertia / stiffness))
    cos, sin, cosh, sinh = mpmath.cos(b), mpmath.sin(b), mpmath.cosh(b), mpmath.sinh(b)
    return 1 + cos * cosh + end * (sin * cosh - cos * sinh) / (stiffness * b**3)


def _damped(p: mpmath.mpc) -> mpmath.mpc:
    return 1 + 2 * p / 5  # S (1 + h s)


def _end(p: mpmath.mpc) -> mpmath.mpc:
    return p * p + 3 * p + 2  # m, c and K


PLACES = (
    # ----------------------------------------------------------------------------------------- elements
    *_mechanical("spring k", 'between = ["x", "ground"], k = "k*@"', E),
    *_mechanical("damper b", 'between = ["x", "ground"], b = "b*@"', s * E),
    *_mechanical("mass m", 'at = "x", m = "m*@"', s**2 * E),
    *_mechanical("force_source f", 'at = "x", f = "-k*@"', E, "x"),
    Place(  # y = E x, and E times the force of a spring at y comes back
        "transformer ratio",
        f"""{MECHANICAL}
elements.t = {{ type = "transformer", from = "x", to = "y", ratio = "@" }}
elements.e = {{ type = "spring", between = ["y", "ground"], k = "k" }}
""",
        [[D, 0, E, 1], [-E, 1, 0, 0], [0, 1, -1, 0]],
    ),
    Place(  # E s y brakes x, E s x moves y
        "gyrator ratio",
        f"""{MECHANICAL}
elements.t = {{ type = "gyrator", from = "x", to = "y", ratio = "b*@" }}
elements.e = {{ type = "spring", between = ["y", "ground"], k = "k" }}
elements.b = {{ type = "damper", between = ["y", "ground"], b = "b" }}
""",
        [[D, s * E, 1], [-s * E, s + 1, 0]],
    ),
    Place(
        "rigid_body m",
        f"""{PLANAR}
elements.e = {{ type = "rigid_body", at = "x", m = "m*@" }}
elements.h = {{ type = "slider", at = "x" }}
""",
        [[D + s**2 * E, 1]],
    ),
    Place(  # the force of the spring at the far end turns the body
        "rigid_link length",
        """
parameters = { K = "2 N*m", c = "3 N*m*s", k = "1 N/m", h = "1 m" }
elements.m = { type = "inertia", at = "p.theta", J = "1 kg*m^2" }
elements.d = { type = "rotary_damper", between = ["p.theta", "ground"], b = "c" }
elements.g = { type = "torque_source", at = "p.theta", tau = "-K*p.theta" }
elements.h = { type = "pin", at = "p" }
elements.e = { type = "rigid_link", between = ["p", "n"], length = "h*@" }
elements.k = { type = "spring", between = ["n.y", "ground"], k = "k" }
inputs.F = { torque = "p.theta" }
outputs.X = "p.theta"
""",
        [[D, 0, E, 1], [-E, 1, 0, 0], [0, 1, -1, 0]],
    ),
    Place(  # y = P/(3 EI), theta = P/(2 EI)
        "massless_beam EI",
        f"""{PLANAR.replace(" }", ', S = "1 N*m^2" }', 1)}
elements.e = {{ type = "massless_beam", between = ["ground", "x"], EI = "S*@", l = "1 m" }}
""",
        [[D, 0, 1, 1], [E, 0, -third, 0], [0, E, -half, 0]],
    ),
    Place(
        "resistor R",
        f"""{ELECTRICAL}
elements.l = {{ type = "inductor", between = ["v_1", "v_2"], L = "L" }}
elements.e = {{ type = "resistor", between = ["v_2", "ground"], R = "R*@" }}
""",
        [[Y, 1, 1], [1, -s - E, 0]],
    ),
    Place(
        "inductor L",
        f"""{ELECTRICAL}
elements.l = {{ type = "resistor", between = ["v_1", "v_2"], R = "R" }}
elements.e = {{ type = "inductor", between = ["v_2", "ground"], L = "L*@" }}
""",
        [[Y, 1, 1], [1, -1 - s * E, 0]],
    ),
    Place(
        "capacitor C",
        f"""{ELECTRICAL}
elements.e = {{ type = "capacitor", between = ["v_1", "ground"], C = "C_1*@" }}
""",
        [[Y + s * E, 1]],
    ),
    Place(
        "coupled_inductors L_1",
        f"""{ELECTRICAL}
elements.l = {{ type = "resistor", between = ["v_2", "ground"], R = "R" }}
[elements.e]
type = "coupled_inductors"
terminals = ["v_1", "ground", "v_2", "ground"]
L_1 = "L + L*@"
L_2 = "L"
M = "L/2"
""",
        [[Y, 1, 0, 1], [1, -s - s * E, -s / 2, 0], [0, s / 2, s + 1, 0]],
    ),
    Place(
        "coupled_inductors M",
        f"""{ELECTRICAL}
elements.l = {{ type = "resistor", between = ["v_2", "ground"], R = "R" }}
[elements.e]
type = "coupled_inductors"
terminals = ["v_1", "ground", "v_2", "ground"]
L_1 = "L"
L_2 = "L"
M = "L/4*@"
""",
        [[Y, 1, 0, 1], [1, -s, -s * E / 4, 0], [0, s * E / 4, s + 1, 0]],
    ),
    Place(
        "current_source i",
        f"""{ELECTRICAL}
elements.e = {{ type = "current_source", at = "v_1", i = "-S*@" }}
""",
        [[Y + E, 1]],
        "v_1",
    ),
    Place(
        "voltage_source v",
        f"""{ELECTRICAL}
elements.e = {{ type = "voltage_source", at = "v_2", v = "-@" }}
elements.l = {{ type = "resistor", between = ["v_1", "v_2"], R = "R" }}
""",
        [[Y + 1 + E, 1]],
        "v_1",
    ),
    Place("dc_motor R", MOTOR % 'R = "R*@", L = "L", k_t = "k_1"', [[s / 2 + E, s, 1], [-1, D, 0]]),
    Place("dc_motor L", MOTOR % 'R = "R", L = "L*@", k_t = "k_1"', [[s * E / 2 + 1, s, 1], [-1, D, 0]]),
    Place(
        "dc_motor k_t",
        MOTOR % 'R = "R", L = "L", k_t = "k_1*@", k_e = "k_2"',
        [[s / 2 + 1, s, 1], [-E, D, 0]],
    ),
    Place(
        "dc_motor k_e",
        MOTOR % 'R = "R", L = "L", k_t = "k_1", k_e = "k_2*@"',
        [[s / 2 + 1, s * E, 1], [-1, D, 0]],
    ),
    Place(
        "dc_motor k_t and k_e",
        MOTOR % 'R = "R", L = "L", k_t = "k_1*@"',
        [[s / 2 + 1, s * E, 1], [-E, D, 0]],
    ),
    Place("voice_coil R", COIL % 'R = "R*@", L = "L", k_f = "k_1"', [[s / 2 + E, s, 1], [-1, D, 0]]),
    Place("voice_coil k_f", COIL % 'R = "R", L = "L", k_f = "k_1*@"', [[s / 2 + 1, s * E, 1], [-E, D, 0]]),
    Place(
        "piezo alpha",
        PIEZO % 'alpha = "alpha*@", C = "C_1", k = "k"',
        [[D + 1, -E, 1], [s * E, s + 1, 0]],
    ),
    Place("piezo C", PIEZO % 'alpha = "alpha", C = "C_1*@", k = "k"', [[D + 1, -1, 1], [s, s * E + 1, 0]]),
    Place("piezo k", PIEZO % 'alpha = "alpha", C = "C_1", k = "k*@"', [[D + E, -1, 1], [s, s + 1, 0]]),
    Place(  # x + E y = (1 + E) w; the torque t drives x, E t drives y, -(1 + E) t drives w
        "planetary_gear rho",
        f"""{ROTATIONAL}
elements.t = {{ type = "planetary_gear", sun = "x", ring = "y", carrier = "w", rho = "@" }}
elements.e = {{ type = "torsion_spring", between = ["y", "ground"], k = "k" }}
elements.f = {{ type = "torsion_spring", between = ["w", "ground"], k = "k" }}
elements.b = {{ type = "rotary_damper", between = ["w", "ground"], b = "b" }}
""",
        [[D, 0, 0, -1, 1], [0, 1, 0, -E, 0], [0, 0, s + 1, 1 + E, 0], [1, E, -1 - E, 0, 0]],
    ),
    Place(  # o = E (F - v), and a resistor takes it to v
        "op_amp A",
        f"""{DRIVEN}
elements.e = {{ type = "op_amp", inputs = ["p", "v_1"], out = "o", A = "@" }}
elements.l = {{ type = "resistor", between = ["o", "v_1"], R = "R" }}
""",
        [[Y + 1, -1, 0, 0], [0, 1, -E, 0], [1, 0, 1, 1]],
    ),
    Place(
        "vcvs mu",
        f"""{DRIVEN}
elements.e = {{ type = "vcvs", inputs = ["p", "v_1"], terminals = ["o", "ground"], mu = "@" }}
elements.l = {{ type = "resistor", between = ["o", "v_1"], R = "R" }}
""",
        [[Y + 1, -1, 0, 0], [0, 1, -E, 0], [1, 0, 1, 1]],
    ),
    Place(  # i = E (F - v) into v
        "vccs g",
        f"""{DRIVEN}
elements.e = {{ type = "vccs", inputs = ["p", "v_1"], terminals = ["v_1", "ground"], g = "S*@" }}
""",
        [[Y, -E, 0], [1, 1, 1]],
    ),
    Place(  # o = E v/3, and v - o leaves v
        "ccvs r",
        f"""{SENSED}
elements.e = {{ type = "ccvs", inputs = ["n", "ground"], terminals = ["o", "ground"], r = "R*@" }}
elements.l = {{ type = "resistor", between = ["v_1", "o"], R = "R" }}
""",
        [[Y + 1, -1, 1], [-E * third, 1, 0]],
    ),
    Place(
        "cccs beta",
        f"""{SENSED}
elements.e = {{ type = "cccs", inputs = ["n", "ground"], terminals = ["ground", "v_1"], beta = "@" }}
""",
        [[Y + E * third, 1]],
    ),
    Place(
        "acoustic_resistance R",
        f"""{ACOUSTIC}
type = "acoustic_resistance"
between = ["p_2", "ground"]
R = "R*@"
[elements.l]
type = "acoustic_mass"
between = ["p_1", "p_2"]
M = "L"
""",
        [[Y, 1, 1], [1, -s - E, 0]],
    ),
    Place(
        "acoustic_mass M",
        f"""{ACOUSTIC}
type = "acoustic_mass"
between = ["p_2", "ground"]
M = "L*@"
[elements.l]
type = "acoustic_resistance"
between = ["p_1", "p_2"]
R = "R"
""",
        [[Y, 1, 1], [1, -1 - s * E, 0]],
    ),
    Place(
        "acoustic_compliance C",
        f'{ACOUSTIC}type = "acoustic_compliance"\nat = "p_1"\nC = "C_1*@"\n',
        [[Y + s * E, 1]],
    ),
    Place("flow_source q", f'{ACOUSTIC}type = "flow_source"\nat = "p_1"\nq = "-S*@"\n', [[Y + E, 1]], "p_1"),
    Place(
        "pressure_source p",
        f"""{ACOUSTIC}
type = "pressure_source"
at = "p_2"
p = "-@"
[elements.l]
type = "acoustic_resistance"
between = ["p_1", "p_2"]
R = "R"
""",
        [[Y + 1 + E, 1]],
        "p_1",
    ),
    Place(
        "piston A",
        f"""{MECHANICAL.replace(" }", ', A_0 = "1 m^2", C_1 = "1 m^3/Pa", R = "1 Pa*s/m^3" }', 1)}
elements.e = {{ type = "piston", mover = "x", chamber = "p_1", A = "A_0*@" }}
elements.v = {{ type = "acoustic_compliance", at = "p_1", C = "C_1" }}
elements.r = {{ type = "acoustic_resistance", between = ["p_1", "ground"], R = "R" }}
""",
        [[D, E, 1], [-s * E, s + 1, 0]],
    ),
    Place(
        "thermal_resistance R",
        f"""{THERMAL}
elements.l = {{ type = "thermal_capacity", at = "T_2", C = "C_1" }}
elements.e = {{ type = "thermal_resistance", between = ["T_1", "T_2"], R = "R*@" }}
""",
        [[Y, 0, 1, 1], [0, s, -1, 0], [1, -1, -E, 0]],
    ),
    Place(
        "thermal_capacity C",
        f"""{THERMAL}
elements.e = {{ type = "thermal_capacity", at = "T_1", C = "C_1*@" }}
""",
        [[Y + s * E, 1]],
    ),
    Place(
        "heat_source phi",
        f"""{THERMAL}
elements.e = {{ type = "heat_source", at = "T_1", phi = "-S*@" }}
""",
        [[Y + E, 1]],
        "T_1",
    ),
    Place(
        "temperature_source T",
        f"""{THERMAL}
elements.e = {{ type = "temperature_source", at = "T_2", T = "-@" }}
elements.l = {{ type = "thermal_resistance", between = ["T_1", "T_2"], R = "R" }}
""",
        [[Y + 1 + E, 1]],
        "T_1",
    ),
    # ----------------------------------------------------------------- signals: y and e = r - y, unless said
    Place("signal", f'{LOOP}signals.y = "K/(s + c)*@"\n', [[s + 3, -2 * E, 0], [1, 1, 1]], "(r - y)"),
    Place(  # y, K/(s + c) e, e
        "term of a signal",
        f'{LOOP}signals.e = "r - y"\nsignals.y = "K/(s + c)*e + k*@"\n',
        [[1, -1, -E, 0], [0, s + 3, -2, 0], [1, 0, 1, 1]],
        "e",
    ),
    Place(
        "signal fed back",
        f'{LOOP}signals.y = "K/(s + c)*(r - y - @)"\n',
        [[s + 3, -2, 0], [1 + E, 1, 1]],
        "y",
    ),
    Place(
        "signal with a delay",
        f"""{LOOP.replace(" }", ', T_0 = "0.3 s" }', 1)}
signals.y = "exp(-s*T_0)/(s + c)*(r - K*@)"
""",
        [[s + 3, -q, 0], [2 * E, 1, 1]],
        "y",
    ),
    Place(  # X, y
        "output",
        f"""{LOOP.replace('"y"', '"@"')}signals.y = "K/(s + c)*(r - y)"\n""",
        [[1, -E, 0], [0, s + 5, 2]],
        "y",
    ),
    Place(  # X, y
        "term of an output",
        f"""{LOOP.replace('"y"', '"y + k*@"')}signals.y = "K/(s + c)*(r - y)"\n""",
        [[1, -1 - E, 0], [0, s + 5, 2]],
        "y",
    ),
    Place(  # y, d: the other input is 0
        "another input",
        f'{LOOP}inputs.d = {{}}\nsignals.y = "K/(s + c)*(r - y + @)"\n',
        [[s + 5, -2 * E, 2], [0, 1, 0]],
        "d",
    ),
    Place(
        "input of an ss",
        f"""{LOOP}
blocks.G = {{ type = "ss", from = ["K*@"], to = ["y"], A = [["-c"]], B = [[1]], C = [[1]] }}
""",
        [[s + 3, -2 * E, 0], [1, 1, 1]],
        "(r - y)",
    ),
    # -------------------------------------------------------------- blocks: unknowns y, e = r - y, w = G e
    _block("ss A", 'type = "ss", A = [["-1 - @"]], B = [[1]], C = [[1]]', [0, -1, s + 1 + E]),
    _block("ss B", 'type = "ss", A = [[-1]], B = [["@"]], C = [[1]]', [0, -E, s + 1]),
    _block("ss C", 'type = "ss", A = [[-1]], B = [[1]], C = [["@"]]', [0, 0, 1, -E], [0, -1, 0, s + 1]),
    _block(
        "ss D",
        'type = "ss", A = [[-1]], B = [[1]], C = [[1]], D = "@"',
        [0, -E, 1, -1],
        [0, -1, 0, s + 1],
    ),
    _block(
        "ss A of two states",
        'type = "ss", A = [[-1, "@"], [-0.5, -2]], B = [[1], [0]], C = [[1, 0]]',
        [0, -1, s + 1, -E],
        [0, 0, half, s + 2],
    ),
    _block("pid k_p", 'type = "pid", k_p = "@"', [0, -E, 1]),
    _block("pid k_i", 'type = "pid", k_p = 1, k_i = "@"', [0, -s - E, s]),
    _block("pid k_d", 'type = "pid", k_p = 1, k_d = "@"', [0, -1 - s * E, 1]),
    _block(
        "pid k_d with T_f",
        'type = "pid", k_p = 1, k_d = "@", T_f = "0.2 s"',
        [0, -1, 1, -1],
        [0, -s * E, 0, 1 + s * fifth],
    ),
    _block(
        "pid T_f", 'type = "pid", k_p = 1, k_d = "tau", T_f = "tau*@"', [0, -1, 1, -1], [0, -s, 0, 1 + s * E]
    ),
    _block("tf num", 'type = "tf", num = "@", den = "s + 1"', [0, -E, s + 1]),
    _block("tf num, list", 'type = "tf", num = ["@", 1], den = [1, 2]', [0, -s * E - 1, s + 2]),
    _block("tf den", 'type = "tf", num = 1, den = "s + 1 + @"', [0, -1, s + 1 + E]),
    _block("tf den, list", 'type = "tf", num = 1, den = [1, 1, "1 + @"]', [0, -1, s**2 + s + 1 + E]),
    _block(
        "lead_lag k",
        'type = "lead_lag", k = "@", T_1 = "0.5 s", T_2 = "0.2 s"',
        [0, -E * (1 + s * half), 1 + s * fifth],
    ),
    _block("lead_lag T_1", 'type = "lead_lag", T_1 = "tau*@", T_2 = "0.2 s"', [0, -1 - s * E, 1 + s * fifth]),
    _block("lead_lag T_2", 'type = "lead_lag", T_1 = "0.5 s", T_2 = "tau*@"', [0, -1 - s * half, 1 + s * E]),
    _block("lag k", 'type = "lag", k = "@", T = "0.5 s"', [0, -E, 1 + s * half]),
    _block("lag T", 'type = "lag", T = "tau*@"', [0, -1, 1 + s * E]),
    _block("integrator k", 'type = "integrator", k = "@"', [0, -E, s]),
    _block(
        "notch zeta_p",
        'type = "notch", omega = 1, zeta_p = "1/2 + @", zeta_z = 0.5',
        [0, -(s**2) - s - 1, s**2 + s + 1 + 2 * s * E],
    ),
    _block(
        "notch zeta_z",
        'type = "notch", omega = 1, zeta_p = 0.5, zeta_z = "@"',
        [0, -(s**2) - 1 - 2 * s * E, s**2 + s + 1],
    ),
    _block(  # E w, E e
        "notch omega",
        'type = "notch", omega = "w_0*@", zeta_p = 0.5, zeta_z = 0.25',
        [0, -(s**2), s**2, s + E, -s * half - E],
        [0, 0, -E, 1, 0],
        [0, -E, 0, 0, 1],
    ),
    _block("low_pass k", 'type = "low_pass", k = "@", omega = 1, zeta = 0.5', [0, -E, s**2 + s + 1]),
    _block(
        "low_pass zeta",
        'type = "low_pass", omega = 1, zeta = "1/2 + @"',
        [0, -1, s**2 + s + 1 + 2 * s * E],
    ),
    _block(  # W w, W e, where W = 1/2 + E
        "low_pass omega",
        'type = "low_pass", omega = "w_0*(1/2 + @)", zeta = 0.5',
        [0, 0, s**2, s + half + E, -half - E],
        [0, 0, -half - E, 1, 0],
        [0, -half - E, 0, 0, 1],
    ),
    _block(
        "resonance zeta_z",
        'type = "resonance", omega_p = 1, zeta_p = 0.5, omega_z = 1, zeta_z = "@"',
        [0, -(s**2) - 1 - 2 * s * E, s**2 + s + 1],
    ),
    _block(
        "resonance zeta_p",
        'type = "resonance", omega_p = 1, zeta_p = "1/2 + @", omega_z = 1, zeta_z = 0.5',
        [0, -(s**2) - s - 1, s**2 + s + 1 + 2 * s * E],
    ),
    # ------------------------------------------------------------------ definitions, equations, energies
    Place(
        "definition",
        f"""{MECHANICAL}
definitions.Z = "b*s + k*@"
elements.e = {{ type = "spring", between = ["x", "ground"], k = "Z" }}
""",
        [[D + s + E, 1]],
    ),
    Place(
        "definition of a definition",
        f"""{MECHANICAL}
definitions.Z = "k*@"
definitions.Z_2 = "k + Z"
elements.e = {{ type = "spring", between = ["x", "ground"], k = "Z_2" }}
""",
        [[D + 1 + E, 1]],
    ),
    Place(
        "parameter as a formula",
        f"""{MECHANICAL.replace(" }", ', Z = "k*@" }', 1)}
elements.e = {{ type = "spring", between = ["x", "ground"], k = "Z" }}
""",
        [[D + E, 1]],
    ),
    Place(
        "equation",
        f"""{EQUATIONS}
equations.unknowns = ["x"]
equations.equations = ["m*s^2*x + c*s*x + K*x + k*@ = F"]
""",
        [[D + E, 1]],
        "x",
    ),
    Place(
        "equation with primes",
        f"""{EQUATIONS}
equations.unknowns = ["x"]
equations.equations = ["m*x'' + c*x' + k*@ = F - K*x"]
""",
        [[D + E, 1]],
        "x",
    ),
    Place(  # x, and F that drives it through E
        "input of an equation",
        f"""{EQUATIONS}
equations.unknowns = ["x"]
equations.equations = ["m*s^2*x + c*s*x + K*x = @"]
""",
        [[D, -E, 0], [0, 1, 1]],
        "F",
    ),
    Place(
        "one of two equations",
        f"""{EQUATIONS}
equations.unknowns = ["x", "y"]
equations.equations = ["m*s^2*x + c*s*x + K*x + k*@ = F", "m*s^2*y + c*s*y + K*y = k*x"]
""",
        [[D, E, 1], [-1, D, 0]],
        "y",
    ),
    Place(
        "force of an energy",
        f'{ENERGY}energy.potential = "K*x^2/2"\nenergy.forces = {{ x = "F - k*@" }}\n',
        [[D + E, 1]],
        "x",
    ),
    Place(
        "potential energy",
        f'{ENERGY}energy.potential = "K*x^2/2 + k*@*x^2/2"\nenergy.forces = {{ x = "F" }}\n',
        [[D + E, 1]],
    ),
    # -------------------------------------------------------------------------------------------- waves
    _field(
        "field equation",
        lambda p, e: _rod(_damped(p), p * p + e, 1 + p / 2),
        equation=f"{FIELD_EQUATION} + s_f*@*w",
    ),
    _field(
        "field stiffness",
        lambda p, e: _rod(_damped(p) * (1 + e), p * p, (1 + p / 2) * (1 + e)),
        equation="S*(1 + eta*s)*(1 + @)*w'' = mu*s^2*w",
    ),
    _field(
        "field condition",
        lambda p, e: _rod(_damped(p), p * p, 1 + p / 2 + e),
        end=f"{FIELD_CONDITION} - k*@",
        of="w(l)",
    ),
    _field(
        "field condition, factor",
        lambda p, e: _rod(_damped(p), p * p, (1 + p / 2) / (1 + e)),
        end="S*(1 + @)*(1 + eta*s)*w'(l) + c*s*w(l) + K*w(l) = F",
    ),
    _field(
        "input of a field condition",
        lambda p, e: _rod(_damped(p), p * p, 1 + p / 2) / e,
        end=FIELD_CONDITION.replace("= F", "= @"),
        of="F",
    ),
    _field(
        "another input of a field condition",
        lambda p, _: _rod(_damped(p), p * p, 1 + p / 2),
        end=f"{FIELD_CONDITION} + @",
        of="d",
    ),
    _field(
        "load of a field",
        lambda p, _: _rod(_damped(p), p * p, 1 + p / 2),
        equation=f"{FIELD_EQUATION} - @/l",
        of="d",
    ),
    _wave("rod EA", "S*(1 + @)", lambda p, e: _rod(_damped(p) * (1 + e), p * p, _end(p))),
    _wave("rod rhoA", "mu*(1 + @)", lambda p, e: _rod(_damped(p), p * p * (1 + e), _end(p))),
    _wave("rod eta", "h*(1 + @)", lambda p, e: _rod(1 + 2 * p / 5 * (1 + e), p * p, _end(p))),
    _wave("rod c_f", "d_f*@", lambda p, e: _rod(_damped(p), p * p + p * e, _end(p))),
    _wave("rod k_f", "s_f*@", lambda p, e: _rod(_damped(p), p * p + e, _end(p))),
    _wave("shaft GJ", "S*(1 + @)", lambda p, e: _rod(_damped(p) * (1 + e), p * p, _end(p))),
    _wave("shaft k_f", "s_f*@", lambda p, e: _rod(_damped(p), p * p + e, _end(p))),
    _wave("string N", "S*(1 + @)", lambda p, e: _rod(1 + e, p * p + p, _end(p))),
    _wave("string c_f", "d_f*@", lambda p, e: _rod(1, p * p + p * e, _end(p))),
    _wave("beam EI", "S*(1 + @)", lambda p, e: _cantilever(_damped(p) * (1 + e), p * p, _end(p))),
    _wave("beam rhoA", "mu*(1 + @)", lambda p, e: _cantilever(_damped(p), p * p * (1 + e), _end(p))),
    _wave("beam c_f", "d_f*@", lambda p, e: _cantilever(_damped(p), p * p + p * e, _end(p))),
    _wave("beam k_f", "s_f*@", lambda p, e: _cantilever(_damped(p), p * p + e, _end(p))),
)

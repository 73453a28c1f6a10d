"""Symbolic boundaries, against textbooks and against characteristic functions that were written by hand."""

from cmath import atan, cos, cosh, exp, pi, sin, sinh, sqrt

import pytest

import symflex
from symflex.errors import SymflexError

ROD = {"type": "rod", "between": ["x", "tip"], "E": "E", "rho": "rho", "A": "A", "l": "l"}
BEAM = {"type": "beam", "between": ["x", "tip"], "EI": "E", "rhoA": "rho", "l": "l"}
FUNCTIONS = {"atan": atan, "pi": pi, "cos": cos, "cosh": cosh, "sin": sin, "sinh": sinh, "sqrt": sqrt}


def model_of(letters, **tables):
    return symflex.Model(parameters={n: {} for n in letters.split()}, **tables)


def loop(letters, transfer):
    return model_of(letters, signals={"y": f"({transfer})*(r - y)"}, inputs={"r": {}}, outputs={"Y": "y"})


def machine(letters, member, force):
    drive = {"type": "force_source", "at": "x", "f": f"F - {force}"}
    elements = {"hub": {"type": "mass", "at": "x", "m": "m"}, "member": member, "drive": drive}
    elements |= {"guide": {"type": "slider", "at": "x"}} if member is BEAM else {}
    return model_of(letters, elements=elements, inputs={"F": {}}, outputs={"X": "x"})


def test_boundaries_of_textbooks():
    lag = "K(omega) = T*omega*sin(omega*L) - cos(omega*L); "
    lag += "K_i(omega) = omega*(T*omega*cos(omega*L) + sin(omega*L)); K_i = 0"
    integrator = "K(omega) = omega; T(omega) = (2*n + 1/2)*pi/omega; K = 0"
    wall = "K(omega) = omega*sqrt(m^2*omega^2 + b^2); T(omega) = (2*n*pi + atan(b/(m*omega)))/omega; K = 0"
    delayed = "K(omega) = sqrt(T_1^2*omega^2 + 1); "
    delayed += "T(omega) = ((2*n + 1)*pi - atan(T_1*omega) - omega*T_2)/omega; K + 1 = 0"
    held = "K(omega) = sqrt(T_1^2*omega^2 + 1); "
    held += "T(omega) = 2*((2*n + 1)*pi - atan(T_1*omega))/(3*omega); K + 1 = 0"
    for letters, transfer, over, expected in (
        ("K T", "K/s*exp(-s*T)", ("T", "K"), integrator),  # K*T < pi/2
        ("m b K T", "K/(m*s^2 + b*s)*exp(-s*T)", ("K", "T"), wall),  # a haptic wall
        ("K T T_1 T_2", "K/(T_1*s + 1)*exp(-s*(T + T_2))", ("K", "T"), delayed),
        ("K T T_1", "K/(T_1*s + 1)*exp(-1.5*T*s)", ("T", "K"), held),  # a sampled computer
        # Silva, Datta and Bhattacharyya 2005, PI control of a lag with delay
        ("K K_i T L", "(K + K_i/s)/(T*s + 1)*exp(-s*L)", ("K", "K_i"), lag),
    ):
        assert "; ".join(map(str, loop(letters, transfer).conditions(over=over).conditions)) == expected


def test_an_arc_tangent_is_typeset_as_a_function():
    shown = loop("K T L", "K/(T*s + 1)*exp(-s*L)").conditions(over=("K", "L")).latex()
    assert r"- \arctan(T \omega)" in shown


def on_rod(s, v):
    q = s * v["l"] * sqrt(v["rho"] / v["E"])
    force = (v["K"] + v["K_d"] * s) * exp(-s * v["T"])
    return v["m"] * s**2 * cosh(q) + s * v["A"] * sqrt(v["E"] * v["rho"]) * sinh(q) + force


def on_spring(s, v):
    return v["m"] * s**2 + v["b"] * s + v["k"] + v["K"] * s * exp(-s * (v["T"] * v["a"] + v["T_2"]) / 2)


def without_damping(s, v):
    return s**2 + v["a"] - v["b"] + v["K"] * exp(-s * v["T"])


def in_filter(s, v):
    return v["T_1"] * s + 1 + v["K"] * exp(-s * v["T"]) * (1 + exp(-s * v["T_2"]))


def on_beam(s, v):
    """The stiffness at the sliding end of a beam whose other end is free is that of Bishop and Johnson."""
    beta = sqrt(sqrt(v["rho"] * -(s**2) / v["E"]))
    q = beta * v["l"]
    stiffness = -v["E"] * beta**3 * (cosh(q) * sin(q) + sinh(q) * cos(q)) / (1 + cosh(q) * cos(q))
    return v["m"] * s**2 + v["K"] * exp(-s * v["T"]) + stiffness


SPRING = model_of(
    "m b k K T a T_2",
    elements={
        "body": {"type": "mass", "at": "x", "m": "m"},
        "wall": {"type": "spring", "between": ["x", "ground"], "k": "k"},
        "loss": {"type": "damper", "between": ["x", "ground"], "b": "b"},
        "drive": {"type": "force_source", "at": "x", "f": "F - K*exp(-s*(a*T + T_2)/2)*s*x"},
    },
    inputs={"F": {}},
    outputs={"X": "x"},
)


@pytest.mark.parametrize(
    ("model", "over", "function"),
    [
        (machine("m E rho A l K K_d T", ROD, "(K + K_d*s)*exp(-s*T)*tip"), ("K", "K_d"), on_rod),
        (machine("m E rho l K T", BEAM, "K*exp(-s*T)*x"), ("K", "T"), on_beam),
        (SPRING, ("K", "T"), on_spring),
        # The angle is nothing below a resonance, and half a turn above it.
        (loop("K T a b", "K*exp(-s*T)/(s^2 + a - b)"), ("K", "T"), without_damping),
        # Neither cosine nor sine of the angle has a sign.
        (loop("K T T_1 T_2", "K*(1 + exp(-s*T_2))*exp(-s*T)/(T_1*s + 1)"), ("K", "T"), in_filter),
    ],
)
def test_a_pole_lies_on_the_axis_where_the_boundary_says(model, over, function):
    lines = [str(c).replace("^", "**").split(" = ") for c in model.conditions(over=over).conditions]
    for omega in (0.3, 1.1, 2.7, 7.9):
        known = {p.name: 0.5 + 0.1 * i for i, p in enumerate(model.resolved.parameters) if p.name not in over}
        known["omega"] = omega
        known["n"] = 1
        # Names stand below the lines that use them, and the delay below the gain.
        for left, right in [*[x for x in lines if x[0].isidentifier()][::-1], *lines]:
            known[left.removesuffix("(omega)")] = eval(right, FUNCTIONS, known)  # noqa: S307 (ours)
        assert abs(function(1j * omega, known)) < 1e-9


def test_what_cannot_be_solved_is_refused():
    for letters, transfer, over, code in (
        ("K T", "K/(s*(T*s + 1))", ("K", "K"), "SF902"),
        ("K T", "K/(s*(T*s + 1))", ("K", "Q"), "SF902"),
        ("K G T", "(K + G)/(s*(T*s + 1))", ("K", "G"), "SF801"),  # they act alike
        ("K T", "(K*s + K)/(T*s + 1)*exp(-s*T)", ("K", "T"), "SF801"),  # T is a lag, too
    ):
        with pytest.raises(SymflexError) as caught:
            loop(letters, transfer).conditions(over=over)
        assert caught.value.diagnostics[0].code == code

"""Boundaries in letters, against textbooks and against characteristic functions that were written by hand."""

from cmath import cos, cosh, exp, sin, sinh, sqrt
from math import atan2, tau

import pytest

import symflex
from symflex.errors import SymflexError

ROD = {"type": "rod", "between": ["x", "tip"], "E": "E", "rho": "rho", "A": "A", "l": "l"}
BEAM = {"type": "beam", "between": ["x", "tip"], "EI": "E", "rhoA": "rho", "l": "l"}
FUNCTIONS = {"cos": cos, "cosh": cosh, "sin": sin, "sinh": sinh, "sqrt": sqrt}


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
    integrator = "K(omega) = omega; cos(omega*T) = 0; sin(omega*T) = omega/K; K = 0"
    wall = "K(omega) = omega*sqrt(m^2*omega^2 + b^2); cos(omega*T) = m*omega^2/K; sin(omega*T) = b*omega/K; "
    wall += "K = 0"
    for letters, transfer, over, expected in (
        ("K T", "K/s*exp(-s*T)", ("T", "K"), integrator),  # K*T < pi/2
        ("m b K T", "K/(m*s^2 + b*s)*exp(-s*T)", ("K", "T"), wall),  # a haptic wall
        # Silva, Datta and Bhattacharyya 2005, PI control of a lag with delay
        ("K K_i T L", "(K + K_i/s)/(T*s + 1)*exp(-s*L)", ("K", "K_i"), lag),
    ):
        assert "; ".join(map(str, loop(letters, transfer).conditions(over=over).conditions)) == expected


def on_rod(s, v):
    q = s * v["l"] * sqrt(v["rho"] / v["E"])
    force = (v["K"] + v["K_d"] * s) * exp(-s * v["T"])
    return v["m"] * s**2 * cosh(q) + s * v["A"] * sqrt(v["E"] * v["rho"]) * sinh(q) + force


def on_beam(s, v):
    """The stiffness at the sliding end of a beam whose other end is free is that of Bishop and Johnson."""
    beta = sqrt(sqrt(v["rho"] * -(s**2) / v["E"]))
    q = beta * v["l"]
    stiffness = -v["E"] * beta**3 * (cosh(q) * sin(q) + sinh(q) * cos(q)) / (1 + cosh(q) * cos(q))
    return v["m"] * s**2 + v["K"] * exp(-s * v["T"]) + stiffness


@pytest.mark.parametrize(
    ("model", "over", "function"),
    [
        (machine("m E rho A l K K_d T", ROD, "(K + K_d*s)*exp(-s*T)*tip"), ("K", "K_d"), on_rod),
        (machine("m E rho l K T", BEAM, "K*exp(-s*T)*x"), ("K", "T"), on_beam),
    ],
)
def test_a_pole_lies_on_the_axis_where_the_boundary_says(model, over, function):
    lines = [str(c).replace("^", "**").split(" = ") for c in model.conditions(over=over).conditions]
    for omega in (0.3, 1.1, 2.7):
        known = {p.name: 0.5 + 0.1 * i for i, p in enumerate(model.resolved.parameters) if p.name not in over}
        known["omega"] = omega
        # Names stand below the lines that use them, and sine and cosine below the gain.
        for left, right in [*[x for x in lines if x[0].isidentifier()][::-1], *lines]:
            known[left.removesuffix("(omega)")] = eval(right, FUNCTIONS, known)  # noqa: S307 (ours)
        if "T" in over:
            known["T"] = (atan2(known["sin(omega*T)"].real, known["cos(omega*T)"].real) + tau) / omega
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

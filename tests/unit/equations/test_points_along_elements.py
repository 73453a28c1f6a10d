"""Quantities of beams, rods, shafts and strings at points between their ends."""

from cmath import cosh, sinh

import numpy as np
import pytest

import symflex
from symflex.errors import SymflexError

S = 2 + 40j
E, I, RHO, A, LENGTH, X = 70e9, 1.2e-9, 2700.0, 1.5e-4, 0.8, 0.3  # noqa: E741

LINES = """symflex = 1
[parameters]
E = "70 GPa"
I = "1.2e-9 m^4"
rho = "2700 kg/m^3"
A = "1.5e-4 m^2"
l = "0.8 m"
x_s = "0.3 m"
G = "26 GPa"
J = "2e-9 m^4"
N = "30 N"
kappa = 0.85
eta = "1e-5 s"
k_f = "200 N/m^2"
[elements]
"""
BEAM = 'E = "E", I = "I", rho = "rho", A = "A"'
CANTILEVER = (
    LINES
    + f'arm = {{ type = "beam", between = ["ground", "tip"], l = "l", {BEAM} }}\n'
    + '[inputs]\nF = { force = "tip" }\n[outputs]\n'
)


def value(text, name, s=S):
    return complex(symflex.loads(text).transfer_function(*name.split("/")).bind()(s))


def cantilever(x):
    """y, theta, f and tau at x with a unit force at the tip, from E I w'''' = -rho A s^2 w."""
    exponents = np.roots([1, 0, 0, 0, RHO * A * S**2 / (E * I)])

    def row(order, at):
        return exponents**order * np.exp(exponents * at)

    rows = np.array([row(0, 0), row(1, 0), E * I * row(2, LENGTH), E * I * row(3, LENGTH)])
    c = np.linalg.solve(rows, np.array([0, 0, 0, -1]))
    y, theta, tau, f = (row(k, x) @ c * scale for k, scale in ((0, 1), (1, 1), (2, E * I), (3, -E * I)))
    return {"y": y, "theta": theta, "f": f, "tau": tau}


@pytest.mark.slow
def test_the_state_of_a_cantilever_at_a_point_solves_its_equation():
    places = [("x_s", X, "y"), ("0.3 m", X, "theta"), ("300mm", X, "f"), ("0.3", X, "tau")]
    places += [("l/2", 0.4, "y"), ("l - 5 mm", 0.795, "f")]
    places += [("0.5*x_s + 1 cm", 0.16, quantity) for quantity in ("y", "theta", "f", "tau")]
    for place, x, quantity in places:
        text = f'{CANTILEVER}Q = "arm.{quantity}({place})"\n'
        expected = pytest.approx(cantilever(x)[quantity], rel=1e-9)
        assert value(text, "Q/F") == expected, (place, quantity)


def test_at_its_end_the_state_of_a_beam_is_that_of_the_node_and_primes_are_derivatives_along_x():
    for one, other in [
        ("arm.y(l)", "tip"),
        ("arm.theta(l)", "tip.theta"),
        ("arm.f(l)", "-arm.f"),
        ("arm.tau(l)", "-arm.tau"),
        ("arm.y'(x_s)", "arm.theta(x_s)"),
        ("E*I*arm.y''(x_s)", "arm.tau(x_s)"),
    ]:
        text = f'{CANTILEVER}Q = "{one} - ({other})"\n'
        assert symflex.loads(text).transfer_function("Q", "F").num == 0, one


ARM = (
    LINES
    + 'pivot = { type = "pin", at = "a" }\nload = { type = "mass", at = "b", m = "0.5 kg" }\n'
    + 'hub = { type = "inertia", at = "a.theta", J = "0.02 kg*m^2" }\n'
)
DRIVE = '[inputs]\nT = { torque = "a.theta" }\n[outputs]\n'
WHOLE = 'arm = {{ type = "beam", between = ["a", "b"], l = "l", {0} }}\n'
SPLIT = (
    'arm = {{ type = "beam", between = ["a", "c"], l = "x_s", {0} }}\n'
    'rest = {{ type = "beam", between = ["c", "b"], l = "l - x_s", {0} }}\n'
)


@pytest.mark.slow
def test_at_a_point_a_thick_beam_is_what_two_are_where_they_meet():
    theory = ', theory = "timoshenko", G = "G", kappa = "kappa"'
    names = ("y", "theta", "f", "tau")
    inside = "".join(f'{q} = "arm.{q}(x_s)"\n' for q in names)
    joint = 'y = "c"\ntheta = "c.theta"\nf = "-arm.f"\ntau = "-arm.tau"\n'
    whole = symflex.loads(ARM + WHOLE.format(BEAM + theory) + DRIVE + inside)
    split = symflex.loads(ARM + SPLIT.format(BEAM + theory) + DRIVE + joint)
    for name in names:
        found, wanted = (complex(m.transfer_function(name, "T").bind()(S)) for m in (whole, split))
        assert found == pytest.approx(wanted, rel=1e-12)


def line(kind, stiffness, drive, quantity):
    return (
        f'{LINES}line = {{ type = "{kind}", between = ["ground", "b"], l = "l", {stiffness} }}\n'
        f'[inputs]\nF = {{ {drive} = "b" }}\n[outputs]\nQ = "line.{quantity}(x_s)"\n'
    )


def test_a_line_held_at_one_end_and_driven_at_the_other():
    rod, string = 'E = "E", A = "A", rho = "rho"', 'N = "N", A = "A", rho = "rho"'
    for kind, parameters, drive, across, through, stiffness, speed in [
        ("rod", rod, "force", "u", "f", E * A, (E / RHO) ** 0.5),
        ("rod", rod, "force", "y", "f", E * A, (E / RHO) ** 0.5),
        ("shaft", 'G = "G", J = "J", rho = "rho"', "torque", "theta", "tau", 52.0, (26e9 / RHO) ** 0.5),
        ("string", string, "force", "y", "f", 30.0, (30 / (RHO * A)) ** 0.5),
        ("string", string, "force", "u", "f", 30.0, (30 / (RHO * A)) ** 0.5),
    ]:
        g = S / speed
        moved, carried = sinh(g * X) / (stiffness * g * cosh(g * LENGTH)), cosh(g * X) / cosh(g * LENGTH)
        found = [value(line(kind, parameters, drive, q), "Q/F") for q in (across, through)]
        assert found == pytest.approx([moved, carried], rel=1e-11), (kind, across)


def test_a_beam_clamped_at_its_first_end_needs_no_node_there():
    text = CANTILEVER.replace('["ground", "tip"]', '["wall", "tip"]').replace(
        "[inputs]", 'w = { type = "fixed", at = "wall" }\n[inputs]'
    )
    assert value(f'{text}Q = "arm.y(x_s)"\n', "Q/F") == pytest.approx(cantilever(X)["y"], rel=1e-9)


def test_a_sensor_between_the_ends_closes_a_loop():
    open_loop = f'{CANTILEVER}Q = "arm.y(x_s)"\nTip = "tip"\n'
    closed = open_loop.replace('F = { force = "tip" }', "r = {}").replace(
        "[inputs]", 'drive = { type = "force_source", at = "tip", f = "K*(r - arm.y(x_s))" }\n[inputs]'
    ).replace("x_s = ", 'K = "200 N/m"\nx_s = ')  # fmt: skip
    plant = cantilever(X)["y"]
    assert value(closed, "Q/r") == pytest.approx(200 * plant / (1 + 200 * plant), rel=1e-9)


def test_a_signal_reads_a_point():
    text = CANTILEVER.replace("[outputs]", '[signals]\ne = "3*arm.theta(0.3 m)"\n[outputs]') + 'Q = "e"\n'
    assert value(text, "Q/F") == pytest.approx(3 * cantilever(X)["theta"], rel=1e-9)


def test_a_point_of_a_field_may_have_its_unit():
    text = (
        "symflex = 1\n[parameters]\nk = 2\n[fields.w]\n"
        'domain = ["0", "0.8 m"]\nequation = "w\'\' = k^2*w"\nconditions = ["w(0 m) = 0", "w(800 mm) = u"]\n'
        '[inputs]\nu = {}\n[outputs]\nQ = "w(0.3 m)"\n'
    )
    assert value(text.replace("k^2", "s^2*k^2"), "Q/u") == pytest.approx(
        sinh(2 * S * X) / sinh(2 * S * LENGTH)
    )


def test_a_point_that_is_none_is_refused():
    for place, code in [
        ("0.9 m", "SF240"), ("-1 mm", "SF240"), ("l + 1 nm", "SF240"), ("2*l", "SF240"), ("-x_s", "SF240"),
        ("s", "SF249"), ("0.3 kg", "SF203"), ("0.3 Hz", "SF203"), ("5 deg", "SF203"), ("E", "SF203"),
        ("tip", "SF212"), ("F", "SF212"), ("arm.y(0)", "SF212"), ("1e999 m", "SF103"),
        ("0.3 parsec", "SF201"),
        ("", "SF111"), ("0.3 m, 0.1 m", "SF111"), ("0.3 m/2", "SF111"), ("nan", "SF210"), ("l/0", "SF224"),
    ]:  # fmt: skip
        with pytest.raises(SymflexError) as caught:
            symflex.loads(f'{CANTILEVER}Q = "arm.y({place})"\n')
        assert {d.code for d in caught.value.diagnostics} == {code}, place


def test_what_has_no_points_is_told_apart():
    for expression, code, hint in [
        ("arm.y", "SF241", "evaluate it at a point: arm.y(0)"),
        ("arm.w(0.3 m)", "SF210", "it offers arm.y(...), arm.theta(...), arm.f(...), arm.tau(...)"),
        ("amr.y(0.3 m)", "SF210", "did you mean 'arm'?"),
        ("tip.y(0.3 m)", "SF210", "write 'tip.y*(...)' to multiply"),
    ]:  # fmt: skip
        with pytest.raises(SymflexError) as caught:
            symflex.loads(f'{CANTILEVER}Q = "{expression}"\n')
        assert [(d.code, d.hint) for d in caught.value.diagnostics] == [(code, hint)], expression


def test_wavenumbers_of_a_point_are_those_of_the_beam():
    G = symflex.loads(f'{CANTILEVER}Q = "arm.y(x_s)"\n').transfer_function("Q", "F")
    assert len(G.exact.kernels.dispersions) == 1

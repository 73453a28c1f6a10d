"""Distributed elements among each other, with motors, signals, delays, and a field at a node."""

from __future__ import annotations

from mpmath import mp

from tests.independent.boundary_value import Number, Problem, Values, bending, rod, shaft, timoshenko
from tests.independent.distributed.case import (
    AXIAL,
    BEAM,
    BEAM_ELEMENT,
    DAMPED,
    LOSSES,
    ROD,
    ROD_ELEMENT,
    SHAFT,
    SHAFT_ELEMENT,
    SLENDER,
    THICK,
    THICK_ELEMENT,
    Case,
    elements,
    ode,
)
from tests.independent.distributed.elements_alone import payload
from tests.independent.distributed.span import (
    clamped,
    free,
    free_with_force,
    pinned,
    second_end,
    span,
    tip_mass_and_dashpot,
)


def two_spans(v: Values, s: Number) -> Number:
    """Beam of two spans over a spring, both ends pinned: moment at one end, rotation of the other."""
    problem = Problem()
    left, right = problem.line(bending(v, s)), problem.line(bending(v, s))
    w, slope, moment, shear = left.at(v["l_1"])
    w_2, slope_2, moment_2, shear_2 = right.start
    end = right.at(v["l"] - v["l_1"])
    problem.require(left.start[0], left.start[2] + 1, *pinned(*end))
    problem.require(w - w_2, slope - slope_2, moment - moment_2, shear_2 - shear + w * v["k"])
    return problem.solve()(end[1])


def two_theories(v: Values, s: Number) -> Number:
    """A stocky root, a rigid body, a slender tip: force at the body, deflection of the tip."""
    problem = Problem()
    root = problem.line(timoshenko(v, s))
    tip = problem.line(bending(v | {"I": v["I_2"], "A": v["A_2"]}, s))
    w, slope, moment, shear = root.at(v["l"])
    w_2, slope_2, moment_2, shear_2 = tip.start
    end = tip.at(v["l_2"])
    problem.require(*clamped(*root.start), *free(*end), w - w_2, slope - slope_2)
    problem.require(v["m"] * s**2 * w - (shear - shear_2) - 1, v["J_b"] * s**2 * slope + moment - moment_2)
    return problem.solve()(end[0])


def massless_then_beam(v: Values, s: Number) -> Number:
    """A cantilever flexure without mass, by its textbook flexibility, and an arm on it."""
    problem = Problem()
    arm = problem.line(bending(v, s))
    w, slope, moment, shear = arm.start
    # The arm's first end is loaded with V and -M, so the flexure's end with -V and M.
    length, stiffness = v["l_f"], v["EI_f"]
    problem.require(
        w - (-shear * length**3 / 3 + moment * length**2 / 2) / stiffness,
        slope - (-shear * length**2 / 2 + moment * length) / stiffness,
        *free_with_force(*arm.at(v["l"]), v, s),
    )
    return problem.solve()(arm.at(v["l"])[0])


def robot(v: Values, s: Number) -> Number:
    """Current-controlled motor, screw, carriage, flexible arm and gripper mass: deflection of the gripper."""
    problem = Problem()
    current, angle, force = (problem.unknown() for _ in range(3))
    arm = problem.line(bending(v, s))
    w, slope, _, shear = arm.start
    end = arm.at(v["l"])
    problem.require(
        # k_c (u - i) = (R + L s) i + k_e s angle
        current * (v["k_c"] + v["R"] + v["L"] * s) + angle * (v["k_t"] * s) - v["k_c"],
        angle * (v["J_m"] * s**2) - current * v["k_t"] + force * v["r"],
        w - angle * v["r"],
        w * (v["m_c"] * s**2 + v["b"] * s) - force + shear,
        slope,
        *payload(*end, v, s),
    )
    return problem.solve()(end[0])


def geared_shaft(v: Values, s: Number) -> Number:
    """A voltage-driven motor turns a long shaft, a gear and a disc: angle of the disc."""
    problem = Problem()
    current, disc = problem.unknown(), problem.unknown()
    axle = problem.line(shaft(v, s))
    angle, torque = axle.start
    angle_2, torque_2 = axle.at(v["l"])
    # The gear turns the disc n times as far; its torque on the disc is 1/n of what the shaft's end gives, -T.
    problem.require(
        current * (v["R"] + v["L"] * s) + angle * (v["k_t"] * s) - 1,
        angle * (v["J_m"] * s**2) - current * v["k_t"] - torque,
        disc - angle_2 * v["n"],
        disc * (v["J_1"] * s**2 + v["b"] * s) + torque_2 / v["n"],
    )
    return problem.solve()(disc)


def delayed_spring(v: Values, s: Number) -> Number:
    """Mass and spring whose position is fed back with delay."""
    return 1 / (v["m"] * s**2 + v["k"] + v["k_p"] * mp.exp(-s * v["T"]))


def delayed_arm(v: Values, s: Number) -> Number:
    """Cantilever whose tip velocity is fed back as a force on the tip, with delay."""
    loop = v["k_v"] * s * mp.exp(-s * v["T"])
    return span(clamped, lambda w, slope, moment, shear, v, s: (moment, shear + 1 - w * loop), second_end(0))(
        v, s
    )


def delayed_rod(v: Values, s: Number) -> Number:
    """Free rod pushed through a delay."""
    push = mp.exp(-s * v["T"])
    return span(lambda u, f, v, s: (f + push,), lambda u, f, v, s: (f,), second_end(0), rod)(v, s)


def field_with_node(v: Values, s: Number) -> Number:
    """Cantilever with a mass, a damper and a unit force at its tip."""
    return span(clamped, tip_mass_and_dashpot, second_end(0))(v, s)


ROBOT = BEAM | {
    "R": "1.2 ohm",
    "L": "0.0021 H",
    "k_t": "0.11 N*m/A",
    "J_m": "2.4e-4 kg*m^2",
    "r": "0.004 m",
    "m_c": "6 kg",
    "b": "60 N*s/m",
    "k_c": "10 V/A",
    "m": "0.4 kg",
}
ROBOT_BODY = """
[signals]
v_m = "k_c*(u - motor.i)"
""" + elements(
    drive='type = "voltage_source", at = "e", v = "v_m"',
    motor='type = "dc_motor", terminals = ["e", "ground"], shaft = "axis", L = "L", R = "R", k_t = "k_t"',
    rotor='type = "inertia", at = "axis", J = "J_m"',
    screw='type = "transformer", from = "axis", to = "x", ratio = "r"',
    carriage='type = "mass", at = "x", m = "m_c"',
    friction='type = "damper", between = ["x", "ground"], b = "b"',
    guide='type = "slider", at = "x"',
    arm=f'{BEAM_ELEMENT}, between = ["x", "tip"], l = "l"',
    gripper='type = "mass", at = "tip", m = "m"',
)

NETWORKS = (
    Case(
        "beam of two spans over a spring",
        BEAM | {"l_1": "0.35 m", "k": "900 N/m"},
        elements(
            left='type = "pin", at = "p"',
            first=f'{BEAM_ELEMENT}, between = ["p", "middle"], l = "l_1"',
            spring='type = "spring", between = ["middle", "ground"], k = "k"',
            second=f'{BEAM_ELEMENT}, between = ["middle", "q"], l = "l - l_1"',
            right='type = "pin", at = "q"',
        ),
        "q.theta",
        *SLENDER,
        two_spans,
        source='{ torque = "p" }',
    ),
    Case(
        "Timoshenko root, rigid body, slender tip",
        THICK
        | {"I_2": "7.2e-10 m^4", "A_2": "2.4e-4 m^2", "l_2": "0.5 m", "m": "0.8 kg", "J_b": "6e-4 kg*m^2"},
        elements(
            root=f'{THICK_ELEMENT}, between = ["ground", "joint"], l = "l"',
            body='type = "rigid_body", at = "joint", m = "m", J = "J_b", cg = "0"',
            whip='type = "beam", E = "E", I = "I_2", rho = "rho", A = "A_2", between = ["joint", "tip"],'
            ' l = "l_2"',
        ),
        "tip",
        120.0,
        (-2.5, 2.0),
        two_theories,
        source='{ force = "joint" }',
    ),
    Case(
        "massless flexure and an arm",
        BEAM | {"EI_f": "4 N*m^2", "l_f": "0.06 m"},
        elements(
            flexure='type = "massless_beam", between = ["ground", "joint"], EI = "EI_f", l = "l_f"',
            arm=f'{BEAM_ELEMENT}, between = ["joint", "tip"], l = "l"',
        ),
        "tip",
        *SLENDER,
        massless_then_beam,
        source='{ force = "tip" }',
    ),
    Case("motor, screw, carriage, flexible arm, gripper: tip", ROBOT, ROBOT_BODY, "tip", *SLENDER, robot),
    Case(
        "motor, shaft, gear and disc",
        SHAFT
        | {
            "R": "1.2 ohm",
            "L": "0.0021 H",
            "k_t": "0.11 N*m/A",
            "J_m": "2.4e-4 kg*m^2",
            "n": "0.2",
            "J_1": "0.03 kg*m^2",
            "b": "0.02 N*m*s",
        },
        elements(
            motor='type = "dc_motor", terminals = ["e", "ground"], shaft = "p",'
            ' L = "L", R = "R", k_t = "k_t"',
            rotor='type = "inertia", at = "p", J = "J_m"',
            axle=f'{SHAFT_ELEMENT}, between = ["p", "q"], l = "l"',
            gear='type = "transformer", from = "q", to = "out_shaft", ratio = "n"',
            disc='type = "inertia", at = "out_shaft", J = "J_1"',
            loss='type = "rotary_damper", between = ["out_shaft", "ground"], b = "b"',
        ),
        "out_shaft",
        4150.0,
        (-4.0, 1.3),
        geared_shaft,
        source='{ voltage = "e" }',
    ),
    Case(
        "mass and spring with delayed feedback",
        {"m": "2 kg", "k": "50 N/m", "k_p": "7 N/m", "T": "0.3 s"},
        '\n[blocks]\nD = { type = "delay", T = "T" }\n'
        + elements(
            body='type = "mass", at = "x", m = "m"',
            spring='type = "spring", between = ["x", "ground"], k = "k"',
            actuator='type = "force_source", at = "x", f = "u - k_p*D*x"',
        ),
        "x",
        5.0,
        (-3.0, 1.5),
        delayed_spring,
    ),
    Case(
        "cantilever with delayed velocity feedback",
        BEAM | {"k_v": "0.7 N*s/m", "T": "0.004 s"},
        '\n[blocks]\nD = { type = "delay", T = "T" }\n'
        + elements(
            arm=f'{BEAM_ELEMENT}, between = ["ground", "tip"], l = "l"',
            actuator='type = "force_source", at = "tip", f = "u - k_v*D*s*tip"',
        ),
        "tip",
        38.0,
        (-2.5, 2.0),
        delayed_arm,
    ),
    Case(
        "free rod pushed after a delay",
        ROD | {"T": "2e-4 s"},
        '\n[blocks]\nD = { type = "delay", T = "T" }\n'
        + elements(
            bar=f'{ROD_ELEMENT}, between = ["p", "q"], l = "l"',
            actuator='type = "force_source", at = "p", f = "D*u"',
        ),
        "q",
        *AXIAL,
        delayed_rod,
    ),
    Case(
        "field whose end is a node with a mass and a damper",
        BEAM | LOSSES | {"m": "0.11 kg", "b": "0.6 N*s/m"},
        ode(DAMPED, "w(0) = 0", "w'(0) = 0", "w''(l) = 0", "w(l) = load")
        + elements(
            gripper='type = "mass", at = "load", m = "m"',
            loss='type = "damper", between = ["load", "ground"], b = "b"',
            joint='type = "force_source", at = "load", f = "E*I*(1 + eta*s)*w\'\'\'(l)"',
        ),
        "load",
        *SLENDER,
        field_with_node,
        source='{ force = "load" }',
    ),
)

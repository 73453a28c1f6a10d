"""Fields of several unknowns, of other orders, of other physics, and fields joined to each other."""

from __future__ import annotations

from tests.independent.boundary_value import (
    Number,
    Problem,
    Rows,
    Values,
    bending,
    exponential,
    rod,
    string,
    timoshenko,
)
from tests.independent.distributed.case import (
    AXIAL,
    BEAM,
    EULER,
    ROD,
    SLENDER,
    STOCKY,
    STRING,
    TAUT,
    THICK,
    Case,
    ode,
    system,
)
from tests.independent.distributed.span import (
    clamped,
    first_end,
    free,
    free_with_force,
    inside,
    pinned,
    second_end,
    span,
)


def stepped_beam(v: Values, s: Number) -> Number:
    """Cantilever of two thicknesses, force at the step, deflection of the tip."""
    problem = Problem()
    root = problem.line(bending(v, s))
    tip = problem.line(bending(v | {"I": v["I_2"], "A": v["A_2"]}, s))
    w, slope, moment, shear = root.at(v["l_1"])
    w_2, slope_2, moment_2, shear_2 = tip.start
    problem.require(*clamped(*root.start), *free(*tip.at(v["l"] - v["l_1"])))
    # The force acts on both faces together: -V of the first part's end and +V_2 of the second's beginning.
    problem.require(w - w_2, slope - slope_2, moment - moment_2, shear_2 - shear - 1)
    return problem.solve()(tip.at(v["l"] - v["l_1"])[0])


def two_rods(v: Values, s: Number) -> Number:
    """Rods of two materials end to end, held at the first end, pulled at the second."""
    problem = Problem()
    first = problem.line(rod(v, s))
    second = problem.line(rod(v | {"E": v["E_2"], "rho": v["rho_2"]}, s))
    u, tension = first.at(v["l_1"])
    problem.require(
        first.start[0], u - second.start[0], tension - second.start[1], second.at(v["l"] - v["l_1"])[1] - 1
    )
    return problem.solve()(u)


def transmission_line(v: Values, s: Number) -> Number:
    """Electrical line driven by a voltage, a resistor at its end: voltage across the resistor."""
    problem = Problem()
    rows = [[0, -(v["L"] * s + v["R"]), 0], [-(v["C"] * s + v["G"]), 0, 0]]
    line = problem.line(rows)
    voltage, current = line.at(v["l"])
    problem.require(line.start[0] - 1, voltage - current * v["R_l"])
    return problem.solve()(voltage)


def heated_wall(v: Values, s: Number) -> Number:
    """Wall with a heat flux into one side and convection from the other: temperature of the heated side."""
    problem = Problem()
    rows = [[0, -1 / v["kappa"], 0], [-v["rho"] * v["c"] * s, 0, 0]]  # temperature and heat flux
    line = problem.line(rows)
    temperature, flux = line.at(v["l"])
    problem.require(line.start[1] - 1, flux - temperature * v["h"])
    return problem.solve()(line.start[0])


def flowing(v: Values, s: Number) -> Rows:
    """Rows of a pipe that conveys fluid at speed U (Paidoussis 1998, eq. 3.1 without gravity and loss)."""
    fluid, total = v["m_f"], v["m_f"] + v["m_p"]
    stiffness = v["E"] * v["I"]
    last = [-total * s**2, -2 * fluid * v["U"] * s, -fluid * v["U"] ** 2, 0, 0]
    return [[0, 1, 0, 0, 0], [0, 0, 1, 0, 0], [0, 0, 0, 1, 0], [x / stiffness for x in last]]


def pipe_with_tail(v: Values, s: Number) -> Number:
    """Cantilevered pipe that conveys fluid, a bare beam clamped to its end: deflection inside the pipe."""
    pipe_stiffness, stiffness = v["E"] * v["I"], v["E"] * v["I_2"]
    problem = Problem()
    line = problem.line(flowing(v, s))
    last = [-v["m_p"] * s**2 / stiffness, 0, 0, 0, 0]
    tail = problem.line([[0, 1, 0, 0, 0], [0, 0, 1, 0, 0], [0, 0, 0, 1, 0], last])
    joint, tip = line.at(v["l"]), tail.at(v["l_2"])
    problem.require(line.start[0], line.start[1], tip[2], stiffness * tip[3] + 1)
    problem.require(
        joint[0] - tail.start[0],
        joint[1] - tail.start[1],
        pipe_stiffness * joint[2] - stiffness * tail.start[2],
        pipe_stiffness * joint[3] - stiffness * tail.start[3],
    )
    return problem.solve()(line.at(v["x_s"])[0])


def bending_and_torsion(v: Values, s: Number) -> Number:
    """Cantilever whose mass centre lies e beside its elastic axis: tip force, twist of the tip."""
    mass, e = v["rho"] * v["A"], v["e"]
    stiffness, torsion = v["E"] * v["I"], v["G"] * v["J"]
    inertia = v["rho"] * v["I_p"] + mass * e**2
    problem = Problem()
    line = problem.line(  # w, w', M, V, twist, torque
        [
            [0, 1, 0, 0, 0, 0, 0],
            [0, 0, 1 / stiffness, 0, 0, 0, 0],
            [0, 0, 0, 1, 0, 0, 0],
            [-mass * s**2, 0, 0, 0, -mass * e * s**2, 0, 0],
            [0, 0, 0, 0, 0, 1 / torsion, 0],
            [mass * e * s**2, 0, 0, 0, inertia * s**2, 0, 0],
        ]
    )
    *_, moment, shear, twist, torque = line.at(v["l"])
    problem.require(*line.start[:2], line.start[4], moment, shear + 1, torque)
    return problem.solve()(twist)


def moving_medium(v: Values, s: Number) -> Number:
    """Concentration carried along with decay: exp(-(s + k) l/v_0), by the same exponential as all others."""
    return exponential([[-(s + v["k"]) / v["v_0"]]], v["l"])[0][0]


def dispersive_wave(v: Values, s: Number) -> Number:
    """Linear shallow-water waves, s h + c h' + d h''' = 0, order three (Whitham 1974, sec. 13.11)."""
    problem = Problem()
    line = problem.line([[0, 1, 0, 0], [0, 0, 1, 0], [-s / v["d"], -v["c"] / v["d"], 0, 0]])
    end = line.at(v["l"])
    problem.require(line.start[0] - 1, end[0], end[1])
    return problem.solve()(line.at(v["l"] / 3)[0])


STEP = {"l_1": "0.4 m", "I_2": "2.1e-10 m^4", "A_2": "1.6e-4 m^2"}

FIELDS_OF_ALL_KINDS = (
    Case(
        "Timoshenko cantilever as a system of two unknowns",
        THICK,
        system(
            ("kappa*G*A*(w'' - phi') = rho*A*s^2*w", "E*I*phi'' + kappa*G*A*(w' - phi) = rho*I*s^2*phi"),
            ("w(0) = 0", "phi(0) = 0", "phi'(l) = 0", "kappa*G*A*(w'(l) - phi(l)) = u"),
            "beam",
            ("w", "phi"),
        ),
        "w(l)",
        *STOCKY,
        span(clamped, free_with_force, second_end(0), timoshenko),
    ),
    Case(
        "pinned-pinned Timoshenko beam with damping under a distributed load, rotation of an end",
        THICK | {"eta": "3e-7 s", "c_f": "900 N*s/m^2"},
        system(
            (
                "kappa*G*A*(1 + eta*s)*(w'' - phi') = (rho*A*s^2 + c_f*s)*w - u",
                "(1 + eta*s)*(E*I*phi'' + kappa*G*A*(w' - phi)) = rho*I*s^2*phi",
            ),
            ("w(0) = 0", "phi'(0) = 0", "w(l) = 0", "phi'(l) = 0"),
            "beam",
            ("w", "phi"),
        ),
        "phi(0)",
        *STOCKY,
        span(pinned, pinned, first_end(1), timoshenko, load=1),
    ),
    Case(
        "free-free rod with damping, displacement inside",
        ROD | {"eta": "3e-7 s", "c_f": "700 N*s/m^2", "x_s": "0.2 m"},
        ode("E*A*(1 + eta*s)*w'' = (rho*A*s^2 + c_f*s)*w", "E*A*(1 + eta*s)*w'(0) = -u", "w'(l) = 0"),
        "w(x_s)",
        *AXIAL,
        span(
            lambda u, tension, v, s: (tension + 1,),
            lambda u, tension, v, s: (tension,),
            inside(0, "x_s"),
            rod,
        ),
    ),
    Case(
        "string under a distributed load, middle",
        STRING,
        ode("N*w'' + u = rho*A*s^2*w", "w(0) = 0", "w(l) = 0"),
        "w(l/2)",
        *TAUT,
        span(
            lambda w, force, v, s: (w,),
            lambda w, force, v, s: (w,),
            lambda line, v: line.at(v["l"] / 2)[0],
            string,
            load=1,
        ),
    ),
    Case(
        "cantilever of two thicknesses, force at the step",
        BEAM | STEP,
        ode(EULER, "w(0) = 0", "w'(0) = 0", domain=("0", "l_1"))
        + ode(
            "E*I_2*y'''' + rho*A_2*s^2*y = 0",
            "y(l_1) = w(l_1)",
            "y'(l_1) = w'(l_1)",
            "E*I_2*y''(l_1) = E*I*w''(l_1)",
            "E*I_2*y'''(l_1) = E*I*w'''(l_1) + u",
            "y''(l) = 0",
            "y'''(l) = 0",
            name="y",
            domain=("l_1", "l"),
        ),
        "y(l)",
        *SLENDER,
        stepped_beam,
    ),
    Case(
        "rods of two materials, displacement of the joint",
        ROD | {"l_1": "0.5 m", "E_2": "110e9 Pa", "rho_2": "4430 kg/m^3"},
        ode("E*w'' = rho*s^2*w", "w(0) = 0", domain=("0", "l_1"))
        + ode(
            "E_2*y'' = rho_2*s^2*y",
            "y(l_1) = w(l_1)",
            "E_2*y'(l_1) = E*w'(l_1)",
            "E_2*A*y'(l) = u",
            name="y",
            domain=("l_1", "l"),
        ),
        "w(l_1)",
        *AXIAL,
        two_rods,
    ),
    Case(
        "electrical transmission line",
        {
            "L": "2.5e-7 H/m",
            "C": "1e-10 F/m",
            "R": "0.1 ohm/m",
            "G": "1e-6 S/m",
            "l": "100 m",
            "R_l": "75 ohm",
        },
        system(
            ("v' = -(L*s + R)*i", "i' = -(C*s + G)*v"), ("v(0) = u", "v(l) = R_l*i(l)"), "line", ("v", "i")
        ),
        "v(l)",
        3.1e6,
        (-3.0, 1.0),
        transmission_line,
    ),
    Case(
        "heated wall",
        {"kappa": "0.8 W/(m*K)", "rho": "1900 kg/m^3", "c": "840 J/(kg*K)", "l": "0.3 m", "h": "8 W/(m^2*K)"},
        ode("kappa*w'' = rho*c*s*w", "-kappa*w'(0) = u", "-kappa*w'(l) = h*w(l)"),
        "w(0)",
        1e-5,
        (-3.0, 3.3),
        heated_wall,
    ),
    Case(
        "pipe conveying fluid with a bare tail",
        {
            "E": "2e6 Pa",
            "I": "2e-9 m^4",
            "I_2": "1e-9 m^4",
            "m_f": "0.12 kg/m",
            "m_p": "0.2 kg/m",
            "U": "0.7 m/s",
            "l": "0.5 m",
            "l_2": "0.2 m",
            "x_s": "0.3 m",
        },
        ode(
            "E*I*w'''' + m_f*U^2*w'' + 2*m_f*U*s*w' + (m_f + m_p)*s^2*w = 0",
            "w(0) = 0",
            "w'(0) = 0",
            "w(l) = y(l)",
            "w'(l) = y'(l)",
        )
        + ode(
            "E*I_2*y'''' + m_p*s^2*y = 0",
            "E*I*w''(l) = E*I_2*y''(l)",
            "E*I*w'''(l) = E*I_2*y'''(l)",
            "y''(l + l_2) = 0",
            "E*I_2*y'''(l + l_2) = -u",
            name="y",
            domain=("l", "l + l_2"),
        ),
        "w(x_s)",
        1.0,
        (-2.0, 2.3),
        pipe_with_tail,
    ),
    Case(
        "coupled bending and torsion",
        BEAM | {"G": "26e9 Pa", "J": "2.6e-9 m^4", "I_p": "3.3e-8 m^4", "e": "0.008 m"},
        system(
            (
                "E*I*w'''' + rho*A*s^2*(w + e*phi) = 0",
                "G*J*phi'' = (rho*I_p + rho*A*e^2)*s^2*phi + rho*A*e*s^2*w",
            ),
            ("w(0) = 0", "w'(0) = 0", "phi(0) = 0", "w''(l) = 0", "E*I*w'''(l) = -u", "phi'(l) = 0"),
            "beam",
            ("w", "phi"),
        ),
        "phi(l)",
        38.0,
        (-2.0, 2.0),
        bending_and_torsion,
    ),
    Case(
        "decaying substance in a moving medium",
        {"v_0": "1.5 m/s", "k": "0.02 1/s", "l": "6 m"},
        ode("v_0*w' + (s + k)*w = 0", "w(0) = u"),
        "w(l)",
        1.0,
        (-3.0, 1.5),
        moving_medium,
    ),
    Case(
        "dispersive wave of third order",
        {"c": "2.1 m/s", "d": "0.9 m^3/s", "l": "3 m"},
        ode("s*w + c*w' + d*w''' = 0", "w(0) = u", "w(l) = 0", "w'(l) = 0"),
        "w(l/3)",
        1.0,
        (-2.0, 2.5),
        dispersive_wave,
    ),
)

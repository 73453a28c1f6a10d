"""Ten machines whose parameters are fitted to responses and records that numpy and scipy computed.

Responses are those of formulas written by hand, with multiplicative noise. Records are simulated by state
equations (scipy), a delayed lag in closed form, and a beam by a sum of modes; they have white noise.
``python -m tests.tools.fits machines 40`` prints how often intervals hold the true values.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import brentq
from scipy.signal import cont2discrete, dlsim, tf2ss

from symflex import pipeline
from symflex.data.fitting.parameters import fit_parameters
from symflex.data.measurement import MeasuredResponse
from symflex.data.measurement.measured_response import Samples


@dataclass(frozen=True)
class Machine:
    """A specification with the values that a fit begins with, and the true ones."""

    begun: dict[str, str]
    body: str
    tf: str
    true: dict[str, float]
    band: tuple[float, float, int]  # Hz, and lines
    response: Callable[[np.ndarray, dict[str, float]], np.ndarray]  # of s
    known: dict[str, float] = field(default_factory=dict)  # true values that are declared

    def text(self) -> str:
        """Return the specification."""
        lines = [f'{name} = "{value}"' for name, value in self.begun.items()]
        return "\n".join(["symflex = 1", "[parameters]", *lines, self.body])


def _impedance(p, s):
    return p["k"] + p["b"] * s


def drive(s, p):
    """Two inertias on a spring and a damper, at the driven one."""
    z, J_1, J_2 = _impedance(p, s), p["J_1"], p["J_2"]
    return (J_2 * s**2 + z) / (J_1 * J_2 * s**4 + (J_1 + J_2) * s**2 * z)


def far(s, p):
    """The same at the other inertia."""
    z, J_1, J_2 = _impedance(p, s), p["J_1"], p["J_2"]
    return z / (J_1 * J_2 * s**4 + (J_1 + J_2) * s**2 * z)


def motor(s, p):
    """Speed of a direct-current motor over its voltage."""
    return p["k_m"] / ((p["L"] * s + p["R"]) * (p["J"] * s + p["b"]) + p["k_m"] ** 2)


def loudspeaker(s, p):
    """Impedance of a moving coil."""
    return p["R_e"] + p["L_e"] * s + p["Bl"] ** 2 / (p["M"] * s + p["R_m"] + p["k_s"] / s)


def crystal(s, p):
    """Admittance of the circuit of Butterworth and Van Dyke."""
    return s * p["C_0"] + 1 / (p["R_1"] + s * p["L_1"] + 1 / (s * p["C_1"]))


def car(s, p):
    """Motion of the body of a quarter car over that of the road."""
    z = p["k_s"] + p["c_s"] * s
    return z * p["k_t"] / ((p["m_s"] * s**2 + z) * (p["m_u"] * s**2 + z + p["k_t"]) - z**2)


def cantilever(s, p):
    """Receptance of the tip of a cantilever with a mass (Bishop & Johnson 1960, table 7.1(c))."""
    EI, rhoA = p["E"] * (1 + p["eta"] * s) * 4e-9, p["rho"] * 4.8e-4
    x = (-rhoA * s**2 / EI) ** 0.25
    free = (np.sin(x) * np.cosh(x) - np.cos(x) * np.sinh(x)) / (EI * x**3 * (1 + np.cos(x) * np.cosh(x)))
    return 1 / (1 / free + p["m"] * s**2)


def rod(s, p):
    """Receptance of the end of a rod with a mass."""
    E = p["E"] * (1 + p["eta"] * s)
    g = s * np.sqrt(p["rho"] / E)
    return 1 / (E * 4.8e-4 * g / np.tanh(g) + p["m"] * s**2)


def oven(s, p):
    """A lag with a delay."""
    return p["K"] * np.exp(-p["T_d"] * s) / (1 + p["T"] * s)


def shaft(s, p):
    """Angle of a disc on a shaft with another disc at its far end."""
    G = p["G"] * (1 + 2e-6 * s)
    g = s * np.sqrt(7850 / G)
    z = G * 1.5708e-8 * g
    near, other = z / np.tanh(1.2 * g) + p["J_1"] * s**2, z / np.tanh(1.2 * g) + p["J_2"] * s**2
    return other / (near * other - (z / np.sinh(1.2 * g)) ** 2)


def ladder(s, p):
    """Voltage ratio of a ladder of two sections."""
    shunt = 1 / (1 / (p["R_2"] + 1 / (s * p["C_2"])) + s * p["C_1"])
    return shunt / (shunt + p["L_1"] * s + 0.8) / (1 + s * p["R_2"] * p["C_2"])


DRIVE = """[elements]
M = { type = "inertia", at = "q1", J = "J_1" }
L = { type = "inertia", at = "q2", J = "J_2" }
K = { type = "torsion_spring", between = ["q1", "q2"], k = "k" }
B = { type = "rotary_damper", between = ["q1", "q2"], b = "b" }
[inputs]
tau = { torque = "q1" }
[outputs]
theta_1 = "q1"
theta_2 = "q2"
"""
TIP = """payload = { type = "mass", at = "tip", m = "m" }
[inputs]
F = { force = "tip" }
[outputs]
X = "tip"
"""
_DRIVE = {"J_1": 2e-3, "J_2": 5e-3, "k": 400.0, "b": 0.03}
_FIRST = {"J_1": "1.5e-3 kg*m^2", "J_2": "7e-3 kg*m^2", "k": "300 N*m/rad", "b": "0.05 N*m*s/rad"}
_SERIES = 1 / (2 * np.pi * np.sqrt(8e-3 * 30e-15))  # Hz, of the crystal

MACHINES = {
    "drive": Machine(_FIRST, DRIVE, "theta_1/tau", _DRIVE, (3, 300, 250), drive),
    "far drive": Machine(
        _FIRST | {"J_2": "5e-3 kg*m^2"},
        DRIVE,
        "theta_2/tau",
        {n: _DRIVE[n] for n in ("J_1", "k", "b")},
        (3, 200, 250),
        far,
        {"J_2": 5e-3},
    ),
    "motor": Machine(
        {"R": "2 Ohm", "L": "1 mH", "k_m": "0.03 N*m/A", "J": "1e-5 kg*m^2", "b": "2e-4 N*m*s"},
        """[elements]
M = { type = "dc_motor", terminals = ["v", "ground"], shaft = "w", k_t = "k_m", L = "L", R = "R" }
J = { type = "inertia", at = "w", J = "J" }
B = { type = "rotary_damper", between = ["w", "ground"], b = "b" }
[inputs]
u = { voltage = "v" }
[outputs]
omega = "s*w"
""",
        "omega/u",
        {"R": 1.2, "k_m": 0.05, "J": 3e-5},
        (0.5, 2000, 200),
        motor,
        {"L": 1e-3, "b": 2e-4},
    ),
    "loudspeaker": Machine(
        {"R_e": "4 Ohm", "L_e": "1 mH", "Bl": "5 N/A", "M": "22 g", "R_m": "0.7 kg/s", "k_s": "4 kN/m"},
        """[elements]
coil = { type = "voice_coil", terminals = ["e", "ground"], mover = "x", k_f = "Bl", R = "R_e", L = "L_e" }
cone = { type = "mass", at = "x", m = "M" }
sus = { type = "spring", between = ["x", "ground"], k = "k_s" }
loss = { type = "damper", between = ["x", "ground"], b = "R_m" }
[inputs]
i = { current = "e" }
[outputs]
u = "e"
""",
        "u/i",
        {"R_e": 6.2, "L_e": 5e-4, "Bl": 7.5, "R_m": 1.4, "k_s": 1800.0},
        (10, 5000, 200),
        loudspeaker,
        {"M": 0.022},
    ),
    "crystal": Machine(
        {"R_1": "30 Ohm", "L_1": "8.01 mH", "C_1": "30 fF", "C_0": "4 pF"},
        """[elements]
R = { type = "resistor", between = ["a", "b"], R = "R_1" }
L = { type = "inductor", between = ["b", "c"], L = "L_1" }
C = { type = "capacitor", between = ["c", "ground"], C = "C_1" }
D = { type = "capacitor", between = ["a", "ground"], C = "C_0" }
X = { type = "voltage_source", between = ["a", "ground"], v = "u" }
[inputs]
u = {}
[outputs]
i = "X.i"
""",
        "i/u",
        {"R_1": 12.0, "L_1": 8e-3, "C_1": 30e-15, "C_0": 6e-12},
        (0.999 * _SERIES, 1.004 * _SERIES, 400),
        crystal,
    ),
    "car": Machine(
        {"m_s": "300 kg", "m_u": "60 kg", "k_s": "10 kN/m", "c_s": "800 N*s/m", "k_t": "300 kN/m"},
        """[equations]
unknowns = ["x_s", "x_u"]
equations = ["m_s*s^2*x_s + (c_s*s + k_s)*(x_s - x_u) = 0", "m_u*s^2*x_u + (c_s*s + k_s)*(x_u - x_s) + k_t*(x_u - z) = 0"]
[inputs]
z = {}
[outputs]
y = "x_s"
""",  # noqa: E501
        "y/z",
        {"m_u": 40.0, "k_s": 2e4, "c_s": 1500.0, "k_t": 1.8e5},
        (0.3, 40, 150),
        car,
        {"m_s": 300.0},
    ),
    "cantilever": Machine(
        {"E": "180 GPa", "rho": "7000 kg/m^3", "eta": "100 us", "m": "1.2 kg"},
        '[elements]\nbar = { type = "beam", between = ["tip", "ground"], E = "E", I = "4e-9 m^4", '
        f'rho = "rho", A = "480 mm^2", l = "1 m", eta = "eta" }}\n{TIP}',
        "X/F",
        {"E": 2.05e11, "rho": 7850.0, "eta": 3e-5, "m": 0.7},
        (1, 150, 250),
        cantilever,
    ),
    "rod": Machine(
        {"E": "60 GPa", "rho": "3200 kg/m^3", "eta": "3 us", "m": "0.6 kg"},
        '[elements]\nbar = { type = "rod", between = ["tip", "ground"], E = "E", rho = "rho", '
        f'A = "480 mm^2", l = "1 m", eta = "eta" }}\n{TIP}',
        "X/F",
        {"E": 7e10, "rho": 2700.0, "eta": 1e-6, "m": 1.0},
        (50, 8000, 250),
        rod,
    ),
    "oven": Machine(
        {"K": "1", "T": "30 s", "T_d": "1 s"},
        '[blocks]\nD = { type = "delay", T = "T_d" }\n[inputs]\nu = {}\n[outputs]\ny = "K*D*u/(T*s + 1)"\n',
        "y/u",
        {"K": 2.5, "T": 12.0, "T_d": 1.7},
        (1e-3, 1, 120),
        oven,
    ),
    "shaft": Machine(
        {"G": "60 GPa", "J_1": "5e-4 kg*m^2", "J_2": "2e-4 kg*m^2"},
        """[elements]
disc_1 = { type = "inertia", at = "q1", J = "J_1" }
disc_2 = { type = "inertia", at = "q2", J = "J_2" }
[elements.shaft]
type = "shaft"
between = ["q1", "q2"]
G = "G"
J = "15708 mm^4"
rho = "7850 kg/m^3"
l = "1.2 m"
eta = "2 us"
[inputs]
tau = { torque = "q1" }
[outputs]
angle = "q1"
""",
        "angle/tau",
        {"G": 7.9e10, "J_1": 3e-4, "J_2": 1e-4},
        (10, 3000, 250),
        shaft,
    ),
    "ladder": Machine(
        {"L_1": "2 mH", "C_1": "1 uF", "C_2": "5 uF", "R_2": "30 Ohm"},
        """[elements]
R = { type = "resistor", between = ["a", "b"], R = "0.8 Ohm" }
L = { type = "inductor", between = ["b", "c"], L = "L_1" }
C = { type = "capacitor", between = ["c", "ground"], C = "C_1" }
R2 = { type = "resistor", between = ["c", "d"], R = "R_2" }
C2 = { type = "capacitor", between = ["d", "ground"], C = "C_2" }
[inputs]
u = { voltage = "a" }
[outputs]
y = "d"
""",
        "y/u",
        {"L_1": 1e-3, "C_1": 2e-6, "R_2": 10.0},
        (100, 20000, 180),
        ladder,
        {"C_2": 5e-6},
    ),
}


def held(above, below, u, step_s):
    """Return the output of a rational function whose input is held between samples."""
    system = cont2discrete(tf2ss(above, below), step_s, "zoh")
    return dlsim((*system[:4], step_s), u)[1][:, 0]


def motor_in_time(u, step_s):
    """State equations of winding and rotor."""
    return held([0.05], [3e-8, 1.2 * 3e-5 + 2e-7, 1.2 * 2e-4 + 0.05**2], u, step_s)


def drive_in_time(u, step_s):
    """State equations of two inertias."""
    return held([5e-3, 0.03, 400], [1e-5, 7e-3 * 0.03, 7e-3 * 400, 0, 0], u, step_s)


def car_in_time(u, step_s):
    """State equations of a quarter car."""
    m_s, m_u, k_s, c_s, k_t = 300.0, 40.0, 2e4, 1500.0, 1.8e5
    below = [m_s * m_u, (m_s + m_u) * c_s, m_s * k_t + (m_s + m_u) * k_s, c_s * k_t, k_s * k_t]
    return held([c_s * k_t, k_s * k_t], below, u, step_s)


def oven_in_time(u, step_s):
    """Sum the delayed responses to all steps of the input."""
    t, y = step_s * np.arange(u.size), np.zeros(u.size)
    jumps = np.diff(np.append(0.0, u))
    for j in np.flatnonzero(jumps):
        age = np.maximum(t - t[j] - 1.7, 0)
        y += jumps[j] * 2.5 * (1 - np.exp(-age / 12))
    return y


def cantilever_in_time(u, step_s):
    """Sum twelve modes of a clamped beam with a mass at its tip."""
    E, rhoA, eta, m = 2.05e11, 7850 * 4.8e-4, 3e-5, 0.7
    EI, mu = E * 4e-9, m / rhoA

    def characteristic(x):
        tip = np.cos(x) * np.tanh(x) - np.sin(x)
        return 1 / np.cosh(x) + np.cos(x) + mu * x * tip

    grid = np.linspace(0.1, 60, 60001)
    signs = characteristic(grid)
    y, z = np.zeros(u.size), np.linspace(0, 1, 20001)
    for i in np.flatnonzero(signs[:-1] * signs[1:] < 0)[:12]:
        x = brentq(characteristic, grid[i], grid[i + 1], xtol=1e-14)
        ratio = (np.cos(x) + np.cosh(x)) / (np.sin(x) + np.sinh(x))
        shape = np.cosh(x * z) - np.cos(x * z) - ratio * (np.sinh(x * z) - np.sin(x * z))
        mass = rhoA * np.trapezoid(shape**2, z) + m * shape[-1] ** 2
        square = x**4 * EI / rhoA
        y += held([shape[-1] ** 2 / mass], [1, eta * square, square], u, step_s)
    return y


def levels(count, source, clock):
    """Return a random binary input."""
    return np.repeat(source.integers(0, 2, count // clock + 1) * 2.0 - 1, clock)[:count]


def step(size, rest, count):
    """Return a step after some samples at rest."""
    return np.append(np.zeros(rest), np.full(count - rest, size))


def hit(size, width, count):
    """Return a pulse of half the width up, and half down."""
    return np.concatenate((np.zeros(20), np.full(width, size), np.full(width, -size), np.zeros(count)))


RECORDS = {
    "step of a motor": ("motor", 2e-4, lambda source: step(12.0, 20, 1500), motor_in_time, 0.01),
    "levels of a motor": ("motor", 1e-3, lambda source: 12 * levels(1500, source, 5), motor_in_time, 0.02),
    "hit of a drive": ("drive", 5e-4, lambda source: hit(10.0, 4, 1500), drive_in_time, 0.01),
    "uneven road": (
        "car",
        4e-3,
        lambda source: 0.01 * np.repeat(source.standard_normal(800), 2),
        car_in_time,
        0.02,
    ),
    "step of an oven": ("oven", 0.5, lambda source: step(1.0, 10, 200), oven_in_time, 0.01),
    "levels of an oven": ("oven", 0.5, lambda source: levels(400, source, 12), oven_in_time, 0.02),
    "hit of a cantilever": ("cantilever", 2e-3, lambda source: hit(50.0, 3, 570), cantilever_in_time, 0.01),
}
"""Machine, time between samples, input, simulation, and noise over the output's deviation."""


def response_of(machine, source, share=0.02, averages=None):
    """Return a response with noise; with averages, also with its coherence."""
    spaced = np.linspace if machine.band[1] < 1.1 * machine.band[0] else np.geomspace
    f = spaced(*machine.band)
    noise = source.standard_normal(f.size) + 1j * source.standard_normal(f.size)
    values = machine.response(2j * np.pi * f, machine.true | machine.known) * (1 + share / np.sqrt(2) * noise)
    if averages is None:
        return MeasuredResponse(machine.tf, f, values)
    coherence = np.full(f.size, 1 / (1 + share**2 * averages))
    return MeasuredResponse(machine.tf, f, values, coherence=coherence, averages=averages)


def record_of(name, source):
    """Return a record as a response on the lines that its input excites, with its samples."""
    machine, step_s, make, simulate, share = RECORDS[name]
    u = make(source)
    y = simulate(u, step_s)
    y = y + share * y.std() * source.standard_normal(y.size)
    f = np.fft.rfftfreq(u.size, step_s)[1:]
    above, below = (np.fft.rfft(np.diff(np.append(x, x[-1])))[1:] for x in (y, u))
    kept = (np.abs(below) > 1e-3 * np.abs(below).max()) & (f < 0.4 / step_s)
    values = above[kept] / below[kept]
    return MeasuredResponse(MACHINES[machine].tf, f[kept], values, samples=(Samples(step_s, y, u),))


def study(name, count, folder, averages=None):
    """Return errors over standard errors, whether intervals hold the true values, and how many are poor."""
    of_record = name in RECORDS
    machine = MACHINES[RECORDS[name][0] if of_record else name]
    path = folder / "machine.toml"
    path.write_text(machine.text(), encoding="utf-8")
    off, inside, poor, fitted = [], [], 0, None
    for seed in range(count):
        source = np.random.default_rng([seed, len(name), bool(averages)])
        measured = record_of(name, source) if of_record else response_of(machine, source, averages=averages)
        if fitted is None:
            fitted = pipeline.machine_of(path, [measured], tuple(machine.true), (machine.tf,))
        found = fit_parameters([measured], fitted)
        true = np.array(list(machine.true.values()))
        off += ((found.theta - true) / found.errors).tolist()
        inside += [low <= t <= high for t, (low, high) in zip(true, found.intervals(), strict=True)]
        poor += bool(found.poor)
    return np.array(off), np.array(inside), poor

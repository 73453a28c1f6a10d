"""Loops of every kind, and the verdict of every command on them, against eigenvalues of polynomials by hand.

Each loop is written twice: as a specification, and as the denominator and numerator of its transfer function
before anything cancels. numpy's roots of both tell how many poles lie in the right half-plane, how many of
those on it are controllable and observable, and how many are hidden.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

import symflex
from symflex import pipeline
from symflex.loops import closed_loop_roots, nominal_gain
from symflex.loops.of_model import stability
from symflex.options import StabilityOptions
from symflex.report.document import Badge
from symflex.report.sections.roots import loop_section, root_section
from symflex.report.study import Study
from symflex.sweep.labelled import sweep_json

if TYPE_CHECKING:
    from collections.abc import Iterator

s = np.poly1d([1, 0])
ON_AXIS, EQUAL = 1e-6, 1e-4
"""Of a double root off 0, which numpy finds to half its digits, and of roots that cancel."""


@dataclass(frozen=True)
class Case:
    text: str
    gain: float
    sides: tuple  # denominator and numerator


LOOPS: dict[str, Case] = {}


def loop(name, sides, K, parameters, inputs, outputs, elements="", more=""):
    """Note a loop: ``sides`` are denominator and numerator by the gain, the rest a specification."""
    gain = f'"{K}"' if isinstance(K, str) else f'{{ value = "{K[0]}", assume = "real" }}'
    text = f"""symflex = 1
parameters = {{ K = {gain}, {parameters} }}
inputs = {{ {inputs} }}
outputs = {{ {outputs} }}
{more}
[elements]
{elements}
[figures.locus]
kind = "locus"
gain = "K"
"""
    number = float((K if isinstance(K, str) else K[0]).split()[0])
    LOOPS[name] = Case(text, number, sides(number))


def torque(name, sides, K, tau, outputs='W = "s*phi"', shaft="one", more=""):
    """Note a loop that acts on the first of one or two inertias by a torque ``tau``."""
    is_speed = "w" in tau
    unit = "N*m*s/rad" if is_speed else "N*m/rad"
    elements = {"one": ONE, "rubbed": ONE + RUBBED, "two": ONE + TWO, "undamped": ONE + UNDAMPED}[shaft]
    elements += f't = {{ type = "torque_source", at = "phi", tau = "{tau}" }}\n{more}'
    parameters = 'J = "2 kg*m^2", k = "40 N*m/rad", d = "0.3 N*m*s/rad", T = "0.5 s", T_i = "4 s"'
    inputs = 'w = { unit = "rad/s" }' if is_speed else 'r = { unit = "rad" }'
    loop(name, sides, f"{K} {unit}", parameters, inputs, outputs, elements)


ONE = 'j = { type = "inertia", at = "phi", J = "J" }\n'
RUBBED = 'f = { type = "rotary_damper", between = ["phi", "ground"], b = "d" }\n'
UNDAMPED = """j_2 = { type = "inertia", at = "psi", J = "J" }
k = { type = "torsion_spring", between = ["phi", "psi"], k = "k" }
"""
TWO = UNDAMPED + 'd = { type = "rotary_damper", between = ["phi", "psi"], b = "d" }\n'
J, LINK = 2 * s**2, np.poly1d([0.3, 40])
PAIR, UNDAMPED_PAIR = (J + LINK) ** 2 - LINK**2, (J + 40) ** 2 - 1600
PHI, PSI, SPEED, POSITION = 'PHI = "phi"', 'PSI = "psi"', "K*(w - s*phi)", "K*(r - phi)"

torque("speed", lambda K: (s * (2 * s + K), K * s), 3, SPEED)
torque("speed to angle", lambda K: (s * (2 * s + K), [K]), 3, SPEED, PHI)
torque("speed of the wrong sign", lambda K: (s * (2 * s - K), -K * s), 3, "K*(s*phi - w)")
torque("speed with friction", lambda K: (s * (2 * s + 0.3 + K), K * s), 3, SPEED, shaft="rubbed")
torque(
    "PI of speed", lambda K: (s * (J + K * s + 2 * K), s * (K * s + 2 * K)), 3, "K*(1 + 1/(T*s))*(w - s*phi)"
)
torque("I of speed", lambda K: (s * (J + 2 * K), 2 * K * s), 3, "K/(T*s)*(w - s*phi)")
torque("speed of two", lambda K: (PAIR + K * s * (J + LINK), K * s * (J + LINK)), 3, SPEED, shaft="two")
for size in (0.1, 3):
    torque(
        f"speed of the other, {size}",
        lambda K: (PAIR + K * s * LINK, K * s * LINK),
        size,
        "K*(w - s*psi)",
        'W = "s*psi"',
        "two",
    )
torque(
    "speed of two undamped",
    lambda K: (UNDAMPED_PAIR + K * s * (J + 40), K * s * (J + 40)),
    3,
    SPEED,
    shaft="undamped",
)
torque(
    "speed, pushing off the other",
    lambda K: (UNDAMPED_PAIR + K * s * J, K * s * J),
    3,
    SPEED,
    shaft="undamped",
    more='t_2 = { type = "torque_source", at = "psi", tau = "-K*(w - s*phi)" }\n',
)
torque("position", lambda K: (J + K, [K]), 3, POSITION, PHI)
PD = "K*(r - phi) - K*T*s*phi"
torque("PD", lambda K: (J + 0.5 * K * s + K, [K]), 3, PD, PHI)
torque("PD seen as a speed", lambda K: (J + 0.5 * K * s + K, K * s), 3, PD)
torque("PI of position", lambda K: (J * s + K * s + 2 * K, [K, 2 * K]), 3, "K*(1 + 1/(T*s))*(r - phi)", PHI)
for size in (0.1, 3):
    torque(
        f"PID, {size}",
        lambda K: (J * s + K * (0.5 * s**2 + s + 0.25), K * np.array([0.5, 1, 0.25])),
        size,
        "K*(1 + T*s + 1/(T_i*s))*(r - phi)",
        PHI,
    )
torque("position of two", lambda K: (PAIR + K * (J + LINK), K * (J + LINK)), 3, POSITION, PHI, "two")
torque("position of the other", lambda K: (PAIR + K * LINK, K * LINK), 3, "K*(r - psi)", PSI, "two")


def motor(name, sides, K, voltage, inputs, outputs):
    """Note a loop that acts on a motor by its voltage; ``Z`` is its winding's impedance."""
    elements = ONE + (
        'm = { type = "dc_motor", terminals = ["v", "ground"], shaft = "phi", R = "R", L = "L", '
        'k_t = "k_t" }\n'
        f'u = {{ type = "voltage_source", between = ["v", "ground"], v = "{voltage}" }}\n'
    )
    parameters = 'R = "2 Ohm", L = "0.1 H", k_t = "0.5 N*m/A", J = "2 kg*m^2", T = "1 s"'
    loop(name, sides, K, parameters, inputs, outputs, elements)


Z = np.poly1d([0.1, 2])
MOTOR = 2 * s**2 * Z + 0.25 * s
W, R, I_R = ('w = { unit = "rad/s" }', 'r = { unit = "rad" }', 'i_r = { unit = "A" }')
motor("motor's speed", lambda K: (MOTOR + K * s / 2, K * s / 2), "3 V*s/rad", SPEED, W, 'W = "s*phi"')
motor(
    "PI of a motor's speed",
    lambda K: (s * MOTOR + K * (s + 1) * s / 2, K * (s + 1) * s / 2),
    "3 V*s/rad",
    "K*(1 + 1/(T*s))*(w - s*phi)",
    W,
    'W = "s*phi"',
)
motor(
    "I of a motor's speed",
    lambda K: (s * MOTOR + K * s / 2, K * s / 2),
    "30 V*s/rad",
    "K/(T*s)*(w - s*phi)",
    W,
    'W = "s*phi"',
)
for size in (3, 300):
    motor(f"motor's position, {size}", lambda K: (MOTOR + K / 2, [K / 2]), f"{size} V/rad", POSITION, R, PHI)
CURRENT = "K*(i_r - m.i)"
motor("current", lambda K: (MOTOR + K * J, K * J), "3 V/A", CURRENT, I_R, 'I = "m.i"')
motor("current to angle", lambda K: (MOTOR + K * J, [K / 2]), "3 V/A", CURRENT, I_R, PHI)
motor(
    "PI of current",
    lambda K: (s * MOTOR + K * (s + 1) * J, K * (s + 1) * J),
    "3 V/A",
    "K*(1 + 1/(T*s))*(i_r - m.i)",
    I_R,
    'I = "m.i"',
)


def circuit(name, sides, first):
    elements = first + (
        'l = { type = "inductor", between = ["a", "ground"], L = "L" }\n'
        'u = { type = "voltage_source", between = ["v", "ground"], v = "K*(i_r - l.i)" }\n'
    )
    loop(name, sides, "3 V/A", 'R = "2 Ohm", C = "2 F", L = "0.1 H"', I_R, 'I = "l.i"', elements)


circuit(
    "current in a coil", lambda K: (Z + K, [K]), 'r = { type = "resistor", between = ["v", "a"], R = "R" }\n'
)
circuit(
    "current through a capacitor",
    lambda K: (2 * s * (0.1 * s + K) + 1, 2 * s * K),
    'c = { type = "capacitor", between = ["v", "a"], C = "C" }\n',
)


def block(name, sides, K, signals, outputs='Y = "y"', blocks=""):
    more = f"signals = {{ {signals} }}\n" + (f"blocks = {{ {blocks} }}" if blocks else "")
    loop(name, sides, f"{K}", 'T = "1 s", K_v = 4', "r = {}", outputs, "", more)


block("integrator", lambda K: (s + K, [K]), 3, 'y = "K*(r - y)/(T*s)"')
block("double integrator", lambda K: (s**2 + K, [K]), 3, 'y = "K*(r - y)/(T*s)^2"')
block("triple integrator", lambda K: (s**3 + K, [K]), 3, 'y = "K*(r - y)/(T*s)^3"')
for size in (3, 8, 9):  # Routh: 8 is the boundary
    block(f"three lags, {size}", lambda K: ((s + 1) ** 3 + K, [K]), size, 'y = "K*(r - y)/(1 + T*s)^3"')
for size in (0.5, 1, 3):
    block(f"unstable plant, {size}", lambda K: (s - 1 + K, [K]), size, 'y = "K*(r - y)/(T*s - 1)"')
for size in (0.5, 2):
    block(f"positive feedback, {size}", lambda K: (s + 1 - K, [K]), size, 'y = "K*(r + y)/(1 + T*s)"')
for name, hidden, power in [
    ("T*s", s, 1),
    ("T*s", s, 3),
    ("(T*s)^2", s**2, 2),
    ("T*s - 1", s - 1, 1),
    ("T*s + 2", s + 2, 1),
    ("T^2*s^2 + 1", s**2 + 1, 2),
    ("T*s*(T^2*s^2 + 1)", s * (s**2 + 1), 3),
]:
    for size in (3, 9):
        block(
            f"{name} hidden, {power}, {size}",
            lambda K, h=hidden, n=power: (h * ((s + 1) ** n + K), K * h),
            size,
            f'u = "({name})/(1 + T*s)^{power}*K*(r - y)", y = "u/({name})"',
        )
BEHIND = 'y = "K*(r - y)/(1 + T*s)", z = "y/({})"'
block("integrator before", lambda K: (s * (s + 1 + K), [K]), 3, 'a = "r/(T*s)", y = "K*(a - y)/(1 + T*s)"')
block(
    "unstable before",
    lambda K: ((s - 1) * (s + 1 + K), [K]),
    3,
    'a = "r/(T*s - 1)", y = "K*(a - y)/(1 + T*s)"',
)
block("integrator behind", lambda K: (s * (s + 1 + K), [K]), 3, BEHIND.format("T*s"), 'Z = "z"')
block("integrator nobody reads", lambda K: (s * (s + 1 + K), K * s), 3, BEHIND.format("T*s"))
block(
    "double pair behind",
    lambda K: ((s**2 + 1) ** 2 * (s + 1 + K), [K]),
    3,
    BEHIND.format("(1 + T^2*s^2)^2"),
    'Z = "z"',
)
block("oscillator", lambda K: (s**2 + 1 + K, [K]), 3, 'y = "K*(r - y)/(1 + T^2*s^2)"')
block(
    "cascade",
    lambda K: (s * (s + 4) + 4 * K, [4 * K]),
    3,
    'a = "K*(r - x)", v = "K_v*(a - v)/(T*s)", x = "v/(T*s)"',
    'X = "x"',
)
block(
    "inner loop of a cascade",
    lambda K: (s * (s + K), K * s),
    3,
    'v = "K*(r - v)/(T*s)", x = "v/(T*s)"',
    'V = "v"',
)
block(
    "cascade with PI",
    lambda K: (s**3 + 4 * (s + 1) * (s + K), 4 * K * (s + 1)),
    3,
    'a = "K*(r - x)", u = "K_v*(1 + 1/(T*s))*(a - v)", v = "u/(T*s)", x = "v/(T*s)"',
    'X = "x"',
)
block(
    "lag of a block",
    lambda K: (s * (s + 1) + K, [K]),
    3,
    'y = "K*H*(r - y)/(T*s)"',
    blocks='H = { type = "lag", T = "T" }',
)


def force(name, sides, K, f, inputs, outputs, more=""):
    elements = 'm = { type = "mass", at = "x", m = "m" }\n'
    elements += f'f = {{ type = "force_source", at = "x", f = "{f}" }}\n{more}'
    loop(name, sides, K, 'm = "1 kg", k = "9 N/m"', inputs, outputs, elements)


OTHER = 'm_2 = { type = "mass", at = "z", m = "m" }\n'
TIED = 'k_1 = { type = "spring", between = ["NODE", "ground"], k = "k" }\n'
VELOCITY = ("2 N*s/m", "K*(w - s*x)", 'w = { unit = "m/s" }', 'V = "s*x"')
force("velocity", lambda K: (s * (s + K), K * s), *VELOCITY)
force("velocity beside a free mass", lambda K: (s**3 * (s + K), K * s**3), *VELOCITY, OTHER)
force(
    "velocity beside an oscillator",
    lambda K: (s * (s**2 + 9) * (s + K), K * s * (s**2 + 9)),
    *VELOCITY,
    OTHER + TIED.replace("NODE", "z"),
)
force(
    "acceleration",
    lambda K: (s**2 * (1 + K), K * s**2),
    "2 kg",
    "K*(a - s^2*x)",
    'a = { unit = "m/s^2" }',
    'A = "s^2*x"',
)
for size in (2, -2):
    force(
        f"rate feedback, {size}",
        lambda K: (s**2 + K * s + 9, [1]),
        (f"{size} N*s/m",),
        "F - K*s*x",
        'F = { unit = "N" }',
        'X = "x"',
        TIED.replace("NODE", "x"),
    )


def expected(case: Case) -> tuple[str, bool]:
    """Return the word, and whether some hidden pole is not in the open left half-plane."""
    poles, hidden = list(np.roots(np.poly1d(case.sides[0]).c)), []
    for zero in np.roots(np.poly1d(case.sides[1]).c):
        near = min(range(len(poles)), key=lambda i: abs(poles[i] - zero), default=None)
        if near is not None and abs(poles[near] - zero) < EQUAL:
            hidden.append(poles.pop(near))
    if any(p.real > ON_AXIS for p in [*poles, *hidden]):
        word = "unstable"
    else:
        word = "marginal" if any(abs(p.real) <= ON_AXIS for p in poles) else "stable"
    return word, any(p.real >= -ON_AXIS for p in hidden)


def badges(part: object) -> Iterator[str]:
    """Yield the texts of all badges in a part of a report."""
    if isinstance(part, Badge):
        yield part.text
    elif isinstance(part, tuple):
        for each in part:
            yield from badges(each)
    elif hasattr(part, "__dataclass_fields__"):
        for name in part.__dataclass_fields__:
            yield from badges(getattr(part, name))


def proved(study: Study) -> dict[str, tuple[str, bool]]:
    """Return the words that roots, stable gains and root loci have, and whether they name hidden motion."""
    closed = study.loop("K")
    verdicts = {
        "roots": study.maps[0].verdict,
        "stability": stability(study.model, StabilityOptions("K")).verdict,
        "locus": closed_loop_roots(closed, nominal_gain(closed)).verdict,
    }
    return {name: (verdict.word, bool(verdict.hidden_motion)) for name, verdict in verdicts.items()}


def said(case: Case) -> dict[str, tuple[str, bool]]:
    """Return what the commands, the report and Python say, each with whether they name hidden motion."""
    study = Study(Path("loop.toml"), "loop", case.text, pipeline.loads(case.text))
    words = proved(study)
    words["report, loops"] = next(badges(loop_section(study))), "hidden" in str(loop_section(study).blocks)
    words["report, roots"] = next(badges(root_section(study))), words["roots"][1]
    model = symflex.loads(case.text)
    for of in ("poles", "margins"):
        summary = sweep_json(model.sweep({"K": [case.gain]}, of=of, gain="K" if of == "margins" else ""))
        (word,) = (word for word, count in summary["stability"].items() if count)
        words[f"sweep of {of}"] = word, summary["hidden_motion_points"] == 1
    is_stable = model.stability("K").is_stable
    if is_stable is not (words["roots"][0] == "stable"):
        words["Python"] = str(is_stable), False
    return words


def check(names):
    wrong = []
    for name in names:
        wanted = expected(LOOPS[name])
        wrong += [(name, who, word) for who, word in said(LOOPS[name]).items() if word != wanted]
    assert not wrong


def test_the_loops_are_of_every_kind():
    kinds = [expected(case) for case in LOOPS.values()]
    assert len(kinds) >= 60
    assert {(w, h) for w in ("stable", "marginal", "unstable") for h in (False, True)} <= {
        *kinds,
        ("marginal", True),
    }


def test_a_speed_loop_hides_its_shafts_angle_from_all():
    check(["speed"])


@pytest.mark.slow
def test_all_commands_the_report_and_python_say_the_same_word():
    check(LOOPS)


DELAY = """symflex = 1
parameters = { K = "GAIN 1/s", T = "1 s" }
blocks = { D = { type = "delay", T = "T" } }
inputs = { r = {} }
outputs = { Y = "y" }
signals = { SIGNALS }
"""
ROD = """symflex = 1
parameters = { K = "2 N*s/m", T = "1 s" }
inputs = { v = { unit = "m/s" } }
outputs = { V = "OUTPUT" }
[elements]
rod = { type = "rod", between = ["x", "END"], E = "2 Pa", A = "1 m^2", rho = "1 kg/m^3", l = "1 m" }
drive = { type = "force_source", at = "x", f = "FORCE" }
"""
RATE = ROD.replace("FORCE", "K*(v - s*x)")
ENDLESS = [
    # s e^s + K is stable for K < pi/2; the damper K at an end of a rod of impedance sqrt(2) stops all waves.
    (DELAY.replace("GAIN", "1").replace("SIGNALS", 'y = "K*D/s*(r - y)"'), "stable", False),
    (DELAY.replace("GAIN", "1").replace("SIGNALS", 'y = "K*D/s*(r - y)", z = "y/(T*s)"'), "stable", True),
    (RATE.replace("END", "z").replace("OUTPUT", "s*x"), "stable", True),
    (RATE.replace("END", "z").replace("OUTPUT", "x"), "marginal", False),
    (RATE.replace("END", "ground").replace("OUTPUT", "s*x"), "stable", False),
    # Without damping a spring leaves all poles on the axis.
    (ROD.replace("FORCE", "K*(v - x/T)").replace("OUTPUT", "x").replace("END", "z"), "marginal", False),
]


@pytest.mark.slow
def test_loops_of_infinitely_many_poles_have_one_word_too():
    for text, word, is_hidden in ENDLESS:
        found = proved(Study(Path("loop.toml"), "loop", text, pipeline.loads(text)))
        assert set(found.values()) == {(word, is_hidden)}, (text, found)

"""Working models around every element and block, in which each of their keys may be 0.

Input: the kind of an element or block, and one of its keys.
Output: the text of a model with a letter for the key, and of the model without what vanishes with it.

Example: of a spring whose stiffness is 0 the model without the spring; of a rod the one without the key.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from symflex.library import ParameterPort
from symflex.library.blocks import BLOCKS
from symflex.library.elements import ELEMENTS, LineElement

LETTER = "zz"


@dataclass(frozen=True)
class Around:
    """An element or block with its keys, and the model it stands in."""

    keys: dict[str, str]  # as they are written, the places of an element included
    rest: str  # elements, or signals
    inputs: str
    outputs: str


@dataclass(frozen=True)
class Zero:
    """A key at 0."""

    kind: str
    number: int  # of the model around it
    key: str
    letter: str  # the text with a letter, whose declared value is ``@``
    without: str  # the text without it
    one: str  # a value of the letter that is not 0, with its unit
    zero: str

    def __str__(self) -> str:
        return f"{self.kind} {self.number}: {self.key}"


FORCE = 'F = { force = "x" }', 'X = "x"'
TORQUE = 'F = { torque = "x" }', 'X = "x"'
CURRENT = 'F = { current = "x" }', 'X = "x"\nZ = "y"'
BOTH = 'F = { force = "x" }', 'X = "x"\nA = "x.theta"'

MASS = 'm = { type = "mass", at = "x", m = "0.3 kg" }\n'
HELD = (
    MASS
    + 's = { type = "spring", between = ["x", "ground"], k = "2 N/m" }\n'
    + 'd = { type = "damper", between = ["x", "ground"], b = "0.1 N*s/m" }\n'
)
SECOND = (
    'm2 = { type = "mass", at = "y", m = "0.2 kg" }\n'
    's2 = { type = "spring", between = ["y", "ground"], k = "3 N/m" }\n'
    'd2 = { type = "damper", between = ["x", "y"], b = "0.05 N*s/m" }\n'
)


def turning(text: str) -> str:
    """Return the same model in rotation."""
    for old, new in (
        ('"mass"', '"inertia"'),
        (" m = ", " J = "),
        (" kg", " kg*m^2"),
        ('"spring"', '"torsion_spring"'),
        (" N/m", " N*m/rad"),
        ('"damper"', '"rotary_damper"'),
        (" N*s/m", " N*m*s/rad"),
    ):
        text = text.replace(old, new)
    return text


TURNING = turning(HELD) + turning(SECOND)
THIRD = 'jz = { type = "inertia", at = "w", J = "0.1 kg*m^2" }\n'
TIP = 'tip = { type = "rigid_body", at = "x", m = "0.3 kg", J = "0.02 kg*m^2" }\n'
ARM = 'arm = { type = "massless_beam", between = ["ground", "x"], EI = "1 N*m^2", l = "1 m" }\n'
FAR = 'far = { type = "rigid_body", at = "y", m = "0.3 kg", J = "0.02 kg*m^2" }\n'
CIRCUIT = (
    'src = { type = "resistor", between = ["x", "ground"], R = "5 Ohm" }\n'
    'c1 = { type = "capacitor", between = ["x", "ground"], C = "0.1 F" }\n'
    'r2 = { type = "resistor", between = ["y", "ground"], R = "3 Ohm" }\n'
    'c2 = { type = "capacitor", between = ["y", "ground"], C = "0.2 F" }\n'
    'l2 = { type = "inductor", between = ["x", "y"], L = "0.3 H" }\n'
)
PLAIN = CIRCUIT.replace('"inductor"', '"resistor"').replace('L = "0.3 H"', 'R = "2 Ohm"')
DRIVEN = 'rz = { type = "resistor", between = ["z", "y"], R = "1 Ohm" }\n'
SENSED = 'rw = { type = "resistor", between = ["w", "ground"], R = "1 Ohm" }\n'
SUPPLY = (
    'c1 = { type = "capacitor", between = ["v", "ground"], C = "0.1 F" }\n'
    'r1 = { type = "resistor", between = ["v", "ground"], R = "10 Ohm" }\n'
)
FEEDBACK = (
    'r1 = { type = "resistor", between = ["x", "n"], R = "1 Ohm" }\n'
    'r2 = { type = "resistor", between = ["n", "y"], R = "3 Ohm" }\n'
    'c2 = { type = "capacitor", between = ["n", "y"], C = "0.1 F" }\n'
    'cs = { type = "capacitor", between = ["x", "ground"], C = "0.3 F" }\n'
)
ACOUSTIC = (
    'r1 = { type = "acoustic_resistance", between = ["x", "ground"], R = "3 Pa*s/m^3" }\n'
    'c1 = { type = "acoustic_compliance", at = "x", C = "0.2 m^3/Pa" }\n'
    'c2 = { type = "acoustic_compliance", at = "y", C = "0.3 m^3/Pa" }\n'
    'r2 = { type = "acoustic_resistance", between = ["x", "y"], R = "5 Pa*s/m^3" }\n'
)
THERMAL = (
    'r1 = { type = "thermal_resistance", between = ["x", "ground"], R = "3 K/W" }\n'
    'c1 = { type = "thermal_capacity", at = "x", C = "0.2 J/K" }\n'
    'c2 = { type = "thermal_capacity", at = "y", C = "0.3 J/K" }\n'
    'r2 = { type = "thermal_resistance", between = ["x", "y"], R = "5 K/W" }\n'
)
ENDS = {"between": '["x", "y"]'}
HOUSED = {"between": '["ground", "x"]'}
LOOSE = {"between": '["y", "x"]'}
UNIFORM = {"EI": '"1 N*m^2"', "rhoA": '"1 kg/m"', "l": '"1 m"'}
ROD = {"EA": '"1 N"', "rhoA": '"1 kg/m"', "l": '"1 m"'}
DAMPED = {"eta": '"0.002 s"'}
THICK = {"theory": '"rayleigh"', "rhoI": '"0.001 kg*m"'}
SOFT = {"theory": '"timoshenko"', "rhoI": '"0.001 kg*m"', "kappaGA": '"500 N"'}
SHAFT = {"GJ": '"1 N*m^2"', "rhoJ": '"1 kg*m"', "l": '"1 m"'}
MOTOR = {"terminals": '["v", "ground"]', "L": '"0.01 H"', "R": '"1 Ohm"'}
SEEN = 'F = { current = "v" }', 'X = "x"\nV = "v"'
SENSING = {"inputs": '["x", "ground"]'}
SUPPLYING = {"terminals": '["z", "ground"]'}

AROUND: dict[str, tuple[Around, ...]] = {
    "mass": (Around({"at": '"x"', "m": '"0.7 kg"'}, HELD, *FORCE),),
    "spring": (Around({**ENDS, "k": '"1 N/m"'}, HELD + SECOND, *FORCE),),
    "damper": (Around({**ENDS, "b": '"1 N*s/m"'}, HELD + SECOND, *FORCE),),
    "inertia": (Around({"at": '"x"', "J": '"0.7 kg*m^2"'}, TURNING, *TORQUE),),
    "torsion_spring": (Around({**ENDS, "k": '"1 N*m/rad"'}, TURNING, *TORQUE),),
    "rotary_damper": (Around({**ENDS, "b": '"1 N*m*s/rad"'}, TURNING, *TORQUE),),
    "rigid_body": (
        Around({"at": '"x"', "m": '"0.3 kg"', "J": '"0.02 kg*m^2"', "cg": '"0.1 m"'}, ARM, *BOTH),
    ),
    "rigid_link": (
        Around(
            {**ENDS, "length": '"0.2 m"', "angle": '"10 deg"'},
            ARM + FAR,
            'F = { force = "y" }',
            'X = "y"\nA = "y.theta"',
        ),
    ),
    "massless_beam": (Around({**HOUSED, "EI": '"1 N*m^2"', "l": '"1 m"'}, TIP, *BOTH),),
    "beam": (
        Around({**HOUSED, **UNIFORM, **DAMPED}, TIP, *FORCE),
        Around({**HOUSED, **UNIFORM}, TIP, *BOTH),
        Around({**LOOSE, **UNIFORM}, TIP, *FORCE),
        Around({**HOUSED, **UNIFORM, **THICK}, TIP, *FORCE),
        Around({**HOUSED, **UNIFORM, **SOFT}, TIP, *FORCE),
    ),
    "frame": (
        Around(
            {**HOUSED, **UNIFORM, **DAMPED, "EA": '"100 N"', "angle": '"30 deg"'},
            TIP,
            'F = { force = "x.y" }',
            'X = "x.y"',
        ),
    ),
    "rod": (
        Around({**HOUSED, **ROD, **DAMPED}, MASS, *FORCE),
        Around({**HOUSED, **ROD}, MASS, *FORCE),
        Around({**LOOSE, **ROD}, MASS, *FORCE),
    ),
    "shaft": (Around({**HOUSED, **SHAFT, **DAMPED}, turning(MASS), *TORQUE),),
    "string": (Around({**HOUSED, "N": '"1 N"', "rhoA": '"1 kg/m"', "l": '"1 m"'}, HELD, *FORCE),),
    "resistor": (Around({**ENDS, "R": '"1 Ohm"'}, CIRCUIT, *CURRENT),),
    "inductor": (Around({**ENDS, "L": '"1 H"'}, PLAIN, *CURRENT),),
    "capacitor": (Around({**ENDS, "C": '"1 F"'}, CIRCUIT, *CURRENT),),
    "dc_motor": (
        Around(
            {**MOTOR, "shaft": '"x"', "k_t": '"0.5 N*m/A"', "k_e": '"0.4 V*s/rad"'},
            turning(HELD) + SUPPLY,
            *SEEN,
        ),
    ),
    "voice_coil": (
        Around({**MOTOR, "mover": '"x"', "k_f": '"0.5 N/A"', "k_e": '"0.4 V*s/m"'}, HELD + SUPPLY, *SEEN),
    ),
    "piezo": (
        Around(
            {"terminals": '["v", "ground"]', **HOUSED, "alpha": '"0.5 N/V"', "C": '"0.1 F"', "k": '"1 N/m"'},
            HELD + SUPPLY,
            *SEEN,
        ),
    ),
    "transformer": (Around({"from": '"x"', "to": '"y"', "ratio": "0.5"}, HELD + SECOND, *FORCE),),
    "gyrator": (Around({"from": '"x"', "to": '"y"', "ratio": '"0.5 N*s/m"'}, HELD + SECOND, *FORCE),),
    "planetary_gear": (
        Around({"sun": '"x"', "ring": '"y"', "carrier": '"w"', "rho": "2"}, TURNING + THIRD, *TORQUE),
    ),
    "coupled_inductors": (
        Around(
            {
                "terminals": '["x", "ground", "y", "ground"]',
                "L_1": '"0.1 H"',
                "L_2": '"0.2 H"',
                "M": '"0.05 H"',
            },
            PLAIN,
            *CURRENT,
        ),
    ),
    "op_amp": (
        Around(
            {"inputs": '["ground", "n"]', "out": '"y"', "A": "1000", "f_u": '"100 Hz"'}, FEEDBACK, *CURRENT
        ),
    ),
    "vcvs": (Around({**SENSING, **SUPPLYING, "mu": "2"}, CIRCUIT + DRIVEN, *CURRENT),),
    "vccs": (Around({**SENSING, "terminals": '["y", "ground"]', "g": '"0.5 A/V"'}, CIRCUIT, *CURRENT),),
    "ccvs": (
        Around({"inputs": '["x", "w"]', **SUPPLYING, "r": '"0.5 Ohm"'}, CIRCUIT + DRIVEN + SENSED, *CURRENT),
    ),
    "cccs": (
        Around(
            {"inputs": '["x", "w"]', "terminals": '["y", "ground"]', "beta": "0.5"},
            CIRCUIT + SENSED,
            *CURRENT,
        ),
    ),
    "acoustic_mass": (Around({**ENDS, "M": '"0.5 kg/m^4"'}, ACOUSTIC, 'F = { flow = "x" }', CURRENT[1]),),
    "acoustic_resistance": (
        Around({**ENDS, "R": '"0.5 Pa*s/m^3"'}, ACOUSTIC, 'F = { flow = "x" }', CURRENT[1]),
    ),
    "acoustic_compliance": (
        Around({"at": '"x"', "C": '"0.5 m^3/Pa"'}, ACOUSTIC, 'F = { flow = "x" }', CURRENT[1]),
    ),
    "thermal_resistance": (Around({**ENDS, "R": '"0.5 K/W"'}, THERMAL, 'F = { heat = "x" }', CURRENT[1]),),
    "thermal_capacity": (Around({"at": '"x"', "C": '"0.5 J/K"'}, THERMAL, 'F = { heat = "x" }', CURRENT[1]),),
    "piston": (
        Around(
            {"mover": '"x"', "chamber": '"y"', "A": '"0.2 m^2"'},
            HELD
            + 'c2 = { type = "acoustic_compliance", at = "y", C = "0.3 m^3/Pa" }\n'
            + 'r2 = { type = "acoustic_resistance", between = ["y", "ground"], R = "5 Pa*s/m^3" }\n',
            *FORCE,
        ),
    ),
}
LOOP = 'Y = "G*(F - Y)/(2*s^2 + 0.5*s + 3)"'
BLOCKS_AROUND: dict[str, dict[str, str]] = {
    "resonance": {"omega_p": "3", "zeta_p": "0.1", "omega_z": "2", "zeta_z": "0.2"},
    "notch": {"omega": "3", "zeta_p": "0.4", "zeta_z": "0.1"},
    "low_pass": {"k": "2", "omega": "3", "zeta": "0.4"},
    "tf": {"num": "[1, 2]", "den": "[1, 3, 2]"},
    "ss": {"A": "[[0, 1], [-2, -3]]", "B": "[0, 1]", "C": "[1, 0]", "D": "0.5"},
    "integrator": {"k": "2"},
    "lead_lag": {"k": "2", "T_1": "0.3", "T_2": "0.1"},
    "lag": {"k": "2", "T": "0.1"},
    "pid": {"k_p": "2", "k_i": "0.5", "k_d": "0.3", "T_f": "0.01"},
    "delay": {"T": "0.1"},
}
GONE = (
    *(("mass", "m"), ("spring", "k"), ("damper", "b"), ("capacitor", "C"), ("vccs", "g")),
    *(("inertia", "J"), ("torsion_spring", "k"), ("rotary_damper", "b")),
    *(("acoustic_compliance", "C"), ("thermal_capacity", "C")),
)
"""Keys whose element does nothing at 0."""
REFUSED = (("resonance", "omega_z"),)  # which divide, so that no model is left
SOURCES = ("force_source", "torque_source", "current_source", "voltage_source", "pressure_source")
SOURCES = (*SOURCES, "flow_source", "heat_source", "temperature_source")
"""Elements whose only key is what they supply: at 0 nothing acts, and there is nothing to compare."""


def may_be_zero(kind: str, port: ParameterPort) -> bool:
    """Tell whether a key may be 0: no stiffness along x and no length may, and no matrix is a number."""
    element = ELEMENTS.get(kind)
    is_length = isinstance(element, LineElement) and port.name == element.length
    is_length |= (kind, port.name) == ("massless_beam", "l")
    is_matrix = kind in ("tf", "ss") and port.name != "D"
    return not (port.sign == "positive" or is_length or is_matrix or (kind, port.name) in REFUSED)


def zeros() -> Iterator[Zero]:
    """Yield every key of every element and block at 0."""
    for kind, models in AROUND.items():
        for number, around in enumerate(models):
            yield from _of_element(kind, number, around)
    for kind, keys in BLOCKS_AROUND.items():
        for port in BLOCKS[kind].parameters:
            if may_be_zero(kind, port):
                with_letter = {**keys, port.name: f'"{LETTER}"'}
                left = {k: v for k, v in keys.items() if k != port.name}
                without = left if port.default == "0" else {**left, port.name: "0"}
                texts = (_block_model(kind, k) for k in (with_letter, without))
                yield Zero(kind, 0, port.name, *texts, keys[port.name], "0")


def _of_element(kind: str, number: int, around: Around) -> Iterator[Zero]:
    element, keys = ELEMENTS[kind], around.keys
    words = [v.strip('"') for v in keys.values()]
    words += [c.default for c in element.choices if c.name not in keys]
    for port in element.parameters:
        is_given = port.default is not None or port.name in keys
        if not (is_given and port.applies(words) and may_be_zero(kind, port)):
            continue
        unit = port.unit or keys[port.name].strip('"').partition(" ")[2] or "1"
        zero, one = (f"{n} {unit}" if unit != "1" else str(n) for n in (0, 1))
        if port.is_direction:
            one = "1 rad"
        left = {k: v for k, v in keys.items() if k != port.name}
        if port.default not in (None, "0") or (port.default is None and (kind, port.name) not in GONE):
            without = _element_model(kind, {**left, port.name: f'"{zero}"'}, around)
        else:
            without = _element_model("" if (kind, port.name) in GONE else kind, left, around)
        letter = _element_model(kind, {**left, port.name: f'"{LETTER}"'}, around)
        yield Zero(kind, number, port.name, letter, without, one, zero)


def _element_model(kind: str, keys: dict[str, str], around: Around) -> str:
    values = ", ".join(f"{k} = {v}" for k, v in keys.items())
    part = f'part = {{ type = "{kind}", {values} }}\n' if kind else ""
    ends = f"[inputs]\n{around.inputs}\n[outputs]\n{around.outputs}\n"
    return f"symflex = 1\n@{ends}[elements]\n{part}{around.rest}"


def _block_model(kind: str, keys: dict[str, str]) -> str:
    values = "".join(f", {k} = {v}" for k, v in keys.items())
    return (
        f'symflex = 1\n@[inputs]\nF = {{}}\n[blocks]\nG = {{ type = "{kind}"{values} }}\n'
        f'[signals]\n{LOOP}\n[outputs]\nX = "Y"\n'
    )

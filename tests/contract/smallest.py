"""The smallest model in which every element and block of the registries does something."""

from __future__ import annotations

HEADER = "symflex = 1\n"

LINE = 'rho = "q", A = "q", l = "q"'

WINDINGS = 'L_1 = "p", L_2 = "q", M = 1'

MODELS = {
    "mass": ("x", "force", 'at = "x", m = "p"'),
    "inertia": ("x", "torque", 'at = "x", J = "p"'),
    "spring": ("x", "force", 'between = ["x", "ground"], k = "p"'),
    "damper": ("x", "force", 'between = ["x", "ground"], b = "p"'),
    "torsion_spring": ("x", "torque", 'between = ["x", "ground"], k = "p"'),
    "rotary_damper": ("x", "torque", 'between = ["x", "ground"], b = "p"'),
    "resistor": ("x", "current", 'between = ["x", "ground"], R = "p"'),
    "inductor": ("x", "current", 'between = ["x", "ground"], L = "p"'),
    "capacitor": ("x", "current", 'between = ["x", "ground"], C = "p"'),
    "force_source": ("x", None, 'at = "x", f = "p*U"'),
    "torque_source": ("x", None, 'at = "x", tau = "p*U"'),
    "current_source": ("x", None, 'at = "x", i = "p*U"'),
    "voltage_source": ("x", None, 'at = "x", v = "p*U"'),
    "rigid_body": ("x", "force", 'at = "x", m = "p", J = "q", cg = "q"'),
    "rigid_link": ("x", "force", 'between = ["base", "x"], length = "p"'),
    "massless_beam": ("x", "force", 'between = ["base", "x"], EI = "p", l = "q"'),
    "beam": ("x", "force", f'between = ["base", "x"], E = "p", I = "q", {LINE}'),
    "frame": ("x.y", "force", f'between = ["base", "x"], E = "p", I = "q", {LINE}, angle = "60 deg"'),
    "rod": ("x", "force", f'between = ["ground", "x"], E = "p", {LINE}'),
    "shaft": ("x", "torque", 'between = ["ground", "x"], G = "p", J = "q", rho = "q", l = "q"'),
    "string": ("x", "force", f'between = ["ground", "x"], N = "p", {LINE}'),
    "fixed": ("x", "force", 'at = "y"'),
    "slider": ("x", "force", 'at = "x"'),
    "pin": ("x.theta", "torque", 'at = "x"'),
    "dc_motor": ("x", "torque", 'terminals = ["v", "ground"], shaft = "x", R = "p", k_t = "q"'),
    "piezo": ("x", "force", 'terminals = ["v", "ground"], between = ["x", "ground"], alpha = "p", k = "q"'),
    "transformer": ("x", "force", 'from = "x", to = "y", ratio = "p"'),
    "gyrator": ("x", "force", 'from = "x", to = "y", ratio = "p"'),
    "voice_coil": ("x", "force", 'terminals = ["v", "ground"], mover = "x", R = "p", k_f = "q"'),
    "planetary_gear": ("x", "torque", 'sun = "x", ring = "y", carrier = "ground", rho = "p"'),
    "coupled_inductors": ("x", "current", f'terminals = ["x", "ground", "y", "ground"], {WINDINGS}'),
    "op_amp": ("x", "current", 'inputs = ["ground", "x"], out = "y", A = "p"'),
    "vcvs": ("x", "current", 'inputs = ["ground", "x"], terminals = ["y", "ground"], mu = "p"'),
    "vccs": ("x", "current", 'inputs = ["ground", "x"], terminals = ["x", "ground"], g = "p"'),
    "ccvs": ("x", "current", 'inputs = ["x", "y"], terminals = ["y", "ground"], r = "p"'),
    "cccs": ("x", "current", 'inputs = ["y", "ground"], terminals = ["ground", "x"], beta = "p"'),
    "acoustic_mass": ("x", "flow", 'between = ["x", "ground"], M = "p"'),
    "acoustic_resistance": ("x", "flow", 'between = ["x", "ground"], R = "p"'),
    "acoustic_compliance": ("x", "flow", 'at = "x", C = "p"'),
    "pressure_source": ("x", None, 'at = "x", p = "p*U"'),
    "flow_source": ("x", None, 'at = "x", q = "p*U"'),
    "thermal_resistance": ("x", "heat", 'between = ["x", "ground"], R = "p"'),
    "thermal_capacity": ("x", "heat", 'at = "x", C = "p"'),
    "heat_source": ("x", None, 'at = "x", phi = "p*U"'),
    "temperature_source": ("x", None, 'at = "x", T = "p*U"'),
    "piston": ("x", "force", 'mover = "x", chamber = "y", A = "p"'),
}
REST = {
    "force_source": 'load = { type = "spring", between = ["x", "ground"], k = "q" }',
    "torque_source": 'load = { type = "torsion_spring", between = ["x", "ground"], k = "q" }',
    "current_source": 'load = { type = "resistor", between = ["x", "ground"], R = "q" }',
    "voltage_source": 'load = { type = "resistor", between = ["x", "ground"], R = "q" }',
    "rigid_link": 'body = { type = "rigid_body", at = "base", m = "p", J = "q" }',
    "massless_beam": 'wall = { type = "fixed", at = "base" }',
    "beam": 'wall = { type = "fixed", at = "base" }',
    "frame": 'wall = { type = "fixed", at = "base" }',
    "fixed": 'part = { type = "spring", between = ["x", "y"], k = "p" }',
    "slider": 'body = { type = "rigid_body", at = "x", m = "p" }',
    "pin": 'body = { type = "rigid_body", at = "x", m = "p", J = "q", cg = "q" }',
    "dc_motor": 'load = { type = "resistor", between = ["v", "ground"], R = "q" }',
    "piezo": 'load = { type = "resistor", between = ["v", "ground"], R = "q" }',
    "transformer": 'load = { type = "spring", between = ["y", "ground"], k = "q" }',
    "gyrator": 'load = { type = "spring", between = ["y", "ground"], k = "q" }',
    "voice_coil": 'load = { type = "resistor", between = ["v", "ground"], R = "q" }',
    "planetary_gear": 'load = { type = "torsion_spring", between = ["y", "ground"], k = "q" }',
    "coupled_inductors": 'load = { type = "resistor", between = ["y", "ground"], R = "q" }',
    "op_amp": 'back = { type = "resistor", between = ["x", "y"], R = "q" }',
    "vcvs": 'back = { type = "resistor", between = ["x", "y"], R = "q" }',
    "vccs": 'load = { type = "resistor", between = ["x", "ground"], R = "q" }',
    "ccvs": 'load = { type = "resistor", between = ["y", "ground"], R = "q" }',
    "cccs": 'sense = { type = "resistor", between = ["x", "y"], R = "q" }',
    "pressure_source": 'load = { type = "acoustic_resistance", between = ["x", "ground"], R = "q" }',
    "flow_source": 'load = { type = "acoustic_resistance", between = ["x", "ground"], R = "q" }',
    "heat_source": 'load = { type = "thermal_resistance", between = ["x", "ground"], R = "q" }',
    "temperature_source": 'load = { type = "thermal_resistance", between = ["x", "ground"], R = "q" }',
    "piston": 'load = { type = "acoustic_compliance", at = "y", C = "q" }',
}

BLOCK_VALUES = {
    "resonance": 'omega_p = "p", zeta_p = 0.1, omega_z = "q", zeta_z = 0.2',
    "notch": 'omega = "p", zeta_p = "q"',
    "low_pass": 'omega = "p", zeta = "q"',
    "tf": 'num = "p", den = "1 + q*s"',
    "ss": 'A = [[0, 1], ["-p", "-q"]], B = [0, 1], C = ["p", 0]',
    "integrator": "",
    "lead_lag": 'T_1 = "p", T_2 = "q"',
    "lag": 'T = "p"',
    "pid": 'k_p = "p", k_i = "q"',
    "delay": 'T = "p"',
}


def element_model(kind: str) -> str:
    """Return the text of the smallest model with one element of this kind."""
    node, drive, ports = MODELS[kind]
    source = f'{{ {drive} = "{node}" }}' if drive else "{}"
    return (
        HEADER
        + "[parameters]\np = 3\nq = 5\n[elements]\n"
        + f'part_1 = {{ type = "{kind}", {ports} }}\n{REST.get(kind, "")}\n'
        + f'[inputs]\nU = {source}\n[outputs]\nX = "{node}"\n'
    )


def block_model(kind: str) -> str:
    """Return the text of the smallest model with one block of this kind."""
    values = BLOCK_VALUES[kind]
    comma = ", " if values else ""
    return (
        HEADER
        + "[parameters]\np = 3\nq = 5\n[blocks]\n"
        + f'G = {{ type = "{kind}"{comma}{values} }}\n[inputs]\nU = {{}}\n[outputs]\nX = "G*U"\n'
    )

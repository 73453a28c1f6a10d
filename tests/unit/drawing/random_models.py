"""Random models of all kinds of parts, as text: not all are sound, and those that are not are left out."""

from __future__ import annotations

import random

from symflex import pipeline
from symflex.errors import SymflexError

MEMBER = 'E = "E", I = "I", rho = "rho", A = "A", l = "l"'
HEAD = """symflex = 1
[parameters]
E = "70 GPa"
I = "1e-9 m^4"
rho = "2700 kg/m^3"
A = "1e-4 m^2"
l = "0.8 m"
N_w = "9 N"
k_1 = { value = "95 kN/m", latex = 'k_{\\mathrm{long,one}}' }
"""


def _nodes(rng, letter, at_most):
    return [f"{letter}_{i}" for i in range(rng.randint(1, at_most))]


def _pair(rng, nodes):
    one = rng.choice(nodes)
    other = rng.choice([n for n in [*nodes, "ground", "ground"] if n != one])
    ends = [one, other]
    rng.shuffle(ends)
    return f'["{ends[0]}", "{ends[1]}"]'


def _elements(rng, t, r, v, p):
    """Return ways to write an element, each with the nodes it needs."""
    theta = [*r, *(f"{n}.theta" for n in p)]
    moving = [*t, *p]
    return [
        lambda: f'type = "mass", at = "{rng.choice(moving)}", m = "{rng.randint(1, 9)} kg"',
        lambda: f'type = "spring", between = {_pair(rng, moving)}, k = "{rng.choice(["k_1", "3 N/m"])}"',
        lambda: f'type = "damper", between = {_pair(rng, moving)}, b = "{rng.randint(1, 9)} N*s/m"',
        lambda: f'type = "spring", between = {_pair(rng, t)}, k = "k_1*2"',
        lambda: f'type = "inertia", at = "{rng.choice(theta)}", J = "{rng.randint(1, 9)} kg*m^2"',
        lambda: f'type = "torsion_spring", between = {_pair(rng, theta)}, k = "2 N*m/rad"',
        lambda: f'type = "rotary_damper", between = {_pair(rng, theta)}, b = "2 N*m*s/rad"',
        lambda: f'type = "resistor", between = {_pair(rng, v)}, R = "2 Ohm"',
        lambda: f'type = "inductor", between = {_pair(rng, v)}, L = "2 mH"',
        lambda: f'type = "capacitor", between = {_pair(rng, v)}, C = "2 uF"',
        lambda: (
            f'type = "dc_motor", terminals = {_pair(rng, v)}, shaft = "{rng.choice(r)}", k_t = "0.1 N*m/A"'
        ),
        lambda: f'type = "transformer", from = "{rng.choice(r)}", to = "{rng.choice(t)}", ratio = "3 mm/rad"',
        lambda: f'type = "transformer", from = "{rng.choice(r)}", to = "{rng.choice(r)}", ratio = 3',
        lambda: f'type = "gyrator", from = "{rng.choice(v)}", to = "{rng.choice(t)}", ratio = 3',
        lambda: f'type = "piezo", terminals = {_pair(rng, v)}, between = {_pair(rng, t)}, alpha = "12 N/V"',
        lambda: f'type = "beam", between = {_pair(rng, p)}, {MEMBER}',
        lambda: f'type = "massless_beam", between = {_pair(rng, p)}, EI = "2 N*m^2", l = "l"',
        lambda: f'type = "rigid_link", between = {_pair(rng, p)}, length = "0.1 m"',
        lambda: f'type = "rigid_body", at = "{rng.choice(p)}", m = "2 kg", J = "1 kg*m^2", cg = "0.1 m"',
        lambda: f'type = "rod", between = {_pair(rng, t)}, E = "E", A = "A", rho = "rho", l = "l"',
        lambda: f'type = "string", between = {_pair(rng, t)}, N = "9 N", A = "A", rho = "rho", l = "l"',
        lambda: f'type = "shaft", between = {_pair(rng, r)}, G = "E", J = "I", rho = "rho", l = "l"',
        lambda: f'type = "{rng.choice(["pin", "slider", "fixed"])}", at = "{rng.choice(p)}"',
        lambda: f'type = "{rng.choice(["pin", "slider", "fixed"])}", between = {_pair(rng, p)}',
        lambda: f'type = "fixed", at = "{rng.choice(t)}"',
        lambda: f'type = "force_source", at = "{rng.choice(moving)}", f = "{rng.choice(["u", "-u", "2*u"])}"',
        lambda: f'type = "torque_source", at = "{rng.choice(theta)}", tau = "3*u"',
        lambda: f'type = "voltage_source", at = "{rng.choice(v)}", v = "u"',
        lambda: f'type = "current_source", between = {_pair(rng, v)}, i = "u"',
        lambda: (
            f'type = "frame", between = {_pair(rng, ["q_0", "q_1", "q_2"])}, {MEMBER}, '
            f'angle = "{rng.choice([0, 30, 90])} deg"'
        ),
    ]


ENDS = {  # of a beam, at 0 or l
    "clamped": ("w({x}) = 0", "w'({x}) = 0"),
    "hinged": ("w({x}) = 0", "w''({x}) = 0"),
    "free": ("w''({x}) = 0", "w'''({x}) = 0"),
    "guided": ("w'({x}) = 0", "w'''({x}) = 0"),
    "pushed": ("w''({x}) = 0", "E*I*w'''({x}) = F_w"),
    "moved": ("w({x}) = F_w", "w'({x}) = 0"),
}
BARS = ("w({x}) = 0", "w'({x}) = 0", "E*A*w'({x}) = F_w", "w({x}) = F_w")
BLOCKS = (
    'type = "lag", T = "3 ms"',
    'type = "integrator"',
    'type = "lead_lag", T_1 = "2 s", T_2 = "50 ms"',
    'type = "pid", k_p = 3, k_i = 2, k_d = 1, T_f = "1 ms"',
    'type = "delay", T = "7 ms"',
    'type = "tf", num = [1, 2], den = [1, 1, 3]',
    'type = "resonance", omega_p = "3 rad/s", zeta_p = 0.1, omega_z = "5 rad/s", zeta_z = 0.2',
)
INPUTS = {
    "x": ["force", "displacement", "velocity", "acceleration"],
    "r": ["torque", "angle", "angular_velocity", "angular_acceleration"],
    "v": ["voltage", "current"],
    "p": ["force", "torque", "displacement", "velocity", "angle", "angular_velocity"],
    "q": ["torque", "angle"],
}


def _field(rng):
    """Return a field and outputs that show it: a beam, a bar, a string, or one that tapers."""
    taper = rng.choice(["", "", "*(1 - x/(2*l))"])
    if rng.random() < 0.6:
        equation = f"(E*I{taper}*w'')'' + rho*A*s^2*w"
        conditions = [c.format(x=x) for x in ("0", "l") for c in ENDS[rng.choice([*ENDS])]]
    else:
        equation = f"({rng.choice(['E*A', 'N_w'])}{taper}*w')' - rho*A*s^2*w"
        conditions = [rng.choice(BARS).format(x=x) for x in ("0", "l")]
    load = rng.choice(["0", "0", "F_w"])
    text = f'[fields.w]\ndomain = ["0", "l"]\nequation = "{equation} = {load}"\nconditions = {conditions}\n'
    return text, rng.sample(["w(l)", "w'(0)", "s*w(l/3)", "w(0.1 m)", "E*I*w''(0)", "2*w(0) + u"], 2)


def _signals(rng, nodes):
    """Return blocks and signals that read inputs, nodes and each other, and outputs that show them."""
    names = [f"sig_{i}" for i in range(rng.randint(1, 4))]
    own = [f"G_{i}" for i in range(rng.randint(0, 3))]
    read, unused = [*names, "u", *nodes], list(own)

    def term():
        factors = rng.sample(["3", "k_1", "s"], rng.randint(0, 1))
        if unused and rng.random() < 0.6:
            factors.append(unused.pop())
        return "*".join([*factors, rng.choice(read)])

    def value():
        terms = [term() for _ in range(rng.randint(1, 3))]
        return rng.choice(["", "-"]) + rng.choice([" + ", " - "]).join(terms)

    lines = [f'{n} = "{value()}"' for n in names]
    blocks = [f"{n} = {{ {rng.choice(BLOCKS)} }}" for n in own]
    shown = [rng.choice(names), f"{rng.choice(names)} - 2*u"]
    return "\n".join(("[blocks]", *blocks, "[signals]", *lines, "")), shown


def text_of(seed):
    """Return the text of a model."""
    rng = random.Random(seed)
    t, r, v, p = (_nodes(rng, letter, 4) for letter in "xrvp")
    ways = _elements(rng, t, r, v, p)
    liked = rng.sample(range(len(ways)), rng.randint(3, 12))
    lines = []
    for i in range(rng.randint(1, 15)):
        try:
            lines.append(f"part_{i} = {{ {ways[rng.choice(liked)]()} }}")
        except IndexError:  # a pair of a single node
            continue
    body = "\n".join(lines)
    used = [n for n in (*t, *r, *v, *p, "q_0", "q_1", "q_2") if f'"{n}"' in body or f'"{n}.' in body]
    if not used:
        return None
    inputs, outputs, more = ["u = {}"], [], ""
    for i in range(rng.randint(1, 3)):
        node = rng.choice(used)
        others = [n for n in used if n[0] == node[0] and n != node]
        place = f'["{node}", "{rng.choice(others)}"]' if others and rng.random() < 0.3 else f'"{node}"'
        inputs.append(f"in_{i} = {{ {rng.choice(INPUTS[node[0]])} = {place} }}")
    for _ in range(rng.randint(1, 4)):
        node = rng.choice(used)
        if node[0] == "q":
            node = f"{node}.{rng.choice(['x', 'y', 'theta'])}"
        others = [n for n in used if n[0] == node[0] and n != node and n[0] != "q"]
        ways_out = [node, f"s*{node}", f"s^2*{node}", f"2*{node} + u", *(f"{node} - {o}" for o in others[:1])]
        outputs.append(rng.choice(ways_out))
    if rng.random() < 0.4:
        text, shown = _signals(rng, [n for n in used if n[0] != "q"])
        more, outputs, body = more + text, outputs + shown, body.replace('"3*u"', '"sig_0"')
    if rng.random() < 0.3:
        text, shown = _field(rng)
        more, outputs, inputs = more + text, outputs + shown, [*inputs, "F_w = {}"]
    outputs = "\n".join(f'out_{i} = "{one}"' for i, one in enumerate(outputs))
    return f"{HEAD}{more}[elements]\n{body}\n[inputs]\n{chr(10).join(inputs)}\n[outputs]\n{outputs}\n"


def models(first, count):
    """Yield so many sound models, each with its seed."""
    seed, found = first, 0
    while found < count:
        text = text_of(seed)
        try:
            model = pipeline.loads(text) if text else None
        except SymflexError:
            model = None
        if model is not None:
            found += 1
            yield seed, model
        seed += 1

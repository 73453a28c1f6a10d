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


def text_of(seed):
    """Return the text of a model."""
    rng = random.Random(seed)
    t, r, v, p = (_nodes(rng, letter, 4) for letter in "xrvp")
    ways = _elements(rng, t, r, v, p)
    liked = rng.sample(range(len(ways)), rng.randint(3, 12))
    lines = []
    names = []
    for i in range(rng.randint(1, 15)):
        try:
            line = ways[rng.choice(liked)]()
        except IndexError:
            continue
        if '["' in line and line.split('["')[1].split('"')[0] == "":
            continue
        names.append(f"part_{i}")
        lines.append(f"part_{i} = {{ {line} }}")
    body = "\n".join(lines)
    used = [n for n in (*t, *r, *v, *p, "q_0", "q_1", "q_2") if f'"{n}"' in body or f'"{n}.' in body]
    if not used:
        return None
    inputs, outputs = [], []
    for i in range(rng.randint(1, 3)):
        node = rng.choice(used)
        kind = {
            "x": ["force", "displacement", "velocity"],
            "r": ["torque", "angle"],
            "v": ["voltage", "current"],
            "p": ["force", "torque", "displacement"],
            "q": ["torque"],
        }[node[0]]
        others = [n for n in used if n[0] == node[0] and n != node]
        place = f'["{node}", "{rng.choice(others)}"]' if others and rng.random() < 0.3 else f'"{node}"'
        inputs.append(f"in_{i} = {{ {rng.choice(kind)} = {place} }}")
    inputs.append("u = {}")
    for i in range(rng.randint(1, 4)):
        node = rng.choice(used)
        if node[0] == "q":
            node = f"{node}.{rng.choice(['x', 'y', 'theta'])}"
        others = [n for n in used if n[0] == node[0] and n != node and n[0] != "q"]
        ways_out = [node, f"s*{node}", f"s^2*{node}", f"2*{node} + u", *(f"{node} - {o}" for o in others[:1])]
        outputs.append(f'out_{i} = "{rng.choice(ways_out)}"')
    signals = ""
    if rng.random() < 0.4:
        node = rng.choice([n for n in used if n[0] != "q"] or ["u"])
        signals = f'[signals]\nsig_1 = "3*(u - 2*s*sig_2)"\nsig_2 = "sig_1 + 4*{node}"\n'
        outputs.append('out_s = "sig_2"')
    inputs, outputs = "\n".join(inputs), "\n".join(outputs)
    return f"{HEAD}{signals}[elements]\n{body}\n[inputs]\n{inputs}\n[outputs]\n{outputs}\n"


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

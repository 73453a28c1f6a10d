"""Random networks of beams, rods, shafts and strings, as specifications and as boundary-value problems.

Every network is a connected graph of members with lumped elements, and now and then a loop with a delay, at
its nodes. The specification and the boundary-value problem are made of the same numbers, and of nothing else.
"""

from __future__ import annotations

from dataclasses import dataclass
from random import Random
from typing import TYPE_CHECKING

from mpmath import exp, mp, mpc, mpf

from tests.independent.boundary_value import DIGITS, Form, Problem, bending, rod, shaft, string, timoshenko

if TYPE_CHECKING:
    from tests.independent.boundary_value import Number, Rows, Values

GROUND = "ground"
KINDS = ("beam", "axial", "shaft")
"""What the members of a network carry: bending, displacements along or across a line, angles."""


@dataclass(frozen=True)
class Member:
    """A member between two nodes."""

    type_name: str
    ends: tuple[str, str]
    values: dict[str, str]  # decimals in SI units
    theory: str = ""


@dataclass(frozen=True)
class Lump:
    """A mass, spring or damper at a node: ``value * s^power`` per displacement or angle."""

    type_name: str
    at: str  # node, with its component where it has one
    key: str
    value: str
    power: int


@dataclass(frozen=True)
class Loop:
    """A source at a node, minus a gain times the late displacement of another."""

    at: str
    sensor: str
    gain: str
    delay: str


@dataclass(frozen=True)
class MemberNetwork:
    """Members with lumped elements, driven at one node and read at another."""

    kind: str
    members: tuple[Member, ...]
    lumps: tuple[Lump, ...]
    driven: str
    read: str
    loop: Loop | None = None


def random_members(seed: int, most: int = 12) -> MemberNetwork:
    """Return a network of two to so many members."""
    random = Random(seed)
    kind = KINDS[seed % len(KINDS)]
    count = random.randint(2, most)
    nodes = [GROUND, "n1"]
    members = [_member(random, kind, (GROUND, "n1"))]
    while len(members) < count:
        if random.random() < 0.7 or len(nodes) < 3:
            nodes.append(f"n{len(nodes)}")
            ends = (random.choice(nodes[:-1]), nodes[-1])
        else:
            ends = tuple(random.sample(nodes, 2))
        members.append(_member(random, kind, ends))
    free = nodes[1:]
    lumps = tuple(_lump(random, kind, random.choice(free)) for _ in range(random.randint(0, 4)))
    loop = None
    if random.random() < 0.3:
        gain, delay = f"{random.randint(1, 90)}", f"0.00{random.randint(1, 9)}"
        loop = Loop(random.choice(free), random.choice(free), gain, delay)
    return MemberNetwork(kind, tuple(members), lumps, random.choice(free), random.choice(free), loop)


def is_seen(network: MemberNetwork) -> bool:
    """Tell whether what drives a network moves what is read: not where ground or nothing is between them."""
    found, pending = {network.driven}, [network.driven]
    while pending:
        here = pending.pop()
        near = {end for m in network.members if here in m.ends for end in m.ends} - {GROUND}
        if network.loop is not None and network.loop.sensor == here:
            near.add(network.loop.at)
        pending += near - found
        found |= near
    return network.read in found


def _member(random: Random, kind: str, ends: tuple[str, str]) -> Member:
    values = {"rho": f"{random.randint(1, 8)}000", "l": f"0.{random.randint(2, 9)}"}
    if random.random() < 0.3 and kind != "axial":
        values["eta"] = f"{random.randint(1, 9)}e-5"
    if random.random() < 0.2:
        values["k_f"] = f"{random.randint(1, 9)}00"
    if kind == "shaft":
        values |= {"G": f"{random.randint(2, 8)}e10", "J": f"{random.randint(1, 9)}e-10"}
        return Member("shaft", ends, values)
    values["A"] = f"{random.randint(1, 9)}e-5"
    if kind == "axial":
        if random.random() < 0.5:
            return Member("string", ends, values | {"N": f"{random.randint(1, 9)}00"})
        return Member("rod", ends, values | {"E": f"{random.randint(1, 9)}e8"})
    values |= {"E": f"{random.randint(5, 20)}e10", "I": f"{random.randint(1, 9)}e-10"}
    theory = random.choice(("euler-bernoulli", "rayleigh", "timoshenko"))
    if theory == "timoshenko":
        values |= {"G": f"{random.randint(2, 8)}e10", "kappa": "0.85"}
    return Member("beam", ends, values, theory)


def _lump(random: Random, kind: str, node: str) -> Lump:
    power = random.randint(0, 2)
    is_turning = kind == "shaft" or (kind == "beam" and random.random() < 0.4)
    names = ("torsion_spring", "rotary_damper", "inertia") if is_turning else ("spring", "damper", "mass")
    keys = ("k", "b", "J") if is_turning else ("k", "b", "m")
    value = (f"{random.randint(1, 90)}0", f"0.{random.randint(1, 9)}", f"0.0{random.randint(1, 9)}")[power]
    at = f"{node}.theta" if is_turning and kind == "beam" else node
    return Lump(names[power], at, keys[power], value, power)


UNITS = {
    "rho": "kg/m^3",
    "l": "m",
    "eta": "s",
    "G": "Pa",
    "A": "m^2",
    "N": "N",
    "E": "Pa",
    "I": "m^4",
    "J": "m^4",
    "kappa": "",
}
LUMP_UNITS = {
    "mass": "kg",
    "spring": "N/m",
    "damper": "N*s/m",
    "inertia": "kg*m^2",
    "torsion_spring": "N*m/rad",
    "rotary_damper": "N*m*s/rad",
}


def specification(network: MemberNetwork) -> str:
    """Return the network in the specification language."""
    elements = []
    for n, member in enumerate(network.members):
        units = UNITS | {"k_f": "N*m/m" if member.type_name == "shaft" else "N/m^2"}
        fields = [f'type = "{member.type_name}"', f'between = ["{member.ends[0]}", "{member.ends[1]}"]']
        fields += [f'{key} = "{f"{value} {units[key]}".strip()}"' for key, value in member.values.items()]
        fields += [f'theory = "{member.theory}"'] * bool(member.theory)
        elements.append(f"member_{n} = {{ {', '.join(fields)} }}")
    for n, lump in enumerate(network.lumps):
        place = f'at = "{lump.at}"' if lump.power == 2 else f'between = ["{lump.at}", "ground"]'
        unit = LUMP_UNITS[lump.type_name]
        elements.append(
            f'lump_{n} = {{ type = "{lump.type_name}", {place}, {lump.key} = "{lump.value} {unit}" }}'
        )
    blocks = parameters = ""
    source = "torque" if network.kind == "shaft" else "force"
    if network.loop is not None:
        gain = f"{network.loop.gain} {'N*m/rad' if network.kind == 'shaft' else 'N/m'}"
        parameters = f'[parameters]\nK = "{gain}"\nT = "{network.loop.delay} s"\n'
        blocks = '[blocks]\nD = { type = "delay", T = "T" }\n'
        port = "tau" if network.kind == "shaft" else "f"
        value = f"-K*D*{network.loop.sensor}"
        elements.append(
            f'loop = {{ type = "{source}_source", at = "{network.loop.at}", {port} = "{value}" }}'
        )
    listed = "\n".join(elements)
    return (
        f"symflex = 1\n{parameters}[elements]\n{listed}\n{blocks}"
        f'[inputs]\nF = {{ {source} = "{network.driven}" }}\n[outputs]\nX = "{network.read}"\n'
    )


def response(network: MemberNetwork, s: complex) -> Number:
    """Return what is read per unit of what drives, by one linear system at one frequency [rad/s]."""
    with mp.workdps(DIGITS):
        return _response(network, mpc(s))


def _response(network: MemberNetwork, s: Number) -> Number:
    problem = Problem()
    width = 2 if network.kind == "beam" else 1
    names = dict.fromkeys(end for m in network.members for end in m.ends if end != GROUND)
    across = {name: [problem.unknown() for _ in range(width)] for name in names}
    across[GROUND] = [Form()] * width
    needed = {name: [Form()] * width for name in across}
    for member in network.members:
        values = {key: mpf(value) for key, value in member.values.items()}
        line = problem.line(_rows(member, values, s))
        start, end = line.start, line.at(values["l"])
        for name, state in zip(member.ends, (start, end), strict=True):
            problem.require(*(x - y for x, y in zip(state[:width], across[name], strict=True)))
        # What it takes to hold the two ends, see the head of boundary_value.
        if network.kind == "beam":
            loads = ([start[3], -start[2]], [-end[3], end[2]])
        else:
            loads = ([-start[1]], [end[1]])
        for name, load in zip(member.ends, loads, strict=True):
            needed[name] = [x + y for x, y in zip(needed[name], load, strict=True)]
    for lump in network.lumps:
        name, _, component = lump.at.partition(".")
        i = int(component == "theta" and network.kind == "beam")
        added = list(needed[name])
        added[i] = added[i] + across[name][i] * (mpf(lump.value) * s**lump.power)
        needed[name] = added
    if network.loop is not None:
        factor = mpf(network.loop.gain) * exp(-s * mpf(network.loop.delay))
        needed[network.loop.at][0] = needed[network.loop.at][0] + across[network.loop.sensor][0] * factor
    needed[network.driven][0] = needed[network.driven][0] - 1
    for name in names:
        problem.require(*needed[name])
    return problem.solve()(across[network.read][0])


def _rows(member: Member, values: Values, s: Number) -> Rows:
    if member.type_name != "beam":
        return {"rod": rod, "shaft": shaft, "string": string}[member.type_name](values, s)
    if member.theory == "timoshenko":
        return timoshenko(values, s)
    return bending(values, s, rotary=member.theory == "rayleigh")

"""Random models of all kinds, for all tests: as data, as specifications, and what chooses among them.

A recipe asks an object like :class:`random.Random`: one with a seed gives the same model each time, one drawn
by hypothesis gives smaller ones where a test fails, one of bytes is what a fuzzer changes.

`networks`, `passive_networks`, `reciprocal_networks`
    Lumped elements, signals and blocks. A network is built as a tree from ground, so that every coordinate
    has a path of its own; couplings, supports and voltage sources are added on top only while the constraints
    they impose stay independent. Such a network is nonsingular at every s in the right half-plane unless a
    signal loop happens to have a pole there.
`random_members`
    A connected graph of beams, rods, shafts or strings with lumped elements, and now and then a loop with a
    delay, at its nodes.
`anything`, `sound`
    The text of parts, fields, blocks and signals put together without regard to what is sound, and those
    models among them that are.
`random_loop`
    Loops around plants, delays or a beam with functions of a gain in them.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import cosh, exp, log, nan, sin, sqrt, tanh
from random import Random
from typing import TYPE_CHECKING

import numpy as np
from hypothesis import strategies as st

from symflex import pipeline
from symflex.errors import SymflexError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

# ------------------------------------------------------------------------------------------ what chooses


class Drawn(Random):
    """Choices that hypothesis draws."""

    draw: Callable

    def _randbelow(self, n: int) -> int:
        # ``st.integers`` would prefer constants of whatever modules are imported by then.
        return self.draw(st.sampled_from(range(n)))

    def random(self) -> float:
        """Return a number from 0 to 1, as all others from one below."""
        return self._randbelow(1000) / 1000


class Bytes(Drawn):
    """Bytes as choices; when they end, always the first."""

    def __init__(self, data: bytes) -> None:
        super().__init__(0)
        self._data = iter(data)

    def _randbelow(self, n: int) -> int:
        return next(self._data, 0) % n


@st.composite
def drawn(draw: Callable, recipe: Callable) -> object:
    """Draw what a recipe makes."""
    random = Drawn()
    random.draw = draw
    return recipe(random)


GROUND = "ground"
MAX_COORDINATES = 7

ACROSS = {"translation": "m", "rotation": "rad", "electrical": "V", "acoustic": "Pa"}
THROUGH = {"translation": "N", "rotation": "N*m", "electrical": "A", "acoustic": "m^3/s"}
INPUT_KEYS = {"translation": "force", "rotation": "torque", "electrical": "current", "acoustic": "flow"}
IMPOSED = {"electrical": "voltage", "acoustic": "pressure"}

# kind: (domain, name of the value, its unit, name of the quantity it carries)
TWO_TERMINAL = {
    "spring": ("translation", "k", "N/m", "f"),
    "damper": ("translation", "b", "N*s/m", "f"),
    "torsion_spring": ("rotation", "k", "N*m/rad", "tau"),
    "rotary_damper": ("rotation", "b", "N*m*s/rad", "tau"),
    "resistor": ("electrical", "R", "ohm", "i"),
    "inductor": ("electrical", "L", "H", "i"),
    "capacitor": ("electrical", "C", "F", "i"),
    "acoustic_mass": ("acoustic", "M", "kg/m^4", "q"),
    "acoustic_resistance": ("acoustic", "R", "Pa*s/m^3", "q"),
}
CARRYING = {kind: entry[::3] for kind, entry in TWO_TERMINAL.items()} | {"dc_motor": ("electrical", "i")}
ONE_TERMINAL = {
    "mass": ("translation", "m", "kg"),
    "inertia": ("rotation", "J", "kg*m^2"),
    "acoustic_compliance": ("acoustic", "C", "m^3/Pa"),
}
SOURCES = {
    "force_source": ("translation", "f", "N"),
    "torque_source": ("rotation", "tau", "N*m"),
    "current_source": ("electrical", "i", "A"),
    "voltage_source": ("electrical", "v", "V"),
    "flow_source": ("acoustic", "q", "m^3/s"),
    "pressure_source": ("acoustic", "p", "Pa"),
}
PLANAR = ("rigid_body", "rigid_link", "massless_beam", "fixed", "slider", "pin")
CONTROLLED = {"vcvs": ("mu", ""), "vccs": ("g", "A/V"), "ccvs": ("r", "Ohm"), "cccs": ("beta", "")}
COUPLINGS = (
    "dc_motor", "voice_coil", "transformer", "gyrator", "planetary_gear", "piston", "coupled_inductors",
    "op_amp", *CONTROLLED,
)  # fmt: skip
ELEMENTS = (*TWO_TERMINAL, *ONE_TERMINAL, *SOURCES, *PLANAR, *COUPLINGS)
UNITS_OF = {
    **{kind: {entry[1]: entry[2]} for kind, entry in (TWO_TERMINAL | ONE_TERMINAL).items()},
    "rigid_body": {"m": "kg", "J": "kg*m^2"},
    "massless_beam": {"EI": "N*m^2", "l": "m"},
    "dc_motor": {"R": "ohm", "k_t": "N*m/A"},
    "voice_coil": {"R": "ohm", "k_f": "N/A"},
    "piston": {"A": "m^2"},
    "coupled_inductors": {"L_1": "H", "L_2": "H"},
    **{kind: {name: unit} for kind, (name, unit) in CONTROLLED.items()},
}
"""The units of the values that each kind of element must have."""
TIMES = {"T_1": "s", "T_2": "s"}
BLOCKS = {
    "resonance": ({"omega_p": "rad/s", "zeta_p": "", "omega_z": "rad/s", "zeta_z": ""},),
    "notch": ({"omega": "rad/s", "zeta_p": "", "zeta_z": ""}, {"omega": "rad/s", "zeta_p": ""}),
    "low_pass": ({"omega": "rad/s", "zeta": ""}, {"omega": "rad/s", "zeta": "", "k": ""}),
    "tf": ({**TIMES, "T_3": "s"},),
    "integrator": ({"k": "1/s"}, {}),
    "lead_lag": (TIMES, {**TIMES, "k": ""}),
    "pid": tuple(
        {"k_p": "", **more}
        for more in ({}, {"k_i": "1/s"}, {"k_d": "s", "T_f": "s"}, {"k_i": "1/s", "k_d": "s"})
    ),
}
"""The values each kind of block may have; only an integrator without a gain has a dimension."""
LISTED_PORTS = ("between", "terminals", "inputs")


# ------------------------------------------------------------------------------------------------- data


@dataclass(frozen=True, slots=True)
class Parameter:
    """Decimals in an SI unit, or plain ones; without a name they are written where they are used."""

    name: str
    number: str
    unit: str = ""

    @property
    def value(self) -> np.longdouble:
        """The value, correctly rounded."""
        return np.longdouble(self.number)

    @property
    def toml(self) -> str:
        """The value as a specification writes it."""
        return f'"{self.number} {self.unit}"' if self.unit else self.number

    @property
    def used(self) -> str:
        """What an element has as its value."""
        return f'"{self.name}"' if self.name else self.toml


@dataclass(frozen=True, slots=True)
class Term:
    """``sign * gains * s^power * blocks * quantity``.

    ``quantity`` is a coordinate (``x_1``, ``p_1.theta``), a signal, an input, or an element's through
    quantity (``spring_2.f``).
    """

    quantity: str
    sign: int = 1
    gains: tuple[Parameter, ...] = ()
    power: int = 0
    blocks: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """The term in the expression grammar, with its sign."""
        factors = [*(gain.name for gain in self.gains), *self.blocks]
        factors += {0: [], 1: ["s"]}.get(self.power, [f"s^{self.power}"])
        return ("- " if self.sign < 0 else "+ ") + "*".join([*factors, self.quantity])


@dataclass(frozen=True, slots=True)
class Element:
    """One element, or a block, which has no ports; ``source`` is a source's value, ``theory`` a beam's.

    A ``tf`` is (1 + T_1 s)/((1 + T_2 s)(1 + T_3 s)).
    """

    kind: str
    name: str
    ports: tuple[tuple[str, tuple[str, ...]], ...] = ()
    values: tuple[tuple[str, Parameter], ...] = ()
    source: tuple[Term, ...] = ()
    theory: str = ""

    @property
    def nodes(self) -> frozenset[str]:
        """The nodes it touches, ground aside, planar ones without their axes."""
        found = (node.partition(".")[0] for _, nodes in self.ports for node in nodes)
        return frozenset(found) - {GROUND}

    def port(self, key: str) -> tuple[str, ...]:
        """Return the nodes of a port."""
        return dict(self.ports)[key]

    def value(self, key: str, default: int = 0) -> np.longdouble:
        """Return a value, or the default when it is not given."""
        found = dict(self.values).get(key)
        return np.longdouble(default) if found is None else found.value

    @property
    def toml(self) -> str:
        """The element's line."""
        names = {key: parameter.used for key, parameter in self.values}
        if self.kind == "tf":
            lag = [parameter.name for _, parameter in self.values]
            names = {"num": f'"1 + {lag[0]}*s"', "den": f'"(1 + {lag[1]}*s)*(1 + {lag[2]}*s)"'}
        parts = [f'type = "{self.kind}"']
        parts += [
            f"{key} = {_nodes(nodes, listed=key in LISTED_PORTS or len(nodes) > 1)}"
            for key, nodes in self.ports
        ]
        parts += [f"{key} = {text}" for key, text in names.items()]
        if self.source:
            parts.append(f'{SOURCES[self.kind][1]} = "{sum_text(self.source)}"')
        parts += [f'theory = "{self.theory}"'] * bool(self.theory)
        return f"{self.name} = {{ {', '.join(parts)} }}"


@dataclass(frozen=True, slots=True)
class Input:
    """An input: ``key`` is force, torque, current, voltage, or empty for a free signal."""

    name: str
    key: str = ""
    nodes: tuple[str, ...] = ()

    @property
    def toml(self) -> str:
        """The input's line."""
        if not self.key:
            return f"{self.name} = {{}}"
        return f"{self.name} = {{ {self.key} = {_nodes(self.nodes, listed=len(self.nodes) > 1)} }}"


@dataclass(frozen=True, slots=True)
class Network:
    """A whole model. ``coordinates`` maps each scalar coordinate to its domain."""

    coordinates: tuple[tuple[str, str], ...]
    elements: tuple[Element, ...]
    inputs: tuple[Input, ...]
    outputs: tuple[tuple[str, tuple[Term, ...]], ...]
    signals: tuple[tuple[str, tuple[Term, ...]], ...] = ()
    blocks: tuple[Element, ...] = ()

    @property
    def kinds(self) -> frozenset[str]:
        """The element and block types that occur."""
        return frozenset(e.kind for e in self.elements) | frozenset(b.kind for b in self.blocks)

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Every parameter with a name once, in the order of use."""
        sums = [
            *(e.source for e in self.elements),
            *(t for _, t in self.signals),
            *(t for _, t in self.outputs),
        ]
        used = [p for part in (*self.elements, *self.blocks) for _, p in part.values]
        used += [gain for terms in sums for term in terms for gain in term.gains]
        return tuple(dict.fromkeys(p for p in used if p.name))

    def __repr__(self) -> str:
        """Show the specification, which is what a failing example is reported by."""
        return f"Network:\n{to_toml(self)}"


def sum_text(terms: Sequence[Term]) -> str:
    """Return a sum in the expression grammar.

    Examples
    --------
    >>> sum_text((Term("x_1", power=2), Term("x_2", sign=-1)))
    's^2*x_1 - x_2'
    """
    text = " ".join(term.text for term in terms)
    return text.removeprefix("+ ") if text.startswith("+ ") else "-" + text.removeprefix("- ")


def to_toml(network: Network) -> str:
    """Return the specification of a network."""
    sections = {
        "parameters": [f"{parameter.name} = {parameter.toml}" for parameter in network.parameters],
        "elements": [element.toml for element in network.elements],
        "signals": [f'{name} = "{sum_text(terms)}"' for name, terms in network.signals],
        "blocks": [block.toml for block in network.blocks],
        "inputs": [entry.toml for entry in network.inputs],
        "outputs": [f'{name} = "{sum_text(terms)}"' for name, terms in network.outputs],
    }
    written = ["\n".join([f"[{name}]", *lines]) for name, lines in sections.items() if lines]
    return "\n\n".join(["symflex = 1", *written]) + "\n"


def _nodes(nodes: tuple[str, ...], *, listed: bool) -> str:
    quoted = [f'"{node}"' for node in nodes]
    return f"[{', '.join(quoted)}]" if listed else quoted[0]


# --------------------------------------------------------------------------------------- lumped networks


@dataclass
class _Builder:
    """What has been drawn so far; lives only while one network is drawn."""

    random: Random
    coordinates: dict[str, str] = field(default_factory=dict)
    planar: list[str] = field(default_factory=list)
    sprung: set[str] = field(default_factory=set)
    elements: list[Element] = field(default_factory=list)
    blocks: list[Element] = field(default_factory=list)
    pool: list[Parameter] = field(default_factory=list)
    constraints: list[dict[str, complex]] = field(default_factory=list)
    reactions: list[dict[str, complex]] = field(default_factory=list)

    def chance(self, one_in: int) -> bool:
        return self.random.randrange(one_in) == one_in - 1

    def pick(self, options: Sequence) -> object:
        return self.random.choice(list(options))

    def parameter(self, unit: str) -> Parameter:
        """Return a new parameter, or now and then one that is already in use."""
        known = [p for p in self.pool if p.unit == unit]
        if known and self.chance(5):
            return self.pick(known)
        new = Parameter(f"g_{len(self.pool) + 1}", f"{self.random.randint(2, 40) / 10}", unit)
        self.pool.append(new)
        return new

    def port(self, coordinate: str) -> str:
        """Return a coordinate as an element of its domain may name it: ``p_1.y``, or ``p_1`` for short.

        The short name needs a planar element at the node; springs alone do not make it planar.
        """
        node = coordinate.partition(".")[0]
        return node if node not in self.sprung and self.chance(2) else coordinate

    def moving(self, names: Sequence[str]) -> list[str]:
        """Return the coordinates that no support holds; all of them when every one is held."""
        held = {name for row in self.constraints if len(row) == 1 for name in row}
        return [name for name in names if name not in held] or list(names)

    def linked(self, start: str) -> list[str]:
        """Return the coordinates that elements connect to ``start``, which is one of them."""
        reached, fresh = set(), {start}
        while fresh:
            reached |= fresh
            nodes = {name.partition(".")[0] for name in reached}
            touching = [e.nodes for e in self.elements if e.nodes & nodes]
            fresh = {name for name in self.coordinates if name.partition(".")[0] in nodes.union(*touching)}
            fresh -= reached
        return [name for name in self.coordinates if name in reached]

    def of(self, *domains: str) -> list[str]:
        return [name for name, domain in self.coordinates.items() if domain in domains]

    def add(self, kind: str, ports: dict, *source: Term, **values: Parameter) -> None:
        """Add an element with the values it must have and those given."""
        number = 1 + sum(element.kind == kind for element in self.elements)
        ports = {key: (nodes,) if isinstance(nodes, str) else tuple(nodes) for key, nodes in ports.items()}
        values = {key: self.parameter(unit) for key, unit in UNITS_OF.get(kind, {}).items()} | values
        new = Element(kind, f"{kind}_{number}", tuple(ports.items()), tuple(values.items()), source)
        self.elements.append(new)

    def constrain(self, *rows: dict[str, complex], reactions: Sequence[dict[str, complex]] = ()) -> bool:
        """Keep the rows if they are independent of those kept before; say whether they are.

        So must be the forces that keep them, which act where the rows do if not otherwise said.
        """
        order = list(self.coordinates)
        for kept in ([*self.constraints, *rows], [*self.reactions, *(reactions or rows)]):
            matrix = np.array([[row.get(name, 0) for name in order] for row in kept])
            if np.linalg.matrix_rank(matrix, tol=1e-6) < len(kept):
                return False
        self.constraints.extend(rows)
        self.reactions.extend(reactions or rows)
        return True

    # -- the tree

    def add_planar(self) -> None:
        name = f"p_{len(self.planar) + 1}"
        y, theta = f"{name}.y", f"{name}.theta"
        self.coordinates |= {y: "translation", theta: "rotation"}
        first = ("body", "springs", "support")
        later = ("body", "springs", "beam", "beam", "link", "link")
        way = self.pick(later if self.planar else first)
        if way == "body":
            self.add_body(name)
        elif way == "springs":
            self.sprung.add(name)
            self.add_two_terminal(self.pick(("spring", "damper")), y, GROUND)
            self.add_two_terminal(self.pick(("torsion_spring", "rotary_damper")), theta, GROUND)
        elif way == "support":
            self.constrain({y: 1}, {theta: 1})
            self.add("fixed", {"at": name})
            self.add_body(name)
        elif way == "beam":
            self.add("massless_beam", {"between": (self.pick(self.planar), name)})
        else:
            other, length = self.pick(self.planar), self.parameter("m")
            self.constrain(
                {y: 1, f"{other}.y": -1, f"{other}.theta": -float(length.value)},
                {theta: 1, f"{other}.theta": -1},
            )
            self.add("rigid_link", {"between": (other, name)}, length=length)
        self.planar.append(name)

    def add_body(self, name: str) -> None:
        more = {"cg": self.parameter("m")} if self.chance(2) else {}
        self.add("rigid_body", {"at": name}, **more)

    def add_scalar(self, domain: str) -> None:
        letter = {"translation": "x", "rotation": "a", "electrical": "v", "acoustic": "b"}[domain]
        name = f"{letter}_{1 + sum(n.startswith(letter) for n in self.coordinates)}"
        others = self.moving(self.of(domain))
        reached = [GROUND] if not others or self.chance(4) else others
        self.coordinates[name] = domain
        if domain != "electrical" and self.chance(4):
            self.add(
                next(k for k, entry in ONE_TERMINAL.items() if entry[0] == domain), {"at": self.port(name)}
            )
        else:
            kinds = [kind for kind, entry in TWO_TERMINAL.items() if entry[0] == domain]
            self.add_two_terminal(self.pick(kinds), name, self.pick(reached))

    def add_two_terminal(self, kind: str, a: str, b: str) -> None:
        self.add(kind, {"between": [self.port(node) for node in ((a, b) if self.chance(2) else (b, a))]})

    def add_extra(self) -> None:
        """Add an element between coordinates that are there."""
        kind = self.pick((*TWO_TERMINAL, *ONE_TERMINAL, "rigid_body", "massless_beam"))
        if kind in ONE_TERMINAL and self.of(ONE_TERMINAL[kind][0]):
            self.add(kind, {"at": self.port(self.pick(self.of(ONE_TERMINAL[kind][0])))})
        elif kind in TWO_TERMINAL and self.of(TWO_TERMINAL[kind][0]):
            nodes = self.of(TWO_TERMINAL[kind][0])
            a = self.pick(nodes)
            self.add_two_terminal(kind, a, self.pick([GROUND, *(n for n in nodes if n != a)]))
        elif kind == "rigid_body" and self.planar:
            self.add_body(self.pick(self.planar))
        elif kind == "massless_beam" and len(self.planar) > 1:
            self.add("massless_beam", {"between": self.random.sample(self.planar, 2)})

    # -- couplings and supports

    def side(self, names: Sequence[str]) -> tuple[str, ...]:
        """Return one of the coordinates, or now and then two for a motion between them."""
        first = self.pick(names)
        others = [n for n in names if n != first]
        return (first, self.pick(others)) if others and self.chance(3) else (first,)

    def terminals(self, names: Sequence[str]) -> tuple[str, str]:
        """Return two nodes, one of which may be ground."""
        a = self.pick(names)
        b = self.pick([GROUND, *(n for n in names if n != a)])
        return (a, b) if self.chance(2) else (b, a)

    def add_motor(self, *, reciprocal: bool) -> None:
        kind, port, domain, per = self.pick(
            (("dc_motor", "shaft", "rotation", "rad"), ("voice_coil", "mover", "translation", "m"))
        )
        moving, terminals = self.of(domain), self.of("electrical")
        if not moving or not terminals:
            return
        more = {"L": self.parameter("H")} if self.chance(2) else {}
        if not reciprocal and self.chance(2):
            more["k_e"] = self.parameter(f"V*s/{per}")
        self.add(kind, {"terminals": self.terminals(terminals), port: self.side(moving)}, **more)

    def add_piston(self) -> None:
        moving, pressures = self.of("translation"), self.of("acoustic")
        if moving and pressures:
            self.add("piston", {"mover": self.side(moving), "chamber": self.side(pressures)})

    def add_planetary_gear(self) -> None:
        names = self.of("rotation")
        if len(names) < 2:
            return
        nodes = self.random.sample([*names, GROUND] if len(names) < 3 else names, 3)
        rho = self.parameter("")
        shares = (1, float(rho.value), -1 - float(rho.value))
        if self.constrain({n: c for n, c in zip(nodes, shares, strict=True) if n != GROUND}):
            self.add("planetary_gear", dict(zip(("sun", "ring", "carrier"), nodes, strict=True)), rho=rho)

    def add_coupled_inductors(self) -> None:
        names = self.of("electrical")
        if names:
            windings = (*self.terminals(names), *self.terminals(names))
            # Other inductances are 0.2 H at least, so that windings on one core are real ones.
            self.add("coupled_inductors", {"terminals": windings}, M=Parameter("", "0.1", "H"))

    def add_active(self) -> None:
        """Add an amplifier of finite gain, or a controlled source."""
        names = self.of("electrical")
        kind = self.pick(("op_amp", *CONTROLLED))
        if len(names) < 2:
            return
        out, *_ = self.random.sample(names, 2)
        inputs = self.terminals(names)
        felt = {n: c for n, c in zip(inputs, (1, -1), strict=True) if n != GROUND}
        if kind == "op_amp":
            more = {"A": self.parameter(""), **({"f_u": self.parameter("rad/s")} if self.chance(2) else {})}
            needed = 1 / float(more["A"].value) + (0.31 + 0.57j) * ("f_u" in more)
            law = {n: -felt.get(n, 0) + needed * (n == out) for n in {*felt, out}}
            if self.constrain(law, reactions=[{out: 1}]):
                self.add(kind, {"inputs": inputs, "out": out}, **more)
            return
        ends = (out, self.pick([GROUND, *(n for n in names if n != out)]))
        gain = self.parameter(CONTROLLED[kind][1])
        rows = [felt] if kind in ("ccvs", "cccs") else []
        reactions = list(rows)
        if kind in ("vcvs", "ccvs"):
            own = {n: c for n, c in zip(ends, (1, -1), strict=True) if n != GROUND}
            # A current that controls may be any: its law alone does not tell whether voltages are determined.
            follow = float(gain.value) if kind == "vcvs" else 0.0
            rows.append({n: own.get(n, 0) - follow * felt.get(n, 0) for n in {*own, *felt}})
            reactions.append(own)
        if not rows or self.constrain(*rows, reactions=reactions):
            self.add(kind, {"inputs": inputs, "terminals": ends}, **{CONTROLLED[kind][0]: gain})

    def add_transformer(self) -> None:
        groups = (("translation", "rotation"), ("electrical",))
        nodes = self.of(*self.pick(groups))
        if len(nodes) < 2:
            return
        source, target = self.random.sample(nodes, 2)
        others = [n for n in self.of(self.coordinates[source]) if n not in (source, target)]
        self.transform((source, self.pick(others)) if others and self.chance(3) else (source,), (target,))

    def transform(self, source: tuple[str, ...], target: tuple[str, ...]) -> None:
        above, below = (ACROSS[self.coordinates[names[0]]] for names in (target, source))
        ratio = self.parameter("" if above == below else f"{above}/{below}")
        size = float(ratio.value)
        if self.constrain({target[0]: 1, **dict(zip(source, (-size, size), strict=False))}):
            self.add("transformer", {"from": source, "to": target}, ratio=ratio)

    def add_geared_tip(self) -> None:
        """Add a node that only a transformer reaches."""
        source = self.pick(self.of("translation", "rotation") or [None])
        if source is not None:
            name = f"x_{1 + sum(n.startswith('x') for n in self.coordinates)}"
            self.coordinates[name] = "translation"
            self.transform((source,), (name,))

    def add_gyrator(self, *, reciprocal: bool) -> None:
        nodes = list(self.coordinates)
        if len(nodes) < 2:
            return
        source, target = self.random.sample(nodes, 2)
        domains = (self.coordinates[source], self.coordinates[target])
        efforts = sum(d in IMPOSED for d in domains)
        if reciprocal and efforts != 1:
            return
        effort = {**THROUGH, "electrical": "V", "acoustic": "Pa"}[domains[0]]
        flow = {"translation": "*s/m", "rotation": "*s/rad", "electrical": "/A", "acoustic": "*s/m^3"}
        ratio = self.parameter(f"{effort}{flow[domains[1]]}")
        if efforts == 1:  # ties a voltage to a velocity
            voltage, motion = (source, target) if domains[0] in IMPOSED else (target, source)
            if not self.constrain({voltage: 1, motion: -float(ratio.value) * (0.83 + 0.47j)}):
                return
        self.add("gyrator", {"from": source, "to": target}, ratio=ratio)

    def add_support(self) -> None:
        kind = self.pick(("fixed", "slider", "pin"))
        if kind == "fixed":
            scalars = [name for name in self.coordinates if "." not in name]
            node = self.pick([*scalars, *self.planar])
            rows = [{node: 1}] if node in scalars else [{f"{node}.y": 1}, {f"{node}.theta": 1}]
        elif self.planar:
            node = self.pick(self.planar)
            rows = [{f"{node}.theta" if kind == "slider" else f"{node}.y": 1}]
        else:
            return
        if self.constrain(*rows):
            self.add(kind, {"at": node})

    # -- signals

    def add_block(self) -> tuple[str, tuple[Parameter, ...]]:
        """Return a new dimensionless block, with the gain that makes it so."""
        kind = self.pick(BLOCKS)
        units = self.pick(BLOCKS[kind])
        gains = () if units else (self.parameter("1/s"),)
        values = tuple((key, self.parameter(unit)) for key, unit in units.items())
        self.blocks.append(Element(kind, f"B_{len(self.blocks) + 1}", values=values))
        return self.blocks[-1].name, gains

    def measured(self, unit: str, sign: int) -> Term:
        """Return a coordinate, velocity, or through quantity times a gain that gives it ``unit``."""
        carried = [e for e in self.elements if e.kind in CARRYING]
        if carried and self.chance(3):
            element = self.pick(carried)
            domain, quantity = CARRYING[element.kind]
            per = {**THROUGH, "rotation": "N/m"}[domain]  # dividing by N*m
            per = f"({per})" if "/" in per and domain == "acoustic" else per
            gain = self.parameter(f"{unit}/{per}")
            return Term(f"{element.name}.{quantity}", sign, (gain,))
        name = self.pick(self.coordinates)
        power = self.random.randint(0, 1)
        gain = self.parameter(f"{unit}{'*s' * power}/{ACROSS[self.coordinates[name]]}")
        return Term(name, sign, (gain,), power)

    def add_signals(self, free: str) -> list[tuple[str, tuple[Term, ...]]]:
        """Return a chain of signals in volts: the first takes the input, the others the one before."""
        signals: list[tuple[str, tuple[Term, ...]]] = []
        length = self.random.randint(1, 3)
        for i in range(1, length + 1):
            terms = [Term(free if i == 1 else f"e_{i - 1}")]
            if self.chance(2):
                block, gains = self.add_block()
                terms = [replace(terms[0], gains=gains, blocks=(block,))]
            if self.chance(2):
                terms.append(self.measured("V", -1))
            if i == 1 and length > 1 and self.chance(2):  # a loop of signals alone
                terms.append(Term(f"e_{length}", -1, (self.parameter(""),)))
            signals.append((f"e_{i}", tuple(terms)))
        return signals

    def add_source(self, quantity: str) -> bool:
        """Let a signal or a free input drive a source; say whether there is a node for it."""
        kinds = [kind for kind, (domain, _, _) in SOURCES.items() if self.of(domain)]
        kind = self.pick(kinds)
        domain, _, unit = SOURCES[kind]
        node = self.pick(self.moving(self.of(domain)))
        terms = [Term(quantity, self.pick((1, -1)), (self.parameter("" if unit == "V" else f"{unit}/V"),))]
        if kind in ("voltage_source", "pressure_source"):
            if not self.constrain({node: 1}):
                return False
        elif self.chance(2):
            terms.append(self.measured(unit, -1))
        self.add(kind, {"at": self.port(node)}, *terms)
        return True

    def add_input(self, number: int) -> Input:
        """Return an input that acts on the network directly."""
        node = self.pick(self.moving(self.coordinates))
        domain = self.coordinates[node]
        if domain in IMPOSED and self.chance(2) and self.constrain({node: 1}):
            return Input(f"U_{number}", IMPOSED[domain], (node,))
        others = [name for name in self.of(domain) if name != node]
        pair = (self.pick(others),) if others and self.chance(3) else ()
        return Input(f"U_{number}", INPUT_KEYS[domain], tuple(self.port(end) for end in (node, *pair)))

    def add_output(self, driven: str) -> tuple[Term, ...]:
        """Return what an output shows, mostly of what ``driven`` is connected to."""
        near = list(self.coordinates) if self.chance(8) else self.linked(driven)
        nodes = {name.partition(".")[0] for name in near}
        carried = [e for e in self.elements if e.kind in CARRYING and e.nodes & nodes]
        if carried and self.chance(4):
            element = self.pick(carried)
            return (Term(f"{element.name}.{CARRYING[element.kind][1]}"),)
        name = self.pick(self.moving(near))
        power = self.random.randint(0, 2)
        others = [other for other in self.of(self.coordinates[name]) if other != name]
        if others and self.chance(3):
            return Term(name, power=power), Term(self.pick(others), -1, power=power)
        return (Term(name, power=power),)

    def network(self, inputs: Sequence[Input], outputs: Sequence, signals: Sequence = ()) -> Network:
        return Network(
            tuple(self.coordinates.items()),
            tuple(self.elements),
            tuple(inputs),
            tuple((f"Y_{i}", terms) for i, terms in enumerate(outputs, 1)),
            tuple(signals),
            tuple(self.blocks),
        )


def _passive_part(random: Random, *, reciprocal: bool) -> _Builder:
    builder = _Builder(random)
    planar = random.randint(0, 2)
    domains = [random.choice(sorted(ACROSS)) for _ in range(random.randint(planar == 0, 4))]
    for _ in range(planar):
        builder.add_planar()
    for domain in domains[: MAX_COORDINATES - 2 * planar]:
        builder.add_scalar(domain)
    couplings = (
        lambda: builder.add_motor(reciprocal=reciprocal),
        builder.add_transformer,
        builder.add_geared_tip,
        lambda: builder.add_gyrator(reciprocal=reciprocal),
        builder.add_piston,
        builder.add_planetary_gear,
        builder.add_coupled_inductors,
        *(() if reciprocal else (builder.add_active,)),
    )
    for _ in range(random.randint(0, 3)):
        builder.add_extra()
    for _ in range(random.randint(1, 3)):
        builder.pick(couplings)()
    if builder.chance(3):
        builder.add_support()
    return builder


def networks(random: Random) -> Network:
    """Return a network of any elements, with signals, blocks and sources."""
    builder = _passive_part(random, reciprocal=False)
    if builder.chance(3):
        for _ in range(2):
            builder.add_scalar("electrical")
        builder.add_active()
    inputs, signals = [], []
    if builder.chance(2):
        signals = builder.add_signals("U_1")
        sources = [builder.add_source(signals[-1][0]) for _ in range(random.randint(1, 2))]
        if any(sources):
            inputs.append(Input("U_1"))
        else:  # every source would have shorted another
            signals, builder.blocks = [], []
    elif builder.chance(4) and builder.add_source("U_1"):
        inputs.append(Input("U_1"))
    if not inputs or builder.chance(3):
        inputs.append(builder.add_input(len(inputs) + 1))
    driven = inputs[0].nodes or builder.elements[-1].port("at")  # the last source, of a free input
    start = next(
        name for name in builder.coordinates if name.partition(".")[0] == driven[0].partition(".")[0]
    )
    outputs = [builder.add_output(start) for _ in range(random.randint(1, 2))]
    if signals and builder.chance(3):
        outputs.append((Term(builder.pick(signals)[0]),))
    return builder.network(inputs, outputs, signals)


def passive_networks(random: Random) -> Network:
    """Return a network without sources of power other than its one input; its output is at that input."""
    builder = _passive_part(random, reciprocal=True)
    node = builder.pick(builder.moving(builder.coordinates))
    driven = Input("U_1", INPUT_KEYS[builder.coordinates[node]], (node,))
    return builder.network([driven], [(Term(node),)])


def reciprocal_networks(random: Random) -> Network:
    """Return a passive network with inputs U_1, U_2 and the outputs Y_1, Y_2 that belong to them.

    Both are mechanical or both electrical, and no gyrator stands between two ports of one kind, so that
    Y_2/U_1 = Y_1/U_2.
    """
    builder = _passive_part(random, reciprocal=True)
    groups = [builder.of("translation", "rotation"), builder.of("electrical", "acoustic")]
    nodes = builder.moving(builder.pick([group for group in groups if group]))
    first = builder.pick(nodes)
    pair = [first, builder.pick([name for name in builder.linked(first) if name in nodes])]
    inputs = [
        Input(f"U_{i}", INPUT_KEYS[builder.coordinates[node]], (node,)) for i, node in enumerate(pair, 1)
    ]
    return builder.network(inputs, [(Term(node),) for node in pair])


# ------------------------------------------------------------------------------ beams, rods, shafts, strings

CARRIED = ("beam", "axial", "shaft")
"""What the members of a network carry: bending, displacements along or across a line, angles."""
MEMBERS = ("beam", "rod", "shaft", "string")
UNITS = {
    "rho": "kg/m^3", "l": "m", "eta": "s", "G": "Pa", "A": "m^2", "N": "N", "E": "Pa", "I": "m^4", "J": "m^4",
}  # fmt: skip
LUMPS = (("spring", "damper", "mass"), ("torsion_spring", "rotary_damper", "inertia"))
"""By the power of s in force or torque per displacement or angle."""


def random_members(seed: int, most: int = 12) -> Network:
    """Return a network of two to so many members, driven at one node by F and read at another as X."""
    random = Random(seed)
    kind = CARRIED[seed % len(CARRIED)]
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
    parts = [*members, *(_lump(random, kind, random.choice(free)) for _ in range(random.randint(0, 4)))]
    force, per, blocks = ("torque", "N*m/rad", ()) if kind == "shaft" else ("force", "N/m", ())
    if random.random() < 0.3:  # a source, minus a gain times the late displacement of a node
        gain, delay = f"{random.randint(1, 90)}", f"0.00{random.randint(1, 9)}"
        at, sensor = random.choice(free), random.choice(free)
        fed_back = Term(sensor, -1, (Parameter("K", gain, per),), blocks=("D",))
        parts.append(Element(f"{force}_source", "loop", (("at", (at,)),), source=(fed_back,)))
        blocks = (Element("delay", "D", values=(("T", Parameter("T", delay, "s")),)),)
    driven, read = random.choice(free), random.choice(free)
    parts = [replace(part, name=part.name or f"part_{n}") for n, part in enumerate(parts)]
    domain = "rotation" if kind == "shaft" else "translation"
    return Network(
        tuple((node, domain) for node in free),
        tuple(parts),
        (Input("F", force, (driven,)),),
        (("X", (Term(read),)),),
        blocks=blocks,
    )


def _member(random: Random, kind: str, ends: tuple[str, str]) -> Element:
    values = {"rho": f"{random.randint(1, 8)}000", "l": f"0.{random.randint(2, 9)}"}
    if random.random() < 0.3 and kind != "axial":
        values["eta"] = f"{random.randint(1, 9)}e-5"
    if random.random() < 0.2:
        values["k_f"] = f"{random.randint(1, 9)}00"
    theory = ""
    if kind == "shaft":
        values |= {"G": f"{random.randint(2, 8)}e10", "J": f"{random.randint(1, 9)}e-10"}
    else:
        values["A"] = f"{random.randint(1, 9)}e-5"
    if kind == "axial":
        kind, key = ("string", "N") if random.random() < 0.5 else ("rod", "E")
        values[key] = f"{random.randint(1, 9)}{'00' if key == 'N' else 'e8'}"
    elif kind == "beam":
        values |= {"E": f"{random.randint(5, 20)}e10", "I": f"{random.randint(1, 9)}e-10"}
        theory = random.choice(("euler-bernoulli", "rayleigh", "timoshenko"))
        if theory == "timoshenko":
            values |= {"G": f"{random.randint(2, 8)}e10", "kappa": "0.85"}
    units = UNITS | {"k_f": "N*m/m" if kind == "shaft" else "N/m^2", "kappa": ""}
    given = tuple((key, Parameter("", number, units[key])) for key, number in values.items())
    return Element(kind, "", (("between", ends),), given, theory=theory)


def _lump(random: Random, carried: str, node: str) -> Element:
    power = random.randint(0, 2)
    is_turning = carried == "shaft" or (carried == "beam" and random.random() < 0.4)
    kind = LUMPS[is_turning][power]
    number = (f"{random.randint(1, 90)}0", f"0.{random.randint(1, 9)}", f"0.0{random.randint(1, 9)}")[power]
    at = f"{node}.theta" if is_turning and carried == "beam" else node
    key, unit = ONE_TERMINAL[kind][1:] if power == 2 else TWO_TERMINAL[kind][1:3]
    ports = (("at", (at,)),) if power == 2 else (("between", (at, GROUND)),)
    return Element(kind, "", ports, ((key, Parameter("", number, unit)),))


# ------------------------------------------------------------------------------- anything, sound or not

MEMBER_VALUES = 'E = "E", I = "I", rho = "rho", A = "A", l = "l"'
ANY_HEAD = """symflex = 1
[parameters]
E = "70 GPa"
I = "1e-9 m^4"
rho = "2700 kg/m^3"
A = "1e-4 m^2"
l = "0.8 m"
N_w = "9 N"
k_1 = { value = "95 kN/m", latex = 'k_{\\mathrm{long,one}}' }
"""


PARTS = (
    'type = "mass", at = "{moving}", m = "{n} kg"',
    'type = "spring", between = {moving_2}, k = "{stiffness}"',
    'type = "damper", between = {moving_2}, b = "{n} N*s/m"',
    'type = "spring", between = {t_2}, k = "k_1*2"',
    'type = "inertia", at = "{theta}", J = "{n} kg*m^2"',
    'type = "torsion_spring", between = {theta_2}, k = "2 N*m/rad"',
    'type = "rotary_damper", between = {theta_2}, b = "2 N*m*s/rad"',
    'type = "resistor", between = {v_2}, R = "2 Ohm"',
    'type = "inductor", between = {v_2}, L = "2 mH"',
    'type = "capacitor", between = {v_2}, C = "2 uF"',
    'type = "dc_motor", terminals = {v_2}, shaft = "{r}", k_t = "0.1 N*m/A"',
    'type = "transformer", from = "{r}", to = "{t}", ratio = "3 mm/rad"',
    'type = "transformer", from = "{r}", to = "{r}", ratio = 3',
    'type = "gyrator", from = "{v}", to = "{t}", ratio = 3',
    'type = "piezo", terminals = {v_2}, between = {t_2}, alpha = "12 N/V"',
    'type = "voice_coil", terminals = {v_2}, mover = {t_2}, R = "2 Ohm", k_f = "3 N/A"',
    'type = "dc_motor", terminals = {v_2}, shaft = {r_2}, R = "2 Ohm", k_t = "0.1 N*m/A"',
    'type = "planetary_gear", sun = "{r}", ring = "{r}", carrier = "{r}", rho = 3',
    'type = "transformer", from = {r_2}, to = {r_2}, ratio = 3',
    'type = "coupled_inductors", terminals = ["{v}", "ground", "ground", "{v}"], L_1 = 1, L_2 = 2, M = 1',
    'type = "op_amp", inputs = {v_2}, out = "{v}"',
    'type = "vcvs", inputs = {v_2}, terminals = {v_2}, mu = 3',
    'type = "vccs", inputs = {v_2}, terminals = {v_2}, g = "3 A/V"',
    'type = "ccvs", inputs = {v_2}, terminals = {v_2}, r = "3 Ohm"',
    'type = "cccs", inputs = {v_2}, terminals = {v_2}, beta = 3',
    'type = "acoustic_mass", between = {b_2}, M = "2 kg/m^4"',
    'type = "acoustic_resistance", between = {b_2}, R = "2 Pa*s/m^3"',
    'type = "acoustic_compliance", at = "{b}", C = "2 m^3/Pa"',
    'type = "piston", mover = "{moving}", chamber = {b_2}, A = "3 cm^2"',
    'type = "pressure_source", at = "{b}", p = "u"',
    'type = "flow_source", between = {b_2}, q = "u"',
    f'type = "beam", between = {{p_2}}, {MEMBER_VALUES}',
    'type = "massless_beam", between = {p_2}, EI = "2 N*m^2", l = "l"',
    'type = "rigid_link", between = {p_2}, length = "0.1 m"',
    'type = "rigid_body", at = "{p}", m = "2 kg", J = "1 kg*m^2", cg = "0.1 m"',
    'type = "rod", between = {t_2}, E = "E", A = "A", rho = "rho", l = "l"',
    'type = "string", between = {t_2}, N = "9 N", A = "A", rho = "rho", l = "l"',
    'type = "shaft", between = {r_2}, G = "E", J = "I", rho = "rho", l = "l"',
    'type = "{support}", at = "{p}"',
    'type = "{support}", between = {p_2}',
    'type = "fixed", at = "{t}"',
    'type = "force_source", at = "{moving}", f = "{signal}"',
    'type = "torque_source", at = "{theta}", tau = "3*u"',
    'type = "voltage_source", at = "{v}", v = "u"',
    'type = "current_source", between = {v_2}, i = "u"',
    f'type = "frame", between = {{q_2}}, {MEMBER_VALUES}, angle = "{{angle}} deg"',
)
CHOSEN = {
    "n": range(1, 10),
    "stiffness": ("k_1", "3 N/m"),
    "support": ("pin", "slider", "fixed"),
    "signal": ("u", "-u", "2*u"),
    "angle": (0, 30, 90),
    "q": ("q_0", "q_1", "q_2"),
}


class _Chosen(dict):
    """What parts ask for, chosen anew each time: a node, or with ``_2`` a pair; IndexError without one."""

    rng: Random

    def __missing__(self, key: str) -> object:
        options = self[f"{key.removesuffix('_2')}s"]
        return _pair(self.rng, options) if key.endswith("_2") else self.rng.choice(options)


def _pair(rng, nodes):
    one = rng.choice(nodes)
    other = rng.choice([n for n in [*nodes, "ground", "ground"] if n != one])
    ends = [one, other]
    rng.shuffle(ends)
    return f'["{ends[0]}", "{ends[1]}"]'


ENDS = {  # of a beam, at 0 or l
    "clamped": ("w({x}) = 0", "w'({x}) = 0"),
    "hinged": ("w({x}) = 0", "w''({x}) = 0"),
    "free": ("w''({x}) = 0", "w'''({x}) = 0"),
    "guided": ("w'({x}) = 0", "w'''({x}) = 0"),
    "pushed": ("w''({x}) = 0", "E*I*w'''({x}) = F_w"),
    "moved": ("w({x}) = F_w", "w'({x}) = 0"),
}
BARS = ("w({x}) = 0", "w'({x}) = 0", "E*A*w'({x}) = F_w", "w({x}) = F_w")
ANY_BLOCKS = (
    'type = "lag", T = "3 ms"',
    'type = "notch", omega = "5 Hz", zeta_p = 0.3, zeta_z = 0.01',
    'type = "low_pass", omega = "20 Hz", zeta = 0.7',
    'type = "ss", A = [[-1, 2], [0, -30]], B = [[0], [1]], C = [[1, 0]], D = [[0]]',
    'type = "integrator"',
    'type = "lead_lag", T_1 = "2 s", T_2 = "50 ms"',
    'type = "pid", k_p = 3, k_i = 2, k_d = 1, T_f = "1 ms"',
    'type = "delay", T = "7 ms"',
    'type = "tf", num = [1, 2], den = [1, 1, 3]',
    'type = "resonance", omega_p = "3 rad/s", zeta_p = 0.1, omega_z = "5 rad/s", zeta_z = 0.2',
)
DRIVEN = {
    "x": ["force", "displacement", "velocity", "acceleration"],
    "r": ["torque", "angle", "angular_velocity", "angular_acceleration"],
    "v": ["voltage", "current"],
    "b": ["pressure", "flow"],
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
    blocks = [f"{n} = {{ {rng.choice(ANY_BLOCKS)} }}" for n in own]
    shown = [rng.choice(names), f"{rng.choice(names)} - 2*u"]
    return "\n".join(("[blocks]", *blocks, "[signals]", *lines, "")), shown


def anything(seed):
    """Return the text of a model, or None; not all are sound."""
    rng = Random(seed)
    t, r, v, p, b = ([f"{letter}_{i}" for i in range(rng.randint(1, 4))] for letter in "xrvpb")
    nodes = {
        "t": t,
        "r": r,
        "v": v,
        "p": p,
        "b": b,
        "moving": [*t, *p],
        "theta": [*r, *(f"{n}.theta" for n in p)],
    }
    chosen = _Chosen({f"{key}s": options for key, options in (CHOSEN | nodes).items()})
    chosen.rng = rng
    liked = rng.sample(PARTS, rng.randint(3, 12))
    lines = []
    for i in range(rng.randint(1, 15)):
        try:
            lines.append(f"part_{i} = {{ {rng.choice(liked).format_map(chosen)} }}")
        except IndexError:  # a pair of a single node
            continue
    body = "\n".join(lines)
    used = [n for n in (*t, *r, *v, *p, *b, "q_0", "q_1", "q_2") if f'"{n}"' in body or f'"{n}.' in body]
    if not used:
        return None
    inputs, outputs, more = ["u = {}"], [], ""
    for i in range(rng.randint(1, 3)):
        node = rng.choice(used)
        others = [n for n in used if n[0] == node[0] and n != node]
        place = f'["{node}", "{rng.choice(others)}"]' if others and rng.random() < 0.3 else f'"{node}"'
        inputs.append(f"in_{i} = {{ {rng.choice(DRIVEN[node[0]])} = {place} }}")
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
    return f"{ANY_HEAD}{more}[elements]\n{body}\n[inputs]\n{chr(10).join(inputs)}\n[outputs]\n{outputs}\n"


def sound(first, count):
    """Yield so many sound models, each with its seed."""
    seed, found = first, 0
    while found < count:
        text = anything(seed)
        try:
            model = pipeline.loads(text) if text else None
        except SymflexError:
            model = None
        if model is not None:
            found += 1
            yield seed, model
        seed += 1


# ------------------------------------------------------------------ loops with functions of a gain

OF_GAIN = {
    "{}": lambda x: x,
    "sqrt({})": sqrt,
    "({})^2": lambda x: x**2,
    "({})^3": lambda x: x**3,
    "({})^(-2)": lambda x: x**-2,
    "1/({})": lambda x: 1 / x,
    "log(1 + {})": lambda x: log(1 + x),
    "log({})": log,
    "exp(-({})/2)": lambda x: exp(-x / 2),
    "exp({}) - 1": lambda x: exp(x) - 1,
    "({0})/(2 + {0})": lambda x: x / (2 + x),
    "(3 - ({0}))/(1 + ({0})^2)": lambda x: (3 - x) / (1 + x**2),
    "sqrt(4 - ({}))": lambda x: sqrt(4 - x),
    "sqrt(1 + ({})^2)": lambda x: sqrt(1 + x**2),
    "tanh({})": tanh,
    "sin({})": sin,
    "1/cosh({})": lambda x: 1 / cosh(x),
    "({0})*log({0})": lambda x: x * log(x),
}
DRIVEN_BEAM = """[elements]
drive = {{ type = "force_source", at = "x", f = "{}" }}
guide = {{ type = "slider", at = "x" }}
damper = {{ type = "damper", between = ["x", "ground"], b = "0.3 N*s/m" }}
link = {{ type = "beam", between = ["x", "t"], EI = "2 N*m^2", rhoA = "0.5 kg/m", l = "1 m", eta = "5 ms" }}
[outputs]
Y = "x"
[inputs]
r = {{ unit = "m" }}"""
LOOP = '[signals]\ny = "{}"\n[inputs]\nr = {{}}\n[outputs]\nY = "y"'


def function_of_gain(random, names):
    """Return a random function of K as an expression and to be called; definitions are added to names."""
    text, steps = "K", []
    scale = Fraction(random.choice((1, 2, 3, 5, 8, 20, -1)), random.choice((1, 1, 2, 4)))
    for _ in range(random.choice((1, 1, 2, 3))):
        form, function = random.choice(list(OF_GAIN.items()))
        steps.append(function)
        text = form.format(text)
        if random.random() < 0.5:
            names[f"d_{len(names)}"] = text
            text = list(names)[-1]

    def value(gain):
        try:
            for step in steps:
                gain = step(gain)
        except (ArithmeticError, ValueError):  # beyond doubles, or where roots of squares are not real
            return nan
        return float(scale) * gain

    return f"{scale}*({text})", value


def _polynomial(random, degree, lowest=-0.2):
    """Return descending coefficients, most of whose roots lie in the left half-plane."""
    found = np.ones(1)
    while len(found) <= degree:
        a, b = random.uniform(lowest, 3), random.uniform(0.2, 4)
        found = np.polymul(found, [1, a] if len(found) == degree or random.random() < 0.5 else [1, a, b])
    return found.round(3)


def random_loop(seed, kind):
    """Return the text of a loop, and of a gain the polynomials without and with a delay of 0.3 s."""
    random, names, places = Random(f"{kind} {seed}"), {}, []
    for _ in range(2 if kind == "two places" or (kind == "delay" and seed % 3 == 0) else 1):
        degree = random.randint(*((2, 5) if kind == "lumped" else (1, 3)))
        zeros = random.randint(0, max(0, degree - random.choice((1, 2, 2, int(kind == "delay")))))
        b = random.choice((1, 4)) * _polynomial(random, zeros, -1)
        places.append((*function_of_gain(random, names), _polynomial(random, degree), b))
    sign = "real" if kind == "lumped" and seed % 4 == 0 else "positive"
    value = random.choice((0.3, 0.7, 1.2, 1.9))
    head = f'symflex = 1\nparameters = {{ K = {{ value = {value}, assume = "{sign}" }}'
    head += ', k = "1 N/m", c = "0.2 N*s/m" }\n[definitions]\n' if kind == "beam" else " }\n[definitions]\n"
    head += "".join(f'{name} = "{text}"\n' for name, text in names.items())
    if kind == "beam":
        more = random.choice(("", f" - c*({places[0][0]})*s*x"))
        return head + DRIVEN_BEAM.format(f"k*({places[0][0]})*(r - x){more}"), None
    paths = [
        f"({f})*({'+'.join(f'({c:g})*s^{len(b) - 1 - i}' for i, c in enumerate(b))})"
        f"/({'+'.join(f'({c:g})*s^{len(a) - 1 - i}' for i, c in enumerate(a))})"
        for f, _, a, b in places
    ]
    paths[0] += "*exp(-0.3*s)*(r - y)" if kind == "delay" else "*(r - y)"
    one, other = places[0], places[-1] if len(places) > 1 else ("", lambda _: 0, np.ones(1), np.ones(1))

    def characteristic(gain):
        plain = np.polymul(one[2], np.polyadd(other[2], other[1](gain) * other[3]))
        return plain, one[1](gain) * np.polymul(one[3], other[2])

    return head + LOOP.format(f"{paths[0]}{''.join(f' - {p}*y' for p in paths[1:])}"), characteristic

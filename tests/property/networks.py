"""Random networks of every network element, as data and as the text of a specification.

A network is built as a tree from ground, so that every coordinate has a path of its own; couplings, supports
and voltage sources are added on top only while the constraints they impose stay independent. Such a network
is nonsingular at every s in the right half plane unless a signal loop happens to have a pole there.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from hypothesis import strategies as st

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

GROUND = "ground"
MAX_COORDINATES = 7

ACROSS = {"translation": "m", "rotation": "rad", "electrical": "V"}
THROUGH = {"translation": "N", "rotation": "N*m", "electrical": "A"}
INPUT_KEYS = {"translation": "force", "rotation": "torque", "electrical": "current"}

# kind: (domain, name of the value, its unit, name of the quantity it carries)
TWO_TERMINAL = {
    "spring": ("translation", "k", "N/m", "f"),
    "damper": ("translation", "b", "N*s/m", "f"),
    "torsion_spring": ("rotation", "k", "N*m/rad", "tau"),
    "rotary_damper": ("rotation", "b", "N*m*s/rad", "tau"),
    "resistor": ("electrical", "R", "ohm", "i"),
    "inductor": ("electrical", "L", "H", "i"),
    "capacitor": ("electrical", "C", "F", "i"),
}
ONE_TERMINAL = {"mass": ("translation", "m", "kg"), "inertia": ("rotation", "J", "kg*m^2")}
SOURCES = {
    "force_source": ("translation", "f", "N"),
    "torque_source": ("rotation", "tau", "N*m"),
    "current_source": ("electrical", "i", "A"),
    "voltage_source": ("electrical", "v", "V"),
}
PLANAR = ("rigid_body", "rigid_link", "massless_beam", "fixed", "slider", "pin")
COUPLINGS = ("dc_motor", "transformer", "gyrator")
ELEMENTS = (*TWO_TERMINAL, *ONE_TERMINAL, *SOURCES, *PLANAR, *COUPLINGS)
BLOCKS = ("resonance", "tf", "integrator", "lead_lag", "pid")
LISTED_PORTS = ("between", "terminals")


# ------------------------------------------------------------------------------------------------- data


@dataclass(frozen=True, slots=True)
class Parameter:
    """A named value of ``tenths``/10 in a unit; no unit means a plain number."""

    name: str
    tenths: int
    unit: str = ""

    @property
    def value(self) -> np.longdouble:
        """The value in SI units, correctly rounded."""
        return np.longdouble(self.tenths) / 10

    @property
    def toml(self) -> str:
        """The value as a specification writes it."""
        number = f"{self.tenths // 10}.{self.tenths % 10}"
        return f'"{number} {self.unit}"' if self.unit else number


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
    """One element; ``source`` is a source's value."""

    kind: str
    name: str
    ports: tuple[tuple[str, tuple[str, ...]], ...]
    values: tuple[tuple[str, Parameter], ...] = ()
    source: tuple[Term, ...] = ()

    @property
    def nodes(self) -> frozenset[str]:
        """The nodes it touches, ground aside, planar ones without their axes."""
        found = (node.partition(".")[0] for _, nodes in self.ports for node in nodes)
        return frozenset(found) - {GROUND}

    def port(self, key: str) -> tuple[str, ...]:
        """Return the nodes of a port."""
        return dict(self.ports)[key]

    def value(self, key: str) -> np.longdouble:
        """Return a value, zero when it is not given."""
        found = dict(self.values).get(key)
        return np.longdouble(0) if found is None else found.value


@dataclass(frozen=True, slots=True)
class Block:
    """One block; a ``tf`` is (1 + T_1 s)/((1 + T_2 s)(1 + T_3 s))."""

    kind: str
    name: str
    values: tuple[tuple[str, Parameter], ...]

    def value(self, key: str, default: int = 0) -> np.longdouble:
        """Return a value, or the default when it is not given."""
        found = dict(self.values).get(key)
        return np.longdouble(default) if found is None else found.value


@dataclass(frozen=True, slots=True)
class Input:
    """An input: ``key`` is force, torque, current, voltage, or empty for a free signal."""

    name: str
    key: str = ""
    nodes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Network:
    """A whole model. ``coordinates`` maps each scalar coordinate to its domain."""

    coordinates: tuple[tuple[str, str], ...]
    elements: tuple[Element, ...]
    inputs: tuple[Input, ...]
    outputs: tuple[tuple[str, tuple[Term, ...]], ...]
    signals: tuple[tuple[str, tuple[Term, ...]], ...] = ()
    blocks: tuple[Block, ...] = ()

    @property
    def kinds(self) -> frozenset[str]:
        """The element and block types that occur."""
        return frozenset(e.kind for e in self.elements) | frozenset(b.kind for b in self.blocks)

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Every parameter once, in the order of use."""
        sums = [
            *(e.source for e in self.elements),
            *(t for _, t in self.signals),
            *(t for _, t in self.outputs),
        ]
        used = [p for part in (*self.elements, *self.blocks) for _, p in part.values]
        used += [gain for terms in sums for term in terms for gain in term.gains]
        return tuple(dict.fromkeys(used))

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
    lines = ["symflex = 1", 'title   = "A random network"', "", "[parameters]"]
    lines += [f"{parameter.name} = {parameter.toml}" for parameter in network.parameters]
    lines += ["", "[elements]", *(_element_line(element) for element in network.elements)]
    if network.signals:
        lines += ["", "[signals]", *(f'{name} = "{sum_text(terms)}"' for name, terms in network.signals)]
    if network.blocks:
        lines += ["", "[blocks]", *(_block_line(block) for block in network.blocks)]
    lines += ["", "[inputs]", *(_input_line(entry) for entry in network.inputs)]
    lines += ["", "[outputs]", *(f'{name} = "{sum_text(terms)}"' for name, terms in network.outputs)]
    return "\n".join(lines) + "\n"


def _nodes_text(nodes: tuple[str, ...], *, listed: bool) -> str:
    quoted = [f'"{node}"' for node in nodes]
    return f"[{', '.join(quoted)}]" if listed else quoted[0]


def _element_line(element: Element) -> str:
    parts = [f'type = "{element.kind}"']
    parts += [f"{key} = {_nodes_text(nodes, listed=key in LISTED_PORTS)}" for key, nodes in element.ports]
    parts += [f'{key} = "{parameter.name}"' for key, parameter in element.values]
    if element.source:
        parts.append(f'{SOURCES[element.kind][1]} = "{sum_text(element.source)}"')
    return f"{element.name} = {{ {', '.join(parts)} }}"


def _block_line(block: Block) -> str:
    names = {key: parameter.name for key, parameter in block.values}
    if block.kind == "tf":
        names = {
            "num": f"1 + {names['T_1']}*s",
            "den": f"(1 + {names['T_2']}*s)*(1 + {names['T_3']}*s)",
        }
    parts = [f'type = "{block.kind}"', *(f'{key} = "{text}"' for key, text in names.items())]
    return f"{block.name} = {{ {', '.join(parts)} }}"


def _input_line(entry: Input) -> str:
    if not entry.key:
        return f"{entry.name} = {{}}"
    return f"{entry.name} = {{ {entry.key} = {_nodes_text(entry.nodes, listed=len(entry.nodes) > 1)} }}"


# --------------------------------------------------------------------------------------------- strategies


@dataclass
class _Builder:
    """What has been drawn so far; lives only while one network is drawn."""

    draw: Callable
    coordinates: dict[str, str] = field(default_factory=dict)
    planar: list[str] = field(default_factory=list)
    sprung: set[str] = field(default_factory=set)
    elements: list[Element] = field(default_factory=list)
    blocks: list[Block] = field(default_factory=list)
    pool: list[Parameter] = field(default_factory=list)
    constraints: list[dict[str, complex]] = field(default_factory=list)

    def chance(self, one_in: int) -> bool:
        return self.draw(st.integers(0, one_in - 1)) == one_in - 1

    def pick(self, options: Sequence) -> object:
        return self.draw(st.sampled_from(list(options)))

    def parameter(self, unit: str) -> Parameter:
        """Return a new parameter, or now and then one that is already in use."""
        known = [p for p in self.pool if p.unit == unit]
        if known and self.chance(5):
            return self.pick(known)
        new = Parameter(f"g_{len(self.pool) + 1}", self.draw(st.integers(2, 40)), unit)
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

    def add(self, kind: str, ports: dict, values: dict, source: tuple[Term, ...] = ()) -> Element:
        number = 1 + sum(element.kind == kind for element in self.elements)
        ports = {key: (nodes,) if isinstance(nodes, str) else tuple(nodes) for key, nodes in ports.items()}
        new = Element(kind, f"{kind}_{number}", tuple(ports.items()), tuple(values.items()), source)
        self.elements.append(new)
        return new

    def constrain(self, *rows: dict[str, complex]) -> bool:
        """Keep the rows if they are independent of those kept before; say whether they are."""
        order = list(self.coordinates)
        kept = [*self.constraints, *rows]
        matrix = np.array([[row.get(name, 0) for name in order] for row in kept])
        if np.linalg.matrix_rank(matrix, tol=1e-6) < len(kept):
            return False
        self.constraints.extend(rows)
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
            self.add("fixed", {"at": name}, {})
            self.add_body(name)
        elif way == "beam":
            self.add_beam(self.pick(self.planar), name)
        else:
            other, length = self.pick(self.planar), self.parameter("m")
            self.constrain(
                {y: 1, f"{other}.y": -1, f"{other}.theta": -float(length.value)},
                {theta: 1, f"{other}.theta": -1},
            )
            self.add("rigid_link", {"between": (other, name)}, {"length": length})
        self.planar.append(name)

    def add_body(self, name: str) -> None:
        values = {"m": self.parameter("kg"), "J": self.parameter("kg*m^2")}
        if self.chance(2):
            values["cg"] = self.parameter("m")
        self.add("rigid_body", {"at": name}, values)

    def add_beam(self, a: str, b: str) -> None:
        values = {"EI": self.parameter("N*m^2"), "l": self.parameter("m")}
        self.add("massless_beam", {"between": (a, b)}, values)

    def add_scalar(self, domain: str) -> None:
        letter = {"translation": "x", "rotation": "a", "electrical": "v"}[domain]
        name = f"{letter}_{1 + sum(n.startswith(letter) for n in self.coordinates)}"
        others = self.moving(self.of(domain))
        reached = [GROUND] if not others or self.chance(4) else others
        self.coordinates[name] = domain
        if domain != "electrical" and self.chance(4):
            self.add_one_terminal({"translation": "mass", "rotation": "inertia"}[domain], name)
        else:
            kinds = [kind for kind, entry in TWO_TERMINAL.items() if entry[0] == domain]
            self.add_two_terminal(self.pick(kinds), name, self.pick(reached))

    def add_two_terminal(self, kind: str, a: str, b: str) -> None:
        _, key, unit, _ = TWO_TERMINAL[kind]
        ends = [self.port(node) for node in ((a, b) if self.chance(2) else (b, a))]
        self.add(kind, {"between": ends}, {key: self.parameter(unit)})

    def add_one_terminal(self, kind: str, node: str) -> None:
        _, key, unit = ONE_TERMINAL[kind]
        self.add(kind, {"at": self.port(node)}, {key: self.parameter(unit)})

    def add_extra(self) -> None:
        """Add an element between coordinates that are there."""
        kind = self.pick((*TWO_TERMINAL, *ONE_TERMINAL, "rigid_body", "massless_beam"))
        if kind in ONE_TERMINAL and self.of(ONE_TERMINAL[kind][0]):
            self.add_one_terminal(kind, self.pick(self.of(ONE_TERMINAL[kind][0])))
        elif kind in TWO_TERMINAL and self.of(TWO_TERMINAL[kind][0]):
            nodes = self.of(TWO_TERMINAL[kind][0])
            a = self.pick(nodes)
            self.add_two_terminal(kind, a, self.pick([GROUND, *(n for n in nodes if n != a)]))
        elif kind == "rigid_body" and self.planar:
            self.add_body(self.pick(self.planar))
        elif kind == "massless_beam" and len(self.planar) > 1:
            self.add_beam(*self.draw(st.permutations(self.planar))[:2])

    # -- couplings and supports

    def add_motor(self, *, reciprocal: bool) -> None:
        shafts, terminals = self.of("rotation"), self.of("electrical")
        if not shafts or not terminals:
            return
        a = self.pick(terminals)
        b = self.pick([GROUND, *(n for n in terminals if n != a)])
        values = {"R": self.parameter("ohm"), "k_t": self.parameter("N*m/A")}
        if self.chance(2):
            values["L"] = self.parameter("H")
        if not reciprocal and self.chance(2):
            values["k_e"] = self.parameter("V*s/rad")
        ends = (a, b) if self.chance(2) else (b, a)
        self.add("dc_motor", {"terminals": ends, "shaft": self.pick(shafts)}, values)

    def add_transformer(self) -> None:
        groups = (("translation", "rotation"), ("electrical",))
        nodes = self.of(*self.pick(groups))
        if len(nodes) < 2:
            return
        source, target = self.draw(st.permutations(nodes))[:2]
        self.transform(source, target)

    def transform(self, source: str, target: str) -> None:
        above, below = (ACROSS[self.coordinates[name]] for name in (target, source))
        ratio = self.parameter("" if above == below else f"{above}/{below}")
        if self.constrain({target: 1, source: -float(ratio.value)}):
            self.add("transformer", {"from": source, "to": target}, {"ratio": ratio})

    def add_geared_tip(self) -> None:
        """Add a node that only a transformer reaches."""
        source = self.pick(self.of("translation", "rotation") or [None])
        if source is not None:
            name = f"x_{1 + sum(n.startswith('x') for n in self.coordinates)}"
            self.coordinates[name] = "translation"
            self.transform(source, name)

    def add_gyrator(self, *, reciprocal: bool) -> None:
        nodes = list(self.coordinates)
        if len(nodes) < 2:
            return
        source, target = self.draw(st.permutations(nodes))[:2]
        domains = (self.coordinates[source], self.coordinates[target])
        electrical = domains.count("electrical")
        if reciprocal and electrical != 1:
            return
        effort = {**THROUGH, "electrical": "V"}[domains[0]]
        flow = {"translation": "m", "rotation": "rad", "electrical": "A"}[domains[1]]
        ratio = self.parameter(f"{effort}/A" if flow == "A" else f"{effort}*s/{flow}")
        if electrical == 1:  # ties a voltage to a velocity
            voltage, motion = (source, target) if domains[0] == "electrical" else (target, source)
            if not self.constrain({voltage: 1, motion: -float(ratio.value) * (0.83 + 0.47j)}):
                return
        self.add("gyrator", {"from": source, "to": target}, {"ratio": ratio})

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
            self.add(kind, {"at": node}, {})

    # -- signals

    def add_block(self) -> tuple[str, tuple[Parameter, ...]]:
        """Return a new dimensionless block, with the gain that makes it so."""
        kind, gains = self.pick(BLOCKS), ()
        if kind == "resonance":
            units = {"omega_p": "rad/s", "zeta_p": "", "omega_z": "rad/s", "zeta_z": ""}
        elif kind == "tf":
            units = {"T_1": "s", "T_2": "s", "T_3": "s"}
        elif kind == "lead_lag":
            units = {"T_1": "s", "T_2": "s"} | ({"k": ""} if self.chance(2) else {})
        elif kind == "pid":
            given = self.pick(({}, {"k_i": "1/s"}, {"k_d": "s", "T_f": "s"}, {"k_i": "1/s", "k_d": "s"}))
            units = {"k_p": "", **given}
        elif self.chance(2):
            units = {"k": "1/s"}
        else:
            units, gains = {}, (self.parameter("1/s"),)
        values = tuple((key, self.parameter(unit)) for key, unit in units.items())
        self.blocks.append(Block(kind, f"B_{len(self.blocks) + 1}", values))
        return self.blocks[-1].name, gains

    def measured(self, unit: str, sign: int) -> Term:
        """Return a coordinate, velocity, or through quantity times a gain that gives it ``unit``."""
        carried = [e for e in self.elements if e.kind in TWO_TERMINAL or e.kind == "dc_motor"]
        if carried and self.chance(3):
            element = self.pick(carried)
            domain, quantity = "electrical", "i"
            if element.kind in TWO_TERMINAL:
                domain, _, _, quantity = TWO_TERMINAL[element.kind]
            per = {"translation": "N", "rotation": "N/m", "electrical": "A"}[domain]  # dividing by N*m
            gain = self.parameter(f"{unit}/{per}")
            return Term(f"{element.name}.{quantity}", sign, (gain,))
        name = self.pick(self.coordinates)
        power = self.draw(st.integers(0, 1))
        gain = self.parameter(f"{unit}{'*s' * power}/{ACROSS[self.coordinates[name]]}")
        return Term(name, sign, (gain,), power)

    def add_signals(self, free: str) -> list[tuple[str, tuple[Term, ...]]]:
        """Return a chain of signals in volts: the first takes the input, the others the one before."""
        signals: list[tuple[str, tuple[Term, ...]]] = []
        length = self.draw(st.integers(1, 3))
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
        if kind == "voltage_source":
            if not self.constrain({node: 1}):
                return False
        elif self.chance(2):
            terms.append(self.measured(unit, -1))
        self.add(kind, {"at": self.port(node)}, {}, tuple(terms))
        return True

    def add_input(self, number: int) -> Input:
        """Return an input that acts on the network directly."""
        node = self.pick(self.moving(self.coordinates))
        domain = self.coordinates[node]
        if domain == "electrical" and self.chance(2) and self.constrain({node: 1}):
            return Input(f"U_{number}", "voltage", (node,))
        others = [name for name in self.of(domain) if name != node]
        pair = (self.pick(others),) if others and self.chance(3) else ()
        return Input(f"U_{number}", INPUT_KEYS[domain], tuple(self.port(end) for end in (node, *pair)))

    def add_output(self, driven: str) -> tuple[Term, ...]:
        """Return what an output shows, mostly of what ``driven`` is connected to."""
        near = list(self.coordinates) if self.chance(8) else self.linked(driven)
        nodes = {name.partition(".")[0] for name in near}
        carried = [e for e in self.elements if e.kind in TWO_TERMINAL or e.kind == "dc_motor"]
        carried = [e for e in carried if e.nodes & nodes]
        if carried and self.chance(4):
            element = self.pick(carried)
            quantity = TWO_TERMINAL[element.kind][3] if element.kind in TWO_TERMINAL else "i"
            return (Term(f"{element.name}.{quantity}"),)
        name = self.pick(self.moving(near))
        power = self.draw(st.integers(0, 2))
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


def _passive_part(builder: _Builder, *, reciprocal: bool) -> None:
    draw = builder.draw
    planar = draw(st.integers(0, 2))
    domains = draw(st.lists(st.sampled_from(sorted(ACROSS)), min_size=planar == 0, max_size=4))
    for _ in range(planar):
        builder.add_planar()
    for domain in domains[: MAX_COORDINATES - 2 * planar]:
        builder.add_scalar(domain)
    couplings = (
        lambda: builder.add_motor(reciprocal=reciprocal),
        builder.add_transformer,
        builder.add_geared_tip,
        lambda: builder.add_gyrator(reciprocal=reciprocal),
    )
    for _ in range(draw(st.integers(0, 3))):
        builder.add_extra()
    for _ in range(draw(st.integers(1, 3))):
        builder.pick(couplings)()
    if builder.chance(3):
        builder.add_support()


@st.composite
def networks(draw: Callable) -> Network:
    """Draw a network of any elements, with signals, blocks and sources."""
    builder = _Builder(draw)
    _passive_part(builder, reciprocal=False)
    inputs, signals = [], []
    if builder.chance(2):
        signals = builder.add_signals("U_1")
        sources = [builder.add_source(signals[-1][0]) for _ in range(draw(st.integers(1, 2)))]
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
    outputs = [builder.add_output(start) for _ in range(draw(st.integers(1, 2)))]
    if signals and builder.chance(3):
        outputs.append((Term(builder.pick(signals)[0]),))
    return builder.network(inputs, outputs, signals)


@st.composite
def passive_networks(draw: Callable) -> Network:
    """Draw a network without sources of power other than its one input; its output is at that input."""
    builder = _Builder(draw)
    _passive_part(builder, reciprocal=True)
    node = builder.pick(builder.moving(builder.coordinates))
    driven = Input("U_1", INPUT_KEYS[builder.coordinates[node]], (node,))
    return builder.network([driven], [(Term(node),)])


@st.composite
def reciprocal_networks(draw: Callable) -> Network:
    """Draw a passive network with inputs U_1, U_2 and the outputs Y_1, Y_2 that belong to them.

    Both are mechanical or both electrical, and no gyrator stands between two ports of one kind, so that
    Y_2/U_1 = Y_1/U_2.
    """
    builder = _Builder(draw)
    _passive_part(builder, reciprocal=True)
    groups = [builder.of("translation", "rotation"), builder.of("electrical")]
    nodes = builder.moving(builder.pick([group for group in groups if group]))
    first = builder.pick(nodes)
    pair = [first, builder.pick([name for name in builder.linked(first) if name in nodes])]
    inputs = [
        Input(f"U_{i}", INPUT_KEYS[builder.coordinates[node]], (node,)) for i, node in enumerate(pair, 1)
    ]
    return builder.network(inputs, [(Term(node),) for node in pair])

"""A statement where it is placed: its nodes, its values and its currents, written into the circuit.

A subcircuit's statement is placed once for every instance. What it reads of others, the current through a
source for instance, is known only when all statements have been placed.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Container, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Final

from symflex.errors import nearest
from symflex.expressions import Attribute, Expression, Name, names, number, product_of, sum_of
from symflex.expressions.nodes import negative
from symflex.model.spec.netlist.cards import Card, Deck
from symflex.model.spec.netlist.circuit import Circuit
from symflex.model.spec.netlist.expressions import exactly, number_of
from symflex.model.spec.netlist.scopes import NOMINAL, Lookup, Scope, Values

HARMLESS: Final = frozenset(
    "ic noisy noiseless noisetemp noiseflow dcvar dcvarlot vinit iinit tol pwr irms ipk mfg pn type v".split()
)
"""What may stand behind the value of a component without changing its small signals."""
AT_ONE: Final = frozenset(("m", "scale"))  # what changes nothing where it is 1
APART: Final = "write what it stands for as components of their own"


@dataclass(frozen=True)
class Coil:
    """An inductor."""

    name: str
    ends: tuple[str, str]
    value: Expression


@dataclass(frozen=True)
class CoupledPair:
    """What a line K says of two inductors, by their paths."""

    card: Card
    name: str
    pair: tuple[str, str]
    factor: Expression


@dataclass(frozen=True)
class IndependentSource:
    """A source V or I."""

    name: str
    path: str
    letter: str
    ends: tuple[str, str]
    card: Card
    kind: str  # "ac", "moves" or "rests"


@dataclass
class Build:
    """What has been built of a netlist."""

    deck: Deck
    circuit: Circuit = field(default_factory=Circuit)
    nominal: Expression = field(default_factory=lambda: number(NOMINAL))
    paths: set[str] = field(default_factory=set)  # of components
    windings: dict[str, Coil] = field(default_factory=dict)  # by path
    couplings: list[CoupledPair] = field(default_factory=list)
    sources: list[IndependentSource] = field(default_factory=list)
    currents: dict[str, Expression] = field(default_factory=dict)  # by path, into the first node
    later: list[Callable[[], None]] = field(default_factory=list)  # what reads currents and voltages
    shared: set[str] = field(default_factory=set)  # nodes of .global

    def __post_init__(self) -> None:
        self.values = Values(self.circuit, self.deck)


@dataclass(frozen=True)
class PlacedCard:
    """A statement in a scope."""

    build: Build
    card: Card
    scope: Scope

    @property
    def word(self) -> str:
        """Its first word, as messages show it."""
        return self.card.words[0][:40]

    @property
    def letter(self) -> str:
        """The first letter of its first word, which says what it is."""
        return self.card.words[0][0].upper()

    @property
    def path(self) -> str:
        """What it is called among all components, in small letters: ``x1.r1``."""
        return self.scope.path + self.card.keyword

    def element(self, suffix: str = "") -> str:
        """Return a new name for an element that comes from it."""
        return self.build.circuit.element(f"{self.scope.prefix}{self.card.words[0]}{suffix}")

    def add(self, name: str, table: Mapping[str, object]) -> None:
        """Add an element to the circuit."""
        self.build.circuit.add("elements", name, table, self.card)

    def carries(self, current: Expression, path: str = "") -> None:
        """Tell the current into its first node, as SPICE counts it."""
        self.build.currents[path or self.path] = current

    def node(self, word: str) -> str:
        """Return the name of a node."""
        key, scope = word.lower(), self.scope
        if key in ("0", "gnd"):
            return "ground"
        if key in scope.nodes:
            return scope.nodes[key]
        is_shared = key in self.build.shared or key.startswith("$g_")
        path, prefix = ("", "") if is_shared else (scope.path, scope.prefix)
        return self.build.circuit.node(path + key, prefix + word)

    def nodes(self, first: int, count: int) -> list[str]:
        """Return the nodes that its words name, from one on."""
        words = self.card.words[first : first + count]
        if len(words) < count or any("=" in w for w in words):
            raise self.card.refuse(f"'{self.word}' needs {count} nodes")
        return [self.node(w) for w in words]

    def touched(self, word: str) -> str:
        """Return the name of a node that a component touches: of its scope, or ``x1.a`` of an instance."""
        key, known = word.lower().replace(":", "."), self.build.circuit.nodes
        inner = self.scope.nodes.get(key) or known.get(self.scope.path + key)
        name = "ground" if key in ("0", "gnd") else inner or known.get(key)
        if name is None:
            raise self.card.refuse(f"no component touches '{word[:40]}'", nearest(key, known))
        return name

    def current(self, word: str) -> Expression:
        """Return the current through a component, into its first node as SPICE counts it."""
        key, known = word.lower().replace(":", "."), self.build.currents
        inner = key.partition(".")[2] if re.match(r"[a-z]\.", key) else key  # v.x1.vs is Vs of X1
        found = known.get(self.scope.path + key) or known.get(inner)
        if found is None:
            hint = nearest(key, known) or "insert a voltage source of 0 V, and name it"
            raise self.card.refuse(f"no voltage source '{word[:40]}' measures a current", hint)
        return found

    def number(self, text: str) -> Expression:
        """Return a value without a unit: a number, or an expression of parameters."""
        written = number_of(self.card, text)
        if written is not None:
            return number(exactly(*written))
        if text[:1] in "{'\"" or re.fullmatch(r"[A-Za-z_]\w*", text, re.A):
            return self.build.values.expression(self.card, text, self.scope)
        hint = "write a number with a suffix, 4.7k or 10meg, or an expression in braces, {2*R}"
        raise self.card.refuse(f"'{text[:60]}' is not a value", hint)

    def valued(self, name: str, text: str, unit: str, factor: Expression | None = None) -> Expression:
        """Return a parameter of the component's name for a constant, or the expression that is its value."""
        circuit = self.build.circuit
        found = Lookup(self.build.values, self.card, self.scope).found(text.lower())
        if text.lower() == self.card.keyword and found is None:  # R1 a b R1: a value without a number
            value: Expression = circuit.symbol(circuit.value_name(name), unit, self.card)
            return value if factor is None else product_of([value, factor])
        value = self.number(text)
        written = number_of(self.card, text)
        if factor is not None:
            value, written = product_of([value, factor]), None
        return self.named(name, value, written, unit)

    def named(self, name: str, value: Expression, written: tuple[str, str] | None, unit: str) -> Expression:
        """Return a parameter for a constant, with its digits as they were written, or else the expression."""
        circuit = self.build.circuit
        return (
            value
            if names(value)
            else circuit.assign(circuit.value_name(name), value, self.card, written, unit)
        )

    def size(self, text: str) -> Fraction | None:
        """Return the number that a word is."""
        found = number_of(self.card, text)
        return None if found is None else exactly(*found)

    def check(
        self, plain: Sequence[str], given: Mapping[str, Sequence[str]], known: Container[str] = ()
    ) -> None:
        """Refuse what stands behind a value and would change it."""
        what = f"of '{self.word}' is not read"
        for key, values in given.items():
            size = None if key in HARMLESS else self.size(values[0])
            changes_nothing = (key in AT_ONE and size == 1) or (key[0] in "rlc" and size == 0)
            if not (key in HARMLESS or key in known or changes_nothing):
                hint = "write each of its copies" if key == "m" else APART
                raise self.card.refuse(f"'{key[:40]}' {what}", hint)
        for word in plain:
            if word.lower() not in HARMLESS:
                hint = "write the nodes, then one value, with a decimal point"
                raise self.card.refuse(f"'{word[:40]}' {what}", APART if word[:1].isalpha() else hint)

    def source(self, name: str, ends: Sequence[str], text: str, *, is_voltage: bool) -> None:
        """Add a source of a value; SPICE counts its current from its first node through it."""
        if is_voltage:
            self.add(name, {"type": "voltage_source", "between": [*ends], "v": text})
        else:
            self.add(name, {"type": "current_source", "between": [*ends[::-1]], "i": text})

    def carries_own(self, name: str, *, is_voltage: bool) -> None:
        """Tell the current of a source, whose .i is delivered: a voltage delivers it at its first node."""
        delivered = Attribute(name, "i")
        self.carries(negative(delivered) if is_voltage else delivered)


def difference(nodes: Sequence[str]) -> Expression:
    """Return the voltage of a node, or between two."""
    if len({*nodes}) < len(nodes):
        return number(0)
    one, *other = (number(0) if n == "ground" else Name(n) for n in nodes)
    return sum_of([one, *map(negative, other)])

"""Parameters, functions and models, as subcircuits see them: own ones over those of what contains them.

A parameter is looked up where its subcircuit is placed, then outwards, as ngspice does: values of the X line
stand before .param lines of the subcircuit, these before the defaults of its .subckt line. They see others
in any order. A parameter that names itself means the next one outwards: ``X1 a b s R={2*R}``. An expression
on the X line sees the subcircuit's numbers, and those of its expressions that come before it in the order in
which the subcircuit itself computes them; for all other names it looks outwards.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from graphlib import CycleError, TopologicalSorter
from typing import Final

from symflex.errors import nearest
from symflex.expressions import Expression, Name, number
from symflex.model.spec.netlist.cards import BRACKETS, Card, Deck, Subcircuit
from symflex.model.spec.netlist.circuit import Circuit
from symflex.model.spec.netlist.expressions import NUMBER, expression_of, inner_text, number_of

NOMINAL: Final = 27  # degrees Celsius, at which values hold where nothing else is said
RENAME: Final = "give it another name, or one of those that it depends on"
WORD: Final = re.compile(r"(?<![\w.])[A-Za-z_]\w*")
FUNCTION: Final = re.compile(rf"([A-Za-z_]\w*)\s*({BRACKETS})\s*=?\s*(.*)")


@dataclass(eq=False)
class Parameter:
    """A parameter of a netlist or of one instance of a subcircuit, evaluated when it is first used."""

    name: str
    text: str
    card: Card
    scope: Scope
    label: str = ""  # its name in the specification, if that is known already
    rank: int = 0  # in the order in which those of a scope are computed
    value: Expression | None = None

    def sees(self, other: Parameter) -> bool:
        """Tell whether another one of its own scope is known when it is computed."""
        return other.rank < self.rank or (other is not self and NUMBER.fullmatch(other.text) is not None)


@dataclass(frozen=True)
class Function:
    """What .func defines."""

    arguments: tuple[str, ...]
    text: str
    card: Card


@dataclass(frozen=True)
class Scope:
    """A netlist, or a subcircuit's instance: what its names begin with, its nodes and what it defines."""

    path: str = ""  # "x1.x2."
    prefix: str = ""  # "X1_X2_"
    nodes: Mapping[str, str] = field(default_factory=dict)
    outer: Scope | None = None
    subcircuits: Mapping[str, Subcircuit] = field(default_factory=dict)
    parameters: dict[str, Parameter] = field(default_factory=dict)
    functions: dict[str, Function] = field(default_factory=dict)
    models: dict[str, Card] = field(default_factory=dict)

    def outwards(self) -> Iterator[Scope]:
        """Yield it and all that contain it, the innermost first."""
        scope: Scope | None = self
        while scope is not None:
            yield scope
            scope = scope.outer

    def model(self, name: str) -> Card | None:
        """Return the .model line of a name."""
        return next((s.models[name] for s in self.outwards() if name in s.models), None)

    def rank(self) -> None:
        """Put the parameters into the order in which they depend on each other; SF105 for a circle."""
        words = {name: set(map(str.lower, WORD.findall(p.text))) for name, p in self.parameters.items()}
        called = {n: f for s in reversed([*self.outwards()]) for n, f in s.functions.items()}
        for mentioned in words.values():
            waiting = [*(mentioned & called.keys())]
            while waiting:
                inner = set(map(str.lower, WORD.findall(called[waiting.pop()].text))) - mentioned
                mentioned.update(inner)
                waiting += inner & called.keys()
        order = TopologicalSorter({n: (w & words.keys()) - {n} for n, w in words.items()})
        try:
            order.prepare()
        except CycleError as error:
            first = self.parameters[error.args[1][0]]
            message = f"the parameter '{first.name[:40]}' depends on itself"
            raise first.card.refuse(message, RENAME) from None
        places = {name: n for n, name in enumerate(self.parameters)}
        rank = 0
        while order.is_active():
            ready = order.get_ready()
            for name in sorted(ready, key=places.__getitem__):
                self.parameters[name].rank = rank = rank + 1
            order.done(*ready)

    def define(self, card: Card) -> None:
        """Take a line .param, .func or .model."""
        if card.keyword == ".model":
            if len(card.words) > 1:
                self.models[card.words[1].lower()] = card
            return
        definition = card.text[len(card.keyword) :].strip()
        function = FUNCTION.fullmatch(definition)
        if function is not None:
            arguments = tuple(w for w in re.split(r"[\s,()]+", function[2].lower()) if w)
            self.functions[function[1].lower()] = Function(arguments, inner_text(function[3].strip()), card)
            return
        before, assigned = card.assigned()
        if card.keyword == ".func" or len(before) > 1 or not assigned:
            form = ".func f(x) {2*x}" if card.keyword == ".func" else ".param R=1k"
            raise card.refuse(f"this is not {form}, nor like it")
        for name, text in assigned:
            self.parameters.pop(name.lower(), None)  # the last line counts, and its place
            self.parameters[name.lower()] = Parameter(name, text, card, self)


class Values:
    """Evaluates what stands in a scope, and writes the parameters that are used into the circuit."""

    def __init__(self, circuit: Circuit, deck: Deck) -> None:
        self.circuit, self.deck = circuit, deck
        self.temperature: Expression = number(NOMINAL)  # in degrees Celsius

    def expression(self, card: Card, text: str, scope: Scope) -> Expression:
        """Return the value of an expression of parameters."""
        return expression_of(card, text, Lookup(self, card, scope))

    def parameter(self, wanted: Parameter) -> Expression:
        """Return what a parameter stands for: its name in the specification, or that of another one."""
        waiting = [wanted]  # chains may be longer than calls can be nested
        while waiting:
            parameter = waiting[-1]
            meaning = Lookup(self, parameter.card, parameter.scope, parameter)
            found = (meaning.found(w.lower()) for w in WORD.findall(parameter.text))
            needed = [p for p in found if p is not None and p.value is None]
            if needed and parameter.value is None:
                waiting += needed
                continue
            parameter.value = parameter.value or self._value(parameter, meaning)
            waiting.pop()
        assert wanted.value is not None
        return wanted.value

    def _value(self, parameter: Parameter, meaning: Lookup) -> Expression:
        value = expression_of(parameter.card, parameter.text, meaning)
        if parameter.scope.outer and isinstance(value, Name):  # what is handed down keeps its name
            return value
        written = number_of(parameter.card, parameter.text)
        label = parameter.label or self.circuit.value_name(parameter.scope.prefix + parameter.name)
        return self.circuit.assign(label, value, parameter.card, written)


@dataclass(frozen=True)
class Lookup:
    """What names mean on a line of a scope."""

    values: Values
    card: Card
    scope: Scope
    own: Parameter | None = None  # of which this is the value, and which does not mean itself
    arguments: Mapping[str, Expression] = field(default_factory=dict)
    within: tuple[Function, ...] = ()

    def found(self, key: str) -> Parameter | None:
        """Return the parameter that a name means, if there is one."""
        for scope in self.scope.outwards():
            found = scope.parameters.get(key)
            is_own = self.own is not None and scope is self.scope
            if found is not None and (not is_own or (self.own and self.own.sees(found))):
                return found
        return None

    def parameter(self, name: str) -> Expression:
        """Return what a name stands for."""
        key = name.lower()
        if key in self.arguments:
            return self.arguments[key]
        found = self.found(key)
        if found is not None:
            return self.values.parameter(found)
        if key == "pi":
            return Name("pi")
        if key == "temper":
            return self.values.temperature
        known = {n for s in self.scope.outwards() for n in s.parameters}
        if self.own is not None and key == self.own.name.lower():
            raise self.card.refuse(f"the parameter '{name[:40]}' depends on itself", RENAME)
        hint = nearest(key, known) or f"define it: .param {name[:40]}=1k"
        raise self.card.refuse(f"unknown parameter '{name[:40]}'", hint)

    def call(self, name: str, arguments: Sequence[Expression]) -> Expression | None:
        """Return the value of a function of .func, ``None`` if there is none of this name."""
        function = next((s.functions[name] for s in self.scope.outwards() if name in s.functions), None)
        if function is None:
            return None
        if function in self.within:
            raise self.card.refuse(f"the function '{name[:40]}' calls itself")
        if len(arguments) != len(function.arguments):
            raise self.card.refuse(f"the function '{name[:40]}' has {len(function.arguments)} arguments")
        self.values.deck.count(1, self.card)
        given = dict(zip(function.arguments, arguments, strict=True))
        inner = Lookup(self.values, self.card, self.scope, self.own, given, (*self.within, function))
        return expression_of(self.card, function.text, inner)

    def signal(self, kind: str, places: Sequence[str]) -> Expression:
        """Refuse a voltage or a current where a constant must stand."""
        what = f"{kind.upper()}({','.join(places)})"[:40]
        raise self.card.refuse(
            f"'{what}' varies, and this value must not", "write it as a source E, G, F or H"
        )

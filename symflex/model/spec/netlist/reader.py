"""From the statements of a netlist to the elements, inputs and outputs of a specification."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Final

from symflex.errors import Diagnostic, Source, SpecError, nearest
from symflex.expressions import Attribute, Expression, format_expression, names
from symflex.model.spec.netlist.cards import MOST_DEPTH, Card, Deck
from symflex.model.spec.netlist.circuit import Circuit, quantity, written
from symflex.model.spec.netlist.expressions import number_of
from symflex.model.spec.netlist.passive import component, couple, coupling, lossless_line
from symflex.model.spec.netlist.scopes import Parameter, Scope
from symflex.model.spec.netlist.sources import (
    arbitrary,
    controlled,
    independent,
    is_library_op_amp,
    library_op_amp,
)
from symflex.model.spec.netlist.statement import Build, PlacedCard, difference

IGNORED: Final = frozenset(
    "end ends op tran dc backanno ic nodeset save endc noise meas measure width four sens pz disto step "
    "csparam title fft wave".split()
)
OPTIONS: Final = (".options", ".option", ".opt", ".opts")
FIRST: Final = (".param", ".params", ".func", ".model", ".global", ".temp", *OPTIONS)
LAST: Final = (".print", ".plot", ".probe", ".tf", ".detector")
SHUNTS: Final = frozenset(("rshunt", "cshunt", "gshunt"))  # options that connect something to every node
NOT_LINEAR: Final = "it is not linear, or has no formula"
LOSSY: Final = "its losses are not read"
REPLACED: Final = {
    "D": ("a diode", NOT_LINEAR, "a resistor of U_T/I_D, 26 mV over its current"),
    "Q": (
        "a bipolar transistor",
        NOT_LINEAR,
        "G out 0 in 0 {I_C/26m} with a resistor beta*26m/I_C from base to emitter",
    ),
    **dict.fromkeys("MJZ", ("a FET", NOT_LINEAR, "G drain source gate source {g_m} with a resistor r_o")),
    **dict.fromkeys("SW", ("a switch", NOT_LINEAR, "a resistor of the state it is in, or nothing")),
    **dict.fromkeys("OUYP", ("a line", LOSSY, "a specification with the line as [fields], x along it")),
    "A": ("a digital or special function", NOT_LINEAR, "E with its gain"),
}
TAKEN_BY: Final[dict[str, Callable[[PlacedCard], None]]] = {
    **dict.fromkeys("RLC", component),
    **dict.fromkeys("VI", independent),
    **dict.fromkeys("EFGHN", controlled),
    "B": arbitrary,
    "K": coupling,
    "T": lossless_line,
}


def specification_of(source: Source, read: Callable[[str], Source]) -> Source:
    """Return the specification of a netlist; SF105 for a line that cannot be read. ``read`` reads others."""
    deck = Deck(source, read)
    title, cards = deck.title_and_cards()
    body, subcircuits = deck.split(cards, {})
    reader = _Netlist(deck, Scope(subcircuits=subcircuits))
    reader.take(body)
    return written(source, title, deck.comments, reader.finished(body))


class _Netlist:
    def __init__(self, deck: Deck, top: Scope) -> None:
        self.deck, self.top = deck, top
        self.build = Build(deck)
        self.expanded: dict[int, int] = {}  # lines that an instance of a subcircuit stands for
        self.source = ""  # which alone acts, as .source and .tf say

    def take(self, body: Sequence[Card]) -> None:
        """Take all statements: definitions first, then components, then what they are asked for."""
        build, parameters = self.build, self.top.parameters
        for card in body:
            self._define(card, self.top)
        self.top.rank()
        for parameter in parameters.values():
            parameter.label = build.circuit.value_name(parameter.name)
        self._warm(body)
        for parameter in parameters.values():
            try:
                build.values.parameter(parameter)
            except SpecError:
                continue  # which matters only where it is used
        words = [c.words[0] for c in body if c.words[0][0].upper() in "RLCEFGHK"]
        build.circuit.reserved = {re.sub(r"\W", "_", w, flags=re.A) for w in words}
        for card in body:
            if card.keyword not in (*FIRST, *LAST):
                self._statement(PlacedCard(build, card, self.top), 0)
        couple(build)
        for finish in build.later:
            finish()
        for card in body:
            if card.keyword in LAST:
                self._ask(PlacedCard(build, card, self.top))

    def _define(self, card: Card, scope: Scope) -> None:
        is_inner = scope is not self.top
        word = card.keyword
        if word in (".param", ".params", ".func", ".model"):
            scope.define(card.whole() if word in (".param", ".params") else card)
        elif word == ".global":
            self.build.shared |= {w.lower() for w in card.words[1:]}
        elif word in OPTIONS and (odd := SHUNTS.intersection(w.lower() for w in card.words)):
            raise card.refuse(f"the option '{min(odd)}' is not read", "connect what it adds to every node")
        elif is_inner and (
            word == ".temp" or (word in OPTIONS and {"temp", "tnom"} & card.options(1)[1].keys())
        ):
            raise card.refuse("a temperature in a subcircuit is not read", "write it outside of .subckt")

    def _warm(self, body: Sequence[Card]) -> None:
        """Read the temperature of the circuit, and that at which its values hold; .temp is stronger."""
        told: Expression | None = None
        for card in body:
            line = PlacedCard(self.build, card, self.top)
            if card.keyword not in (".temp", *OPTIONS):
                continue
            plain, given = card.whole().options(1)
            if card.keyword == ".temp":
                if len(plain) != 1 or given:
                    raise card.refuse("this is not one temperature", "write .temp 50")
                told = self._temperature(line, plain[0])
            else:
                if "temp" in given:
                    self.build.values.temperature = self._temperature(line, given["temp"][0])
                if "tnom" in given:
                    self.build.nominal = self._temperature(line, given["tnom"][0])
        if told is not None:
            self.build.values.temperature = told

    def _temperature(self, line: PlacedCard, text: str) -> Expression:
        if re.fullmatch(r".*\d[a-z]+", text, re.I):
            raise line.card.refuse(
                f"'{text[:40]}' is not a temperature", "write it in degrees Celsius, .temp 50"
            )
        return line.number(text)

    def _statement(self, line: PlacedCard, depth: int) -> None:
        card, letter = line.card, line.letter
        if letter == ".":
            self._directive(line)
            return
        if letter in REPLACED:
            what, why, hint = REPLACED[letter]
            raise card.refuse(f"'{line.word}' is {what}: {why}", f"replace it by {hint}")
        if letter != "X" and letter not in TAKEN_BY:
            hint = "a name begins with R, L, C, V, I, E, F, G, H, B, K, T or X"
            raise card.refuse(f"'{line.word}' is not a SPICE component", hint)
        if line.path in self.build.paths:
            raise card.refuse(f"there are two components '{line.word}'")
        self.build.paths.add(line.path)
        card.whole()
        if letter == "X":
            self._instance(line, depth)
        else:
            TAKEN_BY[letter](line)

    def _instance(self, line: PlacedCard, depth: int) -> None:
        card, scope = line.card, line.scope
        if depth >= MOST_DEPTH:
            raise card.refuse("subcircuits contain each other")
        words, assigned = card.assigned()
        if len(words) < 2:  # noqa: PLR2004
            raise card.refuse(f"'{line.word}' names no subcircuit")
        kind = words[-1][:60]
        subcircuit = scope.subcircuits.get(words[-1].lower())
        if subcircuit is None:
            if is_library_op_amp(words):
                library_op_amp(line, words, {k.lower(): v for k, v in assigned})
                return
            known = scope.subcircuits
            hint = nearest(kind.lower(), known) or "write its .subckt into the netlist, or include its file"
            raise card.refuse(f"the subcircuit '{kind}' is not in the netlist", hint)
        heading, defaults = subcircuit.head.assigned()
        pins, outer = heading[2:], words[1:-1]
        if len(pins) != len(outer):
            raise card.refuse(f"'{kind}' has {len(pins)} pins, and {len(outer)} nodes are given")
        if not depth:
            self.deck.count(self.deck.expanded(subcircuit, self.expanded), card)
        body, inner = self.deck.split(subcircuit.body, subcircuit.known, depth)
        nodes = {p.lower(): line.node(w) for p, w in zip(pins, outer, strict=True)}
        inside = Scope(f"{line.path}.", f"{scope.prefix}{card.words[0]}_", nodes, scope, inner)
        for name, text in defaults:
            inside.parameters[name.lower()] = Parameter(name, text, subcircuit.head, inside)
        for each in body:
            self._define(each, inside)
        inside.rank()
        for name, text in assigned:
            declared = inside.parameters.get(name.lower())
            if declared is not None:
                replaced = Parameter(declared.name, text, card, inside, rank=declared.rank)
                inside.parameters[name.lower()] = replaced
            elif name.lower() == "m":
                line.check((), {"m": [text]})
            else:
                hint = nearest(name.lower(), inside.parameters) or "declare it on the .subckt line"
                raise card.refuse(f"'{kind}' has no parameter '{name[:40]}'", hint)
        for each in body:
            if each.keyword not in FIRST:
                self._statement(PlacedCard(self.build, each, inside), depth + 1)

    def _directive(self, line: PlacedCard) -> None:
        card, word = line.card, line.card.keyword[1:]
        if word in IGNORED:
            return
        if line.scope is not self.top:
            raise card.refuse(f"'.{word[:40]}' in a subcircuit is not read")
        if word == "source":  # SLiCAP
            self.source = self.source or card.words[-1]
        elif word == "ac":
            found = [number_of(card, w) for w in card.words[3:5]]
            ends = [quantity(*x, "Hz") for x in found if x is not None]
            if len(set(ends)) == 2:  # noqa: PLR2004
                self.build.circuit.add("analysis", "band", ends, card)
        else:
            hint = nearest(word, [*IGNORED, "param", "ac", "print", "tf", "include", "subckt"])
            hint = "write the lines that hold" if word in ("if", "else", "elseif", "endif") else hint
            raise card.refuse(f"'.{word[:40]}' is not a directive that is read", hint)

    def _ask(self, line: PlacedCard) -> None:
        """Take what is printed, plotted or probed as outputs."""
        words = line.card.words
        is_tf = line.card.keyword == ".tf"
        for word in words[1:2] if is_tf else words[1:]:
            self._output(line, word)
        if is_tf and len(words) > 2:  # noqa: PLR2004
            self.source = self.source or words[2]

    def _output(self, line: PlacedCard, word: str) -> None:
        circuit = self.build.circuit
        word = re.sub(r"^([VI])_(\w+)$", r"\1(\2)", word)  # as SLiCAP names them
        match = re.fullmatch(r"([vi])(?:m|db|p|r|i)?\s*\((.*)\)", word, re.I)
        if match is None:
            return
        asked = [w for w in re.split(r"[\s,]+", match[2].strip()) if w]
        if match[1].lower() == "v" and len(asked) in (1, 2):
            nodes = [line.touched(w) for w in asked]
            shown = [n for n in nodes if n != "ground"]
            if shown:
                circuit.output("V_" + "_".join(shown), format_expression(difference(nodes)), line.card)
        elif len(asked) == 1:
            read = line.current(asked[0])
            (quantity,) = names(read)
            is_winding = isinstance(quantity, Attribute) and quantity.name != "i"
            label = asked[0] if is_winding or not isinstance(quantity, Attribute) else quantity.owner
            circuit.output(f"I_{label}", format_expression(read), line.card)

    def finished(self, body: Sequence[Card]) -> Circuit:
        """Return the circuit with its sources as inputs, or at rest, and with outputs."""
        circuit, sources = self.build.circuit, self.build.sources
        wanted = self.source.lower()
        acting = [x for x in sources if x.path == wanted] if wanted else []
        acting = acting or [x for x in sources if x.kind == "ac"]
        acting = acting or [x for x in sources if x.kind == "moves"] or sources
        if not acting:
            message = "a netlist needs a source, V or I, for its input, such as V1 in 0 AC 1"
            raise SpecError(Diagnostic("SF105", message, body[0].span if body else None))
        for source in sources:
            a, b = source.ends
            ends = a if b == "ground" else [a, b]
            if source in acting:
                kind, port = (
                    ("voltage", ends) if source.letter == "V" else ("current", b if a == "ground" else [b, a])
                )
                circuit.add("inputs", source.name, {kind: port}, source.card)
            elif source.letter == "V":
                table = {"type": "voltage_source", "at" if b == "ground" else "between": ends, "v": 0}
                circuit.add("elements", source.name, table, replace(source.card, comment="at rest"))
        if not circuit.sections["outputs"]:
            driven = {x.ends[0] for x in sources if x.letter == "V"}
            for node in circuit.nodes.values():
                if node not in driven:
                    circuit.add("outputs", f"V_{node}", node, None)
        return circuit

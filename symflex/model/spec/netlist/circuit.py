"""What has been read of a netlist, as the tables of a specification, and their text.

Names are those of the netlist as far as a specification can have them: letters, digits and underscores, at
most 64, every one once. A parameter, a definition and a node never share a name.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Final

from symflex.errors import Source, Span
from symflex.expressions import Expression, Name, format_expression
from symflex.expressions.format import number_text
from symflex.model.spec.netlist.cards import Card
from symflex.model.spec.netlist.expressions import exact
from symflex.model.spec.positions import Literal
from symflex.model.spec.write import blocks

SECTIONS: Final = ("parameters", "definitions", "elements", "fields", "inputs", "outputs", "analysis")

PREFIXES: Final = {"e9": "G", "e6": "M", "e3": "k", "e-3": "m", "e-6": "u", "e-9": "n", "e-12": "p"}
TAKEN: Final = frozenset(("s", "pi", "j", "ground"))
LONGEST_NAME: Final = 60  # of 64 characters, so that a number can follow
SHORT: Final = 12  # digits up to which a computed value is written with a prefix


@dataclass
class Circuit:
    """What has been read."""

    sections: dict[str, dict[str, object]] = field(default_factory=lambda: {name: {} for name in SECTIONS})
    cards: dict[tuple[str, ...], Card] = field(default_factory=dict)  # by section and key
    nodes: dict[str, str] = field(default_factory=dict)  # by path
    reserved: set[str] = field(default_factory=set)  # names that nodes do not take: those of values to come
    named: set[str] = field(default_factory=lambda: set(TAKEN))  # of values and nodes
    lowered: set[str] = field(default_factory=lambda: set(TAKEN))  # the same in small letters
    placed: set[str] = field(default_factory=set)  # of elements

    def add(self, section: str, name: str, value: object, card: Card | None) -> None:
        """Add an entry, with the statement that it comes from; one of the same name keeps its place."""
        self.sections[section][name] = value
        if card is not None:
            self.cards[section, name] = card

    def value_name(self, name: str) -> str:
        """Return a name for a parameter or a definition that nothing else has."""
        free_name = _free(name, lambda free: free.lower() in self.lowered)
        self._take(free_name)
        return free_name

    def assign(
        self,
        name: str,
        value: Expression,
        card: Card,
        written: tuple[str, str] | None = None,
        unit: str = "",
    ) -> Name:
        """Give a name its value: a parameter for a number, a definition for an expression.

        ``written`` are the digits and the power of ten of a number as it was written.
        """
        known = exact(value)
        if written is None and known is None:
            self.add("definitions", name, format_expression(value), card)
            return Name(name)
        text = (
            quantity(*written, unit) if written is not None else computed_quantity(known or Fraction(), unit)
        )
        entry = text if re.search(r"[ /]", text) else Literal(text)
        is_positive = re.match("-|[^1-9]*$", text) is None
        self.add("parameters", name, entry if is_positive else {"value": entry, "assume": "real"}, card)
        return Name(name)

    def symbol(self, name: str, unit: str, card: Card) -> Name:
        """Declare a parameter without a value."""
        self.add("parameters", name, {"unit": unit or "1"}, card)
        return Name(name)

    def node(self, path: str, name: str) -> str:
        """Return the name of a node by its path, a new one where it is first met."""
        if path not in self.nodes:
            name = name if name[:1].isalpha() else f"n{name}"
            free_name = _free(name, lambda free: free in self.named or free in self.reserved)
            self._take(free_name)
            self.nodes[path] = free_name
        return self.nodes[path]

    def output(self, name: str, expression: str, card: Card) -> None:
        """Add an output, under a name that no other one has."""
        outputs = self.sections["outputs"]
        self.add(
            "outputs", _free(name, lambda free: outputs.get(free, expression) != expression), expression, card
        )

    def _take(self, name: str) -> None:
        self.named.add(name)
        self.lowered.add(name.lower())

    def element(self, name: str) -> str:
        """Return a name for an element that no other one has."""
        free_name = _free(name, self.placed.__contains__)
        self.placed.add(free_name)
        return free_name


def _free(name: str, is_taken: Callable[[str], bool]) -> str:
    """Return a name that a specification can have and that is not taken."""
    name = re.sub(r"\W", "_", name, flags=re.A)
    name = name if name[:1].isalpha() else f"p{name}"
    free, number = name[:LONGEST_NAME], 1
    while is_taken(free):
        free = f"{free}_" if len(free) < LONGEST_NAME else f"{name[: LONGEST_NAME - 1]}_{number}"
        number += 1
    return free


def quantity(digits: str, suffix: str, unit: str = "") -> str:
    """Return a number with its power of ten as a quantity with a prefixed unit, exactly."""
    if not unit:
        return f"{digits}{suffix}"
    prefix = PREFIXES.get(suffix, "")
    return f"{digits} {prefix}{unit}" if prefix or not suffix else f"{digits}{suffix} {unit}"


def computed_quantity(value: Fraction, unit: str = "") -> str:
    """Return a number that was computed, exactly; a fraction that no decimal is has no unit.

    >>> computed_quantity(Fraction(1230), "Ohm"), computed_quantity(Fraction(-1, 3000000), "F")
    ('1.23 kOhm', '-1/3000000')
    """
    sign = "-" * (value < 0)
    size = abs(value)
    plain = number_text(size)
    if "/" in plain or not unit:
        return sign + plain
    for power, prefix in PREFIXES.items():
        digits = number_text(size / Fraction(f"1{power}"))
        if 1 <= size / Fraction(f"1{power}") < 1000 and len(digits) <= SHORT:  # noqa: PLR2004
            return f"{sign}{digits} {prefix}{unit}"
    return f"{sign}{plain} {unit}"


def written(source: Source, title: str, comments: Sequence[str], circuit: Circuit) -> Source:
    """Return the specification that a netlist stands for: each line knows the statement it comes from."""
    lines: list[tuple[str, Span | None]] = [(f"# {_plain(comment)}", None) for comment in comments]
    heading = {"symflex": 1, "title": _plain(title or "circuit")}
    for block in blocks(heading | {name: table for name, table in circuit.sections.items() if table}):
        if block.header:
            lines += [("", None), (block.header.rstrip(), None)]
        width = max(len(entry.key) for entry in block.entries)
        for entry in block.entries:
            card = circuit.cards.get(entry.path[:2])
            comment = _plain(card.comment) if card and entry.path[0] == "elements" else ""
            text = f"{entry.key.ljust(width)} = {entry.value}" + (f"  # {comment}" if comment else "")
            lines.append((text, card.span if card else None))
    texts, origins = zip(*lines, strict=True)
    return Source(f"{source.name}, as a specification", "\n".join(texts) + "\n", origins)


def _plain(text: str) -> str:
    return "".join(c for c in text if c.isprintable())

"""What has been read of a netlist, and the text of the specification that it makes.

Names are those of the netlist as far as a specification can have them: letters, digits and underscores, at
most 64, every one once. A parameter, a definition and a node never share a name.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Final

from symflex.expressions import Expression, Name, format_expression
from symflex.expressions.format import number_text
from symflex.model.spec.netlist.expressions import exact

PREFIXES: Final = {"e9": "G", "e6": "M", "e3": "k", "e-3": "m", "e-6": "u", "e-9": "n", "e-12": "p"}
TAKEN: Final = frozenset(("s", "pi", "j", "ground"))
LONGEST_NAME: Final = 60  # of 64 characters, so that a number can follow
SHORT: Final = 12  # digits up to which a computed value is written with a prefix


@dataclass
class Circuit:
    """What has been read."""

    parameters: dict[str, str] = field(default_factory=dict)
    definitions: dict[str, str] = field(default_factory=dict)
    elements: list[tuple[str, str, str]] = field(default_factory=list)  # name, table, comment
    fields: dict[str, list[str]] = field(default_factory=dict)
    inputs: dict[str, str] = field(default_factory=dict)
    outputs: dict[str, str] = field(default_factory=dict)
    nodes: dict[str, str] = field(default_factory=dict)  # by path
    reserved: set[str] = field(default_factory=set)  # names that nodes do not take: those of values to come
    named: set[str] = field(default_factory=lambda: set(TAKEN))  # of values and nodes
    lowered: set[str] = field(default_factory=lambda: set(TAKEN))  # the same in small letters
    placed: set[str] = field(default_factory=set)  # of elements
    band: str = ""

    def value_name(self, name: str) -> str:
        """Return a name for a parameter or a definition that nothing else has."""
        own = _free(name, lambda free: free.lower() in self.lowered)
        self._take(own)
        return own

    def assign(
        self, own: str, value: Expression, written: tuple[str, str] | None = None, unit: str = ""
    ) -> Name:
        """Give a name its value: a parameter for a number, a definition for an expression.

        ``written`` are the digits and the power of ten of a number as it was written.
        """
        known = exact(value)
        if written is not None:
            self.parameters[own] = quantity(*written, unit)
        elif known is not None:
            self.parameters[own] = computed_quantity(known, unit)
        else:
            self.definitions[own] = format_expression(value)
        return Name(own)

    def symbol(self, own: str, unit: str) -> Name:
        """Declare a parameter without a value."""
        self.parameters[own] = f'{{ unit = "{unit or 1}" }}'
        return Name(own)

    def node(self, path: str, name: str) -> str:
        """Return the name of a node by its path, a new one where it is first met."""
        if path not in self.nodes:
            name = name if name[:1].isalpha() else f"n{name}"
            own = _free(name, lambda free: free in self.named or free in self.reserved)
            self._take(own)
            self.nodes[path] = own
        return self.nodes[path]

    def output(self, name: str, expression: str) -> None:
        """Add an output, under a name that no other one has."""
        own = _free(name, lambda free: self.outputs.get(free, expression) != expression)
        self.outputs[own] = expression

    def _take(self, name: str) -> None:
        self.named.add(name)
        self.lowered.add(name.lower())

    def element(self, name: str) -> str:
        """Return a name for an element that no other one has."""
        own = _free(name, self.placed.__contains__)
        self.placed.add(own)
        return own


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


def texts(words: Sequence[str]) -> str:
    """Return an array of strings in TOML."""
    return "[" + ", ".join(f'"{w}"' for w in words) + "]"


def written(title: str, comments: Sequence[str], circuit: Circuit) -> str:
    """Return the specification."""
    lines = [f"# {_plain(c)}" for c in comments]
    lines += ["symflex = 1", f"title   = {_quoted(title or 'circuit')}"]

    def section(name: str, entries: Iterator[tuple[str, str]]) -> None:
        rows = list(entries)
        if rows:
            width = max(len(key) for key, _ in rows)
            lines.extend(["", f"[{name}]", *(f"{key.ljust(width)} = {text}" for key, text in rows)])

    quoted = (
        (n, f'"{v}"' if re.search(r"[ /]", v) and v[0] != "{" else v) for n, v in circuit.parameters.items()
    )
    real = ', assume = "real" }'  # what is negative, or zero
    section(
        "parameters", ((n, f"{{ value = {v}{real}" if re.match('"?-|[^1-9{]*$', v) else v) for n, v in quoted)
    )
    section("definitions", ((n, f'"{v}"') for n, v in circuit.definitions.items()))
    section(
        "elements", ((n, f"{{ {t} }}" + (f"  # {_plain(c)}" if c else "")) for n, t, c in circuit.elements)
    )
    for name, entries in circuit.fields.items():
        lines += ["", f"[fields.{name}]", *entries]
    section("inputs", iter(circuit.inputs.items()))
    section("outputs", ((n, f'"{e}"') for n, e in circuit.outputs.items()))
    if circuit.band:
        lines += ["", "[analysis]", circuit.band]
    return "\n".join(lines) + "\n"


def _plain(text: str) -> str:
    return "".join(c for c in text if c.isprintable())


def _quoted(text: str) -> str:
    return '"' + _plain(text).replace("\\", "\\\\").replace('"', '\\"') + '"'

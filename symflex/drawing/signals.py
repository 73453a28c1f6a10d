"""Signals as a graph: what an expression is made of becomes sources, sums and boxes joined by wires.

Input: a model and the outputs that are at no one place. Output: a :class:`SignalGraph`.

    e = "k*(r - K*x)"     input r, reading x  ->  box K  ->  sum (+, -)  ->  box k  ->  signal e
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from typing import Final, Literal

from symflex.drawing.lettering import Labels
from symflex.expressions import (
    Attribute,
    Equation,
    Expression,
    Name,
    Negative,
    Product,
    Quotient,
    Sum,
    names,
    number,
    product_of,
    quotient,
)
from symflex.model import Model, PlacedBlock
from symflex.print.forms.shapes import plain

Kind = Literal["input", "reading", "gain", "block", "sum", "signal", "output", "drive"]
LONGEST: Final = 80  # letters of a sum, as LaTeX, that is written into one box
MOST_AT_SUM: Final = 3  # arrows that meet at a sum: from the left, from below, from above


@dataclass
class SignalNode:
    """A source, box, sum, named signal or end of the graph."""

    kind: Kind
    name: str
    label: str = ""  # mathematics
    lines: tuple[str, ...] = ()  # values, where they are asked for
    # What leads to it, and whether it is subtracted.
    before: list[tuple[int, bool]] = field(default_factory=list)
    after: list[int] = field(default_factory=list)


@dataclass
class SignalGraph:
    """All signals of a model; nodes are named by their places in ``nodes``."""

    model: Model
    labels: Labels
    free: Sequence[str]  # inputs that stand nowhere else
    nodes: list[SignalNode] = field(default_factory=list)

    def __post_init__(self) -> None:
        given = [(x.name, x.expression) for x in self.model.signals]
        self.signals = {name: e for name, e in given if not isinstance(e, Equation)}
        self.equations = [e for _, e in given if isinstance(e, Equation)]
        self.blocks = {b.name: b for b in self.model.blocks}
        self.inputs = {i.name: i.latex for i in self.model.inputs}
        constants = {p.name for p in self.model.parameters} | {d.name for d in self.model.definitions}
        self.constants = {*constants, *self.blocks, "s", "pi"}
        self.known: dict[tuple[str, str], int] = {}

    def add_all(self, outputs: Sequence[str], alone: Collection[str]) -> None:
        """Add every signal, what signals drive, some outputs, and inputs but for some."""
        for name in self.signals:
            self._signal(name)
        for use in self.model.elements:
            for parameter in use.element.parameters:
                value = dict(use.values).get(parameter.name)
                # A mere name is written at the source itself.
                if not parameter.signal or value is None or isinstance(whole(value), Name):
                    continue
                if not self._is_constant(value):
                    self._box("drive", use.name, self.labels.name(use.name), self._positive(value))
        for name in (n for n in self.free if n not in alone):
            self._once("input", name, self.labels.end(name, self.inputs[name]))
        for out in self.model.outputs:
            if out.name in outputs:
                origin = self._positive(out.expression)
                self._box("output", out.name, self.labels.end(out.name, out.latex), origin)

    def readings(self) -> list[str]:
        """Return the names of nodes and quantities that are read."""
        return [n.name for n in self.nodes if n.kind == "reading"]

    def _positive(self, value: Expression) -> int:
        """Return the node whose signal an expression is, behind a gain of -1 where it is minus that."""
        origin, is_minus = self._built(value)
        return self._box("gain", "", "-1", origin) if is_minus else origin

    def _new(self, kind: Kind, name: str, label: str) -> int:
        self.nodes.append(SignalNode(kind, name, label))
        return len(self.nodes) - 1

    def _join(self, one: int, other: int, *, is_minus: bool) -> None:
        self.nodes[one].after.append(other)
        self.nodes[other].before.append((one, is_minus))

    def _box(self, kind: Kind, name: str, label: str, origin: int) -> int:
        box = self._new(kind, name, label)
        self._join(origin, box, is_minus=False)
        return box

    def _is_constant(self, expression: Expression) -> bool:
        return all(isinstance(n, Name) and n.name in self.constants for n in names(expression))

    def _once(self, kind: Kind, name: str, label: str) -> int:
        if (kind, name) not in self.known:
            self.known[kind, name] = self._new(kind, name, label)
        return self.known[kind, name]

    def _signal(self, name: str) -> int:
        if ("signal", name) in self.known:
            return self.known["signal", name]
        index = self._once("signal", name, self.labels.name(name))
        self._join(self._positive(self.signals[name]), index, is_minus=False)
        return index

    def _built(self, expression: Expression) -> tuple[int, bool]:
        """Return the node whose signal an expression is, and whether it is minus that."""
        match expression:
            case Name(name=name) if name in self.signals:
                return self._signal(name), False
            case Name(name=name) if name in self.free:
                return self._once("input", name, self.labels.end(name, self.inputs[name])), False
            case Name(name=name):
                return self._once("reading", name, self.labels.name(name)), False
            case Attribute(owner=owner, name=name):
                full = f"{owner}.{name}"
                return self._once("reading", full, self.labels.name(full)), False
            case Negative(operand=inner):
                origin, is_minus = self._built(inner)
                return origin, not is_minus
            case Sum(terms=terms):
                return self._sum([self._built(t) for t in terms]), False
            case Product(factors=factors):
                return self._product(list(factors), None)
            case Quotient():
                above, below = expression.children
                return self._product(list(above.children) if isinstance(above, Product) else [above], below)
            case _:
                return self._whole(expression), False

    def _whole(self, expression: Expression) -> int:
        """Return what is read as it is written."""
        label = self.labels.expression(expression)
        return self._once("reading", label, label)

    def _sum(self, origins: list[tuple[int, bool]]) -> int:
        """Return a sum of what leads to it; one of many terms is made of several."""
        while True:
            first, origins = origins[:MOST_AT_SUM], origins[MOST_AT_SUM:]
            # The arrow from the left is added where there is one.
            first.sort(key=lambda o: (o[1], self.nodes[o[0]].kind == "reading"))
            node = self._new("sum", "", "")
            for origin, is_minus in first:
                self._join(origin, node, is_minus=is_minus)
            if not origins:
                return node
            origins.insert(0, (node, False))

    def _product(self, factors: list[Expression], below: Expression | None) -> tuple[int, bool]:
        varying = [f for f in factors if not self._is_constant(f)]
        if len(varying) != 1 or (below is not None and not self._is_constant(below)):
            product = product_of(factors)
            return self._whole(product if below is None else quotient(product, below)), False
        origin, is_minus = self._built(varying[0])
        constant = [f for f in factors if self._is_constant(f)]
        of_blocks = [f for f in constant if isinstance(f, Name) and f.name in self.blocks]
        gain_product = product_of([f for f in constant if f not in of_blocks])
        gain = gain_product if below is None else quotient(gain_product, below)
        sums = [f for f in constant if isinstance(f, Sum)]
        is_named = self.nodes[origin].kind in ("input", "reading", "signal")
        if len(sums) == 1 and is_named and len(self.labels.expression(gain)) > LONGEST:  # side by side
            terms = [(whole(t), t != whole(t)) for t in sums[0].terms]
            boxes = [(self._box("gain", "", self.labels.fraction(t), origin), minus) for t, minus in terms]
            origin, gain_product = (
                self._sum(boxes),
                product_of([f for f in constant if f not in (*of_blocks, sums[0])]),
            )
            gain = gain_product if below is None else quotient(gain_product, below)
        if gain != number(1):
            origin = self._box("gain", "", self.labels.expression(gain), origin)
            self.nodes[origin].lines = tuple(self.labels.values([gain]))
        for block in (self.blocks[f.name] for f in of_blocks):
            origin = self._box("block", block.name, self.labels.name(block.name), origin)
            self.nodes[origin].lines = tuple(self.labels.values([e for _, e in block.values]))
        return origin, is_minus


def whole(value: Expression) -> Expression:
    """Return what is driven with, but for its sign."""
    return value.operand if isinstance(value, Negative) else value


def formula(block: PlacedBlock) -> Expression | None:
    """Return the transfer function of a block with its values, None if it has no formula."""
    try:
        return plain(block.formula, dict(block.values)) if block.formula else None
    except ZeroDivisionError:
        return None  # it divides by zero, which `derive` refuses

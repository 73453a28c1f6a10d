"""What a name in an expression means, and which names may stand where."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain, count
from typing import Literal

from symflex.algebra import LAPLACE
from symflex.errors import Diagnostic, Span, SpecError, nearest
from symflex.expressions import Attribute, Name
from symflex.library.elements import LineElement, Variable
from symflex.model.model import (
    IMAGINARY,
    INPUT_KINDS,
    Definition,
    FieldProblem,
    Input,
    Model,
    NetworkNode,
    PlacedBlock,
    PlacedElement,
    Signal,
)
from symflex.quantities import IMAGINARY_NAMES, IMAGINARY_UNIT

COORDINATE = "x"  # the coordinate, along which coefficients vary, unless the model gives x another meaning
Kind = Literal[
    "laplace", "pi", "coordinate", "parameter", "definition", "block", "variable", "through", "broken"
]
CONSTANT_KINDS: frozenset[Kind] = frozenset(
    {"laplace", "pi", "coordinate", "parameter", "definition", "block", "broken"}
)
RESERVED: dict[str, str] = {
    LAPLACE: "it is the Laplace variable",
    "pi": "it is the number pi",
    "ground": "it is the reference node",
}
"""Names that have a meaning of their own, and which."""
IN_TIME = "a derivative in time is written with s: s*x"
WHERE_J = (
    "j, with j^2 = -1, is for loss factors such as 'k*(1 + j*eta)' and for complex coefficients: it is not "
    "allowed in lengths and outputs; for j*omega write s"
)
LISTED_NAMES = 8  # names that a hint lists
COMPARED_NAMES = 500  # names compared with a misspelt one: comparing so many takes 3 ms a mistake


@dataclass(frozen=True, slots=True)
class Meaning:
    """What a name stands for, ``described`` in words; a ``broken`` one was declared with a mistake."""

    kind: Kind
    name: str
    described: str
    variable: Variable | None = None


@dataclass(frozen=True)
class ModelScope:
    """All names of one model."""

    meanings: Mapping[str, tuple[Meaning, ...]]  # what a bare name can be read as
    attributes: Mapping[tuple[str, str], tuple[Meaning, ...]]  # what ``owner.name`` can be read as
    owners: Mapping[str, tuple[str, ...]]  # names that may stand after ``owner.``
    # Names whose declaration could not be read; they are known, and nothing more is said about them.
    broken: frozenset[str] = frozenset()
    # The unknowns of all fields, each with its field; they are written with a point, ``w(l)``.
    unknowns: Mapping[str, str] = field(default_factory=dict)
    # In the equations of a field its own unknowns, which stand there bare; empty elsewhere.
    inside: frozenset[str] = frozenset()
    # Quantities of elements that extend along x, ``arm.y``, each with its element in words.
    along: Mapping[str, str] = field(default_factory=dict)
    has_coordinate: bool = False  # true where coefficients may vary along x

    def varying(self) -> ModelScope:
        """Return the scope of what may vary along x."""
        return replace(self, has_coordinate=True)

    def within(self, unknowns: Iterable[str]) -> ModelScope:
        """Return the scope of the equations of the field with these unknowns."""
        return replace(self, inside=frozenset(unknowns), has_coordinate=True)

    def find(self, expression: Name | Attribute) -> Meaning | None:
        """Return the only meaning of a name, among constants when it has others too, or ``None``."""
        if isinstance(expression, Attribute):
            candidates = self.attributes.get((expression.owner, expression.name), ())
            return candidates[0] if len(candidates) == 1 else None
        candidates = self.meanings.get(expression.name, ())
        constants = [m for m in candidates if m.kind in CONSTANT_KINDS]
        return candidates[0] if len(candidates) == 1 else constants[0] if len(constants) == 1 else None

    def is_coordinate(self, name: str) -> bool:
        """Tell whether a name is the coordinate's: nothing else that may stand in a coefficient has it."""
        others = (m.kind in CONSTANT_KINDS or _is_load(m) for m in self.meanings.get(name, ()))
        return name == COORDINATE and name not in self.broken and not any(others)

    def lookup(self, expression: Name | Attribute, *, constant: bool) -> Meaning:
        """Return the meaning of a name; constants are parameters, definitions, blocks, s and pi only."""
        if isinstance(expression, Attribute):
            return self._lookup_attribute(expression, constant=constant)
        if expression.name in self.inside:
            variable = Variable("field", expression.name)
            return Meaning("variable", expression.name, f"the unknown '{expression.name}'", variable)
        candidates = self.meanings.get(expression.name, ())
        if self.has_coordinate and self.is_coordinate(expression.name):
            return Meaning("coordinate", expression.name, "the coordinate x")
        if self.inside:
            candidates = self._along(expression, candidates)
        readable = [m for m in candidates if not constant or m.kind in CONSTANT_KINDS]
        if expression.name in self.broken and (not candidates or len(readable) > 1):
            return Meaning("broken", expression.name, "a name with a mistake")
        if len(readable) == 1:
            return readable[0]
        if len(readable) > 1:
            raise SpecError(_ambiguous(expression.name, readable, expression.span))
        if candidates:
            raise SpecError(_varying(expression.name, candidates[0], expression.span))
        if expression.name in self.unknowns:
            raise SpecError(without_point(expression.name, expression.name, expression.span))
        hint = self._hint(expression.name, constant=constant)
        raise SpecError(Diagnostic("SF210", f"unknown name '{expression.name}'", expression.span, hint))

    def _along(self, expression: Name, candidates: tuple[Meaning, ...]) -> tuple[Meaning, ...]:
        """Return the meanings that may stand in the equations of a field."""
        kept = tuple(m for m in candidates if m.variable is None or _is_load(m))
        if candidates and not kept:
            raise SpecError(outside(expression.name, candidates[0].described, expression.span))
        if not candidates and expression.name in self.unknowns:
            described = f"an unknown of field '{self.unknowns[expression.name]}'"
            raise SpecError(outside(expression.name, described, expression.span))
        return kept

    def _hint(self, name: str, *, constant: bool) -> str | None:
        """Say what may have been meant by an unknown name."""
        if name == COORDINATE:
            return "x is the coordinate in the equations of [fields] and in what may vary along an element"
        if name == IMAGINARY:
            return WHERE_J
        if name in IMAGINARY_NAMES:
            return f"if it is meant, {IMAGINARY_UNIT}"
        moving = name.removesuffix("dot").removesuffix("d").rstrip("_") if name.endswith("dot") else name[1:]
        if name == "dt" or (moving in self.meanings and (name[0] == "d" or name.endswith("dot"))):
            return IN_TIME
        if name == "ground":
            return "the reference node is at zero; leave it out"
        if name in self.owners:
            names = ", ".join(f"{name}.{a}" for a in self.owners[name])
            kinds = {m.kind for a in self.owners[name] for m in self.attributes[name, a]}
            what = "an element" if "through" in kinds else "a node of the plane"
            return f"{what} has no value of its own; it offers {names}"
        usable = [
            n
            for n, ms in self.meanings.items()
            if n not in RESERVED and (not constant or any(m.kind in CONSTANT_KINDS for m in ms))
        ]
        return nearest_name(name, [*usable, *self.inside])

    def _lookup_attribute(self, expression: Attribute, *, constant: bool) -> Meaning:
        text = f"{expression.owner}.{expression.name}"
        candidates = self.attributes.get((expression.owner, expression.name), ())
        if len(candidates) > 1:
            raise SpecError(_ambiguous(text, candidates, expression.span))
        if not candidates and text in self.along:
            raise SpecError(without_point(text, text, expression.span))
        if not candidates:
            offered = self.owners.get(expression.owner)
            if expression.owner in self.broken:
                return Meaning("broken", text, "a name with a mistake")
            if offered is None:
                hint = nearest_name(expression.owner, list(self.owners))
                message = f"'{text}': no element or planar node is called '{expression.owner}'"
            else:
                listed = ", ".join(f"{expression.owner}.{a}" for a in offered)
                hint = f"it offers {listed}" if offered else None
                message = f"'{expression.owner}' has no quantity '{expression.name}'"
            raise SpecError(Diagnostic("SF210", message, expression.span, hint))
        (meaning,) = candidates
        if self.inside:
            raise SpecError(outside(text, meaning.described, expression.span))
        if constant:
            raise SpecError(_varying(text, meaning, expression.span))
        return meaning


def _is_load(meaning: Meaning) -> bool:
    """Tell whether a name may load a field all along."""
    return meaning.variable is not None and meaning.variable.kind in ("signal", "input")


def _ambiguous(name: str, readable: Sequence[Meaning], span: Span | None) -> Diagnostic:
    """Return the diagnostic of a name that can be read in more than one way."""
    readings = " or ".join(m.described for m in readable)
    return Diagnostic("SF211", f"'{name}' can be read two ways: {readings}", span, "rename one of them")


def _varying(written: str, meaning: Meaning, span: Span | None) -> Diagnostic:
    """Return the diagnostic of what varies in time and stands in a constant."""
    message = f"'{written}' is {meaning.described}; only parameters, definitions, s and pi are allowed here"
    hint = "what varies in time belongs in [signals], in [outputs] or in the value of a source"
    return Diagnostic("SF212", message, span, hint)


def without_point(name: str, written: str, span: Span | None) -> Diagnostic:
    """Return the diagnostic of a field that stands without a point where it needs one."""
    # No quotes here and below: they would be read as primes.
    message = f"{written} varies along x; only its value at a point is allowed here"
    primes = written.removeprefix(name)
    return Diagnostic("SF241", message, span, f"evaluate it at a point: {name}{primes}(0)")


def outside(written: str, described: str, span: Span | None) -> Diagnostic:
    """Return the diagnostic of what may not stand in the equations of a field."""
    allowed = "the equations of a field may use only its unknowns, parameters, inputs and signals"
    hint = "what acts at a point belongs in the conditions; a load along x is an input or a signal"
    return Diagnostic("SF245", f"'{written}' is {described}; {allowed}", span, hint)


def nearest_name(name: str, known: Sequence[str]) -> str | None:
    """Return a hint naming the closest known name, or all of them when none is close and they are few.

    >>> nearest_name("K", ["m", "k"]), nearest_name("c", ["m", "k"])
    ("did you mean 'k'?", 'known names: m, k')
    """
    if len(known) > COMPARED_NAMES:
        known = [n for n in known if n.lower() == name.lower()] or [
            n for n in known if n[:1].lower() == name[:1].lower()
        ][:COMPARED_NAMES]
    hint = nearest(name, known)
    if hint is None and 0 < len(known) <= LISTED_NAMES:
        return "known names: " + ", ".join(known)
    return hint


def build_scope(
    parameters: Sequence[str],
    definitions: Sequence[Definition],
    nodes: Sequence[NetworkNode],
    elements: Sequence[PlacedElement],
    signals: Sequence[Signal],
    blocks: Sequence[PlacedBlock],
    inputs: Sequence[Input],
    broken: frozenset[str] = frozenset(),
    fields: Sequence[FieldProblem] = (),
) -> ModelScope:
    """Return what every name of a model means."""
    found = _Meanings()
    found.add_constants(parameters, definitions, blocks)
    found.add_nodes(nodes)
    for signal in signals:
        described = f"the signal '{signal.name}'"
        found.add(Meaning("variable", signal.name, described, Variable("signal", signal.name)))
    for use in elements:
        for quantity in use.element.quantities(dict(use.domains)):
            variable = Variable("through", use.name, quantity)
            described = f"a quantity of {use.element.type_name} '{use.name}'"
            found.offer(quantity, Meaning("through", use.name, described, variable))
    for source in inputs:
        found.add_input(source)
    return ModelScope(
        {name: tuple(candidates) for name, candidates in found.bare.items()},
        {name: tuple(candidates) for name, candidates in found.offered.items()},
        found.owners(),
        broken,
        {unknown: f.name for f in fields for unknown in f.unknowns},
        along={
            f"{use.name}.{name}": f"{use.element.type_name} '{use.name}'"
            for use in elements
            if isinstance(use.element, LineElement)
            for quantity in use.element.along
            for name in quantity
        },
    )


@dataclass(frozen=True, slots=True)
class _Meanings:
    """What names can be read as, while a scope is built."""

    bare: dict[str, list[Meaning]] = field(
        default_factory=lambda: {
            LAPLACE: [Meaning("laplace", LAPLACE, "the Laplace variable")],
            "pi": [Meaning("pi", "pi", "the number pi")],
        }
    )
    offered: dict[tuple[str, str], list[Meaning]] = field(default_factory=dict)  # ``owner.name``

    def add(self, meaning: Meaning) -> None:
        """Add what a bare name can mean."""
        self.bare.setdefault(meaning.name, []).append(meaning)

    def offer(self, name: str, meaning: Meaning) -> None:
        """Add what a name after ``owner.`` can mean."""
        self.offered.setdefault((meaning.name, name), []).append(meaning)

    def owners(self) -> dict[str, tuple[str, ...]]:
        """Return the names that may stand after each ``owner.``."""
        owners: dict[str, list[str]] = {}
        for owner, name in self.offered:
            owners.setdefault(owner, []).append(name)
        return {owner: tuple(names) for owner, names in owners.items()}

    def add_constants(
        self, parameters: Iterable[str], definitions: Iterable[Definition], blocks: Iterable[PlacedBlock]
    ) -> None:
        """Add what does not vary in time."""
        for name in parameters:
            self.add(Meaning("parameter", name, f"the parameter '{name}'"))
        for definition in definitions:
            self.add(Meaning("definition", definition.name, f"the definition '{definition.name}'"))
        for block in blocks:
            self.add(Meaning("block", block.name, f"the block '{block.name}'"))

    def add_nodes(self, nodes: Iterable[NetworkNode]) -> None:
        """Add nodes, and their components in the plane."""
        for node in nodes:
            variables = [Variable("node", node.name, component) for component in node.components]
            for variable in (v for v in variables if v.component):
                described = f"node '{variable}'"
                self.offer(variable.component, Meaning("variable", node.name, described, variable))
            if node.domain != "plane":  # where bare, it could be x or y
                self.add(Meaning("variable", node.name, f"the node '{node.name}'", variables[0]))

    def add_input(self, source: Input) -> None:
        """Add an input, and the reaction of one that imposes a motion or a voltage."""
        kind = INPUT_KINDS.get(source.kind)
        # What the node of its own name is needs no name: both readings are one value.
        names = [str(Variable("node", r.node, r.component)) for r in source.nodes]
        if not (kind is not None and kind.order == 0 and names == [source.name]):
            variable = Variable("input", source.name)
            self.add(Meaning("variable", source.name, f"the input '{source.name}'", variable))
        # A voltage input has always been allowed to bear the name of an element, whose current is then read.
        if kind is None or not kind.is_imposed or (source.name, "i") in self.offered:
            return
        described = f"the reaction of the input '{source.name}'"
        self.offer(kind.quantity, Meaning("through", source.name, described, kind.delivered(source.name)))


def free_name(name: str, taken: Container[str]) -> str:
    """Return a name that nothing has: this one, or with a number.

    >>> free_name("wall", {"wall", "wall_2"})
    'wall_3'
    """
    return next(n for n in chain((name,), (f"{name}_{i}" for i in count(2))) if n not in taken)


def scope_of(model: Model) -> ModelScope:
    """Return what every name of a resolved model means."""
    return build_scope(
        [p.name for p in model.parameters],
        model.definitions,
        model.nodes,
        model.elements,
        model.signals,
        model.blocks,
        model.inputs,
        fields=model.fields,
    )

"""Environments: what touches a machine at a port, as elements of its specification.

Input: the text of a specification, a port and what is there: an expression, the name of a class, or another
specification with its port. Output: an :class:`Environment`, and the specification with it.

Example: ``k_e + b_e*s + m_e*s^2`` at a node that moves is a spring and a damper to ground and a mass: force
over displacement, its dynamic stiffness. In a circuit it is the impedance, voltage over current, and in a
duct pressure over flow. Names that the specification does not have become its parameters; their units follow
from the place, as those of all parameters do.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Final

from symflex.algebra import LAPLACE
from symflex.contact.port import ADMITTANCES, Kind
from symflex.errors import Source, Text, refused
from symflex.expressions import (
    Expression,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
    format_expression,
    names_among,
    negative,
    nodes,
    number,
    parse,
    product_of,
    quotient,
    sum_of,
)
from symflex.library.elements import ELEMENTS
from symflex.model import ContactPort, Model, NodeReference
from symflex.model.model import IMAGINARY
from symflex.model.scope import free_name
from symflex.model.spec.positions import Literal
from symflex.model.spec.write import write
from symflex.quantities import looks_like_quantity

ANY: Final = "any"  # every passive environment
OPTION: Final = "--environment"
MECHANICAL: Final = ("translation", "rotation")
OTHER_CLASSES: Final[Mapping[str, Mapping[str, Kind]]] = {
    "electrical": {"resistor": "dissipative", "inductor": "elastic", "capacitor": "inertial"},
    "acoustic": {"resistance": "dissipative", "mass": "elastic", "compliance": "inertial"},
}
"""Names of classes at ports that do not move, by what they store."""


def part(domain: str, kind: Kind) -> tuple[str, str]:
    """Return the element of a kind, and its parameter."""
    type_name, parameter, _ = ADMITTANCES[domain][kind]
    return type_name, parameter


PARTS: Final[Mapping[str, tuple[tuple[str, str], ...]]] = {
    domain: tuple(part(domain, kind) for kind in ("elastic", "dissipative", "inertial"))
    if domain in MECHANICAL
    else (part(domain, "dissipative"),)
    for domain in ADMITTANCES
}
"""Elements whose value stands beside each power of s, with their parameter; all else is the first."""
CLASSES: Final[Mapping[str, Mapping[str, tuple[tuple[str, str], ...]]]] = {
    **{
        domain: {
            "spring": PARTS[domain][:1],
            "damper": PARTS[domain][1:2],
            "mass": PARTS[domain][2:],
            "spring-damper": PARTS[domain][:2],
            "wall": (),
        }
        for domain in MECHANICAL
    },
    **{
        domain: {**{name: (part(domain, kind),) for name, kind in names.items()}, "short": ()}
        for domain, names in OTHER_CLASSES.items()
    },
}
"""Elements of each class with their parameter, by domain; one without any holds the port still."""
ALIKE: Final[Mapping[str, str]] = {"passive": ANY, "everything": ANY, "dashpot": "damper", "rigid": "wall"}
"""Other words for classes."""


@dataclass(frozen=True)
class Environment:
    """What is at a port: elements from the port to ground or to its second node."""

    port: ContactPort
    text: str  # as printed
    elements: tuple[tuple[str, str, str], ...]  # type, parameter and value of each; none where it is held
    letters: tuple[str, ...] = ()  # names in the values that the model does not have

    @property
    def is_wall(self) -> bool:
        """Whether it holds the port still."""
        return not self.elements

    @property
    def lone(self) -> str | None:
        """The element that a law of one letter is, such as a spring; None of another law."""
        if self.letters != (self.text,):
            return None
        ((kind, _, _),) = self.elements
        return kind.replace("_", " ")


def read_environment(model: Model, port: ContactPort, text: str) -> Environment:
    """Return what an expression or the name of a class says; SF902 for what is neither.

    Raises SpecError: SF1xx for an expression with a mistake, at its place.
    """
    classes, parts = CLASSES[port.domain], PARTS[port.domain]
    if text in classes:
        taken = {p.name for p in model.parameters} | {d.name for d in model.definitions}
        letters = tuple(free_name(f"{key}_e", taken) for _, key in classes[text])
        elements = tuple((*part, letter) for part, letter in zip(classes[text], letters, strict=True))
        return Environment(port, text, elements, letters)
    if text in {name for others in CLASSES.values() for name in others}:
        raise refused(
            f"'{text}' is no environment of a port in {port.domain}", f"there are: {', '.join(classes)}"
        )
    if looks_like_quantity(text):
        return Environment(port, text, ((*parts[0], text),))
    _check_no_class(model, text, classes)
    expression = parse(Text.alone(OPTION, text))
    letters = _letters(model, expression)
    powers = _by_powers(expression, model) if len(parts) > 1 else None
    most = len(parts) - len(port.nodes)  # a mass is at one node
    values = powers if powers is not None and max(powers) <= most else {0: expression}
    elements = tuple((*parts[n], format_expression(value)) for n, value in sorted(values.items()))
    return Environment(port, format_expression(expression), elements, letters)


def with_environment(
    source: Source, model: Model, environment: Environment, scales: Mapping[str, str] = MappingProxyType({})
) -> Source:
    """Return a specification with an environment; errors in it are at places of this new text.

    A letter in ``scales`` stands for every positive value. It is ``scale*share/(1 - share)`` with a share
    between 0 and 1, a parameter whose name :func:`share_name` returns; scales are quantities.
    """
    spec: dict[str, Any] = tomllib.loads(source.text, parse_float=Literal)
    parameters, definitions = {**spec.get("parameters", {})}, {**spec.get("definitions", {})}
    for letter in environment.letters:
        if letter not in scales:
            parameters[letter] = {"assume": "nonnegative"}
            continue
        share, scale = share_name(letter), f"{letter}_scale"
        parameters |= {share: {"assume": "nonnegative"}, scale: scales[letter]}
        definitions[letter] = f"{scale}*{share}/(1 - {share})"
    places = [_written(model, reference, environment.port) for reference in environment.port.nodes]
    between = [*places, "ground"][:2]
    elements: dict[str, object] = {**spec.get("elements", {})}
    if environment.is_wall:
        held = {"at": places[0]} if between[1] == "ground" else {"between": between}
        elements[free_name("wall", elements)] = {"type": "fixed", **held}
    for kind, key, value in environment.elements:
        (attached,) = ELEMENTS[kind].ports
        at = places[0] if attached.terminals == 1 else between
        elements[free_name(f"environment_{key}", elements)] = {"type": kind, attached.name: at, key: value}
    spec |= {"parameters": parameters, "elements": elements}
    spec |= {"definitions": definitions} if definitions else {}
    # A wall may hold a port at a node; one of an input and an output makes a node.
    spec["ports"] = {name: port for name, port in spec.get("ports", {}).items() if "at" not in port}
    return Source(f"{source.name} with {environment.text}", write(spec))


def share_name(letter: str) -> str:
    """Return the name of the parameter that stands for all positive values of a letter."""
    return f"{letter}_share"


def _check_no_class(model: Model, text: str, classes: Iterable[str]) -> None:
    """Refuse a law by which a class is meant, such as ``Any`` or ``spring_damper``."""
    alike = {_bare(name): name for name in (*classes, ANY)}
    alike |= {word: name for word, name in ALIKE.items() if name in alike.values()}
    meant = alike.get(_bare(text))
    known = {p.name for p in model.parameters} | {d.name for d in model.definitions}
    if meant and text not in known:
        raise refused(f"there is no environment '{text}'", f"did you mean '{meant}'?")


def _bare(word: str) -> str:
    return "".join(c for c in word.lower() if c.isalnum())


def _letters(model: Model, expression: Expression) -> tuple[str, ...]:
    """Return the names of an expression that a model does not have; SF902 for what varies in time."""
    known = {p.name for p in model.parameters} | {d.name for d in model.definitions}
    known |= {b.name for b in model.blocks} | {LAPLACE, "pi", IMAGINARY}
    varying = {n.name: "a node" for n in model.nodes} | {s.name: "a signal" for s in model.signals}
    varying |= {i.name: "an input" for i in model.inputs}
    new: dict[str, None] = {}
    for node in nodes(expression):
        if isinstance(node, Name) and node.name not in known:
            if node.name in varying:
                message = f"'{node.name}' is {varying[node.name]}: an environment is a law of s and constants"
                raise refused(message, f"for instance {OPTION} 'k_e + b_e*s'")
            new[node.name] = None
    return tuple(new)


def _by_powers(expression: Expression, model: Model) -> dict[int, Expression] | None:
    """Return what stands beside each power of s; None where it is no polynomial, or may hide s."""
    hiding = {d.name for d in model.definitions} | {b.name for b in model.blocks}
    if names_among(expression, hiding):
        return None
    terms: dict[int, list[Expression]] = {}
    for term in expression.terms if isinstance(expression, Sum) else (expression,):
        monomial = _monomial(term)
        if monomial is None:
            return None
        terms.setdefault(monomial[0], []).append(monomial[1])
    return {n: sum_of(values) for n, values in terms.items()}


def _monomial(term: Expression) -> tuple[int, Expression] | None:
    """Return the power of s in a product and what else it holds; None where s stands elsewhere."""
    if not names_among(term, {LAPLACE}):
        return 0, term
    match term:
        case Name():
            return 1, number(1)
        case Power(base=Name(), exponent=Number(value=n)) if n.denominator == 1 and n >= 0:
            return int(n), number(1)
        case Negative():
            inner = _monomial(term.operand)
            return inner and (inner[0], negative(inner[1]))
        case Quotient() if not names_among(term.denominator, {LAPLACE}):
            inner = _monomial(term.numerator)
            return inner and (inner[0], quotient(inner[1], term.denominator))
        case Product():
            factors = [_monomial(f) for f in term.factors]
            if None in factors:
                return None
            found = [f for f in factors if f is not None]
            return sum(n for n, _ in found), product_of([value for _, value in found])
    return None


def _written(model: Model, reference: NodeReference, port: ContactPort) -> str:
    """Return a port's node as an element names it: the part of a planar one."""
    node = next((n for n in model.nodes if n.name == reference.node), None)
    if node is None or node.components == ("",):
        return reference.node
    component = reference.component or ("theta" if port.domain == "rotation" else "y")
    return f"{reference.node}.{component}"

"""What an element is: its ports, its parameters, and the stamp it leaves in the equations.

Input: an :class:`ElementUse`, the values and unknowns of one use of the element.
Output: a :class:`Stamp`, pure data.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar, Final, Literal

from symflex.library import ParameterPort, Stateless

if TYPE_CHECKING:
    from symflex.algebra import Factored

Domain = Literal["translation", "rotation", "electrical", "acoustic", "thermal"]
Placing = Domain | Literal["planar", "plane"]
PortDomain = Placing | Literal["any", "whole"]

Role = Literal["balance", "law", "constraint", "signal", "equation", "condition", "hidden"]

COMPONENTS: dict[str, tuple[str, ...]] = {"planar": ("y", "theta"), "plane": ("x", "y", "theta")}
"""What a node of several degrees of freedom is made of; one ``plane`` moves along x, too."""
COMPONENT_DOMAIN: dict[str, Domain] = {"x": "translation", "y": "translation", "theta": "rotation"}

DOMAINS: tuple[Domain, ...] = ("translation", "rotation", "electrical", "acoustic", "thermal")
ACROSS_UNIT: dict[str, str] = dict(zip(DOMAINS, ("m", "rad", "V", "Pa", "K"), strict=True))
THROUGH_UNIT: dict[str, str] = dict(zip(DOMAINS, ("N", "N*m", "A", "m^3/s", "W"), strict=True))
THROUGH_NAME: dict[str, str] = dict(zip(DOMAINS, ("f", "tau", "i", "q", "phi"), strict=True))
CIRCUITS = DOMAINS[2:]  # domains in which a node's value is an effort; mechanical ones have a motion
COMPONENT_UNIT: dict[str, str] = {
    **{THROUGH_NAME[domain]: unit for domain, unit in THROUGH_UNIT.items()},
    **{f"supplied_{THROUGH_NAME[domain]}": unit for domain, unit in THROUGH_UNIT.items()},
    **dict.fromkeys(("f_x", "f_y", "f_u", "f_v"), "N"),
    **dict.fromkeys(("i_1", "i_2", "supplied"), "A"),
}
"""Units of through variables by component; the quantity of an input has a name of its own."""


@dataclass(frozen=True, slots=True)
class Variable:
    """An unknown of the equations, or an input."""

    # ``node`` (displacement [m], angle [rad] or voltage [V]), ``through`` (force [N], torque [N m] or current
    # [A] of an element), ``signal``, ``value`` (an auxiliary unknown that carries a rational expression),
    # ``field`` (an unknown function of x, or one of the constants that fix it), ``input``, or ``parameter``
    # (whose unit is unknown).
    kind: Literal["node", "through", "signal", "value", "field", "input", "parameter"]
    owner: str  # name of the node, element, signal, output, field's unknown or input
    component: str = (
        ""  # ``x``, ``y`` or ``theta`` of a planar node; the quantity's name for a through variable
    )

    def __str__(self) -> str:
        return f"{self.owner}.{self.component}" if self.component else self.owner


@dataclass(frozen=True, slots=True)
class LinearForm:
    """A linear combination of variables, ``sum(coefficient * variable)``."""

    terms: tuple[tuple[Variable, Factored], ...] = ()

    @staticmethod
    def of(*terms: tuple[Variable | None, Factored]) -> LinearForm:
        """Return the combination of the given terms; the reference (``None``) contributes nothing."""
        return LinearForm(tuple((v, c) for v, c in terms if v is not None and not c.is_zero))

    @property
    def coefficients(self) -> tuple[Factored, ...]:
        """The coefficients, in order."""
        return tuple(c for _, c in self.terms)

    @staticmethod
    def total(forms: Iterable[LinearForm]) -> LinearForm:
        """Return the sum of the forms, with one term per variable."""
        merged: dict[Variable, Factored] = {}
        for form in forms:
            for variable, coefficient in form.terms:
                before = merged.get(variable)
                merged[variable] = coefficient if before is None else before + coefficient
        return LinearForm(tuple((v, c) for v, c in merged.items() if not c.is_zero))

    def __add__(self, other: LinearForm) -> LinearForm:
        return LinearForm.total((self, other))

    def __mul__(self, scale: Factored) -> LinearForm:
        return LinearForm(tuple((v, c * scale) for v, c in self.terms if not scale.is_zero))


Terms = dict[Variable, "Factored"]  # the coefficients of a linear combination, by its variables


def put_in(terms: Terms, known: Mapping[Variable, Terms]) -> Terms:
    """Return a combination with others in place of some variables."""
    if not any(v in known for v in terms):
        return terms
    forms = [LinearForm(tuple(known.get(v, {v: c**0}).items())) * c for v, c in terms.items()]
    return dict(LinearForm.total(forms).terms)


@dataclass(frozen=True, slots=True)
class Admittance:
    """``admittance * (a - b)`` flows from ``a`` to ``b``; parallel ones are added before elimination."""

    a: Variable | None
    b: Variable | None
    admittance: Factored


@dataclass(frozen=True, slots=True)
class EquationRow:
    """An equation ``form = 0`` for ``about``; a variable may stand in it once per branch that meets it."""

    about: Variable
    form: LinearForm
    role: Role = "law"


@dataclass(frozen=True, slots=True)
class Injection:
    """A force, torque or current delivered into a node."""

    node: Variable | None
    form: LinearForm


@dataclass(frozen=True, slots=True)
class Stamp:
    """One element's unknowns, rows, branches, injections, and quantities (``motor.i``) as linear forms."""

    branches: tuple[Admittance, ...] = ()
    injections: tuple[Injection, ...] = ()
    unknowns: tuple[Variable, ...] = ()
    rows: tuple[EquationRow, ...] = ()
    through: tuple[tuple[str, LinearForm], ...] = ()


@dataclass(frozen=True, slots=True)
class Port:
    """Where an element is attached: a key of its table and the terminals listed there."""

    name: str  # the key
    terminals: int  # how many nodes it lists; one is written as a string, more as an array
    # What the port acts on. ``any`` takes the domain the node has from other elements; ``planar`` needs both
    # deflection y and slope theta; ``plane`` needs x besides; ``whole`` takes the node as it is.
    domain: PortDomain
    doc: str  # what the node is
    default: tuple[str, ...] | None = None  # nodes used when the key is missing
    # The key that names two nodes in its place, the second one for the reaction; empty without one.
    pair: str = ""
    reacts: bool = False  # whether two nodes may be listed under the key itself, the second for the reaction


@dataclass(frozen=True, slots=True)
class Choice:
    """A key that takes one of a few words, such as the theory of a beam."""

    name: str  # the key
    values: tuple[str, ...]  # what it may say
    default: str  # what holds when the key is missing
    doc: str  # what it decides, in the words of an error message: "a theory"

    @property
    def is_flag(self) -> bool:
        """Whether it is written true or false: true chooses its name."""
        return self.name in self.values


@dataclass(frozen=True, slots=True)
class Passivity:
    """What keeps an element from supplying energy: parameters that are not negative."""

    # Parameters that may be negative, too: of levers and couplings, which give at one side what they take at
    # the other.
    of_any_sign: tuple[str, ...] = ()
    equal: tuple[str, ...] = ()  # parameters that must be the same
    definite: tuple[str, ...] = ()  # two and one whose square must not be larger than their product
    # Power is one product at all ports, such as displacement, force and s: a voltage is no displacement.
    is_alike: bool = False


@dataclass(frozen=True, slots=True)
class PortTerminal:
    """Across variables of a node, ``None`` at the reference: ``across``, or ``y``, ``theta`` and ``x``."""

    across: Variable | None = None
    y: Variable | None = None
    theta: Variable | None = None
    x: Variable | None = None


@dataclass(frozen=True, slots=True)
class ElementUse:
    """One element of a model, with its values in the ring."""

    name: str  # the element's name
    s: Factored  # the Laplace variable
    terminals: Mapping[str, tuple[PortTerminal, ...]]  # per port, in the order written
    domains: Mapping[str, Placing]  # per port, the domain it was found to have
    values: Mapping[str, Factored]  # constant parameters (they may depend on s)
    forms: Mapping[str, LinearForm] = field(default_factory=dict)  # values that are expressions of signals
    # What was chosen, the theory of a beam for instance.
    choices: Mapping[str, str] = field(default_factory=dict)
    # Of a distributed element, row by row, the matrix that takes its state from the first end to the second;
    # empty for others.
    transmission: tuple[tuple[Factored, ...], ...] = ()
    is_turned: bool = False  # whether the matrix takes the state from the second end, a tip, to the first
    varying: Collection[str] = ()  # generators other than s that depend on it: definitions, delays

    @property
    def one(self) -> Factored:
        """The ring's one."""
        return self.s**0

    def depends_on_s(self, value: Factored) -> bool:
        """Tell whether a value depends on s, directly or through a definition or a delay."""
        known = value.ring.index
        return any(value.depends_on(name) for name in ("s", *self.varying) if name in known)

    def unknown(self, component: str) -> Variable:
        """Return a through variable of this element."""
        return Variable("through", self.name, component)

    def across(self, port: str) -> tuple[Variable | None, ...]:
        """Return the across variables of a port's terminals."""
        return tuple(t.across for t in self.terminals[port])


class Element(Stateless, ABC):
    """Base of every element. Subclasses are final, stateless and registered in ``ELEMENTS``.

    Proofs, reports and figures read here what they may take for granted of it, and where nothing is said they
    take nothing for granted.
    """

    type_name: ClassVar[str]
    summary: ClassVar[str]
    ports: ClassVar[tuple[Port, ...]]
    parameters: ClassVar[tuple[ParameterPort, ...]] = ()
    choices: ClassVar[tuple[Choice, ...]] = ()
    through: ClassVar[tuple[str, ...]] = ()
    passive: ClassVar[Passivity | None] = None  # ``None`` where it is not known to be passive
    is_source: ClassVar[bool] = False  # it supplies what its value says, and nothing where that rests
    is_inertia: ClassVar[bool] = False
    moves_as_one: ClassVar[bool] = False  # whether all of its nodes lie where one of them lies
    compliance: ClassVar[Literal["", "stretching", "bending"]] = ""  # torsion is stretching about an axis
    carries_x: ClassVar[bool] = False  # whether all of its planar nodes move along x where one of them does
    stiffness: ClassVar[str] = ""  # the parameter with which a massless element becomes rigid
    damping: ClassVar[str] = ""  # the parameter of a damper without which there is none

    def unit_of(self, quantity: str, domains: Mapping[str, Placing]) -> str:
        """Return the SI unit of a parameter or through quantity, given the ports' domains."""
        for parameter in self.parameters:
            if parameter.name == quantity and parameter.unit:
                return parameter.unit
        return COMPONENT_UNIT[quantity]

    def quantities(self, domains: Mapping[str, Placing]) -> tuple[str, ...]:
        """Return the through quantities an expression may name, given the ports' domains."""
        del domains
        return self.through

    @abstractmethod
    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute this element's unknowns, rows, branches and injections."""


LOSS_FACTOR: Final = ParameterPort("eta_s", "1", "a loss factor, valid on s = j*omega", "0")
"""Loss factor of structural damping: the stiffness of the element is multiplied by ``1 + j*eta_s``."""


def difference(use: ElementUse, port: str, scale: Factored) -> LinearForm:
    """Return ``scale*(a - b)`` of the nodes at a port, ``scale*a`` where there is one."""
    return LinearForm.of(*zip(use.across(port), (scale, -scale), strict=False))


def delivered(use: ElementUse, port: str, form: LinearForm) -> tuple[Injection, ...]:
    """Return what is delivered into the node at a port, with the reaction where there is a second one."""
    signs = (use.one, -use.one)
    return tuple(Injection(n, form * sign) for n, sign in zip(use.across(port), signs, strict=False))


def two_terminal(use: ElementUse, port: str, quantity: str, admittance: Factored) -> Stamp:
    """Return the stamp of ``through = admittance * (a - b)``."""
    # An admittance whose denominator depends on s (a relaxing spring, say) gets a through unknown of its own,
    # so that the equations stay polynomial and no root is added to the determinant.
    ends = use.across(port)
    a, b = ends if len(ends) == 2 else (ends[0], None)  # noqa: PLR2004
    denominator = admittance.denominator()
    if not use.depends_on_s(denominator):
        form = LinearForm.of((a, admittance), (b, -admittance))
        return Stamp(branches=(Admittance(a, b, admittance),), through=((quantity, form),))
    law = LinearForm.of((use.unknown(quantity), denominator))
    return determined(use, port, quantity, law + difference(use, port, -admittance * denominator), -use.one)


def determined(
    use: ElementUse, port: str, quantity: str, law: LinearForm, sign: Factored, role: Role = "law"
) -> Stamp:
    """Return the stamp of a through unknown that a law determines, delivered at a port with a sign."""
    through = use.unknown(quantity)
    flow = LinearForm.of((through, use.one))
    return Stamp(
        unknowns=(through,),
        rows=(EquationRow(through, law, role),),
        injections=delivered(use, port, flow * sign),
        through=((quantity, flow),),
    )

"""The resolved model: elements at nodes, signals, blocks, inputs and outputs, with exact parameters.

Every noun here is pure data made by :func:`symflex.model.resolve`; positions do not take part in equality.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any, Final, Literal, TypeVar

from flint import arb

from symflex.balls import ball, precision
from symflex.errors import Diagnostic, Span, Text
from symflex.expressions import Attribute, Equation, Expression, Name, Number, names, parse
from symflex.library.blocks import ROOT
from symflex.library.blocks import Block as BlockType
from symflex.library.elements import COMPONENTS, THROUGH_NAME, Domain, Element, LineElement, Placing, Variable
from symflex.model.direction import direction_of
from symflex.quantities import Dimension

PI_NEARLY = Fraction(314159265358979323846264338328, 10**29)
"""Pi to 30 digits: signs, and the limits of a plot or search band, need no exact one."""
Assumption = Literal["positive", "nonnegative", "real"]
NamedExpressions = tuple[tuple[str, Expression], ...]  # in order, as an element has values


@dataclass(frozen=True, slots=True)
class ExactValue:
    """The real number ``rational * pi**pi_power``; or that times the imaginary unit."""

    rational: Fraction
    pi_power: int = 0
    is_imaginary: bool = False

    def __mul__(self, other: ExactValue) -> ExactValue:
        rational = self.rational * other.rational
        return ExactValue(rational, self.pi_power + other.pi_power if rational else 0)

    @property
    def nearly(self) -> Fraction:
        """The number to 30 digits."""
        return self.rational * PI_NEARLY**self.pi_power


ONE: Final = ExactValue(Fraction(1))
J: Final = ExactValue(Fraction(1), is_imaginary=True)
Z: Final = "z"  # the variable of sampled blocks: ahead by one sample
IMAGINARY: Final = "j"  # the imaginary unit, unless the model gives this name another meaning
FOUND_BITS: Final = 256  # of the value of a parameter that was solved for
PAIRS_SHOWN: Final = 6  # number of transfer functions that a message lists


@dataclass(frozen=True, slots=True)
class ModelParameter:
    """A named constant."""

    name: str  # as declared
    # In SI units; what is declared in Hz, rpm or rev counts cycles. ``None`` keeps it symbolic.
    value: ExactValue | None
    unit: str = ""  # SI unit of ``value``; empty when neither declared nor implied by its use
    assume: Assumption = "positive"  # ``positive``, ``nonnegative`` or ``real``
    # latex and doc: label and description; empty when not given.
    latex: str = ""
    doc: str = ""
    span: Span | None = field(default=None, compare=False, repr=False)
    cycles: int = 0  # exponent of the cycle in what ``value`` counts: 1 for Hz, 0 for rad/s
    # The unit as it was declared; empty when it was not.
    written_unit: str = ""
    scale: ExactValue = ONE  # what one of that unit is in the unit of ``value``
    limits: tuple[ExactValue, ExactValue] | None = None  # its ``range``, like ``value``
    spread: Fraction | ExactValue | None = None  # to either side of the value, or as a share of it
    is_solved_with: bool = False  # a number at equilibrium was solved for with its value, or is its value

    def __repr__(self) -> str:
        value, unit = self.as_written()
        number = "no value" if value is None else f"{float(value.nearly):.10g}"
        return f"<ModelParameter {self.name}: {number}{f' {unit}' if unit else ''}>"

    @property
    def is_imaginary(self) -> bool:
        """True of the imaginary unit, which nobody declares or sets."""
        return self.value is not None and self.value.is_imaginary

    def as_written(self, value: ExactValue | None = None) -> tuple[ExactValue | None, str]:
        """Return a value, by default the parameter's own, in the unit that was written, with that unit.

        >>> E = ModelParameter("E", ExactValue(Fraction(70 * 10**9)), "Pa", written_unit="GPa",
        ...               scale=ExactValue(Fraction(10**9)))
        >>> E.as_written()
        (ExactValue(rational=Fraction(70, 1), pi_power=0, is_imaginary=False), 'GPa')
        """
        exact = self.value if value is None else value
        if not self.written_unit:
            return exact, self.unit
        if exact is None:
            return None, self.written_unit
        of_pi = exact.pi_power - self.scale.pi_power if exact.rational else 0
        return ExactValue(exact.rational / self.scale.rational, of_pi), self.written_unit

    @property
    def in_radians(self) -> ModelParameter:
        """The parameter with 2 pi radians for each cycle that it counts."""
        turn = ExactValue(Fraction(2) ** self.cycles, self.cycles)
        return replace(
            self,
            value=None if self.value is None else self.value * turn,
            unit="rad/s" if self.unit == "Hz" else self.unit.replace("rev", "rad"),
            scale=self.scale * turn,
            cycles=0,
        )

    @property
    def counted_in(self) -> tuple[str, Fraction]:
        """The unit in which results print its values, and what one of it is in the unit of ``value``.

        Results are in SI units, but what was declared in rpm, kHz, mm/rev or degrees is answered in that.
        """
        is_own = self.cycles or self.scale.pi_power
        return (self.written_unit, self.scale.nearly) if is_own else (self.unit, Fraction(1))


@dataclass(frozen=True, slots=True)
class Definition:
    """A name kept closed in the printed form, equal to ``expression``."""

    name: str
    expression: Expression
    latex: str = ""
    span: Span | None = field(default=None, compare=False, repr=False)
    doc: str = ""  # one that is described is wanted for itself, as a fit gives it with its error


@dataclass(frozen=True, slots=True)
class NetworkNode:
    """A place where elements meet."""

    name: str
    domain: Placing
    span: Span | None = field(default=None, compare=False, repr=False)

    @property
    def components(self) -> tuple[str, ...]:
        """The degrees of freedom: ``("",)``, or ``("y", "theta")`` of a planar node, and x in the plane."""
        return COMPONENTS.get(self.domain, ("",))


@dataclass(frozen=True, slots=True)
class NodeReference:
    """A node as a port names it; ``component`` is ``x``, ``y`` or ``theta`` when one was picked."""

    node: str
    component: str = ""
    span: Span | None = field(default=None, compare=False, repr=False)

    @property
    def is_ground(self) -> bool:
        """True for the reference."""
        return self.node == "ground"


@dataclass(frozen=True, slots=True)
class PlacedElement:
    """An element type attached to nodes, with an expression for every parameter."""

    name: str
    element: Element
    nodes: tuple[tuple[str, tuple[NodeReference, ...]], ...]
    domains: tuple[tuple[str, Placing], ...]
    values: NamedExpressions
    span: Span | None = field(default=None, compare=False, repr=False)
    choices: tuple[tuple[str, str], ...] = ()
    latex: str = ""  # what it is called in a drawing

    @property
    def all_values(self) -> NamedExpressions:
        """The values, and of an angle in the plane the cosine and sine by which it enters."""
        if not any(p.is_direction for p in self.element.parameters):
            return self.values
        directions = {p.name for p in self.element.parameters if p.is_direction}
        turned = (direction_of(e) for name, e in self.values if name in directions)
        return (*self.values, *(pair for mapping in turned for pair in mapping.items()))


@dataclass(frozen=True, slots=True)
class FieldProblem:
    """A boundary-value problem along x, Laplace-transformed in time."""

    name: str  # as declared
    unknowns: tuple[str, ...]  # the functions of x it determines
    # start and end: where x begins and ends [the length's unit]; constants without s.
    start: Expression
    end: Expression
    # One for each unknown, which stands as ``Name("w")`` or, differentiated k times along x, as
    # ``Derivative("w", k)``; linear, with coefficients that may contain the coordinate, ``Name("x")``.
    equations: tuple[Equation, ...]
    # As many as the order in x; an unknown of any field stands as ``Call("w", point, order)``.
    conditions: tuple[Equation, ...]
    span: Span | None = field(default=None, compare=False, repr=False)
    # latex and doc: label and description; empty when not given.
    latex: str = ""
    doc: str = ""
    # The equations and then the conditions as they are written, where brackets in them bear primes.
    written: tuple[Equation, ...] = ()

    def rewritten(self, new: Callable[[Expression], Expression]) -> FieldProblem:
        """Return the problem with another expression in place of each, of equations for each side."""

        def sides(equations: tuple[Equation, ...]) -> tuple[Equation, ...]:
            return tuple(replace(e, left=new(e.left), right=new(e.right)) for e in equations)

        return replace(
            self,
            start=new(self.start),
            end=new(self.end),
            equations=sides(self.equations),
            conditions=sides(self.conditions),
            written=sides(self.written),
        )


@dataclass(frozen=True, slots=True)
class FoundValue:
    """A value at equilibrium that was solved for, in the unit that its parameter was declared in."""

    name: str
    value: Fraction
    radius: Fraction  # bounds the distance from ``value`` to the solution
    unit: str = ""
    declared: Fraction | None = None  # what the solution was looked for from

    @property
    def ball(self) -> arb:
        """The value as a ball."""
        with precision(FOUND_BITS):
            return ball(self.value) + arb(0, float(self.radius))

    @property
    def declared_text(self) -> str | None:
        """The declared value as a decimal."""
        return None if self.declared is None else f"{float(self.declared):.15g}"


@dataclass(frozen=True, slots=True)
class OperatingPoint:
    """Values at equilibrium, the nonlinear equations that hold there, and what became of them."""

    values: NamedExpressions  # by name, "x'" for a rate
    equations: tuple[Equation, ...]  # as written
    linear: tuple[Equation, ...]  # of the deviations
    # Of Lagrange's equations the coordinates, and in their order the matrices of mass, damping and stiffness.
    coordinates: tuple[str, ...] = ()
    matrices: tuple[tuple[tuple[Expression, ...], ...], ...] = ()
    # Names whose values were used: in what was solved by value, and for signs.
    solved_with: frozenset[str] = frozenset()
    found: tuple[FoundValue, ...] = ()


@dataclass(frozen=True, slots=True)
class Signal:
    """A signal's name, with its expression or one of the ``[equations]`` that determine unknowns together."""

    name: str
    expression: Expression
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class PlacedBlock:
    """A block with its values, or another model's transfer function (``submodel`` and ``tf``)."""

    name: str
    block: BlockType | None
    values: NamedExpressions = ()
    submodel: Model | None = None
    tf: tuple[str, str] | None = None
    span: Span | None = field(default=None, compare=False, repr=False)

    @property
    def formula(self) -> Expression | None:
        """The transfer function in s and the block's parameters; None of state equations and models."""
        text = self.block.formula if self.block else ""
        return parse(Text.alone("<block>", text)) if text else None


@dataclass(frozen=True, slots=True)
class SampledBlocks:
    """Blocks that a computer works out from samples, holding what they return from one to the next."""

    blocks: tuple[str, ...]
    period: Expression  # from sample to sample [s]
    delay: Expression  # from a sample to the output that follows from it [s]
    by: str = ""  # what makes functions of z of blocks in s; empty where they are written in z
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Input:
    """What acts on a node, or a free signal.

    ``kind`` is ``signal`` or one of :data:`INPUT_KINDS`. What is given at two nodes
    acts on the first and reacts on the second; a motion is then that of the first relative to the second.
    """

    name: str
    kind: str
    nodes: tuple[NodeReference, ...] = ()
    dimension: Dimension | None = None
    unit: str = ""
    latex: str = ""
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class ContactPort:
    """Where the machine is touched: a node, or two, the second for the reaction."""

    name: str
    nodes: tuple[NodeReference, ...]
    domain: Domain  # one of :data:`PORT_PAIRS`
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Output:
    """A named expression of nodes, signals, element quantities and inputs."""

    name: str
    expression: Expression
    dimension: Dimension | None = None
    unit: str = ""
    latex: str = ""
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Analysis:
    """Defaults for the commands: band [Hz], number of modes, digits; names in which formulas are printed.

    ``data_end`` is the frequency at which the data end that the model was fitted to [Hz].
    """

    band: tuple[Fraction, Fraction] | None = None
    data_end: Fraction | None = None
    modes: int | None = None
    digits: int | None = None
    print: NamedExpressions = ()
    prefer: tuple[Expression, ...] = ()  # dimensionless groups
    form: str = ""  # in which transfer functions that have it are printed


@dataclass(frozen=True, slots=True)
class Figure:
    """A figure the specification asks for; of a loop when a gain is named, in reports over measured data.

    ``band`` holds the frequencies it shows [Hz], ``until`` the last time [s], ``limits`` the first and last
    gain of a locus, where it says so itself.
    """

    name: str
    kind: str
    of: tuple[tuple[str, str], ...]
    title: str = ""
    gain: str = ""
    span: Span | None = field(default=None, compare=False, repr=False)
    has_data: bool = False
    band: tuple[Fraction, Fraction] | None = None
    until: Fraction | None = None
    limits: tuple[Fraction, Fraction] | None = None
    over: tuple[str, ...] = ()  # the parameters of a figure of stability
    at: tuple[Fraction, ...] = ()  # the frequencies of deflections [Hz]


TRANSFORMER_SYMBOLS: Final = ("gears", "belt", "screw", "rack", "lever", "coils", "box")
"""What a transformer may be drawn as."""


@dataclass(frozen=True, slots=True)
class DrawingHints:
    """How a specification wants its model drawn; a drawing needs none of them."""

    order: tuple[str, ...] = ()  # nodes from left to right
    symbols: tuple[tuple[str, str], ...] = ()  # transformers with what they are drawn as
    rollers: bool | None = None  # below masses; None if that is left to the drawing
    is_up: bool = False  # what moves in translation moves upwards


@dataclass(frozen=True, slots=True)
class RootOfS:
    """``(slope*s + shift)^(1/order)``."""

    slope: Expression
    shift: Expression
    order: int


@dataclass(frozen=True, slots=True)
class Published:
    """What a paper printed for one transfer function."""

    tf: tuple[str, str]
    expression: Expression
    where: NamedExpressions = ()
    scale: Expression | None = None
    source: str = ""
    span: Span | None = field(default=None, compare=False, repr=False)
    is_latex: bool = False  # read from LaTeX
    others: tuple[Expression, ...] = ()  # sides before the last one, of G = a = b


@dataclass(frozen=True, slots=True)
class PrintedRow:
    """A row of a printed table of roots."""

    values: tuple[tuple[str, ExactValue], ...]  # of parameters, in place of the model's
    entries: tuple[str, ...]  # digits as printed, ``-`` for a gap
    span: Span | None = field(default=None, compare=False, repr=False)
    heading: str = ""  # of its column or row in LaTeX


@dataclass(frozen=True, slots=True)
class PrintedTable:
    """A table of poles or zeros that a paper printed."""

    name: str
    tf: tuple[str, str]
    of: Literal["poles", "zeros"]
    prints: Expression | None  # of :data:`ROOT_QUANTITIES` and parameters; ``None`` where it is not said
    rows: tuple[PrintedRow, ...]
    source: str = ""
    span: Span | None = field(default=None, compare=False, repr=False)


ROOT_QUANTITIES = {
    "omega": "the imaginary part of a root [rad/s]",
    "sigma": "its real part [rad/s]",
    "f": "the imaginary part over 2 pi [Hz]",
    "omega_n": "its distance from 0, the natural frequency [rad/s]",
    "f_n": "that distance over 2 pi [Hz]",
    "zeta": "the damping ratio, minus the real part over the distance from 0",
}
"""What ``prints`` of a table may use of a root."""


@dataclass(frozen=True, slots=True)
class Model:
    """Everything a specification says, resolved.

    ``warnings`` are what it says that may not be meant, from its text alone; those of models in blocks too.
    ``quotients`` holds the dimension of every output over input that is known; it may be so where neither
    end's is, as when one is the other times a block.

    Raises
    ------
    SpecError, ModelError
        By :func:`symflex.model.resolve`, with every problem of the text at once.
    """

    parameters: tuple[ModelParameter, ...] = ()
    definitions: tuple[Definition, ...] = ()
    nodes: tuple[NetworkNode, ...] = ()
    elements: tuple[PlacedElement, ...] = ()
    signals: tuple[Signal, ...] = ()
    blocks: tuple[PlacedBlock, ...] = ()
    fields: tuple[FieldProblem, ...] = ()
    inputs: tuple[Input, ...] = ()
    outputs: tuple[Output, ...] = ()
    title: str = ""
    source: str = ""
    analysis: Analysis = Analysis()
    figures: tuple[Figure, ...] = ()
    ports: tuple[ContactPort, ...] = ()
    drawing: DrawingHints = DrawingHints()
    published: tuple[Published, ...] = ()
    notation: tuple[tuple[str, str], ...] = ()  # symbols of a paper, as typed in LaTeX, and their names here
    tables: tuple[PrintedTable, ...] = ()
    signal_units: tuple[tuple[Variable, Dimension], ...] = ()
    quotients: tuple[tuple[tuple[str, str], Dimension], ...] = ()
    sampled: SampledBlocks | None = None  # what takes samples; all else is continuous
    operating_point: OperatingPoint | None = None
    # Outputs that are imposed, each with an input that follows from them: functions go the other way there.
    imposed: tuple[tuple[str, str], ...] = ()
    warnings: tuple[Diagnostic, ...] = field(default=(), compare=False, repr=False)
    # What was declared in cycles and is used in radians, as it is used; of models in blocks too.
    conversions: tuple[ModelParameter, ...] = field(default=(), compare=False, repr=False)

    def __repr__(self) -> str:
        pairs = ", ".join("/".join(pair) for pair in self.transfer_functions[:PAIRS_SHOWN])
        more = ", ..." if len(self.transfer_functions) > PAIRS_SHOWN else ""
        return f"<Model {self.title or 'without title'}: {pairs}{more}>"

    @property
    def data_end(self) -> Fraction | None:
        """The lowest frequency [Hz] at which data end that it, or a model in its blocks, was fitted to."""
        inner = [b.submodel.data_end for b in self.blocks if b.submodel is not None]
        return min((end for end in (self.analysis.data_end, *inner) if end is not None), default=None)

    @property
    def has_equations(self) -> bool:
        """True when ``[equations]`` determine some of its signals."""
        return any(isinstance(x.expression, Equation) for x in self.signals)

    @property
    def is_distributed(self) -> bool:
        """True when something in it extends along x or delays: its transfer functions are not rational."""
        return (
            bool(self.fields)
            or any(isinstance(use.element, LineElement) for use in self.elements)
            or any(
                (b.block is not None and bool(b.block.kernel_time))
                or (b.submodel is not None and b.submodel.is_distributed)
                for b in self.blocks
            )
        )

    @property
    def root(self) -> RootOfS | None:
        """The root that its equations have in place of s, where one is written."""
        values = next((dict(b.values) for b in self.blocks if b.block is ROOT), None)
        if values is None or not isinstance(order := values["q"], Number):
            return None
        return RootOfS(values["a"], values["b"], int(order.value))

    @property
    def settable(self) -> tuple[ModelParameter, ...]:
        """The parameters but for the imaginary unit, and the z of sampled blocks."""
        moving = (Z,) if self.sampled is not None else ()
        return tuple(p for p in self.parameters if not p.is_imaginary and p.name not in moving)

    @property
    def imaginary(self) -> ModelParameter | None:
        """The imaginary unit, where a loss factor or an expression has brought it in."""
        return next((p for p in self.parameters if p.is_imaginary), None)

    @property
    def is_closed_loop(self) -> bool:
        """True when a signal depends on itself: by others, or by what it drives in the network."""
        network = {n.name for n in self.nodes} | {use.name for use in self.elements}
        uses: dict[str, set[str]] = {"": set()}
        owned = [(d.name, d.expression) for d in self.definitions]
        owned += [(x.name, x.expression) for x in self.signals if not isinstance(x.expression, Equation)]
        for use in self.elements:
            driven = {port.name for port in use.element.parameters if port.signal}
            owned += [("", value) for name, value in use.values if name in driven]
        for owner, expression in owned:
            owners = {n.owner if isinstance(n, Attribute) else n.name for n in names(expression)}
            uses.setdefault(owner, set()).update("" if name in network else name for name in owners)
        for start, first in uses.items():
            reached, pending = set[str](), [*first]
            while pending:
                name = pending.pop()
                if name not in reached:
                    reached.add(name)
                    pending += uses.get(name, ())
            if start in reached:
                return True
        return False

    def expressions(self) -> Iterator[tuple[str, Expression]]:
        """Yield all expressions but printed ones, each with the name it defines or an empty one."""
        yield from ((d.name, d.expression) for d in self.definitions)
        yield from (("", e) for use in self.elements for _, e in use.all_values)
        yield from ((b.name, e) for b in self.blocks for _, e in b.values)
        yield from ((x.name, x.expression) for x in self.signals)
        yield from (("", o.expression) for o in self.outputs)
        for f in self.fields:
            yield from ((f.name, e) for e in (f.start, f.end, *f.equations, *f.conditions))
        if self.sampled is not None:
            yield from (("", e) for e in (self.sampled.period, self.sampled.delay))

    @property
    def transfer_functions(self) -> tuple[tuple[str, str], ...]:
        """Every (output, input) pair, outputs first."""
        return tuple((o.name, i.name) for o in self.outputs for i in self.inputs)

    @property
    def answers(self) -> tuple[Output, ...]:
        """What follows: outputs, but for those imposed, and the inputs that follow from these."""
        imposed, given = {y for y, _ in self.imposed}, {i.name: i for i in self.inputs}
        freed = (given[u] for _, u in self.imposed)
        own = (Output(i.name, Name(i.name), i.dimension, i.unit, i.latex) for i in freed)
        return (*(o for o in self.outputs if o.name not in imposed), *own)

    @property
    def causes(self) -> tuple[Input, ...]:
        """What is given: inputs, but for those that follow, and the outputs that are imposed."""
        freed, known = {u for _, u in self.imposed}, {o.name: o for o in self.outputs}
        imposed = (known[y] for y, _ in self.imposed)
        own = (
            Input(o.name, MOTIONS.get(o.unit, "signal"), (), o.dimension, o.unit, o.latex) for o in imposed
        )
        return (*(i for i in self.inputs if i.name not in freed), *own)


MOTIONS: Final = {
    "m": "displacement",
    "m/s": "velocity",
    "m/s^2": "acceleration",
    "rad": "angle",
    "rad/s": "angular_velocity",
    "rad/s^2": "angular_acceleration",
}  # what is imposed with an output of a unit
AnyDraft = TypeVar("AnyDraft", bound=Any)  # a model, or one that is not resolved yet


def rewritten(draft: AnyDraft, new: Callable[[Expression], Expression]) -> AnyDraft:
    """Return a model or draft with another expression in place of each but those of definitions."""
    changed: AnyDraft = replace(
        draft,
        elements=tuple(replace(x, values=tuple((n, new(e)) for n, e in x.values)) for x in draft.elements),
        blocks=tuple(replace(x, values=tuple((n, new(e)) for n, e in x.values)) for x in draft.blocks),
        signals=tuple(replace(x, expression=new(x.expression)) for x in draft.signals),
        outputs=tuple(replace(x, expression=new(x.expression)) for x in draft.outputs),
        fields=tuple(field.rewritten(new) for field in draft.fields),
    )
    return changed


@dataclass(frozen=True, slots=True)
class InputKind:
    """An input that acts on nodes."""

    domain: Domain  # of the nodes
    unit: str  # SI unit of the input
    # Of an input that nodes follow, ``s^order * node = input``; ``None`` of one delivered into them.
    order: int | None = None

    @property
    def quantity(self) -> str:
        """The name of what an imposed input has to deliver: ``f``, ``tau`` or ``i``."""
        return THROUGH_NAME[self.domain]

    @property
    def effort(self) -> str:
        """The kind that delivers into the same nodes."""
        return next(
            k for k, kind in INPUT_KINDS.items() if kind.domain == self.domain and not kind.is_imposed
        )

    @property
    def is_imposed(self) -> bool:
        """Whether nodes follow it."""
        return self.order is not None

    def delivered(self, name: str) -> Variable:
        """Return the unknown that an imposed input delivers; its name may be an element's too."""
        return Variable("through", name, "supplied" if self.quantity == "i" else f"supplied_{self.quantity}")


INPUT_KINDS: dict[str, InputKind] = {
    "force": InputKind("translation", "N"),
    "torque": InputKind("rotation", "N*m"),
    "current": InputKind("electrical", "A"),
    "voltage": InputKind("electrical", "V", 0),
    "flow": InputKind("acoustic", "m^3/s"),
    "pressure": InputKind("acoustic", "Pa", 0),
    "heat": InputKind("thermal", "W"),
    "temperature": InputKind("thermal", "K", 0),
    "displacement": InputKind("translation", "m", 0),
    "velocity": InputKind("translation", "m/s", 1),
    "acceleration": InputKind("translation", "m/s^2", 2),
    "angle": InputKind("rotation", "rad", 0),
    "angular_velocity": InputKind("rotation", "rad/s", 1),
    "angular_acceleration": InputKind("rotation", "rad/s^2", 2),
}
"""Every kind but a free signal, which acts on no node."""


@dataclass(frozen=True, slots=True)
class DualPair:
    """Two quantities whose product is a power."""

    effort: str
    flow: str
    units: tuple[str, str]  # of both
    # Kinds of inputs: what is delivered into a node, and what nodes follow.
    delivered: str
    imposed: str


PORT_PAIRS: dict[str, DualPair] = {
    "translation": DualPair("force", "velocity", ("N", "m/s"), "force", "velocity"),
    "rotation": DualPair("torque", "angular velocity", ("N*m", "rad/s"), "torque", "angular_velocity"),
    "electrical": DualPair("voltage", "current", ("V", "A"), "current", "voltage"),
    "acoustic": DualPair("pressure", "flow", ("Pa", "m^3/s"), "flow", "pressure"),
}
"""By domain; temperature and heat flow are none."""

"""Frequencies in Hz, rpm or rev/s: where a written product means radians, and where it stays in cycles.

Input: an expression as it was written, and what its names are measured in.
Output: the expression with 2 pi beside every frequency that is read in radians.

A frequency in cycles is converted, unless the same written product has the 2 pi beside it already, once for
each power. A product ends at a sum, in the argument of a function, and at a name: what a definition contains
changes nothing where it is used. Each use is read by itself.

    s + f_c                       s + 2*pi*f_c
    m*(2*pi*f)^2, 4*pi^2*m*f^2    as written: the product has its 2*pi
    2*pi*(f_0 + k*u)              as written: terms that count alike are read together
    J_p*Omega*s*b                 J_p*(2*pi*Omega)*s*b, also if J_p = rho*pi*h*D^4/32
    1/f, 3/f, f^-1                as written: a period; s/f is s/(2*pi*f)
    f_c/f_s                       as written: either reading gives the same ratio
    p*phi                         p/(2*pi)*phi, with p in mm/rev
    pi*d*n, rho*pi*d^2/4*l*n^2    refused: a pi that belongs to no such pair leaves two readings
    2*pi*r*l*n                    refused: 2*pi*r may be a circumference
    K/f                           refused: K times a period, or K over an angular frequency
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import groupby, product
from math import pi
from typing import TYPE_CHECKING, Literal

from symflex.algebra import FUNCTIONS, LAPLACE
from symflex.expressions import (
    Call,
    Derivative,
    Differentiated,
    Equation,
    Expression,
    Measured,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
    format_expression,
    names_among,
    number,
    power,
    product_of,
    quotient,
    with_children,
)
from symflex.model.analysis import lines_in_order
from symflex.model.declarations import one_of
from symflex.model.linearity import rational_exponent
from symflex.model.model import Definition, Published, rewritten
from symflex.model.network import AsWritten
from symflex.model.reading import QuantityLiteral, Reader
from symflex.model.units import constant_measure, counts_cycles
from symflex.quantities import DIMENSIONLESS, Dimension, Quantity, unit_of

if TYPE_CHECKING:
    from symflex.model.network import Draft

Kind = Literal["number", "turn", "period", "s", "other"]
ZERO, ONE, HALF = Fraction(0), Fraction(1), Fraction(1, 2)
PER_SECOND, SECOND, METRE = (unit_of(text).dimension for text in ("1/s", "s", "m"))
WRITTEN_OUT = (pi, 2 * pi, 4 * pi**2, 1 / (2 * pi))
CLOSE = 1e-3
"""How near a decimal comes to one of these if it was written for it: 6.28 is off by 5e-4."""
CLOSER = 1e-4
"""The same for the value of a parameter, which is no such number if it is a damping ratio of 0.159."""


def turned_name(name: str, cycles: Fraction | int) -> Expression:
    """Return a name with the 2 pi that make its cycles radians.

    >>> [format_expression(turned_name("f", n)) for n in (1, 2, -1)]
    ['2*pi*f', '4*pi^2*f', 'f/(2*pi)']
    """
    size = abs(Fraction(cycles))
    if size.denominator == 1:
        factors = product_of([number(2 ** int(size)), power(Name("pi"), int(size))])
    else:
        factors = power(product_of([number(2), Name("pi")]), number(size))
    return product_of([factors, Name(name)]) if cycles > 0 else quotient(Name(name), factors)


@dataclass(frozen=True, slots=True)
class Factor:
    """A factor of a written product. Exponents are those that it has there."""

    node: Expression  # as it is read; in cycles, if it counts any
    exponent: Fraction
    kind: Kind = "other"
    dimension: Dimension | None = None  # without its exponent; ``None`` where it is open
    is_length: bool = False  # whether it is a length, an area or a volume: a pi may belong to it
    # What a number is: exponent of pi, of the 2 above and below the line, its value without pi.
    pis: Fraction = ZERO
    twos: tuple[Fraction, Fraction] = (ZERO, ZERO)
    value: Fraction = ONE
    is_decimal_of_pi: bool = False  # whether it seems to be written for 2 pi, as 6.2832 is
    # What counts cycles: in radians, exponent of the cycle, the names that it consists of.
    turned: Expression | None = None
    degree: Fraction = ZERO
    names: tuple[str, ...] = ()
    parameters: tuple[str, ...] = ()  # whose cycles they are
    unit: str = ""  # as it was written, of the first of these
    scale: Fraction = ONE  # of a parameter, what one of this unit is in SI units
    hidden: Fraction = ZERO  # exponent of cycles that have become radians inside


@dataclass(frozen=True, slots=True)
class ProductReading:
    """A written product: the turns that stay as they are, and the exponent of those that do not."""

    factors: Sequence[Factor]
    kept: frozenset[int] = frozenset()
    degree: Fraction = ZERO
    problem: str = ""  # a key of PROBLEMS where two readings are possible

    @property
    def open(self) -> frozenset[int]:
        """The turns that become radians, unless a larger product has their 2 pi."""
        return frozenset(i for i, f in enumerate(self.factors) if f.kind == "turn") - self.kept

    @property
    def waits(self) -> bool:
        """Whether a product around this one may have the 2 pi."""
        above = all(self.factors[i].exponent > 0 for i in self.open)
        return self.degree != 0 and not self.problem and (above or self.degree > 0)


PROBLEMS = {
    "pi": (
        "the pi in '{text}' leaves two readings of {names}: as it stands, in cycles, or '{radians}'",
        "write the second for radians; for cycles give {quoted} {bare_unit}",
    ),
    "length": (
        "the 2*pi in '{text}' leaves two readings: it belongs to a length, or to {names}",
        "write 2*pi*{first} side by side if it belongs to it, and '{radians}' if not",
    ),
    "ratio": (
        "the 2*pi in '{text}' leaves two readings of {names}: as it stands, or the ratio '{ratio}'",
        "write 2*pi beside each of them for the ratio, or give both in the same unit",
    ),
    "period": (
        "'{text}' leaves two readings of {names}: a period 1/{first}, or '{radians}'",
        "write the second for radians; for the period write (1/{first}), or name it in [definitions]",
    ),
    "count": (
        "'{text}' leaves two readings of {names}: cycles in a period, or '{radians}'",
        "write the second for radians; for cycles divide one frequency by the other",
    ),
    "inside": (
        "'{text}' has a 2*pi beside what became radians where it was added or defined",
        "leave out the 2*pi, or write it beside the frequency itself",
    ),
    "by hand": (
        "'{text}' converts the unit of {names}, by hand, but its value is in SI units already",
        "leave out the number, or declare {quoted} without a unit",
    ),
    "decimal": (
        "a number in '{text}' seems to stand for pi, which leaves two readings of {names}",
        "write pi, as in 2*pi*{first}",
    ),
}
"""What leaves two readings, and what to do."""


@dataclass(slots=True)
class Cycles(AsWritten):
    """Reads the expressions of a model, each use of a frequency by itself."""

    reader: Reader
    numbers: Mapping[str, Fraction]  # values of parameters that are pure numbers
    measure: Callable[[Expression], Dimension | None]
    is_length: Callable[[Expression], bool]
    eager: Collection[str] = ()  # definitions in radians, which are divided by 2 pi where cycles are needed
    converted: set[str] = field(default_factory=set)  # parameters that became radians somewhere
    kept: set[str] = field(default_factory=set)  # names that are left in cycles somewhere
    known: dict[str, Factor] = field(default_factory=dict)  # what counts cycles, or is more than a name

    @property
    def turning(self) -> set[str]:
        """The names that count cycles."""
        return {name for name, factor in self.known.items() if factor.kind == "turn"}

    def read(self, expression: Expression, *, is_delay: bool = False) -> Expression:
        """Return an expression, or an equation, with 2 pi beside what is read in radians."""
        if isinstance(expression, QuantityLiteral):
            return expression
        if isinstance(expression, Equation | Sum):
            parts = [self.read(each, is_delay=is_delay) for each in expression.children]
            return with_children(expression, parts)
        return self._read(_reading(self._factors(expression, ONE), is_delay=is_delay), expression)

    def printed(self, published: Published) -> Published:
        """Return a printed formula with 2 pi beside what it means in radians; its lines may hide names."""
        printed_lines = dict(published.where)
        count = len(published.others) + 1
        roots = [published.expression, *published.others]
        roots += [published.scale] if published.scale is not None else []
        order, circle = lines_in_order(roots, printed_lines)
        if circle:
            return published
        eager, reader = frozenset[str](), Reader()
        for _ in range(2):  # as in :func:`converted`
            inner = self._without(printed_lines, eager, reader)
            lines = {name: inner.define(Definition(name, printed_lines[name])).expression for name in order}
            read = [inner.read(root) for root in roots]
            eager, reader = frozenset(order) & inner.turning - inner.kept, self.reader
        where = tuple((name, lines.get(name, e)) for name, e in published.where)
        expression, *others = read[:count]
        scale = read[count] if published.scale is not None else None
        return replace(published, expression=expression, where=where, scale=scale, others=tuple(others))

    def _without(self, hidden: Collection[str], eager: Collection[str], reader: Reader) -> Cycles:
        """Return what reads expressions in which some names are others than the model's."""

        def measure(expression: Expression) -> Dimension | None:
            return None if names_among(expression, hidden) else self.measure(expression)

        return Cycles(
            reader,
            {n: v for n, v in self.numbers.items() if n not in hidden},
            measure,
            lambda e: not names_among(e, hidden) and self.is_length(e),
            eager,
            known={n: f for n, f in self.known.items() if n not in hidden},
        )

    def define(self, definition: Definition) -> Definition:
        """Return a definition as it is read, and remember what it counts.

        One that is itself a frequency, as ``f_N = f_s/2``, is read where it is used. In any other cycles
        become radians at once, as in ``c = 2*zeta*m*f_0``.
        """
        name, written = definition.name, definition.expression
        if isinstance(written, QuantityLiteral):
            return replace(definition, expression=self._defined(name, written))
        factors = self._factors(written, ONE)
        reading = _reading(factors)
        if all(f.kind == "number" for f in factors):
            self.known[name] = _merged(factors)
        elif any(f.kind == "period" for f in factors) and self.measure(written) == SECOND:
            self.known[name] = Factor(Name(name), ONE, "period", SECOND)
        if reading.waits and self._is_plain(written, reading):
            parameters = dict.fromkeys(p for i in reading.open for p in factors[i].parameters)
            unit = next((factors[i].unit for i in sorted(reading.open)), "")
            self.count(name, reading.degree, tuple(parameters), unit)
            turned = reading.open if name in self.eager else frozenset[int]()
            return replace(definition, expression=_chosen(reading, written, turned))
        if reading.degree and not reading.problem:
            dimension = self.measure(written)
            self.known[name] = Factor(Name(name), ONE, dimension=dimension, hidden=reading.degree)
        return replace(definition, expression=self._read(reading, written))

    def _defined(self, name: str, written: QuantityLiteral) -> QuantityLiteral:
        quantity = written.quantity
        if not counts_cycles(quantity):
            return replace(written, quantity=replace(quantity, cycles=0))
        self.count(name, Fraction(quantity.cycles), (name,), quantity.unit)
        exact = quantity.angular() if name in self.eager else quantity.cyclic()
        return replace(written, quantity=replace(quantity, magnitude=exact[0], pi_power=exact[1], cycles=0))

    def count(
        self, name: str, degree: Fraction, parameters: tuple[str, ...], unit: str, scale: Fraction = ONE
    ) -> None:
        """Remember a name that counts cycles."""
        is_eager = name in self.eager
        cycles = turned_name(name, -degree) if is_eager else Name(name)
        radians = Name(name) if is_eager else turned_name(name, degree)
        self.known[name] = Factor(
            cycles,
            ONE,
            "turn",
            self.measure(Name(name)),
            turned=radians,
            degree=degree,
            names=(name,),
            parameters=parameters,
            unit=unit,
            scale=scale,
        )

    def _is_plain(self, written: Expression, reading: ProductReading) -> bool:
        """Tell whether a definition is a frequency, or a number times something else that counts cycles."""
        others = (f.dimension for f in reading.factors if f.kind in ("s", "period", "other"))
        is_frequency = self.measure(written) == PER_SECOND**reading.degree
        return is_frequency or all(d == DIMENSIONLESS for d in others)

    def _read(self, reading: ProductReading, written: Expression) -> Expression:
        """Return a product in which what is open becomes radians; two readings are noted."""
        for i, factor in enumerate(reading.factors):
            if i in reading.open and reading.degree:
                self.converted |= {*factor.parameters}
            elif factor.kind == "turn":
                self.kept |= {*factor.names, *factor.parameters}
        if reading.problem:
            self._note(reading, written)
        return _chosen(reading, written, reading.open if reading.degree else frozenset())

    def _note(self, reading: ProductReading, written: Expression) -> None:
        turns = [f for f in reading.factors if f.kind in ("turn", "period")]
        names = list(dict.fromkeys(n for f in turns for n in f.names))
        units = dict.fromkeys(self.known[p].unit for f in turns for p in f.parameters)
        quoted = " and ".join(f"'{n}'" for n in names)
        message, hint = PROBLEMS[reading.problem]
        said = {
            "text": written.span.text if written.span else format_expression(written),
            "quoted": quoted,
            "names": f"{quoted}, in {' and '.join(repr(u) for u in units)}" if any(units) else quoted,
            "first": names[0] if names else "",
            "ratio": "/".join(names),
            "radians": format_expression(_chosen(reading, written, reading.open)),
            "bare_unit": "in '1/s'"
            if all(f.dimension == PER_SECOND for f in turns)
            else "in a unit without turns",
        }
        self.reader.note("SF204", message.format(**said), written.span, hint.format(**said))

    def _factors(self, node: Expression, exponent: Fraction, *, is_above: bool = False) -> list[Factor]:
        """Return the factors of a written product, in order; ``is_above`` if more is divided by."""
        parts = _parts(node)
        if parts is None:
            return [self._factor(node, exponent)]
        factors = [
            f
            for i, (part, e) in enumerate(parts)
            for f in self._factors(part, exponent * e, is_above=isinstance(node, Quotient) and not i)
        ]
        is_whole = isinstance(node, Power) or (isinstance(node, Quotient) and not is_above)
        return _with_period(factors, exponent) if is_whole else factors

    def _factor(self, node: Expression, exponent: Fraction) -> Factor:
        match node:
            case Measured():
                return Factor(node, exponent)
            case Number(value):
                return _number(node, value, exponent)
            case Name("pi"):
                return Factor(node, exponent, "number", DIMENSIONLESS, pis=exponent)
            case Name(name) if name == LAPLACE:
                return Factor(node, exponent, "s", PER_SECOND)
            case Name(name) if name in self.known:
                factor = self.known[name]
                if factor.turned is None:
                    return _raised(factor, node, exponent)
                turned = replace(factor.turned, span=node.span)
                return replace(_raised(factor, replace(factor.node, span=node.span), exponent), turned=turned)
            case Name(name):
                is_decimal = _is_decimal_of_pi(self.numbers.get(name, ONE), CLOSER)
                own_dimension, is_length = self.measure(node), self.is_length(node)
                return Factor(node, exponent, "other", own_dimension, is_length, is_decimal_of_pi=is_decimal)
            case Sum():
                return self._sum(node, exponent)
            case Derivative():
                return Factor(node, exponent, "s")
            case Differentiated():
                return Factor(with_children(node, [self.read(c) for c in node.children]), exponent, "s")
            case Call(name, argument):
                read = with_children(node, [self.read(argument, is_delay=name == "exp")])
                return Factor(read, exponent, dimension=DIMENSIONLESS if name in FUNCTIONS else None)
            case Power(base, power):
                return Factor(with_children(node, [self.read(base), self.read(power)]), exponent)
        return Factor(node, exponent)

    def _sum(self, node: Sum, exponent: Fraction) -> Factor:
        """Return a sum as a factor: a turn, if all of its terms count alike."""
        readings = [_reading(self._factors(term, ONE)) for term in node.terms]
        pairs, dimension = list(zip(readings, node.terms, strict=True)), self.measure(node)
        degrees = {r.degree for r in readings if r.waits}
        if len(degrees) == 1 and all(r.waits for r in readings):
            turns = [r.factors[i] for r in readings for i in sorted(r.open)]
            units = {f.unit for f in turns}
            return Factor(
                with_children(node, [_chosen(r, t, ()) for r, t in pairs]),
                exponent,
                "turn",
                dimension,
                turned=with_children(node, [_chosen(r, t, r.open) for r, t in pairs]),
                degree=degrees.pop() * exponent,
                names=tuple(n for f in turns for n in f.names),
                parameters=tuple(p for f in turns for p in f.parameters),
                unit=units.pop() if len(units) == 1 else "",
            )
        kinds = {f.kind for r in readings for f in r.factors}
        hidden = ZERO if "s" in kinds else next(iter(degrees), ZERO)
        kind: Kind = "period" if "period" in kinds and dimension == SECOND else "other"
        read = with_children(node, [self._read(r, t) for r, t in pairs])
        return Factor(read, exponent, kind, dimension, self.is_length(node), hidden=hidden * exponent)


def converted(
    reader: Reader, draft: Draft, quantities: Mapping[str, Quantity | None]
) -> tuple[Draft, Cycles]:
    """Return a draft in which every frequency stands as it is meant, and what reads further expressions."""
    counting = {n: q for n, q in quantities.items() if q is not None and counts_cycles(q)}
    shared = {p.name: p for b in draft.blocks if b.submodel for p in b.submodel.parameters}
    for name, p in shared.items():
        quantity = one_of(p.written_unit) if p.written_unit else None
        if name not in counting and quantity is not None and counts_cycles(quantity):
            counting[name] = quantity  # in radians in that model, and so in this one
    turned = {n for n in counting if n in shared and not shared[n].cycles}
    turned |= _alone(draft, [n for n, q in counting.items() if q.cycles < 0]) - shared.keys()
    pure = (p for p in draft.declared if p.quantity is not None and not p.written_unit)
    numbers = {p.name: p.quantity.magnitude for p in pure if p.quantity is not None}
    measure = constant_measure(draft.declared, draft.inherited, draft.definitions)
    has_lengths = any(q is not None and q.dimension.m for q in quantities.values())
    # Where nothing is in metres, what has no unit may be.
    bare = None if has_lengths else one_of("m")
    in_metres = constant_measure(draft.declared, draft.inherited, draft.definitions, bare)

    def is_length(expression: Expression) -> bool:
        quantity = in_metres(expression)
        return quantity is not None and quantity != DIMENSIONLESS and quantity == METRE**quantity.m

    def started(eager: Collection[str], notes: Reader) -> Cycles:
        made = Cycles(notes, numbers, measure, is_length, eager)
        for name, q in counting.items():
            made.count(name, Fraction(q.cycles), (name,), q.unit, unit_of(q.unit).scale)
        return made

    first = started(turned, Reader())
    for definition in draft.definitions:
        first.define(definition)
    rewritten(draft, first.read)
    # A definition is in radians if nothing needs its cycles: then it prints as an angular frequency.
    eager = turned | (first.turning - counting.keys() - first.kept)
    cycles = started(eager, reader)
    defined = tuple(map(cycles.define, draft.definitions))
    return rewritten(replace(draft, definitions=defined), cycles.read), cycles


def _alone(draft: Draft, names: Collection[str]) -> set[str]:
    """Return the names that stand alone wherever they stand: then such a gain per turn is one per radian."""
    values = [e for group in (draft.elements, draft.blocks) for x in group for _, e in x.values]
    bare = {e.name for e in values if isinstance(e, Name)} & {*names}
    return bare - {n for e in draft.expressions() if not isinstance(e, Name) for n in names_among(e, bare)}


def _parts(node: Expression) -> Sequence[tuple[Expression, Fraction]] | None:
    """Return the factors that a node is made of, with exponents; ``None`` of one that is a factor."""
    match node:
        case Negative(operand):
            return ((operand, ONE),)
        case Product(factors):
            return [(f, ONE) for f in factors]
        case Quotient(above, below):
            return ((above, ONE), (below, -ONE))
        case Power(base, exponent) if (rational := rational_exponent(exponent)) is not None:
            return ((base, rational),)
        case Call("sqrt", argument, 0):
            return ((argument, HALF),)
    return None


def _chosen(reading: ProductReading, written: Expression, turned: Collection[int]) -> Expression:
    """Return a product with some of its turns in radians."""
    nodes = (f.turned or f.node if i in turned else f.node for i, f in enumerate(reading.factors))
    return _rebuilt(written, nodes)


def _rebuilt(node: Expression, factors: Iterator[Expression]) -> Expression:
    """Return a written product with other factors."""
    parts = _parts(node)
    if parts is None:
        return next(factors)
    after = [_rebuilt(part, factors) for part, _ in parts]
    after += node.children[len(after) :]
    is_same = all(old is new for old, new in zip(node.children, after, strict=True))
    return node if is_same else with_children(node, after)


def _number(node: Expression, value: Fraction, exponent: Fraction) -> Factor:
    evens = 0
    while value and value.denominator == 1 and value.numerator % 2 ** (evens + 1) == 0:
        evens += 1
    factor = Factor(
        node,
        ONE,
        "number",
        DIMENSIONLESS,
        twos=(Fraction(evens), ZERO),
        value=value,
        is_decimal_of_pi=_is_decimal_of_pi(value),
    )
    return _raised(factor, node, exponent)


def _is_decimal_of_pi(value: Fraction, close: float = CLOSE) -> bool:
    return value.denominator != 1 and any(abs(value / Fraction(each) - 1) < close for each in WRITTEN_OUT)


def _raised(factor: Factor, node: Expression, exponent: Fraction) -> Factor:
    """Return a factor with another exponent than one."""
    up, down = (n * abs(exponent) for n in factor.twos)
    is_whole = exponent.denominator == 1 and (factor.value or exponent > 0)
    return replace(
        factor,
        node=node,
        exponent=exponent,
        pis=factor.pis * exponent,
        twos=(up, down) if exponent > 0 else (down, up),
        value=factor.value ** int(exponent) if is_whole else ONE,
        degree=factor.degree * exponent,
        hidden=factor.hidden * exponent,
    )


def _merged(factors: Iterable[Factor]) -> Factor:
    """Return numbers as one."""
    merged = Factor(number(1), ONE, "number", DIMENSIONLESS)
    for f in factors:
        merged = replace(
            merged,
            pis=merged.pis + f.pis,
            twos=(merged.twos[0] + f.twos[0], merged.twos[1] + f.twos[1]),
            value=merged.value * f.value,
            is_decimal_of_pi=merged.is_decimal_of_pi or f.is_decimal_of_pi,
        )
    return merged


def _with_period(factors: list[Factor], exponent: Fraction) -> list[Factor]:
    """Return factors with the frequency in them as a period, if they are a number over a frequency."""
    turns = [f for f in factors if f.kind == "turn"]
    others = [f for f in factors if f.kind != "turn"]
    if len(turns) != 1 or any(f.kind != "number" or f.pis or f.is_decimal_of_pi for f in others):
        return factors
    is_period = turns[0].dimension == PER_SECOND and turns[0].exponent == turns[0].degree == -exponent
    return [replace(f, kind="period") if f is turns[0] and is_period else f for f in factors]


def _reading(factors: Sequence[Factor], *, is_delay: bool = False) -> ProductReading:
    """Decide which frequencies of a product stay in cycles; in a delay ``s/f`` is s times a period."""
    turns = frozenset(i for i, f in enumerate(factors) if f.kind == "turn")
    if problem := _problem_of_numbers(factors):
        return ProductReading(factors, problem=problem)
    kept, used = _pairs(factors)
    others = [factors[i] for i in sorted(turns - kept)]
    degree = sum((f.degree for f in others), ZERO)
    pis = sum((f.pis for f in factors), -used)
    is_lone = abs(pis) == 1 and any(f.is_length for f in factors)
    if pis and degree:
        if not _is_pair(factors, pis, degree):
            problem = "pi"
        elif is_lone:
            problem = "length"
        else:
            kept = turns
    elif pis and others:
        units = {"Hz" if f.unit.endswith("Hz") else f.unit for f in others}
        is_mixed = len(units) > 1 and any(_is_pair(factors, pis, f.degree) for f in others)
        problem = "ratio" if is_mixed else ""
    elif pis:
        hidden = sum((f.hidden for f in factors), ZERO)
        problem = "inside" if hidden and _is_pair(factors, pis, hidden) and not is_lone else ""
    elif degree > 0:
        problem = "count" if any(f.kind == "period" for f in factors) else ""
    elif degree and is_delay and any(f.kind == "s" for f in factors):
        kept = turns
    elif degree:
        problem = _problem_of_periods(factors, others, degree)
    if kept == turns or problem:
        degree = ZERO
    return ProductReading(factors, kept, degree, problem)


def _pairs(factors: Sequence[Factor]) -> tuple[frozenset[int], Fraction]:
    """Return the turns that stand side by side with their 2 pi, and how many pi these are.

    Beside a length, to which a pi may belong, only ``2*pi*f`` in this order is one, and ``p/(2*pi)``.
    """
    kept, used = set[int](), ZERO
    is_strict = any(f.is_length for f in factors)
    for kind, run in groupby(range(len(factors)), lambda i: factors[i].kind in ("turn", "number")):
        indices = list(run) if kind else []
        turns = [i for i in indices if factors[i].kind == "turn"]
        degree = sum((factors[i].degree for i in turns), ZERO)
        if not degree:
            continue
        starts, ends = range(turns[0], indices[0] - 1, -1), range(turns[-1], indices[-1] + 1)
        for first, last in product(starts, ends):
            window = factors[first : last + 1]
            is_plain = not is_strict or _is_in_order(window, factors[last + 1 : last + 2])
            if is_plain and _is_pair(window, sum((f.pis for f in window), ZERO), degree):
                kept |= set(turns)
                used += degree
                break
    return frozenset(kept), used


def _is_in_order(window: Sequence[Factor], following: Sequence[Factor]) -> bool:
    """Tell whether a pair is written as ``2*pi*f``, or as ``p/(2*pi)`` where no length is divided by."""
    *others, _ = [f.kind for f in window]
    if "turn" in others:
        is_below = any(f.is_length and f.exponent < 0 for f in following)
        is_pitch = window[0].degree < 0 < window[0].exponent
        return is_pitch and others[0] == "turn" and "turn" not in others[1:] and not is_below
    return len(others) < 3 and bool(window[-2:-1]) and window[-2].pis != 0  # noqa: PLR2004 (a number and pi)


def _is_pair(factors: Iterable[Factor], pis: Fraction, degree: Fraction) -> bool:
    """Tell whether there are as many pi as cycles, and a 2 for each."""
    twos = sum((f.twos[degree < 0] for f in factors), ZERO)
    return pis == degree != 0 and twos >= abs(degree)


def _problem_of_numbers(factors: Sequence[Factor]) -> str:
    """Return what numbers beside a frequency leave open: a decimal for pi, or 60 beside rpm."""
    counting = [f for f in factors if f.kind in ("turn", "period")]
    if not counting:
        return ""
    if any(f.is_decimal_of_pi for f in factors):
        return "decimal"
    value, pis = Fraction(1), sum((f.pis for f in factors), ZERO)
    for f in factors:
        value *= f.value
    exponents = [f.exponent for f in counting] + [pis]
    if sum(f.degree for f in counting) == 0 or any(e.denominator != 1 for e in exponents):
        return ""
    units = [f.scale ** int(f.exponent) for f in counting]
    return "by hand" if any(u != 1 and value == u * 2 ** int(pis) for u in units) else ""


def _problem_of_periods(factors: Sequence[Factor], others: Sequence[Factor], degree: Fraction) -> str:
    """Return whether what is divided by a frequency alone may be a period, or a multiple of one."""
    above = [f for f in factors if f.exponent > 0 and f.kind != "number"]
    if any(f.kind == "s" or f.dimension == PER_SECOND for f in above):
        return ""  # s/f, and w/f with w in rad/s, compare angular frequencies
    below = [f for f in factors if f.exponent < 0 and f.kind != "number"]
    is_alone = all(f.dimension == (PER_SECOND if f in others else DIMENSIONLESS) for f in below)
    is_number = all(f.kind == "number" for f in factors if f not in below)
    return "period" if below and is_alone and (degree == -1 or is_number) else ""

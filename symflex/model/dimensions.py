"""Units: what every expression is measured in, and what free signals must be.

Dimensions of signals and free inputs are unknowns of linear equations over the exponents of the SI base
units (a product adds exponents), solved exactly; an equation that contradicts the others is an error at its
expression. A parameter without unit is an unknown, too; a bare number is a pure number if its places leave it
open, and fits any unit if they ask for several. A number written beside a parameter with a unit is pure; as a
gain, a pole or a time it may have a unit:

    m*s^2*x + 2*c*x = F         refused: an s is missing, with the 2 as without it
    F + 2*x                     refused: N and m
    (s + 2)*x, F - 0.1*s*x      read as they stand: 2 is in 1/s, 0.1 in N*s/m
    u = 100*x - 3*motor.i       read as it stands: every term has a gain
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from symflex.algebra import FUNCTIONS, LAPLACE
from symflex.errors import Diagnostic, Span
from symflex.expressions import (
    Attribute,
    Call,
    Derivative,
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
    is_number,
    measured,
    names,
    names_among,
    nodes,
    substitute,
)
from symflex.library.elements import LUMPED, Variable
from symflex.model.linearity import integer_exponent
from symflex.model.reading import QuantityLiteral
from symflex.model.scope import ModelScope
from symflex.quantities import DIMENSIONLESS, Dimension, Quantity, unit_of, unit_slip

Solution = tuple[tuple[tuple[Variable, Fraction], ...], Dimension]

PER_SECOND = unit_of("1/s").dimension
SECOND = unit_of("s").dimension
EXTREME_EXPONENT = 10**6  # largest exponent of a unit; twenty definitions that square each other pass it

TIMED = PARAMETER = 2  # what :class:`Measure` calls a pole or a time, and a parameter with a unit

LONGEST_TERM = 32  # characters up to which a message repeats a term of a sum


@dataclass(frozen=True, slots=True)
class Measure:
    """The dimension of an expression, as far as it is known."""

    dimension: Dimension = DIMENSIONLESS  # known part
    unknowns: tuple[tuple[Variable, Fraction], ...] = ()  # variables of yet unknown dimension, with exponents
    open: bool = False  # true when something takes part that fits any unit: nothing can be checked
    written: int = 0  # 1 when a written number takes part, TIMED when it must be a pole or a time
    weight: int = 0  # 1 when names take part, PARAMETER when one of them is a parameter with a unit
    laplace: Fraction = Fraction(0)  # exponent of a written s

    def times(self, other: Measure) -> Measure:
        """Return the measure of a product."""
        merged = dict(self.unknowns)
        for variable, exponent in other.unknowns:
            merged[variable] = merged.get(variable, Fraction(0)) + exponent
        return Measure(
            self.dimension * other.dimension,
            tuple((v, e) for v, e in merged.items() if e),
            self.open or other.open,
            max(self.written, other.written),
            max(self.weight, other.weight),
            self.laplace + other.laplace,
        )

    @property
    def is_gain(self) -> bool:
        """Whether a written number may have a unit: beside no parameter that has one, or as a pole."""
        return self.written > (self.weight == PARAMETER)

    @property
    def bare(self) -> frozenset[tuple[Variable, Fraction]]:
        """Parameters without unit, with their exponents."""
        return frozenset(u for u in self.unknowns if u[0].kind == "parameter")

    @property
    def core(self) -> tuple[Dimension, frozenset[tuple[Variable, Fraction]]]:
        """What remains without s and bare parameters: ``m*s^2*x`` and ``alpha*m*s*x`` share it."""
        return self.dimension * SECOND**self.laplace, frozenset(self.unknowns) - self.bare

    @property
    def is_time(self) -> bool:
        """Whether the known part is a power of a time."""
        return self.dimension != DIMENSIONLESS and self.dimension == SECOND**self.dimension.s

    @property
    def is_extreme(self) -> bool:
        """Tell whether an exponent is larger than any meant in earnest."""
        exponents = (*self.dimension.exponents, *(e for _, e in self.unknowns))
        return any(max(abs(e.numerator), e.denominator) > EXTREME_EXPONENT for e in exponents)

    def power(self, exponent: Fraction | int) -> Measure:
        """Return the measure of a power."""
        e = Fraction(exponent)
        return replace(
            self,
            dimension=self.dimension**e,
            unknowns=tuple((v, x * e) for v, x in self.unknowns),
            laplace=self.laplace * e,
        )


@dataclass(frozen=True, slots=True)
class Pair:
    """Two terms of a sum in which numbers take part, compared when all others have been."""

    whole: Expression
    first: tuple[Expression, Measure]
    second: tuple[Expression, Measure]
    is_free: bool = True  # whether its numbers fit any unit
    may_lack: bool = False  # whether a bare number must not stand for an s that is missing

    @property
    def ratio(self) -> Measure:
        """What should be a pure number."""
        return self.second[1].times(self.first[1].power(-1))


class DimensionSystem:
    """Collects dimension equations of one model and solves them."""

    def __init__(
        self,
        scope: ModelScope,
        quantities: Mapping[str, Quantity | None],  # what was declared; ``None`` when without unit
        definitions: Mapping[str, Expression],
        known: Mapping[Variable, Dimension],  # variables whose dimension their domain fixes
        blocks: Mapping[str, Measure | Expression],  # how blocks are measured, or what is measured alike
        laplace: Dimension = PER_SECOND,
        *,
        infers: bool = False,  # whether parameters without unit are unknowns; if not, they fit any
    ) -> None:
        self._scope = scope
        self._quantities = quantities
        self._definitions = definitions
        self._known = dict(known)
        self._blocks = dict(blocks)
        self._laplace = laplace
        self._solved: dict[Variable, Solution] = {}
        self._defined: dict[str, Measure] = {}
        # The measure of x, by what varies along it.
        self._axes = dict.fromkeys(scope.along, Measure(unit_of("m").dimension))
        self._coordinate: Measure | None = None
        self._infers = infers
        self._pairs: list[Pair] = []
        self.lacks_an_s = False
        self._sound_points: set[tuple[str, Expression, tuple[Dimension, ...]]] = set()
        self.problems: list[Diagnostic] = []

    def _note(self, code: str, message: str, span: Span | None, hint: str | None = None) -> None:
        self.problems.append(Diagnostic(code, message, span, hint))

    def require(
        self, expression: Expression, unit: str, what: str, a_what: str, *, varies: bool = False
    ) -> None:
        """Demand that a port's value is measured in the port's SI unit; an empty one accepts anything."""
        # In the message it is called ``what``, "m of mass 'tip'", and ``a_what``, "a mass". If it ``varies``
        # along x, that is a length.
        self._coordinate = Measure(unit_of("m").dimension) if varies else None
        measure = self.measure(expression)
        self._coordinate = None
        if not unit or measure.open or _is_constant(expression):
            return
        wanted = unit_of(unit)
        reduced = self._reduce(measure.times(Measure(wanted.dimension).power(-1)))
        if not self._learn(reduced) and not (reduced.written == TIMED and reduced.is_time):
            given = self._reduce(measure).dimension
            message = f"{what} is in '{given}'; {a_what} is in '{unit}'"
            hint = self._declaration(expression, given, wanted.dimension)
            self._note("SF203", message, expression.span, hint)

    def equate(self, variable: Variable, expression: Expression) -> None:
        """Demand that a signal is measured as its expression is."""
        measure = self.measure(expression)
        if measure.open or _is_constant(expression):
            return
        known = self.variable(variable)
        if measure.is_gain:
            self._pairs.append(Pair(expression, (expression, measure), (expression, known)))
        elif not self._learn(self._reduce(measure.times(known.power(-1)))):
            given, wanted = self._reduce(measure).dimension, self._reduce(known).dimension
            message = f"'{variable}' is used in '{wanted}' but its expression is in '{given}'"
            hint = _gain_hint(expression, given, wanted) or f"a gain in '{wanted / given}' makes it fit"
            self._note("SF203", message, expression.span, hint)

    def place_field(self, unknowns: Sequence[str], ends: Sequence[Expression]) -> None:
        """Take x of a field to be measured as its ends are; a bare number may stand for any unit."""
        measured = [e for e in ends if not _is_constant(e) or isinstance(e, QuantityLiteral)]
        axis = Measure(open=True)
        if measured:
            before = len(self.problems)
            axis = self.measure(measured[0] if len(measured) == 1 else Sum(tuple(measured)))
            axis = Measure(axis.dimension, axis.unknowns, axis.open)
            if len(self.problems) > before:
                axis = Measure(open=True)
        self._axes.update(dict.fromkeys(unknowns, axis))

    def balance(self, equation: Equation, unknowns: Sequence[str] = ()) -> None:
        """Demand that all terms of an equation are measured alike; bare ``unknowns`` are those of a field."""
        opened = substitute(equation, {name: Derivative(name, 0) for name in unknowns})
        terms = [t for side in opened.children for t in (side.terms if isinstance(side, Sum) else (side,))]
        self._coordinate = self._axes[unknowns[0]] if unknowns else None
        before = len(self.problems)
        self._sum(Sum(tuple(terms), span=equation.span), tuple(terms), is_equation=True)
        self._coordinate = None
        if any(d.code == "SF203" for d in self.problems[before:]):
            # What stands beside a function of a wrong argument disagrees for that reason alone.
            self.problems[before:] = [d for d in self.problems[before:] if d.code != "SF205"]

    def dimension(self, measure: Measure) -> Dimension | None:
        """Return the dimension when it is known by now."""
        reduced = self._reduce(measure)
        return None if reduced.unknowns or reduced.open else reduced.dimension

    def settle(self, numbers: Iterable[str]) -> None:
        """Compare terms with numbers; if nothing speaks against it, the bare ``numbers`` are pure ones."""
        guesses: list[Measure] = []
        for pair in sorted(self._pairs, key=lambda p: p.may_lack):
            ratio = self._reduce(pair.ratio)
            lacks = pair.may_lack and ratio.is_time and len(ratio.unknowns) == len(ratio.bare) <= 1
            is_gain = pair.first[1].is_gain or pair.second[1].is_gain
            is_guess = is_gain or pair.is_free or bool(ratio.written and ratio.bare)
            guesses += [pair.ratio] * is_guess
            is_open = is_guess and (ratio.unknowns or pair.is_free or (is_gain and ratio.is_time))
            if lacks or not (is_open or self._learn(ratio)):
                self.lacks_an_s |= lacks
                self._disagree(pair)
        before = dict(self._solved)
        guesses = [m for m in map(_bare, numbers) if self._reduce(m).unknowns] + guesses
        for some in (guesses, [g for g in guesses if g.bare]):
            if all(self._learn(self._reduce(guess)) for guess in some):
                break
            self._solved = dict(before)

    def _disagree(self, pair: Pair) -> None:
        (one, first), (term, second) = pair.first, pair.second
        here, there = self._reduce(second).dimension, self._reduce(first).dimension
        message = f"terms of a sum disagree: {_said(one)}'{there}' and {_said(term)}'{here}'"
        hint = _gain_hint(pair.whole, here, there)
        if pair in self._pairs:
            hint = "numbers here are pure; declare one that has a unit as a parameter with that unit"
            hint = f"an 's' may be missing; {hint}" if pair.may_lack else hint
        self._note("SF205", message, term.span or pair.whole.span, hint)

    def measure(self, expression: Expression) -> Measure:
        """Return what an expression is measured in; disagreeing sums become problems."""
        match expression:
            case Measured(quantity=quantity):
                return Measure(quantity.dimension)
            case Number():
                return Measure(written=1)
            case QuantityLiteral(quantity):
                return Measure(quantity.dimension)
            case Name() | Attribute():
                return self._name(expression)
            case Negative(operand):
                return self.measure(operand)
            case Product(factors):
                result = Measure()
                for factor in factors:
                    result = result.times(self.measure(factor))
                return result
            case Quotient(numerator, denominator):
                return self.measure(numerator).times(self.measure(denominator).power(-1))
            case Power(base, exponent) if (value := integer_exponent(exponent)) is not None:
                return self.measure(base).power(value)
            case Sum(terms):
                return self._sum(expression, terms)
            case Call(name, argument, order) if name in self._axes:
                self._at_point(name, argument)
                return self._field(name, order)
            case Derivative(name, order) if name in self._axes:
                return self._field(name, order)
            case Call(name, argument):
                return self._call(name, argument)
            case _:
                return Measure(open=True)

    def _field(self, name: str, order: int) -> Measure:
        """Return what a field's unknown, differentiated along x, is measured in."""
        unknown = self.variable(Variable("field", name))
        return unknown.times(self._axes[name].power(-order)) if order else unknown

    def _at_point(self, name: str, position: Expression) -> None:
        """Note a point that is not measured as x is."""
        # Numbers that are equal in SI units are equal, whatever they measure.
        point = (name, position, tuple(n.quantity.dimension for n in measured(position)))
        if point in self._sound_points:
            return
        measure = self.measure(position)
        axis, written = self._axes[name], names(position)
        if measure.open or axis.open or any(self._varies(n) for n in written):
            return
        if _is_constant(position) and not measured(position):
            return
        if any(isinstance(n, Name) and n.name == LAPLACE for n in written):
            return  # a point that depends on s is refused for that
        if not self._learn(self._reduce(measure.times(axis.power(-1)))):
            given, wanted = self._reduce(measure).dimension, self._reduce(axis).dimension
            message = f"the point is in '{given}'; the domain of '{name}' is in '{wanted}'"
            if name in self._scope.along:
                message = f"the point is in '{given}'; x along {self._scope.along[name]} is in '{wanted}'"
            self._note("SF203", message, position.span)
            return
        self._sound_points.add(point)

    def _name(self, expression: Name | Attribute) -> Measure:
        if self._coordinate is not None and isinstance(expression, Name):
            if self._scope.is_coordinate(expression.name):
                return self._coordinate
        meaning = self._scope.find(expression)
        if meaning is None:
            return Measure(open=True)
        if meaning.kind == "laplace":
            return Measure(self._laplace, laplace=Fraction(1))
        if meaning.kind == "pi":
            return Measure()
        if meaning.kind == "parameter":
            return self._parameter(meaning.name)
        if meaning.kind == "definition":
            return self.definition(meaning.name)
        if meaning.kind == "block":
            return self._block(meaning.name)
        return self.variable(meaning.variable) if meaning.variable else Measure(open=True)

    def _varies(self, expression: Expression) -> bool:
        """Tell whether a name is a node, signal or input: a function of it is refused as not linear."""
        if not isinstance(expression, Name | Attribute):
            return False
        meaning = self._scope.find(expression)
        return meaning is not None and meaning.variable is not None

    def _parameter(self, name: str) -> Measure:
        quantity = self._quantities.get(name)
        if quantity is None:
            return _bare(name) if self._infers else Measure(open=True)
        return Measure(quantity.dimension, weight=1 if quantity.dimension == DIMENSIONLESS else PARAMETER)

    def definition(self, name: str) -> Measure:
        """Return what a definition is measured in; a bare number is one as among the parameters."""
        if name not in self._defined:
            self._defined[name] = Measure(open=True)
            expression = self._definitions[name]
            measure = self.measure(expression)
            has_unit = not _is_constant(expression) or isinstance(expression, QuantityLiteral)
            if not has_unit and self._infers:
                self._defined[name] = _bare(name)
            elif has_unit and not measure.is_extreme:
                self._defined[name] = measure
        return self._defined[name]

    def _block(self, name: str) -> Measure:
        """Return what a block is measured in; a gain that is a bare number fits any unit."""
        gain = self._blocks.get(name, Measure(open=True))
        if not isinstance(gain, Measure):
            measure = self._reduce(self.measure(gain))
            is_open = measure.open or measure.written > measure.weight
            gain = Measure(measure.dimension, measure.unknowns, is_open, weight=measure.weight)
            self._blocks[name] = gain
        return gain

    def variable(self, variable: Variable) -> Measure:
        """Return what a variable is measured in."""
        dimension = self._known.get(variable)
        return Measure(dimension or DIMENSIONLESS, () if dimension else ((variable, Fraction(1)),), weight=1)

    def _call(self, name: str, argument: Expression) -> Measure:
        inner = self.measure(argument)
        if name not in FUNCTIONS or any(self._varies(n) for n in names(argument)):
            return Measure(open=True)
        if name == "sqrt":
            return inner.power(Fraction(1, 2))
        reduced = self._reduce(inner)
        is_free = reduced.open or reduced.unknowns or (reduced.written and reduced.is_time)
        if not is_free and reduced.dimension != DIMENSIONLESS:
            message = f"the argument of {name} is in '{reduced.dimension}'; it must be a pure number"
            self._note("SF203", message, argument.span, f"divide it by a value in '{reduced.dimension}'")
        return Measure(open=reduced.open and not self._infers)

    def _sum(
        self, expression: Expression, terms: tuple[Expression, ...], *, is_equation: bool = False
    ) -> Measure:
        measures = [(t, self.measure(t)) for t in terms if not is_number(t, 0)]
        if not measures:
            return Measure(open=True)
        closed = [(t, self._reduce(m)) for t, m in measures if not m.open]
        if all(_is_constant(t) for t, _ in closed) and len(closed) < len(measures):
            closed = []  # beside what fits any unit, so does a number
        if not closed:
            return next(m for _, m in measures if m.open)
        # What is known first: beside it, an unknown of yet unknown unit is not what disagrees.
        first_term, first = min(closed, key=lambda m: (m[1].is_gain, bool(m[1].unknowns), m[1].written))
        others = [m for _, m in closed]
        # Without units, numbers of an equation are coefficients, and those in all terms of a sum are gains.
        is_free = all(m.weight < PARAMETER and (is_equation or m.written) for m in others)
        cores, written = [m.core for m in others], first.written
        for term, measure in closed:
            is_alike = (measure.dimension, measure.unknowns) == (first.dimension, first.unknowns)
            if term is first_term or is_alike:
                continue
            both = (first, measure)
            is_alone = any(m.written and not m.weight for m in both)
            fits = is_free or is_alone or any(m.is_gain and m.laplace for m in both)
            with_bare = [m for m in both if m.weight == PARAMETER and m.bare]
            may_lack = [cores.count(m.core) for m in with_bare] == [1]
            pair = Pair(expression, (first_term, first), (term, measure), fits, may_lack)
            ratio = self._reduce(pair.ratio)
            if is_alone and ratio.is_time and not ratio.unknowns:
                written = TIMED
            if is_alone and 0 < len(ratio.unknowns) == len(ratio.bare):
                self._learn(ratio)  # the T of 1 + T*s is a time
            elif ratio.written or with_bare:
                self._pairs.append(pair)
            elif not self._learn(ratio):
                self._disagree(pair)
        return replace(self._reduce(first), written=written)

    def _reduce(self, measure: Measure) -> Measure:
        """Replace solved variables by what they were solved for."""
        dimension, unknowns = measure.dimension, dict(measure.unknowns)
        for variable in list(unknowns):
            if variable in self._solved:
                exponent = unknowns.pop(variable)
                others, known = self._solution(variable)
                dimension = dimension * known**exponent
                for other, weight in others:
                    unknowns[other] = unknowns.get(other, Fraction(0)) + weight * exponent
        return replace(measure, dimension=dimension, unknowns=tuple((v, e) for v, e in unknowns.items() if e))

    def _learn(self, measure: Measure) -> bool:
        """Take ``measure = dimensionless`` as an equation; False when it contradicts what is known."""
        if not measure.unknowns:
            return measure.dimension == DIMENSIONLESS
        if measure.is_extreme:
            return True
        (variable, exponent), *remaining = measure.unknowns
        others = tuple((v, -e / exponent) for v, e in remaining)
        dimension = measure.dimension ** (-1 / exponent)
        self._solved[variable] = (others, dimension)
        return True

    def _solution(self, variable: Variable) -> Solution:
        """Return a solved variable in unsolved ones; what is found on the way is kept for chains."""
        waiting = [variable]
        while waiting:
            terms, dimension = self._solved[waiting[-1]]
            solved = [v for v, _ in terms if v in self._solved]
            stale = [v for v in solved if any(u in self._solved for u, _ in self._solved[v][0])]
            if stale:
                waiting += stale
                continue
            merged: dict[Variable, Fraction] = {}
            for v, weight in terms:
                others, known = self._solved.get(v, (((v, Fraction(1)),), DIMENSIONLESS))
                dimension = dimension * known**weight
                for other, e in others:
                    merged[other] = merged.get(other, Fraction(0)) + e * weight
            self._solved[waiting.pop()] = (tuple((v, e) for v, e in merged.items() if e), dimension)
        return self._solved[variable]

    def _declaration(self, expression: Expression, given: Dimension, wanted: Dimension) -> str | None:
        # A frequency that stands alone has a 2 pi beside it by now.
        name = expression.span.text if expression.span else ""
        quantity = self._quantities.get(name)
        if quantity is None:
            return None
        slip = misplaced(quantity.unit, given, wanted)
        unit = f"in '{quantity.unit}'" if quantity.unit else "as a number"
        return f"'{name}' is declared {unit}" + (f"; {slip}" if slip else "")


def misplaced(unit: str, given: Dimension, wanted: Dimension) -> str | None:
    """Return how a unit at the wrong place is meant, or which element it fits: torsion_spring for N*m/rad."""
    kinds = {unit_of(each).dimension: name for each, name in LUMPED.items()}
    fitting = f'type = "{kinds[given]}" takes it' if {given, wanted} <= kinds.keys() else None
    return unit_slip(unit, given, wanted) or fitting


def _bare(name: str) -> Measure:
    """Return the measure of a parameter without unit."""
    return Measure(unknowns=((Variable("parameter", name), Fraction(1)),), weight=1)


def _is_constant(expression: Expression) -> bool:
    """Tell whether an expression is a number, as ``2*pi*50`` and ``sqrt(2)`` are: it fits any port."""
    written = names(expression)
    return all(n.name in FUNCTIONS if isinstance(n, Call) else n == Name("pi") for n in written)


def _said(term: Expression) -> str:
    """Return ``b*s in `` for a message, nothing where the term is long or has a quantity in it."""
    text = "" if any(isinstance(n, QuantityLiteral) for n in nodes(term)) else format_expression(term)
    for n in nodes(term):
        if isinstance(n, Name) and n.span and n.name not in n.span.text:  # a delay that was written as exp
            text = text.replace(n.name, n.span.text)
    return f"{text} in " if 0 < len(text) <= LONGEST_TERM else ""


def _gain_hint(expression: Expression, given: Dimension, wanted: Dimension) -> str | None:
    """Say that an integral or a derivative has another unit; a gain makes it fit, also a plain number."""
    has_s = names_among(expression, (LAPLACE,))
    if has_s and any(given == wanted * SECOND**power for power in (-2, -1, 1, 2)):
        return "'s' and '1/s' have units: multiply by a gain; a plain number, as in '1*(u/s)', fits any unit"
    return None

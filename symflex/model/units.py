"""Checking units: what is demanded of expressions, and what follows for parameters, inputs and outputs."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE
from symflex.errors import Span
from symflex.expressions import Equation, Expression, Name, Sum, names, number, power, product_of
from symflex.library.elements import ACROSS_UNIT, COMPONENT_DOMAIN, THROUGH_UNIT, LineElement, Variable
from symflex.model.declarations import DeclaredParameter
from symflex.model.dimensions import PER_SECOND, SECOND, DimensionSystem, Measure, misplaced
from symflex.model.model import (
    IMAGINARY,
    INPUT_KINDS,
    Definition,
    ExactValue,
    Input,
    ModelParameter,
    PlacedBlock,
    PlacedElement,
)
from symflex.model.reading import QuantityLiteral, Reader, signed_number
from symflex.model.scope import ModelScope, build_scope
from symflex.quantities import DIMENSIONLESS, Dimension, Quantity, unit_of

if TYPE_CHECKING:
    from symflex.model.network import Draft


def counts_cycles(quantity: Quantity) -> bool:
    """Tell whether a quantity may become radians: ``5 ms/rev`` is a period."""
    is_period = quantity.cycles < 0 and quantity.dimension == SECOND**-quantity.cycles
    return bool(quantity.cycles) and not is_period


def check_units(
    reader: Reader,
    draft: Draft,
    placed: Sequence[PlacedElement],
    scope: ModelScope,
    unsound: Collection[Span | None],
    fields_placed: Collection[str],
    laplace: Dimension = PER_SECOND,
    *,
    infers: bool = True,
) -> DimensionSystem:
    """Measure every expression; of one that is unsound, only what disagrees within it is noted."""
    quantities = declared_quantities(draft.declared, draft.inherited)
    dimensions = _known_dimensions(draft, placed)
    blocks = {b.name: _block_gain(b) for b in draft.blocks}
    definitions = {d.name: d.expression for d in draft.definitions}
    system = DimensionSystem(scope, quantities, definitions, dimensions, blocks, laplace, infers=infers)
    _compare(reader, draft, placed, system, unsound)
    _check_fields(draft, system, unsound, fields_placed)
    _measure_signals(draft, system, unsound)
    # Angles and shares are numbers.
    measured = (q for q in quantities.values() if q is not None and q.dimension != DIMENSIONLESS)
    has_units = any((placed, dimensions, *measured))
    system.settle([p.name for p in draft.declared if p.quantity] + [*definitions] if has_units else ())
    if system.problems and infers and not system.lacks_an_s:
        # What has no unit may have been meant to have several.
        return check_units(reader, draft, placed, scope, unsound, fields_placed, laplace, infers=False)
    disagrees = any(d.code in ("SF203", "SF205") for d in system.problems)
    if disagrees and not (has_units or draft.fields) and laplace != DIMENSIONLESS:
        # A model of numbers alone, as forums have them: there s is a number, too.
        plain = check_units(reader, draft, placed, scope, unsound, fields_placed, DIMENSIONLESS, infers=False)
        return system if plain.problems else plain
    return system


def _compare(
    reader: Reader,
    draft: Draft,
    placed: Sequence[PlacedElement],
    system: DimensionSystem,
    unsound: Collection[Span | None],
) -> None:
    """Compare what parameters of elements and blocks are measured in with what these demand."""

    def require(expression: Expression, unit: str, what: str, doc: str, *, varies: bool = False) -> None:
        if expression.span in unsound:
            system.measure(expression)
        elif not isinstance(expression, QuantityLiteral):
            system.require(expression, unit, what, doc, varies=varies)
        elif unit and expression.quantity.dimension != unit_of(unit).dimension:
            given = expression.quantity
            message = f"{what} is in '{given.unit}'; {doc} is in '{unit}'"
            hint = misplaced(given.unit, given.dimension, unit_of(unit).dimension)
            reader.note("SF203", message, expression.span, hint)

    for definition in draft.definitions:
        # In this order each one finds those it uses already measured, however long the chain.
        system.definition(definition.name)
    for use in placed:
        for name, expression in use.values:
            where = f"{name} of {use.element.type_name} '{use.name}'"
            port = next(p for p in use.element.parameters if p.name == name)
            require(expression, port_unit(use, name), where, port.doc, varies=port.varies)
    for block in draft.blocks:
        for name, expression in block.values:
            ports = block.block.parameters if block.block else ()
            doc = next((p.doc for p in ports if p.name == name), "")
            require(expression, block_unit(block, name), f"{name} of block '{block.name}'", doc)
    if draft.sampled is not None:
        require(draft.sampled.period, "s", "period of [sampled]", "time from sample to sample")
        require(draft.sampled.delay, "s", "delay of [sampled]", "time from a sample to its output")


def _measure_signals(draft: Draft, system: DimensionSystem, unsound: Collection[Span | None]) -> None:
    """Compare the terms of every signal and equation, and measure outputs."""
    for signal in draft.signals:
        if isinstance(signal.expression, Equation):
            if signal.expression.span not in unsound:
                system.balance(signal.expression)
        elif signal.expression.span in unsound:
            system.measure(signal.expression)
        else:
            system.equate(Variable("signal", signal.name), signal.expression)
    for output in draft.outputs:
        system.measure(output.expression)


def _check_fields(
    draft: Draft, system: DimensionSystem, unsound: Collection[Span | None], placed: Collection[str]
) -> None:
    """Compare the terms of every equation and condition of a field."""
    for field in draft.fields:
        ends = (field.start, field.end) if field.name in placed else ()
        system.place_field(field.unknowns, ends)
    for field in draft.fields:
        for equation in field.equations:
            if equation.span not in unsound:
                system.balance(equation, field.unknowns)
        for condition in field.conditions:
            if condition.span not in unsound:
                system.balance(condition)


def declared_quantities(
    declared: Sequence[DeclaredParameter], inherited: Sequence[ModelParameter]
) -> dict[str, Quantity | None]:
    """Return what every parameter is measured in, ``None`` if no unit was written."""
    quantities = {p.name: p.measured for p in declared}
    return quantities | {p.name: _in_si(p) for p in inherited}


def constant_measure(
    declared: Sequence[DeclaredParameter],
    inherited: Sequence[ModelParameter],
    definitions: Sequence[Definition],
    bare: Quantity | None = None,
) -> Callable[[Expression], Dimension | None]:
    """Return a function that tells the dimension of an expression of parameters, ``None`` when it is open."""
    # A parameter without unit is taken for a number, as the ``n`` of a ratio ``n*r`` mostly is.
    plain = bare or Quantity(Fraction(1), 0, 0, DIMENSIONLESS, 0, "")
    quantities = {name: given or plain for name, given in declared_quantities(declared, inherited).items()}
    scope = build_scope([*quantities], definitions, (), (), (), (), ())
    system = DimensionSystem(scope, quantities, {d.name: d.expression for d in definitions}, {}, {})

    def measure(expression: Expression) -> Dimension | None:
        if isinstance(expression, QuantityLiteral):
            return expression.quantity.dimension
        return system.dimension(system.measure(expression)) if names(expression) else None

    return measure


def _in_si(parameter: ModelParameter) -> Quantity | None:
    """Return a quantity of a resolved parameter's unit, ``None`` when it has none."""
    if not parameter.unit:
        return None
    unit = unit_of(parameter.unit)
    return Quantity(Fraction(1), 0, parameter.cycles, unit.dimension, unit.radians, parameter.unit)


def _known_dimensions(draft: Draft, placed: Sequence[PlacedElement]) -> dict[Variable, Dimension]:
    dimensions: dict[Variable, Dimension] = {}
    for node in draft.nodes:
        for component in node.components:
            domain = COMPONENT_DOMAIN.get(component, node.domain)
            dimensions[Variable("node", node.name, component)] = unit_of(ACROSS_UNIT[domain]).dimension
    for use in placed:
        domains = dict(use.domains)
        for quantity in use.element.quantities(domains):
            unit = use.element.unit_of(quantity, domains)
            dimensions[Variable("through", use.name, quantity)] = unit_of(unit).dimension
        if isinstance(use.element, LineElement):
            units = {"u": "m", "v": "m", "x": "m", "y": "m", "theta": "rad"}
            for name in (name for quantity in use.element.along for name in quantity):
                unit = units.get(name) or use.element.unit_of(name, domains)
                dimensions[Variable("field", f"{use.name}.{name}")] = unit_of(unit).dimension
    for source in draft.inputs:
        unit = source.input.unit or source.unit_text
        if unit:
            dimensions[Variable("input", source.input.name)] = unit_of(unit).dimension
        kind = INPUT_KINDS.get(source.input.kind)
        if kind is not None and kind.is_imposed:
            dimensions[kind.delivered(source.input.name)] = unit_of(THROUGH_UNIT[kind.domain]).dimension
    return dimensions


def _block_gain(block: PlacedBlock) -> Measure | Expression:
    """Return what a block is measured in, or an expression that is measured alike."""
    if block.submodel is not None and block.tf is not None:
        output = next(o for o in block.submodel.outputs if o.name == block.tf[0])
        source = next(i for i in block.submodel.inputs if i.name == block.tf[1])
        if output.dimension is None or source.dimension is None:
            return Measure(open=True)
        return Measure(output.dimension / source.dimension)
    gains = block.block.gains if block.block else None
    if gains is None:
        return Measure(open=True)
    values = dict(block.values)
    # What was not written has no span; a default of 1 in an integral fits any unit, as a number in its place.
    terms = [
        replace(product_of([values[name], power(Name(LAPLACE), number(e))]), span=values[name].span)
        for name, e in gains
        if values[name].span is not None
    ]
    return Sum(tuple(terms)) if terms else Measure(open=any(e for _, e in gains))


def measured_variables(draft: Draft) -> list[Variable]:
    """Return the signals, inputs and unknowns of fields, whose dimensions are found by solving."""
    return [
        *(Variable("field", name) for f in draft.fields for name in f.unknowns),
        *(Variable("signal", x.name) for x in draft.signals),
        *(Variable("input", d.input.name) for d in draft.inputs),
    ]


def measured_input(source: Input, system: DimensionSystem) -> Input:
    """Return the input with the dimension and unit found for it."""
    dimension = system.dimension(system.variable(Variable("input", source.name)))
    unit = source.unit or ("" if dimension is None else str(dimension))
    return replace(source, dimension=dimension, unit=unit)


def quotients(draft: Draft, system: DimensionSystem) -> Iterator[tuple[tuple[str, str], Dimension]]:
    """Yield every output over input whose dimension is known."""
    for output in draft.outputs:
        above = system.measure(output.expression)
        for source in draft.inputs:
            below = system.variable(Variable("input", source.input.name))
            dimension = system.dimension(above.times(below.power(-1)))
            if dimension is not None:
                yield (output.name, source.input.name), dimension


def implied_units(placed: Sequence[PlacedElement], blocks: Sequence[PlacedBlock]) -> dict[str, str]:
    """Return the units that ports give to parameters standing there alone."""
    given = [(e, port_unit(use, name)) for use in placed for name, e in use.values]
    given = [(e, "1" if unit.startswith("(") else unit) for e, unit in given]
    given += [(e, block_unit(block, name)) for block in blocks for name, e in block.values]
    implied: dict[str, str] = {}
    for expression, unit in given:
        if isinstance(expression, Name) and unit:
            implied.setdefault(expression.name, unit)
    return implied


def port_unit(use: PlacedElement, name: str) -> str:
    """Return the SI unit of an element's parameter where it is placed."""
    return use.element.unit_of(name, dict(use.domains))


def block_unit(block: PlacedBlock, name: str) -> str:
    """Return the SI unit of a block's parameter, empty when any fits."""
    return next((p.unit for p in block.block.parameters if p.name == name), "") if block.block else ""


def lower(expression: Expression, unit: str = "") -> Expression:
    """Replace a quantity by the number it is in SI units, which remembers where it was written."""
    if not isinstance(expression, QuantityLiteral):
        return expression
    angular = not unit or bool(unit_of(unit).radians) or expression.quantity.cycles > 0
    value = ExactValue(*(expression.quantity.angular() if angular else expression.quantity.cyclic()))
    return replace(exact_expression(value), span=expression.span)


def exact_expression(value: ExactValue) -> Expression:
    """Return ``rational * pi**n`` as an expression; of the imaginary unit, its name."""
    if value.is_imaginary:
        return Name(IMAGINARY)
    number = signed_number(value.rational)
    if not value.pi_power:
        return number
    return product_of([number, power(Name("pi"), signed_number(Fraction(value.pi_power)))])

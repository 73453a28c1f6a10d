"""From a specification to a model.

Input: a parsed :class:`symflex.spec.Spec`.
Output: a :class:`Model`, or one :class:`SpecError` with every problem of the text.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

from symflex.elements import ACROSS_UNIT, Placing, Variable
from symflex.errors import Diagnostic, Span, SpecError
from symflex.expressions import Expression, Name, names, power, product_of
from symflex.model.analysis import read_analysis, read_figures, read_published
from symflex.model.blocks import Loads, Origin, read_blocks
from symflex.model.declarations import (
    DeclaredParameter,
    one_of,
    read_definitions,
    read_label,
    read_parameters,
)
from symflex.model.dimensions import DimensionSystem, Measure
from symflex.model.linearity import check_expression, without_signal
from symflex.model.model import (
    Definition,
    ExactValue,
    Input,
    Model,
    Node,
    Output,
    Parameter,
    PlacedBlock,
    PlacedElement,
    Signal,
)
from symflex.model.network import DraftElement, DraftInput, NetworkReader
from symflex.model.nodes import domain_of, infer_nodes
from symflex.model.reading import QuantityLiteral, Reader, describe, signed_number
from symflex.model.scope import RESERVED, Scope, build_scope
from symflex.quantities import DIMENSIONLESS, Dimension, Quantity, unit_of
from symflex.spec import ArrayValue, StringValue, TableValue, parse_with_recovery

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator, Mapping, Sequence

    from symflex.errors import Source
    from symflex.spec import Entry, Spec

FORMAT_VERSION = 1
SECTIONS = (
    "parameters",
    "definitions",
    "elements",
    "inputs",
    "outputs",
    "signals",
    "blocks",
    "fields",
    "published",
    "analysis",
    "figures",
)
MAX_PAIRS = 10_000
CONSEQUENCES = ("SF210", "SF218")
"""What is noted of a name that was lost with a mistake elsewhere."""
TOP_KEYS = ("symflex", "title", "source", "doc", *SECTIONS)


def load_model(source: Source, ancestors: tuple[Path, ...] = (), loads: Loads | None = None) -> Model:
    """Parse and resolve a text, reporting syntax and meaning errors together.

    Parameters
    ----------
    source : Source
        The text; ``model`` blocks are found relative to ``source.name``.
    ancestors : tuple of Path
        The files whose ``model`` blocks led here.
    loads : Loads, optional
        What was read for ``model`` blocks so far.

    Raises
    ------
    SpecError
        With every problem found, in the order of the text.
    """
    spec, syntax = parse_with_recovery(source)
    own = ancestors or (Path(source.name).resolve(),)
    try:
        model = resolve(spec, Origin(source, own, loads or Loads(), load_model))
    except SpecError as error:
        # A name lost with an unreadable line would be reported as unknown: that is not a second mistake.
        later = [d for d in error.diagnostics if not syntax or d.code not in (*CONSEQUENCES, "SF214")]
        raise SpecError(*_in_order([*syntax, *later], source)) from None
    if syntax:
        raise SpecError(*syntax)
    return model


def resolve(spec: Spec, origin: Origin) -> Model:
    """Give every name, node, unit and value of a specification its meaning.

    Raises
    ------
    SpecError
        SF2xx, with every problem found.
    """
    reader = Reader()
    _check_header(reader, spec)
    sections = {name: _section(reader, spec, name) for name in SECTIONS}
    declared = read_parameters(reader, sections["parameters"])
    definitions = read_definitions(reader, sections["definitions"])
    network = NetworkReader(reader)
    network.read_elements(sections["elements"])
    network.read_inputs(sections["inputs"])
    blocks = read_blocks(reader, sections["blocks"], origin)
    signals = _read_signals(reader, sections["signals"])
    outputs = _read_outputs(reader, sections["outputs"])
    _check_count(reader, spec, outputs, network.inputs)
    _refuse_fields(reader, sections["fields"])
    inherited = _inherited_parameters(reader, declared, blocks)
    twins = _refuse_twins(
        reader, [*(p.name for p in declared), *(p.name for p in inherited)], definitions, blocks
    )
    measure = _constant_measure(declared, inherited, definitions)
    attachments = [a for element in network.elements for a in element.attachments(measure)]
    attachments += [a for source in network.inputs for a in source.attachments()]
    nodes, contradictions = infer_nodes(attachments)
    reader.take(contradictions)
    draft = _Draft(
        declared,
        inherited,
        definitions,
        nodes,
        tuple(network.elements),
        tuple(network.inputs),
        blocks,
        signals,
        outputs,
    )
    model = _finish(reader, draft, _broken_names(sections, draft) | twins)
    later = Reader()
    model = replace(
        model,
        title=reader.plain(spec.root, "title", "the specification"),
        source=reader.plain(spec.root, "source", "the specification"),
        analysis=read_analysis(reader, sections["analysis"]),
        figures=read_figures(later, sections["figures"], model),
        published=read_published(later, sections["published"], model),
    )
    # A transfer function is missing where its output or input could not be read: no second mistake.
    whole = all(
        len(found) == len(section.entries)
        for found, section in ((outputs, sections["outputs"]), (network.inputs, sections["inputs"]))
        if section
    )
    reader.take([p for p in later.problems if whole or p.code != "SF218"])
    problems = reader.problems
    if _lost_sections(spec):
        problems = [p for p in problems if p.code not in CONSEQUENCES]
    else:
        problems += _empty_sections(spec)
    if problems:
        raise SpecError(*_in_order(problems, spec.source))
    return model


def _check_count(reader: Reader, spec: Spec, outputs: Sequence[Output], inputs: Sequence[DraftInput]) -> None:
    """Stop at a model with more transfer functions than can be listed."""
    entry = spec.root.get("outputs")
    if entry is not None and len(outputs) * len(inputs) > MAX_PAIRS:
        message = (
            f"{len(outputs)} outputs and {len(inputs)} inputs make {len(outputs) * len(inputs)} transfer "
            f"functions; at most {MAX_PAIRS} are allowed"
        )
        raise SpecError(*reader.problems, Diagnostic("SF103", message, entry.key_span))


def _lost_sections(spec: Spec) -> bool:
    """Tell whether a section is misspelt or no table, so that its names are not known."""
    return any(
        isinstance(e.value, TableValue) != (e.key in SECTIONS)
        for e in spec.root.entries
        if e.key in SECTIONS or e.key not in TOP_KEYS
    )


def _empty_sections(spec: Spec) -> list[Diagnostic]:
    found = []
    for name, example in (("inputs", 'F = { force = "x_act" }'), ("outputs", 'X = "x_tip"')):
        entry = spec.root.get(name)
        if entry is None or (isinstance(entry.value, TableValue) and not entry.value.entries):
            span = entry.key_span if entry else Span(spec.source, 0, 0)
            message = f"the specification has no [{name}]"
            found.append(Diagnostic("SF214", message, span, f"for instance: {example}"))
    return found


def _broken_names(sections: Mapping[str, TableValue | None], draft: _Draft) -> frozenset[str]:
    """Return the names in declarations that could not be read: their own and those of nodes listed there."""
    read = {
        "parameters": {p.name for p in draft.declared},
        "definitions": {d.name for d in draft.definitions},
        "elements": {e.name for e in draft.elements},
        "inputs": {d.input.name for d in draft.inputs},
        "signals": {x.name for x in draft.signals},
        "blocks": {b.name for b in draft.blocks},
        "fields": set[str](),
    }
    broken: set[str] = set()
    for section, names_read in read.items():
        table = sections[section]
        for entry in table.entries if table else ():
            if entry.key not in names_read:
                broken.add(entry.key)
                if section in ("elements", "inputs") and isinstance(entry.value, TableValue):
                    broken.update(_listed_names(entry.value))
    return frozenset(broken)


def _listed_names(table: TableValue) -> Iterator[str]:
    for entry in table.entries:
        items = entry.value.items if isinstance(entry.value, ArrayValue) else (entry.value,)
        yield from (i.text.value.partition(".")[0] for i in items if isinstance(i, StringValue))


@dataclass(frozen=True, slots=True)
class _Draft:
    """What was read, before names and units were checked."""

    declared: tuple[DeclaredParameter, ...]
    inherited: tuple[Parameter, ...]
    definitions: tuple[Definition, ...]
    nodes: tuple[Node, ...]
    elements: tuple[DraftElement, ...]
    inputs: tuple[DraftInput, ...]
    blocks: tuple[PlacedBlock, ...]
    signals: tuple[Signal, ...]
    outputs: tuple[Output, ...]


def _in_order(problems: Sequence[Diagnostic], source: Source) -> list[Diagnostic]:
    """Return the problems in the order of the text, each once; those of other files come last."""
    unique = list(dict.fromkeys(problems))

    def place(problem: Diagnostic) -> tuple[int, str, int]:
        span = problem.span
        if span is None:
            return (2, "", 0)
        return (int(span.source is not source), span.source.name, span.start)

    return sorted(unique, key=place)


def _check_header(reader: Reader, spec: Spec) -> None:
    reader.keys(spec.root, TOP_KEYS, "the specification")
    version = spec.root.get("symflex")
    if version is None:
        reader.note(
            "SF200",
            "the specification does not say its format version",
            Span(spec.source, 0, 0),
            "begin the file with: symflex = 1",
        )
        return
    literal = getattr(version.value, "value", None)
    if literal != FORMAT_VERSION or isinstance(literal, bool):
        message = f"the format version is {describe(version.value)}; this program reads version 1"
        reader.note("SF200", message, version.value.span, "write symflex = 1")


def _section(reader: Reader, spec: Spec, name: str) -> TableValue | None:
    entry = spec.root.get(name)
    if entry is None:
        return None
    many = isinstance(entry.value, ArrayValue)
    hint = f"write one [{name}] with a line 'name = ...' for each of them" if many else None
    return reader.table(entry, f"[{name}]", hint)


def _refuse_fields(reader: Reader, section: TableValue | None) -> None:
    for entry in section.entries if section else ():
        reader.note(
            "SF911",
            f"field '{entry.key[:64]}': boundary-value problems are not available yet",
            entry.key_span,
            "this version derives networks of lumped elements",
        )


def _read_signals(reader: Reader, section: TableValue | None) -> tuple[Signal, ...]:
    found: list[Signal] = []
    for entry in section.entries if section else ():
        if reader.name(entry, "a signal", RESERVED):
            expression = reader.expression(entry.value, f"signal '{entry.key}'", quantities=False)
            if expression is not None:
                found.append(Signal(entry.key, expression, entry.key_span))
    return tuple(found)


def _read_outputs(reader: Reader, section: TableValue | None) -> tuple[Output, ...]:
    found: list[Output] = []
    for entry in section.entries if section else ():
        if reader.name(entry, "an output"):
            output = _read_output(reader, entry)
            if output is not None:
                found.append(output)
    return tuple(found)


def _read_output(reader: Reader, entry: Entry) -> Output | None:
    what, value, label = f"output '{entry.key}'", entry.value, ""
    if isinstance(value, TableValue):
        reader.keys(value, ("expr", "latex", "doc"), what)
        label = read_label(reader, value, what)
        inner = value.get("expr")
        if inner is None:
            hint = 'for instance { expr = "x_tip" }'
            reader.note("SF214", f"{what} has no 'expr'", entry.key_span, hint)
            return None
        value = inner.value
    expression = reader.expression(value, what, quantities=False)
    return None if expression is None else Output(entry.key, expression, None, "", label, entry.key_span)


def _refuse_twins(
    reader: Reader,
    parameters: Sequence[str],
    definitions: Sequence[Definition],
    blocks: Sequence[PlacedBlock],
) -> frozenset[str]:
    """Note and return the names that two of parameters, definitions and blocks bear."""
    twins: set[str] = set()
    taken = dict.fromkeys(parameters, "a parameter")
    for what, group in (("a definition", definitions), ("a block", blocks)):
        for item in group:
            if item.name in taken:
                message = f"'{item.name}' is {what} and {taken[item.name]}"
                reader.note("SF211", message, item.span, "rename one of them")
                twins.add(item.name)
            taken.setdefault(item.name, what)
    return frozenset(twins)


def _inherited_parameters(
    reader: Reader, declared: Sequence[DeclaredParameter], blocks: Sequence[PlacedBlock]
) -> tuple[Parameter, ...]:
    """Return the parameters that ``model`` blocks bring along; an equal name must be equal in value."""
    own = {p.name: p.resolve(angular=True, implied_unit="") for p in declared}
    found: dict[str, Parameter] = {}
    for block in blocks:
        for parameter in block.submodel.parameters if block.submodel else ():
            known = own.get(parameter.name) or found.get(parameter.name)
            if known is None:
                found[parameter.name] = parameter
            elif known.value is not None and parameter.value is not None and known.value != parameter.value:
                reader.note(
                    "SF226",
                    f"parameter '{parameter.name}' has another value in block '{block.name}' "
                    f"({parameter.span})",
                    known.span if known.name in own else block.span,
                    "rename one of the two: parameters of a model block are shared by name",
                )
    return tuple(found.values())


def _finish(reader: Reader, draft: _Draft, broken: frozenset[str]) -> Model:
    """Check names, linearity and units, and turn the draft into a model."""
    nodes = {n.name: n for n in draft.nodes}
    placed = tuple(_place(d, nodes) for d in draft.elements)
    inputs = tuple(d.input for d in draft.inputs)
    names = [*(p.name for p in draft.declared), *(p.name for p in draft.inherited)]
    scope = build_scope(
        names, draft.definitions, draft.nodes, placed, draft.signals, draft.blocks, inputs, broken
    )
    unsound: set[Span | None] = set()
    for expression, constant in _all_expressions(draft):
        problems = _check(expression, scope, constant=constant)
        reader.take(problems)
        if problems:
            unsound.add(expression.span)
    system = _check_units(reader, draft, placed, scope, unsound)
    readings = system.finish()
    reader.take(system.problems)
    implied = _implied_units(placed, draft.blocks)
    parameters = [
        p.resolve(angular=readings.get(p.name, True), implied_unit=implied.get(p.name, ""))
        for p in draft.declared
    ]
    units = {v: d for v in _variables(draft) if (d := system.dimension(system.variable(v)))}
    return Model(
        parameters=(*parameters, *draft.inherited),
        definitions=tuple(replace(d, expression=_lower(d.expression)) for d in draft.definitions),
        nodes=draft.nodes,
        elements=tuple(
            replace(e, values=tuple((n, _lower(v, _port_unit(e, n))) for n, v in e.values)) for e in placed
        ),
        signals=tuple(replace(x, expression=_lower(x.expression)) for x in draft.signals),
        blocks=tuple(
            replace(b, values=tuple((n, _lower(v, _block_unit(b, n))) for n, v in b.values))
            for b in draft.blocks
        ),
        inputs=tuple(_measured_input(i, system) for i in inputs),
        outputs=tuple(
            replace(
                o,
                expression=_lower(o.expression),
                dimension=(d := _output_dimension(o, system)),
                unit="" if d is None else str(d),
            )
            for o in draft.outputs
        ),
        signal_units=tuple(units.items()),
        quotients=tuple(_quotients(draft, system)),
    )


def _quotients(draft: _Draft, system: DimensionSystem) -> Iterator[tuple[tuple[str, str], Dimension]]:
    for output in draft.outputs:
        above = system.measure(output.expression)
        for source in draft.inputs:
            below = system.variable(Variable("input", source.input.name))
            dimension = system.dimension(above.times(below.power(-1)))
            if dimension is not None:
                yield (output.name, source.input.name), dimension


def _place(draft: DraftElement, nodes: Mapping[str, Node]) -> PlacedElement:
    domains: list[tuple[str, Placing]] = []
    for port, references in draft.nodes:
        live = next((r for r in references if not r.is_ground), None)
        domain: Placing
        match port.domain:
            case "translation" | "rotation" | "electrical":
                domain = port.domain
            case _ if live is None:
                domain = "translation"
            case "whole" | "planar" if nodes[live.node].domain == "planar":
                domain = "planar"
            case _:
                domain = domain_of(live, nodes[live.node])
        domains.append((port.name, domain))
    attached = tuple((port.name, references) for port, references in draft.nodes)
    return PlacedElement(draft.name, draft.element, attached, tuple(domains), draft.values, draft.span)


def _check(expression: Expression, scope: Scope, *, constant: bool) -> list[Diagnostic]:
    if not isinstance(expression, QuantityLiteral):
        return check_expression(expression, scope, constant=constant)
    return [] if constant or not expression.quantity.magnitude else [without_signal(expression.span)]


def _all_expressions(draft: _Draft) -> list[tuple[Expression, bool]]:
    """Return every expression with whether it must be constant."""
    found: list[tuple[Expression, bool]] = [(d.expression, True) for d in draft.definitions]
    for use in draft.elements:
        signal = {p.name for p in use.element.parameters if p.signal}
        found += [(e, name not in signal) for name, e in use.values]
    found += [(e, True) for b in draft.blocks for _, e in b.values]
    found += [(x.expression, False) for x in draft.signals]
    return found + [(x.expression, False) for x in draft.outputs]


def _check_units(
    reader: Reader,
    draft: _Draft,
    placed: Sequence[PlacedElement],
    scope: Scope,
    unsound: Collection[Span | None],
) -> DimensionSystem:
    """Measure every expression; of one that is unsound, only what disagrees within it is noted."""
    quantities = _quantities(draft.declared, draft.inherited)
    known = _known_dimensions(draft, placed)
    blocks = {b.name: _block_measure(b) for b in draft.blocks}
    system = DimensionSystem(
        scope, quantities, {d.name: d.expression for d in draft.definitions}, known, blocks
    )
    for use in placed:
        for name, expression in use.values:
            where = f"{name} of {use.element.type_name} '{use.name}'"
            doc = next(p.doc for p in use.element.parameters if p.name == name)
            if expression.span in unsound:
                system.measure(expression)
            else:
                _require(reader, system, expression, _port_unit(use, name), where, doc)
    for block in draft.blocks:
        for name, expression in block.values:
            doc = next(p.doc for p in block.block.parameters if p.name == name) if block.block else ""
            where = f"{name} of block '{block.name}'"
            if expression.span in unsound:
                system.measure(expression)
            else:
                _require(reader, system, expression, _block_unit(block, name), where, doc)
    for signal in draft.signals:
        if signal.expression.span in unsound:
            system.measure(signal.expression)
        else:
            system.equate(Variable("signal", signal.name), signal.expression)
    for definition in draft.definitions:
        system.measure(definition.expression)
    for output in draft.outputs:
        system.measure(output.expression)
    return system


def _quantities(
    declared: Sequence[DeclaredParameter], inherited: Sequence[Parameter]
) -> dict[str, Quantity | None]:
    """Return what every parameter is measured in, ``None`` where no unit was written."""
    found: dict[str, Quantity | None] = {}
    for p in declared:
        found[p.name] = p.quantity if p.has_unit else None
        if p.quantity is None and p.unit_text:
            found[p.name] = one_of(p.unit_text)
    for parameter in inherited:
        found[parameter.name] = _in_si(parameter)
    return found


def _constant_measure(
    declared: Sequence[DeclaredParameter], inherited: Sequence[Parameter], definitions: Sequence[Definition]
) -> Callable[[Expression], Dimension | None]:
    """Return a function that tells the dimension of an expression of parameters, ``None`` when it is open."""
    quantities = _quantities(declared, inherited)
    scope = build_scope([*quantities], definitions, (), (), (), (), ())
    system = DimensionSystem(scope, quantities, {d.name: d.expression for d in definitions}, {}, {})

    def measure(expression: Expression) -> Dimension | None:
        if isinstance(expression, QuantityLiteral):
            return expression.quantity.dimension
        return system.dimension(system.measure(expression)) if names(expression) else None

    return measure


def _in_si(parameter: Parameter) -> Quantity | None:
    """Return a quantity of a resolved parameter's unit, ``None`` when it has none."""
    if not parameter.unit:
        return None
    unit = unit_of(parameter.unit)
    return Quantity(Fraction(1), 0, 0, unit.dimension, unit.radians, parameter.unit)


def _require(
    reader: Reader, system: DimensionSystem, expression: Expression, unit: str, what: str, doc: str
) -> None:
    if not isinstance(expression, QuantityLiteral):
        system.require(expression, unit, what, doc)
        return
    found = expression.quantity
    if unit and found.dimension != unit_of(unit).dimension:
        reader.note("SF203", f"{what} is in '{found.unit}'; {doc} is in '{unit}'", expression.span)


def _known_dimensions(draft: _Draft, placed: Sequence[PlacedElement]) -> dict[Variable, Dimension]:
    known: dict[Variable, Dimension] = {}
    for node in draft.nodes:
        for component in node.components:
            domain = {"y": "translation", "theta": "rotation"}.get(component, node.domain)
            known[Variable("node", node.name, component)] = unit_of(ACROSS_UNIT[domain]).dimension
    for use in placed:
        domains = dict(use.domains)
        for quantity in use.element.quantities(domains):
            unit = use.element.unit_of(quantity, domains)
            known[Variable("through", use.name, quantity)] = unit_of(unit).dimension
    for source in draft.inputs:
        unit = source.input.unit or source.unit_text
        if unit:
            known[Variable("input", source.input.name)] = unit_of(unit).dimension
    return known


def _block_measure(block: PlacedBlock) -> Measure:
    if block.submodel is not None and block.tf is not None:
        output = next(o for o in block.submodel.outputs if o.name == block.tf[0])
        source = next(i for i in block.submodel.inputs if i.name == block.tf[1])
        if output.dimension is None or source.dimension is None:
            return Measure(open=True)
        return Measure(output.dimension / source.dimension)
    if block.block is not None and block.block.type_name == "resonance":
        return Measure(DIMENSIONLESS)
    return Measure(open=True)


def _variables(draft: _Draft) -> list[Variable]:
    return [
        *(Variable("signal", x.name) for x in draft.signals),
        *(Variable("input", d.input.name) for d in draft.inputs),
    ]


def _measured_input(source: Input, system: DimensionSystem) -> Input:
    variable = Variable("input", source.name)
    dimension = system.dimension(system.variable(variable))
    unit = source.unit or ("" if dimension is None else str(dimension))
    return replace(source, dimension=dimension, unit=unit)


def _output_dimension(output: Output, system: DimensionSystem) -> Dimension | None:
    return system.dimension(system.measure(output.expression))


def _implied_units(placed: Sequence[PlacedElement], blocks: Sequence[PlacedBlock]) -> dict[str, str]:
    """Return the units that ports give to parameters standing there alone."""
    implied: dict[str, str] = {}
    for use in placed:
        for name, expression in use.values:
            unit = _port_unit(use, name)
            if isinstance(expression, Name) and unit:
                implied.setdefault(expression.name, "1" if unit.startswith("(") else unit)
    for block in blocks:
        for name, expression in block.values:
            unit = _block_unit(block, name)
            if isinstance(expression, Name) and unit:
                implied.setdefault(expression.name, unit)
    return implied


def _port_unit(use: PlacedElement, name: str) -> str:
    return use.element.unit_of(name, dict(use.domains))


def _block_unit(block: PlacedBlock, name: str) -> str:
    return next((p.unit for p in block.block.parameters if p.name == name), "") if block.block else ""


def _lower(expression: Expression, unit: str = "") -> Expression:
    """Replace a quantity by the number it is in SI units."""
    if not isinstance(expression, QuantityLiteral):
        return expression
    angular = not unit or bool(unit_of(unit).radians) or expression.quantity.cycles > 0
    value = ExactValue(*(expression.quantity.angular() if angular else expression.quantity.cyclic()))
    return exact_expression(value)


def exact_expression(value: ExactValue) -> Expression:
    """Return ``rational * pi**n`` as an expression."""
    number = signed_number(value.rational)
    if not value.pi_power:
        return number
    return product_of([number, power(Name("pi"), signed_number(Fraction(value.pi_power)))])

"""From a specification to a model.

Input: a parsed :class:`symflex.model.spec.Spec`.
Output: a :class:`Model`, or one :class:`SpecError` with every problem of the text.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Literal

from symflex.algebra import LAPLACE
from symflex.errors import Diagnostic, Source, Span, SpecError, UsageError
from symflex.expressions import Attribute, Equation, Expression, names
from symflex.library.elements import COMPONENTS, LineElement, Placing
from symflex.model.analysis import (
    check_printed,
    in_own_names,
    read_analysis,
    read_drawing,
    read_figures,
    read_notation,
    read_published,
    readable_names,
    with_candidates,
)
from symflex.model.blocks import Loads, Origin, read_blocks
from symflex.model.boundary import (
    Surroundings,
    check_fields,
    check_points,
    depends_on_s,
    stretches,
    varying_constants,
)
from symflex.model.declarations import (
    DeclaredParameter,
    doubtful_units,
    read_definitions,
    read_outputs,
    read_parameters,
    read_signals,
    with_formulas_defined,
)
from symflex.model.dimensions import DimensionSystem
from symflex.model.equations import check_unknowns, read_equations, read_state_equations
from symflex.model.headings import CONSEQUENCES, SECTIONS, check_header, read_section, settled_problems
from symflex.model.linearity import check_equation, check_expression, without_signal
from symflex.model.loss_factors import with_loss
from symflex.model.model import (
    Definition,
    Model,
    ModelParameter,
    NetworkNode,
    Output,
    PlacedBlock,
    PlacedElement,
)
from symflex.model.network import (
    AsWritten,
    Draft,
    DraftElement,
    DraftInput,
    broken_names,
    domain_of,
    read_elements,
    read_inputs,
)
from symflex.model.passes import Specified, rewritten
from symflex.model.reading import QuantityLiteral, Reader
from symflex.model.scope import ModelScope, build_scope
from symflex.model.settings import Setting, check_names, settled
from symflex.model.signs import Line, check_ranges, ranged_values
from symflex.model.spec import Spec, TableValue, parse_with_recovery
from symflex.model.units import (
    block_unit,
    check_units,
    implied_units,
    lower,
    measured_input,
    measured_variables,
    port_unit,
    quotients,
)
from symflex.model.unused import unused

Kind = Literal["constant", "real", "varying", "signal"]
"""What an expression may be: constant, that and real, varying along x, or varying in time."""
MAX_PAIRS = 10_000
"""Transfer functions of one model, as of 100 outputs and 100 inputs: every list of them is printed in full. A
round number, not a measured one."""


def load_model(
    source: Source,
    ancestors: tuple[Path, ...] = (),
    loads: Loads | None = None,
    *,
    allow_outside: Iterable[str | Path] = (),
) -> Model:
    """Parse and resolve a text, reporting syntax and meaning errors together in the order of the text."""
    spec, syntax = parse_with_recovery(source)
    chain = ancestors or (Path(source.name).resolve(),)
    try:
        model = resolve(spec, Origin(source, chain, loads or Loads.of(source, allow_outside), load_model))
    except SpecError as error:
        # A name lost with an unreadable line would be reported as unknown: that is not a second mistake.
        later = [d for d in error.diagnostics if not syntax or d.code not in (*CONSEQUENCES, "SF214")]
        raise SpecError(*_in_order([*syntax, *later], source)) from None
    if syntax:
        raise SpecError(*syntax)
    return model


def load_with(
    source: Source, settings: Mapping[str, Setting], *, allow_outside: Iterable[str | Path] = ()
) -> Model:
    """Parse and resolve a text with values in place of declared ones, checked as those in the text are."""
    folders = tuple(allow_outside)
    model = load_model(source, allow_outside=folders)
    if not settings:
        return model
    check_names(model, settings)
    try:
        return load_model(source, loads=Loads.of(source, folders, settings))
    except SpecError as error:
        raise UsageError(*error.diagnostics) from None


def resolve(spec: Spec, origin: Origin) -> Model:
    """Give every name, node, unit and value of a specification its meaning, or raise every problem."""
    reader = Reader()
    check_header(reader, spec)
    sections = with_formulas_defined({name: read_section(reader, spec, name) for name in SECTIONS})
    draft = _read_draft(reader, spec, sections, origin)
    defined, inputs, outputs = draft.definitions, draft.inputs, draft.outputs
    twins = _refuse_twins(reader, draft)
    if draft.sampled is not None:
        from symflex.model.sampled import misplaced

        reader.take(misplaced(draft))
    draft = rewritten(
        Specified(reader, sections, origin.loads.settings), _with_equations(reader, sections, draft)
    )
    broken = broken_names(sections, draft) | twins
    model = _finish(reader, draft, broken)
    are_read = all(
        len(entries) == len(section.entries)
        for entries, section in ((outputs, sections["outputs"]), (inputs, sections["inputs"]))
        if section
    )
    model = _with_requests(reader, spec, sections, draft, model, broken, are_read=are_read)
    problems = settled_problems(spec, reader.problems)
    if problems:
        raise SpecError(*_in_order(problems, spec.source))
    inner = [w for b in model.blocks if b.submodel is not None for w in b.submodel.warnings]
    return replace(
        model,
        conversions=_conversions(model, defined, draft.cycles.converted),
        warnings=tuple(_in_order([*model.warnings, *unused(model), *inner], spec.source)),
    )


Sections = Mapping[str, TableValue | None]


def _read_draft(reader: Reader, spec: Spec, sections: Sections, origin: Origin) -> Draft:
    """Return what is declared in sections, without equations of motion and fields."""
    declared = read_parameters(reader, sections["parameters"], sections["definitions"])
    declared = settled(reader, declared, origin.loads.settings)
    definitions = read_definitions(reader, sections["definitions"])
    elements = read_elements(reader, sections["elements"])
    inputs = read_inputs(reader, sections["inputs"])
    blocks = read_blocks(reader, sections["blocks"], origin)
    signals = read_signals(reader, sections["signals"])
    outputs = read_outputs(reader, sections["outputs"])
    _check_count(reader, spec, outputs, inputs)
    inherited = _inherited_parameters(reader, declared, blocks)
    sampled = None
    if sections["sampled"]:
        from symflex.model.sampled import VARIABLE, read_sampled  # few models have one

        sampled = read_sampled(reader, spec.root.get("sampled"), blocks)
        inherited += (VARIABLE,)
    return Draft(
        declared, inherited, definitions, (), elements, inputs, blocks, signals, outputs, AsWritten(),
        sampled=sampled,
    )  # fmt: skip


def _with_equations(reader: Reader, sections: Sections, draft: Draft) -> Draft:
    """Return a draft with the unknowns of state equations and of ``[equations]`` among its signals."""
    signals = draft.signals
    for read, section in ((read_state_equations, "blocks"), (read_equations, "equations")):
        signals += read(reader, sections[section], draft.constants, {x.name for x in signals})
    return replace(draft, signals=signals)


def _with_requests(
    reader: Reader,
    spec: Spec,
    sections: Sections,
    draft: Draft,
    model: Model,
    broken: frozenset[str],
    *,
    are_read: bool,
) -> Model:
    """Return a model with what is asked of it: analysis, figures, drawing and printed formulas."""
    requests, hints, point, cycles = Reader(), Reader(), draft.point, draft.cycles
    solved_with = point.solved_with if point else ()
    model = replace(
        model,
        outputs=_in_radians(model, () if point is None else point.coordinates),
        title=reader.plain(spec.root, "title", "the specification"),
        source=reader.plain(spec.root, "source", "the specification"),
        operating_point=point,
        parameters=tuple(replace(p, is_solved_with=p.name in solved_with) for p in model.parameters),
        analysis=read_analysis(reader, sections["analysis"]),
        figures=read_figures(requests, sections["figures"], model),
        drawing=read_drawing(hints, sections["drawing"], model),
        notation=(notation := read_notation(requests, sections["notation"], model)),
        published=tuple(
            map(cycles.printed, read_published(requests, sections["published"], model, notation))
        ),
    )
    if sections["ports"]:
        from symflex.model.ports import read_ports  # few models have one

        model = replace(model, ports=read_ports(hints, sections["ports"], model))
    if sections["tables"]:
        from symflex.model.printed_tables import read_tables  # few models have one

        model = replace(model, tables=read_tables(requests, sections["tables"], model, cycles))
    model = _with_names_in_print(reader, requests, model, broken, cycles)
    # A transfer function is missing where its output or input could not be read: no second mistake.
    reader.take([p for p in requests.problems if are_read or p.code != "SF218"])
    # A node may be missing for the same reason.
    reader.take([p for p in hints.problems if not reader.problems or p.code != "SF210"])
    return model


def _with_names_in_print(
    reader: Reader, later: Reader, model: Model, broken: frozenset[str], cycles: AsWritten
) -> Model:
    """Return a model whose names for print are read, and note what is wrong in printed formulas."""
    readable = readable_names(model, broken)
    analysis = cycles.printed(in_own_names(model.analysis))
    meant = {*readable.constants, *readable.definitions, *readable.varying}
    for name, expression in analysis.where:
        if name in meant:
            message = f"'{name}' in print of [analysis] has a meaning already"
            reader.note("SF213", message, expression.span, "give the combination of parameters another name")
    for published in (*model.published, *([] if {n for n, _ in analysis.where} & meant else [analysis])):
        problems = check_printed(published, readable)
        later.take(with_candidates(problems, published, model) if published.is_latex else problems)
    return replace(model, analysis=replace(model.analysis, print=analysis.where))


def _conversions(
    model: Model, definitions: Sequence[Definition], converted: Collection[str]
) -> tuple[ModelParameter, ...]:
    """Return what is in cycles and became radians, as it is used: parameters, and definitions like them."""
    literals = [(d, d.expression.quantity) for d in definitions if isinstance(d.expression, QuantityLiteral)]
    known = [*model.parameters]
    known += [
        DeclaredParameter(d.name, q, True, "", "real", "", "", d.span).resolve()
        for d, q in literals
        if d.span
    ]
    found = {p.name: p.in_radians for p in known if p.name in converted}
    for block in model.blocks:
        found = {p.name: p for p in (block.submodel.conversions if block.submodel else ())} | found
    return tuple(found.values())


def _check_count(reader: Reader, spec: Spec, outputs: Sequence[Output], inputs: Sequence[DraftInput]) -> None:
    """Stop at a model with more transfer functions than can be listed."""
    entry = spec.root.get("outputs")
    if entry is not None and len(outputs) * len(inputs) > MAX_PAIRS:
        message = (
            f"{len(outputs)} outputs and {len(inputs)} inputs make {len(outputs) * len(inputs)} transfer "
            f"functions; at most {MAX_PAIRS} are allowed"
        )
        hint = "split the outputs over several specifications"
        raise SpecError(*reader.problems, Diagnostic("SF103", message, entry.key_span, hint))


def _in_order(problems: Sequence[Diagnostic], source: Source) -> list[Diagnostic]:
    """Return the problems in the order of the text, each once; those of other files come last."""
    # A name that is unknown or can be read two ways is one problem: the first place is shown, with the
    # lines of the others.
    unique = list(dict.fromkeys(problems))

    def place(problem: Diagnostic) -> tuple[int, str, int]:
        span = problem.span
        if span is None:
            return (2, "", 0)
        return (int(span.source is not source), span.source.name, span.start)

    ordered = sorted(unique, key=place)
    same: dict[tuple[str, object], list[Diagnostic]] = {}
    for p in ordered:
        same.setdefault((p.code, p.message if p.code in ("SF210", "SF211") else id(p)), []).append(p)
    return [_with_lines(*each) for each in same.values()]


def _with_lines(first: Diagnostic, *others: Diagnostic) -> Diagnostic:
    lines = dict.fromkeys(str(p.span.line) for p in others if p.span is not None)
    if not lines:
        return first
    also = f"also in line{'s'[: len(lines) - 1]} {', '.join(lines)}"
    return replace(first, hint=f"{first.hint}; {also}" if first.hint else also)


def _refuse_twins(reader: Reader, draft: Draft) -> frozenset[str]:
    """Note and return the names that two of parameters, definitions and blocks bear."""
    twins: set[str] = set()
    taken = dict.fromkeys(draft.parameters, "a parameter")
    for what, group in (("a definition", draft.definitions), ("a block", draft.blocks)):
        for item in group:
            if item.name in taken:
                message = f"'{item.name}' is {what} and {taken[item.name]}"
                reader.note("SF211", message, item.span, "rename one of them")
                twins.add(item.name)
            taken.setdefault(item.name, what)
    return frozenset(twins)


def _inherited_parameters(
    reader: Reader, declared: Sequence[DeclaredParameter], blocks: Sequence[PlacedBlock]
) -> tuple[ModelParameter, ...]:
    """Return the parameters that ``model`` blocks bring along; an equal name must be equal in value."""
    resolved = {p.name: p.resolve() for p in declared}
    inherited: dict[str, ModelParameter] = {}
    bringing: dict[str, str] = {}
    for block in blocks:
        for parameter in block.submodel.parameters if block.submodel else ():
            earlier = resolved.get(parameter.name) or inherited.get(parameter.name)
            if earlier is None:
                inherited[parameter.name] = parameter
                bringing[parameter.name] = block.name
            elif (
                earlier.value is not None and parameter.value is not None and earlier.value != parameter.value
            ):
                other = bringing.get(parameter.name)
                than = f" than in block '{other}' ({earlier.span})" if other else ""
                here = f"in block '{block.name}' ({parameter.span})"
                message = f"parameter '{parameter.name}' has another value {here}{than}"
                hint = "rename one of the two: parameters of a model block are shared by name"
                reader.note("SF226", message, earlier.span if earlier.name in resolved else block.span, hint)
    return tuple(inherited.values())


def _finish(reader: Reader, draft: Draft, broken: frozenset[str]) -> Model:
    """Check names, linearity and units, and return the model."""
    nodes = {n.name: n for n in draft.nodes}
    placed = tuple(_place(d, nodes) for d in draft.elements)
    inputs = tuple(d.input for d in draft.inputs)
    scope = build_scope(
        draft.parameters,
        draft.definitions,
        draft.nodes,
        placed,
        draft.signals,
        draft.blocks,
        inputs,
        broken,
        draft.fields,
    )
    unsound = _check_names(reader, draft, scope)
    system = _check_values(reader, draft, scope, placed, unsound)
    implied = implied_units(placed, draft.blocks)
    parameters = [
        p.resolve(implied.get(p.name, ""), is_converted=p.name in draft.cycles.eager) for p in draft.declared
    ]
    units = {v: d for v in measured_variables(draft) if (d := system.dimension(system.variable(v)))}
    return Model(
        parameters=(*parameters, *draft.inherited),
        definitions=tuple(replace(d, expression=lower(d.expression)) for d in draft.definitions),
        nodes=draft.nodes,
        elements=tuple(map(_in_si_units, placed)),
        signals=tuple(replace(x, expression=lower(x.expression)) for x in draft.signals),
        blocks=tuple(
            replace(b, values=tuple((n, lower(v, block_unit(b, n))) for n, v in b.values))
            for b in draft.blocks
        ),
        fields=tuple(f.rewritten(lower) for f in draft.fields),
        inputs=tuple(measured_input(i, system) for i in inputs),
        outputs=tuple(_measured(o, system) for o in draft.outputs),
        sampled=draft.sampled
        and replace(
            draft.sampled, period=lower(draft.sampled.period, "s"), delay=lower(draft.sampled.delay, "s")
        ),
        signal_units=tuple(units.items()),
        quotients=tuple(quotients(draft, system)),
        warnings=tuple(doubtful_units(draft.declared)),
    )


def _in_si_units(use: PlacedElement) -> PlacedElement:
    """Return an element whose values are plain expressions, with its loss factors in them."""
    values = tuple((name, lower(value, port_unit(use, name))) for name, value in use.values)
    return replace(use, values=with_loss(use.element, values))


def _measured(output: Output, system: DimensionSystem) -> Output:
    """Return an output with the unit that follows for it."""
    dimension = system.dimension(system.measure(output.expression))
    unit = "" if dimension is None else str(dimension)
    return replace(output, expression=lower(output.expression), dimension=dimension, unit=unit)


def _check_names(reader: Reader, draft: Draft, scope: ModelScope) -> set[Span | None]:
    """Check what names mean and that signals are linear; return the spans of expressions that are unsound."""
    unsound: set[Span | None] = set()
    scopes: dict[Kind, ModelScope] = {"varying": scope.varying(), "constant": scope, "signal": scope}
    unreal = {p.name for p in draft.inherited if p.is_imaginary}
    plain = replace(scope, meanings={n: m for n, m in scope.meanings.items() if n not in unreal})
    outputs = {id(x.expression) for x in draft.outputs}
    for expression, kind in _all_expressions(draft):
        readable = plain if id(expression) in outputs else scopes.get(kind, plain)
        problems = _check(expression, readable, constant=kind != "signal")
        reader.take(problems)
        if problems:
            unsound.add(expression.span)
    acting = [e for e, kind in _all_expressions(replace(draft, signals=(), outputs=())) if kind == "signal"]
    check_unknowns(reader, draft.signals, [*acting, *_field_equations(draft)])
    return unsound


def _field_equations(draft: Draft) -> list[Expression]:
    return [e for f in draft.fields for e in (*f.equations, *f.conditions)]


def _check_values(
    reader: Reader,
    draft: Draft,
    scope: ModelScope,
    placed: Sequence[PlacedElement],
    unsound: set[Span | None],
) -> DimensionSystem:
    """Check ranges, fields and units, and points along x; return what everything is measured in."""
    parameters = [p.resolve(is_converted=p.name in draft.cycles.eager) for p in draft.declared]
    around = _surroundings(draft, scope, (*parameters, *draft.inherited))
    for ranged in ranged_values(draft):
        if ranged.is_extent and depends_on_s(ranged.expression, around.varying):
            reader.note("SF249", f"{ranged.what} cannot depend on s", ranged.expression.span)
            unsound.add(ranged.expression.span)
    check_ranges(reader, draft, around.line, unsound, is_along=False)
    before = len(reader.problems)
    fields_placed = check_fields(reader, draft.fields, around)
    unsound |= {e.span for e in _field_equations(draft) if _holds(e, reader.problems[before:])}
    system = check_units(reader, draft, placed, scope, unsound, fields_placed)
    reader.take(system.problems)
    # A section of other units has other signs, too.
    unsound |= {r.expression.span for r in ranged_values(draft) if _holds(r.expression, system.problems)}
    check_ranges(reader, draft, around.line, unsound, is_along=True)
    along = stretches([f for f in draft.fields if f.name in fields_placed], placed)
    pointed: list[Expression] = [c for f in draft.fields for c in f.conditions]
    pointed += [e for e, kind in _all_expressions(draft) if kind == "signal"]
    for expression in pointed if along else ():
        check_points(reader, expression, along, around)
    return system


def _in_radians(model: Model, coordinates: Iterable[str]) -> tuple[Output, ...]:
    """Return the outputs, those in rad that are sums of angles: of nodes, or coordinates of an energy."""
    angles = {".theta", *(n.name for n in model.nodes if n.domain == "rotation")}
    angles |= {v.owner for v, d in model.signal_units if v.owner in coordinates and str(d) == "1"}
    still = {LAPLACE, "pi", *(p.name for p in model.parameters), *(d.name for d in model.definitions)}

    def turns(expression: Expression) -> bool:
        moving = {f".{n.name}" if isinstance(n, Attribute) else n.name for n in names(expression)} - still
        return bool(moving) and moving <= angles

    signals = {x.name: x.expression for x in model.signals if not isinstance(x.expression, Equation)}
    while more := {name for name in signals.keys() - angles if turns(signals[name])}:
        angles |= more
    units = ("1", "1/s", "1/s^2")
    return tuple(
        replace(o, unit=o.unit.replace("1", "rad", 1)) if o.unit in units and turns(o.expression) else o
        for o in model.outputs
    )


def _place(draft: DraftElement, nodes: Mapping[str, NetworkNode]) -> PlacedElement:
    domains: list[tuple[str, Placing]] = []
    for port, references in draft.nodes:
        live = [r for r in references if not r.is_ground]
        bodies = [r for r in live if nodes[r.node].domain in COMPONENTS and not r.component]
        domain: Placing
        match port.domain:
            case "translation" | "rotation" | "electrical" | "acoustic" | "thermal":
                domain = port.domain
            case _ if not live:
                domain = "translation"
            case "whole" | "planar" | "plane" if len(bodies) == len(live):
                both = {nodes[r.node].domain for r in bodies}
                domain = "plane" if both == {"plane"} else "planar"
            case _:  # where one end is a single coordinate, it is that of the other which is held
                single = next((r for r in live if r not in bodies), live[0])
                domain = domain_of(single, nodes[single.node])
        domains.append((port.name, domain))
    attached = tuple((port.name, references) for port, references in draft.nodes)
    return PlacedElement(
        draft.name,
        draft.element,
        attached,
        tuple(domains),
        draft.values,
        draft.span,
        draft.choices,
        draft.latex,
    )


def _surroundings(draft: Draft, scope: ModelScope, parameters: Sequence[ModelParameter]) -> Surroundings:
    """Return what places along x are made of."""
    extended = bool(draft.fields) or any(True for _ in ranged_values(draft))
    definitions = {d.name: d.expression for d in draft.definitions} if extended else {}
    line = Line(
        definitions,
        frozenset(p.name for p in parameters if p.assume == "positive"),
        frozenset(p.name for p in parameters if p.assume == "nonnegative"),
        {p.name: p.value.nearly for p in parameters if p.value},
    )
    return Surroundings(scope, definitions, varying_constants(draft.definitions, draft.blocks), line)


def _holds(expression: Expression, problems: Sequence[Diagnostic]) -> bool:
    """Tell whether some problem lies within an expression."""
    span = expression.span
    spans = [
        p.span for p in problems if span is not None and p.span is not None and p.span.source is span.source
    ]
    return span is not None and any(span.start <= each.start and each.end <= span.end for each in spans)


def _check(expression: Expression, scope: ModelScope, *, constant: bool) -> list[Diagnostic]:
    if isinstance(expression, Equation):
        return check_equation(expression, scope, acts=True)
    if not isinstance(expression, QuantityLiteral):
        return check_expression(expression, scope, constant=constant)
    return [] if constant or not expression.quantity.magnitude else [without_signal(expression.span)]


def _all_expressions(draft: Draft) -> list[tuple[Expression, Kind]]:
    """Return every expression with what it may be."""
    expressions: list[tuple[Expression, Kind]] = [(d.expression, "constant") for d in draft.definitions]
    for use in draft.elements:
        kinds: dict[str, Kind] = {p.name: "signal" for p in use.element.parameters if p.signal}
        kinds |= {p.name: "varying" for p in use.element.parameters if p.varies}
        kinds |= {"l": "real"} if isinstance(use.element, LineElement) else {}
        expressions += [(e, kinds.get(name, "constant")) for name, e in use.values]
    expressions += [(e, "constant") for b in draft.blocks for _, e in b.values]
    if draft.sampled is not None:
        expressions += [(e, "real") for e in (draft.sampled.period, draft.sampled.delay)]
    expressions += [(x.expression, "signal") for x in draft.signals]
    return expressions + [(x.expression, "signal") for x in draft.outputs]

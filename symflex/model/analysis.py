"""Reading what a specification asks of the commands: defaults, figures, drawings, published formulas.

Whether the names of a printed formula are known is told from its tree.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from itertools import islice
from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE
from symflex.errors import Diagnostic, Span, Text, UsageError, nearest
from symflex.expressions import (
    FUNCTIONS,
    Attribute,
    Call,
    Derivative,
    Expression,
    Name,
    Power,
    Sum,
    names,
    names_among,
    nodes,
    parse,
    substitute,
    sum_of,
)
from symflex.model.model import PI_NEARLY, TRANSFORMER_SYMBOLS, Analysis, DrawingHints, Figure, Published
from symflex.model.scope import COMPARED_NAMES, LISTED_NAMES, RESERVED
from symflex.model.settings import value_in_unit
from symflex.model.signs import Line
from symflex.model.spec import ArrayValue, BooleanValue, KeyValue, NumberValue, TableValue, Value
from symflex.quantities import IMAGINARY_NAMES, Quantity, unit_of

if TYPE_CHECKING:
    from symflex.model.model import Model, ModelParameter, NamedExpressions
    from symflex.model.reading import Reader
    from symflex.papers.symbols import PaperNotation

ANALYSIS_KEYS = ("band", "data_end", "modes", "digits", "form", "print", "prefer")
FORM_NAMES = (
    *("polynomial", "monic", "constant", "factored", "definitions", "zpk"),
    *("hyperbolic", "krylov", "vaughan", "frequency"),
)
FIGURE_KEYS = ("kind", "of", "gain", "over", "range", "band", "until", "at", "data", "title", "doc")
OF_A_LOOP = ("nyquist", "nichols", "sensitivity", "locus")
FIGURE_KINDS = (
    *("bode", "sigma", "rga", "poles_zeros", *OF_A_LOOP, "stability", "modes", "deflection"),
    *("step", "impulse"),
)
IN_TIME = ("step", "impulse")
MODES_LIMIT = 1_000_000
DIGITS_LIMIT = 10_000


def read_analysis(reader: Reader, section: TableValue | None) -> Analysis:
    """Return the defaults for the commands."""
    if section is None:
        return Analysis()
    reader.keys(section, ANALYSIS_KEYS, "[analysis]")
    band, data_end = section.get("band"), section.get("data_end")
    end = _frequency(reader, data_end.value) if data_end else None
    if data_end and end is not None and end <= 0:
        reader.note("SF227", "the data must end above 0 Hz", data_end.value.span, 'as in "1 kHz"')
    prefer = section.get("prefer")
    groups = reader.strings(prefer, "prefer of [analysis]") if prefer else ()
    form = reader.text(section, "form", "[analysis]")
    return Analysis(
        _band(reader, band) if band else None,
        end,
        _count(reader, section, "modes", MODES_LIMIT),
        _count(reader, section, "digits", DIGITS_LIMIT),
        _where(reader, section, "[analysis]", "print") or (),
        tuple(filter(None, (reader.read(parse, group) for group in groups or ()))),
        form.value if form and _check_among(reader, form, FORM_NAMES, "form") else "",
    )


def _band(reader: Reader, entry: KeyValue) -> tuple[Fraction, Fraction] | None:
    value = entry.value
    example = 'for instance ["0.1 Hz", "1 kHz"]'
    items = reader.pair(value, "band must be an array of two frequencies", example)
    if items is None:
        return None
    low, high = (_frequency(reader, item) for item in items)
    if low is None or high is None:
        return None
    if low >= high:
        hint = "write the lower frequency first"
        reader.note("SF227", "the band must end above its start", value.span, hint)
        return None
    if low <= 0:
        hint = "both frequencies must be positive"
        reader.note("SF227", "the band must begin above 0 Hz", items[0].span, hint)
        return None
    return low, high


def _frequency(reader: Reader, value: Value) -> Fraction | None:
    """Return a frequency in Hz; a bare number is in Hz, rad/s is converted with pi to 30 digits."""
    quantity = _quantity(reader, value, "a frequency", "Hz")
    if quantity is None:
        return None
    number = in_limits(quantity)
    return number if quantity.cycles or not quantity.unit else number / (2 * PI_NEARLY)


def _quantity(reader: Reader, value: Value, what: str, unit: str) -> Quantity | None:
    """Return a quantity of the kind that a unit measures, or a number."""
    quantity = reader.quantity(value, what)
    if quantity is None or not quantity.unit or quantity.dimension == unit_of(unit).dimension:
        return quantity
    reader.note("SF203", f"{what} is in '{unit}', found '{quantity.unit}'", value.span)
    return None


def in_limits(quantity: Quantity) -> Fraction:
    """Return the limit of a band or region that a quantity gives, in SI units and cycles."""
    number, pi_power = quantity.cyclic()
    return number * PI_NEARLY**pi_power


def _count(reader: Reader, section: TableValue, key: str, limit: int) -> int | None:
    entry = section.get(key)
    if entry is None:
        return None
    value = entry.value
    if isinstance(value, NumberValue) and value.value.denominator == 1 and 0 < value.value <= limit:
        return int(value.value)
    reader.misfit(f"{key} must be an integer from 1 to {limit}", value)
    return None


def named_pairs(model: Model) -> dict[str, tuple[str, str]]:
    """Return every (output, input) pair by its name "OUT/IN"."""
    return {"/".join(pair): pair for pair in model.transfer_functions}


def pick_tf(
    reader: Reader, name: str, span: Span, known: Mapping[str, tuple[str, str]], where: str = ""
) -> tuple[str, str] | None:
    """Return the (output, input) pair that "OUT/IN" names; ``where`` says of which model."""
    if name not in known:
        close = nearest(name, known) if len(known) <= COMPARED_NAMES else None
        hint = close or "available: " + ", ".join(islice(known, LISTED_NAMES))
        reader.note("SF218", f"there is no transfer function '{name[:80]}'{where}", span, hint)
    return known.get(name)


def read_figures(reader: Reader, section: TableValue | None, model: Model) -> tuple[Figure, ...]:
    """Return the figures asked for."""
    figures: list[Figure] = []
    pairs = named_pairs(model) if section else {}
    for entry in section.entries if section else ():
        what = f"figure '{entry.key}'"
        table = reader.table(entry, what) if reader.name(entry, "a figure") else None
        if table is None:
            continue
        reader.keys(table, FIGURE_KEYS, what)
        kind = _kind(reader, table, entry, what)
        of = table.get("of")
        texts = reader.strings(of, f"of of {what}") if of else ()
        chosen = tuple(tf for t in texts or () if (tf := pick_tf(reader, t.value, t.span, pairs)))
        gain = _gain(reader, table, kind, what, model)
        title = reader.plain(table, "title", what)
        has_data = _has_data(reader, table, kind, chosen, what)
        limits = table.get("band")
        band = _band(reader, limits) if limits else None
        over = _over(reader, table, kind, entry, [p.name for p in model.parameters])
        until = _until(reader, table, kind, what)
        ends = _range(reader, table, kind, what, next((p for p in model.parameters if p.name == gain), None))
        more = ends, over, _at(reader, table, kind, entry)
        figures.append(
            Figure(entry.key, kind, chosen, title, gain, entry.key_span, has_data, band, until, *more)
        )
    return tuple(figures)


def read_drawing(reader: Reader, section: TableValue | None, model: Model) -> DrawingHints:
    """Return how the model is to be drawn."""
    if section is None:
        return DrawingHints()
    reader.keys(section, ("order", "symbols", "rollers", "up"), "[drawing]")
    order, table = section.get("order"), section.get("symbols")
    nodes = [n.name for n in model.nodes]
    listed: list[str] = []
    for text in (reader.strings(order, "order of [drawing]", "an array of nodes") or ()) if order else ():
        _check_among(reader, text, nodes, "node")
        if text.value in listed:
            reader.note("SF213", f"node '{text.value[:64]}' appears twice in order", text.span)
        listed.append(text.value)
    switches: dict[str, bool] = {}
    for entry in filter(None, (section.get("rollers"), section.get("up"))):
        if isinstance(entry.value, BooleanValue):
            switches[entry.key] = entry.value.value
        else:
            reader.misfit(f"{entry.key} of [drawing] must be true or false", entry.value)
    symbols: list[tuple[str, str]] = []
    shown = reader.table(table, "symbols of [drawing]", 'as in { pinion = "rack" }') if table else None
    turning = [e.name for e in model.elements if e.element.type_name == "transformer"]
    for entry in shown.entries if shown else ():
        _check_among(reader, Text(entry.key, entry.key_span), turning, "transformer")
        kind = reader.string(entry, f"symbol of '{entry.key[:64]}'")
        if kind is not None and kind.value not in TRANSFORMER_SYMBOLS:
            hint = nearest(kind.value, TRANSFORMER_SYMBOLS) or "symbols: " + ", ".join(TRANSFORMER_SYMBOLS)
            reader.note("SF208", f"unknown symbol '{kind.value[:60]}' of '{entry.key}'", kind.span, hint)
        elif kind is not None:
            symbols.append((entry.key, kind.value))
    rollers, is_up = switches.get("rollers"), switches.get("up", False)
    return DrawingHints(tuple(listed), tuple(symbols), rollers, is_up)


def _check_among(reader: Reader, text: Text, known: Sequence[str], what: str) -> bool:
    """Tell whether a text is a name of something there is, and note where it is not."""
    if text.value not in known:
        hint = nearest(text.value, known) or f"{what}s: " + (", ".join(known[:LISTED_NAMES]) or "none")
        reader.note("SF210", f"there is no {what} '{text.value[:64]}'", text.span, hint)
    return text.value in known


def _until(reader: Reader, table: TableValue, kind: str, what: str) -> Fraction | None:
    """Return the last time that a figure shows [s], None if it does not say."""
    entry = table.get("until")
    if entry is None:
        return None
    if kind not in IN_TIME:
        hint = "kinds that take 'until': " + ", ".join(IN_TIME)
        reader.note("SF207", f"{what} is of kind '{kind}', which has no 'until'", entry.key_span, hint)
        return None
    quantity = _quantity(reader, entry.value, "a time", "s")
    number = None if quantity is None else in_limits(quantity)
    if number is None or number > 0:
        return number
    reader.note("SF227", "the end time must be after t = 0", entry.value.span, 'as in "0.5 s"')
    return None


def _has_data(
    reader: Reader, table: TableValue, kind: str, chosen: tuple[tuple[str, str], ...], what: str
) -> bool:
    """Return whether reports draw measured data into a figure: a Bode plot of one function."""
    entry = table.get("data")
    if entry is None:
        return False
    if not isinstance(entry.value, BooleanValue):
        reader.misfit(f"data of {what} must be true or false", entry.value)
        return False
    if entry.value.value and (kind != "bode" or len(chosen) != 1):
        hint = "data are drawn under a Bode plot of one transfer function"
        reader.note("SF207", f"{what} cannot show measured data", entry.key_span, hint)
        return False
    return entry.value.value


def _gain(reader: Reader, table: TableValue, kind: str, what: str, model: Model) -> str:
    """Return the parameter that is the gain of the loop a figure shows, empty when it shows none."""
    text = reader.text(table, "gain", what)
    if text is None:
        return ""
    if kind not in OF_A_LOOP:
        hint = "kinds with a gain: " + ", ".join(OF_A_LOOP)
        reader.note("SF207", f"{what} is of kind '{kind}', which has no gain", text.span, hint)
    is_known = _check_among(reader, text, [p.name for p in model.parameters], "parameter")
    return text.value if is_known else ""


def _over(
    reader: Reader, table: TableValue, kind: str, figure: KeyValue, parameters: Sequence[str]
) -> tuple[str, ...]:
    """Return the one or two parameters over which a figure shows stability."""
    entry, example = table.get("over"), 'for instance over = ["K", "T"]'
    if kind != "stability":
        if entry is not None:
            reader.note("SF207", f"a figure of kind '{kind}' has no 'over'", entry.key_span, example)
        return ()
    if entry is None:
        reader.note("SF214", f"figure '{figure.key}' does not say over what", figure.key_span, example)
        return ()
    texts = reader.strings(entry, f"over of figure '{figure.key}'") or ()
    if not 1 <= len(texts) <= 2:  # noqa: PLR2004
        reader.note("SF208", "stability is drawn over one parameter, or over two", entry.key_span, example)
    return tuple(t.value for t in texts if _check_among(reader, t, parameters, "parameter"))


def _at(reader: Reader, table: TableValue, kind: str, figure: KeyValue) -> tuple[Fraction, ...]:
    """Return the frequencies of a figure of deflections [Hz]."""
    entry, example = table.get("at"), 'for instance at = "30 Hz"'
    if (entry is None) == (kind == "deflection"):
        code, is_or = ("SF214", "needs") if entry is None else ("SF207", "does not take")
        span = figure.key_span if entry is None else entry.key_span
        reader.note(code, f"figure '{figure.key}' of kind '{kind}' {is_or} 'at'", span, example)
    if entry is None:
        return ()
    items = entry.value.items if isinstance(entry.value, ArrayValue) else (entry.value,)
    numbers = [(item, _frequency(reader, item)) for item in items]
    for item in (item for item, number in numbers if number is not None and number < 0):
        reader.note("SF227", "a frequency is not negative", item.span, example)
    return tuple(number for _, number in numbers if number is not None)


def _range(
    reader: Reader, table: TableValue, kind: str, what: str, gain: ModelParameter | None
) -> tuple[Fraction, Fraction] | None:
    """Return the first and last gain of a locus in SI units, None if it does not say."""
    entry = table.get("range")
    if entry is None:
        return None
    if kind != "locus" or table.get("gain") is None:
        hint = 'only a locus has one, as in kind = "locus", gain = "K"'
        reader.note("SF207", f"{what} has a 'range' without a locus and its gain", entry.key_span, hint)
    if kind != "locus" or gain is None:
        return None
    items = reader.pair(entry.value, "range must be an array of two gains", "for instance [0, 1e4]")
    if items is None:
        return None
    low, high = (_end(reader, item, gain) for item in items)
    if low is None or high is None:
        return None
    if low >= high:
        span = entry.value.span
        reader.note("SF227", "the range must end above its start", span, "write the lower gain first")
        return None
    return low, high


def _end(reader: Reader, item: Value, gain: ModelParameter) -> Fraction | None:
    quantity = reader.quantity(item, "a gain")
    if quantity is None:
        return None
    if quantity.unit and (not gain.unit or quantity.dimension != unit_of(gain.unit).dimension):
        message = f"'{gain.name}' is in '{gain.unit or 1}', the range is in '{quantity.unit}'"
        reader.note("SF203", message, item.span)
        return None
    try:
        return value_in_unit(gain, quantity).nearly
    except UsageError as error:
        reader.take(replace(d, span=item.span) for d in error.diagnostics)
        return None


def _kind(reader: Reader, table: TableValue, entry: KeyValue, what: str) -> str:
    kinds = "kinds: " + ", ".join(FIGURE_KINDS)
    given = reader.needed(table, "kind", entry, f"{what} has no 'kind'", kinds)
    text = reader.string(given, f"kind of {what}") if given else None
    if text is not None and text.value not in FIGURE_KINDS:
        hint = nearest(text.value, FIGURE_KINDS) or kinds
        reader.note("SF208", f"unknown kind '{text.value[:60]}' of {what}", text.span, hint)
    return text.value if text else ""


def read_notation(reader: Reader, section: TableValue | None, model: Model) -> tuple[tuple[str, str], ...]:
    """Return the symbols of a paper, as they are typed in LaTeX, with the names they have in the model."""
    if section is None:
        return ()
    from symflex.papers.symbols import symbol_of_latex  # few specifications hold LaTeX

    tied: list[tuple[str, str]] = []
    known = {LAPLACE, "pi", *(name for name, _ in labelled_names(model))}
    for entry in section.entries:
        text = reader.string(entry, f"'{entry.key[:80]}' of [notation]")
        if text is not None and text.value not in known:
            close = nearest(text.value, known) if len(known) <= COMPARED_NAMES else None
            hint = close or "write a parameter, a definition, an input, an output or s"
            reader.note("SF210", f"unknown name '{text.value[:64]}' in [notation]", text.span, hint)
        elif text is not None and symbol_of_latex(Text.alone("<symbol>", entry.key)) is None:
            hint = r"give one symbol, such as \hat{x}_1 or M_{\mathrm{eff}}"
            reader.note("SF115", f"'{entry.key[:64]}' in [notation] is no symbol", entry.key_span, hint)
        elif text is not None:
            tied.append((entry.key, text.value))
    return tuple(tied)


def labelled_names(model: Model) -> list[tuple[str, str]]:
    """Return the names of what printed formulas may contain, and of outputs and inputs, with their labels."""
    groups = (model.parameters, model.definitions, model.outputs, model.inputs)
    return [(item.name, item.latex) for group in groups for item in group]


def notation_of_model(
    model: Model, symbols: Iterable[tuple[str, str]], printed: Iterable[str] = ()
) -> PaperNotation:
    """Return what the symbols of a paper mean; ``printed`` are names that the formula's own lines give."""
    from symflex.papers.symbols import notation_of  # few specifications hold LaTeX

    varying = {item.name for group in (model.outputs, model.inputs) for item in group}
    named = [*labelled_names(model), *((name, "") for name in printed)]
    constant = {item.name for group in (model.parameters, model.definitions) for item in group}
    return notation_of(named, varying - constant, symbols)


def read_published(
    reader: Reader, section: TableValue | None, model: Model, symbols: Sequence[tuple[str, str]] = ()
) -> tuple[Published, ...]:
    """Return the printed formulas; :mod:`symflex.model.analysis` checks their names."""
    published: list[Published] = []
    pairs = named_pairs(model) if section else {}
    for entry in section.entries if section else ():
        what = f"published '{entry.key[:80]}'"
        tf = pick_tf(reader, entry.key, entry.key_span, pairs)
        table = reader.table(entry, what, 'for instance { expr = "1/(m*s^2 + k)" }')
        if table is None or tf is None:
            continue
        reader.keys(table, ("expr", "latex", "where", "scale", "source", "doc"), what)
        latex, where = table.get("latex"), _where(reader, table, what)
        if latex is not None and (twice := table.get("expr")) is not None:
            reader.note("SF208", f"{what} has both 'expr' and 'latex'", twice.key_span, "keep one of them")
            continue
        expr = latex or reader.needed(table, "expr", entry, f"{what} has no 'expr' or 'latex'")
        if expr is None:
            continue
        others: list[Expression] = []
        if latex is None:
            expression = reader.expression(expr.value, what, quantities=False)
        else:
            notation = notation_of_model(model, symbols, (name for name, _ in where or ()))
            read = reader.read(
                partial(_from_latex, notation=notation), reader.string(latex, f"latex of {what}")
            )
            (*others, expression), lines = read or ((None,), ())
            where = None if where is None else (*where, *lines)
        scale = table.get("scale")
        scaled = reader.expression(scale.value, f"scale of {what}", quantities=False) if scale else None
        cited = reader.plain(table, "source", what)
        if expression is not None and where is not None and (scaled is not None or not scale):
            meant = (entry.key_span, latex is not None, tuple(others))
            published.append(Published(tf, expression, where, scaled, cited, *meant))
    return tuple(published)


def _from_latex(text: Text, notation: PaperNotation) -> tuple[tuple[Expression, ...], NamedExpressions]:
    from symflex.papers.formula import read_latex  # few specifications hold LaTeX

    return read_latex(text, notation)


CANDIDATES = 4  # parameters that a symbol without a meaning could be, as a hint lists them


def with_candidates(problems: Sequence[Diagnostic], published: Published, model: Model) -> list[Diagnostic]:
    """Return problems of a formula in LaTeX; with what a symbol without a meaning could be."""
    from symflex.model.units import constant_measure  # most formulas are right

    expressions = [published.expression, *(e for _, e in published.where)]
    measure = constant_measure([], model.parameters, model.definitions)
    used = {n.name for e in expressions for n in names(e) if isinstance(n, Name)}

    def disagreeing(name: str, other: ModelParameter) -> int:
        sums = {
            n
            for e in expressions
            for n in nodes(substitute(e, {name: Name(other.name)}))
            if isinstance(n, Sum)
        }
        terms = ([measure(term) for term in part.terms] for part in sums)
        return sum(len({d for d in dimensions if d is not None}) > 1 for dimensions in terms)

    found: list[Diagnostic] = []
    for problem in problems:
        node = next(
            (n for e in expressions for n in names(e) if n.span == problem.span and isinstance(n, Name)), None
        )
        if problem.code != "SF210" or problem.span is None or node is None:
            found.append(problem)
            continue
        counts = {p: disagreeing(node.name, p) for p in model.parameters}
        least = min(counts.values(), default=0)
        # Where every parameter fits alike, the place says nothing.
        tells = any(count > least for count in counts.values())
        fitting = [p for p in counts if tells and counts[p] == least and p.name not in used]
        listed = ", ".join(f"{p.name} [{p.unit or 1}]" for p in fitting[:CANDIDATES])
        could = f"; by its place it could be {listed}" if listed else ""
        hint = f"tie it in [notation]: '{problem.span.text[:40]}' = \"...\"{could}; or define it in 'where'"
        found.append(replace(problem, hint=hint))
    return found


def _where(reader: Reader, table: TableValue, what: str, key: str = "where") -> NamedExpressions | None:
    """Return the lines, ``None`` when one cannot be read."""
    entry = table.get(key)
    inner = reader.table(entry, f"{key} of {what}") if entry else None

    def read(item: KeyValue) -> tuple[str, Expression] | None:
        expression = reader.expression(item.value, f"'{item.key}' of {what}", quantities=False)
        return None if expression is None else (item.key, expression)

    lines = reader.entries(inner, "an abbreviation", read, RESERVED)
    is_whole = len(lines) == len(inner.entries if inner else ()) and (inner or not entry)
    return lines if is_whole else None


NUMBERS = Line({}, frozenset(), frozenset(), {})  # knows the value of numbers alone


def in_own_names(analysis: Analysis) -> Published:
    """Return the names in which formulas are printed as lines of a formula, which are read alike."""
    lines = analysis.print
    return Published(
        ("", ""), sum_of([Name(n, span=e.span) for n, e in lines]), lines, sum_of(analysis.prefer)
    )


@dataclass(frozen=True, slots=True)
class Readable:
    """What the names of a model mean in its printed formulas."""

    constants: frozenset[str]  # ``s``, ``pi`` and parameters
    definitions: Mapping[str, Expression]  # the model's, which a ``where`` line of the same name hides
    varying: Mapping[str, str]  # what may not stand there, in words: nodes, blocks, signals, outputs, inputs
    broken: frozenset[str]  # names whose declaration holds a mistake of its own; nothing is said about them


def readable_names(model: Model, broken: Collection[str] = ()) -> Readable:
    """Return what the names of a model mean in its printed formulas."""
    kinds = (
        (model.nodes, "a node"),
        (model.blocks, "a block"),
        (model.signals, "a signal"),
        (model.outputs, "an output"),
        (model.inputs, "an input"),
    )
    return Readable(
        frozenset(p.name for p in model.parameters) | {LAPLACE, "pi"},
        {d.name: d.expression for d in model.definitions},
        {item.name: what for group, what in kinds for item in group},
        frozenset(broken),
    )


def check_printed(published: Published, readable: Readable) -> list[Diagnostic]:
    """Return everything wrong with the names and exponents of a printed formula."""
    meanings = {**readable.definitions, **dict(published.where)}
    roots = [published.expression, *([published.scale] if published.scale is not None else [])]
    problems: list[Diagnostic] = []
    for expression in (*roots, *(e for _, e in published.where)):
        problems += _name_problems(expression, meanings, readable)
        for part in nodes(expression):
            if isinstance(part, Power) and (names(part.exponent) or NUMBERS.value(part.exponent) is None):
                message = "an exponent in a printed formula is a rational number"
                problems.append(Diagnostic("SF225", message, part.exponent.span or part.span))
    _, circle = lines_in_order(roots, meanings) if not problems else ([], [])
    if circle:
        message = f"lines of a printed formula refer to each other in a circle: {' -> '.join(circle)}"
        problems.append(Diagnostic("SF215", message, meanings[circle[-1]].span))
    return problems


def _name_problems(
    expression: Expression, known: Collection[str], readable: Readable
) -> Iterator[Diagnostic]:
    for node in names(expression):
        if isinstance(node, Attribute | Derivative) or (isinstance(node, Call) and node.order):
            message = "a printed formula may use only s, pi, parameters, definitions and names from 'where'"
            yield Diagnostic("SF212", message, node.span)
        elif node.name in readable.broken:
            continue
        elif isinstance(node, Call) and node.name not in FUNCTIONS:
            hint = nearest(node.name, FUNCTIONS) or "a product needs '*'"
            yield Diagnostic("SF210", f"unknown function '{node.name[:64]}'", node.span, hint)
        elif isinstance(node, Name) and node.name not in known and node.name not in readable.constants:
            yield _unknown(node, known, readable)


def _unknown(node: Name, known: Collection[str], readable: Readable) -> Diagnostic:
    described = readable.varying.get(node.name)
    if described is not None:
        message = f"'{node.name}' is {described}; a printed formula contains only s and constants"
        hint = "define it in 'where' if the formula means something else"
        return Diagnostic("SF212", message, node.span, hint)
    close = nearest(node.name, {*known, *readable.constants})
    hint = f"{close} else define it in 'where'" if close else "define it in 'where'"
    if not close and node.name in IMAGINARY_NAMES:
        hint = "define it in 'where'; if it is the imaginary unit, write s for j*omega and -s^2 for omega^2"
    return Diagnostic("SF210", f"unknown name '{node.name[:64]}' in a printed formula", node.span, hint)


def lines_in_order(
    roots: Sequence[Expression], known: Mapping[str, Expression]
) -> tuple[list[str], list[str]]:
    """Return the lines that occur, each after those it uses, and the first circle of lines if any."""
    done: dict[str, None] = {}
    followed: list[str] = []
    pending = [(name, False) for root in reversed(roots) for name in reversed(names_among(root, known))]
    while pending:
        name, is_left = pending.pop()
        if is_left:
            done[followed.pop()] = None
        elif name in followed:
            return list(done), [*followed[followed.index(name) :], name]
        elif name not in done:
            followed.append(name)
            pending.append((name, True))
            pending += [(other, False) for other in reversed(names_among(known[name], known))]
    return list(done), []

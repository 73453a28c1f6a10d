"""The model as it was given, its transfer functions in closed form, and what a publication printed."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from itertools import starmap
from typing import Final

from symflex.audit import Audit
from symflex.audit.text import VERDICTS, audit_document
from symflex.errors import counted
from symflex.expressions import Attribute, Expression, Name, format_expression, nodes
from symflex.print.forms import PrintedForm, counts_of, with_hidden
from symflex.print.json_format import derive_document
from symflex.print.label import labels_of
from symflex.print.latex import (
    TEXT_WIDTH_MM,
    form_labels,
    formula_latex,
    model_labels,
    parameter_table,
    ratio_latex,
    transfer_function_latex,
)
from symflex.print.latex.table import decimal_text
from symflex.print.mathml import (
    WIDEST_FRACTION,
    MathmlWriter,
    MathRow,
    label_mathml,
    ratio_mathml,
    transfer_function_mathml,
)
from symflex.print.motion import solved_values
from symflex.print.text import shown
from symflex.report.document import (
    Badge,
    Block,
    Cell,
    ChapterPart,
    Code,
    DisplayedFormula,
    Listing,
    Mathematics,
    Notice,
    Run,
    Section,
    Table,
    Tone,
    columns,
    exponents,
    filled,
    labelled,
    marked,
    mathematics,
    parted,
    text,
    unit_text,
)
from symflex.report.study import MOST_FUNCTIONS, Study
from symflex.transfer import AnyTransferFunction


def specification_section(study: Study) -> ChapterPart:
    """Return the specification as it was read, with its checksum."""
    content = study.text.encode()
    checksum = hashlib.sha256(content).hexdigest()
    name = f"data/{study.stem}.toml"
    listing = Listing(f"Specification {study.stem}.toml", study.text)
    return ChapterPart("", (listing, text("SHA-256: ", Code(checksum))), {name: content})


def parameter_section(study: Study) -> ChapterPart | None:
    """Return the table of parameters: symbol, value in the unit it was given in, meaning."""
    model = study.model
    if not model.settable:
        return None
    labels = model_labels(model)
    rows: list[tuple[Cell, ...]] = []
    for p in model.settable:
        symbol = Mathematics(label_mathml(p.name, labels), labels[p.name])
        exact, unit = p.as_written()
        value = "symbolic" if exact is None else exponents(decimal_text(exact))
        rows.append(((symbol,), (Code(p.name),), (value,), (unit_text(unit),), (p.doc,)))
    heads = columns(("Symbol", "plain"), ("Name", "plain"), ("Value", "number"), ("Unit", "plain"), "Meaning")
    return ChapterPart("Parameters", (filled(heads, rows, parameter_table(model)),))


LONGEST_LATEX: Final = 60_000


def motion_section(study: Study) -> ChapterPart | None:
    """Return the equilibrium values and linear equations of a nonlinear model: all else follows from them."""
    point = study.model.operating_point
    if point is None:
        return None
    labels = model_labels(study.model)

    def shown(left: Expression, right: Expression, primes: str = "") -> tuple[Run, ...]:
        if any(isinstance(n, Attribute) for side in (left, right) for n in nodes(side)):
            return (Code(f"{format_expression(left)} = {format_expression(right)}"),)
        return (labelled(left, labels), f"{primes} = ", labelled(right, labels))

    runs = list[Run]()
    for name, value in point.values:
        still = name.rstrip("'")
        begins = ", " if runs else "At equilibrium, "
        runs += [begins, *shown(Name(still), value, "′" * (len(name) - len(still)))]
    blocks = [text(*runs, ". The names below stand for deviations from equilibrium:")] if runs else []
    solved = list[Run]()
    for name, shown_value in solved_values(study.model):
        solved += [
            ", " if solved else "Solved at equilibrium: ",
            labelled(Name(name), labels),
            f" = {shown_value}",
        ]
    blocks = [text(*solved, "."), *blocks] if solved else blocks
    return ChapterPart("Linear equations", (*blocks, *(text(*shown(e.left, e.right)) for e in point.linear)))


def equation_section(study: Study) -> ChapterPart:
    """Return every transfer function in its default form, with what cancelled from it."""
    blocks: list[Block] = []
    left_out = len(study.model.transfer_functions) - len(study.pairs)
    if left_out:
        many = f"{left_out} of {left_out + len(study.pairs)} transfer functions"
        blocks.append(Notice(f"{many} are left out: a report shows the first {MOST_FUNCTIONS}."))
    if study.why_nested:
        blocks.append(text(f"Shown {study.why_nested}."))
    sections = [
        Section(tf.name, displayed(tf, form, f"eq:{study.stem}:{i}"), f"{study.stem}-tf-{i}", ratio(tf))
        for i, (tf, form) in enumerate(zip(study.tfs, study.forms, strict=True), start=1)
    ]
    blocks += parted(sections)
    document = derive_document(list(zip(study.tfs, study.forms, strict=True)))
    data = json.dumps(document, indent=1, ensure_ascii=True).encode()
    return ChapterPart("Transfer functions", tuple(blocks), {f"data/{study.stem}_derive.json": data})


def ratio(tf: AnyTransferFunction) -> Mathematics:
    """Return output over input in one line."""
    above, below = ratio_mathml(tf).removeprefix("<mfrac>").removesuffix("</mfrac>").split("</mrow><mrow>", 1)
    return Mathematics(f"{above}</mrow><mo>/</mo><mrow>{below}", ratio_latex(tf))


def displayed(tf: AnyTransferFunction, form: PrintedForm, label: str) -> tuple[Block, ...]:
    """Return a transfer function in a form, what it is, and what cancelled."""
    form, hidden = with_hidden(tf, form)
    rows = transfer_function_mathml(tf, form)
    latex = transfer_function_latex(tf, form, width_mm=TEXT_WIDTH_MM, label=label)
    blocks: list[Block] = [text(_introduction(tf), " Form: ", Code(form.name), ".")]
    if tf.is_zero:
        return (text("Identically zero: the input does not reach the output."),)
    if rows is None or len(latex) > LONGEST_LATEX:
        blocks.append(Notice("The closed form is too long for a page; it is in the folder data."))
    else:
        blocks.append(DisplayedFormula(rows, latex, f"{tf.name} in closed form"))
    labels = form_labels(tf, form)
    for expression, multiplicity in hidden:
        times = "" if multiplicity == 1 else f" ({multiplicity} times)"
        why = "its modes are uncontrollable from this input or unobservable in this output."
        blocks.append(text("Hidden: the factor ", labelled(expression, labels), f" cancels{times}; {why}"))
    return tuple(blocks)


def _introduction(tf: AnyTransferFunction) -> str:
    unit = f" in {unit_text(tf.unit)}" if unit_text(tf.unit) else ""
    if not tf.is_reduced:
        return f"{tf.quantity.capitalize()}{unit}."
    pairs = zip(counts_of(tf), ("zero", "pole"), strict=True)
    counts = ", ".join(f"infinitely many {noun}s" if n is None else counted(n, noun) for n, noun in pairs)
    return f"{tf.quantity.capitalize()}{unit}; {counts}."


JUDGED: Final[Mapping[str, tuple[str, Tone]]] = {
    "equal": ("right as printed (proved)", "good"),
    "rounded": ("right to the digits that it prints (proved)", "good"),
    "differs": ("not right as printed (proved)", "bad"),
    "agrees": ("agrees at all points tried (not proved)", "fair"),
    "undecided": ("not decided", "fair"),
}


def audit_section(study: Study) -> ChapterPart | None:
    """Return every printed formula with its verdict, and the smallest change that makes a wrong one right."""
    if not study.audits:
        return None
    sections = [
        Section(audit.tf.name, _audited(audit), f"{study.stem}-printed-{i + 1}", ratio(audit.tf))
        for i, audit in enumerate(study.audits)
    ]
    data = json.dumps(audit_document(study.audits), indent=1, ensure_ascii=True).encode()
    return ChapterPart("Printed formulas", parted(sections), {f"data/{study.stem}_audit.json": data})


def _audited(audit: Audit) -> tuple[Block, ...]:
    word, tone = JUDGED[audit.verdict]
    source = f"Printed in {audit.published.source}" if audit.published.source else ""
    blocks: list[Block] = [marked(Badge(word, tone), source)]
    where = audit.formula.lines
    scale = audit.published.scale
    blocks.append(_formula(audit, audit.published.expression, where, f"{audit.tf.name} as printed"))
    if scale is not None:
        blocks.append(text("times ", mathematics(scale, audit.tf.model), ", a scale that is not printed."))
    if audit.verdict in ("equal", "rounded"):
        return tuple(blocks)
    if audit.verdict != "differs":
        blocks.append(text(f"The formula {VERDICTS[audit.verdict]}."))
    if audit.ratio is not None:
        blocks.append(
            text("It is the derived function times ", mathematics(audit.ratio, audit.tf.model), ".")
        )
    if audit.taken:
        blocks.append(text(f"It is right where {audit.taken} (proved)."))
    if audit.correction is not None:
        blocks.append(text("Corrected, in the same symbols:"))
        lines = audit.correction.lines if audit.correction.lines != where else ()
        blocks.append(_formula(audit, audit.correction.expression, lines, f"{audit.tf.name}, corrected"))
    if audit.changes:
        labels = _labels(audit)
        parts = [(c.place, labelled(c.printed, labels), labelled(c.derived, labels)) for c in audit.changes]
        rows = tuple(((location,), (printed,), (derived,)) for location, printed, derived in parts)
        blocks.append(Table(columns("Where", "Printed", "Right"), rows, "What differs"))
    deviation = audit.deviation
    if deviation is not None:
        low, high = (f"{float(f):g}" for f in deviation.band)
        size = "grows without bound" if deviation.unbounded else f"is {deviation.magnitude_db:+.4g} dB"
        magnitude = f"of the magnitude from {low} to {high} Hz {size} at {deviation.magnitude_hz:.4g} Hz"
        phase = f"of the phase is {deviation.phase_deg:+.4g}° at {deviation.phase_hz:.4g} Hz"
        blocks.append(text(f"The largest deviation {magnitude}; that {phase} (measured)."))
    if audit.laws:
        marks = {True: Badge("kept", "good"), False: Badge("violated", "bad")}
        laws = tuple(((x.law,), (marks[x.kept],), (f"{x.detail} ({x.how})",)) for x in audit.laws)
        blocks.append(Table(columns(("Law", "plain"), ("", "plain"), "Why"), laws, "Structural laws"))
    return tuple(blocks)


def _labels(audit: Audit) -> dict[str, str]:
    labels = model_labels(audit.tf.model)
    return labels_of([(name, "") for name, _ in audit.formula.lines if name not in labels], labels)


def _formula(
    audit: Audit, expression: Expression, where: Sequence[tuple[str, Expression]], name: str
) -> DisplayedFormula:
    left_side = Mathematics(ratio_mathml(audit.tf), ratio_latex(audit.tf))
    return equations([(left_side, expression)], _labels(audit), name, where)


def equations(
    sides: Sequence[tuple[Mathematics, Expression]],
    labels: Mapping[str, str],
    name: str,
    where: Sequence[tuple[str, Expression]] = (),
) -> DisplayedFormula:
    """Return equations below each other, and definitions of names in them."""
    writer = MathmlWriter(labels)

    def pieces(expression: Expression) -> tuple[str, ...]:
        is_narrow = writer.width(expression) <= WIDEST_FRACTION
        return (writer.piece(expression).markup,) if is_narrow else writer.pieces(expression)

    rows = [MathRow(left_side.mathml, pieces(e)) for left_side, e in sides]
    both = starmap(shown, where)
    rows += [MathRow(writer.piece(left).markup, writer.pieces(e), is_where=True) for left, e in both]
    latex = formula_latex(
        [(left_side.latex, e) for left_side, e in sides], where, labels, width_mm=TEXT_WIDTH_MM
    )
    return DisplayedFormula(tuple(rows), latex, name)

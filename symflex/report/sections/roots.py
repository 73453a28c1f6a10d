"""Poles and zeros, stable gains of loops and dynamic colocation, with what is proved about them."""

from __future__ import annotations

import json
from math import tau
from typing import Final

from flint import arb

from symflex.analysis.explanation import ZeroExplanation, explanation_paragraphs
from symflex.errors import SymflexError, UncertifiedError
from symflex.loops import DynamicColocation, StabilityMap
from symflex.loops.stability_map import crossover_text
from symflex.model.loss_factors import has_loss_factors
from symflex.print.html import DIGITS
from symflex.print.latex import root_table
from symflex.print.roots import KINDS, PAGE_COLUMNS, columns_for, one_of_each_pair, region_text, roots_of
from symflex.report.document import (
    Badge,
    Block,
    Cell,
    ChapterPart,
    Code,
    Notice,
    Section,
    Table,
    Tone,
    as_printed,
    code_of,
    columns,
    exponents,
    marked,
    parted,
    sentence,
    text,
)
from symflex.report.sections.formulas import ratio
from symflex.report.study import Study, attempt, said
from symflex.roots import PoleZeroMap
from symflex.roots.pole_zero_map import StabilityVerdict
from symflex.roots.root import degrees, figure

LONGEST: Final = 80
LEFT_OUT: Final = (
    "Loss factors describe harmonic motion, s = j*omega with omega > 0. The report lists the roots above the "
    "real axis. It has no mode shapes, responses in time, stability, state equations, or code in languages "
    "other than Python."
)
SAMPLED: Final = (
    "The report takes the controller as sampled. It has no transfer functions, figures or code, which "
    "belong to continuous models."
)
COMPLEX: Final = (
    "Coefficients are complex. The report lists all poles and zeros, in both half-planes. It has no mode "
    "shapes, responses in time, state equations, or code in languages other than Python."
)


def root_section(study: Study) -> ChapterPart:
    """Return the poles and zeros of every transfer function, enclosed, and what its zeros mean."""
    explained = {each.tf: meaning for _, each, meaning in study.located}
    reasons = {each.tf: reason for _, each, reason in study.unexplained}
    derived = attempt(lambda: study.tfs)
    tfs = {} if isinstance(derived, SymflexError) else {tf.name: tf for tf in derived}
    blocks: list[Block] = []
    if study.model.imaginary:
        blocks.append(text(LEFT_OUT if has_loss_factors(study.model) else COMPLEX))
    warnings = []
    sections: list[Section] = []
    for i, each in enumerate(study.maps):
        tf = tfs.get(each.tf)
        content = _of(each, explained.get(each.tf))
        if each.tf in reasons:
            content = (*content, text(f"What the zeros mean is not examined: {reasons[each.tf]}."))
        sections.append(Section(each.tf, content, f"{study.stem}-roots-{i + 1}", ratio(tf) if tf else None))
        if not each.certificate.certified:
            warnings.append(f"{study.stem}: poles and zeros of {each.tf} are not certified")
    code = 0
    for name, error in study.without_map:
        sections.append(Section(name, (Notice(said(error)),), f"{study.stem}-roots-{len(sections) + 1}"))
        warnings.append(f"{study.stem}: no poles and zeros of {name}: {said(error)}")
        code = max(code, code_of(error))
    blocks += parted(sections)
    document = {"schema": "symflex.report-roots/1", "roots": [each.to_json_dict() for each in study.maps]}
    data = {f"data/{study.stem}_roots.json": json.dumps(document, indent=1).encode()}
    title = "Poles and zeros" if blocks else ""
    return ChapterPart(title, tuple(blocks), data, tuple(warnings), code)


def sampled_section(study: Study) -> ChapterPart | None:
    """Return the poles in z of a loop that a sampled controller closes."""
    if study.model.sampled is None:
        return None
    from symflex.analysis.sampled_loop import sampled_poles  # few models have one

    found = sampled_poles(study.model)
    badge = Badge("certified", "good") if found.certified else Badge("not certified", "bad")
    _, *tables = found.passages()
    verdict = marked(badge, f"{found.counted}: {found.sentence}")
    blocks = (verdict, text(f"{found.sampled}."), *as_printed(tables), text(SAMPLED))
    data = {f"data/{study.stem}_poles.json": json.dumps(found.to_json_dict(), indent=1).encode()}
    code = 0 if found.certified else UncertifiedError.exit_code
    return ChapterPart("The sampled loop", blocks, data, (), code)


def _of(located: PoleZeroMap, meaning: ZeroExplanation | None) -> tuple[Block, ...]:
    certificate = located.certificate
    if certificate.certified:
        mark = Badge("certified", "good")
        said = f"{certificate.found} of {certificate.counted} roots enclosed, each within its radius [rad/s]."
    else:
        mark, said = Badge("not certified", "bad"), f"{certificate.reason or 'no reason given'}."
    shown = f" Listed: {region_text(located.region)}" if region_text(located.region) else ""
    blocks: list[Block] = [_stability(located.verdict), marked(mark, said + shown)]
    for part in located.excluded:
        disc = f"{part.radius:.3g} rad/s about {part.re:g} ± {part.im:g} j"
        blocks.append(text(f"Left out: {disc}, where roots accumulate."))
    for kind, title in KINDS.items():
        roots = roots_of(located, kind)
        entries = one_of_each_pair(roots)
        if entries:
            shown_columns = columns_for(PAGE_COLUMNS, roots)
            cells = (entry.cells(shown_columns, DIGITS, "±") for entry in entries[:LONGEST])
            rows = tuple(tuple((exponents(cell),) for cell in row) for row in cells)
            heads = columns(*((column.head, "number") for column in shown_columns))
            count = sum(r.multiplicity for r in roots)
            cut = f" ({LONGEST} of {len(entries)} lines)" if len(entries) > LONGEST else ""
            blocks.append(Table(heads, rows, f"{title}: {count}{cut}", root_table(located, kind)))
        elif kind != "hidden":
            blocks.append(text(f"{title}: none."))
    if meaning is not None:
        blocks += [text(*lines) for lines in _paragraphs(meaning)]
    return tuple(blocks)


def _stability(verdict: StabilityVerdict, more: str = "") -> Block:
    """Return what is said of stability, with its badge, and the motion that nothing sees."""
    said = f"{verdict.sentence.removeprefix(verdict.brief)}{more}."
    motion = verdict.hidden_motion
    return marked(stability_mark(verdict.brief), f"{said} {sentence(motion)}" if motion else said)


def stability_mark(word: str) -> Badge:
    """Return the badge of a verdict: green for what is proved to be stable alone."""
    tones: dict[str, Tone] = {"stable": "good", "unstable": "bad"}
    return Badge(word, tones.get(word, "fair"))


def _paragraphs(meaning: ZeroExplanation) -> list[tuple[str, ...]]:
    """Return what the zeros mean, a paragraph as its lines; what concerns the command line is left out."""
    kept = (p for p in explanation_paragraphs(meaning) if not p[0].startswith("To see that system"))
    shown = ([line.replace("+-", "±").replace("*", "·") for line in paragraph] for paragraph in kept)
    return [tuple(x for line in lines for x in (line, "\n"))[:-1] for lines in shown]


LOOP_HEADS: Final = columns(
    ("From", "number"), ("to", "number"), ("right half-plane", "number"), ("on the axis", "number"), "Loop"
)


def loop_section(study: Study) -> ChapterPart | None:
    """Return the stable gains of the loops that figures name, and up to where outputs move together."""
    blocks: list[Block] = []
    documents = []
    warnings = []
    code = 0
    for i, loop in enumerate(study.loops):
        if isinstance(loop, SymflexError):
            blocks.append(Notice(loop.diagnostics[0].message))
            warnings.append(f"{study.stem}, loops: {loop.diagnostics[0].message}")
            code = max(code, code_of(loop))
            continue
        blocks.append(Section(f"Gain {loop.gain}", _gains(loop), f"{study.stem}-loop-{i + 1}"))
        documents.append(loop.to_json_dict())
        if not loop.certified:
            warnings.append(f"{study.stem}: the loop with the gain {loop.gain} is not certified")
            code = max(code, UncertifiedError.exit_code)
    for band in study.colocations:
        blocks.append(_together(band))
        if not band.is_decided:
            warnings.append(f"{study.stem}: how far {band.tf} moves with {band.reference} is not certified")
            code = max(code, UncertifiedError.exit_code)
    if not blocks:
        return None
    documents += [loop.to_json_dict() for loop in study.colocations]
    content = {"schema": "symflex.report-loops/1", "loops": documents}
    data = {f"data/{study.stem}_loops.json": json.dumps(content, indent=1).encode()}
    title = "Loops" if study.loops else "Dynamic colocation"
    return ChapterPart(title, tuple(blocks), data, tuple(warnings), code)


def _gains(loop: StabilityMap) -> tuple[Block, ...]:
    loop = loop.shown
    opening = marked(Badge("not certified", "bad"), "; ".join(loop.reasons))
    if loop.certified:
        opening = marked(Badge("certified", "good"), "All poles in the right half-plane are counted.")
    blocks: list[Block] = []
    if loop.nominal is not None:
        blocks.append(_stability(loop.verdict, f", with {loop.gain} = {float(loop.nominal):g}"))
    blocks.append(opening)
    rows: list[tuple[Cell, ...]] = []
    for interval in loop.intervals:
        mark = stability_mark(interval.poles.word)
        low, high = ("no end" if end is None else decimal(end) for end in (interval.low, interval.high))
        rows.append(((low,), (high,), (str(interval.poles.right),), (str(interval.poles.axis),), (mark,)))
    unit = f" [{loop.unit}]" if loop.unit else ""
    title = f"Closed-loop poles by the gain {loop.gain}{unit}"
    blocks.append(Table(LOOP_HEADS, tuple(rows), title))
    ends = [(b.gain, [f"{decimal(w / tau)} Hz" for w in b.frequencies]) for b in loop.boundaries]
    places = [f"{loop.gain} = {decimal(gain)} at {', '.join(hertz)}" for gain, hertz in ends if hertz]
    if places:
        blocks.append(text(f"Poles are on the axis for {'; '.join(places)}."))
    margins = [f"gain margin {decimal(m.factor)}" for m in loop.gain_margins]
    if loop.phase_margin is not None:
        margins.append(f"phase margin {decimal(degrees(loop.phase_margin.angle))} degrees")
    if margins and loop.nominal is not None:
        blocks.append(text(f"With {loop.gain} = {float(loop.nominal):g}: {', '.join(margins)}."))
    if loop.crossover is not None:
        shown = crossover_text(loop.gain, loop.crossover)
        blocks.append(text(f"Gain crossover with a gain margin of 6 dB: {shown}."))
    return tuple(blocks)


def _together(colocation: DynamicColocation) -> Block:
    within = f" within {colocation.phase:g} degrees and {colocation.magnitude:g} dB"
    pair = (Code(colocation.tf), " and ", Code(colocation.reference))
    status = () if colocation.is_decided else (" ", Badge("not certified", "bad"))
    if not colocation.begins:
        return text(*pair, f" do not move together{within} at {colocation.limits[0]:g} Hz.", *status)
    if colocation.edge is None:
        return text(*pair, f" move together{within} up to {colocation.limits[1]:g} Hz, the end of the band.")
    edge = decimal(colocation.edge / tau)
    return text(*pair, f" move together{within} up to {edge} Hz, where {colocation.parting}.", *status)


def decimal(value: arb) -> str:
    """Return an enclosure with at most ten digits."""
    return figure(value, DIGITS, trimmed=True)

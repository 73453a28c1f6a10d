"""Stable gains of feedback loops, with what is proved about them, and dynamic colocation."""

from __future__ import annotations

import json
from math import tau
from typing import TYPE_CHECKING, Final

from symflex.errors import SymflexError, UncertifiedError
from symflex.loops import degrees
from symflex.loops.text import bandwidth_text, nominal_text
from symflex.report.document import Badge, Code, Notice, Section, Table, columns, text
from symflex.report.part import ChapterPart, code_of
from symflex.report.sections.roots import stability_mark

if TYPE_CHECKING:
    from flint import arb

    from symflex.loops import DynamicColocation, StabilityMap
    from symflex.report.document import Block, Cell
    from symflex.report.study import Study

DIGITS: Final = 10
HEADS: Final = columns(
    ("From", "number"), ("to", "number"), ("right of the axis", "number"), ("on the axis", "number"), "Loop"
)


def loop_section(study: Study) -> ChapterPart | None:
    """Return the stable gains of the loops that figures name, and up to where outputs move together."""
    blocks: list[Block] = []
    documents = []
    warnings = []
    code = 0
    for i, found in enumerate(study.loops):
        if isinstance(found, SymflexError):
            blocks.append(Notice(found.diagnostics[0].message))
            warnings.append(f"{study.stem}, loops: {found.diagnostics[0].message}")
            code = max(code, code_of(found))
            continue
        blocks.append(Section(f"Gain {found.gain}", _of(found), f"{study.stem}-loop-{i + 1}"))
        documents.append(found.to_json_dict())
        if not found.certified:
            warnings.append(f"{study.stem}: the loop with the gain {found.gain} is not certified")
            code = max(code, UncertifiedError.exit_code)
    for band in study.colocations:
        blocks.append(_together(band))
        if not band.is_decided:
            warnings.append(f"{study.stem}: how far {band.tf} moves with {band.reference} is not certified")
            code = max(code, UncertifiedError.exit_code)
    if not blocks:
        return None
    documents += [found.to_json_dict() for found in study.colocations]
    content = {"schema": "symflex.report-loops/1", "loops": documents}
    data = {f"data/{study.stem}_loops.json": json.dumps(content, indent=1).encode()}
    title = "Loops" if study.loops else "Dynamic colocation"
    return ChapterPart(title, tuple(blocks), data, tuple(warnings), code)


def _of(found: StabilityMap) -> tuple[Block, ...]:
    if found.certified:
        opening = text(Badge("certified", "good"), ": all poles right of the imaginary axis are counted.")
    else:
        opening = text(Badge("not certified", "bad"), f": {'; '.join(found.reasons)}.")
    blocks: list[Block] = []
    if found.nominal is not None:
        word = "unknown" if found.is_stable is None else "stable" if found.is_stable else "unstable"
        said = nominal_text(found).removeprefix(word)
        blocks.append(text(stability_mark(word), f"{said}, with {found.gain} = {float(found.nominal):g}."))
    blocks.append(opening)
    rows: list[tuple[Cell, ...]] = []
    for interval in found.intervals:
        stable = Badge("stable", "good") if interval.poles.is_stable else Badge("unstable", "bad")
        low, high = ("no end" if end is None else decimal(end) for end in (interval.low, interval.high))
        rows.append(((low,), (high,), (str(interval.poles.right),), (str(interval.poles.axis),), (stable,)))
    unit = f" [{found.unit}]" if found.unit else ""
    title = f"Closed-loop poles by the gain {found.gain}{unit}"
    blocks.append(Table(HEADS, tuple(rows), title))
    places = [
        f"{found.gain} = {decimal(b.gain)} at {', '.join(f'{decimal(w / tau)} Hz' for w in b.frequencies)}"
        for b in found.boundaries
        if b.frequencies
    ]
    if places:
        blocks.append(text(f"Poles are on the axis for {'; '.join(places)}."))
    margins = [f"gain margin {decimal(m.factor)}" for m in found.gain_margins]
    if found.phase_margin is not None:
        margins.append(f"phase margin {decimal(degrees(found.phase_margin.angle))} degrees")
    if margins and found.nominal is not None:
        blocks.append(text(f"With {found.gain} = {float(found.nominal):g}: {', '.join(margins)}."))
    if found.bandwidth is not None:
        shown = bandwidth_text(found.gain, found.bandwidth)
        blocks.append(text(f"Bandwidth, where the gain may still double (6 dB): {shown}."))
    return tuple(blocks)


def _together(found: DynamicColocation) -> Block:
    within = f" within {found.phase:g} degrees and {found.magnitude:g} dB"
    pair = (Code(found.tf), " and ", Code(found.reference))
    status = () if found.is_decided else (" ", Badge("not certified", "bad"))
    if not found.begins:
        return text(*pair, f" are not together{within} at {found.limits[0]:g} Hz.", *status)
    if found.edge is None:
        return text(*pair, f" stay together{within} up to {found.limits[1]:g} Hz, the end of the band.")
    edge = decimal(found.edge / tau)
    return text(*pair, f" stay together{within} up to {edge} Hz, where {found.parting}.", *status)


def decimal(value: arb) -> str:
    """Return the middle of an enclosure with ten digits.

    Examples
    --------
    >>> from flint import arb
    >>> decimal(arb(1) / 3)
    '0.3333333333'
    """
    return f"{float(value.mid()):.{DIGITS}g}"

"""Poles and zeros, with what is proved about them."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Final

from symflex.analysis.explanation import explanation_paragraphs
from symflex.errors import SymflexError
from symflex.print.latex import ratio_latex, root_table
from symflex.print.roots import KINDS, PAGE_COLUMNS, one_of_each_pair, region_text, roots_of
from symflex.report.document import Badge, Mathematics, Notice, Section, Table, columns, exponents, text
from symflex.report.part import ChapterPart, code_of
from symflex.report.sections.equations import ratio_line
from symflex.report.study import attempt, said

if TYPE_CHECKING:
    from symflex.analysis.explanation import ZeroExplanation
    from symflex.print.roots import PrintedRoot
    from symflex.report.document import Block, Cell, Tone
    from symflex.report.study import Study
    from symflex.roots import PoleZeroMap

DIGITS: Final = 10
LONGEST: Final = 80
HEADS: Final = columns(*((column.head, "number") for column in PAGE_COLUMNS))


def root_section(study: Study) -> ChapterPart:
    """Return the poles and zeros of every transfer function, enclosed, and what its zeros mean."""
    explained = {found.tf: told for _, found, told in study.located}
    derived = attempt(lambda: study.tfs)
    tfs = {} if isinstance(derived, SymflexError) else {tf.name: tf for tf in derived}
    blocks = []
    warnings = []
    for i, found in enumerate(study.maps):
        tf = tfs.get(found.tf)
        title = Mathematics(ratio_line(tf), ratio_latex(tf)) if tf else None
        content = _of(found, explained.get(found.tf))
        blocks.append(Section(found.tf, content, f"{study.stem}-roots-{i + 1}", title))
        if not found.certificate.certified:
            warnings.append(f"{study.stem}: poles and zeros of {found.tf} are not certified")
    code = 0
    for name, error in study.without_map:
        blocks.append(Section(name, (Notice(said(error)),), f"{study.stem}-roots-{len(blocks) + 1}"))
        warnings.append(f"{study.stem}: no poles and zeros of {name}: {said(error)}")
        code = max(code, code_of(error))
    document = {"schema": "symflex.report-roots/1", "roots": [found.to_json_dict() for found in study.maps]}
    data = {f"data/{study.stem}_roots.json": json.dumps(document, indent=1).encode()}
    return ChapterPart("Poles and zeros", tuple(blocks), data, tuple(warnings), code)


def _of(found: PoleZeroMap, told: ZeroExplanation | None) -> tuple[Block, ...]:
    certificate = found.certificate
    blocks: list[Block] = []
    if certificate.certified:
        mark = Badge("certified", "good")
        said = (
            f": {certificate.found} of {certificate.counted} roots enclosed, each within its radius [rad/s]."
        )
    else:
        mark, said = Badge("not certified", "bad"), f": {certificate.reason or 'no reason given'}."
    shown = f" Listed: {region_text(found.region)}." if region_text(found.region) else ""
    verdict = found.verdict
    blocks.append(text(stability_mark(verdict.word), f"{verdict.sentence.removeprefix(verdict.brief)}."))
    blocks.append(text(mark, said + shown))
    for part in found.excluded:
        blocks.append(
            text(
                f"Left out: {part.radius:.3g} rad/s about {part.re:g} ± {part.im:g} j, where roots "
                f"accumulate."
            )
        )
    for kind, noun in KINDS.items():
        roots = roots_of(found, kind)
        entries = one_of_each_pair(roots)
        title = {"poles": "Poles", "zeros": "Zeros", "hidden": "Hidden roots"}[kind]
        if entries:
            rows = tuple(map(_row, entries[:LONGEST]))
            count = sum(r.multiplicity for r in roots)
            cut = f" ({LONGEST} of {len(entries)} lines)" if len(entries) > LONGEST else ""
            blocks.append(Table(HEADS, rows, f"{title}: {count}{cut}", root_table(found, kind)))
        elif noun != "hidden root":
            blocks.append(text(f"{title}: none."))
    if told is not None:
        blocks += [text(*lines) for lines in _told(told)]
    return tuple(blocks)


def stability_mark(word: str) -> Badge:
    """Return the badge of a verdict: green for what is proved to be stable alone.

    Examples
    --------
    >>> [stability_mark(word).tone for word in ("stable", "marginal", "unstable", "unknown")]
    ['good', 'fair', 'bad', 'fair']
    """
    tones: dict[str, Tone] = {"stable": "good", "unstable": "bad"}
    return Badge("stability not known" if word == "unknown" else word, tones.get(word, "fair"))


def _told(told: ZeroExplanation) -> list[tuple[str, ...]]:
    """Return what the zeros mean, a paragraph as its lines; what concerns the command line is left out."""
    found = []
    for paragraph in explanation_paragraphs(told):
        if not paragraph[0].startswith("To see that system"):
            lines = (line.replace("+-", "±").replace("*", "·") for line in paragraph)
            found.append(tuple(x for line in lines for x in (line, "\n"))[:-1])
    return found


def _row(entry: PrintedRoot) -> tuple[Cell, ...]:
    return tuple((exponents(cell),) for cell in entry.cells(PAGE_COLUMNS, DIGITS, "±"))

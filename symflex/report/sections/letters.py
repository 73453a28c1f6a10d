"""What a person reads off the formulas of a model, in letters: roots, limits, groups without dimension."""

from __future__ import annotations

from functools import partial

from symflex.errors import SymflexError
from symflex.expressions import Expression, Name
from symflex.letters.frequency_equation import roots_in_letters
from symflex.letters.groups import dimensionless_of
from symflex.letters.limits import InLetters, limits_of
from symflex.letters.roots import FactorInLetters
from symflex.letters.short import approximation
from symflex.options import DeriveOptions
from symflex.print.latex.equation import model_labels
from symflex.report.document import Block, ChapterPart, Code, Run, Section, labelled, parted, text
from symflex.report.sections.formulas import displayed, ratio
from symflex.report.sections.roots import decimal
from symflex.report.study import Study, attempt
from symflex.transfer import AnyTransferFunction


def letter_section(study: Study) -> ChapterPart | None:
    """Return what can be said in letters of every transfer function, nothing of models without letters."""
    derived = attempt(lambda: [*zip(study.tfs, study.bounds, strict=True)])
    pairs = [] if isinstance(derived, SymflexError) else derived
    maps, labels, sections = {x.tf: x for x in study.maps}, model_labels(study.model), list[Section]()
    for i, (tf, bound) in enumerate(pairs, start=1):
        found = roots_in_letters(tf, bound, maps[tf.name]) if tf.name in maps else ()
        blocks = tuple(_factor(each, each.factor, labels) for each in found if each.factor)
        read = (_lines(each, labels) for each in (limits_of(tf), dimensionless_of(tf)) if each.rows)
        if blocks := (*blocks, *read, *_near(tf, f"eq:{study.stem}:near:{i}")):
            sections.append(Section(tf.name, blocks, f"{study.stem}-letters-{i}", ratio(tf)))
    return ChapterPart("In letters", tuple(parted(sections)), {}) if sections else None


def _lines(found: InLetters, labels: dict[str, str]) -> Block:
    """Return a paragraph: what is read off a formula."""
    runs: list[Run] = []
    for row in (*found.rows, *found.where):
        comment = f", {row.comment}; " if row.comment else "; "
        runs += [Code(row.name), f"{row.relation.strip()} ", labelled(row.expression, labels), comment]
    return text(*runs[:-1], str(runs[-1]).rstrip("; ") + ".")


def _near(tf: AnyTransferFunction, label: str) -> tuple[Block, ...]:
    """Return a shorter function or one that is rational, and what is proved of it."""
    given = DeriveOptions(short="1 %") if tf.is_reduced and tf.is_rational else DeriveOptions(order=2)
    near = attempt(partial(approximation, tf, given))
    proof = None if isinstance(near, SymflexError) else near[1].approximation
    if isinstance(near, SymflexError) or not proof or proof.is_whole:
        return ()
    return *displayed(*near, label), text("; ".join(proof.said), ".")


def _factor(factor: FactorInLetters, zero: Expression, labels: dict[str, str]) -> Block:
    """Return a paragraph: what the roots of a factor are, and under which conditions."""
    runs: list[Run] = [f"{factor.kind.capitalize()}: ", labelled(zero, labels), " = 0. "]
    for formula in factor.formulas:
        value = "" if formula.value is None else f" = {decimal(formula.value)} {formula.unit}".rstrip()
        runs += [
            labelled(Name(formula.name), labels),
            " = ",
            labelled(formula.expression, labels),
            f"{value}. ",
        ]
    return text(*runs, *(run for line in factor.more() for run in (Code(line), ". ")))

"""What a person reads off the formulas of a model, in symbols: roots, limits, dimensionless groups."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Final

from symflex.errors import SymflexError
from symflex.expressions import Expression, Name
from symflex.options import DeriveOptions
from symflex.print.latex.equation import model_labels
from symflex.report.document import (
    Block,
    ChapterPart,
    Code,
    Mathematics,
    Run,
    Section,
    labelled,
    parted,
    text,
    unit_text,
)
from symflex.report.sections.formulas import displayed, equations, ratio
from symflex.report.sections.roots import decimal
from symflex.report.study import Study, attempt
from symflex.symbolic.frequency_equation import symbolic_roots
from symflex.symbolic.groups import dimensionless_of
from symflex.symbolic.limits import CORNER, limits_of
from symflex.symbolic.roots import IF, SymbolicFactor
from symflex.symbolic.short import approximation
from symflex.transfer import AnyTransferFunction

NOTHING: Final = Mathematics("<mn>0</mn>", "0")
SCALE: Final = {"scale": "G_{0}"}
LIMITS: Final = {"G_infinity": r"G_{\infty}"}
LONGEST: Final = 100  # characters of a condition that a person reads; symflex chose the number, as the next
MOST_ROWS: Final = 12  # groups, with function and scale, that a person reads


def symbolic_section(study: Study) -> ChapterPart | None:
    """Return what can be said in symbols of every transfer function, nothing of models without letters."""
    derived = attempt(lambda: [*zip(study.tfs, study.bounds, strict=True)])
    pairs = [] if isinstance(derived, SymflexError) else derived
    maps, labels, sections = {x.tf: x for x in study.maps}, model_labels(study.model), list[Section]()
    for i, (tf, bound) in enumerate(pairs, start=1):
        found = symbolic_roots(tf, bound, maps[tf.name]) if tf.name in maps else ()
        said = [block for each in found for block in _factor(each, labels)]
        said += [block for read in (_limits, _groups) for block in read(tf, labels)]
        if blocks := (*said, *_near(tf, f"eq:{study.stem}:near:{i}")):
            sections.append(Section(tf.name, blocks, f"{study.stem}-letters-{i}", ratio(tf)))
    return ChapterPart("Symbolic answers", tuple(parted(sections)), {}) if sections else None


def _limits(tf: AnyTransferFunction, labels: Mapping[str, str]) -> Iterator[Block]:
    """Yield the leading terms at both ends, and where they meet."""
    found = limits_of(tf)
    named = {
        "s -> 0": ("G_0", "s → 0"),
        "s -> infinity": ("G_infinity", "s → ∞"),
        CORNER: ("omega_m", ""),
    }
    runs, sides = list[Run](), list[tuple[Mathematics, Expression]]()
    for row in found.rows:
        name, end = named[row.name]
        left_side = labelled(Name(name), LIMITS)
        runs += [
            "; " if runs else "Leading terms: ",
            left_side,
            f" for {end}" if end else " at the corner frequency",
        ]
        runs += [f" ({unit_text(row.comment)})"] if row.comment else []
        sides.append((left_side, row.expression))
    if sides:
        where = [(row.name.removeprefix("where "), row.expression) for row in found.where]
        yield text(*runs, ".")
        yield equations(sides, labels, f"{tf.name} at both ends", where)


def _groups(tf: AnyTransferFunction, labels: Mapping[str, str]) -> Iterator[Block]:
    """Yield the function in dimensionless groups, and the groups."""
    found = dimensionless_of(tf)
    if not 0 < len(found.rows) <= MOST_ROWS:
        return
    (head, *rows), over = found.rows, labelled(Name("scale"), SCALE)
    scaled = Mathematics(f"<mi>G</mi><mo>/</mo>{over.mathml}", f"G/{over.latex}")
    where = [(row.name.removeprefix("where "), row.expression) for row in (*rows, *found.where)]
    yield text("With dimensionless groups, and G for ", ratio(tf), ":")
    yield equations([(scaled, head.expression)], {**labels, **SCALE}, f"{tf.name} with groups", where)
    runs = list[Run]()
    for row in rows:
        said = unit_text(row.comment.strip())
        runs += [labelled(Name(row.name), SCALE), f": {said}. "] if said else []
    if runs:
        yield text(*runs)


def _near(tf: AnyTransferFunction, label: str) -> tuple[Block, ...]:
    """Return a shorter function or one that is rational, and what is proved of it."""
    given = DeriveOptions(short="1 %") if tf.is_reduced and tf.is_rational else DeriveOptions(order=2)
    near = attempt(partial(approximation, tf, given))
    proof = None if isinstance(near, SymflexError) else near[1].approximation
    if isinstance(near, SymflexError) or not proof or proof.is_whole:
        return ()
    return *displayed(*near, label), text("; ".join(proof.said), ".")


def _factor(factor: SymbolicFactor, labels: Mapping[str, str]) -> Iterator[Block]:
    """Yield what the roots of a factor are, and under which conditions; nothing where its names say it."""
    if factor.factor is None or any(isinstance(f.expression, Name) for f in factor.formulas):
        return
    names = [(labelled(Name(f.name), labels), f) for f in factor.formulas]
    yield text(f"{factor.kind.capitalize()} are the roots of")
    yield equations(
        [(NOTHING, factor.factor), *((name, f.expression) for name, f in names)], labels, factor.kind
    )
    runs = list[Run]()
    for name, formula in names:
        if formula.value is not None:
            runs += [name, f" = {decimal(formula.value)} {formula.unit}".rstrip() + ". "]
    for statement, holds, conditions in factor.kinds:
        words, _, condition = statement.partition(IF)
        runs.append(f"{words[0].upper()}{words[1:]}")
        if len(condition) >= LONGEST or not all(each.sides for each in conditions):
            runs += [" under a condition that ", Code("roots --symbolic"), " prints. "]
            continue
        for i, each in enumerate(conditions):
            left, right = (labelled(side, labels) for side in each.sides or ())
            runs += [" and " if i else IF, left, f" {each.sign} ".replace("!=", "≠"), right]
        runs.append(", as here. " if holds and conditions else ". ")
    for line in replace(factor, kinds=()).more():
        runs += [Code(line), ". "]
    if runs:
        yield text(*runs)

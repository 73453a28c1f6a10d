"""One printed formula against one derived function: the verdict and everything that supports it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

from symflex.algebra import LAPLACE
from symflex.audit.corrections import Change, Correction, find_correction
from symflex.audit.field import GrowError, UnreadError
from symflex.audit.laws import LawCheck, check_laws
from symflex.audit.notation import derived_in_symbols, monomial_expression
from symflex.audit.numeric import (
    Comparison,
    Deviation,
    Numbers,
    compare_anywhere,
    largest_deviation,
    numbers_of,
)
from symflex.audit.reading import Formula, FormulaReading, formula_of, read
from symflex.audit.rounded import is_right_to_its_digits
from symflex.budget import spend
from symflex.errors import BudgetError, Diagnostic, SpecError, SymflexError, nearest, refused
from symflex.expressions import (
    Expression,
    Sum,
    format_expression,
    names,
    nodes,
    number,
    quotient,
    substitute,
)
from symflex.model import Definition, Model, Published, with_numbers
from symflex.model.loss_factors import check_causal
from symflex.model.units import constant_measure
from symflex.print.forms import print_form
from symflex.transfer import TransferFunction
from symflex.transfer.of_model import derive_all

Verdict = Literal["equal", "rounded", "differs", "agrees", "undecided"]


@dataclass(frozen=True)
class Audit:
    """What was found about one printed formula."""

    tf: TransferFunction  # the derived function
    published: Published  # what was printed
    formula: Formula  # the same with its lines in order
    # ``equal`` and ``differs``: proved. ``rounded``: proved to the digits printed. ``agrees``: to 50 digits
    # at all points, not proved.
    # ``undecided``: none of these.
    verdict: Verdict
    unread: str = ""  # why the formula could not be read exactly; empty when it was
    # Printed over derived, where that is a number times powers of s and the parameters.
    ratio: Expression | None = None
    taken: str = ""  # where it is right: ``b = 0``, of parameters that are not in it
    correction: Correction | None = None  # the smallest change found that makes the formula right
    # The derived function in the print's symbols, where that is possible and no correction says so.
    derived: Expression | None = None
    comparison: Comparison | None = None  # what numbers say; ``None`` if a proof needs none
    # On the frequency axis; ``None`` when equal, or where parameters have no value.
    deviation: Deviation | None = None
    laws: tuple[LawCheck, ...] = ()  # structural laws
    units: tuple[str, ...] = ()  # printed sums whose terms are measured differently, in words
    numeric: tuple[str, ...] = ()  # parameters in whose place the model's values stand

    def __repr__(self) -> str:
        return f"<Audit {self.tf.name}: {self.verdict}>"

    @property
    def is_certified(self) -> bool:
        """True when the verdict is proved."""
        return self.verdict in ("equal", "rounded", "differs")

    @property
    def changes(self) -> tuple[Change, ...]:
        """What would make the formula right."""
        return () if self.correction is None else self.correction.changes


WORST: Final[Sequence[Verdict]] = ("differs", "undecided", "agrees", "rounded", "equal")


def judge(tf: TransferFunction, published: Published) -> Audit:
    """Compare a printed formula with the derived function; SpecError for what is no formula.

    Of ``G = a = b`` the worst side counts. A formula that prints numbers for some parameters is compared with
    the function that has the model's values in their place.
    """
    sides = (replace(published, expression=e, others=()) for e in (published.expression, *published.others))
    return min((_judged_side(tf, side) for side in sides), key=lambda found: WORST.index(found.verdict))


def _judged_side(tf: TransferFunction, published: Published) -> Audit:
    found = _judged(tf, published)
    if found.verdict == "equal":
        return found
    printed = {n.name for e in (found.formula.whole, *(e for _, e in found.formula.lines)) for n in names(e)}
    numeric = [p.name for p in tf.parameters if p.value is not None and p.name not in printed]
    missing = [p.name for p in tf.parameters if p.value is None]
    vanishes = found.comparison is not None and found.comparison.printed == 0
    if missing and printed <= {LAPLACE, "pi"} and not vanishes:  # numbers could be those of any values
        reason = f"the model has no values for {', '.join(missing)}"
        return Audit(tf, published, found.formula, "undecided", reason)
    if not numeric:
        return _to_its_digits(found, tf)
    kept = [p.name for p in tf.model.parameters if p.name not in numeric]
    try:
        (with_values,) = derive_all(with_numbers(tf.model, kept, in_kernels=True), [published.tf])
        again = replace(_judged(with_values, published), numeric=tuple(numeric))
    except SymflexError:
        return found
    again = _to_its_digits(again, with_values)
    is_said = found.changes or found.taken
    is_plainer = not any(p.name in printed for p in tf.parameters) or (again.changes and not is_said)
    return again if again.verdict in ("equal", "rounded") or is_plainer else found


def _to_its_digits(found: Audit, tf: TransferFunction) -> Audit:
    """Return an audit of numbers that differ only beyond the digits that are printed."""
    form = print_form(tf)
    if found.verdict != "differs" or form.where or found.formula.lines:
        return found
    if not is_right_to_its_digits(found.formula.whole, quotient(form.num, form.den)):
        return found
    return Audit(found.tf, found.published, found.formula, "rounded", numeric=found.numeric)


def _judged(tf: TransferFunction, published: Published) -> Audit:
    formula = formula_of(published, tf.model)
    unread, reading = "", None
    try:
        reading = read(formula, tf)
        if reading.field.equal(reading.printed, reading.derived):
            return Audit(tf, published, formula, "equal")
    except UnreadError as reason:
        unread = str(reason)
    except BudgetError:
        spend()
        unread, reading = "it exceeds the size limits when it is expanded", None
    numbers = numbers_of(formula, tf, tf.model)
    seen = compare_anywhere(numbers, tf)
    if not seen.differs:
        verdict: Verdict = "agrees" if seen.agreed else "undecided"
        unread = unread or "its roots or functions may satisfy a relation that was not found"
        return Audit(tf, published, formula, verdict, unread, comparison=seen)
    return _difference(Audit(tf, published, formula, "differs", unread, comparison=seen), reading, numbers)


def _difference(audit: Audit, reading: FormulaReading | None, numbers: Numbers) -> Audit:
    measured = None if numbers.invented else numbers
    ratio, taken, correction, derived = None, "", None, None
    vanishes = reading is not None and any(map(reading.field.is_zero, (reading.printed, reading.derived)))
    if reading is not None and not vanishes:
        try:
            constant = reading.field.constant_ratio(reading.printed, reading.derived)
            ratio = None if constant is None else monomial_expression(reading.field, constant)
            taken = _taken(reading, audit.tf) if ratio is None else ""
            if ratio is None:
                correction = find_correction(reading, audit.tf)
            if ratio is None and not taken and correction is None:
                derived = derived_in_symbols(reading)
        except BudgetError:  # what is not found within the limits is not reported
            spend()
            reading = None
    return replace(
        audit,
        ratio=ratio,
        taken=taken,
        correction=correction,
        derived=derived,
        deviation=None if measured is None or vanishes else largest_deviation(measured),
        laws=() if vanishes else check_laws(reading, measured),
        units=tuple(_disagreeing_sums(audit.published, audit.tf.model)),
    )


def _taken(reading: FormulaReading, tf: TransferFunction) -> str:
    """Return the values of parameters that are not printed with which the formula is right, 0 or 1."""
    form = print_form(tf)
    expressions = (reading.formula.whole, *(e for _, e in reading.formula.lines))
    printed = {n.name for e in expressions for n in names(e)}
    absent = [p.name for p in tf.parameters if p.name not in printed]
    if not absent or form.where:
        return ""
    units = {p.name: p.unit for p in tf.parameters}
    for value in (0, 1):
        if value and any(units[name] for name in absent):
            continue  # one newton is no natural value
        given = dict.fromkeys(absent, number(value))
        try:
            meant = reading.value(substitute(quotient(form.num, form.den), given))
        except (SpecError, UnreadError, GrowError):
            continue
        if reading.field.equal(reading.printed, meant):
            return " and ".join(f"{name} = {value}" for name in absent)
    return ""


def _disagreeing_sums(published: Published, model: Model) -> Iterator[str]:
    """Yield every printed sum whose terms are in different units, as far as the declared ones tell."""
    printed_lines = [Definition(name, expression) for name, expression in published.where]
    hidden = {d.name for d in printed_lines}
    inherited = [p for p in model.parameters if p.name not in hidden]
    measure = constant_measure(
        [], inherited, [*(d for d in model.definitions if d.name not in hidden), *printed_lines]
    )
    roots = [published.expression, published.scale, *(e for _, e in published.where)]
    sums = dict.fromkeys(n for e in roots if e is not None for n in nodes(e) if isinstance(n, Sum))
    reported: list[Sum] = []
    for part in reversed(sums):
        dimensions = {format_expression(t): d for t in part.terms if (d := measure(t)) is not None}
        # What holds a sum that disagrees may disagree for that reason alone.
        if len(set(dimensions.values())) > 1 and not any(inner in nodes(part) for inner in reported):
            reported.append(part)
            terms = ", ".join(f"{term} in '{dimension}'" for term, dimension in dimensions.items())
            yield f"the terms of {format_expression(part)} disagree: {terms}"


def audit(model: Model, names: Sequence[str] = ()) -> tuple[Audit, ...]:
    """Return what is found about the model's printed formulas, those named "OUT/IN" or all."""
    if model.root is not None:
        check_causal(model, "a comparison with printed formulas")
    printed = {"/".join(p.tf): p for p in model.published}
    for name in names:
        if name not in printed:
            hint = nearest(name, printed) or "published: " + ", ".join(list(printed)[:8])
            raise refused(f"nothing is published for '{name[:100]}'", hint)
    chosen = tuple(printed[name] for name in names) if names else model.published
    check_published(model, chosen)
    derived = derive_all(model, tuple(p.tf for p in chosen)) if chosen else ()
    return tuple(judge(tf, p) for tf, p in zip(derived, chosen, strict=True))


def check_published(model: Model, formulas: Sequence[Published]) -> None:
    """Raise what is wrong with printed formulas of a model, each problem at its place."""
    problems: list[Diagnostic] = []
    for published in formulas:
        try:
            formula_of(published, model)
        except SpecError as error:
            problems += error.diagnostics
    if problems:
        raise SpecError(*problems)

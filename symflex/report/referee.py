r"""A paper in LaTeX against models: which of its formulas are right, which are not, and what is wrong.

Input: the mathematics of a paper, and models. Output: a verdict for every displayed formula, shown as text,
JSON, a page, and a list of errata. Of ``\frac{X}{F} = ...`` the left side says which transfer function the
right side should be. Of ``G = ...`` nothing does, and every transfer function of the models is tried.
Equations that define a symbol, displayed or in a sentence, are read where a formula needs them.

A formula is called right or wrong only where that is proved, as :mod:`symflex.audit` does. Where no small
change makes a formula right, symflex looks for a slip of print: brackets left out after a factor, a root
whose bar is too short, or the factor that another formula of the paper lacks.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from itertools import pairwise, product
from typing import Final, Literal

from symflex.algebra import LAPLACE
from symflex.audit import Audit, judge
from symflex.audit.slips import explained_by_print
from symflex.audit.tables import TableAudit, judge_array
from symflex.audit.text import VERDICTS, table_json, table_text
from symflex.budget import spend
from symflex.errors import (
    BudgetError,
    Diagnostic,
    ModelError,
    Span,
    SpecError,
    SymflexError,
    counted,
    no_such,
)
from symflex.expressions import (
    Call,
    Expression,
    Name,
    Negative,
    Power,
    Product,
    Quotient,
    Sum,
    format_expression,
    is_longer,
    is_number,
    names,
    negative,
    nodes,
    number,
    power,
    product_of,
    quotient,
    substitute,
    sum_of,
    with_children,
)
from symflex.model import Model, Published
from symflex.model.analysis import notation_of_model, readable_names, with_candidates
from symflex.papers.formula import defined_symbol, definition, read_formula, read_value
from symflex.papers.laplace import in_laplace, laplace_of
from symflex.papers.matrices import unsigned
from symflex.papers.source import Paper, PrintedEquation, statements, written
from symflex.papers.symbols import DOTS, IMAGINARY, PaperNotation, PrintedSymbol
from symflex.print.forms import print_form
from symflex.print.label import labels_of
from symflex.print.latex import latex_expression, model_labels
from symflex.report.document import Badge, Block, Code, Section, Tone, labelled, marked, text
from symflex.report.report import Report
from symflex.report.sections.formulas import equations
from symflex.transfer import TransferFunction
from symflex.transfer.of_model import derive_all

Judgement = Literal["equal", "factor", "different", "other model", "not read"]
SCHEMA: Final = "symflex.referee/1"
SAID: Final[Mapping[Judgement, tuple[str, Tone]]] = {
    "equal": ("right (proved)", "good"),
    "factor": ("right but for a factor (proved)", "fair"),
    "different": ("DIFFERS (proved)", "bad"),
    "other model": ("not about these models", "quiet"),
    "not read": ("not judged", "quiet"),
}
DEFINES: Final = "it defines"
NEARLY: Final = "it holds only nearly, by its sign"
MOST_PAIRS: Final = 6  # transfer functions that a formula without a left side is compared with
MOST_LISTED: Final = 6  # symbols without a meaning
MOST_SIDES: Final = 20
MOST_NODES: Final = 1_000  # parts of a formula and its definitions; a Timoshenko beam's has some 300


@dataclass(frozen=True)
class JudgedFormula:
    """A displayed formula of a paper and what was found."""

    latex: str  # as it is typed
    label: str  # its label or tag, empty without one
    span: Span  # where it begins
    verdict: Judgement
    reason: str = ""  # why it could not be judged, or what a verdict rests on
    slip: str = ""  # what is wrong, with what would be right
    model: Model | None = None  # what it is about
    audit: Audit | None = None
    misprint: str = ""  # a slip of print
    repaired: Audit | None = None  # of the formula without it, or times the factor that is left out

    @property
    def said(self) -> str:
        """The verdict in words."""
        return "a definition" if self.reason.startswith(DEFINES) else SAID[self.verdict][0]

    @property
    def where(self) -> str:
        """How the paper calls it, and its line."""
        line = f"line {self.span.line}"
        return f"{self.label}, {line}" if self.label else line


class _Unjudged(Exception):  # noqa: N818 (what is raised is a verdict, not an error)
    def __init__(self, verdict: Judgement, reason: str) -> None:
        super().__init__(reason)
        self.verdict, self.reason = verdict, reason


def referee(paper: Paper, models: Sequence[Model], only: str | None = None) -> tuple[JudgedFormula, ...]:
    """Return the displayed formulas of a paper, judged, in their order; or those with one label or tag."""
    court = _Court(paper, models)
    asked = [item for item in court.items if only is None or item.label.strip("()") == only.strip("()")]
    if not asked and only is not None:
        labels = sorted({item.label for item in court.items if item.label})
        raise no_such("equation", only, labels, "labels and tags")
    found = [court.judged(item) if isinstance(item, _Item) else item for item in asked]
    for i, judged in enumerate(found):
        if judged.span in court.used and judged.verdict in ("other model", "not read"):
            found[i] = replace(judged, verdict="other model", reason=court.used[judged.span])
    audits = [j.repaired or j.audit for j in found]
    scales = dict.fromkeys(a.ratio for a in audits if a is not None and a.ratio is not None)
    return tuple(_with_scale(j, scales) for j in found)


@dataclass(frozen=True)
class JudgedTable:
    """A tabular of a paper, and what was found about its numbers; None if they are not about the models."""

    span: Span
    audit: TableAudit | None
    reason: str = ""  # why it is not judged


def referee_tables(paper: Paper, models: Sequence[Model]) -> tuple[JudgedTable, ...]:
    """Return the tables of a paper in their order, each list of numbers compared with poles of the models."""
    judged = []
    for array in paper.arrays:
        try:
            found = judge_array(array, models)
        except SpecError as error:
            judged.append(JudgedTable(array.span, None, error.diagnostics[0].message))
            continue
        judged.append(JudgedTable(array.span, None if found is None else explained_by_print(found)))
    return tuple(judged)


@dataclass(frozen=True)
class _Item:
    """One displayed equation."""

    equation: PrintedEquation
    label: str

    @property
    def latex(self) -> str:
        typed = written(self.equation.tokens)
        start, source = self.equation.span.start, self.equation.span.source.text
        return rf"\left{typed}" if source[:start].rstrip().endswith(r"\left") else typed


class _Court:
    """The paper's definitions and the models' functions, each derived once."""

    def __init__(self, paper: Paper, models: Sequence[Model]) -> None:
        self.models = models
        self.definitions: dict[PrintedSymbol, PrintedEquation] = {}
        self.items: list[_Item | JudgedFormula] = []
        self.used: dict[
            Span, str
        ] = {}  # equations that define what other formulas contain, and what they define
        self.derived: dict[tuple[int, tuple[str, str]], TransferFunction] = {}
        self.tied: dict[tuple[int, str], dict[tuple[str, str], None]] = {}  # what a letter is, by model
        for display in paper.displays:
            try:
                if display.problem is not None:
                    raise SpecError(display.problem)
                found = statements(display.tokens)
            except SpecError as error:
                if not display.is_inline:
                    reason = error.diagnostics[0].message
                    latex = display.span.text[:200]
                    self.items.append(JudgedFormula(latex, "", display.span, "not read", reason))
                continue
            for equation in found:
                defined = defined_symbol(equation)
                if defined is not None:
                    self.definitions.setdefault(*defined)
            if not display.is_inline:
                self.items += _labelled(found, display.labels)

    def judged(self, item: _Item) -> JudgedFormula:
        """Return the verdict of the first model that the formula is about."""
        last = JudgedFormula(item.latex, item.label, item.equation.span, "other model")
        for model in self.models:
            try:
                return self.judged_by(item, model)
            except _Unjudged as reason:
                if reason.verdict == "not read" or last.verdict == "other model":
                    last = replace(last, verdict=reason.verdict, reason=reason.reason)
            except SpecError as error:
                last = replace(last, verdict="not read", reason=_reason(error))
        return last

    def judged_by(self, item: _Item, model: Model) -> JudgedFormula:
        equation = _exact(item.equation)
        notation = self.notation(model, equation)
        self.check_letters(equation, model, notation)
        moving = _moving(notation, model)
        rows, missed = _read_sides(equation, notation.with_names({x: x.name for x in moving}))
        dots = {symbol.name: meant for symbol, meant in moving.items()}
        has_dots = any(_holds(side, name) for row in rows for side in row for name in dots)
        rows = [[substitute(side, dots) for side in row] for row in rows]
        missed += [_Unjudged("not read", NEARLY)] if equation is not item.equation else []
        sides = rows[0]
        known = {*notation.names.values()} - {
            s.name for s, e in self.definitions.items() if e is item.equation
        }
        claims = [claim for row in rows for claim in _claims(row, model, known)]
        if has_dots:  # dx/dt = v names a velocity, and is no claim about x/v
            claims = [c for c in claims if any(n.name != LAPLACE for n in names(c[1]))]
        number_of = self.models.index(model)
        for pair in model.transfer_functions:  # H = X/F = ... says what H is, also where it comes again
            if any(side == Quotient(*map(Name, pair)) for side in sides):
                for side in sides:
                    if isinstance(side, Name):
                        self.tied.setdefault((number_of, side.name), {}).setdefault(pair)
        letter = sides[0].name if isinstance(sides[0], Name) else ""
        is_tied = not claims and (number_of, letter) in self.tied
        if is_tied:
            claims = [(None, side) for side in sides[1:]]
        if not claims and (relations := [r for row in rows for r in _relations(row, model)]):
            return _worst([self.related(item, model, r, notation) for r in relations], missed)
        zeros = _vanishing(sides, model)
        if zeros:
            return _worst([self.characteristic(item, model, zero, notation) for zero in zeros], missed)
        if not claims:
            raise (
                missed[0]
                if missed
                else _Unjudged("other model", "it names no transfer function of the models")
            )
        judged: list[JudgedFormula] = []
        while claims:
            later = []
            for tf, formula in claims:
                try:
                    if is_tied:
                        found = self.by_letter(item, model, letter, formula, notation)
                    else:
                        found = self.best(item, model, tf, formula, notation)
                    if not isinstance(sides[0], Quotient) and (has_dots or not _holds(formula, LAPLACE)):
                        _check_whole(found)
                    judged.append(found)
                except (_Unjudged, SpecError) as reason:
                    missed.append(reason)
                    later += [formula] if tf is None and not is_tied else []
            right = [j.audit.published.tf for j in judged if j.audit is not None and j.verdict == "equal"]
            claims = [(tf, formula) for tf in right[:1] for formula in later]  # G is this function then
        return _worst(judged, missed)

    def check_letters(self, equation: PrintedEquation, model: Model, notation: PaperNotation) -> None:
        """Refuse an equation with K(s) in a paper that defines it, if K is a parameter of the model."""
        texts = [t.text for t in equation.tokens]
        constant = {p.name for p in model.parameters}
        for symbol, other in self.definitions.items():
            letters = [t.text for t in other.sides[0]]
            if notation.names.get(symbol) in constant and letters[-3:] == ["(", LAPLACE, ")"]:
                if any(texts[i : i + len(letters)] == letters for i in range(len(texts))):
                    said = f"{symbol.name}(s) is a function by line {other.span.line}"
                    raise _Unjudged("not read", f"{said}, and {symbol.name} a parameter of the model")

    def by_letter(
        self, item: _Item, model: Model, letter: str, formula: Expression, notation: PaperNotation
    ) -> JudgedFormula:
        """Return the verdict on a formula for what the paper calls by a letter, which may be several."""
        tied = [*self.tied[self.models.index(model), letter]]
        found = min((self.best(item, model, tf, formula, notation) for tf in tied), key=_rank)
        if found.verdict == "different":
            try:
                found = self.best(item, model, None, formula, notation)
            except _Unjudged:
                pass  # it is no other function either
        if found.audit is None:
            return found
        own = found.audit.tf.name
        known = ["/".join(tf) for tf in tied]
        listed = " and ".join(dict.fromkeys([*known, own]))
        if listed == known[0] and len(known) == 1:
            return found
        said = f"{letter} is {listed} in this paper; this is compared with {own}"
        return replace(found, reason=f"{found.reason}; {said}" if found.reason else said)

    def best(
        self,
        item: _Item,
        model: Model,
        tf: tuple[str, str] | None,
        formula: Expression,
        notation: PaperNotation,
    ) -> JudgedFormula:
        """Return the verdict on a formula for a transfer function, ``None`` if it could be any.

        Then it is right, or right but for a factor, or not about the model: nobody said that it should be.
        """
        lines = self.lines(formula, model, notation, item.equation.span)
        if is_longer([formula, *(line for _, line in lines)], MOST_NODES):
            raise _Unjudged("not read", f"it has more than {MOST_NODES} parts")
        answers: list[JudgedFormula] = []
        if tf is None and not any(_holds(e, LAPLACE) for e in (formula, *(e for _, e in lines))):
            raise _Unjudged("other model", "it names no transfer function of the models, and has no s")
        # The paper may define what is a parameter of the model: zeta = c/(2 sqrt(k m)).
        try:
            own = self.lines(formula, model, notation, item.equation.span, hides=True)
        except (_Unjudged, SpecError):
            own = lines
        for pair in [tf] if tf is not None else model.transfer_functions[:MOST_PAIRS]:
            every = [
                Published(pair, formula, x, None, "", item.equation.span, is_latex=True) for x in (lines, own)
            ]
            for meant in dict.fromkeys(x for p in every for x in (_in_radians(p, model), p)):
                if not any(a.verdict == "equal" for a in answers):
                    answers.append(_judged(item, model, self.audit(model, meant)))
        best = min(answers, key=_rank)
        if tf is None and best.verdict == "different":
            near = f"; {best.audit.tf.name} would need: {best.slip}" if best.audit and best.slip else ""
            raise _Unjudged("other model", f"it is none of the transfer functions of the models{near}")
        if best.verdict == "different" and best.audit is not None and not best.slip:
            best = _repaired(best, self)
        return best

    def audit(self, model: Model, published: Published) -> Audit:
        return judge(self.function(model, published.tf), published)

    def function(self, model: Model, pair: tuple[str, str]) -> TransferFunction:
        """Return a derived function, derived once."""
        key = self.models.index(model), pair
        if key not in self.derived:
            (self.derived[key],) = derive_all(model, (pair,))
        return self.derived[key]

    def related(
        self, item: _Item, model: Model, relation: Mapping[str, Expression], notation: PaperNotation
    ) -> JudgedFormula:
        """Return the verdict on an equation of several outputs: one of them by the others as derived.

        It has to hold for every input that it names, all others being zero, or else for one of all.
        """
        where = item.equation.span
        inputs = [i.name for i in model.inputs if i.name in relation]
        outputs = [name for name in relation if name not in inputs]
        first = next((name for name in outputs if is_number(unsigned(relation[name]), 1)), outputs[0])
        others = [name for name in outputs if name != first]
        found = []
        for given in inputs or [i.name for i in model.inputs]:
            terms = [product_of([relation[name], Name(name)]) for name in others]
            terms += [relation[given]] if given in relation else []
            formula = _over(negative(sum_of(terms)), relation[first])
            lines = self.lines(substitute(formula, dict.fromkeys(others, number(1))), model, notation, where)
            derived = [(name, quotient(*self.parts(model, (name, given)))) for name in others]
            scale = derived[0][1] if len(others) == 1 and given not in relation else None
            if scale is not None:  # of a ratio, what is printed is apart from what is derived
                formula = _over(negative(relation[others[0]]), relation[first])
            lines += () if scale is not None else tuple(derived)
            printed = Published((first, given), formula, lines, scale, "", where, is_latex=True)
            audit = replace(self.audit(model, printed), derived=None)
            if {c.place for c in audit.changes} & {"scale", *(f"line {name}" for name in others)}:
                audit = replace(audit, correction=None)  # what is derived is no slip of the paper
            judged = _judged(item, model, audit)
            said = f"it relates {' and '.join(outputs)}, for {given}"
            found.append(replace(judged, reason=f"{judged.reason}; {said}" if judged.reason else said))
        best = (max if inputs else min)(found, key=lambda j: (*_rank(j), _size(j)))
        _, _, *more = relation  # with two it is a ratio; a sum may be about another model
        if best.verdict == "different" and not best.slip and more:
            raise _Unjudged("other model", "it does not hold in the models, and no small change is known")
        return best

    def parts(self, model: Model, pair: tuple[str, str]) -> tuple[Expression, Expression]:
        """Return the numerator and denominator of a derived function, with nothing but s and parameters."""
        form = print_form(self.function(model, pair))
        above, below = form.num, form.den
        for _ in form.where:
            above, below = substitute(above, dict(form.where)), substitute(below, dict(form.where))
        return above, below

    def characteristic(
        self, item: _Item, model: Model, formula: Expression, notation: PaperNotation
    ) -> JudgedFormula:
        """Return the verdict on what is zero at the poles, if it is; nobody said that it should be."""
        where, near = item.equation.span, ""
        lines = self.lines(formula, model, notation, where)
        if not any(_holds(e, LAPLACE) for e in (formula, *(e for _, e in lines))):
            raise _Unjudged("other model", "it names no transfer function of the models")
        for pair in model.transfer_functions[:MOST_PAIRS]:
            above, _ = self.parts(model, pair)
            name = "/".join(pair)
            printed = Published(pair, quotient(above, formula), lines, None, "", where, is_latex=True)
            audit = self.audit(model, printed)
            roots = [n for n, line in lines if isinstance(line, Power | Call) and _holds(line, LAPLACE)]
            roots = [] if audit.tf.is_rational else roots
            for wavenumber, count in product(roots, (1, 2, 3)):
                below = product_of([formula, power(Name(wavenumber), count)])  # that is not zero with it
                again = self.audit(model, replace(printed, expression=quotient(above, below)))
                if again.verdict == "equal" or again.ratio is not None:
                    audit = again
                    break
            if audit.verdict == "equal" or (audit.ratio is not None and not _holds(audit.ratio, LAPLACE)):
                reason = f"its roots are the poles of {name}"
                return JudgedFormula(item.latex, item.label, where, "equal", reason, "", model)
            if audit.ratio is not None:
                near = near or f"; but for roots at 0, its roots are the poles of {name}"
            elif audit.changes and all(c.place.startswith(("denominator", "line")) for c in audit.changes):
                near = near or f"; the poles of {name} would need: {_changes_said(audit)}"
        raise _Unjudged("other model", f"it was not proved to vanish at the poles of the models{near}")

    def notation(self, model: Model, equation: PrintedEquation) -> PaperNotation:
        """Return what symbols mean in a paper about a model: its own definitions hide those of the model.

        Beside a frequency, i is the imaginary unit and no current I.
        """
        letters = {t.text for t in equation.tokens}
        units = IMAGINARY if letters & {r"\omega", r"\Omega"} else ()
        typed = [t.text for t in equation.tokens]
        turning = {b[1:] for a, b in pairwise(typed) if a in ("i", "j") and b in (r"\omega", r"\Omega")}
        base = notation_of_model(model, model.notation)
        defined = {d.name for d in model.definitions}
        more = {
            symbol: symbol.name
            for symbol in self.definitions
            if base.names.get(symbol, symbol.name) not in {*base.names.values()} - defined
        }
        ends = {item.name for group in (model.outputs, model.inputs) for item in group}
        for symbol, name in base.names.items():  # a paper prints X(s) for the transform of x(t)
            twin = symbol._replace(
                base=symbol.base.swapcase() if len(symbol.base) == 1 else _turned(symbol.base)
            )
            if name in ends and twin not in base.names and twin.name not in (*units, *turning):
                more.setdefault(twin, name)
        varying = base.signals | {symbol.name for symbol in self.definitions}
        return replace(base.with_names(more), signals=varying - {p.name for p in model.parameters})

    def lines(
        self,
        formula: Expression,
        model: Model,
        notation: PaperNotation,
        where: Span,
        *,
        hides: bool = False,
    ) -> tuple[tuple[str, Expression], ...]:
        """Return the definitions that a formula needs; symbols without a meaning raise a verdict.

        Those of the paper stand for definitions of the model, and with ``hides`` for its parameters too.
        """
        readable = readable_names(model)
        meant = {*readable.constants, *readable.definitions}
        lines: dict[str, Expression] = {}
        needed: dict[Span, str] = {}
        pending, unknown = [formula], dict[str, Name]()
        while pending:
            for node in names(pending.pop()):
                if not isinstance(node, Name) or node.name in lines:
                    continue
                equation, bound = self.defining(node.name)
                hidden = hides or node.name in readable.definitions
                if node.name in meant and (equation is None or not hidden):
                    continue
                if equation is None:
                    unknown.setdefault(node.name, node)
                    continue
                lines[node.name] = self.meaning(equation, model, notation, bound)
                symbol = next(s.name for s, e in self.definitions.items() if e is equation)
                needed[equation.span] = f"{DEFINES} {symbol} of line {where.line}"
                pending.append(lines[node.name])
        if set(unknown) in ({"omega"}, {"Omega"}) and not any(
            _holds(formula, n) for n in (LAPLACE, *unknown)
        ):
            turned, laplace = in_laplace([*lines.values()], notation)  # k^4 = mu*omega^2/EI
            if laplace in unknown:
                lines, unknown = dict(zip(lines, turned, strict=True)), {}
        if unknown:
            raise _untied(formula, tuple(lines.items()), unknown, model)
        self.used |= needed
        return tuple(lines.items())

    @staticmethod
    def meaning(
        equation: PrintedEquation, model: Model, notation: PaperNotation, bound: Mapping[str, int]
    ) -> Expression:
        """Return what an equation defines: its last side that says more than a number or an output and input.

        Of ``tau = R C = 0.03 s`` that is R C.
        """
        ends = {item.name for group in (model.outputs, model.inputs) for item in group}
        values: list[Expression] = []
        problem: SpecError | None = None
        for count in range(len(equation.sides), 1, -1):
            try:
                values.append(definition(equation._replace(sides=equation.sides[:count]), notation, bound))
            except SpecError as error:
                problem = problem or error
        if not values:
            assert problem is not None
            raise problem
        said = [v for v in values if not any(_holds(v, end) for end in ends)]
        return next((v for v in said if names(v)), (said or values)[0])

    def defining(self, name: str) -> tuple[PrintedEquation | None, Mapping[str, int]]:
        """Return the equation that defines a name; R_3 may be defined as R_i, and then i is 3."""
        for symbol, equation in self.definitions.items():
            if symbol.name == name:
                return equation, {}
        for symbol, equation in self.definitions.items():
            script, letter = symbol.script[:-1], symbol.script[-1:]
            stem = symbol._replace(script=script).name
            rest = name.removeprefix(stem if script else f"{stem}_")
            if letter.isalpha() and letter.islower() and rest.isdigit() and name != rest:
                return equation, {letter: int(rest)}
        return None, {}


def _in_radians(printed: Published, model: Model) -> Published:
    """Return a formula whose frequencies are in radians, as papers mean them, where the model has cycles."""
    cycles = {p.name: p.cycles for p in model.parameters if p.name in {c.name for c in model.conversions}}
    turn = product_of([number(2), Name("pi")])
    meant = {name: product_of([power(turn, count), Name(name)]) for name, count in cycles.items()}
    lines = tuple((name, substitute(line, meant)) for name, line in printed.where)
    return replace(printed, expression=substitute(printed.expression, meant), where=lines)


def _untied(
    formula: Expression, lines: tuple[tuple[str, Expression], ...], unknown: Mapping[str, Name], model: Model
) -> _Unjudged:
    """Return the verdict on a formula with symbols that mean nothing: what these could be, by their units."""
    held = {n.name for e in (formula, *(e for _, e in lines)) for n in names(e) if isinstance(n, Name)}
    if not held & {p.name for p in model.parameters}:
        return _Unjudged("other model", "it has no symbol of the models")
    problems = [Diagnostic("SF210", name, node.span) for name, node in [*unknown.items()][:MOST_LISTED]]
    printed = Published(("", ""), formula, lines, is_latex=True)
    said = []
    for problem in with_candidates(problems, printed, model):
        could = (problem.hint or "").partition("could be ")[2].partition(";")[0]
        said.append(f"{problem.message} (by its place {could}?)" if could else problem.message)
    more = ", ..." if len(unknown) > MOST_LISTED else ""
    listed = ", ".join(said) + more
    return _Unjudged("not read", f"symbols without a meaning: {listed}; tie them in [notation]")


def _turned(base: str) -> str:
    return base.capitalize() if base.islower() else base.lower()


def _labelled(found: Sequence[PrintedEquation], labels: Sequence[tuple[int, str]]) -> Iterator[_Item]:
    """Yield equations with the label that stands in each, or the only one of their display."""
    starts = [e.span.start for e in found]
    for i, equation in enumerate(found):
        end = starts[i + 1] if i + 1 < len(starts) else float("inf")
        own = [name for at, name in labels if starts[i] <= at < end or (i == 0 and at < starts[0])]
        only = labels[0][1] if len(labels) == 1 else ""
        yield _Item(equation, own[0] if own else only)


def _exact(equation: PrintedEquation) -> PrintedEquation:
    r"""Return an equation without what only holds nearly, such as the last side of ``G = a \approx b``."""
    if equation.is_condition or len(equation.sides) < 2:  # noqa: PLR2004
        raise _Unjudged("other model", "it is no equation")
    if len(equation.sides) > MOST_SIDES:
        raise _Unjudged("not read", f"it has more than {MOST_SIDES} sides")
    if equation.nearly is None:
        return equation
    sides = tuple(side for side in equation.sides if side[0].span.start < equation.nearly.start)
    if len(sides) < 2:  # noqa: PLR2004
        raise _Unjudged("not read", NEARLY)
    return equation._replace(sides=sides)


def _read_sides(
    equation: PrintedEquation, notation: PaperNotation
) -> tuple[list[list[Expression]], list[_Unjudged | SpecError]]:
    """Return the sides that are read, in s, and why others are not; the first one has to be read.

    Of vectors it is one list for each row.
    """
    laplace = laplace_of(equation, notation)
    if (rows := _rows(equation, notation, laplace)) is not None:
        return [in_laplace(row, notation)[0] for row in rows], []
    sides = [read_formula(equation.sides[0], notation, laplace=laplace)]
    missed: list[_Unjudged | SpecError] = []
    for side in equation.sides[1:]:
        try:
            sides.append(read_formula(side, notation, laplace=laplace))
        except SpecError as error:
            missed.append(error)
    return [in_laplace(sides, notation)[0]], missed


def _rows(equation: PrintedEquation, notation: PaperNotation, laplace: str) -> list[list[Expression]] | None:
    """Return the rows of an equation between vectors, ``None`` for other equations."""
    if not any(t.text == r"\begin" for t in equation.sides[0]):
        return None
    vectors = [read_value(side, notation) for side in equation.sides]
    if any(isinstance(v, Expression) or len(v.rows[0]) != 1 for v in vectors):
        return None
    columns = [[row[0] for row in v.rows] for v in vectors if not isinstance(v, Expression)]
    if len({len(column) for column in columns}) != 1:
        return None
    return [[substitute(e, {laplace: Name(LAPLACE)}) for e in row] for row in zip(*columns, strict=True)]


def _worst(judged: Sequence[JudgedFormula], missed: Sequence[_Unjudged | SpecError]) -> JudgedFormula:
    """Return what counts of ``G = a = b``: the worst side that is judged, with why others are not."""
    sure = [j for j in judged if j.verdict != "not read"]
    if not judged:
        raise next((m for m in missed if isinstance(m, SpecError) or m.verdict == "not read"), missed[0])
    worst = max(sure or judged, key=_rank)
    reasons = [j.reason for j in judged if sure and j.verdict == "not read"]
    reasons += [_reason(m) for m in missed if isinstance(m, SpecError) or m.verdict == "not read"]
    if not reasons:
        return worst
    count = "one of its sides is" if len(reasons) == 1 else f"{len(reasons)} of its sides are"
    said = f"{count} not judged: {'; '.join(dict.fromkeys(reasons))}"
    return replace(worst, reason=f"{worst.reason}; {said}" if worst.reason else said)


def _reason(missed: _Unjudged | SpecError) -> str:
    """Return why something is not judged, with its place."""
    if isinstance(missed, _Unjudged):
        return missed.reason
    said = missed.diagnostics[0]
    place = f"{said.span.line}:{said.span.column}: " if said.span is not None else ""
    return f"{place}{said.message}"


def _claims(
    sides: Sequence[Expression], model: Model, known: set[str]
) -> Iterator[tuple[tuple[str, str] | None, Expression]]:
    """Yield which transfer function a side of an equation should be, and the formula for it.

    A name that is not known, as it has no meaning or this equation gives it one, is no formula.
    """
    pairs, inputs = model.transfer_functions, {item.name for item in model.inputs}
    found = False
    for i, left in enumerate(sides):
        if not i and isinstance(left, Name) and len(sides) > 2:  # noqa: PLR2004 (G = X/F = ... says what G is)
            continue
        for right in sides[i + 1 :]:
            for pair in pairs:
                formula = _solved(left, right, pair, inputs)
                if (
                    formula is not None
                    and _says_something(formula, pair)
                    and not _is_function(formula, known)
                ):
                    found = True
                    yield pair, formula
    if not found and not any(_holds(side, end) for side in sides for pair in pairs for end in pair):
        if _is_function(sides[0], known):
            yield from ((None, side) for side in sides[1:] if not _is_function(side, known))


def _moving(notation: PaperNotation, model: Model) -> dict[PrintedSymbol, Expression]:
    """Return what dots above an output or an input mean, which is s times it, unless they are a name."""
    ends = {item.name for group in (model.outputs, model.inputs) for item in group}
    own = {*(p.name for p in model.parameters), *(d.name for d in model.definitions)}
    found: dict[PrintedSymbol, Expression] = {}
    for symbol, name in notation.names.items():
        for mark, count in DOTS.items():
            dotted = symbol._replace(marks=mark)
            is_free = notation.names.get(dotted, dotted.name) == dotted.name  # but for what the paper says
            if name in ends and not symbol.marks and is_free and dotted.name not in own:
                found[dotted] = product_of([power(Name(LAPLACE), count), Name(name)])
    return found


def _relations(sides: Sequence[Expression], model: Model) -> Iterator[dict[str, Expression]]:
    """Yield the linear equations of two and more outputs that an equation states, by coefficients."""
    outputs = {o.name for o in model.outputs}
    ends = {i.name for i in model.inputs} | outputs
    for i, left in enumerate(sides):
        for right in sides[i + 1 :]:
            parts = _coefficients(_cleared(left, right, ends), ends) or {}
            relation = {name: sum_of(part) for name, part in parts.items()}
            if len(outputs & set(relation)) > 1 and not any(is_number(e, 0) for e in relation.values()):
                yield relation


def _check_whole(judged: JudgedFormula) -> None:
    """Refuse what may be one force of an equation of motion, F = b dx/dt: parameters are not in it."""
    if judged.verdict == "different" and judged.audit is not None:
        formula = judged.audit.formula
        held = {n.name for e in (formula.whole, *(e for _, e in formula.lines)) for n in names(e)}
        missing = [p.name for p in judged.audit.tf.parameters if p.name not in held]
        if missing:
            said = f"it has no {', '.join(missing)}, and may be about a part of the model"
            near = f"; {judged.audit.tf.name} would need: {_changes_said(judged.audit)}"
            raise _Unjudged("other model", said + (near if judged.audit.changes else ""))


def _vanishing(sides: Sequence[Expression], model: Model) -> list[Expression]:
    """Return the expressions that an equation without outputs and inputs says to be zero, but for names."""
    ends = {end for pair in model.transfer_functions for end in pair}
    if not any(is_number(side, 0) for side in sides) or any(_holds(x, e) for x in sides for e in ends):
        return []
    return [side for side in sides if not isinstance(side, Name) and not is_number(side, 0)]


def _cleared(left: Expression, right: Expression, ends: Set[str]) -> Expression:
    """Return what an equation says to be zero, without an output or an input below a line."""
    for side, other in ((left, right), (right, left)):
        if isinstance(side, Quotient) and any(_holds(side.denominator, end) for end in ends):
            return sum_of([side.numerator, negative(product_of([other, side.denominator]))])
    return sum_of([left, negative(right)])


def _says_something(formula: Expression, pair: tuple[str, str]) -> bool:
    held = {n.name for n in names(formula) if isinstance(n, Name)}
    return bool(held) and not held & set(pair)


def _is_function(expression: Expression, known: set[str]) -> bool:
    """Tell whether a side is a name such as G, or a quotient of names that the model does not have."""
    match expression:
        case Name(name):
            return name not in known
        case Quotient(Name(above), Name(below)):
            return above not in known and below not in known
    return False


def _holds(expression: Expression, name: str) -> bool:
    return any(isinstance(n, Name) and n.name == name for n in names(expression))


def _solved(
    left: Expression, right: Expression, pair: tuple[str, str], inputs: Set[str]
) -> Expression | None:
    """Return the output over the input as an equation says it, ``None`` if it says nothing of them alone."""
    powers = []
    rests = [left, right]
    for name in pair:
        split = [_split(rest, name) for rest in rests]
        if split[0] is None or split[1] is None:
            return _superposed(_cleared(left, right, {*inputs, *pair}), pair, inputs)
        rests = [split[0][0], split[1][0]]
        powers.append(split[0][1] - split[1][1])
    if powers == [1, -1]:
        return _over(rests[1], rests[0])
    return _over(rests[0], rests[1]) if powers == [-1, 1] else None


def _superposed(zero: Expression, pair: tuple[str, str], inputs: Set[str]) -> Expression | None:
    """Return the output over the input if an expression is zero, all other inputs being zero."""
    parts = _coefficients(zero, {*inputs, *pair})
    if parts is None or not all(parts.get(name) for name in pair):
        return None
    output, given = (parts[name] for name in pair)
    turned = all(isinstance(part, Negative) for part in output)
    above, below = (given, map(negative, output)) if turned else (map(negative, given), output)
    return _over(sum_of(above), sum_of(below))


def _coefficients(node: Expression, signals: Set[str]) -> dict[str, list[Expression]] | None:
    """Return the terms that multiply each signal; ``None`` if an expression is no linear form of signals."""
    held = [n.name for n in names(node) if n.name in signals]
    if not held:
        return {} if is_number(node, 0) else None
    found: dict[str, list[Expression]] = {}
    match node:
        case Name(name):
            return {name: [number(1)]}
        case Negative(operand):
            inner = _coefficients(operand, signals)
            return None if inner is None else {k: [negative(t) for t in v] for k, v in inner.items()}
        case Sum(terms):
            for term in terms:
                inner = _coefficients(term, signals)
                if inner is None:
                    return None
                for name, part in inner.items():
                    found.setdefault(name, []).extend(part)
            return found
        case Product(factors):
            holding = [f for f in factors if any(_holds(f, name) for name in held)]
            inner = _coefficients(holding[0], signals) if len(holding) == 1 else None
            if inner is None:
                return None
            for name, part in inner.items():
                found[name] = [product_of(sum_of(part) if f is holding[0] else f for f in factors)]
            return found
        case Quotient(above, below):
            inner = None if any(_holds(below, name) for name in held) else _coefficients(above, signals)
            return inner and {name: [_over(sum_of(part), below)] for name, part in inner.items()}
    return None


def _over(above: Expression, below: Expression) -> Expression:
    if isinstance(below, Quotient) and is_number(below.numerator, 1):
        return product_of([below.denominator, above])
    return above if is_number(below, 1) else quotient(above, below)


def _split(node: Expression, name: str) -> tuple[Expression, int] | None:
    """Return an expression without a name that is a factor, and the power it had; ``None`` if it is none."""
    if not _holds(node, name):
        return node, 0
    match node:
        case Name():
            return number(1), 1
        case Negative(operand):
            inner = _split(operand, name)
            return None if inner is None else (negative(inner[0]), inner[1])
        case Product(factors):
            holding = [f for f in factors if _holds(f, name)]
            inner = _split(holding[0], name) if len(holding) == 1 else None
            if inner is None:
                return None
            return product_of(inner[0] if f is holding[0] else f for f in factors), inner[1]
        case Quotient(above, below):
            top, bottom = _split(above, name), _split(below, name)
            if top is None or bottom is None:
                return None
            return _over(top[0], bottom[0]), top[1] - bottom[1]
    return None


_ORDER: Final = ("equal", "factor", "different", "not read", "other model")


def _rank(judged: JudgedFormula) -> tuple[int, int]:
    changes = len(judged.audit.changes) if judged.audit is not None else 0
    return _ORDER.index(judged.verdict), changes or 99


def _size(judged: JudgedFormula) -> int:
    """Return how much changes of a formula put in the place of what is printed."""
    changes = judged.audit.changes if judged.audit is not None else ()
    return sum(len(nodes(e)) for c in changes for e in (c.printed, c.derived))


def _judged(item: _Item, model: Model, audit: Audit) -> JudgedFormula:
    """Return what an audit says of a formula."""
    found = JudgedFormula(item.latex, item.label, item.equation.span, "not read", model=model, audit=audit)
    if audit.verdict in ("equal", "rounded"):
        reason = "" if audit.verdict == "equal" else "its numbers are right to the digits that it prints"
        return replace(found, verdict="equal", reason=reason)
    if audit.verdict != "differs":
        is_near = audit.verdict == "agrees"
        return replace(
            found, reason=f"it {VERDICTS['agrees']}" if is_near else f"not decided: {audit.unread}"
        )
    if audit.ratio is not None:
        return replace(found, verdict="factor", slip=_ratio_said(audit))
    where = f"it is right where {audit.taken}" if audit.taken else ""
    return replace(found, verdict="different", slip="; ".join(filter(None, (_changes_said(audit), where))))


def _ratio_said(audit: Audit) -> str:
    assert audit.ratio is not None
    return f"it is {format_expression(audit.ratio)} times the derived function"


def _changes_said(audit: Audit) -> str:
    said = []
    for change in audit.changes:
        printed, right = format_expression(change.printed), format_expression(change.derived)
        said.append(
            f"{change.place}: {printed} should be {right}"
            if printed != "0"
            else f"{change.place}: {right} is missing"
        )
    return "; ".join(said)


# --- slips of print ---


def _repaired(judged: JudgedFormula, court: _Court) -> JudgedFormula:
    """Return a formula with the slip of print, if any, without which it is right or nearly so."""
    assert judged.audit is not None and judged.model is not None
    printed = judged.audit.published
    for words, other in _misprints(printed):
        try:
            audit = court.audit(judged.model, other)
        except (SpecError, ModelError):
            continue
        except BudgetError:
            spend()
            continue
        if audit.verdict == "equal":
            return replace(judged, slip=words, misprint=words, repaired=audit)
        if audit.verdict == "differs" and (audit.ratio is not None or audit.changes):
            more = _ratio_said(audit) if audit.ratio is not None else _changes_said(audit)
            return replace(judged, slip=f"{words}; then {more}", misprint=words, repaired=audit)
    return judged


def _misprints(printed: Published) -> Iterator[tuple[str, Published]]:
    """Yield a formula without slips of print, with what each is."""
    root = "the bar of a root is too short"
    longer = _changed(printed, _with_longer_bars)
    bracketed = _changed(printed, _with_brackets)
    if longer is not None:
        yield root, longer
    if bracketed is not None:
        yield "brackets are missing after a factor", bracketed
        if longer is not None and (both := _changed(bracketed, _with_longer_bars)) is not None:
            yield f"brackets are missing after a factor, and {root}", both


def _changed(printed: Published, change: object) -> Published | None:
    apply = change  # a function of an expression
    expression = apply(printed.expression)  # type: ignore[operator]
    where = tuple((name, apply(line)) for name, line in printed.where)  # type: ignore[operator]
    is_same = expression == printed.expression and where == printed.where
    return None if is_same else replace(printed, expression=expression, where=where)


def _with_longer_bars(node: Expression) -> Expression:
    """Return an expression in which every root is over the factor after it as well."""
    parts = [_with_longer_bars(child) for child in node.children]
    if not isinstance(node, Product):
        return with_children(node, parts) if parts else node
    factors: list[Expression] = []
    for part in parts:
        before = factors[-1] if factors else None
        if isinstance(before, Call) and before.name == "sqrt" and isinstance(part, Name):
            factors[-1] = Call("sqrt", product_of([before.argument, part]))
        else:
            factors.append(part)
    return product_of(factors)


def _with_brackets(node: Expression) -> Expression:
    """Return an expression in which the factor in front of a sum's first term is in front of the sum."""
    parts = [_with_brackets(child) for child in node.children]
    whole = with_children(node, parts) if parts else node
    if not isinstance(whole, Sum):
        return whole
    first = whole.terms[0]
    inner = first.operand if isinstance(first, Negative) else first
    if not isinstance(inner, Product) or not any(isinstance(f, Call) for f in inner.factors):
        return whole
    last = max(i for i, f in enumerate(inner.factors) if isinstance(f, Call))
    if last == len(inner.factors) - 1:
        return whole
    front = product_of(inner.factors[: last + 1])
    rest = sum_of([product_of(inner.factors[last + 1 :]), *whole.terms[1:]])
    return product_of([negative(front) if first is not inner else front, rest])


def _with_scale(judged: JudgedFormula, scales: Iterable[Expression]) -> JudgedFormula:
    """Return a formula judged anew with the factor that another formula of the paper lacks."""
    audit = judged.repaired or judged.audit
    if (
        judged.verdict != "different"
        or audit is None
        or audit.changes
        or audit.taken
        or audit.ratio is not None
        or audit.published.scale is not None
    ):
        return judged
    for ratio in scales:
        candidates = [("", audit.published)]
        candidates += list(_misprints(audit.published)) if judged.repaired is None else []
        for words, published in candidates:
            scaled = replace(published, scale=quotient(number(1), ratio))
            try:
                again = judge(audit.tf, scaled)
            except SymflexError:
                continue
            said = [words] if words else []
            if again.verdict == "equal":
                said.append(f"it is {format_expression(ratio)} times the derived function")
            elif again.changes:
                said.append(_changes_said(again))
                said.append(f"the factor {format_expression(ratio)} is left out, as in other formulas")
            else:
                continue
            return replace(judged, slip="; ".join(said), misprint=words or judged.misprint, repaired=again)
    return judged


# --- what is shown ---


def referee_document(
    paper: str, judged: Sequence[JudgedFormula], tables: Sequence[JudgedTable] = ()
) -> dict[str, object]:
    """Return the document ``symflex referee --json`` prints."""
    return {
        "schema": SCHEMA,
        "paper": paper,
        "formulas": [
            {
                "label": j.label or None,
                "line": j.span.line,
                "column": j.span.column,
                "file": j.span.origin.source.name,
                "latex": j.latex,
                "verdict": j.verdict,
                "tf": None if j.audit is None else j.audit.tf.name,
                "model": None if j.model is None else j.model.title or None,
                "slip": j.slip or None,
                "reason": j.reason or None,
            }
            for j in judged
        ],
        "tables": [
            {"line": each.span.line, "file": each.span.origin.source.name}
            | (
                {"verdict": "other model", "reason": each.reason or None}
                if each.audit is None
                else table_json(each.audit)
            )
            for each in tables
        ],
    }


def referee_text(judged: Sequence[JudgedFormula], tables: Sequence[JudgedTable] = ()) -> str:
    """Return the verdicts as text."""
    blocks = []
    for j in judged:
        tf = f"{j.audit.tf.name}   " if j.audit is not None else ""
        lines = [f"{j.where}   {tf}{j.said}"]
        lines += [f"  {said}" for said in (j.slip, j.reason) if said]
        blocks.append("\n".join(lines))
    count = {verdict: sum(j.verdict == verdict for j in judged) for verdict in SAID}
    total = ", ".join(f"{n} {verdict}" for verdict, n in count.items() if n)
    shown = [f"table, line {t.span.line}   {_table_said(t)}" for t in tables]
    return "\n\n".join(
        [
            *blocks,
            *shown,
            f"{counted(len(judged), 'formula')}: {total}" if judged else "no displayed formulas",
        ]
    )


def _table_said(judged: JudgedTable) -> str:
    if judged.audit is None:
        return "not about the poles of these models" + (f": {judged.reason}" if judged.reason else "")
    return table_text(judged.audit).removeprefix(judged.audit.table.name).strip()


def referee_page(title: str, judged: Sequence[JudgedFormula], tables: Sequence[JudgedTable] = ()) -> Report:
    """Return a page with the formulas beside their verdicts, and what is wrong in tables."""
    sections = [
        Section(_heading(j.where), tuple(_shown(j)), f"formula-{i + 1}") for i, j in enumerate(judged)
    ]
    sections += [
        Section(f"Table, line {t.span.line}", (text(Code(_table_said(t))),), f"table-{i + 1}")
        for i, t in enumerate(tables)
    ]
    return Report(title, "printed formulas against models", "", tuple(sections), {}, (), 0)


def _heading(where: str) -> str:
    return f"L{where[1:]}" if where.startswith("line ") else where


def _shown(j: JudgedFormula) -> Iterator[Block]:
    yield marked(Badge(j.said, SAID[j.verdict][1]), "; ".join(filter(None, (j.slip, j.reason))))
    if j.audit is None or j.model is None or j.audit.published.scale is not None:
        yield text(Code(" ".join(j.latex.split())))
        return
    labels = _labels(j.audit, j.model)
    left_side = labelled(Quotient(*map(Name, j.audit.published.tf)), labels)
    yield equations(
        [(left_side, j.audit.published.expression)],
        labels,
        f"{j.audit.tf.name} as printed",
        j.audit.formula.lines,
    )
    best = j.repaired or j.audit
    if best.correction is not None:
        yield text("Right, in the same symbols:")
        yield equations(
            [(left_side, best.correction.expression)],
            labels,
            f"{j.audit.tf.name}, corrected",
            best.correction.lines,
        )
    elif j.repaired is not None:
        yield text("Without the slip:")
        yield equations(
            [(left_side, best.published.expression)],
            labels,
            f"{j.audit.tf.name}, repaired",
            best.formula.lines,
        )
    elif j.verdict == "different" and best.derived is not None:
        yield text("Derived, in the same symbols:")
        yield equations([(left_side, best.derived)], labels, f"{j.audit.tf.name}, derived")


def _labels(audit: Audit, model: Model) -> dict[str, str]:
    labels = model_labels(model)
    ends = [(name, "") for name in audit.published.tf if name not in labels]
    return labels_of([*ends, *((name, "") for name, _ in audit.formula.lines if name not in labels)], labels)


def errata_latex(judged: Sequence[JudgedFormula]) -> str:
    """Return a list of errata for LaTeX, to be read into a document."""
    items = []
    for j in judged:
        best = j.repaired or j.audit
        if j.verdict not in ("different", "factor") or best is None or j.model is None:
            continue
        labels = _labels(best, j.model)
        name = rf"Eq.~\eqref{{{j.label}}}" if j.label and not j.label.startswith("(") else j.label
        said = [
            f"for ${latex_expression(c.printed, labels)}$ read ${latex_expression(c.derived, labels)}$"
            for c in best.changes
        ]
        said = [j.misprint, *said] if j.misprint else said
        if best.ratio is not None:
            said.append(f"divide the right side by ${latex_expression(best.ratio, labels)}$")
        elif best.published.scale is not None and best is j.repaired:
            said.append(f"multiply the right side by ${latex_expression(best.published.scale, labels)}$")
        said += [f"it holds where {best.taken}"] if best.taken else []
        right = best.correction.expression if best.correction is not None else best.derived
        if not said and right is not None:
            said.append(f"the right side should be ${latex_expression(right, labels)}$")
        if said:
            items.append(rf"  \item {name or f'Line {j.span.line}'}: {'; '.join(said)}.")
    return "\n".join([r"\begin{itemize}", *items, r"\end{itemize}", ""]) if items else "% no errata\n"


__all__ = [
    "JudgedFormula",
    "JudgedTable",
    "errata_latex",
    "referee",
    "referee_document",
    "referee_page",
    "referee_tables",
    "referee_text",
]

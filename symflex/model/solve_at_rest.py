"""Equilibrium values that follow from the equations: as formulas where they can be, else as enclosed numbers.

Input: the residual of each equation at equilibrium, and the names to be solved for, with the values that some
are declared with. Output: a definition for each formula, a number for each other name.

    m*g - C*i_0^2/x_0^2 = 0      i_0 = sqrt(m*g*x_0^2/C), of two roots that with the declared sign
    k*x_0 - c/(d - x_0)^2 = 0    the solution that the declared x_0 leads to

A solution is taken if declared values lead to it, see :mod:`symflex.balls.solutions`, and none is found that
is nearer. Others are listed in a message.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import partial
from random import Random
from typing import TYPE_CHECKING

from flint import arb

from symflex.balls import ball, precision
from symflex.balls.solutions import DIGITS, EquationSystem
from symflex.expressions import (
    Call,
    Equation,
    Expression,
    Name,
    Negative,
    Number,
    Product,
    Quotient,
    Sum,
    format_expression,
    is_number,
    negative,
    nodes,
    number,
    power,
    product_of,
    quotient,
    replace_node,
    replace_values,
    sum_of,
)
from symflex.expressions.derivative import derivative, simplified
from symflex.model.constants_at_rest import BITS, Constants, is_positive, is_zero
from symflex.model.declarations import assuming
from symflex.model.model import Definition, FoundValue, ModelParameter
from symflex.model.reading import Reader, literal_value

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence


EXAMPLE = 'for instance x = "x_0", i = "i_0", solve = ["i_0"]'
CLOSER = "declare a value closer to the one you mean: from there, equations must take every value but once"
CLOSE = 1e-3  # share of a declared value within which no other solution is looked for
BETWEEN = 8  # guesses to either side of a declared value at which one may be nearer, or of several unknowns
DECADES = 3  # to either side of a declared value in which others are looked for
ALL_DECADES = 12  # and of 1 if none is declared
A_DECADE = 6  # guesses
GUESSES = 100  # of several unknowns
INVERSES: Mapping[str, Callable[[Expression], Expression]] = {
    "sqrt": lambda y: power(y, 2),
    "exp": lambda y: Call("log", y),
    "log": lambda y: Call("exp", y),
    "atan": lambda y: Call("tan", y),
}
"""What the argument of a function is where the function is y."""
SHOWN = 4  # solutions that a message lists


@dataclass(frozen=True)
class Left:
    """What is left over of an equation at equilibrium."""

    residual: Expression
    equation: Equation
    unsolved: Expression | None = None  # the residual before formulas were put in


@dataclass
class _Coupled:
    """Equations that declared values are to solve together, and formulas that are put into them."""

    names: list[str]
    rows: list[Expression]
    alone: list[str] = field(default_factory=list)  # solved for in one equation that nothing else depends on

    def put(self, name: str, formula: Expression) -> None:
        """Put a formula in place of a name."""
        self.rows = [simplified(r, {name: formula}) if Name(name) in nodes(r) else r for r in self.rows]

    def drop(self, name: str, formula: Expression, row: int) -> bool:
        """Take a name out with its own equation, if paths to solutions are the same without; tell whether."""
        holding = [i for i, r in enumerate(self.rows) if Name(name) in nodes(r)]
        slopes = [derivative(self.rows[i], Name(name)) for i in holding]
        is_linear = all(Name(n) not in nodes(slope) for slope in slopes for n in self.names)
        if not is_linear and holding != [row]:
            return False
        if not is_linear:
            self.alone.append(name)
        self.names.remove(name)
        del self.rows[row]
        self.put(name, formula)
        return True


@dataclass
class Solving:
    """Solves equations at equilibrium for names."""

    reader: Reader
    constants: Constants
    definitions: list[Definition] = field(default_factory=list)
    by_value: dict[str, Fraction] = field(default_factory=dict)
    used: set[str] = field(default_factory=set)  # names whose values were used
    found: list[FoundValue] = field(default_factory=list)
    calls: dict[Expression, Expression] = field(
        default_factory=dict
    )  # what inverted functions are at equilibrium
    _boxes: dict[str, arb] = field(default_factory=dict)  # of what was solved by value

    def solve(self, residuals: Sequence[Left], names: Sequence[str]) -> tuple[list[Left], list[str]]:
        """Solve for names; return what is left of other equations, and the names that nothing determines."""
        wanted, formulas = list(names), list[tuple[str, Left]]()
        start = {p: self.constants.known.pop(p) for p in names if p in self.constants.known}
        may_vanish = start.keys() & self.constants.signed
        rows = [_without_factor(each, wanted, may_vanish) for each in residuals]
        while not self.reader.problems:
            found = [
                (p, solution, each)
                for each in rows
                for p in wanted
                if (solution := self._formula(each.residual, p, wanted)) is not None
            ]
            if not found:
                # Once these have values, others that have no declared one may have formulas.
                first, known = _first_block(rows, wanted, start)
                if not known:
                    break
                self._solve_by_value([], first, known, start)
                rows = [r for r in rows if r not in first]
                wanted = [p for p in wanted if p not in known]
                continue
            others = [len({Name(p) for p in wanted} & {*nodes(solution)}) for _, solution, _ in found]
            unknown, solution, row = found[others.index(min(others))]
            if unknown in self.constants.signed and isinstance(solution, Call) and start.get(unknown, 1) < 0:
                solution = negative(solution)  # of two roots, the declared
            wanted.remove(unknown)
            self.constants.expressions[unknown] = solution
            root = solution.operand if isinstance(solution, Negative) else solution
            if isinstance(root, Call):  # whose square alone may be left in formulas
                self.used |= self.constants.deciding(is_positive, root.argument) or set()
            self.definitions.append(Definition(unknown, solution, "", row.equation.span))
            if (pair := _one_call(row.residual, unknown, [unknown, *wanted])) is not None:
                self.calls |= {pair[0]: replace_values(pair[1], self.calls)}
            formulas.append((unknown, row))
            values = {unknown: solution} if min(others) else {}
            kept = [replace(r, residual=replace_values(r.residual, self.calls)) for r in rows if r is not row]
            rows = [replace(r, residual=simplified(r.residual, values)) for r in kept]
        ours = [r for r in rows if any(Name(p) in nodes(r.residual) for p in wanted)]
        together = [p for p in wanted if any(Name(p) in nodes(r.residual) for r in ours)]
        ours = ours[: len(together)]
        if len(ours) < len(together):
            ours, together = [], []
        self._solve_by_value(formulas, ours, together, start)
        self.constants.known |= self._boxes
        self.found = [f for p in names if (f := self._found(p, start.get(p))) is not None]
        return [r for r in rows if r not in ours], [p for p in wanted if p not in together]

    def _formula(self, residual: Expression, unknown: str, wanted: Collection[str]) -> Expression | None:
        """Return a formula for the value at which a residual vanishes, None if none is seen."""
        formula = _solved(residual, unknown, wanted)
        if formula is not None:
            # D*X = mu(S)*X says nothing of X where mu(S) = D.
            is_any = self.constants.vanishes(derivative(residual, Name(unknown)))
            return None if is_any else formula
        if (formula := _inverted(residual, unknown, wanted)) is None:
            return None
        # A root has one sign, and an arctangent does not take every value.
        deciding = self.constants.deciding(is_zero, simplified(residual, {unknown: formula}))
        if deciding is None:
            return None
        self.used |= deciding
        return formula

    def _found(self, name: str, start: arb | None) -> FoundValue | None:
        """Return a value beside the declared one; None without a value."""
        value = self.constants.here(Name(name))
        if value is None or not value.is_finite():
            return None
        with precision(BITS):
            scale, unit = unit_of_value(self.constants.declared.get(name))
            scaled, declared = value / scale, None if start is None else start / scale
            middle = Fraction(0 if scaled.contains(0) else scaled.mid().str(DIGITS, radius=False))
            radius = abs(scaled - ball(middle)).upper()
            return FoundValue(
                name,
                middle,
                Fraction(radius.str(3, radius=False)) * (1 + Fraction(1, 100)),
                unit,
                None if declared is None else Fraction(declared.mid().str(DIGITS, radius=False)),
            )

    def _solve_by_value(
        self,
        formulas: Sequence[tuple[str, Left]],
        rows: Sequence[Left],
        unknowns: Sequence[str],
        start: Mapping[str, arb],
    ) -> None:
        """Take the solution that declared values lead to; note what there is if they lead to none."""
        constants, owners = self.constants, dict(formulas)
        self.used |= {n for r in rows for n in constants.behind(r.residual)}
        if {*unknowns} <= {*start}:
            coupled = self._coupled(formulas, rows, unknowns, start)
        else:
            coupled = _Coupled([*unknowns], [r.residual for r in rows])
        if coupled.names:
            given = [start[p] for p in coupled.names] if {*coupled.names} <= {*start} else None
            signed = constants.signed | {*owners}
            search = _Search(constants, coupled.rows, coupled.names, given, signed)
            solution = search.solution()
            first = rows[0] if rows else owners[coupled.names[0]]
            if solution is None and (rows or search.is_evaluated):
                self._note_none(first, search)
                return
            for p, x in zip(coupled.names, solution or (), strict=False):
                if p in unknowns:
                    middle = arb(0) if x.contains(0) else x.mid()
                    constants.known[p], self._boxes[p] = middle, x.union(middle)
                    self.by_value[p] = Fraction(middle.str(DIGITS, radius=False))
        for unknown, row in formulas:
            self._check(unknown, row, start.get(unknown) if unknown in coupled.alone else None)

    def _coupled(
        self,
        formulas: Sequence[tuple[str, Left]],
        rows: Sequence[Left],
        unknowns: Sequence[str],
        start: Mapping[str, arb],
    ) -> _Coupled:
        """Return the equations in which declared values depend on each other."""
        owned = [(p, row) for p, row in formulas if p in start]
        written = [r.unsolved or r.residual for r in (*rows, *(row for _, row in owned))]
        names = {*unknowns, *(p for p, _ in owned)}
        coupled = _Coupled([p for p in start if p in names], written)
        meaning = {p: self.constants.expressions[p] or number(0) for p, _ in formulas}
        for p, _ in formulas:
            if p not in start:
                coupled.put(p, meaning[p])
        remaining = [p for p, _ in owned]
        while dropped := next(
            (p for i, p in enumerate(remaining) if coupled.drop(p, meaning[p], len(rows) + i)), None
        ):
            remaining.remove(dropped)
        return coupled

    def _check(self, unknown: str, row: Left, start: arb | None) -> None:
        """Note a formula whose value is not the solution that the declared value leads to."""
        value = self.constants.here(Name(unknown))
        if value is not None and value.is_finite() and start is not None:
            search = _Search(self.constants, [row.residual], [unknown], [start], {unknown})
            solution = search.solution()
            if search.is_evaluated and (solution is None or not solution[0].overlaps(value)):
                self._note_none(row, search)

    def _note_none(self, row: Left, search: _Search) -> None:
        """Note that no solution belongs to declared values, with those that are found elsewhere."""
        named, shown = ", ".join(search.unknowns), format_expression(row.residual)
        message = f"'{named}' is not found: {shown} has no root next to its value"
        hint = f"give '{named}' a value close to the one at equilibrium, and all other parameters theirs"
        others = self._listed(search, search.others[:SHOWN]) or "none"
        if search.doubtful:
            meant = self._listed(search, [search.doubtful])
            message = f"'{named}' is in doubt: the declared value leads to {meant}, but nearer is {others}"
            hint = CLOSER
        elif search.negative:
            meant = self._listed(search, [search.negative])
            message = f"'{named}' is assumed positive, but leads to {meant}; found elsewhere: {others}"
            hint = f"{assuming(search.unknowns[0], 'real')}, or a value closer to the one you mean"
        elif search.is_evaluated:
            message += f"; found elsewhere: {others}"
            hint = CLOSER
        if not self.constants.declared.keys() >= {
            *search.unknowns
        }:  # made names of unknowns cannot be given one
            message = f"'{named}' is not found: {shown} = 0 has no formula for it, and no value is declared"
            message += f"; found: {others}" if search.is_evaluated else ""
            hint = f"declare parameters with values close to those at equilibrium, {EXAMPLE}"
        self.reader.note("SF407", message, row.equation.span, hint)

    def _listed(self, search: _Search, solutions: Iterable[Sequence[arb]]) -> str:
        """Return solutions with their distance from what is declared."""
        shown = []
        for solution in solutions:
            values = zip(search.unknowns, solution, strict=True)
            text = ", ".join(f"{p} = {self._shown(p, x)}" for p, x in values)
            if search.start:
                pairs = zip(search.unknowns, solution, search.start, strict=True)
                text += f" ({', '.join(self._shown(p, abs(x - y)) for p, x, y in pairs)} away)"
            shown.append(text)
        return " or ".join(shown)

    def _shown(self, name: str, value: arb) -> str:
        """Return a value in the unit that its parameter was declared in."""
        scale, unit = unit_of_value(self.constants.declared.get(name))
        size = 0.0 if value.contains(0) else float(value.mid() / scale)
        return f"{size:.6g} {unit}".rstrip()


def unit_of_value(parameter: ModelParameter | None) -> tuple[arb, str]:
    """Return the size of the unit that a parameter was declared in, and the unit."""
    if parameter is None or not parameter.written_unit:
        return arb(1), ""
    scale = parameter.scale
    return ball(scale.rational) * arb.pi() ** scale.pi_power, parameter.written_unit


class _Search:
    """Looks for solutions of equations: the one that declared values lead to, and others."""

    def __init__(
        self,
        constants: Constants,
        residuals: Sequence[Expression],
        unknowns: Sequence[str],
        start: Sequence[arb] | None,  # the declared values, None without them
        signed: Collection[str],  # which may be negative
    ) -> None:
        self.unknowns, self.start = unknowns, start
        self.others: list[list[arb]] = []  # the nearest first
        self.doubtful: list[arb] | None = None  # what declared values lead to, but others are nearer
        self.negative: list[arb] | None = None  # what they lead to, but parameters are assumed positive
        self.is_evaluated = True  # all other parameters have values
        self._may_be_negative = [p in signed or start is None for p in unknowns]
        slopes = [derivative(r, Name(p)) for r in residuals for p in unknowns]

        def enclosed(expressions: Sequence[Expression], box: Sequence[arb]) -> list[arb]:
            known = constants.known | dict(zip(unknowns, box, strict=True))
            return [constants.value(e, dict(known), None) for e in expressions]

        self._system = EquationSystem(partial(enclosed, residuals), partial(enclosed, slopes))

    def solution(self) -> list[arb] | None:
        """Return the solution that declared values lead to, None if there is none or others are nearer."""
        with precision(BITS):
            try:
                if self.start is None:
                    self.others = self._found(self._anywhere(), [arb(1)] * len(self.unknowns))
                    return None
                solution = self._system.followed(self.start)
                if solution is not None and not self._is_allowed(solution):
                    solution, self.negative = None, solution
                if solution is None:
                    self.others = self._found(self._anywhere(), self.start)
                    return None
                self.others = self._nearer(solution, self.start)
            except KeyError:
                self.is_evaluated = False
                return None
        self.doubtful = solution if self.others else None
        return None if self.others else solution

    def _found(self, guesses: Iterable[Sequence[arb]], scale: Sequence[arb]) -> list[list[arb]]:
        """Return the solutions that guesses lead to and that parameters may have, the nearest first."""
        start = self.start or [arb(0)] * len(self.unknowns)
        found = filter(self._is_allowed, self._system.near(guesses, scale))
        return sorted(found, key=lambda x: max(map(_distance, x, start)))

    def _is_allowed(self, solution: Sequence[arb]) -> bool:
        return all(may or x > 0 for may, x in zip(self._may_be_negative, solution, strict=True))

    def _nearer(self, solution: Sequence[arb], start: Sequence[arb]) -> list[list[arb]]:
        """Return solutions that are no farther from the start in any unknown."""
        reach = [abs(x - y).mid() for x, y in zip(solution, start, strict=True)]
        if all(r <= CLOSE * abs(y) for r, y in zip(reach, start, strict=True)):
            return []
        if len(start) == 1:
            steps: Iterable[Sequence[float]] = ([k / BETWEEN] for k in range(-BETWEEN, BETWEEN + 1))
        else:
            random = Random(1)
            steps = ([random.uniform(-1, 1) for _ in start] for _ in range(BETWEEN))
        guesses = ([y + r * t for y, r, t in zip(start, reach, step, strict=True)] for step in steps)
        return [
            x
            for x in self._found(guesses, start)
            if not all(map(arb.overlaps, x, solution))
            and not any(abs(a - y) > r for a, y, r in zip(x, start, reach, strict=True))
        ]

    def _anywhere(self) -> Iterator[Sequence[arb]]:
        """Yield guesses of all sizes about the declared values, or 1."""
        start = self.start or [arb(0)] * len(self.unknowns)
        sizes = [(abs(y), DECADES) if y != 0 else (arb(1), ALL_DECADES) for y in start]
        random = Random(1)
        if len(start) == 1:
            size, most = sizes[0][0], A_DECADE * sizes[0][1]
            for k in sorted(range(-most, most + 1), key=abs):
                x = size * arb(10) ** (arb(k) / A_DECADE)
                yield from ([x], [-x]) if self._may_be_negative[0] else ([x],)
            return
        for _ in range(GUESSES):
            signs = [random.choice((-1, 1)) if may else 1 for may in self._may_be_negative]
            powers = [random.uniform(-decades / 2, decades / 2) for _, decades in sizes]
            yield [n * x * arb(10) ** p for n, (x, _), p in zip(signs, sizes, powers, strict=True)]


def _first_block(
    rows: Sequence[Left], wanted: Sequence[str], start: Collection[str]
) -> tuple[list[Left], list[str]]:
    """Return the equations that declared names alone solve, and these names, if other rows have more."""
    held = [[p for p in wanted if Name(p) in nodes(r.residual)] for r in rows]
    first = [r for r, columns in zip(rows, held, strict=True) if columns and {*columns} <= {*start}]
    known = [p for p in wanted if any(Name(p) in nodes(r.residual) for r in first)]
    is_square = len(first) == len(known) and any(not {*columns} <= {*start} for columns in held)
    return (first, known) if is_square else ([], [])


def _distance(x: arb, start: arb) -> float:
    """Return how far a value is from the declared one, as a share of it."""
    return float(abs(x - start) / (abs(start) if start != 0 else 1))


def _solved(residual: Expression, unknown: str, wanted: Collection[str]) -> Expression | None:
    """Return the value for which a residual vanishes, if that is linear in it or in its square."""
    residual = _over_one_line(residual, unknown)
    slope = simplified(derivative(residual, Name(unknown)), {})
    if is_number(slope, 0):
        return None
    second = simplified(derivative(slope, Name(unknown)), {})
    size = second.operand if isinstance(second, Negative) else second
    if isinstance(size, Sum) and None not in (numbers := [*map(literal_value, size.terms)]):
        total = number(sum(n for n in numbers if n is not None))  # of x*x it is 1 + 1
        second = total if size is second else negative(total)
    below = slope if is_number(second, 0) else second
    if any(Name(p) in nodes(below) for p in wanted):
        return None
    constant = simplified(residual, {unknown: number(0)})
    if below is slope:
        return negative(_over(constant, slope))
    if not is_number(simplified(slope, {unknown: number(0)}), 0):
        return None
    return Call("sqrt", negative(_over(product_of([number(2), constant]), second)))


def _inverted(residual: Expression, unknown: str, wanted: Collection[str]) -> Expression | None:
    """Return a formula for an unknown that occurs in the argument of one function only."""
    if (found := _one_call(residual, unknown, wanted)) is None:
        return None
    call, value = found
    inner = sum_of([call.argument, negative(INVERSES[call.name](value))])
    return _solved(inner, unknown, wanted)


def _one_call(residual: Expression, unknown: str, wanted: Collection[str]) -> tuple[Call, Expression] | None:
    """Return the only function that has an unknown in its argument, and its value at equilibrium."""
    calls = [n for n in nodes(residual) if isinstance(n, Call) and Name(unknown) in nodes(n.argument)]
    if not calls or calls[0].name not in INVERSES:
        return None
    argument = Name(f"({unknown})")  # which nothing is called
    value = _solved(replace_node(residual, calls[0], argument), argument.name, [*wanted, argument.name])
    if value is None or Name(unknown) in nodes(value) or isinstance(value, Call):
        return None
    return calls[0], value


def _without_factor(equation: Left, wanted: Collection[str], may_vanish: Collection[str]) -> Left:
    """Return what else vanishes, of a product with a wanted name and another: ``X_0*(mu_0 - D)``."""
    residual = equation.residual
    for p in wanted:
        if p in may_vanish:
            continue  # a declared value decides which of both vanishes
        slope = simplified(derivative(residual, Name(p)), {})
        other = {Name(n) for n in wanted} & {*nodes(slope)}
        if other and Name(p) not in other and is_number(simplified(residual, {p: number(0)}), 0):
            return Left(slope, equation.equation, slope)
    return replace(equation, unsolved=residual)


def _over_one_line(residual: Expression, unknown: str) -> Expression:
    """Return a residual times the denominators of its terms that have an unknown."""
    terms = residual.terms if isinstance(residual, Sum) else (residual,)
    for term in terms:
        part = term.operand if isinstance(term, Negative) else term
        if isinstance(part, Quotient) and Name(unknown) in nodes(part.denominator):
            others = [product_of([t, part.denominator]) for t in terms if t is not term]
            above = part.numerator if part is term else negative(part.numerator)
            return _over_one_line(sum_of([*others, above]), unknown)
    return residual


def _over(above: Expression, below: Expression) -> Expression:
    """Return a quotient with one line, and without a number that both parts have."""
    if isinstance(below, Negative):
        return negative(_over(above, below.operand))
    if isinstance(below, Sum) and isinstance(below.terms[0], Negative):
        return negative(_over(above, sum_of(map(negative, below.terms))))
    if isinstance(below, Quotient):
        above, below = product_of([above, below.denominator]), below.numerator
    factor = next(
        (n.value for n in nodes(below)[: 1 + isinstance(below, Product)] if isinstance(n, Number)), 1
    )
    both = ((product_of([number(1 / Fraction(factor)), each])) for each in (above, below))
    return quotient(*both)

"""Whether boundary-value problems are well posed, as far as their text tells.

Input: the fields as read, and what the model's names mean.
Output: what is wrong with domains, equations, points and the number of conditions. Fields whose conditions
name each other's unknowns are one problem, and their orders and conditions are counted together.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE
from symflex.expressions import (
    Call,
    Derivative,
    Equation,
    Expression,
    Name,
    Negative,
    Number,
    Sum,
    format_expression,
    measured,
    names,
    names_among,
    substitute,
)
from symflex.library.elements import LineElement
from symflex.model.along import COORDINATE, varies_along_x
from symflex.model.independence import RandomPoint, Repetition, repetitions
from symflex.model.linearity import check_equation, check_expression
from symflex.model.reading import QuantityLiteral, Reader
from symflex.model.units import lower

if TYPE_CHECKING:
    from symflex.model.model import Definition, FieldProblem, PlacedBlock, PlacedElement
    from symflex.model.scope import ModelScope
    from symflex.model.signs import Line

ORDER_LIMIT = 12
SHOWN_NAMES = 6


@dataclass(frozen=True, slots=True)
class Surroundings:
    """What the fields of a model stand among."""

    scope: ModelScope  # what names mean
    definitions: Mapping[str, Expression]  # each uses only earlier ones
    varying: frozenset[str]  # names of constants that depend on s: definitions and blocks
    line: Line  # where points lie


@dataclass(frozen=True, slots=True)
class _Condition:
    """A condition with its field, and the fields and places whose values it holds."""

    field: FieldProblem
    equation: Equation
    calls: tuple[Call, ...]


def varying_constants(definitions: Sequence[Definition], blocks: Sequence[PlacedBlock]) -> frozenset[str]:
    """Return the names of constants that depend on s; the definitions stand in order of use."""
    varying = {b.name for b in blocks}
    for definition in definitions:
        if names_among(definition.expression, {*varying, LAPLACE}):
            varying.add(definition.name)
    return frozenset(varying)


def depends_on_s(expression: Expression, varying: frozenset[str]) -> bool:
    """Tell whether an expression of constants depends on s."""
    return bool(names_among(expression, {*varying, LAPLACE}))


def check_fields(reader: Reader, fields: Sequence[FieldProblem], around: Surroundings) -> frozenset[str]:
    """Note what is wrong with fields but units and points; return names of those with a sound domain."""
    orders: dict[str, int] = {}
    placed: set[str] = set()
    point = RandomPoint(around.scope, around.definitions)
    for field in fields:
        if _check_domain(reader, field, around):
            placed.add(field.name)
        order = _check_equations(reader, field, around, point)
        if order is not None:
            orders[field.name] = order
    conditions: list[_Condition] = []
    sound = len(orders) == len(placed) == len(fields)
    for field in fields:
        for equation in field.conditions:
            problems = check_equation(equation, around.scope)
            reader.take(problems)
            unknowns = around.scope.unknowns
            calls = tuple(n for n in names(equation) if isinstance(n, Call) and n.name in unknowns)
            if not problems and not calls:
                message = f"this condition of field '{field.name}' contains no value of a field"
                reader.note("SF248", message, equation.span, f"for instance {field.unknowns[0]}(0) = 0")
            sound = sound and bool(calls) and not problems
            conditions.append(_Condition(field, equation, calls))
    if sound and not around.scope.broken:
        _check_counts(reader, fields, orders, conditions, point)
    return frozenset(placed)


@dataclass(frozen=True, slots=True)
class Stretch:
    """Where the points of a field or of an element that extends along x may lie."""

    what: str  # in words, for messages
    names: tuple[str, ...]  # what is evaluated at points of it
    # start and end: where x begins and ends.
    start: Expression
    end: Expression


def stretches(fields: Sequence[FieldProblem], elements: Sequence[PlacedElement]) -> tuple[Stretch, ...]:
    """Return the stretches of a model; of elements, x runs from 0 at the first end."""
    every = [Stretch(f"the domain of field '{f.name}'", f.unknowns, f.start, f.end) for f in fields]
    for use in elements:
        element = use.element
        if isinstance(element, LineElement) and element.length in dict(use.values):
            names = tuple(f"{use.name}.{name}" for quantity in element.along for name in quantity)
            length = dict(use.values)[element.length]
            every.append(Stretch(f"{element.type_name} '{use.name}'", names, Number(Fraction(0)), length))
    return tuple(every)


def check_points(
    reader: Reader, expression: Expression, along: Sequence[Stretch], around: Surroundings
) -> None:
    """Note every point of an expression that depends on s or lies outside what it is a point of."""
    owners = {name: stretch for stretch in along for name in stretch.names}
    noted = {p.span for p in reader.problems}
    inside: set[tuple[str, Expression]] = set()
    for call in (n for n in names(expression) if isinstance(n, Call)):
        stretch, position = owners.get(call.name), call.argument
        if stretch is None or (stretch.what, position) in inside or position.span in noted:
            continue
        if depends_on_s(position, around.varying):
            reader.note("SF249", "a point along x cannot depend on s", position.span)
            continue
        sides = ((stretch.start, "before the start", -1), (stretch.end, "beyond the end", 1))
        wrong = [
            (end, word) for end, word, sign in sides if around.line.sign(_difference(position, end)) == sign
        ]
        for end, word in wrong:
            point, limit = _named(position, around.line), _named(end, around.line)
            reader.note("SF240", f"the point {point} lies {word} of {stretch.what}, {limit}", position.span)
        if not wrong:
            inside.add((stretch.what, position))


def _difference(left: Expression, right: Expression) -> Expression:
    return Sum((lower(left), Negative(lower(right))))


def _written(position: Expression) -> str:
    if isinstance(position, QuantityLiteral) or measured(position):
        return position.span.text if position.span else format_expression(position)
    return format_expression(position)


def _named(position: Expression, line: Line) -> str:
    """Return a place as written, with its value when it has one that differs from what is written."""
    value, text = line.value(position), _written(position)
    shown = "" if value is None else f"{float(value):.6g}"
    return f"'{text}'" if value is None or shown == text else f"'{text}' ({shown})"


def _check_domain(reader: Reader, field: FieldProblem, around: Surroundings) -> bool:
    good = True
    for end in (field.start, field.end):
        if isinstance(end, QuantityLiteral):
            continue
        problems = check_expression(end, around.scope, constant=True)
        reader.take(problems)
        good = good and not problems
        if not problems and depends_on_s(end, around.varying):
            reader.note("SF249", f"the domain of field '{field.name}' cannot depend on s", end.span)
            good = False
    sign = around.line.sign(_difference(field.end, field.start)) if good else None
    if sign is not None and sign <= 0:
        word = "where it begins" if sign == 0 else "before it begins"
        ends = " to ".join(_named(e, around.line) for e in (field.start, field.end))
        message = f"the domain of field '{field.name}' ends {word}: {ends}"
        reader.note("SF240", message, field.end.span or field.span, "write the smaller end first")
        good = False
    return good


def _check_equations(
    reader: Reader, field: FieldProblem, around: Surroundings, point: RandomPoint
) -> int | None:
    """Return the order in x of a field's equations, ``None`` when something is wrong with them."""
    inside = around.scope.within(field.unknowns)
    problems = [p for e in field.equations for p in check_equation(e, inside)]
    reader.take(problems)
    if problems:
        return None
    orders_of = [_orders(e, field.unknowns) for e in field.equations]
    for equation, orders in zip(field.equations, orders_of, strict=True):
        if not orders:
            wanted = ", ".join(field.unknowns)
            message = f"this equation of field '{field.name}' contains none of its unknowns ({wanted})"
            reader.note("SF242", message, equation.span)
            return None
    for unknown in field.unknowns:
        if not any(unknown in orders for orders in orders_of):
            message = f"the unknown '{unknown}' of field '{field.name}' appears in none of its equations"
            reader.note("SF242", message, field.span)
            return None
    if not inside.broken and _repeat(reader, field, point):
        return None
    highest = {u: max(orders.get(u, 0) for orders in orders_of) for u in field.unknowns}
    order = sum(highest.values())
    if order == 0:
        message = f"the equations of field '{field.name}' contain no derivative along x"
        reader.note("SF242", message, field.equations[0].span, f"write it with primes: {field.unknowns[0]}''")
        return None
    if order > ORDER_LIMIT:
        message = f"field '{field.name}' is of order {order} in x; at most {ORDER_LIMIT} is allowed"
        reader.note("SF103", message, field.equations[0].span, "split what is independent into two fields")
        return None
    if not _can_be_solved(orders_of, highest):
        leading = " and ".join(u + "'" * k for u, k in highest.items())
        message = f"the equations of field '{field.name}' do not determine its highest derivatives, {leading}"
        hint = "each needs an equation of its own; substitute one equation into another to get it"
        reader.note("SF242", message, field.equations[0].span, hint)
        return None
    return order


def _repeat(reader: Reader, field: FieldProblem, point: RandomPoint) -> bool:
    """Note equations that repeat or contradict earlier ones, and tell whether there are any."""
    along = point.within(field.unknowns)
    try:
        repeated = repetitions([along.condition(e) for e in field.equations])
    except ZeroDivisionError:
        return False  # reported where the equations are assembled
    for repetition in repeated:
        message = _repetition_message("equation", repetition, field.equations)
        hint = "each unknown needs an equation of its own"
        reader.note("SF242", message, field.equations[repetition.condition].span, hint)
    return bool(repeated)


def _repetition_message(what: str, repetition: Repetition, equations: Sequence[Equation]) -> str:
    others = [equations[i] for i in repetition.others]
    lines = sorted({e.span.line if e.span else 0 for e in others})
    texts = " and ".join(f"'{e.span.text if e.span else format_expression(e)}'" for e in others)
    where = f" (line {', '.join(map(str, lines))})" if lines and lines[0] else ""
    if repetition.contradicts:
        return f"this {what} contradicts {texts}{where}"
    if others:
        return f"this {what} repeats {texts}{where}"
    return f"this {what} says nothing: its terms cancel"


def _orders(equation: Equation, unknowns: Sequence[str]) -> dict[str, int]:
    """Return the highest derivative of every unknown in an equation."""
    orders: dict[str, int] = {}
    for node in names(equation):
        if isinstance(node, Name | Derivative) and node.name in unknowns:
            order = node.order if isinstance(node, Derivative) else 0
            orders[node.name] = max(order, orders.get(node.name, 0))
    return orders


def _can_be_solved(orders_of: Sequence[Mapping[str, int]], highest: Mapping[str, int]) -> bool:
    """Tell whether every unknown's highest derivative can be given its own equation that contains it."""
    chosen: dict[int, str] = {}

    def place(unknown: str, tried: set[int]) -> bool:
        for i, orders in enumerate(orders_of):
            if orders.get(unknown) == highest[unknown] and i not in tried:
                tried.add(i)
                if i not in chosen or place(chosen[i], tried):
                    chosen[i] = unknown
                    return True
        return False

    return all(place(unknown, set()) for unknown in highest)


def _check_counts(
    reader: Reader,
    fields: Sequence[FieldProblem],
    orders: Mapping[str, int],
    conditions: Sequence[_Condition],
    point: RandomPoint,
) -> None:
    """Note repeated conditions, and too few or too many of them, for every group of joined fields."""
    owners = {unknown: field.name for field in fields for unknown in field.unknowns}
    joined = _joined([f.name for f in fields], [{owners[call.name] for call in c.calls} for c in conditions])
    for group in joined:
        members = [f for f in fields if f.name in group]
        of_group = [c for c in conditions if owners[c.calls[0].name] in group]
        try:
            _check_group(reader, members, orders, of_group, point)
        except ZeroDivisionError:
            continue  # reported where the equations are assembled


def _joined(group_names: Sequence[str], links: Sequence[set[str]]) -> list[set[str]]:
    """Return the groups of names that links connect, in order."""
    groups: list[set[str]] = [{n} for n in group_names]
    for link in links:
        touched = [g for g in groups if g & link]
        merged = set[str]().union(*touched)
        groups = [merged if g is touched[0] else g for g in groups if g is touched[0] or g not in touched]
    return groups


def _check_group(
    reader: Reader,
    members: Sequence[FieldProblem],
    orders: Mapping[str, int],
    conditions: Sequence[_Condition],
    point: RandomPoint,
) -> None:
    order = sum(orders[f.name] for f in members)
    repeated = repetitions([point.condition(c.equation) for c in conditions])
    dropped = {r.condition for r in repeated}
    kept = [c for i, c in enumerate(conditions) if i not in dropped]
    places = _PlaceCounts(members, orders, kept, point)
    missing = order - len(kept)
    has_tip = any(_has_tip(f, point) for f in members)
    for repetition in repeated:
        message = _repetition_message("condition", repetition, [c.equation for c in conditions])
        hint = "keep one of them" if repetition.contradicts else "remove it"
        if missing > 0 and not has_tip:
            hint = f"another condition is needed in its place{places.likely()}"
        reader.note("SF244", message, conditions[repetition.condition].equation.span, hint)
    if missing == 0 or (repeated and missing > 0):
        return
    if missing > 0 and has_tip:
        return  # that solutions are finite there counts, for which exponents are needed: see the equations
    shown = [f"'{f.name}'" for f in members[:SHOWN_NAMES]] + ["..."][: len(members) > SHOWN_NAMES]
    who = f"field {shown[0]} has" if len(members) == 1 else f"fields {', '.join(shown)} together have"
    count = "1 condition" if len(kept) == 1 else f"{len(kept)} conditions"
    spans = [c.equation.span for c in kept]
    number = abs(missing)
    amount = "one is" if number == 1 else f"{number} are"
    if missing > 0:
        message = f"{who} {count} for order {order} in x: {amount} missing{places.likely()}"
        reader.note("SF243", message, members[0].span, places.summary())
    else:
        message = f"{who} {count} for order {order} in x: {amount} too many{places.likely(surplus=True)}"
        reader.note("SF243", message, spans[order], places.summary())


def _has_tip(field: FieldProblem, point: RandomPoint) -> bool:
    """Tell whether what a highest derivative is multiplied by vanishes at an end, whatever the values."""
    if COORDINATE in field.unknowns or not any(map(varies_along_x, field.equations)):
        return False
    along = point.within(field.unknowns)
    for end in (field.start, field.end):
        forms = [
            along.condition(Equation(*(substitute(side, {COORDINATE: lower(end)}) for side in e.children)))
            for e in field.equations
        ]
        conditions = [along.condition(e) for e in field.equations]
        for unknown in field.unknowns:
            highest = max(k[2] for f in conditions for k in f if isinstance(k, tuple) and k[0] == unknown)
            if not any((unknown, 0, highest) in f for f in forms):
                return True
    return False


class _PlaceCounts:
    """How many conditions stand at each place along x, and how many are usual: mostly half the order."""

    def __init__(
        self,
        members: Sequence[FieldProblem],
        orders: Mapping[str, int],
        conditions: Sequence[_Condition],
        point: RandomPoint,
    ) -> None:
        owners = {unknown: field.name for field in members for unknown in field.unknowns}
        labels: dict[tuple[str, int], str] = {}
        usual: dict[tuple[str, int], int] = {}
        for field in members:
            for end in (field.start, field.end):
                key = (field.name, point.constant(end))
                labels[key] = _written(end)
                usual[key] = orders[field.name] // 2
        self._guess = all(orders[f.name] % 2 == 0 for f in members)
        touched: list[list[tuple[str, int]]] = []
        for condition in conditions:
            keys = [(owners[c.name], point.constant(c.argument)) for c in condition.calls]
            for key, call in zip(keys, condition.calls, strict=True):
                labels.setdefault(key, _written(call.argument))
            touched.append(keys)
        names_of = {key: f"{field} {at}" for key in labels for field, at in [key]}
        # A condition within one field counts at its first place; one between two fields joins their places.
        links = [
            {names_of[k] for k in keys} if len({k[0] for k in keys}) > 1 else {names_of[keys[0]]}
            for keys in touched
        ]
        groups = _joined(list(names_of.values()), links)
        self._rows: list[tuple[str, int, int]] = []
        for group in groups:
            inside = [k for k in labels if names_of[k] in group]
            texts = dict.fromkeys(labels[k] for k in inside)
            if len(members) > 1 and len(inside) == 1:
                texts = {f"{labels[inside[0]]} of '{inside[0][0]}'": None}
            count = sum(1 for link in links if link & group)
            self._rows.append((" = ".join(texts), count, sum(usual.get(k, 0) for k in inside)))

    def likely(self, *, surplus: bool = False) -> str:
        """Return ", likely at l" when there is a place that has too few (or too many)."""
        suspects = [
            text for text, count, usual in self._rows if (count > usual if surplus else count < usual)
        ]
        if not self._guess or not suspects or len(suspects) == len(self._rows) > 1:
            return ""
        return f", likely at {' and '.join(suspects)}"

    def summary(self) -> str:
        """Return how many conditions there are at each place."""
        return "conditions: " + ", ".join(
            f"{count}{f' of {usual}' if self._guess and usual and usual != count else ''} at {text}"
            for text, count, usual in self._rows
        )

"""Nonlinear ``[equations]``, made linear about the values at equilibrium that ``[operating_point]`` gives.

Input: equations as Newton's or Kirchhoff's law has them, with powers and functions of what varies in time.
Output: linear equations of the deviations from rest, which keep the names, and definitions for values.

    [equations]        m*x'' = m*g - C*i^2/x^2
    [operating_point]  x = "x_0", i = "i_0", solve = ["i_0"]

    i_0 = sqrt(m*g*x_0^2/C),  m*s^2*x - 2*C*i_0^2/x_0^3*x + 2*C*i_0/x_0^2*i = 0

The equations have to hold at equilibrium whatever their letters are: the residual is evaluated in balls for
random values, so a number that is not zero is noticed, and an identity missed with probability 0.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import count
from typing import TYPE_CHECKING

from symflex.algebra import FUNCTIONS, LAPLACE
from symflex.errors import Span, SpecError, nearest
from symflex.expressions import (
    Attribute,
    Derivative,
    Equation,
    Expression,
    Name,
    Negative,
    Number,
    Power,
    Product,
    format_expression,
    is_number,
    negative,
    nodes,
    number,
    power,
    product_of,
    replace_node,
    replace_values,
    sum_of,
)
from symflex.expressions.derivative import SLOPES, derivative, divisor, simplified, without_brackets
from symflex.expressions.nodes import Call, Differentiated
from symflex.expressions.trigonometric import shorter
from symflex.model.constants_at_rest import Constants, is_zero
from symflex.model.declarations import DeclaredParameter
from symflex.model.model import IMAGINARY, Assumption, Definition, FoundValue, OperatingPoint, Signal
from symflex.model.network import AsWritten
from symflex.model.reading import QuantityLiteral, Reader, literal_value
from symflex.model.scope import nearest_name
from symflex.model.solve_at_rest import EXAMPLE, Left, Solving
from symflex.quantities import DIMENSIONLESS, Quantity

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping, Sequence

    from symflex.model.spec import TableValue

SOLVE = "solve"
SIGNS = ("abs", "sgn", "sign")
SMOOTH = f"write powers, {', '.join(FUNCTIONS)}, and abs and sgn of what has a sign"
DELAYED = 'write x\' for the derivative of x; what is delayed is a signal of its own: x_d = "exp(-s*T)*x"'
LONGEST = 500  # parts of a value at equilibrium in which values above it are put


@dataclass(frozen=True)
class AtRest:
    """What ``[operating_point]`` says: values of what varies, and the parameters that follow from them."""

    values: Mapping[str, Expression]  # by name, "x'" for a rate
    solve: tuple[str, ...]
    declared: tuple[DeclaredParameter, ...]  # values that were written as numbers
    definitions: tuple[Definition, ...]  # the same of those in cycles, which are radians in formulas
    span: Span | None
    multipliers: tuple[str, ...] = ()  # values that nobody has to give
    coordinates: tuple[str, ...] = ()  # of Lagrange's equations
    constraints: tuple[str, ...] = ()  # names of multipliers, which the equations of constraints bear


NOWHERE = AtRest({}, (), (), (), None)


def read_operating_point(
    reader: Reader,
    section: TableValue | None,
    taken: Collection[str],
    moving: Collection[str],
    cycles: AsWritten,
) -> AtRest | None:
    """Return the values of ``[operating_point]``; ``taken`` are names of what is constant."""
    if section is None:
        return None
    values, solve = dict[str, Expression](), tuple[str, ...]()
    declared, definitions = list[DeclaredParameter](), list[Definition]()
    for entry in section.entries:
        if entry.key == SOLVE:
            named = reader.strings(entry, "solve of [operating_point]") or ()
            solve = tuple(dict.fromkeys(t.value for t in named))
            continue
        value = reader.expression(entry.value, f"'{entry.key}' of [operating_point]")
        if value is None:
            continue
        value = cycles.read(value)
        literal = literal_value(value)
        if literal is not None and literal != 0:
            name = _unused(entry.key, {*taken, *moving})
            if isinstance(value, QuantityLiteral) and value.quantity.cycles:
                definitions.append(Definition(name, value, "", entry.key_span))
            else:
                declared.append(_declared(name, value, literal, entry.key_span))
            value = Name(name, span=value.span)
        meant = replace_values(value, {Name(n): v for n, v in values.items()})
        value = meant if len(nodes(meant)) < LONGEST else value
        values[entry.key] = number(0) if literal == 0 else value
    for p in {*solve} & {*values}:
        message = f"'{p}' has a value in [operating_point], and is to be solved for"
        reader.note("SF210", message, values[p].span or section.span, "leave out one of them")
    unknown = {p: _unused(p, {*taken, *moving}) for p in solve if p.rstrip("'") in moving and p not in values}
    values |= {p: Name(name) for p, name in unknown.items()}
    wanted = tuple(unknown.get(p, p) for p in solve)
    return AtRest(values, wanted, tuple(declared), tuple(definitions), section.span)


def _declared(name: str, value: Expression, literal: Fraction, span: Span) -> DeclaredParameter:
    """Return the parameter that a number or quantity is, so that formulas have a name for it."""
    quantity = Quantity(literal, 0, 0, DIMENSIONLESS, 0, "")
    if isinstance(value, QuantityLiteral):
        quantity = value.quantity
    assume: Assumption = "positive" if literal > 0 else "real"
    return DeclaredParameter(name, quantity, bool(quantity.unit), "", assume, "", "", span)


def _unused(key: str, taken: Collection[str]) -> str:
    """Return the first of ``x_0``, ``x_1``, ... that nothing is called."""
    base = key.replace(".", "_").replace("'", "_rate")
    return next(n for i in count() if (n := f"{base}_{i}") not in taken)


def linearised(
    reader: Reader,
    signals: tuple[Signal, ...],
    at_rest: AtRest | None,
    inputs: Collection[str],
    moving: Collection[str],
    constants: Constants,
) -> tuple[tuple[Signal, ...], list[Definition], OperatingPoint | None, Mapping[str, Fraction]]:
    """Return linear signals, definitions of equilibrium values, the operating point, solved parameters."""
    # ``moving`` are all names that vary. Without an operating point only derivatives are rewritten, as
    # products with s.
    equations = {x.name: x.expression for x in signals if isinstance(x.expression, Equation)}
    primes = (isinstance(n, Derivative | Differentiated) for e in equations.values() for n in nodes(e))
    if not equations or (at_rest is None and not any(primes)):
        return signals, [], None, {}
    written = (x.expression for x in signals)
    note_divisions(reader, constants, (*written, *(at_rest.values.values() if at_rest else ())))
    point = _AboutRest(reader, at_rest or NOWHERE, frozenset(inputs), constants)
    if at_rest is None and IMAGINARY not in moving:  # coefficients may be complex, values at rest may not
        point.still.add(IMAGINARY)
    point.check_all_named(moving, equations.values())
    if reader.problems:
        raise SpecError(*reader.problems)
    if at_rest is None:
        plain = {n: [without_brackets(x, point.varies) for x in e.children] for n, e in equations.items()}
        rewritten = {n: Equation(*map(in_s, plain[n]), span=e.span) for n, e in equations.items()}
        kept = tuple(replace(x, expression=rewritten.get(x.name, x.expression)) for x in signals)
        return kept, [], None, {}
    point.follow(signals, equations, moving)
    made = {name: point.linear(equation) for name, equation in equations.items()}
    if None not in made.values():
        point.check_names(at_rest)
        point.check_constraints(equations, is_solved=False)
        if not reader.problems:
            point.check_at_rest()
        if not reader.problems:
            point.check_constraints(equations, is_solved=True)
    if reader.problems:
        raise SpecError(*reader.problems)
    kept = tuple(replace(x, expression=point.with_calls(made.get(x.name)) or x.expression) for x in signals)
    return kept, point.definitions, point.described(equations, made), point.by_value


def note_divisions(reader: Reader, constants: Constants, expressions: Iterable[Expression]) -> None:
    """Note every part of what is written that divides by zero, whatever the names in it are."""
    for expression in expressions:
        for node in nodes(expression):
            below = divisor(node)
            if below is None or any(isinstance(n, Differentiated) or _is_of_field(n) for n in nodes(below)):
                continue
            rates = [n for n in nodes(below) if isinstance(n, Derivative)]
            plain = replace_values(below, {n: Name(format_expression(n)) for n in rates})
            if constants.vanishes(plain):
                reader.note("SF224", "division by zero", below.span or node.span or expression.span)


def in_s(expression: Expression, names: Collection[str] | None = None) -> Expression:
    """Return an expression with ``s^2*x`` in place of ``x''``, for the names given, or all."""
    rates = [n for n in nodes(expression) if isinstance(n, Derivative) and (names is None or n.name in names)]
    return replace_values(expression, {n: _term(n, number(1)) for n in rates})


class _AboutRest:
    """Linearises equations about one point, and keeps what is left of each at equilibrium."""

    def __init__(
        self,
        reader: Reader,
        at_rest: AtRest,
        inputs: frozenset[str],
        constants: Constants,
    ) -> None:
        self.reader, self.rest, self.inputs, self.constants = reader, at_rest, inputs, constants
        self.still = {LAPLACE, "pi"}
        self.by_value: dict[str, Fraction] = {}
        self.found: tuple[FoundValue, ...] = ()
        self.used: set[str] = set()  # names whose values were used
        self.decided: dict[Expression, int] = {}  # signs of arguments of abs and sgn
        self.whole: list[Equation] = []  # at equilibrium, as they are written
        self.bare: set[Expression] = set()  # names that occur without a derivative
        self.slopes: list[dict[str, Expression]] = []  # of each equation, by what varies
        self.values = dict(at_rest.values)
        self.definitions = list(at_rest.definitions)
        constants.expressions |= {d.name: d.expression for d in at_rest.definitions} | dict.fromkeys(
            (*at_rest.solve, *at_rest.multipliers)
        )
        self.left_over: list[Left] = []
        self.calls: Mapping[
            Expression, Expression
        ] = {}  # what functions that were inverted are at equilibrium
        self.seen: set[str] = set()
        self.signals: dict[str, Expression] = {}  # explicit ones, and rates, which follow from the others
        rates = {n: v for n, v in at_rest.values.items() if n.endswith("'") and not is_number(v, 0)}
        self.rates = {Name(n[:-1]): v for n, v in rates.items() if not n.endswith("''")}
        self.drifting: set[Expression] = set()  # names in what does not stay as it is at these rates

    def follow(
        self, signals: Sequence[Signal], equations: Mapping[str, Equation], moving: Collection[str]
    ) -> None:
        """Take signals, and find the rates that follow from equations and from given values."""
        for x in signals:
            if x.name not in equations and all(_base(n) in moving for n in self.leaves(x.expression)):
                self.take_signal(x)
        given = [
            Equation(Name(name), value, span=self.values[name].span)
            for name, value in self.signals.items()
            if name in self.values
        ]
        parts = (*equations.values(), *self.signals.values())
        products = [n for e in parts for n in nodes(e) if isinstance(n, Product)]
        after_s = {id(f) for n in products if any(map(_order_of_s, n.factors)) for f in n.factors}
        leaves = [n for e in parts for n in nodes(e) if self.varies(n) and id(n) not in after_s]
        self.bare = {n for n in leaves if isinstance(n, Name)}
        for equation in (*equations.values(), *given):
            self.infer_rates(equation)
        for each in given:  # and to be right
            residual = self.at_rest(sum_of([each.left, negative(each.right)]))
            self.left_over.append(Left(residual, each))

    def leaves(self, expression: Expression) -> list[Expression]:
        """Return each leaf that varies in time once."""
        return [n for n in dict.fromkeys(nodes(expression)) if self.varies(n)]

    def varies(self, node: Expression) -> bool:
        """Tell whether a node is a leaf that varies in time."""
        match node:
            case Name(name):
                return name not in self.constants.expressions and name not in self.still
            case Derivative() | Attribute():
                return True
        return False

    def check_all_named(self, moving: Collection[str], equations: Iterable[Equation]) -> None:
        """Note names that mean nothing, and values at equilibrium that vary."""
        for leaf in dict.fromkeys(n for e in equations for n in nodes(e)):
            name = leaf.name if isinstance(leaf, Name | Derivative) else None
            if name is None or name in moving or not self.varies(leaf):
                continue
            message, hint = (
                f"unknown name '{name}'",
                nearest_name(name, sorted({*moving, *self.constants.expressions})),
            )
            if name in self.constants.expressions:
                message, hint = f"'{name}' is constant and has no derivative in time", None
            self.reader.note("SF210", message, leaf.span, hint)
        for call in (n for e in (*equations, *self.rest.values.values()) for n in nodes(e)):
            if isinstance(call, Call) and self.rest is not NOWHERE and call.name not in (*FUNCTIONS, *SIGNS):
                message = f"unknown function '{call.name}'"
                if not any(map(self.varies, nodes(call))):
                    self.reader.note("SF210", message, call.span, nearest(call.name, FUNCTIONS) or SMOOTH)
        for value in self.rest.values.values():
            for leaf in (n for n in nodes(value) if self.varies(n) or n == Name(LAPLACE)):
                message = (
                    f"'{format_expression(leaf)}' is not a parameter; values at equilibrium are constant"
                )
                hint = nearest_name(format_expression(leaf), sorted(self.constants.expressions))
                self.reader.note("SF210", message, leaf.span or value.span, hint)

    def linear(self, equation: Equation) -> Equation | None:
        """Return a linear equation of the deviations, ``None`` where there is none, which is noted."""
        try:
            difference = sum_of(
                [self._with_primes(equation.left), negative(self._with_primes(equation.right))]
            )
            leaves = self._met(difference)
            slopes = [(n, shorter(self.at_rest(derivative(difference, n)))) for n in leaves]
            values = {n: self._value_at_rest(format_expression(n)) for n in leaves}
            self.whole.append(Equation(replace_values(difference, values), number(0), span=equation.span))
            residual = simplified(self.at_rest(difference), {LAPLACE: number(0)})
            self.left_over.append(Left(shorter(residual), equation))
        except ValueError as error:
            part = error.args[0]
            message = f"'{format_expression(part)}' has no derivative here"
            if isinstance(part, Call) and part.name not in SLOPES:
                message = f"unknown function '{part.name}'"
            self.reader.note("SF222", message, part.span or equation.span, SMOOTH)
        except ZeroDivisionError:
            message = "this is not smooth at the operating point: a denominator vanishes there"
            self.reader.note("SF224", message, equation.span, "give other values in [operating_point]")
        else:
            moving = [(n, c) for n, c in slopes if not is_number(c, 0)]
            self.slopes.append({format_expression(n): c for n, c in moving})
            moving.sort(key=lambda part: -getattr(part[0], "order", 0))  # as books do: accelerations first
            left = [_term(n, c) for n, c in moving if _base(n) not in self.inputs]
            right = [negative(_term(n, c)) for n, c in moving if _base(n) in self.inputs]
            if all(isinstance(term, Negative) for term in left):
                left, right = [negative(t) for t in left], [negative(t) for t in right]
            return Equation(sum_of(left), sum_of(right), span=equation.span)
        return None

    def with_calls(self, linear: Equation | None) -> Equation | None:
        """Return an equation with what was solved for in place of functions of it: sqrt(h_0) is q_0/a."""
        return linear and Equation(
            *(replace_values(e, self.calls) for e in linear.children), span=linear.span
        )

    def check_domain(self) -> None:
        """Note what has no value with the values at equilibrium: a quotient by zero, a logarithm or root."""
        for equation in self.whole:
            for node in nodes(equation.left):
                below = divisor(node)
                if below is None and not isinstance(node, Call):
                    continue
                value = self.constants.here(node if below is None else below)
                if below is not None and value is not None and value.contains(0):
                    message = f"'{format_expression(below)}' is zero at the operating point: division by zero"
                elif below is None and value is not None and not value.is_finite():
                    message = f"'{format_expression(node)}' has no value at the operating point"
                else:
                    continue
                span = (below or node).span or equation.span
                self.reader.note("SF224", message, span, "correct the values of parameters")

    def _with_primes(self, expression: Expression) -> Expression:
        """Return ``x''`` in place of ``s^2*x``."""
        expression = without_brackets(expression, self.varies)
        rewritten = {}
        for node in nodes(expression):
            if not isinstance(node, Product):
                continue
            orders = [_order_of_s(f) for f in node.factors]
            moving = [i for i, f in enumerate(node.factors) if any(map(self.varies, nodes(f)))]
            has_s = any(Name(LAPLACE) in nodes(f) for i, f in enumerate(node.factors) if i not in moving)
            if len(moving) > 1 and has_s:
                message = "s before a product of two quantities that vary can be read in two ways"
                self.reader.note("SF222", message, node.span, DELAYED)
            elif moving and any(orders) and isinstance(leaf := node.factors[moving[0]], Name):
                others = [f for i, f in enumerate(node.factors) if not orders[i] and i != moving[0]]
                rewritten[node] = product_of([*others, Derivative(leaf.name, sum(orders), span=leaf.span)])
        for old, new in rewritten.items():
            expression = replace_node(expression, old, new)
        return expression

    def infer_rates(self, equation: Equation) -> None:
        """Let the rate of what turns steadily follow from the equation ``theta' = omega``."""
        for one, other in ((equation.left, equation.right), (equation.right, equation.left)):
            match self._with_primes(one):
                case Derivative(name, 1) as rate if name not in self.values and Name(name) not in self.bare:
                    if not self._leads_to(rate, value := self._with_primes(other), set()):
                        self.signals.setdefault(format_expression(rate), value)

    def _leads_to(self, leaf: Expression, expression: Expression, passed: set[Expression]) -> bool:
        """Tell whether the value of an expression at equilibrium follows from that of a leaf."""
        new = {*self.leaves(expression)} - passed
        passed |= new
        free = {format_expression(each) for each in new} - self.values.keys()
        known = [self.signals[n] for n in free if n in self.signals]
        return leaf in new or any(self._leads_to(leaf, each, passed) for each in known)

    def take_signal(self, signal: Signal) -> None:
        """Let the value of an explicit signal at equilibrium follow from the others."""
        value = self._with_primes(signal.expression)
        self._met(value)
        self.signals[signal.name] = replace_values(value, {Name(LAPLACE): number(0)})

    def _met(self, expression: Expression) -> list[Expression]:
        """Return the leaves of an expression; those of one that changes while angles turn are kept.

        What depends on differences of angles alone stays as it is, and so do the energies of what turns.
        """
        leaves = self.leaves(expression)
        self.seen |= {*map(format_expression, leaves), *map(_base, leaves)}
        change = sum_of(product_of([v, derivative(expression, q)]) for q, v in self.rates.items())
        varying = {n: Name(format_expression(n)) for n in nodes(change) if self.varies(n) or _is_of_field(n)}
        if not self.constants.vanishes(replace_values(change, varying)):
            self.drifting |= {*leaves}
        return leaves

    def at_rest(self, expression: Expression) -> Expression:
        """Return an expression with the values at equilibrium in place of all that varies."""
        leaves = {n: self._value_at_rest(format_expression(n)) for n in nodes(expression) if self.varies(n)}
        value = simplified(
            replace_values(expression, leaves), {format_expression(n): v for n, v in leaves.items()}
        )
        while parts := [n for n in nodes(value) if isinstance(n, Call) and n.name in SIGNS]:
            part = parts[-1]  # no other is inside of it
            sign = self._sign(part)
            size = part.argument if sign > 0 else negative(part.argument)
            value = replace_node(value, part, size if part.name == "abs" else number(sign))
        return simplified(value, {})

    def _sign(self, part: Call) -> int:
        """Return the sign of what abs or sgn is of, by the values of parameters if it depends on them."""
        sign = self.constants.sign(part.argument)
        if sign is None:
            value = self.constants.here(part.argument)
            sign = 0 if value is None else int(value > 0) - int(value < 0)
            self.used |= self.constants.behind(part.argument)
        if not sign:
            raise ValueError(part)
        self.decided[part.argument] = sign
        return sign

    def _value_at_rest(self, name: str) -> Expression:
        if name not in self.values and name in self.signals:
            self.values[name] = Name(name)  # where a loop leads back to it
            value = self.values[name] = self.at_rest(self.signals[name])
            if Name(name) in nodes(value):
                message, hint = (
                    f"'{name}' depends on itself at equilibrium",
                    "give its value in [operating_point]",
                )
                self.reader.note("SF407", message, self.rest.span, hint)
        return self.values.get(name, number(0))

    def described(
        self, equations: Mapping[str, Equation], made: Mapping[str, Equation | None]
    ) -> OperatingPoint:
        """Return what happened, once all equations are linear."""
        coordinates = self.rest.coordinates
        rows = [slopes for name, slopes in zip(equations, self.slopes, strict=True) if name in coordinates]
        matrices = tuple(
            tuple(tuple(row.get(q + "'" * order, number(0)) for q in coordinates) for row in rows)
            for order in (2, 1, 0)
        )
        linear = tuple(e for e in made.values() if e is not None)
        values = tuple((n, v) for n, v in self.values.items() if n.rstrip("'") in self.seen)
        facts = coordinates, matrices if coordinates else (), frozenset(self.used), self.found
        return OperatingPoint(values, tuple(equations.values()), linear, *facts)

    def check_names(self, given: AtRest) -> None:
        """Note values of what occurs in no equation."""
        for name, value in given.values.items():
            if name not in self.seen and name.rstrip("'") not in self.seen:
                hint = nearest(name, self.seen) or EXAMPLE
                message = f"'{name}' of [operating_point] occurs in no equation"
                self.reader.note("SF210", message, value.span or given.span, hint)
            base, order = name.rstrip("'"), name.count("'")
            lower_rates = {base + "'" * k for k in range(1, order)}
            depends = Name(base) in (self.drifting if order == 1 else self.bare)
            if order and not is_number(value, 0) and (depends or lower_rates & self.seen):
                message = f"'{base}' moves, as '{name}' has a value, and equations depend on it"
                hint = (
                    "what turns steadily may occur by its rates, and in differences of angles that turn alike"
                )
                self.reader.note("SF407", message, value.span or given.span, hint)

    def check_at_rest(self) -> None:
        """Solve what is asked for, and note every equation that does not hold at equilibrium."""
        solving = Solving(self.reader, self.constants)
        unsolved, missing = solving.solve(self.left_over, [*self.rest.multipliers, *self.rest.solve])
        self.definitions += solving.definitions
        self.by_value = solving.by_value
        self.used |= solving.used
        self.found, self.calls = tuple(solving.found), solving.calls
        if not self.reader.problems:
            self.check_domain()
        for made in () if self.reader.problems else solving.definitions:
            value = self.constants.here(made.expression)
            if value is not None and not value.is_finite():
                message = f"'{format_expression(made.expression)}' has no value at the operating point"
                self.reader.note("SF224", message, made.span, "correct the values of parameters")
        numbers = {p.name: self.constants.known[p.name] for p in self.rest.declared}
        for each in unsolved:
            if self.constants.vanishes(each.residual):
                continue
            if self.constants.vanishes(each.residual, numbers):
                self.used |= self.constants.behind(each.residual) & {*numbers}
            elif (deciding := self.constants.deciding(is_zero, each.residual)) is not None:
                self.used |= deciding
            else:
                self._note_left(each)
        for name in missing:
            if name in self.rest.multipliers:
                self.definitions.append(Definition(name, number(0), "", self.rest.span))
                continue
            message, hint = f"no equation at equilibrium determines '{name}'", "leave it out of solve"
            rates = [r for r, value in self.values.items() if r[-1] == "'" and Name(name) in nodes(value)]
            if rates:  # r' = w - p gives the rate of r, not w
                hint = f'write "{rates[0]}" = "0" if \'{rates[0][:-1]}\' is at equilibrium too, or {hint}'
            self.reader.note("SF407", message, self.rest.span, hint)
        for part, sign in self.decided.items():
            value = self.constants.here(part)
            if value is not None and value.is_finite() and (value > 0) - (value < 0) != sign:
                message = f"'{format_expression(part)}' is taken for {'positive' if sign > 0 else 'negative'}"
                hint = "declare values with the signs that they have at equilibrium"
                self.reader.note(
                    "SF407", f"{message} at equilibrium, and is not", part.span or self.rest.span, hint
                )

    def check_constraints(self, equations: Mapping[str, Equation], *, is_solved: bool) -> None:
        """Note constraints with dependent gradients there: what is linear of them says too little."""
        by_name = dict(zip(equations, self.slopes, strict=True))
        rows = [
            [by_name[name].get(q, number(0)) for q in self.rest.coordinates] for name in self.rest.constraints
        ]
        depends = any(Name(p) in nodes(e) for p in self.rest.solve for row in rows for e in row)
        if rows and depends is is_solved and self.constants.are_dependent(rows):
            message = (
                "a singular configuration: gradients of the constraints are dependent at the operating point"
            )
            hint = "choose another point; leave out a constraint that follows from the others everywhere"
            self.reader.note("SF407", message, equations[self.rest.constraints[0]].span, hint)

    def _note_left(self, unsolved: Left) -> None:
        size, value = "", self.constants.here(unsolved.residual)
        if value is not None and value.is_finite():
            size = f" ({'0 for these values alone' if value.contains(0) else value.str(3, radius=False)})"
        shown = format_expression(unsolved.residual)
        message = f"this does not hold at the operating point: its residual is {shown}{size}"
        hint = "correct [operating_point], or name what follows from it: solve = [...]"
        self.reader.note("SF407", message, unsolved.equation.span, hint)


def _order_of_s(factor: Expression) -> int:
    match factor:
        case Name(name) if name == LAPLACE:
            return 1
        case Power(Name(name), Number(n)) if name == LAPLACE and n.denominator == 1:
            return int(n)
    return 0


def _is_of_field(node: Expression) -> bool:
    return isinstance(node, Call) and node.name not in (*FUNCTIONS, *SIGNS)


def _base(node: Expression) -> str:
    return node.name if isinstance(node, Derivative) else format_expression(node)


def _term(node: Expression, slope: Expression) -> Expression:
    if not isinstance(node, Derivative):
        return product_of([slope, node])
    return product_of([slope, power(Name(LAPLACE), node.order), Name(node.name)])

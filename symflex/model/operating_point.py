"""Nonlinear ``[equations]``, made linear about the values at rest that ``[operating_point]`` gives.

Input: equations as Newton's or Kirchhoff's law has them, with powers and functions of what varies in time.
Output: linear equations of the deviations from rest, which keep the names, and definitions for values.

    [equations]        m*x'' = m*g - C*i^2/x^2
    [operating_point]  x = "x_0", i = "i_0", solve = ["i_0"]

    i_0 = sqrt(m*g*x_0^2/C),  m*s^2*x - 2*C*i_0^2/x_0^3*x + 2*C*i_0/x_0^2*i = 0

The equations have to hold at rest whatever their letters are: what is left over is evaluated in balls for
random values, so a number that is not zero is noticed, and an identity missed with probability 0.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import count
from random import Random
from typing import TYPE_CHECKING

from flint import arb, arb_mat

from symflex.algebra import FUNCTIONS, LAPLACE
from symflex.balls import precision, stays_inside
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
    Quotient,
    Sum,
    fold,
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
from symflex.expressions.derivative import SLOPES, derivative, simplified, without_brackets
from symflex.expressions.nodes import Call, Differentiated
from symflex.expressions.trigonometric import shorter
from symflex.model.model import Definition, OperatingPoint, Signal
from symflex.model.reading import Reader, literal_value
from symflex.model.scope import nearest_name
from symflex.model.units import AsWritten, lower

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping

    from symflex.model.spec import TableValue

SOLVE = "solve"
EXAMPLE = 'for instance x = "x_0", i = "i_0", solve = ["i_0"]'
SMOOTH = f"write powers, {', '.join(FUNCTIONS)}, and abs and sgn of what has a sign"
DELAYED = 'write x\' for the derivative of x; what is delayed is a signal of its own: x_d = "exp(-s*T)*x"'
TRIALS = 200  # random points, of which three are to be in the domain of all functions
AGREEING = 3
BITS = 256
STEPS = 60  # Newton steps, from a value a person gave
DIGITS = 40  # of a parameter that has no formula
LONGEST = 500  # parts of a value at rest in which values above it are put


@dataclass(frozen=True)
class AtRest:
    """What ``[operating_point]`` says: values of what varies, and the parameters that follow from them."""

    values: Mapping[str, Expression]  # by name, "x'" for a rate
    solve: tuple[str, ...]
    definitions: tuple[Definition, ...]  # of values that were written as numbers
    span: Span | None
    multipliers: tuple[str, ...] = ()  # values that nobody has to give
    coordinates: tuple[str, ...] = ()  # of Lagrange's equations


NOWHERE = AtRest({}, (), (), None)


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
    values, definitions, solve = dict[str, Expression](), list[Definition](), tuple[str, ...]()
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
            # A number alone would fit any unit.
            name = _unused(entry.key, {*taken, *moving})
            definitions.append(Definition(name, value, "", entry.key_span))
            value = Name(name, span=value.span)
        meant = replace_values(value, {Name(n): v for n, v in values.items()})
        value = meant if len(nodes(meant)) < LONGEST else value
        values[entry.key] = number(0) if literal == 0 else value
    for p in {*solve} & {*moving} & {*values}:
        message = f"'{p}' has a value in [operating_point], and is to be solved for"
        reader.note("SF210", message, values[p].span or section.span, "leave out one of them")
    unknown = {p: _unused(p, {*taken, *moving}) for p in solve if p in moving and p not in values}
    values |= {p: Name(name) for p, name in unknown.items()}
    return AtRest(values, tuple(unknown.get(p, p) for p in solve), tuple(definitions), section.span)


def _unused(key: str, taken: Collection[str]) -> str:
    """Return the first of ``x_0``, ``x_1``, ... that nothing is called."""
    base = key.replace(".", "_").replace("'", "_rate")
    return next(n for i in count() if (n := f"{base}_{i}") not in taken)


def linearised(
    reader: Reader,
    signals: tuple[Signal, ...],
    rest: AtRest | None,
    inputs: Collection[str],
    moving: Collection[str],
    constants: Mapping[str, Expression | None],
    numbers: Mapping[str, Expression],
    signed: Collection[str],
) -> tuple[tuple[Signal, ...], list[Definition], OperatingPoint | None, Mapping[str, Fraction]]:
    """Return linear signals, definitions of values at rest, the operating point, and solved parameters."""
    # ``moving`` are all names that vary, ``constants`` all that do not, with the expressions of those that
    # are defined; ``numbers`` are the values of parameters, ``signed`` those that may be negative. Without an
    # operating point only derivatives are rewritten, as products with s.
    equations = {x.name: x.expression for x in signals if isinstance(x.expression, Equation)}
    primes = (isinstance(n, Derivative | Differentiated) for e in equations.values() for n in nodes(e))
    if not equations or (rest is None and not any(primes)):
        return signals, [], None, {}
    point = _AboutRest(
        reader, rest or NOWHERE, frozenset(inputs), dict(constants), numbers, frozenset(signed)
    )
    point.check_all_named(moving, equations.values())
    if reader.problems:
        raise SpecError(*reader.problems)
    if rest is None:
        plain = {n: [without_brackets(x, point.varies) for x in e.children] for n, e in equations.items()}
        rewritten = {n: Equation(*map(in_s, plain[n]), span=e.span) for n, e in equations.items()}
        kept = tuple(replace(x, expression=rewritten.get(x.name, x.expression)) for x in signals)
        return kept, [], None, {}
    for x in signals:
        leaves = [n for n in nodes(x.expression) if point.varies(n)]
        if x.name not in equations and all(isinstance(n, Name) and n.name in moving for n in leaves):
            point.signals[x.name] = replace_values(x.expression, {Name(LAPLACE): number(0)})
            point.seen |= {n.name for n in leaves if isinstance(n, Name)}
    for name, value in point.signals.items():
        if name in point.values:  # given, and to be right
            left = point.at_rest(sum_of([Name(name), negative(value)]))
            point.left_over.append((left, Equation(Name(name), value, span=point.values[name].span)))
    parts = (*equations.values(), *point.signals.values())
    products = [n for e in parts for n in nodes(e) if isinstance(n, Product)]
    after_s = {id(f) for n in products if any(map(_order_of_s, n.factors)) for f in n.factors}
    leaves = [n for e in parts for n in nodes(e) if point.varies(n) and id(n) not in after_s]
    point.bare = {n for n in leaves if isinstance(n, Name)}
    made = {name: point.linear(equation) for name, equation in equations.items()}
    if None not in made.values():
        point.check_names(rest)
        point.check_at_rest()
    if reader.problems:
        raise SpecError(*reader.problems)
    kept = tuple(replace(x, expression=made.get(x.name) or x.expression) for x in signals)
    return kept, point.definitions, point.described(equations, made), point.by_value


def in_s(expression: Expression, names: Collection[str] | None = None) -> Expression:
    """Return an expression with ``s^2*x`` in place of ``x''``, for the names given, or all."""
    rates = [n for n in nodes(expression) if isinstance(n, Derivative) and (names is None or n.name in names)]
    return replace_values(expression, {n: _term(n, number(1)) for n in rates})


class _AboutRest:
    """Linearises equations about one point, and keeps what is left of each at rest."""

    def __init__(
        self,
        reader: Reader,
        rest: AtRest,
        inputs: frozenset[str],
        constants: dict[str, Expression | None],
        numbers: Mapping[str, Expression],
        signed: frozenset[str],
    ) -> None:
        self.reader, self.rest, self.inputs, self.constants = reader, rest, inputs, constants
        self.signed = signed
        self.by_value: dict[str, Fraction] = {}
        self.solved_with: set[str] = set()
        self.bare: set[Expression] = set()  # names that occur without a derivative
        self.slopes: list[dict[str, Expression]] = []  # of each equation, by what varies
        self.values = dict(rest.values)
        self.definitions = list(rest.definitions)
        self.constants |= {d.name: d.expression for d in rest.definitions} | dict.fromkeys(
            (*rest.solve, *rest.multipliers)
        )
        with precision(BITS):
            self.known = {name: self._value(value, {}, None) for name, value in numbers.items()}
        self.left_over: list[tuple[Expression, Equation]] = []
        self.seen: set[str] = set()
        self.signals: dict[str, Expression] = {}  # explicit ones, which follow from the others

    def varies(self, node: Expression) -> bool:
        """Tell whether a node is a leaf that varies in time."""
        match node:
            case Name(name):
                return name not in self.constants and name not in (LAPLACE, "pi")
            case Derivative() | Attribute():
                return True
        return False

    def check_all_named(self, moving: Collection[str], equations: Iterable[Equation]) -> None:
        """Note names that mean nothing, and values at rest that vary."""
        for leaf in dict.fromkeys(n for e in equations for n in nodes(e)):
            name = leaf.name if isinstance(leaf, Name | Derivative) else None
            if name is None or name in moving or not self.varies(leaf):
                continue
            message, hint = f"unknown name '{name}'", nearest_name(name, [*moving, *self.constants])
            if name in self.constants:
                message, hint = f"'{name}' is constant and has no derivative in time", None
            self.reader.note("SF210", message, leaf.span, hint)
        for call in (n for e in (*equations, *self.rest.values.values()) for n in nodes(e)):
            if isinstance(call, Call) and self.rest is not NOWHERE and call.name not in (*FUNCTIONS, "abs"):
                message = f"unknown function '{call.name}'"
                if not any(map(self.varies, nodes(call))):
                    self.reader.note("SF210", message, call.span, nearest(call.name, FUNCTIONS) or SMOOTH)
        for value in self.rest.values.values():
            for leaf in (n for n in nodes(value) if self.varies(n) or n == Name(LAPLACE)):
                message = f"'{format_expression(leaf)}' is not a parameter; values at rest are constant"
                hint = nearest_name(format_expression(leaf), list(self.constants))
                self.reader.note("SF210", message, leaf.span or value.span, hint)

    def linear(self, equation: Equation) -> Equation | None:
        """Return a linear equation of the deviations, ``None`` where there is none, which is noted."""
        try:
            whole = sum_of([self._with_primes(equation.left), negative(self._with_primes(equation.right))])
            leaves = [n for n in dict.fromkeys(nodes(whole)) if self.varies(n)]
            self.seen |= {format_expression(n) for n in leaves} | {
                n.name for n in leaves if isinstance(n, Derivative)
            }
            self._infer_rates(equation)
            slopes = [(n, shorter(self.at_rest(derivative(whole, n)))) for n in leaves]
            values = {n: self._value_at_rest(format_expression(n)) for n in leaves}
            self._check_domain(replace_values(whole, values), equation.span)
            rest = simplified(self.at_rest(whole), {LAPLACE: number(0)})
            self.left_over.append((shorter(rest), equation))
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

    def _check_domain(self, whole: Expression, span: Span | None) -> None:
        """Note a logarithm or root that has no value for the values that parameters have."""
        with precision(BITS):
            for call in (n for n in nodes(whole) if isinstance(n, Call)):
                with suppress(KeyError):  # what has no value yet
                    if not self._value(call, dict(self.known), None).is_finite():
                        message = f"'{format_expression(call)}' has no value at the operating point"
                        self.reader.note(
                            "SF224", message, call.span or span, "correct the values of parameters"
                        )

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

    def _infer_rates(self, equation: Equation) -> None:
        """Take the rate of what turns steadily from the equation ``theta' = omega``."""
        for one, other in ((equation.left, equation.right), (equation.right, equation.left)):
            match self._with_primes(one):
                case Derivative(name, 1) as rate if name not in self.values and Name(name) not in self.bare:
                    self.values.setdefault(format_expression(rate), self.at_rest(other))

    def at_rest(self, expression: Expression) -> Expression:
        """Return an expression with the values at rest in place of all that varies."""
        leaves = {n: self._value_at_rest(format_expression(n)) for n in nodes(expression) if self.varies(n)}
        rest = simplified(
            replace_values(expression, leaves), {format_expression(n): v for n, v in leaves.items()}
        )
        for part in [n for n in nodes(rest) if isinstance(n, Call) and n.name in ("abs", "sgn", "sign")]:
            size = part.argument.operand if isinstance(part.argument, Negative) else part.argument
            if is_number(size, 0) or not self._is_positive(size):
                raise ValueError(part)
            sign = number(1 if size is part.argument else -1)
            rest = replace_node(rest, part, size if part.name == "abs" else sign)
        return simplified(rest, {})

    def _value_at_rest(self, name: str) -> Expression:
        if name not in self.values and name in self.signals:
            self.values[name] = Name(name)  # where a loop leads back to it
            value = self.values[name] = self.at_rest(self.signals[name])
            if Name(name) in nodes(value):
                message, hint = f"'{name}' depends on itself at rest", "give its value in [operating_point]"
                self.reader.note("SF407", message, self.rest.span, hint)
        return self.values.get(name, number(0))

    def _is_positive(self, size: Expression) -> bool:
        """Tell whether a size is made of positive parts alone."""
        for node in nodes(size):
            defined = self.constants.get(node.name) if isinstance(node, Name) else None
            literal = None if defined is None else literal_value(defined)
            if isinstance(node, Negative | Call) or (isinstance(node, Name) and node.name in self.signed):
                return False
            if defined is not None and not (self._is_positive(defined) if literal is None else literal > 0):
                return False
        return True

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
        own = coordinates, matrices if coordinates else (), frozenset(self.solved_with)
        return OperatingPoint(values, tuple(equations.values()), linear, *own)

    def check_names(self, rest: AtRest) -> None:
        """Note values of what occurs in no equation."""
        for name, value in rest.values.items():
            if name not in self.seen and name.rstrip("'") not in self.seen:
                hint = nearest(name, self.seen) or EXAMPLE
                message = f"'{name}' of [operating_point] occurs in no equation"
                self.reader.note("SF210", message, value.span or rest.span, hint)
            base, order = name.rstrip("'"), name.count("'")
            lower_rates = {base + "'" * k for k in range(1, order)}
            if order and not is_number(value, 0) and (Name(base) in self.bare or lower_rates & self.seen):
                message = f"'{base}' is not at rest, as '{name}' has a value, and equations depend on it"
                hint = "only what occurs by its rates alone may turn steadily"
                self.reader.note("SF407", message, value.span or rest.span, hint)

    def check_at_rest(self) -> None:
        """Solve what is asked for, and note every equation that does not hold at rest."""
        wanted = [*self.rest.multipliers, *self.rest.solve]
        left = [(_without_factor(r, wanted), e) for r, e in self.left_over]
        while found := [
            (p, solution, equation)
            for rest, equation in left
            for p in wanted
            if (solution := _solved(rest, p, wanted)) is not None
        ]:
            others = [len({Name(p) for p in wanted} & {*nodes(solution)}) for _, solution, _ in found]
            unknown, solution, equation = found[others.index(min(others))]
            if unknown in self.signed and unknown in self.known and isinstance(solution, Call):
                # of two roots, the declared
                solution = negative(solution) if self.known[unknown] < 0 else solution
            self._check_domain(solution, equation.span)
            wanted.remove(unknown)
            self.constants[unknown] = solution
            self.definitions.append(Definition(unknown, solution, "", equation.span))
            known = {unknown: solution} if min(others) else {}
            left = [(simplified(r, known), e) for r, e in left if e is not equation]
        rows = [(r, e) for r, e in left if any(Name(p) in nodes(r) for p in wanted)]
        together = [p for p in wanted if any(Name(p) in nodes(r) for r, _ in rows)]
        rows = rows[: len(together)]
        if rows and len(rows) == len(together):
            wanted = [p for p in wanted if p not in together]
            values = self._solved_by_value([r for r, _ in rows], together)
            self.by_value = dict(zip(together, values, strict=False))
            unread = [r for r, _ in rows]
            while unread:
                names = {n.name for e in unread for n in nodes(e) if isinstance(n, Name)} - self.solved_with
                self.solved_with |= names
                unread = [e for n in names if (e := self.constants.get(n)) is not None]
            if not values:
                self._note_left(*rows[0], ", ".join(together))
        for rest, equation in left:
            if (rest, equation) not in rows and not self._vanishes(rest):
                self._note_left(rest, equation, None)
        for name in wanted:
            if name in self.rest.multipliers:
                self.definitions.append(Definition(name, number(0), "", self.rest.span))
                continue
            message, hint = f"no equation at rest determines '{name}'", "leave it out of solve"
            rates = [r for r, value in self.values.items() if r[-1] == "'" and Name(name) in nodes(value)]
            if rates:  # r' = w - p gives the rate of r, not w
                hint = f'write "{rates[0]}" = "0" if \'{rates[0][:-1]}\' is at rest too, or {hint}'
            self.reader.note("SF407", message, self.rest.span, hint)

    def _note_left(self, rest: Expression, equation: Equation, unknown: str | None) -> None:
        size = ""
        with precision(BITS), suppress(KeyError):  # of a parameter without a value
            value = self._value(rest, dict(self.known), None)
            if value.is_finite():
                size = f" ({'0 for these values alone' if value.contains(0) else value.str(3, radius=False)})"
        message = f"this does not hold at the operating point: {format_expression(rest)} is left{size}"
        hint = "correct [operating_point], or name what follows from it: solve = [...]"
        if unknown is not None:
            message = f"'{unknown}' is not found: {format_expression(rest)} has no root next to its value"
            hint = f"give '{unknown}' a value close to the one at rest, and all other parameters theirs"
            if not self.known.keys() >= {*unknown.split(", ")}:  # made names of unknowns cannot be given one
                hint = f"declare parameters with values close to those at rest, {EXAMPLE}"
        self.reader.note("SF407", message, equation.span, hint)

    def _solved_by_value(self, rows: list[Expression], unknowns: list[str]) -> list[Fraction]:
        """Return the roots next to parameters' values, proved by Newton's operator, to forty digits."""
        slopes = [derivative(rest, Name(p)) for rest in rows for p in unknowns]
        n = len(unknowns)
        with precision(BITS):
            try:

                def step(box: list[arb]) -> list[arb]:
                    """Return what Newton's operator subtracts from the middle of a box."""
                    boxes = self.known | dict(zip(unknowns, box, strict=True))
                    middles = boxes | {p: boxes[p].mid() for p in unknowns}
                    matrix = arb_mat(n, n, [self._value(e, dict(boxes), None) for e in slopes])
                    left = arb_mat(n, 1, [self._value(e, dict(middles), None) for e in rows])
                    return list(matrix.solve(left).entries())

                x = [self.known[p].mid() for p in unknowns]
                for _ in range(STEPS):
                    x = [(a - b).mid() for a, b in zip(x, step(x), strict=True)]
                reach = [(abs(a) * arb(10) ** -DIGITS).mid() for a in x]
                steps = step([arb(a, r) for a, r in zip(x, reach, strict=True)])
                if not all(map(stays_inside, steps, reach)):
                    return []
            except (KeyError, ZeroDivisionError):
                return []
            return [Fraction(a.str(DIGITS, radius=False)) for a in x]

    def _vanishes(self, residual: Expression) -> bool:
        if is_number(residual, 0):
            return True
        random, agreeing = Random(1), 0
        for _ in range(TRIALS):
            with precision(BITS):
                value = self._value(residual, {}, random)
                if value.is_finite() and not value.contains(0):
                    return False
                agreeing += bool(value.is_finite())
            if agreeing == AGREEING:
                return True
        return False

    def _value(self, expression: Expression, known: dict[str, arb], random: Random | None) -> arb:
        """Return an expression's value, where names without one have random ones; else KeyError."""

        def named(name: str) -> arb:
            if name not in known:
                defined = self.constants[name]
                if defined is None and random is None:
                    raise KeyError(name)
                sign = 1 if random is None or name not in self.signed else random.choice((-1, 1))
                known[name] = (
                    sign * arb(random.randrange(1, 1 << 20)) / (1 << random.randrange(18, 26))
                    if defined is None and random
                    else self._value(lower(defined or number(0)), known, random)
                )
            return known[name]

        def called(call: Call, inner: arb) -> arb:
            return abs(inner) if call.name == "abs" else getattr(inner, call.name.replace("sign", "sgn"))()

        return fold(
            expression,
            number=lambda n: arb(n.numerator) / n.denominator,
            name=lambda name: arb.pi() if name == "pi" else named(name),
            power=lambda base, exponent: base ** self._value(exponent, known, random),
            call=called,
        )


def _solved(residual: Expression, unknown: str, wanted: Collection[str]) -> Expression | None:
    """Return the value for which a residual vanishes, if that is linear in it or in its square."""
    residual = _over_one_line(residual, unknown)
    slope = simplified(derivative(residual, Name(unknown)), {})
    if is_number(slope, 0):
        return None
    second = simplified(derivative(slope, Name(unknown)), {})
    below = slope if is_number(second, 0) else second
    if any(Name(p) in nodes(below) for p in wanted):
        return None
    constant = simplified(residual, {unknown: number(0)})
    if below is slope:
        return negative(_over(constant, slope))
    if not is_number(simplified(slope, {unknown: number(0)}), 0):
        return None
    return Call("sqrt", negative(_over(product_of([number(2), constant]), second)))


def _without_factor(residual: Expression, wanted: Collection[str]) -> Expression:
    """Return what else vanishes, of a product with a wanted name and another: ``X_0*(mu_0 - D)``."""
    for p in wanted:
        slope = simplified(derivative(residual, Name(p)), {})
        other = {Name(n) for n in wanted} & {*nodes(slope)}
        if other and Name(p) not in other and is_number(simplified(residual, {p: number(0)}), 0):
            return slope
    return residual


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


def _order_of_s(factor: Expression) -> int:
    match factor:
        case Name(name) if name == LAPLACE:
            return 1
        case Power(Name(name), Number(n)) if name == LAPLACE and n.denominator == 1:
            return int(n)
    return 0


def _base(node: Expression) -> str:
    return node.name if isinstance(node, Derivative) else format_expression(node)


def _term(node: Expression, slope: Expression) -> Expression:
    if not isinstance(node, Derivative):
        return product_of([slope, node])
    return product_of([slope, power(Name(LAPLACE), node.order), Name(node.name)])

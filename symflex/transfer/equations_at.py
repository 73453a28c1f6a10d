"""The equations of a model with numbers, ``A(s) x + B u = 0``, whatever is asked of them.

Input: :class:`symflex.equations.Equations`, assembled without names for wavenumbers, so that fundamental
functions are entire in s also where wavenumbers vanish; and exact values of the parameters in them.
Output: :class:`NamedValues`, which take entries of A to their values, on a ball of s, to first order in s or
in any parameter, or as polynomials in s; :class:`Majorants` bound them where abs(s) is at most a radius.

Example: a mass m = 2 kg on a spring k = 8 N/m. ``m s^2 + k`` is 10 at s = 1 rad/s; its derivative is 4 in s,
1 in m, 1 in k. For abs(s) up to 3 rad/s it is at most 2*9 + 8 = 26.

Derivatives are carried forward from s or a parameter, through functions of constants and definitions, to the
fundamental functions (Griewank and Walther 2008, chapter 3). Bounds of sums and products are sums and
products of bounds; where abs(A) is at most B, entry by entry, abs(exp(A)) is at most exp(B), by its series.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from math import prod

from flint import acb, acb_mat, acb_series, arb

from symflex.algebra import LAPLACE, Dispersion, Factored, composed, evaluated, terms_of
from symflex.algebra.propagators import EXPONENTIAL
from symflex.along.law import BoundLaw
from symflex.balls import Arithmetic, Value, at_centre, ball, current_bits, eliminate, raised
from symflex.equations import Equations
from symflex.expressions import Call, names_among
from symflex.library.elements import LinearForm
from symflex.model import ExactValue
from symflex.model.along import is_tapered, varies_along_x
from symflex.model.model import IMAGINARY, J
from symflex.transfer.enclose import constant_tangent, enclose, enclosure, first_order
from symflex.transfer.enclose_kernels import fundamental_functions

Powers = Sequence[tuple[str, int]]
Plan = tuple[acb, Powers, Sequence[tuple[int, Sequence[tuple[acb, Powers]], int]]]  # a constant, powers, sums
ZERO, ONE = acb(0), acb(1)


class EssentialSingularityError(Exception):
    """A denominator vanishes in the disc: roots accumulate there."""


@dataclass(frozen=True, eq=False)
class MemberWaves:
    """The fundamental functions and exponentials of a law of waves at a length."""

    law: Dispersion
    length: Factored
    orders: dict[str, int]  # by their names

    def at(self, value: Callable[[Factored], Value], sign: int = 1) -> dict[str, Value]:
        """Return them from the values of length and coefficients, these times a sign."""
        length, orders = value(self.length), self.orders
        plain: tuple[Value, ...] = ()
        if any(order != EXPONENTIAL for order in orders.values()):
            plain = fundamental_functions([value(c) * sign for c in self.law.characteristic], length)
        return {
            name: (value(self.law.shift) * -sign * length).exp() if n == EXPONENTIAL else plain[n]
            for name, n in orders.items()
        }


@dataclass(frozen=True, eq=False)
class EquationsAt:
    """Equations with numbers, ready to be evaluated at the current precision."""

    equations: Equations
    values: tuple[tuple[str, ExactValue], ...] = ()  # of every parameter that occurs
    _constants: dict[int, dict[str, acb]] = field(default_factory=dict)  # by bits
    _moving: dict[str, frozenset[str]] = field(default_factory=dict)
    _entries: dict[tuple[str, str], list[dict[int, Factored]]] = field(default_factory=dict)
    # By bits, parameter and id of a value, which is kept so that no other has its id.
    _plans: dict[tuple[int, str], dict[int, tuple[Factored, Plan]]] = field(default_factory=dict)

    def __reduce__(self) -> tuple[type[EquationsAt], tuple[object, ...]]:
        """Leave out what is kept of earlier evaluations: ids mean nothing in another process."""
        return EquationsAt, (self.equations, self.values)

    def on(self, s: Arithmetic, along: str = "") -> NamedValues:
        """Return the values on a ball of s [rad/s], to first order ``along`` ``"s"`` or a parameter."""
        return NamedValues(self, acb_series([s, 1], 2) if along == LAPLACE else s, along)

    def entries(self, output: str = "", source: str = "") -> list[dict[int, Factored]]:
        """Return A row by row, its entries by column; ``[A b; c d]`` with an output and an input."""
        equations, pair = self.equations, (output, source)
        if pair in self._entries:
            return self._entries[pair]
        forms, columns = [row.form for row in equations.rows], [*equations.unknowns]
        if output:
            forms.append(next(o for o in equations.outputs if o.name == output).form)
            columns.append(next(v for v in equations.inputs if v.owner == source))
        places = {v: j for j, v in enumerate(columns)}
        totals = (LinearForm.total([form]).terms for form in forms)
        self._entries[pair] = [{places[v]: c for v, c in terms if v in places} for terms in totals]
        return self._entries[pair]

    def value(self, output: str, source: str, s: acb) -> acb:
        """Return the value of a transfer function on a ball of s; UndecidedError where A may be singular."""
        number, entries, size = self.on(s), self.entries(output, source), len(self.equations.unknowns)
        row_left = eliminate([{j: number(c) for j, c in row.items()} for row in entries], size).rows[size]
        divisor = next(o for o in self.equations.outputs if o.name == output).divisor
        return acb(row_left.get(size, ZERO) / number(divisor))

    def moving(self, along: str) -> frozenset[str]:
        """Return the names whose values depend on s or a parameter, that itself among them."""
        if along not in self._moving:
            self._moving[along] = self._dependent(along)
        return self._moving[along]

    def _dependent(self, along: str) -> frozenset[str]:
        moving, known = {along, *(n for n, call in self.functions.items() if names_among(call, {along}))}, 0
        while len(moving) > known:  # definitions may hold delays, and delays definitions
            known = len(moving)
            moving |= {name for name, value in self.definitions.items() if holds(value, moving)}
            for waves in self.waves:
                parts = (waves.length, waves.law.shift, *waves.law.characteristic)
                if along == LAPLACE or any(holds(part, moving) for part in parts):
                    moving |= set(waves.orders)
        return frozenset(moving)

    @cached_property
    def definitions(self) -> Mapping[str, Factored]:
        """The names that are defined in terms of others."""
        return dict(self.equations.definitions)

    @cached_property
    def waves(self) -> tuple[MemberWaves, ...]:
        """What members are made of, by dispersion and length."""
        groups, propagation = dict[tuple[int, int], MemberWaves](), self.equations.propagation
        if propagation is not None:
            for p in propagation.propagators:
                law, lengths = propagation.table.dispersions[p.dispersion], propagation.lengths[p.dispersion]
                waves = MemberWaves(law, lengths[p.length], {})
                groups.setdefault((p.dispersion, p.length), waves).orders[p.generator] = p.order
        return tuple(groups.values())

    @cached_property
    def waves_of(self) -> Mapping[str, MemberWaves]:
        """To which of these a name belongs."""
        return {name: waves for waves in self.waves for name in waves.orders}

    @cached_property
    def functions(self) -> Mapping[str, Call]:
        """The names that are functions of constants."""
        return {c.generator: c.expression for c in self.equations.constants}

    @cached_property
    def _parameters(self) -> Mapping[str, Callable[[], arb]]:
        return {"pi": arb.pi, IMAGINARY: enclosure(J)} | {
            name: enclosure(value) for name, value in self.values
        }

    def constant(self, name: str) -> acb:
        """Return the value of a name free of s at the current precision."""
        known = self._constants.setdefault(current_bits(), {})
        if name not in known:
            if name in self.functions:
                known[name] = acb(enclose(self.functions[name], self._parameters))
            elif name in self.definitions:
                known[name] = evaluated(self.definitions[name], self.constant, ONE)
            else:
                known[name] = acb(self._parameters[name]())
        return known[name]

    def plan(self, value: Factored, along: str = "") -> Plan:
        """Return how to evaluate a value, with the products of constants, made once for each precision."""
        plans = self._plans.setdefault((current_bits(), along), {})
        if id(value) not in plans:
            plans[id(value)] = value, self._planned(value, self.moving(LAPLACE) | self.moving(along))
        return plans[id(value)][1]

    def _planned(self, value: Factored, names: Collection[str]) -> Plan:
        constant, powers, sums = acb(ball(value.unit)), [], []
        for factor, exponent in value.factors:
            by_moving: dict[tuple[tuple[str, int], ...], acb] = {}
            for monomial, coefficient in terms_of(factor):
                term, moving = acb(coefficient), []
                for name, power in ((value.ring.names[i], e) for i, e in monomial):
                    if name in names:
                        moving.append((name, power))
                    else:
                        term *= self.constant(name) ** power
                by_moving[tuple(moving)] = by_moving.get(tuple(moving), ZERO) + term
            if len(by_moving) == 1:
                ((alone, term),) = by_moving.items()
                constant *= term**exponent
                powers += [(name, power * exponent) for name, power in alone]
            else:
                sums.append((id(factor), [(term, of) for of, term in by_moving.items()], exponent))
        return constant, powers, sums

    # ---------------------------------------------------------------------------- laws that vary along x

    @cached_property
    def functions_along_x(self) -> Mapping[str, Call]:
        """The functions of the coordinate along x among the generators."""
        if not is_tapered(self.equations.model):
            return {}
        return {name: call for name, call in self.functions.items() if varies_along_x(call)}

    @cached_property
    def laws(self) -> Mapping[Dispersion, BoundLaw]:
        """The laws that vary along x, with numbers."""
        propagation = self.equations.propagation
        if propagation is None:
            return {}
        known = {name: partial(self._real, name) for name in propagation.ring.names if name != LAPLACE}
        return {
            law: BoundLaw(
                law.replaced(lambda x: self._opened(propagation.embed(x))),
                self.functions_along_x,
                law.start[0],
                known,
                self._parameters,
            )
            for law in propagation.table.dispersions
            if law.kind == "varying"
        }

    def _real(self, name: str) -> arb:
        return self.constant(name).real

    def _opened(self, value: Factored) -> Factored:
        """Return a coefficient without definitions that depend on s."""
        for name, meant in reversed(self.equations.definitions):
            if name in self.moving(LAPLACE) and value.depends_on(name):
                value = composed(value, {name: meant})
        return value


class NamedValues(dict[str, Arithmetic]):
    """Names in equations with their values at one s, each made when asked for; called, of a quotient."""

    def __init__(self, equations: EquationsAt, s: Arithmetic, along: str = "") -> None:
        self.equations, self.along = equations, "" if along == LAPLACE else along
        self[LAPLACE] = s
        self._factors: dict[int, Arithmetic] = {}  # by their ids

    def __missing__(self, name: str) -> Arithmetic:
        at = self.equations
        if name in at.waves_of:
            self.update(self._waves(at.waves_of[name]))
        elif name in at.definitions:
            self[name] = self(at.definitions[name])
        elif name in at.moving(self.along):
            # A parameter, or a function of constants, to first order in the one they move along
            real = [(n, v) for n, v in self.equations.values if not v.is_imaginary]
            known = {n: first_order(enclosure(v)(), int(n == self.along)) for n, v in real}
            call = self.equations.functions.get(name)
            value = known[name] if call is None else constant_tangent(call, known)
            self[name] = acb_series([acb(value[0]), acb(value[1])], 2)
        else:
            self[name] = at.constant(name)
        return self[name]

    def __call__(self, value: Factored) -> Arithmetic:
        """Return the value of a rational function; KeyError where a name has none."""
        result: Arithmetic
        result, powers, sums = self.equations.plan(value, self.along)
        for name, power in powers:
            result = result * (self[name] if power == 1 else raised(self[name], power))
        for number, terms, exponent in sums:
            known = self._factors.get(number)
            if known is None:
                known = ZERO
                for constant, of in terms:
                    term = constant
                    for name, power in of:
                        term = term * (self[name] if power == 1 else raised(self[name], power))
                    known = known + term
                self._factors[number] = known
            result = result * (known if exponent == 1 else raised(known, exponent))
        return result

    def matrix(self, entries: Sequence[Mapping[int, Factored]]) -> acb_mat:
        """Return the values of a square matrix."""
        matrix = acb_mat(len(entries), len(entries))
        for i, row in enumerate(entries):
            for j, entry in row.items():
                matrix[i, j] = at_centre(self(entry))
        return matrix

    def _waves(self, waves: MemberWaves) -> dict[str, Arithmetic]:
        law = self.equations.laws.get(waves.law)
        if law is None:
            return waves.at(self)
        start, _ = law.ends()
        matrix = law.matrix_at(at_centre(self[LAPLACE]), (start, start + at_centre(self(waves.length)).real))
        return {name: matrix[n // waves.law.order][n % waves.law.order] for name, n in waves.orders.items()}


class Majorants(dict[str, arb]):
    """Bounds on the names in equations for abs(s) up to a radius [rad/s]; called, on rational functions."""

    def __init__(self, equations: EquationsAt, radius: arb) -> None:
        self.equations = equations
        self[LAPLACE] = radius

    def __missing__(self, name: str) -> arb:
        at = self.equations
        if name in at.definitions:
            self[name] = self(at.definitions[name])
        else:
            # With all coefficients turned to grow, what solves the equation is larger term by term.
            grown = at.waves_of[name].at(lambda x: acb(self(x)), -1)
            self.update({each: at_centre(x).real.abs_upper() for each, x in grown.items()})
        return self[name]

    def __call__(self, value: Factored) -> arb:
        """Return a bound on a rational function; EssentialSingularityError where it may have a pole."""
        constant, powers, sums = self.equations.plan(value)
        result = abs(constant) * self._product(powers)
        for _, terms, exponent in sums:
            fixed = abs(sum((c for c, of in terms if not of), ZERO))
            moving = sum((abs(c) * self._product(of) for c, of in terms if of), arb(0))
            if exponent < 0 and not fixed > moving:
                raise EssentialSingularityError
            result *= (fixed + moving if exponent > 0 else fixed - moving) ** exponent
        return arb(result.abs_upper())

    def _product(self, powers: Powers) -> arb:
        if any(power < 0 for _, power in powers):
            raise EssentialSingularityError
        return prod((self[name] ** power for name, power in powers), start=arb(1))


def holds(value: Factored, names: Collection[str]) -> bool:
    """Tell whether a value depends on any of these names."""
    known = value.ring.names
    return any(known[i] in names for f, _ in value.factors for m, _ in terms_of(f) for i, _ in m)

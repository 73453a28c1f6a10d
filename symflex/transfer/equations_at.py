"""The equations of a model with numbers, ``A(s) x + B u = 0``: in balls, and to first order.

Input: :class:`symflex.equations.Equations`, assembled without names for wavenumbers, so that fundamental
functions are entire in s also where wavenumbers vanish; and exact values of the parameters.
Output: the entries of A on a ball of s, with their derivatives in s or in any parameter where asked.

Example: a mass m = 2 kg on a spring k = 8 N/m at s = 1 rad/s. ``m s^2 + k`` is 10; its derivative is
4 in s, 1 in m, 1 in k.

Derivatives are carried forward from s or a parameter, through functions of constants and definitions, to the
fundamental functions (Griewank and Walther 2008, chapter 3).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from flint import acb, acb_mat, acb_series, arb

from symflex.algebra import LAPLACE, Factored, composed, evaluated
from symflex.algebra.propagators import EXPONENTIAL, Propagation
from symflex.along.law import BoundLaw
from symflex.balls import Arithmetic, Value, at_centre
from symflex.expressions import Name, names
from symflex.model.along import is_tapered, varies_along_x
from symflex.transfer.enclose import constant_tangent, enclose, enclosure, first_order
from symflex.transfer.enclose_kernels import fundamental_functions

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from symflex.algebra import Dispersion
    from symflex.equations import Equations
    from symflex.expressions import Call
    from symflex.library.elements import LinearForm, Variable
    from symflex.model import ExactValue

Laws = dict["Dispersion", BoundLaw]
Generators = dict[str, Value]


@dataclass(frozen=True, eq=False)
class EquationsAt:
    """Equations with numbers, ready to be evaluated."""

    equations: Equations
    values: tuple[tuple[str, ExactValue], ...]  # of every parameter that occurs

    def generators(self, s: acb, along: str = "") -> tuple[Generators, Laws]:
        """Return the values of all names on a ball of s [rad/s], and the laws that vary along x.

        ``along`` is ``"s"`` or a parameter: values are series to first order in it then. Members that taper
        have none.
        """
        equations = self.equations
        values: Generators = (
            {LAPLACE: s} if not along else {LAPLACE: acb_series([s, int(along == LAPLACE)], 2)}
        )
        values |= self._constants(along)
        one: Arithmetic = acb_series([1], 2) if along else acb(1)
        waiting = [(n, v) for n, v in equations.definitions if not _define(n, v, values, one)]
        laws = self._laws(values)
        if equations.propagation is not None:
            values |= _propagators(equations.propagation, values, laws, one)
        for name, value in waiting:
            _define(name, value, values, one)
        return values, laws

    def row(self, form: LinearForm, values: Generators, columns: Mapping[Variable, int]) -> dict[int, Value]:
        """Return the coefficients of a linear form by column; what belongs to no column is left out."""
        one: Arithmetic = acb_series([1], 2) if isinstance(values[LAPLACE], acb_series) else acb(1)
        entries: dict[int, Value] = {}
        for variable, coefficient in form.terms:
            if variable in columns:
                j, entry = columns[variable], number(coefficient, values, one)
                entries[j] = entries[j] + entry if j in entries else entry
        return entries

    def matrix(self, forms: Sequence[LinearForm], values: Generators, columns: Sequence[Variable]) -> acb_mat:
        """Return the values of linear forms as rows."""
        places = {variable: j for j, variable in enumerate(columns)}
        matrix = acb_mat(len(forms), len(columns))
        for i, form in enumerate(forms):
            for j, entry in self.row(form, values, places).items():
                matrix[i, j] = at_centre(entry)
        return matrix

    def moving(self, along: str) -> frozenset[str]:
        """Return the names whose values depend on s or a parameter, that itself among them."""
        equations, moving = self.equations, {along}
        for constant in equations.constants:
            if any(isinstance(n, Name) and n.name in moving for n in names(constant.expression)):
                moving.add(constant.generator)
        known = 0
        while len(moving) > known:  # definitions may hold delays, and delays definitions
            known = len(moving)
            for name, value in equations.definitions:  # each in terms of earlier ones
                if holds(value, moving):
                    moving.add(name)
            if (propagation := equations.propagation) is not None:
                laws, lengths = propagation.table.dispersions, propagation.lengths
                for p in propagation.propagators:
                    law = laws[p.dispersion]
                    parts = (lengths[p.dispersion][p.length], law.shift, *law.characteristic)
                    if any(holds(part, moving) for part in parts):
                        moving.add(p.generator)
        return frozenset(moving)

    def _constants(self, along: str) -> Generators:
        equations = self.equations
        used = [c for c in equations.constants if c.generator not in self.functions_along_x]
        if not along:
            later: dict[str, Callable[[], arb]] = {name: enclosure(v) for name, v in self.values}
            plain = {name: evaluate() for name, evaluate in later.items()}
            plain["pi"] = arb.pi()
            plain |= {c.generator: enclose(c.expression, later) for c in used}
            return {name: acb(value) for name, value in plain.items()}
        real = {name: first_order(enclosure(v)(), int(name == along)) for name, v in self.values}
        known = {"pi": first_order(arb.pi()), **real}
        known |= {c.generator: constant_tangent(c.expression, real) for c in used}
        return {name: acb_series([acb(x[0]), acb(x[1])], 2) for name, x in known.items()}

    @cached_property
    def functions_along_x(self) -> Mapping[str, Call]:
        """The functions of the coordinate along x among the generators."""
        if not is_tapered(self.equations.model):
            return {}
        return {c.generator: c.expression for c in self.equations.constants if varies_along_x(c.expression)}

    def _laws(self, values: Generators) -> Laws:
        """Return the laws that vary along x with numbers, given those of all that does not."""
        propagation = self.equations.propagation
        if propagation is None:
            return {}
        constants = {name: _constant(at_centre(v).real) for name, v in values.items() if name != LAPLACE}
        parameters = {name: enclosure(value) for name, value in self.values}
        return {
            law: BoundLaw(
                law.replaced(lambda x: self._opened(propagation.embed(x))),
                self.functions_along_x,
                law.start[0],
                constants,
                parameters,
            )
            for law in propagation.table.dispersions
            if law.kind == "varying"
        }

    def _opened(self, value: Factored) -> Factored:
        """Return a coefficient without definitions that depend on s."""
        moving = {LAPLACE}
        for name, meant in self.equations.definitions:
            if any(meant.depends_on(each) for each in moving):
                moving.add(name)
        for name, meant in reversed(self.equations.definitions):
            if name in moving and value.depends_on(name):
                value = composed(value, {name: meant})
        return value


def number(value: Factored, values: Mapping[str, Value], one: Arithmetic) -> Value:
    """Return a rational function with a value for every generator; KeyError where one has none."""
    result: Value = evaluated(value, values.__getitem__, one)
    return result


def holds(value: Factored, names: Iterable[str]) -> bool:
    """Tell whether a value depends on any of these names."""
    return any(name in value.ring.index and value.depends_on(name) for name in names)


def _define(name: str, value: Factored, values: Generators, one: Arithmetic) -> bool:
    """Add a definition's value; False when it holds what has none yet."""
    try:
        values[name] = number(value, values, one)
    except KeyError:
        return False
    return True


def _constant(value: arb) -> Callable[[], arb]:
    return lambda: value


def _propagators(propagation: Propagation, values: Generators, laws: Laws, one: Arithmetic) -> Generators:
    """Return the fundamental functions and exponentials at s."""
    propagators: Generators = {}
    matrices: dict[tuple[int, int], list[list[acb]]] = {}
    columns: dict[tuple[int, int], tuple[Value, ...]] = {}
    for p in propagation.propagators:
        law = propagation.table.dispersions[p.dispersion]
        length = number(propagation.lengths[p.dispersion][p.length], values, one)
        if p.order == EXPONENTIAL:
            propagators[p.generator] = (-number(law.shift, values, one) * length).exp()
            continue
        key = (p.dispersion, p.length)
        if law in laws:
            if key not in matrices:
                start, _ = laws[law].ends()
                reach = (start, start + at_centre(length).real)
                matrices[key] = laws[law].matrix_at(at_centre(values[LAPLACE]), reach)
            row, column = divmod(p.order, law.order)
            propagators[p.generator] = matrices[key][row][column]
            continue
        if key not in columns:
            coefficients = [number(c, values, one) for c in law.characteristic]
            columns[key] = fundamental_functions(coefficients, length)
        entry = columns[key][p.order]
        propagators[p.generator] = entry if isinstance(one, acb_series) else at_centre(entry)
    return propagators

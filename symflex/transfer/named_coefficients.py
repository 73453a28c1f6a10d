"""Names for the coefficients of field equations, while what a transfer function has in common is cancelled.

Input: a model whose wavenumbers no parameter follows from, and what its laws are.
Output: the same with a definition for every coefficient.

A pair of wavenumbers is tied to parameters by two relations, and common factors are found where each is
solved for a parameter. With ``A = "d^2"`` and ``I = "d^4/12"`` neither is solved for d. Nor are those of two
beams that differ in a damper alone: their wavenumbers are tied to each other besides. With a name of its own
for every coefficient of every law each relation can be solved; in the result the names are opened again.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import partial
from itertools import chain

from symflex.equations import Equations
from symflex.expressions import Equation, Expression, Name, Negative, Number, Product, Quotient, Sum, names
from symflex.library.elements.line import LineElement
from symflex.library.fields import text
from symflex.model import Definition, FieldProblem, Model, PlacedElement
from symflex.model.boundary import depends_on_s, varying_constants
from symflex.transfer.expansion import Expansion


@dataclass
class _Naming:
    """Collects definitions, one per law and value."""

    varying: frozenset[str]  # constants that depend on s
    constants: frozenset[str]  # parameters, definitions, pi
    found: dict[tuple[Hashable, Hashable], Definition] = field(default_factory=dict)

    def name(self, law: Hashable, key: Hashable, value: Expression) -> Expression:
        """Return the name of a value in a law; zero, and what depends on s, stay what they are."""
        if depends_on_s(value, self.varying) or value == Number(Fraction(0)):
            return value
        definition = Definition(f"coefficient[{len(self.found)}]", value)
        return Name(self.found.setdefault((law, key), definition).name)

    def element(self, use: PlacedElement, law: Hashable) -> PlacedElement:
        """Return a line element with names for its values."""
        if not isinstance(use.element, LineElement):
            return use
        kept = {p.name for p in use.element.parameters if p.is_direction} | {use.element.length}
        values = ((n, e if n in kept else self.name(law, n, e)) for n, e in use.values)
        return replace(use, values=tuple(values))

    def field(self, problem: FieldProblem, law: Hashable) -> FieldProblem:
        """Return a field with names for the coefficients in its equations and conditions."""
        put = partial(self._in_expression, law)

        def named(equation: Equation) -> Equation:
            return replace(equation, left=put(equation.left), right=put(equation.right))

        equations, conditions = map(named, problem.equations), map(named, problem.conditions)
        return replace(problem, equations=tuple(equations), conditions=tuple(conditions))

    def _in_expression(self, law: Hashable, expression: Expression) -> Expression:
        put = partial(self._in_expression, law)
        if self._is_constant(expression):
            return self.name(law, expression, expression)
        match expression:
            case Negative(operand):
                return Negative(put(operand))
            case Sum(terms):
                return Sum(tuple(map(put, terms)))
            case Product(factors):
                constant = [f for f in factors if self._is_constant(f)]
                varying = [put(f) for f in factors if not self._is_constant(f)]
                return (
                    Product((put(Product(tuple(constant))), *varying))
                    if constant
                    else Product(tuple(varying))
                )
            case Quotient(numerator, denominator):
                return Quotient(put(numerator), put(denominator))
        return expression

    def _is_constant(self, expression: Expression) -> bool:
        return all(isinstance(n, Name) and n.name in self.constants for n in names(expression))


def named_coefficients(equations: Equations) -> tuple[Model, tuple[str, ...]]:
    """Return the model with definitions for coefficients of its laws, shared where laws are."""
    model, laws = equations.model, _laws(equations)
    varying = varying_constants(model.definitions, model.blocks)
    constants = {"pi", *(p.name for p in model.parameters), *(d.name for d in model.definitions)}
    naming = _Naming(varying, frozenset(constants - varying))
    elements = tuple(naming.element(use, laws.get(use.name)) for use in model.elements)
    fields = tuple(naming.field(problem, laws[problem.name]) for problem in model.fields)
    coefficients = tuple(naming.found.values())
    named = replace(model, elements=elements, fields=fields, definitions=(*model.definitions, *coefficients))
    return named, tuple(d.name for d in coefficients)


def in_order_of_use(model: Model) -> tuple[str, ...]:
    """Return parameters in order of use along x, then others, whatever order they are declared in."""
    lines = [use for use in model.elements if isinstance(use.element, LineElement)]
    used = [dict(use.values).get(p.name) for use in lines for p in use.element.parameters]
    used += [side for field in model.fields for e in field.equations for side in (e.left, e.right)]
    inside = {
        d.name: dict.fromkeys(n.name for n in names(d.expression) if isinstance(n, Name))
        for d in model.definitions
    }
    for name, names_used in inside.items():
        inside[name] = dict.fromkeys(n for each in names_used for n in inside.get(each, {each: None}))
    written = (n.name for e in used if e is not None for n in names(e) if isinstance(n, Name))
    ordered = dict.fromkeys(n for each in written for n in inside.get(each, (each,)))
    declared = {p.name: None for p in model.parameters}
    return tuple(n for n in {**ordered, **declared} if n in declared)


def _laws(equations: Equations) -> dict[str, Hashable]:
    """Return what is equal of line elements and fields with equal equations, however they are written."""
    expansion, propagation = Expansion.of(equations), equations.propagation
    laws: dict[str, Hashable] = {}
    if propagation is None:
        return laws
    for part in equations.continua:
        entries = map(propagation.embed, chain(*part.system.matrix, *part.system.loads))
        laws[part.name] = (part.kind, part.system.states, *(text(expansion.expanded(x)) for x in entries))
    return laws

"""From a transfer function to the programs that compute it.

Input: a :class:`symflex.transfer.TransferFunction`.
Output: a lumped :class:`Piecewise` per way of evaluating it. ``closed``, ``closed in s`` and ``nested`` keep
sums such as k + b*s and definitions as intermediates: the first in recurrences over the elements, the second
in recurrences that part powers of s too, the third by powers of s; ``factors`` multiplies out every factor by
powers of s.

Of a nested transfer function every shared step becomes an assignment: nothing is a power of s above the
second or so, nor a product of many impedances, so nothing overflows long before the value does.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from math import inf
from typing import TYPE_CHECKING

from flint import fmpz_mpoly

from symflex.algebra import LAPLACE, Factored, Ring
from symflex.budget import spend
from symflex.codegen.program.forge import Forge, schedule
from symflex.codegen.program.nodes import ParameterValue, Piecewise, Solve
from symflex.codegen.program.polynomials import (
    RingValues,
    degree_of,
    evaluate_polynomial,
    express,
    plan_recurrences,
)
from symflex.equations import ConstantFunction
from symflex.errors import BudgetError, Diagnostic, ModelError
from symflex.expressions import Expression, Name, fold
from symflex.model import Model
from symflex.model.along import COORDINATE
from symflex.model.linearity import integer_exponent
from symflex.print.forms.nested import step_names
from symflex.transfer import NestedTransferFunction, TransferFunction

if TYPE_CHECKING:
    from symflex.equations.line_network import LineNetwork


TERM_LIMIT = 20_000  # terms a program may be made of; beyond that its text would be megabytes
HEADROOM, FAR_FROM = 180, 1e15
"""Decades a power of s may reach in double precision, of 308 in all: coefficients have the rest; and
abs(s) [rad/s] below which they could overflow where a far branch is made."""

PI = "pi"


def build_program(tf: TransferFunction, form: str | None = None) -> Piecewise:
    """Return the program of one form, by default the first there is; SF503 if it would be too large."""
    forms = available_forms(tf)
    if not forms:
        message = f"a program for {tf.name} would have more than {TERM_LIMIT} terms"
        raise BudgetError(Diagnostic("SF503", message, None, "keep repeated sums in [definitions]"))
    parameters = tuple(p.name for p in tf.parameters)
    forge = forge_of(tf.model)
    if tf.is_zero:
        return schedule(forge, parameters, forge.constant(0), None, inf)
    make = _maker(tf, form or forms[0])
    near, degree = make(Generators(forge, tf, is_far=False))
    limit = 10.0 ** (HEADROOM // degree) if degree else inf
    if limit >= FAR_FROM or tf.model.root is not None:
        return schedule(forge, parameters, near, None, inf)
    far, _ = make(Generators(forge, tf, is_far=True))
    return schedule(forge, parameters, near, far, limit)


def forge_of(model: Model) -> Forge:
    """Return a workbench for functions of s, or of a root of it; SF910 if that is no square root."""
    if (root := model.root) is None:
        return Forge()
    if root.order & (root.order - 1):
        message = f"code for powers of s with the denominator {root.order} is not available yet"
        raise ModelError(Diagnostic("SF910", message, None, "that for halves, quarters and eighths is"))

    def made(forge: Forge, s: int) -> int:
        slope, shift = (constant_of(forge, model, x) for x in (root.slope, root.shift))
        inside = forge.add([forge.multiply([slope, s]), shift])
        for _ in range(root.order.bit_length() - 1):
            inside = forge.apply("complex_sqrt", inside)
        return forge.label(inside, "r")

    return Forge(root=made)


def available_forms(tf: TransferFunction) -> tuple[str, ...]:
    """Return the forms a lumped transfer function can be evaluated in, the preferred one first."""
    forms: list[str] = []
    if not tf.is_rational:
        return ()
    if (closed := tf.closed) is not None and not tf.is_zero:
        used = [value for name, value in tf.definitions if name in closed.generators]
        # The closed form would divide away the poles of a definition at run time.
        has_poles = any(value.is_zero or value.denominator().depends_on(LAPLACE) for value in used)
        terms = [len(closed.num), len(closed.den), *(len(p) for _, p in closed.closure.sums)]
        # A parameter that cancels where definitions are opened is no argument.
        has_others = not set(tf.parameters_below(closed.generators)) <= set(tf.parameters)
        if not has_poles and not has_others and sum(terms) <= TERM_LIMIT:
            forms += ["closed", "closed in s", "nested"]
    if tf.length <= TERM_LIMIT:
        forms.append("factors")
    return tuple(forms)


@dataclass
class Generators:
    """Makes an expression for every generator, in powers of s or of 1/s."""

    forge: Forge
    tf: TransferFunction
    is_far: bool
    _made: dict[str, tuple[int, int]] = field(default_factory=dict)

    def polynomial(self, ring: Ring, polynomial: fmpz_mpoly) -> tuple[int, int]:
        """Return an expression and its degree in s; in the far branch of ``polynomial / s**degree``."""
        images = self.images(ring, (polynomial,))
        return evaluate_polynomial(self.forge, polynomial, images), degree_of(polynomial, images.degrees)

    def images(self, ring: Ring, polynomials: Iterable[fmpz_mpoly]) -> RingValues:
        """Return what stands for a ring's generators, for those in use."""
        spend()
        used = ring.used_in(polynomials)
        pairs = [self.generator(n) if n in used or n == LAPLACE else (0, 0) for n in ring.names]
        return RingValues(tuple(v for v, _ in pairs), tuple(d for _, d in pairs), ring.index[PI], self.is_far)

    def product(self, value: Factored) -> tuple[int, int]:
        """Return a product of powers of polynomials, its unit left out, and its degree in s."""
        parts: list[int] = []
        total = 0
        for factor, exponent in value.factors:
            part, degree = self.polynomial(value.ring, factor)
            parts.append(self.forge.power(part, exponent))
            total += degree * exponent
        return self.forge.multiply(parts), total

    def balance(self, above: tuple[int, int], below: tuple[int, int]) -> int:
        """Return the quotient, with the power of s that the far branch divided out."""
        (num, num_degree), (den, den_degree) = above, below
        if self.is_far:
            base = self.forge.s if num_degree > den_degree else self.forge.inverse
            num = self.forge.multiply([num, self.forge.power(base, abs(num_degree - den_degree))])
        suffix = "_far" if self.is_far else ""
        for part, label in ((num, "num"), (den, "den")):
            size = self.forge.signed(part)[1]
            if self.forge.depends[size]:
                self.forge.label(size, label + suffix)
        return self.forge.divide(num, den)

    def generator(self, name: str) -> tuple[int, int]:
        """Return the expression of a generator, and its degree in s."""
        if name not in self._made:
            self._made[name] = self._make(name)
        return self._made[name]

    def _make(self, name: str) -> tuple[int, int]:
        forge, tf = self.forge, self.tf
        if name == LAPLACE:
            return (forge.inverse if self.is_far else forge.s), 1
        if name in (definitions := dict(tf.definitions)):
            value, degree = self.quotient(definitions[name])
            return self._labelled(value, name), degree
        if tf.closed is not None and name in (sums := dict(tf.closed.closure.sums)):
            total, degree = self.polynomial(tf.closed.closure.base, sums[name])
            return self._labelled(total, name), degree
        constants = {c.generator: c.expression for c in tf.constants}
        return constant_of(forge, tf.model, constants.get(name, Name(name))), 0

    def quotient(self, value: Factored) -> tuple[int, int]:
        """Return a rational function, and the degree of its numerator in s."""
        forge = self.forge
        (above, degree), (below, _) = (self.product(v) for v in (value.numerator(), value.denominator()))
        return forge.divide(forge.multiply([forge.ratio(value.unit), above]), below), degree

    def _labelled(self, value: int, name: str) -> int:
        suffix = "_far" if self.is_far and self.forge.depends[value] else ""
        return self.forge.label(value, name + suffix)


def constant_of(forge: Forge, model: Model, expression: Expression) -> int:
    """Return an expression of constants, or of the coordinate along x, as the model writes it."""

    def named(name: str) -> int:
        if name == PI:
            return forge.constant(1, 1)
        inner = next((e for n, e in _every_definition(model) if n == name), None)
        if any(p.name == name for p in model.parameters):
            return forge.parameter(name)
        if inner is None:
            return forge.s if name == COORDINATE else forge.parameter(name)
        return forge.label(constant_of(forge, model, inner), name)

    def power(base: int, exponent: Expression) -> int:
        order = integer_exponent(exponent) or 0
        raised = forge.power(base, abs(order))
        return raised if order >= 0 else forge.divide(forge.constant(1), raised)

    return fold(
        expression,
        number=forge.constant,
        name=named,
        power=power,
        call=lambda call, argument: forge.apply(call.name, argument),
        negative=forge.negate,
        total=forge.add,
        product=forge.multiply,
        quotient=forge.divide,
    )


def _every_definition(model: Model) -> Iterator[tuple[str, Expression]]:
    """Yield the definitions of a model and then those of the models inside its blocks."""
    yield from ((d.name, d.expression) for d in model.definitions)
    for block in model.blocks:
        if block.submodel is not None:
            yield from _every_definition(block.submodel)


def _maker(tf: TransferFunction, form: str) -> Callable[[Generators], tuple[int, int]]:
    """Return what makes the value of a form, and the highest power of s in it, for either branch."""
    if form == "factors":
        return _factors
    closed = tf.closed
    assert closed is not None  # a form that is available
    ring, polynomials = closed.closure.ring, (closed.num, closed.den)
    if form == "nested":
        return lambda g: _quotient(g, [g.polynomial(ring, p) for p in polynomials])
    plan = plan_recurrences(ring, polynomials, splits_s=form == "closed in s")
    return lambda g: _quotient(g, express(g.forge, plan, g.images(ring, polynomials)))


def _quotient(generators: Generators, parts: Sequence[tuple[int, int]]) -> tuple[int, int]:
    above, below = parts
    return generators.balance(above, below), max(above[1], below[1])


def _factors(generators: Generators) -> tuple[int, int]:
    """Return the product of factors and the highest power of s in it."""
    ratio, forge = generators.tf.ratio, generators.forge
    varying = Factored(ratio.ring, Fraction(1), tuple(f for f in ratio.factors if int(f[0].degrees()[0])))
    fixed = Factored(ratio.ring, Fraction(1), tuple(f for f in ratio.factors if not int(f[0].degrees()[0])))
    gain = forge.divide(
        forge.multiply([forge.constant(ratio.unit.numerator), generators.product(fixed.numerator())[0]]),
        forge.multiply([forge.constant(ratio.unit.denominator), generators.product(fixed.denominator())[0]]),
    )
    num, num_degree = generators.product(varying.numerator())
    den, den_degree = generators.product(varying.denominator())
    above, below = (forge.multiply([gain, num]), num_degree), (den, den_degree)
    return _quotient(generators, (above, below))


OPERATION_LIMIT = 100_000  # operations a program may have; beyond that its text would be many megabytes


def build_nested(tf: NestedTransferFunction) -> Piecewise:
    """Return the program of a nested function, or one that solves the network; SF503 if it is too large."""
    if not tf.is_rational:
        return _build_solved(tf, tf.cut.network)
    size = tf.size
    if size > OPERATION_LIMIT:
        message = f"a program for {tf.name} would have {size} operations, more than {OPERATION_LIMIT}"
        raise BudgetError(Diagnostic("SF503", message, None, "evaluate it with the Python interface"))
    forge = forge_of(tf.model)
    program = tf.program
    named = _generators(forge, tf.model, tf.constants)
    made = program.values(
        program.operations(tf.steps),
        name=lambda position: named(program.names[position]),
        number=forge.ratio,
        negative=forge.negate,
        total=forge.add,
        product=forge.multiply,
        quotient=forge.divide,
        power=forge.power,
    )
    for i, name in step_names(tf).items():
        forge.label(forge.signed(made[i])[1], name)
    ratio = forge.divide(made[tf.num], made[tf.den])
    return schedule(forge, tuple(p.name for p in tf.parameters), ratio, None, inf)


def _generators(forge: Forge, model: Model, constants: Iterable[ConstantFunction]) -> Callable[[str], int]:
    """Return what makes s, pi, parameters and functions of constants of their names."""
    expressions = {c.generator: c.expression for c in constants}

    def named(name: str) -> int:
        return forge.s if name == LAPLACE else constant_of(forge, model, expressions.get(name, Name(name)))

    return named


def _build_solved(tf: NestedTransferFunction, network: LineNetwork) -> Piecewise:
    """Return the program of a transfer function of a network of line elements, which is solved as it is."""
    forge = forge_of(tf.model)
    entries = network.values(
        name=_generators(forge, tf.model, network.equations.constants),
        number=forge.constant,
        total=forge.add,
        product=forge.multiply,
        quotient=forge.divide,
        power=forge.power,
        exponential=lambda x: forge.apply("complex_exp", x),
    )
    used = {node.name for node in forge.nodes if isinstance(node, ParameterValue)}
    ends = network.numbers(tf.output.name, tf.input.name)
    value = forge.make(Solve, tuple(entries), network.table, *ends)
    return schedule(forge, tuple(p.name for p in tf.model.parameters if p.name in used), value, None, inf)

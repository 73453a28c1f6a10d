"""Why the zeros of a transfer function are where they are.

Input: a transfer function with numbers, its poles and zeros, and the model they come of.
Output: a :class:`ZeroExplanation`: the constrained system whose poles the zeros are, whether that is proved,
what the system separates into, and what zeros off the imaginary axis mean.

    F pushes the first of two masses joined by a spring k; X is its displacement.
    numerator of X/F                           m_2 s^2 + k
    determinant of the system with x held      m_2 s^2 + k
    colocated, proved: the zeros +-j sqrt(k/m_2) are the poles of the second mass on its spring.

The zeros are the poles of the system in which the output is kept at zero by whatever the input takes: the
numerator is the determinant bordered by the output's row and the input's column (Cramer). Where the input
acts on the coordinate that the output shows, keeping the output at zero is holding that coordinate (Miu 1991,
"Physical interpretation of transfer function zeros for simple control systems with mechanical flexibilities",
ASME J. Dyn. Sys. Meas. Control 113).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE, Factored, degree_in
from symflex.analysis.explanation.at_points import PrimePoints
from symflex.analysis.explanation.constraints import Constraint, hold, open_circuit, replace_condition
from symflex.analysis.explanation.coordinates import acting, in_one_way, measured, seen_at_the_input
from symflex.analysis.explanation.ends import bending_between, ends_of_element, ends_of_field, is_line
from symflex.analysis.explanation.parts import Relation, Separation, relate, separate, varying, waves_of
from symflex.analysis.explanation.text import EndChange, Kind, RealZero, Status, ZeroExplanation
from symflex.balls import opposite
from symflex.equations import Equations
from symflex.equations.elimination import Determinants
from symflex.errors import ModelError
from symflex.expressions import format_expression, power, product_of
from symflex.model import Input, Model, Output, with_numbers
from symflex.model.loss_factors import check_causal
from symflex.print.forms.arrange import Arranger
from symflex.transfer.lowest_terms import cancel
from symflex.transfer.of_model import assemble, assemble_sparse

if TYPE_CHECKING:
    from symflex.roots import PoleZeroMap
    from symflex.transfer import AnyBoundFunction

SYMBOLIC_ELEMENTS = 12  # lumped models up to this size keep their symbols, so that factors print
LONGEST = 100  # characters of a factor that is printed


System = Determinants | PrimePoints  # its determinants, or their values where these are not multiplied out


@dataclass(frozen=True, eq=False)
class _Case:
    """One transfer function with its equations and determinants."""

    model: Model
    pair: tuple[str, str]
    equations: Equations
    whole: System  # of the equations

    @property
    def output(self) -> Output:
        return next(o for o in self.model.outputs if o.name == self.pair[0])

    @property
    def input(self) -> Input:
        return next(i for i in self.model.inputs if i.name == self.pair[1])

    @property
    def status(self) -> Status:
        """How sure a relation is: at points of a prime field almost."""
        return "almost surely" if isinstance(self.whole, PrimePoints) else "proved"

    def constrained(self, constraint: Constraint) -> System | None:
        """Return a constrained model as this one is, ``None`` when the constraint repeats another."""
        try:
            if isinstance(self.whole, PrimePoints):
                return PrimePoints(assemble_sparse(constraint.model))
            return Determinants.of(assemble(constraint.model))
        except ModelError:
            return None

    def relate(self, factor: Factored, held: System) -> Relation | None:
        """Return how the numerator and the determinant of a constrained system are related."""
        if isinstance(self.whole, PrimePoints):
            return self.whole.relate(self.pair, factor, held.equations)
        return relate(self.whole, self.pair, factor, held) if isinstance(held, Determinants) else None

    def separate(self, equations: Equations) -> Separation:
        """Return the parts of a constrained system."""
        varies = self.whole.varies if isinstance(self.whole, PrimePoints) else None
        return separate(equations, self.pair[1], self.model, varies)

    def explained(
        self, kind: Kind, status: Status, constraint: Constraint, *, is_direct: bool, order: int = 0
    ) -> ZeroExplanation:
        """Return that the zeros are the poles of a constrained system, or how they are related to them."""
        held = (constraint.held, constraint.words, constraint.spec)
        return ZeroExplanation("/".join(self.pair), kind, status, *self.pair, is_direct, *held, order)


def explain_zeros(model: Model, bound: AnyBoundFunction, located: PoleZeroMap) -> ZeroExplanation:
    """Explain the zeros of a transfer function; the model's numbers are those of ``bound``.

    Determinants of networks in nested form are compared at points, see :mod:`.at_points`.

    >>> from symflex import pipeline
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... elements.body = { type = "mass", at = "x", m = 2 }
    ... elements.tail = { type = "mass", at = "y", m = 3 }
    ... elements.link = { type = "spring", between = ["x", "y"], k = 12 }
    ... inputs.F = { force = "x" }
    ... outputs.X = "x"
    ... ''')
    >>> (bound,) = pipeline.derive_bound(model, [("X", "F")])
    >>> told = explain_zeros(model, bound, pipeline.roots(bound))
    >>> told.kind, told.status, told.held, told.parts[0].elements
    ('colocated', 'proved', 'x = 0', ('tail', 'link'))
    """
    check_causal(model, "an explanation of zeros")
    values = dict(bound.values)
    parameters = tuple(replace(p, value=values.get(p.name, p.value)) for p in model.parameters)
    given = replace(model, parameters=parameters)
    is_nested = not bound.is_reduced
    if is_nested or len(model.elements) > SYMBOLIC_ELEMENTS:
        given = with_numbers(given)
    pair = (bound.source.output.name, bound.source.input.name)
    given = seen_at_the_input(in_one_way(given), pair[0], bound.source.input)
    if bound.is_zero:
        return ZeroExplanation(bound.name, "zero", "proved", *pair)
    equations = assemble_sparse(given) if is_nested else assemble(given)
    case = _Case(given, pair, equations, PrimePoints(equations) if is_nested else Determinants.of(equations))
    plain = ZeroExplanation(bound.name, "noncolocated", "proved", *pair)
    has_zeros, has_hidden = True, any(not h.root.is_zero for h in located.hidden)
    if bound.is_reduced:
        has_hidden, factors = bool(bound.hidden), bound.ratio.factors
        has_zeros = not bound.is_rational or any(e > 0 and degree_in(f, 0) for f, e in factors)
    explained = _by_coordinate(case) or _by_condition(case) or _by_terminals(case)
    complete = replace(explained or plain, has_zeros=has_zeros, has_hidden=has_hidden)
    return _with_roots(case, complete, located)


# ------------------------------------------------------------------------------ what the zeros are poles of


def _by_coordinate(case: _Case) -> ZeroExplanation | None:
    """Hold the coordinate that the output shows."""
    motion = measured(case.equations, case.pair[0])
    if motion is None:
        return None
    constraint = hold(case.model, motion.coordinates)
    held = case.constrained(constraint)
    if held is None:
        return None
    is_direct = acting(case.model, case.input) == motion.coordinates
    relation = case.relate(motion.factor, held)
    if relation is None:
        return case.explained("colocated", "not shown", constraint, is_direct=True) if is_direct else None
    separation = case.separate(held.equations)
    kind, transmission = _kind(case, relation, separation, motion.factor)
    plain = replace(
        case.explained(kind, case.status, constraint, is_direct=is_direct, order=relation.order),
        filtered=_text(case.equations, relation.filtered),
        is_delayed=relation.is_delayed,
    )
    if kind == "noncolocated":
        return replace(plain, spec="", words="")
    return replace(
        plain,
        extra="" if kind == "partly" else _text(case.equations, relation.apart),
        transmission=transmission,
        parts=separation.parts,
        ends=_end_changes(case, separation),
    )


def _kind(case: _Case, relation: Relation, separation: Separation, factor: Factored) -> tuple[Kind, str]:
    """Return what kind of pair it is, and the factor of the numerator that no undriven part accounts for."""
    one = Factored.number(case.equations.ring, 1)
    if relation.is_equality:
        return "colocated", ""
    undriven = [part.system for part in separation.parts if not part.has_input]
    if isinstance(case.whole, PrimePoints):
        ratio = case.whole.ratio(case.pair, factor, undriven) if undriven else None
        if ratio is None or not (ratio.order == 0 or ratio.is_rational):
            return "noncolocated", ""
        return ("beyond", "") if ratio.order == 0 else ("partly", "...")
    if not relation.has_zeros or relation.transmission is None:
        return "noncolocated", ""
    driven = one
    for part in separation.parts:
        if part.has_input:
            driven = driven * part.determinant
    remainder, _ = cancel(relation.transmission * driven, relation.apart)
    remainder = varying(case.equations, remainder)
    if any(exponent < 0 for _, exponent in remainder.factors):
        return "noncolocated", ""
    if remainder.is_constant:
        return "beyond", ""
    return ("partly", _text(case.equations, remainder)) if undriven else ("noncolocated", "")


def _by_condition(case: _Case) -> ZeroExplanation | None:
    """Let a field's condition that contains the input give way to one that keeps the output at zero."""
    replaced = replace_condition(case.model, case.input, case.output.expression)
    if replaced is None:
        return None
    constraint = replaced.constraint
    held = case.constrained(constraint)
    if held is None:
        return None
    # The factor that cleared the denominators of the condition with the input is not part of the numerator.
    terms = [term for row in case.equations.rows for term in row.form.terms]
    scale = next(c for v, c in terms if v.kind == "input" and v.owner == case.pair[1])
    relation = case.relate(scale, held)
    if relation is None and replaced.is_dual:
        return case.explained("colocated", "not shown", constraint, is_direct=True)
    if relation is None or relation.transmission is None or not relation.apart.is_constant:
        return None
    # What the output does to the value it shows is all that is left of the numerator.
    order = relation.transmission.exponent_of(case.equations.ring.generator(LAPLACE))
    filtered = relation.transmission / Factored.generator(case.equations.ring, LAPLACE) ** order
    after = next(f for f in constraint.model.fields if f.name == replaced.field.name)
    ends = (ends_of_field(replaced.field), ends_of_field(after))
    kind: Kind = "colocated" if replaced.is_dual else "noncolocated"
    return replace(
        case.explained(kind, case.status, constraint, is_direct=replaced.is_dual, order=order),
        filtered=_text(case.equations, filtered),
        parts=case.separate(held.equations).parts,
        ends=(EndChange(replaced.field.name, *ends),) if all(ends) else (),
    )


def _by_terminals(case: _Case) -> ZeroExplanation | None:
    """Open the terminals of a voltage input whose current the output shows; free what an input moves."""
    constraint = open_circuit(case.model, case.input)
    held = None if constraint is None else case.constrained(constraint)
    if constraint is None or held is None:
        return None
    relation = case.relate(Factored.number(case.equations.ring, 1), held)
    if relation is None or relation.transmission is None or not relation.apart.is_constant:
        return None
    s = case.equations.ring.generator(LAPLACE)
    order = relation.transmission.exponent_of(s)
    if any(f != s for f, _ in relation.transmission.factors):
        return None
    kind: Kind = "open circuit" if case.input.kind in ("voltage", "signal") else "free"
    plain = case.explained(kind, case.status, constraint, is_direct=True, order=order)
    return replace(plain, parts=case.separate(held.equations).parts)


# --------------------------------------------------------------------------------------------- in words


def _text(equations: Equations, value: Factored) -> str:
    """Return a product of factors in s in the spec language; ``...`` when it is long or holds waves."""
    if value.is_constant:
        return ""
    arranger = Arranger.plain(equations.ring, {c.generator: c.expression for c in equations.constants})
    if any(value.depends_on(name) for name in waves_of(equations)):
        return "..."
    text = format_expression(product_of([power(arranger.collected(f), e) for f, e in value.factors]))
    return text if len(text) <= LONGEST else "..."


def _end_changes(case: _Case, separation: Separation) -> tuple[EndChange, ...]:
    """Return the line elements whose ends the constraint changes, parts with the input left out."""
    before = case.separate(case.equations).resting
    driven = {name for part in separation.parts if part.has_input for name in part.elements}
    changes = []
    for use in case.model.elements:
        if is_line(use) and use.name not in driven:
            ends = [ends_of_element(case.model, use, resting) for resting in (before, separation.resting)]
            if ends[0] != ends[1]:
                changes.append(EndChange(use.name, *ends))
    return tuple(changes)


def _with_roots(case: _Case, explained: ZeroExplanation, located: PoleZeroMap) -> ZeroExplanation:
    """Return the explanation with what there is to say about the zeros in the region shown."""
    right = [root for root in located.zeros if root.re > 0]
    real = [root for root in right if root.is_real]
    negative = [root for root in located.zeros if root.is_real and root.re < 0]
    pairs = tuple(
        RealZero(root, any(bool(opposite(other.re).overlaps(root.re)) for other in negative)) for root in real
    )
    return replace(
        explained,
        right_half_plane=sum(root.multiplicity for root in right),
        real_zeros=pairs,
        on_axis=sum(r.multiplicity for r in located.zeros if r.on_imaginary_axis and not r.is_zero),
        bending=bending_between(case.model, case.equations, case.output, case.input)
        if explained.kind in ("noncolocated", "partly", "beyond")
        else None,
    )

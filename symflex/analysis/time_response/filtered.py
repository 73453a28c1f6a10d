"""Passive models that a voltage drives: a force filtered by something rational moves them as much.

Input: a bound transfer function. Output: that of a force or torque on some node, and the filter g.

Example: a motor, ``tau = k_t i`` with ``R i + L s i = V - k_t s phi``. A voltage moves what is on the shaft
as the torque ``k_t/(R + L s) V`` does with the terminals short-circuited. So the response is a convolution,

    y = g * z,    g(t) = (k_t/L) e^(-t R/L)

and where z is known up to a radius at all times, y is known up to that times the integral of abs(g).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from flint import acb, arb

from symflex.algebra import NO_KERNELS
from symflex.analysis.explanation.coordinates import in_one_way
from symflex.analysis.time_response.exponentials import ExponentialTerm
from symflex.analysis.time_response.partial_fractions import EnclosedQuotient, at_infinity, partial_fractions
from symflex.analysis.time_response.passive_modes import force_on
from symflex.library.elements import CIRCUITS, Variable
from symflex.model.model import Input, NodeReference
from symflex.model.signs import is_passive
from symflex.roots.polynomial_roots import find_polynomial_roots
from symflex.roots.problem import problem_of
from symflex.transfer.bind import bind
from symflex.transfer.of_model import derive_all

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.transfer import BoundTransferFunction

MOST_NODES = 12
"""At which a force is tried."""
FORCE = "filtered force"
"""Name of an input in a model whose names hold no blanks."""


@dataclass(frozen=True)
class Filtered:
    """A function that is another one times a rational one."""

    driven: BoundTransferFunction  # by a force
    impulse_response: tuple[ExponentialTerm, ...]  # of the filter, all of which decay

    @property
    def weight(self) -> arb:
        """A bound of the integral of abs(g)."""
        total = arb(0)
        for term in self.impulse_response:
            for j, c in enumerate(term.coefficients):
                total += abs(c) / (-term.rate.real) ** (j + 1)
        return total.upper()

    def convolved(self, terms: Sequence[ExponentialTerm]) -> list[ExponentialTerm] | None:
        """Return the filter's response to a sum of exponentials; None where two of them are too close."""
        found: list[ExponentialTerm] = []
        for own in self.impulse_response:
            if len(own.coefficients) > 1:
                return None
            (a,) = own.coefficients
            besides = acb(0)
            for term in terms:
                # Re(x) * Re(y) is half of Re(x * y) and of Re(x * conj(y)).
                for rate, coefficients in (
                    (term.rate, term.coefficients),
                    (term.rate.conjugate(), tuple(c.conjugate() for c in term.coefficients)),
                ):
                    apart = own.rate - rate
                    if apart.contains(0):
                        return None
                    kept = [acb(0)] * len(coefficients)
                    for j, c in enumerate(coefficients):
                        # 1/((s - g)(s - p)^(j + 1)) has at g the residue 1/(g - p)^(j + 1).
                        share = a * c / 2
                        besides += share / apart ** (j + 1)
                        for i in range(j + 1):
                            kept[j - i] -= share / apart ** (i + 1)
                    found.append(ExponentialTerm(rate, tuple(kept)))
            found.append(ExponentialTerm(own.rate, (besides,)))
        return found if all(c.is_finite() for term in found for c in term.coefficients) else None


def filtered(bound: BoundTransferFunction, digits: int) -> Filtered | None:
    """Return a passive model's function as that of a force, filtered; None where no force does the same."""
    model = bound.source.model
    if not bound.is_of_model or not is_passive(model, bound.all_values):
        return None
    model = in_one_way(model)
    places = [
        Variable("node", node.name, component)
        for node in model.nodes
        if node.domain not in CIRCUITS
        for component in node.components
    ]
    if len(places) > MOST_NODES:
        return None
    kinds = [(v, kind) for v in places if (kind := force_on(model, v)) is not None]
    forces = [
        Input(f"{FORCE} {i}", kind, (NodeReference(v.owner, v.component),))
        for i, (v, kind) in enumerate(kinds)
    ]
    output = bound.source.output.name
    given = replace(model, inputs=(*model.inputs, *forces), figures=(), published=())
    pairs = [(output, bound.source.input.name), *((output, force.name) for force in forces)]
    own, *others = (bind(tf, dict(bound.values)) for tf in derive_all(given, pairs))
    for driven in others:
        if driven.is_zero:
            continue
        ratio = own.ratio / driven.ratio
        if any(ratio.depends_on(name) for name in own.kernels.generators):
            continue
        rational = replace(own, ratio=ratio, kernels=NO_KERNELS, parts=None, hidden=())
        poles = find_polynomial_roots(
            problem_of(rational, [(f, -e) for f, e in ratio.factors if e < 0]), digits
        )
        quotient = EnclosedQuotient.of(rational, max((p.working_bits() for p in poles), default=0) + 64)
        terms = partial_fractions(quotient, poles, 0)
        if not poles or terms is None or at_infinity(quotient, 0)[0]:
            continue
        if all(term.rate.real < 0 for term in terms):
            return Filtered(driven, tuple(terms))
    return None

"""Systems that only lose energy: how much the poles beyond a circle may add to a response, at any time.

Input: a bound transfer function of a model in which nothing supplies energy but the input.
Output: a bound of its step response less the terms of all poles with abs(s) below a radius R.

Example: a force on a mass m gives ``H = 1/(m s^2)``, and beyond any R nothing is left out; the bound is of
the size of H(R) = 1/(m R^2).

Let a be the coordinate that the input acts on, and H_aa what a force at a moves there. ``s H_aa`` is positive
real, so there is a measure nu >= 0 of frequencies, even, with (Cauer 1932; Anderson & Vongpanitlerd 1973)

    H_aa(s) = alpha + integral of nu(dw)/(s^2 + w^2)    and a step response
    y(t)    = alpha + integral of (1 - cos(w t))/w^2 nu(dw)

At real s = R it shows how much lies beyond R: there 1/w^2 is at most 2/(R^2 + w^2), and so alpha and all
w > R together add at most 4 H_aa(R), which is one value. Between a and another coordinate b, nu is at most
the geometric mean of both (it is a matrix that is nowhere negative), and so is its bound.

What lies below R is an integral of H (e^(st) + e^(-st) - 2)/(2 pi j s) along the imaginary axis, just right
of it. The first exponential is moved to the left half of the circle abs(s) = R: between are the poles within
R, whose residues are summed. The rest is moved to the right half, where there are none. On both halves no
exponential is larger than 1, so what they add is at most (left + 3 right)/(2 pi), where left and right are
integrals of abs(H/s). These are finite paths, covered with balls. Nothing is assumed about poles beyond R, or
about how fast H falls off.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from math import pi
from typing import ClassVar

from flint import acb, arb

from symflex.algebra import Factored
from symflex.analysis.explanation.coordinates import (
    PAIR,
    Coordinates,
    acting,
    driven_source,
    in_one_way,
    measured,
    parted_at,
)
from symflex.analysis.time_response.effort import EFFORT
from symflex.analysis.time_response.function_size import BoundBySize, Rest, SizeOfExponentials
from symflex.analysis.time_response.sample_times import SampleTimes
from symflex.analysis.time_response.sampled import Refused
from symflex.balls import ball, precision
from symflex.expressions import Attribute, Name, Negative, Number, Sum, substitute
from symflex.library.elements import CIRCUITS, COMPONENT_DOMAIN, Variable
from symflex.model import Model
from symflex.model.model import INPUT_KINDS, Input, NodeReference, Output
from symflex.model.signs import line_of, value_along
from symflex.roots import Root
from symflex.roots.passivity import energy_proof
from symflex.transfer import BoundTransferFunction, bind
from symflex.transfer.of_model import assemble, derive_all

STEP, RAMP = 1, 2  # impulses, integrated so often
OUTPUT, INPUT = "displacement", "reaction"  # names in a model whose names begin differently


@dataclass(frozen=True, eq=False)
class PassiveBound(BoundBySize):
    """A passive model's transfer function from a force to ``factor * s^order`` times a displacement."""

    name: ClassVar = "passive modes"

    function: SizeOfExponentials
    order: int
    factor: arb  # its size
    colocated: tuple[SizeOfExponentials, ...]  # what forces at both ends move; none where these are one

    def may_be_pole(self, root: Root) -> bool:
        """Tell whether a root may be a pole: none lies in the right half-plane, undamped all on the axis."""
        return not (root.re > 0 or (root.re < 0 and self.function.is_even))

    def rest(self, reached: float, integrations: int, times: SampleTimes) -> Rest | None:
        """Return what energy bounds: a step of a displacement, and what is smoother."""
        smooth = integrations - self.order
        with precision(EFFORT.bits):
            radius = arb(reached).exp()
            right = self.function.on_arc(reached, 0.0, pi / 2)
            left = right if self.function.is_even else self.function.on_arc(reached, pi / 2, pi)
            sizes = [each.at(acb(radius)) for each in self.colocated or (self.function,)]
            finite = [size for size in sizes if size is not None]
            if right is None or left is None or len(finite) < len(sizes):
                return None
            beyond = 4 * (finite[0] * finite[-1]).sqrt()
            beyond *= self.factor if self.colocated else radius**-self.order
            # Both arcs stand for their mirror images as well.
            step = beyond + (left + 3 * right) / arb.pi() / radius**self.order
            if smooth == RAMP:
                # Of exp(st) - 1 in place of exp(st), the 1 adds an integral over the whole circle.
                last = arb(float(times.seconds[-1]))
                step = last * step + (left + right) / arb.pi() / radius ** (self.order + 1)
            return Rest(step.upper(), (step.upper(),) * len(times))


def passive_bound(bound: BoundTransferFunction, integrations: int) -> tuple[PassiveBound, int] | Refused:
    """Return what bounds a passive model's modes between a force or torque and displacements."""
    model = bound.source.model
    if model.fields:
        return Refused("stored energy is known for elements, not for fields")
    energy = energy_proof(model, bound.all_values, bound.source.output)
    if not (bound.is_of_model and energy.is_passive) or energy.has_loop:
        return Refused("something in the model may supply energy")
    model = in_one_way(model)
    here = acting(model, bound.source.input)
    function = SizeOfExponentials.of(bound)
    if not here:
        return Refused("the input is not a force or torque on a node")
    if function is None:
        return Refused("it is not a short sum of exponentials")
    there = measured(assemble(model), bound.source.output.name)
    if there is None:
        model = parted_at(model, bound.source.output.name)
        there = measured(assemble(model), bound.source.output.name)
    if there is None:
        return Refused("the output is not a displacement of a node")
    order = there.factor.exponent_of(there.factor.ring.context.gen(0))
    factor = there.factor / Factored.generator(there.factor.ring, "s") ** order
    if not factor.is_constant or order < 0:
        return Refused("the output is not a derivative of a displacement")
    if integrations - order not in (STEP, RAMP):
        return Refused("energy bounds only step responses of displacements, and smoother ones")
    size, ends = abs(ball(factor.unit)) * _input_gain(model, bound), [here]
    if here != there.coordinates:
        ends.append(there.coordinates)
    if None in (force_on(model, coordinates[0][0]) for coordinates in ends):
        return Refused("an end is a coordinate on which no force or torque does work")
    if len(ends) == 1:
        return PassiveBound(function, order, size, ()), integrations
    of_functions = (SizeOfExponentials.of(c) for c in _colocated(bound, model, ends))
    sizes = tuple(each for each in of_functions if each is not None)
    if len(sizes) < PAIR:
        return Refused(
            "the two ends are not reciprocal: a force at one does not move the other as much as the reverse"
        )
    return PassiveBound(function, order, size, sizes), integrations


def _input_gain(model: Model, bound: BoundTransferFunction) -> arb:
    """Return how large a force a unit input is; not a number where that has no value."""
    source = bound.source.input
    use = driven_source(model, source)
    if use is None:
        return arb(1)
    ((_, value),) = use.values
    unit = substitute(value, {source.name: Number(Fraction(1))})
    gain = value_along(unit, arb("nan"), line_of(model, bound.all_values))
    return arb("nan") if gain is None else abs(gain)


def _colocated(
    bound: BoundTransferFunction, model: Model, ends: list[Coordinates]
) -> list[BoundTransferFunction]:
    """Return what a force moves at both ends where the model is reciprocal, seen from both functions."""
    forces, shown = [], []
    for i, coordinates in enumerate(ends):
        kind = force_on(model, coordinates[0][0]) or ""
        nodes = tuple(NodeReference(v.owner, v.component) for v, _ in coordinates)
        forces.append(Input(f"{INPUT}_{i}", kind, nodes))
        terms = [Attribute(v.owner, v.component) if v.component else Name(v.owner) for v, _ in coordinates]
        moves = terms[0] if len(terms) == 1 else Sum((terms[0], Negative(terms[1])))
        shown.append(Output(f"{OUTPUT}_{i}", moves))
    # What else drives the model stays, at rest: without it a support would be missing.
    given = replace(model, inputs=(*model.inputs, *forces), outputs=tuple(shown), figures=(), published=())
    pairs = [(o.name, i.name) for o in shown for i in forces]
    # A model of which some numbers are written into the wavenumbers has no longer all parameters.
    remaining = {p.name for p in given.parameters}
    values = {name: value for name, value in bound.values if name in remaining}
    derived = [bind(tf, values) for tf in derive_all(given, pairs)]
    return [derived[0], derived[-1]] if (derived[1].ratio / derived[2].ratio).is_one else []


def force_on(model: Model, variable: Variable) -> str | None:
    """Return the kind of input that does work on a coordinate; None for a voltage or a pressure."""
    domain = next(n.domain for n in model.nodes if n.name == variable.owner)
    component_domain = COMPONENT_DOMAIN.get(variable.component, domain)
    kinds = (k for k, kind in INPUT_KINDS.items() if kind.domain == component_domain and not kind.is_imposed)
    return None if component_domain in CIRCUITS else next(kinds, None)

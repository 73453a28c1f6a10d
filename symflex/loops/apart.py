"""Poles of a model that no gain moves: of filters before a loop, of what follows it, and hidden ones.

Input: a loop. Output: where these poles lie, and what they say of stability. A speed loop

    J s^2 phi = K (w - s phi)    has the poles 0 and -K/J, and s phi/w = K/(J s + K) shows -K/J alone

so the shaft's angle, which is arbitrary at equilibrium, does not depend on the gain.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from symflex.algebra import LAPLACE, NO_KERNELS, Factored
from symflex.errors import SymflexError
from symflex.loops.loop import GainPolynomial
from symflex.roots.locate import energy_of, locate, not_searched
from symflex.roots.pole_zero_map import StabilityVerdict, count_right, judge
from symflex.roots.region import Modes
from symflex.roots.root import Root
from symflex.transfer import BoundTransferFunction
from symflex.transfer.transfer_function import HiddenFactor

NONE = StabilityVerdict("stable", 0, certified=True)


@dataclass(frozen=True, slots=True)
class PolesApart:
    """Poles that do not depend on a gain."""

    verdict: StabilityVerdict = NONE
    right: int = 0  # in the right half-plane, hidden ones among them
    axis: int = 0  # on the axis, controllable and observable
    hidden: tuple[Root, ...] = ()  # those that are neither controllable nor observable


def poles_apart(bound: BoundTransferFunction, factors: Sequence[GainPolynomial]) -> PolesApart:
    """Return where the roots of those factors over the ring of ``bound`` lie that no gain moves."""
    ring, moving = bound.ratio.ring, {LAPLACE, *bound.kernels.generators}
    parts = [
        (f, exponent * factor.multiplicity, factor.is_hidden)
        for factor in factors
        for f, exponent in factor.coefficients[0].factors
        if not factor.degree and factor.multiplicity > 0 and ring.used_in([f]) & moving
    ]
    if not parts:
        return PolesApart()
    one = Factored.number(ring, 1)
    den = one
    for f, exponent, is_hidden in parts:
        den = den if is_hidden else den * Factored.polynomial(ring, f) ** exponent
    hidden = tuple(HiddenFactor(f, exponent) for f, exponent, is_hidden in parts if is_hidden)
    is_plain = ring.used_in(f for f, _, _ in parts).isdisjoint(bound.kernels.generators)
    apart = replace(
        bound,
        ratio=1 / den,
        hidden=hidden,
        kernels=NO_KERNELS if is_plain else bound.kernels,
        parts=None if is_plain else (one, den),
        is_of_model=False,
    )
    try:
        located = locate(apart, None if is_plain else Modes(1))
    except SymflexError as error:
        return PolesApart(not_searched(error))
    verdict, on_axis = located.verdict, [r for r in located.poles if r.on_imaginary_axis]
    unseen = [h.root for h in located.hidden]
    every = (*located.all_poles, *unseen)
    # Hidden poles on the axis, which are all that energy leaves, do not change the word.
    is_finite = ring.used_in(f for f, _ in den.factors).isdisjoint(bound.kernels.generators)
    if verdict.word == "unknown" and is_finite and (energy := energy_of(bound)).is_passive:
        verdict = judge(located.poles, "", energy.reason, unseen, (True, False))
    right, axis = count_right(every), sum(r.multiplicity for r in on_axis)
    return PolesApart(verdict, right, axis, tuple(unseen))

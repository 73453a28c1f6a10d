"""Kernels of length zero: with these values they are numbers.

Input: a bound transfer function. Output: the same without such kernels; a rational one when none is left.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from symflex.algebra import NO_KERNELS, Factored, Ring, degree_in
from symflex.errors import Diagnostic, ModelError
from symflex.transfer.transfer_function import HiddenFactor

if TYPE_CHECKING:
    from flint import fmpz_mpoly

    from symflex.algebra.dispersion import Kernel
    from symflex.transfer import BoundTransferFunction

EVEN = ("cosh", "cos", "exp")


def without_lengths_of_zero(bound: BoundTransferFunction) -> BoundTransferFunction:
    """Return the function with the values of kernels whose length is zero in their place.

    SF231 when the denominator vanishes: two nodes are one.

    Examples
    --------
    >>> from symflex import pipeline
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... parameters.T = { value = "0 s", assume = "nonnegative" }
    ... blocks.D = { type = "delay", T = "T" }
    ... inputs.u = {}
    ... outputs.y = "u/(1 + D)"
    ... ''')
    >>> bound = pipeline.derive_bound(model, model.transfer_functions)[0]
    >>> without_lengths_of_zero(bound).is_distributed
    False
    """
    gone = [kernel for kernel in bound.kernels.kernels if kernel.length.is_zero]
    if not gone:
        return bound
    ring = bound.ratio.ring
    images = [ring.context.gen(i) for i in range(len(ring.names))]
    for kernel in gone:
        images[ring.index[kernel.generator]] = ring.constant(_value(kernel))

    def evaluated(factor: fmpz_mpoly) -> Factored:
        return Factored.polynomial(ring, ring.compose(factor, images))

    num, den = (part.map_factors(ring, evaluated) for part in (bound.num, bound.den))
    if den.is_zero:
        message = f"the denominator of {bound.name} is zero for these values"
        raise ModelError(Diagnostic("SF231", message, None, "without its length a part is none"))
    hidden = [
        HiddenFactor(f, e * known.multiplicity)
        for known in bound.hidden
        for f, e in evaluated(known.polynomial).factors
    ]
    kernels = [ring.index[generator] for generator in bound.kernels.generators]
    factors = [f for f, _ in (*num.factors, *den.factors)] + [h.polynomial for h in hidden]
    if any(degree_in(f, i) for f in factors for i in kernels):
        return replace(bound, ratio=num / den, parts=(num, den), hidden=tuple(hidden))
    small = Ring(tuple(name for name in ring.names if name not in bound.kernels.generators))
    places = [ring.index[name] for name in small.names]

    def moved(factor: fmpz_mpoly) -> fmpz_mpoly:
        terms = {tuple(int(m[i]) for i in places): int(c) for m, c in factor.terms()}
        return small.context.from_dict(terms)

    ratio = (num / den).map_factors(small, lambda f: Factored.polynomial(small, moved(f)))
    known = tuple(HiddenFactor(moved(h.polynomial), h.multiplicity) for h in hidden)
    return replace(bound, ratio=ratio, hidden=known, kernels=NO_KERNELS, parts=None)


def _value(kernel: Kernel) -> int:
    if kernel.function == "fundamental":
        return int(kernel.order == kernel.dispersion.order - 1)
    return int(kernel.function in EVEN)

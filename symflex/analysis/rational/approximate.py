"""From a bound transfer function to a rational approximation: what it keeps, and its error."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import takewhile
from typing import TYPE_CHECKING

import numpy as np

from symflex.analysis.rational.approximation import RationalApproximation, scan_error
from symflex.analysis.rational.forms import FORMS
from symflex.analysis.rational.toolboxes import check_form
from symflex.analysis.response import default_band
from symflex.errors import Diagnostic, ModelError, UsageError
from symflex.roots import Band, Everything, Modes, PoleZeroMap, Position, Root
from symflex.roots.functions.simplified import without_lengths_of_zero
from symflex.roots.locate import locate
from symflex.roots.pole_zero_map import is_right

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.transfer import BoundTransferFunction


FURTHER = (1, 4)
"""Modes beyond those kept that are looked for: a double root counts as two and is not divided."""


@dataclass(frozen=True, slots=True)
class KeptRoots:
    """The poles and zeros that are kept."""

    modes: int  # modes among the poles, roots at 0 aside
    # poles and zeros: those kept.
    poles: tuple[Root, ...]
    zeros: tuple[Root, ...]
    found: PoleZeroMap  # what was known, some of those left out among them
    omitted_hz: float | None  # natural frequency of the first pole left out [Hz]
    is_exact: bool  # nothing is left out of a rational function
    # By how much the degree of the numerator exceeds that of the denominator, of a rational function of which
    # nothing is left out; else 0.
    excess: int

    @property
    def highest_hz(self) -> float | None:
        """The highest natural frequency of a pole kept [Hz], of a zero when there is none but 0."""
        for roots in (self.poles, self.zeros):
            frequencies = [root.frequency_hz() for root in roots if not root.is_zero]
            if frequencies:
                return max(frequencies)
        return None


def truncate(bound: BoundTransferFunction, modes: int, digits: int) -> KeptRoots:
    """Return the poles of a number of modes, and the zeros below the first pole left out.

    Poles in the right half plane are kept wherever they lie: without them the approximation would be stable.
    Zeros are left out from above until there are no more than poles, unless nothing is left out of a rational
    function: what grows with s is of no use to a simulation. Modes count as in :class:`symflex.roots.Modes`,
    roots at 0 aside; SF902 for a number below zero.
    """
    if modes < 0:
        raise UsageError(Diagnostic("SF902", f"the number of modes cannot be {modes}"))
    for further in FURTHER:
        region = Modes(modes + further) if bound.is_distributed else Everything()
        found = locate(bound, region, digits)
        poles, left_out = _lowest(found, modes)
        if left_out or not bound.is_distributed:
            break
    omitted = min((root.frequency_hz() for root in left_out), default=None)
    zeros, above = _zeros_below(bound, found, omitted, digits)
    is_exact = not left_out and not bound.is_distributed
    if not is_exact:
        zeros = _no_more_than(zeros, sum(root.multiplicity for root in poles))
    excess = max(_count(zeros) - _count(poles), 0) if is_exact else 0
    known = replace(found, zeros=above)
    return KeptRoots(len(_modes_of(poles)), poles, zeros, known, omitted, is_exact, excess)


def modes_up_to(bound: BoundTransferFunction, high_hz: float, digits: int) -> int:
    """Return how many modes have natural frequencies up to a limit [Hz]."""
    return len(_modes_of(locate(bound, Band(Fraction(0), Fraction(high_hz)), digits).poles))


def _count(roots: Sequence[Root]) -> int:
    return sum(root.multiplicity for root in roots)


def _modes_of(roots: Sequence[Root]) -> list[Root]:
    """Return the roots that count: one of each pair, a multiple one as often as it is one."""
    return [root for root in roots if not root.is_zero and not root.im < 0 for _ in range(root.multiplicity)]


def _lowest(found: PoleZeroMap, modes: int) -> tuple[tuple[Root, ...], tuple[Root, ...]]:
    """Return the poles of the lowest modes with those at 0 and in the right half plane, and the others."""
    positions = Modes(modes).classify(found.poles)
    is_kept = [p is not Position.OUTSIDE or is_right(r) for r, p in zip(found.poles, positions, strict=True)]
    kept = tuple(r for r, keep in zip(found.poles, is_kept, strict=True) if keep)
    left_out = tuple(r for r, keep in zip(found.poles, is_kept, strict=True) if not keep)
    return (*kept, *found.unstable), left_out


def _zeros_below(
    bound: BoundTransferFunction, found: PoleZeroMap, limit_hz: float | None, digits: int
) -> tuple[tuple[Root, ...], tuple[Root, ...]]:
    """Return the zeros with natural frequencies below a limit, and all that are known."""
    known = found.zeros
    if limit_hz is None:
        return known, known
    if bound.is_distributed and all(root.frequency_hz() < limit_hz for root in known):
        # There may be more of them below the limit than were asked for.
        known = locate(bound, Band(Fraction(0), Fraction(limit_hz)), digits).zeros
    return tuple(takewhile(lambda root: root.frequency_hz() < limit_hz, known)), known


def _no_more_than(zeros: Sequence[Root], poles: int) -> tuple[Root, ...]:
    """Leave out zeros from above, mirror images together, until there are no more of them than poles."""
    kept = list(zeros)
    while _count(kept) > poles and not kept[-1].is_zero:
        last = kept[-1].frequency_hz()
        kept = [root for root in kept if root.is_zero or root.frequency_hz() < last * (1 - 1e-12)]
    return tuple(kept)


DEFAULT_MODES = 5
DIGITS = 30
"""Of roots and residues: twice what a double holds."""
SCANNED_DECADES = 3
"""The error is sampled from a thousandth of the lowest natural frequency on."""


def approximate(
    bound: BoundTransferFunction,
    modes: int | None = None,
    form: str = "product",
    band: tuple[float, float] | None = None,
) -> RationalApproximation:
    """Return a rational function close to a transfer function at low frequencies.

    ``modes`` are kept, besides roots at 0: by default those up to the end of ``band``, else as many as the
    model's ``[analysis]`` says, else five; if these are all, the function is exact. ``form`` is ``product``
    or ``modal``, see :data:`symflex.analysis.rational.FORMS`. The error is stated in ``band`` [Hz], by
    default from a thousandth of the lowest natural frequency to the highest one kept.

    SF902 for an unknown form or a negative number of modes, SF227 for a band that is empty or not positive,
    SF402 when the function is identically zero, SF405 when residues, or the behaviour near s = 0, cannot be
    told.

    Examples
    --------
    >>> from symflex import pipeline
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... elements.rod = { type = "rod", between = ["ground", "x"], E = 1, A = 1, rho = 1, l = 1 }
    ... inputs.F = { force = "x" }
    ... outputs.X = "x"
    ... ''')
    >>> (bound,) = pipeline.derive_bound(model, [("X", "F")])  # tanh(s)/s
    >>> R = approximate(bound, modes=2)
    >>> [round(float(pole.imag / np.pi), 12) for pole in R.poles]
    [0.5, -0.5, 1.5, -1.5]
    >>> print(f"{abs(R(0.5) / bound(0.5)) - 1:.4f}")
    0.0024
    """
    check_form(form, tuple(FORMS))
    if band is not None and not 0 < band[0] < band[1] < float("inf"):
        message = f"a band runs from a positive to a higher frequency, not from {band[0]:g} to {band[1]:g} Hz"
        raise UsageError(Diagnostic("SF227", message))
    bound = without_lengths_of_zero(bound)
    if bound.ratio.is_zero:
        message = f"{bound.name} is identically zero"
        raise ModelError(Diagnostic("SF402", message, None, "the input does not reach the output"))
    if modes is None:
        modes = _default_modes(bound, band)
    kept = truncate(bound, modes, DIGITS)
    made = FORMS[form](bound, kept, DIGITS)
    low, high, stated = _bands(kept, band)

    def value(s: complex) -> complex:
        return complex(made.evaluator(np.asarray(s, dtype=complex)))

    roots = (*kept.poles, *(kept.zeros if form == "product" else ()))
    return RationalApproximation(
        bound,
        form,
        kept.modes,
        made.function,
        made.evaluator,
        made.residues,
        made.correction,
        kept.is_exact,
        made.is_estimate or any(not root.certified for root in roots),
        kept.omitted_hz,
        scan_error(bound, value, kept.found, low, high),
        stated,
        kept.found.verdict,
    )


def _default_modes(bound: BoundTransferFunction, band: tuple[float, float] | None) -> int:
    if band is not None:
        return modes_up_to(bound, band[1], DIGITS)
    return bound.source.model.analysis.modes or DEFAULT_MODES


def _bands(kept: KeptRoots, band: tuple[float, float] | None) -> tuple[float, float, tuple[float, float]]:
    """Return where the error is sampled, and the band it is stated for [Hz].

    Samples end at the first pole left out, where an undamped G is infinite and R is not.
    """
    bottom, top = default_band(kept.found)
    low = bottom * 10 / 10**SCANNED_DECADES
    high = kept.omitted_hz or top
    stated = band or (low, kept.highest_hz or high)
    return min(low, stated[0]), max(high, stated[1]), stated

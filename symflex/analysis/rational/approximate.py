"""From a bound transfer function to a rational approximation, with its error along the imaginary axis."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from symflex.analysis.rational.approximation import RationalApproximation
from symflex.analysis.rational.approximation_error import scan_error
from symflex.analysis.rational.forms import FORMS
from symflex.analysis.rational.truncation import modes_up_to, truncate
from symflex.analysis.response import default_band
from symflex.errors import Diagnostic, ModelError, UsageError
from symflex.errors.diagnostic import nearest
from symflex.roots.functions.vanishing import without_lengths_of_zero

if TYPE_CHECKING:
    from symflex.analysis.rational.truncation import KeptRoots
    from symflex.transfer import BoundTransferFunction

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
    if form not in FORMS:
        hint = nearest(form, FORMS) or "forms: " + ", ".join(FORMS)
        raise UsageError(Diagnostic("SF902", f"there is no form '{form[:64]}'", None, hint))
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

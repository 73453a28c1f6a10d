"""Measuring what a program's rounding errors are, against ball arithmetic.

Input: a program and the transfer function it computes.
Output: a :class:`Verification`, a bound that holds at every sample.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import inf, isfinite, pi, tau
from typing import TYPE_CHECKING

import numpy as np
from flint import acb, ctx

from symflex.emit.program.build import available_forms, build_program
from symflex.emit.program.evaluate import evaluate, nearest_double
from symflex.errors import ModelError
from symflex.transfer import bind

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from symflex.emit.program.nodes import Program
    from symflex.transfer import BoundTransferFunction, EnclosedTransferFunction, TransferFunction

DEFAULT_BAND = (Fraction(1, 10), Fraction(10_000))
"""Hz."""

SAMPLES = 400
ASIDE = (0.0, 1e-9, 1e-6, 1e-3, 1e-2)
"""Relative distances from a pole's or zero's frequency at which the error is measured as well."""

REACH = np.logspace(-9, 12, 85)
"""Frequencies [rad/s] at which a form may neither overflow nor lose the value."""

SIMILAR = 2.0
"""Forms whose errors differ by less than this factor count as equally accurate; the faster one is taken."""

FIRST_BITS = 128
LAST_BITS = 4096
ENOUGH_BITS = 64


@dataclass(frozen=True, slots=True)
class Verification:
    """How well a program agrees with its transfer function.

    Parameters
    ----------
    name : str
        ``OUT/IN``.
    form : str
        The form evaluated: ``closed`` or ``factors``.
    error : float or None
        The worst ``|dG| / (|G| (1 + |s G'/G|))`` on the imaginary axis: the relative error beyond what one
        rounding of ``s`` would cause. ``None`` when it was not measured.
    band : tuple of Fraction
        [Hz].
    samples : int
        Number of frequencies.
    reason : str
        Why it was not measured; empty when it was.
    """

    name: str
    form: str
    error: float | None
    band: tuple[Fraction, Fraction]
    samples: int
    reason: str = ""

    def text(self, digits: int = 2) -> str:
        """Return the sentence that stands in the docstring.

        Examples
        --------
        >>> Verification("V/F", "closed", 3.1e-16, DEFAULT_BAND, 400).text()
        'verified: worst relative error 3.1e-16 over 0.1 Hz ... 10 kHz against ball arithmetic'
        """
        if self.error is None:
            return f"not verified: {self.reason}"
        error = "0" if self.error == 0 else f"{self.error:.{digits - 1}e}"
        low, high = (frequency_text(f) for f in self.band)
        return f"verified: worst relative error {error} over {low} ... {high} against ball arithmetic"


def frequency_text(hertz: Fraction) -> str:
    """Return a frequency with a prefix that keeps it short.

    Examples
    --------
    >>> [frequency_text(Fraction(t)) for t in ("0.1", "1000", "2.5e6", "1e-5")]
    ['0.1 Hz', '1 kHz', '2.5 MHz', '1e-05 Hz']
    """
    for prefix, size in (("G", 10**9), ("M", 10**6), ("k", 10**3)):
        if hertz >= size:
            return f"{float(hertz / size):.6g} {prefix}Hz"
    return f"{float(hertz):.6g} Hz"


def choose_program(
    tf: TransferFunction, band_hz: tuple[Fraction, Fraction] | None = None, samples: int = SAMPLES
) -> tuple[Program, Verification]:
    """Return the program of the form with the smallest measured error, and the measurement.

    Without values for all parameters nothing can be measured and the first form is taken.

    Parameters
    ----------
    tf : TransferFunction
        Derived.
    band_hz : tuple of Fraction, optional
        [Hz]; by default the band of the model's ``[analysis]``, else 0.1 Hz to 10 kHz.
    samples : int
        Number of frequencies, spaced evenly on a logarithmic scale; more are taken near poles and zeros.

    Raises
    ------
    BudgetError
        SF503 when the program would be too large.
    """
    band = band_hz or tf.model.analysis.band or DEFAULT_BAND
    forms = available_forms(tf)
    first = forms[0] if forms else ""
    missing = [p.name for p in tf.parameters if p.value is None]
    if missing:
        reason = "no values for " + ", ".join(missing)
        return build_program(tf), Verification(tf.name, first, None, band, 0, reason)
    try:
        bound = bind(tf)
        bound.enclosed(FIRST_BITS)
    except ModelError as error:
        return build_program(tf), Verification(tf.name, first, None, band, 0, error.diagnostics[0].message)
    candidates = []
    for form in forms or (first,):
        program = build_program(tf, form or None)
        measured = verify(program, bound, band, samples)
        keeps = _keeps_its_value(program, bound)
        candidates.append((program, Verification(tf.name, form, measured.error, band, measured.samples), keeps))
    reaching = [c for c in candidates if c[2]] or candidates
    best = min(_error(v) for _, v, _ in reaching)
    similar = [c for c in reaching if _error(c[1]) <= SIMILAR * best]
    program, verification, _ = min(similar, key=lambda c: (c[0].size, _error(c[1])))
    return program, verification


def _error(verification: Verification) -> float:
    return inf if verification.error is None else verification.error


def verify(
    program: Program,
    bound: BoundTransferFunction,
    band_hz: tuple[Fraction, Fraction] = DEFAULT_BAND,
    samples: int = SAMPLES,
) -> Verification:
    """Measure a program's error on the imaginary axis.

    Parameters
    ----------
    program : Program
        Of ``bound.source``.
    bound : BoundTransferFunction
        With the declared values; the program gets the doubles nearest to them.
    band_hz : tuple of Fraction
        [Hz].
    samples : int
        Number of frequencies, besides those around poles and zeros.
    """
    enclosures = _Enclosures(bound)
    frequencies = sample_frequencies(bound, band_hz, samples)
    s = 1j * (tau * frequencies)
    computed = evaluate(program, s, _doubles(bound))
    worst, measured = 0.0, 0
    for point, value in zip(s, computed, strict=True):
        error = enclosures.relative_error(complex(point), complex(value))
        if error is not None:
            worst, measured = max(worst, error), measured + 1
    return Verification(bound.name, "", worst, band_hz, measured)


def sample_frequencies(
    bound: BoundTransferFunction, band_hz: tuple[Fraction, Fraction], samples: int
) -> NDArray[np.float64]:
    """Return frequencies [Hz] over a band, denser around those of poles and zeros."""
    low, high = float(band_hz[0]), float(band_hz[1])
    frequencies = [np.geomspace(low, high, samples)]
    for polynomial, _ in bound.enclosed(FIRST_BITS).factors if not bound.ratio.is_zero else ():
        roots = _roots(polynomial.coeffs())
        for center in (*np.abs(roots.imag), *np.abs(roots)):
            near = center / (2 * pi) * np.array([1 + sign * x for x in ASIDE for sign in (1, -1)])
            frequencies.append(near)
    merged = np.unique(np.concatenate(frequencies))
    return merged[(merged >= low) & (merged <= high)]


def _roots(coefficients: Sequence[acb]) -> NDArray[np.complex128]:
    """Return rough roots of a polynomial with ascending coefficients of any size."""
    sizes = [c.abs_upper() for c in coefficients]
    largest = max(sizes, default=None)
    if largest is None or not largest > 0:
        return np.array([], dtype=complex)
    scaled = [complex(float((c.real / largest).mid()), float((c.imag / largest).mid())) for c in coefficients]
    return np.asarray(np.roots(scaled[::-1]), dtype=complex)


class _Enclosures:
    """A bound transfer function in balls, at as many bits as a sample needs."""

    def __init__(self, bound: BoundTransferFunction) -> None:
        self._bound = bound
        self._known: dict[int, EnclosedTransferFunction] = {}

    def at(self, bits: int) -> EnclosedTransferFunction:
        if bits not in self._known:
            self._known[bits] = self._bound.enclosed(bits)
        return self._known[bits]

    def relative_error(self, s: complex, value: complex) -> float | None:
        """Return a bound of the error of ``value``, or ``None`` at a pole or zero."""
        if self._bound.ratio.is_zero:
            return 0.0 if value == 0 else inf
        point = acb(s.real, s.imag)
        bits = FIRST_BITS
        while bits <= LAST_BITS:
            function = self.at(bits)
            exact, slope = function(point), function.logarithmic_derivative(point)
            if exact.is_finite() and slope.is_finite() and exact.rel_accuracy_bits() >= ENOUGH_BITS:
                if not isfinite(value.real) or not isfinite(value.imag):
                    return inf
                with ctx.workprec(bits):
                    distance = (acb(value.real, value.imag) - exact).abs_upper()
                    scale = exact.abs_lower() * (1 + (point * slope).abs_lower())
                    return float((distance / scale).upper())
            bits *= 2
        return None


def _keeps_its_value(program: Program, bound: BoundTransferFunction) -> bool:
    """True when the program is finite, and not spuriously zero, from 1e-9 to 1e12 rad/s."""
    values = evaluate(program, 1j * REACH, _doubles(bound))
    if bound.ratio.is_zero or (np.isfinite(values) & (values != 0)).all():
        return True
    expected = np.array([bound(complex(s)) for s in 1j * REACH])
    agree = (np.isfinite(values) & (values != 0)) | ~np.isfinite(expected) | (expected == 0)
    return bool(agree.all())


def _doubles(bound: BoundTransferFunction) -> dict[str, float]:
    return {name: nearest_double(value.rational, value.pi_power) for name, value in bound.values}

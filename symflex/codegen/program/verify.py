"""Measuring what a program's rounding errors are, against ball arithmetic, at every sample."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain
from math import inf, isfinite, tau
from typing import Any

import numpy as np
from flint import acb, arb
from numpy.typing import NDArray

from symflex.algebra import degree_in
from symflex.balls import precision, value_at
from symflex.budget import spend
from symflex.codegen.program.band import FIRST_BITS, BandForm, EnclosedValues, band_form
from symflex.codegen.program.build import available_forms, build_nested, build_program
from symflex.codegen.program.distributed import Pieces, series_uses
from symflex.codegen.program.evaluate import evaluate, nearest_double
from symflex.codegen.program.nodes import Piecewise
from symflex.errors import BudgetError, Diagnostic, ModelError
from symflex.model import ExactValue
from symflex.roots.functions.kernel_function import KernelFunction
from symflex.transfer import AnyBoundFunction, AnyTransferFunction, TransferFunction, bind_any
from symflex.transfer.bound import EnclosedTransferFunction, coefficients_in_s
from symflex.transfer.of_model import derive_for_roots, derive_nested

DEFAULT_BAND = (Fraction(1, 10), Fraction(10_000))  # hz
MOST_WAVES = 300.0  # largest exponent of a tapered member up to which the error is measured by default
SAMPLES = 400  # frequencies at which the error is measured, besides those around poles and zeros
ASIDE = (0.0, 1e-9, 1e-6, 1e-3, 1e-2)  # distances from a root, relatively, where the error is measured too
REACH = np.logspace(-9, 12, 85)  # frequencies [rad/s] at which a form may neither overflow nor lose the value
SIMILAR, MUCH_LONGER = 2.0, 2
"""Forms whose errors differ by less than this factor count as equally accurate, and the faster one is taken;
how many times the operations of the shortest form recurrences may take when nothing can be measured."""

LONG = 500  # terms from which coefficients of powers of s are not expanded if another form is accurate
ACCURATE = 1e-14  # error below which no other form is looked for: some fifty roundings of a double
SCAN, MOST_EXTREMES = 3000, 40
"""Frequencies over the band among which a distributed system's resonances and antiresonances are sought, and
how many of each the error is measured around: the first and the last ones of more."""

LIGHT_NESTED, LEAST = 600, 0.05
"""Operations of a nested form from which fewer frequencies are looked at, and the part of them that is looked
at in any case; of a network of beams a value takes 10 ms and more."""

NAMED = 6  # parameters without value that are named
BESIDE_ROOTS = (0.0, 1e-9, 1e-4)  # distances from a root, relatively, at which a band form is measured
BAND_SHARE = 8  # one in so many samples shows how smooth the rest of a band form with known roots is
ASIDE_OF_AXIS, HEIGHTS = 0.1, np.linspace(0.02, 0.98, 5)
"""Distance from the imaginary axis, and heights, in bands, at which a band form is measured too."""
NEAR_AXIS = 1e-3  # damping ratio up to which what a formula loses at a root is measured on the axis
AT_A_POLE = 1e-14  # distance from a pole, relatively, at which infinity may stand for the value
TINY = 1e-307  # what is smaller has no more digits in double precision


@dataclass(frozen=True, slots=True)
class Verification:
    """How well a program agrees with its transfer function."""

    name: str  # ``OUT/IN``
    # The form evaluated: ``closed``, ``closed in s``, ``nested`` or ``factors``; of a distributed system
    # ``pieces`` or ``real``, of a network of many members ``solved``; of roots in and around a band ``band``.
    form: str
    # The worst ``|dG| / (|G| (1 + |s G'/G|))`` on the imaginary axis: the relative error beyond what one
    # rounding of ``s`` would cause. ``None`` when it was not measured.
    error: float | None
    band: tuple[Fraction, Fraction]  # [Hz]
    samples: int  # number of frequencies
    reason: str = ""  # why it was not measured; empty when it was

    def text(self) -> str:
        """Return the sentence that stands in the docstring."""
        if self.error is None:
            return f"not verified: {self.reason}"
        error = _error_text(self.error)
        low, high = (frequency_text(f) for f in self.band)
        if self.error == inf:
            return f"not accurate: some values overflow over {low} ... {high}"
        return f"verified: worst relative error {error} over {low} ... {high} against ball arithmetic"


def _error_text(error: float) -> str:
    return "0" if error == 0 else f"{error:.1e}"


def frequency_text(hertz: Fraction) -> str:
    """Return a frequency with a prefix that keeps it short."""
    for prefix, size in (("G", 10**9), ("M", 10**6), ("k", 10**3)):
        if hertz >= size:
            return f"{float(hertz / size):.6g} {prefix}Hz"
    return f"{float(hertz):.6g} Hz"


def choose_programs(
    tf: AnyTransferFunction, samples: int = SAMPLES, *, has_real: bool = True, most: float = inf
) -> tuple[tuple[Piecewise, Verification], tuple[Piecewise, Verification] | None]:
    """Return the program of the form with the smallest measured error, and the measurement; twice.

    The second one is that of the frequency response where the language ``has_real`` arithmetic for it, else
    the first. Without values recurrences are taken unless another form is much shorter.
    Raises SF503 where a formula with kernels takes more operations than ``most``.
    """
    if tf.is_nameless and not any(law.matrix for law in tf.kernels.dispersions):
        # Exponents have no formula: the members' equations are solved, but where these are followed along x.
        (tf,) = derive_nested(tf.model, [(tf.output.name, tf.input.name)])
    gauge = _gauge(tf, samples, most)
    chosen, programs = _choose(gauge), _real_programs(gauge)
    first = next(programs, None)
    if first is None or not has_real:
        return chosen, None if first is None else chosen
    return chosen, _choose_pieces(chain([first], programs), gauge, "real")


def choose_band(
    tf: AnyTransferFunction, up_to_hz: Fraction | None = None, samples: int = SAMPLES
) -> tuple[Piecewise, Verification, tuple[str, ...]]:
    """Return the program of the band form, how well it agrees with the function, and what is said of it."""
    if missing := [p.name for p in tf.parameters if p.value is None]:
        message = f"{tf.name} in band form consists of numbers, and {', '.join(missing[:NAMED])} has no value"
        raise ModelError(Diagnostic("SF229", message, None, "give values, or export it to numpy"))
    (bound,) = derive_for_roots(tf.model, [(tf.output.name, tf.input.name)])
    values = EnclosedValues(bound)
    form = BandForm.zero(tf.name) if bound.is_zero else band_form(values, up_to_hz)
    program, high = form.program(), form.end_hz
    band = (min((tf.model.analysis.band or DEFAULT_BAND)[0], high / 1000), high)
    centers = [f for f in form.centers_hz if band[0] <= f <= band[1]]
    if len(centers) > 2 * MOST_EXTREMES:
        centers = [*centers[:MOST_EXTREMES], *centers[-MOST_EXTREMES:]]
    count = max(1, int(samples * _part(bound) / BAND_SHARE))
    references = References(values, 1j * tau * _frequencies(band, count, centers, BESIDE_ROOTS))
    error = None if not len(references.s) else references.worst_error(program)
    reason = "" if error is not None else "no value could be enclosed"
    verified = Verification(tf.name, "band", error, band, len(references.s), reason)
    off = [form.end * complex(x, y) for x in (-ASIDE_OF_AXIS, ASIDE_OF_AXIS) for y in HEIGHTS]
    worst = References(values, np.array(off)).worst_error(program)
    return program, verified, (*form.sentences(), form.beside(ASIDE_OF_AXIS, _error_text(worst)))


def measure_values(
    tf: AnyTransferFunction,
    values: Callable[[NDArray[np.complex128]], Sequence[complex]],
    form: str,
    samples: int = SAMPLES,
) -> Verification:
    """Return how well ``values`` of s [rad/s], found in some other ``form``, agree with a function."""
    gauge = _gauge(tf, samples)
    if gauge.references is None:
        return gauge.verified(form, None)
    return gauge.verified(form, gauge.references.worst_of(values(gauge.references.s)))


@dataclass(frozen=True, slots=True)
class _Gauge:
    """What the programs of one transfer function are measured against."""

    tf: AnyTransferFunction
    band: tuple[Fraction, Fraction]
    pieces: Pieces | None  # of a distributed system
    references: References | None  # without them nothing can be measured
    reason: str = ""  # why

    def verified(self, form: str, error: float | None) -> Verification:
        samples = 0 if self.references is None else len(self.references.s)
        if error is not None and not samples and not self.tf.is_zero:
            return Verification(self.tf.name, form, None, self.band, 0, "no value could be enclosed")
        return Verification(self.tf.name, form, error, self.band, samples, self.reason)


def _gauge(tf: AnyTransferFunction, samples: int, most: float = inf) -> _Gauge:
    band = tf.model.analysis.band or DEFAULT_BAND
    missing = [p.name for p in tf.parameters if p.value is None]
    pieces = None
    if tf.is_reduced and not (tf.is_rational or tf.is_zero):
        values = {p.name: double_of(p.value) for p in tf.parameters if p.value}
        pieces = Pieces(tf, None if missing else values)
        if most < inf and (length := pieces.of_s(series_uses(tf)[0]).length) > most:
            message = f"code of its formula would have {length} operations"
            hint = "a band form stands for it over a band of frequencies"
            raise BudgetError(Diagnostic("SF503", message, None, hint))
    if missing:
        if not tf.is_reduced and len(missing) > NAMED:
            missing[NAMED:] = [f"and {len(missing) - NAMED} more"]
        return _Gauge(tf, band, pieces, None, "no values for " + ", ".join(missing))
    try:
        bound = bind_any(tf)
        is_tapered = any(law.matrix for law in bound.kernels.dispersions)
        if bound.is_reduced and is_tapered and tf.model.analysis.band is None:
            # Members that taper are to be no more than so many waves long.
            end = Fraction(KernelFunction(bound, bound.den).frequency_of(MOST_WAVES) / tau)
            band = (band[0], max(min(band[1], end), 10 * band[0]))
        return _Gauge(tf, band, pieces, References.over(bound, band, samples, pieces=pieces))
    except ModelError as problem:
        return _Gauge(tf, band, pieces, None, problem.diagnostics[0].message)


def _choose(gauge: _Gauge) -> tuple[Piecewise, Verification]:
    tf, references = gauge.tf, gauge.references
    if not tf.is_reduced:
        nested = build_nested(tf)
        form = "nested" if nested.network is None else "solved"
        worst = None if references is None else references.worst_error(nested)
        return nested, gauge.verified(form, worst)
    if gauge.pieces is not None:
        uses = series_uses(tf, is_measured=references is not None)
        return _choose_pieces(map(gauge.pieces.of_s, uses), gauge, "pieces")
    forms = available_forms(tf)
    if references is None:
        # Expanded coefficients of a model without numbers would be pages long.
        compact = [form for form in forms if form != "factors"] or forms
        programs = [(form, program) for form in compact if (program := _program(tf, form)) is not None]
        if not programs:
            return build_program(tf), gauge.verified("", None)
        shortest = min(program.size for _, program in programs)
        form, program = next((f, p) for f, p in programs if p.size <= MUCH_LONGER * shortest)
        return program, gauge.verified(form, None)
    is_long = tf.length > LONG
    candidates: list[tuple[Piecewise, str, float]] = []
    for form in forms:
        is_spare = form == "closed in s" or (form == "factors" and is_long)
        if is_spare and any(error < ACCURATE for _, _, error in candidates):
            continue
        if (program := _program(tf, form)) is not None:
            candidates.append((program, form, references.worst_error(program)))
    if not candidates:
        program = build_program(tf)
        candidates.append((program, "", references.worst_error(program)))
    reaching = [c for c in candidates if keeps_its_value(c[0], references.bound)] or candidates
    best = min(error for _, _, error in reaching)
    similar = [c for c in reaching if c[2] <= SIMILAR * best]
    program, form, error = min(similar, key=lambda c: (c[0].size, c[2]))
    return program, gauge.verified(form, error)


def _real_programs(gauge: _Gauge) -> Iterator[Piecewise]:
    """Yield the programs of the frequency response in real arithmetic, none where it is complex."""
    pieces, references = gauge.pieces, gauge.references
    if pieces is None or (references is not None and references.are_complex):
        return
    usual, *others = series_uses(pieces.tf, is_measured=references is not None)
    if (first := pieces.of_frequency(usual)) is not None:
        yield first
        yield from filter(None, map(pieces.of_frequency, others))


def _choose_pieces(programs: Iterator[Piecewise], gauge: _Gauge, form: str) -> tuple[Piecewise, Verification]:
    """Return the program whose series reach as far as serves accuracy best, and its measured error."""
    references, first = gauge.references, next(programs)
    if references is None:
        return first, gauge.verified(form, None)
    if first.minors:
        # There are no others, and none is accurate at all frequencies.
        return first, gauge.verified(form, references.worst_error(first))
    candidates: list[tuple[bool, float, Piecewise]] = []
    for program in chain([first], programs):
        error, keeps = references.worst_error(program), keeps_its_value(program, references.bound)
        candidates.append((not keeps, error, program))
        if keeps and error < ACCURATE:
            break
    _, error, program = min(candidates, key=lambda c: c[:2])
    return program, gauge.verified(form, error)


def _program(tf: TransferFunction, form: str) -> Piecewise | None:
    """Return the program of a form, ``None`` when it is too large."""
    try:
        return build_program(tf, form)
    except BudgetError:
        spend()
        return None


def sample_frequencies(
    bound: AnyBoundFunction, band_hz: tuple[Fraction, Fraction], samples: int, pieces: Pieces | None = None
) -> NDArray[np.float64]:
    """Return frequencies [Hz] over a band, denser around those of poles and zeros."""
    aside = ASIDE[::2] if bound.source.solves_network else ASIDE
    if bound.is_zero:
        return _frequencies(band_hz, samples, [], aside)
    enclosed = bound.enclosed(FIRST_BITS)
    if not isinstance(enclosed, EnclosedTransferFunction):
        low, high = float(band_hz[0]), float(band_hz[1])
        centers = [*_extremes(bound, low, high, pieces), *_meetings(bound)]
        return _frequencies(band_hz, samples, centers, aside)
    roots = np.concatenate([[], *(_roots(polynomial.coeffs()) for polynomial, _ in enclosed.factors)])
    return _frequencies(band_hz, samples, [*(np.abs(roots.imag) / tau), *(np.abs(roots) / tau)], aside)


def _frequencies(
    band_hz: tuple[Fraction, Fraction], samples: int, centers: Sequence[float], aside: Sequence[float]
) -> NDArray[np.float64]:
    """Return so many frequencies [Hz] over a band, and those at relative distances from some of them."""
    low, high = float(band_hz[0]), float(band_hz[1])
    around = np.array([1 + sign * x for x in aside for sign in (1, -1)])
    frequencies = [np.geomspace(low, high, samples), *(center * around for center in centers)]
    merged = np.unique(np.concatenate(frequencies))
    return merged[(merged >= low) & (merged <= high)]


def _extremes(bound: AnyBoundFunction, low: float, high: float, pieces: Pieces | None) -> list[float]:
    """Return resonances and antiresonances [Hz]: where the magnitude on the axis is largest and smallest."""
    source = bound.source
    if source.is_reduced:
        program = (pieces or Pieces(source)).of_s(series_uses(source)[0])
    else:
        program = build_nested(source)
    part = _part(bound)
    most = 2 * max(1, int(MOST_EXTREMES * part) // 2)
    values = doubles(bound)

    def size(hertz: NDArray[np.float64]) -> NDArray[np.float64]:
        with np.errstate(all="ignore"):
            return np.nan_to_num(np.log(np.abs(evaluate(program, tau * 1j * hertz, values))))

    grid = np.geomspace(low, high, int(SCAN * part))
    extremes: list[float] = []
    level = size(grid)
    for sign in (1, -1):
        inner = sign * level[1:-1]
        peaks = np.flatnonzero((inner > sign * level[:-2]) & (inner >= sign * level[2:])) + 1
        if len(peaks) > most:
            peaks = np.concatenate([peaks[: most // 2], peaks[-most // 2 :]])
        left, right = grid[peaks - 1], grid[peaks + 1]
        each = np.arange(len(peaks))
        for _ in range(8 if len(peaks) else 0):
            near = np.linspace(left, right, 21)
            best = np.argmax(sign * size(near), axis=0)
            left, right = near[np.maximum(best - 1, 0), each], near[np.minimum(best + 1, 20), each]
        extremes += ((left + right) / 2).tolist()
    return extremes


def _meetings(bound: AnyBoundFunction) -> list[float]:
    """Return frequencies [Hz] on the axis where the denominator has a zero without kernels.

    Where wavenumbers of different laws meet, the formula is 0/0 there, though the function is not singular.
    """
    if not bound.is_reduced or bound.source.model.root is not None:
        return []
    kernels = bound.kernels
    named = (*kernels.wavenumbers, *(k.generator for k in kernels.kernels))
    positions = [bound.ratio.ring.index[name] for name in named]
    frequencies: list[float] = []
    with precision(FIRST_BITS):
        values = [evaluate() for _, evaluate in bound.constants]
        for factor, exponent in bound.ratio.factors:
            if exponent > 0 or any(degree_in(factor, i) for i in positions):
                continue
            terms = coefficients_in_s(factor, bound.constant_ring)
            roots = _roots([acb(value_at(c, values.__getitem__, arb)) for c in terms])
            near = np.abs(roots.real) < NEAR_AXIS * np.abs(roots.imag)
            frequencies += (np.abs(roots.imag[near]) / tau).tolist()
    return frequencies


def _part(bound: AnyBoundFunction) -> float:
    """Return which part of the usual number of frequencies is looked at."""
    source = bound.source
    if source.solves_network:
        return LEAST
    return 1.0 if source.is_reduced else max(LEAST, min(1.0, LIGHT_NESTED / max(source.size, 1)))


def _roots(coefficients: Sequence[acb], *, is_scaled: bool = False) -> NDArray[np.complex128]:
    """Return rough roots of a polynomial with ascending coefficients of any size."""
    sizes = [c.abs_upper() for c in coefficients]
    largest = max(sizes, default=None)
    if largest is None or not largest > 0:
        return np.array([], dtype=complex)
    scaled = [complex(float((c.real / largest).mid()), float((c.imag / largest).mid())) for c in coefficients]
    with np.errstate(all="ignore"):
        is_within = np.isfinite(np.divide(scaled, scaled[-1])).all()
    if is_within:
        return np.asarray(np.roots(scaled[::-1]), dtype=complex)
    if is_scaled or not sizes[-1] > 0:
        return np.array([], dtype=complex)
    # Quotients of coefficients are beyond doubles: roots are counted in their geometric mean.
    first = next(i for i, size in enumerate(sizes) if size > 0)
    mean = ((sizes[first].log() - sizes[-1].log()) / max(len(sizes) - 1 - first, 1)).exp()
    return float(mean.mid()) * _roots([c * mean**i for i, c in enumerate(coefficients)], is_scaled=True)


class References:
    """Enclosures of a transfer function, bound to the declared values, at points."""

    def __init__(self, values: EnclosedValues, points: NDArray[Any]) -> None:
        self.bound = values.bound
        self._references: list[_Reference] = []
        kept = []
        for s in map(complex, points):
            if self.bound.is_zero:
                reference = _Reference(acb(0), FIRST_BITS, acb(1).abs_lower())
            elif (enclosed := values.at(s)) is None:
                continue  # a pole or zero
            else:
                with precision(enclosed.bits):
                    size = enclosed.value.abs_lower() * (1 + (acb(s) * enclosed.slope).abs_lower())
                reference = _Reference(enclosed.value, enclosed.bits, size)
            self._references.append(reference)
            kept.append(s)
        self.s = np.array(kept, dtype=complex)

    @classmethod
    def over(
        cls,
        bound: AnyBoundFunction,
        band_hz: tuple[Fraction, Fraction],
        samples: int = SAMPLES,
        *,
        pieces: Pieces | None = None,
    ) -> References:
        """Return those at so many frequencies over a band [Hz], besides those around poles and zeros."""
        if bound.is_reduced:
            bound.expect(0, tau * float(band_hz[1]))
        hertz = sample_frequencies(bound, band_hz, max(1, int(samples * _part(bound))), pieces)
        return cls(EnclosedValues(bound), 1j * (tau * hertz))

    @property
    def are_complex(self) -> bool:
        """True when some value is proved to be neither real nor imaginary."""
        return any(not (r.value.real.contains(0) or r.value.imag.contains(0)) for r in self._references)

    def worst_error(self, program: Piecewise) -> float:
        """Return a bound of the error at all frequencies, for a program that gets the nearest doubles."""
        return self.worst_of(evaluate(program, _arguments(program, self.s), doubles(self.bound)))

    def worst_of(self, values: Iterable[complex]) -> float:
        """Return a bound of the error of values at all frequencies."""
        pairs = zip(self._references, values, strict=True)
        return max((r.error_of(complex(v)) for r, v in pairs), default=0.0)


@dataclass(frozen=True, slots=True)
class _Reference:
    """A value in a ball, and the size that its errors are measured by."""

    value: acb
    bits: int
    size: arb

    def error_of(self, computed: complex) -> float:
        with precision(self.bits):
            if not isfinite(computed.real) or not isfinite(computed.imag):
                # The reciprocal's error, where the nearest double to a pole's frequency makes it zero.
                vanishing = self.value.abs_upper() / self.size
                return float(vanishing.upper()) if vanishing < AT_A_POLE else inf
            distance = (acb(computed.real, computed.imag) - self.value).abs_upper()
            if distance < TINY:
                return 0.0
            return float((distance / self.size).upper())


def _arguments(program: Piecewise, s: NDArray[Any]) -> NDArray[Any]:
    """Return what a program takes for values of s on the imaginary axis."""
    return s.imag if program.is_real else s


def keeps_its_value(program: Piecewise, bound: AnyBoundFunction) -> bool:
    """Tell whether a program is finite, and not spuriously zero, from 1e-9 to 1e12 rad/s."""
    values = evaluate(program, _arguments(program, 1j * REACH), doubles(bound))
    keeps = np.isfinite(values) & (values != 0)
    if bound.is_zero or keeps.all():
        return True
    expected = np.array([bound(complex(s)) for s in 1j * REACH[~keeps]])
    return bool((~np.isfinite(expected) | (np.abs(expected) < TINY)).all())


def doubles(bound: AnyBoundFunction) -> dict[str, Any]:
    """Return the double nearest to every parameter's value."""
    # A function does not depend on a parameter without value, though the network it is solved from may.
    others = {p.name: 1.0 for p in bound.source.model.parameters}
    declared = {p.name: p.value for p in bound.source.model.parameters if p.value is not None}
    given = declared | dict(bound.values)
    return others | {name: double_of(x) for name, x in given.items()}


def double_of(value: ExactValue) -> Any:  # noqa: ANN401 (complex for one name alone)
    """Return the double nearest to an exact value, or the imaginary unit."""
    return 1j if value.is_imaginary else nearest_double(value.rational, value.pi_power)

"""A rational function in place of a transfer function, and how far they are apart.

The error at omega is ``|R - G|/|G|``, with the dips of G filled: beside a zero of G on the imaginary axis any
function has an infinite relative error whose own zero is not exactly the same. So within a tenth of a zero's
distance from the origin, the factor ``|j omega - z|`` of ``|G|`` counts as ``|z|/10``; an antiresonance that
is off by 0.1 % makes an error of 1 %. At a pole that R and G share both are infinite; the error beside it
compares residues and stays finite, and is taken for the error at the pole.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from math import inf, isfinite, nan, pi
from typing import TYPE_CHECKING

import mpmath
import numpy as np

from symflex.analysis.rational.toolboxes import PERCENTS, RationalFunction, end_units
from symflex.analysis.response import AXIS_GAP, adaptive_grid
from symflex.balls import to_complex_mpmath
from symflex.errors import Diagnostic, ModelError
from symflex.errors.optional import installed
from symflex.print.html import DIGITS
from symflex.print.notebook import Printed
from symflex.print.text import WIDTH, Passage
from symflex.roots import PoleZeroMap, Root
from symflex.roots.pole_zero_map import NOT_EXAMINED, StabilityVerdict
from symflex.state_space import Channel
from symflex.state_space.cascade import cascade
from symflex.state_space.numeric import BoundState, BoundStateSpace
from symflex.transfer import AnyBoundFunction, AnyTransferFunction, points_of

if TYPE_CHECKING:
    import numpy.typing as npt
    import sympy

    from symflex.analysis.rational.laurent import PrincipalPart


DIP = 0.1  # distance from a zero, relative to its distance from 0, within which its dip is filled
POINTS = 400
BISECTIONS = 60  # more than a double has bits


@dataclass(frozen=True, slots=True)
class BandError:
    """The largest error met in a band.

    Parameters
    ----------
    low_hz, high_hz : float
        The band [Hz].
    worst : float
        The largest relative error among the samples.
    worst_at_hz : float
        Where it was met [Hz].
    samples : int
        How many frequencies were sampled.
    is_rigorous : bool
        Whether ``worst`` bounds the error between the samples too.
    filled_hz : tuple of float
        Antiresonances [Hz] beside which the error would be larger if their dips were not filled.
    """

    low_hz: float
    high_hz: float
    worst: float
    worst_at_hz: float
    samples: int
    is_rigorous: bool = False
    filled_hz: tuple[float, ...] = ()


@dataclass(frozen=True, eq=False)
class ErrorScan:
    """Errors at frequencies.

    Notes
    -----
    The arrays are read-only.
    """

    frequency_hz: npt.NDArray[np.float64]  # frequency_hz, error: increasing frequencies, errors there
    error: npt.NDArray[np.float64]
    errors_at: Callable[[float], tuple[float, float, float]]  # error, plain and dip_hz at a frequency [Hz]
    plain: npt.NDArray[np.float64]  # ``|R - G|/|G|``, dips not filled
    dip_hz: npt.NDArray[np.float64]  # frequency of the zero in whose dip a sample is; nan outside of all

    def __post_init__(self) -> None:
        for array in (self.frequency_hz, self.error, self.plain, self.dip_hz):
            array.setflags(write=False)

    def at(self, frequency_hz: float) -> float:
        """Return the error at a frequency [Hz]."""
        return self.errors_at(frequency_hz)[0]

    @property
    def is_rigorous(self) -> bool:
        """False: between the samples nothing is proved."""
        return False

    @property
    def low_hz(self) -> float:
        """The lowest frequency sampled [Hz]."""
        return float(self.frequency_hz[0])

    @property
    def high_hz(self) -> float:
        """The highest frequency sampled [Hz]."""
        return float(self.frequency_hz[-1])

    def within(self, low_hz: float, high_hz: float) -> BandError:
        """Return the largest error met in a band inside the frequencies sampled."""
        inside = (self.frequency_hz >= low_hz) & (self.frequency_hz <= high_hz)
        frequencies = np.concatenate(([low_hz], self.frequency_hz[inside], [high_hz]))
        errors = np.concatenate(([self.at(low_hz)], self.error[inside], [self.at(high_hz)]))
        i = int(np.argmax(errors))
        filled = self._dips(inside & (self.plain > errors[i]))
        found = float(errors[i]), float(frequencies[i]), len(errors)
        return BandError(low_hz, high_hz, *found, filled_hz=filled)

    def outside(self, tolerance: float) -> tuple[float, ...]:
        """Return the antiresonances [Hz] below :meth:`valid_to` beside which ``|R - G|/|G|`` is larger.

        All these frequencies are within a tenth of the antiresonance.
        """
        return self._dips((self.plain > tolerance) & (self.frequency_hz <= self.valid_to(tolerance)))

    def _dips(self, samples: npt.NDArray[np.bool_]) -> tuple[float, ...]:
        return tuple(np.unique(self.dip_hz[samples & ~np.isnan(self.dip_hz)]).tolist())

    def valid_to(self, tolerance: float) -> float:
        """Return the frequency [Hz] up to which no sample exceeds the tolerance.

        It lies between the last good and the first bad sample, found by bisection; 0 when the first is bad,
        :attr:`high_hz` when none is.
        """
        bad = np.flatnonzero(~(self.error <= tolerance))
        if not bad.size:
            return self.high_hz
        if bad[0] == 0:
            return 0.0
        good, wrong = (float(self.frequency_hz[bad[0] - k]) for k in (1, 0))
        for _ in range(BISECTIONS):
            middle = (good + wrong) / 2
            if not good < middle < wrong:
                break
            good, wrong = (middle, wrong) if self.at(middle) <= tolerance else (good, middle)
        return good


def scan_error(
    bound: AnyBoundFunction,
    approximation: Callable[[complex], complex],
    roots: PoleZeroMap,
    low_hz: float,
    high_hz: float,
) -> ErrorScan:
    r"""Sample the error of an approximation in a band [Hz], densely about the poles and zeros there.

    >>> from symflex import pipeline
    >>> model = pipeline.loads('symflex = 1\ninputs.u = {}\noutputs.y = "u/(s + 1)"')
    >>> bound = pipeline.derive_bound(model, [("y", "u")])[0]
    >>> scan = scan_error(bound, lambda s: 1 + 0j, pipeline.roots(bound), 0.001, 1.0)
    >>> round(2 * np.pi * scan.valid_to(0.01), 6)  # |1 - 1/(1 + j omega)| (1 + omega^2)^(1/2) = omega
    0.01
    """
    zeros = np.array([complex(root.enclosure().mid()) for root in roots.zeros if not root.is_zero])
    on_axis = np.array(
        [float(root.im.mid()) for root in roots.poles if root.on_imaginary_axis and root.im > 0]
    )
    errors_at = partial(_errors_at, bound, approximation, zeros, on_axis)
    frequencies = adaptive_grid(bound, low_hz, high_hz, POINTS, roots) / (2 * np.pi)
    found = np.array([errors_at(f) for f in frequencies.tolist()])
    return ErrorScan(frequencies, found[:, 0], errors_at, found[:, 1], found[:, 2])


def _errors_at(
    bound: AnyBoundFunction,
    approximation: Callable[[complex], complex],
    zeros: npt.NDArray[np.complex128],
    on_axis: npt.NDArray[np.float64],
    frequency_hz: float,
) -> tuple[float, float, float]:
    """Return the error with dips filled, that without, and the frequency of the dip [Hz], else nan."""
    omega = 2 * np.pi * frequency_hz
    gaps = np.abs(1j * omega - zeros) / np.abs(zeros)
    nearest = zeros[int(np.argmin(gaps))] if gaps.size and gaps.min() < DIP else None
    dip = nan if nearest is None else float(abs(nearest)) / (2 * np.pi)
    edges = on_axis if nearest is None or nearest.real != 0 else np.append(on_axis, abs(nearest))
    near = edges[np.abs(edges - omega) < AXIS_GAP * edges]
    s = 1j * (near[0] * (1 - AXIS_GAP) if near.size else omega)
    exact = bound(s)
    difference = abs(approximation(s) - exact)
    if difference == 0:
        return 0.0, 0.0, dip
    gaps = np.maximum(np.abs(s - zeros), np.finfo(float).tiny) / np.abs(zeros)
    filled = abs(exact) * float(np.prod(np.maximum(1.0, DIP / gaps)))
    error, plain = (difference / size if size else inf for size in (filled, abs(exact)))
    return error, plain, dip


@dataclass(frozen=True, eq=False)
class RationalEvaluator:
    """Values of a rational function in double precision, neither overflowing nor cancelling."""

    order: int  # of the zero at s = 0; negative of a pole
    leading: complex  # what the function over ``s^order`` is at s = 0
    poles: npt.NDArray[np.complex128]  # poles and zeros: those other than 0
    zeros: npt.NDArray[np.complex128]
    terms: tuple[tuple[complex, int, complex], ...] | None = None  # pole, power, coefficient: summed
    polynomial: tuple[float, ...] = ()  # added to the partial fractions, in ascending powers of s

    def at(self, s: complex) -> complex:
        """Return the value at one complex frequency."""
        return complex(self(np.asarray(s, dtype=complex)))

    def __call__(self, s: npt.NDArray[np.complex128]) -> npt.NDArray[np.complex128]:
        """Return the values at an array of complex frequencies [rad/s]."""
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            if self.terms is not None:
                total = np.zeros(s.shape, dtype=np.complex128)
                for i, constant in enumerate(self.polynomial):
                    total = total + constant * s**i
                for pole, power, coefficient in self.terms:
                    total = total + coefficient / (s - pole) ** power
                return total
            total = self.leading * s.astype(complex) ** self.order
            for i in range(max(len(self.poles), len(self.zeros))):
                if i < len(self.zeros):
                    total = total * (1 - s / self.zeros[i])
                if i < len(self.poles):
                    total = total / (1 - s / self.poles[i])
            return total


@dataclass(frozen=True, eq=False)
class Approximant:
    """A rational function R with real coefficients, as a form makes it."""

    poles: tuple[mpmath.mpc, ...]  # poles and zeros [rad/s], repeated; modal zeros are near those of G
    zeros: tuple[mpmath.mpc, ...]
    gain: mpmath.mpf  # what ``(s - z).../(s - p)...`` is multiplied with
    num: tuple[mpmath.mpf, ...]  # num, den: coefficients in descending powers, ``den`` from 1 on
    den: tuple[mpmath.mpf, ...]
    evaluator: RationalEvaluator  # R in double precision
    residues: tuple[PrincipalPart, ...] = ()  # of the modal form, its principal parts
    correction: tuple[mpmath.mpf, ...] = ()  # in ascending powers: the modes left out, and growth
    is_estimate: bool = False  # some pole, zero or residue is not proved


@dataclass(frozen=True, eq=False, kw_only=True)
class RationalApproximation(Printed, Approximant, RationalFunction):
    """A rational function R(s) in place of a transfer function G(s), for a band of frequencies.

    Parameters
    ----------
    bound : AnyBoundFunction
        G.
    form : str
        ``product``: the poles and zeros of G, and its leading term at s = 0; ``modal``: the principal parts
        of G at its poles and a constant that makes the finite part at s = 0 exact.
    modes : int
        How many modes, roots at 0 aside.
    is_exact : bool
        R is G: a lumped system with all its modes.
    omitted_hz : float or None
        Natural frequency of the first pole left out [Hz]; ``None`` when no pole is.
    scan : ErrorScan
        Where the error was sampled.
    band : tuple of float
        The band of :attr:`error` [Hz].
    stability : StabilityVerdict
        That of G and its hidden modes; R has all known poles of G in the right half-plane.
    """

    bound: AnyBoundFunction
    form: str
    modes: int
    is_exact: bool
    omitted_hz: float | None
    scan: ErrorScan
    band: tuple[float, float]
    stability: StabilityVerdict = NOT_EXAMINED

    def __repr__(self) -> str:
        modes = "1 mode" if self.modes == 1 else f"{self.modes} modes"
        but = " outside antiresonances" if self.outside(0.01) else ""
        limit = "exact" if self.is_exact else f"within 1 % up to {self.valid_to(0.01):.4g} Hz{but}"
        return f"<RationalApproximation {self.tf}: {self.form} form, {modes}, {limit}>"

    def passages(self) -> Iterator[Passage]:
        """Return poles and zeros, or residues, and how good the approximation is."""
        head, *said = _said(self)
        yield Passage([head])
        yield Passage([INDENT + line for line in said])
        if self.residues:
            yield Passage([_counted("poles and residues", self.poles)], _residue_rows(self))
        else:
            yield Passage([_counted("poles", self.poles)], _root_rows(self.poles))
        yield Passage([_counted("zeros", self.zeros)], _root_rows(self.zeros))
        if self.is_estimate:
            yield Passage([f"{INDENT}{ESTIMATE}"])

    @property
    def source(self) -> AnyTransferFunction:
        """What it approximates."""
        return self.bound.source

    @property
    def tf(self) -> str:
        """``OUT/IN``."""
        return self.bound.name

    @property
    def order_at_zero(self) -> int:
        """The order of the zero of G at s = 0; negative for a pole."""
        return self.evaluator.order

    @property
    def leading_coefficient(self) -> float:
        """The limit of ``G(s)/s^order_at_zero`` at s = 0: the static gain when the order is zero."""
        return self.evaluator.leading.real

    @property
    def error(self) -> BandError:
        """The largest relative error met in :attr:`band`; sampled, not proved."""
        return self.scan.within(*self.band)

    def valid_to(self, tolerance: float) -> float:
        """Return the frequency [Hz] up to which the relative error stays within a tolerance.

        Parameters
        ----------
        tolerance : float
            Such as 0.01.

        Returns
        -------
        float
            Found on samples from ``scan.low_hz`` upwards and by bisection, not proved. 0 when the lowest
            sample exceeds the tolerance, ``scan.high_hz`` when none does, infinity when R is G.
        """
        return inf if self.is_exact else self.scan.valid_to(tolerance)

    def outside(self, tolerance: float) -> tuple[float, ...]:
        """Return the antiresonances [Hz] up to :meth:`valid_to` beside which ``|R - G|/|G|`` is larger.

        Within a tenth of the frequency of each, the error counts as if the dip of G were filled.
        """
        return () if self.is_exact else self.scan.outside(tolerance)

    def __call__(self, s: npt.ArrayLike) -> complex | npt.NDArray[np.complex128]:
        """Return R at s [rad/s], a number or an array, in double precision."""
        points = points_of(s)
        values = self.evaluator(points)
        return complex(values) if points.ndim == 0 else values

    def coefficients(self) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """Return numerator and denominator in double precision, in descending powers of s.

        Raises
        ------
        ModelError
            SF233 when a coefficient is too large or too small for double precision.
        """
        return _doubles(self.num, self.tf), _doubles(self.den, self.tf)

    def label(self) -> str:
        """Return a name with the form and the frequency up to which it is within 1 %.

        Only letters, digits and underscores, as control software requires.
        """
        name = self.tf.replace("/", "_over_")
        if self.is_exact:
            return f"{name}_exact"
        valid = f"{self.valid_to(PERCENTS[0] / 100):.3g}".replace(".", "p").replace("+", "").replace("-", "m")
        return f"{name}_{self.form}_{self.modes}_modes_{PERCENTS[0]}_percent_to_{valid}_Hz"

    def state_space(self) -> BoundStateSpace:
        """Return state equations: sections of second order in series, each with the poles of one pair.

        Raises
        ------
        ModelError
            SF236 when there are more zeros than poles, SF233 when a number does not fit in double precision.
        """
        arrays = cascade(self.zeros, self.poles, self.gain, self.tf)
        states = tuple(BoundState(f"z_{i + 1}", (), "") for i in range(len(arrays.a)))
        units = end_units(self.source)
        inputs = (Channel(self.source.input.name, str(units["input_unit"])),)
        outputs = (Channel(self.source.output.name, str(units["output_unit"])),)
        return BoundStateSpace(self.label(), arrays, states, inputs, outputs, is_minimal=True)

    def facts(self) -> dict[str, object]:
        """Return form, modes, the frequencies up to which it is within 1 % and 5 %, and where it is not."""
        return {
            "exact": self.is_exact,
            "form": self.form,
            "modes": self.modes,
            "valid_to_hz": {f"{percent} %": self.valid_to(percent / 100) for percent in PERCENTS},
            "outside_hz": {f"{percent} %": list(self.outside(percent / 100)) for percent in PERCENTS},
            "valid_to_is_proved": self.is_exact,
        }

    def zeros_poles_gain(self) -> tuple[list[complex], list[complex], float]:
        """Return the nearest doubles to zeros, poles and gain."""
        zeros, poles = ([complex(x) for x in roots] for roots in (self.zeros, self.poles))
        return zeros, poles, float(_doubles((self.gain,), self.tf)[0])

    def value_and_slope(self, s: complex) -> tuple[complex, complex]:
        """Return value and ``R'/R`` at s [rad/s]."""
        with np.errstate(all="ignore"):
            zeros, poles = (np.array([complex(x) for x in roots]) for roots in (self.zeros, self.poles))
            slope = complex(np.sum(1 / (s - zeros)) - np.sum(1 / (s - poles)))
        return complex(self(s)), slope

    def to_sympy(self, digits: int = 15) -> sympy.Basic:
        """Return a ``sympy.physics.control.TransferFunction`` of the symbol ``s``.

        Parameters
        ----------
        digits : int
            Significant digits of the coefficients.

        Raises
        ------
        UsageError
            SF902 when SymPy is not installed.
        """
        installed("sympy")
        import sympy
        from sympy.physics.control import TransferFunction

        s = sympy.Symbol("s")

        def polynomial(coefficients: tuple[mpmath.mpf, ...]) -> sympy.Expr:
            last = len(coefficients) - 1
            return sympy.Add(
                *(sympy.Float(c, digits) * s ** (last - i) for i, c in enumerate(coefficients) if c)
            )

        return TransferFunction(polynomial(self.num), polynomial(self.den), s)


def _doubles(numbers: Sequence[mpmath.mpf], name: str) -> npt.NDArray[np.float64]:
    """Return the nearest doubles, or raise SF233 when a number is too large or too small for one."""
    values = np.array([float(number) for number in numbers])
    if not np.isfinite(values).all() or any(n != 0 and v == 0 for n, v in zip(numbers, values, strict=True)):
        message = f"a coefficient of the approximation of {name} does not fit into double precision"
        raise ModelError(Diagnostic("SF233", message, None, "use poles, zeros and gain, or keep fewer modes"))
    return values


SCHEMA = "symflex.rational/1"
INDENT = "  "
ESTIMATE = "some poles or zeros could not be separated, or are not proved"
SHOWN_DIPS = 3  # antiresonances that are named
JSON_DIGITS = 17  # so many give a double back exactly

Row = tuple[str, ...]


def _said(approximation: RationalApproximation) -> list[str]:
    """Return a heading, how good the approximation is, and its behaviour at low frequency."""
    source = approximation.bound.source
    quantity = source.quantity + (f" [{source.unit}]" if source.unit else "")
    modes = "1 mode" if approximation.modes == 1 else f"{approximation.modes} modes"
    headline = approximation.stability.headline
    lines = [f"{approximation.tf}   {quantity}, {approximation.form} form, {modes}; {headline}"]
    lines += [*_validity(approximation), f"gain: {_decimal(approximation.gain)}"]
    leading = f"{approximation.leading_coefficient:.{DIGITS}g}"
    order = approximation.order_at_zero
    lines.append(f"near s = 0: {leading}*s^{order}" if order else f"static gain: {leading}")
    for i, constant in enumerate(approximation.correction):
        name = "static correction" if i == 0 else f"and of s^{i}"
        lines.append(f"{name}: {_decimal(constant)}")
    return lines


def _validity(approximation: RationalApproximation) -> list[str]:
    if approximation.is_exact:
        exact = "exact: nothing is left out of this rational function"
        return [exact, "its modes in symbols, also approximate ones: symflex roots --symbolic"]
    lines = []
    for percent in PERCENTS:
        limit = approximation.valid_to(percent / 100)
        if not limit:
            lines.append(f"already off by more than {percent} % at {approximation.scan.low_hz:.4g} Hz")
        else:
            least = "at least " if limit == approximation.scan.high_hz else ""
            but = _outside(approximation.outside(percent / 100))
            lines += _broken(f"within {percent} % of the exact function up to {least}{limit:.6g} Hz", but)
    error, scan = approximation.error, approximation.scan
    band = f"{error.low_hz:.4g} to {error.high_hz:.4g} Hz"
    worst = f"worst error from {band}: {100 * error.worst:.3g} %, at {error.worst_at_hz:.6g} Hz"
    lines += _broken(worst, _outside(error.filled_hz))
    sampled = f"{len(scan.error)} samples from {scan.low_hz:.4g} to {scan.high_hz:.6g} Hz"
    lines.append(f"sampled, not proved: {sampled}")
    if approximation.omitted_hz is not None:
        lines.append(f"the first pole left out is at {approximation.omitted_hz:.6g} Hz")
    return lines


def _broken(line: str, outside: str) -> list[str]:
    """Return a line with where it does not hold, which takes a line of its own if the two are too long."""
    if len(INDENT + line + outside) <= WIDTH:
        return [line + outside]
    return [f"{line},", INDENT + outside.removeprefix(", ")]


def _outside(dips_hz: Sequence[float]) -> str:
    """Return what is said of antiresonances beside which an error is larger."""
    if not dips_hz:
        return ""
    shown = ", ".join(f"{dip:.6g}" for dip in dips_hz[:SHOWN_DIPS])
    more = f" and {len(dips_hz) - SHOWN_DIPS} more" if len(dips_hz) > SHOWN_DIPS else ""
    noun = "the antiresonance" if len(dips_hz) == 1 else "antiresonances"
    return f", outside {100 * DIP:.0f} % of {noun} at {shown} Hz{more}"


def _decimal(number: mpmath.mpf, digits: int = DIGITS) -> str:
    if number == 0:
        return "0"
    return str(mpmath.nstr(number, digits, min_fixed=-4, max_fixed=digits)).removesuffix(".0")


def _counted(title: str, roots: Sequence[mpmath.mpc]) -> str:
    return f"{INDENT}{title}: {len(roots) or 'none'}"


def _root_rows(roots: Sequence[mpmath.mpc]) -> list[Row]:
    """Return a row per root in the upper half-plane: how often, where, its frequency and damping."""
    rows: list[Row] = [("", "Re [rad/s]", "Im [rad/s]", "f [Hz]", "zeta")]
    for root, count in Counter(root for root in roots if root.imag >= 0).items():
        size, times = abs(complex(root)), f"x{count}" if count > 1 else ""
        im = ("+-" if root.imag else "") + _decimal(root.imag)
        zeta = f"{-float(root.real) / size + 0:.6g}" if size else ""
        rows.append((times, _decimal(root.real), im, f"{size / (2 * pi):.6g}", zeta))
    return rows if roots else []


def _residue_rows(approximation: RationalApproximation) -> list[Row]:
    highest = max(len(residue.coefficients) for residue in approximation.residues)
    rows: list[Row] = [
        ("Re [rad/s]", "Im [rad/s]", "power" if highest > 1 else "", "Re residue", "Im residue")
    ]
    for residue in approximation.residues:
        if residue.root.im < 0:
            continue
        pole = _middle(residue.root)
        for power, coefficient in enumerate(residue.coefficients, 1):
            value = to_complex_mpmath(coefficient)
            re = "0" if coefficient.real.contains(0) else _decimal(value.real)
            im = "0" if coefficient.imag.contains(0) else _decimal(value.imag)
            pair = ("+-", "-+" if im.startswith("-") else "+-") if pole.imag != 0 else ("", "")
            imaginary = im if im == "0" else pair[1] + im.removeprefix("-") if pair[1] else im
            location = (_decimal(pole.real), pair[0] + _decimal(pole.imag)) if power == 1 else ("", "")
            rows.append((*location, f"{-power}" if highest > 1 else "", re, imaginary))
    return rows


def _middle(root: Root) -> mpmath.mpc:
    return to_complex_mpmath(root.enclosure())


def rational_json(approximation: RationalApproximation) -> dict[str, object]:
    """Return an approximation in the schema ``symflex.rational/1``, ready for :func:`json.dumps`."""
    error, scan = approximation.error, approximation.scan
    return {
        "schema": SCHEMA,
        "tf": approximation.tf,
        "quantity": approximation.bound.source.quantity,
        "unit": approximation.bound.source.unit,
        "form": approximation.form,
        "modes": approximation.modes,
        "stability": approximation.stability.to_json_dict(),
        "exact": approximation.is_exact,
        "certified": not approximation.is_estimate,
        "gain": _exact(approximation.gain),
        "num": [_exact(c) for c in approximation.num],
        "den": [_exact(c) for c in approximation.den],
        "poles": [_complex(root) for root in approximation.poles],
        "zeros": [_complex(root) for root in approximation.zeros],
        "residues": [
            {
                "pole": _complex(_middle(residue.root)),
                "coefficients": [
                    {**_complex(to_complex_mpmath(c)), "radius": f"{float(c.rad()):.2g}"}
                    for c in residue.coefficients
                ],
            }
            for residue in approximation.residues
        ],
        "correction": [_exact(c) for c in approximation.correction],
        "order_at_zero": approximation.order_at_zero,
        "leading_coefficient": approximation.leading_coefficient,
        "valid_to_hz": {
            f"{percent} %": _finite(approximation.valid_to(percent / 100)) for percent in PERCENTS
        },
        "outside_hz": {f"{percent} %": list(approximation.outside(percent / 100)) for percent in PERCENTS},
        "error": {
            "band_hz": [error.low_hz, error.high_hz],
            "worst": _finite(error.worst),
            "worst_at_hz": error.worst_at_hz,
            "outside_hz": list(error.filled_hz),
            "rigorous": error.is_rigorous,
        },
        "sampled": {"low_hz": scan.low_hz, "high_hz": scan.high_hz, "samples": len(scan.error)},
        "omitted_hz": approximation.omitted_hz,
    }


def _exact(number: mpmath.mpf) -> str:
    return str(mpmath.nstr(number, JSON_DIGITS))


def _complex(number: mpmath.mpc) -> dict[str, str]:
    return {"re": _exact(number.real), "im": _exact(number.imag)}


def _finite(number: float) -> float | None:
    return number if isfinite(number) else None

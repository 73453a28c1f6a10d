"""A rational function in place of a transfer function, with what is known of its error."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

import mpmath
import numpy as np

from symflex.analysis.rational.toolboxes import PERCENTS, RationalFunction, end_units
from symflex.errors import Diagnostic, ModelError
from symflex.roots.verdict import NOT_EXAMINED, StabilityVerdict
from symflex.state_space import Channel
from symflex.state_space.cascade import cascade
from symflex.state_space.numeric import BoundState, BoundStateSpace, not_installed

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt
    import sympy

    from symflex.analysis.rational.approximation_error import BandError, ErrorScan
    from symflex.analysis.rational.laurent import PrincipalPart
    from symflex.transfer import BoundTransferFunction, TransferFunction


@dataclass(frozen=True, eq=False)
class PoleZeroGain:
    """A rational function with real coefficients."""

    # poles and zeros: [rad/s], as often as their multiplicity says, both members of each conjugate pair.
    poles: tuple[mpmath.mpc, ...]
    zeros: tuple[mpmath.mpc, ...]
    gain: mpmath.mpf  # what ``(s - z).../(s - p)...`` is multiplied with
    # num and den: coefficients in descending powers of s, ``den`` beginning with 1.
    num: tuple[mpmath.mpf, ...]
    den: tuple[mpmath.mpf, ...]


@dataclass(frozen=True, eq=False)
class RationalEvaluator:
    """Values of a rational function in double precision, neither overflowing nor cancelling."""

    order: int  # of the zero at s = 0; negative of a pole
    leading: complex  # what the function over ``s^order`` is at s = 0
    # poles and zeros: those other than 0.
    poles: npt.NDArray[np.complex128]
    zeros: npt.NDArray[np.complex128]
    # Pole, power and coefficient of partial fractions; with them these are summed.
    terms: tuple[tuple[complex, int, complex], ...] | None = None
    polynomial: tuple[float, ...] = ()  # added to the partial fractions, in ascending powers of s

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
class RationalApproximation(RationalFunction):
    """A rational function R(s) in place of a transfer function G(s), for a band of frequencies.

    Parameters
    ----------
    bound : BoundTransferFunction
        G.
    form : str
        ``product``: the poles and zeros of G, and its leading term at s = 0; ``modal``: the principal parts
        of G at its poles and a constant that makes the finite part at s = 0 exact.
    modes : int
        How many modes, roots at 0 aside.
    function : PoleZeroGain
        R.
    evaluator : RationalEvaluator
        R in double precision.
    residues : tuple of PrincipalPart
        Of the modal form, its principal parts; empty for products.
    correction : tuple of mpmath.mpf
        Of the modal form, what is added to the principal parts, in ascending powers of s; one constant, the
        static correction of the modes left out, unless G is a rational function that grows with s.
    is_exact : bool
        R is G: a lumped system with all its modes.
    is_estimate : bool
        Some pole, zero or residue is not proved.
    omitted_hz : float or None
        Natural frequency of the first pole left out [Hz]; ``None`` when no pole is.
    scan : ErrorScan
        Where the error was sampled.
    band : tuple of float
        The band of :attr:`error` [Hz].
    stability : StabilityVerdict
        Of G and its hidden modes; all poles of G in the right half plane that are known are poles of R.
    """

    bound: BoundTransferFunction
    form: str
    modes: int
    function: PoleZeroGain
    evaluator: RationalEvaluator
    residues: tuple[PrincipalPart, ...]
    correction: tuple[mpmath.mpf, ...]
    is_exact: bool
    is_estimate: bool
    omitted_hz: float | None
    scan: ErrorScan
    band: tuple[float, float]
    stability: StabilityVerdict = NOT_EXAMINED

    @property
    def source(self) -> TransferFunction:
        """What it approximates."""
        return self.bound.source

    @property
    def tf(self) -> str:
        """``OUT/IN``."""
        return self.bound.name

    @property
    def poles(self) -> tuple[mpmath.mpc, ...]:
        """The poles [rad/s], as often as their multiplicity says."""
        return self.function.poles

    @property
    def zeros(self) -> tuple[mpmath.mpc, ...]:
        """The zeros [rad/s]; those of a modal form are near, not on, the zeros of G."""
        return self.function.zeros

    @property
    def gain(self) -> mpmath.mpf:
        """What ``(s - z).../(s - p)...`` is multiplied with."""
        return self.function.gain

    @property
    def num(self) -> tuple[mpmath.mpf, ...]:
        """Numerator, coefficients in descending powers of s."""
        return self.function.num

    @property
    def den(self) -> tuple[mpmath.mpf, ...]:
        """Denominator, coefficients in descending powers of s, beginning with 1."""
        return self.function.den

    @property
    def order_at_zero(self) -> int:
        """The order of the zero of G at s = 0; negative of a pole."""
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

    def __call__(self, s: npt.ArrayLike) -> complex | npt.NDArray[np.complex128]:
        """Return R at s [rad/s], a number or an array, in double precision."""
        points = np.asarray(s, dtype=complex)
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
        """Return a name that says what this is and up to which frequency it is within 1 %.

        Only letters, digits and underscores, as programs for control design want names.
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
        """Return the form, the modes and the frequencies up to which it is within 1 % and 5 %."""
        return {
            "exact": self.is_exact,
            "form": self.form,
            "modes": self.modes,
            "valid_to_hz": {f"{percent} %": self.valid_to(percent / 100) for percent in PERCENTS},
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
        try:
            import sympy
            from sympy.physics.control import TransferFunction
        except ImportError:
            raise not_installed("sympy") from None
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
        raise ModelError(Diagnostic("SF233", message, None, "poles, zeros and gain may; or take fewer modes"))
    return values

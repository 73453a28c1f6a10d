"""A rational function in place of a transfer function, with what is known of its error."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

import mpmath
import numpy as np

from symflex.errors import Diagnostic, ModelError, UsageError

if TYPE_CHECKING:
    import numpy.typing as npt
    import sympy

    from symflex.rational.approximation_error import BandError, ErrorScan
    from symflex.rational.residues import Residue
    from symflex.transfer import BoundTransferFunction

PERCENTS = (1, 5)
"""What the validity of an approximation is stated for."""


@dataclass(frozen=True, eq=False)
class PoleZeroGain:
    """A rational function with real coefficients.

    Parameters
    ----------
    poles, zeros : tuple of mpmath.mpc
        [rad/s], as often as their multiplicity says, both members of each conjugate pair.
    gain : mpmath.mpf
        What ``(s - z).../(s - p)...`` is multiplied with.
    num, den : tuple of mpmath.mpf
        Coefficients in descending powers of s, ``den`` beginning with 1.
    """

    poles: tuple[mpmath.mpc, ...]
    zeros: tuple[mpmath.mpc, ...]
    gain: mpmath.mpf
    num: tuple[mpmath.mpf, ...]
    den: tuple[mpmath.mpf, ...]


@dataclass(frozen=True, eq=False)
class Evaluator:
    """Values of a rational function in double precision, neither overflowing nor cancelling.

    Parameters
    ----------
    order : int
        Of the zero at s = 0; negative of a pole.
    leading : complex
        What the function over ``s^order`` is at s = 0.
    poles, zeros : array of complex
        Those other than 0.
    terms : tuple of (complex, int, complex), optional
        Pole, power and coefficient of partial fractions; with them these are summed.
    polynomial : tuple of float
        Added to the partial fractions, in ascending powers of s.
    """

    order: int
    leading: complex
    poles: npt.NDArray[np.complex128]
    zeros: npt.NDArray[np.complex128]
    terms: tuple[tuple[complex, int, complex], ...] | None = None
    polynomial: tuple[float, ...] = ()

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
class RationalApproximation:
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
    evaluator : Evaluator
        R in double precision.
    residues : tuple of Residue
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
    """

    bound: BoundTransferFunction
    form: str
    modes: int
    function: PoleZeroGain
    evaluator: Evaluator
    residues: tuple[Residue, ...]
    correction: tuple[mpmath.mpf, ...]
    is_exact: bool
    is_estimate: bool
    omitted_hz: float | None
    scan: ErrorScan
    band: tuple[float, float]

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
        """Return a name that says what this is and where it is valid.

        Only letters, digits and underscores, as programs for control design want names.
        """
        name = self.tf.replace("/", "_over_")
        if self.is_exact:
            return f"{name}_exact"
        valid = (
            f"{self.valid_to(PERCENTS[-1] / 100):.3g}".replace(".", "p").replace("+", "").replace("-", "m")
        )
        return f"{name}_{self.form}_{self.modes}_modes_{PERCENTS[-1]}_percent_to_{valid}_Hz"

    def to_control(self) -> object:
        """Return a ``control.TransferFunction``, named by :meth:`label`, with named input and output.

        Raises
        ------
        UsageError
            SF902 when python-control is not installed.
        ModelError
            SF233 when a coefficient is too large or too small for double precision.
        """
        try:
            import control
        except ImportError:
            raise _not_installed("control", "pip install 'symflex[control]'") from None
        source = self.bound.source
        names = {"inputs": [source.input.name], "outputs": [source.output.name]}
        return control.TransferFunction(*self.coefficients(), name=self.label(), **names)

    def to_scipy(self) -> object:
        """Return a ``scipy.signal.ZerosPolesGain``, which keeps the digits that coefficients lose.

        Raises
        ------
        UsageError
            SF902 when scipy is not installed.
        ModelError
            SF233 when the gain is too large or too small for double precision.
        """
        try:
            from scipy.signal import ZerosPolesGain
        except ImportError:
            raise _not_installed("scipy", "pip install scipy") from None
        zeros, poles = ([complex(root) for root in roots] for roots in (self.zeros, self.poles))
        (gain,) = _doubles((self.gain,), self.tf)
        return ZerosPolesGain(zeros, poles, gain)

    def to_sympy(self, digits: int = 15) -> sympy.Expr:
        """Return numerator over denominator as a SymPy expression of the symbol ``s``.

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
        except ImportError:
            raise _not_installed("sympy", "pip install sympy") from None
        s = sympy.Symbol("s")

        def polynomial(coefficients: tuple[mpmath.mpf, ...]) -> sympy.Expr:
            last = len(coefficients) - 1
            return sympy.Add(
                *(sympy.Float(c, digits) * s ** (last - i) for i, c in enumerate(coefficients) if c)
            )

        return polynomial(self.num) / polynomial(self.den)


def _doubles(numbers: tuple[mpmath.mpf, ...], name: str) -> npt.NDArray[np.float64]:
    values = np.array([float(number) for number in numbers])
    if not np.isfinite(values).all() or any(n != 0 and v == 0 for n, v in zip(numbers, values, strict=True)):
        message = f"a coefficient of the approximation of {name} does not fit into double precision"
        raise ModelError(Diagnostic("SF233", message, None, "poles, zeros and gain may; or take fewer modes"))
    return values


def _not_installed(package: str, hint: str) -> UsageError:
    return UsageError(Diagnostic("SF902", f"{package} is not installed", None, hint))

"""A rational function in place of a transfer function, with what is known of its error."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

import mpmath
import numpy as np

from symflex.analysis.rational.toolboxes import PERCENTS, ApproximateFunction, doubles
from symflex.roots.verdict import NOT_EXAMINED, StabilityVerdict
from symflex.state_space.numeric import BoundStateSpace, not_installed

if TYPE_CHECKING:
    import numpy.typing as npt
    import sympy

    from symflex.analysis.rational.approximation_error import BandError, ErrorScan
    from symflex.analysis.rational.laurent import PrincipalPart
    from symflex.transfer import BoundTransferFunction


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
class RationalEvaluator:
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
        return doubles(self.num, self.tf), doubles(self.den, self.tf)

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
        return ApproximateFunction(self).state_space()

    def to_control(self, form: str = "transfer-function") -> object:
        """Return a system of python-control, named by :meth:`label`, with named input and output.

        Parameters
        ----------
        form : str
            ``transfer-function``; or ``state-space``, see :meth:`state_space`, which loses no digits.

        Returns
        -------
        control.TransferFunction or control.StateSpace
            Its attribute ``metadata`` holds units, the frequencies up to which it is valid, and what
            rounding coefficients does to it.

        Raises
        ------
        UsageError
            SF902 when python-control is not installed, and for an unknown form.
        ModelError
            SF233 when a coefficient is too large or too small for double precision, SF236 as
            :meth:`state_space`.
        """
        return ApproximateFunction(self).to_control(form)

    def to_frd(self, omega: npt.ArrayLike) -> object:
        """Return a ``control.FrequencyResponseData`` at angular frequencies [rad/s]; named as the others.

        Raises
        ------
        UsageError
            SF902 when python-control is not installed, when frequencies do not increase, and at a pole.
        """
        return ApproximateFunction(self).to_frd(omega)

    def to_scipy(self, form: str = "zeros-poles-gain") -> object:
        """Return a system of ``scipy.signal``.

        Parameters
        ----------
        form : str
            ``zeros-poles-gain``, which keeps the digits that coefficients lose; ``transfer-function``;
            ``state-space``.

        Returns
        -------
        scipy.signal.ZerosPolesGain, TransferFunction or StateSpace
            Its attribute ``metadata`` holds name, units and the frequencies up to which it is valid.

        Raises
        ------
        UsageError
            SF902 when scipy is not installed, and for an unknown form.
        ModelError
            SF233 when a number is too large or too small for double precision, SF236 as
            :meth:`state_space`.
        """
        return ApproximateFunction(self).to_scipy(form)

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

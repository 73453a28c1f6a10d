"""Handing a rational function of s to python-control and scipy.

Input: a bound transfer function, or an approximation of one. Output: what these programs call a system.

    x/F = 1/(m s^2 + k)  --to_control()-->  control.TransferFunction([1/m], [1, 0, k/m])
                         --to_scipy()-->    scipy.signal.ZerosPolesGain([], [+-j sqrt(k/m)], 1/m)

Each coefficient is the double nearest to the exact one. Of a polynomial of high degree even those lose
digits: ``metadata["coefficients_error"]`` says how many, and state equations and roots keep them.
"""

from __future__ import annotations

import warnings
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from functools import cached_property
from math import tau

import numpy as np
import numpy.typing as npt
from flint import acb, fmpz_mpoly

from symflex.analysis.response import real_numbers
from symflex.balls import to_complex_mpmath
from symflex.errors import Diagnostic, ModelError, no_such, refused
from symflex.errors.optional import installed
from symflex.model import with_numbers
from symflex.model.loss_factors import check_causal
from symflex.roots.locate import locate
from symflex.state_space import minimal, not_rational, realise, realise_quotient
from symflex.state_space.numeric import BoundStateSpace, Rounding, bound_state_space
from symflex.state_space.popov import FieldElement
from symflex.transfer import AnyTransferFunction, BoundTransferFunction, TransferFunction
from symflex.transfer.bound import Enclosed

TRANSFER_FUNCTION, STATE_SPACE, ZEROS_POLES_GAIN = "transfer-function", "state-space", "zeros-poles-gain"
CONTROL_FORMS = (TRANSFER_FUNCTION, STATE_SPACE)
SCIPY_FORMS = (ZEROS_POLES_GAIN, TRANSFER_FUNCTION, STATE_SPACE)

PERCENTS = (1, 5)  # what the validity of an approximation is stated for
SCIPY_ZERO = 1e-14  # leading coefficients of a numerator that scipy.signal.normalize takes away

DEFAULT_BAND_HZ = (0.1, 1e4)  # for the loss of digits if the model names none: servos to piezo drives
SAMPLES = 200  # forty to a decade of that band
DIGITS = 30  # digits of the roots: twice what a double holds, so that each is rounded to the nearest one
BITS = 384  # precision of the exact value that rounded coefficients are compared with

Coefficients = tuple["npt.NDArray[np.float64]", "npt.NDArray[np.float64]"]
"""Numerator and denominator in descending powers of s; the denominator begins with 1."""

ZerosPolesGain = tuple[list[complex], list[complex], float]


class RationalFunction(ABC):
    """A rational function of s that programs for control design can take over."""

    @property
    @abstractmethod
    def source(self) -> AnyTransferFunction:
        """What it is of, with the names and units of its ends."""

    @abstractmethod
    def label(self) -> str:
        """Return a name of letters, digits and underscores."""

    @abstractmethod
    def facts(self) -> dict[str, object]:
        """Return what else is known: the band where it holds, whether it is proved."""

    @abstractmethod
    def coefficients(self) -> Coefficients:
        """Return the nearest doubles to the coefficients."""

    @abstractmethod
    def zeros_poles_gain(self) -> ZerosPolesGain:
        """Return the nearest doubles to zeros and poles [rad/s] and gain."""

    @abstractmethod
    def state_space(self) -> BoundStateSpace:
        """Return state equations."""

    @abstractmethod
    def value_and_slope(self, s: complex) -> tuple[complex, complex]:
        """Return the value at s [rad/s] and ``G'(s)/G(s)``."""

    def metadata(self) -> dict[str, object]:
        """Return quantity and units, and :meth:`facts`."""
        return {**end_units(self.source), **self.facts()}

    def to_control(self, form: str = TRANSFER_FUNCTION) -> object:
        """Return a system of python-control, named by :meth:`label`, with named input and output.

        ``form`` is ``transfer-function`` or ``state-space``, which loses no digits. The attribute
        ``metadata`` has units, the frequencies up to which it is valid, and what rounding coefficients does
        to it. SF902 when python-control is not installed, and for an unknown form; SF233 when a coefficient
        is too large or too small for double precision; SF236 as :meth:`state_space`.
        """
        check_form(form, CONTROL_FORMS)
        control = installed("control")
        if form == STATE_SPACE:
            return self.state_space().to_control(self.metadata())
        names = {"inputs": [self.source.input.name], "outputs": [self.source.output.name]}
        num, den = self.coefficients()
        system = control.TransferFunction(num, den, 0, name=self.label(), **names)
        system.metadata = {**self.metadata(), **self.loss_of_digits()}
        return system

    def to_frd(self, omega: npt.ArrayLike) -> object:
        """Return a ``control.FrequencyResponseData`` at angular frequencies [rad/s]; named as the others.

        SF902 when python-control is not installed, when frequencies do not increase, and at a pole.
        """

        def value(s: complex) -> complex:
            return self.value_and_slope(s)[0]

        return frequency_response_data(self.source, value, omega, self.label(), self.metadata())

    def to_scipy(self, form: str = ZEROS_POLES_GAIN) -> object:
        """Return a system of ``scipy.signal``, with ``metadata`` and errors as :meth:`to_control`.

        ``form`` is ``zeros-poles-gain``, which keeps the digits that coefficients lose, ``transfer-function``
        or ``state-space``.
        """
        check_form(form, SCIPY_FORMS)
        signal = installed("scipy.signal")
        if form == STATE_SPACE:
            return self.state_space().to_scipy(self.metadata())
        more: dict[str, object] = {}
        if form == TRANSFER_FUNCTION:
            num, den = self.coefficients()
            if num[0] and abs(num[0]) <= SCIPY_ZERO:
                message = (
                    f"scipy would treat the first coefficient of {self.source.name}, {num[0]:.3g}, as zero"
                )
                raise ModelError(
                    Diagnostic("SF233", message, None, "use the zeros-poles-gain form, which keeps it")
                )
            with warnings.catch_warnings():
                if not num.any():
                    # It finds nothing but zeros suspicious.
                    warnings.simplefilter("ignore")
                system, more = signal.TransferFunction(num, den), self.loss_of_digits()
        else:
            system = signal.ZerosPolesGain(*self.zeros_poles_gain())
        system.metadata = {"name": self.label(), **self.metadata(), **more}
        return system

    def loss_of_digits(self) -> dict[str, object]:
        """Return what rounding coefficients, and evaluating powers of s, does to the function.

        The worst ``|dG| / (|G| (1 + |s G'/G|))`` on the imaginary axis over the band of ``[analysis]``, else
        0.1 Hz to 10 kHz, by samples.
        """
        num, den = self.coefficients()
        band = self.source.model.analysis.band
        low, high = DEFAULT_BAND_HZ if band is None else (float(f) for f in band)
        worst = 0.0
        for omega in tau * np.geomspace(low, high, SAMPLES):
            exact, slope = self.value_and_slope(1j * omega)
            if not (np.isfinite(exact) and np.isfinite(slope) and exact):
                continue
            with np.errstate(all="ignore"):
                computed = np.polyval(num, 1j * omega) / np.polyval(den, 1j * omega)
            error = abs(computed - exact) / (abs(exact) * (1 + abs(omega * slope)))
            worst = max(worst, float(error)) if np.isfinite(error) else np.inf
        return {"coefficients_error": worst, "coefficients_error_band_hz": (low, high)}


class ExactFunction(RationalFunction):
    """A bound rational function, else SF235; ``is_minimal`` leaves unseen states out of equations."""

    def __init__(self, bound: BoundTransferFunction, *, is_minimal: bool = False) -> None:
        check_causal(bound.source.model, "a system of a toolbox")
        if not bound.is_rational:
            raise not_rational(bound.name)
        self._bound = bound
        self._is_minimal = is_minimal

    @property
    def source(self) -> TransferFunction:
        """What it is of."""
        return self._bound.source

    def label(self) -> str:
        """Return ``OUT_over_IN``."""
        return f"{self.source.output.name}_over_{self.source.input.name}"

    def facts(self) -> dict[str, object]:
        """Return that it is exact."""
        return {"exact": True}

    def coefficients(self) -> Coefficients:
        """Return the nearest doubles to the coefficients; SF233 when one is too large or too small."""
        above, below = self._parts
        return self._rounded(above), self._rounded(below)

    @cached_property
    def _enclosed(self) -> Enclosed:
        return self._bound.enclosed(BITS)

    @cached_property
    def _parts(self) -> tuple[list[fmpz_mpoly], list[fmpz_mpoly]]:
        """Numerator and denominator, polynomials free of s in descending powers of s."""
        ratio = self._bound.ratio
        above, below = (side.expand() for side in (ratio.numerator(), ratio.denominator()))
        return ratio.ring.coefficients(above)[::-1], ratio.ring.coefficients(below)[::-1]

    def _rounded(self, numerators: Sequence[fmpz_mpoly]) -> npt.NDArray[np.float64]:
        """Return coefficients over the denominator's first one as doubles."""
        lead = self._parts[1][0]
        rounding = Rounding(self._bound.ratio.ring.names, dict(self._bound.constants))
        what = f"a coefficient of {self._bound.name}"
        return np.array([rounding.nearest(FieldElement.of(c, lead), what) for c in numerators])

    def zeros_poles_gain(self) -> ZerosPolesGain:
        """Return the nearest doubles to zeros, poles and gain."""
        if self._bound.ratio.is_zero:
            return [], [], 0.0
        located = locate(self._bound, None, DIGITS)
        zeros, poles = (
            [complex(to_complex_mpmath(r.enclosure())) for r in roots for _ in range(r.multiplicity)]
            for roots in (located.zeros, located.poles)
        )
        (gain,) = self._rounded(self._parts[0][:1])
        return zeros, poles, float(gain)

    def state_space(self) -> BoundStateSpace:
        """Return the state equations of the model's network; see :func:`symflex.state_space.realise`."""
        source = self.source
        model = with_numbers(source.model, (), dict(self._bound.values))
        pair = (source.output.name, source.input.name)
        if model.is_distributed:
            system = realise_quotient(self._bound.ratio, source.constants, self._bound.radicals, model, pair)
        else:
            system = realise(model, [pair])
        return bound_state_space(minimal(system) if self._is_minimal else system, dict(self._bound.values))

    def value_and_slope(self, s: complex) -> tuple[complex, complex]:
        """Return value and ``G'/G`` at s [rad/s]."""
        slope = self._enclosed.logarithmic_derivative(acb(s.real, s.imag))
        return self._bound(s), complex(slope.mid()) if slope.is_finite() else complex("nan")


def frequency_response_data(
    source: AnyTransferFunction,
    value: Callable[[complex], complex],
    omega: npt.ArrayLike,
    label: str,
    metadata: dict[str, object],
) -> object:
    """Return a ``control.FrequencyResponseData`` at ``omega`` [rad/s]; SF902 without it, or at a pole."""
    control = installed("control")
    grid = real_numbers(omega, "omega")
    is_increasing = grid.ndim == 1 and bool(np.all(np.diff(grid) > 0))
    if not (is_increasing and grid.size and np.isfinite(grid).all() and grid[0] >= 0):
        raise refused("omega must be an increasing array of finite numbers that are not negative [rad/s]")
    values = np.array([value(complex(0.0, w)) for w in grid.tolist()], dtype=np.complex128)
    if not np.isfinite(values).all():
        pole = float(grid[~np.isfinite(values)][0])
        raise refused(f"{source.name} has a pole at omega = {pole:g} rad/s", "leave this frequency out")
    names = {"inputs": [source.input.name], "outputs": [source.output.name]}
    data = control.FrequencyResponseData(values, grid, name=label, **names)
    data.metadata = metadata
    return data


def end_units(source: AnyTransferFunction) -> dict[str, object]:
    """Return name, quantity and units of a transfer function."""
    return {
        "transfer_function": source.name,
        "quantity": source.quantity,
        "unit": source.unit,
        "input_unit": source.input.unit or str(source.input.dimension or ""),
        "output_unit": source.output.unit,
    }


def check_form(form: str, forms: Sequence[str]) -> None:
    """Raise SF902 for a form that is not one of these."""
    if form not in forms:
        raise no_such("form", form, forms)

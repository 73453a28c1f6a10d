"""A frequency response: values of a transfer function on the imaginary axis.

Input: a :class:`BoundTransferFunction` and frequencies. Output: a :class:`SampledResponse`.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, nan
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from flint import acb, ctx

from symflex.analysis.response.phase import count_turns, follow_phase
from symflex.roots.functions.simplified import without_lengths_of_zero
from symflex.roots.locate import locate
from symflex.transfer.bind import EnclosedDistributed

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

    from symflex.roots import PoleZeroMap
    from symflex.transfer import BoundTransferFunction, EnclosedTransferFunction


@dataclass(frozen=True, eq=False)
class SampledResponse:
    """Values of a transfer function at s = j omega.

    Parameters
    ----------
    tf : str
        ``"OUT/IN"``.
    omega : array of float, shape (n,)
        Angular frequencies [rad/s].
    values : array of complex, shape (n,)
        In ``unit``; ``inf + nan*1j`` at a pole.
    quantity, unit : str
        ``receptance``, ``mobility``, ...; SI unit, empty when unknown.
    turns : array of int, shape (n,), optional
        Whole turns between the principal value of the phase and the phase, which
        :func:`respond` knows from the poles and zeros. Without them, as for measured
        values, :attr:`phase` is unwrapped
        from point to point, which is right only on a grid fine enough.

    Notes
    -----
    The arrays are copied and read-only.

    Examples
    --------
    >>> response = SampledResponse("x/F", [1.0, 10.0], [1.0, -0.01], "receptance", "m/N")
    >>> response.magnitude_db.tolist()
    [0.0, -40.0]
    """

    tf: str
    omega: npt.NDArray[np.float64]
    values: npt.NDArray[np.complex128]
    quantity: str
    unit: str
    turns: npt.NDArray[np.int64] | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "omega", _frozen(np.array(self.omega, dtype=np.float64)))
        object.__setattr__(self, "values", _frozen(np.array(self.values, dtype=np.complex128)))
        if self.turns is not None:
            object.__setattr__(self, "turns", _frozen(np.array(self.turns, dtype=np.int64)))
        shapes = {a.shape for a in (self.omega, self.values, self.turns) if a is not None}
        if self.omega.ndim != 1 or len(shapes) != 1:
            message = f"a frequency response needs one-dimensional arrays of one length, not {sorted(shapes)}"
            raise ValueError(message)

    @property
    def frequency_hz(self) -> npt.NDArray[np.float64]:
        """``omega / (2 pi)`` [Hz]."""
        return self.omega / (2 * np.pi)

    @property
    def magnitude(self) -> npt.NDArray[np.float64]:
        """Absolute values, in ``unit``."""
        return np.abs(self.values)

    @property
    def magnitude_db(self) -> npt.NDArray[np.float64]:
        """``20 log10`` of the magnitude, in dB relative to one ``unit``; ``-inf`` at a zero."""
        with np.errstate(divide="ignore"):
            return 20 * np.log10(self.magnitude)

    @property
    def phase(self) -> npt.NDArray[np.float64]:
        """The phase [rad], continuous in omega; NaN exactly at a pole or zero on the axis.

        A negative gain counts as a lag of pi, or a lead of pi when poles at s = 0 lag already.
        """
        defined = np.isfinite(self.values) & (self.values != 0)
        principal = np.angle(np.where(defined, self.values, 1))
        if self.turns is None:
            phase = np.full(principal.shape, np.nan)
            phase[defined] = np.unwrap(principal[defined])
            return phase
        return np.where(defined, principal + 2 * np.pi * self.turns, np.nan)


def _frozen(array: npt.NDArray[np.generic]) -> npt.NDArray[np.generic]:
    array.setflags(write=False)
    return array


FIRST_BITS = 96
LAST_BITS = 6144
"""Precision of the first attempt, and where doubling it ends: six times."""
DOUBLE_BITS = 54
"""One more than a double has."""


def respond(
    bound: BoundTransferFunction, omega: npt.ArrayLike, roots: PoleZeroMap | None = None
) -> SampledResponse:
    """Evaluate a transfer function on the imaginary axis to double precision.

    Each value is right to the last bits of its absolute value; ``inf + nan*1j`` at a pole. The phase is
    counted from the poles and zeros, for a distributed system followed from s = 0, so it does not depend on
    how fine the grid is. ``roots`` are all poles and zeros, when they are known already; those of a
    distributed system do not matter. ValueError unless ``omega`` [rad/s] is one-dimensional and finite.

    Examples
    --------
    >>> from symflex.errors import Source
    >>> from symflex.model import load_model
    >>> from symflex.equations import assemble
    >>> from symflex.transfer import bind, derive
    >>> text = '''
    ... symflex = 1
    ... elements.load = { type = "mass", at = "x", m = "2 kg" }
    ... inputs.F = { force = "x" }
    ... outputs.X = "x"
    ... '''
    >>> inertia = bind(derive(assemble(load_model(Source("mass.toml", text))), "X", "F"))
    >>> response = respond(inertia, [0.5, 1.0])
    >>> response.values.real.tolist(), np.degrees(response.phase).tolist(), response.unit
    ([-2.0, -0.5], [-180.0, -180.0], 'm/N')
    """
    grid = np.atleast_1d(np.array(omega, dtype=np.float64))
    if grid.ndim != 1 or not np.isfinite(grid).all():
        message = "omega must be a one-dimensional array of finite numbers"
        raise ValueError(message)
    settled = without_lengths_of_zero(bound)
    if settled is not bound:
        bound, roots = settled, None
    quantity, unit = bound.source.quantity, bound.source.unit
    if bound.ratio.is_zero:
        return SampledResponse(bound.name, grid, np.zeros(grid.shape, np.complex128), quantity, unit)
    values = evaluate(bound, grid)
    if bound.is_distributed:
        turns = _follow_turns(bound, grid, values)
    else:
        turns = count_turns(grid, values, locate(bound) if roots is None else roots)
    return SampledResponse(bound.name, grid, values, quantity, unit, turns)


def _follow_turns(
    bound: BoundTransferFunction, omega: npt.NDArray[np.float64], values: npt.NDArray[np.complex128]
) -> npt.NDArray[np.int64]:
    """Return the whole turns that the principal values of a distributed system's phase lack."""
    steps, places = np.unique(np.abs(omega), return_inverse=True)
    phase = np.zeros(steps.shape)
    moving = steps > 0
    phase[moving] = follow_phase(bound, steps[moving])
    usable = np.isfinite(values) & (values != 0)
    principal = np.angle(np.where(usable, values, 1))
    wanted = np.where(omega < 0, -1, 1) * phase[places]
    usable &= np.isfinite(wanted) & (omega != 0)
    turns = np.rint((np.where(usable, wanted, principal) - principal) / (2 * np.pi))
    return turns.astype(np.int64)


def evaluate(bound: BoundTransferFunction, omega: npt.NDArray[np.float64]) -> npt.NDArray[np.complex128]:
    """Return the values at angular frequencies, with more bits where cancellation asks for them."""
    values = np.zeros(omega.shape, np.complex128)
    pending, bits = list(enumerate(omega.tolist())), FIRST_BITS
    if bound.is_distributed:
        # Where wavenumbers vanish, there is a limit but no value.
        values[omega == 0] = bound(0j)
        pending = [(i, value) for i, value in pending if value]
    while pending:
        balls = _enclose(bound.enclosed(bits), [value for _, value in pending])
        unsettled = []
        for point, ball in zip(pending, balls, strict=True):
            if ball.is_finite() and ball.rel_accuracy_bits() >= DOUBLE_BITS:
                values[point[0]] = complex(ball)
            elif bits < LAST_BITS:
                unsettled.append(point)
            elif not ball.is_finite():
                # Where wavenumbers vanish or meet, there is a limit.
                values[point[0]] = bound(1j * point[1]) if bound.is_distributed else complex(inf, nan)
        pending, bits = unsettled, 2 * bits
    return values


def _enclose(function: EnclosedTransferFunction | EnclosedDistributed, omega: Sequence[float]) -> list[acb]:
    """Return balls around the values, one polynomial after the other, for all points at once."""
    with ctx.workprec(function.bits):
        points = [acb(0, value) for value in omega]
        if isinstance(function, EnclosedDistributed):
            return [function(point) for point in points]
        values = [function.unit] * len(points)
        for polynomial, exponent in function.factors:
            factor = polynomial.evaluate(points, "iter")
            values = [value * ball**exponent for value, ball in zip(values, factor, strict=True)]
        return values

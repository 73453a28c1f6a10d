"""The fitted factor: a gain and a product of simple resonances, with its derivatives.

    g prod_i (omega_pi/omega_zi)^2 (s^2 + 2 zeta_zi omega_zi s + omega_zi^2)/(s^2 + 2 zeta_pi omega_pi s +
    omega_pi^2)

(Eppinger & Seering 1988, section "Polynomial Resonance Model"). Several responses share the poles.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

Real = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]


MILLISECOND = 1e-3


@dataclass(frozen=True, slots=True)
class Free:
    """What is fitted of each response besides its resonances: a gain, a lag of the sensor."""

    gain: bool = False
    lag: bool = False

    @property
    def count(self) -> int:
        """How many parameters that are."""
        return self.gain + self.lag


@dataclass(frozen=True, eq=False)
class Resonances:
    """Parameters of n resonances in m responses that share their poles.

    Parameters
    ----------
    omega_p, zeta_p : array of float, shape (n,)
        Natural frequencies [rad/s], ascending, and damping ratios of the poles.
    omega_z, zeta_z : array of float, shape (m, n)
        Those of the zeros, ascending in each response. A negative damping ratio is a pair of zeros in the
        right half plane.
    gain : array of float, shape (m,)
        What stands in front of each response.
    lag : array of float, shape (m,)
        Time constant of the sensor of each response [s], a factor 1/(1 + lag s); by default 0.

    Examples
    --------
    >>> one = Resonances.of([(10.0, 0.05, 11.0, 0.05)])
    >>> abs(one.factor(0, np.array([1e-6])))
    array([1.])
    """

    omega_p: Real
    zeta_p: Real
    omega_z: Real
    zeta_z: Real
    gain: Real
    lag: Real = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        if not self.lag.size:
            object.__setattr__(self, "lag", np.zeros(self.gain.size))

    @staticmethod
    def of(modes: list[tuple[float, float, float, float]], gain: float = 1.0) -> Resonances:
        """Return the resonances of one response from (omega_p, zeta_p, omega_z, zeta_z) of each."""
        table = np.array(modes, dtype=np.float64).reshape(-1, 4)
        return Resonances(
            table[:, 0], table[:, 1], table[None, :, 2], table[None, :, 3], np.array([gain])
        ).ordered()

    @property
    def count(self) -> int:
        """How many resonances there are."""
        return self.omega_p.size

    @property
    def responses(self) -> int:
        """How many responses share the poles."""
        return self.gain.size

    def ordered(self) -> Resonances:
        """Return the same product with poles, and zeros of each response, in ascending order.

        A product does not know which zero belongs to which pole; in this order it has one spelling.
        """
        poles = np.argsort(self.omega_p, kind="stable")
        zeros = np.argsort(self.omega_z, axis=1, kind="stable")
        return Resonances(
            self.omega_p[poles],
            self.zeta_p[poles],
            np.take_along_axis(self.omega_z, zeros, 1),
            np.take_along_axis(self.zeta_z, zeros, 1),
            self.gain,
            self.lag,
        )

    def factor(self, response: int, omega: Real) -> Complex:
        """Return the product with the response's gain at ``1j*omega``, shape (k,)."""
        value: Complex = self.gain[response] / (1 + 1j * omega * self.lag[response])
        for i in range(self.count):
            above = _quadratic(omega, self.omega_z[response, i], self.zeta_z[response, i])
            value = value * above / _quadratic(omega, self.omega_p[i], self.zeta_p[i])
        return value

    def pack(self, free: Free) -> Real:
        """Return the parameters as one vector.

        ln omega_p, ln zeta_p; then per response ln omega_z, zeta_z and, when they are free, ln abs(gain)
        and the lag in milliseconds.
        """
        parts = [np.log(self.omega_p), np.log(self.zeta_p)]
        for r in range(self.responses):
            parts += [np.log(self.omega_z[r]), self.zeta_z[r]]
            if free.gain:
                parts.append(np.log(np.abs(self.gain[r : r + 1])))
            if free.lag:
                parts.append(self.lag[r : r + 1] / MILLISECOND)
        return np.concatenate(parts)

    def unpack(self, vector: Real, free: Free) -> Resonances:
        """Return the resonances of a vector as :meth:`pack` makes it; gains keep their sign."""
        n = self.count
        omega_p, zeta_p = np.exp(vector[:n]), np.exp(vector[n : 2 * n])
        rest = vector[2 * n :].reshape(self.responses, 2 * n + free.count)
        gain = np.sign(self.gain) * np.exp(rest[:, 2 * n]) if free.gain else self.gain
        lag = MILLISECOND * rest[:, -1] if free.lag else self.lag
        return Resonances(omega_p, zeta_p, np.exp(rest[:, :n]), rest[:, n : 2 * n], gain, lag)

    def log_derivatives(self, response: int, omega: Real, free: Free) -> Complex:
        """Return d ln(factor) by the packed parameters, shape (k, size of the vector)."""
        n, m = self.count, self.responses
        width = 2 * n + free.count
        found = np.zeros((omega.size, 2 * n + m * width), dtype=np.complex128)
        start = 2 * n + response * width
        for i in range(n):
            by_omega, by_zeta = _log_slopes(omega, self.omega_p[i], self.zeta_p[i])
            found[:, i], found[:, n + i] = -by_omega, -by_zeta * self.zeta_p[i]
            by_omega, by_zeta = _log_slopes(omega, self.omega_z[response, i], self.zeta_z[response, i])
            found[:, start + i], found[:, start + n + i] = by_omega, by_zeta
        if free.gain:
            found[:, start + 2 * n] = 1
        if free.lag:
            s = 1j * omega
            found[:, start + width - 1] = -MILLISECOND * s / (1 + s * self.lag[response])
        return found


def _quadratic(omega: Real, centre: float, zeta: float) -> Complex:
    """Return (s^2 + 2 zeta centre s + centre^2)/centre^2 at s = j omega."""
    x = omega / centre
    return 1 - x * x + 2j * zeta * x


def _log_slopes(omega: Real, centre: float, zeta: float) -> tuple[Complex, Complex]:
    """Return the derivatives of ln of :func:`_quadratic` by ln(centre) and by zeta."""
    x = omega / centre
    value = 1 - x * x + 2j * zeta * x
    return np.asarray((2 * x * x - 2j * zeta * x) / value, np.complex128), 2j * x / value

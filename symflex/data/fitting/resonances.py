"""The fitted factor: a gain, a power of s and a product of simple resonances, with its derivatives.

    g s^k prod_i (omega_pi/omega_zi)^2 (s^2 + 2 zeta_zi omega_zi s + omega_zi^2)/(s^2 + 2 zeta_pi omega_pi s +
    omega_pi^2) / (1 + lag s) exp(-delay s)

(Eppinger & Seering 1988, section "Polynomial Resonance Model"). Several responses share the poles. A response
may have fewer pairs of zeros than of poles, as transfer functions between two points have: a pair that is not
there has its natural frequency at infinity, where its factor is 1.

Two real poles are a pair with a damping ratio above 1. Where degrees are odd, a real pole, 1/(1 + s/p), and a
real zero of each response, 1 + s/z, stand beside the pairs: the lag of a motor, an inductor.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

Real = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]
Values = Complex | Real
Whole = npt.NDArray[np.int64]
Mask = npt.NDArray[np.bool_]

MILLISECOND = 1e-3
UNITS = {"omega_z": 1.0, "zeta_z": 1.0, "real_z": 1.0, "gain": 1.0, "lag": MILLISECOND, "delay": MILLISECOND}
"""Parameters that each response has of its own, and in which units a packed vector holds them."""
LOGARITHMIC = ("omega_z", "real_z", "gain")  # those of which it contains the logarithm
NO_PEAK = 0.5**0.5  # damping ratio from which a pair of poles raises no magnitude


@dataclass(frozen=True, slots=True)
class Free:
    """What is fitted besides resonances: gain, a sensor's lag (a lead if ``lag_sign`` says so), delay."""

    gain: bool = False
    lag: bool = False
    delay: bool = False
    lag_sign: bool = False

    @property
    def count(self) -> int:
        """How many parameters that are."""
        return self.gain + self.lag + self.delay


@dataclass(frozen=True, eq=False)
class Resonances:
    """Parameters of n resonances in m responses that share their poles."""

    # omega_p and zeta_p: shape (n,): Natural frequencies [rad/s], ascending, and damping ratios of the poles.
    omega_p: Real
    zeta_p: Real
    # omega_z and zeta_z: shape (m, n): Those of the zeros, ascending in each response. A negative damping
    # ratio is a pair of zeros in the right half-plane. Infinite where a response has fewer pairs of zeros. A
    # negative frequency -w stands for two real zeros of opposite sign, the factor 1 + 2 zeta s/w - (s/w)^2:
    # transfer functions of beams have them.
    omega_z: Real
    zeta_z: Real
    gain: Real  # shape (m,): What stands in front of each response
    # shape (m,): Time constant of the sensor of each response [s], a factor 1/(1 + lag s), or where it is
    # negative, a lead, 1 - lag s; by default 0.
    lag: Real = field(default_factory=lambda: np.zeros(0))
    # shape (m,): Delay of each response [s], a factor exp(-delay s); by default 0.
    delay: Real = field(default_factory=lambda: np.zeros(0))
    # shape (m,): The power of s of each response; by default 0.
    slope: Whole = field(default_factory=lambda: np.zeros(0, np.int64))
    # shape (0,) or (1,): Corner frequency of the real pole that all responses share [rad/s], if there is one.
    real_p: Real = field(default_factory=lambda: np.zeros(0))
    # shape (m,): Corner frequency of the real zero of each response [rad/s], negative in the right
    # half-plane, infinite where it has none; by default infinite.
    real_z: Real = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        for name in ("lag", "delay", "slope"):
            if not getattr(self, name).size:
                kind = np.int64 if name == "slope" else np.float64
                object.__setattr__(self, name, np.zeros(self.gain.size, kind))
        if not self.real_z.size:
            object.__setattr__(self, "real_z", np.full(self.gain.size, np.inf))

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

    @property
    def has_zeros(self) -> Mask:
        """Which pairs of zeros are there, shape (m, n)."""
        return np.isfinite(self.omega_z)

    @property
    def order(self) -> int:
        """How many poles there are."""
        return 2 * self.count + self.real_p.size

    @property
    def is_improper(self) -> Mask:
        """Which responses have more zeros than poles, powers of s among both, shape (m,)."""
        zeros = self.slope + 2 * self.has_zeros.sum(axis=1) + np.isfinite(self.real_z) + (self.lag < 0)
        return np.asarray(zeros > self.order + (self.lag > 0))

    def in_band(self, low: float, high: float) -> Mask:
        """Return which pole pairs are resonances in a band [rad/s]; the others are residual terms."""
        return (self.zeta_p < NO_PEAK) & (self.omega_p >= low) & (self.omega_p <= high)

    def ordered(self) -> Resonances:
        """Return the same product with poles and zeros in ascending order, in which it has one spelling."""
        poles = np.argsort(self.omega_p, kind="stable")
        zeros = np.argsort(np.abs(self.omega_z), axis=1, kind="stable")
        omega_z, zeta_z = (np.take_along_axis(array, zeros, 1) for array in (self.omega_z, self.zeta_z))
        omega_p, zeta_p = self.omega_p[poles], self.zeta_p[poles]
        return replace(self, omega_p=omega_p, zeta_p=zeta_p, omega_z=omega_z, zeta_z=zeta_z)

    def real_corners(self) -> list[float]:
        """Return the corner frequencies of all real poles, the single one and those in pairs.

        >>> round(Resonances.of([(6.0, 1.25, 9.0, 0.1)]).real_corners()[1], 12)
        12.0
        """
        pairs = self.zeta_p >= 1
        omega, zeta = self.omega_p[pairs], self.zeta_p[pairs]
        # The smaller root by the product of both: a difference would lose its digits.
        upper = omega * (zeta + np.sqrt(zeta**2 - 1))
        return [*self.real_p.tolist(), *np.column_stack((omega**2 / upper, upper)).ravel().tolist()]

    def with_real_corners(self, corners: list[float]) -> Resonances | None:
        """Return the product with other real poles; None if it has more zeros than pairs of poles then."""
        n = len(corners) // 2
        low, high = np.array(sorted(corners)[: 2 * n]).reshape(n, 2).T
        is_pair = self.zeta_p < 1
        omega_p = np.append(self.omega_p[is_pair], np.sqrt(low * high))
        if self.has_zeros[:, omega_p.size :].any():
            return None
        zeta_p = np.append(self.zeta_p[is_pair], (low + high) / (2 * np.sqrt(low * high)))
        return replace(
            self,
            omega_p=omega_p,
            zeta_p=zeta_p,
            omega_z=self.omega_z[:, : omega_p.size],
            zeta_z=self.zeta_z[:, : omega_p.size],
            real_p=np.array(sorted(corners)[2 * n :]),
        ).ordered()

    def minimum_phase(self, which: Mask) -> Resonances:
        """Return the function whose marked responses have positive gains and no zeros on the right."""
        # Real zeros of opposite sign, mirrored, are an overdamped pair.
        zeta = np.where(self.omega_z < 0, np.hypot(1, self.zeta_z), np.abs(self.zeta_z))
        sizes = {
            name: np.where(which, np.abs(array := getattr(self, name)), array) for name in ("real_z", "gain")
        }
        omega_z = np.where(which[:, None], np.abs(self.omega_z), self.omega_z)
        return replace(self, omega_z=omega_z, zeta_z=np.where(which[:, None], zeta, self.zeta_z), **sizes)

    def one(self, response: int) -> Resonances:
        """Return those of one response."""
        r = slice(response, response + 1)
        return replace(self, **{name: getattr(self, name)[r] for name in (*UNITS, "slope")})

    def factor(self, response: int, omega: Values) -> Complex:
        """Return the product with the response's gain at ``1j*omega``, shape (k,)."""
        s = 1j * omega
        lag = self.lag[response]
        value: Complex = self.gain[response] * (1 + s * abs(lag)) ** (-1.0 if lag >= 0 else 1.0)
        if self.slope[response]:
            value = value * s ** float(self.slope[response])
        if self.delay[response]:
            value = value * np.exp(-s * self.delay[response])
        for i in range(self.count):
            above = _quadratic(omega, self.omega_z[response, i], self.zeta_z[response, i])
            value = value * above / _quadratic(omega, self.omega_p[i], self.zeta_p[i])
        for corner in self.real_p:
            value = value / (1 + s / corner)
        return np.asarray(value * (1 + s / self.real_z[response]), np.complex128)

    def share(self, response: int, i: int, omega: Values) -> Complex:
        """Return what the partial fraction of a pair of poles has of a response at ``1j*omega``.

        >>> round(float(abs(Resonances.of([(2.0, 0.01, np.inf, 0.0)]).share(0, 0, np.array([2.0]))[0])), 2)
        1.0
        """
        size, zeta = self.omega_p[i], self.zeta_p[i]
        pole = size * (-zeta + 1j * np.sqrt(1 - zeta**2))
        omega_p = self.omega_p.copy()
        omega_p[i] = np.inf
        rest = replace(self, omega_p=omega_p).factor(response, np.array([pole / 1j]))[0]
        residue = rest * size**2 / (2j * pole.imag)
        s = 1j * omega
        both = residue / (s - pole) + np.conj(residue) / (s - np.conj(pole))
        return np.asarray(both / self.factor(response, omega), np.complex128)

    def shared(self) -> int:
        """Return how many parameters all responses share; they stand first in the packed vector."""
        return 2 * self.count + self.real_p.size

    def places(self, response: int, free: Free) -> dict[str, slice]:
        """Return where the parameters of a response stand in the packed vector, by their names."""
        at = self.shared() + sum(self._own(r, free) for r in range(response))
        n = int(self.has_zeros[response].sum())
        sizes = {"omega_z": n, "zeta_z": n, "real_z": int(np.isfinite(self.real_z[response]))}
        sizes |= {"gain": int(free.gain), "lag": int(free.lag), "delay": int(free.delay)}
        slices = {}
        for name, size in sizes.items():
            slices[name] = slice(at, at + size)
            at += size
        return slices

    def own_places(self, free: Free) -> Iterator[tuple[str, tuple[int, Mask] | slice, slice]]:
        """Yield for every response its parameters: name, place in the array of it, place in the vector."""
        for r, shown in enumerate(self.has_zeros):
            for name, columns in self.places(r, free).items():
                single = slice(r, r + columns.stop - columns.start)  # empty where it is not fitted
                yield name, (r, shown) if name in ("omega_z", "zeta_z") else single, columns

    def _own(self, response: int, free: Free) -> int:
        shown = int(self.has_zeros[response].sum())
        return 2 * shown + int(np.isfinite(self.real_z[response])) + free.count

    def columns(self, response: int, free: Free) -> Whole:
        """Return which packed parameters a response depends on: those of the poles, and its own."""
        first = self.places(response, free)["omega_z"].start
        of_response = np.arange(first, first + self._own(response, free))
        return np.concatenate((np.arange(self.shared()), of_response))

    def size(self, free: Free) -> int:
        """Return how many parameters there are."""
        return self.shared() + sum(self._own(r, free) for r in range(self.responses))

    def pack(self, free: Free) -> Real:
        """Return the parameters as one vector."""
        # ln omega_p, ln zeta_p, ln real_p; then per response ln abs(omega_z), zeta_z of the zeros there are,
        # ln abs(real_z) likewise and, when they are free, ln abs(gain), the lag and the delay in
        # milliseconds.
        parts = [np.log(self.omega_p), np.log(self.zeta_p), np.log(self.real_p)]
        for name, index, _ in self.own_places(free):
            values = getattr(self, name)[index]
            parts.append(np.log(np.abs(values)) if name in LOGARITHMIC else values / UNITS[name])
        return np.concatenate(parts)

    def unpack(self, vector: Real, free: Free) -> Resonances:
        """Return the resonances of a vector as :meth:`pack` makes it; gains keep their sign."""
        n = self.count
        arrays: dict[str, Real] = {name: getattr(self, name).copy() for name in UNITS}
        for name, index, columns in self.own_places(free):
            signs, found = np.sign(arrays[name][index]), vector[columns]
            arrays[name][index] = signs * np.exp(found) if name in LOGARITHMIC else UNITS[name] * found
        shared = {"omega_p": vector[:n], "zeta_p": vector[n : 2 * n], "real_p": vector[2 * n : self.shared()]}
        arrays |= {name: np.exp(logarithms) for name, logarithms in shared.items()}
        return replace(self, **arrays)  # type: ignore[arg-type]

    def log_derivatives(self, response: int, omega: Values, free: Free) -> Complex:
        """Return d ln(factor) by the packed parameters that :meth:`columns` names, shape (k, p)."""
        n, shared = self.count, self.shared()
        slopes = np.zeros((omega.size, shared + self._own(response, free)), dtype=np.complex128)
        places = self.places(response, free)
        first = places["omega_z"].start - shared
        at = {name: slice(one.start - first, one.stop - first) for name, one in places.items()}
        s = 1j * omega[:, None]
        for i in range(n):
            by_omega, by_zeta = _log_slopes(omega, self.omega_p[i], self.zeta_p[i])
            slopes[:, i], slopes[:, n + i] = -by_omega, -by_zeta * self.zeta_p[i]
        slopes[:, 2 * n : shared] = s / (self.real_p + s)
        for k, i in enumerate(np.flatnonzero(self.has_zeros[response]).tolist()):
            by_omega, by_zeta = _log_slopes(omega, self.omega_z[response, i], self.zeta_z[response, i])
            slopes[:, at["omega_z"].start + k], slopes[:, at["zeta_z"].start + k] = by_omega, by_zeta
        slopes[:, at["real_z"]] = -s / (self.real_z[response] + s)
        slopes[:, at["gain"]] = 1
        slopes[:, at["lag"]] = -MILLISECOND * s / (1 + s * abs(self.lag[response]))
        slopes[:, at["delay"]] = -MILLISECOND * s
        return slopes


def _quadratic(omega: Values, centre: float, zeta: float) -> Complex:
    """Return 1 + 2 zeta s/centre + (s/centre)^2 at s = j omega; a negative centre negates the square."""
    x = omega / abs(centre)
    value: Complex = 1 - np.sign(centre) * x * x + 2j * zeta * x
    return value


def _log_slopes(omega: Values, centre: float, zeta: float) -> tuple[Complex, Complex]:
    """Return the derivatives of ln of :func:`_quadratic` by ln(centre) and by zeta."""
    x = omega / abs(centre)
    value = _quadratic(omega, centre, zeta)
    curved = 2 * np.sign(centre) * x * x
    return np.asarray((curved - 2j * zeta * x) / value, np.complex128), 2j * x / value

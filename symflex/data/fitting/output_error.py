"""Poles, delay and disturbances that leave the least error of outputs in time; all else is linear.

Each output is a sum of modes that its input drives and of what disturbs it, see
:mod:`symflex.data.fitting.sampled_record`:

    y = sum_i (r_i/(s - p_i) + conj) u + d u + sum_i c_i exp(p_i t) + drift t + sum_k sine at omega_k + noise

Residues r, feedthrough d, decays c, drift and amplitudes of sines enter linearly. Given the poles, the delay
of u and the frequencies of sines they are found by one factorisation, and drop out of the search (variable
projection: Golub & Pereyra, SIAM J. Numer. Anal. 10, 1973; Kaufman, BIT 15, 1975). Several outputs share
the poles, and several records of one output its residues too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final

import numpy as np
from scipy.linalg import block_diag, qr

from symflex.data.fitting.least_squares import NULL_PART, search, triangle
from symflex.data.fitting.resonances import NO_PEAK, Complex, Real, Values
from symflex.data.fitting.sampled_record import SampledRecord

Outputs = tuple[tuple[SampledRecord, ...], ...]
"""The records of each output."""

DEPENDENT: Final = 1e-11  # share of a column that is its own, below which others say the same
PINNED: Final = 1e6
LEAST_DAMPING, MOST_DAMPING = 1e-7, 0.9995  # of pairs; beyond, they are two real poles
OCTAVE: Final = 0.7  # logarithm of a frequency by which a search may move it
FAR: Final = 3.0  # the same of real poles
LOOSE: Final = 1.5  # samples by which a search may move a delay; for sines, multiples of 1/T
STEPS, TOLERANCE = 60, 1e-9
MOST_PARAMETERS: Final = 0.6  # share of the values of an output that parameters may be
ANYWHERE: Final = 8.0  # what a pair of poles costs more, as it may have any frequency
CHANCE: Final = 2e-4  # share of records of noise in which a sine is found (Fisher, Proc. R. Soc. A 125, 1929)
SHARP, UNDAMPED = 1e-5, 12.0  # damping ratio of a pair that is rather a sine, and what it costs more
UNASKED: Final = 1e9  # what another number of modes costs than that asked for
NULL: Final = 1e-14  # reciprocal condition below which a direction is not determined


@dataclass(frozen=True, eq=False)
class PoleSet:
    """What enters outputs nonlinearly, and which linear terms there are."""

    omega: Real  # of pairs of poles [rad/s]
    zeta: Real
    real: Real  # corner frequencies of real poles [rad/s]
    lines: Real  # of steady sines [rad/s]
    delay_s: float = 0.0
    integrators: int = 0  # poles at zero
    is_delay_free: bool = False
    has_direct: bool = False  # whether the output follows the input at once
    has_drift: bool = False

    @staticmethod
    def nothing() -> PoleSet:
        """Return an offset alone."""
        none = np.zeros(0)
        return PoleSet(none, none, none, none)

    @property
    def poles(self) -> Complex:
        """The poles of pairs, upper half-plane, and real ones."""
        upper = self.omega * (-self.zeta + 1j * np.sqrt(1 - self.zeta**2))
        return np.concatenate((upper, -self.real))

    @property
    def order(self) -> int:
        """How many poles there are, those at zero included."""
        return 2 * self.omega.size + self.real.size + self.integrators

    def with_terms(self, more: PoleSet) -> PoleSet:
        """Return the dynamics with poles and sines of another."""
        return replace(
            self,
            omega=np.append(self.omega, more.omega),
            zeta=np.append(self.zeta, more.zeta),
            real=np.append(self.real, more.real),
            lines=np.append(self.lines, more.lines),
        )

    def pack(self, step_s: float, length_s: float) -> Real:
        """Return the parameters of a search."""
        parts = [np.log(self.omega), self.zeta, np.log(self.real), self.lines * length_s]
        return np.concatenate((*parts, [self.delay_s / step_s] * self.is_delay_free))

    def unpack(self, x: Real, step_s: float, length_s: float) -> PoleSet:
        """Return what the parameters of a search stand for."""
        sizes = np.cumsum([self.omega.size, self.zeta.size, self.real.size, self.lines.size])
        omega, zeta, real, lines, delay = np.split(x, sizes)
        return replace(
            self,
            omega=np.exp(omega),
            zeta=zeta,
            real=np.exp(real),
            lines=lines / length_s,
            delay_s=float(delay[0]) * step_s if delay.size else self.delay_s,
        )


@dataclass(frozen=True, eq=False)
class Solved:
    """One output with the best linear terms."""

    residual: Real  # weighted by the noise
    errors: tuple[Complex, ...]  # the spectrum that is left of each record, not weighted
    coefficients: Real
    basis: Real  # orthonormal columns that span those of the linear terms
    columns: Real  # shape (k, c), weighted
    parts: tuple[_RecordModel, ...] = field(repr=False)

    @property
    def cost(self) -> float:
        """The sum of squares."""
        return float(self.residual @ self.residual)

    def slopes(self, problem: OutputError) -> Real:
        """Return the weighted derivatives of the model by the parameters of a search, shape (k, p)."""
        column = shared = self.parts[0].driven.shape[1]
        stacked = []
        for part in self.parts:
            width = part.own.shape[1]
            of_record = self.coefficients[column : column + width]
            by = part.slopes(self.coefficients[:shared], of_record, problem.step_s, problem.length_s)
            stacked.append(part.record.weighted(by))
            column += width
        return np.concatenate(stacked)


@dataclass(frozen=True, eq=False)
class OutputError:
    """Outputs, and the search for dynamics that describe them."""

    outputs: Outputs
    criterion: str = "bic"
    modes: int | None = None  # how many pairs of poles are asked for
    step_s: float = field(init=False)
    length_s: float = field(init=False)
    sizes: tuple[int, ...] = field(init=False)  # values of each output

    def __post_init__(self) -> None:
        every = [one for records in self.outputs for one in records]
        object.__setattr__(self, "step_s", min(one.step_s for one in every))
        object.__setattr__(self, "length_s", max(one.step_s * one.size for one in every))
        sizes = tuple(sum(_values(one) for one in records) for records in self.outputs)
        object.__setattr__(self, "sizes", sizes)

    def solve(self, dynamics: PoleSet) -> list[Solved]:
        """Return every output with the best linear terms."""
        return [_solved(records, dynamics) for records in self.outputs]

    def linear_terms(self, dynamics: PoleSet, output: int) -> int:
        """Return how many linear terms an output has; an offset of each record is one."""
        records = self.outputs[output]
        plant = dynamics.order + dynamics.has_direct if records[0].input is not None else 0
        return plant + sum(_own_terms(one, dynamics) + 1 for one in records)

    def score(self, dynamics: PoleSet, costs: Sequence[float] | None = None) -> float:
        """Return the criterion; a sine may lie at any frequency, and a pair of poles nearly so."""
        costs = [one.cost for one in self.solve(dynamics)] if costs is None else costs
        n = sum(self.sizes)
        price = np.log(n) if self.criterion == "bic" else 2.0
        total = 0.0
        for r, (cost, size) in enumerate(zip(costs, self.sizes, strict=True)):
            parameters = self.linear_terms(dynamics, r)
            if parameters > MOST_PARAMETERS * size:
                return np.inf
            # Samples before a delay are not used; each would add about one to the squares.
            unused = sum(one.lead for one in self.outputs[r] if not one.is_at_rest)
            total += size * np.log(max(cost, 1e-300) / size) + parameters * price + unused
        total += dynamics.omega.size * (2 * price + ANYWHERE) + dynamics.real.size * (price + ANYWHERE / 2)
        total += UNDAMPED * np.sum(dynamics.zeta < SHARP)
        total += dynamics.lines.size * 2 * np.log(n / CHANCE) + dynamics.is_delay_free * price
        asked = self.modes is not None and np.sum(dynamics.zeta < NO_PEAK) != self.modes
        return float(total + UNASKED * asked)

    def score_with(self, dynamics: PoleSet, more: PoleSet, solved: list[Solved]) -> float:
        """Return the criterion of dynamics with one term more, before anything else moves."""
        costs = []
        for records, one in zip(self.outputs, solved, strict=True):
            columns = _without(one.basis, _columns([_RecordModel(record, more) for record in records]))
            _, _, residual = solved_real(columns, one.residual)
            costs.append(float(residual @ residual))
        return self.score(dynamics.with_terms(more), costs)

    def refined(self, start: PoleSet, steps: int = STEPS, tolerance: float = TOLERANCE) -> PoleSet:
        """Return the minimum that a start leads to."""
        clipped = replace(start, zeta=np.clip(start.zeta, 2 * LEAST_DAMPING, MOST_DAMPING - 1e-4))
        x = clipped.pack(self.step_s, self.length_s)
        if not x.size:
            return start
        n, m = start.omega.size, start.real.size
        highest = np.log(np.pi / self.step_s)
        reach = np.concatenate((np.full(n, OCTAVE), np.full(n, 2.0), np.full(m, FAR)))
        reach = np.concatenate((reach, np.full(x.size - reach.size, LOOSE)))
        low, high = x - reach, x + reach
        high[:n] = np.maximum(np.minimum(high[:n], highest), x[:n])
        low[n : 2 * n], high[n : 2 * n] = LEAST_DAMPING, MOST_DAMPING
        if start.is_delay_free:
            low[-1] = max(low[-1], 0.0)
            lead = min(one.lead for records in self.outputs for one in records)
            high[-1] = max(min(high[-1], lead + 0.999), x[-1])

        last: list[tuple[Real, list[Solved]]] = []  # at most one: a step that is taken was tried just before

        def solved(vector: Real) -> list[Solved]:
            if not last or not np.array_equal(last[0][0], vector):
                last[:] = [(vector.copy(), self.solve(clipped.unpack(vector, self.step_s, self.length_s)))]
            return last[0][1]

        def residual(vector: Real) -> list[Values]:
            return [one.residual for one in solved(vector)]

        def reduced(vector: Real, _: list[Values]) -> tuple[Real, Real]:
            stacked = np.concatenate(
                [
                    np.column_stack((-_without(one.basis, one.slopes(self)), one.residual))
                    for one in solved(vector)
                ]
            )
            upper = triangle(stacked)
            return upper[:, :-1], upper[:, -1]

        found, _ = search(residual, reduced, x, (low, high), steps, tolerance)
        return clipped.unpack(found, self.step_s, self.length_s)

    def with_noise(self, dynamics: PoleSet) -> OutputError:
        """Return the problem with lines weighed by the noise that a model leaves, and lost samples filled."""
        outputs = []
        for records, one in zip(self.outputs, self.solve(dynamics), strict=True):
            pairs = zip(records, one.errors, strict=True)
            outputs.append(
                tuple(r.filled(e).with_noise(e, _gain(r, dynamics, one.coefficients)) for r, e in pairs)
            )
        return replace(self, outputs=tuple(outputs))

    def filled(self, dynamics: PoleSet) -> OutputError:
        """Return the problem with samples that were lost as a model has them."""
        outputs = self.outputs
        if any(one.measured is not None for records in outputs for one in records):
            outputs = tuple(
                tuple(r.filled(e) for r, e in zip(records, one.errors, strict=True))
                for records, one in zip(outputs, self.solve(dynamics), strict=True)
            )
        return replace(self, outputs=outputs)

    def offset(self, dynamics: PoleSet, output: int, one: Solved, begun: float) -> float | None:
        """Return the mean of an output without modes and input; None where an integrator leaves it open."""
        # A record at rest is that of the input less what it begins with.
        record = self.outputs[output][0]
        if dynamics.integrators:
            return None
        root, at, total = np.sqrt(record.size), 0, np.sum(record.output) / np.sqrt(record.size)
        own = one.coefficients[_RecordModel(record, dynamics).driven.shape[1] :]
        begun = begun if record.is_at_rest and not record.is_from_zero else 0.0
        has_free = record.input is None or not record.is_at_rest
        for i, p in enumerate(dynamics.poles):
            pole, is_pair = record.pole(p, dynamics.delay_s, is_mean=True), i < dynamics.omega.size
            for values, coefficients in (
                (None if record.input is None else pole.driven, one.coefficients),
                (pole.free if has_free else None, own),
            ):
                if values is not None:
                    c = complex(*coefficients[at : at + 1 + is_pair])
                    level = root * begun / -p if coefficients is not own else 0
                    total -= (1 + is_pair) * (c * (values[0] + level)).real
            at += 1 + is_pair
        if dynamics.has_direct:
            total -= one.coefficients[at] * (record.input_mean()[0].real + root * begun)
        for k, w in enumerate(dynamics.lines):
            c = complex(*own[own.size - 2 * (dynamics.lines.size - k) :][:2])
            total -= 2 * (c * record.pole(1j * w, is_mean=True).free[0]).real
        return float(total / root)

    def with_lost_inputs(self, dynamics: PoleSet) -> OutputError:
        """Return the problem with the input free at samples that were lost."""
        outputs = []
        for records, one in zip(self.outputs, self.solve(dynamics), strict=True):
            free = []
            for record in records:
                plain = replace(record, lost=None)
                columns = _of_lost(plain, dynamics, one.coefficients)
                free.append(
                    plain if columns is None else replace(plain, lost=qr(columns, mode="economic")[0])
                )
            outputs.append(tuple(free))
        return replace(self, outputs=tuple(outputs))

    def lost_inputs(self, dynamics: PoleSet) -> list[list[Real]]:
        """Return the likeliest errors of the input at the samples that were lost, of each record."""
        # Their deviation is that of the input about its neighbours' mean.
        found: list[list[Real]] = []
        for records, one in zip(self.outputs, self.solve(dynamics), strict=True):
            of_output: list[Real] = []
            for record, error in zip(records, one.errors, strict=True):
                plain = replace(record, lost=None)
                columns = _of_lost(plain, dynamics, one.coefficients)
                if columns is None or record.input is None:
                    of_output.append(np.zeros(0))
                    continue
                u = record.input
                variance = float(np.mean((u[1:-1] - (u[:-2] + u[2:]) / 2) ** 2)) + np.finfo(float).tiny
                own = _RecordModel(plain, dynamics).own
                _, basis, rest = solved_real(plain.weighted(own), plain.weighted(error))
                columns = _without(basis, columns)
                left = float(np.mean(_without(solved_real(columns, rest)[1], rest) ** 2))
                normal = columns.T @ columns + np.eye(columns.shape[1]) * left / variance
                of_output.append(np.asarray(np.linalg.solve(normal, columns.T @ rest), np.float64))
            found.append(of_output)
        return found

    def covariance(self, dynamics: PoleSet) -> tuple[Real, list[Solved], float]:
        """Return the covariance of the search's parameters and of the linear terms, output after output."""
        # Also the solutions and the sum of squares per degree of freedom, which scales it.
        every = self.solve(dynamics)
        slopes = [one.slopes(self) for one in every]
        p = slopes[0].shape[1]
        counts = [one.columns.shape[1] for one in every]
        total = p + sum(counts)
        normal = np.zeros((total, total))
        at = p
        for one, by, count in zip(every, slopes, counts, strict=True):
            own = slice(at, at + count)
            normal[:p, :p] += by.T @ by
            normal[:p, own] = by.T @ one.columns
            normal[own, :p] = normal[:p, own].T
            normal[own, own] = one.columns.T @ one.columns
            at += count
        freedom = sum(self.sizes) - total
        reduced = sum(one.cost for one in every) / max(freedom, 1)
        scale = np.sqrt(np.maximum(np.diag(normal), np.finfo(float).tiny))
        values, vectors = np.linalg.eigh(normal / np.outer(scale, scale))
        kept = values > NULL * values[-1]
        inverse = (vectors[:, kept] / values[kept]) @ vectors[:, kept].T
        covariance = inverse * reduced / np.outer(scale, scale)
        lost = np.any(np.abs(vectors[:, ~kept]) > NULL_PART, axis=1)
        covariance[lost, lost] = np.inf
        return covariance, every, reduced


def _of_lost(record: SampledRecord, dynamics: PoleSet, coefficients: Real) -> Real | None:
    """Return what a unit error of the input adds, weighted, at each sample that was lost."""
    by_lost = _by_lost(record, dynamics, coefficients)
    return None if by_lost is None else record.weighted(by_lost)


def _by_lost(record: SampledRecord, dynamics: PoleSet, coefficients: Real) -> Complex | None:
    if record.measured is None or record.input is None:
        return None
    response = _struck(record, dynamics, coefficients)
    lost = np.flatnonzero(~record.measured)
    return np.asarray(response[:, np.newaxis] * record.back[:, np.newaxis] ** lost, np.complex128)


def _struck(record: SampledRecord, dynamics: PoleSet, coefficients: Real) -> Complex:
    """Return the spectrum of the output of a unit input at the first sample."""
    driven = _RecordModel(record.struck(), dynamics).driven
    return np.asarray(driven @ coefficients[: driven.shape[1]], np.complex128)


def _gain(record: SampledRecord, dynamics: PoleSet, coefficients: Real) -> Real | float:
    """Return by how much errors of an input of few bits grow on each line; 0 for an input of many."""
    if not record.rounding:
        return 0.0
    return np.asarray(np.sqrt(record.size) * np.abs(_struck(record, dynamics, coefficients)), np.float64)


def _values(record: SampledRecord) -> int:
    """Return how many numbers a record contributes: two a line, less those that were lost."""
    free = 0 if record.lost is None else record.lost.shape[1]
    lost = (
        0 if record.measured is None else int(np.sum(~record.measured) * record.omega.size * 2 / record.size)
    )
    return 2 * record.omega.size - lost - free


def _own_terms(record: SampledRecord, dynamics: PoleSet) -> int:
    """Return how many linear terms a record has for itself, without its offset."""
    terms = 2 * dynamics.lines.size + (dynamics.has_drift and not dynamics.integrators)
    if record.input is None:
        return terms + dynamics.order
    return terms + (0 if record.is_at_rest else dynamics.order + 1)


def _without(basis: Real, values: Real) -> Real:
    """Return values without what orthonormal columns span."""
    return np.asarray(values - basis @ (basis.T @ values), np.float64)


def _solved(records: tuple[SampledRecord, ...], dynamics: PoleSet) -> Solved:
    parts = tuple(_RecordModel(record, dynamics) for record in records)
    columns = _columns(parts)
    target = np.concatenate([record.weighted(record.output_lines) for record in records])
    coefficients, basis, residual = solved_real(columns, target)
    column = shared = parts[0].driven.shape[1]
    errors = []
    for part in parts:
        width = part.own.shape[1]
        model = part.model(coefficients[:shared], coefficients[column : column + width])
        errors.append(part.record.output_lines - model)
        column += width
    return Solved(residual, tuple(errors), coefficients, basis, columns, parts)


def left_by_prediction(record: SampledRecord, dynamics: PoleSet, coefficients: Real) -> Complex:
    """Return what a plant of other records leaves of one; all that is not the plant's is fitted."""
    part = _RecordModel(record, dynamics)
    columns = part.own
    if (by_lost := _by_lost(record, dynamics, coefficients)) is not None:
        columns = np.hstack((columns, by_lost))
    rest = record.output_lines - part.driven @ coefficients[: part.driven.shape[1]]
    of_record, _, _ = solved_real(record.weighted(columns), record.weighted(rest))
    return np.asarray(rest - columns @ of_record, np.complex128)


def _columns(parts: Sequence[_RecordModel]) -> Real:
    """Return the weighted columns of an output: those of the plant, then those of each record."""
    driven = [part.record.weighted(part.driven) for part in parts]
    own = [part.record.weighted(part.own) for part in parts]
    return np.hstack((np.concatenate(driven), block_diag(*own)))


def solved_real(columns: Real, target: Real) -> tuple[Real, Real, Real]:
    """Return coefficients of least squares, an orthonormal basis of the columns, and what is left."""
    if not columns.shape[1]:
        return np.zeros(0), columns, target
    norms = np.linalg.norm(columns, axis=0) + np.finfo(float).tiny
    basis, upper = qr(columns / norms, mode="economic")
    lost = np.flatnonzero(np.abs(np.diag(upper)) < DEPENDENT)
    upper[lost, lost] = PINNED
    right = basis.T @ target
    return np.linalg.solve(upper, right) / norms, basis, target - basis @ right


class _RecordModel:
    """The linear terms of one record, and the derivatives of their sum."""

    def __init__(self, record: SampledRecord, dynamics: PoleSet) -> None:
        self.record, self.dynamics = record, dynamics
        poles = dynamics.poles
        self.above = [record.pole(p, dynamics.delay_s) for p in poles]
        n = dynamics.omega.size
        self.below = [record.pole(p.conjugate(), dynamics.delay_s) for p in poles[:n]]
        self.at_zero = record.pole(0.0, dynamics.delay_s) if dynamics.integrators else None
        self.sines = [(record.pole(1j * w), record.pole(-1j * w)) for w in dynamics.lines]
        self.n = n
        self.is_driven = record.input is not None
        self.has_free = not (self.is_driven and record.is_at_rest)

    def _pairs(self, name: str) -> list[Complex]:
        """Return, of a part of each pole, the columns of its real and imaginary coefficient."""
        columns = []
        for i, one in enumerate(self.above):
            a = getattr(one, name)
            if i < self.n:
                b = getattr(self.below[i], name)
                columns += [a + b, 1j * (a - b)]
            else:
                columns.append(a)
        return columns

    @cached_property
    def driven(self) -> Complex:
        """The columns of residues, poles at zero and the feedthrough."""
        if not self.is_driven:
            return self._stacked([])
        columns = self._pairs("driven")
        if self.at_zero is not None:
            both = [self.at_zero.driven, self.at_zero.driven_by_pole]
            columns += both[: self.dynamics.integrators]
        if self.dynamics.has_direct:
            columns.append(self.record.direct(self.dynamics.delay_s)[0])
        return self._stacked(columns)

    @cached_property
    def own(self) -> Complex:
        """The columns of what a record begins with, and of what disturbs it."""
        record, columns = self.record, []
        if self.has_free:
            columns += self._pairs("free")
            if self.at_zero is not None:
                columns += [self.at_zero.free, self.at_zero.free_by_pole][: self.dynamics.integrators]
            if self.is_driven:
                columns.append(record.at_first_sample())
        if self.dynamics.has_drift and not (self.dynamics.integrators and self.has_free):
            columns.append(record.drift())
        for above, below in self.sines:
            columns += [above.free + below.free, 1j * (above.free - below.free)]
        return self._stacked(columns)

    def _stacked(self, columns: list[Complex]) -> Complex:
        if not columns:
            return np.zeros((self.record.omega.size, 0), np.complex128)
        return np.stack(columns, axis=1)

    def model(self, of_plant: Real, of_record: Real) -> Complex:
        """Return the spectrum of the sum."""
        return np.asarray(self.driven @ of_plant + self.own @ of_record, np.complex128)

    def slopes(self, of_plant: Real, of_record: Real, step_s: float, length_s: float) -> Complex:
        """Return the derivatives of the sum by the parameters of a search."""
        dynamics, n = self.dynamics, self.n
        poles = dynamics.poles
        zeta, upper = dynamics.zeta, poles[:n]
        by_zeta = -dynamics.omega * (1 + 1j * zeta / np.sqrt(1 - zeta**2))
        residues = _complex(of_plant, n, poles.size) if self.is_driven else np.zeros(poles.size)
        decays = _complex(of_record, n, poles.size) if self.has_free else np.zeros(poles.size)
        by_pole, by_mirror = [], []
        for i, one in enumerate(self.above):
            a, r, c = one, residues[i], decays[i]
            by_pole.append((r * a.driven_by_pole if self.is_driven else 0) + c * a.free_by_pole)
            if i < n:
                b, r, c = self.below[i], np.conj(r), np.conj(c)
                by_mirror.append((r * b.driven_by_pole if self.is_driven else 0) + c * b.free_by_pole)
        columns = [
            q[i] * by_pole[i] + np.conj(q[i]) * by_mirror[i] for q in (upper, by_zeta) for i in range(n)
        ]
        columns += [-corner * by_pole[n + i] for i, corner in enumerate(dynamics.real)]
        first = of_record.size - 2 * dynamics.lines.size
        for k, (above, below) in enumerate(self.sines):
            c = complex(of_record[first + 2 * k], of_record[first + 2 * k + 1])
            by_line = 1j * c * above.free_by_pole - 1j * np.conj(c) * below.free_by_pole
            columns.append(by_line / length_s)
        if dynamics.is_delay_free:
            columns.append(step_s * self._by_delay(of_plant, residues))
        return self._stacked(columns)

    def _by_delay(self, of_plant: Real, residues: Complex | Real) -> Complex:
        total = np.zeros(self.record.omega.size, np.complex128)
        if not self.is_driven:
            return total
        for i, one in enumerate(self.above):
            total = total + residues[i] * one.driven_by_delay
            if i < self.n:
                total = total + np.conj(residues[i]) * self.below[i].driven_by_delay
        if self.at_zero is not None:
            at = self.n + len(self.above)
            total = total + of_plant[at] * self.at_zero.driven_by_delay
        if self.dynamics.has_direct:
            total = total + of_plant[-1] * self.record.direct(self.dynamics.delay_s)[1]
        return np.asarray(total, np.complex128)


def _complex(coefficients: Real, pairs: int, poles: int) -> Complex:
    """Return the complex coefficient of each pole, of pairs the upper one."""
    of_pairs = coefficients[: 2 * pairs].reshape(pairs, 2)
    return np.concatenate((of_pairs @ [1, 1j], coefficients[2 * pairs : pairs + poles])).astype(np.complex128)

"""State equations between samples: what a computer that holds its output from one to the next steps through.

Input: the matrices of ``w' = A w + B u(t - T)`` in balls, a sampling time h, a delay T.
Output: a :class:`SampledStateSpace`, ``w[k+1] = F w[k] + G u[k]`` with every entry rounded once.

Between samples u is constant, so the step is a matrix exponential and nothing is approximated:

    exp [A B; 0 0] h  =  [F G; 0 1]

A delay ``T = (n - m) h``, 0 <= m < 1, makes the input change m samples before the end of a step: what
comes after that instant acts with the newer of two past inputs, what comes before with the older, and past
inputs are states (Astrom and Wittenmark 1997, Computer-Controlled Systems, section 2.3).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil
from typing import TYPE_CHECKING

import numpy as np
from flint import arb, arb_mat

from symflex.balls import ball, precision, precisions
from symflex.errors import Diagnostic, ModelError, no_such, refused
from symflex.errors.optional import installed
from symflex.model.model import PI_NEARLY, ExactValue
from symflex.options import Stated, duration, finite, frequency
from symflex.state_space.numeric import Arrays, Matrices, rounding_of
from symflex.state_space.realise import StateSpace

if TYPE_CHECKING:
    import numpy.typing as npt

Balls = Callable[[int], tuple[arb_mat, ...]]  # a, B, C and D in balls of so many bits
FIRST_BITS, LAST_BITS = 192, 6144
NOTHING_BITS = 150  # an entry so many bits below the largest counts as zero if its sign cannot be decided
MOST_SAMPLES = 1000  # largest delay in samples: it takes as many states
METHODS = ("zoh", "tustin", "matched")  # zero-order hold, bilinear, and roots matched, of one function


@dataclass(frozen=True, slots=True)
class Sampling:
    """How a system is seen, or computed, from sample to sample.

    Raises
    ------
    UsageError
        SF902 for an unknown method, a sampling time that is not positive, a frequency to prewarp at that is
        not below half of the sampling frequency, or is not for ``tustin``.
    """

    sample: Fraction  # the sampling time [s]
    method: str = "zoh"  # one of :data:`METHODS`
    # Of ``tustin``: the angular frequency [rad/s] at which the value is that of the continuous system.
    prewarp: ExactValue | None = None

    def __post_init__(self) -> None:
        if self.method not in METHODS:
            raise no_such("sampling method", self.method, METHODS, "methods")
        if not self.sample > 0:
            raise refused("a sampling time must be positive")
        if self.prewarp is None:
            return
        if self.method != "tustin":
            raise refused(f"prewarping applies to 'tustin', not to '{self.method}'")
        if not 0 < self.prewarp.nearly * self.sample < PI_NEARLY:
            message = "the prewarping frequency must be positive and below half of the sampling frequency"
            raise refused(message, f"that is {1 / (2 * float(self.sample)):g} Hz")

    @property
    def seconds(self) -> arb:
        """The sampling time [s] at the current precision."""
        return ball(self.sample)

    @property
    def rate(self) -> arb:
        """The k of ``s = k (z - 1)/(z + 1)`` [1/s] at the current precision."""
        if self.prewarp is None:
            return 2 / ball(self.sample)
        omega = ball(self.prewarp.rational) * arb.pi() ** self.prewarp.pi_power
        return omega / (omega * self.seconds / 2).tan()

    def check_delay(self, delay: Fraction) -> None:
        """Refuse a delay [s] that is negative, or takes too many states, with SF902."""
        if not 0 <= delay <= MOST_SAMPLES * self.sample:
            raise refused(f"a delay has from 0 to {MOST_SAMPLES} samples")
        if self.method != "zoh" and (delay / self.sample).denominator != 1:
            message = f"'{self.method}' cannot represent a delay of {float(delay / self.sample):.6g} samples"
            raise refused(message, "use zoh, or a sampling time that divides it")


def sampling_of(
    sample: Stated, method: str | None = None, prewarp: Stated | None = None, flag: str = "--sample"
) -> Sampling:
    """Return how a system is sampled, from a time [s] and a frequency [Hz], with units or without; SF902.

    >>> sampling_of("2 ms", "tustin").sample
    Fraction(1, 500)
    """
    time = duration(sample, flag) if isinstance(sample, str) else finite(sample, flag)
    if prewarp is None:
        return Sampling(time, method or "zoh")
    hertz = frequency(prewarp, "--prewarp", "10 or '0.1 kHz'", is_hertz=True)
    return Sampling(time, method or "zoh", ExactValue(2 * hertz, 1))


@dataclass(frozen=True, eq=False)
class SampledStateSpace(Matrices):
    """``w[k+1] = A w[k] + B u[k]``, ``y[k] = C w[k] + D u[k]`` in doubles, one step per sampling time.

    The input is held from one sample to the next; the states are those of the continuous system and then,
    with a delay, past inputs, the oldest first.
    """

    arrays: Arrays
    sampling: Sampling
    delay: Fraction  # the delay of all inputs [s]
    # names: of the states, inputs and outputs
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]

    @property
    def dt(self) -> float:
        """The sampling time [s]."""
        return float(self.sampling.sample)

    def __repr__(self) -> str:
        shape = f"{len(self.states)} states, {len(self.inputs)} inputs, {len(self.outputs)} outputs"
        return f"<SampledStateSpace every {self.dt:g} s: {shape}>"

    def to_control(self) -> object:
        """Return a discrete ``control.StateSpace`` with names; SF902 when python-control is not installed."""
        return installed("control").StateSpace(
            *(m.copy() for m in (self.A, self.B, self.C, self.D)),
            self.dt,
            inputs=list(self.inputs),
            outputs=list(self.outputs),
            states=list(self.states),
            remove_useless_states=False,
        )

    def to_scipy(self) -> object:
        """Return a discrete ``scipy.signal.StateSpace``; SF902 when scipy is not installed."""
        matrices = (m.copy() for m in (self.A, self.B, self.C, self.D))
        return installed("scipy.signal").StateSpace(*matrices, dt=self.dt)


def sampled_state_space(
    system: StateSpace, values: Mapping[str, ExactValue], sampling: Sampling, delay: Fraction = Fraction(0)
) -> SampledStateSpace:
    """Return an exact realisation with numbers, as it is seen at samples; errors as of :func:`sampled`."""
    rounding = rounding_of(system, values)

    def balls(bits: int) -> tuple[arb_mat, ...]:
        matrices = []
        for _, rows, (height, width) in system.matrices:
            matrix = arb_mat(height, width)
            for i, row in enumerate(rows):
                for j, value in row.items():
                    matrix[i, j] = rounding.enclosed(value, bits)
            matrices.append(matrix)
        return tuple(matrices)

    groups = (system.states, system.inputs, system.outputs)
    states, inputs, outputs = (tuple(x.name for x in group) for group in groups)
    return sampled(balls, sampling, delay, (states, inputs, outputs))


def sampled(
    balls: Balls,
    sampling: Sampling,
    delay: Fraction,
    names: tuple[Sequence[str], Sequence[str], Sequence[str]],
) -> SampledStateSpace:
    """Return the system as it is seen at samples, the input held between them, or as tustin computes it.

    ``names`` are those of states, inputs and outputs, in this order.
    """
    sampling.check_delay(delay)
    if sampling.method == "matched":
        message = "'matched' applies to one transfer function, not to state equations"
        raise refused(message, "use tustin, or export code with --to c or numpy")
    states, inputs, outputs = names
    whole = ceil(delay / sampling.sample)
    stepped = _stepped if sampling.method == "zoh" else _bilinear
    for bits in precisions(FIRST_BITS, LAST_BITS):
        with precision(bits):
            doubles = [_doubles(m) for m in stepped(balls(bits), sampling, delay, whole)]
        held = [array for array in doubles if array is not None]
        if len(held) == len(doubles):
            past = [f"{name}_{i}_before" for i in range(whole, 0, -1) for name in inputs]
            arrays = Arrays(held[0], held[1], held[2], held[3])
            every = (*states, *past)
            return SampledStateSpace(arrays, sampling, delay, every, tuple(inputs), tuple(outputs))
    message = "an entry of the sampled state equations does not fit in double precision"
    raise ModelError(Diagnostic("SF233", message, None, "choose a shorter sampling time"))


def _stepped(
    matrices: tuple[arb_mat, ...], sampling: Sampling, delay: Fraction, whole: int
) -> tuple[arb_mat, arb_mat, arb_mat, arb_mat]:
    """Return the matrices of one step, towards whose end the input changes."""
    a, b, c, d = matrices
    ahead = whole * sampling.sample - delay
    grown, newer = _held(a, b, ball(ahead))
    before, older = _held(a, b, ball(sampling.sample - ahead))
    return _with_past_inputs(grown * before, grown * older, newer, c, d, whole)


def _bilinear(
    matrices: tuple[arb_mat, ...], sampling: Sampling, delay: Fraction, whole: int
) -> tuple[arb_mat, arb_mat, arb_mat, arb_mat]:
    """Return the matrices that ``s = k (z - 1)/(z + 1)`` makes of others, late by whole samples."""
    del delay
    a, b, c, d = matrices
    n, k = a.nrows(), sampling.rate
    try:
        inverse = (arb_mat(n, n, k) - a).inv()
    except ZeroDivisionError:
        message = f"a pole at {float(k):g} rad/s, or one very near, is taken to infinity by tustin"
        raise refused(message, "choose another sampling time") from None
    given = inverse * b * 2
    step = inverse * (arb_mat(n, n, k) + a)
    return _with_past_inputs(step, given, given * 0, c * inverse * k, d + c * given * arb(0.5), whole)


def _with_past_inputs(
    step: arb_mat, older: arb_mat, newer: arb_mat, c: arb_mat, d: arb_mat, whole: int
) -> tuple[arb_mat, arb_mat, arb_mat, arb_mat]:
    """Return matrices with past inputs as states after the others, u[k - whole] to u[k - 1]."""
    n, m, p = older.nrows(), older.ncols(), c.nrows()
    if not whole:
        return step, older + newer if n else newer, c, d
    # Columns are those of states and of u[k - whole] to u[k], which move on by one sample.
    above = [step, older, newer, arb_mat(n, (whole - 1) * m)]
    every = _joined(above, [arb_mat(whole * m, n + m), arb_mat(whole * m, whole * m, 1)])
    size = n + whole * m
    shown = _joined([c, d, arb_mat(p, (whole - 1) * m)])
    return _columns(every, size, 0, size), _columns(every, size, size, size + m), shown, arb_mat(p, m)


def _held(a: arb_mat, b: arb_mat, time: arb) -> tuple[arb_mat, arb_mat]:
    """Return ``exp(A t)``, and the integral of that times B from 0 to t."""
    n, m = a.nrows(), b.ncols()
    grown = (_joined([a, b], [arb_mat(m, n + m)]) * time).exp()
    return _columns(grown, n, 0, n), _columns(grown, n, n, n + m)


def _joined(*rows: Sequence[arb_mat]) -> arb_mat:
    """Return a matrix of blocks."""
    entries = [b[i, j] for row in rows for i in range(row[0].nrows()) for b in row for j in range(b.ncols())]
    return arb_mat(sum(row[0].nrows() for row in rows), sum(b.ncols() for b in rows[0]), entries)


def _columns(matrix: arb_mat, height: int, first: int, end: int) -> arb_mat:
    """Return some columns of the first rows of a matrix."""
    return arb_mat(height, end - first, [matrix[i, j] for i in range(height) for j in range(first, end)])


def _doubles(matrix: arb_mat) -> npt.NDArray[np.float64] | None:
    """Return the nearest double of every entry; None if more precision is needed, or nothing fits."""
    rows, columns = matrix.nrows(), matrix.ncols()
    doubles = np.zeros((rows, columns))
    entries = [(i, j, matrix[i, j]) for i in range(rows) for j in range(columns)]
    largest = max((x.abs_upper() for _, _, x in entries), default=arb(0))
    nothing = largest * arb(2) ** -NOTHING_BITS
    for i, j, x in entries:
        low, high = float(x.lower()), float(x.upper())
        if low != high:
            if not x.abs_upper() < nothing:
                return None
            low = 0.0
        if not np.isfinite(low):
            return None
        doubles[i, j] = low
    return doubles

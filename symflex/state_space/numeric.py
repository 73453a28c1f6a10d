"""State equations with numbers, ready for simulation and control design: every entry the nearest double.

Input: a :class:`StateSpace`, and values for the parameters that are left in it; or poles and zeros, both
members of conjugate pairs, and a gain. Output: :class:`Arrays`, each entry rounded once.

Poles and zeros become sections of second order in series: the poles of a triangular matrix are those of its
diagonal blocks, so each stands on its own two entries, and none is lost among coefficients of high degree.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import inf, isfinite
from sys import float_info
from typing import TYPE_CHECKING

import mpmath
import numpy as np
from flint import acb, acb_mat, arb, ctx, fmpz_mpoly

from symflex.errors import Diagnostic, ModelError, UncertifiedError
from symflex.errors.optional import installed
from symflex.expressions import format_expression
from symflex.transfer.balls import enclosure, later, value_at

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import numpy.typing as npt
    from numpy import float64

    from symflex.model import ExactValue
    from symflex.state_space.popov import FieldElement
    from symflex.state_space.realise import Channel, StateSpace


@dataclass(frozen=True, slots=True)
class BoundState:
    """One state."""

    name: str  # letters, digits and underscores
    # The quantities of the model that it is a sum of, with their coefficients; empty when it is not one.
    terms: tuple[tuple[str, float], ...]
    unit: str  # SI unit, empty when unknown


@dataclass(frozen=True, slots=True, eq=False)
class BoundStateSpace:
    """``w' = A w + B u``, ``y = C w + D u`` in doubles; every entry is the nearest to the exact one."""

    name: str  # what programs for control design call it: letters, digits and underscores
    arrays: Arrays  # the matrices
    states: tuple[BoundState, ...]  # what the states are
    # inputs and outputs: their names and units.
    inputs: tuple[Channel, ...]
    outputs: tuple[Channel, ...]
    is_minimal: bool  # every state is controllable and observable

    @property
    def A(self) -> npt.NDArray[float64]:  # noqa: N802
        """Array of shape (n, n), read-only."""
        return self.arrays.a

    @property
    def B(self) -> npt.NDArray[float64]:  # noqa: N802
        """Array of shape (n, inputs), read-only."""
        return self.arrays.b

    @property
    def C(self) -> npt.NDArray[float64]:  # noqa: N802
        """Array of shape (outputs, n), read-only."""
        return self.arrays.c

    @property
    def D(self) -> npt.NDArray[float64]:  # noqa: N802
        """Array of shape (outputs, inputs), read-only."""
        return self.arrays.d

    @property
    def metadata(self) -> dict[str, object]:
        """Units of inputs, outputs and states by name, for an object that cannot hold them itself."""
        return {
            "input_units": {x.name: x.unit for x in self.inputs},
            "output_units": {x.name: x.unit for x in self.outputs},
            "state_units": {x.name: x.unit for x in self.states},
            "minimal": self.is_minimal,
        }

    def __repr__(self) -> str:
        shape = f"{len(self.states)} states, {len(self.inputs)} inputs, {len(self.outputs)} outputs"
        return f"<BoundStateSpace {self.name}: {shape}>"

    def to_control(self, facts: Mapping[str, object] | None = None) -> object:
        """Return a ``control.StateSpace`` with names; units and ``facts`` are in its attribute ``metadata``.

        SF902 when python-control is not installed.
        """
        control = installed("control")
        system = control.StateSpace(
            *(m.copy() for m in (self.A, self.B, self.C, self.D)),
            0,
            name=self.name,
            inputs=[x.name for x in self.inputs],
            outputs=[x.name for x in self.outputs],
            states=[x.name for x in self.states],
            remove_useless_states=False,
        )
        system.metadata = {**self.metadata, **(facts or {})}
        return system

    def to_scipy(self, facts: Mapping[str, object] | None = None) -> object:
        """Return a ``scipy.signal.StateSpace``; names, units and ``facts`` are in its attribute ``metadata``.

        SF902 when scipy is not installed.
        """
        system = installed("scipy.signal").StateSpace(*(m.copy() for m in (self.A, self.B, self.C, self.D)))
        system.metadata = {"name": self.name, **self.metadata, **(facts or {})}
        return system


def bound_state_space(system: StateSpace, values: Mapping[str, ExactValue] | None = None) -> BoundStateSpace:
    """Return a realisation in double precision, given values of what is left in it; errors as ``rounded``."""
    rounding = rounding_of(system, values)
    states = tuple(
        BoundState(
            state.name,
            tuple(
                (format_expression(quantity), rounding.nearest(value, f"a part of state '{state.name}'"))
                for quantity, value in state.terms
            ),
            state.unit,
        )
        for state in system.states
    )
    name = f"{'_'.join(x.name for x in system.outputs)}_over_{'_'.join(x.name for x in system.inputs)}"
    return BoundStateSpace(
        name, rounded(system, values), states, system.inputs, system.outputs, system.is_minimal
    )


FIRST_BITS, LAST_BITS = 128, 4096
RESPONSE_BITS = 192


@dataclass(frozen=True, slots=True, eq=False)
class Arrays:
    """The matrices of state equations in double precision."""

    # a, b, c and d: shapes (n, n), (n, m), (p, n), (p, m) for n states, m inputs, p outputs. Read-only.
    a: npt.NDArray[np.float64]
    b: npt.NDArray[np.float64]
    c: npt.NDArray[np.float64]
    d: npt.NDArray[np.float64]

    def __post_init__(self) -> None:
        for array in (self.a, self.b, self.c, self.d):
            array.setflags(write=False)


def rounded(system: StateSpace, values: Mapping[str, ExactValue] | None = None) -> Arrays:
    """Return the matrices with every entry the double nearest to its exact value.

    SF229 for a parameter without value, SF231 when these values divide by zero, SF233 when an entry is too
    large or too small for double precision, SF401 when it cannot be told whether an entry is zero.
    """
    rounding = rounding_of(system, values)
    arrays = []
    for letter, rows, shape in system.matrices:
        array = np.zeros(shape)
        for i, row in enumerate(rows):
            for j, value in row.items():
                what = f"entry {letter}[{i + 1}, {j + 1}] of the state equations"
                array[i, j] = rounding.nearest(value, what)
        arrays.append(array)
    return Arrays(*arrays)


def rounding_of(system: StateSpace, values: Mapping[str, ExactValue] | None = None) -> Rounding:
    """Return what rounds the entries of a realisation."""
    known = values or {}
    given = {name: enclosure(value) for name, value in known.items()}
    constants = {c.generator: later(c.expression, given) for c in system.constants}
    exact = {name: v.rational for name, v in known.items() if not v.pi_power}
    return Rounding(system.ring.names, {"pi": arb.pi, **given, **constants}, exact)


class Rounding:
    """Rounds quotients of polynomials to the nearest double.

    ``names`` are the ring's generators; ``constants`` enclose a generator at the current precision, and
    ``exact`` are those that are rational.
    """

    def __init__(
        self,
        names: Sequence[str],
        constants: Mapping[str, Callable[[], arb]],
        exact: Mapping[str, Fraction] | None = None,
    ) -> None:
        self._names = names
        self._constants = constants
        self._exact = exact or {}
        self._balls: dict[int, dict[str, arb]] = {}

    def nearest(self, value: FieldElement, what: str) -> float:
        """Return the nearest double; ``what`` is its name in messages. Errors as of :func:`rounded`."""
        exact = self._rational(value)
        found = self._of_ball(value, what) if exact is None else _float(exact)
        if found == exact:
            return found
        if not isfinite(found) or abs(found) < float_info.min:
            size = "large" if abs(found) > 1 else "small"
            message = f"{what} is too {size} for double precision"
            hint = "choose units in which values lie nearer to 1, such as mm and t"
            raise ModelError(Diagnostic("SF233", message, None, hint))
        return found

    def _rational(self, value: FieldElement) -> Fraction | None:
        above, below = (self._exact_value(part) for part in (value.num, value.den))
        if above is None or below is None:
            return None
        if not below:
            raise _zero_denominator()
        return above / below

    def _exact_value(self, polynomial: fmpz_mpoly) -> Fraction | None:
        degrees = zip(self._names, polynomial.degrees(), strict=True)
        if any(degree > 0 and name not in self._exact for name, degree in degrees):
            return None
        return value_at(polynomial, lambda i: self._exact[self._names[i]], Fraction)

    def _of_ball(self, value: FieldElement, what: str) -> float:
        bits = FIRST_BITS
        while bits <= LAST_BITS:
            with ctx.workprec(bits):
                below = self._enclosed(value.den, bits)
                if not below.contains(0):
                    quotient = self._enclosed(value.num, bits) / below
                    low, high = float(quotient.lower()), float(quotient.upper())
                    if low == high:
                        return low
            bits *= 2
        message = f"it cannot be told whether {what} is zero"
        raise UncertifiedError(Diagnostic("SF401", message))

    def _enclosed(self, polynomial: fmpz_mpoly, bits: int) -> arb:
        known = self._balls.setdefault(bits, {})

        def value(i: int) -> arb:
            name = self._names[i]
            if name not in known:
                known[name] = self._constant(name)
            return known[name]

        return value_at(polynomial, value, arb)

    def _constant(self, name: str) -> arb:
        if name not in self._constants:
            raise ModelError(Diagnostic("SF229", f"parameter '{name}' has no value"))
        return self._constants[name]()


def _float(value: Fraction) -> float:
    try:
        return float(value)
    except OverflowError:
        return inf if value > 0 else -inf


def _zero_denominator() -> ModelError:
    message = "the state equations divide by zero for these values"
    hint = "a rigid or massless limit has its own equations: bind() first, then state_space()"
    return ModelError(Diagnostic("SF231", message, None, hint))


def response(arrays: Arrays, points: Sequence[complex]) -> list[tuple[tuple[complex, ...], ...]]:
    """Return ``C (s - A)^-1 B + D`` at each s [rad/s], per output a row; not a number at poles.

    The matrices count as exact, and what is computed with them is enclosed and then rounded.
    """
    with ctx.workprec(RESPONSE_BITS):
        a, b, c, d = (_acb_matrix(array) for array in (arrays.a, arrays.b, arrays.c, arrays.d))
        n = len(arrays.a)
        found = []
        for s in points:
            value = d
            if n:
                shifted = (
                    acb_mat(n, n, [acb(s) if i == j else acb(0) for i in range(n) for j in range(n)]) - a
                )
                try:
                    value = d + c * shifted.solve(b)
                except ZeroDivisionError:
                    value = d * acb("nan")
            rows = value.tolist()
            found.append(tuple(tuple(complex(x.mid()) for x in row) for row in rows))
        return found


def _acb_matrix(array: npt.NDArray[np.float64]) -> acb_mat:
    rows, columns = array.shape
    return acb_mat(rows, columns, [acb(float(x)) for x in array.ravel()])


BITS = 256
PAIR = 2


@dataclass(frozen=True, slots=True)
class _Section:
    """``factor*(s - z).../(s^2 + d_1 s + d_0)``, or the same of first order; ascending coefficients.

    The factor makes it of the order of 1 near its natural frequency.
    """

    num: tuple[mpmath.mpf, ...]
    den: tuple[mpmath.mpf, ...]
    factor: mpmath.mpf

    @property
    def order(self) -> int:
        return len(self.den)

    @property
    def direct(self) -> mpmath.mpf:
        return self.num[self.order]

    @property
    def scale(self) -> mpmath.mpf:
        """The natural frequency [rad/s], 1 at 0: states of a section have one unit then."""
        return _size(self.den) or mpmath.mpf(1)

    def matrix(self) -> list[list[mpmath.mpf]]:
        if self.order == 1:
            return [[-self.den[0]]]
        return [[mpmath.mpf(0), self.scale], [-self.den[0] / self.scale, -self.den[1]]]

    def output(self) -> list[mpmath.mpf]:
        left = [self.num[i] - self.direct * self.den[i] for i in range(self.order)]
        return left if self.order < PAIR else [left[0] / self.scale, left[1]]


def cascade(zeros: Sequence[mpmath.mpc], poles: Sequence[mpmath.mpc], gain: mpmath.mpf, name: str) -> Arrays:
    """Return the state equations of ``gain*prod(s - z)/prod(s - p)``; messages call it ``name``.

    Roots [rad/s] come as often as their multiplicity says, conjugates of each other or real. SF236 when there
    are more zeros than poles, SF233 when a number does not fit in double precision.

    Examples
    --------
    >>> made = cascade([], [mpmath.mpc(0, 2), mpmath.mpc(0, -2)], mpmath.mpf(8), "8/(s^2 + 4)")
    >>> made.a.tolist(), made.b.tolist(), made.c.tolist()
    ([[0.0, 2.0], [-2.0, 0.0]], [[0.0], [1.0]], [[4.0, 0.0]])
    """
    if len(zeros) > len(poles):
        message = f"{name} has more zeros than poles: no state equations have its output"
        raise ModelError(Diagnostic("SF236", message, None, "take an output with fewer derivatives"))
    with mpmath.workprec(BITS):
        sections = _sections(zeros, poles)
        n = sum(section.order for section in sections)
        a, b, c = mpmath.zeros(n), mpmath.zeros(n, 1), mpmath.zeros(1, n)
        # What reaches the section at hand: a combination of earlier states, and of the input.
        carried, direct, start = [mpmath.mpf(0)] * n, mpmath.mpf(1), 0
        for section in sections:
            last = start + section.order - 1
            for j, value in enumerate(carried):
                a[last, j] = value
            for i, row in enumerate(section.matrix()):
                for j, value in enumerate(row):
                    a[start + i, start + j] = value
            b[last, 0] = direct
            carried = [value * section.direct for value in carried]
            for j, value in enumerate(section.output()):
                carried[start + j] = value
            direct = direct * section.direct
            start += section.order
        gain = gain / mpmath.fprod(section.factor for section in sections)
        for j, value in enumerate(carried):
            c[0, j] = gain * value
        matrices = ((a, (n, n)), (b, (n, 1)), (c, (1, n)), (mpmath.matrix([[gain * direct]]), (1, 1)))
        return Arrays(*(_doubles(matrix, shape, name) for matrix, shape in matrices))


def _doubles(matrix: mpmath.matrix, shape: tuple[int, int], name: str) -> np.ndarray:
    array = np.array([[float(matrix[i, j]) for j in range(shape[1])] for i in range(shape[0])], dtype=float)
    if not np.isfinite(array).all():
        message = f"the state equations of {name} do not fit in double precision"
        hint = "choose units in which values lie nearer to 1, or take fewer modes"
        raise ModelError(Diagnostic("SF233", message, None, hint))
    return array.reshape(shape)


def _sections(zeros: Sequence[mpmath.mpc], poles: Sequence[mpmath.mpc]) -> list[_Section]:
    """Return a section per pair of poles, with zeros of like frequency, by frequency."""
    below, single_pole = _pairs(poles)
    above, single_zero = _pairs(zeros)
    free = list(range(len(below)))
    numerators: list[tuple[mpmath.mpf, ...]] = [()] * len(below)
    for pair in above:
        nearest = min(free, key=lambda i: abs(_size(below[i]) - _size(pair)))
        free.remove(nearest)
        numerators[nearest] = pair
    if single_zero and not single_pole:
        numerators[free[0]] = single_zero
        single_zero = ()
    sections = [_section(num, den) for num, den in zip(numerators, below, strict=True)]
    return [*sections, _section(single_zero, single_pole)] if single_pole else sections


def _section(num: tuple[mpmath.mpf, ...], den: tuple[mpmath.mpf, ...]) -> _Section:
    """Return a section of monic polynomials given without their leading coefficient."""
    factor = (_size(den) or mpmath.mpf(1)) ** (len(den) - len(num))
    whole = [factor * value for value in (*num, mpmath.mpf(1))]
    whole += [mpmath.mpf(0)] * (len(den) + 1 - len(whole))
    return _Section(tuple(whole), den, factor)


def _pairs(roots: Sequence[mpmath.mpc]) -> tuple[list[tuple[mpmath.mpf, ...]], tuple[mpmath.mpf, ...]]:
    """Return monic quadratics with the given roots by frequency, and what is left; ascending coefficients."""
    upper = [r for r in roots if r.imag > 0]
    real = sorted((r.real for r in roots if r.imag == 0), key=abs)
    pairs = [(r.real**2 + r.imag**2, -2 * r.real) for r in upper]
    pairs += [(p * q, -(p + q)) for p, q in zip(real[0::2], real[1::2], strict=False)]
    single = (-real[-1],) if len(real) % 2 else ()
    return sorted(pairs, key=_size), single


def _size(polynomial: tuple[mpmath.mpf, ...]) -> mpmath.mpf:
    """Return the natural frequency of a monic polynomial [rad/s]."""
    return abs(polynomial[0]) if len(polynomial) < PAIR else mpmath.sqrt(abs(polynomial[0]))

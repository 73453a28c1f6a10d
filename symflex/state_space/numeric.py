"""State equations with numbers, ready for simulation and control design: every entry the nearest double.

Input: a :class:`StateSpace`, and values for the parameters that are left in it.
Output: :class:`Arrays`, each entry rounded once.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import inf, isfinite
from sys import float_info
from typing import TYPE_CHECKING

import numpy as np
from flint import acb, acb_mat, arb, fmpz_mpoly
from numpy import float64

from symflex.balls import precision, precisions, value_at
from symflex.errors import Diagnostic, ModelError, UncertifiedError
from symflex.errors.optional import installed
from symflex.expressions import format_expression
from symflex.model import ExactValue
from symflex.state_space.popov import FieldElement
from symflex.state_space.realise import Channel, StateSpace
from symflex.transfer.enclose import enclosure, later

if TYPE_CHECKING:
    import numpy.typing as npt


@dataclass(frozen=True, slots=True)
class BoundState:
    """One state."""

    name: str  # letters, digits and underscores
    # The quantities of the model that it is a sum of, with their coefficients; empty when it is not one.
    terms: tuple[tuple[str, float], ...]
    unit: str  # SI unit, empty when unknown


class Matrices:
    """What has the matrices of state equations: A of shape (n, n), B (n, m), C (p, n), D (p, m)."""

    __slots__ = ()
    arrays: Arrays

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


@dataclass(frozen=True, slots=True, eq=False)
class BoundStateSpace(Matrices):
    """``w' = A w + B u``, ``y = C w + D u`` in doubles; every entry is the nearest to the exact one."""

    name: str  # what programs for control design call it: letters, digits and underscores
    arrays: Arrays  # the matrices
    states: tuple[BoundState, ...]  # what the states are
    # inputs and outputs: their names and units.
    inputs: tuple[Channel, ...]
    outputs: tuple[Channel, ...]
    is_minimal: bool  # every state is controllable and observable

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
    """Return the matrices with every entry the double nearest to its exact value."""
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
    given_values = values or {}
    given = {name: enclosure(value) for name, value in given_values.items()}
    constants = {c.generator: later(c.expression, given) for c in system.constants}
    exact = {name: v.rational for name, v in given_values.items() if not v.pi_power}
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
        rounded_value = self._of_ball(value, what) if exact is None else _float(exact)
        if rounded_value == exact:
            return rounded_value
        if not isfinite(rounded_value) or abs(rounded_value) < float_info.min:
            size = "large" if abs(rounded_value) > 1 else "small"
            message = f"{what} is too {size} for double precision"
            hint = "choose units in which values are closer to 1, such as mm and t"
            raise ModelError(Diagnostic("SF233", message, None, hint))
        return rounded_value

    def enclosed(self, value: FieldElement, bits: int) -> arb:
        """Return a ball around a quotient, at a precision that is to be the current one."""
        below = self._enclosed(value.den, bits)
        if below == 0:
            raise _zero_denominator()
        return self._enclosed(value.num, bits) / below

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
        for bits in precisions(FIRST_BITS, LAST_BITS):
            with precision(bits):
                below = self._enclosed(value.den, bits)
                if not below.contains(0):
                    quotient = self._enclosed(value.num, bits) / below
                    low, high = float(quotient.lower()), float(quotient.upper())
                    if low == high:
                        return low
        raise UncertifiedError(Diagnostic("SF401", f"it could not be decided whether {what} is zero"))

    def _enclosed(self, polynomial: fmpz_mpoly, bits: int) -> arb:
        balls = self._balls.setdefault(bits, {})

        def value(i: int) -> arb:
            name = self._names[i]
            if name not in balls:
                if name not in self._constants:
                    raise ModelError(Diagnostic("SF229", f"parameter '{name}' has no value"))
                balls[name] = self._constants[name]()
            return balls[name]

        return value_at(polynomial, value, arb)


def _float(value: Fraction) -> float:
    try:
        return float(value)
    except OverflowError:
        return inf if value > 0 else -inf


def _zero_denominator() -> ModelError:
    message = "the state equations divide by zero for these values"
    hint = "for a rigid or massless limit, call bind() first, then state_space()"
    return ModelError(Diagnostic("SF231", message, None, hint))


def response(arrays: Arrays, points: Sequence[complex]) -> list[tuple[tuple[complex, ...], ...]]:
    """Return ``C (s - A)^-1 B + D`` at each s [rad/s], per output a row; not a number at poles.

    The matrices count as exact, and what is computed with them is enclosed and then rounded.
    """
    with precision(RESPONSE_BITS):
        a, b, c, d = (
            acb_mat(array.shape[0], array.shape[1], array.astype(complex).ravel().tolist())
            for array in (arrays.a, arrays.b, arrays.c, arrays.d)
        )
        n = len(arrays.a)
        responses = []
        for s in points:
            value = d
            if n:
                try:
                    value = d + c * (acb_mat(n, n, acb(s)) - a).solve(b)
                except ZeroDivisionError:
                    value = d * acb("nan")
            responses.append(tuple(tuple(complex(x.mid()) for x in row) for row in value.tolist()))
        return responses

"""Transfer functions as straight-line programs: the exact representation that does not grow by expansion.

Input: a lumped model's equations, and which transfer functions are wanted.
Output: a :class:`NestedTransferFunction` each. Its numerator and denominator are nested expressions whose
shared parts exist once, so their size grows with the work of eliminating a sparse network: in proportion to
the length of a chain, ring, tree or ladder. They are evaluated in balls or in double precision as they are.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from flint import acb, arb, ctx

from symflex.algebra import LAPLACE
from symflex.algebra.straight_line import Operation, Step, StraightLine
from symflex.budget import spend
from symflex.errors import Diagnostic, ModelError
from symflex.expressions import Name, names
from symflex.transfer.balls import FIRST_BITS, ball, double_value, enclosure, later
from symflex.transfer.bind import values_for
from symflex.transfer.transfer_function import TransferFunction, name_quantity, unit_of_quotient

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from decimal import Decimal
    from fractions import Fraction

    import numpy as np
    import numpy.typing as npt

    from symflex.equations import ConstantFunction, Equations
    from symflex.model import ExactValue, Input, Model, ModelParameter, Output

CONSTANT_BITS = 256


@dataclass(frozen=True, eq=False)
class NestedTransferFunction:
    """``output = num/den * input``, a quotient of nested expressions.

    Neither need be a polynomial in s, and nothing is known about common factors: what would cancel, a hidden
    mode, is not looked for. As a function of s and the parameters the quotient is exact.
    """

    output: Output  # what is measured
    input: Input  # what drives
    program: StraightLine  # the steps; those of several functions of a model may share a program
    # num and den: steps of it.
    num: int
    den: int
    quantity: str  # ``receptance``, ``mobility``, ...
    unit: str  # SI unit, empty when unknown
    constants: tuple[ConstantFunction, ...]  # what generators such as ``sqrt(k*m)`` stand for
    model: Model  # where it comes from

    @property
    def name(self) -> str:
        """``OUT/IN``."""
        return f"{self.output.name}/{self.input.name}"

    @property
    def is_zero(self) -> bool:
        """True when the output does not depend on the input."""
        return self.num == 0

    @property
    def is_distributed(self) -> bool:
        """False: the nested form is of lumped models."""
        return False

    @property
    def is_nameless(self) -> bool:
        """False, as it holds no wavenumbers."""
        return False

    @cached_property
    def steps(self) -> tuple[int, ...]:
        """The steps numerator and denominator are made of, in order."""
        return tuple(self.program.steps_of(self.num, self.den))

    @cached_property
    def operations(self) -> tuple[Operation, ...]:
        """The steps with their operands, and with the steps that nothing needs after each."""
        program, kept = self.program, {self.num, self.den}
        found: list[Operation] = []
        for i in reversed(self.steps):
            gone = tuple(x for x in dict.fromkeys(program.inner(i)) if x not in kept)
            kept.update(gone)
            found.append((program.kinds[i], i, program.operands[i], gone))
        return tuple(reversed(found))

    @property
    def size(self) -> int:
        """The number of operations, shared ones counted once."""
        return self.program.size(self.num, self.den)

    @cached_property
    def generators(self) -> frozenset[str]:
        """The names of the generators that occur."""
        kinds, operands = self.program.kinds, self.program.operands
        return frozenset(self.program.names[operands[i][0]] for i in self.steps if kinds[i] == Step.GENERATOR)

    @cached_property
    def parameters(self) -> tuple[ModelParameter, ...]:
        """The parameters that occur, in declared order."""
        used = set(self.generators)
        for constant in self.constants:
            if constant.generator in used:
                used |= {n.name for n in names(constant.expression) if isinstance(n, Name)}
        return tuple(p for p in self.model.parameters if p.name in used)


AnyTransferFunction = TransferFunction | NestedTransferFunction
"""Either of the two exact representations."""


def derive_nested(
    equations: Equations, pairs: Sequence[tuple[str, str]]
) -> tuple[NestedTransferFunction, ...]:
    """Return transfer functions in nested form.

    Raises ModelError: SF30x when the equations are singular; SF910 for a distributed model.
    """
    model = equations.model
    if model.is_distributed:
        message = "the nested form of a model with beams, rods, fields or delays is not available yet"
        raise ModelError(Diagnostic("SF910", message, None, "leave the representation to the program"))
    from symflex.equations.elimination.star_mesh import eliminate  # few models are so large

    found = eliminate(equations, pairs)
    outputs, inputs = {o.name: o for o in model.outputs}, {i.name: i for i in model.inputs}
    known = dict(model.quotients)
    made = []
    for (output, source), (num, den) in zip(pairs, found.quotients, strict=True):
        ends = outputs[output], inputs[source]
        dimension = known.get((output, source))
        made.append(
            NestedTransferFunction(
                *ends,
                found.program,
                num,
                den,
                name_quantity(*ends, dimension),
                unit_of_quotient(*ends, dimension),
                equations.constants,
                model,
            )
        )
    return tuple(made)


@dataclass(frozen=True, eq=False)
class BoundNested:
    """A nested transfer function with numbers."""

    source: NestedTransferFunction  # the symbolic function
    values: tuple[tuple[str, ExactValue], ...]  # every parameter's value, in declared order

    @property
    def name(self) -> str:
        """``OUT/IN``."""
        return self.source.name

    @property
    def is_zero(self) -> bool:
        """True when the output does not depend on the input."""
        return self.source.is_zero

    @cached_property
    def _enclosures(self) -> dict[str, Callable[[], arb]]:
        """Per generator other than s, how to enclose it at the current precision."""
        values = {name: enclosure(value) for name, value in self.values}
        found = {**values, "pi": arb.pi}
        for constant in self.source.constants:
            if constant.generator in self.source.generators:
                found[constant.generator] = later(constant.expression, values)
        return found

    def enclosed(self, bits: int) -> EnclosedNested:
        """Return the function, evaluated in balls at the given precision."""
        with ctx.workprec(bits):
            used = self.source.generators - {LAPLACE}
            return EnclosedNested(bits, self.source, {n: acb(self._enclosures[n]()) for n in used})

    @cached_property
    def _first(self) -> EnclosedNested:
        return self.enclosed(FIRST_BITS)

    def __call__(self, s: complex) -> complex:
        """Return the value at one complex frequency [rad/s] to double precision.

        The precision is raised until the ball's radius is below the last bit. Where the expression has no
        value, at s = 0 mostly, it is the limit, found from two points close by; at a pole that is
        ``inf + nan*1j``.
        """
        if self.is_zero:
            return 0j
        # A wide ball may hold a zero divisor where the function has none: once more before a limit is sought.
        return double_value(self.enclosed, self._first, s, 1)

    def at(self, s: npt.ArrayLike) -> npt.NDArray[np.complex128]:
        """Return the values in double precision at many complex frequencies at once.

        Parameters
        ----------
        s : array_like of complex
            [rad/s].

        Returns
        -------
        ndarray of complex
            Of the same shape; not finite at poles.
        """
        import numpy as np  # binding and ball arithmetic need none of it

        points = np.asarray(s, dtype=complex)
        with ctx.workprec(CONSTANT_BITS):
            known: dict[str, Any] = {
                n: float(self._enclosures[n]().mid()) for n in self.source.generators - {LAPLACE}
            }
        known[LAPLACE] = points
        with np.errstate(all="ignore"):
            num, den = _values(self.source, known, lambda f: f.numerator / f.denominator)
            value = num / np.asarray(den, dtype=complex)
        return np.array(np.broadcast_to(value, points.shape), dtype=complex)


@dataclass(frozen=True, eq=False)
class EnclosedNested:
    """A bound nested transfer function, evaluated in balls at one precision."""

    bits: int  # the precision everything is computed at
    source: NestedTransferFunction  # the function
    constants: Mapping[str, acb]  # its generators but for s

    def __call__(self, s: acb) -> acb:
        """Return a ball that contains the values on the ball ``s`` [rad/s]; not finite near a pole."""
        with ctx.workprec(self.bits):
            num, den = _values(self.source, {**self.constants, LAPLACE: s}, ball)
            return acb(num) / acb(den)

    def value_and_slope(self, s: acb) -> tuple[acb, acb]:
        """Return balls around the value and around ``G'(s)/G(s)``."""
        with ctx.workprec(self.bits):
            num, den, above, below = _values_and_slopes(self.source, self.constants, s)
            return num / den, above / num - below / den


_GENERATOR, _NUMBER, _ADD, _MULTIPLY, _DIVIDE, _NEGATE, _POWER = map(int, Step)


def _values(
    tf: NestedTransferFunction, known: Mapping[str, Any], number: Callable[[Fraction], Any]
) -> tuple[Any, Any]:
    """Return numerator and denominator in whatever arithmetic the generators' values have."""
    names = tf.program.names
    values = tf.program.values(tf.operations, name=lambda position: known[names[position]], number=number)
    return values[tf.num], values[tf.den]


def _values_and_slopes(  # noqa: PLR0912  (one branch per kind of step, in one loop for speed)
    tf: NestedTransferFunction, known: Mapping[str, acb], s: acb
) -> tuple[acb, acb, acb, acb]:
    """Return numerator and denominator, and their derivatives by s; what is free of s has none on the way."""
    program = tf.program
    values: dict[int, acb] = {}
    spend()
    slopes: dict[int, acb] = {}
    for kind, i, args, gone in tf.operations:
        if kind == _MULTIPLY:
            value, slope = values[args[0]], slopes.get(args[0])
            for x in args[1:]:
                factor, own = values[x], slopes.get(x)
                if slope is not None:
                    slope = slope * factor
                if own is not None:
                    slope = value * own if slope is None else slope + value * own
                value = value * factor
        elif kind == _ADD:
            value, slope = values[args[0]], slopes.get(args[0])
            for x in args[1:]:
                value = value + values[x]
                own = slopes.get(x)
                if own is not None:
                    slope = own if slope is None else slope + own
        elif kind == _DIVIDE:
            above, below = args
            value, slope = values[above] / values[below], slopes.get(above)
            own = slopes.get(below)
            if own is not None:
                slope = (-value * own if slope is None else slope - value * own) / values[below]
            elif slope is not None:
                slope = slope / values[below]
        elif kind == _GENERATOR:
            name = program.names[args[0]]
            value, slope = (s, acb(1)) if name == LAPLACE else (known[name], None)
        elif kind == _NEGATE:
            value, slope = -values[args[0]], slopes.get(args[0])
            slope = None if slope is None else -slope
        elif kind == _POWER:
            base, exponent = args
            value, slope = values[base] ** exponent, slopes.get(base)
            if slope is not None:
                slope = exponent * values[base] ** (exponent - 1) * slope
        else:
            value, slope = acb(ball(program.fraction(i))), None
        values[i] = value
        if slope is not None:
            slopes[i] = slope
        for x in gone:
            del values[x]
            slopes.pop(x, None)
    zero = acb(0)
    return values[tf.num], values[tf.den], slopes.get(tf.num, zero), slopes.get(tf.den, zero)


def bind_nested(
    tf: NestedTransferFunction, values: Mapping[str, int | float | Fraction | Decimal | str] | None = None
) -> BoundNested:
    """Return a nested transfer function with the declared values, or the given ones in their place.

    Values are in SI units or have a unit ("0.8 m"). Raises ModelError: SF229 a parameter without value;
    UsageError: SF902 an unknown parameter.
    """
    return BoundNested(tf, values_for(tf.model, tf.parameters, dict(values or {})))

"""Transfer functions as straight-line programs: the exact representation that does not grow by expansion.

Input: a model's equations, and which transfer functions are wanted.
Output: a :class:`NestedTransferFunction` each. Its numerator and denominator are nested expressions whose
shared parts exist once, so their size grows with the work of eliminating a sparse network: in proportion to
the length of a chain, ring, tree or ladder. They are evaluated in balls or in double precision as they are.

Of beams, rods and delays the generators are fundamental functions: of a beam of length l, whose deflection
has a fourth derivative of ``-c_0`` times itself, they are ``h`` and its first three derivatives at l, where
h solves the same equation, with ``h = h' = h'' = 0`` and a third derivative of 1 at the start. They are
entire in s; at a point each is a ball as narrow as is asked for. Elimination divides by what is zero where
a member vibrates between fixed ends. The quotient has a value there, but wide balls of s lead to none: such
functions are evaluated at points.
"""

from __future__ import annotations

from cmath import isfinite
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache, cached_property, partial
from math import prod
from operator import truediv
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from flint import acb, acb_series

from symflex.algebra import LAPLACE, NO_KERNELS, KernelTable
from symflex.algebra.straight_line import Operation, Step, StraightLine
from symflex.balls import Arithmetic, UndecidedError, Value, ball, expansion, precision, precisions, raised
from symflex.budget import spend, uncollected
from symflex.equations import ConstantFunction, Equations
from symflex.model import ExactValue, Input, Model, ModelParameter, Output
from symflex.transfer.against_equations import Agreement, ModelSolve, compare
from symflex.transfer.bind import Given, bind, values_for
from symflex.transfer.bound import BoundTransferFunction
from symflex.transfer.derive import nested_transfer
from symflex.transfer.direct_solve import Point
from symflex.transfer.double_value import DOUBLE_BITS, FIRST_BITS, LAST_BITS, double_value
from symflex.transfer.transfer_function import (
    HiddenFactor,
    TransferFunction,
    name_quantity,
    parameters_named,
    unit_of_quotient,
)

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from symflex.equations.elimination.star_mesh import Waves
    from symflex.equations.line_network import LineNetwork
    from symflex.transfer.equations_at import EquationsAt

CONSTANT_BITS = 256  # precision of powers of pi before they are rounded to a double


@dataclass(frozen=True, eq=False)
class CutModel:
    """A model, of which the network that double precision solves is made when it is wanted."""

    solve: ModelSolve  # its equations at points

    @cached_property
    def network(self) -> LineNetwork:
        """The equations as a table of numbers."""
        from symflex.equations.line_network import line_network  # exports of networks alone need it

        with uncollected():
            return line_network(self.solve.direct.equations)


@dataclass(frozen=True, eq=False)
class NestedTransferFunction:
    """``output = num/den * input``, a quotient of nested expressions.

    Neither need be a polynomial in s, and nothing is known about common factors: what would cancel, a hidden
    mode, is not looked for. As a function of s and the parameters the quotient is exact.
    """

    is_reduced: ClassVar[Literal[False]] = False
    hidden: ClassVar[tuple[HiddenFactor, ...]] = ()  # none was looked for
    kernels: ClassVar[KernelTable] = NO_KERNELS  # it contains no wavenumbers
    is_nameless: ClassVar[bool] = False  # for the same reason
    output: Output  # what is measured
    input: Input  # what drives
    program: StraightLine  # the steps; those of several functions of a model may share a program
    num: int  # num and den: steps of it
    den: int
    quantity: str  # ``receptance``, ``mobility``, ...
    unit: str  # SI unit, empty when unknown
    constants: tuple[ConstantFunction, ...]  # what generators such as ``sqrt(k*m)`` stand for
    model: Model  # where it comes from
    equations: Equations  # those it solves
    every_wave: tuple[Waves, ...]  # the fundamental functions in them, of all members
    cut: CutModel  # the same for double precision; functions of a model share it

    def __repr__(self) -> str:
        return f"<NestedTransferFunction {self.name}, {self.size} operations>"

    @property
    def name(self) -> str:
        """``OUT/IN``."""
        return f"{self.output.name}/{self.input.name}"

    @property
    def is_zero(self) -> bool:
        """True when the output does not depend on the input."""
        return self.num == 0

    @property
    def is_rational(self) -> bool:
        """True without fundamental functions of beams, rods, fields or delays."""
        return not self.waves

    @property
    def solves_network(self) -> bool:
        """True when values are those of a network of waves, solved at every s."""
        return not self.is_rational

    @property
    def extent(self) -> str:
        """What numerator and denominator are, and how long, in words."""
        return f"nested expressions of {self.size} operations"

    @cached_property
    def waves(self) -> tuple[Waves, ...]:
        """The fundamental functions that occur."""
        kinds, operands = self.program.kinds, self.program.operands
        used = {operands[i][0] for i in self.program.steps_of(self.num, self.den) if kinds[i] == _GENERATOR}
        return tuple(w for w in self.every_wave if any(position in used for position, _ in w.generators))

    @cached_property
    def wave_of(self) -> Mapping[int, tuple[Waves, int]]:
        """Per position of a generator that is a fundamental function, its group, and its place in it."""
        return {position: (w, i) for w in self.waves for i, (position, _) in enumerate(w.generators)}

    @cached_property
    def _roots(self) -> tuple[int, ...]:
        return (self.num, self.den, *(i for w in self.waves for i in w.arguments))

    @cached_property
    def steps(self) -> tuple[int, ...]:
        """The steps numerator and denominator are made of, in order, arguments of functions among them."""
        return tuple(self.program.steps_of(*self._roots))

    @cached_property
    def operations(self) -> tuple[Operation, ...]:
        """The steps with their operands, and with the steps that nothing needs after each."""
        program, kept = self.program, set(self._roots)
        steps: list[Operation] = []
        for i in reversed(self.steps):
            gone = tuple(x for x in dict.fromkeys(program.inner(i)) if x not in kept)
            kept.update(gone)
            steps.append((program.kinds[i], i, program.operands[i], gone))
        return tuple(reversed(steps))

    @property
    def size(self) -> int:
        """The number of operations, shared ones counted once."""
        return self.program.size(self.num, self.den)

    @cached_property
    def generators(self) -> frozenset[str]:
        """The names of the generators that occur, but for fundamental functions."""
        kinds, operands = self.program.kinds, self.program.operands
        used = {operands[i][0] for i in self.steps if kinds[i] == _GENERATOR}
        return frozenset(self.program.names[i] for i in used if i not in self.wave_of)

    @cached_property
    def parameters(self) -> tuple[ModelParameter, ...]:
        """The parameters that occur, in declared order."""
        return parameters_named(self.model, self.constants, self.generators)


AnyTransferFunction = TransferFunction | NestedTransferFunction  # both exact representations


def derive_nested(
    equations: Equations, pairs: Sequence[tuple[str, str]]
) -> tuple[NestedTransferFunction, ...]:
    """Return transfer functions in nested form; SF30x for singular equations, SF991 where they disagree."""
    model = equations.model
    solve = ModelSolve(model, nested_transfer, equations)
    cut = CutModel(solve)
    from symflex.equations.elimination.star_mesh import eliminate  # few models are so large

    elimination = eliminate(equations, pairs)
    outputs, inputs = {o.name: o for o in model.answers}, {i.name: i for i in model.causes}
    known = dict(model.quotients)
    made = []
    for (output, source), (num, den) in zip(pairs, elimination.quotients, strict=True):
        ends = outputs[output], inputs[source]
        dimension = known.get((output, source))
        named = name_quantity(*ends, dimension), unit_of_quotient(*ends, dimension)
        quotient = (*ends, elimination.program, num, den, *named, equations.constants, model)
        made.append(NestedTransferFunction(*quotient, equations, elimination.waves, cut))
    compare(solve, [Agreement((tf.output.name, tf.input.name), partial(_only_value, tf)) for tf in made])
    return tuple(made)


def _only_value(tf: NestedTransferFunction, _: Point, known: Mapping[str, acb]) -> list[acb]:
    num, den = _values(tf, {name: known[name] for name in tf.generators}, ball)
    return [acb(num) / acb(den)]


@dataclass(frozen=True, eq=False)
class BoundNested:
    """A nested transfer function with numbers."""

    is_reduced: ClassVar[Literal[False]] = False
    kernels: ClassVar[KernelTable] = NO_KERNELS  # it contains no wavenumbers
    source: NestedTransferFunction  # the symbolic function
    values: tuple[tuple[str, ExactValue], ...]  # every parameter's value, in declared order
    located: dict[object, Any] = field(default_factory=dict)  # poles and zeros that are known, by region

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.name}, {self.source.size} operations>"

    @property
    def name(self) -> str:
        """``OUT/IN``."""
        return self.source.name

    @property
    def is_zero(self) -> bool:
        """True when the output does not depend on the input."""
        return self.source.is_zero

    @property
    def is_rational(self) -> bool:
        """True when the function is a quotient of polynomials in s."""
        return self.source.is_rational

    def enclosed(self, bits: int) -> EnclosedNested:
        """Return the function, evaluated in balls at the given precision."""
        with precision(bits):
            used = self.source.generators - {LAPLACE}
            return EnclosedNested(bits, self.source, {name: self.numeric.constant(name) for name in used})

    def solved(self, s: acb, bits: int) -> acb:
        """Return a ball around the value from the equations; not finite where they are singular."""
        with precision(bits), suppress(UndecidedError):
            return self.numeric.value(self.source.output.name, self.source.input.name, s)
        return acb("nan")

    @cached_property
    def numeric(self) -> EquationsAt:
        """The equations with numbers."""
        return self._with_numbers(self.source.equations)

    def _with_numbers(self, equations: Equations) -> EquationsAt:
        from symflex.transfer.equations_at import EquationsAt  # few models are so large

        # A function does not depend on a parameter without value, though its network may.
        declared = ((p.name, p.value or ExactValue(Fraction(1))) for p in self.source.model.parameters)
        return EquationsAt(equations, tuple((dict(declared) | dict(self.values)).items()))

    @cached_property
    def _known(self) -> Callable[[int], EnclosedNested]:
        return cache(self.enclosed)

    def __call__(self, s: complex, bits: int = FIRST_BITS) -> complex:
        """Return the value at one s [rad/s] in doubles; a limit where it has none, inf at a pole."""
        if self.is_zero:
            return 0j
        # A wide ball may contain a zero divisor where the function has none, so retry before seeking a limit.
        value = double_value(self._known, s, 1, bits)
        if isfinite(value) or self.source.equations.propagation is None:
            return value
        # A program may divide by what is zero for these values, such as the sine of an angle of 180 degrees.
        return double_value(lambda bits: partial(self.solved, bits=bits), s, 1)

    def each(self, points: Sequence[complex]) -> list[complex]:
        """Return values at frequencies [rad/s], in long chains with the bits that the last one took."""
        bits = self._bits_at(points[-1]) if points else FIRST_BITS
        return [self(s, bits) for s in points]

    def _bits_at(self, s: complex) -> int:
        point = acb(s.real, s.imag)
        for bits in precisions(FIRST_BITS, LAST_BITS // 2):
            if self._known(bits)(point).rel_accuracy_bits() >= DOUBLE_BITS:
                return bits
        return LAST_BITS

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
        if not self.source.is_rational:
            return self._solved(points)
        with precision(CONSTANT_BITS):
            known: dict[str, Any] = {
                n: float(self.numeric.constant(n).real.mid()) for n in self.source.generators - {LAPLACE}
            }
        known[LAPLACE] = points
        with np.errstate(all="ignore"):
            num, den = _values(self.source, known, lambda f: f.numerator / f.denominator)
            value = num / np.asarray(den, dtype=complex)
        return np.array(np.broadcast_to(value, points.shape), dtype=complex)

    def _solved(self, points: npt.NDArray[np.complex128]) -> npt.NDArray[np.complex128]:
        """Return the values of a network of line elements."""
        import numpy as np

        from symflex.algebra.line_networks import network_value  # few functions are of so many members

        network = self.source.cut.network
        known = self._with_numbers(network.equations).constant
        with precision(CONSTANT_BITS), np.errstate(all="ignore"):
            entries = network.values(
                name=lambda name: points if name == LAPLACE else float(known(name).real.mid()),
                number=lambda x: x.numerator / x.denominator,
                total=sum,
                product=prod,
                quotient=truediv,
                power=pow,
                exponential=np.exp,
            )
            numbers = network.numbers(self.source.output.name, self.source.input.name)
            value = network_value(entries, network.table, *numbers)
        return np.array(np.broadcast_to(value, points.shape), dtype=complex)


@dataclass(frozen=True, eq=False)
class EnclosedNested:
    """A bound nested transfer function, evaluated in balls at one precision."""

    bits: int  # the precision everything is computed at
    source: NestedTransferFunction  # the function
    constants: Mapping[str, acb]  # its generators but for s

    def __call__(self, s: acb) -> acb:
        """Return a ball that contains the values on the ball ``s`` [rad/s]; not finite near a pole."""
        with precision(self.bits):
            num, den = _values(self.source, {**self.constants, LAPLACE: s}, ball)
            return acb(num) / acb(den)

    def value_and_slope(self, s: acb) -> tuple[acb, acb]:
        """Return balls around the value and around ``G'(s)/G(s)``."""
        with precision(self.bits):
            spend()
            sides = _values(self.source, {**self.constants, LAPLACE: expansion(s)}, ball)
            (num, above), (den, below) = (
                (x[0], x[1]) if isinstance(x, acb_series) else (x, acb(0)) for x in map(_complex, sides)
            )
            return num / den, above / num - below / den


_GENERATOR = int(Step.GENERATOR)


def _values(
    tf: NestedTransferFunction, known: Mapping[str, Any], number: Callable[[Fraction], Any]
) -> tuple[Any, Any]:
    """Return numerator and denominator in whatever arithmetic the generators' values have."""
    names, wave_of = tf.program.names, tf.wave_of
    values: dict[int, Any] = {}
    functions: dict[Waves, tuple[Value, ...]] = {}

    def generator(position: int) -> Any:  # noqa: ANN401 (whatever the values are)
        if position not in wave_of:
            return known[names[position]]
        waves, index = wave_of[position]
        if waves not in functions:
            # Fundamental functions, in the order of their generators
            arguments = [_complex(values[i]) for i in waves.arguments]
            from symflex.transfer.enclose_kernels import fundamental_functions  # only with beams

            *coefficients, shift, length = arguments
            orders = [order for _, order in waves.generators]
            plain = fundamental_functions(coefficients, length) if any(n >= 0 for n in orders) else ()
            functions[waves] = tuple(plain[n] if n >= 0 else (-shift * length).exp() for n in orders)
        return functions[waves][index]

    tf.program.values(tf.operations, name=generator, number=number, quotient=_quotient, known=values)
    return values[tf.num], values[tf.den]


def _quotient(above: Arithmetic, below: Arithmetic) -> Arithmetic:
    """Return a quotient, not finite where a series is divided by one that begins with zero."""
    return above * raised(below, -1) if isinstance(below, acb_series) else above / below


def _complex(value: Arithmetic) -> Value:
    return value if isinstance(value, acb_series) else acb(value)


AnyBoundFunction = BoundTransferFunction | BoundNested  # both representations, with numbers


def bind_nested(tf: NestedTransferFunction, values: Mapping[str, Given] | None = None) -> BoundNested:
    """Return a nested function with the declared values, or the given ones; SF229 without, SF902 unknown."""
    return BoundNested(tf, values_for(tf.model, tf.parameters, dict(values or {})))


def bind_any(tf: AnyTransferFunction, values: Mapping[str, Given] | None = None) -> AnyBoundFunction:
    """Return a transfer function in either form with the declared values, or the given ones; see ``bind``."""
    return bind_nested(tf, values) if isinstance(tf, NestedTransferFunction) else bind(tf, values)

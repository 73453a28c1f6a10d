"""The language-neutral program tree: what generated code computes, before any language prints it.

A :class:`Piecewise` is straight-line code in pieces, and tests that tell which piece serves. Sums and
products are n-ary and are evaluated from left to right, so that every language computes the same
floating-point numbers in the same order. A mass m on a damper b, driven by a force, has the velocity
1/(m s + b) per newton:

    lumped(("m", "b"), Straight((), (), (Divide(ONE, Add((Multiply((m, Laplace())), b))),)))

where ``m`` is ``ParameterValue("m")``.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import astuple, dataclass, replace
from fractions import Fraction
from itertools import islice
from math import inf
from typing import TYPE_CHECKING, ClassVar, Self

if TYPE_CHECKING:
    from symflex.equations.line_network import Table


@dataclass(frozen=True, slots=True)
class CodeNode:
    """Base of all nodes; in the table of a forge operands are numbers of nodes, which stand before."""

    OPERANDS: ClassVar[tuple[str, ...]] = ()  # the fields that contain operands, or tuples of them

    def __init_subclass__(cls) -> None:
        operands = tuple(name for name, kind in cls.__annotations__.items() if "CodeNode" in kind)
        cls.OPERANDS = operands or cls.OPERANDS

    @property
    def children(self) -> tuple[CodeNode, ...]:
        """The operands, from left to right; empty for a leaf."""
        children: list[CodeNode] = []
        for name in self.OPERANDS:
            value = getattr(self, name)
            children += value if isinstance(value, tuple) else (value,)
        return tuple(children)

    def walk(self) -> Iterator[CodeNode]:
        """Yield the node and all it is made of, in no particular order."""
        pending: list[CodeNode] = [self]
        while pending:
            node = pending.pop()
            yield node
            pending += node.children

    def with_children(self, children: Iterable[CodeNode]) -> Self:
        """Return the same with other operands, as many as there are."""
        given = iter(children)
        changes = {}
        for name in self.OPERANDS:
            value = getattr(self, name)
            is_list = isinstance(value, tuple)
            changes[name] = tuple(islice(given, len(value))) if is_list else next(given)
        return replace(self, **changes) if changes else self


@dataclass(frozen=True, slots=True)
class RealNumber(CodeNode):
    """The non-negative number ``value * pi**pi_power``."""

    value: Fraction
    pi_power: int = 0


ONE = RealNumber(Fraction(1))


@dataclass(frozen=True, slots=True)
class ComplexNumber(CodeNode):
    """The number ``real + 1j*imaginary``."""

    real: Fraction
    imaginary: Fraction


@dataclass(frozen=True, slots=True)
class ToComplex(CodeNode):
    """A real number as a complex one, for functions whose value is complex where it is negative."""

    operand: CodeNode


@dataclass(frozen=True, slots=True)
class ParameterValue(CodeNode):
    """A parameter, by its name in the model."""

    name: str


@dataclass(frozen=True, slots=True)
class Laplace(CodeNode):
    """The Laplace variable s."""


@dataclass(frozen=True, slots=True)
class InverseLaplace(CodeNode):
    """The quotient 1/s."""


@dataclass(frozen=True, slots=True)
class Assigned(CodeNode):
    """The value of an earlier assignment."""

    name: str


@dataclass(frozen=True, slots=True)
class Add(CodeNode):
    """A sum, evaluated from left to right."""

    terms: tuple[CodeNode, ...]


@dataclass(frozen=True, slots=True)
class Multiply(CodeNode):
    """A product, evaluated from left to right."""

    factors: tuple[CodeNode, ...]


@dataclass(frozen=True, slots=True)
class Divide(CodeNode):
    """A quotient."""

    numerator: CodeNode
    denominator: CodeNode


@dataclass(frozen=True, slots=True)
class IntegerPower(CodeNode):
    """An expression free of s raised to an integer of at least two."""

    base: CodeNode
    exponent: int


@dataclass(frozen=True, slots=True)
class Negate(CodeNode):
    """Minus its operand."""

    operand: CodeNode


@dataclass(frozen=True, slots=True)
class LargerRoot(CodeNode):
    """The root ``m*(1 + sqrt(1 - p/(m*m)))`` of ``x^2 - 2*m*x + p`` where m is in the right half-plane.

    Where m is small beside the root of p, the formula's value keeps digits that its derivative loses.
    """

    spelled: CodeNode  # the expression above, for languages without derivatives
    middle: CodeNode  # m
    product: CodeNode  # p


@dataclass(frozen=True, slots=True)
class Apply(CodeNode):
    """An elementary function: a key of ``kernels.FUNCTIONS``, ``abs``, or a complex exp or sqrt."""

    function: str
    argument: CodeNode


@dataclass(frozen=True, slots=True)
class Within(CodeNode):
    """The point itself where its absolute value is at most ``end``, elsewhere not a number."""

    point: CodeNode  # s
    end: float


@dataclass(frozen=True, slots=True)
class RootFactor(CodeNode):
    """A factor of a product over roots: ``z - s``, two such of a pair; ``s - z`` of a negative real root.

    Parts of z are two doubles, the rest added last, so that all digits are right also where s is close to z.
    """

    point: CodeNode  # s
    # re and im: of z; im is positive, or zero for a single real root.
    re: tuple[float, float]
    im: tuple[float, float]
    is_mirrored: bool = False  # true where -z is a root as well; re is positive then

    @property
    def is_pair(self) -> bool:
        """True for two conjugate roots."""
        return self.im != (0.0, 0.0)

    @property
    def is_real_on_axis(self) -> bool:
        """True where the factor is real for imaginary s: roots mirror each other in the imaginary axis."""
        return self.is_mirrored or self.re == (0.0, 0.0)

    @property
    def spelled(self) -> CodeNode:
        """The factor in sums and products."""
        minus = Negate(self.point)
        if not self.is_pair and self.re[0] < 0:
            return _sum(_real(-self.re[0]), self.point, _real(-self.re[1]))
        factors = []
        for sign in (1, -1) if self.is_pair else (1,):
            high, low = (
                ComplexNumber(Fraction(re), sign * Fraction(im)) if im else _real(re)
                for re, im in zip(self.re, self.im, strict=True)
            )
            factors += [_sum(high, s, low) for s in ((minus, self.point) if self.is_mirrored else (minus,))]
        return Multiply(tuple(factors)) if len(factors) > 1 else factors[0]


def _sum(*terms: CodeNode | None) -> CodeNode:
    return Add(tuple(x for x in terms if x is not None))


def _real(value: float) -> CodeNode | None:
    """Return a number, nothing for zero."""
    number = RealNumber(Fraction(abs(value)))
    return (Negate(number) if value < 0 else number) if value else None


@dataclass(frozen=True, slots=True)
class Solutions(CodeNode):
    """The values at x = 1 of the solutions of ``y^(n) + c_(n-1) y^(n-1) + ... + c_0 y = 0``, as a list.

    Solution k starts from ``y^(i)(0) = 1`` for i = k and 0 for the other i below n.
    """

    coefficients: tuple[CodeNode, ...]  # ``c_0, ..., c_(n-1)``
    terms: int  # length of their Taylor series


@dataclass(frozen=True, slots=True)
class SolutionSlopes(CodeNode):
    """The derivatives in s of :class:`Solutions`, as a list."""

    coefficients: tuple[CodeNode, ...]
    slopes: tuple[CodeNode, ...]  # their derivatives in s
    terms: int


@dataclass(frozen=True, slots=True)
class Solve(CodeNode):
    """What an output of a network is per unit of an input; see :mod:`symflex.algebra.line_networks`."""

    entries: tuple[CodeNode, ...]  # the values of the table's entries
    network: Table  # which entries stand where
    # output, source: their numbers in the table.
    output: int
    source: int


@dataclass(frozen=True, slots=True)
class Tip:
    """How finite solutions begin where a stiffness vanishes: ``h v' = B v``, ``z_i = h^powers_i v_i``."""

    places: tuple[tuple[int, ...], ...]  # per part of B its row, column, and powers of h and of the bases
    powers: tuple[int, ...]
    exponents: tuple[int, ...]  # the diagonal of B at the start, that places leave out
    free: tuple[int, ...]  # the states whose values at the start tell a solution


@dataclass(frozen=True, slots=True)
class FundamentalMinors(CodeNode):
    """Minors, as a list, by :func:`symflex.along.doubles.fundamental_minors`, of a law along x."""

    start: CodeNode  # of x
    length: CodeNode
    bases: tuple[CodeNode, ...]  # functions of s
    # The parts of the coefficients, and after them those of a tip: functions of x, for which the leaf
    # :class:`Laplace` stands.
    along: Straight
    places: tuple[tuple[int, ...], ...]  # per part its row, its column, and its powers of the bases
    wanted: tuple[tuple[tuple[int, ...], tuple[int, ...]], ...]  # rows and columns of every minor
    tip: Tip | None = None  # where a stiffness vanishes at the start

    @property
    def beginning(self) -> tuple[object, ...]:
        """What run-time functions take of the tip, empty without one."""
        return astuple(self.tip) if self.tip else ()


@dataclass(frozen=True, slots=True)
class ScaledSum(CodeNode):
    """A sum of amplitudes times exponentials, over the largest one, and the logarithm of that, as a list."""

    amplitudes: tuple[CodeNode, ...]
    exponents: tuple[CodeNode, ...]


@dataclass(frozen=True, slots=True)
class Item(CodeNode):
    """One value of a list."""

    values: CodeNode
    position: int


@dataclass(frozen=True, slots=True)
class Assignment:
    """A named intermediate value; the name is unique in its program, and not yet an identifier."""

    name: str
    value: CodeNode


@dataclass(frozen=True, slots=True)
class Condition:
    """A test made for every value of s."""

    quantity: CodeNode  # what is tested
    # The condition holds where ``abs(quantity) < limit/abs(scale)``; if it is zero, where the real part of
    # ``scale*quantity`` is negative.
    limit: float
    scale: CodeNode  # free of s


@dataclass(frozen=True, slots=True)
class Straight:
    """Assignments in order, those of parameters alone first, and the values they lead to."""

    constants: tuple[Assignment, ...]
    assignments: tuple[Assignment, ...]
    values: tuple[CodeNode, ...]

    @property
    def every(self) -> tuple[Assignment, ...]:
        """All assignments, in order."""
        return (*self.constants, *self.assignments)

    def nodes(self) -> Iterator[CodeNode]:
        """Yield all expressions, parts included, in no particular order."""
        for root in (*self.values, *(a.value for a in self.every)):
            yield from root.walk()

    def needed(self, values: Sequence[CodeNode]) -> Straight:
        """Return the assignments that some values need, and these values."""
        names = {n.name for value in values for n in value.walk() if isinstance(n, Assigned)}
        kept: list[list[Assignment]] = []
        for group in (self.assignments, self.constants):
            of_value: list[Assignment] = []
            for assignment in reversed(group):
                if assignment.name in names:
                    of_value.insert(0, assignment)
                    names |= {n.name for n in assignment.value.walk() if isinstance(n, Assigned)}
            kept.append(of_value)
        return Straight(tuple(kept[1]), tuple(kept[0]), tuple(values))


@dataclass(frozen=True, slots=True)
class CodePiece:
    """One way of computing a quotient."""

    # Its values are numerator and denominator, in a lumped program the quotient alone; with a circle also the
    # logarithm of the factor that both were divided by, and the radius of the circle.
    code: Straight
    # Points on a circle around s over which numerator and denominator are averaged, because the formula
    # itself is singular near s though they are not; 0 for none.
    circle: int = 0
    is_complex: bool = False  # true for a piece of complex s in a program of the angular frequency


@dataclass(frozen=True, slots=True)
class Piecewise:
    """How to compute a transfer function.

    A lumped one has one piece; or two, of which the first is in powers of 1/s, for ``abs(s)`` so large that
    powers of s would overflow, and begins with the assignments of the second.
    """

    parameters: tuple[str, ...]  # names of the parameters it takes, as in the model
    tests: Straight  # makes the quantities of the conditions, in order
    conditions: tuple[Condition, ...]  # condition i adds ``2**i`` to the number of the piece that serves
    pieces: tuple[int, ...]  # for every such number, which of ``code`` it is
    code: tuple[CodePiece, ...]  # the pieces
    # None for a function of complex s. For a function of angular frequency in real arithmetic, which the leaf
    # :class:`Laplace` then stands for: its value times ``1j**turn`` is the transfer function.
    turn: int | None = None

    @property
    def is_real(self) -> bool:
        """True for a function of angular frequency in real arithmetic."""
        return self.turn is not None

    @property
    def minors(self) -> tuple[FundamentalMinors, ...]:
        """The fundamental matrices that are followed along x, one for every law and length."""
        nodes = (n for piece in self.code for n in piece.code.nodes())
        return tuple(dict.fromkeys(n for n in nodes if isinstance(n, FundamentalMinors)))

    @property
    def network(self) -> Solve | None:
        """The network of line elements that is solved, where there is one."""
        value = self.code[0].code.values[0]
        return value if isinstance(value, Solve) else None

    @property
    def is_lumped(self) -> bool:
        """True when every piece computes the value itself."""
        return len(self.code[0].code.values) == 1

    @property
    def near(self) -> Straight:
        """What serves for small ``abs(s)``, in a lumped program."""
        return self.code[-1].code

    @property
    def far(self) -> Straight | None:
        """What serves beyond ``limit`` in a lumped program; None if ``near`` serves everywhere."""
        return self.code[0].code if self.conditions else None

    @property
    def late(self) -> tuple[Assignment, ...]:
        """The assignments of ``far`` that ``near`` does not have."""
        return () if self.far is None else self.far.assignments[len(self.near.assignments) :]

    @property
    def limit(self) -> float:
        """Up to which ``near`` serves in a lumped program; infinite if it serves everywhere."""
        return self.conditions[0].limit if self.conditions else inf

    @property
    def varies(self) -> bool:
        """False when the value of a lumped program does not depend on s."""
        return bool(self.near.assignments) or any(isinstance(n, Laplace) for n in self.near.nodes())

    @property
    def size(self) -> int:
        """The number of operations of ``near`` that depend on s: what an array pays for, per element."""
        return _operations(self.near)

    @property
    def length(self) -> int:
        """The number of operations of all pieces that depend on s, which a file's length follows."""
        return sum(_operations(piece.code) for piece in self.code)


def _operations(code: Straight) -> int:
    roots = [*(a.value for a in code.assignments), *code.values]
    return sum(max(len(node.children) - 1, 0) for root in roots for node in root.walk())


def lumped(
    parameters: tuple[str, ...], near: Straight, far: Straight | None = None, limit: float = inf
) -> Piecewise:
    """Return the program that computes ``near``, or ``far`` where ``abs(s)`` exceeds a limit."""
    nothing = Straight((), (), ())
    if far is None:
        return Piecewise(parameters, nothing, (), (0,), (CodePiece(near),))
    tests = (Condition(Laplace(), limit, ONE),)
    return Piecewise(parameters, nothing, tests, (0, 1), (CodePiece(far), CodePiece(near)))

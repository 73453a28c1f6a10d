"""The blocks of the specification language: transfer functions that may stand as factors in expressions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from math import isqrt
from typing import TYPE_CHECKING, ClassVar

from symflex.library import ParameterPort, Stateless

if TYPE_CHECKING:
    from symflex.algebra import Factored


class Block(Stateless):
    """Base of every block, final and stateless. With ``kernel_time`` it is ``exp(-s*T)``, a generator."""

    type_name: ClassVar[str]
    formula: ClassVar[str] = ""  # the transfer function in s and the parameters; none of state equations
    remark: ClassVar[str] = ""  # ends the summary
    parameters: ClassVar[tuple[ParameterPort, ...]]
    kernel_time: ClassVar[str] = ""
    # Its unit is that of these parameters, each times a power of s; without any it is a pure number. With
    # ``None`` any unit fits.
    gains: ClassVar[tuple[tuple[str, int], ...] | None] = ()

    @property
    def summary(self) -> str:
        """The formula as people write products, and the remark."""
        return self.formula.replace("*", " ") + self.remark


class Resonance(Block):
    """One pair of poles and one pair of zeros with unit gain at low frequency.

    Source: Eppinger & Seering 1988, section "Polynomial Resonance Model".
    """

    type_name = "resonance"
    formula = (
        "(omega_p/omega_z)^2*(s^2 + 2*zeta_z*omega_z*s + omega_z^2)/(s^2 + 2*zeta_p*omega_p*s + omega_p^2)"
    )
    parameters = (
        ParameterPort("omega_p", "rad/s", "an angular frequency"),
        ParameterPort("zeta_p", "1", "a damping ratio"),
        ParameterPort("omega_z", "rad/s", "an angular frequency"),
        ParameterPort("zeta_z", "1", "a damping ratio"),
    )


class Notch(Block):
    """A pair of poles and a pair of zeros at one frequency: unit gain at low and at high ones.

    The gain at omega is ``zeta_z/zeta_p``.
    """

    type_name = "notch"
    formula = "(s^2 + 2*zeta_z*omega*s + omega^2)/(s^2 + 2*zeta_p*omega*s + omega^2)"
    parameters = (
        ParameterPort("omega", "rad/s", "an angular frequency"),
        ParameterPort("zeta_p", "1", "a damping ratio"),
        ParameterPort("zeta_z", "1", "a damping ratio", "0"),
    )


class LowPass(Block):
    """A pair of poles with unit gain at low frequency, times k: a second-order low-pass filter."""

    type_name = "low_pass"
    formula = "k*omega^2/(s^2 + 2*zeta*omega*s + omega^2)"
    gains = (("k", 0),)
    parameters = (
        ParameterPort("k", "", "a gain", "1"),
        ParameterPort("omega", "rad/s", "an angular frequency"),
        ParameterPort("zeta", "1", "a damping ratio"),
    )


class TransferFunctionBlock(Block):
    """A numerator over a denominator: expressions in s, or lists of coefficients, highest power first."""

    type_name = "tf"
    formula = "num/den"
    gains = None
    remark = ", each an expression in s or a list of coefficients (highest power first)"
    parameters = (ParameterPort("num", "", "a numerator"), ParameterPort("den", "", "a denominator", "1"))


class StateSpaceBlock(Block):
    """State equations ``s x = A x + B u``, ``y = C x + D u`` with one input and one output.

    Its values are the matrices' entries, ``A[1][2]``, ``B[1]``, ``C[1]``, ``D``. As
    ``det(s - A + B C) = det(s - A) (1 + C (s - A)^-1 B)``, two characteristic polynomials are enough.
    """

    type_name = "ss"
    gains = None
    remark = "C (s - A)^-1 B + D, with matrices as arrays of rows"
    parameters = (
        ParameterPort("A", "", "a square matrix"),
        ParameterPort("B", "", "a column"),
        ParameterPort("C", "", "a row"),
        ParameterPort("D", "", "a number", "0"),
    )

    def characteristic(self, values: Mapping[str, Factored]) -> Factored:
        """Return ``det(s - A)`` at values of s and entries."""
        return _characteristic(values["s"], _matrix(values))

    def transfer(self, values: Mapping[str, Factored]) -> Factored:
        """Return the transfer function from the only input to the only output, at values of s and entries."""
        s, a = values["s"], _matrix(values)
        b, c = ([values[f"{name}[{i + 1}]"] for i in range(len(a))] for name in "BC")
        below = _characteristic(s, a)
        closed = [[x - y * z for x, z in zip(row, c, strict=True)] for row, y in zip(a, b, strict=True)]
        return (_characteristic(s, closed) - below) / below + values["D"]


def _matrix(values: Mapping[str, Factored]) -> list[list[Factored]]:
    places = range(1, isqrt(sum(name.startswith("A[") for name in values)) + 1)
    return [[values[f"A[{i}][{j}]"] for j in places] for i in places]


def _characteristic(s: Factored, matrix: Sequence[Sequence[Factored]]) -> Factored:
    """Return ``det(s - matrix)`` by the recursion of Le Verrier (1840) and Faddeev (1949)."""
    one = s**0
    places = range(len(matrix))
    entries = [[(j, x) for j, x in enumerate(row) if not x.is_zero] for row in matrix]
    coefficient, total = one, one
    power: list[list[Factored]] = [[one if i == j else one * 0 for j in places] for i in places]
    for k in range(1, len(matrix) + 1):
        product = [[sum((x * power[m][j] for m, x in row), one * 0) for j in places] for row in entries]
        coefficient = sum((product[i][i] for i in places), one * 0) * Fraction(-1, k)
        power = [
            [x + coefficient if i == j else x for j, x in enumerate(row)] for i, row in enumerate(product)
        ]
        total = total * s + coefficient
    return total


class Integrator(Block):
    """Gain over s."""

    type_name = "integrator"
    formula = "k/s"
    gains = (("k", -1),)
    parameters = (ParameterPort("k", "", "a gain", "1"),)


class LeadLag(Block):
    """A real zero at ``-1/T_1`` and a real pole at ``-1/T_2``; lead when T_1 > T_2."""

    type_name = "lead_lag"
    formula = "k*(1 + T_1*s)/(1 + T_2*s)"
    gains = (("k", 0),)
    parameters = (
        ParameterPort("k", "", "a gain", "1"),
        ParameterPort("T_1", "s", "a time constant"),
        ParameterPort("T_2", "s", "a time constant"),
    )


class Lag(Block):
    """A real pole at ``-1/T``: a first-order low-pass filter."""

    type_name = "lag"
    formula = "k/(1 + T*s)"
    gains = (("k", 0),)
    parameters = (ParameterPort("k", "", "a gain", "1"), ParameterPort("T", "s", "a time constant"))


class Pid(Block):
    """Proportional, integral and filtered derivative action, in parallel form."""

    type_name = "pid"
    formula = "k_p + k_i/s + k_d*s/(1 + T_f*s)"
    gains = (("k_p", 0), ("k_i", -1), ("k_d", 1))
    parameters = (
        ParameterPort("k_p", "", "a proportional gain"),
        ParameterPort("k_i", "", "an integral gain", "0"),
        ParameterPort("k_d", "", "a derivative gain", "0"),
        ParameterPort("T_f", "s", "a time constant", "0"),
    )


class Delay(Block):
    """A delay (dead time) T [s], the factor ``exp(-s*T)``.

    It is not rational: the equations see its ``kernel_time`` and carry it as a generator of its own.
    """

    type_name = "delay"
    formula = "exp(-s*T)"
    parameters = (ParameterPort("T", "s", "a delay"),)
    kernel_time = "T"


class RootBlock(Block):
    """``r = (a*s + b)^(1/q)`` on its principal branch, for roots that are written in expressions."""

    type_name = "root"
    formula = "(a*s + b)^(1/q)"
    gains = None
    parameters = tuple(ParameterPort(n, "", "a coefficient of what the root is taken of") for n in "abq")


class DecayBlock(Block):
    """``exp(-k*r^m)`` of the root r of a model."""

    type_name = "decay"
    formula = "exp(-k*r^m)"
    parameters = (ParameterPort("k", "", "a rate"), ParameterPort("m", "", "a power of the root"))
    kernel_time = "k"


ROOT, DECAY = RootBlock(), DecayBlock()
BLOCKS: dict[str, Block] = {
    block.type_name: block
    for block in (
        Resonance(),
        Notch(),
        LowPass(),
        TransferFunctionBlock(),
        StateSpaceBlock(),
        Integrator(),
        LeadLag(),
        Lag(),
        Pid(),
        Delay(),
    )
}

MODEL_BLOCK = "model"  # it stands for another specification, and is resolved by the package ``model``

"""Dispersion relations, wavenumbers and the kernels made of them: what a transfer function has besides s.

A distributed element's field equations ``z' = A(s) z`` have a characteristic polynomial in the spatial
exponent lambda. Its roots are the wavenumbers; hyperbolic and trigonometric functions of a wavenumber times a
length are the kernels. Both are generators of the ring, with exact definitions kept here.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, TypeVar

from flint import nmod_poly

from symflex.algebra.factored import PRIME, Factored, random_point, residue
from symflex.errors import Diagnostic, ModelError, Span

Value = TypeVar("Value", bound=Any)
DispersionKind = Literal["exponential", "wave", "bending", "pair", "general", "varying"]
KernelFunction = Literal["cosh", "sinh", "cos", "sin", "exp", "fundamental", "entry"]


@dataclass(frozen=True, slots=True, eq=False)
class SingularStart:
    """Solutions that are finite where x begins, and where coefficients have poles.

    ``z_i = h^powers_i * v_i`` with h the way from there, ``h dv/dh = B v``, all of it analytic, and
    ``B_ij = h^orders_ij * matrix_ij``. At h = 0 B is triangular, for some order of the states, and nowhere
    positive on its diagonal.
    """

    powers: tuple[int, ...]
    orders: tuple[tuple[int, ...], ...]
    matrix: tuple[tuple[Factored, ...], ...]
    values: tuple[tuple[Factored, ...], ...]  # v at the start, per free state; other columns are zero

    @property
    def free(self) -> tuple[int, ...]:
        """The states whose values at the start tell a solution."""
        size = range(len(self.powers))
        return tuple(j for j in size if not self.values[j][j].is_zero)

    def at_start(self) -> tuple[tuple[Factored, ...], ...]:
        """Return the states at the start, per state that is free there."""
        return tuple(
            tuple(x * 0 if power else x for x in row)
            for power, row in zip(self.powers, self.values, strict=True)
        )


@dataclass(frozen=True, slots=True, eq=False)
class Dispersion:
    """The characteristic polynomial of field equations, and names of its roots; equal if one object."""

    name: str  # the field, element or block it was first needed for
    # ``exponential``: no roots but the shift; ``wave``: ``gamma^2 = -c_0``; ``bending``: ``4 mu^4 = c_0``,
    # the four roots ``mu*(+-1 +-j)``; ``pair``: ``lambda^4 + c_2 lambda^2 + c_0`` with roots ``+-lambda_1``,
    # ``+-lambda_2``; ``general``: any order, roots without a name; ``varying``: equations whose coefficients
    # vary along x, which have no exponents.
    kind: DispersionKind
    characteristic: tuple[Factored, ...]  # rational ``c_0, ...`` of exponents plus ``shift``, or none
    shift: Factored  # every solution is ``exp(-shift*x)`` times one of the polynomial above; zero for most
    wavenumbers: tuple[str, ...] = ()  # none, ``(gamma,)``, ``(mu,)`` or ``(lambda_1, lambda_2)``
    matrix: tuple[tuple[Factored, ...], ...] = ()  # A in ``z' = A(x, s) z`` if it varies, and x's start
    start: tuple[Factored, ...] = ()
    singular: SingularStart | None = None  # where a stiffness vanishes at the start
    span: Span | None = None  # where such equations are written
    meets: tuple[Factored, ...] = ()  # zero where another law of the split equations has a root

    @property
    def order(self) -> int:
        """Order of the differential equation in x; of a varying one, the number of states."""
        return max(len(self.characteristic), len(self.matrix), 1)

    @property
    def coefficients(self) -> tuple[Factored, ...]:
        """All that solutions are made of."""
        own = () if self.singular is None else (*self.singular.matrix, *self.singular.values)
        return (
            *self.characteristic,
            self.shift,
            *(x for row in (*self.matrix, *own) for x in row),
            *self.start,
            *self.meets,
        )

    @property
    def discriminant(self) -> Factored:
        """``(lambda_1^2 - lambda_2^2)^2`` of a pair: zero where its wavenumbers meet."""
        return self.characteristic[2] ** 2 - self.characteristic[0] * 4

    @property
    def has_double_root(self) -> bool:
        """Tell whether two roots of the characteristic polynomial are equal at every s."""
        if not self.characteristic:
            return False
        point = random_point(self.characteristic[0].ring.names)
        polynomial = nmod_poly([*(residue(c, point) for c in self.characteristic), 1], PRIME)
        return bool(polynomial.gcd(polynomial.derivative()).degree() > 0)

    def replaced(self, image: Callable[[Factored], Factored]) -> Dispersion:
        """Return the law with every coefficient replaced."""

        def rows(matrix: Sequence[Sequence[Factored]]) -> tuple[tuple[Factored, ...], ...]:
            return tuple(tuple(map(image, row)) for row in matrix)

        own = self.singular
        return replace(
            self,
            characteristic=tuple(map(image, self.characteristic)),
            shift=image(self.shift),
            matrix=rows(self.matrix),
            start=tuple(map(image, self.start)),
            meets=tuple(map(image, self.meets)),
            singular=own and replace(own, matrix=rows(own.matrix), values=rows(own.values)),
        )

    def roots(self, c: Sequence[Value], square_root: Callable[[Value], Value]) -> dict[str, Value]:
        """Return the wavenumbers by name on any branch, given ``c_0, ...``, numbers or series."""
        wavenumbers: tuple[Value, ...] = ()
        match self.kind:
            case "wave":
                wavenumbers = (square_root(-c[0]),)
            case "bending":
                wavenumbers = (square_root(square_root(c[0] / 4)),)
            case "pair":
                middle = -c[2] / 2
                root = square_root(middle * middle - c[0])
                wavenumbers = (square_root(middle + root), square_root(middle - root))
        return dict(zip(self.wavenumbers, wavenumbers, strict=True))


@dataclass(frozen=True, slots=True, eq=False)
class Kernel:
    """A generator that is a transcendental function of s."""

    generator: str  # its name in the ring
    # ``cosh``, ``sinh``, ``cos``, ``sin`` of wavenumber times length; ``exp`` for ``exp(-shift*length)``;
    # ``fundamental`` for the derivative of the given order, at x = length, of the solution h of the
    # characteristic equation with ``h(0) = ... = h^(n-2)(0) = 0`` and ``h^(n-1)(0) = 1``; ``entry`` for one
    # of Z(start + length), where ``Z' = A Z`` and Z(start) is the unit matrix.
    function: KernelFunction
    dispersion: Dispersion  # whose wavenumber it is a function of
    wavenumber: str  # generator of the wavenumber; empty for ``exp``, ``fundamental`` and ``entry``
    length: Factored  # [m]; of the parameters alone. For a delay, a time [s].
    order: int = 0  # of the derivative, for ``fundamental``; of an ``entry`` its number, row by row


@dataclass(frozen=True, slots=True, eq=False)
class KernelTable:
    """All dispersions and kernels of one ring: wavenumbers stand before kernels, all else before both."""

    dispersions: tuple[Dispersion, ...] = ()
    kernels: tuple[Kernel, ...] = ()

    def __bool__(self) -> bool:
        return bool(self.dispersions)

    def without_tapers(
        self, what: str, hint: str = "poles, zeros and frequency responses are available"
    ) -> None:
        """Return if no coefficient varies along x; else SF910: ``what`` is not available."""
        tapered = next((d for d in self.dispersions if d.matrix), None)
        if tapered is not None:
            message = f"{what} not available yet where coefficients vary along x, as in '{tapered.name}'"
            raise ModelError(Diagnostic("SF910", message, None, hint))

    @property
    def wavenumbers(self) -> tuple[str, ...]:
        """Generators of the wavenumbers."""
        return tuple(w for d in self.dispersions for w in d.wavenumbers)

    @property
    def generators(self) -> tuple[str, ...]:
        """Generators of wavenumbers and then of kernels."""
        return (*self.wavenumbers, *(k.generator for k in self.kernels))

    @property
    def coefficients(self) -> tuple[Factored, ...]:
        """The coefficients of all laws."""
        return tuple(v for d in self.dispersions for v in d.coefficients)

    @property
    def values(self) -> tuple[Factored, ...]:
        """All that wavenumbers and kernels are made of: coefficients and lengths."""
        return (*self.coefficients, *(k.length for k in self.kernels))

    def restricted(self, names: Container[str]) -> KernelTable:
        """Return the table of the dispersions of which some generator is among the names."""
        kept = {
            d
            for d in self.dispersions
            if any(n in names for n in (*d.wavenumbers, *(k.generator for k in self.kernels_of(d))))
        }
        return KernelTable(
            tuple(d for d in self.dispersions if d in kept),
            tuple(k for k in self.kernels if k.dispersion in kept),
        )

    def kernels_of(self, dispersion: Dispersion) -> tuple[Kernel, ...]:
        """Return the kernels of one dispersion, in order."""
        return tuple(k for k in self.kernels if k.dispersion is dispersion)

    @property
    def pairs(self) -> tuple[tuple[Kernel, Kernel], ...]:
        """The even and the odd function, cosh and sinh or cos and sin, of every argument."""
        odd = {"cosh": "sinh", "cos": "sin"}
        by_argument: dict[tuple[str, str, Factored], Kernel] = {
            (k.function, k.wavenumber, k.length): k for k in self.kernels
        }
        return tuple(
            (k, by_argument[odd[k.function], k.wavenumber, k.length])
            for k in self.kernels
            if k.function in odd
        )

    def embedded(self, images: Iterable[tuple[Factored, Factored]]) -> KernelTable:
        """Return the table with its values replaced, by identity."""
        mapped = dict(images)
        dispersions = {d: d.replaced(mapped.__getitem__) for d in self.dispersions}
        return KernelTable(
            tuple(dispersions.values()),
            tuple(
                replace(k, dispersion=dispersions[k.dispersion], length=mapped[k.length])
                for k in self.kernels
            ),
        )


NO_KERNELS = KernelTable()  # the table of a lumped system

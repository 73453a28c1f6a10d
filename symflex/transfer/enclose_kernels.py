"""Values of wavenumbers and kernels in balls, at a complex frequency or as a Taylor series about one.

Input: a kernel table whose coefficients are polynomials in s and constants with known enclosures.
Output: one value per generator of the ring, wavenumbers and kernels included.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from flint import acb, acb_mat, acb_series

from symflex.transfer.balls import ball

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from flint import arb, fmpz_mpoly

    from symflex.kernels import Dispersion, Factored, Kernel, KernelTable

Value = acb | acb_series
"""A number, or a power series in the displacement from one."""


@dataclass(frozen=True, eq=False)
class KernelValues:
    """Evaluates a ring of wavenumbers and kernels at the current precision.

    Parameters
    ----------
    names : sequence of str
        Generators of the ring: s, constants, wavenumbers, kernels.
    table : KernelTable
        Over the same ring.
    constants : mapping of str to arb
        Enclosures of the constants.
    """

    names: Sequence[str]
    table: KernelTable
    constants: Mapping[str, arb]

    def at(self, s: Value) -> dict[str, Value]:
        """Return the values of all generators at ``s`` [rad/s]."""
        values: dict[str, Value] = {"s": s, **{name: acb(value) for name, value in self.constants.items()}}
        coefficients: dict[int, tuple[Value, ...]] = {}
        shifts: dict[int, Value] = {}
        for law in self.table.dispersions:
            found = tuple(self.value(c, values) for c in law.characteristic)
            coefficients[id(law)] = found
            shifts[id(law)] = self.value(law.shift, values)
            values.update(zip(law.wavenumbers, _wavenumbers(law, found), strict=True))
        fundamental: dict[tuple[int, int], tuple[Value, ...]] = {}
        for kernel in self.table.kernels:
            length = self.value(kernel.length, values)
            law = kernel.dispersion
            if kernel.function == "exp":
                values[kernel.generator] = (-shifts[id(law)] * length).exp()
            elif kernel.function == "fundamental":
                key = (id(law), id(kernel.length))
                if key not in fundamental:
                    fundamental[key] = fundamental_functions(coefficients[id(law)], length)
                values[kernel.generator] = fundamental[key][kernel.order]
            else:
                values[kernel.generator] = _kernel(kernel, values[kernel.wavenumber] * length)
        return values

    def value(self, value: Factored, values: Mapping[str, Value]) -> Value:
        """Return a product of powers of polynomials."""
        total: Value = acb(ball(value.unit))
        for factor, exponent in value.factors:
            total = total * _power(self.polynomial(factor, values), exponent)
        return total

    def polynomial(self, polynomial: fmpz_mpoly, values: Mapping[str, Value]) -> Value:
        """Return a polynomial of the ring."""
        total: Value = acb(0)
        powers: dict[tuple[int, int], Value] = {}
        for monomial, coefficient in polynomial.terms():
            term: Value = acb(coefficient)
            for i, exponent in enumerate(monomial):
                if exponent:
                    key = (i, int(exponent))
                    if key not in powers:
                        powers[key] = _power(values[self.names[i]], int(exponent))
                    term = term * powers[key]
            total = total + term
        return total


def _power(base: Value, exponent: int) -> Value:
    if isinstance(base, acb):
        return base**exponent
    result: Value = base
    for _ in range(abs(exponent) - 1):
        result = result * base
    return 1 / result if exponent < 0 else result


def _wavenumbers(law: Dispersion, c: Sequence[Value]) -> tuple[Value, ...]:
    """Return the roots by their names; every branch serves, because functions are symmetric in them."""
    match law.kind:
        case "wave":
            return ((-c[0]).sqrt(),)
        case "bending":
            return ((c[0] / 4).sqrt().sqrt(),)
        case "pair":
            middle = -c[2] / 2
            root = (middle * middle - c[0]).sqrt()
            return ((middle + root).sqrt(), (middle - root).sqrt())
    return ()


def _kernel(kernel: Kernel, argument: Value) -> Value:
    match kernel.function:
        case "cosh" | "sinh" if isinstance(argument, acb):
            return argument.cosh() if kernel.function == "cosh" else argument.sinh()
        case "cosh" | "sinh":
            grown, decayed = argument.exp(), (-argument).exp()
            return (grown + decayed) / 2 if kernel.function == "cosh" else (grown - decayed) / 2
    return argument.cos() if kernel.function == "cos" else argument.sin()


def fundamental_functions(coefficients: Sequence[Value], length: Value) -> tuple[Value, ...]:
    """Return ``h, h', ..., h^(n-1)`` at a length for ``lambda^n + ... + c_0``.

    They are the last column of the exponential of the companion matrix times the length.
    """
    n = len(coefficients)
    numbers = [c for c in coefficients if isinstance(c, acb)]
    if len(numbers) == n and isinstance(length, acb):
        companion = acb_mat(n, n)
        for i in range(n - 1):
            companion[i, i + 1] = acb(1)
        for j, number in enumerate(numbers):
            companion[n - 1, j] = -number
        grown = (companion * length).exp()
        return tuple(grown[i, n - 1] for i in range(n))
    # First order about a point: the derivative of h with respect to c_k is minus h * h^(k), a convolution,
    # and is the block above the diagonal of the exponential of a block matrix (Van Loan 1978).
    base = [c[0] if isinstance(c, acb_series) else c for c in coefficients]
    slope = [c[1] if isinstance(c, acb_series) else acb(0) for c in coefficients]
    reach = length[0] if isinstance(length, acb_series) else length
    block = acb_mat(2 * n, 2 * n)
    for offset in (0, n):
        for i in range(n - 1):
            block[offset + i, offset + i + 1] = acb(1)
        for j, c in enumerate(base):
            block[offset + n - 1, offset + j] = -c
    for j, c in enumerate(slope):
        block[n - 1, n + j] = -c
    grown = (block * reach).exp()
    return tuple(acb_series([grown[i, n - 1], grown[i, 2 * n - 1]], 2) for i in range(n))


def expansion(s: acb) -> acb_series:
    """Return ``s + x`` to first order in x."""
    return acb_series([s, acb(1)], 2)

"""A product of polynomials in s with exact coefficients."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb, arb_poly, fmpz_mpoly, fmpz_mpoly_ctx

from symflex.algebra import Ring, degree_in
from symflex.errors import Diagnostic, ModelError, UncertifiedError
from symflex.roots.precision import precision
from symflex.transfer import BoundTransferFunction, coefficients_in_s

ZERO_TEST_BITS = (64, 256, 1024, 4096)
"""At which a coefficient is compared with zero, one after the other."""


@dataclass(frozen=True, slots=True)
class RealConstant:
    """A real number that exact steps treat as an independent symbol."""

    name: str  # such as ``pi`` or ``sqrt(2)``; equal names are the same constant
    evaluate: Callable[[], arb]  # returns the constant as a real ball at the current ``flint.ctx.prec``


@dataclass(frozen=True, slots=True)
class PolynomialInS:
    """A polynomial in s whose coefficients are integer polynomials in real constants; SF403 for zero.

    Examples
    --------
    >>> from fractions import Fraction
    >>> p = PolynomialInS.from_rationals([Fraction(1, 2), 0, Fraction(1, 3)])
    >>> p.degree, p.integers()
    (2, (3, 0, 2))
    """

    # In ascending powers of s, all in ``context``; trailing zeros are dropped.
    coefficients: tuple[fmpz_mpoly, ...]
    context: fmpz_mpoly_ctx  # ring of the coefficients; generator number i stands for ``constants[i]``
    # One for each generator; empty when all coefficients are integers.
    constants: tuple[RealConstant, ...] = ()

    def __post_init__(self) -> None:
        if len(self.constants) != self.context.nvars():
            message = f"{self.context.nvars()} generators but {len(self.constants)} constants"
            raise ValueError(message)
        length = len(self.coefficients)
        while length and self.coefficients[length - 1].is_zero():
            length -= 1
        if length == 0:
            raise ModelError(Diagnostic("SF403", "the polynomial is zero: every s is a root of it"))
        object.__setattr__(self, "coefficients", tuple(self.coefficients[:length]))

    @classmethod
    def from_rationals(cls, coefficients: Sequence[Fraction | int]) -> PolynomialInS:
        """Return the polynomial with these ascending coefficients, scaled to integers."""
        scale = math.lcm(*(c.denominator for c in coefficients))
        return cls.from_integers([int(c * scale) for c in coefficients])

    @classmethod
    def from_integers(cls, coefficients: Sequence[int]) -> PolynomialInS:
        """Return the polynomial with these ascending integer coefficients."""
        context = fmpz_mpoly_ctx.get([], "lex")
        return cls(tuple(context.constant(c) for c in coefficients), context)

    @property
    def degree(self) -> int:
        """Degree in s."""
        return len(self.coefficients) - 1

    @property
    def is_exact(self) -> bool:
        """Whether every coefficient is an integer."""
        return not self.constants

    def integers(self) -> tuple[int, ...]:
        """Return the ascending coefficients of a polynomial without constants."""
        if self.constants:
            message = "the coefficients contain constants"
            raise ValueError(message)
        return tuple(int(c.to_dict().get((), 0)) for c in self.coefficients)

    def enclosure(self) -> arb_poly:
        """Return the polynomial with coefficients as balls, at the current ``flint.ctx.prec``."""
        if self.is_exact:
            return arb_poly([arb(c) for c in self.integers()])
        values = tuple(constant.evaluate() for constant in self.constants)
        return arb_poly([_evaluate(c, values) for c in self.coefficients])

    def require_leading_coefficient(self) -> None:
        """Prove that the leading coefficient is not zero.

        SF401 when balls of 4096 bits still contain zero, as they do when the constants satisfy a relation
        that makes the coefficient vanish.
        """
        if self.is_exact:
            return
        for bits in ZERO_TEST_BITS:
            with precision(bits):
                values = tuple(constant.evaluate() for constant in self.constants)
                if _evaluate(self.coefficients[-1], values) != 0:
                    return
        message = f"cannot tell whether the coefficient {self.coefficients[-1]} of s^{self.degree} is zero"
        hint = "its constants seem to satisfy a relation; write the coefficient without it"
        raise UncertifiedError(Diagnostic("SF401", message, hint=hint))


def _evaluate(coefficient: fmpz_mpoly, values: tuple[arb, ...]) -> arb:
    total = arb(0)
    for exponents, integer in coefficient.to_dict().items():
        term = arb(integer)
        for value, exponent in zip(values, exponents, strict=True):
            if exponent:
                term *= value ** int(exponent)
        total += term
    return total


@dataclass(frozen=True, slots=True)
class RootProblem:
    """The roots of a product of powers of polynomials."""

    # Polynomials with positive exponents; they need not be coprime nor square-free.
    factors: tuple[tuple[PolynomialInS, int], ...]

    def __post_init__(self) -> None:
        if any(exponent < 1 for _, exponent in self.factors):
            message = "exponents of factors are positive"
            raise ValueError(message)

    @classmethod
    def from_rationals(cls, coefficients: Sequence[Fraction | int]) -> RootProblem:
        """Return the problem of one polynomial with these ascending coefficients."""
        return cls(((PolynomialInS.from_rationals(coefficients), 1),))

    @property
    def degree(self) -> int:
        """Number of roots, counted with multiplicity."""
        return sum(polynomial.degree * exponent for polynomial, exponent in self.factors)


def polynomial_in_s(bound: BoundTransferFunction, factor: fmpz_mpoly) -> PolynomialInS:
    """Return a factor without wavenumbers and kernels as a polynomial in s."""
    constants = tuple(RealConstant(name, evaluate) for name, evaluate in bound.constants)
    ring = bound.ratio.ring
    used = tuple(c for c in constants if degree_in(factor, ring.index[c.name]))
    small = Ring(("s", *(c.name for c in used)))
    places = [ring.index[name] for name in small.names]
    terms = {tuple(int(m[i]) for i in places): int(c) for m, c in factor.terms()}
    coefficients = Ring(small.names[1:])
    polynomial = small.context.from_dict(terms)
    return PolynomialInS(coefficients_in_s(polynomial, coefficients), coefficients.context, used)


def problem_of(bound: BoundTransferFunction, factors: Iterable[tuple[fmpz_mpoly, int]]) -> RootProblem:
    """Return what roots powers of factors without wavenumbers and kernels have, those that depend on s."""
    polynomials = [(polynomial_in_s(bound, f), e) for f, e in factors]
    return RootProblem(tuple((p, e) for p, e in polynomials if p.degree > 0))

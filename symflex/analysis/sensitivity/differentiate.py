"""The derivatives of poles and zeros with respect to parameters, by implicit differentiation.

Input: a transfer function with the parameters as symbols, their values, and the roots found with numbers.
Output: a :class:`RootDerivative` per root and parameter.

What is differentiated is the factor of the numerator or denominator that makes the root: a
:class:`RootBranch`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

from flint import acb

from symflex.algebra import square_free_factors
from symflex.algebra.origin import OriginSeries
from symflex.analysis.sensitivity.sensitivity import RootDerivative
from symflex.analysis.sensitivity.tangents import Tangents
from symflex.budget import spend
from symflex.roots.precision import bits_for_digits, precision
from symflex.roots.root import exact_fraction

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from fractions import Fraction

    from flint import fmpz_mpoly

    from symflex.algebra import Factored
    from symflex.analysis.sensitivity.sensitivity import Kind, Status
    from symflex.analysis.sensitivity.tangents import Tangents
    from symflex.model import ExactValue, ModelParameter
    from symflex.roots import PoleZeroMap, Root
    from symflex.transfer import TransferFunction


ROUNDS = 4
"""Doublings of the precision before a derivative that is nearly zero is taken as it is."""


def differentiate(
    tf: TransferFunction,
    values: Mapping[str, ExactValue],
    found: PoleZeroMap,
    parameters: Sequence[ModelParameter] | None = None,
    digits: int = 15,
) -> tuple[RootDerivative, ...]:
    """Return how poles and zeros move with parameters: poles first, each with all parameters.

    ``tf`` has the parameters as symbols, ``found`` its roots at the values; by default all parameters that
    occur are taken. A root at 0 that is there for all values of the parameters has the derivative 0, exactly.
    Where the significant digits wanted of a derivative take too long, fewer are certified.
    """
    used = [p for p in tf.parameters if parameters is None or p in parameters]
    if tf.ratio.is_zero:
        return ()
    tangents = Tangents(tf, values)
    sides: tuple[tuple[Kind, Factored, Sequence[Root]], ...] = (
        ("pole", tf.den, found.poles),
        ("zero", tf.num, found.zeros),
    )
    moved: list[RootDerivative] = []
    for kind, part, roots in sides:
        side = _Side(tangents, part, digits, {})
        for i, root in enumerate(roots):
            for parameter in used:
                spend()
                status, place, derivative = side.moved(root, parameter.name)
                value = values[parameter.name]
                moved.append(RootDerivative(kind, i, root, parameter, value, status, place, derivative))
    return tuple(moved)


Movement = tuple["Status", acb, "acb | None"]


@dataclass(frozen=True, slots=True, eq=False)
class _Side:
    """A numerator or denominator; what is known of its roots is kept, the upper of each pair."""

    tangents: Tangents
    part: Factored
    digits: int
    branches: dict[tuple[Fraction, Fraction], RootBranch | Obstacle]

    def moved(self, root: Root, parameter: str) -> Movement:
        """Return the status, the place and the derivative of a root."""
        if root.im < 0:
            with precision(root.working_bits()):
                upper = replace(root, im=-root.im)
            status, place, derivative = self.moved(upper, parameter)
            return status, _conjugate(place), None if derivative is None else _conjugate(derivative)
        if root.is_zero and self._is_fixed_at_zero(root):
            return "certified", acb(0), acb(0)
        key = (exact_fraction(root.re), exact_fraction(root.im))
        if key not in self.branches:
            self.branches[key] = find_branch(self.tangents, self.part, root)
        branch = self.branches[key]
        if not isinstance(branch, RootBranch):
            return branch, root.enclosure(), None
        wanted = bits_for_digits(self.digits)
        bits = max(root.working_bits(), 2 * wanted)
        derivative = None
        for _ in range(ROUNDS):
            closer = branch.refined(bits)
            if closer is None:
                return "undecided", root.enclosure(), None
            branch = self.branches[key] = closer
            derivative = branch.derivative(parameter, bits)
            if derivative.is_finite() and derivative.rel_accuracy_bits() >= wanted:
                break
            bits *= 2
        if derivative is None or not derivative.is_finite():
            return "undecided", branch.root, None
        return "certified", branch.root, derivative

    def _is_fixed_at_zero(self, root: Root) -> bool:
        """Tell whether for all values of the parameters as many roots are at 0 as for these."""
        ring, table = self.tangents.tf.ratio.ring, self.tangents.tf.kernels
        if not table:
            return self.part.exponent_of(ring.context.gen(0)) == root.multiplicity
        return OriginSeries(ring, table).order(self.part) == root.multiplicity


def _conjugate(value: acb) -> acb:
    with precision(max(2, value.bits())):
        return value.conjugate()


Obstacle = Literal["multiple", "undecided"]

ROUNDS_OF_ROOTS = 4
"""After so many doublings of the precision, rounding is no longer the reason."""


@dataclass(frozen=True, slots=True, eq=False)
class RootBranch:
    """A function of s and the parameters that is zero at a root while its derivative in s is not.

    By the implicit function theorem the root is then a differentiable function of the parameters.
    """

    tangents: Tangents  # evaluates the function
    factor: fmpz_mpoly  # the function
    root: acb  # holds one root of it [rad/s]

    def refined(self, bits: int) -> RootBranch | None:
        """Return the branch with the root to about so many bits, ``None`` when it holds no root after all.

        Interval Newton steps ``m - f(m)/f'(X)`` (Moore 1966), which keep every root of X.
        """
        with precision(bits):
            root = self.root
            for _ in range(bits.bit_length()):
                middle = root.mid()
                value, _ = self.tangents.polynomial(self.factor, self.tangents.along("s", middle))
                _, slope = self.tangents.polynomial(self.factor, self.tangents.along("s", root))
                step = middle - value / slope
                if not step.is_finite():
                    break
                if not step.overlaps(root):
                    return None
                closer = acb(step.real.intersection(root.real), step.imag.intersection(root.imag))
                if not closer.rad() < root.rad() / 2:
                    break
                root = closer
            return RootBranch(self.tangents, self.factor, root)

    def derivative(self, parameter: str, bits: int) -> acb:
        """Return ``ds/dp = -(df/dp)/(df/ds)`` at the current enclosure of the root."""
        with precision(bits):
            along_s, along_p = (self.tangents.along(name, self.root) for name in ("s", parameter))
            _, slope = self.tangents.polynomial(self.factor, along_s)
            _, change = self.tangents.polynomial(self.factor, along_p)
            return -change / slope


def find_branch(tangents: Tangents, part: Factored, root: Root) -> RootBranch | Obstacle:
    """Return the factor of a numerator or denominator that alone is zero at a root, and simply.

    Else ``"multiple"``, where a root of higher multiplicity splits, or several factors meet in it: it has no
    derivative; or ``"undecided"``, where the enclosure of the root does not tell.
    """
    place, bits = root.enclosure(), root.working_bits()
    for _ in range(ROUNDS_OF_ROOTS):
        found = _meeting(tangents, [f for f, _ in part.factors], place, bits)
        if found is not None and len(found) == 1 and root.multiplicity > 1:
            # Twice the same factor, multiplied out: such a root stays double, and moves.
            _, square_free = square_free_factors(found[0])
            found = _meeting(tangents, [f for f, _ in square_free], place, bits)
        if found is not None and len(found) == 1 and _is_simple(tangents, found[0], place, bits):
            return RootBranch(tangents, found[0], place)
        if found == []:
            return "undecided"
        bits *= 2
    return "multiple" if root.multiplicity > 1 and root.certified else "undecided"


def _meeting(tangents: Tangents, factors: Sequence[fmpz_mpoly], s: acb, bits: int) -> list[fmpz_mpoly] | None:
    """Return the factors that may be zero at a root, ``None`` when some have no value there."""
    with precision(bits):
        point = tangents.along("s", s)
        values = [(f, tangents.polynomial(f, point)[0]) for f in factors]
    if not all(value.is_finite() for _, value in values):
        return None
    return [f for f, value in values if value.contains(0)]


def _is_simple(tangents: Tangents, factor: fmpz_mpoly, s: acb, bits: int) -> bool:
    with precision(bits):
        _, slope = tangents.polynomial(factor, tangents.along("s", s))
        return slope.is_finite() and not slope.contains(0)

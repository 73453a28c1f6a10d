"""The factor of a numerator or denominator that makes a root, and the root as precisely as asked for.

Input: a product of factors with symbols, and a root of it found with numbers.
Output: a :class:`Branch`, which can be differentiated, or why there is none.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from flint import acb

from symflex.algebra import square_free_factors
from symflex.roots.precision import precision

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flint import fmpz_mpoly

    from symflex.algebra import Factored
    from symflex.analysis.sensitivity.tangents import Tangents
    from symflex.roots import Root

Obstacle = Literal["multiple", "undecided"]

ROUNDS = 4
"""Doublings of the precision after which rounding is no reason any more."""


@dataclass(frozen=True, slots=True, eq=False)
class Branch:
    """A function of s and the parameters that is zero at a root while its derivative in s is not.

    By the implicit function theorem the root is then a differentiable function of the parameters.

    Parameters
    ----------
    tangents : Tangents
        Evaluates the function.
    factor : fmpz_mpoly
        The function.
    root : acb
        Holds one root of it [rad/s].
    """

    tangents: Tangents
    factor: fmpz_mpoly
    root: acb

    def refined(self, bits: int) -> Branch | None:
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
            return Branch(self.tangents, self.factor, root)

    def derivative(self, parameter: str, bits: int) -> acb:
        """Return ``ds/dp = -(df/dp)/(df/ds)`` at the current enclosure of the root."""
        with precision(bits):
            along_s, along_p = (self.tangents.along(name, self.root) for name in ("s", parameter))
            _, slope = self.tangents.polynomial(self.factor, along_s)
            _, change = self.tangents.polynomial(self.factor, along_p)
            return -change / slope


def find_branch(tangents: Tangents, part: Factored, root: Root) -> Branch | Obstacle:
    """Return the factor of a numerator or denominator that alone is zero at a root, and simply.

    Parameters
    ----------
    tangents : Tangents
        Of the transfer function the part belongs to.
    part : Factored
        Its numerator or denominator.
    root : Root
        Of the part with numbers.

    Returns
    -------
    Branch or str
        ``"multiple"`` where a root of higher multiplicity splits, or several factors meet in it: it has no
        derivative. ``"undecided"`` where the enclosure of the root does not tell.
    """
    place, bits = root.enclosure(), root.working_bits()
    for _ in range(ROUNDS):
        found = _meeting(tangents, [f for f, _ in part.factors], place, bits)
        if found is not None and len(found) == 1 and root.multiplicity > 1:
            # Twice the same factor, multiplied out: such a root stays double, and moves.
            _, square_free = square_free_factors(found[0])
            found = _meeting(tangents, [f for f, _ in square_free], place, bits)
        if found is not None and len(found) == 1 and _is_simple(tangents, found[0], place, bits):
            return Branch(tangents, found[0], place)
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

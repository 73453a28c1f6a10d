"""Residues: how much of each mode a transfer function holds.

Input: a bound transfer function and a region. Output: a :class:`Residue` per pole.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.analysis.rational.laurent import expand_at_pole, expand_at_zero
from symflex.budget import spend
from symflex.errors import Diagnostic, UncertifiedError
from symflex.roots import precision
from symflex.roots.functions.vanishing import without_lengths_of_zero
from symflex.roots.locate import locate
from symflex.roots.root import GUARD_BITS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flint import acb

    from symflex.roots import Budget, Region, Root
    from symflex.transfer import BoundTransferFunction


@dataclass(frozen=True, slots=True)
class Residue:
    """The principal part of a transfer function at one of its poles p.

    Parameters
    ----------
    root : Root
        The pole.
    pole : acb
        Its enclosure, refined [rad/s].
    coefficients : tuple of acb
        Enclosures of the coefficients of ``1/(s - p)``, ``1/(s - p)^2``, ... up to the pole's order.
    is_estimate : bool
        The pole could not be told from others, or the residue is not proved.
    """

    root: Root
    pole: acb
    coefficients: tuple[acb, ...]
    is_estimate: bool

    @property
    def value(self) -> acb:
        """The residue, the coefficient of ``1/(s - p)``, in the transfer function's unit times rad/s."""
        return self.coefficients[0]

    def conjugate(self, root: Root) -> Residue:
        """Return the residue at the conjugate pole."""
        # What arithmetic returns is rounded to the working precision.
        with precision(max(c.bits() for c in (self.pole, *self.coefficients)) + GUARD_BITS):
            conjugates = tuple(c.conjugate() for c in self.coefficients)
            return Residue(root, self.pole.conjugate(), conjugates, self.is_estimate)


def find_residues(
    bound: BoundTransferFunction,
    region: Region | None = None,
    digits: int = 15,
    budget: Budget | None = None,
) -> tuple[Residue, ...]:
    r"""Return the principal parts at the poles in a region.

    Parameters
    ----------
    bound : BoundTransferFunction
        With numbers.
    region : Region, optional
        As for :func:`symflex.roots.locate.locate`.
    digits : int
        Significant digits of every coefficient that is not zero.
    budget : Budget, optional
        Limits the search for the poles.

    Returns
    -------
    tuple of Residue
        In the order of the poles; both members of a conjugate pair.

    Raises
    ------
    UncertifiedError
        SF405 when poles cannot be told apart, or the behaviour at one cannot be told.
    BudgetError
        SF505, SF506 when the search for the poles takes too long; see
        :meth:`symflex.roots.PoleZeroMap.complete`.

    Examples
    --------
    >>> from symflex import pipeline
    >>> model = pipeline.loads('symflex = 1\ninputs.u = {}\noutputs.y = "(s + 3)/(s^2*(s + 1))*u"')
    >>> for residue in find_residues(pipeline.derive_bound(model, [("y", "u")])[0]):
    ...     print([round(float(c.real.mid()), 12) for c in residue.coefficients])
    [-2.0, 3.0]
    [2.0]
    """
    bound = without_lengths_of_zero(bound)
    return residues_at(bound, locate(bound, region, digits, budget).complete().all_poles, digits)


def residues_at(bound: BoundTransferFunction, poles: Sequence[Root], digits: int) -> tuple[Residue, ...]:
    """Return the principal parts at known poles; see :func:`find_residues`."""
    found: list[Residue] = []
    for root in poles:
        spend()
        upper = next((r for r in found if _are_conjugate(r.root, root)), None)
        if upper is not None:
            found.append(upper.conjugate(root))
        elif root.is_zero:
            found.append(_at_zero(bound, root, digits))
        else:
            pole, series = expand_at_pole(bound, root, digits)
            found.append(Residue(root, pole, series.principal_part, series.is_estimate))
    return tuple(found)


def _at_zero(bound: BoundTransferFunction, root: Root, digits: int) -> Residue:
    series = expand_at_zero(bound, -1, digits)
    if series.order != -root.multiplicity:
        message = f"the order of the pole of {bound.name} at s = 0 is {root.multiplicity} or {-series.order}"
        raise UncertifiedError(Diagnostic("SF405", message))
    is_estimate = series.is_estimate or not root.certified
    return Residue(root, root.enclosure(), series.principal_part, is_estimate)


def _are_conjugate(a: Root, b: Root) -> bool:
    """Tell whether two roots, each apart from all others, are a conjugate pair."""
    return not a.is_real and bool(a.re.overlaps(b.re)) and bool(a.im.overlaps(-b.im))

"""What is made of polynomials again and again, made once."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Generic, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable

    from flint import fmpz_mpoly

Made = TypeVar("Made")


@dataclass(frozen=True, eq=False)
class PolynomialMemo(Generic[Made]):
    """A function of polynomials that remembers its values.

    The engine's polynomials have no hash, so the same object is known again, and not an equal one.

    Examples
    --------
    >>> from symflex.algebra import Ring
    >>> s = Ring(("s",)).generator("s")
    >>> memo = PolynomialMemo(lambda polynomial: [len(polynomial)])
    >>> memo(s), memo(s) is memo(s)
    ([1], True)
    """

    make: Callable[[fmpz_mpoly], Made]  # the function
    _known: dict[int, tuple[fmpz_mpoly, Made]] = field(default_factory=dict)

    def __call__(self, polynomial: fmpz_mpoly) -> Made:
        """Return the value for a polynomial."""
        known = self._known.get(id(polynomial))
        if known is None:
            # The polynomial is kept as well: as long as it lives, its id is its own.
            known = self._known[id(polynomial)] = (polynomial, self.make(polynomial))
        return known[1]

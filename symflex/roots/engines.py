"""All engines that find roots, in the order in which they are asked.

    s^2 + 6 s + 5                      guessed by durand-kerner, where that fails by laguerre
    a chain of 200 masses, degree 400  guessed by laguerre
    an undamped beam                   lossless: sign changes on the axes, and a count on an arc
    the same with a dashpot            guess-and-prove: cells counted in doubles, every root found proved, one
                                       certified count of all of them
    where that count says otherwise    subdivision: every cell is counted with proof

Every root is certified whoever found it; a poor engine costs time and never a wrong root.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

from symflex.roots.counting.winding import Cell, Winding
from symflex.roots.plane.search import RootSearch
from symflex.roots.polynomials.discs import Proposer, propose_by_durand_kerner, propose_by_laguerre

if TYPE_CHECKING:
    from symflex.roots.axes.lossless import LosslessSearch
    from symflex.roots.counting.argument_principle import CertifiedWinding
    from symflex.roots.functions.kernel_function import KernelFunction

    Start = Callable[["Sought"], Iterator[RootSearch | LosslessSearch]]

POLYNOMIAL = "polynomial"  # what stands in a certificate where engines are chosen by degree
LOSSLESS = "lossless"
GUESS_AND_PROVE = "guess-and-prove"
SUBDIVISION = "subdivision"


@dataclass(frozen=True, slots=True)
class Guess:
    """An engine that guesses all roots of a polynomial."""

    propose: Proposer  # returns one guess per root in the upper half-plane, ``None`` where it does not settle
    best_to: float = inf  # degree up to which it is asked in its turn; beyond, after all others
    largest: float = inf  # degree beyond which it is not asked


@dataclass(frozen=True, slots=True)
class Sought:
    """A function with kernels whose roots are searched."""

    function: KernelFunction  # the function
    winding: CertifiedWinding[KernelFunction]  # counts its roots with proof
    order: int  # to which it vanishes at s = 0
    holes: tuple[Cell, ...]  # neighbourhoods of points where roots accumulate, left out
    digits: int  # significant digits of every root

    @property
    def mirrors(self) -> bool:
        """Whether samples on the axes are of one branch, as all branches are alike: their signs then tell."""
        return self.function.is_even and self.function.power == 1 and not self.holes

    def search(self, winding: Winding[KernelFunction]) -> RootSearch:
        """Return a search of the plane that counts as told."""
        return RootSearch(winding, self.holes, self.digits)


def without_losses(sought: Sought) -> Iterator[LosslessSearch]:
    """Isolate the roots of an undamped function in one dimension, on both axes; others are refused."""
    from symflex.roots.axes.lossless import lossless_search  # only with kernels

    search = lossless_search(sought.function, sought.order, sought.digits) if sought.mirrors else None
    if search is not None:
        yield search


def guess_and_prove(sought: Sought) -> Iterator[RootSearch]:
    """Look for roots in cells of the plane, counted in doubles."""
    yield sought.search(Winding(sought.function))


def subdivide(sought: Sought) -> Iterator[RootSearch]:
    """Cut cells of the plane, every count proved."""
    yield sought.search(sought.winding)


GUESSES: Mapping[str, Guess] = {
    # Measured: FLINT's takes 19 s for degree 400, Laguerre's 0.6 s; below 12 neither takes a millisecond.
    "durand-kerner": Guess(propose_by_durand_kerner, best_to=12, largest=64),
    "laguerre": Guess(propose_by_laguerre),
}
SEARCHES: Mapping[str, Start] = {
    LOSSLESS: without_losses,
    GUESS_AND_PROVE: guess_and_prove,
    SUBDIVISION: subdivide,
}
ROOT_FINDERS: Mapping[str, Guess | Start] = {**GUESSES, **SEARCHES}


def proposers_for(degree: int) -> tuple[Proposer, ...]:
    """Return what guesses the roots of a polynomial, one after the other until one settles.

    >>> [len(proposers_for(degree)) for degree in (4, 40, 400)]
    [2, 2, 1]
    """
    asked = [guess for guess in GUESSES.values() if degree <= guess.largest]
    return tuple(guess.propose for guess in sorted(asked, key=lambda guess: degree > guess.best_to))

"""Laurent series of networks that nobody writes out, from the series of their determinants in a disc.

Numerator and denominator are entire, and in a disc about 0 each is a polynomial but for an error that is
bounded there: so are, by Cauchy's estimate, the errors of its Taylor coefficients about any point inside.

    f(r x) = p(x) + e(x), abs(e) <= 1e-30:  about x = 1/2, that of x^2 is off by 1e-30/(1 - 1/2)^2 at most
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property, partial

from flint import acb

from symflex.balls import UndecidedError, bits_for_digits, current_bits, precision
from symflex.errors import Diagnostic, UncertifiedError
from symflex.roots.locate import equations_of
from symflex.roots.networks.cramer import CramerEquations
from symflex.roots.networks.disc_search import SERIES_BITS, DiscSearch, DiscSide
from symflex.roots.networks.disc_series import DiscSeries, ball_about_zero
from symflex.transfer import BoundNested
from symflex.transfer.equations_at import EssentialSingularityError

Taylor = Callable[[acb, int], list[acb] | None]  # as many coefficients at a point as are wanted
WIDER = 1.1  # than what holds the points asked for, the disc
FEWEST_MODES = 3  # modes in a disc of which only the behaviour at 0 is asked for


@dataclass(frozen=True, eq=False)
class NetworkSides:
    """Numerator and denominator of a network's transfer function in a disc, as precise as is asked for."""

    bound: BoundNested
    reach: float  # how far from 0 points are asked for [rad/s]
    _known: dict[int, tuple[DiscSeries, DiscSeries]] = field(default_factory=dict)  # by digits

    @cached_property
    def _cramer(self) -> CramerEquations:
        source = self.bound.source
        return CramerEquations.of(equations_of(self.bound), source.output.name, source.input.name)

    def _search(self, digits: int) -> tuple[DiscSearch, float]:
        """Return a search to so many digits, and the radius of its disc."""
        bits = SERIES_BITS + 2 * bits_for_digits(digits)
        search = DiscSearch(self._cramer, series_bits=bits)
        return search, WIDER * self.reach or search.radius_of(FEWEST_MODES)

    @contextmanager
    def _enclosed(self) -> Iterator[None]:
        try:
            yield
        except (EssentialSingularityError, UndecidedError) as error:
            message = f"the determinants of {self.bound.name} are not known as far out as its poles"
            raise UncertifiedError(Diagnostic("SF405", message, None, "ask for fewer modes")) from error

    def taylor(self, digits: int) -> tuple[Taylor, Taylor]:
        """Return the Taylor coefficients of both sides at points of the disc, if enclosed; else SF405."""
        if digits not in self._known:
            with self._enclosed():
                search, radius = self._search(digits)
                self._known[digits] = search.series(radius)
        den, num = self._known[digits]
        return partial(_coefficients, num), partial(_coefficients, den)

    def at_zero(self, digits: int) -> tuple[DiscSide, DiscSide]:
        """Return numerator and denominator, whose orders at 0 are proved; SF405 where they are not."""
        with self._enclosed():
            search, radius = self._search(digits)
            den, num = search.sides(radius)
        self._known.setdefault(digits, (den.series, num.series))
        if den.zero_reach or num.zero_reach:
            message = f"the behaviour of {self.bound.name} near s = 0 could not be determined"
            raise UncertifiedError(Diagnostic("SF405", message))
        return num, den


def _coefficients(series: DiscSeries, centre: acb, terms: int) -> list[acb] | None:
    with precision(max(current_bits(), series.bits)):
        x = centre / series.radius
        room = 1 - abs(x)
        if not room > 0:
            return None
        local = series.first_about(x, terms)
        return [(c + ball_about_zero(series.off / room**k)) / series.radius**k for k, c in enumerate(local)]

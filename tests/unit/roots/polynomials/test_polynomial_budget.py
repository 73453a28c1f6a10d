"""Searches for the roots of polynomials that are broken off: what they return is proved, and is not all."""

from fractions import Fraction
from itertools import count

from flint import fmpz_poly

from symflex.errors import BudgetError
from symflex.roots import (
    Band,
    Budget,
    Everything,
    Mode,
    Modes,
    PolynomialInS,
    RootProblem,
    find_pole_zero_map,
    find_polynomial_roots,
)
from tests.unit.roots.root_problems import problem, problem_of

DEGREE = 40
CHEBYSHEV = fmpz_poly.chebyshev_t(DEGREE)
SHIFTED = CHEBYSHEV(fmpz_poly([-2, 1]))
"""T_n(s - 2): all roots real, none at 0 and no symmetry."""
NEVER = RootProblem(())


def budget(calls):
    """A budget that is over after so many looks at the clock."""
    return Budget(calls, clock=count().__next__)


def broken_off(polynomials, calls, digits=20):
    """The roots found until then, ``None`` when the search ended before."""
    try:
        with budget(calls).entered():
            find_polynomial_roots(polynomials, digits)
    except BudgetError as error:
        assert error.diagnostics[0].code == "SF506"
        return error.found
    return None


def test_multiplicities_are_right_though_parts_are_missing():
    for calls in range(10, 300, 58):
        # s^3 (T_12(s - 2))^2 T_7(s - 4): roots at 0 three times, 12 double, 7 simple ones
        double, simple = fmpz_poly.chebyshev_t(12), fmpz_poly.chebyshev_t(7)
        product = double(fmpz_poly([-2, 1])) ** 2 * simple(fmpz_poly([-4, 1])) * fmpz_poly([0, 0, 0, 1])
        found = broken_off(problem_of(product), calls)
        assert found is None or all(root.certified for root in found), calls
        for root in found or ():
            assert root.multiplicity == (3 if root.is_zero else 2 if root.re < 3 else 1), calls


DONE = RootProblem(tuple((PolynomialInS.from_integers(c), 1) for c in ([4, 0, 1], [1, 1])))
"""s^2 + 4 and s + 1, which are done before the Chebyshev polynomial."""


def mapped(region, zeros=NEVER):
    both = RootProblem((*DONE.factors, *problem_of(SHIFTED).factors))
    with budget(100).entered():
        return find_pole_zero_map("y/u", both, zeros, region, 20)


def test_a_map_says_what_it_lost_and_keeps_to_its_region():
    result = mapped(Everything(), problem(4, 0, 1))
    certificate = result.certificate
    assert (certificate.counted, certificate.is_exceeded, certificate.code) == (45, True, "SF506")
    assert certificate.found == len(result.poles) == 3
    assert result.zeros == ()
    band = mapped(Band(Fraction(0), Fraction(161, 1000)))
    assert [root.decimal(2).re for root in band.poles] == ["-1.0"]
    # Which mode is the second is not known where some are missing; the lowest that were found are shown.
    second = mapped(Mode(2))
    assert (second.poles, second.certificate.found > 0) == ((), True)
    lowest = mapped(Modes(1))
    assert (len(lowest.poles), lowest.certificate.certified) == (1, False)

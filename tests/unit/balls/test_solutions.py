"""Starts lead to the solutions that belong to them, which are worked out by hand or by mpmath."""

import mpmath
import pytest
from flint import arb

from symflex.balls import precision
from symflex.balls.solutions import EquationSystem


def _cubic(x):
    return [x[0] ** 3 - 3 * x[0]]


def _slope_of_cubic(x):
    return [3 * x[0] ** 2 - 3]


# Roots 0 and +-sqrt(3), folds at +-1.
@pytest.mark.parametrize(
    ("start", "expected"),
    [(0.5, 0), (-0.999, 0), (1.1, mpmath.sqrt(3)), (50, mpmath.sqrt(3)), (-1.1, -mpmath.sqrt(3)), (1, None)],
)
def test_a_start_leads_to_the_root_between_the_same_folds(start, expected):
    with precision(256):
        found = EquationSystem(_cubic, _slope_of_cubic).followed([arb(start)])
        assert (found is None) == (expected is None)
        assert found is None or abs(float(found[0]) - float(expected)) < 1e-15
        assert found is None or found[0].rad() < 1e-38


@pytest.mark.parametrize("start", [0.01, 0.3, 0.65, 0.9, 2])
def test_rough_guesses_of_a_diode_lead_to_its_voltage(start):
    with precision(256):
        current, thermal, resistance = arb("1e-12"), arb("0.026"), 100

    def values(x):
        return [(x[0] - 5) / resistance + current * ((x[0] / thermal).exp() - 1)]

    def slopes(x):
        return [arb(1) / resistance + current / thermal * (x[0] / thermal).exp()]

    # With Lambert's function: v = E + R*I - U*W(R*I/U*exp((E + R*I)/U)).
    with precision(256), mpmath.workdps(30):
        drop = mpmath.mpf("1e-10")
        w = mpmath.lambertw(drop / mpmath.mpf("0.026") * mpmath.exp((5 + drop) / mpmath.mpf("0.026")))
        (found,) = EquationSystem(values, slopes).followed([arb(start)])
        assert abs(float(found) - float(5 + drop - mpmath.mpf("0.026") * w.real)) < 1e-14


def _toggle(x):
    return [4 / (1 + x[1] ** 2) - x[0], 4 / (1 + x[0] ** 2) - x[1]]


def _slopes_of_toggle(x):
    return [arb(-1), -8 * x[1] / (1 + x[1] ** 2) ** 2, -8 * x[0] / (1 + x[0] ** 2) ** 2, arb(-1)]


# x = 4/(1 + y^2), y = 4/(1 + x^2): x y = 1 and x + y = 4 off the diagonal, x^3 + x = 4 on it.
@pytest.mark.parametrize(
    ("start", "expected"),
    [
        ((3, 0.2), (2 + 3**0.5, 2 - 3**0.5)),
        ((0.2, 3), (2 - 3**0.5, 2 + 3**0.5)),
        ((1.2, 1.4), (1.3787967, 1.3787967)),
        ((5, 5), None),  # as far from one as from the other
    ],
)
def test_equations_of_two_unknowns_are_followed_together(start, expected):
    with precision(256):
        found = EquationSystem(_toggle, _slopes_of_toggle).followed([arb(x) for x in start])
        assert (None if found is None else [float(x) for x in found]) == (
            None if expected is None else pytest.approx(expected, rel=1e-7)
        )


def test_a_start_leads_nowhere_if_there_is_no_solution_or_a_pole_before_it():
    with precision(256):
        above = EquationSystem(lambda x: [x[0] ** 2 + 2], lambda x: [2 * x[0]])
        beyond = EquationSystem(lambda x: [1 / (1 - x[0]) + 1], lambda x: [1 / (1 - x[0]) ** 2])  # x = 2
        outside = EquationSystem(lambda x: [x[0].log()], lambda x: [1 / x[0]])
        assert above.followed([arb(1)]) is beyond.followed([arb(0)]) is outside.followed([arb(-1)]) is None
        assert float(beyond.followed([arb(3)])[0]) == float(outside.followed([arb(7)])[0]) + 1 == 2


def test_solutions_are_found_from_guesses_each_once():
    with precision(256):
        guesses = [[arb(k) / 3] for k in range(-9, 10)]
        found = EquationSystem(_cubic, _slope_of_cubic).near(guesses, [arb(1)])
        assert sorted(float(x) for (x,) in found) == pytest.approx([-(3**0.5), 0, 3**0.5], abs=1e-30)

"""Dynamic stiffness and own frequencies of a member against textbook formulas."""

from itertools import pairwise
from math import cos, cosh, floor, pi, sin, sinh, tan

import pytest
from flint import arb, ctx

from symflex.balls import UndecidedError
from symflex.roots.networks.members import MemberBalls


def member(entries, slopes, states, length=1.0):
    """Return a member from the entries of its matrix and their parts in lambda."""

    def table(values):
        return [[arb(values.get((i, j), 0)) for j in range(states)] for i in range(states)]

    return MemberBalls(table(entries), table(slopes), arb(length))


def beam(axial_force=0.0, foundation=0.0, rotary=0.0, shear=0.0, length=1.0):
    """Return a beam of unit bending stiffness and unit mass per length; states y, theta, f, tau."""
    entries = {(0, 1): 1, (1, 3): 1, (3, 2): -1, (2, 0): foundation, (3, 1): axial_force, (0, 2): shear}
    return member(entries, {(2, 0): -1, (3, 1): -rotary}, 4, length)


def rod(length=1.0):
    """Return a rod of unit stiffness and unit mass per length."""
    return member({(0, 1): 1}, {(1, 0): -1}, 2, length)


@pytest.fixture(autouse=True)
def working_precision():
    with ctx.workprec(128):
        yield


def test_a_beams_stiffness_is_that_of_the_textbooks():
    for beta in [0.5, 3.0, 4.7, 6.0, 20.0, 40.0]:
        # Clough & Penzien 1975, Dynamics of Structures: the dynamic stiffness of a uniform beam.
        c, s, ch, sh = cos(beta), sin(beta), cosh(beta), sinh(beta)
        d = 1 - c * ch
        found = beam().stiffness(arb(beta) ** 4)
        expected = {
            "start": [
                [beta**3 * (c * sh + s * ch), beta**2 * s * sh],
                [beta**2 * s * sh, beta * (s * ch - c * sh)],
            ],
            "across": [[-(beta**3) * (s + sh), beta**2 * (ch - c)], [-(beta**2) * (ch - c), beta * (sh - s)]],
        }
        for name, block in expected.items():
            for i, row in enumerate(block):
                for j, value in enumerate(row):
                    assert float(getattr(found, name)[i, j]) == pytest.approx(value / d, rel=1e-9), beta


def test_a_rods_stiffness_and_frequencies_are_those_of_the_textbooks():
    for omega in [0.3, 3.0, 3.2, 100.0]:
        found = rod().stiffness(arb(omega) ** 2)
        assert float(found.start[0, 0]) == pytest.approx(omega / tan(omega))
        assert float(found.across[0, 0]) == pytest.approx(-omega / sin(omega))
    for omega in [0.1, 3.14, 3.15, 31.4, 31.5, 1000.3]:
        assert rod().stiffness(arb(omega) ** 2).held == floor(omega / pi)
    with pytest.raises(UndecidedError):
        rod().stiffness(arb.pi() ** 2)


CLAMPED = (4.730040744862704, 7.853204624095838, 10.995607838001671, 14.137165491257464)
"""beta*l of a beam clamped at both ends: cos cosh = 1 (Timoshenko, Young & Weaver 1974)."""


def test_a_clamped_beams_frequencies_are_counted_between_each_other_and_moved_by_a_foundation():
    for number, (low, high) in enumerate(pairwise((0.1, *CLAMPED))):
        for beta in (low * 1.0001, high * 0.9999):
            assert beam().stiffness(arb(beta) ** 4).held == number
    # omega^2 = beta^4 + k for unit mass per length.
    for k in (10.0, 1e5):
        for number, (low, high) in enumerate(pairwise((0.1, *CLAMPED))):
            for beta in (low * 1.0001, high * 0.9999):
                assert beam(foundation=k).stiffness(arb(beta) ** 4 + k).held == number


def test_a_compressed_beams_buckling_counts_as_a_frequency_at_rest():
    # Held at both ends it buckles at 4 pi^2 EI/l^2.
    assert beam(axial_force=-0.99 * 4 * pi**2).stiffness(arb(0)).held == 0
    assert beam(axial_force=-1.01 * 4 * pi**2).stiffness(arb(0)).held == 1
    assert beam().stiffness(arb(-1e6)).held == 0

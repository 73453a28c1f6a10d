"""Beams on damped foundations: roots at, and next to, points where wavenumbers vanish or meet."""

import mpmath
import numpy as np
import pytest
from flint import acb, arb

from symflex.balls import precision
from symflex.roots import Modes
from symflex.roots.counting.local_series import local_series
from symflex.roots.distributed.side import Side
from symflex.roots.locate import locate
from tests.unit.roots.distributed_models import bound

STEEL = 'E = "200 GPa", I = "4000 mm^4", rho = "8000 kg/m^3", A = "500 mm^2", l = "1 m"'
STIFFNESS, MASS = 800.0, 4.0
TIMOSHENKO = 'theory = "timoshenko", G = "80 GPa", kappa = "0.85"'
# cos x cosh x = 1 (Blevins 1979, table 8-1).
FREE_FREE = (4.730040744862704, 7.853204624095838, 10.99560783800167)


def beam(options, between, rest=""):
    return f"""
symflex = 1
[elements]
bar = {{ type = "beam", between = {between}, {STEEL}, {options} }}
{rest}
[inputs]
F = {{ force = "tip" }}
[outputs]
X = "tip"
"""


def on_foundation(stiffness, damping, betas):
    """Return m s^2 + c s + k + EI beta^4 = 0 for every beta, in the upper half plane or on the real axis."""
    roots = [np.roots([MASS, damping, stiffness + STIFFNESS * b**4]) for b in betas]
    return sorted({complex(s) for pair in roots for s in pair if s.imag >= 0}, key=abs)


def poles(text, modes):
    found = locate(bound(text), Modes(modes), 12)
    assert found.certificate.certified
    values = [complex(float(r.re.mid()), float(r.im.mid())) for r in found.poles]
    return sorted((s for s in values if s.imag >= 0), key=abs)


def test_a_free_beam_on_a_damped_foundation_has_the_modes_of_one_in_the_air_shifted():
    # Both rigid motions are at the point where the wavenumber vanishes.
    expected = on_foundation(10000.0, 40.0, (0.0, *FREE_FREE))
    text = beam('k_f = "10 kN/m^2", c_f = "40 N*s/m^2"', '["tip", "end"]')
    assert poles(text, len(expected)) == pytest.approx(expected, rel=1e-9)


@pytest.mark.slow
def test_a_free_beam_on_a_critically_damped_foundation_has_double_poles():
    # Both rigid motions have (s + 50)^2 = 0. One double root is a pole; the other is hidden, and not told
    # apart from two roots that are closer than any number of digits.
    text = beam('k_f = "10 kN/m^2", c_f = "400 N*s/m^2"', '["tip", "end"]')
    found = locate(bound(text), Modes(5), 12)
    values = [complex(float(r.re.mid()), float(r.im.mid())) for r in found.poles]
    expected = [-50.0, *on_foundation(10000.0, 400.0, FREE_FREE)]
    assert sorted((s for s in values if s.imag >= 0), key=abs) == pytest.approx(expected, rel=1e-9)
    assert next(r.multiplicity for r in found.poles) == 2
    assert [(round(float(h.root.re.mid()), 9), h.root.multiplicity) for h in found.hidden] == [(-50.0, 2)]
    assert found.certificate.reason == "some roots could not be told apart"


def test_a_free_beam_on_a_viscous_foundation_comes_to_rest():
    expected = [s for s in on_foundation(0.0, 40.0, (0.0, *FREE_FREE)) if s]
    found = poles(beam('c_f = "40 N*s/m^2"', '["tip", "end"]'), len(expected))
    assert [s for s in found if s] == pytest.approx(expected, rel=1e-9)


@pytest.mark.slow
def test_a_pole_is_not_taken_for_a_zero_close_to_it():
    # w = const is a free motion: m s^2 + c s + k = 0. A zero that numerator and denominator share lies
    # 5e-9 rad/s beside it.
    text = beam(f'k_f = "10 kN/m^2", c_f = "40 N*s/m^2", {TIMOSHENKO}', '["tip", "end"]')
    found = locate(bound(text), Modes(2), 14)
    with precision(128):
        expected = acb(-5, arb(2475).sqrt())
        assert min(abs(acb(r.re, r.im) - expected).upper() for r in found.poles) < 1e-11


def timoshenko_rows(s):
    """Return the rows of (w, phi, M, V)' for the beam of TIMOSHENKO on 10 kN/m^2 and 40 N s/m^2."""
    area, inertia = mpmath.mpf(500) / 10**6, mpmath.mpf(4000) / 10**12
    shear, rotary = mpmath.mpf("0.85") * 80 * 10**9 * area, 8000 * inertia * s**2
    return mpmath.matrix(
        [
            [0, 1, 0, 1 / shear],
            [0, 0, 1 / (200 * 10**9 * inertia), 0],
            [0, rotary, 0, -1],
            [4 * s**2 + 40 * s + 10000, 0, 0, 0],
        ]
    )


@pytest.mark.slow
def test_a_timoshenko_cantilever_on_a_damped_foundation_against_shooting():
    text = beam(f'k_f = "10 kN/m^2", c_f = "40 N*s/m^2", {TIMOSHENKO}', '["ground", "tip"]')

    def moment_and_force(s):
        grown = mpmath.expm(timoshenko_rows(s))
        return grown[2, 2] * grown[3, 3] - grown[2, 3] * grown[3, 2]

    for pole in poles(text, 2):
        with mpmath.workdps(40):
            assert complex(mpmath.findroot(moment_and_force, pole)) == pytest.approx(pole, rel=1e-9)


def test_a_series_at_a_branch_point_has_the_functions_values_and_counts_its_root():
    function = bound(beam('k_f = "10 kN/m^2", c_f = "40 N*s/m^2"', '["tip", "end"]'))
    searched = Side(function, function.den, 12).function
    centre = acb(-5, arb(2475).sqrt()).mid()
    series = local_series(searched, centre, arb(2), 300, 40)
    with precision(300):
        off = acb("0.001", "-0.002").mid()
        total = sum(c * off**n for n, c in enumerate(series.coefficients))
        # Sixteen terms leave out what is (0.0022/2)^16 of the bound.
        assert abs(total - searched.value(centre + off, 300)) < 1e-40 * series.bound
    assert series.count(arb(2) ** -20) == 1


def test_a_series_about_another_point_has_the_same_values():
    function = bound(beam('k_f = "10 kN/m^2", c_f = "40 N*s/m^2"', '["tip", "end"]'))
    searched = Side(function, function.den, 12).function
    series = local_series(searched, acb(-4, 50), arb(2), 300, 40)
    with precision(300):
        coefficients, missed = series.around(acb(-4.25, 50.125), arb(0.25))
        off = acb(-0.125, 0.0625)
        total = sum(c * off**n for n, c in enumerate(coefficients))
        assert abs(total - searched.value(acb(-4.375, 50.1875), 300)).upper() < missed


def test_a_series_is_refused_where_waves_have_an_essential_singularity():
    function = bound(beam('k_f = "10 kN/m^2", eta = "20 ms"', '["tip", "ground"]'))
    searched = Side(function, function.den, 12).function
    assert local_series(searched, acb(-49), arb(2), 200, 20) is None
    assert local_series(searched, acb(-47), arb(2), 200, 20) is not None

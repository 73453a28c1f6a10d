import math
from dataclasses import replace

import numpy as np
import pytest

from symflex import pipeline
from symflex.analysis.response import adaptive_grid, default_band, respond, roots_if_found
from symflex.roots.locate import locate
from tests.unit.analysis.systems import rational
from tests.unit.refusals import refusal

TURN = 2 * math.pi


def test_the_peak_of_a_resonance_is_on_the_grid():
    for damping in ["0.1", "0.01", "1e-4", "1e-8"]:
        bound = rational(f"1/(s^2 + 2*{damping}*s + 1)")
        zeta = float(damping)
        peak = 1 / (
            2 * zeta * math.sqrt(1 - zeta**2)
        )  # of a single degree of freedom; Ewins 2000, section 2.2
        grid = adaptive_grid(bound, 0.01, 1)
        assert respond(bound, grid).magnitude.max() == pytest.approx(peak, rel=1e-3), damping


def test_the_trough_of_a_lightly_damped_zero_is_on_the_grid():
    bound = rational("(s^2 + 2e-6*s + 1)/(s + 1)^2")
    trough = 2e-6 / 2  # |2 zeta j| over |1 + j|^2
    assert respond(bound, adaptive_grid(bound, 0.01, 1)).magnitude.min() == pytest.approx(trough, rel=1e-3)


def test_the_phase_advances_by_small_steps_through_a_resonance():
    bound = rational("1/(s^2 + 2e-5*s + 1)")
    phase = respond(bound, adaptive_grid(bound, 0.01, 1, points=50)).phase
    assert np.abs(np.diff(phase)).max() < math.radians(10)


def test_the_grid_closes_in_on_a_pole_on_the_axis_from_both_sides_and_keeps_off_it():
    grid = adaptive_grid(rational("1/(s^2 + 1)"), 1 / TURN, 10 / TURN)
    assert np.abs(grid - 1).min() == pytest.approx(1e-7, rel=0.02)
    grid = adaptive_grid(rational("1/(s^2 + 1)"), 0.01, 1)
    assert {-1, 1} == set(np.sign(grid[np.abs(grid - 1) < 1e-6] - 1))


def test_a_band_must_be_positive_and_not_empty():
    for low, high in ((0, 1), (-1, 1), (2, 1), (1, 1), (1, math.inf), (math.nan, 1)):
        assert refusal(adaptive_grid, rational("1/(s + 1)"), low, high) == "UsageError SF227", (low, high)


def test_a_grid_has_two_points_or_more():
    with pytest.raises(ValueError, match="at least 2 points"):
        adaptive_grid(rational("1/(s + 1)"), 1, 2, points=1)


def test_the_default_band_spans_a_decade_beyond_poles_and_zeros_of_all_functions():
    for expressions, low, high in (
        (["s*(s + 20)/(s^2 + 0.1*s + 9)"], 3 / TURN / 10, 20 / TURN * 10),
        (["(s + 200)/(s^2 + 0.1*s + 9)"], 3 / TURN / 10, 3 / TURN * 10),  # far beyond what oscillates
        (["1/(s^2 + 0.1*s + 9)^2"], 3 / TURN / 10, 3 / TURN * 10**0.75),  # 80 dB a decade fall by 60 dB
        (["s^6/(s^2 + 1.0*s + 9)^20"], 3 / TURN / 10**0.5, 3 / TURN * 1.3),
        (["1/(s + 1)", "1/(s + 50)"], 1 / TURN / 10, 50 / TURN * 10),
        (["1/s^2"], 0.1, 10),  # integrators alone: a decade around one hertz
    ):
        found = default_band(*(locate(rational(each)) for each in expressions))
        assert found == pytest.approx((low, high), rel=1e-14), expressions


def without_roots(bound):
    """What a search that found no root leaves behind."""
    found = locate(bound)
    certificate = replace(found.certificate, reason="too long", code="SF505")
    return replace(found, poles=(), zeros=(), certificate=certificate)


def test_where_no_root_is_known_the_grid_follows_the_values_through_a_resonance():
    # 1/(s^2 + 2 zeta s + 1) with zeta = 1/100 has its peak 1/(2 zeta sqrt(1 - zeta^2)) at sqrt(1 - 2 zeta^2).
    bound = rational("1/(s^2 + s/50 + 1)")
    omega = adaptive_grid(bound, 0.01, 1.0, 100, roots=without_roots(bound))
    values = 1 / (1 - omega**2 + 1j * omega / 50)
    assert np.abs(values).max() == pytest.approx(50 / math.sqrt(1 - 1e-4), rel=1e-3)
    assert np.abs(np.diff(np.unwrap(np.angle(values)))).max() < math.radians(15)


def test_a_grid_without_roots_ends_where_values_have_no_logarithm():
    bound = rational("(s^2 + 1)/(s^2 + 4)")
    assert len(adaptive_grid(bound, 0.01, 1.0, 50, roots=without_roots(bound))) < 3000


MATCHED = """
symflex = 1
parameters = { E = "210 GPa", rho = "7800 kg/m^3", A = "1e-4 m^2", l = "2 m" }
inputs.F = { unit = "N" }
outputs.V = "s*u(l)"
[fields.u]
domain = ["0", "l"]
equation = "E*u'' = rho*s^2*u"
conditions = ["E*A*u'(0) = -F", "E*A*u'(l) = -A*sqrt(E*rho)*s*u(l)"]
"""


@pytest.mark.slow
def test_a_rod_that_ends_in_its_own_impedance_has_a_response_and_no_roots_but_where_it_rests():
    # A wave runs along it once: V/F = exp(-s l/c)/(A sqrt(E rho)).
    (bound,) = pipeline.derive_bound(pipeline.loads(MATCHED), [("V", "F")])
    found = roots_if_found(bound)
    assert (found.certificate.certified, found.poles, found.zeros) == (True, (), ())
    omega = np.array([10.0, 1e3, 3e4])
    expected = np.exp(-1j * omega * 2 * math.sqrt(7800 / 210e9)) / (1e-4 * math.sqrt(210e9 * 7800))
    assert respond(bound, omega).values == pytest.approx(expected, rel=1e-12)

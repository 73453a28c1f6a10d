"""Peaks of matrices, by hand and on grids."""

from math import cos, pi, sqrt

import numpy as np
import pytest

import symflex
from tests.unit.analysis.norms.models import cantilever, two_masses

SHAFT = """
symflex = 1
[elements]
s_1 = { type = "shaft", between = ["a", "b"], G = "80 GPa", J = "1e4 mm^4", rho = "7.85 g/cm^3", l = "1.2 m" }
d_1 = { type = "inertia", at = "a", J = "0.02 kg*m^2" }
d_2 = { type = "inertia", at = "b", J = "0.05 kg*m^2" }
b_1 = { type = "rotary_damper", between = ["a", "ground"], b = "0.1 N*m*s/rad" }
b_2 = { type = "rotary_damper", between = ["b", "ground"], b = "0.3 N*m*s/rad" }
[inputs]
T_1 = { torque = "a" }
T_2 = { torque = "b" }
[outputs]
W_1 = "s*a"
W_2 = "s*b"
"""


def matrix(**outputs):
    return symflex.Model(inputs={"u": {}, "v": {}}, outputs=outputs).transfer_matrix().bind()


def contains(ball, value, share=1e-12):
    return abs(float(ball.mid()) - value) <= float(ball.rad()) + share * abs(value)


def test_peaks_known_by_hand():
    assert contains(matrix(y="(u + v)/(s + 1)", z="(u - v)/(s + 1)").peak().magnitude, sqrt(2))
    assert contains(matrix(y="u/(s + 1)", z="s*v/(s + 1)*3").peak().magnitude, 3)
    infinite = matrix(y="u/(s + 1)", z="v/(s^2 + 9)").peak()
    assert not infinite.magnitude.is_finite() and float(infinite.places[0].mid()) == pytest.approx(3)
    rising = matrix(y="u/(s + 1)", z="s*v/(s + 1)*3").peak()
    assert rising.beyond is not None and "as the frequency grows" in rising.place


def test_the_larger_entry_on_a_diagonal_is_met():
    # By hand: the singular values of a diagonal matrix are the magnitudes of its entries.
    for outputs in ({"y": "2*u", "z": "3*v"}, {"y": "2*u", "z": "3*v/(s + 1)"}):
        found = matrix(**outputs).peak()
        assert found.certified and contains(found.magnitude, 3)
        assert float(found.magnitude.rad()) < 1e-5


def test_two_masses_peak_as_their_first_mode():
    # By hand: of the modes (1, 1)/sqrt(2) and (1, -1)/sqrt(2) the first is 1/(s^2 + 0.2 s + 100).
    zeta = 0.2 / 20
    assert contains(
        two_masses().transfer_matrix().bind().peak().magnitude, 1 / 100 / (2 * zeta * sqrt(1 - zeta**2))
    )


@pytest.mark.slow
def test_a_band_and_a_grid_agree_for_a_beam():
    model = cantilever()
    model = symflex.loads(model.to_toml().replace('X = "tip"', 'X = "tip"\nPhi = "tip.theta"'))
    found = model.transfer_matrix().bind()
    peak = found.peak(band=(30, 400))
    largest = found.singular_values(2j * np.pi * np.linspace(30, 400, 300))[0].max()
    assert peak.certified and largest <= float(peak.magnitude.upper()) * (1 + 1e-12)
    assert float(peak.magnitude.lower()) <= found.singular_values(2j * np.pi * 30)[0] * (1 + 1e-9)


def test_delays_turn_entries_against_each_other():
    # By hand: with [1, e^-jx; 2 e^-2jx, -1] the largest value is where 3 x = pi: (3 + sqrt(5))/2.
    found = matrix(y="u + exp(-s)*v", z="2*exp(-2*s)*u - v").peak()
    assert found.certified and contains(found.magnitude, (3 + sqrt(5)) / 2)
    assert float(found.places[0].mid()) % (2 * np.pi / 3) == pytest.approx(np.pi / 3, abs=1e-2)


def test_the_column_of_wood_and_berry_has_the_peak_of_a_dense_grid():
    # Wood and Berry 1973, in minutes; the values are of numpy. Delays alone change them by 11 %.
    column = matrix(
        y="12.8*exp(-s)/(16.7*s + 1)*u - 18.9*exp(-3*s)/(21*s + 1)*v",
        z="6.6*exp(-7*s)/(10.9*s + 1)*u - 19.4*exp(-3*s)/(14.4*s + 1)*v",
    )
    omega = np.linspace(0.2, 2, 4001)
    s = 1j * omega
    rows = [
        [12.8 * np.exp(-s) / (16.7 * s + 1), -18.9 * np.exp(-3 * s) / (21 * s + 1)],
        [6.6 * np.exp(-7 * s) / (10.9 * s + 1), -19.4 * np.exp(-3 * s) / (14.4 * s + 1)],
    ]
    largest = np.linalg.svd(np.moveaxis(np.array(rows), -1, 0), compute_uv=False)[:, 0].max()
    found = column.peak(band=(0.2 / (2 * np.pi), 2 / (2 * np.pi)))
    assert found.certified and contains(found.magnitude, largest, 1e-6)


def test_several_delays_of_what_does_not_fall_off_have_bounds_alone():
    # Independent phases give at most the largest singular value of [1, 0.7, 1; 2, 1, 0.4], numpy's 2.6839.
    found = symflex.Model(
        inputs={"u": {}, "v": {}, "w": {}},
        outputs={"y": "u + 0.7*exp(-0.3*s)*v + w", "z": "2*exp(-0.71*s)*u - v + 0.4*exp(-s)*w"},
    )
    peak = found.transfer_matrix().bind().peak()
    most = np.linalg.svd([[1, 0.7, 1], [2, 1, 0.4]], compute_uv=False)[0]
    assert not peak.certified and 2.5 < float(peak.magnitude.mid()) <= most


@pytest.mark.slow
def test_modes_that_hardly_any_damper_reaches_are_certified_far_out():
    # At high modes both inertias nearly rest: w = phi (phi^T T)/(phi^T b phi) with phi = (1/J_1, +-1/J_2),
    # so that the norm tends to (2500 + 400)/(0.1*2500 + 0.3*400).
    shaft = symflex.loads(SHAFT).transfer_matrix().bind()
    found = shaft.peak(band=(12000, 20000))
    assert found.certified and float(found.magnitude.mid()) == pytest.approx(2900 / 370, rel=1e-5)


def test_sums_of_delays_have_no_pole_and_a_peak():
    # By hand: abs(1 + exp(-j omega)) is 2 at most, at omega = 0; from 0.1 to 0.4 Hz at 0.1 Hz.
    model = symflex.Model(inputs={"u": {}}, outputs={"y": "(1 + exp(-s))*u"})
    peak = model.transfer_matrix().bind().peak(band=(0.1, 0.4))
    assert peak.certified
    assert float(peak.magnitude.mid()) == pytest.approx(2 * cos(0.1 * pi), rel=3e-6)

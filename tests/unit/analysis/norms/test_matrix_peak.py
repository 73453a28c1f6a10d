"""Peaks of matrices, by hand and on grids."""

from math import sqrt

import numpy as np
import pytest

import symflex
from symflex.errors import SymflexError
from tests.unit.analysis.norms.models import cantilever, two_masses


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


def test_delays_that_turn_entries_against_each_other_are_refused():
    # Both entries of the first row in phase give 2.30278, in opposite phase 2.61803.
    with pytest.raises(SymflexError, match="SF802"):
        matrix(y="u + exp(-s)*v", z="u - 2*v").peak()

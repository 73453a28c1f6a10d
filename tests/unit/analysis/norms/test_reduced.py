"""Reduced models: the proved error against dense grids of other formulas."""

import json

import numpy as np
import pytest

import symflex
from tests.unit.analysis.norms.models import cantilever, response, two_masses
from tests.unit.refusals import refusal


def receptance(model=None):
    return (model or cantilever()).transfer_function("X", "F").bind()


def error_met(reduced, frequencies):
    """Return the largest error of a cantilever on a grid [rad/s]."""
    values = reduced.at(1j * frequencies)[0, 0]
    return max(abs(response(w) - value) for w, value in zip(frequencies.tolist(), values, strict=True))


def test_three_modes_of_a_cantilever_have_the_error_of_a_dense_grid():
    reduced = receptance().reduced(3)
    met = error_met(reduced, np.linspace(7300, 7390, 10))  # where a grid of 4000 points is largest
    assert met == pytest.approx(2.1052444e-6, rel=1e-6)  # mpmath, 30 digits
    assert met <= float(reduced.error.most) <= 1.0011 * met and float(reduced.error.least) <= met
    assert reduced.certified and reduced.band is None and len(reduced.state_space().A) == 6
    assert float(reduced.relative.upper()) == pytest.approx(2.1052e-6 / (0.8**3 / 3 / 140), rel=2e-3)


TIP_MASS = """
symflex = 1
[elements]
arm = { type = "beam", between = ["p", "q"], EI = 20, rhoA = 1, l = 1, eta = "1 ms" }
held = { type = "fixed", at = "p" }
load = { type = "mass", at = "q.y", m = 2.37 }
[inputs]
F = { force = "q.y" }
[outputs]
A = "s^2*q.y"
"""


@pytest.mark.slow
def test_the_error_of_an_acceleration_is_enclosed_up_to_its_limit():
    # A mass takes a force by itself as the frequency grows: the limit is 1/m, that of the model its D.
    reduced = symflex.loads(TIP_MASS).transfer_function("A", "F").bind().reduced(3)
    limit = abs(1 / 2.37 - reduced.state_space().D[0][0])
    assert limit <= float(reduced.error.most) <= 1.01 * limit


@pytest.mark.slow
def test_an_error_takes_the_fewest_modes():
    # The error of one mode is 1.5368e-4 m/N at 1018 rad/s, an eighth of the static value (mpmath).
    assert receptance().reduced(error=0.13).modes == 1
    reduced = receptance().reduced(error=0.12)
    met = error_met(reduced, np.linspace(3000, 3100, 7))
    assert reduced.modes == 2 and float(reduced.error.least) * 0.9999 <= met <= float(reduced.error.most)


def test_without_damping_the_error_is_that_of_a_band_and_says_so():
    reduced = receptance(cantilever("EI")).reduced(2)
    assert reduced.certified and reduced.band[1] == pytest.approx(161.083, rel=1e-4)  # its second mode
    assert any("is undamped" in note for note in reduced.notes)
    infinite = receptance(cantilever("EI")).reduced(2, band=(0, 600))  # its third is at 451 Hz
    assert not infinite.error.most.is_finite() and "infinite" in str(infinite)


def test_a_matrix_has_the_largest_singular_value_and_each_pair_its_own():
    model = two_masses()
    reduced = model.transfer_matrix().bind().reduced(1)
    # By hand: modes (1, 1) and (1, -1)/sqrt(2); of the second 1/2/(s^2 + 0.6 s + 300) is left out, less its
    # static value. The matrix [1, -1; -1, 1]/2 has the singular value 1.
    s = 1j * np.linspace(17.2, 17.4, 2001)
    left_out = np.abs(1 / (s**2 + 0.6 * s + 300) - 1 / 300).max()
    assert reduced.error.least <= left_out * (1 + 1e-9) and left_out <= reduced.error.most * (1 + 1e-9)
    for row in reduced.channels:
        for gain in row:
            assert float(gain.least) <= left_out / 2 * (1 + 1e-9) <= float(gain.most) * (1 + 2e-9)
    assert len(reduced.state_space().A) == 2  # a residue of rank one has one pair of states


def test_rigid_bodies_and_multiple_poles_are_kept():
    model = symflex.Model(inputs={"u": {}}, outputs={"y": "u/s^2 + u/(s + 1)^2 + u/(s + 40)"})
    reduced = model.transfer_function("y", "u").bind().reduced(2)
    s = 1j * np.geomspace(0.01, 1e5, 400)
    exact = 1 / s**2 + 1 / (s + 1) ** 2 + 1 / (s + 40)
    off = np.abs(exact - reduced.at(s)[0, 0]).max()  # 1/40 at most, as the frequency grows
    assert off <= float(reduced.error.most) and reduced.error.least <= 0.025 <= reduced.error.most * 1.0001


def test_delays_stay_outside():
    model = symflex.Model(inputs={"u": {}}, outputs={"y": "exp(-s/4)*(u/(s + 1) + u/(s + 100))"})
    reduced = model.transfer_function("y", "u").bind().reduced(1)
    assert reduced.delays == ((0.25,),) and "0.25 s" in str(reduced)
    assert abs(reduced.at(2j)[0, 0] - np.exp(-0.5j) * (1 / (1 + 2j) + 0.01)) < 1e-12
    assert reduced.error.least <= 0.01 <= reduced.error.most * 1.0001


def test_the_rms_of_the_error_has_an_end_for_shaped_noise():
    # Left out is 1/(s + 900) - 1/900; by hand, s/((s + a)*(s + b)) has the norm 1/sqrt(2*(a + b)).
    model = symflex.Model(inputs={"u": {}}, outputs={"y": "u/(s + 1) + u/(s + 900)"})
    reduced = model.transfer_function("y", "u").bind().reduced(1)
    assert "static correction" in reduced.h2_error().because
    norm = reduced.h2_error("1/(s + 1)").value
    assert abs(float(norm.mid()) - 1 / 900 / (2 * 901) ** 0.5) < float(norm.rad()) < 0.001 * float(norm.mid())


def test_the_equations_are_a_specification_with_the_error_in_its_title():
    reduced = receptance().reduced(1)
    again = symflex.loads(reduced.specification("arm"))
    assert "0.000153" in again.resolved.title and "H-infinity" in again.resolved.title
    s = 300j
    assert again.transfer_function("X", "F").bind()(s) == pytest.approx(reduced.at(s)[0, 0], rel=1e-9)


def test_the_document_has_bounds_and_matrices():
    document = json.loads(json.dumps(two_masses().transfer_matrix().bind().reduced(1).to_json_dict()))
    assert document["schema"] == "symflex.reduced/1" and document["certified"]
    assert document["outputs"] == ["X_1", "X_2"] and np.array(document["C"]).shape == (2, 2)
    assert document["error"]["least"] <= document["error"]["most"] <= 1.01 * document["error"]["least"]


def test_what_cannot_be_reduced_is_refused():
    integrator = symflex.Model(inputs={"u": {}}, outputs={"y": "u/s"}).transfer_function("y", "u").bind()
    assert "SF402" in refusal(lambda: integrator.reduced(error=0.1))
    growing = symflex.Model(inputs={"u": {}}, outputs={"y": "s*u"}).transfer_function("y", "u").bind()
    assert "SF236" in refusal(lambda: growing.reduced(1))
    for wrong in (-1, 1.5):
        assert "SF902" in refusal(lambda wrong=wrong: growing.reduced(wrong))

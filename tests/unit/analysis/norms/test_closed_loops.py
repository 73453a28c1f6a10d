"""Loops that are closed together, against numpy: singular values on a grid, and winding numbers."""

import numpy as np
import pytest

import symflex
from symflex.errors import UsageError


def model(**outputs):
    return symflex.Model(inputs={"u": {}, "v": {}}, outputs=outputs)


ROSENBROCK = {"y": "u/(s + 1) + 2*v/(s + 3)", "z": "u/(s + 1) + v/(s + 1)"}
WOOD_BERRY = {
    "y": "12.8*exp(-s)/(16.7*s + 1)*u - 18.9*exp(-3*s)/(21*s + 1)*v",
    "z": "6.6*exp(-7*s)/(10.9*s + 1)*u - 19.4*exp(-3*s)/(14.4*s + 1)*v",
}


def wood_berry(s):
    first = [12.8 * np.exp(-s) / (16.7 * s + 1), -18.9 * np.exp(-3 * s) / (21 * s + 1)]
    return np.array([first, [6.6 * np.exp(-7 * s) / (10.9 * s + 1), -19.4 * np.exp(-3 * s) / (14.4 * s + 1)]])


def test_largest_singular_values_are_those_of_a_grid():
    found = model(**ROSENBROCK).transfer_matrix().bind().closed_loops()
    assert found.certified and found.closed.word == "stable" and found.encirclements == 0
    s = 1j * np.linspace(0.0, 10, 4001)
    loops = np.array([[1 / (s + 1), 2 / (s + 3)], [1 / (s + 1), 1 / (s + 1)]]).transpose(2, 0, 1)
    inside = np.linalg.inv(np.eye(2) + loops)
    for peak, own in (
        (found.peaks.sensitivity, inside),
        (found.peaks.complementary_sensitivity, loops @ inside),
        (found.peaks.balanced, inside - loops @ inside),
    ):
        assert float(peak.magnitude.mid()) == pytest.approx(np.linalg.svd(own)[1][:, 0].max(), rel=1e-5)


def test_encirclements_are_the_winding_number_of_the_determinant():
    omega = np.geomspace(1e-6, 200, 100_001)
    omega = np.concatenate([-omega[::-1], omega])
    a, b, c, d = wood_berry(1j * omega).reshape(4, -1)
    angle = np.unwrap(np.angle((1 + a) * (1 + d) - b * c))
    found = model(**WOOD_BERRY).transfer_matrix().bind().closed_loops()
    assert found.encirclements == round((angle[0] - angle[-1]) / (2 * np.pi)) == found.closed.right
    assert found.peaks is None


def test_loops_that_stabilise_are_encircled_the_other_way():
    # By hand: s - 1 + 3 = 0 and s + 2 + 1 = 0; one open pole at 1.
    found = model(y="3*u/(s - 1)", z="v/(s + 2)").transfer_matrix().bind().closed_loops()
    assert (found.open.right, found.closed.right, found.encirclements) == (1, 0, -1)
    assert "encircles 0 once counterclockwise" in str(found)


def test_a_loop_alone_has_the_margins_of_its_gain():
    # L = 1/s: S = s/(s + 1), T = 1/(s + 1), and S - T is an all-pass: alpha is 2.
    loop = symflex.Model(inputs={"u": {}}, outputs={"y": "u/s"})
    found = loop.transfer_matrix().bind().closed_loops()
    assert found.certified and float(found.peaks.disk["alpha"].mid()) == pytest.approx(2, rel=1e-5)


ROD = """
symflex = 1
[parameters]
w = "2 1/m"
g = "30 N/m"
[elements]
rod = { type = "rod", between = ["ground", "b"], EA = 9, rhoA = 1, l = 1, eta = "20 ms" }
push = { type = "force_source", at = "b", f = "g*u" }
[inputs]
u = { unit = "m" }
v = {}
[outputs]
Y = "b"
Z = "w*b + 3*v/(s + 1)"
"""


def test_sensitivity_of_a_rod_is_enclosed_although_it_does_not_fall_off():
    # By hand: a force moves the free end of a rod by tanh(q)/(EA (1 + eta s) q), q^2 = s^2/(9 (1 + eta s)).
    found = symflex.loads(ROD).transfer_matrix().bind().closed_loops()
    s = 1j * np.concatenate([np.linspace(0.1, 200, 4001), np.linspace(7, 8, 10_001)])
    q = s / (3 * np.sqrt(1 + 0.02 * s))
    end = 30 * np.tanh(q) / (9 * (1 + 0.02 * s) * q)
    loops = np.array([[end, 0 * end], [2 * end, 3 / (s + 1)]]).transpose(2, 0, 1)
    inside = np.linalg.inv(np.eye(2) + loops)
    assert found.certified
    for peak, own in ((found.peaks.sensitivity, inside), (found.peaks.balanced, 2 * inside - np.eye(2))):
        assert float(peak.magnitude.mid()) == pytest.approx(np.linalg.svd(own)[1][:, 0].max(), rel=1e-5)


def test_a_closed_loop_on_the_axis_has_no_count():
    found = model(y="-u/(s + 1)", z="v/(s + 1)").transfer_matrix().bind().closed_loops()
    assert found.closed.word == "marginal" and found.encirclements is None


def test_numbers_of_outputs_and_inputs_agree():
    with pytest.raises(UsageError, match="from 1 to 2"):
        model(**ROSENBROCK).transfer_matrix("y").bind().closed_loops()

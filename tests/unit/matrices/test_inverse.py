"""Imposed outputs: inverses, determinants and normal ranks, compared with those by hand and by numpy."""

from __future__ import annotations

import numpy as np
import pytest

from symflex.errors import ModelError, UsageError
from symflex.matrices.inverse import determinant, impose_all, inverse, return_difference
from symflex.matrices.transfer_matrix import derive_matrix
from symflex.transfer import bind
from tests.unit.matrices.models import TWO_MASSES, model_of

CROSSED = """
symflex = 1
[inputs]
u = {}
v = {}
w = {}
[outputs]
x = "v/s"
y = "u/(s + 1) + w"
z = "w/(s + 2)"
"""

TWICE = """
symflex = 1
[inputs]
u = {}
v = {}
[outputs]
x = "(u + v)/(s + 1)"
y = "2*(u + v)/(s + 1)"
"""


def test_the_inverse_of_receptances_is_the_dynamic_stiffness() -> None:
    turned = inverse(derive_matrix(model_of(TWO_MASSES)))
    assert [[tf.name for tf in row] for row in turned.pairs] == [
        ["F_1/X_1", "F_1/X_2"],
        ["F_2/X_1", "F_2/X_2"],
    ]
    assert {tf.quantity for tf in turned.each} == {"dynamic stiffness"}
    ring = turned.over.den.ring
    s, m_1, m_2, k_1, k_2 = (ring.generator(name) for name in ("s", "m_1", "m_2", "k_1", "k_2"))
    assert turned.over.den.is_one
    rows = [[n.expand() for n in row] for row in turned.over.numerators]
    assert rows == [[m_1 * s**2 + k_1 + k_2, -k_2], [-k_2, m_2 * s**2 + k_2]]


def test_an_inverse_with_numbers_is_that_of_values() -> None:
    matrix = derive_matrix(model_of(CROSSED))
    s = np.array([0.3 + 1j, 2j])
    values = np.moveaxis(matrix.bind().at(s), -1, 0)
    turned = np.moveaxis(inverse(matrix).bind().at(s), -1, 0)
    assert np.allclose(values @ turned, np.eye(3), atol=1e-14)


def test_a_determinant_has_the_sign_of_the_order_of_its_pairs() -> None:
    # x = v/s, y = u/(s + 1) + w, z = w/(s + 2): one exchange, so -1/(s (s + 1) (s + 2)).
    tf = determinant(derive_matrix(model_of(CROSSED)))
    s = 0.7 + 0.2j
    assert bind(tf)(s) == pytest.approx(-1 / (s * (s + 1) * (s + 2)), rel=1e-15)


def test_a_singular_matrix_is_refused_with_its_normal_rank() -> None:
    matrix = derive_matrix(model_of(TWICE))
    assert impose_all(matrix).rank == 1
    assert determinant(matrix).is_zero
    with pytest.raises(ModelError, match="its normal rank is 1, not 2") as caught:
        inverse(matrix)
    assert caught.value.diagnostics[0].code == "SF237"


def test_a_wide_matrix_has_a_normal_rank_and_no_inverse() -> None:
    matrix = derive_matrix(model_of(CROSSED), ["x", "z"])
    assert impose_all(matrix).rank == 2
    with pytest.raises(UsageError, match="2 outputs and 3 inputs has no inverse"):
        inverse(matrix)


def test_the_return_difference_adds_the_unit_matrix_and_its_inverse_is_the_sensitivity() -> None:
    matrix = derive_matrix(model_of(TWO_MASSES))
    s = 0.3 + 2j
    whole = np.eye(2) + np.linalg.inv(np.array([[2 * s**2 + 50, -20], [-20, s**2 + 20]]))
    closed = return_difference(matrix)
    assert np.allclose(closed.bind().at(s), whole, rtol=1e-14)
    assert bind(determinant(closed))(s) == pytest.approx(np.linalg.det(whole), rel=1e-13)
    assert np.allclose(inverse(closed).bind().at(s), np.linalg.inv(whole), rtol=1e-12)


def test_loops_are_closed_from_as_many_outputs_to_as_many_inputs() -> None:
    wide = derive_matrix(model_of(CROSSED), ["x", "z"])
    turned = inverse(derive_matrix(model_of(TWO_MASSES)))  # whose outputs are imposed
    for matrix in (wide, turned):
        with pytest.raises(UsageError, match="loops are closed from as many outputs"):
            return_difference(matrix)


def test_characteristic_loci_are_followed_and_multiply_to_the_determinant() -> None:
    bound = derive_matrix(model_of(TWO_MASSES)).bind()
    s = 1 + 1j * np.linspace(0.1, 8, 40)
    loci = bound.characteristic_loci(s)
    assert loci.shape == (2, 40)
    values = np.moveaxis(bound.at(s), -1, 0)
    assert np.allclose(np.prod(1 + loci, axis=0), np.linalg.det(np.eye(2) + values), rtol=1e-12)
    assert np.abs(np.diff(loci.real, axis=1)).max() < 0.2

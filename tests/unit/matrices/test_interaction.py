"""Static gains, static decoupling and relative gains, compared with those by hand and in print."""

from __future__ import annotations

import numpy as np
import pytest

from symflex.errors import ModelError
from symflex.expressions import format_expression
from symflex.matrices.interaction import interaction, interaction_json, interaction_text
from symflex.matrices.inverse import determinant
from symflex.matrices.transfer_matrix import derive_matrix
from symflex.transfer import bind
from tests.unit.matrices.models import BEAM, TWO_MASSES, model_of


def said(found, gains):
    return [[format_expression(e) for e in row] for row in found.said(gains)]


def test_two_springs_in_a_row_have_the_gains_of_their_stiffness_matrix() -> None:
    # K = [k_1 + k_2, -k_2; -k_2, k_2]; the relative gain is K_11 (K^-1)_11 = (k_1 + k_2)/k_1.
    found = interaction(derive_matrix(model_of(TWO_MASSES)))
    assert said(found, found.decoupling) == [["k_1 + k_2", "-k_2"], ["-k_2", "k_2"]]
    assert said(found, found.gains)[0] == ["1/k_1", "1/k_1"]
    assert said(found, found.relative) == [["(k_1 + k_2)/k_1", "-k_2/k_1"], ["-k_2/k_1", "(k_1 + k_2)/k_1"]]


def test_relative_gains_exist_at_rest_where_gains_are_infinite() -> None:
    text = """
symflex = 1
[inputs]
u = {}
v = {}
[outputs]
x = "(2*u + v)/s"
y = "(u + 3*v)/(s*(s + 1))"
"""
    found = interaction(derive_matrix(model_of(text)))
    assert found.gains is found.decoupling is None
    assert found.values(found.relative) == [[1.2, -0.2], [-0.2, 1.2]]  # 6/5 of [2, 1; 1, 3]
    assert "static gains: none, a value is infinite at s = 0" in interaction_text(found)


def test_dead_times_are_1_at_rest() -> None:
    found = interaction(derive_matrix(model_of(WOOD_BERRY)))
    assert found.values(found.gains) == [[12.8, -18.9], [6.6, -19.4]]
    # lambda_11 = 1/(1 - 18.9*6.6/(12.8*19.4)), printed as 2.01 (Seborg et al., chapter 18).
    (first, *_), _ = found.values(found.relative)
    assert first == pytest.approx(1 / (1 - 18.9 * 6.6 / (12.8 * 19.4)), rel=1e-15)
    assert round(first, 2) == 2.01


def test_an_entry_that_is_zero_is_zero_at_rest():
    text = """
symflex = 1
[parameters]
k = 4
[inputs]
u = {}
v = {}
[outputs]
x = "u/(s + k) + v"
y = "2*v/(s + 1)"
"""
    found = interaction(derive_matrix(model_of(text)))
    assert said(found, found.gains) == [["1/k", "1"], ["0", "2"]]
    assert found.values(found.relative) == [[1, 0], [0, 1]]


def test_relative_gains_have_their_values_where_a_parameter_is_zero():
    # By hand: [1, 0; 2, 1/3] is triangular, so each pair is alone, and the determinant is 1/(s + 1)/(s + 3).
    matrix = derive_matrix(
        model_of("""
symflex = 1
[parameters]
a = { value = 0, assume = "real" }
b = 2
[inputs]
u = {}
v = {}
[outputs]
y = "u/(s + 1) + a*v"
z = "b*u + v/(s + 3)"
""")
    )
    found = interaction(matrix)
    assert found.values(found.gains) == [[1, 0], [2, 1 / 3]]
    assert found.values(found.decoupling) == [[1, 0], [-6, 3]]
    assert found.values(found.relative) == [[1, 0], [0, 1]]
    assert bind(determinant(matrix))(0.5) == pytest.approx(1 / (1.5 * 3.5), rel=1e-14)


def test_loss_factors_have_no_static_gain():
    text = TWO_MASSES.replace('k = "k_2" }', 'k = "k_2", eta_s = 0.02 }')
    with pytest.raises(ModelError, match="a value at s = 0"):
        interaction(derive_matrix(model_of(text)))


def test_json_has_letters_and_numbers() -> None:
    document = interaction_json(interaction(derive_matrix(model_of(TWO_MASSES))))
    assert document["schema"] == "symflex.interaction/1"
    assert document["relative_gains"]["is"][0][0] == "(k_1 + k_2)/k_1"
    assert np.allclose(document["relative_gains"]["values"], [[5 / 3, -2 / 3], [-2 / 3, 5 / 3]])


def test_beams_have_no_symbolic_gains() -> None:
    text = BEAM.replace("F = {}", "F = {}\nM = {}").replace("\"w''(l) = 0\"", "\"EI*w''(l) = M\"")
    with pytest.raises(ModelError, match="SF910"):
        interaction(derive_matrix(model_of(text)))


WOOD_BERRY = """
symflex = 1
source = "Wood and Berry 1973, Chem. Eng. Sci. 28: methanol and water, in minutes"
[inputs]
R = {}
S = {}
[outputs]
x_D = "12.8*exp(-s)/(16.7*s + 1)*R - 18.9*exp(-3*s)/(21*s + 1)*S"
x_B = "6.6*exp(-7*s)/(10.9*s + 1)*R - 19.4*exp(-3*s)/(14.4*s + 1)*S"
"""

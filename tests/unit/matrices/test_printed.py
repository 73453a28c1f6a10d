"""Printed forms of matrices: each entry is its function, names mean one thing, parts are those on paper."""

from __future__ import annotations

import pytest

from symflex.errors import UsageError
from symflex.expressions import format_expression, is_number
from symflex.matrices.printed import print_matrix
from symflex.matrices.transfer_matrix import derive_matrix
from tests.unit.matrices.models import BEAM, TWO_MASSES, model_of


def test_two_masses_print_as_their_adjugate_over_their_determinant() -> None:
    form = print_matrix(derive_matrix(model_of(TWO_MASSES)))
    assert is_number(form.front, 1)
    assert [[format_expression(e) for e in row] for row in form.entries] == [
        ["m_2*s^2 + k_2", "k_2"],
        ["k_2", "m_1*s^2 + k_1 + k_2"],
    ]


def test_what_all_numerators_share_stands_in_front() -> None:
    form = print_matrix(derive_matrix(model_of(TWO_MASSES), ["X_1"], ["F_2"]))
    assert (format_expression(form.front), format_expression(form.entries[0][0])) == ("k_2", "1")


def test_a_name_of_a_beam_stands_for_one_thing_in_all_entries() -> None:
    form = print_matrix(derive_matrix(model_of(BEAM)))
    names = [name for name, _ in form.where]
    meanings = [format_expression(e) for _, e in form.where]
    assert len(set(names)) == len(names)
    assert len(set(meanings)) == len(meanings)
    assert {"alpha*l", "l*alpha/2"} & set(meanings)


def test_every_form_that_both_parts_have_can_be_asked_for() -> None:
    matrix = derive_matrix(model_of(TWO_MASSES))
    for name in ("polynomial", "monic", "constant", "factored", "definitions", "zpk"):
        assert print_matrix(matrix, name).name == name, name
    nested = derive_matrix(model_of(TWO_MASSES), representation="nested")
    assert print_matrix(nested).name == "nested"
    with pytest.raises(UsageError, match="a matrix has no frequency form"):
        print_matrix(matrix, "frequency")
    with pytest.raises(UsageError, match="there is no form 'shortes'"):
        print_matrix(matrix, "shortes")

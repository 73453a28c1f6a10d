"""Smith-McMillan forms, compared with minors by hand."""

from __future__ import annotations

import pytest

from symflex.errors import BudgetError, ModelError
from symflex.expressions import format_expression
from symflex.matrices.smith_mcmillan import in_expressions, smith_mcmillan
from symflex.matrices.transfer_matrix import derive_matrix
from symflex.model import Model
from tests.unit.matrices.models import BEAM, TWO_MASSES, model_of, of_functions


def form_of(model: Model) -> list[str]:
    matrix = derive_matrix(model)
    return [format_expression(entry) for entry in in_expressions(matrix, smith_mcmillan(matrix))]


@pytest.mark.parametrize(
    ("rows", "form"),
    [
        # N = [s+3, 2(s+1); s+3, s+3], d = (s+1)(s+3): D_1 = 1, D_2 = (s+3)(s-1)
        ([["1/(s+1)", "2/(s+3)"], ["1/(s+1)", "1/(s+1)"]], ["1/((s + 1)*(s + 3))", "(s - 1)/(s + 1)"]),
        # N = [s-1, 4; 4.5, 2(s-1)], d = s+2: D_1 = 1, D_2 = (s+2)(s-4)
        ([["(s-1)/(s+2)", "4/(s+2)"], ["4.5/(s+2)", "2*(s-1)/(s+2)"]], ["1/(s + 2)", "s - 4"]),
        # Rows depend on each other.
        ([["1/(s+1)", "1/(s+2)"], ["2/(s+1)", "2/(s+2)"]], ["1/((s + 1)*(s + 2))"]),
        # A pole and a zero at -1, in different places: N = diag(s+2, (s+1)^2), D_1 = 1.
        ([["1/(s+1)", "0"], ["0", "(s+1)/(s+2)"]], ["1/((s + 1)*(s + 2))", "s + 1"]),
    ],
)
def test_forms_are_those_of_the_minors(rows: list[list[str]], form: list[str]) -> None:
    assert form_of(of_functions(*rows)) == form


def test_two_masses_keep_their_symbols() -> None:
    # N is the adjugate of K + M s^2, so that det N is d itself.
    first, second = form_of(model_of(TWO_MASSES))
    assert second == "1"
    assert first.startswith("1/(m_1*m_2*s^4")


def test_functions_that_are_not_rational_have_no_form() -> None:
    with pytest.raises(ModelError, match="only a matrix of rational functions"):
        form_of(model_of(BEAM))


def test_a_matrix_of_too_many_minors_is_refused() -> None:
    row = [f"1/(s+{j})" for j in range(1, 8)]
    with pytest.raises(BudgetError, match="too many minors"):
        form_of(of_functions(*(row for _ in range(8))))

"""Roots of matrices as text and JSON."""

from __future__ import annotations

from symflex.matrices.matrix_roots import matrix_roots_text
from symflex.matrices.zeros import locate_matrix
from tests.unit.matrices.models import numbers, of_functions, state_space


def test_the_text_tells_rank_decoupling_zeros_and_directions() -> None:
    # By hand: det = (1 - s)/((s + 1)^2 (s + 3)), and at s = 1 the matrix is [1, 1; 1, 1]/2.
    found = locate_matrix(of_functions(["1/(s+1)", "2/(s+3)"], ["1/(s+1)", "1/(s+1)"]))
    text = matrix_roots_text(found)
    assert "normal rank 2 of a 2 x 2 matrix" in text
    assert "s = 1.00000: inputs u_0 1, u_1 -1; outputs y_0 1, y_1 -1" in text
    assert "decoupling" not in text
    assert "invariant zeros" not in text


def test_the_text_tells_what_neither_input_nor_output_meets() -> None:
    model = state_space(numbers("-1 0\n0 -2"), numbers("1\n0"), numbers("1 0"))
    text = matrix_roots_text(locate_matrix(model))
    assert "decoupling zeros: 1, modes that the matrix does not have" in text
    assert "-2.00000         1          1     1" in text
    assert "invariant zeros: 1, at -2.00000" in text


def test_lines_keep_to_the_width() -> None:
    model = of_functions(*([f"(s + {i} + {j})/(s^2 + {i + 1})" for j in range(3)] for i in range(3)))
    text = matrix_roots_text(locate_matrix(model), width=80)
    assert max(map(len, text.splitlines())) <= 80


def test_json_has_the_records_of_roots_and_what_only_matrices_have() -> None:
    model = state_space(numbers("-1 0\n0 -2"), numbers("1\n0"), numbers("1 0"))
    document = locate_matrix(model, digits=15).to_json_dict()
    assert (document["schema"], document["tf"]) == ("symflex.roots/1", "y_0/u_0")
    matrix = document["matrix"]
    assert isinstance(matrix, dict)
    assert (matrix["outputs"], matrix["inputs"], matrix["normal_rank"]) == (["y_0"], ["u_0"], 1)
    (missed,) = matrix["decoupling_zeros"]
    counts = [missed[key] for key in ("input_decoupling", "output_decoupling", "both", "exact")]
    assert counts == [1, 1, 1, True]
    assert [float(zero["re"]) for zero in matrix["invariant_zeros"]] == [-2]


def test_directions_of_a_complex_zero_have_complex_entries() -> None:
    # [s^2 + 1, 0; 0, s + 1]/(s + 2)^3 turned by [1, 1; 0, 1]: at s = j the inputs (1, 0) move nothing.
    found = locate_matrix(of_functions(["(s^2+1)/(s+2)^3", "(s+1)/(s+2)^3"], ["0", "(s+1)/(s+2)^3"]))
    (above,) = (each for each in found.directions if each.zero.im > 0)
    assert [complex(x) for x in above.inputs] == [1, 0]
    entries = above.to_json_dict(15)["output"]
    assert isinstance(entries, list)
    assert [float(entry["re"]) for entry in entries] == [1, -1]

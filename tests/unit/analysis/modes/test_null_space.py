from flint import acb, acb_mat, arb, ctx

from symflex.analysis.modes.bound_equations import null_space


def test_the_null_vector_of_every_singular_matrix_in_the_balls_is_enclosed():
    wide = arb(2, 0.01)
    found = null_space(acb_mat([[acb(1), acb(wide)], [acb(2), acb(2) * wide]]))
    x, y = found.basis[0]
    assert all((x / y).contains(-value) for value in (1.99, 2, 2.01))


def test_balls_too_wide_give_no_answer():
    wide = acb(arb(0, 10))
    assert null_space(acb_mat([[wide, wide], [wide, wide]])) is None


def test_a_null_space_of_two_dimensions_is_seen_as_such():
    matrix = acb_mat([[1, 2, 3], [2, 4, 6], [3, 6, 9]])
    assert null_space(matrix) is None
    found = null_space(matrix, 2)
    assert not found.is_refuted
    assert all((x + 2 * y + 3 * z).contains(0) for x, y, z in found.basis)


def test_rows_and_columns_of_very_different_units_do_no_harm():
    with ctx.workprec(64):
        big, small = acb(10) ** 30, acb(10) ** -30
        found = null_space(acb_mat([[big, -2 * small], [2 * big, -4 * small]]))
        x, y = found.basis[0]
        assert abs(x / y * acb(10) ** 60 - 2) < arb(10) ** -10


def test_a_column_that_vanishes_with_the_determinant_does_not_set_the_scale():
    with ctx.workprec(128):
        matrix = acb_mat([[1, 0], [4204, acb(arb(0, 2.0**-100))]])
        assert null_space(matrix) is None
        found = null_space(matrix, typical=acb_mat([[1, 0], [4204, 1]]))
        x, y = found.basis[0]
        assert (x / y).contains(0)

"""Colocated pairs, found in the equations."""

from symflex.matrices.colocated import colocated
from tests.unit.matrices.models import TWO_MASSES, model_of


def test_the_motion_of_the_node_that_a_force_drives_is_colocated_and_no_other():
    assert colocated(model_of(TWO_MASSES)) == (("X_1", "F_1"), ("X_2", "F_2"))


def test_rates_and_differences_count_and_sums_and_signs_do_not():
    text = TWO_MASSES.replace('F_2 = { force = "x_2" }', 'F_2 = { force = ["x_1", "x_2"] }')
    text = text.replace(
        'X_2 = "x_2"',
        'V = "2*s*x_1"\nD = "s^2*(x_1 - x_2)"\nS = "x_1 + x_2"\nN = "x_2 - x_1"\n'
        'P = "k_1*x_1"\nL = "x_1/(s + 1)"',
    )
    assert colocated(model_of(text)) == (("X_1", "F_1"), ("V", "F_1"), ("D", "F_2"))

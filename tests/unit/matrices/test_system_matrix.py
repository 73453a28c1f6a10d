"""System matrices in balls and modulo a prime, compared with ranks that are seen."""

from __future__ import annotations

import numpy as np
import pytest
from flint import acb, arb, nmod_poly

from symflex.balls import precision
from symflex.matrices.system_matrix import SystemMatrix, interpolated, is_regular, null_vector, null_vectors
from symflex.model import Model, with_numbers
from symflex.transfer.of_model import assemble
from tests.unit.matrices.models import numbers, of_functions, state_space

# x_0 is moved and seen, x_1 is moved, x_2 is seen, x_3 neither.
FOUR_MODES = state_space(
    numbers("-1 0 0 0\n0 -2 0 0\n0 0 -3 0\n0 0 0 -4"), numbers("1\n1\n0\n0"), numbers("1 0 1 0")
)


def matrix_of(model: Model) -> SystemMatrix:
    outputs, inputs = ([each.name for each in some] for some in (model.outputs, model.inputs))
    return SystemMatrix.of(assemble(with_numbers(model)), outputs, inputs)


@pytest.mark.parametrize(("s", "moved", "seen"), [(-1, True, True), (-2, True, False), (-3, False, True)])
def test_full_rank_is_proved_at_modes_that_are_moved_and_seen(s: int, moved: bool, seen: bool) -> None:
    with precision(128):
        at = matrix_of(FOUR_MODES).on(acb(arb(s, 1e-25)))
        assert (at.is_controllable, at.is_observable) == (moved, seen)


def test_degrees_of_the_divisors_count_the_modes_that_are_missed() -> None:
    modulo = matrix_of(FOUR_MODES).modulo
    assert modulo is not None
    assert modulo.divisors is not None
    # The modes are 4; -3, -4 are not moved, -2, -4 not seen; these three are zeros of the system matrix.
    assert [divisor.degree() for divisor in modulo.divisors.each] == [4, 2, 2, 3, 3, 3]
    factor = nmod_poly([4, 1], modulo.prime)
    assert modulo.divisors.orders(factor).each == (1, 1, 1, 1, 1, 1)


def test_a_zero_at_the_first_number_does_not_lower_the_normal_rank() -> None:
    # det G = (1 - s)/((s + 1)^2 (s + 3))
    modulo = matrix_of(of_functions(["1/(s+1)", "2/(s+3)"], ["1/(s+1)", "1/(s+1)"])).modulo
    assert modulo is not None
    assert modulo.rank == 2


def test_a_filter_of_an_output_is_an_unknown_more() -> None:
    matrix = matrix_of(of_functions(["1/(s+1)"]))
    assert (len(matrix.upper), len(matrix.lower)) == (1, 1)


def test_a_null_vector_is_that_of_the_singular_matrix_in_the_ball() -> None:
    # [1, s; s, 1] at s = 1 has the null vector (1, -1).
    with precision(128):
        s = acb(arb(1, 1e-30))
        (vector,) = null_vectors([{0: acb(1), 1: s}, {0: s, 1: acb(1)}]) or []
        assert bool(abs(vector[0] / vector[1] + 1) < 1e-25)


def test_as_many_null_vectors_are_returned_as_the_rank_is_short() -> None:
    zero: dict[int, acb] = {}
    assert len(null_vectors([{0: acb(1)}, zero, dict(zero)]) or []) == 2
    assert null_vectors([{0: acb(1)}, dict(zero), dict(zero)], most=1) is None
    assert not is_regular([{0: acb(0, 0)}])
    assert is_regular([{0: acb(2)}])


def test_a_polynomial_is_found_from_its_values() -> None:
    points = [(s, (3 * s**3 + 2) % 10007) for s in range(5, 12)]
    assert [int(c) for c in interpolated(points, 10007).coeffs()] == [2, 0, 0, 3]


def test_the_null_vector_of_a_full_matrix_is_that_of_numpy() -> None:
    rank_short = np.arange(1.0, 26).reshape(5, 5) ** 2 % 17
    rank_short[4] = rank_short[:4].sum(axis=0)
    rows = [{j: acb(x) for j, x in enumerate(row)} for row in rank_short]
    vector = null_vector(rows)
    assert vector is not None
    found = np.array([complex(x).real for x in vector])
    expected = np.linalg.svd(rank_short)[2][-1]
    assert np.allclose(found / found[0], expected / expected[0], rtol=1e-9)
    assert null_vector([{0: acb(0)}, {0: acb(0)}]) is None

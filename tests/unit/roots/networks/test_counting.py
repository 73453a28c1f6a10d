"""What members add to a network, against matrices by numpy."""

import numpy as np
from flint import arb

from symflex.roots.networks.counting import _turn, add_member


def test_motions_are_turned_to_the_axes_of_a_member_and_angles_stay():
    turned = _turn([arb(0.6), arb(0.8)])
    matrix = np.array([[float(turned[i, j]) for j in range(3)] for i in range(3)])
    # Along (0.6, 0.8) a motion (3, 4) is 5 long, and has nothing across.
    assert np.allclose(matrix @ [3, 4, 7], [5, 0, 7])
    assert np.allclose(matrix @ [-4, 3, 0], [0, 5, 0])
    assert _turn([]) is None


def test_a_member_adds_its_stiffness_to_what_moves_its_ends():
    # Unknowns of both ends (rows of the network or held); in the third case both ends are at one node.
    random = np.random.default_rng(2)
    whole = random.integers(-9, 10, (4, 4))
    whole = whole + whole.T
    blocks = [whole[:2, :2].tolist(), whole[:2, 2:].tolist(), whole[2:, 2:].tolist()]
    for ends in ((0, 1, 2, 3), (None, 2, 0, None), (1, 0, 1, 0), (3, None, 3, 1)):
        taken = np.array([[float(i == end) for i in range(4)] for end in ends])
        expected = taken.T @ whole @ taken + np.eye(4)
        rows = [{i: arb(1)} for i in range(4)]
        add_member(rows, ends, [[[arb(x) for x in row] for row in block] for block in blocks])
        found = np.array([[float(row.get(j, 0)) for j in range(4)] for row in rows])
        assert np.array_equal(found, expected), ends

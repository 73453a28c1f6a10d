"""Which unit pivot is first, and what rows are left: against matrices worked out by hand."""

from __future__ import annotations

from symflex.algebra import Ring
from symflex.equations.elimination import eliminate_unit_pivots
from symflex.equations.elimination.closing import _cheapest

RING = Ring(("s", "a", "b"))
s, a, b = (RING.generator(n) for n in RING.names)
ONE = RING.constant(1)


def pivot(*rows, unknowns):
    """Return the pivot chosen first, as row and column."""
    columns = set(range(unknowns))
    users = {c: {i for i, row in enumerate(rows) if c in row} for c in columns}
    return _cheapest(dict(enumerate(rows)), users, columns)


# What a pivot may fill in: the other entries of its row times the other rows of its column.
CHOICES = {
    "a cheaper one in a later row": (
        ({0: ONE, 1: a, 2: a}, {1: ONE, 2: a}, {0: a, 2: a}),  # 2 * 1 and 1 * 1
        3,
        (1, 1),
    ),
    "a free one after one that costs little": (
        ({0: ONE, 1: a}, {0: a, 1: a}, {2: ONE}),  # 1 * 1 and 0
        3,
        (2, 2),
    ),
    "the first of two that cost the same": (
        ({0: ONE, 1: a, 2: a}, {1: ONE, 2: a}, {0: a, 1: a, 2: a}),  # 2 * 1 and 1 * 2
        3,
        (0, 0),
    ),
    "the first of two in one row": (
        ({0: a, 2: ONE, 1: ONE}, {0: a, 1: a, 2: a}),  # 2 * 1 twice
        3,
        (0, 1),
    ),
    "the one of a short row though many hold its column": (
        ({4: ONE, 0: a}, {0: a, 1: ONE, 2: a, 3: a, 4: a}, {1: a, 4: a}, {4: b}),  # 1 * 3 and 4 * 1
        5,
        (0, 4),
    ),
    "without what inputs add": (
        ({0: ONE, 1: a, 7: a, 8: a}, {0: a, 1: ONE, 2: a}, {1: a, 2: a}),  # 1 * 1 and 2 * 2
        3,
        (0, 0),
    ),
    "minus one too": (({0: a, 1: -ONE}, {0: a, 1: a}), 2, (0, 1)),
    "no number but one": (({0: RING.constant(2), 1: a}, {0: a, 1: RING.constant(-3)}), 2, None),
    "nothing of an input": (({0: a, 2: ONE}, {1: a, 3: ONE}), 2, None),
}


def test_the_pivot_that_can_fill_in_least_is_first():
    for name, (rows, unknowns, expected) in CHOICES.items():
        assert pivot(*rows, unknowns=unknowns) == expected, name


def test_a_row_is_put_into_the_others():
    for sign in [1, -1]:
        # x_0 = a x_1 + b u, so s x_0 + b x_1 is (a s + b) x_1 + b s u.
        found = eliminate_unit_pivots(
            ({0: ONE * sign, 1: -a * sign, 2: -b * sign}, {0: s, 1: b}), ({0: ONE}, {1: s}), 2
        )
        assert found.rows == ({1: a * s + b, 2: b * s},), sign
        assert found.outputs == ({1: a, 2: b}, {1: s}), sign
        assert (found.columns, found.kept) == ((1,), (1,)), sign


def test_a_chain_of_units_leaves_one_row():
    # x_0 = u, x_1 = a x_0, x_2 = a x_1 and s x_3 = x_2: s x_3 = a^2 u.
    rows = ({0: ONE, 4: -ONE}, {0: -a, 1: ONE}, {1: -a, 2: ONE}, {2: -ONE, 3: s})
    found = eliminate_unit_pivots(rows, ({3: ONE}, {2: ONE}), 4)
    assert found.rows == ({3: s, 4: -(a**2)},)
    assert found.outputs == ({3: ONE}, {4: a**2})
    assert (found.columns, found.kept) == ((3,), (3,))

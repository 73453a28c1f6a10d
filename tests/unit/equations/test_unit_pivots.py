"""Which unit pivot is first, and what rows are left: against matrices worked out by hand."""

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


def test_a_chain_of_units_leaves_one_row():
    # x_0 = u, x_1 = a x_0, x_2 = a x_1 and s x_3 = x_2: s x_3 = a^2 u.
    rows = ({0: ONE, 4: -ONE}, {0: -a, 1: ONE}, {1: -a, 2: ONE}, {2: -ONE, 3: s})
    found = eliminate_unit_pivots(rows, ({3: ONE}, {2: ONE}), 4)
    assert found.rows == ({3: s, 4: -(a**2)},)
    assert found.outputs == ({3: ONE}, {4: a**2})
    assert (found.columns, found.kept) == ((3,), (3,))

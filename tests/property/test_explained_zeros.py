"""Colocated zeros of random networks are the eigenvalues of the pencil without the held coordinate.

The matrices are put together here from the branches, and solved by numpy.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symflex import pipeline
from symflex.analysis.explanation import explain_zeros


@st.composite
def trees(draw):
    """Masses on a tree of springs, one of them on the ground: (masses, [(a, b, stiffness)], driven)."""
    size = draw(st.integers(2, 6))
    masses = draw(st.lists(st.integers(1, 5), min_size=size, max_size=size))
    springs = [(draw(st.integers(0, i - 1)), i, draw(st.integers(1, 9))) for i in range(1, size)]
    return masses, springs, draw(st.integers(0, size - 1))


def specification(masses, springs, driven):
    lines = ["symflex = 1", "[elements]"]
    lines += [f'm{i} = {{ type = "mass", at = "x{i}", m = {m} }}' for i, m in enumerate(masses)]
    lines += [
        f'k{i} = {{ type = "spring", between = ["x{a}", "x{b}"], k = {k} }}'
        for i, (a, b, k) in enumerate(springs)
    ]
    lines += ['soil = { type = "spring", between = ["x0", "ground"], k = 4 }', "[inputs]"]
    lines += [f'F = {{ force = "x{driven}" }}', "[outputs]", f'X = "x{driven}"']
    return "\n".join(lines)


def held_frequencies(masses, springs, driven):
    """Return the squared natural frequencies with one mass held, and the sizes of what is left in pieces."""
    stiffness = np.zeros((len(masses),) * 2)
    stiffness[0, 0] = 4
    for a, b, k in springs:
        stiffness[np.ix_([a, b], [a, b])] += k * np.array([[1, -1], [-1, 1]])
    kept = [i for i in range(len(masses)) if i != driven]
    scale = np.sqrt(np.array(masses, dtype=float)[kept])
    squares = np.linalg.eigvalsh(stiffness[np.ix_(kept, kept)] / np.outer(scale, scale))
    groups = {i: {i} for i in kept}
    for a, b, _ in springs:
        if driven not in (a, b):
            joined = groups[a] | groups[b]
            groups.update(dict.fromkeys(joined, joined))
    pieces = {frozenset(group) for group in groups.values()}
    return squares, sorted(2 * len(piece) for piece in pieces)


@pytest.mark.slow
@settings(max_examples=40)
@given(trees())
def test_colocated_zeros_are_the_poles_of_the_held_network(tree):
    model = pipeline.loads(specification(*tree))
    (bound,) = pipeline.derive_bound(model, [("X", "F")])
    found = pipeline.roots(bound)
    told = explain_zeros(model, bound, found)
    squares, orders = held_frequencies(*tree)
    assert (told.kind, told.status, told.is_direct) == ("colocated", "proved", True)
    assert sorted(part.order for part in told.parts) == orders
    roots = [*found.zeros, *(h.root for h in found.hidden)]
    ours = [float(r.im.mid()) ** 2 for r in roots for _ in range(r.multiplicity) if r.im > 0]
    assert np.allclose(sorted(ours), squares, rtol=1e-9)

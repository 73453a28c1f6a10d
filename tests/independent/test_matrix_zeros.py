"""Poles and zeros of random matrices: Smith forms of lumped ones, beams by transfer matrices."""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest
import scipy.linalg

from symflex.matrices.zeros import locate_matrix
from symflex.roots import Rectangle, Root
from tests.independent.smith import Rows, roots, zeros_of
from tests.independent.winding import count_inside
from tests.unit.matrices.models import model_of, state_space

KINDS = ("square", "tall", "wide", "hidden", "repeated", "feedthrough", "singular", "both")
HELD = {"free": (0, 1), "fixed": (2, 3), "pin": (1, 3)}  # which of w, w', w'', w''' are free at the left end


def random_system(seed: int) -> tuple[Rows, Rows, Rows, Rows]:
    """Return state equations of one of several kinds, with small integers."""
    draw = random.Random(seed)
    kind, n = KINDS[seed % len(KINDS)], draw.randint(3, 6)
    p, m = {"tall": (3, 2), "wide": (1, 3)}.get(kind, (2, 2))

    def some(rows: int, columns: int) -> Rows:
        return [[Fraction(draw.choice([-3, -1, 0, 0, 1, 2])) for _ in range(columns)] for _ in range(rows)]

    a, b, c, d = some(n, n), some(n, m), some(p, n), [[Fraction(0)] * m for _ in range(p)]
    if kind == "feedthrough":
        d = some(p, m)
    if kind == "singular":
        c[1] = [2 * x for x in c[0]]
    if kind == "hidden":  # the last state moves by itself
        a[-1], b[-1] = [Fraction(0)] * (n - 1) + [Fraction(-2)], [Fraction(0)] * m
    if kind == "both":  # and moves no other, and is not seen
        a = [[*row[:-1], Fraction(0)] for row in a[:-1]] + [[Fraction(0)] * (n - 1) + [Fraction(-2)]]
        b[-1], c = [Fraction(0)] * m, [[*row[:-1], Fraction(0)] for row in c]
    if kind == "repeated":
        a = [[Fraction(-1 if i == j else int(j == i + 1 and i % 2 == 0)) for j in range(n)] for i in range(n)]
    return a, b, c, d


def matches(found: list[tuple[complex, int]], expected: list[tuple[complex, int]]) -> bool:
    left = list(expected)
    for z, order in found:
        near = next((w for w in left if abs(w[0] - z) < 1e-9 * (1 + abs(z)) and w[1] == order), None)
        if near is None:
            return False
        left.remove(near)
    return not left


def listed(some: tuple[Root, ...]) -> list[tuple[complex, int]]:
    return [(complex(root), root.multiplicity) for root in some]


@pytest.mark.parametrize(
    "seed", [*range(8), *(pytest.param(k, marks=pytest.mark.slow) for k in range(8, 64))]
)
def test_lumped_matrices_have_the_poles_and_zeros_of_their_smith_forms(seed: int) -> None:
    system = random_system(seed)
    expected = zeros_of(*system)
    found = locate_matrix(state_space(*([[str(x) for x in row] for row in part] for part in system)))
    apart = found.decoupling_zeros
    assert found.normal_rank == expected.rank
    assert found.located.certificate.certified
    assert matches(listed(found.located.poles), roots(expected.poles))
    assert matches(listed(found.located.zeros), roots(expected.zeros))
    assert matches(listed(found.invariant_zeros), roots(expected.invariant))
    assert matches([(complex(z.root), z.inputs) for z in apart if z.inputs], roots(expected.inputs))
    assert matches([(complex(z.root), z.outputs) for z in apart if z.outputs], roots(expected.outputs))


Function = Callable[[complex], tuple[complex, complex]]


def random_beam(seed: int) -> tuple[str, Function, int]:
    """Return a beam of three pieces as text, its det A and det [A B; C D], and how many inputs it has."""
    draw = random.Random(seed)
    lengths = [draw.choice(["0.2", "0.3", "0.5"]) for _ in range(3)]
    left, right = draw.choice(list(HELD)), draw.choice(list(HELD))
    masses, dampers = ([draw.choice([0, 0, x]) for _ in range(4)] for x in (1, 3))
    free = [
        (i, d) for i in range(4) for d in ("y", "theta") if (i, d) not in _held(left, 0) + _held(right, 3)
    ]
    size = draw.choice([2, 2, 3])
    ends = [draw.sample(free, size) for _ in range(2)]
    lines = ["symflex = 1", "[elements]"]
    for i, length in enumerate(lengths):
        lines.append(
            f'b{i} = {{ type = "beam", between = ["n{i}", "n{i + 1}"], EI = 9, rhoA = 1, l = "{length}" }}'
        )
    for i in range(4):
        if masses[i]:
            lines.append(f'm{i} = {{ type = "mass", at = "n{i}.y", m = {masses[i]} }}')
        if dampers[i]:
            lines.append(f'd{i} = {{ type = "damper", between = ["n{i}.y", "ground"], b = {dampers[i]} }}')
    for i, kind in ((0, left), (3, right)):
        if kind != "free":
            lines.append(f'hold{i} = {{ type = "{kind}", at = "n{i}" }}')
    lines.append("[inputs]")
    kinds = {"y": "force", "theta": "torque"}
    lines += [f'u{k} = {{ {kinds[d]} = "n{i}.{d}" }}' for k, (i, d) in enumerate(ends[0])]
    lines += ["[outputs]", *(f'y{k} = "n{i}.{d}"' for k, (i, d) in enumerate(ends[1]))]

    def determinants(s: complex) -> tuple[complex, complex]:
        # State w, w', M = EI w'', V = M'; two unknowns at the left end, then the inputs.
        s = complex(s)
        state = np.zeros((4, 2 + size), complex)
        for k, row in enumerate(HELD[left]):
            state[row, k] = 1
        read = []
        for i in range(4):
            read.append(state.copy())
            state[3] -= (masses[i] * s * s + dampers[i] * s) * state[0]
            for k, (place, d) in enumerate(ends[0]):
                if place == i:
                    state[3 if d == "y" else 2, 2 + k] += 1 if d == "y" else -1
            if i < len(lengths):
                law = [[0, 1, 0, 0], [0, 0, 1 / 9, 0], [0, 0, 0, 1], [-s * s, 0, 0, 0]]  # EI = 9, rho A = 1
                state = scipy.linalg.expm(np.array(law, complex) * float(lengths[i])) @ state
        rows = [state[row] for row in sorted({0, 1, 2, 3} - set(HELD[right]))]
        rows += [read[place][0 if d == "y" else 1] for place, d in ends[1]]
        return complex(np.linalg.det(np.array(rows)[:2, :2])), complex(np.linalg.det(np.array(rows)))

    return "\n".join(lines), determinants, size


def _held(kind: str, node: int) -> list[tuple[int, str]]:
    return [(node, d) for d in {"free": (), "pin": ("y",), "fixed": ("y", "theta")}[kind]]


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_matrices_of_beams_have_as_many_roots_as_their_determinants_and_the_same(seed: int) -> None:
    text, determinants, size = random_beam(seed)
    low, high = complex(-60.5, -180.5), complex(61.5, 181.5)
    ends = (Fraction(x) for x in (low.real, high.real, low.imag, high.imag))
    found = locate_matrix(model_of(text), region=Rectangle(*ends))
    modes = (*found.located.poles, *(h.root for h in found.located.hidden))
    assert found.normal_rank == size
    for roots_found, which in ((modes, 0), (found.invariant_zeros, 1)):
        counted = count_inside(lambda s, which=which: determinants(s)[which], low, high)
        assert sum(root.multiplicity for root in roots_found) == counted
    for root in found.located.zeros:
        # Newton's step from the zero, with a slope by differences, is as small as the zero is right.
        z = complex(root)
        step = 1e-5 * abs(z)
        slope = (determinants(z + step)[1] - determinants(z - step)[1]) / (2 * step)
        assert root.is_zero or abs(determinants(z)[1] / slope) < 1e-8 * abs(z)

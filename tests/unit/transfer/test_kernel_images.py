"""Proofs that two polynomials share no factor with a kernel in it."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from symflex.algebra import Dispersion, Factored, Ring
from symflex.algebra.exponentials import Exponentials
from symflex.algebra.propagators import propagate
from symflex.transfer.kernel_images import KernelImages

BASE = Ring(("s", "k", "l"))
S, K, L = (Factored.generator(BASE, name) for name in BASE.names)


@pytest.fixture(scope="module")
def kernels():
    """The kernels of a beam, and of another one, by name, and the images of their ring."""
    laws = [Dispersion("w", "bending", (K * S**2, S * 0, S * 0, S * 0), S * 0) for _ in range(2)]
    found = propagate(BASE, [(law, [L]) for law in laws])
    ring = found.kernel_ring
    gens = {k.generator: ring.generator(k.generator) for k in found.table.kernels}
    named = {f"{k.function}_{k.wavenumber[-2]}": gens[k.generator] for k in found.table.kernels}
    named |= {name: ring.generator(name) for name in BASE.names}
    return SimpleNamespace(**named), KernelImages(ring, Exponentials(ring, found.table).angles)


APART = [
    (lambda v: v.cosh_0 + 2, lambda v: v.cosh_0 + 3),
    (lambda v: v.cos_0 + 2, lambda v: v.cos_0 + 3),
    (lambda v: v.s * v.cosh_0 * v.cos_0 + v.k, lambda v: v.s * v.cosh_0 * v.cos_0 - v.k),
    (
        lambda v: v.cosh_0 * v.sin_0 + v.k * v.sinh_0 * v.cos_0,
        lambda v: v.cosh_0 * v.sin_0 - v.k * v.sinh_0 * v.cos_0,
    ),
    (lambda v: v.cosh_0 + v.s, lambda v: v.cosh_1 + v.s),
    (lambda v: v.sin_0 * v.sinh_0 + v.s, lambda v: v.s + v.k),
]

SHARED = [
    (lambda v: (v.cosh_0 + v.s) * (v.cos_0 + v.k), lambda v: (v.cosh_0 + v.s) * (v.sin_0 + v.k)),
    # sinh x = 2 sinh(x/2) cosh(x/2) and cosh x + 1 = 2 cosh^2(x/2)
    (lambda v: v.sinh_0, lambda v: v.cosh_0 + 1),
    (lambda v: v.sin_0, lambda v: 1 - v.cos_0),
    # cosh^2 - 1 = sinh^2
    (lambda v: v.cosh_0 * v.cosh_0 - 1, lambda v: v.s * v.sinh_0),
    (
        lambda v: v.cosh_0 * v.cosh_1 + v.sinh_0 * v.sinh_1,
        lambda v: v.cosh_0 * v.cosh_0 * v.cosh_1 + v.cosh_0 * v.sinh_0 * v.sinh_1,
    ),
]


def test_coprime_polynomials_are_proved_apart(kernels):
    named, images = kernels
    assert [i for i, (f, g) in enumerate(APART) if not images.prove_apart(f(named), g(named))] == []


def test_polynomials_with_a_common_factor_are_not(kernels):
    named, images = kernels
    assert [i for i, (f, g) in enumerate(SHARED) if images.prove_apart(f(named), g(named))] == []


def test_what_is_of_lower_degree_than_it_seems_proves_nothing(kernels):
    named, images = kernels
    grown = named.cosh_0 + named.sinh_0  # exp(x): no zeros, and half the degree
    assert not images.prove_apart(grown, named.cosh_0 + 2)

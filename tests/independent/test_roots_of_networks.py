"""Poles and zeros of random networks, against responses of boundary-value problems and their winding."""

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from math import inf, pi

import pytest
from mpmath import arg, exp, mp, mpc, mpf

from symflex import pipeline
from symflex.model import with_numbers
from symflex.roots.networks.anywhere import roots_in_disc
from symflex.roots.networks.cramer import CramerEquations
from symflex.roots.networks.poles_zeros import locate_in_network
from symflex.roots.passivity import energy_proof
from symflex.roots.region import Band, Modes
from tests.independent.boundary_value import DIGITS
from tests.independent.members import is_seen, random_members, response, specification

POINTS = 72
"""On half a circle, on which the response turns by less than half a turn between two."""
BESIDE = mpf(10) ** -9
"""How far from a root its response is taken, relative to it: far beyond the root's own radius."""


def equations_of(network):
    return pipeline.assemble_sparse(with_numbers(pipeline.loads(specification(network)), in_kernels=True))


def located(network, region, digits=15):
    equations, pair = equations_of(network), ("X", "F")
    return locate_in_network(
        equations, "X/F", pair, region, digits, is_default=False, energy=energy_proof(equations.model)
    )


def growth(network, root):
    """Return the response beside a root over that twice as far: 2 at a simple pole, 1/2 at a simple zero."""
    with mp.workdps(DIGITS):
        s = mpc(root.decimal(15).re, root.decimal(15).im)
        step = abs(s) * BESIDE * mpc("0.6", "0.8")
        return complex(response(network, s + step) / response(network, s + 2 * step))


def is_quick(network):
    """Tell whether no roots accumulate below the second mode, as those of short shafts with damping do."""
    return not any(e.kind == "shaft" and dict(e.values).get("eta") for e in network.elements)


def networks(most, chosen):
    """Return networks with roots that can be compared, the first of up to two members, the others slow."""

    def comparable(size):
        every = (random_members(seed, size) for seed in range(60))
        return [network for network in every if is_quick(network) and is_seen(network)]

    larger = [pytest.param(network, marks=pytest.mark.slow) for network in comparable(most)[chosen]]
    return pytest.mark.parametrize("network", [comparable(2)[1], *larger], ids=lambda n: str(len(n.elements)))


@networks(6, slice(0, 40, 20))
@pytest.mark.slow
def test_responses_grow_and_vanish_where_roots_are(network):
    found = located(network, Modes(2))
    for roots, expected in ((found.poles, 2), (found.zeros, 0.5)):
        for root in roots:
            if root.multiplicity == 1 and not root.im < 0 and not root.is_zero:
                assert growth(network, root) == pytest.approx(expected, rel=0.01)


@pytest.mark.slow
@networks(4, slice(0))
def test_as_many_are_counted_as_the_response_winds(network):
    near = located(network, Modes(2))
    radius = float(max(abs(complex(float(p.re), float(p.im))) for p in near.poles)) * 1.1
    found = located(network, Band(Fraction(0), Fraction(radius) / Fraction(2 * pi)))
    assert found.certificate.certified, found.certificate.reason
    with mp.workdps(DIGITS):
        points = [radius * exp(mpc(0, pi * (k + 0.5) / POINTS)) for k in range(POINTS)]
        values = [response(network, s) for s in points]
        values.append(values[-1].conjugate())
        turned = 2 * sum(float(arg(b / a)) for a, b in pairwise(values))
        turned -= float(arg(values[-1] / values[-2])) - 2 * float(arg(values[0]))
    zeros, poles = (sum(r.multiplicity for r in roots) for roots in (found.zeros, found.poles))
    assert turned / (2 * pi) == pytest.approx(zeros - poles, abs=0.05)


def lossless(network):
    """Return a network without what loses energy or feeds back."""
    elements = tuple(
        replace(e, values=tuple((key, x) for key, x in e.values if key != "eta"))
        for e in network.elements
        if e.kind not in ("damper", "rotary_damper") and not e.source
    )
    return replace(network, elements=elements, blocks=())


def frequencies(roots, top):
    """Return the frequencies up to a highest [rad/s], each as often as there are roots."""
    found = [float(r.im) for r in roots for _ in range(r.multiplicity) if not r.im < 0]
    return sorted(x for x in found if x <= top)


@networks(7, slice(0, 2))
@pytest.mark.slow
def test_counts_of_eigenvalues_and_winding_numbers_find_the_same(network):
    network = lossless(network)
    counted = located(network, Modes(4))
    top = max(frequencies(counted.poles, inf)) * 1.05
    region = Band(Fraction(0), Fraction(top) / Fraction(2 * pi))
    counted = located(network, region)
    assert counted.certificate.certified
    cramer = CramerEquations.of(equations_of(network), "X", "F")
    wound = roots_in_disc(cramer, region, 15, symmetric=(False, False))
    assert frequencies(counted.poles, top) == pytest.approx(frequencies(wound.poles, top))
    assert frequencies(counted.zeros, top) == pytest.approx(frequencies(wound.zeros, top), abs=1e-9)
    hidden = [h.root for h in counted.hidden]
    assert frequencies(hidden, top) == pytest.approx(frequencies(wound.shared, top))

"""Poles and zeros that coincide are no modes, however the search for them went."""

from __future__ import annotations

from itertools import count

import pytest
from mpmath import cos, findroot, mpf, pi, sin

from symflex import pipeline
from symflex.errors import BudgetError
from symflex.roots import Budget, Modes, precision
from symflex.roots.distributed.side import Proof, Side
from symflex.roots.locate import locate
from symflex.roots.root import overlap

# Rods of equal travel time between ground and a mass: that they swing against each other while it rests is
# hidden, at n pi.
TWO_RODS = """
symflex = 1
[parameters]
E     = "1 Pa"
rho   = "1 kg/m^3"
E_2   = "3 Pa"
rho_2 = "3 kg/m^3"
A     = "1 m^2"
l     = "1 m"
[elements]
one  = { type = "rod", between = ["x", "ground"], E = "E", rho = "rho", A = "A", l = "l" }
two  = { type = "rod", between = ["x", "ground"], E = "E_2", rho = "rho_2", A = "A", l = "l" }
mass = { type = "mass", at = "x", m = "2 kg" }
[inputs]
F = { force = "x" }
[outputs]
N = "one.f"
"""


@pytest.fixture(scope="module")
def rods():
    model = pipeline.loads(TWO_RODS)
    return pipeline.derive_bound(model, model.transfer_functions)[0]


def poles():
    """2 s^2 + 4 s coth(s) = 0 on s = j w: w = 2 cot(w), one root in each interval (n pi, (n + 1/2) pi)."""
    ends = [(n * pi, (n + mpf(1) / 2) * pi) for n in range(3)]
    return [findroot(lambda w: w * sin(w) - 2 * cos(w), interval, solver="anderson") for interval in ends]


def upper(roots):
    return [float(root.im.mid()) for root in roots if root.im > 0]


@pytest.mark.parametrize("is_counted_at_once", [True, pytest.param(False, marks=pytest.mark.slow)])
def test_a_search_repeated_with_proof_keeps_hidden_modes_hidden(rods, monkeypatch, is_counted_at_once):
    if not is_counted_at_once:
        monkeypatch.setattr(Side, "counted", lambda self: Proof(0, 0, "for this test"))
    found = locate(rods, Modes(3), 12)
    assert ("subdivision" in found.certificate.engine) is not is_counted_at_once
    assert found.certificate.certified
    assert upper(found.poles) == pytest.approx([float(w) for w in poles()])
    assert found.zeros == ()
    assert upper(h.root for h in found.hidden) == pytest.approx([float(pi), float(2 * pi)])
    assert {h.cause for h in found.hidden} == {"coincident"}


@pytest.mark.parametrize("looks", range(20, 600, 60))
def test_no_root_of_a_search_broken_off_is_a_pole_and_a_zero(rods, looks):
    try:
        found = locate(rods, Modes(3), 12, Budget(looks, clock=count().__next__))
    except BudgetError:
        return
    with precision(128):
        assert not any(overlap(pole, zero) for pole in found.poles for zero in found.zeros)

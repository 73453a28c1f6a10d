"""Residues and approximations of networks, against their formula and the network itself."""

from fractions import Fraction

import pytest

from symflex import pipeline
from symflex.analysis.rational import approximate, find_residues
from symflex.analysis.time_response import SampleTimes, time_response
from symflex.model import with_numbers
from symflex.roots import Modes
from symflex.transfer import BoundNested
from symflex.transfer.nested_form import bind_any
from symflex.transfer.of_model import derive_nested
from tests.unit.loops.test_networks import chain

LAW = "K*r"
"""Without the loop, so that a force alone drives."""


def bound_of(count, representation):
    model = pipeline.loads(chain(count, law=LAW))
    if representation == "nested":
        (nested,) = derive_nested(with_numbers(model, in_kernels=True), [("Y", "r")])
        return bind_any(nested)
    (bound,) = pipeline.derive_bound(model, [("Y", "r")])
    return bound


@pytest.mark.slow
def test_residues_are_those_of_the_formula():
    written, network = (bound_of(1, kind) for kind in ("expanded", "nested"))
    assert isinstance(network, BoundNested)
    expected, found = (find_residues(bound, Modes(3), 20) for bound in (written, network))
    assert len(found) == len(expected) == 6
    for one, other in zip(found, expected, strict=True):
        assert not one.is_estimate
        assert one.coefficients[0].overlaps(other.coefficients[0])
        assert one.coefficients[0].rel_accuracy_bits() > 66


@pytest.mark.slow
def test_an_approximation_of_two_beams_is_close_to_them_below_its_modes():
    bound = bound_of(2, "nested")
    found = approximate(bound, 2, "product")
    assert found.modes == 2
    assert found.leading_coefficient == pytest.approx(bound(0j).real, rel=1e-12)
    omega = 2.5
    assert abs(found(1j * omega) / bound(1j * omega) - 1) < 2e-3


@pytest.mark.slow
def test_a_step_response_is_that_of_the_formula_and_not_certified():
    times = SampleTimes.evenly(Fraction(1, 5), 9)
    written, network = (time_response(bound_of(1, k), "step", times, 4) for k in ("expanded", "nested"))
    assert not network.certified and "the lowest 12" in network.reason
    assert all(a.overlaps(b) for a, b in zip(network.enclosures, written.enclosures, strict=True))
    largest = max(abs(written.values))
    assert float(max(y.rad() for y in network.enclosures)) < 1e-3 * largest

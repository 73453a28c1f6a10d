"""What symflex derives from random networks is what an independent dense solution gives at any s."""

import itertools

import numpy as np
import pytest
from hypothesis import assume, given, settings

import symflex
from benchmarks.generated import imported
from tests.property.networks import networks, passive_networks, reciprocal_networks, to_toml
from tests.property.tableau import respond

POINTS = (0.37 + 1.13j, 1.71 - 0.59j, 0.05 + 2.9j, -0.23 + 0.67j, 2.3 + 0j)
WORST_RELATIVE_ERROR = 1e-9
FLOOR = 1e-4
"""A value smaller than this part of what it was computed from is a difference: its error is absolute."""


def quiet(examples):
    return settings(max_examples=examples)


def pairs(network):
    """Return every (output, input)."""
    return itertools.product((name for name, _ in network.outputs), (entry.name for entry in network.inputs))


def reference(network, output, source, at):
    """Return the independent response, or drop the example when ``at`` is a pole of a signal loop."""
    try:
        return respond(network, output, source, at)
    except np.linalg.LinAlgError:
        assume(False)


def assert_close(found, expected):
    allowed = WORST_RELATIVE_ERROR * max(abs(expected.value), FLOOR * expected.scale)
    assert abs(complex(found) - expected.value) <= allowed


@given(network=networks())
@quiet(12)
@pytest.mark.slow
def test_the_bound_transfer_functions_agree_with_the_dense_tableau(network):
    model = symflex.loads(to_toml(network))
    for output, source in pairs(network):
        H = model.transfer_function(output, source).bind()
        for at in POINTS:
            assert_close(H(at), reference(network, output, source, at))


@pytest.mark.slow
@given(network=networks())
@quiet(20)
def test_the_exported_functions_agree_with_the_dense_tableau_and_broadcast_over_s(network):
    functions = imported(symflex.loads(to_toml(network)).export_numpy(), "exported").TRANSFER_FUNCTIONS
    for output, source in pairs(network):
        function = functions[f"{output}/{source}"]
        one_by_one = [function(at) for at in POINTS]
        for at, found in zip(POINTS, one_by_one, strict=True):
            assert_close(found, reference(network, output, source, at))
        assert np.allclose(function(np.array(POINTS)), one_by_one, rtol=1e-12, atol=1e-300)


@given(network=reciprocal_networks())
@quiet(12)
@pytest.mark.slow
def test_a_passive_network_is_reciprocal(network):
    model = symflex.loads(to_toml(network))
    there = model.transfer_function("Y_2", "U_1").bind()
    back = model.transfer_function("Y_1", "U_2").bind()
    for at in POINTS:
        scale = reference(network, "Y_2", "U_1", at).scale
        assert abs(complex(there(at)) - complex(back(at))) <= WORST_RELATIVE_ERROR * scale


@given(network=passive_networks())
@quiet(12)
@pytest.mark.slow
def test_neither_poles_nor_zeros_of_a_passive_driving_point_are_in_the_right_half_plane(network):
    G = symflex.loads(to_toml(network)).transfer_function("Y_1", "U_1")
    H = G.bind()
    assert not any(pole.re > 0 for pole in H.poles())  # a ball is positive only when all of it is
    # A held node has no zeros to speak of.
    assert G.num == 0 or not any(zero.re > 0 for zero in H.zeros())

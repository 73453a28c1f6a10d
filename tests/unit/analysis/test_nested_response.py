"""Responses and mode shapes of functions in nested form, against those of the same functions expanded."""

import numpy as np
import pytest

from symflex import pipeline
from symflex.analysis.modes import mode_shape
from symflex.analysis.response import follow_phase, respond
from symflex.model import with_numbers
from symflex.roots.functions.nested_function import NestedFunction
from symflex.transfer import bind_nested
from symflex.transfer.of_model import derive_nested

BEAM = 'type = "beam", E = "200 GPa", rho = "7800 kg/m^3", A = "100 mm^2", I = "1000 mm^4"'


def two_beams(loss: str = "") -> str:
    return f"""
    symflex = 1
    [elements]
    first = {{ {BEAM}, between = ["ground", "joint"], l = "0.3 m"{loss} }}
    spring = {{ type = "spring", between = ["joint", "ground"], k = "2 kN/m" }}
    second = {{ {BEAM}, between = ["joint", "tip"], l = "0.2 m"{loss} }}
    [inputs]
    F = {{ force = "tip" }}
    [outputs]
    Y = "tip"
    """


def both(text: str):
    model = pipeline.loads(text)
    (nested,) = derive_nested(with_numbers(model, in_kernels=True), model.transfer_functions)
    (expanded,) = pipeline.derive_bound(model, model.transfer_functions)
    return bind_nested(nested), expanded


@pytest.fixture(scope="module")
def lossless():
    return both(two_beams())


@pytest.mark.slow
def test_values_and_phases_of_a_lossless_network_are_those_of_the_expanded_form(lossless):
    nested, expanded = lossless
    omega = np.geomspace(1.0, 5e4, 12)
    found, expected = respond(nested, omega), respond(expanded, omega)
    np.testing.assert_allclose(found.values, expected.values, rtol=1e-14)
    np.testing.assert_allclose(found.phase, expected.phase, atol=1e-12)


@pytest.mark.slow
def test_the_phase_of_a_damped_network_is_followed_through_its_resonances():
    nested, expanded = both(two_beams(', eta = "1e-4 s"'))
    omega = np.geomspace(10.0, 3e3, 4)
    np.testing.assert_allclose(follow_phase(nested, omega), follow_phase(expanded, omega), atol=1e-9)


def test_the_order_at_rest_and_the_reach_of_all_members_are_known(lossless):
    nested, _ = lossless
    function = NestedFunction(nested)
    assert function.order_at_zero() == pytest.approx(0, abs=1e-9)
    # lambda = (rho A/(E I))^(1/4) sqrt(s), over 0.3 m and 0.2 m.
    wavenumber = (7800 * 1e-4 / (200e9 * 1e-9)) ** 0.25
    assert function.reach(100.0) == pytest.approx(wavenumber * 10 * 0.5, rel=1e-9)


@pytest.mark.slow
def test_mode_shapes_of_a_network_are_those_of_the_expanded_form(lossless):
    nested, expanded = lossless
    for number in (1, 2):
        one, other = mode_shape(nested, number), mode_shape(expanded, number)
        assert one.pole.im.overlaps(other.pole.im)
        for left in one.motions:
            assert left.value.overlaps(other.motion(str(left.variable)).value)

"""An element that is called idle may have any value: an independent dense solution does not see it."""

import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given

from symflex import pipeline
from tests.property.networks import networks, to_toml
from tests.property.tableau import respond
from tests.property.test_random_networks import pairs, quiet
from tests.random_models import ONE_TERMINAL, TWO_TERMINAL

POINTS = (0.37 + 1.13j, 1.71 - 0.59j)
SIMPLE = {**ONE_TERMINAL, **TWO_TERMINAL}


def idle_in(network):
    """Return the elements whose warnings say that they have no effect."""
    warnings = pipeline.warnings(pipeline.loads(to_toml(network)))
    told = [w.message for w in warnings if w.code == "SF654" or w.message.endswith("nothing")]
    names = {name for message in told for name in re.findall(r"'([^']*)'", message)}
    return [e for e in network.elements if e.name in names and e.kind in SIMPLE and len(e.values) == 1]


def responses(network):
    try:
        found = [respond(network, out, source, at) for out, source in pairs(network) for at in POINTS]
    except np.linalg.LinAlgError:
        assume(False)
    return np.array([complex(r.value) for r in found])


def with_another_value(network, element):
    ((key, parameter),) = element.values
    changed = replace(element, values=((key, replace(parameter, number=f"{3 * parameter.value:.1f}")),))
    elements = tuple(changed if e is element else e for e in network.elements)
    return replace(network, elements=elements)


@pytest.mark.slow
@quiet(60)
@given(networks())
def test_no_response_depends_on_the_value_of_an_element_that_is_called_idle(network):
    idle = idle_in(network)
    assume(idle)
    before = responses(network)
    for element in idle:
        after = responses(with_another_value(network, element))
        assert after == pytest.approx(before, rel=1e-9, abs=1e-12)

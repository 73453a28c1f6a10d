"""Principal parts and a power series in place of a function."""

import pytest
from flint import acb, acb_poly

import symflex
from symflex.analysis.norms.expanded import expanded, without_delay
from tests.unit.analysis.norms.models import cantilever, response
from tests.unit.refusals import refusal


def test_parts_and_series_add_up_to_the_function():
    function = expanded(cantilever().transfer_function("X", "F").bind().bound, 3)
    for omega in (1e-3, 100.0, 0.99 * function.used):
        s = acb(0, omega)
        value = acb_poly(list(function.regular))(s)
        for part in function.parts:
            value += sum(c / (s - part.pole) ** k for k, c in enumerate(part.coefficients, 1))
        assert complex(value) == pytest.approx(response(omega), rel=1e-9)
    assert float(function.missing) < 1e-12 and function.reasons == ()


def test_a_delay_of_all_is_taken_out():
    model = symflex.Model(inputs={"u": {}}, outputs={"y": "exp(-3*s)*u/(s + 1)"})
    bound, delay = without_delay(model.transfer_function("y", "u").bind().bound)
    assert float(delay) == 3 and bound(1j) == pytest.approx(1 / (1 + 1j))


def test_roots_of_s_have_no_principal_parts():
    model = symflex.Model(inputs={"u": {}}, outputs={"y": "u/(1 + sqrt(s))"})
    assert "SF802" in refusal(lambda: expanded(model.transfer_function("y", "u").bind().bound, 3))

"""Principal parts and a power series in place of a function."""

from math import pi

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


def test_parts_and_series_of_a_hyperbolic_tangent_are_those_of_a_table():
    # tanh(s)/s is the sum of 2/(s^2 + p^2), p = pi/2, 3 pi/2, ...; about 0 it begins with 1 - s^2/3.
    model = symflex.Model(inputs={"u": {}}, outputs={"y": "u*(1 - exp(-2*s))/((1 + exp(-2*s))*s)"})
    function = expanded(model.transfer_function("y", "u").bind().bound, 1)
    inside = [(k + 0.5) * pi for k in range(int(function.radius / pi + 0.5))]
    found = sorted((complex(part.pole).imag, complex(part.coefficients[0]).imag) for part in function.parts)
    assert found == [
        (pytest.approx(p), pytest.approx(-1 / p)) for p in sorted([*inside, *(-p for p in inside)])
    ]
    zeroth, first, second = (complex(x) for x in function.regular[:3])
    assert zeroth == pytest.approx(1 - sum(2 / p**2 for p in inside), abs=1e-13)
    assert second == pytest.approx(sum(2 / p**4 for p in inside) - 1 / 3, abs=1e-13)
    assert abs(first) < 1e-20 and function.reasons == ()


def test_a_delay_of_all_is_taken_out():
    model = symflex.Model(inputs={"u": {}}, outputs={"y": "exp(-3*s)*u/(s + 1)"})
    bound, delay = without_delay(model.transfer_function("y", "u").bind().bound)
    assert float(delay) == 3 and bound(1j) == pytest.approx(1 / (1 + 1j))


def test_roots_of_s_have_no_principal_parts():
    model = symflex.Model(inputs={"u": {}}, outputs={"y": "u/(1 + sqrt(s))"})
    assert "SF802" in refusal(lambda: expanded(model.transfer_function("y", "u").bind().bound, 3))

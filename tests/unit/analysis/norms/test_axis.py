"""Forms on pieces of the axis contain the function."""

import numpy as np
from flint import acb, acb_mat, arb

from symflex.analysis.norms.axis import MatrixOnAxis, TaylorForm
from symflex.analysis.norms.expanded import expanded
from symflex.balls import precision
from tests.unit.analysis.norms.models import cantilever, response


def test_forms_contain_the_function_in_the_disc_and_beyond():
    function = expanded(cantilever().transfer_function("X", "F").bind().bound, 2)
    matrix = MatrixOnAxis(((function,),))
    for form_on, low, high in ((matrix.in_disc, 900.0, 905.0), (matrix.beyond_disc, 9000.0, 9100.0)):
        form, middle = form_on(low, high), (low + high) / 2
        assert form.is_finite
        for omega in np.linspace(low, high, 5):
            with precision(128):
                t = arb(omega - middle)
                total = sum((m[0, 0] * t**k for k, m in enumerate(form.powers)), acb(0))
                off = abs(total - acb(response(omega))).lower()
            assert off <= form.off + 1e-15 * abs(response(omega)), omega


def test_tails_bound_the_function():
    function = expanded(cantilever().transfer_function("X", "F").bind().bound, 2)
    matrix = MatrixOnAxis(((function,),))
    size, power = matrix.tail_power(1e5)
    for omega in (1e5, 1e6, 1e7):
        assert abs(response(omega)) <= float(matrix.tail(1e5))
        assert abs(response(omega)) <= float(size) * omega**power
    assert matrix.tail(1.0) is None


def test_forms_multiply():
    form = TaylorForm((acb_mat(1, 1, [2]), acb_mat(1, 1, [1])), arb(0.5), arb(0))
    product = form.times(form, arb(1))
    assert [float(m[0, 0].real) for m in product.powers] == [4, 4, 1]
    assert float(product.off) >= 2 * 3 * 0.5 + 0.25

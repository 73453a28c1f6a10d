"""Programs of nested transfer functions: their values, and what becomes of long and wide expressions."""

import numpy as np
import pytest

from benchmarks.networks import chain, network
from symflex import pipeline
from symflex.codegen.module_text import formula_of
from symflex.codegen.program.build import build_nested
from symflex.codegen.program.evaluate import evaluate
from symflex.codegen.program.verify import choose_programs
from symflex.codegen.python.module import NUMPY
from symflex.errors import BudgetError
from symflex.expressions import Product, Sum, format_expression
from symflex.print.forms.nested import nested_form
from tests.unit.codegen.exportable import executed
from tests.unit.transfer.test_nested_form import CHAIN, dense


def test_the_exported_module_computes_what_the_matrix_gives():
    model = pipeline.loads(CHAIN)
    text = NUMPY.export(model, pipeline.derive_nested(model), samples=20).text
    functions = executed(text)["TRANSFER_FUNCTIONS"]
    s = np.array([0.3j, 12j, 40j, 2 - 3j, 500j])
    expected = np.array([dense(x, "F")[2] for x in s])
    assert np.allclose(functions["X_3/F"](s), expected, rtol=1e-9)
    # Parameters broadcast as everywhere: here all masses and stiffnesses grow alike.
    scaled = functions["X_3/F"](s, m_1=2.0, m_2=4.0, m_3=6.0, k=800.0, b=10.0)
    assert np.allclose(2 * scaled, expected, rtol=1e-9)


def test_the_error_is_measured_around_resonances():
    (tf,) = pipeline.derive_nested(pipeline.loads(CHAIN), [("X_3", "F")])
    program, verification = choose_programs(tf, samples=50)[0]
    assert verification.form == "nested"
    assert verification.samples > 60
    assert verification.error < 1e-14
    assert program.far is None


def test_nothing_overflows_from_nanoradians_to_terahertz():
    names = {f"{c}_{i}": 10.0 for c in "mkb" for i in range(1, 61)}
    (tf,) = pipeline.derive_nested(network(chain(60)), [("X_first", "F")])
    omega = np.logspace(-9, 12, 43)
    found = evaluate(build_nested(tf), 1j * omega, names)
    assert np.isfinite(found).all()
    assert found[0] == pytest.approx(-1 / (600 * omega[0] ** 2), rel=1e-9)
    assert found[-1] == pytest.approx(-1 / (10 * omega[-1] ** 2), rel=1e-9)


def test_without_values_a_few_missing_ones_are_named():
    (tf,) = pipeline.derive_nested(network(chain(30)), [("X_first", "F")])
    _, verification = choose_programs(tf)[0]
    assert verification.text() == "not verified: no values for m_1, m_2, m_3, m_4, m_5, m_6, and 82 more"


def test_a_docstring_names_the_command_that_prints_a_formula_nobody_would_read():
    (tf,) = pipeline.derive_nested(network(chain(150)), [("X_first", "F")])
    (sentence,) = formula_of(tf)
    assert sentence.endswith("in s, which symflex derive --tf X_first/F prints.")


def test_a_program_beyond_the_limit_is_refused(monkeypatch):
    monkeypatch.setattr("symflex.codegen.program.build.OPERATION_LIMIT", 100)
    (tf,) = pipeline.derive_nested(network(chain(30)), [("X_first", "F")])
    with pytest.raises(BudgetError) as caught:
        build_nested(tf)
    assert caught.value.diagnostics[0].code == "SF503"


@pytest.mark.slow
def test_long_products_and_sums_are_continued_in_lines_of_their_own():
    (tf,) = pipeline.derive_nested(network(chain(80)), [("X_last", "F")])
    form = nested_form(tf)
    lines = [form.num, form.den, *(e for _, e in form.where)]
    assert max(len(e.factors) for e in lines if isinstance(e, Product)) <= 26
    assert max(len(format_expression(e)) for e in lines) < 200
    star = network([(1, i) for i in range(2, 303)])
    (tf,) = pipeline.derive_nested(star, [("X_first", "F")])
    form = nested_form(tf)
    lines = [form.num, form.den, *(e for _, e in form.where)]
    assert max(len(e.terms) for e in lines if isinstance(e, Sum)) <= 100


def test_the_print_grows_in_proportion_to_the_chain():
    lengths = []
    for n in (20, 30, 40):
        (tf,) = pipeline.derive_nested(network(chain(n)), [("X_first", "F")])
        lengths.append(len(nested_form(tf).where))
    assert lengths[2] - lengths[1] == lengths[1] - lengths[0] == 20

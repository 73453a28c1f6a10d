"""Functions too large to be expanded unasked: coprime on a line, opened on demand, with numbers early."""

from fractions import Fraction

import mpmath
import pytest
from flint import acb, ctx

from benchmarks.chains import specification
from symflex import pipeline
from symflex.equations.elimination import Determinants, closing
from symflex.errors import BudgetError
from symflex.print.forms import print_form
from symflex.transfer.expansion import Expansion
from symflex.transfer.lowest_terms import DeterminantsOnLine

BODY = """
inputs = { F = { force = "x" } }
[elements]
M_1 = { type = "mass", at = "x", m = "m" }
M_2 = { type = "mass", at = "y", m = "m" }
K_1 = { type = "spring", between = ["x", "ground"], k = "k" }
K_2 = { type = "spring", between = ["y", "ground"], k = "k" }
C = { type = "spring", between = ["x", "y"], k = "c" }
"""


def chain(n):
    return pipeline.loads(specification(n))


def valued_chain(n):
    """Return a chain with numbers for its names, m_i = i + 1, k_i = 100 + i, b_i = 1/(i + 1)."""
    text = specification(n)
    for i in range(1, n + 1):
        text = text.replace(f"m_{i} = {{}}", f"m_{i} = {i + 1}").replace(
            f"k_{i} = {{}}", f"k_{i} = {100 + i}"
        )
        text = text.replace(f"b_{i} = {{}}", f'b_{i} = "1/{i + 1} N*s/m"')
    return pipeline.loads(text)


def receptances(n, s):
    """Return x_1/F and x_n/F of the valued chain from a dense solve."""
    a = mpmath.zeros(n)
    for i in range(n):
        a[i, i] += (i + 2) * s**2
    for i in range(n - 1):
        w = 101 + i + s / (i + 2)
        for row, column, sign in ((i, i, 1), (i + 1, i + 1, 1), (i, i + 1, -1), (i + 1, i, -1)):
            a[row, column] += sign * w
    force = mpmath.zeros(n, 1)
    force[0] = 1
    x = mpmath.lu_solve(a, force)
    return x[0], x[n - 1]


def on_line(model):
    equations = pipeline.assemble(model)
    expansion = Expansion.of(equations)
    return DeterminantsOnLine(Determinants.of(equations), expansion.plain, expansion.images)


@pytest.mark.slow
def test_a_chain_of_ten_is_opened_only_when_it_is_asked_for():
    tf = pipeline.derive_all(chain(10))[0]
    assert tf.is_large
    assert "ratio" not in vars(tf)
    # Every subset of links is cut or not: with a masses a chain has (4^a - 1)/3 terms over s^2.
    assert sorted(len(f) for f, _ in tf.ratio.factors) == [1, (2 * 4**9 + 1) // 3, (4**10 - 1) // 3]


def test_the_number_of_terms_is_bounded_before_opening():
    for tf in pipeline.derive_all(chain(9)):
        assert tf.is_large == (tf.closed.length > 50_000)
        bound = tf.closed.length
        assert bound >= sum(len(f) for f, _ in tf.ratio.factors if len(f) > 2)


@pytest.mark.slow
def test_orders_and_parameters_are_told_and_a_form_is_printed_without_opening(monkeypatch):
    driving, transfer = pipeline.derive_all(chain(10))
    assert driving.order == (18, 20)
    assert transfer.order == (9, 20)
    assert [p.name for p in driving.parameters] == [p.name for p in driving.model.parameters]
    assert print_form(transfer).name == "definitions"
    assert "ratio" not in vars(transfer)
    monkeypatch.setattr(closing, "TERM_LIMIT", 1_000)
    with pytest.raises(BudgetError, match="SF501"):
        _ = driving.ratio


def test_a_large_function_is_bound_without_opening():
    model = valued_chain(10)
    s = mpmath.mpc("-0.25", "1.5")
    with mpmath.workdps(40):
        expected = receptances(10, s)
    for tf, value in zip(pipeline.derive_all(model), expected, strict=True):
        assert tf.is_large
        bound = pipeline.bind(tf)
        assert "ratio" not in vars(tf)
        assert dict(bound.values)["m_3"].rational == 4
        with ctx.workprec(200):
            found = bound.enclosed(200)(acb(-0.25, 1.5))
        with mpmath.workdps(40):
            parts = (mpmath.mpf(x.mid().str(40, radius=False)) for x in (found.real, found.imag))
            assert abs(mpmath.mpc(*parts) - value) < 1e-30 * abs(value)


def test_other_values_may_be_given_to_a_large_function():
    tf = pipeline.derive_all(valued_chain(10))[0]
    bound = pipeline.bind(tf, {"k_1": Fraction(7)})
    plain = pipeline.bind(tf)
    at = acb(0, 1)
    assert dict(bound.values)["k_1"].rational == 7
    assert not bound.enclosed(100)(at).overlaps(plain.enclosed(100)(at))


def test_closed_and_opened_agree_where_both_are_made():
    model = valued_chain(6)
    s = mpmath.mpc("0.5", "2")
    with mpmath.workdps(40):
        expected = receptances(6, s)
    for tf, value in zip(pipeline.derive_all(model), expected, strict=True):
        opened = tf.ratio
        numbers = {p.name: p.value.rational for p in model.parameters}
        point = [mpmath.mpf(1)] * len(opened.ring.names)
        with mpmath.workdps(40):
            for i, name in enumerate(opened.ring.names):
                given = numbers.get(name)
                point[i] = (
                    s if name == "s" else mpmath.mpf(given.numerator) / given.denominator if given else 0
                )
            total = mpmath.mpf(opened.unit.numerator) / opened.unit.denominator
            for factor, exponent in opened.factors:
                value_of_factor = mpmath.mpf(0)
                for monomial, coefficient in factor.terms():
                    term = mpmath.mpf(int(coefficient))
                    for x, e in zip(point, monomial, strict=True):
                        if e:
                            term *= x ** int(e)
                    value_of_factor += term
                total *= value_of_factor**exponent
            assert abs(total - value) < 1e-30 * abs(value)


def test_common_factors_are_not_called_coprime_on_the_line():
    # The difference mode is not reached by the sum of both displacements: m s^2 + k + 2 c cancels.
    text = "symflex = 1\nparameters = {m = {}, k = {}, c = {}}" + BODY + '[outputs]\nD = "x + y"'
    line = on_line(pipeline.loads(text))
    assert not line.prove_coprime("D", "F")


def test_a_common_factor_without_s_is_not_overlooked():
    # x - y is zero wherever c enters, and x + y bears the factor m of both masses only in s.
    text = "symflex = 1\nparameters = {m = {}, k = {}, c = {}}" + BODY + '[outputs]\nX = "x"\nY = "c*y"'
    line = on_line(pipeline.loads(text))
    assert line.prove_coprime("X", "F")
    assert line.prove_coprime("Y", "F")
    free = text.replace('m = "m"', 'm = "c*m"').replace('k = "k"', 'k = "c*k"')
    assert not on_line(pipeline.loads(free)).prove_coprime("Y", "F")


def test_a_definition_that_divides_leaves_the_question_to_the_general_way():
    text = (
        "symflex = 1\nparameters = {m = {}, k = {}, c = {}}\n"
        + 'definitions = { Z = "k/c" }\n'
        + BODY.replace('k = "k"', 'k = "Z"')
        + '[outputs]\nX = "x"'
    )
    assert not on_line(pipeline.loads(text)).prove_coprime("X", "F")

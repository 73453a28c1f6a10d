"""What is printed is read back: a fault planted in a form or its text is caught, and nothing shown."""

from dataclasses import replace
from fractions import Fraction
from itertools import product

import mpmath
import pytest

from symflex import pipeline
from symflex.errors import BudgetError, InternalError
from symflex.expressions import (
    Call,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
    format_expression,
    nodes,
    number,
    quotient,
    replace_node,
)
from symflex.print import forms, read_back, text
from symflex.print.forms import print_form, zpk
from symflex.print.forms.printed import forms_of
from tests.independent.spec_expressions import evaluate
from tests.unit.codegen.models_with_kernels import derived

WAVE = """symflex = 1
parameters = { c = 340, l = 0.5 }
fields.w = { domain = ["0", "l"], equation = "EQUATION", conditions = ["w(0) = w_0", "w'(l) = 0"] }
inputs.w_0 = {}
outputs.tip = "w(l)"
"""
SUSPENSION = """symflex = 1
parameters = { m = "3 kg", k = "200 N/m", b = {}, g = { value = "-2 N/m", assume = "real" } }
definitions = { omega_0 = "sqrt(k/m)" }
inputs.u = {}
outputs.y = "omega_0*(b*s + k - g)/(m*s^2 + b*s + k)*u"
"""
HANGING = """symflex = 1
parameters = { g = "9.81 m/s^2", rhoA = "0.2 kg/m", l = "1.2 m" }
[fields.w]
domain = ["0", "l"]
equation = "(rhoA*g*(l - x)*w')' = rhoA*s^2*w"
conditions = ["w(0) = w_0"]
[inputs]
w_0 = { unit = "m" }
[outputs]
tip = "w(l)"
"""


def only(text):
    (tf,) = pipeline.derive_all(pipeline.loads(text))
    return tf


def mutants(node):
    """Yield what a part of a formula may become by one slip."""
    match node:
        case Sum((first, second, *rest)):
            yield Sum((first, second.operand if isinstance(second, Negative) else Negative(second), *rest))
            yield Sum((first, *rest)) if rest else first
        case Product((_, *rest)):
            yield Product(tuple(rest)) if len(rest) > 1 else rest[0]
        case Quotient(above, below):
            yield Quotient(below, above)
            yield Product((above, below))
        case Power(base, Number(value)):
            yield Power(base, Number(value + 1))
        case Call(name, argument) if name in ("sinh", "cosh", "sin", "cos"):
            yield replace(node, name={"sinh": "cosh", "cosh": "sinh", "sin": "cos", "cos": "sin"}[name])
            yield replace(node, argument=Product((Number(Fraction(2)), argument)))
        case Call("sqrt", argument):
            yield argument
        case Name("l"):
            yield Power(node, Number(Fraction(2)))


def wrong_forms(form):
    """Yield a form with one slip each, in the formula and in its lines."""
    parts = [("num", form.num), ("den", form.den), *enumerate(e for _, e in form.where)]
    for place, whole in parts:
        for node in dict.fromkeys(nodes(whole)):
            for other in mutants(node):
                wrong = replace_node(whole, node, other)
                if isinstance(place, str):
                    yield replace(form, **{place: wrong})
                else:
                    lines = list(form.where)
                    lines[place] = (lines[place][0], wrong)
                    yield replace(form, where=tuple(lines))


def is_caught(tf, form):
    try:
        read_back.read_back(tf, form)
    except InternalError as error:
        assert (error.exit_code, error.diagnostics[0].code) == (1, "SF992")
        return True
    return False


@pytest.mark.slow
def test_every_slip_in_a_form_is_caught():
    beam = derived("sliding_free_beam")[1]
    for tf in (only(SUSPENSION), only(WAVE.replace("EQUATION", "w'' = s^2/c^2*w")), beam):
        for name in forms_of(tf):
            if name != "zpk":  # of decimals a slip may be smaller than their rounding
                form = print_form(tf, name)
                left = [wrong for wrong in wrong_forms(form) if not is_caught(tf, wrong)]
                shown = [(format_expression(w.num), format_expression(w.den), w.where) for w in left]
                assert shown == [], (tf.name, name)


def test_a_wrong_form_is_not_shown_and_the_error_names_it(monkeypatch, tmp_path, capsys):
    from symflex.cli import run

    path = tmp_path / "suspension.toml"
    path.write_text(SUSPENSION)
    monkeypatch.setitem(
        forms.FORMS, "polynomial", lambda tf: replace(print_form(tf, "factored"), den=Name("m"))
    )
    for options in ([], ["--json"], ["--format", "latex"]):
        assert run(["derive", str(path), "--form", "polynomial", *options]) == 1
        shown = capsys.readouterr()
        assert shown.out == ""
        assert "error[SF992]: the factored form of y/u is not shown" in shown.err
        assert "report it" in shown.err


def test_a_name_that_no_line_explains_is_caught():
    tf = only(WAVE.replace("EQUATION", "w'' = s^2/c^2*w"))
    form = print_form(tf, "hyperbolic")
    with pytest.raises(InternalError, match="nothing says what q is"):
        read_back.read_back(tf, replace(form, where=()))
    with pytest.raises(InternalError, match="in a circle: q -> q"):
        read_back.read_back(tf, replace(form, where=(("q", Name("q")),)))


def test_a_text_that_reads_differently_is_caught(monkeypatch):
    tf = only(SUSPENSION)
    right = print_form(tf, "factored")
    for wrong in (
        lambda e: format_expression(e).replace("(", "").replace(")", ""),
        lambda e: format_expression(e).replace("+", "-"),
        lambda e: format_expression(e) + ")",
    ):
        with monkeypatch.context() as patched:
            patched.setattr(read_back, "format_expression", wrong)
            with pytest.raises(InternalError, match="the factored form of y/u is not shown"):
                read_back.read_back(tf, right)


def test_lines_that_lose_something_are_caught(monkeypatch):
    monkeypatch.setattr(text, "_lay_out", lambda text, *_, **__: [text[:-1]])
    with pytest.raises(InternalError, match="lines it was broken into"):
        text.wrapped(print_form(only(SUSPENSION)).num, 80)


def test_a_wrong_law_and_a_wrong_closed_form_are_caught():
    tf = only(HANGING)
    form = print_form(tf)
    assert read_back.read_back(tf, form) >= 8
    (left, closed), *others = form.closed
    wrong = replace(form, closed=((left, Product((closed, closed))), *others))
    with pytest.raises(InternalError, match=r"Z_11\(0\) is"):
        read_back.read_back(tf, wrong)
    (name, law), *laws = form.laws
    wrong = replace(form, laws=((name, replace(law, right=Negative(law.right))), *laws))
    with pytest.raises(InternalError, match="the equation of Z_1j"):
        read_back.read_back(tf, wrong)


def test_a_wrong_law_of_a_fundamental_function_is_caught():
    (tf, *_) = derived("third order")
    form = print_form(tf)
    (name, law), *laws = form.laws
    terms = law.left.terms
    wrong = replace(law, left=Sum((*terms[:-1], Negative(terms[-1]))))
    with pytest.raises(InternalError):
        read_back.read_back(tf, replace(form, laws=((name, wrong), *laws)))


def test_wrong_decimals_are_caught_and_rounded_ones_are_not():
    tf = only(SUSPENSION.replace("b = {}", 'b = "5 N*s/m"'))
    form = print_form(tf, "zpk", 3)
    read_back.read_back(tf, form, 3)
    with pytest.raises(InternalError, match="the zpk form of y/u is not shown"):
        read_back.read_back(tf, replace(form, den=number(1)), 3)


def test_roots_that_a_budget_leaves_out_are_not_printed_as_if_they_were_none(monkeypatch):
    tf = only(SUSPENSION.replace("b = {}", 'b = "5 N*s/m"'))
    locate = zpk.locate

    def partly(*arguments):
        found = locate(*arguments)
        return replace(found, poles=(), certificate=replace(found.certificate, reason="over", code="SF506"))

    monkeypatch.setattr(zpk, "locate", partly)
    with pytest.raises(BudgetError, match="not all roots of y/u were found"):
        print_form(tf, "zpk")


def test_hidden_factors_are_read_back(monkeypatch):
    tf = derived("clamped_clamped")[0]
    form, factors = forms.with_hidden(tf, print_form(tf))
    assert factors
    wrong = [(Product((Number(Fraction(2)), e)), times) for e, times in factors]
    with pytest.raises(InternalError, match="what cancelled from"):
        read_back.read_hidden(tf, form, wrong)


def test_an_argument_over_a_speed_is_divided_by_it():
    expected = {
        "w'' = s^2/c^2*w": "s*l/c",
        "w'' = 4*s^2/(9*c^2)*w": "2*s*l/(3*c)",
        "w'' = s*w": "l*sqrt(s)",
        "w'' = s^2*w": "s*l",
        "w'' = s/c*w": "l*sqrt(s/c)",
    }
    for equation, q in expected.items():
        tf = only(WAVE.replace("EQUATION", equation))
        for name in ("hyperbolic", "factored", "krylov", "polynomial"):
            lines = dict(print_form(tf, name).where)
            assert format_expression(lines["q"]) == q, (equation, name)


EVERYWHERE = (-0.7, -3.1, 0.4j, -0.4j, 1.3 + 0.6j, -0.8 + 0.5j, -0.6 - 0.9j, 0.7 - 1.1j)


BEAMS = ({"EI": 0.6, "rhoA": 1.7, "l": 0.8}, {"EI": 2.1, "rhoA": 0.3, "l": 1.4})


def boundary_values(c_0, length):
    """Return slider and tip of a beam ``w'''' = -c_0 w`` with ``w' = 0`` and ``w''' = 1`` at its start."""
    rates = [mpmath.root(-c_0, 4, k) for k in range(4)]

    def row(order, x):
        return [rate**order * mpmath.exp(rate * x) for rate in rates]

    matrix = mpmath.matrix([row(1, 0), row(3, 0), row(2, length), row(3, length)])
    shares = mpmath.lu_solve(matrix, mpmath.matrix([0, 1, 0, 0]))
    return [sum(a * b for a, b in zip(row(0, x), shares, strict=True)) for x in (0, length)]


BEAM = """symflex = 1
parameters = { EI = {}, rhoA = {}, l = {} }
[fields.w]
domain = ["0", "l"]
equation = "EI*w'''' + rhoA*POWER*w = 0"
conditions = ["w'(0) = 0", "EI*w'''(0) = F", "w''(l) = 0", "w'''(l) = 0"]
[inputs]
F = {}
[outputs]
near = "s*w(0)"
far = "s*w(l)"
"""


@pytest.mark.parametrize("power", ["s^2", "s^4", "s^2*(1 + s/3)"])
def test_vaughans_form_is_right_for_every_s(power):
    # Also where p is negative on the whole imaginary axis, for p = s^2*sqrt(rhoA/EI); and with damping.
    tfs = pipeline.derive_all(pipeline.loads(BEAM.replace("POWER", power)))
    printed = [print_form(tf, "vaughan") for tf in tfs]
    texts = [
        (format_expression(quotient(f.num, f.den)), tuple((n, format_expression(e)) for n, e in f.where))
        for f in printed
    ]
    with mpmath.workdps(25):
        for known, s in product(BEAMS, EVERYWHERE):
            v = {name: mpmath.mpf(x) for name, x in known.items()} | {"s": mpmath.mpc(s)}
            moved = boundary_values(v["rhoA"] / v["EI"] * evaluate(power, v), v["l"])
            for (formula, lines), w in zip(texts, moved, strict=True):
                expected = v["s"] * w / v["EI"]
                assert abs(evaluate(formula, v, lines) - expected) < 1e-18 * abs(expected), (known, s)

"""Expressions as LaTeX; what is expected is written by hand."""

from fractions import Fraction

import pytest

from symflex.errors import Source, Span, Text
from symflex.expressions import Attribute, Equation, Name, Number, Product, Sum, parse, product_of
from symflex.print.latex import latex_expression
from symflex.print.latex.expression import Writer, break_lines


def tree(text):
    return parse(Text(text, Span(Source("test", text), 0, len(text))))


# fmt: off
WRITTEN = {
    "2*zeta_p1*omega_p1*s": r"2 \zeta_{p1} \omega_{p1} s", "s^2 + 2*s - 3": "s^{2} + 2 s - 3",
    "-a - b": "-a - b", "a - (b - c)": "a - (b - c)", "a*(b + c)": "a (b + c)",
    "a*(b + c*(d + e))": "a [b + c (d + e)]", "a*(b + c*(d + e*(f + g)))": r"a \{b + c [d + e (f + g)]\}",
    "(a + b)^2": "(a + b)^{2}", "(-a)^2": "(-a)^{2}", "s^-1": "s^{-1}", "a/b": r"\frac{a}{b}",
    "(a + b)/(c*d)": r"\frac{a + b}{c d}", "(a/b)^2": r"\left( \frac{a}{b} \right)^{2}",
    "a*(b/c + d)": r"a \left( \frac{b}{c} + d \right)", "a/b/c": r"\frac{\frac{a}{b}}{c}",
    "a/(b/(c/d))": r"\frac{a}{\frac{b}{c/d}}", "x^(a/b)": "x^{a/b}", "x^(a/(b*c))": "x^{a/(b c)}",
    "s^(1/2)": r"\sqrt{s}", "s^0.5": r"\sqrt{s}", "sqrt(a + b)": r"\sqrt{a + b}",
    "sqrt(E*I/(rho*A))": r"\sqrt{\frac{E I}{\rho A}}", "sin(x)": r"\sin(x)",
    "cos(a/b)": r"\cos\left( \frac{a}{b} \right)", "sinh(x)^2*y": r"\sinh^{2}(x) \, y",
    "exp(-s*T_s)": r"\mathrm{e}^{-s T_{s}}", "log(a + b)": r"\log(a + b)", "s*2": "2 s",
    "2*3^n": r"2 \cdot 3^{n}", "0.25*m": "0.25 m", "4.7e-12*C": r"4.7 \cdot 10^{-12} C",
    "1000000*a": "1000000 a", "k_amp*k_t": r"k_{\mathrm{amp}} \, k_{t}", "EI*l": r"\mathit{EI} \, l",
    "pi*d": r"\pi d",
}  # fmt: skip
# fmt: on


def test_an_expression_prints_as_written_by_hand():
    assert {text: latex_expression(tree(text), {}) for text in WRITTEN} == WRITTEN


def test_an_exact_third_prints_as_a_fraction():
    assert latex_expression(product_of([Number(Fraction(1, 3)), Name("m")]), {}) == r"\frac{1}{3} m"


def test_a_declared_label_is_used():
    assert latex_expression(tree("r*s"), {"r": r"r_{trans}"}) == r"r_{trans} \, s"


def test_a_label_with_a_superscript_is_raised_in_parentheses():
    assert latex_expression(tree("k^2"), {"k": "k^{*}"}) == "(k^{*})^{2}"


def test_a_label_that_shows_a_sum_is_multiplied_in_parentheses():
    assert latex_expression(tree("a*k"), {"k": "x+y"}) == "a (x+y)"


def test_what_no_transfer_function_holds_is_refused():
    for node in (Attribute("motor", "i"), Equation(Name("a"), Name("b"))):
        with pytest.raises(TypeError):
            latex_expression(node, {})


@pytest.mark.slow
def test_a_tree_of_any_depth_is_printed():
    expression = Name("x")
    for _ in range(5000):
        expression = Sum((Name("a"), Product((Name("b"), expression))))
    assert latex_expression(expression, {}).count("a") == 5000


def lines(text, width):
    return break_lines(tree(text), Writer({}), width, width)


def test_a_sum_breaks_before_its_signs():
    # Each letter is about half an em wide, a sign with its space more than one.
    assert lines("a + b - c", 2.0) == ["a", "{}+ b", "{}- c"]


def test_a_product_breaks_with_a_sign_between_its_factors():
    assert lines("(a + b)*(c + d)", 5.0) == ["(a + b)", r"{}\times (c + d)"]


def test_a_factor_too_long_breaks_inside_its_parentheses_with_its_neighbours_beside_them():
    first, *_, last = lines("m*(a + b + c + d + e + f + g + h)*s", 9.0)
    assert first.startswith(r"m \bigl( a")
    assert last.endswith(r"h \bigr) s")


def test_what_continues_inside_parentheses_is_indented():
    _, *others = lines("m*(a + b + c + d + e + f + g + h)*s", 9.0)
    assert all(line.startswith(r"\quad {}+") for line in others)


def test_a_long_term_begins_a_line():
    assert lines("a + (b + c + d + e + f)*s", 8.0)[0] == "a"


def test_a_quotient_too_wide_breaks_at_a_slash():
    assert lines("(a + b)*(c + d)/(e + f)", 6.0) == ["(a + b) (c + d)", "{}/ (e + f)"]


def test_a_quotient_broken_within_a_product_stands_in_parentheses():
    assert r"\Bigl( (a + b)" in "".join(lines("x*((a + b)/(c + d + e + f))*y", 6.0))


def test_a_number_too_long_for_a_line_goes_on_in_the_next():
    assert "".join(lines(str(10**50 + 7), 10.0)) == str(10**50 + 7)

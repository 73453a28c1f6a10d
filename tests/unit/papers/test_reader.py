"""What the reader of LaTeX refuses, and where."""

import pytest

from symflex.errors import SpecError
from symflex.expressions import format_expression
from tests.unit.papers.reading import read

UNREAD = (
    (r"\sum_{i=1}^{n} a_i", 1, "whose ends are not numbers"),
    (r"a+\cdots+b", 3, "an ellipsis"),
    (r"b + |x|", 5, "a magnitude"),
    (r"\begin{cases} a & x>0 \\ b & x<0\end{cases}", 1, "a distinction of cases"),
    (r"a \approx b", 3, "nearly"),
    (r"k_{1,2}+k_{12}", 9, "two symbols would both be 'k_12'"),
    (r"\mathbf{K}+K", 12, "two symbols would both be 'K'"),
    (r"(a+b", 1, "never closed"),
    (r"\frac{a}", 8, "an argument is missing"),
    (r"a_{b", 3, "never closed"),
    (r"0.1\,\mathrm{s}\cdot s", 6, "may be a unit"),
    (r"1,5", 3, "more than one formula"),
    (r"\omega^2 + j", 12, "does not vanish"),
    (r"\input{secrets}", 1, "not read here"),
    (r"R\text{ s}", 2, "may be a unit"),
    (r"20\log_{10} a\;\text{dB}", 16, "may be a unit"),
    (r"\frac{a}{b}\ \mathrm{Hz}", 14, "may be a unit"),
    ("5e-3", 2, "may be a power of ten"),
)


@pytest.mark.parametrize(("latex", "column", "said"), UNREAD)
def test_what_is_not_understood_is_refused_at_its_place(latex: str, column: int, said: str) -> None:
    with pytest.raises(SpecError) as caught:
        read(latex)
    (problem,) = caught.value.diagnostics
    assert said in problem.message
    assert problem.span is not None
    assert problem.span.column == column


def test_nesting_and_length_are_bounded() -> None:
    with pytest.raises(SpecError, match="nested too deeply"):
        read("(" * 500 + "a" + ")" * 500)
    with pytest.raises(SpecError, match="at most 20000"):
        read("a+" * 20_000)
    with pytest.raises(SpecError, match="SF103"):
        read("((2^{64})^{64})^{64}")


@pytest.mark.parametrize(
    ("latex", "known", "text"),
    [
        (r"\frac{G(s)H(s)}{1 + G(s)H(s)}", "G H", "G*H/(1 + G*H)"),
        (r"\frac{G_1(s)}{1 + k\,G_2(s)\frac{1}{s + 100}}", "G_1 G_2 k", "G_1/(1 + k*G_2*(1/(s + 100)))"),
    ],
)
def test_several_constants_with_s_in_brackets_are_functions(latex, known, text):
    assert format_expression(read(latex, known)) == text


@pytest.mark.parametrize("latex", [r"\frac{1}{ms^2 + b(s) + k}", r"\frac{1}{J(s)^2 + b(s)}", r"G(s)H(s) + G"])
def test_a_constant_with_s_in_brackets_may_be_a_product(latex):
    with pytest.raises(SpecError, match="two ways"):
        read(latex, "m b k J G H")

"""What a paper calls s; each formula in s was written by hand."""

from math import isclose

import pytest

from symflex.errors import SpecError, Text
from symflex.expressions import parse
from symflex.papers.formula import evaluated
from tests.unit.papers.reading import read


@pytest.mark.parametrize(
    ("latex", "known", "reading"),
    [
        (r"\frac{1}{1 - \omega^2 LC + j\omega RC}", "L C R", "1/(1+s^2*L*C+s*R*C)"),
        (r"\frac{k}{k - m\Omega^2}", "k m", "k/(k+m*s^2)"),
        (r"\frac{a}{p + a}", "a", "a/(s+a)"),
        (r"\frac{1}{D^2 + c}", "c", "1/(s^2+c)"),
        (r"\frac{a}{p + a}", "a p", "a/(p+a)"),
    ],
)
def test_a_formula_is_in_s_whatever_the_paper_calls_it(latex, known, reading):
    found, expected = evaluated(read(latex, known)), evaluated(parse(Text.alone("own", reading)))
    assert isclose(abs(found - expected), 0, abs_tol=1e-12)


def test_an_imaginary_unit_beside_s_is_refused():
    with pytest.raises(SpecError, match="stand side by side"):
        read(r"\frac{1}{s + j\omega}")

"""Read one formula, as the tests of papers do."""

from symflex.errors import Text
from symflex.expressions import Expression
from symflex.papers.formula import read_latex
from symflex.papers.symbols import notation_of


def read(latex: str, known: str = "") -> Expression:
    return read_latex(Text.alone("paper.tex", latex), notation_of([(n, "") for n in known.split()]))[0][-1]

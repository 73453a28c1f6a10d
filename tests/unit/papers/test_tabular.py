"""Tables as ten authors type them."""

import pytest

from symflex.errors import SpecError, Text
from symflex.papers.tabular import LONGEST_TABLE, MOST_CELLS, cells_of, lists_of, printed_number


def lists(typed):
    return [(each.heading, each.entries) for each in lists_of(cells_of(Text.alone("table", typed)))]


@pytest.mark.parametrize(
    ("typed", "expected"),
    [
        (
            r"Mode & $\omega$ \\ \hline 1 & 3.516 \\ 2 & 22.03 \\ 3 & 61.70 \\ \hline",
            [(r"$\omega$", ("3.516", "22.03", "61.70"))],
        ),
        (
            r"\begin{tabular}{@{}lll@{}} \toprule $m$ & first & second \\ \midrule"
            r" 0 & 3.516 & 22.03 \\ 0.5 & 2.016 & 16.90 \\ \bottomrule \end{tabular}",
            [("0", ("3.516", "22.03")), ("0.5", ("2.016", "16.90"))],
        ),
        (
            r"Theory & 3{,}516 & 22{,}03 \\ Test & 3{,}48 & -- \\ & 1 & 2",
            [("Theory", ("3.516", "22.03")), ("", ("1", "2"))],
        ),
        (
            r"\begin{tabular*}{\textwidth}{lcc} $n$ & \multicolumn{1}{c}{$f_n$/Hz} & $\zeta$ \\"
            "\n1 & 10.2 % measured\n & 0.01 \\\\\n2 & 64.1 & 0.02 \\end{tabular*}",
            [("$f_n$/Hz", ("10.2", "64.1")), (r"$\zeta$", ("0.01", "0.02"))],
        ),
        *(
            (
                rf"Mode & $f$ \\ {a} & 3.516 \\ {b} & 22.03 \\ {c} & 61.70",
                [("$f$", ("3.516", "22.03", "61.70"))],
            )
            for a, b, c in (
                ("1st", "2nd", "3rd"),
                ("$1^{st}$", "$2^{nd}$", "$3^{rd}$"),
                ("Mode 1", "Mode 2", "Mode 3"),
                ("1.", "2.", "3."),
                ("(1)", "(2)", "(3)"),
                ("First", "Second bending", "Third"),
                (r"$\omega_1$", r"$\omega_2$", r"$\omega_3$"),
            )
        ),
        (
            r"m & $f_1$ & $f_2$ \\ 1 kg & 3.516 & 22.03 \\ 2 kg & 3.1 & 21.5",  # these count no modes
            [("1 kg", ("3.516", "22.03")), ("2 kg", ("3.1", "21.5"))],
        ),
        (
            r"n & $\beta l$ \\ 1 & 1,8751 \\ 2 & 4,6941 \\ 3 & 7,855",
            [(r"$\beta l$", ("1.8751", "4.6941", "7.855"))],
        ),
        (r"n & $f$ \\ 1 & 161.2 \\ 2 & 1,011.2", [("$f$", ("161.2", "1011.2"))]),
        (r"no numbers & at all \\ but & words", []),
    ],
)
def test_lists_of_numbers_are_found(typed, expected):
    assert lists(typed) == expected


@pytest.mark.parametrize(
    ("cell", "expected"),
    [
        ("3.516", "3.516"),
        ("$-1.2\\times10^{-3}$", "-1.2e-3"),
        (r"1\,111.5", "1111.5"),
        (r"\num{61.70}", "61.70"),
        ("61.7$^{*}$", "61.7"),
        ("\u2212 4.2", "-4.2"),
        ("---", "-"),
        ("", "-"),
        (r"Ref.~\cite{3}", None),
        ("3.5 Hz", None),
        ("$\\beta_1$", None),
        ("1.2.3", None),
    ],
)
def test_cells_are_digits_gaps_or_words(cell, expected):
    assert printed_number(cell) == expected


@pytest.mark.parametrize("typed", ["&" * (MOST_CELLS + 1), "1" * (LONGEST_TABLE + 1)])
def test_what_no_page_has_is_refused(typed):
    with pytest.raises(SpecError) as error:
        lists(typed)
    assert error.value.diagnostics[0].code == "SF103"


@pytest.mark.parametrize(
    "typed", ["{" * 5000, "}" * 5000, "\\" * 5001, r"\multicolumn{99}{c}{" * 500, "$^" * 9000]
)
def test_hostile_tables_end(typed):
    assert lists(typed) == []

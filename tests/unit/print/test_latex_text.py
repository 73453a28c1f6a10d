"""Plain text in LaTeX: whatever it holds, it prints and does nothing else."""

import re

from hypothesis import given
from hypothesis import strategies as st

from symflex.print.latex import escape_text
from symflex.print.latex.text import text_width

# Every command the module may write.
COMMANDS = re.compile(
    r"\\(?:textbackslash|textasciicircum|textasciitilde|textasciigrave|textquotedbl|quotesinglbase|quotedblbase|"
    r"ldots|textbullet|dag|ddag|texteuro|texttrademark|allowbreak|textexclamdown|textquestiondown|guillemotleft|"
    r"guillemotright|textsterling|textsection|textparagraph|textcopyright|textregistered|textordfeminine|"
    r"textordmasculine|textcent|textcurrency|textyen|textbrokenbar|textasciidieresis|textasciimacron|"
    r"textasciiacute|textonequarter|textonehalf|textthreequarters|ss|ae|AE|oe|OE|o|O|l|L|dj|DJ|dh|DH|th|TH|ng|NG|"
    r"i|ij|IJ|c)\{\}|\\[{}$&#%_-]|\\ensuremath\{[^{}]*(?:\{\d\})?\}|\\[`'^~=.\"urHvck]\{(?:[A-Za-z]|\\[ij])\}"
)


ESCAPED = {
    "50 % of $x_1$ & #2": r"50 \% of \$x\_1\$ \& \#2", r"\input{x}": r"\textbackslash{}input\{x\}",
    "x^2 ~ y": r"x\textasciicircum{}2 \textasciitilde{} y",
    "Größe, Łódź": r"Gr\"{o}\ss{}e,{} \L{}\'{o}d\'{z}",
    "ω and Ω": r"\ensuremath{\omega} and \ensuremath{\Omega}", "ΑΒ": "AB",
    "10–20 °C": r"10--20 \ensuremath{^\circ}C", "m²": r"m\ensuremath{^{2}}", "a\n\nb\tc": "a b c",
    "a\x00\x1b\u202eb": "ab", "中": "[U+4E2D]", "\ud800": "[U+D800]", "ﬁn": "fin", "'so'": "`{}so'{}",
    "a--b": "a-{}-{}b", "": "",
}  # fmt: skip


def test_text_is_escaped():
    assert {text: escape_text(text) for text in ESCAPED} == ESCAPED


@given(st.text())
def test_escaped_text_is_one_line_of_ascii_and_holds_no_command_that_is_not_ours(text):
    escaped = escape_text(text)
    assert all(" " <= c <= "~" for c in escaped)
    rest = COMMANDS.sub("", escaped)
    assert not set(rest.replace("{}", "")) & set("\\{}$&#%_^")


def test_a_long_word_may_be_broken_anywhere():
    assert escape_text("W" * 60).count(r"\allowbreak{}") >= 10


def test_an_ordinary_word_is_left_to_hyphenation():
    assert escape_text("electromechanical") == "electromechanical"


def test_the_width_of_text_is_never_below_that_of_its_digits():
    # A digit of cmr10 is half an em.
    assert 2.0 <= text_width("1234") <= 2.01

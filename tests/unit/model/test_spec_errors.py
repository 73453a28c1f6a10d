"""Syntax errors: all of a text at once, in the words of its author, and the rest still read."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symflex.errors import Diagnostic, Source, SpecError
from symflex.model.spec import (
    ArrayValue,
    NumberValue,
    OtherValue,
    TableValue,
    Value,
    parse,
    parse_with_recovery,
)


def problems(text: str) -> tuple[Diagnostic, ...]:
    return parse_with_recovery(Source("a.toml", text))[1]


def only(text: str) -> Diagnostic:
    found = problems(text)
    assert len(found) == 1
    return found[0]


def places(text: str) -> list[tuple[str, str]]:
    return [(str(p.span), p.code) for p in problems(text)]


def test_every_error_of_a_text_is_reported_in_order() -> None:
    text = '[parameters]\nm_1 = 60 kg\nm_2 = "20 kg\nk = "1 N/m"\nk = "2 N/m"\n[elements\nx == 2\n'
    assert places(text) == [
        ("a.toml:2:7", "SF101"),
        ("a.toml:3:7", "SF101"),
        ("a.toml:5:1", "SF102"),
        ("a.toml:6:1", "SF101"),
        ("a.toml:7:3", "SF101"),
    ]


def test_parse_raises_all_errors_together() -> None:
    with pytest.raises(SpecError) as raised:
        parse(Source("a.toml", "a = x y\nb = x y\n"))
    assert len(raised.value.diagnostics) == 2


def test_a_text_without_errors_has_no_diagnostics() -> None:
    assert problems('a = ["#", """\n[x]\n""", \'"\'] # = [\n') == ()


def test_at_most_twenty_errors_are_reported() -> None:
    assert len(problems("a = x y\n" * 50)) == 20


def test_the_first_twenty_errors_are_the_ones_reported() -> None:
    found = problems("".join(f"k{i} = {'x y' if i % 2 else chr(34)}\n" for i in range(50)))
    assert [p.span.line for p in found if p.span] == list(range(1, 21))


def test_a_common_mistake_is_pointed_at_with_what_to_write() -> None:
    for text, found, hint in [
        ("m = 60 kg\n", "60 kg", 'put it in quotes: "60 kg"'),
        ("m = 60 kg # mass\n", "60 kg", 'put it in quotes: "60 kg"'),
        ("m == 3\n", "==", "write a single '='"), ("on = True\n", "True", "write true"),
        ("on = FALSE\n", "FALSE", "write false"), ("m = none\n", "none", "leave the key out"),
        ("m = .5\n", ".5", "begin with a digit: 0.5"), ("m = 5.\n", "5.", "put a digit after the point: 5.0"),
        ("m = 0,5\n", "0,5", "write a decimal point: 0.5"),
        ("m = \u22125\n", "\u22125", "write '-' for U+2212: -5"),
        ("m\u00fc = 5\n", "m\u00fc", "names are ASCII: write 'mue'"),
        ("m = 007\n", "007", "write it without leading zeros"),
        ("m = \u201cx\u201d\n", "\u201cx\u201d", 'write straight quotes: "'),
        ('m = "60 kg\n', '"60 kg', 'add the closing quote: "'),
        ("m = '60 kg\n", "'60 kg", "add the closing quote: '"),
        ('m = """60\nkg\n', '"""60', 'add the closing quote: """'),
        ("m = [1, 2\n", "[", "add the closing ']'"), ("m = { a = 1\n", "{", "add the closing '}'"),
        ("[elements\n", "[", "add the closing ']'"), ("a.b]\nx = 1\n", "a.b]", "begin it with '['"),
        ("m: 3\n", ":", "write '=' instead of ':'"), ('m "3"\n', 'm "3"', "write '=' between key and value"),
        ("V_act/F = 3\n", "V_act/F", 'put it in quotes: "V_act/F"'),
        ("m =\n", "=", 'write a number, or text in quotes: "..."'), ("= 3\n", "=", "write key = value"),
        ("m = { a = 1, }\n", "}", "remove the comma"),
        ("[a] b = 1\n", "[a] b = 1", "begin a new line after [a]"), ("m = [on, 1]\n", "on", "write true"),
        ("m = 1\nm = 2\n", "m", "it is first defined in line 1"),
        ("[a]\n[b]\n[a]\n", "a", "it is first defined in line 1"),
    ]:  # fmt: skip
        problem = only(text)
        assert problem.span is not None, text
        assert (problem.span.text, problem.hint) == (found, hint), text


def test_latex_in_double_quotes_is_pointed_at_its_backslash() -> None:
    problem = only(r'latex = "k_\alpha"')
    assert problem.span is not None
    assert (problem.span.column, problem.span.text) == (12, r"\a")


def test_an_inline_table_over_several_lines_is_one_error() -> None:
    text = "m = {\n  a = 1,\n  b = 2\n}\nn = 3\n"
    assert only(text).message == "an inline table must end on the line where it begins"


def recovered(text: str) -> TableValue:
    return parse_with_recovery(Source("a.toml", text))[0].root


def value_of(text: str, key: str) -> Value:
    found = recovered(text).get(key)
    assert found is not None
    return found.value


def test_what_is_left_open_or_wrong_ends_before_the_next_statement_and_stays_known() -> None:
    for text, keys, errors in [
        ("a = [1,\n 2\nb = 3\n", ("a", "b"), 1),
        ("a = [1,\n 2\n\n[elements]\nb = 3\n", ("a", "elements"), 1),
        ('a = """\nprose, more\nprose\nb = 3\n', ("a", "b"), 1),
        ("m =\nn = 1\n", ("m", "n"), 1),
        # A control character in a comment harms no statement.
        ("a = 1\n# \x07\nb = 2\n", ("a", "b"), 1),
    ]:
        assert (recovered(text).keys(), len(problems(text))) == (keys, errors), text


def test_a_value_that_is_wrong_is_kept_and_others_keep_their_places() -> None:
    text = "é = 1\nm = 60 kg of iron\nn = 17\n"
    wrong, other = value_of(text, "m"), value_of(text, "n")
    assert (type(wrong), wrong.span.text) == (OtherValue, "60 kg of iron")
    assert (other.span.line, other.span.column, other.span.text) == (3, 5, "17")


def test_entries_under_a_broken_or_repeated_header_go_to_the_table_it_names() -> None:
    for text, key, keys in [
        ("[a]\nx = 1\n[elements\ny = 2\n", "elements", ("y",)),
        ("[a]\nx = 1\nelements]\nx = 2\n", "elements", ("x",)),
        ("[a]\nx = 1\n[b]\n[a]\ny = 2\n", "a", ("x", "y")),
    ]:
        table = value_of(text, key)
        assert isinstance(table, TableValue), text
        assert table.keys() == keys, text


def test_of_a_repeated_key_the_first_value_is_kept() -> None:
    table = value_of("[a]\nx = 1\n[b]\n[a]\nx = 2\n", "a")
    assert isinstance(table, TableValue)
    for root in (table, recovered("x = 1\nx = 2\n")):
        found = root.get("x")
        assert found is not None
        assert isinstance(found.value, NumberValue)
        assert found.value.literal == "1"


def test_a_repeated_key_of_an_inline_table_is_sf102() -> None:
    assert only("m = { a = 1, a = 2 }\n").code == "SF102"


def test_a_header_inside_an_inline_table_is_sf102() -> None:
    assert only("a = { b = 1 }\n[a.c]\n").code == "SF102"


def test_a_control_character_is_reported_as_its_code_point() -> None:
    for text in ["a = \x00\n", "# \x07\n", 'a = "\x1b[31m"\n', "a = 1\rb = 2\n"]:
        assert only(text).message.startswith("control character U+00"), text


def test_half_a_surrogate_pair_is_refused() -> None:
    with pytest.raises(SpecError) as raised:
        parse(Source("a.toml", 'a = "\ud800"\n'))
    assert raised.value.diagnostics[0].code == "SF101"


# fmt: off
FRAGMENTS = [
    "a", "b.c", "1", "-0.5e3", "=", " = ", "[", "]", "[[a]]", "{", "}", ",", ".", "\n", "\r\n", "\r", " ",
    "#", "\\", '"', "'", '"""', "'''", '"x"', "'é'", '\\"', "\\u00e9", "é", "😀", "true", "inf", "\x00",
    "\ufeff", "2024-01-01", "\na = ", "\n[a]\n", "\n[x.y]\n", "\nb = { c = 1 }\n", "m = 60 kg\n",
    "d = [1,\n2]\n", "1e999999999", "\\ \n",
]
# fmt: on


def check(value: Value, source: Source) -> None:
    assert value.span.source is source
    assert 0 <= value.span.start <= value.span.end <= len(source.text)
    if isinstance(value, TableValue):
        for item in value.entries:
            assert 0 <= item.key_span.start <= item.key_span.end <= len(source.text)
            check(item.value, source)
    elif isinstance(value, ArrayValue):
        for each in value.items:
            check(each, source)


@settings(max_examples=100)
@given(st.lists(st.sampled_from(FRAGMENTS), max_size=40).map("".join))
@pytest.mark.slow
def test_any_text_gives_a_spec_or_a_spec_error(text: str) -> None:
    source = Source("a.toml", text)
    try:
        spec, found = parse_with_recovery(source)
    except SpecError as error:
        found = error.diagnostics
        assert {p.code for p in found} == {"SF103"}
    else:
        check(spec.root, source)
    assert all(p.render() and p.span for p in found)


def test_a_broken_header_of_a_table_that_is_an_array_later_joins_its_last_item() -> None:
    found = value_of("[a\nx = 1\n[[a]]\ny = 2\n", "a")
    assert isinstance(found, ArrayValue)
    assert [item.keys() for item in found.items if isinstance(item, TableValue)] == [("y", "x")]

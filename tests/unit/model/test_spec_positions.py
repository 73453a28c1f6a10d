"""Every key and value knows its place; expected places are counted by hand or found with str.index."""

from __future__ import annotations

from fractions import Fraction

import pytest

from symflex.errors import Source, Span
from symflex.model.spec import (
    ArrayValue,
    BooleanValue,
    KeyValue,
    NumberValue,
    OtherValue,
    StringValue,
    TableValue,
    parse,
)


def entry(text: str, *path: str) -> KeyValue:
    """Return the entry at a path of keys."""
    table = parse(Source("a.toml", text)).root
    for key in path[:-1]:
        found = table.get(key)
        assert found is not None
        assert isinstance(found.value, TableValue)
        table = found.value
    found = table.get(path[-1])
    assert found is not None
    return found


def place(span: Span) -> tuple[int, int, str]:
    return span.line, span.column, span.text


def test_a_key_stands_where_it_is_written() -> None:
    assert place(entry("# c\n\n  m_1 = 2\n", "m_1").key_span) == (3, 3, "m_1")


def test_a_number_stands_where_it_is_written() -> None:
    assert place(entry("a = 1\nm = 1_0.5e2 # c\n", "m").value.span) == (2, 5, "1_0.5e2")


def test_a_string_value_spans_its_quotes() -> None:
    assert place(entry('m = "60 kg"\n', "m").value.span) == (1, 5, '"60 kg"')


def test_the_text_of_a_string_spans_what_is_between_its_quotes() -> None:
    value = entry('m = "60 kg"\n', "m").value
    assert isinstance(value, StringValue)
    assert (place(value.text.span), value.text.verbatim) == ((1, 6, "60 kg"), True)


def test_columns_after_characters_of_several_bytes_are_counted_in_characters() -> None:
    text = '# für 😀\n"α" = 1\np = { \'é\' = "ü€😀", k = "x" }\n'
    assert place(entry(text, "p", "k").value.span) == (3, 24, '"x"')


def test_columns_do_not_move_with_crlf_line_ends() -> None:
    assert place(entry('# é\r\na = 1\r\nb = "é"\r\nc = 3\r\n', "c").value.span) == (4, 5, "3")


def test_offsets_count_a_byte_order_mark_that_stands_in_the_text() -> None:
    span = entry("\ufeffa = 1\n", "a").key_span
    assert (span.start, span.text) == (1, "a")


def test_a_string_with_an_escape_is_not_verbatim() -> None:
    value = entry(r'm = "a\tb"', "m").value
    assert isinstance(value, StringValue)
    assert (value.text.value, value.text.verbatim, value.text.span.text) == ("a\tb", False, r"a\tb")


def test_a_literal_string_with_a_backslash_is_verbatim() -> None:
    value = entry(r"m = '\beta'", "m").value
    assert isinstance(value, StringValue)
    assert (value.text.value, value.text.verbatim) == (r"\beta", True)


def test_an_offset_in_a_string_of_several_lines_is_an_offset_in_the_text() -> None:
    value = entry('m = """\na +\n b\n"""\nn = 1\n', "m").value
    assert isinstance(value, StringValue)
    assert place(value.text.at(5, 6)) == (3, 2, "b")


def test_a_string_of_several_lines_spans_from_quotes_to_quotes() -> None:
    text = 'm = """\na\n b"""\nn = 1\n'
    span = entry(text, "m").value.span
    assert (span.start, span.end) == (4, text.index("\nn"))


def test_a_key_after_a_string_of_several_lines_stands_in_its_line() -> None:
    assert place(entry("m = '''\né\n b'''\nn = \"1\"\n", "n").key_span) == (4, 1, "n")


def test_a_backslash_at_a_line_end_with_blanks_after_it_joins_lines() -> None:
    value = entry('m = """a \\   \n   b"""\nn = 1\n', "m").value
    assert isinstance(value, StringValue)
    assert (value.text.value, value.text.verbatim) == ("a b", False)


def test_crlf_inside_a_string_makes_it_not_verbatim() -> None:
    value = entry('m = """\r\na\r\nb"""\r\n', "m").value
    assert isinstance(value, StringValue)
    assert (value.text.value, value.text.verbatim) == ("a\nb", False)


def test_quotes_directly_before_closing_quotes_belong_to_the_string() -> None:
    value = entry('m = """a"""""\n', "m").value
    assert isinstance(value, StringValue)
    assert (value.text.value, value.text.span.text) == ('a""', 'a""')


@pytest.mark.parametrize("written", ['""', "''", '""""""', "''''''"])
def test_an_empty_string_has_an_empty_place_between_its_quotes(written: str) -> None:
    value = entry(f"m = {written}\nn = 1\n", "m").value
    assert isinstance(value, StringValue)
    assert (value.text.span.start, value.text.span.end) == (4 + len(written) // 2,) * 2


def test_each_item_of_an_array_of_strings_has_its_place() -> None:
    value = entry('between = ["x_act", # é\n  "x_tip",\n]\n', "between").value
    assert isinstance(value, ArrayValue)
    assert [place(item.span) for item in value.items] == [(1, 12, '"x_act"'), (2, 3, '"x_tip"')]


def test_each_part_of_a_dotted_key_has_its_place() -> None:
    text = 'a . "b c".d = 1\n'
    assert [place(entry(text, *path).key_span) for path in (("a",), ("a", "b c"), ("a", "b c", "d"))] == [
        (1, 1, "a"),
        (1, 5, '"b c"'),
        (1, 11, "d"),
    ]


def test_a_table_made_by_a_dotted_key_spans_the_key() -> None:
    assert place(entry("a.b = 1\n", "a").value.span) == (1, 1, "a")


def test_a_table_spans_its_header() -> None:
    assert place(entry("x = 1\n [ a . b ] # c\ny = 1\n", "a", "b").value.span) == (2, 2, "[ a . b ]")


def test_a_quoted_key_in_a_header_is_decoded_and_placed() -> None:
    found = entry('[published."V_act/F"]\nexpr = "1"\n', "published", "V_act/F")
    assert (found.key, place(found.key_span)) == ("V_act/F", (1, 12, '"V_act/F"'))


def test_an_escape_in_a_quoted_key_is_decoded() -> None:
    assert entry(r'"\u03c9_1" = 1', "ω_1").key == "ω_1"


def test_a_table_first_named_by_a_longer_header_spans_its_own_header() -> None:
    assert place(entry("[a.b]\n[a]\n", "a").value.span) == (2, 1, "[a]")


def test_an_inline_table_spans_its_key() -> None:
    assert place(entry('  m = { value = "1 kg" }\n', "m").value.span) == (1, 3, "m")


def test_the_entries_of_an_inline_table_have_their_columns() -> None:
    text = '[elements]\ndrive = { type = "spring", between = ["a", "b"], k = "k" }\n'
    assert place(entry(text, "elements", "drive", "k").key_span) == (2, 50, "k")


def test_an_inline_table_in_an_array_spans_its_braces() -> None:
    value = entry("a = [{b = 1}]\n", "a").value
    assert isinstance(value, ArrayValue)
    assert value.items[0].span.text == "{b = 1}"


def test_repeated_double_headers_are_an_array_of_tables() -> None:
    value = entry("[[a]]\nb = 1\n[a.c]\nd = 2\n[[a]]\nb = 3\n", "a").value
    assert isinstance(value, ArrayValue)
    assert [(place(i.span), i.keys()) for i in value.items if isinstance(i, TableValue)] == [
        ((1, 1, "[[a]]"), ("b", "c")),
        ((5, 1, "[[a]]"), ("b",)),
    ]


def test_entries_keep_the_order_of_the_text() -> None:
    assert parse(Source("a.toml", "z = 1\na = 2\n[m]\n[b]\n")).root.keys() == ("z", "a", "m", "b")


def test_a_missing_key_gives_none() -> None:
    assert parse(Source("a.toml", "a = 1\n")).root.get("b") is None


def test_an_empty_text_is_an_empty_root_at_its_start() -> None:
    root = parse(Source("a.toml", "")).root
    assert (root.entries, root.span.line, root.span.column) == ((), 1, 1)


@pytest.mark.parametrize(
    ("literal", "value"),
    [
        ("0.1", Fraction(1, 10)),
        ("1e3", Fraction(1000)),
        ("1_000", Fraction(1000)),
        ("0xFF", Fraction(255)),
        ("0o17", Fraction(15)),
        ("0b101", Fraction(5)),
        ("-2.50E-1", Fraction(-1, 4)),
        ("+7", Fraction(7)),
        ("3.141592653589793238462643383279", Fraction(3141592653589793238462643383279, 10**30)),
        ("1e400", Fraction(10**400)),
        ("9" * 400, Fraction(10**400 - 1)),
    ],
)
def test_a_number_is_exact_and_keeps_its_literal(literal: str, value: Fraction) -> None:
    found = entry(f"x = {literal}\n", "x").value
    assert isinstance(found, NumberValue)
    assert (found.value, found.literal) == (value, literal)


def test_a_boolean_has_its_value() -> None:
    found = entry("x = true\n", "x").value
    assert isinstance(found, BooleanValue)
    assert (found.value, place(found.span)) == (True, (1, 5, "true"))


@pytest.mark.parametrize(
    ("written", "kind"),
    [
        ("1979-05-27T07:32:00Z", "date-time"),
        ("1979-05-27 07:32:00", "date-time"),
        ("1979-05-27", "date"),
        ("07:32:00", "time"),
        ("-inf", "inf"),
        ("nan", "nan"),
    ],
)
def test_a_value_without_use_is_kept_with_its_kind_and_place(written: str, kind: str) -> None:
    found = entry(f"x = {written} # c\n", "x").value
    assert isinstance(found, OtherValue)
    assert (found.kind, found.span.text) == (kind, written)

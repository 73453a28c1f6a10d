"""Every key and value knows its place; expected places are counted by hand or found with str.index."""

from __future__ import annotations

from fractions import Fraction

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
    for text, path, expected in [
        ("# c\n\n  m_1 = 2\n", ["m_1"], (3, 3, "m_1")),
        # After a string of several lines.
        ("m = '''\né\n b'''\nn = \"1\"\n", ["n"], (4, 1, "n")),
        # Each part of a dotted key.
        ('a . "b c".d = 1\n', ["a"], (1, 1, "a")),
        ('a . "b c".d = 1\n', ["a", "b c"], (1, 5, '"b c"')),
        ('a . "b c".d = 1\n', ["a", "b c", "d"], (1, 11, "d")),
        # Quoted in a header, and in an inline table.
        ('[published."V_act/F"]\nexpr = "1"\n', ["published", "V_act/F"], (1, 12, '"V_act/F"')),
        ('[e]\nd = { type = "spring", k = "k" }\n', ["e", "d", "k"], (2, 24, "k")),
    ]:
        found = entry(text, *path)
        assert (found.key, place(found.key_span)) == (path[-1], expected), text


def test_a_value_stands_where_it_is_written() -> None:
    for text, path, expected in [
        ("a = 1\nm = 1_0.5e2 # c\n", ["m"], (2, 5, "1_0.5e2")),
        ('m = "60 kg"\n', ["m"], (1, 5, '"60 kg"')),
        ("x = true\n", ["x"], (1, 5, "true")),
        # Columns count characters, whatever their bytes, and CRLF moves none.
        ('# für 😀\n"α" = 1\np = { \'é\' = "ü€😀", k = "x" }\n', ["p", "k"], (3, 24, '"x"')),
        ('# é\r\na = 1\r\nb = "é"\r\nc = 3\r\n', ["c"], (4, 5, "3")),
        # A string of several lines, from quotes to quotes.
        ('m = """\na\n b"""\nn = 1\n', ["m"], (1, 5, '"""\na\n b"""')),
        # A table spans the dotted key or header that makes it, its own rather than a longer one, or its key.
        ("a.b = 1\n", ["a"], (1, 1, "a")),
        ("x = 1\n [ a . b ] # c\ny = 1\n", ["a", "b"], (2, 2, "[ a . b ]")),
        ("[a.b]\n[a]\n", ["a"], (2, 1, "[a]")),
        ('  m = { value = "1 kg" }\n', ["m"], (1, 3, "m")),
    ]:
        assert place(entry(text, *path).value.span) == expected, text


def test_offsets_count_a_byte_order_mark_that_stands_in_the_text() -> None:
    span = entry("\ufeffa = 1\n", "a").key_span
    assert (span.start, span.text) == (1, "a")


def string(text: str) -> StringValue:
    value = entry(text, "m").value
    assert isinstance(value, StringValue)
    return value


def test_a_string_is_verbatim_where_its_text_is_what_stands_between_its_quotes() -> None:
    for text, value, written in [
        ('m = "60 kg"\n', "60 kg", "60 kg"),
        (r"m = '\beta'", r"\beta", r"\beta"),
        ('m = """a"""""\n', 'a""', 'a""'),
        (r'm = "a\tb"', "a\tb", r"a\tb"),
        ('m = """a \\   \n   b"""\nn = 1\n', "a b", "a \\   \n   b"),
        ('m = """\r\na\r\nb"""\r\n', "a\nb", "a\r\nb"),
    ]:
        found = string(text).text
        assert (found.value, found.span.text, found.verbatim) == (value, written, value == written), text


def test_an_offset_in_a_string_of_several_lines_is_an_offset_in_the_text() -> None:
    assert place(string('m = """\na +\n b\n"""\nn = 1\n').text.at(5, 6)) == (3, 2, "b")


def test_an_empty_string_has_an_empty_place_between_its_quotes() -> None:
    for written in ['""', "''", '""""""', "''''''"]:
        span = string(f"m = {written}\nn = 1\n").text.span
        assert (span.start, span.end) == (4 + len(written) // 2,) * 2, written


def array(text: str, key: str) -> ArrayValue:
    value = entry(text, key).value
    assert isinstance(value, ArrayValue)
    return value


def test_each_item_of_an_array_has_its_place() -> None:
    items = array('between = ["x_act", # é\n  "x_tip",\n]\n', "between").items
    assert [place(item.span) for item in items] == [(1, 12, '"x_act"'), (2, 3, '"x_tip"')]
    assert array("a = [{b = 1}]\n", "a").items[0].span.text == "{b = 1}"


def test_repeated_double_headers_are_an_array_of_tables() -> None:
    value = array("[[a]]\nb = 1\n[a.c]\nd = 2\n[[a]]\nb = 3\n", "a")
    assert [(place(i.span), i.keys()) for i in value.items if isinstance(i, TableValue)] == [
        ((1, 1, "[[a]]"), ("b", "c")),
        ((5, 1, "[[a]]"), ("b",)),
    ]


def test_an_escape_in_a_quoted_key_is_decoded() -> None:
    assert entry(r'"\u03c9_1" = 1', "ω_1").key == "ω_1"


def test_entries_keep_the_order_of_the_text() -> None:
    assert parse(Source("a.toml", "z = 1\na = 2\n[m]\n[b]\n")).root.keys() == ("z", "a", "m", "b")


def test_a_missing_key_gives_none() -> None:
    assert parse(Source("a.toml", "a = 1\n")).root.get("b") is None


def test_an_empty_text_is_an_empty_root_at_its_start() -> None:
    root = parse(Source("a.toml", "")).root
    assert (root.entries, root.span.line, root.span.column) == ((), 1, 1)


def test_a_number_is_exact_and_keeps_its_literal() -> None:
    for literal, value in [
        ("0.1", Fraction(1, 10)), ("1e3", Fraction(1000)), ("1_000", Fraction(1000)), ("0xFF", Fraction(255)),
        ("0o17", Fraction(15)), ("0b101", Fraction(5)), ("-2.50E-1", Fraction(-1, 4)), ("+7", Fraction(7)),
        ("3.141592653589793238462643383279", Fraction(3141592653589793238462643383279, 10**30)),
        ("1e400", Fraction(10**400)), ("9" * 400, Fraction(10**400 - 1)),
    ]:  # fmt: skip
        found = entry(f"x = {literal}\n", "x").value
        assert isinstance(found, NumberValue), literal
        assert (found.value, found.literal) == (value, literal), literal


def test_a_boolean_has_its_value() -> None:
    found = entry("x = true\n", "x").value
    assert isinstance(found, BooleanValue)
    assert found.value is True


def test_a_value_without_use_is_kept_with_its_kind_and_place() -> None:
    for written, kind in [
        ("1979-05-27T07:32:00Z", "date-time"),
        ("1979-05-27 07:32:00", "date-time"),
        ("1979-05-27", "date"),
        ("07:32:00", "time"),
        ("-inf", "inf"),
        ("nan", "nan"),
    ]:
        found = entry(f"x = {written} # c\n", "x").value
        assert isinstance(found, OtherValue), written
        assert (found.kind, found.span.text) == (kind, written), written

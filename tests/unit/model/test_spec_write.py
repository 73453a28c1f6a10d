"""A model built in Python becomes text that says the same."""

from __future__ import annotations

import tomllib
from decimal import Decimal
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symflex.errors import Source, SpecError
from symflex.model.spec import (
    ArrayValue,
    BooleanValue,
    NumberValue,
    OtherValue,
    StringValue,
    TableValue,
    Value,
    parse,
)
from symflex.model.spec.write import write


def plain(value: Value) -> object:
    """Return a parsed value as nested dicts and lists."""
    match value:
        case StringValue():
            return value.text.value
        case NumberValue() | BooleanValue():
            return value.value
        case ArrayValue():
            return [plain(item) for item in value.items]
        case TableValue():
            return {entry.key: plain(entry.value) for entry in value.entries}
        case OtherValue():
            return value.kind


def exact(value: object) -> object:
    """Return what a written value is expected to come back as."""
    match value:
        case bool() | str():
            return value
        case float():
            return Fraction(Decimal(float.__repr__(value)))
        case int() | Fraction() | Decimal():
            return Fraction(value)
        case dict():
            return {key: exact(each) for key, each in value.items()}
        case list() | tuple():
            return [exact(each) for each in value]
    raise AssertionError(value)


texts = st.text(st.characters(exclude_categories=["Cs"]), max_size=12) | st.sampled_from(
    'V_act/F|\\beta|"|\'|\'"|\\"\'|"""|a\nb|\r\n|\x00\x7f\x85|é😀|\ufeff|'.split("|")
)
names = texts | st.sampled_from(["parameters", "elements", "fields", "published", "a.b", "inf", "1e3"])


def mappings(inner: st.SearchStrategy[object]) -> st.SearchStrategy[dict[str, object]]:
    return st.dictionaries(names, inner, max_size=4)


decimals = st.builds(lambda p, k: Fraction(p, 10**k), st.integers(-(10**30), 10**30), st.integers(0, 40))
scalars = (
    st.booleans()
    | texts
    | st.integers(-(10**60), 10**60)
    | st.floats(allow_nan=False, allow_infinity=False)
    | decimals
    | st.decimals(allow_nan=False, allow_infinity=False, min_value=-(10**9), max_value=10**9)
)
values = st.recursive(
    scalars,
    lambda inner: st.lists(inner, max_size=3) | st.lists(inner, max_size=3).map(tuple) | mappings(inner),
    max_leaves=12,
)


@settings(max_examples=60)
@given(mappings(values))
@pytest.mark.slow
def test_what_is_written_is_read_back(mapping: dict[str, object]) -> None:
    assert plain(parse(Source("<python>", write(mapping))).root) == exact(mapping)


@settings(max_examples=40)
@given(mappings(texts | mappings(texts)))
def test_tomllib_reads_what_is_written(mapping: dict[str, object]) -> None:
    assert tomllib.loads(write(mapping)) == mapping


def test_the_text_is_canonical() -> None:
    model = {
        "symflex": 1,
        "parameters": {"m_1": {"value": "60 kg", "latex": r"\mu"}, "k": 0.1},
        "elements": {"s": {"type": "spring", "between": ("a", "b")}},
        "fields": {"w": {"domain": ["0", "l"]}},
        "published": {"V/F": {"expr": "1", "where": {"S": "s"}}},
        "empty": {},
    }
    assert write(model) == (
        "symflex = 1\n"
        "\n[parameters]\n"
        "m_1 = { value = \"60 kg\", latex = '\\mu' }\n"
        "k = 0.1\n"
        "\n[elements]\n"
        's = { type = "spring", between = ["a", "b"] }\n'
        "\n[fields.w]\n"
        'domain = ["0", "l"]\n'
        '\n[published."V/F"]\n'
        'expr = "1"\n'
        'where = { S = "s" }\n'
        "\n[empty]\n"
    )


def test_a_value_is_written_as() -> None:
    for value, written in [
        (Fraction(1, 3), '"1/3"'), (Fraction(-22, 7), '"-22/7"'), (Fraction(-1, 8), "-0.125"),
        (Fraction(6, 2), "3"), (Decimal("1.50"), "1.50"), (Decimal("1E+5"), "1E+5"), (1e-7, "1e-07"),
        (1e300, "1e+300"), (float("inf"), "inf"), (Decimal("-Infinity"), "-inf"), (True, "true"),
        ("x", '"x"'), (r"\frac{a}{b}", r"'\frac{a}{b}'"), ("\\'", '"\\\\\'"'),
        ("\x1b[0m\n", '"\\u001b[0m\\n"'), ((), "[]"),
    ]:  # fmt: skip
        assert write({"a": value}) == f"a = {written}\n", value


def test_a_string_cannot_add_a_statement() -> None:
    assert tomllib.loads(write({"a": '"\nb = 1\n[c]'})) == {"a": '"\nb = 1\n[c]'}


def test_a_value_that_cannot_be_written_is_refused_by_its_path() -> None:
    for value in [None, 1j, object(), {1, 2}, b"x", "\ud800", [1, None]]:
        with pytest.raises(SpecError, match=r"error\[SF104\]: parameters\.k(\.1)?: ") as raised:
            write({"parameters": {"k": value}})
        assert raised.value.diagnostics[0].code == "SF104", value


def test_a_key_that_is_no_text_is_refused() -> None:
    with pytest.raises(SpecError, match=r"SF104.*parameters: the key 3 is not text"):
        write({"parameters": {3: 1}})


def test_a_number_past_the_limits_is_refused() -> None:
    for value in [
        10**400,
        -(10**100_000),
        Fraction(1, 3**2000),
        Decimal("1E+401"),
        Decimal("1" * 500),
        Fraction(1, 2**401),
    ]:
        with pytest.raises(SpecError, match="SF103"):
            write({"a": value})


def test_a_number_of_four_hundred_digits_is_written() -> None:
    assert write({"a": 10**400 - 1}) == f"a = {'9' * 400}\n"


def test_a_mapping_that_holds_itself_is_refused() -> None:
    model: dict[str, object] = {}
    model["a"] = {"b": model}
    with pytest.raises(SpecError, match="SF103"):
        write(model)

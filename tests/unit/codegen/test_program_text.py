"""Names become identifiers one to one, and prose stays prose."""

import doctest
import keyword

from hypothesis import given
from hypothesis import strategies as st

from symflex.codegen.module_text import identifiers, inert, wrapped

RESERVED = frozenset({*keyword.kwlist, "np", "s"})


@given(st.lists(st.text(max_size=20), unique=True, max_size=12))
def test_different_names_have_different_identifiers(names):
    found = identifiers({n: n for n in names}, RESERVED)
    assert len(set(found.values())) == len(names)


@given(st.text(max_size=40))
def test_whatever_the_name_its_identifier_is_a_plain_one(name):
    found = identifiers({name: name}, RESERVED)[name]
    assert found.isidentifier()
    assert found.isascii()
    assert found not in RESERVED
    assert not found.startswith("_")


def test_a_keyword_and_its_usual_replacement_stay_apart_in_either_order():
    for names in (("lambda", "lambda_"), ("lambda_", "lambda")):
        found = identifiers({n: n for n in names}, RESERVED)
        assert found["lambda_"] == "lambda_"
        assert found["lambda"] not in names


def test_a_name_that_can_be_an_identifier_is_kept_even_if_a_mangled_one_came_first():
    assert identifiers({"a-b": "a-b", "a_b": "a_b"}, RESERVED)["a_b"] == "a_b"


@given(st.text(max_size=200))
def test_inert_text_is_one_line_without_double_quotes_or_invisible_characters(text):
    shown = inert(text)
    assert shown.isprintable()
    assert '"' not in shown


@given(st.text(alphabet="> .a\n", max_size=60))
def test_inert_text_starts_no_doctest_however_it_is_wrapped(text):
    lines = wrapped(inert(text), 20, "    ")
    assert doctest.DocTestParser().get_examples("\n".join(lines)) == []


def test_a_directive_is_pulled_apart():
    for text in (".. include:: /etc/passwd", "x .. raw:: html", "\n.. code::"):
        assert ".. " not in inert(text)


@given(st.text(max_size=300))
def test_wrapped_lines_keep_to_their_width_and_lose_nothing_but_spaces(text):
    shown = inert(text)
    lines = wrapped(shown, 40, "  ", "    ")
    assert all(len(line) <= 40 for line in lines)
    assert "".join("".join(lines).split()) == "".join(shown.split())


def test_a_long_product_is_broken_after_an_operator():
    lines = wrapped("*".join(["name_of_a_factor"] * 6), 40)
    assert all(line.endswith("*") for line in lines[:-1])

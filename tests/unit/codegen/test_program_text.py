"""Names become identifiers one to one, and prose stays prose."""

import keyword

from hypothesis import given
from hypothesis import strategies as st

from symflex.codegen.module_text import identifiers, inert, wrapped

RESERVED = frozenset({*keyword.kwlist, "np", "s"})


def test_a_name_that_can_be_an_identifier_is_kept_even_if_a_mangled_one_came_first():
    assert identifiers({"a-b": "a-b", "a_b": "a_b"}, RESERVED)["a_b"] == "a_b"


@given(st.text(max_size=300))
def test_wrapped_lines_keep_to_their_width_and_lose_nothing_but_spaces(text):
    shown = inert(text)
    lines = wrapped(shown, 40, "  ", "    ")
    assert all(len(line) <= 40 for line in lines)
    assert "".join("".join(lines).split()) == "".join(shown.split())


def test_a_long_product_is_broken_after_an_operator():
    lines = wrapped("*".join(["name_of_a_factor"] * 6), 40)
    assert all(line.endswith("*") for line in lines[:-1])

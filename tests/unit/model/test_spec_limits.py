"""What is too large is refused with its place, before anything is built from it."""

from __future__ import annotations

import pytest

from symflex.errors import Diagnostic, Source, SpecError
from symflex.model.spec import parse


def refusal(text: str) -> Diagnostic:
    with pytest.raises(SpecError) as raised:
        parse(Source("a.toml", text))
    assert len(raised.value.diagnostics) == 1
    return raised.value.diagnostics[0]


def beginning(text: str) -> str:
    return text[:16]


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("#" * 1_000_001, "a.toml:1:1"),
        ("#" + "é" * 500_000, "a.toml:1:1"),
        ("a = " + "[" * 33 + "]" * 33, "a.toml:1:37"),
        ("a = " + "[" * 900_000, "a.toml:1:37"),
        ("b = 1\na = " + "{a=" * 33 + "1" + "}" * 33, "a.toml:2:101"),
        ("x = 1\ny = 1e999999999\n", "a.toml:2:5"),
        ("y = [1.0, -1.5e-401]", "a.toml:1:11"),
        ("y = { z = 1e+9_9_9 }", "a.toml:1:11"),
        ("y = 1e" + "9" * 300, "a.toml:1:5"),
        ("y = " + "9" * 401, "a.toml:1:5"),
        ("y = " + "9" * 5000, "a.toml:1:5"),
        ("y = 0x" + "f" * 399, "a.toml:1:5"),
        ("y = 0." + "1" * 399, "a.toml:1:5"),
        ("k = 1\n" * 20_001, "a.toml:20001:1"),
        ("a = [" + "1," * 20_000 + "]", "a.toml:1:40005"),
        (".".join("a" * 17) + " = 1", "a.toml:1:1"),
        ("[" + ".".join("a" * 17) + "]", "a.toml:1:2"),
        ('"a"' + " . 'b'" * 16 + " = 1", "a.toml:1:95"),
        ("a = { " + ".".join("a" * 17) + " = 1 }", "a.toml:1:7"),
        (".".join("a" * 15) + "={" + (".".join("a" * 15) + "={") * 4, "a.toml:1:155"),
    ],
    ids=beginning,
)
def test_what_passes_a_limit_is_refused_at_its_place(text: str, place: str) -> None:
    problem = refusal(text)
    assert (problem.code, str(problem.span)) == ("SF103", place)


@pytest.mark.parametrize(
    "text",
    [
        "#" * 999_999 + "\n",
        "a = " + "[" * 32 + "]" * 32,
        "a = " + "{a=" * 32 + "1" + "}" * 32,
        'a = "' + "[" * 100 + '"\n# ' + "{" * 100,
        "a = '''" + "[\n" * 100 + "'''",
        "y = 1e400",
        "y = -1e-400",
        "y = " + "9" * 400,
        '"' + "9" * 500 + '" = 1',
        'y = "1e999999999"',
        "".join(f"k{i} = 1\n" for i in range(20_000)),
        ".".join("a" * 16) + " = 1",
        '"' + "a." * 40 + '" = 1',
    ],
    ids=beginning,
)
def test_what_keeps_just_within_the_limits_is_read(text: str) -> None:
    assert parse(Source("a.toml", text)).source.text == text


@pytest.mark.parametrize(
    "text",
    [
        "a = [\n" + "\n" * 900_000 + "]",
        'a = """' + '\n\\"""' * 150_000,
        "a = " + '""' * 450_000,
        "#\x00\n" * 300_000,
        "= " * 450_000,
    ],
    ids=beginning,
)
def test_a_long_hostile_text_takes_time_in_proportion_to_its_length(text: str) -> None:
    # Each took minutes or more when a scan ran to the end of the text for each of its lines.
    try:
        parse(Source("a.toml", text))
    except SpecError as error:
        assert error.diagnostics[0].code == "SF101"

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


def test_what_passes_a_limit_is_refused_at_its_place() -> None:
    for text, place in [
        ("#" * 1_000_001, "a.toml:1:1"), ("#" + "é" * 500_000, "a.toml:1:1"),
        ("a = " + "[" * 33 + "]" * 33, "a.toml:1:37"), ("a = " + "[" * 900_000, "a.toml:1:37"),
        ("b = 1\na = " + "{a=" * 33 + "1" + "}" * 33, "a.toml:2:101"),
        ("x = 1\ny = 1e999999999\n", "a.toml:2:5"), ("y = [1.0, -1.5e-401]", "a.toml:1:11"),
        ("y = { z = 1e+9_9_9 }", "a.toml:1:11"), ("y = 1e" + "9" * 300, "a.toml:1:5"),
        ("y = " + "9" * 401, "a.toml:1:5"), ("y = " + "9" * 5000, "a.toml:1:5"),
        ("y = 0x" + "f" * 399, "a.toml:1:5"), ("y = 0." + "1" * 399, "a.toml:1:5"),
        ("k = 1\n" * 20_001, "a.toml:20001:1"), ("a = [" + "1," * 20_000 + "]", "a.toml:1:40005"),
        (".".join("a" * 17) + " = 1", "a.toml:1:1"), ("[" + ".".join("a" * 17) + "]", "a.toml:1:2"),
        ('"a"' + " . 'b'" * 16 + " = 1", "a.toml:1:95"),
        ("a = { " + ".".join("a" * 17) + " = 1 }", "a.toml:1:7"),
        (".".join("a" * 15) + "={" + (".".join("a" * 15) + "={") * 4, "a.toml:1:155"),
    ]:  # fmt: skip
        problem = refusal(text)
        assert (problem.code, str(problem.span)) == ("SF103", place), text[:16]


def test_what_keeps_just_within_the_limits_is_read(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("symflex.model.spec.scan.MAX_ENTRIES", 2_000)  # 20,000 take seconds
    for text in [
        "#" * 999_999 + "\n", "a = " + "[" * 32 + "]" * 32, "a = " + "{a=" * 32 + "1" + "}" * 32,
        'a = "' + "[" * 100 + '"\n# ' + "{" * 100, "a = '''" + "[\n" * 100 + "'''", "y = 1e400",
        "y = -1e-400", "y = " + "9" * 400, '"' + "9" * 500 + '" = 1', 'y = "1e999999999"',
        "".join(f"k{i} = 1\n" for i in range(2_000)), ".".join("a" * 16) + " = 1", '"' + "a." * 40 + '" = 1',
    ]:  # fmt: skip
        assert parse(Source("a.toml", text)).source.text == text


@pytest.mark.slow
def test_a_long_hostile_text_takes_time_in_proportion_to_its_length() -> None:
    # Each took minutes or more when a scan ran to the end of the text for each of its lines.
    for text in [
        "a = [\n" + "\n" * 300_000 + "]",
        'a = """' + '\n\\"""' * 50_000,
        "a = " + '""' * 150_000,
        "#\x00\n" * 100_000,
        "= " * 150_000,
    ]:
        try:
            parse(Source("a.toml", text))
        except SpecError as error:
            assert error.diagnostics[0].code == "SF101", text[:16]

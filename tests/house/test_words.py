import re

import pytest

from tests.house.repository import ROOT, tracked_files

# Each is written in two parts, so that this file does not contain it.
FORBIDDEN = tuple(
    "".join(parts)
    for parts in (
        ("/wo", "rk/"),
        ("/tm", "p/"),
        ("/ro", "ot/"),
        ("bash", "_jobs"),
        ("before", "-stop"),
        ("FIX", "ME"),
        ("TO", "DO"),
        ("X", "XX"),
        ("lorem", " ipsum"),
        ("chat", "gpt"),
        ("clau", "de"),
        ("co", "pilot"),
        ("language", " model"),
        ("pragma: ", "no cover"),
    )
)
PATTERN = re.compile("|".join(map(re.escape, FORBIDDEN)))

FROM_TEXT_TO_CODE = re.compile(r"(?<![\w.`])(?:eval|exec)\(|\b(?:sympify|parse_expr|lambdify)\(")
VAGUE_NAMES = {"utils", "util", "helpers", "helper", "manager", "misc", "common"}


def text_files():
    for path in tracked_files():
        try:
            yield path, path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue


def occurrences(pattern, files):
    return [
        f"{path.relative_to(ROOT)}:{text.count(chr(10), 0, match.start()) + 1}: {match[0]}"
        for path, text in files
        for match in pattern.finditer(text)
    ]


def test_no_file_contains_a_forbidden_word():
    assert occurrences(PATTERN, text_files()) == []


def test_the_package_never_turns_text_into_code():
    package = ((path, text) for path, text in text_files() if path.is_relative_to(ROOT / "symflex"))
    assert occurrences(FROM_TEXT_TO_CODE, package) == []


def test_polynomials_are_factored_in_one_place_that_survives_large_coefficients():
    library = re.compile(r"\.(?:factor|factor_squarefree)\(\)")
    package = ((path, text) for path, text in text_files() if path.is_relative_to(ROOT / "symflex"))
    found = occurrences(library, package)
    assert {place.split(":")[0] for place in found} == {"symflex/algebra/ring.py"}, found


def test_the_precision_of_balls_is_read_set_and_raised_in_one_place():
    precision = re.compile(r"\bctx\.(?:prec|cap|dps|workprec|workdps)\b|\bbits \*= 2\b")
    package = ((path, text) for path, text in text_files() if path.is_relative_to(ROOT / "symflex"))
    found = occurrences(precision, package)
    assert {place.split(":")[0] for place in found} == {"symflex/balls/precision.py"}, found


def test_no_module_bears_a_vague_name():
    named = {
        p
        for p in tracked_files()
        for part in p.relative_to(ROOT).with_suffix("").parts
        if part in VAGUE_NAMES
    }
    assert sorted(named) == []


@pytest.mark.parametrize("word", FORBIDDEN)
def test_each_forbidden_word_would_be_found(word):
    assert occurrences(PATTERN, [(ROOT / "README.md", f"one line\nand {word} here")])

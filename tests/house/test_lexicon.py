"""The words of the field: what a person reads says "certified poles", "undamped" and "delay" everywhere.

Each line of the table has an expression, what to write in its place, and the files or folders in which the
words stand with good reason. A space in an expression is any white space, line breaks of comments included.
"""

import re
from functools import cache
from pathlib import Path

import pytest

from tests.house.repository import ROOT
from tests.house.test_words import occurrences, text_files

NUMBERS = "(?:poles?|zeros?|roots?|frequenc(?:y|ies)|digits|modes?|peaks?)"
PARTS = (
    "(?:arms?|beams?|frames?|links?|members?|models?|networks?|rods?|shafts?|strings?|structures?|systems?)"
)
KEYS = "(?:mass|length|density|stiffness|cross-section|shear modulus|damping coefficient|inductance|gain)"
HOLDERS = "(?:discs?|box|boxes|balls?|cells?|files?|formulas?|models?|tables?|numerators?|denominators?)"
SPEAKERS = (
    "(?:pages?|program|outputs?|reports?|messages?|lists?|tables?|files?|symflex|commands?|sections?|hints?)"
)

LEXICON = {
    rf"\bproved (?:{NUMBERS}|ones)\b"
    rf"|\bprov(?:es?|ing) (?:(?:its|the|their|every|each|all|simple|real) )*{NUMBERS}\b"
    rf"|\b{NUMBERS} (?:is|are) proved\b(?! to| not| so| that| equal)"
    r"|\bha(?:ve|s|d) (?:them|it) proved\b": ("certify", {}),
    r"\bwith(?:out)? loss(?:es)?\b(?!\sfactor)|\b(?:Kelvin-Voigt|material) loss|\bloss times?\b": (
        "damping",
        {},
    ),
    rf"\bloss(?:less|y) {PARTS}\b": ("undamped, damped; lines and couplings may be lossless", {}),
    r"\bloss\s*=\s*\{|\belements\.loss\b|\"loss\": \{": (
        "damping, the name of an element",
        {"tests/": "models that no reader meets"},
    ),
    r"\bdead times?\b": (
        "delay",
        {
            "docs/glossary.md": "the synonym, once",
            "docs/blocks.md": "the synonym, once",
            "symflex/library/blocks.py": "the synonym, once",
            "docs/i-have-i-want.md": "what others call a delay",
        },
    ),
    r"\b(?:[Rr]ight|[Ll]eft) of the (?:imaginary )?axis\b": ("in the right half-plane", {}),
    r"\bhalf planes?\b": ("half-plane", {}),
    rf"\b{HOLDERS} (?:may |then |also )?holds?\b(?! for| at| if| where| with)|\bholds? no\b": ("contain", {}),
    r"\bgain's own value\b": ("nominal gain", {}),
    r"\brooms? (?:of the program|imports?|offers?)\b|\bRooms\b|\bas \w*room\b": ("package, layer", {}),
    r"\bat (?:and|or) below (?:its|the|a) folder\b|\b(?:specifications|files|all) in it and below\b": (
        "in that folder and its subfolders",
        {},
    ),
    r"\blost in (?:its|their) (?:own )?(?:standard )?errors?\b": ("less than twice its standard error", {}),
    r"\bmay rest anywhere\b": ("is arbitrary at equilibrium", {}),
    r"\binputs? and outputs? (?:do not )?see\b|\bno (?:in|out)put sees\b": (
        "uncontrollable or unobservable",
        {},
    ),
    rf"\b{SPEAKERS} (?:then |also )?says?\b": ("report, list, give, or the passive", {}),
    r"\btold apart\b": ("separated, distinguished", {}),
    r"\bcircular functions?\b": ("trigonometric", {}),
    rf"^\| `\w+` \| `[^`]*` \| an? {KEYS}\b": ("mass, length: no article in a cell", {}),
    r"\blimit from above\b": ("limit from the right (t -> 0+)", {}),
}


@cache
def texts():
    return [(path, text) for path, text in text_files() if path != Path(__file__)]


@pytest.mark.parametrize("words", LEXICON)
def test_words_of_the_field_are_used(words):
    instead, reasons = LEXICON[words]
    pattern = re.compile(words.replace(" ", r"[\s#]+"), re.MULTILINE)
    excepted = tuple(reasons)
    files = [(path, text) for path, text in texts() if not str(path.relative_to(ROOT)).startswith(excepted)]
    assert occurrences(pattern, files) == [], f"write instead: {instead}"

from __future__ import annotations

import re

from tests.house.repository import ROOT

CODE = re.compile(r"\bSF\d{3}\b")
ROW = re.compile(r"^\| `(SF\d{3})` \|", re.MULTILINE)


def used():
    return {
        code
        for path in (ROOT / "symflex").rglob("*.py")
        for code in CODE.findall(path.read_text(encoding="utf-8"))
    }


def documented():
    return ROW.findall((ROOT / "docs" / "error-codes.md").read_text(encoding="utf-8"))


def test_every_code_the_program_uses_is_documented():
    assert used() - set(documented()) == set()


def test_every_documented_code_is_used():
    assert set(documented()) - used() == set()


def test_the_codes_are_listed_once_and_in_order():
    assert documented() == sorted(set(documented()))

import re

from symflex import errors
from tests.house.repository import ROOT

CODE = re.compile(r"\bSF\d{3}\b")
ROW = re.compile(r"^\| \[?`(SF\d{3})`(?:\]\(#[\w-]+\))? \|", re.MULTILINE)


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


def test_every_cure_is_linked_from_the_table():
    table = (ROOT / "docs" / "error-codes.md").read_text(encoding="utf-8")
    cures = set(re.findall(r"^### .* \((SF\d{3})\)$", table, re.MULTILINE))
    linked = re.findall(r"^\| \[`(SF\d{3})`\]\(#[\w-]+-(sf\d{3})\) \|", table, re.MULTILINE)
    assert {code for code, anchor in linked if code.lower() == anchor} == cures != set()


def test_the_codes_are_listed_once_and_in_order():
    assert documented() == sorted(set(documented()))


RAISED = re.compile(r"\b(\w+Error)\(\s*Diagnostic\(\s*\"(SF\d{3})\"")
CLASS = re.compile(r"^\| `(\w+Error)` \| (\d) \| (.*) \|$", re.MULTILINE)


def table():
    """Per exception, its exit code and all codes that the table gives it."""
    found = {}
    for name, code, text in CLASS.findall((ROOT / "docs" / "error-codes.md").read_text(encoding="utf-8")):
        codes = {f"SF{i}" for i in re.findall(r"SF(\d{3})", text)}
        codes |= {f"SF{h}{i:02}" for h in re.findall(r"SF(\d)xx", text) for i in range(100)}
        for low, high in re.findall(r"SF(\d{3}) to SF(\d{3})", text):
            codes |= {f"SF{i}" for i in range(int(low), int(high) + 1)}
        found[name] = int(code), codes
    return found


def test_what_the_program_raises_is_what_the_table_says():
    rows = table()
    raised = {
        pair
        for path in (ROOT / "symflex").rglob("*.py")
        for pair in RAISED.findall(path.read_text(encoding="utf-8"))
        if pair[0] != "SymflexError"  # the base is printed by the command line, and raised for SF912 alone
    }
    assert len(raised) > 30
    assert {(name, code) for name, code in raised if code not in rows[name][1]} == set()


def test_exit_codes_are_those_of_the_table():
    for name, (code, _) in table().items():
        assert getattr(errors, name).exit_code == code

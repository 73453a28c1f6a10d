"""A message that points to a limit says the way round it."""

import ast
import re

import pytest

from tests.house.repository import ROOT

LIMITS = re.compile(r"SF(103|104|230|231|233|235|236|5\d\d|910|911|912|914|917|919)")
"""Sizes and nesting, labels, double precision, rational functions, budgets, and what there is not yet."""

HINT_AFTER = {"Diagnostic": 3, "note": 3, "refuse": 2, "Slip": 2, "RejectedError": 4, "_refused": 3}
"""How many arguments after its code a call takes the hint."""


def calls():
    """Yield every call that makes a diagnostic of a limit, with its place and its hint, if it has one."""
    for path in sorted((ROOT / "symflex").rglob("*.py")):
        source = path.read_text(encoding="utf-8")
        for node in ast.walk(ast.parse(source)) if LIMITS.search(source) else ():
            if not isinstance(node, ast.Call):
                continue
            name = getattr(node.func, "id", getattr(node.func, "attr", ""))
            for i, argument in enumerate(node.args):
                text = getattr(argument, "value", None)
                if name in HINT_AFTER and isinstance(text, str) and LIMITS.fullmatch(text):
                    after = node.args[i + HINT_AFTER[name] :]
                    hint = (
                        after[0] if after else next((k.value for k in node.keywords if k.arg == "hint"), None)
                    )
                    yield f"{path.relative_to(ROOT)}:{node.lineno} {text}", hint


@pytest.mark.slow
def test_messages_of_limits_say_the_way_round_them():
    found = dict(calls())
    assert len(found) > 60
    assert not [
        place
        for place, hint in found.items()
        if hint is None or (isinstance(hint, ast.Constant) and hint.value is None)
    ]

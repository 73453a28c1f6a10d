"""Formulas with mistakes, and formulas meant to do harm."""

import pytest

from symflex.errors import SpecError
from tests.unit.audit.beam import audited, measured

REFUSED = {
    "division by zero": ("1/(s - s)", {}, "SF224"),
    "division by a hidden zero": ("1/(cos(q)^2 + sin(q)^2 - 1)", {"q": "l*sqrt(s)"}, "SF224"),
    "a negative power of zero": ("(s - s)^(-2)", {}, "SF224"),
    "an unknown function": ("besselj(s)", {}, "SF210"),
    "an unknown name": ("1/(rho*Area*s)", {}, "SF210"),
    "a node": ("s*tip", {}, "SF212"),
    "an output": ("V_tip", {}, "SF212"),
    "a quantity of an element": ("arm.f", {}, "SF212"),
    "a field at a point": ("w'(0)", {}, "SF212"),
    "lines in a circle": ("x", {"x": "y + 1", "y": "x - 1"}, "SF215"),
    "a line that uses itself": ("E", {"E": "E + 1"}, "SF215"),
    "an exponent with a name": ("s^l", {}, "SF225"),
    "s as an exponent": ("2^s", {}, "SF225"),
}


def test_a_formula_with_a_mistake_is_refused_at_its_place():
    for name, (expr, where, code) in REFUSED.items():
        with pytest.raises(SpecError) as caught:
            audited("V_act", expr, where)
        (problem, *_) = caught.value.diagnostics
        assert (name, problem.code) == (name, code)
        assert problem.span is not None, name


def test_all_mistakes_of_a_formula_are_reported_together():
    with pytest.raises(SpecError) as caught:
        audited("V_act", "foo(s) + bar^s + tip")
    assert [d.code for d in caught.value.diagnostics] == ["SF210", "SF210", "SF225", "SF212"]


UNREAD = {
    "a tower of powers": ("w4", {"w1": "2^64", "w2": "w1^64", "w3": "w2^64", "w4": "w3^64"}),
    "sums to high powers": ("w3", {"w1": "(s + E)^64 + 1", "w2": "w1^64 + 1", "w3": "w2^64 + 1"}),
    "roots in roots": ("sqrt(" * 20 + "s" + ")" * 20, {}),
    "exponentials in exponentials": ("exp(exp(exp(exp(s))))", {}),
    "the root of a large number": (f"sqrt({10**100 + 267})", {}),
    "many roots": ("+".join(f"sqrt({i} + s)" for i in range(1, 50)), {}),
    "arguments without a common measure": ("+".join(f"cos({i}.{i}*s)" for i in range(1, 40)), {}),
    "a large product": ("1 + " + "*".join(f"(s^{i} + E^{i} + l^{i})" for i in range(1, 30)), {}),
}


@pytest.mark.slow
def test_a_formula_beyond_the_limits_is_still_proved_to_differ():
    for name, given in UNREAD.items():
        found = audited("V_act", *given)
        assert found.unread, name
        assert found.verdict == "differs", name


@pytest.mark.slow
def test_the_deviation_of_a_formula_beyond_the_limits_is_measured():
    found = measured("V_act", *UNREAD["the root of a large number"])
    assert (found.verdict, bool(found.unread)) == ("differs", True)
    assert found.deviation is not None


def test_zero_is_proved_to_differ():
    for expr in ("s - s", "sqrt(-s)*sqrt(-s) + s", "0"):
        assert audited("V_act", expr).verdict == "differs", expr


def test_a_formula_without_a_value_is_not_decided():
    assert audited("V_act", "log(s - s)").verdict == "undecided"

"""Laws that wrong formulas violate. What is violated is known from how the formula was made wrong."""

from __future__ import annotations

import pytest

from tests.unit.audit.beam import COLOCATED, KRYLOV, SCALE, TIP, VAUGHAN, audited

PAPER = COLOCATED.replace("-1/2", "-1").replace("6*C^2", "2*C^2")


def laws(*given):
    return {law.law: law for law in audited(*given).laws}


@pytest.mark.parametrize("law", ["double zeros", "lossless phase", "interlacing"])
def test_the_papers_colocated_formula_violates(law):
    assert not laws("V_act", PAPER, VAUGHAN, SCALE)[law].kept


def test_the_papers_colocated_formula_has_the_systems_poles():
    found = laws("V_act", PAPER, VAUGHAN, SCALE)["poles"]
    assert (found.kept, found.how) == (True, "proved")


def test_the_papers_colocated_formula_has_the_right_rigid_body_motion():
    # With q -> 0: S -> 0 and C -> 1, so (1 + 2 + 1)*1 = 4 and (1 + 6 + 1)/2 = 4.
    found = laws("V_act", PAPER, VAUGHAN, SCALE)["limit at zero"]
    assert (found.kept, found.how) == (True, "proved")


def test_a_wrong_characteristic_equation_is_a_violation_with_proof():
    found = laws("V_tip", TIP.replace("- 4*C*S", "+ 4*C*S"), VAUGHAN, SCALE)["poles"]
    assert (found.kept, found.how) == (False, "proved")


def test_an_added_pole_is_named():
    found = laws("V_tip", TIP + "/(s + 3*E)", VAUGHAN, SCALE)["poles"]
    assert "poles that are none of the system's, where s + 3*E = 0" in found.detail
    assert "missing" not in found.detail


@pytest.mark.slow
@pytest.mark.parametrize(
    ("expr", "ratio"),
    [
        (COLOCATED.replace("6*C^2", "14*C^2"), "2"),  # (1 + 14 + 1)/(1 + 6 + 1)
        (COLOCATED.replace("6*C^2", "C^2"), "3/8"),
        (COLOCATED + "/s", "1/s"),
    ],
)
def test_a_wrong_limit_is_named(expr, ratio):
    found = laws("V_act", expr, VAUGHAN, SCALE)["limit at zero"]
    assert found.detail == f"printed/derived behaves as {ratio} as s tends to 0"


@pytest.mark.slow
def test_half_powers_of_s_in_a_limit_are_named():
    # sin q for cos q: the ratio is tan q ~ q = mu*l.
    where = KRYLOV | {"d": "cosh(q)*sinh(q) + cos(q)*sin(q)"}
    found = laws("V_tip", "2*mu*cosh(q)*sin(q)/(rho*A*s*d)", where)["limit at zero"]
    assert "l*sqrt(2*s)*(rho*A/(E*I))^(1/4)/2 as" in found.detail


@pytest.mark.slow
def test_zeros_of_a_noncolocated_function_need_not_interlace():
    assert "interlacing" not in laws("V_tip", TIP.replace("-2", "-3"), VAUGHAN, SCALE)


@pytest.mark.slow
def test_a_formula_that_is_right_up_to_a_factor_violates_the_limit_only():
    found = laws("V_act", COLOCATED.replace("-1/2", "-1"), VAUGHAN, SCALE)
    assert [name for name, law in found.items() if not law.kept] == ["limit at zero"]

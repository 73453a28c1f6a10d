"""Laws that wrong formulas violate. What is violated is known from how the formula was made wrong."""

import pytest

from symflex import pipeline
from symflex.audit import audit
from tests.unit.audit.beam import COLOCATED, KRYLOV, SCALE, TIP, VAUGHAN, audited, measured

PAPER = COLOCATED.replace("-1/2", "-1").replace("6*C^2", "2*C^2")


def laws(*given):
    """Return the laws that are proved, by name."""
    return {law.law: law for law in audited(*given).laws}


@pytest.mark.slow
def test_the_papers_colocated_formula_violates_three_laws_and_keeps_two():
    # With q -> 0: S -> 0 and C -> 1, so (1 + 2 + 1)*1 = 4 and (1 + 6 + 1)/2 = 4.
    found = {law.law: law for law in measured("V_act", PAPER, VAUGHAN, SCALE).laws}
    assert [name for name, law in found.items() if not law.kept] == [
        "double zeros",
        "lossless phase",
        "interlacing",
    ]
    assert [name for name, law in found.items() if law.kept and law.how == "proved"] == [
        "poles",
        "limit at zero",
    ]


def laws_of_two_masses(pair, expr):
    """Return the laws by name; poles at k/m and 3*k/m, and the zero of X/F at 2*k/m between them."""
    text = f"""
symflex = 1
parameters = {{ m = "1 kg", k = "900 N/m" }}
[elements]
a = {{ type = "mass", at = "x", m = "m" }}
b = {{ type = "mass", at = "y", m = "m" }}
left = {{ type = "spring", between = ["x", "ground"], k = "k" }}
middle = {{ type = "spring", between = ["x", "y"], k = "k" }}
right = {{ type = "spring", between = ["y", "ground"], k = "k" }}
[inputs]
F = {{ force = "x" }}
[outputs]
X = "x"
Y = "y"
[analysis]
band = ["0.1 Hz", "100 Hz"]
[published."{pair}"]
expr = "{expr}/((m*s^2 + k)*(m*s^2 + 3*k))"
"""
    (found,) = audit(pipeline.loads(text))
    return {law.law: law.kept for law in found.laws}


def test_a_formula_that_is_right_up_to_a_factor_violates_the_limit_only():
    found = laws_of_two_masses("X/F", "2*(m*s^2 + 2*k)")
    assert [law for law, kept in found.items() if not kept] == ["limit at zero"]
    assert {"lossless phase", "interlacing"} <= found.keys()


def test_zeros_of_a_noncolocated_function_need_not_interlace():
    assert "interlacing" not in laws_of_two_masses("Y/F", "2*k")


def test_a_wrong_characteristic_equation_is_a_violation_with_proof():
    found = laws("V_tip", TIP.replace("- 4*C*S", "+ 4*C*S"), VAUGHAN, SCALE)["poles"]
    assert (found.kept, found.how) == (False, "proved")


@pytest.mark.slow
def test_an_added_pole_is_named():
    found = laws("V_tip", TIP + "/(s + 3*E)", VAUGHAN, SCALE)["poles"]
    assert "it has poles that the system does not have, where s + 3*E = 0" in found.detail
    assert "missing" not in found.detail


@pytest.mark.slow
def test_a_wrong_limit_is_named():
    for expr, ratio in (
        (COLOCATED.replace("6*C^2", "14*C^2"), "2"),  # (1 + 14 + 1)/(1 + 6 + 1)
        (COLOCATED.replace("6*C^2", "C^2"), "3/8"),
        (COLOCATED + "/s", "1/s"),
    ):
        found = laws("V_act", expr, VAUGHAN, SCALE)["limit at zero"]
        assert found.detail == f"printed/derived behaves as {ratio} as s tends to 0"


def test_half_powers_of_s_in_a_limit_are_named():
    # sin q for cos q: the ratio is tan q ~ q = mu*l.
    where = KRYLOV | {"d": "cosh(q)*sinh(q) + cos(q)*sin(q)"}
    found = laws("V_tip", "2*mu*cosh(q)*sin(q)/(rho*A*s*d)", where)["limit at zero"]
    assert "l*sqrt(2*s)*(rho*A/(E*I))^(1/4)/2 as" in found.detail

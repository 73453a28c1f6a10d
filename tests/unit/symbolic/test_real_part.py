"""Symbolic conditions for a positive real part, against those derived by hand."""

from symflex import pipeline
from symflex.contact import at_port
from symflex.model.ports import port_named
from symflex.symbolic.real_part import real_part_conditions

WALL = """symflex = 1
parameters = { m = {}, b = {}, K = {}, tau = {}, B = {}, k = {} }
[elements]
body = { type = "mass", at = "x", m = "m" }
friction = { type = "damper", between = ["x", "ground"], b = "b" }
motor = { type = "force_source", at = "x", f = "FORCE" }
[inputs]
F = { force = "x" }
[outputs]
X = "x"
"""


def conditions(force):
    model = pipeline.loads(WALL.replace("FORCE", force))
    driven, pair = at_port(model, port_named(model, "x"))
    (tf,) = pipeline.derive_all(driven, [pair])
    found = real_part_conditions(tf)
    return found.sentence, [str(c) for c in found.conditions]


def test_friction_makes_up_for_a_lag():
    # Re Z = b - K tau/(1 + (omega tau)^2).
    assert conditions("-K/(tau*s + 1)*x") == (
        "the real part is positive at all frequencies exactly when",
        ["b > K*tau"],
    )


def test_a_filtered_lead_needs_less_friction():
    # Re Z = b + (B - K tau)/(1 + (omega tau)^2).
    assert conditions("-(K + B*s)/(tau*s + 1)*x")[1] == ["b + B > K*tau"]


def test_a_spring_and_a_damper_are_positive_for_all_values():
    assert conditions("-(K + B*s)*x") == ("the real part is positive at all frequencies", [])


def test_a_force_along_the_motion_needs_more_friction():
    assert conditions("B*s*x")[1] == ["b > B"]


def test_an_integral_of_position_is_never_positive_at_low_frequencies():
    # Re Z = b - K/omega^2.
    assert conditions("-K/s*x") == ("the real part is never positive at all frequencies", [])


def test_a_condition_on_a_middle_power_is_enough_and_not_needed():
    # (1 + omega^2 tau^2)^2 Re Z = b + B - 2 K tau + (2 b - B) omega^2 tau^2 + b omega^4 tau^4.
    assert conditions("-(K + B*s)/(tau*s + 1)^2*x") == (
        "the real part is positive at all frequencies if",
        ["2*b > B", "b + B > 2*K*tau"],
    )


def test_a_factor_that_comes_with_its_mirror_image_is_positive_with_it():
    # (1 + omega^2 tau^2) Re Z = b (k^2 + omega^2 tau^2), the size of k + j omega tau.
    assert conditions("-b*(k^2 - 1)/(tau*s + 1)*s*x") == ("the real part is positive at all frequencies", [])


def of_function(expression):
    """Return what is said of an even function, which is its own real part, for positive letters."""
    text = f"""symflex = 1
parameters = {{ a = {{}}, b = {{}}, c = {{}}, d = {{}} }}
inputs.u = {{}}
outputs.y = "({expression})*u"
"""
    (tf,) = pipeline.derive_all(pipeline.loads(text))
    found = real_part_conditions(tf)
    return (
        found.sentence.removeprefix("the real part is "),
        {str(c) for c in found.conditions},
        found.is_never,
    )


ALWAYS, NEVER = "positive at all frequencies", "never positive at all frequencies"


def test_two_factors_of_unknown_sign_count_by_their_product():
    # (a - b + x)(c - d + x) with x = omega^2; two negative factors are positive together at x = 0.
    assert of_function("(a - b - s^2)*(c - d - s^2)") == (
        "positive at all frequencies if",
        {"(a - b)*(c - d) > 0", "a + c > b + d"},
        False,
    )


def test_every_power_of_s_and_every_pair_of_mirror_images_turns_the_sign():
    # s^2 = -x, s^4 = x^2, s^6 = -x^3; (a + s)(a - s) = a^2 + x; (a^3 + s^3)(a^3 - s^3) = a^6 + x^3. A square
    # of a real number is taken for positive.
    for expression, is_positive in (
        ("b*s^2", False),
        ("-b*s^2", True),
        ("b*s^4", True),
        ("b*s^6", False),
        ("b*(a + s)*(a - s)", True),
        ("-b*(a + s)*(a - s)", False),
        ("b*(a^3 + s^3)*(a^3 - s^3)", True),
        ("b*(a^2 + s^2)^2", True),
        ("-b*(a^2 + s^2)^2", False),
        ("b*(a^2 + s^2)*s^2", False),
        ("(a - b)^2", True),
    ):
        assert of_function(expression) == (ALWAYS if is_positive else NEVER, set(), not is_positive), (
            expression
        )


def test_conditions_on_the_first_and_the_last_coefficient_are_needed():
    # a - b + c x + (d - b) x^2, and 2 more of it; a coefficient of x that may be negative is not needed.
    exactly, enough = f"{ALWAYS} exactly when", f"{ALWAYS} if"
    assert of_function("a - b - c*s^2 + (d - b)*s^4") == (exactly, {"a > b", "d > b"}, False)
    assert of_function("(a - b)^2*(c - d)") == (exactly, {"c > d"}, False)
    assert of_function("a - b - (c - d)*s^2 + s^4") == (enough, {"a > b", "c > d"}, False)
    # a - b - c x falls below 0 for all values, -a + (c - d) x + x^2 is -a at 0.
    assert of_function("a - b + c*s^2") == (NEVER, set(), True)
    assert of_function("-a - (c - d)*s^2 + s^4") == (NEVER, set(), True)


def test_an_odd_function_has_no_real_part():
    assert of_function("b*s + a*s^3") == ("zero at all frequencies", set(), False)

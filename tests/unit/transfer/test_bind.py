"""Transfer functions with numbers, against mpmath at forty digits and messages in full."""

import math
from decimal import Decimal
from fractions import Fraction
from itertools import product as combinations

import mpmath
import numpy as np
import pytest
from flint import acb, ctx

from symflex import pipeline
from symflex.errors import ModelError, SpecError, UsageError
from symflex.model import ExactValue
from symflex.transfer.bind import _derived_with_numbers, bind_polynomials, read_values

HEADER = "symflex = 1\n[parameters]\n"
TWO_MASSES = f"""{HEADER}m = "2 kg"
M = "7/3 kg"
k = "8 N/m"
b = {{ value = "0.1 N*s/m", assume = "nonnegative" }}
a = {{ value = "-3", assume = "real" }}
[elements]
first = {{ type = "mass", at = "x", m = "m" }}
second = {{ type = "mass", at = "y", m = "M" }}
link = {{ type = "spring", between = ["x", "y"], k = "k" }}
loss = {{ type = "damper", between = ["x", "y"], b = "b" }}
wall = {{ type = "spring", between = ["x", "ground"], k = "3*k" }}
[inputs]
F = {{ force = "x" }}
[outputs]
Y = "y"
V = "s*y"
I = "-y/s"
W = "sqrt(k*m)*pi*y + a*x"
"""
DIGITS = 40


def derive(text, output="Y", source="F"):
    return pipeline.derive(pipeline.assemble(pipeline.loads(text)), output, source)


def value_of(exact):
    return mpmath.mpf(exact.rational.numerator) / exact.rational.denominator * mpmath.pi**exact.pi_power


def responses(s, given):
    """Return x and y per force by the two equations of motion."""
    m, M, k, b = (value_of(given[name]) for name in ("m", "M", "k", "b"))
    w = k + b * s
    determinant = (m * s**2 + w + 3 * k) * (M * s**2 + w) - w**2
    return (M * s**2 + w) / determinant, w / determinant


def formula(s, output, given):
    x, y = responses(s, given)
    m, k, a = (value_of(given[name]) for name in ("m", "k", "a"))
    return {"Y": y, "V": s * y, "I": -y / s, "W": mpmath.sqrt(k * m) * mpmath.pi * y + a * x}[output]


def holds(ball, exact):
    """Tell whether a ball contains a number known to forty digits, and is small itself."""
    with ctx.workprec(400):
        at = acb(mpmath.nstr(exact.real, 60), mpmath.nstr(exact.imag, 60))
        return bool(abs(ball - at) < abs(at) * acb(10).real ** -DIGITS)


DECLARED = {
    "m": ExactValue(Fraction(2)),
    "M": ExactValue(Fraction(7, 3)),
    "k": ExactValue(Fraction(8)),
    "b": ExactValue(Fraction(1, 10)),
    "a": ExactValue(Fraction(-3)),
}
GIVEN = (
    {},
    {"b": ExactValue(Fraction(0)), "m": ExactValue(Fraction(5, 7))},
    {
        "k": ExactValue(Fraction(3, 7), 2),
        "M": ExactValue(Fraction(5, 3), -1),
        "b": ExactValue(Fraction(2), 1),
    },
    {"m": ExactValue(Fraction(1, 9), -3), "k": ExactValue(Fraction(4, 25)), "a": ExactValue(Fraction(0))},
)
POINTS = (mpmath.mpc("0.5", "-1.25"), mpmath.mpc(3, 7), mpmath.mpc("-0.125", "1024"))


def value_and_slope(law, s, *given):
    """Return a law's value and, to forty digits, its logarithmic derivative."""
    with mpmath.workdps(80):
        slope = mpmath.diff(lambda z: mpmath.log(law(z, *given)), s, h=mpmath.mpf(10) ** -25)
        value = law(s, *given)
    with ctx.workprec(300):
        return value, acb(mpmath.nstr(slope.real, 40), mpmath.nstr(slope.imag, 40))


@pytest.mark.slow
def test_balls_hold_what_the_equations_of_motion_give_at_forty_digits():
    for output, given in [*combinations("YVIW", GIVEN)]:
        tf = derive(TWO_MASSES, output)
        used = {name: value for name, value in given.items() if name != "a" or output == "W"}
        enclosed = pipeline.bind(tf, used).enclosed(300)
        for s in POINTS:
            point = acb(float(s.real), float(s.imag))
            exact, slope = value_and_slope(formula, s, output, DECLARED | given)
            assert holds(enclosed(point), exact), output
            with ctx.workprec(300):
                assert abs(enclosed.logarithmic_derivative(point) - slope) < 1e-20, output


ROD = f"""{HEADER}E = "70 GPa"
rho = "2700 kg/m^3"
A = "1e-4 m^2"
l = "2 m"
a = {{ value = 1, assume = "real" }}
[elements]
bar = {{ type = "rod", E = "E", rho = "rho", A = "A", l = "l", between = ["base", "tip"] }}
WALL
[inputs]
F = {{ force = "tip" }}
[outputs]
X = "tip"
V = "s*tip"
N = "a*tip"
"""
FREE = ROD.replace("WALL", "")
HELD = ROD.replace("WALL", 'wall = { type = "spring", between = ["base", "ground"], k = "3 N/m" }')


def rod(s, given, k):
    """Return the tip's displacement per force: E A u'' = rho A s^2 u, held at x = 0 by a spring."""
    E, rho, A, length = (value_of(given[name]) for name in ("E", "rho", "A", "l"))
    q = s * mpmath.sqrt(rho / E)
    stiff = E * A * q
    ch, sh = mpmath.cosh(q * length), mpmath.sinh(q * length)
    return (ch * stiff + k * sh) / (stiff * (stiff * sh + k * ch))


METAL = {
    "E": ExactValue(Fraction(70 * 10**9)),
    "rho": ExactValue(Fraction(2700)),
    "A": ExactValue(Fraction(1, 10**4)),
    "l": ExactValue(Fraction(2)),
}


def test_rods_have_the_values_of_the_wave_equation_at_forty_digits():
    lengths = [{}, {"l": ExactValue(Fraction(1, 3), 1)}, {"A": ExactValue(Fraction(1, 7), -2)}]
    for (text, k), given, s in combinations([(FREE, 0), (HELD, 3)], lengths, (300 - 400j, 0.5 + 8192j)):
        bound = pipeline.bind(derive(text, "X"), given)
        assert not bound.is_rational, (text, given)
        exact, slope = value_and_slope(rod, mpmath.mpc(s), METAL | given, k)
        point = acb(s.real, s.imag)
        assert holds(bound.enclosed(400)(point), exact), (text, given)
        above, below = (bound.enclosed_part(part, 400)(point) for part in (bound.num, bound.den))
        with ctx.workprec(400):
            assert holds(above / below, exact), (text, given)
            error = bound.enclosed(400).logarithmic_derivative(point) - slope
            assert abs(error) < 1e-15, (text, given)
        assert bound(s) == pytest.approx(complex(exact), rel=4e-16), (text, given)


def diagnostic(error, code, values=None, text=TWO_MASSES, output="Y", source="F"):
    with pytest.raises(error) as caught:
        pipeline.bind(derive(text, output, source), values)
    (found,) = caught.value.diagnostics
    assert found.code == code
    return found


def test_an_unknown_name_is_told_with_the_nearest_or_all():
    for name, hint in [("MM", "did you mean 'M'?"), ("something", "parameters: m, M, k, b, a")]:
        found = diagnostic(UsageError, "SF902", {"k": 1, name: 3})
        assert (found.message, found.hint) == (f"there is no parameter '{name}'", hint), name


def test_a_very_long_unknown_name_is_shortened():
    assert diagnostic(UsageError, "SF902", {"x" * 99: 3}).message == f"there is no parameter '{'x' * 64}'"


def test_one_missing_value_is_told_where_its_parameter_stands():
    found = diagnostic(ModelError, "SF229", text=TWO_MASSES.replace('m = "2 kg"', "m = {}"))
    assert found.message == "parameter 'm' has no value"
    assert found.hint == "give it a value here or with --set; in Python, to bind()"
    assert found.span.line == 3


def many(count):
    names = [f"p_{i}" for i in range(count)]
    lines = "\n".join(f"{name} = {{}}" for name in names)
    return f"""{HEADER}{lines}
[inputs]
U = {{}}
[outputs]
Y = "({" + ".join(names)})*U"
"""


def test_missing_values_are_told_in_one_line_of_forty_names():
    for count, more in [(2, ""), (40, ""), (41, " and 1 more"), (45, " and 5 more")]:
        found = diagnostic(ModelError, "SF229", text=many(count), source="U")
        shown = ", ".join(f"p_{i}" for i in range(min(count, 40)))
        assert found.message == f"{count} parameters have no value: {shown}{more}", count
        assert found.hint == "give them values in [parameters], or to bind() in Python", count
        assert found.span is None, count


def test_a_negative_value_is_refused_where_the_model_excludes_it():
    for name, assume in [("k", "positive"), ("b", "nonnegative")]:
        found = diagnostic(UsageError, "SF209", {name: Fraction(-1, 10**9)})
        assert found.message == f"parameter '{name}' is negative, but is assumed {assume}", name
        assert found.hint == f'write {name} = {{ value = ..., assume = "real" }} in the model', name


def test_zero_and_real_values_are_taken():
    assert dict(pipeline.bind(derive(TWO_MASSES), {"k": 0, "b": 1}).values)["k"].rational == 0
    assert dict(pipeline.bind(derive(TWO_MASSES, "W"), {"a": -9}).values)["a"].rational == -9


def test_a_denominator_that_vanishes_is_told_with_a_way_out():
    found = diagnostic(ModelError, "SF231", {"m": 0, "M": 0, "k": 0, "b": 0})
    assert found.message == "the denominator of Y/F is zero for these values"
    assert found.hint.startswith("write the limit as a model of its own (")
    assert "they float" in found.hint


def test_a_rod_without_mass_moves_as_one():
    moved = FREE.replace('F = { force = "tip" }', 'F = { displacement = "tip" }').replace(
        'X = "tip"', 'X = "base"'
    )
    assert pipeline.bind(derive(moved, "X"), {"rho": 0})(3 + 4j) == 1


def test_what_is_no_number_is_told_by_name():
    floats = [math.inf, -math.inf, math.nan, np.float64("nan"), np.array([1.0, 2.0])]
    for given in [*floats, None, 1j, Decimal("Infinity"), Decimal("NaN")]:
        found = diagnostic(UsageError, "SF902", {"k": given})
        assert found.message == "the value of 'k' must be a finite number", given


def test_a_wrong_unit_is_told_with_both():
    found = diagnostic(UsageError, "SF203", {"k": "3 N"})
    assert found.message == "'k' is in 'N/m', the value given in 'N'"


TURNING = f"""{HEADER}f = "50 Hz"
w = "3 rad/s"
n = {{}}
g = "3 Hz^2"
r = "2 1/s"
[inputs]
U = {{}}
[outputs]
Y = "U*f/(s + w)"
Z = "U*n/(s + f)"
"""


def test_turns_and_radians_are_converted_to_what_a_parameter_counts():
    for name, given, exact in [
        ("f", "60 Hz", ExactValue(Fraction(60))),
        ("f", "120 rpm", ExactValue(Fraction(2))),
        ("f", "60 rad/s", ExactValue(Fraction(30), -1)),
        ("f", "60", ExactValue(Fraction(60))),
        ("w", "60 rad/s", ExactValue(Fraction(60))),
        ("w", "60 Hz", ExactValue(Fraction(120), 1)),
        ("w", "30 rpm", ExactValue(Fraction(1), 1)),
        ("g", "48 rad^2/s^2", ExactValue(Fraction(12), -2)),
        ("g", "5 Hz^2", ExactValue(Fraction(5))),
        # Without a unit of its own a parameter takes radians, in 1/s it counts what is counted.
        ("n", "60 Hz", ExactValue(Fraction(120), 1)),
        ("n", "60 N", ExactValue(Fraction(60))),
        ("r", "60 Hz", ExactValue(Fraction(60))),
    ]:
        model = pipeline.loads(TURNING)
        parameter = next(p for p in model.parameters if p.name == name)
        assert read_values((parameter,), {name: given}) == ((name, exact),), (name, given)


def test_values_read_before_stay_as_they_are_and_all_stand_in_declared_order():
    parameters = pipeline.loads(TURNING).parameters
    known = ExactValue(Fraction(1, 3), 5)
    assert read_values(parameters, {"n": known}) == (
        ("f", ExactValue(Fraction(50))),
        ("w", ExactValue(Fraction(3))),
        ("n", known),
        ("g", ExactValue(Fraction(3))),
        ("r", ExactValue(Fraction(2))),
    )


HIDING = f"""{HEADER}a = 1
c = 2
d = {{ value = 3, assume = "real" }}
[inputs]
U = {{}}
[outputs]
Y = "(s + a)^2*(s + d)/((s + c)^3*(s + 5))*U"
Z = "(s^2 + d)*s/((s + c)*s^2)*U"
"""


def test_what_values_cancel_is_hidden_with_its_power():
    for values, roots in [
        ({}, []),
        ({"a": 2}, [-2, -2]),
        ({"a": 2, "d": 2}, [-2, -2, -2]),
        ({"d": 5}, [-5]),
        ({"a": 5, "d": 2}, [-5, -2]),
    ]:
        bound = pipeline.bind(derive(HIDING, "Y", "U"), values)
        hidden = [float(h.root.re) for h in pipeline.roots(bound).hidden for _ in range(h.root.multiplicity)]
        assert sorted(hidden) == roots, values
        s = mpmath.mpf("1.5")
        a, c, d = (mpmath.mpf(values.get(n, v)) for n, v in (("a", 1), ("c", 2), ("d", 3)))
        exact = (s + a) ** 2 * (s + d) / ((s + c) ** 3 * (s + 5))
        assert bound(1.5 + 0j) == pytest.approx(complex(exact), rel=1e-15), values


def test_polynomials_get_the_values_of_a_function_bound_before():
    tf = derive(TWO_MASSES, "W")
    bound = pipeline.bind(tf, {"k": ExactValue(Fraction(3, 7), 2), "m": "5 kg"})
    polynomials = [f for f, _ in tf.ratio.factors]
    found = bind_polynomials(tf, bound, polynomials)
    with mpmath.workdps(80):
        given = DECLARED | dict(bound.values)
        exact = formula(POINTS[0], "W", given)
    point = acb(0.5, -1.25)
    with ctx.workprec(300):
        value = acb(tf.ratio.unit.numerator) / tf.ratio.unit.denominator
        for image, (_, exponent) in zip(found, tf.ratio.factors, strict=True):
            value *= bound.enclosed_part(image, 300)(point) ** exponent
        assert holds(value, exact)


def test_where_a_wavenumber_vanishes_the_value_is_the_limit():
    # At rest: the spring of 3 N/m and l/(E A); without the spring a free mass, whose pole it is.
    assert pipeline.bind(derive(HELD, "X"))(0j) == pytest.approx(1 / 3 + 2 / 7e6, rel=1e-15)
    assert math.isinf(pipeline.bind(derive(FREE, "X"))(0j).real)


def test_a_function_that_values_make_zero_is_zero_everywhere():
    bound = pipeline.bind(derive(HELD, "N"), {"a": 0})
    assert (bound(3j), bound(0j)) == (0, 0)


def test_a_denominator_of_a_wavenumber_that_vanishes_is_told_with_a_way_out():
    moved = HELD.replace('F = { force = "tip" }', 'F = { displacement = "tip" }').replace(
        'X = "tip"', 'X = "base"'
    )
    found = diagnostic(ModelError, "SF231", {"E": 0}, moved, "X")
    assert found.message == "a denominator is zero for these values"
    assert found.hint == "write a rigid or massless limit as a model of its own"


def test_deriving_with_numbers_from_the_start_gives_the_same_function():
    for output in "YVIW":
        tf = derive(TWO_MASSES, output)
        bound = pipeline.bind(tf, {"k": "5 N/m"})
        numeric = _derived_with_numbers(tf, bound.values, [name for name, _ in bound.values])
        assert numeric.values == bound.values, output
        assert numeric.name == bound.name, output
        for s in (0.5 + 2j, -3 + 0.25j):
            assert numeric(s) == pytest.approx(bound(s), rel=1e-15), output


def test_a_quantity_that_cannot_be_read_is_told_with_its_place():
    with pytest.raises(SpecError) as caught:
        pipeline.bind(derive(TWO_MASSES), {"k": "3 N/mm^x"})
    (found,) = caught.value.diagnostics
    assert (found.span.source.name, found.span.line) == ("<value>", 1)
    assert found.span.start > 0
    assert found.span.text in "3 N/mm^x"


class Scalar:
    """A number of a library that says its size, or does not."""

    def __init__(self, value, **size):
        self.__dict__.update(size)
        self.value = value

    def item(self):
        return self.value


def test_what_other_libraries_call_a_number_is_one_if_it_is_alone():
    for given, is_read in [(Scalar(0.5), True), (Scalar(0.5, size=1), True), (Scalar(0.5, size=2), False)]:
        if is_read:
            assert dict(pipeline.bind(derive(TWO_MASSES), {"k": given}).values)["k"].rational == Fraction(
                1, 2
            ), given
        else:
            diagnostic(UsageError, "SF902", {"k": given})


ROOTS = f"""{HEADER}k = 2
m = 9
[inputs]
U = {{}}
[outputs]
Y = "U/(s^2 + sqrt(k/m)^2)"
Z = "U/(s^2 + sqrt(k/m)^4)"
W = "U/(s^2 + sqrt(k/m)*s + sqrt(k/m)^2)"
"""


def test_even_powers_of_roots_of_rational_numbers_are_rational():
    for output, values, denominator in [
        ("Y", {}, "9*s^2 + 2"),
        ("Y", {"k": 50, "m": 3}, "3*s^2 + 50"),
        ("Z", {}, "81*s^2 + 4"),
        ("Z", {"k": 5, "m": 2}, "4*s^2 + 25"),
    ]:
        ((polynomial, exponent),) = pipeline.bind(derive(ROOTS, output, "U"), values).ratio.factors
        assert (str(polynomial), exponent) == (denominator, -1), (output, values)


def test_odd_powers_of_roots_stay_what_they_are():
    bound = pipeline.bind(derive(ROOTS, "W", "U"))
    with mpmath.workdps(60):
        root = mpmath.sqrt(mpmath.mpf(2) / 9)
        s = mpmath.mpc(0.5, -1.25)
        assert holds(bound.enclosed(300)(acb(0.5, -1.25)), 1 / (s**2 + root * s + root**2))


def test_what_values_cancel_beside_a_rod_is_hidden_too():
    text = FREE.replace("a = { value", 'p = "1 1/s"\nq = "2 1/s"\na = { value').replace(
        'N = "a*tip"', 'N = "(s + p)/(s + q)*tip"'
    )
    tf = derive(text, "N")
    assert pipeline.bind(tf).hidden == ()
    bound = pipeline.bind(tf, {"p": 3, "q": 3})
    assert [(str(h.polynomial), h.multiplicity) for h in bound.hidden] == [("s + 3", 1)]
    assert bound(5j) == pytest.approx(pipeline.bind(derive(text, "X"))(5j), rel=1e-15)


def test_numerator_and_denominator_of_a_rod_are_entire_and_do_not_vanish_together_at_rest():
    bound = pipeline.bind(derive(HELD, "X"))
    for part in (bound.num, bound.den):
        near, nearer = (complex(bound.enclosed_part(part, 400)(acb(10.0**-e))) for e in (6, 9))
        assert abs(nearer) > 1e-9
        assert nearer == pytest.approx(near, rel=1e-6)

"""Short formulas: what is said of coefficients, roots and magnitude holds, and what must stay stays."""

from fractions import Fraction
from random import Random

import numpy as np
import pytest
import sympy

from symflex import pipeline
from symflex.api.transfer_function import Form
from symflex.errors import UsageError
from symflex.options import DeriveOptions
from symflex.print.forms import print_form
from symflex.print.text import form_text
from symflex.symbolic.short import approximation, shortened

HEAD = "symflex = 1\ninputs.u = {}\n"


def function(output, definitions=(), **values):
    """Return the function of a formula; a pair is a value and its spread."""
    pairs = {n: v if isinstance(v, tuple) else (v, 0) for n, v in values.items()}
    entries = (
        f'parameters.{n} = {{ value = {v}, assume = "real"{f", spread = {s}" if s else ""} }}\n'
        for n, (v, s) in pairs.items()
    )
    lines = "".join(f'definitions.{n} = "{text}"\n' for n, text in dict(definitions).items())
    text = HEAD + "".join(entries) + lines + f'outputs.y = "{output}"'
    (tf,) = pipeline.derive_all(pipeline.loads(text))
    return tf


def test_a_term_that_keeps_a_pole_in_the_left_half_plane_stays():
    # Routh 1877: s^3 + a s^2 + s + c is stable for a > c; 1.005 > 1.002 > 1
    form = shortened(function("u/(s^3 + (a + d)*s^2 + s + c)", a=1, d=0.005, c=1.002), Fraction(1, 100))[1]
    assert form.approximation.facts["terms"] == [5, 5]
    assert form.approximation.facts["kept_whole"] == 1


def test_a_term_of_a_definition_stays_that_keeps_a_pole_in_the_left_half_plane():
    tf = function("u/(s^3 + A*s^2 + s + c)", {"A": "a + d"}, a=1, d=0.005, c=1.002)
    form = shortened(tf, Fraction(1, 100))[1]
    assert dict(form.where) or form.approximation.facts["terms"] == [5, 5]
    assert form.approximation.facts["kept_whole"] == 1


def test_a_coefficient_of_both_signs_is_measured_by_its_difference():
    # d is 0.1 % of a, and 1 % of a - b + d at the values, but up to 1.25 % over the spread
    tf = function("u/(s + a - b + d)", a=(10, 0.01), b=(9, 0.01), d=0.01)
    assert shortened(tf, Fraction(1, 100))[1].approximation.facts["terms"][0] == 4
    assert shortened(tf, Fraction(1, 70))[1].approximation.facts["terms"][0] == 3


def test_terms_of_opposite_sign_in_which_nothing_is_left_stay():
    # over the spread a - b is zero
    tf = function("u/(s + a - b + d)", a=(10, 0.1), b=(9, 0.1), d=1e-9)
    assert shortened(tf, Fraction(1, 100))[1].approximation.facts["terms"][0] == 4


@pytest.mark.parametrize(
    ("output", "values", "expected"),
    [
        # sums inside products: (a + d) and (b + e) share the bound
        ("u/(((a + d)*s + 1)*((b + c)*s + 2))", {"a": 1, "d": 4e-3, "b": 7, "c": 2e-2},
            "1/((a*s + 1)*(b*s + 2))"),
        # a zero next to a pole does not cancel it
        ("u*(a*s + 1)/((a + d)*s + 1)", {"a": 1, "d": 0.001}, "(a*s + 1)/((a + d)*s + 1)"),
        # two springs in series of which one is rigid
        ("u*(k + c)/(m*s^2*(k + c) + k*c)", {"m": 1, "k": 5, "c": 5000}, "1/(m*s^2 + k)"),
        # the delay is as it was
        ("u*exp(-T*s)/(s + a + d)", {"T": 1, "a": 2, "d": 0.001}, "exp(-T*s)/(s + a)"),
    ],
)  # fmt: skip
def test_a_short_formula_is_what_an_author_would_write(output, values, expected):
    tf, form = shortened(function(output, **values), Fraction(1, 100))
    assert form_text(tf, form) == f"y/u = {expected}"


def test_terms_beside_a_complex_coefficient_go():
    tf, form = shortened(function("u/(s + K + d)", {"K": "a + c*j"}, a=1, c=2, d=0.001), Fraction(1, 100))
    assert form_text(tf, form) == "y/u = 1/(s + K)\n  where K = a + c*j"


VALUES = {"a": 3.0, "b": 0.02, "c": 2.0, "d": 0.01, "e": 0.5}
OUTPUT = "u*(e*s + a + d)/(a*c*s^2 + (a*d + c*e + b*d)*s + a - b*c^2 + d*e)"


def coefficients(expression, values):
    """Return the coefficients of a SymPy expression in s, in doubles."""
    symbols = {x.name: x for x in expression.free_symbols}
    numbers = {symbols[n]: v for n, v in values.items() if n in symbols}
    return np.array([float(c) for c in sympy.Poly(expression.subs(numbers), symbols["s"]).all_coeffs()])


def test_a_sum_of_kernels_loses_what_stands_before_all_of_it():
    # a beam with a spring at its tip that is a thousandth of its own stiffness, and one that is not
    text = """
    symflex = 1
    parameters = { EI = "3 N*m^2", m = "2 kg/m", l = "1 m", k = "1 N/m", c = "1 mN/m" }
    inputs.F = { force = "b" }
    outputs.X = "b"
    [elements]
    clamp = { type = "fixed", at = "a" }
    arm = { type = "beam", between = ["a", "b"], EI = "EI", rhoA = "m", l = "l" }
    spring = { type = "spring", between = ["b", "ground"], k = "k + c" }
    """
    (tf,) = pipeline.derive_all(pipeline.loads(text))
    short, form = shortened(tf, Fraction(1, 100))
    assert "c" not in {p.name for p in short.parameters}
    assert (
        form.approximation.facts["poles"]["lost"]
        == 0
        < form.approximation.facts["poles"]["displacement"]
        < 1e-3
    )


def test_no_statement_is_exceeded_at_random_points_of_the_box_and_of_the_band():
    spread, random = 0.1, Random(3)
    tf = function(OUTPUT, **{name: (value, spread) for name, value in VALUES.items()})
    short, printed = shortened(tf, Fraction(3, 100))
    before, after, facts = Form(tf, print_form(tf)), Form(short, printed), printed.approximation.facts
    assert facts["terms"][0] < facts["terms"][1]
    worst, decibels, moved = 0.0, 0.0, {"poles": 0.0, "zeros": 0.0}
    for _ in range(200):
        point = {name: value * (1 + spread * random.choice((-1, 1))) for name, value in VALUES.items()}
        sides = [(before.num, after.num), (before.den, after.den)]
        pairs = [tuple(coefficients(side, point) for side in pair) for pair in sides]
        shares = [y / x for x, y in pairs]
        worst = max(worst, *(float(abs(each - 1).max()) for each in shares))
        for kind, pair in zip(("zeros", "poles"), pairs, strict=True):
            one, other = map(np.roots, pair)
            moved[kind] = max(moved[kind], *(min(abs(other - root)) / abs(root) for root in one))
        for low, high in facts["within_1_db_over_spread_hz"]:
            s = 2j * np.pi * np.geomspace(low, high, 50)
            num, num_s, den, den_s = (np.polyval(x, s) for pair in pairs for x in pair)
            decibels = max(decibels, *np.abs(20 * np.log10(np.abs(num_s * den / (num * den_s)))))
    assert 0 < decibels <= 1
    assert worst <= facts["coefficients"]["spread"] <= 1.5 * worst
    assert all(moved[kind] <= facts[kind]["spread"] <= 1.5 * moved[kind] for kind in moved)
    num, den, num_s, den_s = (coefficients(x, VALUES) for x in (before.num, before.den, after.num, after.den))
    for kind, one, other in (("poles", den, den_s), ("zeros", num, num_s)):
        gaps = [min(abs(np.roots(other) - root)) / abs(root) for root in np.roots(one)]
        assert max(gaps) <= facts[kind]["displacement"] * (1 + 1e-9)
    for low, high in facts["within_1_db_hz"]:
        s = 2j * np.pi * np.geomspace(low, high, 200)
        quotient = np.polyval(num_s, s) * np.polyval(den, s) / (np.polyval(num, s) * np.polyval(den_s, s))
        assert np.all(np.abs(20 * np.log10(np.abs(quotient))) <= 1 + 1e-9)


def test_roots_that_may_merge_over_the_spread_are_not_bounded():
    # s^2 + 2 z s + 1 has a double root for z = 1; the zero of the numerator moves by d/a, over the spread too
    values = {"a": (2, 0.1), "d": (0.01, 0.1), "z": (0.95, 0.1)}
    form = shortened(function("u*(s + a + d)/(s^2 + 2*z*s + 1 + d)", **values), Fraction(2, 100))[1]
    facts = form.approximation.facts
    assert facts["poles"]["spread"] is None
    assert 0.011 / 1.811 <= facts["zeros"]["spread"] <= 0.0063
    assert any("over the spread not bounded" in line for line in form.approximation.said)


def test_roots_from_which_a_term_of_value_zero_is_dropped_stay():
    form = shortened(function("u/(s + a + d)", a=(2, 0.1), d=0), Fraction(1, 100))[1]
    assert form.approximation.facts["poles"]["spread"] == 0


def test_of_roots_of_s_nothing_is_said_over_a_spread():
    # at s = 10 j a resonance moves, which no sqrt(s) on the imaginary axis meets
    values = {"a": (1, 0.05), "b": (0.01, 0.05), "w": (100, 0.05), "d": (0.5, 0.05)}
    form = shortened(function("u*(sqrt(s) + a)/(s^2 + b*s + w + d)", **values), Fraction(2, 100))[1]
    assert "within_1_db_over_spread_hz" not in form.approximation.facts
    assert form.approximation.facts["poles"]["spread"] is None


def test_a_formula_in_which_every_term_counts_is_said_to_stay():
    form = shortened(function("u/(a*s + b)", a=1, b=2), Fraction(1, 100))[1]
    assert form.approximation.said == ("no term can be dropped within 1 %: all 2 stay",)


NESTED = "u*(3*M*s^2 + 2*K)/((M*s^2 + B*s + K + g*cos(p))*(3*M*s^2 + 2*K) + 6*K*M*s^2)"
LINES = {"M": "m + n", "K": "k*c/(k + c) + g", "B": "2*z*sqrt(K*M)"}
OWN = {"m": 2.0, "n": 4e-3, "k": 1e3, "c": 9e5, "g": 0.5, "p": 0.1, "z": 0.02, "B": 1.0}


@pytest.mark.parametrize(
    ("lines", "spread", "letters"), [(LINES, 0, "kmz"), ({n: LINES[n] for n in "MK"}, 0.05, "Bkm")]
)
def test_definitions_lose_terms_and_no_statement_is_exceeded(lines, spread, letters):
    random = Random(5)
    values = {name: value for name, value in OWN.items() if name not in lines}
    tf = function(NESTED, lines, **{name: (value, spread) for name, value in values.items()})
    short, form = shortened(tf, Fraction(1, 100))
    head, _, where = form_text(short, form).removeprefix("y/u = ").partition("\n  where ")
    assert "".join(p.name for p in sorted(short.parameters, key=lambda p: p.name)) == letters

    def polynomials(output, lines):
        """Return numerator and denominator as functions of the values, by SymPy."""
        function = sympy.sympify(output.removeprefix("u*").replace("^", "**"))
        for _ in lines:
            function = function.subs({n: sympy.sympify(text) for n, text in lines.items()})
        sides = sympy.fraction(sympy.together(function))
        s, names = sympy.Symbol("s"), [sympy.Symbol(name) for name in values]
        return [sympy.lambdify(names, sympy.Poly(side, s).all_coeffs()) for side in sides]

    def at(sides, point):
        num, den = (np.array(side(*point.values()), dtype=float) for side in sides)
        return num / den[-1], den / den[-1]

    before = polynomials(NESTED, lines)
    after = polynomials(head, dict([where.split(" = ")] if where else []))
    facts, worst = form.approximation.facts, 0.0
    bands = facts["within_1_db_over_spread_hz"] if spread else facts["within_1_db_hz"]
    for _ in range(200 if spread else 1):
        point = {name: value * (1 + spread * random.choice((-1, 1))) for name, value in values.items()}
        one, other = at(before, point), at(after, point)
        ratios = np.concatenate([y[x != 0] / x[x != 0] for x, y in zip(one, other, strict=True)])
        worst = max(worst, ratios.max() / ratios.min() - 1)
        for low, high in bands:
            s = 2j * np.pi * np.geomspace(low, high, 200)
            (n, d), (n_s, d_s) = ([np.polyval(x, s) for x in each] for each in (one, other))
            assert np.all(abs(20 * np.log10(abs(n_s * d / (n * d_s)))) <= 1 + 1e-9)
    bound = facts["coefficients"]["spread" if spread else "nominal"]
    assert bound / 3 < worst <= (1 + bound) / (1 - bound) - 1 <= 0.0203
    one, other = at(before, values), at(after, values)
    assert abs(other[0][-1] / one[0][-1] - 1) <= facts["static"] * (1 + 1e-9)
    for kind, x, y in (("zeros", one[0], other[0]), ("poles", one[1], other[1])):
        gaps = [min(abs(np.roots(y) - root)) / abs(root) for root in np.roots(x)]
        assert max(gaps) <= facts[kind]["displacement"] * (1 + 1e-9)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"short": "2"}, "--short takes a share"),
        ({"short": "1 %", "order": 2}, "exclude each other"),
        ({"short": "1 %", "spread": "-1 %"}, "--spread takes a share"),
    ],
)
def test_what_cannot_be_short_is_refused(given, said):
    with pytest.raises(UsageError, match=said):
        approximation(function("u/(s + a)", a=1), DeriveOptions(**given))

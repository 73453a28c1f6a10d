"""Expressions evaluated: their values against numbers, and what they may not hold, with the place."""

from dataclasses import replace
from fractions import Fraction

import pytest

from symflex import pipeline
from symflex.algebra import PRIME, Factored, Ring, residue
from symflex.equations.distributed import read_equation
from symflex.equations.evaluate import Dynamics, ExactEvaluator, exact_root, shared_by_sides
from symflex.errors import BudgetError, ModelError, Source, Span, Text
from symflex.expressions import Name, names, parse_equation
from symflex.expressions import parse as parse_text
from symflex.library.elements import LinearForm, Variable
from symflex.model import scope_of

MODEL = pipeline.loads(
    """symflex = 1
[parameters]
k = {}
m = {}
[definitions]
z = "k - k"
w = "k/m"
[blocks]
G = { type = "tf", num = "k", den = "s + m" }
[elements]
mass = { type = "mass", at = "x", m = "m" }
spring = { type = "spring", between = ["x", "ground"], k = "k" }
[inputs]
F = { force = "x" }
u = {}
[outputs]
X = "x + sqrt(w)*u + sqrt(2)*u"
"""
)
RING = Ring(("s", "k", "m", "z", "w", "pi", "sqrt(k/m)", "sqrt(2)"))
POINT = {"s": 11, "k": 5, "m": 3, "z": 0, "w": 5 * pow(3, -1, PRIME), "pi": 7, "sqrt(k/m)": 13, "sqrt(2)": 17}
S, K, M = (Factored.generator(RING, name) for name in "skm")
SPRING = Variable("through", "spring", "f")


def parse(text):
    return parse_text(Text(text, Span(Source("model.toml", text), 0, len(text))))


def evaluator(**more):
    definitions = {d.name: d.expression for d in MODEL.definitions}
    through = {SPRING: LinearForm.of((Variable("node", "x"), K))}
    return ExactEvaluator(
        RING, scope_of(MODEL), {"G": Dynamics(K / (S + M), S + M)}, through, definitions, POINT, **more
    )


def in_field(value):
    return value.numerator * pow(value.denominator, -1, PRIME) % PRIME


def test_a_constant_has_the_value_of_its_numbers():
    for text, value in [
        ("3/4", Fraction(3, 4)), ("k + 2*m - s", Fraction(0)), ("-(k - m)*s/4", Fraction(-11, 2)),
        ("k^3 - m^-2", 125 - Fraction(1, 9)), ("k^0", Fraction(1)), ("G*m", Fraction(15, 14)),
        ("1/G^2", Fraction(14, 5) ** 2), ("w*pi + z", Fraction(35, 3)), ("sqrt(9/4)*k", Fraction(15, 2)),
        ("sqrt(w) - 1", Fraction(12)), ("sqrt(k/m)*sqrt(2)", Fraction(13 * 17)),
        ("exp(m - m) + cos(0) + cosh(0*k) + sin(0) + tan(0) + sinh(0) + tanh(k - k)", Fraction(3)),
        ("k + m*(s - s)", Fraction(5)),
    ]:  # fmt: skip
        assert residue(evaluator().constant(parse(text)), POINT) == in_field(value), text


def test_a_linear_form_has_the_coefficients_of_its_numbers():
    for text, terms in [
        ("x", {"x": 1}),
        ("3*x - u/2 + k*x", {"x": 8, "u": Fraction(-1, 2)}),
        ("-(x - u)*G", {"x": Fraction(-5, 14), "u": Fraction(5, 14)}),
        ("spring.f + m*x", {"x": 8}),
        ("x^1*k", {"x": 5}),
        ("u + x - u", {"x": 1}),
        ("0", {}),
        ("x*(k - k)", {}),
        ("x + 0*m", {"x": 1}),
    ]:
        form = evaluator().linear(parse(text))
        assert {str(v): residue(c, POINT) for v, c in form.terms} == {
            n: in_field(Fraction(v)) for n, v in terms.items()
        }, text


def test_what_is_not_constant_or_not_linear_is_refused_at_its_place():
    for method, text, code, place, message in [
        ("constant", "k + x", "SF221", "k + x", "the sum has a term without an unknown"),
        ("constant", "2*x", "SF212", "2*x", "'2*x' must be constant"),
        ("constant", "k/x", "SF212", "x", "'x' must be constant"),
        ("constant", "sqrt(x)", "SF212", "x", "'x' must be constant"),
        ("linear", "k", "SF221", "k", "the expression has a term without an unknown"),
        ("linear", "x*u", "SF222", "x*u", "a product of two unknowns is not linear"),
        ("linear", "(x + u)^2", "SF222", "(x + u)^2", "a power of an unknown is not linear"),
        ("constant", "k/(m - m)", "SF224", "m - m", "division by zero"),
        ("constant", "k/z", "SF224", "z", "division by zero"),
        ("constant", "1/(k - w*m)", "SF224", "k - w*m", "division by zero"),
        ("constant", "z^-1", "SF224", "z^-1", "division by zero"),
        ("constant", "sqrt(s)", "SF910", "sqrt(s)", "sqrt of an expression in s is not available yet"),
        ("constant", "exp(G)", "SF910", "exp(G)", "exp of an expression in s is not available yet"),
        ("constant", "exp(s - s)", "SF910", "exp(s - s)", "exp of an expression in s is not available yet"),
    ]:
        with pytest.raises(ModelError) as caught:
            getattr(evaluator(), method)(parse(text))
        (problem,) = caught.value.diagnostics
        assert (problem.code, problem.message, problem.span.text) == (code, message, place), (method, text)


def test_what_is_not_available_is_said_with_what_is():
    for blocks, text, message, hint in [
        (
            {"G": K}, "sqrt(s)", "sqrt of an expression in s is not available yet",
            "write a delay as a block of type delay; waves come with rods, beams and [fields]",
        ),
        (
            {"k": K}, "sqrt(k)", "sqrt of a block ('k') is not available yet",
            "blocks may be added, multiplied, divided and raised to integer powers",
        ),
        (
            {}, "G", "a delay inside a field's equation or a length is not available",
            "wavenumbers would depend on it; a delayed load may come from a signal: "
            '[signals] load = "exp(-s*T)*..."',
        ),
    ]:  # fmt: skip
        with pytest.raises(ModelError) as caught:
            ExactEvaluator(RING, scope_of(MODEL), blocks, {}, {}, POINT).constant(parse(text))
        (problem,) = caught.value.diagnostics
        assert (problem.code, problem.message, problem.hint) == ("SF910", message, hint), blocks
        assert problem.span.text == text, blocks


def coefficients(text):
    """Read an equation of the field w."""
    equation = parse_equation(Text(text, Span(Source("model.toml", text), 0, len(text))))
    inside = replace(evaluator(), scope=scope_of(MODEL).within(["w"]))
    return read_equation(equation, ["w"], inside)


def test_the_coefficients_of_an_equation_are_those_of_its_left_side_less_its_right():
    for text, terms, loads in [
        ("w'' + s*w = 3*w - w''", {2: 2, 0: 8}, {}),
        (
            "k*(w'' - u)/m = -(2*w'' - G*u + u)",
            {2: Fraction(11, 3)},
            {"u": Fraction(-2, 3) - Fraction(5, 14)},
        ),
        ("w' - w' + s^2*w = 0", {0: 121}, {}),
        ("(w + w')*(k - k) = 2*w'*k - u", {1: -10}, {"u": 1}),
        ("0 = w''''*pi/2 + 4*u*0 + 0*k", {4: Fraction(-7, 2)}, {}),
    ]:
        found = coefficients(text)
        for read, wanted in (
            (found.terms, {("w", k): c for k, c in terms.items()}),
            ({str(v): c for v, c in found.loads.items()}, loads),
        ):
            assert {key: residue(c, POINT) for key, c in read.items()} == {
                key: in_field(Fraction(c)) for key, c in wanted.items()
            }, text


def test_an_equation_with_a_constant_term_or_a_division_by_zero_is_refused():
    for text, code, place, message in [
        ("w'' = 3*k", "SF221", "3*k", "the expression has a term without an unknown"),
        ("w'' = k", "SF221", "k", "the expression has a term without an unknown"),
        ("w''/(k - k) = w", "SF224", "k - k", "division by zero"),
        ("w''/z = w", "SF224", "z", "division by zero"),
    ]:
        with pytest.raises(ModelError) as caught:
            coefficients(text)
        (problem,) = caught.value.diagnostics
        assert (problem.code, problem.message, problem.span.text) == (code, message, place), text


def test_zero_to_a_positive_power_is_zero():
    assert evaluator().constant(parse("(k - k)^2")).is_zero


def test_what_too_many_terms_would_come_of_is_refused_at_its_place():
    names = tuple(f"a{i}" for i in range(12))
    model = pipeline.loads(
        'symflex = 1\ninputs.u = {}\noutputs.y = "u"\n[parameters]\n'
        + "".join(f"{n} = {{}}\n" for n in names)
    )
    wide = ExactEvaluator(Ring(("s", *names)), scope_of(model), {}, {}, {})
    text = f"({' + '.join(names)})^40 + 1"
    with pytest.raises(BudgetError) as caught:
        wide.constant(parse(text))
    (problem,) = caught.value.diagnostics
    assert (problem.code, problem.span.text, problem.hint) == (
        "SF501",
        text,
        "keep repeated sums in [definitions]",
    )


def chain(link, last):
    """Definitions of which each is made of the one before, from ``d0 = k`` on."""
    return {"d0": parse("k"), **{f"d{i}": parse(link.format(i - 1)) for i in range(1, last + 1)}}


def test_definitions_are_opened_in_a_function_up_to_a_size():
    for link, accepted, refused in [("-d{}", 197, 199), ("d{0} + d{0}", 9, 10)]:
        for last, code in ((accepted, None), (refused, "SF103")):
            opener = ExactEvaluator(RING, scope_of(MODEL), {}, {}, chain(link, last)).opener
            call = parse(f"sqrt(d{last})")
            if code is None:
                assert not {n.name for n in names(opener.open(call)) if isinstance(n, Name)} - {"k"}, link
            else:
                with pytest.raises(ModelError, match="the argument of sqrt is too large") as caught:
                    opener.open(call)
                assert [(d.code, d.span.text) for d in caught.value.diagnostics] == [
                    (code, f"sqrt(d{last})")
                ], link


def test_a_square_root_of_a_number_is_exact_or_none():
    for value, root in [
        (Fraction(0), Fraction(0)),
        (Fraction(1, 4), Fraction(1, 2)),
        (Fraction(49, 9), Fraction(7, 3)),
        (Fraction(2), None),
        (Fraction(4, 3), None),
        (Fraction(3, 4), None),
        (Fraction(-4), None),
    ]:
        assert exact_root(value) == root, value


def test_a_point_of_a_field_is_asked_for():
    asked = []

    def at(call):
        asked.append(call.name)
        return LinearForm.of((Variable("field", "f", "w"), K))

    found = evaluator(fields=("w",), field_value=at)
    assert found.linear(parse("2*w(m)")).terms[0][1].unit == 2
    assert found.constant(parse("sqrt(9/4)")).unit == Fraction(3, 2)
    assert asked == ["w"]


def test_a_coefficient_that_is_zero_by_its_values_connects_nothing():
    # u = F/(s + 2) + zz (...) is F/(s + 2) with zz = 0: its only pole is -2
    text = """symflex = 1
parameters = {{ p = {{ value = {p}, assume = "real" }}, q = 1, T = "1 s" }}
definitions.zz = "{zz}"
signals.u = "F/(s*T + 2) + {term}"
inputs.F = {{}}
outputs.Y = "u"
"""
    terms = ("zz*F/(s*T - 1)", "zz/(s*T - 1)*F", "(zz + zz*s*T)*F/(s*T - 1)", "zz*(F + u)/(sqrt(s*T) - 2)")
    for p, zz in ((1, "p - q"), (1, "p^2 - p*q"), (0, "p")):
        for term in terms:
            model = pipeline.loads(text.format(p=p, zz=zz, term=term))
            (bound,) = pipeline.derive_bound(model, model.transfer_functions)
            found = pipeline.roots(bound)
            assert found.verdict.sentence == "stable", (zz, term)
            assert [complex(root) for root in found.poles] == [-2], (zz, term)
            assert found.hidden == (), (zz, term)


def test_a_factor_that_two_denominators_have_is_shared_as_often_as_above():
    # (s - 1) (s + 5) over (s - 1) (s + 2) times (s - 1) (s + 3), which sums have left multiplied out
    ring = Ring(("s",))
    s = ring.generator("s")
    above, *below = (Factored.polynomial(ring, (s - 1) * (s + n)) for n in (5, 2, 3))
    assert str(shared_by_sides(above / below[0] / below[1])) == "(s - 1)"

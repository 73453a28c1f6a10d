"""Transfer functions against equations: values at points from formulas of books, and planted faults."""

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest
from flint import acb, arb, ctx

from symflex import pipeline
from symflex.errors import InternalError
from symflex.model import ExactValue
from symflex.transfer import nested_transfer
from symflex.transfer.against_equations import Agreement, ModelSolve, compare
from symflex.transfer.agreement import agreement
from symflex.transfer.direct_solve import Point, SingularPointError
from tests.house.repository import ROOT

DERIVATIONS = sorted(p for p in (ROOT / "derivations").rglob("*.toml") if p.name != "claims.toml")
CANTILEVER = """symflex = 1
inputs.F = { force = "tip" }
outputs.Y = "tip"
[elements.arm]
type = "beam"
between = ["ground", "tip"]
E = "2 Pa"
I = "3 m^4"
rho = "5 kg/m^3"
A = "7 m^2"
l = "1 m"
"""


def solution(text, s, bits=128):
    model = pipeline.loads(text)
    with ctx.workprec(bits):
        solve = ModelSolve(model, nested_transfer, None if model.is_distributed else pipeline.assemble(model))
        ones = {p.name: lambda: arb(1) for p in model.parameters}
        return solve.direct.at(Point(lambda: acb(*s), ones), model.transfer_functions).values


def test_a_mass_on_a_spring_is_what_its_equation_says():
    found = solution(
        """symflex = 1
inputs = { F = { force = "x" } }
outputs = { X = "x" }
[elements]
body = { type = "mass", at = "x", m = "2 kg" }
wall = { type = "spring", between = ["x", "ground"], k = "8 N/m" }
""",
        (1, 1),
    )["X", "F"]
    assert (found * acb(8, 4)).contains(1)
    assert found.rel_accuracy_bits() > 100


def test_a_beam_is_carried_without_wavenumbers():
    # Tip receptance of a cantilever (Bishop & Johnson 1960, table 7.1), with lambda^4 = -rho A s^2/(E I).
    found = solution(CANTILEVER, (2, 1))["Y", "F"]
    with ctx.workprec(128):
        q = (acb(-35) * acb(2, 1) ** 2 / 6).sqrt().sqrt()
        above = q.cosh() * q.sin() - q.sinh() * q.cos()
        right = above / (q**3 * 6 * (1 + q.cosh() * q.cos()))
        assert found.overlaps(right)
        assert found.rel_accuracy_bits() > 80


def test_taylor_steps_follow_a_law_that_varies():
    # An exponential horn with A = exp(2 x) m^2: u'' + 2 u' = s^2 u (Webster 1919), u(0) = 0, E A u'(1) = F.
    found = solution(
        """symflex = 1
parameters = { a = "1 m^2", l = "1 m" }
inputs.F = { force = "x" }
outputs.X = "x"
[elements]
horn = { type = "rod", between = ["ground", "x"], E = "1 Pa", rho = "1 kg/m^3", A = "a*exp(2*x/l)", l = "l" }
""",
        (3, -2),
        192,
    )["X", "F"]
    with ctx.workprec(192):
        root = (1 + acb(3, -2) ** 2).sqrt()
        right = root.sinh() / (acb(1).exp() ** 2 * (root * root.cosh() - root.sinh()))
        assert found.overlaps(right)
        assert found.rel_accuracy_bits() > 60


def test_taylor_steps_leave_out_less_with_more_bits():
    # Waves of a stiff tension grow by exp(56) along the beam, and cancel by as much.
    text = """symflex = 1
inputs.M = { unit = "N*m" }
outputs.y = "w(l/2)"
[parameters]
EI = "1 N*m^2"
T = "800 N"
q = "1 N/m"
m = "1 kg/m"
l = "2 m"
[fields.w]
domain = ["0", "l"]
equation = "(EI*w'')'' - ((T - q*x)*w')' + m*s^2*w = 0"
conditions = ["w(0) = 0", "w''(0) = 0", "w(l) = 0", "EI*w''(l) = M"]
"""
    (tf,) = pipeline.derive_all(pipeline.loads(text))
    assert compare(tf.solve, [agreement(tf)]) == ""


def test_a_point_at_which_equations_are_singular_is_told():
    model = pipeline.loads(
        """symflex = 1
elements = { b = { type = "mass", at = "x", m = "1 kg" } }
inputs = { F = { force = "x" } }
outputs = { X = "x" }
"""
    )
    solve = ModelSolve(model, nested_transfer, pipeline.assemble(model))
    with pytest.raises(SingularPointError):
        solve.direct.at(Point(lambda: acb(0), {}), model.transfer_functions)


@pytest.mark.slow
@pytest.mark.parametrize("path", DERIVATIONS, ids=lambda p: p.stem)
def test_every_derivation_is_compared(path):
    model = pipeline.load(path)
    for tf in pipeline.derive_all(model):
        reason = compare(tf.solve, [agreement(tf)])
        assert reason == (
            "" if path.stem not in ("hanging_string", "wedge", "cone") else tf.solve.direct.unsolved
        )


def functions(name):
    return pipeline.derive_all(pipeline.load(ROOT / "derivations" / name))


def wrong(tf):
    """Return the function with the faults that a derivation may make."""
    ratio, s = tf.ratio, tf.ratio.ring.context.gen(0)
    first = next(f for f, _ in ratio.factors if len(f) > 1)
    sign = ratio.map_factors(
        ratio.ring, lambda f: type(ratio).polynomial(ratio.ring, f + 2 * s**2 if f == first else f)
    )
    return -ratio, ratio * 2, ratio.filter(lambda f: f != first) * ratio.unit, sign


@pytest.mark.parametrize(
    "name", ["eppinger1988/two_mass.toml", "classics/clamped_free.toml", "frames/l_frame.toml"]
)
def test_a_wrong_sign_a_factor_and_a_lost_factor_are_noticed(name):
    tf = functions(name)[0]
    for ratio in wrong(tf):
        planted = replace(tf, reduced=ratio, closed=None, parts=(ratio.numerator(), ratio.denominator()))
        with pytest.raises(InternalError, match=r"SF991.*transfer function"):
            compare(tf.solve, [agreement(planted)])


def test_wrong_parts_of_a_function_are_noticed():
    tf = functions("classics/clamped_free.toml")[0]
    planted = replace(tf, parts=(tf.num * 2, tf.den))
    with pytest.raises(InternalError):
        compare(tf.solve, [agreement(planted)])


def test_a_mode_that_was_lost_is_noticed():
    tf = next(tf for tf in functions("eppinger1988/two_mass.toml") if tf.name == "X_act/F")
    text = Path(ROOT / "derivations/eppinger1988/two_mass.toml").read_text(encoding="utf-8")
    assert "hidden" not in text
    less = replace(tf, reduced=tf.ratio * 1, closed=None)
    wider = Agreement(("X_act", "F"), agreement(less).values, lambda _, known: known["s"] ** 3)
    with pytest.raises(InternalError, match="lost a mode"):
        compare(tf.solve, [wider])


def test_a_bound_function_is_compared_at_its_values():
    tf = functions("classics/clamped_free.toml")[0]
    values = {p.name: ExactValue(Fraction(k + 2, 3)) for k, p in enumerate(tf.model.parameters)}
    assert compare(tf.solve, [agreement(tf)], values) == ""
    shifted = Agreement(("W_tip", "F"), lambda *_: [acb(arb(1) / 7)])
    with pytest.raises(InternalError):
        compare(tf.solve, [shifted], values)

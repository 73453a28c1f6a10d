"""Exported ES modules, run in Node, against ball arithmetic."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from flint import acb, ctx

from symflex import pipeline
from symflex.codegen import export
from symflex.codegen.javascript import JAVASCRIPT
from symflex.codegen.program.band import is_closed
from symflex.transfer import bind
from tests.integration.node import Node
from tests.unit.codegen import hostile_names as hostile
from tests.unit.codegen.against_balls import axis_points, worst_errors
from tests.unit.codegen.exportable import DERIVATIONS, SPECS, derived, public_name
from tests.unit.codegen.hostile_names import mass_on_springs, with_prose
from tests.unit.codegen.test_band_form import STRING

ACCURACY = 1e-13

CANTILEVER = """
symflex = 1
parameters = { EI = "3 N*m^2", rhoA = "2 kg/m", l = "1.5 m" }
inputs     = { F = {} }
outputs    = { W = "w(l)" }

[fields.w]
domain     = ["0", "l"]
equation   = "EI*w'''' + rhoA*s^2*w = 0"
conditions = ["w(0) = 0", "w'(0) = 0", "w''(l) = 0", "EI*w'''(l) = -F"]
"""

pytestmark = pytest.mark.needs_tool("node")


@pytest.fixture
def node(tmp_path):
    return Node(tmp_path)


def asked(node, name, samples):
    """Write a module; return its closed functions with points and the keys of their values there."""
    model, tfs = derived(name)
    made = JAVASCRIPT.export(model, tfs, name, samples=samples)
    module = node.write(name, made.text)
    rows = []
    for tf, verified in zip(tfs, made.verified[: len(tfs)], strict=True):
        if verified.form == "band":
            continue  # away from the axis its error is larger, as its documentation says
        w = axis_points(tf, samples)
        s = np.concatenate([1j * w, w[::7] * np.exp(1j * np.linspace(-1.5, 1.5, len(w[::7])))])
        rows.append((tf, s, node.at(f"{module}.{public_name(tf)}", s)))
    return rows


def compared(node, rows):
    node.run()
    for tf, s, key in rows:
        assert worst_errors(tf, s, node.numbers(key))[0] <= ACCURACY, tf.name


def test_lumped_delayed_and_distributed_functions_agree_with_balls(node):
    names = ("two_mass", "chain", "delayed", "rod_tip_mass", "sliding_free_beam")
    compared(node, [row for name in names for row in asked(node, name, 20)])


@pytest.mark.slow
def test_every_derivation_with_a_closed_expression_agrees_with_balls(node):
    names = [n for n in (*DERIVATIONS, *SPECS) if all(map(is_closed, derived(n)[1]))]
    assert len(names) > 35
    compared(node, [row for name in names for row in asked(node, name, 30)])


def test_numerators_denominators_and_their_derivatives_agree_with_balls(node):
    # The logarithmic derivative of a quotient is N'/N - D'/D, whatever factor N and D share.
    parts = ("numerator", "numeratorDerivative", "denominator", "denominatorDerivative")
    rows = []
    for name in ("quarter_car", "delayed", "rod_tip_mass", "tension", "two_beams", "kelvin_voigt_cantilever"):
        model, (tf, *_) = derived(name)
        module = node.write(name, JAVASCRIPT.export(model, [tf], name, samples=5).text)
        w = 2 * np.pi * np.logspace(-1, 3, 23)
        s = np.concatenate([1j * w, w * np.exp(1j * np.linspace(-1.4, 1.4, len(w)))])
        call = f"{module}.{public_name(tf)}"
        rows.append((tf, s, [node.at(f"{call}.{part}", s) for part in parts]))
    node.run()
    for tf, s, keys in rows:
        enclosed = bind(tf).enclosed(300)
        above, rise, below, fall = map(node.numbers, keys)
        for i, point in enumerate(s.tolist()):
            with ctx.workprec(300):
                slope = complex(enclosed.logarithmic_derivative(acb(point.real, point.imag)).mid())
                value = complex(enclosed(acb(point.real, point.imag)).mid())
            assert abs(above[i] / below[i] / value - 1) < 1e-9, (tf.name, point)
            scale = max(abs(rise[i] / above[i]), abs(fall[i] / below[i]))
            assert abs(rise[i] / above[i] - fall[i] / below[i] - slope) < 1e-9 * scale, (tf.name, point)


def test_scalars_pairs_arrays_parameters_and_mistakes(node):
    model, tfs = derived("rod_tip_mass")
    module = node.write("rod", JAVASCRIPT.export(model, tfs, "rod", samples=5).text)
    tf = tfs[0]
    call = f'{module}.TRANSFER_FUNCTIONS["{tf.name}"]'
    pair, real, other = (node.keep(f"{call}({s})") for s in ("[3, 40]", "3", "[3, 40], { l: 0.7 }"))
    said = node.keep(
        f"[() => {call}(1, {{ q: 1 }}), () => {call}(1, {{ l: null }}), "
        f"() => {call}.numerator(1, {{ __proto__x: 1 }})]"
        ".map((f) => { try { return f(); } catch (e) { return `${e.name}: ${e.message}`; } })"
    )
    length = node.keep(f"{module}.PARAMETERS.l")
    node.run()
    for key, s, given in ((pair, 3 + 40j, {}), (real, 3, {}), (other, 3 + 40j, {"l": 0.7})):
        assert complex(*node.values[key]) == pytest.approx(bind(tf, given)(s), rel=1e-13)
    assert node.values[said] == [
        "RangeError: there is no parameter q",
        "TypeError: l needs a number as its value",
        "RangeError: there is no parameter __proto__x",
    ]
    assert node.values[length]["unit"] == "m"


def test_a_cantilever_is_what_its_equation_says(node):
    model = pipeline.loads(CANTILEVER)
    module = node.write(
        "plain", JAVASCRIPT.export(model, pipeline.derive_all(model), "plain", samples=5).text
    )
    s = np.array([1e-3j, 0.4 + 3j, -2 + 90j])
    key = node.at(f"{module}.W_over_F", s)
    node.run()
    # EI w'''' = b^4 EI w with w, w' = 0 at the root and w'' = 0, EI w''' = -F at the tip.
    b = (-2 * s**2 / 3) ** 0.25
    sine, cosine, sinh, cosh = (f(1.5 * b) for f in (np.sin, np.cos, np.sinh, np.cosh))
    expected = (sine * cosh - cosine * sinh) / (3 * b**3 * (1 + cosine * cosh))
    assert np.max(np.abs(node.numbers(key) / expected - 1)) < 1e-11


def test_a_band_form_is_the_function_of_its_band(node):
    # A string whose end is moved: its other end follows by 1/cosh(s l/c), c = sqrt(1000) m/s.
    model = pipeline.loads(STRING)
    language = replace(JAVASCRIPT, form="band", up_to=Fraction(1000))
    made = language.export(model, pipeline.derive_all(model), "string", samples=30)
    module = node.write("string", made.text)
    s = 2j * np.pi * np.linspace(1.0, 900.0, 41)
    key = node.at(f"{module}.end_over_u", s)
    node.run()
    expected = 1 / np.cosh(s / np.sqrt(1000))
    assert np.max(np.abs(node.numbers(key) / expected - 1)) < 1e-11


def test_one_module_for_all_hostile_names_loads_and_gives_the_right_value(node, monkeypatch):
    monkeypatch.setattr(export, "formula_of", lambda tf: (tf.name,))  # no name of these can be read back
    names = tuple(dict.fromkeys([*hostile.JAVASCRIPT, *hostile.ODD]))
    model = mass_on_springs(names)
    prose = with_prose(model, "*/ process.exit(1); /* </script><script>alert(1)</script> <!-- `${1/0}`")
    tfs = [replace(tf, model=prose) for tf in pipeline.derive_all(model)]
    text = JAVASCRIPT.export(prose, tfs, "plant", samples=3).text
    assert "</script" not in text and "<!--" not in text
    module = node.write("plant", text)
    count = node.keep(f"Object.keys({module}.PARAMETERS).length")
    key = node.keep(f"Object.values({module}.TRANSFER_FUNCTIONS)[0]([-5, 3])")
    node.run()
    assert node.values[count] == len(model.parameters)
    assert complex(*node.values[key]) == pytest.approx(bind(tfs[0])(-5 + 3j), rel=1e-13)

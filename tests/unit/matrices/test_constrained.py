"""Models of one input and output that stand for a matrix, compared with solves by numpy."""

from __future__ import annotations

import re

import numpy as np
import pytest

from symflex.expressions import format_expression
from symflex.matrices.constrained import closed, closed_at_once, driven_at_once, imposed
from symflex.model import Model
from symflex.roots.locate import locate
from symflex.roots.passivity import energy_proof
from symflex.transfer.of_model import derive_for_roots
from tests.unit.matrices.models import TWO_MASSES, model_of

S = 0.3 + 1.7j
STIFFNESS = np.array([[2 * S**2 + 50, -20], [-20, S**2 + 20]], complex)  # of TWO_MASSES: K + M s^2


def weights_of(model: Model, what: str) -> list[int]:
    """Return the numbers in the sum that is read, or of what is given in the laws about a name."""
    expressions = [o.expression for o in model.outputs]
    texts = [format_expression(e) for e in (expressions[:1] if what == "sum" else expressions[1:])]
    if what == "sum":
        return [int(n) for n in re.findall(r"(\d+)\*", texts[0])]
    return [int(found[1]) for text in texts if (found := re.match(rf"{what}_\d - (\d+)\*", text))]


def value(model: Model) -> complex:
    (bound,) = derive_for_roots(model, model.transfer_functions[:1])
    return bound(S)


def test_one_input_drives_all_and_one_output_sums_all() -> None:
    model = driven_at_once(model_of(TWO_MASSES), ["X_1", "X_2"], ["F_1", "F_2"])
    into, out = weights_of(model, "F"), weights_of(model, "sum")
    expected = np.array(out) @ np.linalg.inv(STIFFNESS) @ np.array(into)
    assert abs(value(model) - expected) < 1e-12 * abs(expected)


def test_inputs_that_impose_outputs_are_the_inverse() -> None:
    model = imposed(model_of(TWO_MASSES), [("X_1", "F_1"), ("X_2", "F_2")])
    into, out = weights_of(model, "x"), weights_of(model, "sum")
    expected = np.array(out) @ STIFFNESS @ np.array(into)
    assert abs(value(model) - expected) < 1e-12 * abs(expected)


def test_names_that_are_taken_are_not_taken_again() -> None:
    text = TWO_MASSES.replace("X_1 =", "matrix_0 =").replace("x_2", "matrix_1")
    model = imposed(model_of(text), [("matrix_0", "F_1")])
    assert [each.name for each in (model.inputs[0], model.outputs[0])] == ["matrix_2", "matrix_3"]


def test_what_imposes_outputs_supplies_energy() -> None:
    model = imposed(model_of(TWO_MASSES), [("X_1", "F_1")])
    assert energy_proof(model_of(TWO_MASSES)).is_passive
    assert not energy_proof(model).is_passive


def test_loops_closed_with_minus_have_s_t_and_their_difference() -> None:
    model, given, read = closed(model_of(TWO_MASSES), [("X_1", "F_1"), ("X_2", "F_2")])
    sensitivity = np.linalg.inv(np.eye(2) + np.linalg.inv(STIFFNESS))
    expected = np.vstack([sensitivity, np.eye(2) - sensitivity, 2 * sensitivity - np.eye(2)])
    bound = derive_for_roots(model, [(y, u) for y in read for u in given])
    found = np.array([f(S) for f in bound]).reshape(6, 2)
    assert abs(found - expected).max() < 1e-12


def test_loops_closed_at_once_have_the_poles_of_all() -> None:
    # With weights r of what is given and q of what is read: q^T (1 + P)^-1 r.
    model = closed_at_once(model_of(TWO_MASSES), [("X_1", "F_1"), ("X_2", "F_2")])
    into = [
        int(n) for o in model.outputs[1:] for n in re.findall(r"- (\d+)\*", format_expression(o.expression))
    ]
    expected = np.array(weights_of(model, "sum")) @ np.linalg.solve(
        np.eye(2) + np.linalg.inv(STIFFNESS), into
    )
    assert abs(value(model) - expected) < 1e-12 * abs(expected)
    (bound,) = derive_for_roots(model, model.transfer_functions[:1])
    # On the axis: det(K + 1 - M w^2) = (51 - 2 x)(21 - x) - 400.
    roots = sorted(float(r.im.mid()) ** 2 for r in locate(bound, digits=12).poles if r.im > 0)
    assert roots == pytest.approx(np.sort(np.roots([2, -93, 671]).real))

"""The band in which two outputs move together."""

from __future__ import annotations

import math

import pytest
from flint import arb

import symflex
from symflex.errors import UsageError
from symflex.loops import DynamicColocation, of_model
from symflex.options import ColocationOptions
from tests.unit.refusals import refusal

MASSES = {
    "a": {"type": "mass", "at": "x", "m": "1 kg"},
    "k": {"type": "spring", "between": ["x", "y"], "k": "4 N/m"},
    "c": {"type": "damper", "between": ["x", "y"], "b": "0.5 N*s/m"},
    "b": {"type": "mass", "at": "y", "m": "1 kg"},
}


def model(**more):
    elements = {**MASSES, **more}
    return symflex.Model(
        elements=elements,
        inputs={"F": {"force": "x"}, "G": {"force": "y"}},
        outputs={"X": "x", "Y": "y", "Zero": "0*x"},
        analysis={"band": ["0.001 Hz", "1 Hz"]},
    )


def ratio(omega):
    return (4 + 0.5j * omega) / (4 + 0.5j * omega - omega**2)


def test_the_edge_is_where_the_ratio_leaves_the_sector():
    for phase, magnitude, cause in ((10, 1, "magnitude"), (1, 20, "phase")):
        found = model().colocation("Y", "X", "F", phase=phase, magnitude=magnitude)
        omega = float(found.edge.mid())
        assert found.is_decided
        assert found.cause == cause
        value = ratio(omega)
        if cause == "magnitude":
            assert abs(20 * math.log10(abs(value)) - magnitude) < 1e-9
        else:
            assert abs(abs(math.degrees(math.atan2(value.imag, value.real))) - phase) < 1e-9
        # Not before.
        for share in (0.1, 0.5, 0.9, 0.999):
            inside = ratio(omega * share)
            assert abs(20 * math.log10(abs(inside))) < magnitude, (cause, share)
            assert abs(math.degrees(math.atan2(inside.imag, inside.real))) < phase, (cause, share)


def test_an_output_is_colocated_with_itself():
    found = model().colocation("X", "X", "F")
    assert found.edge is None
    assert found.begins
    assert "all that was examined" in str(found)


def test_outputs_that_are_never_together():
    found = model().colocation("Y", "X", "F", band=(10, 100))
    assert not found.begins
    assert "where the search begins" in str(found)


def test_what_has_no_band_is_refused():
    colocation = model().colocation
    bare = symflex.Model(elements=MASSES, inputs={"F": {"force": "x"}}, outputs={"X": "x", "Y": "y"})
    assert refusal(colocation, "Y", "X", "F", phase=0) == "UsageError SF805"
    assert refusal(colocation, "Y", "X", "F", magnitude=-1) == "UsageError SF805"
    assert refusal(colocation, "Zero", "X", "F") == "ModelError SF402"
    assert refusal(bare.colocation, "Y", "X", "F") == "UsageError SF804"
    options = ColocationOptions("Y/F", "X/G")  # of two inputs
    assert refusal(of_model.colocation, model().resolved, options) == "UsageError SF805"


def test_metres_are_not_compared_with_radians():
    beam = symflex.loads("""
symflex = 1
elements.body = { type = "rigid_body", at = "p", m = 1, J = 2 }
elements.k = { type = "spring", between = ["p.y", "ground"], k = 3 }
elements.t = { type = "torsion_spring", between = ["p.theta", "ground"], k = 3 }
elements.link = { type = "rigid_body", at = "p", m = 1, cg = 1 }
inputs.F = { force = "p.y" }
outputs.X = "p.y"
outputs.Phi = "p.theta"
""")
    with pytest.raises(UsageError, match="SF805"):
        beam.colocation("Phi", "X", "F", band=(0.1, 1))


def test_a_sentence_never_lacks_what_differs_and_says_what_is_not_certified():
    for begins, is_decided in [(True, False), (False, False), (True, True)]:
        found = DynamicColocation("a/u", "b/u", 10, 1, (1, 2), arb(7), is_decided, "", begins)
        assert "  " not in str(found), (begins, is_decided)
        assert ("NOT CERTIFIED" in str(found)) is not is_decided, (begins, is_decided)

"""The phase of a distributed system from its roots on the axis, against the one that is followed along it."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from symflex import pipeline
from symflex.analysis.response import follow_phase, roots_if_found
from symflex.roots import Band
from tests.house.repository import ROOT

BAND = Band(Fraction(1), Fraction(200))
OMEGA = 2 * np.pi * np.geomspace(1.0, 200.0, 60)


def bound_and_roots(name):
    model = pipeline.load(ROOT / "derivations" / "classics" / f"{name}.toml")
    (bound,) = pipeline.derive_for_roots(model, model.transfer_functions[:1])
    return bound, roots_if_found(bound, BAND)


@pytest.mark.slow
def test_without_losses_it_turns_by_half_a_turn_at_each_root():
    for name in ("clamped_free", "sliding_sliding"):
        bound, roots = bound_and_roots(name)
        resonances = [float(root.im.mid()) for root in roots.poles if root.im > 0]
        assert roots.certificate.certified, name
        assert len(resonances) > 1, name
        omega = np.sort(np.concatenate([OMEGA, *(np.multiply(resonances, near) for near in (0.999, 1.001))]))
        np.testing.assert_allclose(
            follow_phase(bound, omega, roots), follow_phase(bound, omega), atol=1e-9, err_msg=name
        )


@pytest.mark.slow
def test_roots_that_are_not_all_in_reach_do_not_matter():
    bound, roots = bound_and_roots("clamped_free")
    expected = follow_phase(bound, OMEGA)
    for unusable in (
        replace(roots, poles=(), region=Band(Fraction(1), Fraction(199))),
        replace(roots, poles=(), region=Band(Fraction(2), Fraction(200))),
        replace(roots, poles=(), certificate=replace(roots.certificate, reason="no")),
    ):
        np.testing.assert_array_equal(follow_phase(bound, OMEGA, unusable), expected)


def test_with_losses_roots_do_not_matter():
    bound, roots = bound_and_roots("kelvin_voigt_cantilever")
    wrong = replace(roots, poles=())
    np.testing.assert_array_equal(follow_phase(bound, OMEGA, wrong), follow_phase(bound, OMEGA))

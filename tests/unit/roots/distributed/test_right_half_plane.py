"""Poles in the right half plane: counted and listed wherever they lie, or it is said why not."""

from fractions import Fraction

import mpmath
import pytest

from symflex import pipeline
from symflex.print.roots import roots_text
from symflex.roots import Band, Everything, Mode, Modes, PoleZeroMap, Rectangle
from symflex.roots.distributed.far_out import Tail
from symflex.roots.pole_zero_map import StabilityVerdict

HAYES = """
symflex = 1
blocks.D = {{ type = "delay", T = "1 s" }}
inputs.r = {{}}
signals.y = "{gain}*D/s*(r - y)"
outputs.Y = "y"
"""
LUMPED = """
symflex = 1
inputs.u = {}
outputs.y = "u/((s + 1)*(s + 2)*((s - 1/2)^2 + 10000))"
"""
ROD = """
symflex = 1
elements.rod = { type = "rod", between = ["ground", "x"], E = 1, A = 1, rho = 1, l = 1 }
"""
DAMPER = 'elements.b = {{ type = "damper", between = ["x", "ground"], b = "{b}" }}'
FORCE = """
inputs.F = { force = "x" }
outputs.X = "x"
"""


def found(text: str, region=None, *, index=0) -> PoleZeroMap:
    model = pipeline.loads(text)
    return pipeline.roots(pipeline.derive_bound(model, model.transfer_functions)[index], region)


def unstable_by_lambert(gain):
    """The roots of s + K exp(-s) are W(-K), one a branch; five branches reach far enough here."""
    every = [mpmath.lambertw(-gain, k) for k in range(-5, 6)]
    return sorted((s for s in every if s.real > 0), key=lambda s: (abs(s.imag), s.imag))


@pytest.mark.parametrize(("gain", "count"), [(1, 0), (2, 2), (7, 2), (10, 4), (20, 6)])
def test_an_integrator_with_dead_time_has_as_many_as_hayes_counts(gain, count):
    # Hayes 1950: a pair enters as K T passes (2 n + 1/2) pi.
    verdict = found(HAYES.format(gain=gain)).verdict
    assert (verdict.right, verdict.certified) == (count, True)
    assert verdict.word == ("unstable" if count else "stable")


@pytest.mark.parametrize("region", [Modes(1), Mode(3), Band(0, 1), Rectangle(-9, -1, 0, 1)], ids=str)
def test_whatever_is_asked_for_the_unstable_poles_of_a_delay_are_those_of_lambert(region):
    poles = found(HAYES.format(gain=10), region).all_poles
    right = [mpmath.mpc(float(p.re.mid()), float(p.im.mid())) for p in poles if p.re > 0]
    expected = unstable_by_lambert(10)
    right.sort(key=lambda s: (round(abs(s.imag), 6), s.imag))
    assert len(right) == len(expected) == 4
    assert max(abs(a - b) for a, b in zip(right, expected, strict=True)) < 1e-12


@pytest.mark.slow
def test_by_default_they_are_among_the_poles():
    shown = found(HAYES.format(gain=200))
    assert sum(bool(p.re > 0) for p in shown.poles) == len(unstable_by_lambert_of_many(200))
    assert shown.unstable == ()


def unstable_by_lambert_of_many(gain):
    return [s for k in range(-90, 91) if (s := mpmath.lambertw(-gain, k)).real > 0]


@pytest.mark.parametrize("region", [Modes(2), Mode(1), Band(0, 1), Rectangle(-9, -1, 0, 1)], ids=str)
def test_of_a_lumped_system_those_outside_of_what_is_asked_for_are_a_part_of_their_own(region):
    shown = found(LUMPED, region)
    assert not any(p.re > 0 for p in shown.poles)
    assert [(float(p.re.mid()), float(p.im.mid())) for p in shown.unstable] == [(0.5, 100), (0.5, -100)]
    assert "in the right half plane, outside of what was asked for" in roots_text(shown, 15)


def test_everything_holds_them_all():
    assert found(LUMPED, Everything()).unstable == ()


def test_the_first_line_says_unstable():
    assert roots_text(found(LUMPED), 15).splitlines()[0].endswith("; unstable")


def test_an_unstable_mode_that_cancels_is_listed_and_counted():
    text = 'symflex = 1\ninputs.u = {}\nsignals.x = "u/(s - 3)"\noutputs.y = "(s - 3)*x/(s + 1)"'
    shown = found(text, Band(0, Fraction(1, 5)))
    assert shown.verdict.right == 1
    assert [float(h.root.re.mid()) for h in shown.hidden] == [3.0]


@pytest.mark.parametrize(
    ("den", "word"), [("s + 1", "stable"), ("s", "marginal"), ("s^2 + 4", "marginal"), ("s - 1", "unstable")]
)
def test_a_pole_on_the_axis_is_not_asymptotically_stable(den, word):
    assert found(f'symflex = 1\ninputs.u = {{}}\noutputs.y = "u/({den})"').verdict.word == word


def test_an_advanced_loop_has_no_end_of_unstable_poles_and_says_so():
    # 1 + s exp(-s): roots of s = -exp(s), without end to the right (Bellman & Cooke 1963, section 12.12).
    text = 'symflex = 1\nblocks.D = { type = "delay", T = 1 }\ninputs.u = {}\noutputs.y = "u/(1 + s*D)"'
    verdict = found(text).verdict
    assert (verdict.word, verdict.right) == ("unstable", None)
    assert "have no end" in verdict.reason


def test_a_neutral_loop_whose_delayed_part_is_the_smaller_is_counted():
    # s (1 + exp(-s)/2) + 1: stable, as 1/2 < 1 and Re s >= 0 leaves abs(s) <= 2, where no root is.
    text = 'symflex = 1\nblocks.D = { type = "delay", T = 1 }\ninputs.u = {}\noutputs.y = "u/(s + s*D/2 + 1)"'
    verdict = found(text).verdict
    assert (verdict.word, verdict.right, verdict.certified) == ("stable", 0, True)


def test_a_critical_neutral_loop_is_not_known():
    # s (1 + exp(-s)) + 1: its roots come closer to the axis without end.
    text = 'symflex = 1\nblocks.D = { type = "delay", T = 1 }\ninputs.u = {}\noutputs.y = "u/(s + s*D + 1)"'
    verdict = found(text).verdict
    assert verdict.right is None
    assert "have no end" in verdict.reason


NEGATIVE_MASS = """
elements.m = { type = "mass", at = "x", m = "m" }
parameters.m = { value = "-0.2 kg", assume = "real" }
"""


@pytest.mark.parametrize("region", [None, Band(0, Fraction(1, 100)), Mode(1)], ids=str)
def test_a_pole_that_grows_without_losses_is_found_above_what_was_asked_for(region):
    # Of impedance 1, ended by -m s^2 with m = 1/5: coth(s) = s/5.
    verdict = found(ROD + NEGATIVE_MASS + FORCE, region)
    right = [float(p.re.mid()) for p in verdict.all_poles if p.re > 0]
    assert right == pytest.approx([float(mpmath.findroot(lambda s: mpmath.coth(s) - s / 5, 5))])
    assert verdict.verdict.word == "unstable"


def test_without_proof_of_what_lies_beyond_poles_on_the_axis_are_no_verdict():
    # What acts at the end is told by the middle: no energy is conserved.
    field = """
symflex = 1
inputs.F = {}
outputs.U = "u(1)"
[fields.u]
domain = ["0", "1"]
equation = "u'' = s^2*u"
conditions = ["u(0) = 0", "u'(1) = F - u(1/2)/10"]
"""
    verdict = found(field).verdict
    assert (verdict.word, verdict.right, verdict.certified) == ("unknown", None, False)
    assert verdict.reason.startswith("poles on the imaginary axis; known up to")


def test_a_part_not_told_from_zero_is_not_printed_as_zero():
    # s + pi/2 exp(-s) has the roots +-j pi/2, exactly (Hayes 1950), which no enclosure can tell.
    root = found(HAYES.format(gain="pi/2"), Modes(1)).poles[0]
    assert root.decimal(15).re.startswith("0e-")
    assert "  ~0" in roots_text(found(HAYES.format(gain="pi/2"), Modes(1)), 15)


def test_a_passive_structure_is_marginal_by_its_energy():
    verdict = found(ROD + FORCE).verdict
    assert (verdict.word, verdict.right, verdict.certified) == ("marginal", 0, True)
    assert "passive" in verdict.reason


@pytest.mark.parametrize(("b", "word"), [("3 N*s/m", "stable"), ("0 N*s/m", "marginal")])
def test_a_passive_structure_has_no_pole_right_of_the_axis_with_a_damper(b, word):
    verdict = found(ROD + DAMPER.format(b=b) + FORCE).verdict
    assert (verdict.word, verdict.right) == (word, 0)


def test_a_negative_damper_is_not_passive_and_its_rod_unstable():
    # Of impedance 1, ended by -3: cosh s - 3 sinh s = 0, so exp(2 s) = 2 and all poles have Re s = ln(2)/2.
    shown = found(ROD + DAMPER.format(b="-3 N*s/m") + FORCE)
    assert shown.verdict.word == "unstable"
    right = [float(p.re.mid()) for p in shown.poles if p.re > 0]
    assert right
    assert right == pytest.approx([0.34657359027997264] * len(right))


def test_what_is_not_proved_cannot_be_without_a_reason():
    with pytest.raises(ValueError, match="reason"):
        StabilityVerdict("unknown", None, certified=False)


@pytest.mark.parametrize("given", [(None, ""), (1.0, "why")])
def test_a_tail_has_either_a_radius_or_a_reason(given):
    with pytest.raises(ValueError, match="either"):
        Tail(*given)

"""Poles in the right half plane: counted and listed wherever they lie, or it is said why not."""

from fractions import Fraction

import mpmath
import pytest

from symflex import pipeline
from symflex.print.roots import roots_text
from symflex.roots import Band, Mode, Modes, PoleZeroMap, Rectangle

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


def test_an_integrator_with_dead_time_has_as_many_as_hayes_counts():
    # Hayes 1950: a pair enters as K T passes (2 n + 1/2) pi.
    for gain, count in ((1, 0), (2, 2), (10, 4)):
        verdict = found(HAYES.format(gain=gain)).verdict
        assert (verdict.right, verdict.certified) == (count, True), gain
        assert verdict.word == ("unstable" if count else "stable"), gain


@pytest.mark.slow
def test_whatever_is_asked_for_the_unstable_poles_of_a_delay_are_those_of_lambert():
    expected = unstable_by_lambert(10)
    for region in (Modes(1), Mode(3), Band(0, 1), Rectangle(-9, -1, 0, 1)):
        poles = found(HAYES.format(gain=10), region).all_poles
        right = [mpmath.mpc(float(p.re.mid()), float(p.im.mid())) for p in poles if p.re > 0]
        right.sort(key=lambda s: (round(abs(s.imag), 6), s.imag))
        assert len(right) == len(expected) == 4, region
        assert max(abs(a - b) for a, b in zip(right, expected, strict=True)) < 1e-12, region


def test_of_a_lumped_system_those_outside_of_what_is_asked_for_are_a_part_of_their_own():
    for region in [Modes(2), Mode(1), Band(0, 1), Rectangle(-9, -1, 0, 1)]:
        shown = found(LUMPED, region)
        assert not any(p.re > 0 for p in shown.poles), region
        assert [(float(p.re.mid()), float(p.im.mid())) for p in shown.unstable] == [
            (0.5, 100),
            (0.5, -100),
        ], region
        assert "in the right half plane, outside the region asked for" in roots_text(shown, 15), region


def test_an_unstable_mode_that_cancels_is_listed_and_counted():
    text = 'symflex = 1\ninputs.u = {}\nsignals.x = "u/(s - 3)"\noutputs.y = "(s - 3)*x/(s + 1)"'
    shown = found(text, Band(0, Fraction(1, 5)))
    assert shown.verdict.right == 1
    assert [float(h.root.re.mid()) for h in shown.hidden] == [3.0]


def test_a_pole_on_the_axis_is_not_asymptotically_stable():
    for den, word in [("s + 1", "stable"), ("s", "marginal"), ("s^2 + 4", "marginal"), ("s - 1", "unstable")]:
        assert found(f'symflex = 1\ninputs.u = {{}}\noutputs.y = "u/({den})"').verdict.word == word


@pytest.mark.slow
def test_loops_whose_delayed_part_is_differentiated_are_counted_only_where_it_is_the_smaller():
    for den, expected in [
        # Roots of s = -exp(s), without end to the right (Bellman & Cooke 1963, section 12.12).
        ("1 + s*D", ("unstable", None, True)),
        # s (1 + exp(-s)/2) + 1: stable, as 1/2 < 1 and Re s >= 0 leaves abs(s) <= 2, where no root is.
        ("s + s*D/2 + 1", ("stable", 0, True)),
        # s (1 + exp(-s)) + 1: its roots come closer to the axis without end.
        ("s + s*D + 1", ("unknown", None, False)),
    ]:
        text = 'symflex = 1\nblocks.D = { type = "delay", T = 1 }\ninputs.u = {}\n'
        verdict = found(f'{text}outputs.y = "u/({den})"').verdict
        assert (verdict.word, verdict.right, verdict.certified) == expected, den
        assert ("infinitely many" in verdict.reason) is (verdict.word == "unstable"), den
        assert ("have no bound" in verdict.reason) is (verdict.word == "unknown"), den


NEGATIVE_MASS = """
elements.m = { type = "mass", at = "x", m = "m" }
parameters.m = { value = "-0.2 kg", assume = "real" }
"""


def test_a_pole_that_grows_without_losses_is_found_above_what_was_asked_for():
    for region in [None, Band(0, Fraction(1, 100)), Mode(1)]:
        # Of impedance 1, ended by -m s^2 with m = 1/5: coth(s) = s/5.
        verdict = found(ROD + NEGATIVE_MASS + FORCE, region)
        right = [float(p.re.mid()) for p in verdict.all_poles if p.re > 0]
        assert right == pytest.approx([float(mpmath.findroot(lambda s: mpmath.coth(s) - s / 5, 5))]), region
        assert verdict.verdict.word == "unstable", region


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
    shown = found(HAYES.format(gain="pi/2"), Modes(1))
    assert shown.poles[0].decimal(15).re.startswith("0e-")
    assert "  ~0" in roots_text(shown, 15)


@pytest.mark.slow
def test_a_passive_structure_has_no_pole_right_of_the_axis_with_and_without_a_damper():
    for b, word in ((None, "marginal"), ("3 N*s/m", "stable"), ("0 N*s/m", "marginal")):
        verdict = found(ROD + (DAMPER.format(b=b) if b else "") + FORCE).verdict
        assert (verdict.word, verdict.right, verdict.certified) == (word, 0, True), b
        assert "passive" in verdict.reason, b


def test_a_negative_damper_is_not_passive_and_its_rod_unstable():
    # Of impedance 1, ended by -3: cosh s - 3 sinh s = 0, so exp(2 s) = 2 and all poles have Re s = ln(2)/2.
    shown = found(ROD + DAMPER.format(b="-3 N*s/m") + FORCE)
    assert shown.verdict.word == "unstable"
    right = [float(p.re.mid()) for p in shown.poles if p.re > 0]
    assert right
    assert right == pytest.approx([0.34657359027997264] * len(right))


LOSSY_ARM = """
symflex = 1
inputs.F = { force = "x" }
[elements]
wall = { type = "fixed", at = "root" }
arm = { type = "beam", between = ["root", "x"], EI = 1, rhoA = 1, l = 1, eta = 0.01 }
"""
OWN = {  # {} stands for s - a or s + a
    "a quotient": ("", "x/({})"),
    "a definition": ('definitions.C = "1/({})"', "x*(1 + C)"),
    "a block": ('blocks.P = {{ type = "tf", num = [1], den = "{}" }}', "P*x"),
    "a signal": ('signals.u = "x/({})"', "u"),
}


@pytest.mark.parametrize(
    "kind", [pytest.param(kind, marks=[pytest.mark.slow] * (kind != "a quotient")) for kind in OWN]
)
@pytest.mark.parametrize("den", ["s - 100", "s + 100"])
def test_a_passive_structure_says_nothing_of_poles_that_its_output_adds(kind, den):
    line, output = (part.format(den) for part in OWN[kind])
    shown = found(LOSSY_ARM.replace("[elements]", f'{line}\noutputs.X = "{output}"\n[elements]'), Modes(1))
    right = [100] if "-" in den else []
    assert [float(p.re.mid()) for p in shown.unstable] == right
    assert (shown.verdict.word, shown.verdict.right) == ("unstable" if right else "stable", len(right))


@pytest.mark.slow
@pytest.mark.parametrize("drive", ["u/(s - 100)", "C*u"])
def test_a_passive_structure_says_nothing_of_poles_of_what_drives_it(drive):
    text = LOSSY_ARM.replace('F = { force = "x" }', "u = {}")
    text = text.replace("[elements]", 'definitions.C = "1/(s - 100)"\noutputs.X = "x"\n[elements]')
    shown = found(text + f'push = {{ type = "force_source", at = "x", f = "{drive}" }}\n', Modes(1))
    assert [float(p.re.mid()) for p in shown.unstable] == [100]


def test_delays_in_an_output_are_no_part_of_what_is_passive():
    # 1 + 2 exp(-s) vanishes at ln 2 + j pi (2 n + 1), all along a line right of the axis.
    text = 'symflex = 1\nblocks.D = { type = "delay", T = 1 }\ninputs.u = {}\noutputs.y = "u/(1 + 2*D)"'
    verdict = found(text, Modes(2)).verdict
    assert (verdict.word, verdict.right) == ("unstable", None)


STRINGS = """
symflex = 1
inputs.F = { force = "c" }
outputs.X = "c"
elements.one = { type = "string", between = ["ground", "a"], N = 1, rhoA = 1, l = 0.3 }
elements.two = { type = "string", between = ["a", "c"], N = 1, rhoA = 1, l = 0.15 }
elements.three = { type = "string", between = ["c", "ground"], N = 1, rhoA = 1, l = 0.55 }
elements.loss = { type = "damper", between = ["a", "ground"], b = 0.5 }
"""


def test_a_mode_above_those_shown_that_no_damper_feels_keeps_a_passive_structure_from_being_stable():
    # The modes of a string of length 1 are sin(n pi x): the tenth rests at x = 0.3, and moves at x = 0.45.
    verdict = found(STRINGS, Modes(2)).verdict
    assert (verdict.word, verdict.right, verdict.certified) == ("unknown", 0, False)
    # At the end of a rod every mode feels it.
    damped = ROD + DAMPER.format(b=0.5) + FORCE
    assert found(damped, Modes(1)).verdict.sentence == "stable: passive, nothing supplies energy"


@pytest.mark.slow
def test_a_voltage_that_follows_a_motion_may_supply_energy():
    # An inductor is an integral of the motion then: m s^2 + n^2/(L s) and a rod's s coth(s) have zeros there.
    text = (
        ROD
        + FORCE
        + """
elements.body = { type = "mass", at = "x", m = 1 }
elements.pickup = { type = "transformer", from = "x", to = "v", ratio = 1 }
elements.coil = { type = "inductor", between = ["v", "ground"], L = 1 }
"""
    )
    grows = mpmath.findroot(lambda s: s**2 + s * mpmath.coth(s) + 1 / s, 0.3 + 0.9j)
    assert grows.real > 0
    verdict = found(text, Modes(1))
    assert verdict.verdict.word == "unstable"
    assert any(abs(complex(p.re.mid(), p.im.mid()) - complex(grows)) < 1e-9 for p in verdict.all_poles)
    assert "passive" not in verdict.verdict.reason


def test_a_force_that_follows_a_point_of_a_member_is_no_passive_one():
    # sinh(s l)/s of the rod, cosh(s) + K sinh(s/2)/s = 0: with K = -3 a root lies where they meet.
    text = (
        ROD
        + FORCE
        + """
parameters = { K = "3 N/m", x_s = "0.5 m" }
elements.loop = { type = "force_source", at = "x", f = "K*rod.u(x_s)" }
"""
    )
    grows = mpmath.findroot(lambda s: s * mpmath.cosh(s) - 3 * mpmath.sinh(s / 2), 1)
    verdict = found(text, Modes(1))
    assert verdict.verdict.word == "unstable"
    assert "passive" not in verdict.verdict.reason
    assert any(abs(p.re.mid() - float(grows)) < 1e-9 for p in verdict.all_poles)
    # A force of the other sign has no root there, but neither is it a spring.
    verdict = found(text.replace('"K*rod', '"-K*rod'), Modes(1)).verdict
    assert (verdict.word, verdict.certified) == ("unknown", False)


MOVING = """
symflex = 1
inputs.F = {{ unit = "N" }}
outputs.Y = "w(1/3)"
[fields.w]
domain = [0, 1]
equation = "s^2*w + 4*s*w' + 4*w'' = 25*w''"
conditions = ["w(0) = 0", "25*w'(1) + {damping}*s*w(1) = F"]
"""


def test_a_string_that_moves_is_damped_where_what_its_end_reflects_is_smaller():
    """Waves at speeds 5 + 2 and 5 - 2: their quotient, abs((d - 25/7)/(d + 25/3)), is 1 for d = -50/21."""
    for damping, is_stable in ((3, True), (0, True), (-2.3, True), (-2.5, False)):
        poles = mpmath.log(abs((damping - 25 / 7) / (damping + 25 / 3))) / (1 / 7 + 1 / 3)
        assert (poles < 0) is is_stable
        shown = found(MOVING.format(damping=damping), Modes(1))
        assert all(float(p.re.mid()) == pytest.approx(float(poles)) for p in shown.poles if not p.is_real)
        assert (shown.verdict.word == "stable") is is_stable, damping


EXCHANGER = """
symflex = 1
inputs.T_0 = {{}}
outputs.Y = "T(2)"
[fields.pipe]
unknowns = ["T", "W"]
domain = [0, 2]
equations = ["T' + s*T + {h}*(T - W) = 0", "-W' + s*W + {h}*(W - T) = 0"]
conditions = ["T(0) = T_0", "W(2) = 0"]
"""


def test_counterflow_is_stable_but_where_heat_flows_to_what_is_warmer():
    """With k^2 = (s + h)^2 - h^2 at poles cosh(2 k) + (s + h) sinh(2 k)/k = 0; of h = -2 one is real."""
    assert found(EXCHANGER.format(h=0.3), Modes(1)).verdict.word == "stable"
    warmed = found(EXCHANGER.format(h=-2), Modes(1))
    assert warmed.verdict.word == "unstable"
    (low, high) = (
        (mpmath.cosh(2 * k) + (s - 2) * mpmath.sinh(2 * k) / k).real
        for s in (3.5, 3.9)
        for k in [mpmath.sqrt((s - 2) ** 2 - 4)]
    )
    assert low < 0 < high

"""Poles, zeros and hidden modes of networks against closed forms and published values."""

from fractions import Fraction
from itertools import pairwise
from math import log, pi, sqrt

import numpy as np
import pytest

from symflex import pipeline
from symflex.balls import UndecidedError, opposite
from symflex.roots.locate import locate
from symflex.roots.networks import poles_zeros
from symflex.roots.region import Band, Mode, Modes, Rectangle
from symflex.transfer.nested_form import bind_nested
from tests.unit.roots.networks.network_models import BEAM, located, omegas, specification

UNIT = sqrt(700 / 0.27)
"""sqrt(E I/(rho A)) of the beam [m^2/s]."""
FREE = (4.730040744862704, 7.853204624095838, 10.995607838001671, 14.137165491257464)
"""beta*l of a beam with free ends (Timoshenko, Young & Weaver 1974)."""
CLAMP = 'c = { type = "fixed", at = "n_0" }'
CANTILEVER = (1.8751040687119611, 4.694091132974175, 7.854757438237613, 10.995540734875467)


def spans(count, supports, length="0.5 m"):
    """Return equal beams in a row, with supports at nodes."""
    rows = [f'b_{i} = {{ {BEAM}, between = ["n_{i}", "n_{i + 1}"], l = "{length}" }}' for i in range(count)]
    rows += [f's_{i} = {{ type = "{kind}", at = "n_{i}" }}' for i, kind in supports.items()]
    return "\n".join(rows)


def test_a_cantilever_in_pieces_has_the_frequencies_of_one():
    for count in (1, 2, 4):
        tip = f"n_{count}"
        text = specification(spans(count, {0: "fixed"}), f'F = {{ force = "{tip}" }}', f'X = "{tip}"')
        found = located(text)
        assert found.certificate.certified, count
        expected = [(b / (0.5 * count)) ** 2 * UNIT for b in CANTILEVER]
        assert omegas(found.poles) == pytest.approx(expected, rel=1e-11), count


def test_both_poles_of_a_pair_have_the_digits_asked_for():
    text = specification(spans(2, {0: "fixed"}), 'F = { force = "n_2" }', 'X = "n_2"')
    pair = [root.im for root in located(text, Modes(1), 40).poles]
    assert [bool(im.rel_accuracy_bits() > 130) for im in pair] == [True, True]
    assert pair[0].overlaps(opposite(pair[1]))


def test_zeros_where_a_force_acts_are_the_poles_of_what_is_held_there():
    # A cantilever held at its tip by a pin: tan = tanh.
    text = specification(spans(2, {0: "fixed"}), 'F = { force = "n_2" }', 'X = "n_2"')
    expected = [(b / 1.0) ** 2 * UNIT for b in (3.926602312047919, 7.068582745628732, 10.210176122813031)]
    assert omegas(located(text).zeros)[:3] == pytest.approx(expected, rel=1e-11)


def test_a_free_beam_has_two_motions_at_rest_of_which_a_force_sees_one():
    text = specification(spans(3, {}), 'F = { force = "n_0" }', 'X = "n_0"')
    found = located(text)
    assert [r.multiplicity for r in found.poles if r.is_zero] == [2]
    assert [h.root.multiplicity for h in found.hidden if h.root.is_zero] == [2]
    assert omegas(found.poles) == pytest.approx([(b / 1.5) ** 2 * UNIT for b in FREE], rel=1e-11)


@pytest.mark.slow
def test_what_the_counts_of_a_network_do_not_settle_is_searched_in_its_formula(monkeypatch):
    def undecided(*_, **__):
        raise UndecidedError

    monkeypatch.setattr(poles_zeros, "roots_in_disc", undecided)
    lumps = 'd = { type = "damper", between = ["n_1", "ground"], b = "1e-9 N*s/m" }'
    text = specification(spans(2, {0: "fixed"}, "L") + "\n" + lumps, 'F = { force = "n_2" }', 'X = "n_2"')
    (tf,) = pipeline.derive_nested(
        pipeline.loads(text.replace("[elements]", '[parameters]\nL = "0.5 m"\n[elements]'))
    )
    # The formula has the values the network had: a beam of half the length is four times as fast.
    for given, scale in (({}, 1), ({"L": "0.25"}, 4)):
        found = locate(bind_nested(tf, given), Modes(2), 12)
        assert found.certificate.certified, given
        assert [float(p.im) for p in found.poles if p.im > 0] == pytest.approx(
            [scale * b**2 * UNIT for b in CANTILEVER[:2]], rel=1e-9
        ), given


def test_a_velocity_has_one_pole_at_rest_less():
    text = specification(spans(2, {0: "slider"}), 'F = { force = "n_0" }', 'X = "s*n_0.y"')
    assert [r.multiplicity for r in located(text).poles if r.is_zero] == [1]


def test_equal_spans_on_pins_have_pass_bands_between_those_of_one_span():
    # The lowest band of a beam on many pins begins with the pinned span, beta l = pi, and ends below the
    # clamped one, 4.730; each holds as many frequencies as there are spans (Miles 1956, Proc. ASCE 82 EM1).
    count = 5
    text = specification(
        spans(count, dict.fromkeys(range(count + 1), "pin")), 'M = { torque = "n_0" }', 'X = "n_0.theta"'
    )
    found = located(text, Modes(2 * count), source="M")
    betas = [sqrt(w / UNIT) * 0.5 for w in omegas(found.poles)]
    assert found.certificate.certified
    assert betas[0] == pytest.approx(pi, rel=1e-10)
    assert betas[count] == pytest.approx(2 * pi, rel=1e-10)
    assert pi - 1e-9 < min(betas) < max(betas[:count]) < FREE[0]
    assert 2 * pi - 1e-9 < min(betas[count:]) < max(betas) < FREE[1]


def test_a_string_driven_in_its_middle_hides_the_modes_with_a_node_there():
    string = 'type = "string", N = "100 N", A = "1e-4 m^2", rho = "2500 kg/m^3", l = "0.5 m"'
    elements = f'p = {{ {string}, between = ["ground", "a"] }}\nq = {{ {string}, between = ["a", "ground"] }}'
    found = located(specification(elements), Modes(3))
    first = pi * sqrt(100 / 0.25)
    assert found.certificate.certified
    assert omegas(found.poles) == pytest.approx([first, 3 * first, 5 * first], rel=1e-12)
    assert omegas([h.root for h in found.hidden]) == pytest.approx([2 * first, 4 * first], rel=1e-12)
    assert omegas(found.zeros) == pytest.approx([2 * first, 4 * first, 6 * first], rel=1e-12)


@pytest.mark.slow
def test_two_equal_arms_on_a_hub_have_a_double_frequency_of_which_the_hub_sees_one():
    # Mirror images of each other: in one mode the hub moves, in the other it rests, at the clamped frequency.
    arm = f'{{ {BEAM}, l = "0.5 m", between = ["a", "END"] }}'
    mass = 'm = { type = "mass", at = "a.y", m = "1 kg" }'
    elements = f"p = {arm.replace('END', 'b')}\nq = {arm.replace('END', 'c')}\n{mass}"
    found = located(specification(elements), Modes(4))
    hidden = omegas([h.root for h in found.hidden])
    clamped = (CANTILEVER[0] / 0.5) ** 2 * UNIT
    assert found.certificate.certified
    assert any(
        w == pytest.approx(clamped, rel=1e-10) for w in omegas(found.poles) + omegas(found.zeros) + hidden
    )


@pytest.mark.slow
def test_poles_and_zeros_alternate_where_a_force_acts():
    rows = [
        f'b_{i} = {{ {BEAM}, between = ["n_{i}", "n_{i + 1}"], l = "{0.3 + 0.05 * i:.2f} m" }}\n'
        f'k_{i} = {{ type = "spring", between = ["n_{i + 1}.y", "ground"], k = "{100 * (i + 1)} N/m" }}'
        for i in range(6)
    ]
    text = specification("\n".join(rows), 'F = { force = "n_3" }', 'X = "n_3"')
    found = located(text, Modes(8))
    merged = sorted([(w, "pole") for w in omegas(found.poles)] + [(w, "zero") for w in omegas(found.zeros)])
    assert all(a != b for (_, a), (_, b) in pairwise(merged))


@pytest.mark.slow
def test_regions_of_a_cantilever_hold_what_lies_in_them():
    text = specification(spans(3, {0: "fixed"}), 'F = { force = "n_3" }', 'X = "n_3"')
    every = omegas(located(text, Modes(8)).poles)
    assert omegas(located(text, Mode(7)).poles) == pytest.approx(every[6:7])
    low, high = Fraction(10), Fraction(400)
    inside = [w for w in every if low <= w / (2 * pi) <= high]
    assert 1 < len(inside) < 7
    assert omegas(located(text, Band(low, high)).poles) == pytest.approx(inside)
    # Beside the imaginary axis there is nothing.
    sides = (Fraction(1), Fraction(5), Fraction(0), Fraction(5000))
    assert located(text, Rectangle(*sides)).poles == ()


def test_forty_digits_are_correct():
    # beta l of the cantilever to fifty digits, from mpmath's findroot of cos cosh + 1.
    text = specification(spans(2, {0: "fixed"}, "1 m"), 'F = { force = "n_2" }', 'X = "n_2"')
    from mpmath import findroot, mp, mpf

    with mp.workdps(60):
        beta = findroot(lambda x: mp.cos(x) * mp.cosh(x) + 1, mpf("1.875"))
        expected = mp.nstr((beta / 2) ** 2 * mp.sqrt(mpf(700) / mpf("0.27")), 42)
    (pole, _) = located(text, Modes(1), 40).poles
    assert expected.startswith(pole.decimal(40).im[:38])


@pytest.mark.slow
def test_frequencies_of_unlike_members_are_those_of_an_independent_matrix():
    # Six beams on springs: sign changes of the determinant of textbook matrices, cleared of their poles.
    lengths, springs = [0.3, 0.41, 0.27, 0.36, 0.5, 0.33], [100.0, 900.0, 50.0, 4000.0, 10.0, 700.0]
    rows = [
        f'b_{i} = {{ {BEAM}, between = ["n_{i}", "n_{i + 1}"], l = "{length} m" }}\n'
        f'k_{i} = {{ type = "spring", between = ["n_{i + 1}.y", "ground"], k = "{k} N/m" }}'
        for i, (length, k) in enumerate(zip(lengths, springs, strict=True))
    ]
    text = specification("\n".join([*rows, CLAMP]), 'F = { force = "n_6" }', 'X = "n_6"')
    found = omegas(located(text, Modes(6)).poles)

    def sign(omega):
        total = np.zeros((14, 14))
        signs = 1.0
        b = sqrt(omega / UNIT)
        for i, length in enumerate(lengths):
            c, s, ch, sh = np.cos(b * length), np.sin(b * length), np.cosh(b * length), np.sinh(b * length)
            d = 1 - c * ch
            signs *= np.sign(d)
            near = np.array(
                [[b**3 * (c * sh + s * ch), b**2 * s * sh], [b**2 * s * sh, b * (s * ch - c * sh)]]
            )
            far = np.array([[-(b**3) * (s + sh), b**2 * (ch - c)], [-(b**2) * (ch - c), b * (sh - s)]])
            flip = np.diag([1, -1])
            block = np.block([[near, far], [far.T, flip @ near @ flip]]) * 700 / d
            total[2 * i : 2 * i + 4, 2 * i : 2 * i + 4] += block
        for i, k in enumerate(springs):
            total[2 * i + 2, 2 * i + 2] += k
        return signs * np.linalg.slogdet(total[2:, 2:])[0]

    grid = np.linspace(1.0, found[-1] * 1.001, 1_500)
    signs = [sign(w) for w in grid]
    crossings = [w for w, a, b in zip(grid[1:], signs, signs[1:], strict=False) if a != b]
    assert len(crossings) == 6
    assert found == pytest.approx(crossings, abs=grid[1] - grid[0])


# --------------------------------------------------------- losses, loops, delays and sensors elsewhere


ROD = 'type = "rod", E = "1 Pa", A = "1 m^2", rho = "1 kg/m^3"'
"""Unit stiffness, unit mass per length: waves travel a metre in a second."""


def dashpot(b, node="a"):
    return f'd = {{ type = "damper", between = ["{node}", "ground"], b = "{b} N*s/m" }}'


def damped_rod(b):
    """Return a rod of a metre, in two pieces, with a dashpot at its tip."""
    pieces = [
        f'r_{i} = {{ {ROD}, l = "0.5 m", between = ["{a}", "{c}"] }}'
        for i, (a, c) in enumerate((("ground", "m"), ("m", "a")))
    ]
    return specification("\n".join([*pieces, dashpot(b)]))


@pytest.mark.slow
def test_a_rod_with_a_dashpot_has_its_poles_on_a_line_and_zeros_of_the_clamped_one():
    # cosh s + b sinh s = 0: s = ln((1 - b)/(1 + b))/2 + j pi (k + 1/2); one that supplies energy is unstable.
    for b, word in ((0.3, "stable"), (-0.3, "unstable")):
        found = located(damped_rod(b), Modes(3))
        assert found.certificate.certified, b
        assert found.certificate.engine == "cramer"
        assert omegas(found.poles) == pytest.approx([pi * (k + 0.5) for k in range(3)], rel=1e-11), b
        for pole in found.poles:
            assert float(pole.re) == pytest.approx(log((1 - b) / (1 + b)) / 2, rel=1e-11), b
        assert omegas(found.zeros) == pytest.approx([pi, 2 * pi, 3 * pi], rel=1e-11), b
        assert found.verdict.word == word


def test_a_strong_dashpot_has_real_poles_to_forty_digits():
    # b > 1: s = ln((b - 1)/(b + 1))/2 + j pi k; ln(1/2)/2 to forty digits.
    real = [pole for pole in located(damped_rod(3.0), Modes(2), 40).poles if pole.is_real]
    assert len(real) == 1
    assert real[0].decimal(40).re.startswith("-0.346573590279972654708616060729088284")


@pytest.mark.slow
def test_regions_hold_what_lies_in_them():
    # abs(s)/(2 pi) is about 0.26, 0.75, 1.25; of a mode both conjugates are shown.
    for region, count in (
        (Band(Fraction(1, 5), Fraction(1)), 4),
        (Rectangle(Fraction(-1), Fraction(0), Fraction(0), Fraction(8)), 3),
        (Mode(3), 2),
    ):
        assert len(located(damped_rod(0.3), region).poles) == count, region


def test_zeros_of_a_sensor_elsewhere_may_be_real():
    # Force at a cantilever's tip, deflection in its middle: zeros +-sigma (Spector & Flashner 1990).
    elements = "\n".join(
        f'b_{i} = {{ {BEAM}, l = "0.25 m", between = ["{a}", "{b}"] }}'
        for i, (a, b) in enumerate((("ground", "m"), ("m", "a")))
    )
    found = located(specification(elements, outputs='X = "m.y"'), Modes(3))
    assert found.certificate.certified
    assert found.certificate.engine == "cramer"
    assert any(zero.is_real for zero in found.zeros)
    assert all(zero.is_real or zero.on_imaginary_axis for zero in found.zeros)
    assert all(pole.on_imaginary_axis for pole in found.poles)


def test_a_members_force_is_read():
    # Force in a rod held at one end, at that end: 1/cosh: no zeros at all, so fewer than asked for are found.
    text = specification(f'r = {{ {ROD}, l = "1 m", between = ["a", "ground"] }}', outputs='X = "r.f"')
    found = located(text, Band(Fraction(0), Fraction(1)))
    assert found.zeros == ()
    assert omegas(found.poles) == pytest.approx([pi * 0.5, pi * 1.5], rel=1e-11)
    assert all(pole.on_imaginary_axis for pole in found.poles)


def test_a_free_rod_with_a_dashpot_has_one_pole_at_rest():
    # It comes to rest anywhere: s (sinh s + b cosh s) = 0.
    elements = f'r = {{ {ROD}, l = "1 m", between = ["a", "c"] }}\n' + dashpot(0.3, "c")
    found = located(specification(elements), Modes(2))
    assert [pole.multiplicity for pole in found.poles if pole.is_zero] == [1]


def test_a_delayed_loop_has_the_poles_of_its_equation():
    # k = 1: s^2 m + c s + K exp(-s T) = 0 on a mass, without any member: only the delay is distributed.
    text = """symflex = 1
[elements]
m = { type = "mass", at = "a", m = "1 kg" }
d = { type = "damper", between = ["a", "ground"], b = "2 N*s/m" }
f = { type = "force_source", at = "a", f = "K*D*(r - a)" }
[parameters]
K = "3 N/m"
[blocks]
D = { type = "delay", T = "0.5 s" }
[inputs]
r = {}
[outputs]
X = "a"
"""
    from mpmath import findroot, mp

    found = located(text, Band(Fraction(0), Fraction(3)), source="r")
    assert found.certificate.certified
    for pole in found.poles:
        s = complex(float(pole.re), float(pole.im))
        root = findroot(lambda z: z * z + 2 * z + 3 * mp.exp(-z / 2), s)
        assert complex(root) == pytest.approx(s, rel=1e-10)

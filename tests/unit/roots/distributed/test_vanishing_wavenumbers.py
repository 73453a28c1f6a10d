"""Roots where a wavenumber vanishes, to as many digits as are asked for, against the motion known there.

A free beam moves as a rigid body where a foundation's stiffness and the mass cancel: w = 1 solves
E I w'''' - N w'' + (rho A s^2 + c_f s + k_f) w = 0 with free ends where the bracket is zero, whatever the
axial force and the rotary inertia are. One of its wavenumbers vanishes there. In the Timoshenko theory one
vanishes at the cut-off frequency, kappa G A = -rho I s^2, where a pinned beam turns all its sections alike
(w = 0, phi = 1).
"""

from fractions import Fraction

import pytest
from mpmath import expm, findroot, matrix, mpc, mpf, sqrt, workdps

from symflex import pipeline
from symflex.balls import to_complex_mpmath, to_mpmath
from symflex.roots import Band, Modes
from symflex.roots.locate import locate

BEAM = """
symflex = 1
[elements.b]
type    = "beam"
between = ["a", "c"]
E       = "4 Pa"
I       = "1 m^4"
rho     = "2 kg/m^3"
A       = "1 m^2"
l       = "1 m"
{more}
{ends}
[inputs]
F = {{ {load} }}
[outputs]
Y = "{output}"
"""
AXIAL = 'N = "3 N"\nk_f = "14 N/m^2"'
RAYLEIGH = 'theory = "rayleigh"\nk_f = "14 N/m^2"'
TIMOSHENKO = 'theory = "timoshenko"\nkappa = "0.5"\nG = "28 Pa"'
CUT_OFF = Band(Fraction("0.4"), Fraction("0.44"))  # sqrt(7) rad/s = 0.421 Hz
PINNED = '[elements]\np = { type = "pin", at = "a" }\nq = { type = "pin", at = "c" }'


def solved(more, digits, region, ends="", load='force = "a.y"', output="a.y"):
    model = pipeline.loads(BEAM.format(more=more, ends=ends, load=load, output=output))
    (bound,) = pipeline.derive_bound(model, model.transfer_functions)
    return locate(bound, region, digits)


def check(roots, expected, digits):
    """Exactly one root has the expected value, with its radius and all digits."""
    with workdps(digits + 20):
        near = [r for r in roots if abs(to_complex_mpmath(r.enclosure()) - expected()) < mpf("1e-3")]
        (root,) = near
        value, radius = to_complex_mpmath(root.enclosure()), to_mpmath(root.re.rad() + root.im.rad())
        assert root.certified
        assert root.multiplicity == 1
        assert abs(value - expected()) <= radius + mpf(10) ** (-digits - 10)
        assert radius < 10 * abs(expected()) * mpf(10) ** -digits
    assert len(root.decimal(digits).im.replace(".", "").lstrip("-0")) >= digits - 1
    return root


@pytest.mark.slow
def test_translation_of_a_free_beam_on_a_foundation_is_known_to_all_digits():
    result = solved(AXIAL, 25, Modes(1))
    assert check(result.poles, lambda: mpc(0, sqrt(7)), 25).on_imaginary_axis
    assert len(result.poles) == 2
    assert result.certificate.certified


@pytest.mark.slow
def test_translation_with_rotary_inertia():
    result = solved(RAYLEIGH, 30, Modes(2))
    assert check(result.poles, lambda: mpc(0, sqrt(7)), 30).on_imaginary_axis
    assert result.certificate.certified


@pytest.mark.slow
def test_where_two_wavenumbers_meet_or_one_vanishes_without_a_motion_there_is_no_mode():
    # w'''' - (3/4) w'' + (s^2 + 7)/2 w = 0 has double wavenumbers where (3/4)^2 = 2 (s^2 + 7); at the cut-off
    # frequency of a free Timoshenko beam its shear force, kappa G A (w' - phi), is not zero at the ends.
    for more, place, region in ((AXIAL, mpf(7) - mpf(9) / 32, Modes(2)), (TIMOSHENKO, mpf(7), CUT_OFF)):
        result = solved(more, 15, region, output="c.y")
        found = [*result.poles, *result.zeros, *(h.root for h in result.hidden)]
        assert result.certificate.certified
        assert not any(abs(float(root.im.mid()) - float(sqrt(place))) < 1e-3 for root in found), more


@pytest.mark.slow
def test_sections_of_a_pinned_timoshenko_beam_turn_alike_at_the_cut_off_frequency():
    result = solved(TIMOSHENKO, 30, CUT_OFF, PINNED, 'torque = "a.theta"', "a.theta")
    assert check(result.poles, lambda: mpc(0, sqrt(7)), 30).on_imaginary_axis
    assert result.certificate.certified


@pytest.mark.slow
def test_what_vanishes_with_wavenumbers_of_numbers_is_no_pole():
    # Clamped, with a spring of 100 N/m at 2 m, where F acts. Its wavenumbers vanish at 0, -0.6 and +-200j.
    beam = ', EI = 7, rhoA = 0.5, rhoI = 0.002, kappaGA = 80, c_f = 0.3, theory = "timoshenko" }\n'
    model = pipeline.loads(
        f"symflex = 1\n[elements]\nm = {{ type = 'beam', between = ['a', 'b'], l = 1{beam}"
        f"n = {{ type = 'beam', between = ['b', 'c'], l = 1{beam}f = {{ type = 'fixed', at = 'a' }}\n"
        "k = { type = 'spring', between = ['c', 'ground'], k = 100 }\n"
        "[inputs.F]\nforce = 'c'\n[outputs]\nY = 'b'\n"
    )
    (bound,) = pipeline.derive_bound(model, model.transfer_functions)
    result = locate(bound, Modes(2), 15)

    def determinant(s):
        """Return that of the conditions at the spring, by the moment and shear force at the clamp."""
        mass, damping = s * s / 2, 3 * s / 10
        motion = matrix([
            [0, 1, 0, mpf(1) / 80], [0, 0, mpf(1) / 7, 0], [0, s * s / 500, 0, -1], [mass + damping, 0, 0, 0]
        ])  # fmt: skip
        across = expm(2 * motion)
        ends = [(across[2, j], across[3, j] + 100 * across[0, j]) for j in (2, 3)]
        return ends[0][0] * ends[1][1] - ends[0][1] * ends[1][0]

    assert result.certificate.certified
    assert result.verdict.word == "stable"
    assert len(result.poles) == 4
    for guess in (mpc(-0.3, 10), mpc(-0.3, 24)):
        with workdps(40):
            pole = findroot(determinant, guess)
        check(result.poles, lambda pole=pole: pole, 15)

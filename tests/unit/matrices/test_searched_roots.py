"""Zeros of matrices of beams, compared with pinned beams and with roots of equations by mpmath."""

from __future__ import annotations

from math import pi

import mpmath
import pytest

from symflex.matrices.matrix_roots import MatrixRoots
from symflex.matrices.searched_roots import NOT_EXCLUDED, SearchedMatrix
from symflex.model import Model
from symflex.roots import Modes
from tests.unit.matrices.models import model_of, of_functions

FREE_BEAM = """
symflex = 1
elements.one = { type = "beam", between = ["a", "b"], EI = 1, rhoA = 1, l = "1/2" }
elements.two = { type = "beam", between = ["b", "c"], EI = 1, rhoA = 1, l = "1/4" }
elements.three = { type = "beam", between = ["c", "d"], EI = 1, rhoA = 1, l = "1/4" }
inputs = { F_a = { force = "a.y" }, F_b = { force = "b.y" }, F_d = { force = "d.y" } }
outputs = { Y_a = "a.y", Y_c = "c.y", Y_d = "d.y" }
"""
ENDS = """
symflex = 1
elements.beam = { type = "beam", between = ["a", "d"], EI = 1, rhoA = 1, l = "1" }
inputs = { F_a = { force = "a.y" }, F_d = { force = "d.y" } }
outputs = { Y_a = "a.y", Y_d = "d.y" }
"""
LOADED = """
symflex = 1
[fields.w]
domain = ["0", "1"]
equation = "w'''' + s^2*w = p"
conditions = ["w(0) = 0", "w'(0) = 0", "w''(1) = 0", "w'''(1) = -F"]
[inputs]
F = {}
p = {}
[outputs]
tip = "w(1)"
middle = "w(1/2)"
"""
MIRRORED = """
symflex = 1
[elements]
one = { type = "beam", between = ["p", "q"], EI = 5, rhoA = 1, l = 0.5 }
two = { type = "beam", between = ["q", "r"], EI = 5, rhoA = 1, l = 0.5 }
left = { type = "spring", between = ["p.y", "ground"], k = 30 }
right = { type = "spring", between = ["r.y", "ground"], k = 30 }
middle = { type = "damper", between = ["q.y", "ground"], b = 1 }
[inputs]
F = { force = "q.y" }
H = {}
[outputs]
Y = "q.y + 0.1*H"
S = "p.y + r.y"
"""


def roots_of(model: Model, outputs: str = "", inputs: str = "", modes: int = 2) -> MatrixRoots:
    rows = tuple(outputs.split()) or tuple(each.name for each in model.outputs)
    columns = tuple(inputs.split()) or tuple(each.name for each in model.inputs)
    return SearchedMatrix(model, rows, columns, Modes(modes), 15).roots()


def test_zeros_of_a_beam_pushed_and_read_at_its_ends_are_the_poles_of_a_pinned_one() -> None:
    found = roots_of(model_of(ENDS))
    above = [complex(zero) for zero in found.located.zeros if zero.im > 0]
    assert above == pytest.approx([1j * (n * pi) ** 2 for n in (1, 2)], rel=1e-13)
    # The first bending mode is symmetric, the second antisymmetric.
    signs = [complex(each.inputs[1]).real for each in found.directions if each.zero.im > 0]
    assert signs == pytest.approx([1, -1], abs=1e-12)
    assert found.located.certificate.certified


def test_both_rigid_motions_are_poles_of_the_matrix() -> None:
    at_rest = roots_of(model_of(ENDS)).located.poles[0]
    assert (at_rest.is_zero, at_rest.multiplicity, at_rest.certified) == (True, 4, True)


def test_one_force_at_an_end_moves_one_of_two_rigid_motions() -> None:
    found = roots_of(model_of(ENDS), "Y_a Y_d", "F_a")
    (missed,) = found.decoupling_zeros
    assert (missed.root.is_zero, missed.inputs, missed.outputs) == (True, 2, 0)
    assert found.located.zeros == ()
    assert found.located.certificate.certified


def test_zeros_of_a_beam_read_beside_its_forces_are_real() -> None:
    # Forces at 0 and 1/2, read at 3/4 and 1: by hand, one factor is sinh u + sin u at q = 2 u, s^2 = -q^4.
    found = roots_of(model_of(FREE_BEAM), "Y_c Y_d", "F_a F_b", modes=1)
    u = mpmath.findroot(lambda x: mpmath.sinh(x) + mpmath.sin(x), 2.36 * (1 + 1j))
    s = complex(mpmath.sqrt(-((2 * u) ** 4))).real
    assert sorted(complex(z).real for z in found.located.zeros) == pytest.approx([-abs(s), abs(s)], rel=1e-13)
    assert all(zero.is_real for zero in found.located.zeros)


def test_what_clears_the_equations_of_a_loaded_field_is_no_zero_at_rest() -> None:
    # At rest F and p bend the beam differently: 1/3 * 17/384 is not 5/48 * 1/8.
    found = roots_of(model_of(LOADED))
    assert not any(root.is_zero for root in (*found.located.zeros, *found.located.poles))
    assert found.decoupling_zeros == ()
    assert found.located.verdict.hidden == ""


def turned_in_the_middle() -> complex:
    """Return the first antisymmetric mode of MIRRORED: half of it, pinned in the middle."""

    def moment_free(x: mpmath.mpf) -> mpmath.mpf:
        sine, sinh = mpmath.sin(x / 2), mpmath.sinh(x / 2)
        shear = sine * mpmath.cosh(x / 2) - sinh * mpmath.cos(x / 2)
        return 5 * x**3 * shear - 2 * 30 * sine * sinh

    return complex(1j * mpmath.sqrt(5) * mpmath.findroot(moment_free, 2.4) ** 2)


def test_modes_that_turn_the_middle_are_hidden_where_only_mirrored_motions_are_driven_and_read() -> None:
    # H adds to Y without moving anything: no factor of the quotient cancels as it is written.
    found = roots_of(model_of(MIRRORED))
    first = next(each for each in found.decoupling_zeros if each.root.im > 0)
    assert complex(first.root) == pytest.approx(turned_in_the_middle(), rel=1e-13)
    shown = [complex(root) for root in (*found.located.poles, *found.located.zeros)]
    assert min(abs(s - turned_in_the_middle()) for s in shown) > 1


def test_as_many_modes_are_shown_as_are_asked_for_beside_hidden_ones() -> None:
    found = roots_of(model_of(MIRRORED), modes=2)
    assert sum(1 for pole in found.located.poles if pole.im > 0) == 2


def test_of_two_filters_of_one_input_the_matrix_has_one() -> None:
    found = roots_of(
        of_functions(["exp(-0.3*s)/(s+1)", "2/(s+3)"], ["1/(s+1)", "exp(-0.5*s)/(s+2)"]), modes=3
    )
    assert [complex(pole).real for pole in found.located.poles] == [-1, -2, -3]
    (hidden,) = found.decoupling_zeros
    assert (complex(hidden.root), hidden.cause) == (-1, "input")
    # det G = exp(-0.8 s)/((s + 1)(s + 2)) - 2/((s + 1)(s + 3))
    first = mpmath.findroot(lambda s: mpmath.exp(-0.8 * s) * (s + 3) - 2 * (s + 2), -0.3)
    assert complex(found.located.zeros[0]) == pytest.approx(complex(first), rel=1e-13)


def test_dependent_outputs_lower_the_normal_rank_for_sure() -> None:
    text = ENDS.replace('Y_d = "d.y"', 'Y_d = "2*a.y"')
    found = roots_of(model_of(text), modes=1)
    assert (found.normal_rank, found.has_full_rank) == (1, False)
    reason = found.located.certificate.reason
    assert reason in (None, NOT_EXCLUDED)


def test_a_zero_that_is_not_square_is_not_proved() -> None:
    # One of two beams, apart from each other, is pushed: the other is read at rest.
    text = """
symflex = 1
elements.one = { type = "beam", between = ["a", "b"], EI = 1, rhoA = 1, l = 1 }
elements.two = { type = "beam", between = ["c", "d"], EI = 1, rhoA = 1, l = "1/2" }
elements.hold = { type = "fixed", at = "a" }
elements.keep = { type = "fixed", at = "c" }
inputs = { F = { force = "b.y" } }
outputs = { Y = "b.y", Z = "d.y" }
"""
    found = roots_of(model_of(text))
    assert found.located.zeros
    assert found.located.certificate.reason == NOT_EXCLUDED
    assert all(each.inputs and not each.outputs for each in found.decoupling_zeros)


def test_loss_factors_leave_the_roots_of_positive_frequencies() -> None:
    text = ENDS.replace('l = "1"', 'l = "1", eta_s = 0.02')
    found = roots_of(model_of(text), modes=1)
    assert found.located.zeros[0].loss_factor() is not None


def test_what_is_missed_beyond_the_highest_pole_is_no_zero() -> None:
    # A uniform load misses the antisymmetric modes of a clamped beam, at whose frequencies the moment at its
    # end has zeros, too. The second of these lies beyond the second mode that is moved.
    text = """
symflex = 1
[fields.w]
domain = ["0", "1"]
equation = "w'''' + s^2*w = p"
conditions = ["w(0) = 0", "w'(0) = 0", "w(1) = 0", "w'(1) = 0"]
[inputs]
p = {}
[outputs]
M = "w''(1)"
"""
    found = roots_of(model_of(text))
    # cos q cosh q = 1: symmetric modes at q = 4.73, 11.00, antisymmetric ones at 7.85, 14.14.
    missed = [
        float(mpmath.findroot(lambda q: mpmath.cos(q) * mpmath.cosh(q) - 1, q)) ** 2 for q in (7.853, 14.137)
    ]
    above = [complex(zero).imag for zero in found.located.zeros if zero.im > 0]
    assert above == pytest.approx(missed, rel=1e-12)
    assert [zero.multiplicity for zero in found.located.zeros] == [1] * 4
    assert found.located.certificate.certified

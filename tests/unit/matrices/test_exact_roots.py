"""Poles and zeros of lumped matrices, compared with printed ones and with systems whose modes are seen."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from symflex.matrices.exact_roots import ExactMatrix
from symflex.matrices.matrix_roots import MatrixRoots
from symflex.model import Model, with_numbers
from symflex.roots import Band, Mode, Modes, Region, Root
from tests.unit.matrices.models import TWO_MASSES, model_of, numbers, of_functions, state_space


def roots_of(model: Model, region: Region | None = None) -> MatrixRoots:
    outputs, inputs = (tuple(each.name for each in some) for some in (model.outputs, model.inputs))
    exact = ExactMatrix.of(with_numbers(model), outputs, inputs)
    assert exact is not None
    return exact.roots(region, 20)


def values(roots: tuple[Root, ...]) -> list[complex]:
    """Return roots as often as they are, by real part and imaginary part."""
    found = [complex(root) for root in roots for _ in range(root.multiplicity)]
    return sorted(found, key=lambda z: (round(z.real, 9), z.imag))


# Emami-Naeini and Van Dooren (1982), Computation of zeros of linear multivariable systems, examples 3, 4 and
# 11, with the zeros that the tests of ControlSystems.jl list for them (test_analysis.jl).
EXAMPLE_3 = state_space(
    numbers("0 1 0 0 0 0\n0 0 1 0 0 0\n0 0 0 0 0 0\n0 0 0 0 1 0\n0 0 0 0 0 1\n0 0 0 0 0 0"),
    numbers("0 0\n0 0\n1 0\n0 0\n0 0\n0 1"),
    numbers("1 1 0 0 0 0\n0 0 0 1 -1 0"),
    numbers("1 0\n1 0"),
)
EXAMPLE_4 = state_space(
    numbers("""
        -0.129 0 0.0396 0.025 0.0191
        0.00329 0 -0.0000779 0.000122 -0.621
        0.0718 0 -0.1 0.000887 -3.85
        0.0411 0 0 -0.0822 0
        0.000361 0 0.000035 0.0000426 -0.0743"""),
    numbers("0 0.00139\n0 0.0000359\n0 -0.00989\n0.0000249 0\n0 -0.00000534"),
    numbers("1 0 0 0 0\n0 1 0 0 0"),
)
EXAMPLE_11 = state_space(
    numbers("-2 -6 3 -7 6\n0 -5 4 -4 8\n0 2 0 2 -2\n0 6 -3 5 -6\n0 -2 2 -2 5"),
    numbers("-2 7\n-8 -5\n-3 0\n1 5\n-8 0"),
    numbers("0 -1 2 -1 -1\n1 1 1 0 -1\n0 3 -2 3 -1"),
)
# The systems sys322, sys222 and sys623 of the tests of python-control, with the zeros that these list; the
# last one, of three outputs, is the example of SLICOT's AB08ND.
SYS_322 = state_space(
    numbers("-3 4 2\n-1 -3 0\n2 5 3"),
    numbers("1 4\n-3 -3\n-2 1"),
    numbers("4 2 -3\n1 4 3"),
    numbers("-2 4\n0 1"),
)
SYS_222 = state_space(numbers("4 1\n2 -3"), numbers("5 2\n-3 -3"), numbers("2 -4\n0 1"), numbers("3 2\n1 -1"))
SYS_623 = state_space(
    numbers("1 0 0 0 0 0\n0 1 0 0 0 0\n0 0 3 0 0 0\n0 0 0 -4 0 0\n0 0 0 0 -1 0\n0 0 0 0 0 3"),
    numbers("0 -1\n-1 0\n1 -1\n0 0\n0 1\n-1 -1"),
    numbers("1 0 0 1 0 0\n0 1 0 1 0 1\n0 0 1 0 0 1"),
)


@pytest.mark.parametrize(
    ("model", "zeros", "within"),
    [
        (EXAMPLE_3, [-0.6823278038280199, 0.3411639019140099 - 1.161541399997252j, None, 1], 1e-12),
        (EXAMPLE_4, [-0.3680512036036696, -0.06467751189940692], 1e-11),
        (EXAMPLE_11, [-3, 4], 1e-15),
        (SYS_322, [-5.924398, -0.490252, 44.41465], 6e-7),
        (SYS_222, [-10.568501, 3.368501], 6e-7),
        (SYS_623, [-1, 2], 1e-15),
    ],
    ids=["example 3", "example 4", "example 11", "sys322", "sys222", "sys623"],
)
def test_invariant_zeros_are_those_that_are_printed(
    model: Model, zeros: list[complex | None], within: float
) -> None:
    found = values(roots_of(model).invariant_zeros)
    assert len(found) == len(zeros)
    for z, printed in zip(found, zeros, strict=True):
        assert printed is None or abs(z - printed) <= within * max(1, abs(z))


def test_the_example_of_tzero_has_the_zeros_of_its_page() -> None:
    """MathWorks, documentation of tzero: H = [1/(s+1) 1/(s+2); 1/(s+3) 2/(s+4)], -2.5000 +- 1.3229i."""
    found = roots_of(of_functions(["1/(s+1)", "1/(s+2)"], ["1/(s+3)", "2/(s+4)"]))
    zeros = values(found.located.zeros)
    assert [round(z.real, 4) + 1j * round(z.imag, 4) for z in zeros] == [-2.5 - 1.3229j, -2.5 + 1.3229j]


def test_example_4_11_of_skogestad_and_postlethwaite_has_its_pole_once_and_its_zero() -> None:
    """Multivariable feedback control: 1/(s+2) [s-1, 4; 4.5, 2(s-1)] has a pole at -2, a zero at 4."""
    found = roots_of(of_functions(["(s-1)/(s+2)", "4/(s+2)"], ["4.5/(s+2)", "2*(s-1)/(s+2)"]))
    assert (values(found.located.poles), values(found.located.zeros)) == ([-2], [4])
    # At s = 4 the matrix is [3, 4; 4.5, 6]/6.
    (direction,) = found.directions
    assert [complex(x) for x in direction.inputs] == [1, -0.75]
    assert abs(complex(direction.outputs[0]) - 1) < 1e-15
    assert abs(complex(direction.outputs[1]) + 2 / 3) < 1e-15


def test_directions_of_outputs_count_what_outputs_are_divided_by() -> None:
    text = """
symflex = 1
parameters = { k = 0.3 }
inputs = { u = {}, v = {} }
signals = { x = "2*(u + v)/s", w = "(u + s*v)/(s + 3)" }
outputs = { y = "x/7", z = "w/k" }
"""
    (direction,) = roots_of(model_of(text)).directions
    # By hand: the determinant has s - 1; at s = 1, y = 2*(u + v)/7 and z = (u + v)/(4*k).
    assert complex(direction.zero) == 1
    y, z = (complex(x) for x in direction.outputs)
    assert z / y == pytest.approx(-(2 / 7) * 4 * 0.3, rel=1e-14)


def test_a_pole_counts_as_often_as_in_the_denominators_of_minors() -> None:
    """ControlSystems.jl, test_analysis.jl: [2/(s+1) 3/(s+2); 1/(s+1) 1/(s+1)] has poles -1, -1, -2."""
    found = roots_of(of_functions(["2/(s+1)", "3/(s+2)"], ["1/(s+1)", "1/(s+1)"]))
    assert values(found.located.poles) == [-2, -1, -1]


def test_decoupling_zeros_are_counted_by_what_misses_them() -> None:
    # By inspection: x_1 is neither moved nor seen, x_2 not seen, x_3 not moved.
    model = state_space(
        numbers("-1 0 0 0\n0 -2 0 0\n0 0 -3 0\n0 0 0 -4"), numbers("1\n0\n1\n0"), numbers("1 0 0 1")
    )
    found = roots_of(model)
    counted = [(complex(z.root), z.inputs, z.outputs, z.both) for z in found.decoupling_zeros]
    assert counted == [(-2, 1, 1, 1), (-3, 0, 1, 0), (-4, 1, 0, 0)]
    assert values(found.located.poles) == [-1]
    assert values(tuple(h.root for h in found.located.hidden)) == [-4, -3, -2]
    assert found.located.certificate.certified


def test_a_pole_and_a_zero_at_the_same_place_are_both_poles_and_zeros() -> None:
    # diag(1/(s + 1), (s + 1)/(s + 2)): nothing cancels between the two.
    found = roots_of(of_functions(["1/(s+1)", "0"], ["0", "(s+1)/(s+2)"]))
    assert values(found.located.poles) == [-2, -1]
    assert values(found.located.zeros) == [-1]
    assert not found.decoupling_zeros


def test_a_matrix_of_dependent_rows_has_a_normal_rank_below_its_size() -> None:
    found = roots_of(of_functions(["1/(s+1)", "1/(s+2)"], ["2/(s+1)", "2/(s+2)"]))
    assert (found.normal_rank, found.has_full_rank) == (1, False)
    assert values(found.located.zeros) == []
    assert found.located.certificate.certified


def test_a_matrix_that_is_zero_has_neither_poles_nor_zeros() -> None:
    found = roots_of(state_space(numbers("-1 0\n0 -2"), numbers("1\n0"), numbers("0 1")))
    assert (found.normal_rank, found.located.poles, found.located.zeros) == (0, (), ())
    assert [z.cause for z in found.decoupling_zeros] == ["output", "input"]


def test_wide_and_tall_matrices_have_the_zeros_common_to_their_pairs() -> None:
    # By hand: (s + 5) divides both entries, s + 6 one of them.
    for rows in (
        [["(s+5)/(s+1)^2", "(s+5)*(s+6)/(s+2)^3"]],
        [["(s+5)/(s+1)^2"], ["(s+5)*(s+6)/(s+2)^3"]],
    ):
        found = roots_of(of_functions(*rows))
        assert values(found.located.zeros) == [-5]
        assert values(found.located.poles) == [-2, -2, -2, -1, -1]


def test_two_masses_of_two_forces_have_no_zero_and_one_pair_has() -> None:
    model = model_of(TWO_MASSES)
    both = roots_of(model)
    assert (len(both.located.zeros), len(both.located.poles)) == (0, 4)


def test_constants_such_as_pi_stay_exact() -> None:
    model = model_of("""
symflex = 1
parameters = { f_1 = "10 Hz", m = "2 kg", phi = "30 deg" }
elements.m = { type = "mass", at = "x", m = "m" }
elements.n = { type = "mass", at = "y", m = "m*cos(phi)" }
elements.k = { type = "spring", between = ["x", "y"], k = "m*f_1^2" }
inputs = { F = { force = "x" } }
outputs = { X = "x", Y = "y" }
""")
    # Both read: no zero, and the poles of two free masses, omega^2 = k (1/m_1 + 1/m_2).
    found = roots_of(model)
    omega = 20 * 3.141592653589793 * (1 + 1 / (3**0.5 / 2)) ** 0.5
    assert found.located.zeros == ()
    assert sum(root.multiplicity for root in found.located.poles) == 4
    assert float(found.located.poles[-1].size().mid()) == pytest.approx(omega, rel=1e-14)


def test_a_band_leaves_out_what_lies_beyond_it() -> None:

    model = of_functions(["(s+1)*(s+50)/((s+2)*(s+60)^2)", "0"], ["0", "1/(s+3)"])
    found = roots_of(model, Band(Fraction(0), Fraction(1)))
    assert values(found.located.poles) == [-3, -2]
    assert values(found.located.zeros) == [-1]
    assert values(found.invariant_zeros) == [-1]


QUADRUPLE_TANK = """
symflex = 1
[parameters]
T_1 = "62 s"
T_2 = "90 s"
T_3 = "23 s"
T_4 = "30 s"
g_1 = 0.7
g_2 = 0.6
[inputs]
v_1 = {}
v_2 = {}
[outputs]
y_1 = "3.7*(g_1*v_1 + (1 - g_2)*v_2/(1 + s*T_3))/(1 + s*T_1)"
y_2 = "4.7*((1 - g_1)*v_1/(1 + s*T_4) + g_2*v_2)/(1 + s*T_2)"
"""


@pytest.mark.parametrize(("split", "place"), [("0.6", -1), ("0.3", 0), ("0.2", 1)])
def test_valves_of_the_quadruple_tank_move_a_zero_into_the_right_half_plane(split: str, place: int) -> None:
    """Johansson (2000): one zero is in the left half-plane for g_1 + g_2 > 1, in the right one below.

    Time constants are those of 2.6/(62 s + 1), 1.5/((23 s + 1)(62 s + 1)), 1.4/((30 s + 1)(90 s + 1)) and
    2.8/(90 s + 1), which Bequette (Process control, section 14.8) prints for the first operating point.
    """
    model = model_of(QUADRUPLE_TANK.replace("g_2 = 0.6", f"g_2 = {split}"))
    first, second = sorted(values(roots_of(model).located.zeros), key=lambda z: z.real)
    # (1 + s T_3)(1 + s T_4) = (1 - g_1)(1 - g_2)/(g_1 g_2)
    g = float(split)
    ratio = 0.3 * (1 - g) / (0.7 * g)
    expected = np.roots([23 * 30, 53, 1 - ratio])
    assert sorted([first.real, second.real]) == pytest.approx(sorted(expected), abs=1e-12)
    assert (second.real > 0) - (second.real < 0) == place


def test_what_misses_the_inputs_is_listed_beside_any_number_of_modes_and_within_a_band_alone() -> None:
    # -1 and -2 are seen; no input moves -3, which is 3/(2 pi) = 0.477 Hz.
    model = state_space(numbers("-1 0 0\n0 -2 0\n0 0 -3"), numbers("1\n1\n0"), numbers("1 1 1"))
    for region, poles, zeros in (
        (None, [-2, -1], [-3]),
        (Modes(1), [-1], [-3]),
        (Mode(2), [-2], [-3]),
        (Band(Fraction(0), Fraction(4, 10)), [-2, -1], []),
    ):
        found = roots_of(model, region)
        assert values(found.located.poles) == poles
        assert [complex(z.root) for z in found.decoupling_zeros] == zeros
